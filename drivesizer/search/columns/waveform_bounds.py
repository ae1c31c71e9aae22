"""Bounds over the waveform, from moments and extremes alone: they decide most candidates.

What they leave open is computed from the waveform itself (``exactly``), as is everything that is shown. A
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

from drivesizer.physics.cycle_at_gearhead import DIRECTION, SPEED, AtGearhead
from drivesizer.physics.figures import product
from drivesizer.physics.heat_cycle_columns import coolest_winding, winding_bounds
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.several_belts import at_a_time, behind_one, heat_behind_one
from drivesizer.physics.stress import Heat, Parts, Stress, temperature_at_most
from drivesizer.physics.thermal import resistance_25, resistance_at, two_bodies
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.limits_over_time import Moments, Pair, kept_on_the_bus, warmest_passing
from drivesizer.spec.robot import RobotSpec

__all__ = ["at_source", "bounds"]

Array = NDArray[np.float64]
_CELLS = 1 << 16  # candidates times points at a time: what stays in the processor's cache
_ROUNDING = 1e-9  # of a figure
_SOME = 1e-100  # s, more than nothing, of a time that is not known yet


def bounds(spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, parts: Parts) -> Pair:
    """Lower and upper bounds over the waveform; upper ones of windings that pass."""
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    motor, feed, ambient = parts.motor, spec.feed(parts.controller, parts.brake), spec.environment.ambient
    low, high = winding_limits(spec, cycle, demand, heating, stresses, motor)
    bodies, total = two_bodies(motor), cycle.load_cycle.total
    coolest = coolest_winding(bodies, ambient, demand.rms_current, total, heating.mean, low)
    warmest = warmest_passing(spec, cycle, heating, stresses, motor, high)
    k_t, R_25 = motor["torque_constant"], resistance_25(motor)
    cool, hot = (np.asarray(resistance_at(R_25, T)) for T in (coolest, warmest))
    leads = np.broadcast_to(feed.leads if spec.resists else 0.0, k_t.shape)
    volts, least_power = _each(cycle, _least_at_points, k_t, demand, cool, leads, feed.broadcast(len(k_t)))
    at_hot = most_volts = np.maximum(_each(cycle, _most_at_points, k_t, demand, hot), stresses.cold_voltage.value)
    if spec.resists:
        most_volts = np.maximum(at_hot, _each(cycle, _most_at_points, k_t, demand, hot + leads))
    nothing = np.full_like(k_t, np.nan)
    none, (shortest, longest) = Moments(*[nothing] * len(Moments._fields)), _above(spec, cycle, demand, stresses, parts)
    least = none._replace(
        winding=low, above=shortest, voltage=np.maximum(volts, stresses.cold_voltage.value), stored=np.zeros_like(k_t)
    )
    most = none._replace(winding=high, above=longest, voltage=most_volts, stored=_most_kept(spec, cycle, demand, motor))
    if spec.supply.current or spec.supply.power:
        power = np.minimum(_each(cycle, _most_power, k_t, demand, hot), stresses.current.value * at_hot)
        power = at_source(power + _most_beyond(cycle, demand, stresses, k_t), stresses, feed)
        least = least._replace(power=of_the_source(least_power + feed.stage.standby, feed))
        most = most._replace(power=power)
    return least, most


def _each(cycle: AtGearhead, compute: Callable[..., Any], *columns: Any) -> Any:
    """A function of the cycle's extreme points and candidates, of so many of these at a time as stay in the cache."""
    points = len(cycle.extremes.high) + len(cycle.extremes.low)
    return at_a_time(len(columns[0]), max(_CELLS // points, 1), partial(compute, cycle), *columns)


def at_source(power: Array, stresses: Stress, feed: Feed) -> Array:
    """Upper bound of the power out of the source, of one of the motor's power."""
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


def _most_power(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array) -> Array:
    """More than the electrical power ever is [W]: where current and voltage are both positive, or both negative."""
    found = np.zeros(len(hot))
    for points, sign in ((cycle.extremes.above, 1.0), (cycle.extremes.below, -1.0)):
        current, volts = _current_and_induced(sign * points, k_t, demand)
        volts += hot * current
        found = np.maximum(found, (np.maximum(current, 0.0) * np.maximum(volts, 0.0)).max(axis=0))
    return found


def _above(spec: RobotSpec, cycle: AtGearhead, demand: Demands, stresses: Stress, parts: Parts) -> tuple[Array, Array]:
    """Bounds of the time above the controller's current [s]: what is exceeded so long has that mean square."""
    peak, limit = stresses.current.value, controller_current(parts.controller, spec.environment.ambient)
    none, total = np.where(np.isnan(peak) | np.isnan(limit), np.nan, 0.0), cycle.load_cycle.total
    with np.errstate(divide="ignore", invalid="ignore"):
        most = total * np.minimum(np.square(demand.rms_current / limit) * (1.0 + _ROUNDING), 1.0)
    exceeded = peak > limit
    return np.where(exceeded, _SOME, none), np.where(exceeded, most, none)


def _most_kept(spec: RobotSpec, cycle: AtGearhead, demand: Demands, motor: Any) -> Array:
    """More than the energy that stays on the bus [J]: all that is returned over a cycle and not accepted.

    Infinite where more may be returned than is drawn, or that is unknown.
    """
    kept, nothing = kept_on_the_bus(spec), np.zeros_like(demand.rms_current)
    if not kept > 0.0:
        return nothing
    ratio, c, acting = demand.total_ratio, demand.coefficients, np.flatnonzero(cycle.braked)
    returned = ratio * product(c[:, acting], cycle.braked[acting, None])[:, 0]
    heat = np.asarray(resistance_at(resistance_25(motor), spec.environment.ambient)) * demand.rms_current**2
    work = ratio * product(c, cycle.moments[:, SPEED, None])[:, 0]
    draws = heat + work > _ROUNDING * (heat + np.abs(work))  # mean power at least, see ``least_drawn``
    most = np.where(draws, kept * returned * (1.0 + _ROUNDING), np.inf)
    return np.where(_brakes(cycle, c), most, nothing)


def _brakes(cycle: AtGearhead, coefficients: Array) -> NDArray[np.bool_]:
    """Whether the motor's torque is ever against its motion: otherwise nothing is regenerated."""
    against = np.zeros(len(coefficients), bool)
    for points, sign in ((cycle.extremes.low, +1.0), (cycle.extremes.high, -1.0)):
        moving = points[points[:, DIRECTION] == sign] * cycle.scale
        if len(moving):
            against |= (sign * product(coefficients, moving.T) < 0.0).any(axis=1)
    return against
