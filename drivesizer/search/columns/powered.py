"""Candidates with the smallest controller that does in all load cases, against what is electrical and temperature.

What a controller must give depends on how warm the winding is, and on the controller: for how long the current is
above its own, what it loses, what its capacitance takes. So one is chosen by moments and extremes for a cold winding
first, and where it turns out not to suffice others, by rising current.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import STAGE_FIGURES
from drivesizer.physics.winding import Heat, Parts, Stress, on, put, replaced, stress
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import line_frequency
from drivesizer.search.columns.candidates import FREE, Rows
from drivesizer.search.columns.controllers import (
    HANGING,
    ChosenPart,
    Required,
    controllers,
    no_better_than,
    room_on_bus,
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
    waveform_limits,
)
from drivesizer.search.columns.offers import Offers, unknown_where_doubtful, worst_of_all
from drivesizer.spec.mounting import controller_needed

__all__ = ["UNDECIDED", "Moving", "Powered", "powered"]

Array = NDArray[np.float64]
UNDECIDED = "undecided"  # figure of a candidate: 1 where bounds leave open whether the waveform meets its limits


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
    first = case.controllers([u.cold_voltage.value for u in case.stresses])
    chosen = first.row
    free = np.ones(len(chosen), bool) if parts.controller is None else parts.controller.rows == FREE
    row = chosen if parts.controller is None else np.where(free, chosen, parts.controller.rows)
    found = case.judged(row)
    row, found = _walked(case, row, found, np.flatnonzero(free & ~case.undecided(row, found)), first.better)
    figures = _figures(problem, [low.agreed(high) for low, high in found.pairs], case.stresses)
    available = offered.controllers.available(parts.motor.rows, row)
    figures = _where_known(figures, cases) | {UNDECIDED: case.undecided(row, found).astype(float)}
    return Powered(row, [available, *found.checks], figures)


_OF_CONTROLLER = (
    "controller_continuous_current", "controller_peak_current", "controller_speed", "encoder_frequency",
)  # fmt: skip


class _Found(NamedTuple):
    """Checks and bounds of candidates with some controllers."""

    checks: list[CheckColumn]
    pairs: list[Pair]  # of each load case

    def failed(self, others: bool = False) -> NDArray[np.bool_]:
        """Whether a check fails; ``others``: one that no other controller changes."""
        some = [check.failed for check in self.checks if not check.advice and not (others and check.name in HANGING)]
        found: NDArray[np.bool_] = np.logical_or.reduce(some)
        return found

    def on(self, rows: NDArray[Any]) -> _Found:
        """Of some of the candidates."""
        rows = np.flatnonzero(rows) if rows.dtype == bool else rows
        return _Found([check.on(rows) for check in self.checks], [(on(a, rows), on(b, rows)) for a, b in self.pairs])

    def margin(self, of_controller: bool) -> Array:
        """The smallest margin of the checks that hang on the controller, or of the others."""
        some = [c for c in self.checks if (c.name in _OF_CONTROLLER or c.name in HANGING) == of_controller]
        found: Array = np.minimum.reduce([check.tightness for check in some])
        return found

    @property
    def passes(self) -> NDArray[np.bool_]:
        """Whether every check passes."""
        found: NDArray[np.bool_] = np.logical_and.reduce([check.passed for check in self.checks if not check.advice])
        return found

    @property
    def lacking(self) -> NDArray[np.int64]:
        """Number of checks that are unknown."""
        found: NDArray[np.int64] = np.sum([~(c.passed | c.failed) for c in self.checks if not c.advice], axis=0)
        return found

    def replaced(self, rows: NDArray[np.int64], new: _Found, of: NDArray[np.int64]) -> _Found:
        """With some of the candidates found anew; ``of`` says which of the new ones these are."""

        def both(old: Pair, some: Pair) -> Pair:
            low, high = (replaced(a, rows, on(b, of)) for a, b in zip(old, some, strict=True))
            return low, high

        return _Found(
            [check.with_rows(rows, other.on(of)) for check, other in zip(self.checks, new.checks, strict=True)],
            [both(*pair) for pair in zip(self.pairs, new.pairs, strict=True)],
        )


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

    def some(self, rows: NDArray[np.int64]) -> _Cases:
        """Some of the candidates."""
        moving, stresses = [on(case, rows) for case in self.moving], [on(u, rows) for u in self.stresses]
        cycles = [cycle.on(rows) for cycle in self.cycles]
        exactly = self.exactly[rows] if isinstance(self.exactly, np.ndarray) else self.exactly
        return self._replace(
            cycles=cycles, moving=moving, stresses=stresses, parts=self.parts.on(rows), exactly=exactly
        )

    def controllers(
        self,
        voltage: Sequence[Array],
        barred: NDArray[np.bool_] | None = None,
        known: NDArray[np.bool_] | None = None,
        present: tuple[NDArray[np.int64], Array] | None = None,
    ) -> ChosenPart:
        """The best that suffices in the worst of all cases, as far as that is known before its own limits are."""
        spec, motor, moving = self.problem.spec, self.parts.motor, self.moving
        lines = np.maximum.reduce([line_frequency(c.demand, self.parts.encoder) for c in moving])
        required = Required(
            np.maximum.reduce([c.demand.rms_current for c in moving]),
            np.maximum.reduce([u.current.value for u in self.stresses]),
            np.maximum.reduce(list(voltage)),
            np.maximum.reduce([electrical_speed(c.demand, motor) for c in moving]),
            lines if spec.wants_encoder else None,
            max(controller_needed(case.spec, spec.margins.torque) for case in self.problem.cases),
            spec.margins.torque,
            spec.margins.speed,
        )
        usable = self.offered.controllers
        return controllers(spec, self.problem.catalog, motor.rows, required, usable, barred, known, present)

    def others(
        self,
        found: _Found,
        barred: NDArray[np.bool_],
        known: NDArray[np.bool_],
        present: tuple[NDArray[np.int64], Array],
    ) -> NDArray[np.int64]:
        """Of those that are not barred the best that may suffice, -1 where none may.

        Of candidates that fail nothing one of which all is ``known``, at the highest voltage where that is open. Leads
        take of the voltage that was found: then it is that of a cold winding.
        """
        opened = known & ~next(c.passed | c.failed for c in found.checks if c.name == "supply_voltage")
        volts = [np.where(opened, np.nan_to_num(high.voltage, nan=np.inf), low.voltage) for low, high in found.pairs]
        if self.problem.spec.resists:
            volts = [u.cold_voltage.value for u in self.stresses]
        return self.controllers(volts, barred, known, present).row

    def beyond_supply(self, found: _Found) -> NDArray[np.bool_]:
        """Candidates whose motor takes more voltage than the supply has, with any controller."""
        more, cases = 1.0 + self.problem.spec.margins.speed, zip(self.problem.cases, found.pairs, strict=True)
        beyond = [more * low.voltage > case.spec.supply.lowest for case, (low, _) in cases]
        return np.asarray(np.logical_or.reduce(beyond), bool)

    def full_bus(self, found: _Found, tried: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Usable controllers without room for the energy returned with those tried: (controllers, candidates).

        Of those that lose no more, with which no less is returned.
        """
        usable, table = self.offered.controllers, self.problem.catalog.controllers
        loss = self.problem.spec.feed({name: table[name][usable.order] for name in STAGE_FIGURES}).stage.least_loss
        full = np.zeros((len(loss), len(tried)), bool)
        for case, (low, _) in zip(self.problem.cases, found.pairs, strict=True):
            full |= room_on_bus(case.spec, table, usable)[:, None] * (1.0 + 1e-9) < low.stored
        return np.asarray(full & (loss[:, None] <= loss[tried]), bool)

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

    def undecided(self, row: NDArray[np.int64], found: _Found) -> NDArray[np.bool_]:
        """Candidates that fail nothing by bounds alone, which is all that is wanted, and that the waveform may fail."""
        if not isinstance(self.exactly, str) or self.exactly != "bounds":
            return np.zeros(len(row), bool)
        parts = self.parts._replace(controller=Rows(self.problem.catalog.controllers, row))
        cases = zip(self.problem.cases, found.pairs, self.moving, strict=True)
        left = [left_open(case.spec, pair, parts) & moving.demand.complete for case, pair, moving in cases]
        return np.asarray(np.logical_or.reduce(left) & ~found.failed(), bool)

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


