"""Bounds of winding, voltage and power over a long cycle from blocks of it, closer than those of ``waveform_bounds``.

In the few blocks in which the power may be largest it is bounded moment by moment. What is still undecided then is
computed from the waveform itself (``limits_over_time``).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import SPEED, AtGearhead
from drivesizer.physics.heat_bounds import Blocks, Bracket, blocks, bracket
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source, source_power
from drivesizer.physics.products import product
from drivesizer.physics.several_belts import scales
from drivesizer.physics.stress import Heat, Parts, Stress, on, volts_of
from drivesizer.physics.thermal import resistance_25, resistance_at, two_bodies
from drivesizer.physics.waveform import balanced, wave
from drivesizer.search.columns.limits_over_time import Moments, Pair
from drivesizer.search.columns.waveform_bounds import at_source, resisted
from drivesizer.spec.robot import RobotSpec

__all__ = ["by_segments", "closer", "closer_power"]

Array = NDArray[np.float64]
_ROUNDING = 1e-12  # share of a power that rounding may take
_ALIKE = 1e-9  # and more than that


def _bracketed(cycle: AtGearhead, demand: Demands, heating: Heat, parts: Parts, ambient: float, count: int) -> Bracket:
    """Bounds of the winding over a long cycle from so many blocks [K]: closer than those of ``bounds``."""
    current = demand.coefficients / parts.motor["torque_constant"][:, None]
    return bracket(two_bodies(parts.motor), ambient, _blocks(cycle, count), current, heating.friction, heating.iron)


def _blocks(cycle: AtGearhead, count: int) -> Blocks:
    """The cycle in so many blocks at most."""
    return _blocks_before_belt(cycle, count).behind(cycle.scale)


def _blocks_before_belt(cycle: AtGearhead, count: int) -> Blocks:
    """The cycle behind a belt of ratio 1 in so many blocks at most."""
    store, name = cycle.base.coarse, ("blocks", count)
    if name not in store:
        store[name] = blocks(cycle.load_cycle.duration, cycle.base.six, count)
    found: Blocks = store[name]
    return found


def closer(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    low: Moments,
    high: Moments,
    *,
    count: int,
) -> Pair:
    """Bounds of winding and voltage over a long cycle from so many blocks of it, closer than those of ``bounds``.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As in ``bounds``.
    low, high
        Its result.
    count
        Of blocks at most.

    Returns
    -------
    Pair
        Lower and upper bounds, no wider than they were.
    """
    T = _bracketed(cycle, demand, heating, parts, spec.environment.ambient, count)
    pair = low._replace(winding=T.lower), high._replace(winding=T.upper)
    low, high = resisted(spec, cycle, demand, heating, stresses, parts, pair, T.coolest.min(axis=1))
    feed = spec.feed(parts.controller, parts.brake)
    leads = np.broadcast_to(feed.leads, T.lower.shape)
    least, most = _in_blocks(cycle, demand, parts.motor, T, _blocks(cycle, count), leads[:, None])
    least = of_the_source(least[0] + feed.stage.standby, feed), least[1]
    most = at_source(most[0], stresses, feed), np.maximum(most[1], stresses.cold_voltage.value)
    for name, one, other in zip(("power", "voltage"), least, most, strict=True):
        low = low._replace(**{name: np.fmax(getattr(low, name), one)})
        high = high._replace(**{name: np.fmin(getattr(high, name), np.where(np.isnan(other), np.inf, other))})
    return low, high


def by_segments(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    low: Moments,
    high: Moments,
) -> Pair:
    """Bounds over a short cycle from its segments, where a winding's course takes many pieces of each.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As in ``bounds``; the candidates may be behind several belts.
    low, high
        Its result.

    Returns
    -------
    Pair
        Lower and upper bounds.
    """
    scale = scales(cycle, len(demand.rms_current))
    current = demand.coefficients * scale / parts.motor["torque_constant"][:, None]
    fast, each = scale[:, SPEED], _blocks_before_belt(cycle, len(cycle.load_cycle.duration))
    losses = heating.friction * fast, heating.iron * fast**2
    T = bracket(two_bodies(parts.motor), spec.environment.ambient, each, current, *losses)
    pair = low._replace(winding=T.lower), high._replace(winding=T.upper)
    return resisted(spec, cycle, demand, heating, stresses, parts, pair, T.coolest.min(axis=1))


def _in_blocks(
    cycle: AtGearhead, demand: Demands, motor: Any, T: Bracket, pieces: Blocks, leads: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Bounds of the motor's largest power [W] and voltage [V], the winding no cooler and no warmer than it may be."""
    k_t = motor["torque_constant"]
    c, induced = demand.coefficients / k_t[:, None], volts_of(demand, k_t, np.zeros_like(k_t))
    cool, _ = _resistances(motor, T)
    top, bottom, high, low = _ends_in_blocks(demand, motor, T, pieces)
    with np.errstate(invalid="ignore"):  # of what runs away
        volts_above = high + leads * np.maximum(top, 0.0)
        volts_below = low + leads * np.minimum(bottom, 0.0)
    powers = _most_in_blocks(demand, k_t, (top, bottom, high, low), pieces)
    surplus = demand.surplus(k_t)
    rows = np.flatnonzero(surplus != 0.0)  # an unknown one is among them
    most = powers.max(axis=1), np.maximum(volts_above.max(axis=1), -volts_below.min(axis=1))
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low]) * cycle.scale
    time = np.concatenate([cycle.extremes.high_time, cycle.extremes.low_time])
    place = np.minimum(np.searchsorted(np.cumsum(pieces.duration), time), len(pieces.duration) - 1)
    current = product(c, points.T)
    volts = product(induced, points.T) + cool[:, place] * current
    power = current * volts
    least = np.where(power > 0.0, np.abs(volts + leads * current), 0.0).max(axis=1)
    power[rows] += _beyond(surplus[rows, None] * points[:, SPEED] * current[rows])
    return (power.max(axis=1), least), most


