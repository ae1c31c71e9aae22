"""Candidates with the best controller that does in all load cases, against what is electrical and temperature.

What a controller must give depends on how warm the winding is, and on the controller: for how long the current is
above its own, what it loses, what its capacitance takes. So all controllers of a candidate are ordered by what moments
and extremes say of them at least, and computed in that order until none that is left could be better.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.winding import Heat, Parts, Stress, on, put, replaced, stress
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import line_frequency
from drivesizer.search.columns.candidates import FREE, Rows
from drivesizer.search.columns.controllers import (
    HANGING,
    LOST,
    ChosenPart,
    Ranks,
    Required,
    controllers,
)
from drivesizer.search.columns.limits import electrical_limits, electrical_speed
from drivesizer.search.columns.limits_over_time import (
    Exactly,
    Moments,
    Pair,
    bounds,
    decided,
    exact,
    least,
    left_open,
    lowest,
    waveform_limits,
)
from drivesizer.search.columns.offers import Offers, unknown_where_doubtful, worst_of_all
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec

Array = NDArray[np.float64]
UNDECIDED = "undecided"  # figure of a candidate: above 0 where bounds leave open whether the waveform meets its limits


class Moving(NamedTuple):
    """The columns of one load case."""

    demand: Demands
    heating: Heat


class Powered(NamedTuple):
    """Candidates with their controllers."""

    controller: NDArray[np.int64]  # row of each
    checks: list[CheckColumn]
    figures: dict[str, Array]

    def on(self, rows: slice) -> Powered:
        """Of some of the candidates."""
        figures = {name: column[rows] for name, column in self.figures.items()}
        return Powered(self.controller[rows], [check.on(rows) for check in self.checks], figures)


def powered(
    problem: Problem,
    offered: Offers,
    cycles: Sequence[AtGearhead],
    cases: Sequence[Moving],
    parts: Parts,
    *,
    exactly: Exactly,
    each: Collection[str] = (),
) -> Powered:
    """Controllers, and every check that hangs on current, voltage and heat."""
    ambients = [case.spec.environment.ambient for case in problem.cases]
    stresses = [
        stress(ambient, cycle, c.demand, parts.motor) for ambient, cycle, c in zip(ambients, cycles, cases, strict=True)
    ]
    case = _Cases(problem, offered, cycles, cases, stresses, parts, exactly, each)
    first = case.controllers()
    free = np.ones(len(first.row), bool) if parts.controller is None else parts.controller.rows == FREE
    row = first.row if parts.controller is None else np.where(free, first.row, parts.controller.rows)
    if len(offered.controllers.order):
        row = case.with_least(row, first.ranks, free)
    found = case.judged(row)
    if len(offered.controllers.order):
        row, found = _best_of_all(case, first.ranks, row, found, free & ~(case.undecided(row, found) > 0.0))
    figures = _figures(problem, [low.agreed(high) for low, high in found.pairs], case.stresses)
    available = offered.controllers.available(parts.motor.rows, row)
    figures = _where_known(figures, cases) | {UNDECIDED: case.undecided(row, found)}
    return Powered(row, [available, *found.checks], figures)


_OF_CONTROLLER = (
    "controller_continuous_current", "controller_peak_current", "controller_speed", "encoder_frequency", *HANGING,
)  # fmt: skip


class _Found(NamedTuple):
    """Checks and bounds of candidates with some controllers."""

    checks: list[CheckColumn]
    pairs: list[Pair]  # of each load case

    def on(self, rows: NDArray[Any]) -> _Found:
        """Of some of the candidates."""
        return _Found([check.on(rows) for check in self.checks], [(on(a, rows), on(b, rows)) for a, b in self.pairs])

    def replaced(self, rows: NDArray[np.int64], new: _Found, of: NDArray[np.int64]) -> _Found:
        """With some of the candidates found anew; ``of`` says which of the new ones these are."""

        def both(old: Pair, some: Pair) -> Pair:
            low, high = (replaced(a, rows, on(b, of)) for a, b in zip(old, some, strict=True))
            return low, high

        return _Found(
            [check.with_rows(rows, other.on(of)) for check, other in zip(self.checks, new.checks, strict=True)],
            [both(*pair) for pair in zip(self.pairs, new.pairs, strict=True)],
        )

    def failed(self, names: Collection[str] | None = None) -> NDArray[np.bool_]:
        """Whether a check fails; of those that no controller changes, or of all."""
        some = [c.failed for c in self.checks if not c.advice and (names is None or c.name not in names)]
        found: NDArray[np.bool_] = np.logical_or.reduce(some)
        return found

    def margin(self, of_controller: bool) -> Array:
        """The smallest margin of the checks that hang on the controller, or of the others."""
        some = [c.tightness for c in self.checks if (c.name in _OF_CONTROLLER) == of_controller]
        found: Array = np.minimum.reduce(some)
        return found


class _Cases(NamedTuple):
    """The load cases and their candidates."""

    problem: Problem
    offered: Offers
    cycles: Sequence[AtGearhead]
    moving: Sequence[Moving]
    stresses: Sequence[Stress]
    parts: Parts
    exactly: Exactly
    each: Collection[str]

    @property
    def by_bounds(self) -> bool:
        """Whether nothing is computed from the waveform."""
        return isinstance(self.exactly, str) and self.exactly == "bounds"

    @property
    def complete(self) -> NDArray[np.bool_]:
        """Whether all that is demanded of each candidate is known."""
        return np.asarray(np.logical_and.reduce([c.demand.complete for c in self.moving]), bool)

    def some(self, rows: NDArray[np.int64]) -> _Cases:
        """Some of the candidates."""
        moving, stresses = [on(case, rows) for case in self.moving], [on(u, rows) for u in self.stresses]
        cycles = [cycle.on(rows) for cycle in self.cycles]
        exactly = self.exactly[rows] if isinstance(self.exactly, np.ndarray) else self.exactly
        return self._replace(
            cycles=cycles, moving=moving, stresses=stresses, parts=self.parts.on(rows), exactly=exactly
        )

    def controllers(self) -> ChosenPart:
        """The best that suffices in the worst of all cases, as far as that is known before its own limits are."""
        spec, motor, moving = self.problem.spec, self.parts.motor, self.moving
        lines = np.maximum.reduce([line_frequency(c.demand, self.parts.encoder) for c in moving])
        required = Required(
            np.maximum.reduce([c.demand.rms_current for c in moving]),
            np.maximum.reduce([u.current.value for u in self.stresses]),
            np.maximum.reduce([u.cold_voltage.value for u in self.stresses]),
            np.maximum.reduce([electrical_speed(c.demand, motor) for c in moving]),
            lines if spec.wants_encoder else None,
            max(controller_needed(case.spec, spec.margins.torque) for case in self.problem.cases),
            spec.margins.torque,
            spec.margins.speed,
        )
        return controllers(spec, self.problem.catalog, motor.rows, required, self.offered.controllers)

    def with_least(self, row: NDArray[np.int64], ranks: Ranks, free: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Controllers that are the best by lower bounds over the waveform; what has one that meets these keeps it."""
        parts = self.parts._replace(controller=Rows(self.problem.catalog.controllers, row))
        unmet = np.zeros(len(row), bool)
        if ranks.weight:
            unmet[:] = True
        else:
            for number in range(len(self.cycles)):
                unmet |= ~np.logical_and.reduce([c.passed for c in self._hanging(number, parts)])
        rows = np.flatnonzero(unmet & free & (row >= 0) & self.complete)
        if not len(rows):
            return row
        few = self.some(rows)
        ranks = few.ranks(ranks.on(rows))
        unknown, _, _, place = ranks.best()
        taken = np.flatnonzero(unknown < LOST)  # where each fails the first one says on what
        return put(row, rows[taken], self.offered.controllers.order[place[taken].astype(np.int64)])

    def _hanging(self, number: int, parts: Parts, low: Moments | None = None) -> list[CheckColumn]:
        """Limits of one load case that hang on controller and cycle, by lower bounds."""
        spec = self.problem.cases[number].spec
        if low is None:
            low = lowest(spec, self.cycles[number], *self.moving[number], self.stresses[number], parts)
        return [check for check in waveform_limits(spec, low, low, parts) if check.name in HANGING]

    def ranks(self, ranks: Ranks, row: NDArray[np.int64] | None = None, found: _Found | None = None) -> Ranks:
        """Ranks of all controllers by lower bounds over the waveform, and by what was computed with one of them."""
        usable, table = self.offered.controllers, self.problem.catalog.controllers
        parts = self.parts._replace(controller=Rows(table, usable.order[:, None]))
        passed: dict[str, NDArray[np.bool_]] = {}
        lacking, margin = ranks.lacking.copy(), ranks.margin
        for number, case in enumerate(self.problem.cases):
            low = lowest(case.spec, self.cycles[number], *self.moving[number], self.stresses[number], parts)
            if found is not None and row is not None:
                low = self._at_least(case.spec, low, found.pairs[number][0], parts, row)
            for check in self._hanging(number, parts, low):
                lacking[np.broadcast_to(check.failed, lacking.shape)] = LOST
                passed[check.name] = passed.get(check.name, np.True_) & check.passed
                if ranks.weight:
                    margin = np.minimum(margin, check.tightness)
        hanging = np.zeros(lacking.shape, np.int8)
        for one in passed.values():
            hanging += ~one
        return ranks._replace(lacking=lacking, hanging=hanging, margin=margin)

    def _at_least(
        self, spec: RobotSpec, low: Moments, computed: Moments, parts: Parts, row: NDArray[np.int64]
    ) -> Moments:
        """Lower bounds by what was computed with one controller: what loses more draws no less, and returns no more."""
        if not spec.resists:
            low = low._replace(voltage=np.fmax(low.voltage, computed.voltage))
        tried, stage = spec.feed(Rows(self.problem.catalog.controllers, row)).stage, spec.feed(parts.controller).stage
        stored = np.where(stage.least_loss <= tried.least_loss, np.fmax(low.stored, computed.stored), low.stored)
        loses_more = (stage.loss >= tried.loss) & (stage.standby >= tried.standby)
        return low._replace(stored=stored, power=np.where(loses_more, np.fmax(low.power, computed.power), low.power))

    def beyond_supply(self, found: _Found) -> NDArray[np.bool_]:
        """Candidates whose motor takes more voltage than the supply has, with any controller."""
        more, cases = 1.0 + self.problem.spec.margins.speed, zip(self.problem.cases, found.pairs, strict=True)
        beyond = [more * low.voltage > case.spec.supply.lowest for case, (low, _) in cases]
        return np.asarray(np.logical_or.reduce(beyond), bool)

    def judged(self, row: NDArray[np.int64]) -> _Found:
        """The electrical limits with some controllers, and those of the waveform by bounds or exactly."""
        specs = [case.spec for case in self.problem.cases]
        complete = [case.demand.complete for case in self.moving]
        stresses = [self._stress(k, row) for k in range(len(specs))]
        parts = self.parts._replace(controller=Rows(self.problem.catalog.controllers, row))

        def electrical(k: int) -> list[CheckColumn]:
            checks = electrical_limits(specs[k], self.cycles[k], self.moving[k].demand, stresses[k], parts)
            return unknown_where_doubtful(checks, complete[k])

        first = worst_of_all(self.problem, electrical)
        dead: NDArray[np.bool_] = np.logical_or.reduce([check.failed for check in first if not check.advice])
        pairs = [
            least(self._pair(k, parts, stresses[k], dead), *self.moving[k], stresses[k]) for k in range(len(specs))
        ]
        limits = [waveform_limits(spec, *pair, parts) for spec, pair in zip(specs, pairs, strict=True)]
        last = worst_of_all(self.problem, lambda k: unknown_where_doubtful(limits[k], complete[k]))
        return _Found([*first, *last], pairs)

    def undecided(self, row: NDArray[np.int64], found: _Found) -> Array:
        """1 of candidates that fail nothing by bounds, which are all that is wanted, and that the waveform may fail.

        2 of those of which a check is unknown whatever the waveform says.
        """
        if not self.by_bounds:
            return np.zeros(len(row))
        parts = self.parts._replace(controller=Rows(self.problem.catalog.controllers, row))
        left, lacks = np.zeros(len(row), bool), np.zeros(len(row), bool)
        for case, (low, high), moving in zip(self.problem.cases, found.pairs, self.moving, strict=True):
            left |= left_open(case.spec, (low, high), parts) & moving.demand.complete
            for check in waveform_limits(case.spec, low, low, parts):
                lacks |= ~(check.passed | check.failed)
        return np.where(left & ~found.failed(), 1.0 + lacks, 0.0)

    def _stress(self, k: int, row: NDArray[np.int64]) -> Stress:
        """The stress of one load case, with what resistances before the winding take of the voltage."""
        spec = self.problem.cases[k].spec
        if not spec.resists:
            return self.stresses[k]
        leads = spec.feed(Rows(self.problem.catalog.controllers, row)).leads
        return stress(spec.environment.ambient, self.cycles[k], self.moving[k].demand, self.parts.motor, leads)

    def _pair(self, k: int, parts: Parts, stresses: Stress, dead: NDArray[np.bool_]) -> Pair:
        """Peaks and heat over the waveform of one load case."""
        args = (self.problem.cases[k].spec, self.cycles[k], *self.moving[k], stresses, parts)
        if isinstance(self.exactly, np.ndarray):
            return self._in_part(k, parts, stresses, dead)
        if self.exactly == "bounds":
            return bounds(*args)
        if self.exactly:
            return exact(*args, "all" if self.exactly is True else self.exactly)
        return decided(*args, ~dead, self.each)

    def _in_part(self, k: int, parts: Parts, stresses: Stress, dead: NDArray[np.bool_]) -> Pair:
        """The same, computed from the waveform of some candidates and by bounds of the others."""
        columns = tuple(np.empty((2, len(Moments._fields), len(dead))))
        for side in (True, False):
            rows = np.flatnonzero(self.exactly == side)
            if len(rows):
                some = self.some(rows)._replace(exactly=side)
                pair = some._pair(k, parts.on(rows), on(stresses, rows), dead[rows])
                for whole, moments in zip(columns, pair, strict=True):
                    whole[:, rows] = moments
        return Moments(*columns[0]), Moments(*columns[1])


