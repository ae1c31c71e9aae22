"""A set put together for the simulation: its controller designed, its machine, its heat, and what it is asked for.

Gains are those of ``loop_design``. What is taken for granted on the way is kept with the
result.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import NamedTuple

import numpy as np

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain, within_reach
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Resolution, Supply, Task
from drivesizer.control.linear_modes import Machine, machine_of
from drivesizer.control.loop_design import designed, edges_of, gap_of, shaft_of
from drivesizer.control.loop_models import Shaft
from drivesizer.control.validation import Gains
from drivesizer.errors import InputError
from drivesizer.load_cases.at_shaft import at_shaft, remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.physics.stress import housing_loss
from drivesizer.physics.thermal import TwoBodies, two_bodies
from drivesizer.physics.usable_voltage import usable_in
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec

__all__ = ["FOLLOWS", "Prepared", "prepared"]

FOLLOWS = 0.1  # of the top speed: a drive whose error grows beyond a tenth is not said to follow (our convention)
_WHOLE = 1e-9  # share of a cycle that is none


class Prepared(NamedTuple):
    """What a simulation takes, and what that was made of."""

    train: DriveTrain
    controller: Gains | Cascade
    shaft: Shaft | None
    usable_voltage: float  # V, NaN unknown
    drive: Drive
    task: Task
    said: tuple[str, ...]  # what was assumed on the way


def prepared(
    spec: RobotSpec, drive_set: DriveSet, asked: Profile, controller: Gains | Cascade | None = None
) -> Prepared:
    """A set and its task as the engine takes them; with a controller that was designed before, where one is given.

    Raises
    ------
    InputError
        As :func:`run`.
    """
    train, own, said = designed(spec, drive_set)
    controller = controller or own
    within_reach(train, asked)
    _sampled(controller, asked)
    shaft = shaft_of(spec, train)
    usable = usable_in(spec.supply.lowest, drive_set.controller)
    heat, lacks = _heat(spec, drive_set)
    drive = _drive(spec, drive_set, _machine(spec, drive_set, train, shaft), controller, heat, usable)
    return Prepared(train, controller, shaft, usable, drive, _task(spec, asked, train), (*said, *lacks))


# --- what is asked


def _sampled(controller: Gains | Cascade, asked: Profile) -> None:
    """Refuse a profile whose top speed no sample of the velocity loop sees, or that has more samples than numbers."""
    period = controller.period if isinstance(controller, Gains) else controller.velocity_period
    if not asked.duration / period < 2.0**53:
        raise InputError(f"profile {asked.name}: {asked.duration:g} s is too long to be sampled every {period:g} s")
    time, speed = np.array(asked.time) - asked.time[0], np.array(asked.speed)
    near = np.unique(np.concatenate([np.floor(time / period + k) for k in (-1.0, 0.0, 1.0)])) * period
    seen = np.abs(np.interp(near[(near >= 0.0) & (near <= time[-1])], time, speed)).max(initial=0.0)
    if not seen >= (1.0 - FOLLOWS) * asked.top_speed:
        raise InputError(
            f"profile {asked.name}: its top speed lies between two samples of the controller, {period:g} s apart; "
            "expected a slower change"
        )


def _task(spec: RobotSpec, asked: Profile, train: DriveTrain) -> Task:
    """What is asked of the driven shaft, as often as the mission lasts."""
    left = remaining_torque(spec, asked, at_shaft(spec))
    lasts = spec.mission.duration / asked.duration if spec.mission else 1.0
    return Task(
        time=asked.time,
        speed=tuple((np.array(asked.speed) / train.radius).tolist()),
        load_time=tuple(left[:, 0].tolist()),
        load_torque=tuple(left[:, 1].tolist()),
        cycles=max(1, math.ceil(lasts - _WHOLE)),
    )


# --- the machine


def _machine(spec: RobotSpec, drive_set: DriveSet, train: DriveTrain, shaft: Shaft | None) -> Machine:
    machine = machine_of(train)
    if shaft is None:
        return machine
    return replace(machine, stiffness=shaft.stiffness, damping=shaft.damping, gap=gap_of(spec, drive_set))


def _drive(
    spec: RobotSpec, drive_set: DriveSet, machine: Machine, own: Gains | Cascade, heat: MotorHeat | None, usable: float
) -> Drive:
    """The set as the engine takes it; an unknown limit is none there, and unknown in its check."""
    controller, known = drive_set.controller, not math.isnan(usable)

    def limit(name: str) -> float:
        value = getattr(controller, name) if controller else math.nan
        return math.inf if math.isnan(value) else float(value)

    return Drive(
        machine=machine,
        controller=own,
        supply=Supply(
            voltage=spec.supply.lowest, resistance=spec.supply.resistance or 0.0, sets=spec.load.motors,
            max_duty=controller.max_duty if controller and known else 1.0,
            voltage_drop=controller.voltage_drop if controller and known else 0.0,
        ),
        current=CurrentLimit(
            peak=limit("peak_current"), continuous=limit("continuous_current"), peak_time=limit("peak_time")
        ),
        encoder=Resolution(edges=edges_of(spec, drive_set), periods=max(own.counted_over, 1)),
        heat=heat,
    )  # fmt: skip


def _heat(spec: RobotSpec, drive_set: DriveSet) -> tuple[MotorHeat | None, list[str]]:
    """Winding and housing, which friction and iron warm, and what is left out; None where a figure is unknown."""
    figures = asdict(drive_set.motor)
    bodies: TwoBodies = two_bodies(figures)
    if not (bodies.known and spec.plant.warming):
        return None, []
    coulomb, viscous = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    losses = {"loss_torque": coulomb, "loss_viscous": viscous}
    known = {name: loss for name, loss in losses.items() if not math.isnan(loss)}
    said = ["what the motor loses beside its copper is unknown, and warms nothing"] if known != losses else []
    return MotorHeat(bodies=bodies, ambient=spec.environment.ambient, **known), said
