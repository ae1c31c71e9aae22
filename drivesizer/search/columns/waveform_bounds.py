"""Bounds over the waveform, from moments and extremes alone: they decide most candidates.

What they leave undecided is computed from the waveform itself (``limits_over_time``), as is everything that is shown. A
bound never passes what the waveform would fail. Voltage and power grow with the winding's temperature wherever current
and voltage point the same way, and are straight in it: a winding that is nowhere cooler and nowhere warmer bounds them.
Symbols: R resistance [ohm], T temperature [K].
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.extremes import Envelope
from drivesizer.physics.heat_cycle_columns import coolest_winding, winding_bounds
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.products import product
from drivesizer.physics.several_belts import at_a_time, behind_one, heat_behind_one
from drivesizer.physics.stress import Heat, Parts, Stress, temperature_at_most, volts_of
from drivesizer.physics.thermal import resistance_25, resistance_at, two_bodies
from drivesizer.physics.waveform import longest_run
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.bus_bounds import most_kept
from drivesizer.search.columns.limits_over_time import Moments, Pair, warmest_passing
from drivesizer.spec.robot import RobotSpec

__all__ = ["above_bounds", "at_source", "bounds", "closer_above", "most_cold_power", "resisted"]

Array = NDArray[np.float64]
_PIECES = 256  # of a cycle, that bound the time of overload at first
_CELLS = 1 << 16  # candidates times pieces in a block: what stays in the processor's cache
_SOME = 1e-300  # more than nothing, of an amount that is not known yet


def bounds(spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, parts: Parts) -> Pair:
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
    return resisted(spec, cycle, demand, heating, stresses, parts, (low, high), coolest)


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
    motor, (low, high) = parts.motor, found
    k_t = motor["torque_constant"]
    warmest = warmest_passing(spec, cycle, heating, stresses, motor, high.winding)
    cool, hot = (np.asarray(resistance_at(resistance_25(motor), T)) for T in (coolest, warmest))
    leads = np.broadcast_to(spec.feed(parts.controller, parts.brake).leads if spec.resists else 0.0, k_t.shape)
    cold_volts = stresses.cold_voltage.value
    least, at_hot, most_volts = _each(
        cycle, partial(_voltages, resists=spec.resists), k_t, demand, cool, hot, leads, cold_volts
    )
    low = low._replace(voltage=least)
    high = high._replace(voltage=most_volts)
    kept = most_kept(spec, cycle, demand, motor)
    low, high = low._replace(stored=np.zeros_like(k_t)), high._replace(stored=kept)
    if not (spec.supply.current or spec.supply.power):
        return low, high
    feed = spec.feed(parts.controller, parts.brake)
    least = _each(cycle, _corner_power, k_t, demand, cool, feed.broadcast(len(k_t))) + feed.stage.standby
    most = np.minimum(_each(cycle, _power_bound, k_t, demand, hot), stresses.current.value * at_hot)
    most = most + _most_beyond(cycle, demand, stresses, k_t)
    low = low._replace(power=of_the_source(least, feed))
    high = high._replace(power=at_source(most, stresses, feed))
    return low, high


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


def _voltages(
    cycle: AtGearhead, k_t: Array, demand: Demands, cool: Array, hot: Array, leads: Array, cold: Array, *, resists: bool
) -> tuple[Array, Array, Array]:
    """Less than the largest voltage, and more than it without and with what ``leads`` take [V]."""
    at_hot = most = np.maximum(cycle.peak(volts_of(demand, k_t, hot), demand.left_out).value, cold)
    if resists:
        most = np.maximum(at_hot, cycle.peak(volts_of(demand, k_t, hot + leads), demand.left_out).value)
    return _least_voltage(cycle, demand, cool + leads, k_t, cold), at_hot, most


def _least_voltage(cycle: AtGearhead, demand: Demands, cool: Array, k_t: Array, cold: Array) -> Array:
    """Less than the largest voltage: cold at the start, or at a bound where a warmer winding only raises it."""
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low]) * cycle.scale
    volts = product(points, volts_of(demand, k_t, cool).T)  # shape (points, candidates): few long rows
    more = np.where(product(points, demand.coefficients.T) * volts > 0.0, np.abs(volts), 0.0)
    least: Array = np.maximum(more.max(axis=0), cold)
    return least


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


def above_bounds(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, stresses: Stress, parts: Parts, pieces: int = _PIECES
) -> tuple[Array, Array]:
    """Bounds of the uninterrupted time above the continuous current, from a cycle in so many pieces at most [s].

    That of the pieces that certainly are above, and of those that may be.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    cycle
        The load cycle at the gearhead's output.
    demand, stresses
        Columns over candidates, of ``demands`` and ``stress``.
    parts
        The parts of each candidate, with its controller.
    pieces
        Into which the cycle is cut, at most.

    Returns
    -------
    tuple[Array, Array]
        Lower and upper bound [s], each of shape (rows,).
    """
    peak, limit = stresses.current.value, controller_current(parts.controller, spec.environment.ambient)
    cycle, demand = behind_one(cycle, demand)
    low = np.where(np.isnan(peak) | np.isnan(limit), np.nan, 0.0)
    high = low.copy()
    rows = np.flatnonzero(peak > limit)
    if len(rows):
        current = demand.coefficients.take(rows, axis=0) / parts.motor["torque_constant"][rows, None]
        low[rows], high[rows] = _times_above(cycle.envelope(pieces), current, limit[rows, None])
    return low, high


def closer_above(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    _: Heat,
    stresses: Stress,
    parts: Parts,
    low: Moments,
    high: Moments,
    *,
    count: int,
) -> Pair:
    """Bounds with those of the time of overload from a cycle in so many pieces, see ``above_bounds``.

    Parameters
    ----------
    spec, cycle, demand, stresses, parts
        As in ``bounds``.
    low, high
        Its result.
    count
        Of pieces at most.

    Returns
    -------
    Pair
        Lower and upper bounds.
    """
    shortest, longest = above_bounds(spec, cycle, demand, stresses, parts, count)
    return low._replace(above=shortest), high._replace(above=longest)


def _times_above(found: Envelope, current: Array, limit: Array) -> tuple[Array, Array]:
    """Bounds of the time for which currents are above a limit, so many candidates at a time [s]."""
    low, high = np.empty((2, len(limit)))
    size = max(_CELLS // len(found.duration), 1)
    for some in (slice(first, first + size) for first in range(0, len(limit), size)):
        low[some], high[some] = _runs_above(found, current[some], limit[some])
    return low, high


def _runs_above(found: Envelope, current: Array, limit: Array) -> tuple[Array, Array]:
    """Longest uninterrupted time that currents are certainly and perhaps above a limit [s]."""
    top, bottom = product(current, found.high.T), product(current, found.low.T)
    certainly, perhaps = np.maximum(bottom, -top) > limit, np.maximum(top, -bottom) > limit
    pieces = found.duration, np.zeros_like(found.duration), found.duration
    least, ever = np.full(len(current), _SOME), np.flatnonzero(certainly.any(axis=1))
    if len(ever):
        least[ever] = np.maximum(longest_run(*pieces, certainly[ever]), _SOME)
    return least, longest_run(*pieces, perhaps)


def _corner_power(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array, feed: Feed) -> Array:
    """Largest power into the stage at the extreme points [W]: between them it may be more."""
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low]) * cycle.scale
    current = product(points, (demand.coefficients / k_t[:, None]).T)
    power = current * product(points, volts_of(demand, k_t, hot).T) + feed.lost(current)
    found: Array = power.max(axis=0)
    return found


def _power_bound(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array) -> Array:
    """More than the electrical power ever is [W]: where current and voltage are both positive, or both negative."""
    current, volts = (demand.coefficients / k_t[:, None] * cycle.scale, volts_of(demand, k_t, hot) * cycle.scale)
    found = np.zeros(len(hot))
    for points, sign in ((cycle.extremes.above, 1.0), (cycle.extremes.below, -1.0)):
        both = [np.maximum(sign * product(points, c.T), 0.0) for c in (current, volts)]
        found = np.maximum(found, (both[0] * both[1]).max(axis=0))
    return found