def _best_of_all(
    case: _Cases, ranks: Ranks, row: NDArray[np.int64], found: _Found, free: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], _Found]:
    """Candidates with the best of all controllers, as computed from the waveform.

    They are tried in the order of what bounds say of them at least, until none that is left could be better. Where all
    that are listed fail others may exist: none.
    """
    usable = case.offered.controllers
    unmet = ~np.logical_and.reduce([c.passed for c in found.checks if c.name in HANGING])
    if ranks.weight:
        unmet |= found.margin(True) < found.margin(False)
    wanting = unmet & free & (row >= 0) & ~found.failed(HANGING) & ~case.beyond_supply(found)
    rows = np.flatnonzero(wanting & (case.complete | found.failed()))
    if not len(rows):
        return row, found
    case, ranks, new, one = case.some(rows), ranks.on(rows), found.on(rows), row[rows]
    tried, best = np.zeros((len(usable.order), len(rows)), bool), np.full((4, len(rows)), np.inf)
    while True:
        others = new.margin(False) if ranks.weight else np.inf
        reached = _reached(case, ranks, one, new, others)
        taken = np.flatnonzero(_before(reached, best))
        best[:, taken] = reached[:, taken]
        row, found = put(row, rows[taken], one[taken]), found.replaced(rows[taken], new, taken)
        tried |= usable.order[:, None] == one
        ranks = case.ranks(ranks, one, new)
        then, fails = ranks.best(others, tried), np.isinf(best[0])
        lost = then[0] == LOST
        none = lost & fails & usable.partial[case.parts.motor.rows]
        going = none | (~lost & _before(then, best) & (case.complete | fails))
        left = np.flatnonzero(going & (one >= 0) & ~new.failed(HANGING))
        if not len(left):
            return row, found
        one = np.where(none, -1, usable.order[then[3].astype(np.int64)])[left]
        case, rows, ranks, tried, best = (
            case.some(left),
            rows[left],
            ranks.on(left),
            tried[:, left],
            best[:, left],
        )
        new = case.judged(one)


