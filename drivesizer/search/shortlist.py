"""From a spec to the best drives: parts offered, a screw, the drive's own mass, search, budgets."""

from __future__ import annotations

import fnmatch
from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, Catalog, Table, load, singular
from drivesizer.catalog.parts import Screw as Part
from drivesizer.catalog.view.mounted import STEPPER, view_for
from drivesizer.errors import InputError, UnknownCatalogError, nearest, quoted
from drivesizer.load_cases.profile import located, profile_of
from drivesizer.loads.course import Course, course
from drivesizer.loads.screw import Screw, ScrewChoice, own_limits
from drivesizer.loads.stage_losses import force_along
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.budgets import check_battery, drive_mass, machine_requirements, mass_without_drive
from drivesizer.machine.mass_budget import settle
from drivesizer.machine.problem import problem
from drivesizer.physics.load_cycle import Ends
from drivesizer.results.check import Reliability, Uncertainty
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.problem import (
    ChosenScrew,
    Problem,
    TriedScrew,
    chosen_of,
    leaves_open,
    screw_figures,
    wants_screw,
    with_screw,
)
from drivesizer.results.sizing import Choices, objective_figure
from drivesizer.search.columns.controllers import matching, offered_buses, offers
from drivesizer.search.columns.evaluation import smallest_margin
from drivesizer.search.columns.limits import own_limit
from drivesizer.search.machine_filter import Weigh, best_in_machine, divided, machine_filter, weighing
from drivesizer.search.passing import Progress
from drivesizer.search.ranking import COUNTED
from drivesizer.search.search import Judge, SearchResult, family_firsts, family_of, search
from drivesizer.search.set_record import drive_in_brief, drive_parts, drive_set, other_checks
from drivesizer.search.uncertainty.options import FINALISTS, POOL, Sampling, sampling_of
from drivesizer.spec.drive import OBJECTIVES
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
            raise InputError(f"{spec.where(('select', 'catalogs'))}: {error}") from None
    _offers_motors(spec, catalog)
    estimates = spec.select.estimates == "on"
    return view_for(catalog, spec.select.motor.kind, estimates, spec.control.phase_current)


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


def pair_of(catalog: Catalog, motor: str, gearhead: str, volts: float) -> tuple[int, int]:
    """Rows of a motor and a gearhead."""
    row = _row(catalog, "motors", motor, catalog.motors.at_voltage(volts))
    box = str(catalog.motors["inside"][row])
    if box and gearhead in ("", box):
        return row, catalog.gearheads.rows[box]
    if not gearhead:
        raise InputError(f"--gearhead: motor {quoted(motor)} needs one; expected a part number, or {DIRECT} for none")
    other = _row(catalog, "gearheads", gearhead)
    whole = box or str(catalog.gearheads["inside"][other])
    if whole:
        raise InputError(f"--gearhead: {quoted(whole)} is an actuator, which has motor and gearhead inside")
    return row, other


def _row(catalog: Catalog, section: str, part: str, counts: NDArray[np.bool_] | None = None) -> int:
    table = catalog.table(section)
    rows = [row for row in table.called(part) if counts is None or counts[row]]
    if not rows:
        raise InputError(f"{singular(section)} {quoted(part)} is in no catalogue{nearest(part, table.rows)}")
    if len(rows) > 1:
        names = ", ".join(table["part"][rows].tolist())
        raise InputError(f"{singular(section)} {quoted(part)} is several parts; expected one of {names}")
    return rows[0]


# -- A screw out of the catalogues: of each lead the smallest that holds, and of all leads that of the best drive.
#
# The limits of a screw itself do not hang on what drives it. So each lead needs one screw only, and the search runs
# once for each lead, as often as for as many belt ratios: another lead is another load cycle, with another inertia
# and efficiency, not the same one scaled.


_KINDS = {"ball_screw": ("ball",), "lead_screw": ("trapezoidal", "lead")}  # in the catalogues, by kind of load
_SURE = ("pass", "open", "unknown", "fail")
_NO_EFFICIENCY = "efficiency unknown"