def _walked(
    case: _Cases, row: NDArray[np.int64], found: _Found, rows: NDArray[np.int64], better: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], _Found]:
    """Candidates whose controller does not suffice, or is not the best, with others, each with its own limits.

    Until the best does. None is tried that no figure makes better than one that was, nor one of which something is not
    known in place of one that only leaves a check unknown. Where all that are listed fail others may exist: none.
    """
    usable, table = case.offered.controllers, case.problem.catalog.controllers
    by_margin = case.problem.spec.select.objective == "margin"
    if not len(rows := rows[_wanting(case, row, found, better)[rows]]):
        return row, found
    no_better, place = no_better_than(case.problem.spec, table, usable), np.zeros(len(table), np.int64)
    place[usable.order] = np.arange(len(usable.order))
    barred, one, new = np.zeros((len(usable.order), len(rows)), bool), row[rows], found.on(rows)
    while len(rows):
        full = case.full_bus(new, place[one])
        barred |= (usable.order[:, None] == one) | _pointless(new, no_better, place[one], full)
        now = found.on(rows)
        fails, passes = now.failed(), now.passes
        present = np.where(passes, row[rows], -1), now.margin(True) if by_margin else np.zeros(len(rows))
        one = case.some(rows).others(new, barred, ~fails & ~passes, present)
        going = (one >= 0) | fails & usable.partial[case.parts.motor.rows[rows]]
        rows, barred, one, now, new = rows[going], barred[:, going], one[going], now.on(going), new.on(going)
        if not len(rows):
            break
        new = case.some(rows).judged(one)
        fewer = (new.failed() < now.failed()) | ~(new.failed() | now.failed()) & (new.lacking < now.lacking)
        both = new.passes & now.passes
        fewer |= both & (new.margin(True) > now.margin(True) * (1.0 + 1e-9)) if by_margin else both
        taken = np.flatnonzero(fewer)
        row, found = put(row, rows[taken], one[taken]), found.replaced(rows[taken], new, taken)
        better = put(better, rows[taken], np.full(len(taken), True))  # what was no better than the first may be now
        going = (one >= 0) & ~new.failed(others=True)
        going &= _wanting(case.some(rows), row[rows], found.on(rows), better[rows])
        rows, barred, one, new = rows[going], barred[:, going], one[going], new.on(going)
    return row, found


