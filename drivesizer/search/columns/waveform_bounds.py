"""Bounds over the waveform, from moments and extremes alone: they decide most candidates.

What they leave undecided is computed from the waveform itself (``limits_over_time``), as is everything that is shown. A
bound never passes what the waveform would fail. Voltage and power grow with the winding's temperature wherever current
and voltage point the same way, and are straight in it: a winding that is nowhere cooler and nowhere warmer bounds them.
Symbols: R resistance [ohm], T temperature [K].
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import SPEED, AtGearhead, lacking
from drivesizer.physics.figures import product
from drivesizer.physics.heat_cycle_columns import coolest_winding, winding_bounds
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.several_belts import at_a_time, behind_one, heat_behind_one
from drivesizer.physics.stress import Heat, Parts, Stress, on, replaced, temperature_at_most, volts_of
from drivesizer.physics.thermal import resistance_25, resistance_at, two_bodies
from drivesizer.search.columns.bus_bounds import most_kept
from drivesizer.search.columns.limits_over_time import Moments, Pair, warmest_passing, waveform_limits
from drivesizer.search.columns.overload_bounds import above_bounds
from drivesizer.spec.robot import RobotSpec

__all__ = ["BehindOne", "at_most", "at_source", "bounds", "most_cold_power", "resisted"]

Array = NDArray[np.float64]
_CELLS = 1 << 16  # candidates times points at a time: what stays in the processor's cache


def bounds(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    *,
    nearness: bool = True,
) -> Pair:
    """Lower and upper bounds over the waveform, from moments and extremes alone.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    cycle
        The load cycle at the gearhead's output.
    demand, heating, stresses
        Columns over candidates, as ``demands``, ``heat`` and ``stress`` give them.
    parts
        The parts of each candidate.
    nearness
        Whether it matters how near to its limits a candidate is that passes: else wide bounds do for those that pass by
        them, and upper ones for those that are short of voltage.

    Returns
    -------
    Pair
        Lower and upper bounds, columns over candidates.
    """
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    nothing = np.full_like(demand.rms_current, np.nan)
    none = Moments(*[nothing] * len(Moments._fields))
    T_low, T_high = winding_limits(spec, cycle, demand, heating, stresses, parts.motor)
    shortest, longest = above_bounds(spec, cycle, demand, stresses, parts)
    low, high = none._replace(winding=T_low, above=shortest), none._replace(winding=T_high, above=longest)
    coolest = coolest_winding(
        two_bodies(parts.motor),
        spec.environment.ambient,
        demand.rms_current,
        cycle.load_cycle.total,
        heating.mean,
        T_low,
    )
    if nearness:
        return resisted(spec, cycle, demand, heating, stresses, parts, (low, high), coolest)
    low, high = _by_the_largest_current(spec, cycle, demand, heating, stresses, parts, (low, high))
    rows = np.flatnonzero(~np.logical_and.reduce([c.passed for c in waveform_limits(spec, high, high, parts)]))
    at = BehindOne(spec, cycle, on(demand, rows), on(heating, rows), on(stresses, rows), parts.on(rows))
    least = _at_least(at, on(low, rows), coolest[rows])
    short = next(c.failed for c in waveform_limits(spec, least, least, at.parts) if c.name == "supply_voltage")
    few = np.flatnonzero(~short)
    return replaced(low, rows, least), replaced(high, rows[few], at_most(at.on(few), on(high, rows[few])))


class BehindOne(NamedTuple):
    """A load case behind one belt and its candidates."""

    spec: RobotSpec
    cycle: AtGearhead
    demand: Demands
    heating: Heat
    stresses: Stress
    parts: Parts

    def on(self, rows: NDArray[np.int64]) -> BehindOne:
        """Some of the candidates."""
        columns = on(self.demand, rows), on(self.heating, rows), on(self.stresses, rows), self.parts.on(rows)
        return BehindOne(self.spec, self.cycle, *columns)


def _by_the_largest_current(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, parts: Parts, found: Pair
) -> Pair:
    """Bounds of the winding with wide ones of voltage and power: at the largest current all that warmth adds."""
    motor, (low, high) = parts.motor, found
    warmest = warmest_passing(spec, cycle, heating, stresses, motor, high.winding)
    ambient, R_25 = spec.environment.ambient, resistance_25(motor)
    warmer = np.maximum(np.asarray(resistance_at(R_25, warmest)) - np.asarray(resistance_at(R_25, ambient)), 0.0)
    cold, current = stresses.cold_voltage.value, stresses.current.value
    volts = cold + warmer * current
    low = low._replace(voltage=cold, stored=np.zeros_like(cold))
    high = high._replace(voltage=volts, stored=most_kept(spec, cycle, demand, motor))
    if not _limits_power(spec):
        return low, high
    most = current * volts + _most_beyond(cycle, demand, stresses, motor["torque_constant"])
    most = at_source(most, stresses, spec.feed(parts.controller, parts.brake))
    return low._replace(power=np.zeros_like(cold)), high._replace(power=most)


def resisted(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    found: Pair,
    coolest: Array,
) -> Pair:
    """Bounds of the winding with those of voltage and power put to them.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As in ``bounds``.
    found
        Bounds of the winding's peak, and all else that does not hang on its resistance.
    coolest
        A temperature below which the winding is at no moment [K].

    Returns
    -------
    Pair
        Lower and upper bounds.
    """
    at, (low, high) = BehindOne(spec, cycle, demand, heating, stresses, parts), found
    return _at_least(at, low, coolest), at_most(at, high)


def _at_least(at: BehindOne, low: Moments, coolest: Array) -> Moments:
    """Lower bounds of the winding with those of voltage and power put to them, by a winding nowhere cooler."""
    motor, feed = at.parts.motor, at.spec.feed(at.parts.controller, at.parts.brake)
    cool, k_t = np.asarray(resistance_at(resistance_25(motor), coolest)), motor["torque_constant"]
    leads = np.broadcast_to(feed.leads if at.spec.resists else 0.0, k_t.shape)
    least, power = _each(at.cycle, _least_at_points, k_t, at.demand, cool, leads, feed.broadcast(len(k_t)))
    low = low._replace(voltage=np.maximum(least, at.stresses.cold_voltage.value), stored=np.zeros_like(k_t))
    if not _limits_power(at.spec):
        return low
    return low._replace(power=of_the_source(power + feed.stage.standby, feed))


def at_most(at: BehindOne, high: Moments) -> Moments:
    """Upper bounds of the winding with those of voltage and power put to them.

    Parameters
    ----------
    at
        The load case and its candidates.
    high
        Upper bounds of the winding, and all else that does not hang on its resistance.

    Returns
    -------
    Moments
        Upper bounds.
    """
    spec, cycle, demand, heating, stresses, parts = at
    motor, feed, cold = parts.motor, spec.feed(parts.controller, parts.brake), stresses.cold_voltage.value
    warmest = warmest_passing(spec, cycle, heating, stresses, motor, high.winding)
    hot, k_t = np.asarray(resistance_at(resistance_25(motor), warmest)), motor["torque_constant"]
    at_hot = most = np.maximum(_each(cycle, _most_at_points, k_t, demand, hot), cold)
    if spec.resists:
        most = np.maximum(at_hot, _each(cycle, _most_at_points, k_t, demand, hot + feed.leads))
    high = high._replace(voltage=most, stored=most_kept(spec, cycle, demand, motor))
    if not _limits_power(spec):
        return high
    power = np.minimum(_each(cycle, _power_bound, k_t, demand, hot), stresses.current.value * at_hot)
    return high._replace(power=at_source(power + _most_beyond(cycle, demand, stresses, k_t), stresses, feed))


def _limits_power(spec: RobotSpec) -> bool:
    """Whether the supply has a limit of current or power."""
    return bool(spec.supply.current or spec.supply.power)


def _each(cycle: AtGearhead, compute: Callable[..., Any], *columns: Any) -> Any:
    """A function of the cycle's extreme points and candidates, of so many of these at a time as stay in the cache."""
    points = len(cycle.extremes.high) + len(cycle.extremes.low)
    return at_a_time(len(columns[0]), max(_CELLS // points, 1), partial(compute, cycle), *columns)


def most_cold_power(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, parts: Parts
) -> Array:
    """Upper bound of the electrical power while the winding is at the ambient temperature.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    cycle
        The load cycle at the gearhead's output.
    demand, heating, stresses
        Columns over candidates, as ``demands``, ``heat`` and ``stress`` give them.
    parts
        The parts of each candidate.

    Returns
    -------
    Array
        [W], shape (rows,).
    """
    cycle, demand = behind_one(cycle, demand)
    k_t = parts.motor["torque_constant"]
    cold = np.asarray(resistance_at(resistance_25(parts.motor), spec.environment.ambient))
    most = _each(cycle, _power_bound, k_t, demand, cold) + _most_beyond(cycle, demand, stresses, k_t)
    return at_source(most, stresses, spec.feed(parts.controller, parts.brake))


def at_source(power: Array, stresses: Stress, feed: Feed) -> Array:
    """Upper bound of the power out of the source, of one of the motor's power.

    Parameters
    ----------
    power
        Upper bound of the motor's power [W].
    stresses
        Columns over candidates, of ``stress``.
    feed
        Stages and supply.

    Returns
    -------
    Array
        [W], shape (rows,).
    """
    found: Array = of_the_source(power + feed.lost(stresses.current.value) + feed.stage.standby, feed)
    return found


def _most_beyond(cycle: AtGearhead, demand: Demands, stresses: Stress, k_t: Array) -> Array:
    """Bound of the power above V I [W] where two constants differ (``waveform.balanced``); infinite if unknown."""
    found = 2.0 * np.abs(demand.surplus(k_t)) * cycle.peak_speed * stresses.current.value
    return np.where(np.isnan(found), np.inf, found)


def _least_at_points(
    cycle: AtGearhead, k_t: Array, demand: Demands, cool: Array, leads: Array, feed: Feed
) -> tuple[Array, Array]:
    """Less than the largest voltage [V], by points where warmth only raises it, and power into the stage there [W]."""
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low])
    current, volts = _current_and_induced(points, k_t, demand)
    volts += cool * current
    power = (current * volts + feed.lost(current)).max(axis=0)
    volts += leads * current
    return np.where(current * volts > 0.0, np.abs(volts), 0.0).max(axis=0), power


