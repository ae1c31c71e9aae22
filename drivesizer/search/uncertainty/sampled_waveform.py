"""Figures that need the current of each moment, of one drive over many samples: winding, power, time of overload.

``limits_over_time`` has them of many drives over one load cycle. Here each sample has a load cycle of its own, so that
arrays have the samples last.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_figures import piece_counts
from drivesizer.physics.heat_cycle_columns import each_figure
from drivesizer.physics.load_cycle import places
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, source_energy, source_power
from drivesizer.physics.stress import Heat, Parts, Stress, on, temperature_at_most
from drivesizer.physics.thermal import TwoBodies, resistance_at, two_bodies
from drivesizer.physics.waveform import Wave, balanced, longest_above, mean_square
from drivesizer.physics.winding_course import winding_rises
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.limits_over_time import Moments, Pair, between_bounds, hottest, kept_on_the_bus
from drivesizer.search.uncertainty.sampled_cycle import AtSamples

__all__ = ["moments"]

Array = NDArray[np.float64]
_AT_ONCE = 1 << 14  # pieces times samples whose heat is computed at a time: what stays in the processor's cache


def moments(
    spec: Any,
    cycles: AtSamples,
    demands: Demands,
    heat: Heat,
    stress: Stress,
    parts: Parts,
    feed: Feed,
    *,
    energies: bool,
) -> Pair:
    """Figures of the waveform of one drive, sample by sample.

    Parameters
    ----------
    spec
        With columns in place of the figures that are sampled.
    cycles
        Load cycles of the samples.
    demands, heat, stress, parts
        Columns over the samples.
    feed
        Power stages and supply, columns over the samples.
    energies
        Compute the energy drawn and returned; else it may be NaN.

    Returns
    -------
    pair of Moments
        Columns over the samples: lower and upper bounds, the same where the winding's heat is known.
    """
    k_t = parts.motor["torque_constant"]
    current = cycles.line(demands.coefficients) / k_t
    induced = cycles.speeds * (demands.back_emf * demands.total_ratio)
    kept, count = kept_on_the_bus(spec), current.shape[-1]
    stores = bool(np.any(kept > 0.0))
    limited = spec.supply.current is not None or spec.supply.power is not None
    limited = limited or not np.isnan(parts.controller["max_power"]).all()
    outputs = _Outputs(
        limited or stores or energies, energies or stores, stores,
        np.broadcast_to(kept, (count,)), np.broadcast_to(demands.surplus(k_t), (count,)),
        feed.broadcast(count), spec.resists,
    )  # fmt: skip
    top = np.broadcast_to(hottest(spec, cycles, heat, stress, parts.motor), (count,))
    sides = _sides(spec, cycles, heat, parts.motor, (current, induced), top, outputs)
    above = _time_above(spec, cycles, current, stress, parts)
    steady = np.broadcast_to(temperature_at_most(spec.environment.ambient, cycles, heat, stress, parts.motor), (count,))
    mean, cold = np.broadcast_to(heat.winding, (count,)), stress.cold_voltage.value
    return _bounded([one._replace(above=above, voltage=np.maximum(one.voltage, cold)) for one in sides], mean, steady)


def _time_above(spec: Any, cycles: AtSamples, current: Array, stress: Stress, parts: Parts) -> Array:
    """Longest uninterrupted time above the controller's continuous current [s]; NaN where that is unknown."""
    count = current.shape[-1]
    limit = np.broadcast_to(controller_current(parts.controller, spec.environment.ambient), (count,))
    if not (stress.current.value > limit).any():
        return np.where(np.isnan(limit), np.nan, 0.0)
    duration = np.broadcast_to(cycles.load_cycle.duration, (len(current), count))
    return longest_above(_wave(duration, current, current), limit)


class _Outputs(NamedTuple):
    """Figures to compute, and what they need beside currents and voltages."""

    power: bool
    energies: bool
    stores: bool
    kept: Array  # share of the returned energy that stays on the bus
    surplus: Array  # V*s/rad, see ``Demands.surplus``
    feed: Feed
    resists: bool  # whether resistances take of the voltage before the winding


def _wave(duration: Array, current: Array, voltage: Array) -> Wave:
    """Current and voltage of samples as ``waveform`` takes them, views with the samples first."""
    return Wave(duration.T, np.moveaxis(current, -1, 0), np.moveaxis(voltage, -1, 0))


def _bounded(sides: list[Moments], mean: Array, steady: Array) -> Pair:
    """Bounds of samples whose heat is unknown; of the rest the one figure."""
    low, high = sides[0], sides[-1]
    if low is high:
        return low, high
    rows = np.flatnonzero(np.isnan(high.winding))
    return between_bounds(high, on(low, rows), rows, mean, steady)


