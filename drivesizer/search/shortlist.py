"""From a spec to the best drives: with the drive's mass, by search, by the machine's budgets, by probability.

``sizing`` makes a full result of it, ``study`` a row for each variant.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from drivesizer.catalog import DIRECT, Catalog
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.machine.budgets import check_battery, machine_requirements
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.reliability import Reliability, Uncertainty
from drivesizer.results.weights import Choices
from drivesizer.search.both_methods import other_checks
from drivesizer.search.columns.controllers import matching, offered_buses, offers
from drivesizer.search.machine_filter import Weigh, divided, machine_filter, weighing
from drivesizer.search.order.families import family_firsts, family_of
from drivesizer.search.order.found import Judge, SearchResult
from drivesizer.search.order.ranking import COUNTED, Ranking, names_of
from drivesizer.search.order.sifting import Progress
from drivesizer.search.own_mass import depends_on_ranking, problem_with_drive_mass
from drivesizer.search.search import search
from drivesizer.search.set_record import drive_in_brief, drive_parts, drive_set
from drivesizer.search.uncertainty.options import FINALISTS, POOL, Sampling, sampling_of
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.search.uncertainty.run import SampledDrives

__all__ = ["Shortlist", "shortlist"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Shortlist:
    """Drives by their rows in the result of the search."""

    problem: Problem
    objective: Ranking
    found: SearchResult
    weigh: Weigh  # budgets of the machine with a drive in it
    best: list[int]  # that pass, in order
    top: int  # how many were requested
    unsure: list[int]  # that pass with less than the required probability; the most probable first
    reliability: dict[int, Reliability]  # of both, where drives were sampled
    uncertainty: Uncertainty | None  # None: nothing was sampled
    weighed: tuple[str, ...]  # how the machine's own mass was found
    others: list[int]  # the best of other motor families than the first one's, in order
    choices: Choices | None = None  # to choose from by weights
    checks_alone: bool = False  # drives are given with their sums and checks, without what else is known of them

    @property
    def short(self) -> list[int]:
        """Drives that pass their own checks but fail on a budget of the machine."""
        return divided(self.found, self.weigh, self.top, self.found.short, short=True)

    @property
    def rejected(self) -> Iterable[int]:
        """Rows of the closest rejected, in order."""
        evaluation = self.found.evaluation
        rows = range(self.found.passing, len(evaluation.candidates.motor))
        failed = evaluation.failed if rows else ()
        return (row for row in rows if failed[row])

    def record(self, row: int, rank: int = 0, **known: Any) -> DriveSet:
        """A drive with the machine's budgets, unless it fails by itself; what else is known is as for ``drive_set``."""
        evaluation = self.found.evaluation
        if not evaluation.fails(row):
            known["budget"] = self.weigh(evaluation, row)
        made = drive_in_brief if self.checks_alone else drive_set
        return made(evaluation, row, rank, self.objective, **known)


def shortlist(
    spec: RobotSpec,
    catalog: Catalog,
    objective: Ranking,
    top: int,
    *,
    misses: int = 3,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    sampling: Sampling | None = None,
    brief: bool = False,
    others: int = 0,
    choices: int = 0,
    checks_alone: bool = False,
    made: dict[Hashable, Any] | None = None,
) -> Shortlist:
    """The best drives of a spec, and the closest rejected."""
    _known_choices(spec, catalog)
    check_battery(spec, catalog)
    _known_to(spec, {*names_of(objective), *pareto})
    made = {} if made is None or depends_on_ranking(spec) else made
    if "problem" not in made:
        made["problem"] = problem_with_drive_mass(spec, catalog, objective)
    problem, weighed = made["problem"]
    sampling = sampling or sampling_of(spec)
    pool = POOL if sampling and sampling.confidence is not None else 0
    machine = machine_requirements(problem.machine)
    weigh = weighing(problem, machine, brief=checks_alone)
    judge = machine_filter(problem, machine, weigh, counted=not checks_alone)
    found = search(
        problem, top=max(top, pool), objective=objective, misses=misses, pareto=pareto, progress=progress, judge=judge,
        others=0 if pool else others, margins=choices > 0, made=made,
    )  # fmt: skip
    rows: Sequence[int] = range(found.passing)
    sampled = _sampled(found, rows[:pool], sampling, brief) if sampling and pool else None
    best = divided(found, weigh, top, sampled.good if sampled else rows)
    if sampling and not sampled and best:
        sampled = _sampled(found, best, sampling, brief)
    unsure = divided(found, weigh, top, sampled.bad) if sampled else []
    finalists = {} if brief else {row: drive_parts(found.evaluation, row) for row in best[:FINALISTS]}
    return Shortlist(
        problem=problem,
        objective=objective,
        found=found,
        weigh=weigh,
        best=best,
        top=top,
        unsure=unsure,
        reliability=_reliability(sampled, [*best, *unsure], finalists),
        uncertainty=_uncertainty(sampled),
        weighed=weighed,
        others=_family_alternatives(found, best)[:others] if pool else list(found.others),
        choices=_choices(problem, found, objective, 0 if pool else choices, judge, weigh),
        checks_alone=checks_alone,
    )


