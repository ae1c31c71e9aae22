"""Drives in full: every check by the spec's method, with estimated figures at both ends of their bands."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog, Table, columns_of
from drivesizer.physics.figures import Array, Mask, Whole, joined, on
from drivesizer.results.check import Check, Status
from drivesizer.results.check_columns import CheckColumn, at_most, fits, over_ends, together
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import Requirement
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns import paper as paper_rule
from drivesizer.search.columns.brakes import counts_check, encoders_for, offered_brakes, offered_encoders
from drivesizer.search.columns.candidates import FREE, Candidates, Rows
from drivesizer.search.columns.controllers import Required, controllers, usable_controllers
from drivesizer.search.columns.limits_over_time import Waveform
from drivesizer.search.columns.paper import motor_requirements, vehicle
from drivesizer.search.columns.stages import Drives, amount_of, examine
from drivesizer.spec.robot import RobotSpec

# sizes and masses: whether a drive moves its load does not hang on them
_NEEDED = {"length": "length", "mass": "mass", "diameter": "diameter", "backlash": "backlash_at_load"}


def at_ends(problem: Problem) -> tuple[Problem, Problem]:
    """The problem with estimated figures at the favourable and at the unfavourable end of their bands.

    But for masses of encoders and controllers: the lightest is the same one at both.
    """
    middle = problem.catalog

    def ends() -> tuple[Catalog, ...]:
        names = ("encoders", "controllers")
        return tuple(end.with_tables({name: weighed(end, name) for name in names}, {}) for end in middle.ends)

    def weighed(end: Catalog, name: str) -> Table[Any]:
        table = end.table(name)
        return table.changed({"mass": middle.table(name)["mass"]})

    favourable, unfavourable = middle.once("both ends", ends)
    return (
        replace(problem, catalog=favourable, opposite=unfavourable),
        replace(problem, catalog=unfavourable, opposite=favourable),
    )


def estimated(problem: Problem, candidates: Candidates, method: str = "physics") -> Whole:
    """Candidates with an estimated figure that a check may hang on."""
    if not problem.catalog.ends:
        return np.zeros(0, np.int64)
    motors, gearheads = (_differ(problem.catalog, name, problem.spec, method) for name in ("motors", "gearheads"))
    mask: Mask = motors[candidates.motor] | gearheads[candidates.gearhead]
    if method == "physics" and (offered := offered_brakes(problem.spec, problem.catalog)) is not None:
        brakes: Mask = np.append(_differ(problem.catalog, "brakes", problem.spec, method), False)
        uncertain: Mask = np.any(brakes[offered.row], axis=1)
        mask |= uncertain[candidates.motor]
    return np.flatnonzero(mask)


def _differ(catalog: Catalog, section: str, spec: RobotSpec, method: str) -> Mask:
    """Parts of which a figure that counts is not the same at both ends."""
    left = frozenset(name for name, need in _NEEDED.items() if not getattr(spec.needs, need))

    def differ() -> Mask:
        low, high = (end.table(section) for end in catalog.ends)
        mask = np.zeros(len(low), bool)
        counted = {name for check in CHECKS["paper"].values() for name in check.rests_on}
        for name, column in columns_of(section).items():
            counts = name not in left and (method == "physics" or f"{section[:-1]}.{name}" in counted)
            if column.kind != "text" and counts:
                mask |= (low[name] != high[name]) & ~np.isnan(low[name])
        return mask

    return catalog.once(("differ", section, left, method), differ)


# -- Drives in full: every check by the spec's method, with the numbers that a record shows.


class Evaluation(NamedTuple):
    """Everything that was computed over the candidates."""

    problem: Problem
    candidates: Candidates
    checks: list[CheckColumn]
    encoder: Whole
    controller: Whole
    brake: Whole  # -1 none
    figures: Mapping[str, Array]  # what objectives count beside the catalogue's figures, SI

    @property
    def spec(self) -> RobotSpec:
        """The machine in its first load case."""
        return self.problem.spec

    @property
    def catalog(self) -> Catalog:
        """The parts."""
        return self.problem.catalog

    @property
    def failed(self) -> Mask:
        """Mask of the candidates that fail a check that is not mere advice."""
        return np.logical_or.reduce([check.failed for check in self.checks if not check.advice])

    @property
    def unknown(self) -> Mask:
        """Mask of the candidates that have an unknown check, and fail none."""
        known = [c.passed | c.opened for c in self.checks if not c.advice]
        all_known: Mask = np.logical_and.reduce(known)
        return ~self.failed & ~all_known

    def on(self, rows: Whole) -> Evaluation:
        """Of some of the candidates."""
        return Evaluation(self.problem, *on(self[1:], rows))

    def with_parts(self, rows: Whole | slice = slice(None)) -> Candidates:
        """Some of the candidates, each with the parts that were chosen for it."""
        parts = {name: getattr(self, name)[rows] for name in ("controller", "brake", "encoder")}
        return self.candidates.on(rows)._replace(**parts)

    def fails(self, index: int) -> bool:
        """Whether one candidate fails a check that is not mere advice."""
        return any(check.failed[index] for check in self.checks if not check.advice)

    def status(self, index: int) -> Status:
        """Outcome of the checks of one candidate."""
        if self.fails(index):
            return "fail"
        opened = self.open_checks(index)
        if not all(check.passed[index] or check.advice or check.name in opened for check in self.checks):
            return "unknown"
        return "open" if opened else "pass"

    def open_checks(self, index: int) -> set[str]:
        """Names of the checks of one candidate that are open; informational ones do not count."""
        columns = [check for check in self.checks if not (check.advice or check.opened is False)]
        return {check.name for check in columns if np.broadcast_to(check.opened, check.passed.shape)[index]}

    def sampled_checks(self, index: int) -> set[str]:
        """Those of them that are open by estimated figures, and not by a range that nobody knows more of."""
        sampled = {c.name for c in self.checks if c.least is not None and not np.isnan(c.least[index])}
        return self.open_checks(index) & sampled

    def requirements(self, index: int) -> tuple[list[Requirement], list[Requirement]]:
        """Requirements (1)-(16) of the load and (17)-(20) of the parts of one candidate; none by physics."""
        if self.spec.method == "physics":
            return [], []
        drive = self.candidates.on(np.array([index]))
        motor, gearhead = Rows(self.catalog.motors, drive.motor), Rows(self.catalog.gearheads, drive.gearhead)
        wheel = vehicle(self.spec, motor["rotor_inertia"]).steps
        shaft = motor_requirements(self.spec, wheel, motor, gearhead, drive.belt).steps
        return [step.on(0) for step in wheel.values()], [step.on(0) for step in shaft.values()]

    def checks_of(self, index: int) -> tuple[Check, ...]:
        """The checks of one candidate, but for those that have no limit to it."""
        return tuple(self._at(check, index) for check in self.checks if check.limit[index] != np.inf)

    def tightest_of(self, index: int) -> tuple[Check, ...]:
        """Of the checks of one candidate the one with the smallest margin; empty where no margin hangs on the load."""
        known = [(float((c if c.least is None else c._replace(least=None)).tightness[index]), c) for c in self.checks]
        tightest, check = min(known, key=lambda pair: pair[0], default=(np.inf, None))
        return () if check is None or tightest == np.inf else (self._at(check, index),)

    def _at(self, check: CheckColumn, index: int) -> Check:
        return check.at(index, self.spec.method, cases=tuple(case.name for case in self.problem.cases))


def evaluate(problem: Problem, candidates: Candidates, *, rejected: bool = True) -> Evaluation:
    """Every candidate's checks by the spec's method; by the paper's, with its requirements."""
    if problem.spec.method == "physics":
        return by_physics(problem, candidates)
    few = len(candidates.motor) <= paper_rule.FEW
    if rejected or few or len(estimated(problem, candidates, "paper")):  # at one end of a band one may pass
        return _over_bands(_by_the_paper, problem, candidates, "paper")
    columns = candidates.motor, candidates.gearhead, candidates.belt
    left = np.flatnonzero(~paper_rule.hopeless(problem.spec, problem.catalog, *columns))
    return _by_the_paper(problem, candidates.on(left), rejected=False)


