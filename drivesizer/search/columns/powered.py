"""Candidates with the smallest controller that does in all load cases, against what is electrical and temperature.

The voltage that a controller must give depends on how warm the winding is, which is known only when the waveform is
computed; so a controller is chosen for a cold winding first, and another where that one turns out too weak.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.stress import Heat, Parts, Stress, on, put, replaced, stress
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import FREE, Rows
from drivesizer.search.columns.controllers import Chosen, Speeds, controllers
from drivesizer.search.columns.decided import decided
from drivesizer.search.columns.encoders import line_frequency
from drivesizer.search.columns.exactly import exact
from drivesizer.search.columns.limits import electrical_limits, electrical_speed
from drivesizer.search.columns.limits_over_time import Exactly, Moments, Pair, least, waveform_limits
from drivesizer.search.columns.offers import Offers, unknown_where_doubtful, worst_of_all
from drivesizer.spec.altitude import controller_needed

__all__ = ["Moving", "Powered", "powered"]

Array = NDArray[np.float64]
_TRIES = 4  # of controllers for a candidate


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
    staged: bool = False,
    nearness: bool = True,
) -> Powered:
    """Controllers, and every check that hangs on current, voltage and heat.

    Parameters
    ----------
    problem, offered
        The problem with its load cycles, and its controllers.
    cycles
        The load cycles behind the belts of the candidates.
    cases, parts
        Columns over candidates; the controllers are chosen but where a row is given.
    exactly
        Compute the waveform of all, with their energy or as far as is wanted; else only of those that safe bounds leave
        undecided. Or a mask of which.
    each
        Names of checks to decide of candidates that fail on another as well.
    staged, nearness
        As ``decided`` takes them.

    Returns
    -------
    Powered
        Row of each candidate's controller, its checks, and its figures.
    """
    ambients = [case.spec.environment.ambient for case in problem.cases]
    stresses = [
        stress(ambient, cycle, c.demand, parts.motor) for ambient, cycle, c in zip(ambients, cycles, cases, strict=True)
    ]
    case = _Cases(problem, offered, cycles, cases, stresses, parts, exactly, each, staged, nearness)
    continuous = np.zeros(len(parts.motor.rows), bool)
    required = case.required
    chosen = case.controllers(required, [u.cold_voltage.value for u in case.stresses], continuous)
    free = np.ones_like(continuous) if parts.controller is None else parts.controller.rows == FREE
    row = chosen.row if parts.controller is None else np.where(free, chosen.row, parts.controller.rows)
    found = case.judged(row, None)
    tried, changed = np.zeros_like(continuous), free
    for _ in range(_TRIES):  # what has not changed would be given the same again
        settled = ~found.weak | (found.open & tried)  # a voltage that stays open is no reason to overload a controller
        short = free & ~continuous & found.check("controller_peak_time").failed & ~found.dead & settled
        again = short | (changed & found.weak & ~found.dead & ~tried)
        if not again.any():
            break
        continuous |= short
        tried |= found.open
        row, found, changed = _again(case, required, row, found, continuous, short, np.flatnonzero(again))
    figures = _figures(problem, [low.agreed(high) for low, high in found.pairs], case.stresses)
    return Powered(row, [chosen.checks[0], *found.checks], _where_known(figures, cases))


class _Found(NamedTuple):
    """Checks and bounds of candidates with some controllers."""

    checks: list[CheckColumn]
    dead: NDArray[np.bool_]  # by the electrical limits already
    weak: NDArray[np.bool_]  # the controller has too little voltage, or may have
    open: NDArray[np.bool_]  # it may have: bounds of the voltage are all that is known, and do not decide
    pairs: list[Pair]  # of each load case

    def check(self, name: str) -> CheckColumn:
        """The check of a name."""
        return next(check for check in self.checks if check.name == name)

    def replaced(self, rows: NDArray[np.int64], new: _Found, of: NDArray[np.int64]) -> _Found:
        """With some of the candidates found anew; ``of`` says which of the new ones these are."""

        def both(old: Pair, some: Pair) -> Pair:
            low, high = (replaced(a, rows, on(b, of)) for a, b in zip(old, some, strict=True))
            return low, high

        return _Found(
            [check.with_rows(rows, other.on(of)) for check, other in zip(self.checks, new.checks, strict=True)],
            put(self.dead, rows, new.dead[of]),
            put(self.weak, rows, new.weak[of]),
            put(self.open, rows, new.open[of]),
            [both(*pair) for pair in zip(self.pairs, new.pairs, strict=True)],
        )


class _Required(NamedTuple):
    """Demands on controllers for each candidate."""

    motor: NDArray[np.int64]  # row of its motor
    rms: Array  # A
    largest: Array  # A
    speeds: Speeds


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
    staged: bool
    nearness: bool

    def some(self, rows: NDArray[np.int64]) -> _Cases:
        """Some of the candidates."""
        moving, stresses = [on(case, rows) for case in self.moving], [on(u, rows) for u in self.stresses]
        cycles = [cycle.on(rows) for cycle in self.cycles]
        exactly = self.exactly[rows] if isinstance(self.exactly, np.ndarray) else self.exactly
        return self._replace(
            cycles=cycles, moving=moving, stresses=stresses, parts=self.parts.on(rows), exactly=exactly
        )

    @property
    def required(self) -> _Required:
        """Requirement in the worst of all cases, with the margins that the spec requires."""
        spec, motor = self.problem.spec, self.parts.motor
        more, faster = 1.0 + spec.margins.torque, 1.0 + spec.margins.speed
        lasting = 1.0 + max(controller_needed(case.spec, spec.margins.torque) for case in self.problem.cases)
        rms = lasting * np.maximum.reduce([c.demand.rms_current for c in self.moving])
        largest = more * np.maximum.reduce([u.current.value for u in self.stresses])
        electrical = faster * np.maximum.reduce([electrical_speed(c.demand, motor) for c in self.moving])
        lines = faster * np.maximum.reduce([line_frequency(c.demand, self.parts.encoder) for c in self.moving])
        return _Required(
            motor.rows, rms, largest, Speeds(electrical, lines if spec.wants_encoder else np.zeros_like(lines))
        )

    def controllers(self, required: _Required, voltage: Sequence[Array], continuous: NDArray[np.bool_]) -> Chosen:
        """The smallest that suffices in the worst of all cases; of some candidates, where those are fewer."""
        spec, usable = self.problem.spec, self.offered.controllers
        volts = (1.0 + spec.margins.speed) * np.maximum.reduce(list(voltage))
        carried, largest = np.where(continuous, required.largest, required.rms), required.largest
        return controllers(spec, self.problem.catalog, required.motor, carried, largest, volts, required.speeds, usable)

    def judged(self, row: NDArray[np.int64], before: list[Pair] | None) -> _Found:
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
            least(self._pair(k, parts, stresses[k], dead, before[k] if before else None), *self.moving[k], stresses[k])
            for k in range(len(specs))
        ]
        limits = [waveform_limits(spec, *pair, parts) for spec, pair in zip(specs, pairs, strict=True)]
        last = worst_of_all(self.problem, lambda k: unknown_where_doubtful(limits[k], complete[k]))
        volts = [next(check for check in some if check.name == "supply_voltage") for some in limits]
        weak = ~np.logical_and.reduce([check.passed for check in volts])
        fails = np.logical_or.reduce([check.failed for check in volts])
        return _Found([*first, *last], dead, weak, weak & ~fails, pairs)

    def _stress(self, k: int, row: NDArray[np.int64]) -> Stress:
        """The stress of one load case, with what resistances before the winding take of the voltage."""
        spec = self.problem.cases[k].spec
        if not spec.resists:
            return self.stresses[k]
        leads = spec.feed(Rows(self.problem.catalog.controllers, row)).leads
        return stress(spec.environment.ambient, self.cycles[k], self.moving[k].demand, self.parts.motor, leads)

    def _pair(self, k: int, parts: Parts, stresses: Stress, dead: NDArray[np.bool_], before: Pair | None) -> Pair:
        """Peaks and heat over the waveform of one load case."""
        args = (self.problem.cases[k].spec, self.cycles[k], *self.moving[k], stresses, parts)
        if isinstance(self.exactly, np.ndarray):
            return self._in_part(k, parts, stresses, dead, before)
        if self.exactly:
            return exact(*args, "all" if self.exactly is True else self.exactly)
        return decided(*args, ~dead, before, each=self.each, staged=self.staged, nearness=self.nearness)

    def _in_part(self, k: int, parts: Parts, stresses: Stress, dead: NDArray[np.bool_], before: Pair | None) -> Pair:
        """The same, computed from the waveform of some candidates and by bounds of the others."""
        columns = tuple(np.empty((2, len(Moments._fields), len(dead))))
        for side in (True, False):
            rows = np.flatnonzero(self.exactly == side)
            if len(rows):
                own = None if before is None else (on(before[0], rows), on(before[1], rows))
                some = self.some(rows)._replace(exactly=side)
                pair = some._pair(k, parts.on(rows), on(stresses, rows), dead[rows], own)
                for whole, moments in zip(columns, pair, strict=True):
                    whole[:, rows] = moments
        return Moments(*columns[0]), Moments(*columns[1])


def _again(
    case: _Cases,
    required: _Required,
    row: NDArray[np.int64],
    found: _Found,
    continuous: NDArray[np.bool_],
    short: NDArray[np.bool_],
    rows: NDArray[np.int64],
) -> tuple[NDArray[np.int64], _Found, NDArray[np.bool_]]:
    """Other controllers for some candidates, where there are, what is found with them, and who changed."""
    changed = np.zeros(len(row), bool)
    opened = found.open[rows] & ~short[rows]
    volts = [np.where(opened, high.voltage[rows], low.voltage[rows]) for low, high in found.pairs]
    chosen = case.controllers(on(required, rows), volts, continuous[rows]).row
    other = np.flatnonzero(chosen != row[rows])
    if not len(other):
        return row, found, changed
    retried = rows[other]
    before = [(on(low, retried), on(high, retried)) for low, high in found.pairs]
    new = case.some(retried).judged(chosen[other], before)
    # where heat is unknown a controller is none the worse that does for a cold winding and not for a hot one
    better = np.flatnonzero(~opened[other] | ~new.weak)
    changed[retried[better]] = True
    return put(row, retried[better], chosen[other[better]]), found.replaced(retried[better], new, better), changed


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
