"""Checks of a task and its drives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.engine.task import Drive, Task
from drivesizer.errors import InputError

__all__ = ["checked", "multiples"]

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