def _resistances(motor: Any, T: Bracket) -> tuple[Array, Array]:
    """Of windings in blocks, nowhere cooler and nowhere warmer than they may be [ohm]."""
    R_25 = np.asarray(resistance_25(motor))[:, None]
    return np.asarray(resistance_at(R_25, T.coolest)), np.asarray(resistance_at(R_25, T.warmest))


def _ends_in_blocks(demand: Demands, motor: Any, T: Bracket, pieces: Blocks) -> tuple[Array, Array, Array, Array]:
    """Largest and smallest current [A] and voltage [V] that there may be in each block."""
    k_t = motor["torque_constant"]
    c, induced = demand.coefficients / k_t[:, None], volts_of(demand, k_t, np.zeros_like(k_t))
    cool, hot = _resistances(motor, T)
    top, bottom = product(c, pieces.most.T), product(c, pieces.least.T)
    with np.errstate(invalid="ignore"):  # of what runs away
        high = product(induced, pieces.most.T) + np.maximum(cool * top, hot * top)
        low = product(induced, pieces.least.T) + np.minimum(cool * bottom, hot * bottom)
    return top, bottom, high, low


def _most_in_blocks(demand: Demands, k_t: Array, ends: tuple[Array, Array, Array, Array], pieces: Blocks) -> Array:
    """More than the motor's power is in each block [W]."""
    top, bottom, high, low = ends
    with np.errstate(invalid="ignore"):  # of what runs away
        both = np.maximum(top, 0.0) * np.maximum(high, 0.0), np.minimum(bottom, 0.0) * np.minimum(low, 0.0)
    powers: Array = np.maximum(*both)
    surplus = demand.surplus(k_t)
    rows = np.flatnonzero(surplus != 0.0)  # an unknown one is among them
    turning = surplus[rows, None] * pieces.most[:, SPEED], surplus[rows, None] * pieces.least[:, SPEED]
    powers[rows] += _beyond(np.minimum.reduce([a * b[rows] for a in turning for b in (top, bottom)]))
    return powers


def closer_power(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    low: Moments,
    high: Moments,
    *,
    count: int,
) -> Pair:
    """Bounds of the power over a long cycle, closer than those of ``closer``: of the moments in the blocks that decide.

    A block counts in which the power may exceed what it certainly reaches somewhere. In it current and voltage of each
    moment are known but for the winding's resistance, by which the power rises.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As in ``bounds``.
    low, high
        Its result, or that of ``closer``.
    count
        Of blocks at most.

    Returns
    -------
    Pair
        Lower and upper bounds, no wider than they were.
    """
    pieces, feed = _blocks(cycle, count), spec.feed(parts.controller, parts.brake).broadcast(len(low.power))
    T = _bracketed(cycle, demand, heating, parts, spec.environment.ambient, count)
    ends = _ends_in_blocks(demand, parts.motor, T, pieces)
    powers = _most_in_blocks(demand, parts.motor["torque_constant"], ends, pieces)
    largest = np.maximum(np.abs(ends[0]), np.abs(ends[1]))
    each = feed.reshaped((-1, 1))
    reached = low.power - _ALIKE * np.abs(low.power)  # so that rounding leaves out no block
    with np.errstate(invalid="ignore"):  # of what runs away
        may = ~(of_the_source(powers + each.lost(largest) + each.stage.standby, each) < reached[:, None])
    least, most = low.power.copy(), high.power.copy()
    for row in np.flatnonzero(np.isfinite(low.power + T.warmest.max(axis=1))).tolist():
        some = slice(row, row + 1)
        one = feed.on(some), on(demand, some), parts.motor.on(some), _resistances(parts.motor.on(some), on(T, some))
        found = _powers_at(cycle, pieces, np.flatnonzero(may[row]), *one)
        least[row], most[row] = np.fmax(least[row], found[0]), np.fmin(most[row], found[1])
    return low._replace(power=least), high._replace(power=most)


def _powers_at(
    cycle: AtGearhead,
    pieces: Blocks,
    blocks: NDArray[np.int64],
    feed: Feed,
    demand: Demands,
    motor: Any,
    resistances: tuple[Array, Array],
) -> tuple[float, float]:
    """Bounds of the largest power out of the source in some blocks of one drive [W]; NaN where there is none."""
    ends = np.append(pieces.first, len(cycle.load_cycle.duration))
    segments = np.concatenate([np.arange(ends[k], ends[k + 1]) for k in blocks])
    owner = np.repeat(blocks, np.diff(ends)[blocks])
    functions, k_t = cycle.base.six[segments] * cycle.scale, motor["torque_constant"]
    induced = volts_of(demand, k_t, np.zeros_like(k_t))
    flows = wave(cycle.load_cycle.duration[segments], functions, demand.coefficients, induced, k_t)
    surplus, speed = demand.surplus(k_t), functions[:, :, SPEED]
    found = []
    for R, sign in zip(resistances, (-1.0, 1.0), strict=True):
        at = flows._replace(voltage=flows.voltage + R[:, owner, None] * flows.current)
        power = float(source_power(balanced(at, surplus, speed), feed)[0][0])
        found.append(power + sign * _ROUNDING * abs(power))
    return found[0], found[1]


def _beyond(work: Array) -> Array:
    """Power above V I [W] where constants differ, by the power of that difference (``waveform.balanced``)."""
    found: Array = np.maximum(-2.0 * work, 0.0)
    return found
