r"""A platform as every format needs it: base, wheels with their drives, what it reaches, its motion.

All wheels have one drive, and its controller: that of the wheel with the largest RMS torque. Motors that have failed
belong to a load case; the file has all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import fsum, inf, isfinite, isnan, nan
from typing import NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array, Attached
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.platform import dynamics_of, ground_of, platform_assumptions, trajectory_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.budgets import drive_rows
from drivesizer.output.export.common import LEAST_INERTIA, PROGRAM, Export, brief, export_of, sentences, speed_at, whose
from drivesizer.output.export.joint_drive import JointDrive
from drivesizer.platform.dynamics import Ground, contact_loads, motion, own_rolling
from drivesizer.platform.envelope import Size
from drivesizer.platform.kinematics import Kinematics, Platform
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.description import Body
from drivesizer.spec.platform import Limits
from drivesizer.spec.robot import RobotSpec

BASE = "base_link"
_NOTHING = 1e-9  # of what is largest: rounding
_LIGHT, _HEAVY = 1e-3, 0.5  # of the mass that a wheel carries: bounds of its own


def wheel_name(place: int) -> str:
    """Name of a wheel's joint, by its place from 0: the numbers are those of every other output."""
    return f"wheel_{place + 1}"


class Reach(NamedTuple):
    """Largest figures of a platform's motion, in one direction at a time; NaN where there is none."""

    forwards: float  # m/s
    sideways: float  # m/s; NaN where its wheels do not allow it
    turning: float  # rad/s
    acceleration: float  # m/s^2
    jerk: float  # m/s^3
    turning_acceleration: float  # rad/s^2
    turning_jerk: float  # rad/s^3


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
    assumptions: tuple[str, ...]

    @property
    def radius(self) -> float:
        """Of the wheels [m]."""
        return self.platform.wheels[0].radius

    @property
    def head(self) -> list[str]:
        """Remarks on the whole file, as sentences."""
        drive, names = next(iter(self.drives.values())), ", ".join(drive.joint for drive in self.drives.values())
        lines = sentences("platform", of=self, whole=self.platform, program=PROGRAM)
        return [
            *lines,
            f"{names}, each: {' '.join(drive.remarks)}",
            *(f"Assumed: {line}." for line in self.assumptions),
        ]

    def of_wheel(self, place: int) -> str:
        """Remark on the joint of a wheel: what resists."""
        no_drive = "" if place in self.drives else "It has no drive. "
        rolling = brief(self.rolling[place])
        return f"{no_drive}Friction has the {rolling} N*m that it takes to roll under its load at rest."

    @property
    def rollers(self) -> list[str]:
        """Remark on the rollers' resistance, which no file has."""
        C = max(wheel.roller_resistance for wheel in self.platform.wheels)
        left = f"Left out: the resistance of the rollers on their pins, {brief(C)} of a wheel's load where they turn."
        return [left] if C else []


def platform_export(spec: RobotSpec, drive: DriveSet) -> PlatformExport:
    """The record of a platform with the drive that a sizing found."""
    if spec.budget is not None and spec.budget.drive_counts:  # of the mass that it was sized for
        mass = fsum(row.ends[1] for row in drive.masses if not isnan(row.each))
        spec = spec.model_copy(update={"load": spec.load.model_copy(update={"mass": mass})})
    section, load, belt = spec.platform, spec.load, spec.belt
    if section is None or not isinstance(load, WheeledVehicle):
        raise InputError(f"{spec.where(())}: no section platform; expected one, e.g. platform: {{layout: ...}}")
    if any(place.kind == "skid" for place in section.places):
        where = spec.where(("platform",))
        raise InputError(
            f"{where}: skid wheels are not exported; expected `drivesizer export --format json` of the drive"
        )
    (_, case, wheel_spec), *_ = load_cases(spec)
    of = export_of(spec, drive)
    unbroken = spec.alone(platform=section.model_copy(update={"failed": []}))
    d = dynamics_of(unbroken)
    platform = d.platform if section.height_known else replace(d.platform, height=0.0)
    size = section.size.record if section.size else None
    base, wheel = split(platform, size)
    rolling = own_rolling(d, contact_loads(platform, ground=Ground(gravity=spec.environment.gravity)))
    rolling[rolling < _NOTHING * rolling.max()] = 0.0
    time, eta, eta_dot = _motion(unbroken, of)
    left = whose(case, wheel_spec)
    controller = [] if of.stepper or not left else [f"all drives have the controller that is designed for {case}"]
    rows = drive_rows(drive, 1, belt=belt.mass if belt else None, encoder=spec.wants_encoder)
    own = [row for row in rows if row.name != "controller"]
    drives = {}
    for place in d.kinematics.driven:
        name, at = wheel_name(place), platform.wheels[place]
        drives[place] = JointDrive(
            joint=name,
            motor=f"{name}_motor",
            of=of,
            mass=fsum(row.each for row in own if not isnan(row.each)),  # part of the base
            lacking=tuple(row.name for row in own if isnan(row.each)),
            place=Attached(BASE, np.array([at.x, at.y, at.radius])),
            stage_inertia=belt.inertia if belt else 0.0,
            stage_friction=belt.friction_torque if belt else 0.0,
        )
    return PlatformExport(
        name=spec.name,
        of=of,
        drives=drives,
        platform=platform,
        kinematics=d.kinematics,
        base=base,
        wheel=wheel,
        rolling=tuple(rolling.tolist()),
        size=size,
        friction=load.friction_coefficient,
        ground=ground_of(spec),
        reach=_reached(d.kinematics, of, float(rolling.max()), section.limits, eta_dot),
        time=time,
        eta=eta,
        assumptions=(
            *(line for line in of.assumptions if line not in left),
            *controller,
            *(line.rstrip(".") for line in platform_assumptions(section, load)),
        ),
    )


