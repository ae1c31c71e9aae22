"""Figures of current and voltage over time: power of the supply, energy with clipped return, time of overload.

Current and voltage are straight lines within a segment, so power is a product of two lines: its sign changes where
one of them does, its extremes are ends or the vertex, and everything below is exact. Columns over candidates and
segments; the caller minds how many at a time.
Symbols: I current [A], V voltage [V], t time [s], E energy [J].
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.extremes import first_largest
from drivesizer.physics.figures import product

__all__ = [
    "Energy", "Wave", "balanced", "crossing", "energy", "highest_powers", "in_halves",
    "largest_power", "longest_above", "longest_run", "lost", "mean_square", "most_stored", "share_above",
    "signed_energy", "wave",
]  # fmt: skip

Array = NDArray[np.float64]

_PART = 1 << 16  # steps of a long cycle at a time


class Wave(NamedTuple):
    """Current and voltage of candidates: shape (candidates, segments, 2), values at both ends."""

    duration: Array  # s, of each segment; of candidates with a cycle of their own (candidates, segments)
    current: Array
    voltage: Array


class Energy(NamedTuple):
    """Energy that one drive draws from its supply and returns, over one cycle."""

    drawn: Array  # J
    returned: Array  # J
    stored: Array  # J, the most that was returned and not drawn again


def wave(duration: Array, functions: Array, torque: Array, volts: Array, k_t: Array) -> Wave:
    """Current and voltage over the segments.

    Parameters
    ----------
    duration
        Of each segment [s].
    functions
        The six functions at both ends of each segment, shape (segments, 2, 6).
    torque, volts
        Coefficients of motor torque and of voltage for each candidate, shape (candidates, 6).
    k_t
        Torque constants [N*m/A].

    Returns
    -------
    Wave
        Current [A] and voltage [V] of each candidate.
    """
    flat = functions.reshape(-1, 6).T
    shape = (len(torque), len(duration), 2)
    return Wave(duration, product(torque / k_t[:, None], flat).reshape(shape), product(volts, flat).reshape(shape))


def balanced(found: Wave, surplus: Array, speed: Array) -> Wave:
    r"""The waveform whose V I is the power that windings take whose two constants differ.

    k_e w is the voltage, k_t I the torque, so that of the power k_e w I only k_t w I turns the motor. What they differ
    by is lost in either direction of power, for no figure makes energy of nothing:

    .. math:: P = R I^2 + k_t w I + |k_e - k_t|\,|w I| = V I + \max(0,\ 2 (k_t - k_e) w I)

    Parameters
    ----------
    found
        Current and terminal voltage.
    surplus
        k_e - k_t of each candidate, by the speed that is given [V*s/rad].
    speed
        At both ends of each segment [rad/s], of one sign in each: (segments, 2), or of each candidate.

    Returns
    -------
    Wave
        Cut where the current changes its sign; the same where no constants differ.
    """
    if not (np.abs(surplus) > 0.0).any():
        return found
    duration, current, voltage, emf = _cut(found, surplus, speed)
    against = (current.sum(-1) * emf.sum(-1) < 0.0)[..., None]
    return Wave(duration, current, np.where(against, voltage - 2.0 * emf, voltage))


def lost(found: Wave, surplus: Array, speed: Array) -> Array:
    """Energy lost over the cycle by the difference of the windings' two constants [J].

    Parameters
    ----------
    found
        Current and voltage over the segments.
    surplus, speed
        As in ``balanced``.

    Returns
    -------
    array
        Energy [J], of each candidate.
    """
    duration, current, _, emf = _cut(found, surplus, speed)
    heat: Array = np.abs(duration * _work(Wave(duration, current, emf), 1.0)).sum(axis=1)
    return heat


def _cut(found: Wave, surplus: Array, speed: Array) -> tuple[Array, Array, Array, Array]:
    """Duration, current, voltage and what the back-EMF is above k_t w, in halves that meet where no current flows."""
    emf = np.broadcast_to(surplus[:, None, None] * speed, found.current.shape)
    duration, (current, voltage, emf) = in_halves(found.duration, found.current, (found.current, found.voltage, emf))
    return duration, current, voltage, emf


def in_halves(duration: Array, current: Array, lines: Sequence[Array]) -> tuple[Array, list[Array]]:
    """Segments in halves that meet where the current changes its sign; where it does not the second has no length.

    Those of samples stay whole where no current does.

    Parameters
    ----------
    duration
        Of each segment [s].
    current
        Values at both ends of each, shape (candidates, segments, 2).
    lines
        What is cut, of that shape.

    Returns
    -------
    tuple
        Duration of the halves [s], and the lines over them, of twice as many segments.
    """
    share = crossing(current)
    if _of_samples(share) and (share == 1.0).all():
        return duration * share, [*lines]
    count, segments = share.shape
    durations, halves = _room(share, (count, 2 * segments)), []
    durations[:, ::2], durations[:, 1::2] = duration * share, duration * (1.0 - share)
    for ends in lines:
        middle = ends[..., 0] + share * (ends[..., 1] - ends[..., 0])
        points = _room(share, (count, 2 * segments, 2))
        points[:, ::2, 0], points[:, 1::2, 1] = ends[..., 0], ends[..., 1]
        points[:, ::2, 1] = points[:, 1::2, 0] = middle
        halves.append(points)
    return durations, halves


def _room(like: Array, shape: tuple[int, ...]) -> Array:
    """Room for figures that lie in memory as others do: of many samples of one drive these side by side."""
    return np.empty(shape, order="F" if _of_samples(like) else "C")


def _of_samples(like: Array) -> bool:
    """Whether figures of one moment lie side by side, as those of samples: their sums hang on no segment without time.

    Of candidates those of a cycle do: numpy adds them up in an order that hangs on how many there are.
    """
    return like.strides[0] < like.strides[-1]


def mean_square(found: Wave) -> Array:
    """Mean square current over each segment [A^2]: shape (candidates, segments)."""
    a, b = found.current[..., 0], found.current[..., 1]
    square: Array = (a * a + a * b + b * b) / 3
    return square


def largest_power(found: Wave) -> tuple[Array, Array]:
    """Largest electrical power of each candidate [W], and when [s]; ends of segments and vertices between them."""
    power, at = highest_powers(found)
    largest, worst = first_largest(power)
    rows = np.arange(len(power))
    ends = np.cumsum(found.duration, axis=-1) - found.duration
    start, duration = (np.broadcast_to(x, power.shape) for x in (ends, found.duration))
    return largest, start[rows, worst] + at[rows, worst] * duration[rows, worst]


def highest_powers(found: Wave) -> tuple[Array, Array]:
    """Largest power in each segment [W], and after which share of it: shape (candidates, segments)."""
    rises, (first, last), bend, vertex = _course_of_power(found)
    return _power_at(found, rises, np.where(bend < 0.0, vertex, np.nan), last > first)


def _course_of_power(found: Wave) -> tuple[tuple[Array, Array], tuple[Array, Array], Array, Array]:
    """Rises of current and voltage over each segment, power at its ends, its bend, and the share at which it turns."""
    I, V = found.current, found.voltage
    rise_I, rise_V = I[..., 1] - I[..., 0], V[..., 1] - V[..., 0]
    bend = rise_I * rise_V
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = -(I[..., 0] * rise_V + V[..., 0] * rise_I) / (2 * bend)
    return (rise_I, rise_V), (I[..., 0] * V[..., 0], I[..., 1] * V[..., 1]), bend, vertex


def _power_at(found: Wave, rises: tuple[Array, Array], vertex: Array, later: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Power where it turns round within a segment, else at its end or its start [W], and after which share of it."""
    at = np.where((vertex > 0.0) & (vertex < 1.0), vertex, np.where(later, 1.0, 0.0))
    power: Array = (found.current[..., 0] + at * rises[0]) * (found.voltage[..., 0] + at * rises[1])
    return power, at


