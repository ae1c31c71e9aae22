"""What needs the current of each moment, for one set over many samples: winding, power, time of overload.

As ``limits_over_time`` has it for many sets over one cycle.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.heat_course import of_pieces
from drivesizer.physics.heat_cycle import highest, periodic
from drivesizer.physics.heat_cycle_columns import each_figure
from drivesizer.physics.load_cycle import mean_product
from drivesizer.physics.motor_demand import Demands, piece_counts, places
from drivesizer.physics.stress import Heat, Parts, Stress, on
from drivesizer.physics.thermal import TwoBodies, resistance_at, two_bodies
from drivesizer.physics.waveform import Wave, balanced, energy, largest_power, longest_above
from drivesizer.search.columns.limits_over_time import (
    Moments,
    Pair,
    between_bounds,
    hottest,
    kept_on_the_bus,
    while_at_most,
)
from drivesizer.search.uncertainty.sampled_cycle import AtSamples

__all__ = ["moments"]

Array = NDArray[np.float64]
_AT_ONCE = 1 << 14  # pieces times samples whose heat is computed at a time: what stays in the processor's cache


def moments(
    spec: Any,
    at: AtSamples,
    asked: Demands,
    warm: Heat,
    under: Stress,
    parts: Parts,
    *,
    energies: bool,
) -> Pair:
    """What the waveform asks of a set, sample by sample: bounds that differ where its heat is unknown.

    Parameters
    ----------
    spec
        With columns in place of the figures that are sampled.
    at, asked, warm, under, parts
        As ``limits_over_time.exact`` takes them.
    energies
        Tell what is drawn and returned; else these may be NaN.
    """
    k_t, limit = parts.motor["torque_constant"], parts.controller["continuous_current"]
    current, induced = at.line(asked.coefficients) / k_t, at.speeds * (asked.back_emf * asked.total_ratio)
    kept = kept_on_the_bus(spec)
    stores = bool(np.any(kept > 0.0))
    limited = spec.supply.current is not None or spec.supply.power is not None
    count = current.shape[-1]
    wanted = _Wanted(
        limited or stores or energies, energies or stores, stores,
        np.broadcast_to(kept, (count,)), np.broadcast_to(asked.surplus(k_t), (count,)),
    )  # fmt: skip
    top = np.broadcast_to(hottest(spec, at, warm, under, parts.motor), (count,))
    sides = _sides(spec, at, warm, parts.motor, (current, induced), top, wanted)
    limit = np.broadcast_to(limit, (count,))
    above = np.where(np.isnan(limit), np.nan, 0.0)
    if (under.current.value > limit).any():
        duration = np.broadcast_to(at.cycle.duration, (len(current), count)).T
        above = longest_above(Wave(duration, np.moveaxis(current, -1, 0), np.moveaxis(current, -1, 0)), limit)
    steady = np.broadcast_to(while_at_most(spec, at, warm, under, parts.motor), (count,))
    mean, cold = np.broadcast_to(warm.winding, (count,)), under.cold_voltage.value
    return _bounded([one._replace(above=above, voltage=np.maximum(one.voltage, cold)) for one in sides], mean, steady)


class _Wanted(NamedTuple):
    """What is to be told, and what it takes beside currents and voltages."""

    power: bool
    energies: bool
    stores: bool
    kept: Array  # share of what comes back that stays on the bus
    surplus: Array  # V*s/rad, see ``Demands.surplus``


def _bounded(sides: list[Moments], mean: Array, steady: Array) -> Pair:
    """Of samples whose heat is unknown bounds; of the rest the one figure."""
    low, high = sides[0], sides[-1]
    if low is high:
        return low, high
    rows = np.flatnonzero(np.isnan(high.winding))
    return between_bounds(high, on(low, rows), rows, mean, steady)


def _sides(
    spec: Any,
    at: AtSamples,
    warm: Heat,
    motor: Any,
    flows: tuple[Array, Array],
    top: Array,
    wanted: _Wanted,
) -> list[Moments]:
    """What is asked, some samples at a time; where some heat is unknown twice, coldest first."""
    (current, induced), bodies = flows, two_bodies(motor)
    count, ambient = len(top), np.broadcast_to(spec.environment.ambient, (len(top),))
    R_25 = np.broadcast_to(bodies.R_25, (count,))
    permitted = np.broadcast_to(motor["max_winding_temperature"], (count,))
    known = bodies.known.all() and not np.isnan(warm.friction + warm.iron).any()
    unknown = np.isnan(current).any(axis=(0, 1)) | np.full(count, not known)
    pieces = _pieces(at, current, *((float(np.min(x)) if known else np.inf) for x in (bodies.tau_w, bodies.tau_h)))
    size = max(_AT_ONCE // int(pieces.sum()), 256)
    found: list[list[Moments]] = []
    for rows in (slice(first, min(first + size, count)) for first in range(0, count, size)):
        cut = _cut(at, (current[..., rows], induced[..., rows] if induced.shape[-1] > 1 else induced), pieces, rows)
        peak, ends, means = _temperatures(spec, at, warm, bodies, cut, rows, unknown[rows])
        long_run = np.broadcast_to(np.where(np.isfinite(warm.winding), warm.winding, np.nan), (count,))[rows]
        away = np.isinf(peak) & np.isfinite(permitted[rows])  # taken as hot as it may be, where it fails
        ends, means = (np.where(away, permitted[rows], x) for x in (ends, means))
        good = np.isfinite(peak) | away
        each = [top[rows]] if good.all() else [ambient[rows], top[rows]]
        found.append([
            _moments(spec, cut, R_25[rows], (np.where(good, ends, T), np.where(good, means, long_run)), wanted, rows)
            ._replace(winding=peak)
            for T in each
        ])  # fmt: skip
    twice = max(map(len, found))
    return [
        Moments(*(np.concatenate(c) for c in zip(*(f[side if len(f) > 1 else 0] for f in found), strict=True)))
        for side in range(twice)
    ]


class _Cut(NamedTuple):
    """Some samples over the pieces of the cycle: pieces first, samples last."""

    duration: Array  # s
    current: Array  # A, (pieces, 2, samples)
    induced: Array  # V
    speed: Array  # rad/s, at the gearhead's output
    steady: NDArray[np.bool_]  # whether current and speed stay what they are: (pieces, 1)


def _cut(at: AtSamples, flows: tuple[Array, Array], pieces: NDArray[np.int64], rows: slice) -> _Cut:
    owner, place = places(pieces)
    ends = (np.stack([place, place + 1], axis=1) / pieces[owner][:, None])[..., None]

    def cut(line: Array) -> Array:
        found: Array = line[owner, :1] + ends * (line[owner, 1:] - line[owner, :1])
        return found

    current, induced = flows
    speed = at.speeds[..., rows] if at.speeds.shape[-1] > 1 else at.speeds
    duration = at.cycle.duration
    t = (duration[:, rows] if duration.shape[-1] > 1 else duration)[owner] / pieces[owner][:, None]
    level = [(x[:, 0] == x[:, 1]).all(axis=-1) for x in (current, speed)]
    return _Cut(t, cut(current), cut(induced), cut(speed), (level[0] & level[1])[owner][:, None])


def _temperatures(
    spec: Any, at: AtSamples, warm: Heat, motor: TwoBodies, cut: _Cut, rows: slice, unknown: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Peak of the winding [K]; at both ends of the pieces, and over each: NaN where heat is unknown."""
    if unknown.all():
        nothing = np.full(len(unknown), np.nan)
        return nothing, nothing, nothing

    def part(column: Any) -> Any:
        return column[rows] if getattr(column, "shape", ())[-1:] == (warm.winding.shape[-1],) else column

    a, b = np.where(unknown, 0.0, cut.current.swapaxes(0, 1)) if unknown.any() else cut.current.swapaxes(0, 1)
    square = (a * a + a * b + b * b) / 3  # of what is unknown any current, without effect
    v, w = cut.speed.swapaxes(0, 1)
    loss = part(warm.friction) * np.abs(v + w) / 2 + part(warm.iron) * (v * v + v * w + w * w) / 3
    t, square, loss = (np.ascontiguousarray(x) for x in np.broadcast_arrays(cut.duration, square, loss))
    ambient = part(spec.environment.ambient)
    with np.errstate(over="ignore", invalid="ignore"):  # where a motor runs away
        found = periodic(each_figure(motor, part), ambient, t, square, loss)
        peak, (ends, means) = highest(found, 1.0, 0.0).rise, of_pieces(found, cut.steady)
    good = found.settles & ~unknown
    peak = np.where(good, peak + ambient, np.where(unknown, np.nan, np.inf))
    return peak, ends + ambient, means + ambient