def _before(one: Array, other: Array) -> NDArray[np.bool_]:
    """Whether some columns go before others, by the first row in which they differ."""
    found = np.zeros(one.shape[1], bool)
    for a, b in zip(one[::-1], other[::-1], strict=True):
        found = (a < b) | ((a == b) & found)
    return found


def _reached(case: _Cases, ranks: Ranks, row: NDArray[np.int64], found: _Found, others: Array | float) -> Array:
    """Columns as ``Ranks.best`` gives them, as computed with a controller each; infinite where a check fails."""
    usable, every = case.offered.controllers, np.arange(len(row))
    some = [c for c in found.checks if c.name in _OF_CONTROLLER and not c.advice]
    unknown = np.sum([~(c.passed | c.failed) for c in some], axis=0) + (usable.unclear[row] | (row < 0))
    unknown = np.where(case.undecided(row, found) > 0.0, 0, unknown)  # by bounds it may pass
    place = np.zeros(len(case.problem.catalog.controllers) + 1, np.int64)
    place[usable.order] = np.arange(len(usable.order))
    place = place[row]
    share = ranks.share[place, 0 if ranks.share.shape[1] == 1 else every]
    if ranks.weight:
        share = share + ranks.weight / (1.0 + np.maximum(np.minimum(found.margin(True), others), -0.999))
    unprinted = ranks.unprinted[place, 0 if ranks.unprinted.shape[1] == 1 else every]
    return np.where(found.failed(), np.inf, np.array([unknown, np.round(share, 9), unprinted, place], float))


def _where_known(figures: dict[str, Array], cases: Sequence[Moving]) -> dict[str, Array]:
    """The figures of drives whose current is known in every case: a lower bound may fail a check, but is no figure."""
    complete = np.logical_and.reduce([case.demand.complete for case in cases])
    return {name: np.where(complete, column, np.nan) for name, column in figures.items()}


def _figures(problem: Problem, found: Sequence[Moments], stresses: Sequence[Stress]) -> dict[str, Array]:
    """Figures for objectives and records: the first case's energy and heat, the largest current and temperature."""
    loads, share = [case.spec.load for case in problem.cases], problem.spec.supply.regeneration
    machines = problem.machine_cases
    power = [np.sum([loads[i].alike * found[i].power for i in wheels], 0) for wheels in machines]
    drawn, returned = (
        np.sum([loads[i].alike * getattr(found[i], name) for i in machines[0]], 0) for name in ("drawn", "returned")
    )
    return {
        "energy": drawn - share * returned,
        "returned": returned,
        "power": np.maximum.reduce(power),
        "joule_heat": found[0].copper,
        "peak_current": np.maximum.reduce([u.current.value for u in stresses]),
        "winding_temperature": np.maximum.reduce([m.winding for m in found]),
    }
