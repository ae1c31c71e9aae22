"""Input of a simulation: drive train, designed controller, limits, heat and task of a drive.

Gains are those of ``loop_design``. Assumptions are kept with the result.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivesizer.catalog.parts import Controller, one_row
from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain, within_reach
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Resolution, Supply, Task
from drivesizer.control.loop_design import designed, edges_of, train_behind
from drivesizer.control.validation import Gains
from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.at_shaft import remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.physics.cycle_at_gearhead import at_gearhead
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.stress import housing_loss
from drivesizer.physics.thermal import TwoBodies, two_bodies
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.ratings import controller_current
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec

__all__ = ["FOLLOWS", "Prepared", "motor_heat", "prepared"]

FOLLOWS = 0.1  # of the top speed: a drive whose error exceeds it does not follow (our convention)
_DRAIN = 0.05  # s: slow for the current loop, short for a rest between two motions (our choice)
_WHOLE = 1e-9  # share of a cycle that is neglected


class Prepared(NamedTuple):
    """Input of a simulation, and the parts that it was made from."""

    train: DriveTrain
    controller: Gains | Cascade
    usable_voltage: float  # V, NaN unknown
    drive: Drive
    task: Task
    assumptions: tuple[str, ...]


def prepared(
    spec: RobotSpec, drive_set: DriveParts, profile: Profile, controller: Gains | Cascade | None = None
) -> Prepared:
    """A drive and its task as the engine takes them."""
    if controller is None:
        train, controller, said = designed(spec, drive_set)
    else:
        train, said = train_behind(spec, drive_set, controller)
    within_reach(train, profile)
    _sampled(controller, profile)
    feed = spec.feed_of(drive_set.controller, drive_set.brake)
    usable = float(feed.usable)
    heat, lacks = motor_heat(spec, drive_set)
    drive = _drive(spec, drive_set, train, controller, heat, feed)
    return Prepared(train, controller, usable, drive, _task(spec, profile, train), (*said, *lacks))


# --- the task


def _sampled(controller: Gains | Cascade, profile: Profile) -> None:
    """Refuse a profile whose top speed lies between samples of the velocity loop, or that is too long to be counted."""
    period = controller.period if isinstance(controller, Gains) else controller.velocity_period
    if not profile.duration / period < 2.0**53:
        raise InputError(f"profile {profile.name}: {profile.duration:g} s is too long to be sampled every {period:g} s")
    time, speed = np.array(profile.time) - profile.time[0], np.array(profile.speed)
    near = np.unique(np.concatenate([np.floor(time / period + k) for k in (-1.0, 0.0, 1.0)])) * period
    seen = np.abs(np.interp(near[(near >= 0.0) & (near <= time[-1])], time, speed)).max(initial=0.0)
    if not seen >= (1.0 - FOLLOWS) * profile.top_speed:
        raise InputError(
            f"profile {profile.name}: its top speed lies between two samples of the controller, {period:g} s apart; "
            "expected a slower change"
        )


def _task(spec: RobotSpec, profile: Profile, train: DriveTrain) -> Task:
    """Motion and load of the driven shaft, repeated for the mission's duration."""
    left = remaining_torque(spec, profile, train.load)
    lasts = spec.mission.duration / profile.duration if spec.mission else 1.0
    return Task(
        time=profile.time,
        speed=tuple((np.array(profile.speed) / train.radius).tolist()),
        load_time=tuple(left[:, 0].tolist()),
        load_torque=tuple(left[:, 1].tolist()),
        cycles=max(1, math.ceil(lasts - _WHOLE)),
    )


# --- the machine


def _drive(
    spec: RobotSpec,
    drive_set: DriveParts,
    train: DriveTrain,
    own: Gains | Cascade,
    heat: MotorHeat | None,
    feed: Feed,
) -> Drive:
    """The drive as the engine takes it; an unknown limit is none there, and unknown in its check."""
    controller, known, stage = drive_set.controller, not math.isnan(feed.usable), feed.stage

    def limit(value: float) -> float:
        return math.inf if math.isnan(value) else float(value)

    figures = controller or Controller()

    return Drive(
        train=train,
        controller=own,
        supply=Supply(
            voltage=spec.supply.lowest, resistance=spec.supply.resistance or 0.0, sets=spec.load.motors,
            max_duty=float(stage.max_duty) if known else 1.0, voltage_drop=float(stage.drop) if known else 0.0,
            loss=float(stage.loss), stage_resistance=float(stage.resistance), standby=float(stage.standby),
            leads=float(feed.leads),
        ),
        current=CurrentLimit(
            peak=limit(figures["peak_current"]),
            continuous=limit(controller_current(figures, spec.environment.ambient)),
            peak_time=limit(figures["peak_time"]),
        ),
        encoder=Resolution(edges=edges_of(spec, drive_set), periods=max(own.counted_over, 1)),
        heat=heat,
        drain_time=_DRAIN if spec.control.at_rest == "drain" else math.inf,
    )  # fmt: skip


def _from_gearhead(spec: RobotSpec, drive_set: DriveParts) -> float:
    """Loss of the gearhead that heats the housing, per speed of the motor, by the mean of the load cycle [W*s/rad]."""
    if not (spec.mounting and spec.mounting.gear_loss_share):
        return 0.0
    cycle = at_gearhead(load_cycle(spec), drive_set.belt_efficiency, math.inf).behind(drive_set.belt_ratio)
    return float(loss_at_flange(spec, cycle, one_row(drive_set.gearhead))[0]) / drive_set.gearhead.ratio


def motor_heat(spec: RobotSpec, drive_set: DriveParts) -> tuple[MotorHeat | None, list[str]]:
    """Winding and housing of a motor with their losses."""
    figures = drive_set.motor
    bodies: TwoBodies = two_bodies(figures)
    if not (bodies.known and spec.plant.warming):
        return None, []
    coulomb, viscous = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    coulomb += _from_gearhead(spec, drive_set)
    losses = {"loss_torque": coulomb, "loss_viscous": viscous}
    known = {name: loss for name, loss in losses.items() if not math.isnan(loss)}
    said = (
        ["the motor's losses other than copper loss are unknown and left out of its heating"] if known != losses else []
    )
    of_torque, of_speed = (known.get(name, 0.0) for name in losses)
    found = MotorHeat(bodies=bodies, ambient=spec.environment.ambient, loss_torque=of_torque, loss_viscous=of_speed)
    return found, said