def _choices(
    problem: Problem, found: SearchResult, objective: Ranking, most: int, judge: Judge | None, weigh: Weigh
) -> Choices | None:
    """Drives to choose from by weights, where any are wanted."""
    if not most or not found.every:
        return None
    from drivesizer.search.choices import choices  # only a report needs them

    return choices(problem, found.every, objective, most, judge=judge, weigh=weigh)


def _family_alternatives(found: SearchResult, best: list[int]) -> list[int]:
    """The best of each other motor family among drives that reach the required probability."""
    family = family_of(found.evaluation.catalog, found.evaluation.candidates.motor[best])
    return [best[n] for n in family_firsts(family)[1:]]


def _sampled(found: SearchResult, rows: Sequence[int], how: Sampling, brief: bool) -> SampledDrives:
    """Some drives over samples, with their checks by physics whatever the method."""
    from drivesizer.search.uncertainty.run import sample_drives, subject  # where nothing is sampled it need not load

    evaluation, problem = found.evaluation, found.evaluation.problem
    paper = problem.spec.method == "paper"
    beside = {row: other_checks(problem, drive_parts(evaluation, row)) if paper else () for row in rows}
    subjects = {row: subject(evaluation, row, beside[row]) for row in rows}
    return sample_drives(problem, subjects, how, brief=brief)


def _reliability(
    sampled: SampledDrives | None, rows: list[int], finalists: dict[int, DriveParts]
) -> dict[int, Reliability]:
    """Reliability of drives, of some in closed loop as well."""
    if sampled is None:
        return {}
    from drivesizer.search.uncertainty.run import reliabilities

    return reliabilities(sampled, rows, finalists)


def _uncertainty(sampled: SampledDrives | None) -> Uncertainty | None:
    """Assumptions and samples, which all drives have in common."""
    if sampled is None:
        return None
    from drivesizer.search.uncertainty.run import uncertainty

    return uncertainty(sampled)


def _known_to(spec: RobotSpec, names: set[str]) -> None:
    """Refuse objectives that the paper's method does not compute."""
    foreign = sorted(names & set(COUNTED))
    if spec.method == "paper" and foreign:
        raise InputError(f"objective {foreign[0]}: the paper's method does not compute it; expected method: physics")


def _known_choices(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a family or part that no catalogue has, in this section and before this first stage once."""
    catalog.once(("known choices", spec.is_direct), lambda: _refuse_unknown_choices(spec, catalog), (spec.select,))


def _refuse_unknown_choices(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a family or part that no catalogue has: a misspelling would silently find nothing."""
    none = catalog.gearheads.rows[DIRECT]
    unlisted = not spec.is_direct and not np.any(catalog.motor_gearhead.right == none)
    for section in ("motor", "gearhead", "encoder", "controller", "brake"):
        choice, table = getattr(spec.select, section), catalog.table(f"{section}s")
        for key, wanted in choice.named.items():
            known = set(table[key].tolist()) - ({DIRECT} if unlisted else set())
            for name in wanted:
                if not known.intersection(matching(name, table, key)):
                    where = spec.where(("select", section, key))
                    hint = "; expected transmission: [{kind: direct}]" if name == DIRECT else nearest(name, known)
                    raise InputError(f"{where}: {quoted(name)} is in no catalogue that the spec names{hint}")
    bus, buses = spec.select.controller.bus, offered_buses(catalog.controllers)
    if bus and not any(offers(b, bus) for b in buses):
        where = spec.where(("select", "controller", "bus"))
        raise InputError(
            f"{where}: no controller has the bus {quoted(bus)}; expected one of {', '.join(sorted(buses))}"
        )
