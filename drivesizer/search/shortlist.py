"""From a spec to the best drives: parts offered, the drive's own mass, search, budgets, probability."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from drivesizer.catalog import DIRECT, Catalog, load, singular
from drivesizer.catalog.prices import priced
from drivesizer.catalog.typed import with_typed
from drivesizer.catalog.view import STEPPER, view_for
from drivesizer.errors import InputError, UnknownCatalogError, nearest, quoted
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.budgets import check_battery, drive_mass, mass_without_drive, settle
from drivesizer.machine.problem import problem
from drivesizer.physics.figures import Mask
from drivesizer.results.check import Reliability, Uncertainty
from drivesizer.results.drive_set import Detail, DriveSet
from drivesizer.results.problem import (
    Problem,
    wants_screw,
)
from drivesizer.results.sizing import Choices
from drivesizer.search.columns.controllers import offered_buses, offers
from drivesizer.search.machine_filter import InMachine, best_in_machine
from drivesizer.search.passing import Progress
from drivesizer.search.ranking import COUNTED
from drivesizer.search.screw_choice import problem_with_screw
from drivesizer.search.search import SearchResult, family_firsts, family_of, search
from drivesizer.search.set_record import drive_in_brief, drive_parts, drive_set, other_checks
from drivesizer.search.uncertainty.options import FINALISTS, POOL, Sampling, sampling_of
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.search.uncertainty.probabilities import SampledDrives


# -- The parts out of which a spec's drive is chosen: its catalogues as the search takes them, or two parts by number.


def load_parts(spec: RobotSpec, catalog: Catalog | None = None) -> Catalog:
    """The catalogues that a spec names, or one that was loaded, for the search."""
    if catalog is None:
        try:
            catalog = load(spec.select.catalogs, beside=Path(spec.file).parent if spec.file else None)
        except UnknownCatalogError as error:
            lines = [f"{spec.where(('select', 'catalogs'))}: {line}" for line in error.lines]
            raise InputError(lines[0], lines) from None
        catalog = with_typed(catalog, spec.typed, spec.select.named) if spec.typed else catalog
    _offers_motors(spec, catalog)
    limit = next((price.currency for price in spec.price_limits), "")
    catalog = priced(catalog, limit, spec.select.rates, spec.load.motors)
    how = spec.select.motor.kind, spec.select.estimates == "on", spec.control.phase_current
    return catalog.once(("view", *how), lambda: view_for(catalog, *how))


def _offers_motors(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse catalogues without a motor of the kind that the spec selects: steppers, or anything else."""
    steppers = spec.select.motor.kind == STEPPER
    if steppers and not len(catalog.steppers):
        where = spec.where(("select", "catalogs"))
        named = ", ".join(spec.select.catalogs)
        raise InputError(f"{where}: {named} without steppers; expected e.g. stepperonline")
    if not steppers and len(catalog.steppers) and not len(catalog.motors) and not len(catalog.actuators):
        where = spec.where(("select", "catalogs"))
        raise InputError(f"{where}: only steppers are in them; expected select: {{motor: {{kind: {STEPPER}}}}}")


def pair_of(catalog: Catalog, motor: str, gearhead: str, spec: RobotSpec) -> tuple[int, int]:
    """Rows of a motor and a gearhead; a motor alone drives directly where the spec says so."""
    row = _row(catalog, "motors", motor, catalog.motors.at_voltage(spec.supply.nominal))
    box = str(catalog.motors["inside"][row])
    if box and gearhead in ("", box):
        return row, catalog.gearheads.rows[box]
    gearhead = gearhead or (DIRECT if spec.is_direct else "")
    if not gearhead:
        raise InputError(f"--gearhead: motor {quoted(motor)} needs one; expected a part number, or {DIRECT} for none")
    other = _row(catalog, "gearheads", gearhead)
    whole = box or str(catalog.gearheads["inside"][other])
    if whole:
        raise InputError(f"--gearhead: {quoted(whole)} is an actuator, which has motor and gearhead inside")
    return row, other


def _row(catalog: Catalog, section: str, part: str, counts: Mask | None = None) -> int:
    table = catalog.table(section)
    rows = [row for row in table.called(part) if counts is None or counts[row]]
    if not rows:
        raise InputError(f"{singular(section)} {quoted(part)} is in no catalogue{nearest(part, table.rows)}")
    if len(rows) > 1:
        names = ", ".join(table["part"][rows].tolist())
        raise InputError(f"{singular(section)} {quoted(part)} is several parts; expected one of {names}")
    return rows[0]


