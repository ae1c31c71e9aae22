"""Peaks and heat over the waveform, as closely as the checks need: by bounds, exactly where these leave them open.

Bounds of all come first; a long cycle is then taken in blocks. What still is open of those that pass is computed from
the cycle itself.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.several_belts import at_a_time, behind_each, behind_one, heat_behind_one
from drivesizer.physics.stress import Heat, Parts, Stress, on, put, replaced
from drivesizer.physics.thermal import two_bodies
from drivesizer.search.columns import waveform_bounds
from drivesizer.search.columns.block_bounds import by_few_blocks, by_segments, closer_power
from drivesizer.search.columns.block_bounds import closer as closer_in_blocks
from drivesizer.search.columns.bus_bounds import closer_stored, stored_by_segments
from drivesizer.search.columns.candidates import Rows
from drivesizer.search.columns.exactly import exact, time_above
from drivesizer.search.columns.limits_over_time import (
    Moments,
    Pair,
    Wanted,
    kept_on_the_bus,
    waveform_limits,
)
from drivesizer.search.columns.overload_bounds import above_bounds, closer_above
from drivesizer.spec.robot import RobotSpec

__all__ = ["decided"]

Array = NDArray[np.float64]
_LONG = 256  # pieces of a cycle, from where blocks of it decide sooner than the cycle itself
_BLOCKS = (64, 1024)
_CELLS, _TOGETHER = 1 << 17, 64  # candidates times pieces in one go, and candidates at least
_MORE = 4  # times as many pieces as segments, from where the segments of a short cycle decide sooner
_FEW_PIECES, _PIECES = 256, 8192
_SOME_PIECES = (512, 2048)
_WINDING = 2  # so many of the limits are those of the winding
_VOLTAGE = 1  # of the motor
_BUS = 3  # the voltage of the bus
_POWER = 4  # from here on they are those of the supply's power
_NOT_BY_HEAT = (2, _BUS)  # time of overload


class _Case:
    """One load case and its candidates: what all bounds and the waveform are computed from."""

    def __init__(
        self,
        spec: RobotSpec,
        cycle: AtGearhead,
        demand: Demands,
        heating: Heat,
        stresses: Stress,
        parts: Parts,
        each: Collection[str],
        staged: bool,
    ) -> None:
        self.spec, self.cycle, self.columns = spec, cycle, (demand, heating, stresses, parts)
        self.each, self.staged = each, staged
        self.told = (
            two_bodies(parts.motor).known & ~np.isnan(heating.winding) & demand.complete
        )  # whose winding is known from the waveform

    @property
    def controlled(self) -> bool:
        """Whether more than the time of overload hangs on the controller: power and what is returned, by its losses."""
        supply = self.spec.supply
        return bool(self.spec.resists or supply.current or supply.power or np.any(kept_on_the_bus(self.spec) > 0.0))

    def some(self, mask: NDArray[Any]) -> tuple[RobotSpec, AtGearhead, Demands, Heat, Stress, Parts]:
        """Of some of the candidates."""
        demand, heating, stresses, parts = self.columns
        rows = _numbers(mask)
        return (self.spec, self.cycle.on(rows), on(demand, rows), on(heating, rows), on(stresses, rows), parts.on(rows))

    @cached_property
    def bounding(self) -> Parts:
        """The parts that bounds are computed of: where a limit is judged by itself a winding may be hotter."""
        parts = self.columns[3]
        if not self.each:
            return parts
        some = parts.motor.table.taken(parts.motor.rows)
        permitted = np.where(self.told, np.inf, some["max_winding_temperature"])
        table = replace(some, columns={**some.columns, "max_winding_temperature": permitted})
        return parts._replace(motor=Rows(table, np.arange(len(permitted))))

    def bounded(self, mask: NDArray[Any]) -> tuple[RobotSpec, AtGearhead, Demands, Heat, Stress, Parts]:
        """Of some of the candidates, for bounds."""
        return (*self.some(mask)[:-1], self.bounding.on(mask))

    def open(self, found: Pair, alive: NDArray[np.bool_]) -> list[NDArray[np.bool_]]:
        """Of each limit, where the two bounds differ in the status of a candidate that passes so far.

        Of any candidate where the limit is judged by itself.
        """
        low, high = (waveform_limits(self.spec, side, side, self.columns[3]) for side in found)
        fails = np.logical_or.reduce([a.failed & b.failed for a, b in zip(low, high, strict=True)])
        passing = alive & ~fails
        masks = [
            (passing | (a.name in self.each)) & ((a.passed != b.passed) | (a.failed != b.failed))
            for a, b in zip(low, high, strict=True)
        ]
        unknown = np.isnan(found[1].power) & ~self.told  # temperature unknown: at most a failure while cold
        if any(mask.any() for mask in masks[_POWER:]) and (passing & unknown).any():
            most = found[0]._replace(power=self.coldest)
            colds = waveform_limits(self.spec, most, most, self.columns[3])[_POWER:]
            masks[_POWER:] = [m & ~(unknown & ~c.failed) for m, c in zip(masks[_POWER:], colds, strict=True)]
        masks = [mask & self.columns[0].complete for mask in masks]  # else it stays unknown whatever the waveform says
        return [mask & self.told for mask in masks[:_WINDING]] + masks[_WINDING:]

    def open_again(
        self, found: Pair, alive: NDArray[np.bool_], left: list[NDArray[np.bool_]], mask: NDArray[np.bool_]
    ) -> list[NDArray[np.bool_]]:
        """The same where only the bounds of some candidates are others than those that left these open."""
        rows = np.flatnonzero(mask)
        few = _Case(*self.some(rows), self.each, self.staged)
        some = few.open((on(found[0], rows), on(found[1], rows)), alive[rows])
        return [put(old, rows, new) for old, new in zip(left, some, strict=True)]

    @cached_property
    def coldest(self) -> Array:
        """An upper bound of the cycle's power with a cold winding [W]."""
        found: Array = waveform_bounds.most_cold_power(self.spec, self.cycle, *self.columns)
        return found