class _Case(NamedTuple):
    """A load case of a screw, whatever its lead."""

    spec: RobotSpec
    course: Course
    force: Ends  # N, on the nut of one screw


class _ScrewOfLead(NamedTuple):
    """The screw of a lead, or why there is none."""

    lead: float  # m
    screw: Part | None
    failed: str  # the limit that most of its screws fail


@dataclass(frozen=True, slots=True, kw_only=True)
class _Tried:
    """A lead with its screw and the best drive for it."""

    problem: Problem
    best: DriveSet | None

    @property
    def chosen(self) -> ChosenScrew:
        """Of the machine's length."""
        assert self.problem.screw is not None
        return self.problem.screw


def problem_with_screw(spec: RobotSpec, catalog: Catalog) -> tuple[Problem, tuple[str, ...]]:
    """The sizing problem of a machine with the screw out of the catalogues that suits its drive best."""
    held = _smallest_by_lead(spec, catalog)
    screws = [one.screw for one in held if one.screw is not None]
    if not screws:
        raise InputError(f"{spec.where(('load', 'screw'))}: no screw holds: the leads {_reasons(held)}")
    problems = [_with_screw(spec, catalog, screw) for screw in screws]
    tried = [_Tried(problem=one, best=best_in_machine(one)) for one in problems]
    able = [one for one in tried if one.best is not None]
    chosen = (
        able[int(np.lexsort(_order(able, spec.select.weights)[::-1])[0])].problem
        if able
        else max(problems, key=_nearness)
    )
    rows = [TriedScrew(lead=one.lead, failed=one.failed) for one in held if one.screw is None]
    for one in tried:
        part = one.chosen.screw
        ranked = spec.select.objective
        figure = objective_figure(one.best, ranked) if one.best and isinstance(ranked, str) else None
        drive = one.best.label if one.best else ""
        rows.append(TriedScrew(part.lead, f"{part.manufacturer} {part.part}", one.chosen.least_mass, drive, figure))
    rows.sort(key=lambda row: row.lead)
    assert chosen.screw is not None
    said = f"a screw of each of {len(rows)} leads was tried with its best drive; --checks and reports list them"
    return replace(chosen, screw=replace(chosen.screw, tried=tuple(rows))), (said,) * (len(rows) > 1)


def _with_screw(spec: RobotSpec, catalog: Catalog, screw: Part) -> Problem:
    """The problem with one screw."""
    return replace(problem(with_screw(spec, screw), catalog), screw=chosen_of(spec, screw))


# --- the screw of each lead -------------------------------------------------------------------------------------------


def _smallest_by_lead(spec: RobotSpec, catalog: Catalog) -> list[_ScrewOfLead]:
    """For each lead of the catalogues the smallest screw that holds in all load cases; known limits before unknown."""
    rows, table = _screw_rows(spec, catalog), catalog.screws
    cases = [_case(one) for _, one in spec.load_cases if leaves_open(one)]
    found = []
    for lead in np.unique(table["lead"][rows]).tolist():
        same = rows[table["lead"][rows] == lead]
        order = np.lexsort((table["part"][same], table["dynamic_load"][same], table["diameter"][same]))
        found.append(_smallest(lead, (table.record(int(row)) for row in same[order]), cases))
    return found


def _smallest(lead: float, screws: Iterator[Part], cases: Sequence[_Case]) -> _ScrewOfLead:
    unsure, failed = None, Counter[str]()
    for screw in screws:
        fails, lacks = _screw_verdict(screw, cases)
        if fails:
            failed[fails] += 1
        elif not lacks:
            return _ScrewOfLead(lead, screw, "")
        elif unsure is None:
            unsure = screw
    return _ScrewOfLead(lead, unsure, failed.most_common(1)[0][0] if failed and unsure is None else "")