def _by_the_paper(problem: Problem, candidates: Candidates, rejected: bool = True) -> Evaluation:
    """The rule of section 3.1.3 for motor and gearhead, and the controller by the torques of (17) and (18)."""
    spec, catalog, none = problem.spec, problem.catalog, np.full(len(candidates.motor), -1)
    motor, gearhead = Rows(catalog.motors, candidates.motor), Rows(catalog.gearheads, candidates.gearhead)
    wheel = vehicle(spec, motor["rotor_inertia"]).steps
    shaft = motor_requirements(spec, wheel, motor, gearhead, candidates.belt).steps
    checks = paper_rule.rule(spec, wheel, shaft, motor, gearhead, candidates.belt)
    gear = [check for check in checks if check.name.startswith("gearhead")]
    total = gearhead["ratio"] * candidates.belt
    checks.append(paper_rule.largest_allowed(catalog, candidates.motor, candidates.gearhead, total, gear))
    listed = fits("compatibility", True, candidates.listed)
    torques = shaft["rms_torque_at_motor"].value, paper_rule.largest_torque_at_motor(shaft)
    currents = [torque / motor["torque_constant"] + motor["no_load_current"] for torque in torques]
    evaluation = Evaluation(problem, candidates, [listed, *checks], none, none, none, {})
    if not rejected:
        left = np.flatnonzero(~evaluation.failed)
        evaluation, currents = on((evaluation, currents), left)
    sets, (rms, peak) = evaluation.candidates, currents
    controller, _ = controllers(spec, catalog, sets.motor, Required(rms, peak))
    usable, of_controller = usable_controllers(spec, catalog), Rows(catalog.controllers, controller)
    total = catalog.gearheads["ratio"].take(sets.gearhead) * sets.belt
    speed = wheel["nominal_speed"].value * total  # of (1), as the paper's other limits of speed take it
    encoder, _ = encoders_for(spec, offered_encoders(spec, catalog), sets.motor, speed, total)
    checks = [
        *evaluation.checks,
        usable.available(sets.motor, controller),
        at_most("controller_continuous_current", rms, controller_current(of_controller, usable.ambient)),
        at_most("controller_peak_current", peak, of_controller["peak_current"]),
        *counts_check(spec, catalog, encoder),
    ]
    return evaluation._replace(checks=checks, controller=controller, encoder=encoder)


