"""A sized platform as every format needs it: base, wheels with their drives, what it reaches, its motion.

All wheels have one drive, and its controller: that of the wheel with the largest RMS torque. Motors that have failed
belong to a load case; the file has all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import fsum, isnan

import numpy as np

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Attached
from drivesizer.joints.record import Array
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.platform_record import platform_assumptions
from drivesizer.load_cases.platform_wheels import dynamics_of, ground_of, trajectory_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.mass_budget import drive_rows
from drivesizer.output.export.common import Export, export_of, whose
from drivesizer.output.export.machine.record import JointDrive
from drivesizer.output.export.platform.bodies import split
from drivesizer.output.export.platform.reach import Reach, reached, wheel_speed
from drivesizer.platform.contact_loads import Ground, contact_loads
from drivesizer.platform.dynamics import own_rolling
from drivesizer.platform.envelope import Size
from drivesizer.platform.kinematics import Kinematics
from drivesizer.platform.motion import motion
from drivesizer.platform.wheels import Platform
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.description.solids import Body
from drivesizer.spec.robot import RobotSpec

__all__ = ["BASE", "PlatformExport", "platform_export", "wheel_name"]

BASE = "base_link"
_NOTHING = 1e-9  # of the largest: rounding


def wheel_name(place: int) -> str:
    """Name of a wheel's joint, by its place from 0: the numbers are those of every other output."""
    return f"wheel_{place + 1}"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlatformExport:
    """A platform with its drives, SI; places in the robot's frame, whose origin is on the floor."""

    name: str
    of: Export  # the drive of a wheel
    drives: Mapping[int, JointDrive]  # by place of the wheel, from 0
    platform: Platform  # all together
    kinematics: Kinematics
    base: Body
    wheel: Body  # each of them
    rolling: tuple[float, ...]  # N*m, torque of each wheel to roll on a level floor
    size: Size | None
    friction: float | None  # coefficient between wheel and floor; None unknown
    ground: Ground
    reach: Reach
    time: Array  # s, of its motion, shape (points,)
    eta: Array  # m/s, m/s, rad/s: velocity at these, shape (3, points)
    said: tuple[str, ...]  # assumptions

    @property
    def radius(self) -> float:
        """Of the wheels [m]."""
        return self.platform.wheels[0].radius


def platform_export(spec: RobotSpec, found: DriveSet) -> PlatformExport:
    """The record of a platform with the drive that a sizing found.

    Parameters
    ----------
    spec
        With a platform.
    found
        The drive.

    Returns
    -------
    PlatformExport
        SI.

    Raises
    ------
    InputError
        When a figure is unknown that every format needs, or the spec has no platform.
    """
    spec = _laden(spec, found)
    section, load = spec.platform, spec.load
    if section is None or not isinstance(load, WheeledVehicle):
        raise InputError(f"{spec.where(())}: no section platform; expected one, e.g. platform: {{layout: ...}}")
    (_, case, wheel_spec), *_ = load_cases(spec)
    of = export_of(spec, found)
    unbroken = spec.alone(platform=section.model_copy(update={"failed": []}))
    d = dynamics_of(unbroken)
    platform = d.platform if section.height_known else replace(d.platform, height=0.0)
    size = section.size.record if section.size else None
    base, wheel = split(platform, size)
    rolling = own_rolling(d, contact_loads(platform, ground=Ground(gravity=spec.environment.gravity)))
    rolling[rolling < _NOTHING * rolling.max()] = 0.0
    time, eta, eta_dot = _motion(unbroken, of)
    fastest = wheel_speed(of, float(rolling.max()))
    left = whose(case, wheel_spec)
    controller = [] if of.stepper or not left else [f"all drives have the controller that is designed for {case}"]
    return PlatformExport(
        name=spec.name,
        of=of,
        drives={place: _drive(spec, found, of, platform, place) for place in d.kinematics.driven},
        platform=platform,
        kinematics=d.kinematics,
        base=base,
        wheel=wheel,
        rolling=tuple(rolling.tolist()),
        size=size,
        friction=load.friction_coefficient,
        ground=ground_of(spec),
        reach=reached(d.kinematics, fastest, section.limits, eta_dot),
        time=time,
        eta=eta,
        said=(
            *(line for line in of.said if line not in left),
            *controller,
            *(line.rstrip(".") for line in platform_assumptions(section, load)),
        ),
    )


def _laden(spec: RobotSpec, found: DriveSet) -> RobotSpec:
    """The spec with the mass that it was sized for, where the drive's own counts."""
    if spec.budget is None or not spec.budget.drive_counts:
        return spec
    mass = fsum(row.ends[1] for row in found.masses if not isnan(row.each))
    return spec.model_copy(update={"load": spec.load.model_copy(update={"mass": mass})})


def _drive(spec: RobotSpec, found: DriveSet, of: Export, platform: Platform, place: int) -> JointDrive:
    """The drive of a wheel; its mass is part of the base."""
    name, at, belt = wheel_name(place), platform.wheels[place], spec.belt
    rows = drive_rows(found, 1, belt=belt.mass if belt else None, encoder=spec.wants_encoder)
    own = [row for row in rows if row.name != "controller"]
    return JointDrive(
        joint=name,
        of=of,
        travel=1.0,
        turns_by={name: 1.0},
        mass=fsum(row.each for row in own if not isnan(row.each)),
        lacking=tuple(row.name for row in own if isnan(row.each)),
        place=Attached(BASE, np.array([at.x, at.y, at.radius])),
        stage_inertia=belt.inertia if belt else 0.0,
        stage_friction=belt.friction_torque if belt else 0.0,
    )


def _motion(spec: RobotSpec, of: Export) -> tuple[Array, Array, Array]:
    """The spec's motion: times, velocity in the robot's frame, and its rate of change at both ends of each piece."""
    d, trajectory = dynamics_of(spec), trajectory_of(spec)
    if trajectory is not None:
        found = motion(d, trajectory, ground_of(spec))
        time = np.concatenate([[0.0], np.cumsum(found.duration)])
        return time, np.concatenate([found.eta[:, :, 0], found.eta[:, -1:, 1]], axis=1), found.eta_dot
    time, speed = np.array(of.cycle.time), np.array(of.cycle.speed) * of.train.radius
    lasts = np.diff(time) > 0.0
    rise = np.diff(speed)[lasts] / np.diff(time)[lasts]
    ahead = np.array([[1.0], [0.0], [0.0]])
    return time - time[0], ahead * speed, ahead * rise
