r"""Bounds of the energy that stays on the bus, without a waveform: they decide most drives whose supply takes not all.

What a motor returns is no more than what its load and its masses give back, function by function: the coefficients of
its torque are 0 or more (``motor_demand``). In pieces of the cycle current and speed bound the power on either side,

.. math:: P = R I^2 + k_t w I + |k_e - k_t|\,|w I| + V_l |I|,

the winding nowhere cooler and nowhere warmer than it may be. In pieces of a noisy cycle these bounds are wide: those in
which a drive may return most are taken segment by segment.
Symbols: R resistance [ohm], I current [A], w speed [rad/s], V_l loss of the stage per ampere [V].
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import DIRECTION, SPEED, AtGearhead
from drivesizer.physics.extremes import Envelope, refined
from drivesizer.physics.figures import product
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.several_belts import behind_one, heat_behind_one
from drivesizer.physics.stress import Heat, Parts, Stress, on
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.physics.waveform import most_stored
from drivesizer.search.columns.limits_over_time import Moments, Pair, kept_on_the_bus, warmest_passing
from drivesizer.spec.robot import RobotSpec

__all__ = ["closer_stored", "most_kept", "stored_by_segments"]

Array = NDArray[np.float64]
_CELLS = 1 << 16  # candidates times pieces in a block: what stays in the processor's cache
_ROUNDING = 1e-9  # of a figure
_SEGMENTS = 4096  # of a drive that are looked at one by one, the last pieces of them made full
_TOGETHER = 512  # of them one after the other, at least


def most_kept(spec: RobotSpec, cycle: AtGearhead, demand: Demands, motor: Any) -> Array:
    """Upper bound of the energy that stays on the bus: all that is returned over a cycle and not accepted.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    cycle
        The load cycle at the gearhead's output.
    demand
        Columns over candidates, of ``demands``.
    motor
        Columns over candidates by field name.

    Returns
    -------
    Array
        [J], shape (rows,); infinite where more may be returned than is drawn, or that is unknown.
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


def closer_stored(
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
    """Bounds of the energy that stays on the bus from a cycle in so many pieces, no wider than they are.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As ``limits_over_time.exact`` takes them.
    low, high
        Bounds over the waveform, of ``waveform_bounds.bounds``.
    count
        Of pieces at most.

    Returns
    -------
    Pair
        Lower and upper bounds.
    """
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    losing = _losing(spec, cycle, demand, heating, stresses, parts, high)
    found = _stored(cycle, cycle.envelope(count), demand, losing, kept_on_the_bus(spec))
    return _no_wider(low, high, *found)


def stored_by_segments(
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
    """The same, the pieces in which each drive may return most segment by segment: some thousand show that much stays.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts, low, high, count
        As ``closer_stored`` takes them.

    Returns
    -------
    Pair
        Lower and upper bounds.
    """
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    losing, pieces = _losing(spec, cycle, demand, heating, stresses, parts, high), cycle.envelope(count)
    duration, functions = cycle.load_cycle.duration, cycle.base.six
    size = np.diff(np.append(pieces.first, len(duration)))
    found = np.full((2, len(losing.hot)), np.nan)
    for row in np.flatnonzero(np.isfinite(losing.hot)).tolist():
        some = slice(row, row + 1)
        one, of = on(demand, some), on(losing, some)
        returned = -_in_pieces(cycle, pieces, one, of)[0][0] * pieces.duration
        closely = refined(pieces, _returning(returned, size), duration, functions)
        found[:, some] = _stored(cycle, closely, one, of, kept_on_the_bus(spec))
    return _no_wider(low, high, *found)


def _returning(returned: Array, size: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers of the pieces, rising, that may return most: neighbours together, for what one returns another keeps."""
    starts = np.arange(0, len(size), max(_TOGETHER * len(size) // size.sum(), 1))
    most = np.add.reduceat(np.fmax(returned, 0.0), starts)
    order = np.argsort(-most, kind="stable")
    count = np.searchsorted(np.cumsum(np.add.reduceat(size, starts)[order]), _SEGMENTS) + 1
    chosen = np.isin(np.cumsum(np.isin(np.arange(len(size)), starts)) - 1, order[:count])
    return np.flatnonzero(chosen & (returned > 0.0))


def _no_wider(low: Moments, high: Moments, least: Array, most: Array) -> Pair:
    """Bounds with those of what is stored where these are closer."""
    most = np.where(np.isfinite(high.stored), np.fmin(most, high.stored), high.stored)
    return low._replace(stored=np.fmax(least, low.stored)), high._replace(stored=most)


class _Losing(NamedTuple):
    """Constants of the motor, and losses on the way to the bus: columns over candidates."""

    cool: Array  # ohm, of winding and stage at least
    hot: Array  # ohm, at most
    k_t: Array  # N*m/A
    surplus: Array  # V*s/rad, by what the back-EMF constant differs
    loss: Array  # W per ampere, of the stage


def _losing(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, parts: Parts, high: Moments
) -> _Losing:
    motor, stage = parts.motor, spec.feed(parts.controller, parts.brake).stage
    warmest = warmest_passing(spec, cycle, heating, stresses, motor, high.winding)
    cool, hot = (np.asarray(resistance_at(resistance_25(motor), T)) for T in (spec.environment.ambient, warmest))
    k_t, ohm, loss = np.broadcast_arrays(motor["torque_constant"], stage.resistance, stage.least_loss)
    return _Losing(cool + ohm, hot + ohm, k_t, np.abs(demand.back_emf - k_t), loss)


def _stored(cycle: AtGearhead, pieces: Envelope, demand: Demands, losing: _Losing, kept: float) -> tuple[Array, Array]:
    """Bounds of the energy that is stored at most, of drives that return less than they draw [J]; NaN unknown."""
    found, size = np.empty((2, len(losing.k_t))), max(_CELLS // len(pieces.duration), 1)
    for some in (slice(start, start + size) for start in range(0, found.shape[1], size)):
        powers = _in_pieces(cycle, pieces, on(demand, some), on(losing, some))
        for side, power in zip(found, reversed(powers), strict=True):
            side[some] = most_stored(np.minimum(-power, -kept * power) * pieces.duration)
    return found[0] * (1.0 - _ROUNDING), found[1] * (1.0 + _ROUNDING)


def _in_pieces(cycle: AtGearhead, pieces: Envelope, demand: Demands, losing: _Losing) -> tuple[Array, Array]:
    """Least and largest power of some drives into the stage in each piece [W]."""
    low, high = (points * cycle.scale for points in (pieces.low, pieces.high))
    of, ratio = _Losing(*(column[:, None] for column in losing)), demand.total_ratio[:, None]
    c = demand.coefficients / of.k_t
    current, speed = [product(c, x.T) for x in (low, high)], [ratio * x[:, SPEED] for x in (low, high)]
    return _powers(current, speed, of)


def _powers(current: list[Array], speed: list[Array], of: _Losing) -> tuple[Array, Array]:
    """Least and largest power into the stage in each piece [W], with the ends of current and of speed in it."""
    products = [a * b for a in current for b in speed]
    work = np.minimum.reduce(products), np.maximum.reduce(products)
    turning = [of.k_t * x + of.surplus * np.abs(x) for x in work]
    idle = np.where((work[0] < 0.0) & (work[1] > 0.0), 0.0, np.inf)  # between them one may turn nothing
    least, most = np.minimum.reduce([*turning, idle]), np.maximum(*turning)
    low, high = np.maximum(np.maximum(current[0], -current[1]), 0.0), np.maximum(current[1], -current[0])
    return least + (of.cool * low + of.loss) * low, most + (of.hot * high + of.loss) * high