def by_physics(problem: Problem, candidates: Candidates, waveform: Waveform = "all") -> Evaluation:
    """Every limit against the whole load cycle, whatever the spec's method."""
    return _over_bands(lambda at, sets: at_figures(at, sets, waveform), problem, candidates, "physics")


def _over_bands(
    at: Callable[[Problem, Candidates], Evaluation], problem: Problem, candidates: Candidates, method: str
) -> Evaluation:
    """Candidates at the middle of the bands of their estimated figures; each check holds what it is at both ends.

    Its parts are those of the unfavourable end: one drive is judged, not three.
    """
    rows = estimated(problem, candidates, method)
    if not len(rows):
        return at(problem, candidates)
    sets, (favourable, unfavourable) = candidates.on(rows), at_ends(problem)
    hard = at(unfavourable, sets)
    easy = at(favourable, hard.with_parts())
    if (easy.failed | easy.unknown).any():
        hard, easy = _with_others(at, (unfavourable, hard), (favourable, easy), sets)
    middle = at(problem, _with_parts(candidates, rows, hard))
    ends = {e.name: (e, h) for e, h in zip(easy.checks, hard.checks, strict=True)}  # some checks no drive of these has
    checks = [over_ends(m, ends[m.name], rows) if m.name in ends else m for m in middle.checks]
    return middle._replace(candidates=candidates, checks=checks)