def _sides(
    spec: Any, at: AtSamples, heat: Heat, motor: Any, flows: tuple[Array, Array], top: Array, outputs: _Outputs
) -> list[Moments]:
    """The figures, some samples at a time; where some heat is unknown twice, coldest first."""
    (current, induced), bodies = flows, two_bodies(motor)
    count, ambient = len(top), np.broadcast_to(spec.environment.ambient, (len(top),))
    R_25 = np.broadcast_to(bodies.R_25, (count,))
    permitted = np.broadcast_to(motor["max_winding_temperature"], (count,))
    known = bodies.known.all() and not np.isnan(heat.friction + heat.iron).any()
    unknown = np.isnan(current).any(axis=(0, 1)) | np.full(count, not known)
    pieces = _pieces(at, current, *((float(np.min(x)) if known else np.inf) for x in (bodies.tau_w, bodies.tau_h)))
    size = max(_AT_ONCE // int(pieces.sum()), 256)
    found: list[list[Moments]] = []
    for rows in (slice(first, min(first + size, count)) for first in range(0, count, size)):
        cut = _cut(at, (current[..., rows], induced[..., rows] if induced.shape[-1] > 1 else induced), pieces, rows)
        peak, ends, means = _temperatures(spec, heat, bodies, cut, rows, unknown[rows])
        long_run = np.broadcast_to(np.where(np.isfinite(heat.winding), heat.winding, np.nan), (count,))[rows]
        away = np.isinf(peak) & np.isfinite(permitted[rows])  # at the permitted temperature, where it fails
        ends, means = (np.where(away, permitted[rows], x) for x in (ends, means))
        good = np.isfinite(peak) | away
        each = [top[rows]] if good.all() else [ambient[rows], top[rows]]
        found.append([
            _moments(cut, R_25[rows], (np.where(good, ends, T), np.where(good, means, long_run)), outputs, rows)
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

    duration: Array  # s, (pieces, 1) or (pieces, samples)
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
    duration = at.load_cycle.duration
    t = (duration[:, rows] if duration.shape[-1] > 1 else duration)[owner] / pieces[owner][:, None]
    level = (current[:, 0] == current[:, 1]).all(axis=-1) & (speed[:, 0] == speed[:, 1]).all(axis=-1)
    return _Cut(t, cut(current), cut(induced), cut(speed), level[owner][:, None])


def _temperatures(
    spec: Any, heat: Heat, motor: TwoBodies, cut: _Cut, rows: slice, unknown: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Peak of the winding [K]; at both ends of the pieces, and over each: NaN where heat is unknown."""
    if unknown.all():
        nothing = np.full(len(unknown), np.nan)
        return nothing, nothing, nothing

    def part(column: Any) -> Any:
        return column[rows] if getattr(column, "shape", ())[-1:] == (heat.winding.shape[-1],) else column

    flowing = (
        np.where(unknown, 0.0, cut.current) if unknown.any() else cut.current
    )  # of the unknown any, without effect
    square = mean_square(_wave(cut.duration, flowing, flowing)).T
    v, w = cut.speed.swapaxes(0, 1)
    loss = part(heat.friction) * np.abs(v + w) / 2 + part(heat.iron) * (v * v + v * w + w * w) / 3
    t, square, loss = (np.ascontiguousarray(x) for x in np.broadcast_arrays(cut.duration, square, loss))
    ambient = part(spec.environment.ambient)
    found, peak, ends, means = winding_rises(each_figure(motor, part), ambient, t, square, loss, cut.steady)
    good = found.settles & ~unknown
    highest = np.where(good, peak.rise + ambient, np.where(unknown, np.nan, np.inf))
    return highest, ends + ambient, means + ambient


def _moments(cut: _Cut, R_25: Array, T: tuple[Array, Array], outputs: _Outputs, rows: slice) -> Moments:
    """The figures with the winding at some temperature at the ends of the pieces, and over each."""
    ends, means = (np.asarray(resistance_at(R_25, x)) for x in T)
    count = len(R_25)
    volts, nothing = cut.induced + ends * cut.current, np.full(count, np.nan)
    feed, largest = outputs.feed.on(rows), np.abs(volts)
    if outputs.resists:
        largest = np.maximum(largest, np.abs(volts + feed.leads * cut.current))
    found = Moments(nothing, nothing, largest.max(axis=(0, 1)), *[nothing] * 8)
    found = found._replace(stored=nothing if outputs.stores else np.zeros(count))
    if not outputs.power:
        return found
    duration = np.broadcast_to(cut.duration, (len(volts), count))
    turning = outputs.surplus[rows], np.moveaxis(np.broadcast_to(cut.speed, cut.current.shape), -1, 0)
    power, when = source_power(balanced(_wave(duration, cut.current, volts), *turning), feed)
    found = found._replace(power=power, power_time=when)
    if not outputs.energies:
        return found
    heated = means * mean_square(_wave(duration, cut.current, cut.current)).T * duration
    found = found._replace(copper=heated.sum(axis=0) / duration.sum(axis=0))
    volts = cut.induced + (means[:, None] if means.ndim == 2 else means) * cut.current
    taken = balanced(_wave(duration, cut.current, volts), *turning)
    sums = source_energy(taken, feed, outputs.kept[rows], storing=outputs.stores)
    return found._replace(**(sums._asdict() | ({} if outputs.stores else {"stored": found.stored})))


def _pieces(at: AtSamples, current: Array, winding: float, housing: float) -> NDArray[np.int64]:
    """In how many pieces each segment is taken: to 1 % of what a change within it would do; ``physics`` has 0.1 %.

    A current that changes counts by the winding's time constant, a loss at the housing alone by the housing's.
    """
    duration = at.load_cycle.duration.max(axis=-1)
    quickest = np.where((current[:, 0] == current[:, 1]).all(axis=-1), np.where(at.level, np.inf, housing), winding)
    return piece_counts(duration, quickest, 1e-2)
