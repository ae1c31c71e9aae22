"""Motions of hours in closed loop: a simulation with a slower current loop, held against the whole drive in windows.

A motion with more periods of the current loop than can be simulated is simulated with that loop at the velocity loop's
rate (``slower_loop``). The full drive is simulated in windows: around the largest value of every figure, and at even
distances. There both are compared: the largest factor by which the full drive exceeds the slower one is the allowance
of a figure outside the windows. A check that passes without that allowance and fails with it is unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drivesizer.control.cascade import Cascade
from drivesizer.control.closed_loop.slower_loop import slower
from drivesizer.control.engine import Drive, Simulation, Task, simulate

__all__ = ["LONGEST", "Long", "simulate_long"]

LONGEST = 250_000_000  # steps of a simulation: some 40 s
_LEAD, _WATCHED = 1.0, 2.0  # s, that a window is simulated before it is watched, and is watched
_EVEN = 8  # windows at even distances
_NEAR = 0.5  # of a figure's largest value: a window in which it reaches that tells by how much the two differ
_PEAKS = (
    "voltage_asked", "voltage", "current", "current_asked", "speed", "speed_error", "angle_error", "load_speed_error",
    "load_angle_error", "gear_torque", "power", "bus_current",
)  # fmt: skip
_MEANS = ("rms_current", "rms_gear_torque_running")
_EXCESS = 10.0  # times as far off as the current's square is the I2t integral taken to be, a difference of squares


class Long(NamedTuple):
    """A simulation of a long motion."""

    out: Simulation  # with the larger of all peaks
    drive: Drive  # that was simulated from end to end
    allowed: dict[str, float]  # factor of 1 and more by which a figure may be larger than it is told
    windows: tuple[tuple[float, float], ...]  # s, in which the drive as it is was simulated


def simulate_long(drive: Drive, task: Task, rows: int) -> Long:
    """Simulate a drive along a motion of hours.

    Parameters
    ----------
    drive, task, rows
        As in ``engine.simulate``.
    """
    slow = slower(drive) if isinstance(drive.controller, Cascade) else None
    out = simulate(slow or drive, task, rows=max(rows, 2), most_steps=LONGEST)
    if slow is None or out.problems[0]:
        return Long(out, slow or drive, {}, ())
    windows = _windows(task, out)  # of the first cycle
    pairs = [tuple(_seen(one, task, out, *window) for one in (drive, slow)) for window in windows]
    whole = [pair for pair in pairs if not pair[0].problems[0] and not pair[1].problems[0]]
    figures = dict(out.figures)
    for name in _PEAKS:
        for seen, _ in whole:
            if seen.figures[name][0] > figures[name][0]:
                figures[name], figures[f"{name}_time"] = seen.figures[name], seen.figures[f"{name}_time"]
    allowed = {name: _allowed(name, out, figures, whole) for name in (*_PEAKS, *_MEANS)}
    allowed["i2t_share"] = 1.0 + _EXCESS * (allowed["rms_current"] ** 2 - 1.0)
    return Long(replace(out, figures=figures), slow, allowed, tuple(windows))


def _windows(task: Task, out: Simulation) -> list[tuple[float, float]]:
    """Where the drive as it is is watched [s]: about the largest values, and at even distances; none over another."""
    first, last = task.time[0], task.time[-1]
    about = [first + float(out.figures[f"{name}_time"][0]) % (last - first) for name in _PEAKS]
    about += np.linspace(first, last, _EVEN, endpoint=False).tolist()
    starts = sorted(min(max(t - 0.5 * _WATCHED, first), last - _WATCHED) for t in about)
    kept = starts[:1] + [b for a, b in pairwise(starts) if b > a]
    found: list[tuple[float, float]] = []
    for start in kept:
        if found and start < found[-1][1]:
            found[-1] = found[-1][0], start + _WATCHED
        else:
            found.append((start, start + _WATCHED))
    return found


def _seen(drive: Drive, task: Task, out: Simulation, start: float, end: float) -> Simulation:
    """A set watched in a window, at the temperature that it has there; times as in the whole motion."""
    begin = max(start - _LEAD, task.time[0])
    heat = drive.heat
    if heat is not None and out.series is not None:
        warm = float(np.interp(begin, out.series["time"], out.series["winding"]))
        heat = replace(heat, winding=warm, housing=warm)
    found = simulate(replace(drive, heat=heat), _cut(task, begin, start, end), rows=0)
    later = begin - task.time[0]
    return replace(
        found, figures={name: x + later * name.endswith("_time") for name, x in found.figures.items()}
    )  # fmt: skip


def _cut(task: Task, begin: float, start: float, end: float) -> Task:
    """A part of a task, from a moment on watched."""

    def part(times: Sequence[float] | Any, values: Sequence[float] | Any) -> tuple[Any, Any]:
        t = np.asarray(times, float)
        if not len(t):
            return (), ()
        some = np.concatenate(([begin], t[(t > begin) & (t < end)], [end]))
        return some, np.interp(some, t, np.asarray(values, float))

    time, speed = part(task.time, task.speed)
    load_time, load_torque = part(task.load_time, task.load_torque)
    return Task(
        time=time, speed=speed, load_time=load_time, load_torque=load_torque, since=start if start > begin else None
    )


def _allowed(name: str, out: Simulation, told: dict[str, Any], pairs: Sequence[Any]) -> float:
    """By what factor a figure may exceed what is told of it: as the drive as it is exceeds the slower at most."""
    most = float(out.figures[name][0])
    found = [
        float(seen.figures[name][0] / slow.figures[name][0])
        for seen, slow in pairs
        if slow.figures[name][0] >= _NEAR * most > 0.0
    ]
    return max([1.0, *(x * most / float(told[name][0]) for x in found)])
