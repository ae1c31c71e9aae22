"""Input of a simulation: drives with controllers and limits, and the motion required of them, in pieces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import drivesizer.control.engine.layout as at
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine.layout import Array
from drivesizer.control.validation import Cascade, Gains
from drivesizer.errors import InputError
from drivesizer.physics.thermal import TwoBodies

__all__ = [
    "CurrentLimit", "Drive", "Flags", "MotorHeat", "Part", "Resolution", "Supply", "Task", "checked", "multiples",
    "pieces_of", "stretches",
]  # fmt: skip


# -- Input of a simulation: a drive with its controller and limits, and the motion and load required of it.


@dataclass(frozen=True, slots=True, kw_only=True)
class Supply:
    """The bus that feeds a number of equal drives, and the controller's voltage range."""

    voltage: float  # V, without load
    resistance: float = 0.0  # ohm, of the source and its cables
    sets: int = 1
    max_duty: float = 1.0
    voltage_drop: float = 0.0  # V
    loss: float = 0.0  # W/A, of each power stage
    stage_resistance: float = 0.0  # ohm, of each power stage
    standby: float = 0.0  # W, of each controller
    leads: float = 0.0  # ohm, that take of the voltage at full duty (``physics.power_stage``); of its check
    raises: bool = False  # whether regenerated energy raises the bus; else a brake chopper or a battery takes it


@dataclass(frozen=True, slots=True, kw_only=True)
class CurrentLimit:
    """Peak current for its time, then the continuous one (integral of I^2 - I_cont^2); infinite: none, or not known."""

    peak: float = math.inf  # A
    continuous: float = math.inf  # A
    peak_time: float = math.inf  # s, at the peak from rest


@dataclass(frozen=True, slots=True, kw_only=True)
class Resolution:
    """Counts of the motor's angle; 0 edges: speed and angle are measured exactly."""

    edges: int = 0  # per turn of the motor
    periods: int = 1  # of the velocity loop, over which counts are taken for a speed


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorHeat:
    """Winding and housing, and where they start."""

    bodies: TwoBodies
    ambient: float  # K
    winding: float = math.nan  # K at the start; NaN: ambient
    housing: float = math.nan  # K at the start; NaN: ambient
    loss: float = 0.0  # W at the housing, always
    loss_torque: float = 0.0  # N*m at the housing: times the speed
    loss_viscous: float = 0.0  # N*m*s/rad at the housing: times the square of the speed
    brief: bool = False  # whether a period's step is one of the second order, and its derivatives follow now and then


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One drive: drive train, controller, supply, limits."""

    train: DriveTrain
    controller: Gains | Cascade
    supply: Supply
    current: CurrentLimit = CurrentLimit()
    encoder: Resolution = Resolution()
    heat: MotorHeat | None = None  # None: the winding stays at 25 degC
    delay: bool = True  # cascade: each loop responds one of its periods late
    drain_time: float = math.inf  # s, in which the integral drains to 1/e at rest, where friction holds
    prompt: bool = False  # cascade: except the current loop, which responds at once (see ``slower_loop``)


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Required motion and load of the driven shaft; straight lines between the corners."""

    time: Sequence[float] | Array  # s, strictly rising
    speed: Sequence[float] | Array  # rad/s of the driven shaft
    load_time: Sequence[float] | Array = ()  # s, strictly rising
    load_torque: Sequence[float] | Array = ()  # N*m, added to the drive train's own; constant beyond the corners
    since: float | None = None  # s; what comes before is simulated and not recorded; of one cycle
    cycles: int = 1  # number of repetitions; the length is then rounded up to whole samples of the slowest loop


# -- Checks of a task and its drives.


_ABOVE_ZERO = {
    "resistance", "inductance", "torque_constant", "back_emf_constant", "motor_inertia", "gear_ratio",
    "gear_efficiency", "belt_ratio", "belt_efficiency", "radius",
}  # fmt: skip
_SIGNED = {"forward_torque", "backward_torque", "rest_torque"}


def checked(drives: Sequence[Drive], task: Task) -> None:
    """Refuse a task or a drive that cannot be simulated."""
    for name, times, values in (("time", task.time, task.speed), ("load_time", task.load_time, task.load_torque)):
        t, v = np.asarray(times, float), np.asarray(values, float)
        if t.ndim != 1 or t.shape != v.shape or not (np.all(np.diff(t) > 0.0) and np.isfinite((t, v)).all()):
            raise InputError(f"task: {name} and its values are to be finite, as many, and the times rising")
    if len(task.time) < 2 or task.cycles < 1:
        raise InputError("task: expected at least two corners, and at least one cycle")
    if task.since is not None and not (task.cycles == 1 and task.time[0] < task.since < task.time[-1]):
        raise InputError("task: since is to lie within a single cycle")
    if len({drive.train.flexible for drive in drives}) != 1:
        raise InputError("expected at least one drive, and all of them rigid or all flexible")
    for drive in drives:
        _checked_drive(drive)


