"""Input of a simulation: drives with controllers and limits, and the motion required of them, in pieces."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine.layout import Array
from drivesizer.control.validation import Cascade, Gains
from drivesizer.errors import InputError
from drivesizer.physics.thermal import TwoBodies

__all__ = ["CurrentLimit", "Drive", "MotorHeat", "Resolution", "Supply", "Task", "checked", "pieces_of"]


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
    cycles: int = 1  # number of repetitions; the length is then rounded up to whole samples of the slowest loop


# -- Checks of a task and its drives.


_POSITIVE = {
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
    for drive in drives:
        m, supply = drive.train, drive.supply
        above = _POSITIVE | ({"stiffness", "load_inertia"} if m.flexible else set())
        for f in fields(DriveTrain):
            value = getattr(m, f.name)
            known = value > 0.0 if f.name in above else value >= 0.0 or f.name in _SIGNED
            if not known or (f.name != "stiffness" and not math.isfinite(value)):
                raise InputError(f"machine: {f.name.replace('_', ' ')} {value:g} is no figure of a machine")
        if not supply.voltage > supply.voltage_drop >= 0.0:
            raise InputError("supply: expected a voltage above the drop")


# -- A task as straight pieces between samples.
#
# A corner between two samples takes effect at the next one. A piece shorter than a sample is left out, or ends at
# the values of reference and load a sample later, so that a jump lasts a sample at most.


_WHOLE = 1e-9  # a corner this near to a sample, in periods, is on it
_ROUNDING = 8.0 * np.finfo(float).eps  # of a time, the same


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
    # the sample at which each corner takes effect; corners closer than rounding share one
    slack = _WHOLE + _ROUNDING * starts / h
    apart = np.concatenate(([True], np.diff(starts) > 2.0 * h * slack[1:]))
    tick = np.ceil(starts / h - slack)[np.maximum.accumulate(np.where(apart, np.arange(len(starts)), 0))]
    if task.cycles > 1:
        whole = p[at.N_V] * max(p[at.N_P], 1.0)  # periods after which all loops are at the same sample again
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
