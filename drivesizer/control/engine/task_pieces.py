"""A task as straight pieces between samples.

A corner between two samples takes effect at the next one. A piece shorter than a sample is left out, or ends at the
values of reference and load a sample later, so that a jump lasts a sample at most.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.blocks import blocks
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.task import Task
from drivesizer.errors import InputError

__all__ = ["Flags", "Part", "pieces_of", "stretches"]

Flags = NDArray[np.bool_]
_WHOLE = 1e-9  # a corner this near to a sample, in periods, is on it
_ROUNDING = 8.0 * np.finfo(float).eps  # of a time, the same
_LAP = 4096  # periods of a lap of a long stretch, at least
_LAPS = 64  # of which a stretch is long


class Part(NamedTuple):
    """Pieces of a task in a row."""

    first: int
    end: int  # the one after the last
    rows: int  # of a motion that they repeat; 0: nothing repeats


def pieces_of(task: Task, p: Array) -> Array:
    """A task as pieces between samples, at the motor shaft."""
    h, K, origin = p[at.H], p[at.RATIO], task.time[0]
    time, speed = np.asarray(task.time, float) - origin, np.asarray(task.speed, float) * K
    if not time[-1] / h < 2.0**53:
        raise InputError(f"task: {time[-1]:g} s is too long to be sampled every {h:g} s")
    load = np.array([0.0]), np.array([0.0])
    if len(task.load_time):
        load = np.asarray(task.load_time, float) - origin, np.asarray(task.load_torque, float)
    starts = np.unique(np.concatenate((time, load[0][(load[0] > 0.0) & (load[0] < time[-1])])))
    if task.since is not None:
        starts = np.union1d(starts, task.since - origin)
    tick = _ticks(starts, h)
    if task.cycles > 1:
        whole = _whole(p)
        tick[-1] = np.ceil(tick[-1] / whole - _WHOLE) * whole
    kept = np.flatnonzero(tick[1:] > tick[:-1])
    first, last, start = tick[kept], tick[kept + 1], starts[kept]
    short = (starts[kept + 1] - start < h) & (last - first == 1.0)
    corner = np.isin(start, time)
    start = np.where(short, np.maximum(start, first * h), start)
    later = np.where(short, (first + 1.0 - _WHOLE) * h, start)
    (v, slope), (l, dl) = _line(start, time, speed), _line(start, *load)
    slope = np.where(short, (_line(later, time, speed)[0] - v) / h, slope)
    dl = np.where(short, (_line(later, *load)[0] - l) / h, dl)
    return np.column_stack((first, last, start, v, slope, _angle(start, time, speed), l, dl, corner))


def _ticks(starts: Array, h: float) -> Array:
    """The sample at which each corner takes effect; corners closer than rounding share one."""
    slack = _WHOLE + _ROUNDING * starts / h
    tick = np.ceil(starts / h - slack)
    apart = np.concatenate(([True], np.diff(starts) > 2.0 * h * slack[1:]))
    return np.asarray(tick[np.maximum.accumulate(np.where(apart, np.arange(len(starts)), 0))])


def _line(x: Array, corners: Array, values: Array) -> tuple[Array, Array]:
    """Value and slope to the right of some points of straight lines between corners; constant beyond them."""
    n = np.searchsorted(corners, x, "right") - 1
    inside = (n >= 0) & (n < len(corners) - 1)
    a, b = np.where(inside, n, 0), np.where(inside, n + 1, 0)
    rise, run = values[b] - values[a], np.where(inside, corners[b] - corners[a], 1.0)
    slope = np.where(inside, rise / run, 0.0)
    beyond = np.where(n < 0, values[0], values[-1])
    return np.where(inside, values[a] + slope * (x - corners[a]), beyond), slope


def _angle(x: Array, time: Array, speed: Array) -> Array:
    """Angle of the reference at some times [rad]."""
    n = np.clip(np.searchsorted(time, x, "right") - 1, 0, len(time) - 2)
    before = np.concatenate(([0.0], np.cumsum(np.diff(time) * (speed[1:] + speed[:-1]) / 2.0)))[n]
    return np.asarray(before + (x - time[n]) * (speed[n] + _line(x, time, speed)[0]) / 2.0)


def _whole(p: Array) -> float:
    """Periods after which all loops are at the same sample again."""
    return float(p[at.N_V] * max(p[at.N_P], 1.0))


def stretches(pieces: Array, p: Array) -> tuple[list[Part], Flags, int]:
    """Ranges of a task's pieces: repeated motions, and the rest."""
    lap = int(np.ceil(_LAP / _whole(p)) * _whole(p))
    constant = (pieces[:, 4] == 0.0) & (pieces[:, 7] == 0.0) & (pieces[:, 1] - pieces[:, 0] >= _LAPS * lap)
    found, done = [], 0
    for part in [*(Part(*block) for block in blocks(pieces, p, lap, _LAPS * lap)), Part(len(pieces), len(pieces), 0)]:
        found += [Part(done, part.first, 0)] * (part.first > done) + [part]
        done = part.end
    return found[:-1], constant, lap