def _checked_drive(drive: Drive) -> None:
    m = drive.train
    above = _ABOVE_ZERO | ({"stiffness", "load_inertia"} if m.flexible else set())
    for f in fields(DriveTrain):
        value = getattr(m, f.name)
        if not (value > 0.0 if f.name in above else value >= 0.0 or f.name in _SIGNED):
            raise InputError(f"machine: {f.name.replace('_', ' ')} {value:g} is no figure of a machine")
        if not math.isfinite(value) and f.name != "stiffness":
            raise InputError(f"machine: {f.name.replace('_', ' ')} is not finite")
    c, supply = drive.controller, drive.supply
    if isinstance(c, Cascade):
        multiples(c)
    elif not c.period > 0.0:
        raise InputError(f"controller: period {c.period:g} s: expected a time above 0")
    if not supply.voltage > supply.voltage_drop >= 0.0 or not supply.resistance >= 0.0 or not 0 < supply.max_duty <= 1:
        raise InputError("supply: expected a voltage above the drop, a resistance of 0 or more, a duty up to 1")
    if not min(supply.loss, supply.stage_resistance, supply.standby, supply.leads) >= 0.0:
        raise InputError("supply: expected losses of 0 or more")
    if drive.heat is not None and not drive.heat.bodies.known:
        raise InputError("heat: a thermal figure is unknown; expected all of them, or no heat")


def multiples(c: Cascade) -> tuple[int, int]:
    """Current periods per velocity period, and velocity periods per position period."""
    found = []
    for name, slow, fast in (("velocity", c.velocity_period, c.current_period),
                             ("position", c.position_period, c.velocity_period)):  # fmt: skip
        n = round(slow / fast) if fast > 0.0 and math.isfinite(slow / fast) else -1
        if n < (name == "velocity") or abs(slow / fast - n) > 1e-6 * max(n, 1):
            raise InputError(f"controller: {name} period {slow:g} s: expected a whole multiple of {fast:g} s")
        found.append(n)
    return found[0], found[1]


# -- Motions that a task has written out repeatedly: ranges of its pieces that repeat.
#
# Pieces are the same when they have equal duration, and equal speed and load at both ends. Equal pieces get the same
# number; where numbers repeat at a distance, so does the motion. The last row of ``benchmarks/closed_loop.py``
# measures it.


Numbers = NDArray[np.int64]


_SAME = 1e-9  # of the largest speed or load: smaller differences are neglected
_SAME_TIME = 1e-3  # of a period, the same
_LEAST = 8  # least laps
_AHEAD = 3  # next places of a number whose distances are tried
_TRIED = 48  # distances, the most frequent first


def blocks(pieces: Array, p: Array, lap: int, worth: int) -> list[tuple[int, int, int]]:
    """Ranges of pieces that repeat."""
    if len(pieces) < 2 * _LEAST or pieces[-1, 1] < worth:
        return []
    numbers = _numbers(pieces, p)
    found = [run for distance in _distances(numbers) for run in _runs(numbers, distance)]
    taken: list[tuple[int, int, int]] = []
    for first, end, rows in sorted(found, key=lambda run: (run[0] - run[1], run[2], run[0])):  # the longest first
        periods = (pieces[end - 1, 1] - pieces[first, 0]) * rows / (end - first)
        rows *= int(np.ceil(lap / max(periods, 1.0)))
        end -= (end - first) % rows
        clear = all(end <= a or first >= b for a, b, _ in taken)
        if clear and end - first >= _LEAST * rows and pieces[end - 1, 1] - pieces[first, 0] >= worth:
            taken.append((first, end, rows))
    return sorted(taken)


def _numbers(pieces: Array, p: Array) -> Numbers:
    """Numbers of the pieces: the same number, the same motion."""
    start, end = pieces[:, 2], np.append(pieces[1:, 2], pieces[-1, 1] * p[at.H])
    lasts = end - start
    speed, load = pieces[:, 3], pieces[:, 6]
    columns = [(lasts, _SAME_TIME * p[at.H])]
    for first, slope in ((speed, pieces[:, 4]), (load, pieces[:, 7])):
        columns += [(x, _SAME * float(np.abs(first).max())) for x in (first, first + slope * lasts)]
    found = np.zeros(len(pieces), np.int64)
    for values, apart in columns:
        kind = _kinds(values, apart)
        _, found = np.unique(found * (kind.max() + 1) + kind, return_inverse=True)
    return np.asarray(found, np.int64)


def _kinds(values: Array, apart: float) -> Numbers:
    """Numbers of values; neighbours no farther apart than a bound share one."""
    order = np.argsort(values, kind="stable")
    kind = np.zeros(len(values), np.int64)
    kind[order[1:]] = np.cumsum(np.diff(values[order]) > apart)
    return kind


def _distances(numbers: Numbers) -> list[int]:
    """Distances at which numbers recur, the most frequent first."""
    order = np.argsort(numbers, kind="stable")
    same = numbers[order]
    found = [
        (order[n:] - order[:-n])[same[n:] == same[:-n]] for n in range(1, _AHEAD + 1) if n < len(numbers)
    ]  # fmt: skip
    distance, count = np.unique(np.concatenate(found), return_counts=True)
    return [int(x) for x in distance[np.lexsort((distance, -count * distance))][:_TRIED]]


def _runs(numbers: Numbers, distance: int) -> list[tuple[int, int, int]]:
    """Ranges in which numbers repeat at a distance."""
    if _LEAST * distance > len(numbers):
        return []
    same = np.concatenate(([False], numbers[distance:] == numbers[:-distance], [False]))
    edges = np.flatnonzero(np.diff(same.astype(np.int8)))
    starts, ends = edges[::2], edges[1::2] + distance
    long = ends - starts >= _LEAST * distance
    return [(int(a), int(b), distance) for a, b in zip(starts[long], ends[long], strict=True)]


# -- A task as straight pieces between samples.
#
# A corner between two samples takes effect at the next one. A piece shorter than a sample is left out, or ends at
# the values of reference and load a sample later, so that a jump lasts a sample at most.


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