def split(platform: Platform, size: Size | None) -> tuple[Body, Body]:
    r"""Base and one wheel of a platform.

    The spec has the mass of all together, the inertia about the vertical through its centre, and of a wheel the inertia
    J about its axle. A simulator wants bodies. A wheel gets the mass of a homogeneous disc of its inertia, and J about
    every axis; the base what is left, so that mass, centre and inertia of all together are those of the spec:

    .. math:: m_w = \frac{2J}{r^2}, \quad m_b = m - N m_w, \quad c_b = \frac{m c - m_w \sum p_k}{m_b}, \quad
        I_b = I - \sum_k (J + m_w |p_k - c|^2) - m_b |c_b - c|^2

    p_k are the wheels' contact points. Of rolling and pitching the spec has nothing: the base is as slender as its box,
    :math:`I_x : I_y : I_z = w^2 + h^2 : l^2 + h^2 : l^2 + w^2`, or flat where that is unknown.
    """
    r, share = platform.wheels[0].radius, platform.mass / len(platform.wheels)
    J = max(platform.wheels[0].inertia, LEAST_INERTIA)
    places = np.array([(w.x, w.y, w.radius) for w in platform.wheels])
    middle = np.array([platform.x, platform.y, platform.height])
    slender = 0.5, 0.5, 1.0  # inertia about x, y and z over that about z
    if size is not None:
        length, width, height = size.length**2, size.width**2, size.height**2
        slender = (width + height) / (length + width), (length + height) / (length + width), 1.0

    def levers(points: Array) -> float:
        return float(((points - middle)[..., :2] ** 2).sum())

    for wheel in (min(max(2.0 * J / r**2, _LIGHT * share), _HEAVY * share), _LIGHT * share):
        # a lighter one where little of the inertia is known
        mass = platform.mass - len(places) * wheel
        centre = (platform.mass * middle - wheel * places.sum(axis=0)) / mass
        about = platform.inertia - len(places) * J - wheel * levers(places) - mass * levers(centre)
        if about > 0.0:
            centre[np.abs(centre) < _NOTHING * r] = 0.0
            return Body(mass, centre, about * np.diag(slender)), Body(wheel, np.zeros(3), J * np.eye(3))
    raise InputError(
        f"platform.inertia: {platform.inertia:.4g} kg*m^2 is less than its wheels alone have; expected that of all, "
        "without payloads"
    )


def _reached(k: Kinematics, of: Export, rolling: float, limits: Limits, eta_dot: Array) -> Reach:
    r"""Speeds that a platform reaches, by direction, and accelerations that it is sized for.

    A drive turns its wheel as fast as the lowest supply voltage V permits while the platform rolls at constant speed on
    a level floor, T being the torque of that:

    .. math:: K w = \frac{k_t V - R \left( M_f + \frac{T}{K e} \right)}{k_t k_e + R b}

    or as the parts permit where that is less. The platform's speed in a direction is w over the largest of the wheels'
    speeds in it; a limit that the spec sets is kept. Accelerations are the spec's limits, else the largest of its
    motion.
    """
    permitted, train = of.limits.peak_speed, of.train
    wheel = permitted.value if permitted.by else inf
    if not of.stepper:
        driven = speed_at(train, of.voltage, train.friction + rolling / (train.ratio * train.efficiency))
        wheel = min(wheel, max(driven, 0.0) / train.ratio)
    wheel = wheel if wheel < inf else nan

    def least(value: float, limit: float | None) -> float:
        return min((speed for speed in (value, limit) if speed is not None and isfinite(speed)), default=nan)

    most = np.abs(k.E[list(k.driven)]).max(axis=0)
    speed, aside, turning = (wheel / rate if rate > _NOTHING * most.max() else nan for rate in most.tolist())
    along, about = float(np.hypot(eta_dot[0], eta_dot[1]).max()), float(np.abs(eta_dot[2]).max())
    return Reach(
        forwards=least(speed, limits.speed),
        sideways=least(aside, limits.speed) if k.mobility > 2 else nan,
        turning=least(turning, limits.turning_speed),
        acceleration=limits.acceleration or along or nan,
        jerk=limits.jerk or nan,
        turning_acceleration=limits.turning_acceleration or about or nan,
        turning_jerk=limits.turning_jerk or nan,
    )


def _motion(spec: RobotSpec, of: Export) -> tuple[Array, Array, Array]:
    """The spec's motion: times, velocity in the robot's frame, and its rate of change at both ends of each piece."""
    trajectory = trajectory_of(spec)
    if trajectory is not None:
        course = motion(dynamics_of(spec), trajectory, ground_of(spec))
        time = np.concatenate([[0.0], np.cumsum(course.duration)])
        return time, np.concatenate([course.eta[:, :, 0], course.eta[:, -1:, 1]], axis=1), course.eta_dot
    time, speed = np.array(of.cycle.time), np.array(of.cycle.speed) * of.train.radius
    lasts = np.diff(time) > 0.0
    rise = np.diff(speed)[lasts] / np.diff(time)[lasts]
    ahead = np.array([[1.0], [0.0], [0.0]])
    return time - time[0], ahead * speed, ahead * rise