def decided(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    alive: NDArray[np.bool_],
    before: Pair | None,
    *,
    each: Collection[str] = (),
    staged: bool = False,
    nearness: bool = True,
) -> Pair:
    """Peaks and heat over the waveform, exact where bounds do not decide.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As ``limits_over_time.exact`` takes them.
    alive
        Candidates that have failed on nothing so far.
    before
        What was found with another controller.
    each
        Names of checks to decide of candidates that fail on another as well.
    staged
        Whether it is enough to know which limits fail; else also how far those left open by blocks are from them.
    nearness
        Whether it matters how near to its limits a candidate is that passes.

    Returns
    -------
    Pair
        Lower and upper bounds, equal where they are exact.
    """
    case = _Case(spec, cycle, demand, heating, stresses, parts, each, staged)
    if before and not case.controlled:
        shortest, longest = above_bounds(spec, cycle, demand, stresses, parts)
        found = before[0]._replace(above=shortest), before[1]._replace(above=longest)
    else:
        closely = nearness or before is not None
        found = waveform_bounds.bounds(spec, cycle, demand, heating, stresses, case.bounding, nearness=closely)
        if before:
            known = (
                ("winding", "winding_time") if spec.resists else ("winding", "winding_time", "voltage", "voltage_time")
            )
            low, high = (one._replace(**{name: getattr(old, name) for name in known})
                         for one, old in zip(found, before, strict=True))  # fmt: skip
            found = low, high
    left = case.open(found, alive)
    long = cycle.base.pieces > _LONG
    if long:
        found, left = _closer(case, alive, found, left, nearness)
    elif not nearness and _MORE * len(cycle.load_cycle.duration) <= cycle.base.pieces:
        found, left = _passing_by_segments(case, found, left)
    return _exactly(case, alive, found, left, long)


