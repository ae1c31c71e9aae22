"""A task as straight pieces between samples."""

from __future__ import annotations

import numpy as np

import drivesizer.engine.places as at
from drivesizer.engine.drive import Task
from drivesizer.engine.places import Array
from drivesizer.errors import InputError

__all__ = ["pieces_of"]

_WHOLE = 1e-9  # a corner this near to a sample, in periods, is on it


def pieces_of(task: Task, p: Array) -> Array:
    """The task as the march's pieces, at the motor shaft; corners between two samples leave none."""
    h, K = p[at.H], p[at.RATIO]
    time, speed = np.array(task.time) - task.time[0], np.array(task.speed) * K
    if not time[-1] / h < 2.0**53:
        raise InputError(f"task: {time[-1]:g} s is too long to be sampled every {h:g} s")
    load_time, load = np.array(task.load_time or (0.0,)) - task.time[0], np.array(task.load_torque or (0.0,))
    starts = np.unique(np.concatenate((time, load_time[(load_time > 0.0) & (load_time < time[-1])])))
    n = np.searchsorted(time, starts[:-1], "right") - 1
    slope = (np.diff(speed) / np.diff(time))[n]
    angle = np.concatenate(([0.0], np.cumsum(np.diff(time) * (speed[1:] + speed[:-1]) / 2.0)))[n]
    since = starts[:-1] - time[n]
    forces = np.interp(starts, load_time, load)
    tick = np.ceil(starts / h - _WHOLE)
    if task.cycles > 1:
        whole = p[at.N_V] * max(p[at.N_P], 1.0)
        tick[-1] = np.ceil(tick[-1] / whole - _WHOLE) * whole
    found = np.column_stack((
        tick[:-1], tick[1:], starts[:-1], speed[n] + slope * since, slope,
        angle + (speed[n] + 0.5 * slope * since) * since, forces[:-1], np.diff(forces) / np.diff(starts), since == 0.0,
    ))  # fmt: skip
    return np.ascontiguousarray(found[found[:, 1] > found[:, 0]])