def _moments(spec: Any, cut: _Cut, R_25: Array, T: tuple[Array, Array], wanted: _Wanted, rows: slice) -> Moments:
    """What is asked with the winding at some temperature at the ends of the pieces, and over each."""
    ends, means = (np.asarray(resistance_at(R_25, x)) for x in T)
    I, count = cut.current, len(R_25)
    volts = cut.induced + ends * I
    square = (I[:, 0] * I[:, 0] + I[:, 0] * I[:, 1] + I[:, 1] * I[:, 1]) / 3
    copper = (cut.duration * means * square).sum(axis=0) / cut.duration.sum(axis=0)
    nothing = np.full(count, np.nan)
    found = Moments(nothing, nothing, np.abs(volts).max(axis=(0, 1)), nothing, copper, *[nothing] * 6)
    found = found._replace(stored=nothing if wanted.stores else np.zeros(count))
    if not wanted.power:
        return found
    duration = np.broadcast_to(cut.duration, (len(I), count)).T
    wave = Wave(duration, np.moveaxis(I, -1, 0), np.moveaxis(volts, -1, 0))
    turning = wanted.surplus[rows], np.moveaxis(np.broadcast_to(cut.speed, I.shape), -1, 0)
    power, when = largest_power(balanced(wave, *turning))
    found = found._replace(power=power, power_time=when)
    if not wanted.energies:
        return found
    volts = cut.induced + (means[:, None] if means.ndim == 2 else means) * I
    wave = wave._replace(voltage=np.moveaxis(volts, -1, 0))
    taken = balanced(wave, *turning)
    if wanted.stores:
        return found._replace(**energy(taken, wanted.kept[rows])._asdict())
    if taken is not wave:
        sums = energy(taken, storing=False)
        return found._replace(drawn=sums.drawn, returned=sums.returned)
    drawn, returned = _energies(wave, cut.duration, I, volts)
    return found._replace(drawn=drawn, returned=returned)