# -- The sizing problem of a machine whose mass includes that of its own drive, or whose screw is left open.


_SAME = 1e-9  # kg: of drives out of a catalogue one is found again, or another is heavier
_ITERATED = frozenset({"mass_sized_for"})  # holds once the rounds have settled, and not before


def depends_on_ranking(spec: RobotSpec) -> bool:
    """Whether the problem of a machine hangs on what ranks drives: by its own drive's mass, or a screw left open."""
    counts = spec.budget is not None and spec.budget.drive_counts and isinstance(spec.load, WheeledVehicle)
    return counts or wants_screw(spec)


def problem_with_drive_mass(spec: RobotSpec, catalog: Catalog) -> tuple[Problem, tuple[str, ...]]:
    """The sizing problem of a machine, with the mass of its drive or the screw that the spec leaves to the search."""
    load = spec.load
    if wants_screw(spec):
        return problem_with_screw(spec, catalog)
    if not depends_on_ranking(spec) or not isinstance(load, WheeledVehicle):
        return problem(spec, catalog), ()

    def weighing(mass: float) -> RobotSpec:
        return spec.model_copy(update={"load": load.model_copy(update={"mass": mass})})

    def sized(mass: float) -> float | None:
        heavy = problem(weighing(mass), catalog)
        best = best_in_machine(heavy, _ITERATED)
        return drive_mass(heavy, best) if best else None

    settled = settle(sized, mass_without_drive(spec, catalog), tolerance=_SAME)
    return problem(weighing(settled.total), catalog), (
        f"the drive's own mass counts, as far as it is known: {settled.words}",
    )


# -- From a spec to the best drives: with the drive's mass, by search, by the machine's budgets, by probability.
#
# ``sizing`` makes a full result of it, ``study`` a row for each variant.


@dataclass(frozen=True, slots=True, kw_only=True)
class Shortlist:
    """Drives by their rows in the result of the search."""

    problem: Problem
    search: SearchResult
    machine: InMachine  # with a drive in it, against its budgets
    best: list[int]  # that pass, in order
    top: int  # how many were requested
    unsure: list[int]  # that pass with less than the required probability; the most probable first
    reliability: dict[int, Reliability]  # of both, where drives were sampled
    uncertainty: Uncertainty | None  # None: nothing was sampled
    weighed: tuple[str, ...]  # how the machine's own mass was found
    others: list[int]  # the best of other motor families than the first one's, in order
    choices: Choices | None = None  # to choose from by weights
    detail: Detail = "full"

    @property
    def short(self) -> list[int]:
        """Drives that pass their own checks but fail on a budget of the machine."""
        return self.machine.divided(self.search.evaluation, self.top, self.search.short, short=True)

    @property
    def rejected(self) -> Iterable[int]:
        """Rows of the closest rejected, in order."""
        evaluation = self.search.evaluation
        rows = range(self.search.passing, len(evaluation.candidates.motor))
        failed = evaluation.failed if rows else ()
        return (row for row in rows if failed[row])

    def record(self, row: int, rank: int = 0, **known: Any) -> DriveSet:
        """A drive with the machine's budgets, unless it fails by itself; what else is known is as for ``drive_set``."""
        evaluation = self.search.evaluation
        if not evaluation.fails(row):
            known["budget"] = self.machine.budget(evaluation, row)
        if self.detail == "checks" or (self.detail == "headline" and rank > 1):
            return drive_in_brief(evaluation, row, rank, every_check=self.detail == "headline", **known)
        return drive_set(evaluation, row, rank, **known)


