"""Bounds of winding, voltage and power over a long cycle from blocks of it, closer than those of ``waveform_bounds``.

In the few blocks in which the power may be largest it is bounded moment by moment. What is still undecided then is
computed from the waveform itself (``limits_over_time``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import SPEED, AtGearhead
from drivesizer.physics.extremes import Envelope, distinct, highest_and_lowest
from drivesizer.physics.figures import product
from drivesizer.physics.heat_bounds import Blocks, Bracket, blocks, bracket, merged
from drivesizer.physics.load_cycle import places
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, at_input, of_the_source
from drivesizer.physics.several_belts import behind_one, heat_behind_one
from drivesizer.physics.stress import Heat, Parts, Stress, volts_of
from drivesizer.physics.thermal import resistance_25, resistance_at, two_bodies
from drivesizer.physics.waveform import Wave, balanced, highest_powers
from drivesizer.search.columns.limits_over_time import Moments, Pair
from drivesizer.search.columns.waveform_bounds import BehindOne, at_most, at_source, resisted
from drivesizer.spec.robot import RobotSpec

__all__ = ["by_few_blocks", "by_segments", "closer", "closer_power"]

Array = NDArray[np.float64]
_ROUNDING = 1e-12  # share of a power that rounding may take
_ALIKE = 1e-9  # and more than that
_FEW = 8  # blocks that pass most of what passes
_PIECES = 1024  # of a cycle, by which it is found where a drive's power may be largest
_KEPT = 1 << 18  # drives times blocks of which temperatures are kept
_AT_ONCE = 1 << 15  # drives times segments of which the power is computed


def _bracketed(cycle: AtGearhead, demand: Demands, heating: Heat, parts: Parts, ambient: float, count: int) -> Bracket:
    """Bounds of the winding over a long cycle from so many blocks [K]: closer than those of ``bounds``.

    Those of the few candidates that were looked at last are kept: their power is what is looked at next.
    """
    current, bodies = demand.coefficients / parts.motor["torque_constant"][:, None], two_bodies(parts.motor)
    constants = (ambient, bodies.R_25, bodies.R_th1, bodies.R_th2, bodies.tau_w, bodies.tau_h)
    figures = [np.broadcast_to(x, len(current)) for x in (*constants, heating.friction, heating.iron)]
    keys = [row.tobytes() for row in np.column_stack([current, *figures])]
    store, name = cycle.base.coarse, ("bracket", count)
    known, kept = store.get(name, ({}, None))
    if kept is not None and all(key in known for key in keys):
        rows = [known[key] for key in keys]
        return Bracket(*(column[rows] for column in kept))
    found = bracket(bodies, ambient, _blocks(cycle, count), current, heating.friction, heating.iron)
    if len(keys) * count <= _KEPT:
        store[name] = {key: row for row, key in enumerate(keys)}, found
    return found


def _blocks(cycle: AtGearhead, count: int) -> Blocks:
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
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
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


def by_few_blocks(
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
    """Upper bounds of winding, voltage and power from few blocks, made of so many: they cost much less.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As in ``bounds``.
    low, high
        Its result.
    count
        Of blocks at most that are put together.

    Returns
    -------
    Pair
        The lower bounds as they were, and the upper ones.
    """
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    fine, store, name = _blocks(cycle, count), cycle.base.coarse, ("few blocks", count)
    if name not in store:
        store[name] = merged(fine, min(_FEW, len(fine.duration)))
    current = demand.coefficients / parts.motor["torque_constant"][:, None]
    bodies, losses = two_bodies(parts.motor), (heating.friction, heating.iron)
    T = bracket(bodies, spec.environment.ambient, store[name], current, *losses)
    at = BehindOne(spec, cycle, demand, heating, stresses, parts)
    return low, at_most(at, high._replace(winding=T.upper))


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
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    T = _bracketed(cycle, demand, heating, parts, spec.environment.ambient, len(cycle.load_cycle.duration))
    pair = low._replace(winding=T.lower), high._replace(winding=T.upper)
    return resisted(spec, cycle, demand, heating, stresses, parts, pair, T.coolest.min(axis=1))


def _in_blocks(
    cycle: AtGearhead, demand: Demands, motor: Any, T: Bracket, pieces: Blocks, leads: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Bounds of the motor's largest power [W] and voltage [V], the winding no cooler and no warmer than it may be."""
    k_t = motor["torque_constant"]
    c, induced = demand.coefficients / k_t[:, None], volts_of(demand, k_t, np.zeros_like(k_t))
    ohms = _resistances(motor, T)
    top, bottom, high, low = _ends_in_blocks(demand, k_t, ohms, (pieces.most, pieces.least))
    with np.errstate(invalid="ignore"):  # of what runs away
        volts_above = high + leads * np.maximum(top, 0.0)
        volts_below = low + leads * np.minimum(bottom, 0.0)
    powers = _most_in_blocks(demand, k_t, (top, bottom, high, low), (pieces.most, pieces.least))
    surplus = demand.surplus(k_t)
    rows = np.flatnonzero(surplus != 0.0)  # an unknown one is among them
    most = powers.max(axis=1), np.maximum(volts_above.max(axis=1), -volts_below.min(axis=1))
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low])
    time = np.concatenate([cycle.extremes.high_time, cycle.extremes.low_time])
    place = np.minimum(np.searchsorted(np.cumsum(pieces.duration), time), len(pieces.duration) - 1)
    current = product(c, points.T)
    volts = product(induced, points.T) + ohms[0][:, place] * current
    power = current * volts
    least = np.where(power > 0.0, np.abs(volts + leads * current), 0.0).max(axis=1)
    power[rows] += _beyond(surplus[rows, None] * points[:, SPEED] * current[rows])
    return (power.max(axis=1), least), most


