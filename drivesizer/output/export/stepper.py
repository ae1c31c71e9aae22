"""A stepper as exports have it: its model in open loop, and its limits at the driven shaft."""

from __future__ import annotations

from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.open_loop.run import prepared
from drivesizer.control.open_loop.simulation import Stepper
from drivesizer.load_cases.at_shaft import at_shaft, motion_of
from drivesizer.machine.pull_out import torque_of_drive
from drivesizer.output.export.limits import Limits, behind_gearhead, least
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec

__all__ = ["OpenLoopStepper", "limits_of", "stepper_of"]


class OpenLoopStepper(NamedTuple):
    """A stepper with its driver, as the simulation of ``validate`` has it."""

    model: Stepper
    microsteps: float  # per full step
    speed: NDArray[np.float64]  # rad/s at the motor, of the points of its torque

    @property
    def stiffness(self) -> float:
        """Torque per angle about a held position, at the driven shaft with gears that drive [N*m/rad]."""
        one = self.model
        return float(one.teeth * one.torque[0] * one.ratio**2 * one.efficiency)

    @property
    def damping(self) -> float:
        """Torque per speed of small swings about the field, at the driven shaft [N*m*s/rad]."""
        one = self.model
        at_motor = 2.0 * one.damping_ratio * float(np.sqrt(one.teeth * one.torque[0] * one.inertia))
        return at_motor * one.ratio**2 * one.efficiency


def stepper_of(spec: RobotSpec, found: DriveSet) -> tuple[OpenLoopStepper, DriveTrain, list[str]]:
    """The stepper of a drive, its drive train without electrical figures, and assumptions.

    Parameters
    ----------
    spec, found
        The machine and the drive.

    Returns
    -------
    tuple
        As said.

    Raises
    ------
    NoLoopError
        When a figure is unknown without which nothing moves.
    """
    lowest = spec.supply.lowest
    ready = prepared(spec, found, motion_of(spec), lambda speed: torque_of_drive(found, speed, lowest))
    one, shaft, gearhead = ready.stepper, at_shaft(spec), found.gearhead
    train = DriveTrain(
        resistance=nan, inductance=nan, torque_constant=nan, back_emf_constant=nan, friction=one.friction,
        motor_inertia=one.motor_inertia, gear_ratio=gearhead.ratio,
        gear_efficiency=one.efficiency / found.belt_efficiency, belt_ratio=found.belt_ratio,
        belt_efficiency=found.belt_efficiency, load_inertia=one.load_inertia, radius=shaft.radius,
        forward_torque=one.forward_torque, backward_torque=one.backward_torque, rest_torque=one.rest_torque,
    )  # fmt: skip
    speed = np.linspace(0.0, one.top_speed, len(one.torque))
    return OpenLoopStepper(one, ready.microsteps, speed), train, list(ready.assumptions)


def limits_of(found: DriveSet, one: OpenLoopStepper, train: DriveTrain) -> Limits:
    """Limits at the driven shaft: the pull-out torque at rest, and the speed up to which it was looked up.

    Parameters
    ----------
    found, one, train
        The drive and what ``stepper_of`` makes of it.

    Returns
    -------
    Limits
        SI; what flows at any time is continuous too.
    """
    pull_out = {"stepper, pull-out torque at rest": float(one.model.torque[0] * train.ratio * train.efficiency)}
    peak, lasting = (pull_out | more for more in behind_gearhead(found, train))
    fastest = {"stepper, highest speed of the motion": one.model.top_speed / train.ratio}
    return Limits(*(least(named) for named in (peak, lasting, fastest, fastest)))