def shortlist(
    spec: RobotSpec,
    catalog: Catalog,
    top: int,
    *,
    misses: int = 3,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    sampling: Sampling | None = None,
    detail: Detail = "full",
    others: int = 0,
    choices: int = 0,
    memo: dict[Hashable, Any] | None = None,
) -> Shortlist:
    """The best drives of a spec, and the closest rejected."""
    # in this section and before this first stage once
    catalog.once(("known choices", spec.is_direct), lambda: _refuse_unknown_choices(spec, catalog), (spec.select,))
    check_battery(spec, catalog)
    if spec.method == "paper" and (foreign := sorted({*spec.select.weights, *pareto} & {*COUNTED})):
        raise InputError(f"objective {foreign[0]}: the paper's method does not compute it; expected method: physics")
    memo = {} if memo is None or depends_on_ranking(spec) else memo
    if "problem" not in memo:
        memo["problem"] = problem_with_drive_mass(spec, catalog)
    problem, weighed = memo["problem"]
    problem = problem.ranked_by(spec.select.objective)
    sampling = sampling or sampling_of(spec)
    pool = POOL if sampling and sampling.confidence is not None else 0
    machine = InMachine(problem, detail=detail, memo=memo)
    result = search(
        problem, top=max(top, pool), misses=misses, pareto=pareto, progress=progress, judge=machine.judge,
        others=0 if pool else others, margins=choices > 0,
    )  # fmt: skip
    evaluation, rows = result.evaluation, list(range(result.passing))
    sampled = _sampled(result, rows[:pool], sampling, detail) if sampling and pool else None
    best = machine.divided(evaluation, top, sampled.good if sampled else rows)
    if sampling and not sampled and best:
        sampled = _sampled(result, best, sampling, detail)
    unsure, alternatives = machine.divided(evaluation, top, sampled.bad) if sampled else [], list(result.others)
    reliability, uncertainty = dict[int, Reliability](), None
    if sampled is not None:
        from drivesizer.search.uncertainty import probabilities

        finalists = {row: drive_parts(evaluation, row) for row in best[:FINALISTS]} if detail == "full" else {}
        reliability = probabilities.reliabilities(sampled, [*best, *unsure], finalists)
        uncertainty = probabilities.uncertainty(sampled)
    if pool:  # the best of each other motor family among drives that reach the required probability
        family = family_of(evaluation.catalog, evaluation.candidates.motor[best])
        alternatives = [best[n] for n in family_firsts(family)[1:]][:others]
    offered = None
    if choices and not pool:
        from drivesizer.search import choices as by_weights  # only a report needs them

        offered = by_weights.choices(problem, result, choices, machine)
    return Shortlist(
        problem=problem, search=result, machine=machine, best=best, top=top, unsure=unsure, reliability=reliability,
        uncertainty=uncertainty, weighed=weighed, others=alternatives, choices=offered, detail=detail,
    )  # fmt: skip


def _sampled(result: SearchResult, rows: Sequence[int], how: Sampling, detail: Detail) -> SampledDrives:
    """Some drives over samples, with their checks by physics whatever the method."""
    from drivesizer.search.uncertainty import probabilities  # where nothing is sampled it need not load

    evaluation, problem = result.evaluation, result.evaluation.problem
    paper = problem.spec.method == "paper"
    physics_checks = {row: other_checks(problem, drive_parts(evaluation, row)) if paper else () for row in rows}
    subjects = {row: probabilities.subject(evaluation, row, physics_checks[row]) for row in rows}
    return probabilities.sample_drives(problem, subjects, how, ends=detail == "full")


def _refuse_unknown_choices(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a family or part that no catalogue has: a misspelling would silently find nothing."""
    none = catalog.gearheads.rows[DIRECT]
    unlisted = not spec.is_direct and not np.any(catalog.motor_gearhead.right == none)
    for section in ("motor", "gearhead", "encoder", "controller", "brake"):
        choice, table = getattr(spec.select, section), catalog.table(f"{section}s")
        for key, names in choice.named.items():
            known = set(table[key].tolist()) - ({DIRECT} if unlisted else set())
            for name in names:
                if not known.intersection(table.matching(key, name)):
                    where = spec.where(("select", section, "maker" if key == "manufacturer" else key))
                    hint = "; expected transmission: [{kind: direct}]" if name == DIRECT else nearest(name, known)
                    raise InputError(f"{where}: {quoted(name)} is in no catalogue that the spec names{hint}")
    bus, buses = spec.select.controller.bus, offered_buses(catalog.controllers)
    if bus and not any(offers(b, bus) for b in buses):
        where = spec.where(("select", "controller", "bus"))
        raise InputError(
            f"{where}: no controller has the bus {quoted(bus)}; expected one of {', '.join(sorted(buses))}"
        )