def _screw_verdict(screw: Part, cases: Sequence[_Case]) -> tuple[str, bool]:
    """The first limit that a screw fails, and whether one is unknown."""
    lacks = False
    for case in cases:
        load: Any = case.spec.load
        load = load.model_copy(update=screw_figures(load, screw))
        if load.efficiency is None and load.thread_friction is None:
            return _NO_EFFICIENCY, False
        with located(case.spec):
            limits = own_limits(load, case.course, case.force)
        for own in limits:
            check = own_limit(case.spec, own)
            if check is not None and check.failed.any():
                return CHECKS["physics"][own.name].title.removeprefix("Screw ").partition(",")[0], False
            lacks |= check is not None and not check.passed.all()
    return "", lacks


def _case(spec: RobotSpec) -> _Case:
    load: Any = spec.load
    moved = course(profile_of(spec))
    return _Case(spec, moved, force_along(moved, load, spec.environment.gravity, load.mass) / load.motors)


def _screw_rows(spec: RobotSpec, catalog: Catalog) -> NDArray[np.int64]:
    """Rows of the screws of the required kind, maker and size."""
    load, table = spec.load, catalog.screws
    assert isinstance(load, Screw)
    assert load.screw is not None
    good = np.isin(table["kind"], _KINDS[load.kind]) & ~table.excluded & (table["lead"] > 0.0)
    for rows in _conditions(load.screw, table):
        good &= rows
    found = np.flatnonzero(good)
    if not len(found):
        listed = len(np.flatnonzero(np.isin(table["kind"], _KINDS[load.kind]) & ~table.excluded))
        there = f"{listed} of that kind" if listed else "none: select.catalogs needs some that do, e.g. thk, or all"
        raise InputError(
            f"{spec.where(('load', 'screw'))}: no such screw in the catalogues that the spec names; they list {there}"
        )
    return found


def _conditions(choice: ScrewChoice, table: Table[Any]) -> Iterator[NDArray[np.bool_]]:
    """Masks of the screws that meet each part of a choice."""
    for name, column in (("maker", "manufacturer"), ("family", "family"), ("part", "part")):
        wanted = getattr(choice, name)
        if wanted is not None:
            texts = np.char.lower(table[column])
            yield np.array([any(fnmatch.fnmatchcase(str(t), w.lower()) for w in wanted) for t in texts], bool)
    for name in ("diameter", "lead"):
        yield table[name] >= (getattr(choice, f"{name}_min") or 0.0) * (1.0 - 1e-9)
        most = getattr(choice, f"{name}_max")
        yield table[name] <= (inf if most is None else most) * (1.0 + 1e-9)
    if choice.play_max is not None:
        yield table["axial_play"] <= choice.play_max


# --- the best of them -------------------------------------------------------------------------------------------------


def _order(able: Sequence[_Tried], weights: Mapping[str, float]) -> tuple[NDArray[np.float64], ...]:
    """Columns that order leads, the first one first.

    Status of their best drives, objectives of which the screw's share is unknown, the objective, the screw's size.
    """
    best: list[Any] = [one.best for one in able]
    sure = np.array([float(_SURE.index(one.status)) for one in best])
    value = np.zeros(len(able))
    for name, weight in weights.items():
        value += weight * _shares(np.array([_figure(one, name) for one in able]), name)
    size = np.array([one.chosen.least_mass for one in able])
    unknown = np.array([float(sum(isnan(_screw_share(one, name)) for name in weights)) for one in able])
    return sure, unknown, value, size


def _figure(one: _Tried, name: str) -> float:
    """An objective of the best drive, of mass and price with the screw's as far as that is known."""
    assert one.best is not None
    own = _screw_share(one, name)
    return objective_figure(one.best, name).value + (0.0 if isnan(own) else own)


def _screw_share(one: _Tried, name: str) -> float:
    """Share of the screw in an objective; NaN unknown."""
    return {"mass": one.chosen.least_mass, "price": one.chosen.screw.price}.get(name, 0.0)


