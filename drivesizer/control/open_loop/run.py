"""A stepper of a drive prepared and simulated along a profile, with what it needs of its pull-out torque."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import require
from drivesizer.control.open_loop.simulation import (
    DAMPING_RATIO,
    Motion,
    Stepper,
    Turned,
    least_share,
    simulate,
)
from drivesizer.errors import InputError, NoLoopError
from drivesizer.load_cases.at_shaft import AtShaft, at_shaft, remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["OpenLoop", "Prepared", "PullOut", "prepared", "run"]

Array = NDArray[np.float64]
PullOut = Callable[[Array], Array]  # torque at speeds of the motor

_POINTS = 513  # of the pull-out torque over the speed
_FASTEST = 1e9  # rad/s at the motor
_STARTS = 40.0  # periods of the natural frequency that a start without a ramp is watched
_CALM = 16  # microsteps with which swings are small
_SETTLES = 10.0  # the same, at rest after the motion
_NEEDED = {"motor": ("rotor_inertia", "pole_pairs", "holding_torque"), "gearhead": ("ratio", "efficiency")}


class OpenLoop(NamedTuple):
    """A stepper that was simulated, with its inputs."""

    spec: RobotSpec
    drive_set: DriveParts
    profile: Profile
    stepper: Stepper
    radius: float  # m, travel of the load per angle of the driven shaft; 1 where it turns with it
    microsteps: float  # per full step
    out: Turned
    share: float  # of the pull-out torque that keeps step along the motion
    start: float  # the same of a start without a ramp, to needs.start_speed; NaN where there is none
    finer: int  # microsteps with which no step is lost, where some are; 0 where these do not help
    assumptions: tuple[str, ...]

    @property
    def per_travel(self) -> float:
        """Travel of the load per angle of the motor [m/rad, or 1]."""
        return self.radius / self.stepper.ratio


class Prepared(NamedTuple):
    """Input of a simulation."""

    stepper: Stepper
    microsteps: float  # per full step
    assumptions: tuple[str, ...]


def run(spec: RobotSpec, drive_set: DriveParts, profile: Profile, pull_out: PullOut) -> OpenLoop:
    """Simulate a stepper along a profile, at rest for a while after one that ends at rest."""
    ready = prepared(spec, drive_set, profile, pull_out)
    stepper, shaft = ready.stepper, at_shaft(spec)
    motion = _motion(spec, profile, shaft, _SETTLES / stepper.natural_frequency)
    out = simulate(stepper, motion)
    finer = 0
    driver = math.nan if drive_set.controller is None else drive_set.controller.microsteps
    if out.lost and ready.microsteps < _CALM and not driver < _CALM:
        calm = replace(stepper, microstep=stepper.microstep * ready.microsteps / _CALM)
        finer = 0 if simulate(calm, motion).lost else _CALM
    return OpenLoop(spec, drive_set, profile, stepper, shaft.radius, ready.microsteps, out,
                    least_share(stepper, motion), _start(spec, stepper, motion), finer, ready.assumptions)  # fmt: skip


def prepared(spec: RobotSpec, drive_set: DriveParts, profile: Profile, pull_out: PullOut) -> Prepared:
    """A stepper as its simulation takes it."""
    said: list[str] = []
    shaft = at_shaft(spec)
    top = max(profile.top_speed / shaft.radius * drive_set.total_ratio, spec.needs.start_speed or 0.0)
    if not top <= _FASTEST:
        raise InputError(f"profile {profile.name}: {top:.3g} rad/s is no speed that a motor can be turned to")
    microsteps = _microsteps(spec, drive_set, said)
    stepper = _stepper(spec, drive_set, shaft, microsteps, said)
    stepper = replace(stepper, torque=_torques(drive_set, pull_out, top), top_speed=top)
    return Prepared(stepper, microsteps, tuple(said))


def _microsteps(spec: RobotSpec, drive_set: DriveParts, said: list[str]) -> float:
    """Microsteps of a full step: as the spec has them, else the driver's finest, else full steps."""
    driver, given = drive_set.controller, spec.control.microsteps
    finest = driver.microsteps if driver else math.nan
    if given is not None and given > finest:
        name = driver.part if driver else ""
        raise InputError(f"control.microsteps: {given} is more than {finest:g}, the most of controller {name}")
    if given is not None:
        return float(given)
    if finest >= 1.0:
        said.append(f"the driver runs its finest microsteps, {finest:g} to a full step; control.microsteps sets others")
        return finest
    said.append("the driver's microsteps are unknown: full steps, which shake the rotor most; see control.microsteps")
    return 1.0