def _most_at_points(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array) -> Array:
    """The largest voltage with a winding of one resistance [V]: peaks of what is linear in the functions lie there."""
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low])
    current, volts = _current_and_induced(points, k_t, demand)
    volts += hot * current
    found: Array = np.abs(volts).max(axis=0)
    rows = np.flatnonzero(lacking(demand.left_out))
    if len(rows):  # as far as what is unknown makes it no smaller
        some = volts_of(on(demand, rows), k_t[rows], hot[rows])
        found[rows] = cycle.peak(some, demand.left_out[rows]).value
    return found


def _current_and_induced(points: Array, k_t: Array, demand: Demands) -> tuple[Array, Array]:
    """Current [A] and induced voltage [V] at points of the functions: shape (points, candidates), few long rows."""
    current = product(points, (demand.coefficients / k_t[:, None]).T)
    return current, points[:, SPEED, None] * (demand.back_emf * demand.total_ratio)


def winding_limits(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, motor: Any
) -> tuple[Array, Array]:
    """Bounds of the winding's peak [K]; without time constants the mean, and what the largest current would make."""
    fast = cycle.peak_speed
    loss_peak = heating.friction * fast + heating.iron * fast**2
    found = winding_bounds(
        two_bodies(motor), spec.environment.ambient, demand.rms_current, stresses.current.value,
        cycle.load_cycle.total, heating.mean, loss_peak,
    )  # fmt: skip
    without = np.isnan(motor["winding_time_constant"]) | np.isnan(motor["motor_time_constant"])
    most = temperature_at_most(spec.environment.ambient, cycle, heating, stresses, motor)
    low, high = (np.where(without, x, bound) for x, bound in zip((heating.winding, most), found, strict=True))
    return low, high


def _power_bound(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array) -> Array:
    """More than the electrical power ever is [W]: where current and voltage are both positive, or both negative."""
    found = np.zeros(len(hot))
    for points, sign in ((cycle.extremes.above, 1.0), (cycle.extremes.below, -1.0)):
        current, volts = _current_and_induced(sign * points, k_t, demand)
        volts += hot * current
        found = np.maximum(found, (np.maximum(current, 0.0) * np.maximum(volts, 0.0)).max(axis=0))
    return found
