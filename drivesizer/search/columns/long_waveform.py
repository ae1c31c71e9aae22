"""Figures of a long waveform, part by part: each stays in the processor's cache, and memory is bounded.

The figures are those of ``waveform`` and ``power_stage`` over all segments at once; sums are added part by part.
Symbols: E energy [J], t time [s].
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.extremes import first_largest, near_largest
from drivesizer.physics.power_stage import Feed, at_input, lost_in_source
from drivesizer.physics.waveform import Energy, Wave, highest_powers, signed_energy

__all__ = ["PART", "Near", "energy_of_source", "first_of", "in_parts", "near_power", "near_values"]

Array = NDArray[np.float64]
PART = 1 << 15  # segments at a time


class Near(NamedTuple):
    """Values of a part that differ from its largest by rounding alone, and its very first."""

    row: NDArray[np.intp]
    value: Array
    time: Array  # s


def in_parts(count: int) -> list[slice]:
    """The segments of a cycle of so many, some at a time."""
    return [slice(first, min(first + PART, count)) for first in range(0, count, PART)]


def near_values(values: Array, time: Array) -> Near:
    """The largest values of one part of a waveform.

    Parameters
    ----------
    values
        Shape (candidates, moments).
    time
        Of the moments [s], of that shape or (moments,).

    Returns
    -------
    Near
        In order of time, for each candidate.
    """
    near = near_largest(values)
    near[:, 0] = True
    row, place = np.nonzero(near)
    return Near(row, values[near], np.broadcast_to(time, values.shape)[row, place])


def near_power(found: Wave, stage: Any, start: float) -> Near:
    """The largest powers at the input of stages in one part of a waveform [W].

    Parameters
    ----------
    found
        Current and voltage that make the motors' power.
    stage
        Of each candidate.
    start
        Of the part [s].

    Returns
    -------
    Near
        Ends of segments and vertices between them.
    """
    inner = at_input(found, stage)
    power, at = highest_powers(inner)
    begin = np.cumsum(inner.duration, axis=-1) - inner.duration
    return near_values(power, start + (begin + at * inner.duration))


def first_of(found: Sequence[Near], count: int) -> tuple[Array, Array]:
    """The largest value of each candidate, and when it is met first.

    Parameters
    ----------
    found
        Of all parts.
    count
        Of candidates.

    Returns
    -------
    tuple of arrays
        Value and time [s], of places that differ by rounding alone the first.
    """
    row, value, time = (np.concatenate(column) for column in zip(*found, strict=True))
    largest, when = np.empty((2, count))
    for k in range(count):
        mine = row == k
        top, place = first_largest(value[mine])
        largest[k], when[k] = top, time[mine][place]
    return largest, when


def energy_of_source(parts: Iterable[Wave], feed: Feed, kept: float, *, storing: bool) -> Energy:
    """``power_stage.source_energy`` of a waveform in parts.

    Parameters
    ----------
    parts
        Current and voltage that make the motors' power, one part after the other.
    feed
        Their stages and supply.
    kept, storing
        As ``waveform.energy`` takes them.

    Returns
    -------
    Energy
        Of each drive [J].
    """
    drawn, returned, walks = list[Array](), list[Array](), list[_Walk]()
    apart = storing and bool(np.any(feed.stage.assumed))
    least = feed.stage._replace(loss=feed.stage.least_loss)
    for found in parts:
        inner = at_input(found, feed.stage)
        out, back = _drawn_and_returned(inner)
        more = feed.stage.standby * inner.duration.sum(axis=-1) + lost_in_source(inner, feed).sum(axis=-1)
        drawn.append(out.sum(axis=1) + more)
        returned.append(back.sum(axis=1))
        if storing:
            walks.append(_walk(*(_drawn_and_returned(at_input(found, least)) if apart else (out, back)), kept))
    stored = _stored(walks) if storing else np.full_like(returned[0], np.nan)
    return Energy(np.sum(drawn, axis=0), np.sum(returned, axis=0), stored)


def _drawn_and_returned(found: Wave) -> tuple[Array, Array]:
    """Energy of each step of one sign [J]: what is drawn, what is returned; shape (candidates, steps)."""
    steps = signed_energy(found).reshape(len(found.current), -1)
    return np.maximum(steps, 0.0), np.maximum(-steps, 0.0)


class _Walk(NamedTuple):
    """A store over a part, from nothing: at its end, lowest, highest, its largest rise, all that came [J]."""

    end: Array
    low: Array
    high: Array
    rise: Array
    came: Array


def _walk(drawn: Array, returned: Array, kept: float) -> _Walk:
    came = returned * kept
    sums = np.cumsum(came - drawn, axis=1)
    lowest = np.minimum(np.minimum.accumulate(sums, axis=1), 0.0)
    rise, high = (np.maximum(x.max(axis=1), 0.0) for x in (sums - lowest, sums))
    return _Walk(sums[:, -1], lowest[:, -1], high, rise, came.sum(axis=1))


def _stored(walks: Sequence[_Walk]) -> Array:
    """Largest rise over a cycle that repeats, as ``waveform.energy`` has it of all steps."""
    sums = lowest = risen = np.zeros_like(walks[0].end)
    for part in [*walks, *walks]:
        risen = np.maximum(np.maximum(risen, part.rise), sums + part.high - lowest)
        lowest = np.minimum(lowest, sums + part.low)
        sums = sums + part.end
    found: Array = np.where(sums > 0.0, np.inf, np.minimum(risen, np.sum([part.came for part in walks], axis=0)))
    return found