def _shares(values: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Figures as shares of the best of them, less is better; unknown ones behind all others."""
    if OBJECTIVES[name].more_is_better:
        values = 1.0 / np.maximum(1.0 + values, 1e-9)
    least = np.nanmin(values, initial=inf)
    return np.nan_to_num(values / least if 0.0 < least < inf else values, nan=1e9)


def _nearness(one: Problem) -> float:
    """The smallest margin of the closest rejected drive."""
    found = search(one, top=1, misses=1)
    return float(smallest_margin(found.evaluation.checks)[0]) if len(found.evaluation.candidates.motor) else -inf


def _reasons(held: Sequence[_ScrewOfLead]) -> str:
    """Leads without a screw that holds, by the limit that most of its screws fail."""
    leads: dict[str, list[str]] = {}
    for one in held:
        if one.screw is None:
            leads.setdefault(one.failed, []).append(f"{one.lead * 1e3:.4g}")
    return "; ".join(f"{', '.join(several)} mm ({reason})" for reason, several in leads.items())


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
        return made(evaluation, row, rank, **known)


def shortlist(
    spec: RobotSpec,
    catalog: Catalog,
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
    _known_to(spec, {*spec.select.weights, *pareto})
    made = {} if made is None or depends_on_ranking(spec) else made
    if "problem" not in made:
        made["problem"] = problem_with_drive_mass(spec, catalog)
    problem, weighed = made["problem"]
    problem = problem.ranked_by(spec.select.objective)
    sampling = sampling or sampling_of(spec)
    pool = POOL if sampling and sampling.confidence is not None else 0
    machine = machine_requirements(problem.machine)
    weigh = weighing(problem, machine, brief=checks_alone)
    judge = machine_filter(problem, machine, weigh, counted=not checks_alone)
    found = search(
        problem, top=max(top, pool), misses=misses, pareto=pareto, progress=progress, judge=judge,
        others=0 if pool else others, margins=choices > 0,
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
        found=found,
        weigh=weigh,
        best=best,
        top=top,
        unsure=unsure,
        reliability=_reliability(sampled, [*best, *unsure], finalists),
        uncertainty=_uncertainty(sampled),
        weighed=weighed,
        others=_family_alternatives(found, best)[:others] if pool else list(found.others),
        choices=_choices(problem, found, 0 if pool else choices, judge, weigh),
        checks_alone=checks_alone,
    )


def _choices(problem: Problem, found: SearchResult, most: int, judge: Judge | None, weigh: Weigh) -> Choices | None:
    """Drives to choose from by weights, where any are wanted."""
    if not most:
        return None
    from drivesizer.search.choices import choices  # only a report needs them

    return choices(problem, found, most, judge=judge, weigh=weigh)


def _family_alternatives(found: SearchResult, best: list[int]) -> list[int]:
    """The best of each other motor family among drives that reach the required probability."""
    family = family_of(found.evaluation.catalog, found.evaluation.candidates.motor[best])
    return [best[n] for n in family_firsts(family)[1:]]


def _sampled(found: SearchResult, rows: Sequence[int], how: Sampling, brief: bool) -> SampledDrives:
    """Some drives over samples, with their checks by physics whatever the method."""
    from drivesizer.search.uncertainty.probabilities import (  # where nothing is sampled it need not load
        sample_drives,
        subject,
    )

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
    from drivesizer.search.uncertainty.probabilities import reliabilities

    return reliabilities(sampled, rows, finalists)


def _uncertainty(sampled: SampledDrives | None) -> Uncertainty | None:
    """Assumptions and samples, which all drives have in common."""
    if sampled is None:
        return None
    from drivesizer.search.uncertainty.probabilities import uncertainty

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
                    where = spec.where(("select", section, "maker" if key == "manufacturer" else key))
                    hint = "; expected transmission: [{kind: direct}]" if name == DIRECT else nearest(name, known)
                    raise InputError(f"{where}: {quoted(name)} is in no catalogue that the spec names{hint}")
    bus, buses = spec.select.controller.bus, offered_buses(catalog.controllers)
    if bus and not any(offers(b, bus) for b in buses):
        where = spec.where(("select", "controller", "bus"))
        raise InputError(
            f"{where}: no controller has the bus {quoted(bus)}; expected one of {', '.join(sorted(buses))}"
        )
