"""A set put together for the march: its controller designed, its machine, its heat, and what it is asked for.

Gains are those of ``control_design`` or ``cascade_design``. What is taken for granted on the way is kept with the
result.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np

from drivesizer.cascade import Cascade, rates
from drivesizer.cascade_design import Wanted, design_cascade
from drivesizer.catalog import EDGES, Controller
from drivesizer.choose import usable_in
from drivesizer.control_design import design
from drivesizer.engine import CurrentLimit, Drive, Encoder, Heat, Supply, Task
from drivesizer.errors import InputError
from drivesizer.linear_modes import Machine, machine_of
from drivesizer.loop_plant import Shaft
from drivesizer.physics_limits import housing_loss
from drivesizer.plant import DriveTrain, drive_train, within_reach
from drivesizer.profile import Profile
from drivesizer.results import DriveSet, Gains
from drivesizer.shaft_load import at_shaft, remaining_torque
from drivesizer.spec import RobotSpec
from drivesizer.thermal import TwoBodies, two_bodies
from drivesizer.units import show

__all__ = ["FOLLOWS", "Ready", "designed", "ready"]

FOLLOWS = 0.1  # of the top speed: a drive whose error grows beyond a tenth is not said to follow (our convention)
_PERIOD = 1e-3  # s, of a velocity loop on the voltage, where the controller's is unknown
_WHOLE = 1e-9  # share of a cycle that is none


class Ready(NamedTuple):
    """What a march takes, and what that was made of."""

    train: DriveTrain
    controller: Gains | Cascade
    shaft: Shaft | None
    usable_voltage: float  # V, NaN unknown
    drive: Drive
    task: Task
    said: tuple[str, ...]  # what was assumed on the way


def ready(spec: RobotSpec, drive_set: DriveSet, asked: Profile, controller: Gains | Cascade | None = None) -> Ready:
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
    shaft = _shaft(spec, train)
    usable = usable_in(spec, drive_set.controller)
    heat, lacks = _heat(spec, drive_set)
    drive = _drive(spec, drive_set, _machine(spec, drive_set, train, shaft), controller, heat, usable)
    return Ready(train, controller, shaft, usable, drive, _task(spec, asked, train), (*said, *lacks))


# --- the controller


def designed(spec: RobotSpec, drive_set: DriveSet) -> tuple[DriveTrain, Gains | Cascade, list[str]]:
    """The machine of a set, the controller that is designed for it, and what was assumed of both.

    Raises
    ------
    InputError
        When the catalogue lacks a figure without which nothing moves, or ``control`` asks for what cannot be.
    """
    if spec.control.structure == "voltage_pid":
        period, said = _period(drive_set.controller)
        train, assumed = drive_train(spec, drive_set, period)
        return train, design(spec, train, period), [*said, *assumed]
    every, said = rates(drive_set.controller)
    train, assumed = drive_train(spec, drive_set, every.current)
    cascade, rules = design_cascade(train, every, _wanted(spec), where=lambda field: spec.where(_path(field)))
    return train, cascade, [*said, *assumed, *rules]


def _period(controller: Controller | None) -> tuple[float, list[str]]:
    """The period of a controller's velocity loop [s]."""
    rate = controller.speed_loop if controller else math.nan
    if rate > 0.0:
        return 1.0 / rate, []
    return _PERIOD, [f"the controller's rate is unknown: it runs every {show(_PERIOD, 'ms', 'time')}"]


def _wanted(spec: RobotSpec) -> Wanted:
    """What the spec gives of the cascade."""
    c = spec.control
    given: dict[str, Any] = {f"current_{name}": getattr(c.current, name) for name in ("kp", "ki")}
    given |= {f"velocity_{name}": getattr(c.velocity, name) for name in ("kp", "ki", "kd")}
    given |= {name: getattr(c.velocity, name) for name in ("filter_time", "bandwidth", "damping", "phase_margin")}
    given |= {f"feedforward_{name}": value for name, value in c.feedforward.model_dump().items()}
    return Wanted(position=c.position is not None, position_kp=c.position.kp if c.position else None, **given)


def _path(field: str) -> tuple[str, ...]:
    """Where a field of ``Wanted`` stands in the spec."""
    section, _, name = field.partition("_")
    if section in ("current", "velocity", "position", "feedforward"):
        return "control", section, name
    return "control", "velocity", field


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


def _shaft(spec: RobotSpec, train: DriveTrain) -> Shaft | None:
    """What is elastic between motor and load, as the spec says; none of a rigid model."""
    if spec.plant.model == "rigid":
        return None
    where, stiffness = spec.where(("plant", "model")), spec.plant.stiffness or (spec.belt and spec.belt.stiffness)
    if not stiffness:
        raise InputError(f"{where}: two_mass needs plant.stiffness or the belt's, e.g. stiffness: 500 N*m/rad")
    if not train.load_inertia > 0.0:
        raise InputError(f"{where}: two_mass needs an inertia of the load, e.g. inertia: 0.02 kg*m^2")
    damping = 2.0 * spec.plant.damping_ratio * math.sqrt(stiffness * train.load_inertia)
    return Shaft(stiffness=stiffness, damping=damping)


def _machine(spec: RobotSpec, drive_set: DriveSet, train: DriveTrain, shaft: Shaft | None) -> Machine:
    machine = machine_of(train)
    if shaft is None:
        return machine
    own = drive_set.gearhead.backlash / drive_set.belt_ratio
    gap = spec.plant.backlash if spec.plant.backlash is not None else own
    return replace(
        machine, stiffness=shaft.stiffness, damping=shaft.damping, gap=0.0 if math.isnan(gap) else float(gap)
    )


def _drive(
    spec: RobotSpec, drive_set: DriveSet, machine: Machine, own: Gains | Cascade, heat: Heat | None, usable: float
) -> Drive:
    """The set as the engine takes it; an unknown limit is none there, and unknown in its check."""
    controller, known = drive_set.controller, not math.isnan(usable)

    def limit(name: str) -> float:
        value = getattr(controller, name) if controller else math.nan
        return math.inf if math.isnan(value) else float(value)

    counted = spec.control.speed_from == "counts" and drive_set.encoder is not None
    lines = drive_set.encoder.lines if counted and drive_set.encoder else math.nan
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
        encoder=Encoder(edges=0 if math.isnan(lines) else round(EDGES * lines)),
        heat=heat,
    )  # fmt: skip


def _heat(spec: RobotSpec, drive_set: DriveSet) -> tuple[Heat | None, list[str]]:
    """Winding and housing, which friction and iron warm, and what is left out; None where a figure is unknown."""
    figures = asdict(drive_set.motor)
    bodies: TwoBodies = two_bodies(figures)
    if not (bodies.known and spec.plant.warming):
        return None, []
    coulomb, viscous = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    losses = {"loss_torque": coulomb, "loss_viscous": viscous}
    known = {name: loss for name, loss in losses.items() if not math.isnan(loss)}
    said = ["what the motor loses beside its copper is unknown, and warms nothing"] if known != losses else []
    return Heat(bodies=bodies, ambient=spec.environment.ambient, **known), said