def _energies(wave: Wave, duration: Array, current: Array, volts: Array) -> tuple[Array, Array]:
    """What is drawn and what comes back over a cycle [J]; cut where power turns round only where it does."""
    turns = ((current[:, 0] * current[:, 1] < 0.0) | (volts[:, 0] * volts[:, 1] < 0.0)).any(axis=-1)
    work = (duration * mean_product(current, volts))[~turns]  # each drawn or returned, all of it
    drawn, returned = np.maximum(work, 0.0).sum(axis=0), np.maximum(-work, 0.0).sum(axis=0)
    if turns.any():
        cut = energy(Wave(wave.duration[:, turns], wave.current[:, turns], wave.voltage[:, turns]), storing=False)
        drawn, returned = drawn + cut.drawn, returned + cut.returned
    return drawn, returned


def _pieces(at: AtSamples, current: Array, winding: float, housing: float) -> NDArray[np.int64]:
    """In how many pieces each segment is taken: to 1 % of what a change within it would do; ``physics`` has 0.1 %.

    A current that changes counts by the winding's time constant, a loss at the housing alone by the housing's.
    """
    duration, steady = at.cycle.duration.max(axis=-1), (at.speeds[:, 0] == at.speeds[:, 1]).all(axis=-1)
    quickest = np.where((current[:, 0] == current[:, 1]).all(axis=-1), np.where(steady, np.inf, housing), winding)
    return piece_counts(duration, quickest, 1e-2)