def _resistances(motor: Any, T: Bracket) -> tuple[Array, Array]:
    """Of windings in blocks, nowhere cooler and nowhere warmer than they may be [ohm]."""
    R_25 = np.asarray(resistance_25(motor))[:, None]
    return np.asarray(resistance_at(R_25, T.coolest)), np.asarray(resistance_at(R_25, T.warmest))


def _ends_in_blocks(
    demand: Demands, k_t: Array, ohms: tuple[Array, Array], reached: tuple[Array, Array]
) -> tuple[Array, Array, Array, Array]:
    """Largest and smallest current [A] and voltage [V] that there may be in blocks, by what the functions reach."""
    c, induced = demand.coefficients / k_t[:, None], volts_of(demand, k_t, np.zeros_like(k_t))
    (cool, hot), (most, least) = ohms, reached
    top, bottom = product(c, most.T), product(c, least.T)
    with np.errstate(invalid="ignore"):  # of what runs away
        high = product(induced, most.T) + np.maximum(cool * top, hot * top)
        low = product(induced, least.T) + np.minimum(cool * bottom, hot * bottom)
    return top, bottom, high, low


def _most_in_blocks(
    demand: Demands, k_t: Array, ends: tuple[Array, Array, Array, Array], reached: tuple[Array, Array]
) -> Array:
    """More than the motor's power is in each block [W]."""
    top, bottom, high, low = ends
    with np.errstate(invalid="ignore"):  # of what runs away
        both = np.maximum(top, 0.0) * np.maximum(high, 0.0), np.minimum(bottom, 0.0) * np.minimum(low, 0.0)
    powers: Array = np.maximum(*both)
    surplus = demand.surplus(k_t)
    rows = np.flatnonzero(surplus != 0.0)  # an unknown one is among them
    turning = [surplus[rows, None] * functions[:, SPEED] for functions in reached]
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

    A piece of a block counts in which the power may exceed what it certainly reaches somewhere. In it current and
    voltage of each moment are known but for the winding's resistance, by which the power rises.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        As in ``bounds``.
    low, high
        Its result, or that of ``closer``.
    count
        Of blocks at most, in which the winding is bounded.

    Returns
    -------
    Pair
        Lower and upper bounds, no wider than they were.
    """
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    T, pieces = _bracketed(cycle, demand, heating, parts, spec.environment.ambient, count), _pieces(cycle, count)
    owner = np.searchsorted(_blocks(cycle, count).first, pieces.first, side="right") - 1
    cool, hot = _resistances(parts.motor, T)
    ohms, k_t = (cool[:, owner], hot[:, owner]), parts.motor["torque_constant"]
    feed = spec.feed(parts.controller, parts.brake).broadcast(len(low.power))
    may = _may_be_largest(demand, k_t, ohms, pieces, feed, low.power)
    may &= np.isfinite(low.power + T.warmest.max(axis=1))[:, None]
    least, most = low.power.copy(), high.power.copy()
    for some in _few_rows(may, pieces, len(cycle.load_cycle.duration)):
        rows, found = some.rows, _powers_at(cycle, some, ohms, demand, k_t, feed)
        least[rows], most[rows] = np.fmax(least[rows], found[0]), np.fmin(most[rows], found[1])
    return low._replace(power=least), high._replace(power=most)


def _may_be_largest(
    demand: Demands, k_t: Array, ohms: tuple[Array, Array], pieces: Envelope, feed: Feed, least: Array
) -> NDArray[np.bool_]:
    """In which pieces the power out of the source may be more than it certainly is somewhere: (candidates, pieces)."""
    ends = _ends_in_blocks(demand, k_t, ohms, (pieces.high, pieces.low))
    powers = _most_in_blocks(demand, k_t, ends, (pieces.high, pieces.low))
    each, largest = feed.reshaped((-1, 1)), np.maximum(np.abs(ends[0]), np.abs(ends[1]))
    reached = least - _ALIKE * np.abs(least)  # so that rounding leaves out no piece
    with np.errstate(invalid="ignore"):  # of what runs away
        most = of_the_source(powers + each.lost(largest) + each.stage.standby, each)
        found: NDArray[np.bool_] = ~(most < reached[:, None])
    return found


def _pieces(cycle: AtGearhead, count: int) -> Envelope:
    """The blocks in pieces, and what the functions reach in each."""
    store, name = cycle.base.coarse, ("pieces of blocks", count)
    if name not in store:
        duration = cycle.load_cycle.duration
        starts = np.linspace(0, len(duration), _PIECES, endpoint=False).astype(np.int64)
        starts = distinct(np.append(starts, _blocks(cycle, count).first))
        reached = highest_and_lowest(len(duration), cycle.base.six, starts)
        store[name] = Envelope(np.add.reduceat(duration, starts), *reached, starts)
    found: Envelope = store[name]
    return found


class _Some(NamedTuple):
    """Segments of some drives, those of one after those of another."""

    rows: NDArray[np.int64]  # of the drives
    first: NDArray[np.int64]  # where the segments of each begin
    drive: NDArray[np.int64]  # row of each segment's drive
    piece: NDArray[np.int64]  # in which it is
    segment: NDArray[np.int64]


def _few_rows(may: NDArray[np.bool_], pieces: Envelope, count: int) -> Iterator[_Some]:
    """The segments of the pieces that count of each drive, of a few drives at a time."""
    size = np.diff(np.append(pieces.first, count))
    every = may.astype(np.int64) @ size
    for drives in _split(every):
        if not every[drives].any():
            continue
        row, piece = np.nonzero(may[drives])
        drive, place = places(size[piece])
        rows = drives.start + row[drive]
        first = np.flatnonzero(np.append(True, rows[1:] != rows[:-1]))
        yield _Some(rows[first], first, rows, piece[drive], pieces.first[piece[drive]] + place)


def _split(sizes: NDArray[np.int64]) -> list[slice]:
    """Rows that together are of no more than so much, one at least."""
    ends = np.cumsum(sizes)
    found, start = list[slice](), 0
    while start < len(sizes):
        stop = max(int(np.searchsorted(ends, ends[start] - sizes[start] + _AT_ONCE, side="right")), start + 1)
        found.append(slice(start, stop))
        start = stop
    return found


def _powers_at(
    cycle: AtGearhead, some: _Some, ohms: Sequence[Array], demand: Demands, k_t: Array, feed: Feed
) -> tuple[Array, Array]:
    """Bounds of the largest power out of the source of drives in their segments [W]."""
    functions, duration = cycle.base.six[some.segment], cycle.load_cycle.duration[some.segment][:, None]
    c, induced = demand.coefficients / k_t[:, None], volts_of(demand, k_t, np.zeros_like(k_t))
    current, volts = (np.einsum("nef,nf->ne", functions, x[some.drive])[:, None] for x in (c, induced))
    surplus, speed, of = demand.surplus(k_t)[some.drive], functions[:, None, :, SPEED], feed.on(some.drive)
    found = []
    for R, sign in zip(ohms, (-1.0, 1.0), strict=True):
        at = Wave(duration, current, volts + R[some.drive, some.piece][:, None, None] * current)
        inner = at_input(balanced(at, surplus, speed), of.stage)
        power = np.maximum.reduceat(highest_powers(inner)[0].max(axis=1), some.first)
        source = of_the_source(power + of.stage.standby[some.first], feed.on(some.rows))
        found.append(source + sign * _ROUNDING * np.abs(source))
    return found[0], found[1]


def _beyond(work: Array) -> Array:
    """Power above V I [W] where constants differ, by the power of that difference (``waveform.balanced``)."""
    found: Array = np.maximum(-2.0 * work, 0.0)
    return found