def _exactly(case: _Case, alive: NDArray[np.bool_], found: Pair, left: list[NDArray[np.bool_]], long: bool) -> Pair:
    """The same, exact of those left open: by their winding first, as candidates that fail on that need no more.

    Over a short cycle all is computed in one go, for a second one would cost more than it saves.
    """
    winding, every = np.logical_or.reduce(left[:_WINDING]), np.logical_or.reduce(left)
    first = winding if long else every
    what: Wanted = "winding" if long else _wanted(left)
    wants: NDArray[np.bool_] = behind_each(case.cycle, lambda _, bus: np.full(len(bus), bus.any()), left[_BUS])
    few = exact(*case.some(first), what) if first.any() else found
    if winding.any():
        new = [on(side, winding[first]).over(on(old, winding), "winding") for side, old in zip(few, found, strict=True)]
        found = _replaced(found, winding, new)
        left = case.open_again(found, alive, left, winding)
    rest = np.logical_or.reduce(left[_WINDING:])
    if not rest.any():
        return found
    if long:
        what = _wanted(left)
        few = exact(*case.some(rest), what)
    else:
        few = on(few[0], rest[first]), on(few[1], rest[first])
    sides = [(x, on(old, rest)) for x, old in zip(few, found, strict=True)]
    new = [x.over(old, what) for x, old in sides]
    if what == "limits" and not long and not wants.all():  # only another belt's candidates want to know of the bus
        less = [x.over(old, "power") for x, old in sides]
        new = [
            Moments(*(np.where(wants[rest], a, b) for a, b in zip(*x, strict=True)))
            for x in zip(new, less, strict=True)
        ]
    return _replaced(found, rest, new)


def _wanted(left: list[NDArray[np.bool_]]) -> Wanted:
    """Figures to compute where these limits are open: the energy that the bus stores costs most."""
    return "limits" if left[_BUS].any() else "power"


def _passing_by_segments(
    case: _Case, found: Pair, left: list[NDArray[np.bool_]]
) -> tuple[Pair, list[NDArray[np.bool_]]]:
    """The same, closer where that shows that what is open passes; what may fail is left to the waveform."""
    rows = np.flatnonzero(np.logical_or.reduce(left) & case.told)
    if not len(rows):
        return found, left
    few = by_segments(*case.bounded(rows), on(found[0], rows), on(found[1], rows))
    return _where_it_passes(case, rows, found, few, left, range(len(left)))


def _where_it_passes(
    case: _Case,
    rows: NDArray[np.int64],
    found: Pair,
    few: Pair,
    left: list[NDArray[np.bool_]],
    concerned: Collection[int],
) -> tuple[Pair, list[NDArray[np.bool_]]]:
    """Closer bounds of some candidates taken where all that is open of one among some limits passes by them."""
    limits = waveform_limits(case.spec, few[1], few[1], case.bounding.on(rows))
    holds = [check.passed | ~mask[rows] for check, mask in zip(limits, left, strict=True)]
    holds[_VOLTAGE] = limits[_VOLTAGE].passed  # a controller that is too weak is found by closer bounds
    good = np.flatnonzero(np.logical_and.reduce([holds[k] for k in concerned]))
    found = _replaced(found, rows[good], [on(side, good) for side in few])
    settled = np.zeros(len(case.told), bool)
    settled[rows[good]] = True
    return found, [mask & ~settled if k in concerned else mask for k, mask in enumerate(left)]


