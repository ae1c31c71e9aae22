"""Candidates with the best controller that does in all load cases, against what is electrical and temperature.

What a controller must give depends on how warm the winding is, and on the controller: for how long the current is
above its own, what it loses, what its capacitance takes. So all controllers of a candidate are ordered by what moments
and extremes say of them at least, and computed in that order until none that is left could be better.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.supply_power import Draw
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.figures import on, put
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.winding import Heat, Parts, stress
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.search.columns import limits_over_time as over_time
from drivesizer.search.columns.brakes import line_frequency
from drivesizer.search.columns.candidates import FREE, Rows
from drivesizer.search.columns.controllers import HANGING, LOST, Ranks, Required, Usable, controllers
from drivesizer.search.columns.limits import (
    electrical_limits,
    electrical_speed,
    unknown_where_doubtful,
    worst_of_all,
)
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
UNDECIDED = "undecided"  # figure of a candidate: above 0 where bounds leave open whether the waveform meets its limits
_AT_ONCE = 1 << 13  # controllers of candidates times segments of a cycle that are computed at once
OVER_WAVEFORM = ("winding_temperature", *HANGING)  # checks that bounds may leave open
_OF_CONTROLLER = (
    "controller_continuous_current", "controller_peak_current", "controller_speed", "encoder_frequency", *HANGING,
)  # fmt: skip


class Moving(NamedTuple):
    """Demands of candidates in a load case, and their heat: columns."""

    demand: Demands
    heating: Heat


class Powered(NamedTuple):
    """Candidates with their controllers."""

    controller: NDArray[np.int64]  # row of each
    checks: list[CheckColumn]
    figures: dict[str, Array]


def powered(
    problem: Problem,
    usable: Usable,
    cycles: Sequence[AtGearhead],
    moving: Sequence[Moving],
    parts: Parts,
    *,
    waveform: over_time.Waveform,
    each: Collection[str] = (),
) -> Powered:
    """Controllers, and every check that hangs on current, voltage and heat."""
    cases = [
        over_time.InCase(case.spec, cycle, *one, stress(case.spec.environment.ambient, cycle, one.demand, parts.motor))
        for case, cycle, one in zip(problem.cases, cycles, moving, strict=True)
    ]
    given, some = parts.controller, _Candidates(problem, usable, cases, parts, waveform, each)
    row, ranks = some.controllers()
    free = np.ones(len(row), bool) if given is None else given.rows == FREE
    row = row if given is None else np.where(free, row, given.rows)
    if len(usable.order):
        row = some.by_lower_bounds(row, ranks, free)
    found = some.judged(row)
    if len(usable.order):
        row, found = _best_of_all(some, ranks, row, found, free & ~(found.undecided > 0.0))
    agreed = [low.agreed(high) for low, high in found.pairs]
    figures = over_time.cycle_figures(
        problem, [Draw(one.drawn, one.returned, one.power) for one in agreed],
        joule_heat=agreed[0].copper, peak_current=np.maximum.reduce([case.stresses.current.value for case in cases]),
        winding_temperature=np.maximum.reduce([one.winding for one in agreed]),
    )  # fmt: skip
    # a lower bound may fail a check, but is no figure
    figures = {name: np.where(some.complete, column, np.nan) for name, column in figures.items()}
    available = usable.available(parts.motor.rows, row)
    return Powered(row, [available, *found.checks], figures | {UNDECIDED: found.undecided})


class _Judged(NamedTuple):
    """Candidates with some controllers."""

    checks: list[CheckColumn]
    pairs: list[over_time.Pair]  # bounds over the waveform of each load case
    # 1 of what fails nothing by bounds, which are all that is wanted, and what the waveform may fail; 2 of those of
    # which a check is unknown whatever the waveform says
    undecided: Array

    def failed(self, but: Collection[str] = ()) -> Mask:
        """Whether a check fails, but for some."""
        found: Mask = np.logical_or.reduce([c.failed for c in self.checks if not c.advice and c.name not in but])
        return found

    def margin(self, of_controller: bool) -> Array:
        """The smallest margin of the checks that hang on the controller, or of the others."""
        found: Array = np.minimum.reduce(
            [c.tightness for c in self.checks if (c.name in _OF_CONTROLLER) == of_controller]
        )
        return found


class _Candidates(NamedTuple):
    """The load cases and their candidates."""

    problem: Problem
    usable: Usable
    cases: Sequence[over_time.InCase]
    parts: Parts
    waveform: over_time.Waveform
    each: Collection[str]

    @property
    def complete(self) -> Mask:
        """Whether all that is demanded of each candidate is known."""
        return np.asarray(np.logical_and.reduce([case.demand.complete for case in self.cases]), bool)

    def some(self, rows: NDArray[np.int64]) -> _Candidates:
        """Some of the candidates."""
        cases, parts = on((self.cases, self.parts), rows)
        return self._replace(cases=cases, parts=parts)

    def with_controllers(self, row: NDArray[np.int64]) -> Parts:
        """The parts of candidates with some controllers."""
        return self.parts._replace(controller=Rows(self.problem.catalog.controllers, row))

    def controllers(self) -> tuple[NDArray[np.int64], Ranks]:
        """The best that suffices in the worst of all cases, as far as that is known before its own limits are."""
        spec, motor = self.problem.spec, self.parts.motor

        def worst(figure: Callable[[over_time.InCase], Array]) -> Array:
            found: Array = np.maximum.reduce([figure(case) for case in self.cases])
            return found

        required = Required(
            worst(lambda case: case.demand.rms_current),
            worst(lambda case: case.stresses.current.value),
            worst(lambda case: case.stresses.cold_voltage.value),
            worst(lambda case: electrical_speed(case.demand, motor)),
            worst(lambda case: line_frequency(case.demand, self.parts.encoder)) if spec.wants_encoder else None,
            max(controller_needed(case.spec, spec.margins.torque) for case in self.cases),
            spec.margins.torque,
            spec.margins.speed,
        )
        return controllers(spec, self.problem.catalog, motor.rows, required, self.usable)

    def by_lower_bounds(self, row: NDArray[np.int64], ranks: Ranks, free: Mask) -> NDArray[np.int64]:
        """Controllers that are the best by lower bounds over the waveform; what has one that meets these keeps it."""
        parts, unmet = self.with_controllers(row), np.full(len(row), bool(ranks.weight))
        for case in self.cases:
            if over_time.kept_on_the_bus(case.spec) > 0.0 and not ranks.weight:
                lowest = over_time.lowest(case, parts)
                unmet |= ~np.logical_and.reduce([c.passed for c in _hanging(case.spec, lowest, parts)])
        rows = np.flatnonzero(unmet & free & (row >= 0) & self.complete)
        if not len(rows):
            return row
        unknown, _, _, place = self.some(rows).ranks(ranks.on(rows)).best()
        taken = np.flatnonzero(unknown < LOST)  # where each fails the first one says on what
        return put(row, rows[taken], self.usable.order[place[taken].astype(np.int64)])

    def ranks(self, ranks: Ranks, row: NDArray[np.int64] | None = None, found: _Judged | None = None) -> Ranks:
        """Ranks of all controllers by lower bounds over the waveform, and by what was computed with one of them.

        What loses more than that one draws no less, and returns no more.
        """
        parts = self.with_controllers(self.usable.order[:, None])
        passed: dict[str, Mask] = {}
        lacking, margin = ranks.lacking.copy(), ranks.margin
        for k, case in enumerate(self.cases):
            spec, low = case.spec, over_time.lowest(case, parts)
            if found is not None and row is not None:
                computed, stage = found.pairs[k][0], spec.feed(parts.controller).stage
                tried = spec.feed(Rows(self.problem.catalog.controllers, row)).stage
                more = (stage.loss >= tried.loss) & (stage.standby >= tried.standby)
                less = stage.least_loss <= tried.least_loss
                low = low._replace(
                    voltage=low.voltage if spec.resists else np.fmax(low.voltage, computed.voltage),
                    stored=np.where(less, np.fmax(low.stored, computed.stored), low.stored),
                    power=np.where(more, np.fmax(low.power, computed.power), low.power),
                )
            for check in _hanging(spec, low, parts):
                lacking[np.broadcast_to(check.failed, lacking.shape)] = LOST
                passed[check.name] = passed.get(check.name, np.True_) & check.passed
                if ranks.weight:
                    margin = np.minimum(margin, check.tightness)
        hanging = np.zeros(lacking.shape, np.int8)
        for one in passed.values():
            hanging += ~one
        return ranks._replace(lacking=lacking, hanging=hanging, margin=margin)

    def judged(self, row: NDArray[np.int64]) -> _Judged:
        """The electrical limits with some controllers, and those of the waveform by bounds or exactly."""
        parts, cases = self.with_controllers(row), list(self.cases)
        for k, (spec, cycle, demand, *_) in enumerate(cases):
            if spec.resists:  # before the winding, of the voltage
                leads = spec.feed(parts.controller).leads
                stresses = stress(spec.environment.ambient, cycle, demand, parts.motor, leads)
                cases[k] = cases[k]._replace(stresses=stresses)

        def electrical(k: int) -> list[CheckColumn]:
            spec, cycle, demand, _, stresses = cases[k]
            checks = electrical_limits(spec, cycle, demand, stresses, parts)
            return unknown_where_doubtful(checks, demand.complete)

        first = worst_of_all(self.problem, electrical)
        alive: Mask = ~np.logical_or.reduce([check.failed for check in first if not check.advice])
        pairs = [over_time.over_waveform(case, parts, self.waveform, alive, self.each) for case in cases]

        def of_waveform(k: int) -> list[CheckColumn]:
            checks = over_time.waveform_limits(cases[k].spec, *pairs[k], parts)
            return unknown_where_doubtful(checks, cases[k].demand.complete)

        found = _Judged([*first, *worst_of_all(self.problem, of_waveform)], pairs, np.zeros(len(row)))
        if self.waveform != "bounds":
            return found
        left, lacks = np.zeros(len(row), bool), np.zeros(len(row), bool)
        for case, pair in zip(cases, pairs, strict=True):
            left |= over_time.left_open(case.spec, pair, parts) & case.demand.complete
            for check in over_time.waveform_limits(case.spec, pair[0], pair[0], parts):
                lacks |= ~(check.passed | check.failed)
        return found._replace(undecided=np.where(left & ~found.failed(), 1.0 + lacks, 0.0))

    def reached(self, ranks: Ranks, row: NDArray[np.int64], found: _Judged) -> Array:
        """Columns as ``Ranks.best`` gives them, as computed with a controller each; infinite where a check fails."""
        some = [c for c in found.checks if c.name in _OF_CONTROLLER and not c.advice]
        unknown = np.sum([~(c.passed | c.failed) for c in some], axis=0) + (self.usable.unclear[row] | (row < 0))
        unknown = np.where(found.undecided > 0.0, 0, unknown)  # by bounds it may pass
        place = np.zeros(len(self.problem.catalog.controllers) + 1, np.int64)
        place[self.usable.order] = np.arange(len(self.usable.order))
        place = place[row]
        share, unprinted = ranks.at(ranks.share, place), ranks.at(ranks.unprinted, place)
        if ranks.weight:
            least = np.minimum(found.margin(True), found.margin(False))
            share = share + ranks.weight / (1.0 + np.maximum(least, -0.999))
        return np.where(found.failed(), np.inf, np.array([unknown, np.round(share, 9), unprinted, place], float))


def _hanging(spec: RobotSpec, low: over_time.Moments, parts: Parts) -> list[CheckColumn]:
    """Limits of a load case that hang on controller and cycle, by lower bounds."""
    return [c for c in over_time.waveform_limits(spec, low, low, parts) if c.name in HANGING]


def _best_of_all(
    some: _Candidates, ranks: Ranks, row: NDArray[np.int64], found: _Judged, free: Mask
) -> tuple[NDArray[np.int64], _Judged]:
    """Candidates with the best of all controllers, as computed from the waveform.

    They are tried in the order of what bounds say of them at least, until none that is left could be better. Where all
    that are listed fail others may exist: none. Where the motor takes more voltage than the supply has none helps.
    """
    usable, more = some.usable, 1.0 + some.problem.spec.margins.speed
    unmet = ~np.logical_and.reduce([c.passed for c in found.checks if c.name in HANGING])
    if ranks.weight:
        unmet |= found.margin(True) < found.margin(False)
    for case, (low, _) in zip(some.cases, found.pairs, strict=True):
        free = free & ~(more * low.voltage > case.spec.supply.lowest)
    wanting = unmet & free & (row >= 0) & ~found.failed(HANGING)
    rows = np.flatnonzero(wanting & (some.complete | found.failed()))
    if not len(rows):
        return row, found
    some, ranks, kept, chosen = some.some(rows), ranks.on(rows), on(found, rows), row[rows]
    best, tried = some.reached(ranks, chosen, kept), usable.order[:, None] == chosen
    few = _AT_ONCE // some.problem.segments
    left, here, new, one = np.arange(len(rows)), some, kept, chosen
    while len(left):
        ranks, others = here.ranks(ranks, one, new), new.margin(False) if ranks.weight else np.inf
        could = ranks.before(best[:, left], others) & ~tried[:, left] & (here.complete | np.isinf(best[0, left]))
        place, at = np.nonzero(could)
        if len(at) > few:
            at = np.flatnonzero(could.any(axis=0))
            place = ranks.best(others, ~could)[3, at].astype(np.int64)
        if not len(at):
            break
        left, here, ranks, one = left[at], here.some(at), ranks.on(at), usable.order[place]
        new, tried[place, left] = here.judged(one), True
        reached = here.reached(ranks, one, new)
        in_order = np.lexsort((*reached[::-1], left))
        of_each = in_order[np.unique(left[in_order], return_index=True)[1]]
        taken = of_each[_before(reached[:, of_each], best[:, left[of_each]])]
        best[:, left[taken]] = reached[:, taken]
        chosen, kept = put(chosen, left[taken], one[taken]), put(kept, left[taken], on(new, taken))
        going = np.flatnonzero(~new.failed(HANGING)) if len(left) == len(of_each) else left[:0]
        left, here, ranks, new, one = left[going], here.some(going), ranks.on(going), on(new, going), one[going]
    none = np.flatnonzero(np.isinf(best[0]) & usable.partial[some.parts.motor.rows])
    if len(none):
        new = some.some(none).judged(np.full(len(none), -1))
        taken = np.flatnonzero(~new.failed())
        chosen, kept = put(chosen, none[taken], np.full(len(taken), -1)), put(kept, none[taken], on(new, taken))
    return put(row, rows, chosen), put(found, rows, kept)


def _before(one: Array, other: Array) -> Mask:
    """Whether some columns go before others, by the first row in which they differ."""
    found = np.zeros(one.shape[1], bool)
    for a, b in zip(one[::-1], other[::-1], strict=True):
        found = (a < b) | ((a == b) & found)
    return found