def _with_others(
    at: Callable[[Problem, Candidates], Evaluation],
    hard: tuple[Problem, Evaluation],
    easy: tuple[Problem, Evaluation],
    sets: Candidates,
) -> tuple[Evaluation, Evaluation]:
    """Both ends of a band, with the controller of the favourable one of candidates of which less then is undecided."""
    free = at(easy[0], hard[1].with_parts()._replace(controller=np.full(len(sets.motor), FREE)))
    if (free.controller == hard[1].controller).all():
        return hard[1], easy[1]
    drives = free.with_parts()
    other = at(hard[0], drives)
    better = _undecided(other) + _undecided(free) < _undecided(hard[1]) + _undecided(easy[1])
    drives = drives._replace(controller=np.where(better, free.controller, hard[1].controller))
    return at(hard[0], drives), at(easy[0], drives)


def _undecided(evaluation: Evaluation) -> Whole:
    """Number of checks that do not pass; what fails counts more than all that are unknown."""
    checks = [check for check in evaluation.checks if not check.advice]
    return np.sum([~check.passed for check in checks], axis=0) + len(checks) * evaluation.failed


def _with_parts(candidates: Candidates, rows: Whole, drives: Evaluation | Drives) -> Candidates:
    """Candidates, of which some rows have the parts that were chosen for them."""
    parts = np.full((3, len(candidates.motor)), FREE)
    parts[:, rows] = drives.controller, drives.brake, drives.encoder
    return candidates._replace(controller=parts[0], brake=parts[1], encoder=parts[2])


def figures_by_physics(problem: Problem, candidates: Candidates, waveform: Waveform = "all") -> Mapping[str, Array]:
    """The figures of :func:`by_physics` alone, which take no checks at the favourable end of a band."""
    rows = estimated(problem, candidates)
    if len(rows):
        _, hard = _in_order_of_belts(at_ends(problem)[1], candidates.on(rows), waveform)
        candidates = _with_parts(candidates, rows, hard)
    return _in_order_of_belts(problem, candidates, waveform)[1].figures


def at_figures(
    problem: Problem, candidates: Candidates, waveform: Waveform, exact_checks: Collection[str] = ()
) -> Evaluation:
    """Every limit at the figures of the problem's catalogue, as they are."""
    checks, drives = _in_order_of_belts(problem, candidates, waveform, exact_checks)
    order = list(CHECKS["physics"])  # in which people read them
    checks.sort(key=lambda check: order.index(check.name))
    columns = drives.encoder, drives.controller, drives.brake, drives.figures
    return Evaluation(problem, candidates, checks, *columns)


def _in_order_of_belts(
    problem: Problem, candidates: Candidates, waveform: Waveform, exact_checks: Collection[str] = ()
) -> tuple[list[CheckColumn], Drives]:
    """Checks of candidates, which are examined belt by belt, and their parts and figures as columns."""
    order = np.argsort(candidates.belt, kind="stable")
    examined = list(examine(problem, candidates.on(order), waveform=waveform, exact_checks=exact_checks))
    if not examined:
        none = np.zeros(0, np.int64)
        return [], Drives(none, amount_of((), 0), none, none, none, {})
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    checks = together([(order[batch.drives.rows], batch.checks) for batch in examined], len(order))
    drives = joined([batch.drives for batch in examined])
    return checks, on(drives, np.argsort(drives.rows)[place])


def smallest_margin(checks: list[CheckColumn]) -> Array:
    """The smallest margin of each candidate that is known; what passes by selection is left out."""
    return np.minimum.reduce([check.tightness for check in checks]) if checks else np.zeros(0)