def _pointless(
    found: _Found, no_better: dict[str, NDArray[np.bool_]], tried: NDArray[np.int64], full: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Controllers that cannot do better than those tried: (controllers, candidates).

    No better for one check that fails; where none does, for all that are unknown, of which the bus is where it is full.
    """
    failed, checks = found.failed(), [check for check in found.checks if check.name in no_better]
    fails: Any = np.logical_or.reduce([no_better[check.name][:, tried] & check.failed for check in checks])
    lacks = np.logical_and.reduce([
        no_better[check.name][:, tried] | check.passed | (full & (check.name == "bus_voltage")) for check in checks
    ])  # fmt: skip
    barred: NDArray[np.bool_] = np.where(failed, fails, lacks & np.logical_or.reduce([~c.passed for c in checks]))
    return barred


def _wanting(case: _Cases, row: NDArray[np.int64], found: _Found, better: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Candidates with whose controller a check fails or is unknown that another one may meet, or one is better."""
    unmet: NDArray[np.bool_] = np.logical_or.reduce([~check.passed for check in found.checks if check.name in HANGING])
    if case.problem.spec.select.objective == "margin":
        better = better | (found.margin(True) < found.margin(False))
    unmet |= better & found.passes
    unmet &= (row >= 0) & ~found.failed(others=True) & ~case.beyond_supply(found)
    if not unmet.any():
        return unmet
    known = np.logical_and.reduce([c.demand.complete for c in case.moving])
    wanting: NDArray[np.bool_] = unmet & (known | found.failed())
    return wanting


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
