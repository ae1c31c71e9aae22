"""What needs the current of each moment, for one set over many samples: winding, power, time of overload.

As ``waveform_limits`` has it for many sets over one cycle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.heat_columns import each_figure
from drivesizer.heat_cycle import highest, periodic
from drivesizer.physics import Demands
from drivesizer.physics_limits import Heat, Parts, Stress
from drivesizer.thermal import TwoBodies, two_bodies
from drivesizer.tolerances.behind import AtSamples, mean_product
from drivesizer.waveform import Wave, balanced, energy, largest_power, longest_above
from drivesizer.waveform_limits import Moments, kept_on_the_bus

__all__ = ["moments"]

Array = NDArray[np.float64]
_FINEST = 200  # pieces of a segment at most
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
) -> Moments:
    """What the waveform asks of a set, sample by sample.

    Parameters
    ----------
    spec
        With columns in place of the figures that are sampled.
    at, asked, warm, under, parts
        As ``waveform_limits.exact`` takes them.
    energies
        Tell what is drawn and returned; else these are NaN.
    """
    k_t = parts.motor["torque_constant"]
    current = at.line(asked.coefficients) / k_t
    nothing = np.full(current.shape[-1], np.nan)
    power = when = drawn = returned = nothing
    limit = np.broadcast_to(parts.controller["continuous_current"], nothing.shape)
    above = np.where(np.isnan(limit), np.nan, 0.0)
    kept = kept_on_the_bus(spec.supply)
    stores = bool(np.any(kept > 0.0))
    stored = nothing if stores else np.zeros_like(nothing)
    limited = spec.supply.current is not None or spec.supply.power is not None
    if limited or stores or energies or (under.current.value > limit).any():
        volts = current * under.hot + at.speeds * (asked.back_emf * asked.total_ratio)
        duration = np.broadcast_to(at.sampled.duration, (len(volts), len(nothing))).T
        wave = Wave(duration, np.moveaxis(current, -1, 0), np.moveaxis(volts, -1, 0))
        above = longest_above(wave, limit)
        surplus = np.broadcast_to(asked.surplus(k_t), nothing.shape)
        taken = balanced(wave, surplus, np.moveaxis(np.broadcast_to(at.speeds, current.shape), -1, 0))
        power, when = largest_power(taken)
        if stores or (energies and taken is not wave):
            drawn, returned, stored = energy(taken, kept)
        elif energies:
            drawn, returned = _energies(wave, at.sampled.duration, current, volts)
    winding = _winding(spec, at, current, warm, parts.motor)
    return Moments(winding, nothing, power, when, drawn, returned, stored, above)


def _energies(wave: Wave, duration: Array, current: Array, volts: Array) -> tuple[Array, Array]:
    """What is drawn and what comes back over a cycle [J]; cut where power turns round only where it does."""
    turns = ((current[:, 0] * current[:, 1] < 0.0) | (volts[:, 0] * volts[:, 1] < 0.0)).any(axis=-1)
    work = (duration * mean_product(current, volts))[~turns]  # each drawn or returned, all of it
    drawn, returned = np.maximum(work, 0.0).sum(axis=0), np.maximum(-work, 0.0).sum(axis=0)
    if turns.any():
        cut = energy(Wave(wave.duration[:, turns], wave.current[:, turns], wave.voltage[:, turns]), storing=False)
        drawn, returned = drawn + cut.drawn, returned + cut.returned
    return drawn, returned


def _winding(spec: Any, at: AtSamples, current: Array, warm: Heat, motor: Any) -> Array:
    """Peak of the winding's temperature over the cycle repeated for ever; the mean without time constants."""
    bodies = two_bodies(motor)
    if np.isnan(motor["winding_time_constant"] + motor["motor_time_constant"]).all():
        return warm.winding
    count = current.shape[-1]
    if not bodies.known.all() or np.isnan(warm.friction + warm.iron).any():
        return np.full(count, np.nan)
    unknown = np.isnan(current).any(axis=(0, 1))
    if unknown.any():
        current = np.where(unknown, 0.0, current)  # any current, without effect
    pieces = _pieces(at, current, float(np.min(bodies.tau_w)), float(np.min(bodies.tau_h)))
    found = np.empty(count)
    size = max(_AT_ONCE // int(pieces.sum()), 256)
    for first in range(0, count, size):
        rows = slice(first, min(first + size, count))
        found[rows] = _block(spec, at, current[..., rows], warm, bodies, pieces, rows)
    found[unknown] = np.nan
    return found


def _pieces(at: AtSamples, current: Array, winding: float, housing: float) -> NDArray[np.int64]:
    """In how many pieces each segment is taken: to 1 % of what a change within it would do; ``physics`` has 0.1 %.

    A current that changes counts by the winding's time constant, a loss at the housing alone by the housing's.
    """
    duration, steady = at.sampled.duration.max(axis=-1), (at.speeds[:, 0] == at.speeds[:, 1]).all(axis=-1)
    quickest = np.where((current[:, 0] == current[:, 1]).all(axis=-1), np.where(steady, np.inf, housing), winding)
    found: NDArray[np.int64] = np.clip(np.ceil(np.sqrt(duration / quickest / 0.12)), 1, _FINEST).astype(np.int64)
    return found


def _block(
    spec: Any, at: AtSamples, current: Array, warm: Heat, motor: TwoBodies, pieces: NDArray[np.int64], rows: slice
) -> Array:
    owner = np.repeat(np.arange(len(pieces)), pieces)
    ends = [(np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces) + k) / pieces[owner] for k in (0, 1)]

    def cut(line: Array) -> tuple[Array, Array]:
        left, rise = line[owner, 0], (line[:, 1] - line[:, 0])[owner]
        return left + ends[0][:, None] * rise, left + ends[1][:, None] * rise

    def part(column: Any) -> Any:
        return column[rows] if getattr(column, "shape", ())[-1:] == (warm.winding.shape[-1],) else column

    a, b = cut(current)
    square = (a * a + a * b + b * b) / 3
    v, w = cut(at.speeds[..., rows] if at.speeds.shape[-1] > 1 else at.speeds)
    loss = part(warm.friction) * np.abs(v + w) / 2 + part(warm.iron) * (v * v + v * w + w * w) / 3
    duration = at.sampled.duration
    t = (duration[:, rows] if duration.shape[-1] > 1 else duration)[owner] / pieces[owner][:, None]
    t, square, loss = (np.ascontiguousarray(x) for x in np.broadcast_arrays(t, square, loss))
    ambient = part(spec.environment.ambient)
    with np.errstate(over="ignore", invalid="ignore"):  # where a motor runs away
        found = periodic(each_figure(motor, part), ambient, t, square, loss)
        rise = highest(found, 1.0, 0.0).rise
    return np.where(found.settles, rise + ambient, np.inf)
