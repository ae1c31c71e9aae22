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

__all__ = ["LONGEST", "LongSimulation", "simulate_long"]

LONGEST = 250_000_000  # steps of a simulation: some 40 s
_LEAD, _WATCHED = 1.0, 2.0  # s of a window before it is recorded, and recorded
_EVEN = 8  # windows at even distances
_NEAR = 0.5  # of a figure's largest value: windows that reach it are compared
_PEAKS = (
    "voltage_demand", "stage_voltage", "voltage", "current", "current_demand", "speed", "speed_error", "angle_error",
    "load_speed_error", "load_angle_error", "gear_torque", "power", "bus_current",
)  # fmt: skip
_MEANS = ("rms_current", "rms_gear_torque_running")
_EXCESS = 10.0  # error of the I2t integral, a difference of squares, over that of the current's square


class LongSimulation(NamedTuple):
    """Simulation of a long motion."""

    out: Simulation  # with the largest peaks of motion and windows
    drive: Drive  # simulated from end to end
    allowed: dict[str, float]  # factor of 1 and more by which a figure may exceed its reported value
    windows: tuple[tuple[float, float], ...]  # s, in which the full drive was simulated


def simulate_long(drive: Drive, task: Task, rows: int) -> LongSimulation:
    """Simulate a drive along a motion of hours."""
    slow = slower(drive) if isinstance(drive.controller, Cascade) else None
    out = simulate(slow or drive, task, rows=max(rows, 2), most_steps=LONGEST)
    if slow is None or out.problems[0]:
        return LongSimulation(out, slow or drive, {}, ())
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
    return LongSimulation(replace(out, figures=figures), slow, allowed, tuple(windows))


def _windows(task: Task, out: Simulation) -> list[tuple[float, float]]:
    """Windows of the full drive [s]: around the largest values and at even distances, without overlap."""
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
    """Simulation of a drive in a window, from its temperature there; times are those of the whole motion."""
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
    """A part of a task, recorded from a time on."""

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


def _allowed(name: str, out: Simulation, reported: dict[str, Any], pairs: Sequence[Any]) -> float:
    """Factor by which a figure may exceed its reported value: the largest of full over slower drive in the windows."""
    most = float(out.figures[name][0])
    found = [
        float(seen.figures[name][0] / slow.figures[name][0])
        for seen, slow in pairs
        if slow.figures[name][0] >= _NEAR * most > 0.0
    ]
    return max([1.0, *(x * most / float(reported[name][0]) for x in found)])