def energy(found: Wave, kept: Any = 1.0, *, storing: bool = True) -> Energy:
    """Energy drawn and returned over the cycle, each where power has that sign.

    Parameters
    ----------
    found
        Current and voltage over the segments.
    kept
        Share of the returned energy that is stored, and drawn first: one, or one of each candidate.
    storing
        Compute the stored energy too; else it is NaN.

    Returns
    -------
    Energy
        Columns over candidates [J].
    """
    parts = signed_energy(found)
    drawn, returned = np.maximum(parts, 0.0), np.maximum(-parts, 0.0)
    taken, back = drawn.sum((1, 2)), returned.sum((1, 2))
    if not storing:
        return Energy(taken, back, np.full_like(back, np.nan))
    share = np.broadcast_to(kept, back.shape)
    steps = (returned * share[:, None, None] - drawn).reshape(len(parts), prod(parts.shape[1:]))
    stored = np.where(share * back > taken, np.inf, most_stored(steps))  # more with every cycle
    return Energy(taken, back, stored)


def crossing(ends: Array) -> Array:
    """Share of each segment after which a quantity changes sign; 1 where it does not."""
    left, right = ends[..., 0], ends[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(left * right < 0.0, left / (left - right), 1.0)


def signed_energy(found: Wave) -> Array:
    """Energy of each segment up to where one of both changes its sign, from there to the other, and from there on [J].

    Power has one sign in each part: shape (candidates, segments, 3); of samples 1 where no sign changes.
    """
    one, other = crossing(found.current), crossing(found.voltage)
    if _of_samples(one) and (one == 1.0).all() and (other == 1.0).all():
        return (_work(found, 1.0) * found.duration)[..., None]
    first, second = (_work(found, cut) for cut in (np.minimum(one, other), np.maximum(one, other)))
    parts = _room(one, (*one.shape, 3))
    parts[..., 0] = first
    np.subtract(second, first, out=parts[..., 1])
    np.subtract(_work(found, 1.0), second, out=parts[..., 2])
    parts *= found.duration[..., None]
    return parts


def _work(found: Wave, at: Any) -> Array:
    """Integral of the power over the first share of each segment, per time of it."""
    i, v = found.current[..., 0], found.voltage[..., 0]
    rise_i, rise_v = found.current[..., 1] - i, found.voltage[..., 1] - v
    work: Array = at * (i * v + at * ((i * rise_v + v * rise_i) / 2 + at * rise_i * rise_v / 3))
    return work


def most_stored(steps: Array) -> Array:
    """Largest rise of a periodic running sum: peak of an initially empty store.

    Parameters
    ----------
    steps
        What comes in, one step after the other, and what goes out below 0: shape (candidates, steps).

    Returns
    -------
    array
        Of each candidate.

    Examples
    --------
    >>> most_stored(np.array([[8.0, -5.0, 4.0, -9.0]])).tolist()
    [8.0]
    """
    if len(steps) == 1 and steps.shape[1] > _PART:
        return np.array([_most_stored(steps[0])])
    twice = np.cumsum(np.concatenate([np.zeros((len(steps), 1)), steps, steps], axis=1), axis=1)
    risen = (twice - np.minimum.accumulate(twice, axis=1)).max(axis=1)
    stored: Array = np.minimum(risen, np.maximum(steps, 0.0).sum(axis=1))
    return stored


def _most_stored(steps: Array) -> float:
    """The same of many steps, some at a time: the running sums of all take much room."""
    level, lowest, risen, all_in = 0.0, 0.0, 0.0, float(np.maximum(steps, 0.0).sum())
    for first in [*range(0, len(steps), _PART)] * 2:
        part = steps[first : first + _PART].copy()
        part[0] += level
        np.cumsum(part, out=part)
        lows = np.minimum(np.minimum.accumulate(part), lowest)
        risen = np.maximum(risen, (part - lows).max())  # NaN stays
        level, lowest = part[-1], lows[-1]
    return float(np.minimum(risen, all_in))


def longest_above(found: Wave, limit: Array) -> Array:
    """Longest uninterrupted time for which the absolute current is above a limit [s]; the cycle repeats.

    Parameters
    ----------
    found
        Current over the segments.
    limit
        Of each candidate [A].

    Returns
    -------
    array
        Time [s], of each candidate; NaN where the limit is unknown.
    """
    above = np.zeros(len(limit))
    rows = np.flatnonzero((np.abs(found.current) > limit[:, None, None]).any((1, 2)))
    if len(rows):
        duration = found.duration if found.duration.ndim == 1 else found.duration[rows]
        some = Wave(duration, found.current[rows], found.voltage[rows])
        above[rows] = longest_run(duration, *_below(some, limit[rows, None]))
    return np.where(np.isnan(limit), np.nan, above)


def share_above(found: Wave, limit: Array) -> Array:
    """Share of the time for which the absolute current is above a limit [1], for each candidate's limit [A].

    Parameters
    ----------
    found
        Current over the segments.
    limit
        Of each candidate [A].

    Returns
    -------
    array
        Share [1], of each candidate; NaN where the limit is unknown.
    """
    enter, leave, whole = _below(found, limit[:, None])
    below = np.where(whole, 0.0, leave - enter).sum(axis=1)
    share: Array = 1.0 - below / found.duration.sum(axis=-1)
    return np.where(np.isnan(limit), np.nan, np.maximum(share, 0.0))


def longest_run(duration: Array, enter: Array, leave: Array, whole: NDArray[np.bool_]) -> Array:
    """Longest uninterrupted time without a break, in a cycle that repeats [s].

    Parameters
    ----------
    duration
        Of each segment [s]; (candidates, segments) where each has a cycle of its own.
    enter, leave
        From when until when in each segment there is a break [s], for each candidate or the same for all.
    whole
        Where a segment has none.

    Returns
    -------
    array
        Time [s], of each candidate.
    """
    total, start = duration.sum(axis=-1, keepdims=True), np.cumsum(duration, axis=-1) - duration
    begins = np.where(whole, -np.inf, start + leave)
    last = begins.max(axis=1, keepdims=True) - total  # in the cycle before
    before = np.maximum.accumulate(np.concatenate([last, begins[:, :-1]], axis=1), axis=1)
    with np.errstate(invalid="ignore"):
        longest = np.where(whole, 0.0, start + enter - before).max(axis=1)
    total = total[..., 0]
    longest = np.maximum(longest - 8 * np.spacing(total), 0.0)  # rounding of the times may have added this
    run: Array = np.where(whole.all(axis=1), total, longest)
    return run


def _below(found: Wave, limit: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Of each segment: from when until when it is not above [s], and whether all of it is above."""
    I, dt = found.current, found.duration
    a, b = I[..., 0], I[..., 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        up, down = (limit - a) / (b - a), (-limit - a) / (b - a)  # shares at which it meets +limit and -limit
    enter, leave = np.minimum(up, down), np.maximum(up, down)
    flat = a == b
    whole = np.where(flat, np.abs(a) > limit, (enter >= 1.0) | (leave <= 0.0))
    first = np.where(flat, 0.0, np.clip(enter, 0.0, 1.0)) * dt
    last = np.where(flat, 1.0, np.clip(leave, 0.0, 1.0)) * dt
    return first, last, whole