def _closer(
    case: _Case, alive: NDArray[np.bool_], found: Pair, left: list[NDArray[np.bool_]], nearness: bool
) -> tuple[Pair, list[NDArray[np.bool_]]]:
    """The same bounds and what they leave open, closer where that is winding, voltage, power or time of overload."""
    for step in _steps(case, nearness):
        mask = step.opened(case, left)
        if not mask.any():
            continue
        few = _of_some(case, mask, found, step)
        if step.only_passing:
            by_heat = [k for k in range(len(left)) if k not in _NOT_BY_HEAT]
            concerned = [_WINDING] if step.opened is _by_time else by_heat
            found, left = _where_it_passes(case, _numbers(mask), found, few, left, concerned)
        else:
            found = _replaced(found, mask, few)
            left = case.open_again(found, alive, left, mask)
    if (mask := left[_WINDING]).any():  # the current alone decides
        spec, cycle, demand, heating, _, parts = case.some(mask)
        above = time_above(spec, cycle, demand, heating, parts)
        found = _replaced(found, mask, [on(m, mask)._replace(above=above) for m in found])
        left = case.open_again(found, alive, left, mask)
    return found, left


class _Step(NamedTuple):
    """Bounds that are closer than those before."""

    closer: Callable[..., Pair]
    pieces: int  # that they are computed from
    opened: Callable[[_Case, list[NDArray[np.bool_]]], NDArray[np.bool_]]  # the candidates that may need them
    only_passing: bool = False  # whether they count where all that is open passes by them, and nowhere else


def _steps(case: _Case, nearness: bool) -> list[_Step]:
    """Bounds that are closer and closer, the cheap ones first.

    What fails is rejected by bounds that are as close as can be, for of the rejected the closest are shown.
    """
    coarse, fine = _BLOCKS
    steps = []
    if not nearness:
        steps.append(_Step(by_few_blocks, coarse, _by_heat, only_passing=True))
    steps += [_Step(closer_in_blocks, count, _by_heat) for count in (coarse, fine)]
    if case.staged:
        steps.append(_Step(closer_power, fine, _by_power))
    steps += [_Step(closer_stored, count, _by_bus) for count in (_FEW_PIECES, _PIECES)]
    if case.staged or case.spec.supply.capacitance is None:
        steps.append(_Step(stored_by_segments, _PIECES, _by_bus))
    if not nearness:
        steps += [_Step(closer_above, count, _by_time, only_passing=True) for count in _SOME_PIECES]
    return [*steps, _Step(closer_above, _PIECES, _by_time)]


def _by_heat(case: _Case, left: list[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    """Candidates whose winding, voltage or power is open, and whose course of temperatures is known."""
    found: NDArray[np.bool_] = np.logical_or.reduce([x for k, x in enumerate(left) if k not in _NOT_BY_HEAT])
    return found & case.told


def _by_power(case: _Case, left: list[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    """Those of them whose power is."""
    found: NDArray[np.bool_] = np.logical_or.reduce([np.zeros_like(case.told), *left[_POWER:]])
    return found & case.told


def _by_bus(_: _Case, left: list[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    return left[_BUS]


def _by_time(_: _Case, left: list[NDArray[np.bool_]]) -> NDArray[np.bool_]:
    return left[_WINDING]


def _of_some(case: _Case, mask: NDArray[np.bool_], found: Pair, step: _Step) -> Pair:
    """Closer bounds of some candidates, as many at a time as have room."""
    spec, cycle, demand, heating, *others = case.bounded(mask)
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    columns, sides = (demand, heating, *others), (on(side, mask) for side in found)
    closer, size = partial(step.closer, spec, cycle, count=step.pieces), max(_CELLS // step.pieces, _TOGETHER)
    few: Pair = at_a_time(len(demand.rms_current), size, closer, *columns, *sides)
    return few


def _replaced(found: Pair, mask: NDArray[Any], few: Sequence[Moments]) -> Pair:
    """Bounds with those of some candidates replaced."""
    rows = _numbers(mask)
    low, high = (replaced(old, rows, new) for old, new in zip(found, few, strict=True))
    return low, high


def _numbers(rows: NDArray[Any]) -> NDArray[np.int64]:
    """Numbers of rows, of these or of a mask: they are quicker."""
    return np.flatnonzero(rows) if rows.dtype == bool else rows