def _stepper(
    spec: RobotSpec, drive_set: DriveParts, shaft: AtShaft, microsteps: float, said: list[str]
) -> Stepper:  # fmt: skip
    """The drive as its simulation takes it, still without its torque."""
    require(drive_set, _NEEDED, "not simulated without")
    motor, own, damping = drive_set.motor, drive_set.at_motor, spec.control.damping_ratio
    unknown = drive_set.unknown_inertias + ["load"] * math.isnan(shaft.inertia)
    said += [f"the inertia of the {name} is unknown and taken as 0" for name in unknown]
    return Stepper(
        teeth=motor.pole_pairs,
        torque=np.ones(2),
        top_speed=0.0,
        microstep=2.0 * math.pi / (4.0 * motor.pole_pairs * microsteps),
        damping_ratio=DAMPING_RATIO if damping is None else damping,
        motor_inertia=drive_set.inertia(unknown=0.0),
        load_inertia=0.0 if math.isnan(shaft.inertia) else shaft.inertia,
        ratio=drive_set.total_ratio,
        efficiency=own.efficiency * drive_set.belt_efficiency,
        friction=own.idle,
        forward_torque=shaft.forward_torque,
        backward_torque=shaft.backward_torque,
        rest_torque=shaft.rest_torque,
    )


def _torques(drive_set: DriveParts, pull_out: PullOut, top: float) -> Array:
    """Pull-out torque at even steps of the speed."""
    speed = np.linspace(0.0, top or 1.0, _POINTS)
    found = pull_out(speed)
    lacks = np.flatnonzero(np.isnan(found))
    if len(lacks):
        known = show(float(speed[lacks[0] - 1]), "rpm", "rotary_speed", 3)
        above = f" above {known}" if lacks[0] else ": no curve, and a figure of its model is unknown"
        raise NoLoopError(f"motor {drive_set.motor.part}: its pull-out torque is unknown{above}; not simulated without")
    if not found[0] > 0.0:
        raise NoLoopError(f"motor {drive_set.motor.part}: it has no pull-out torque at rest")
    return found


def _motion(spec: RobotSpec, profile: Profile, shaft: AtShaft, settles: float) -> Motion:
    """Motion and load of the driven shaft, and the rest after it."""
    left = remaining_torque(spec, profile, shaft)
    time, speed = list(profile.time), [v / shaft.radius for v in profile.speed]
    when, torque = left[:, 0].tolist(), left[:, 1].tolist()
    if speed[-1] == 0.0:
        end = time[-1] + settles
        time, speed = [*time, end], [*speed, 0.0]
        when, torque = ([*when, end], [*torque, torque[-1]]) if when else (when, torque)
    return Motion(time=time, speed=speed, load_time=when, load_torque=torque)


def _start(spec: RobotSpec, stepper: Stepper, motion: Motion) -> float:
    """Share of the pull-out torque of a start without a ramp, in the heavier direction at its largest load."""
    speed = spec.needs.start_speed
    if speed is None:
        return math.nan
    undamped = replace(stepper, damping_ratio=0.0)  # the safe side: damping helps a start
    lasts = _STARTS / stepper.natural_frequency
    high, low = max(motion.load_torque, default=0.0), min(motion.load_torque, default=0.0)
    forward = stepper.forward_torque + high >= -stepper.backward_torque - low
    speeds = ((speed if forward else -speed) / stepper.ratio,) * 2
    loads = (high if forward else low,) * 2
    start = Motion(time=(0.0, lasts), speed=speeds, load_time=(0.0, lasts), load_torque=loads)
    return least_share(undamped, start, at_rest=True)
