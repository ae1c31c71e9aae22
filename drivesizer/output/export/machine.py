"""A machine of several axes as one file for a simulator or a robot's software: the robot whole, other axes beside."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan
from pathlib import Path
from xml.etree.ElementTree import Comment, Element

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.files.csv_columns import path_from_spec
from drivesizer.joints.inverse_dynamics import Array, Attached, JointMotion
from drivesizer.joints.mass_columns import radius_of
from drivesizer.joints.places import coupling, drive_places, fixed_positions, payload_place
from drivesizer.joints.trajectory import motion_of
from drivesizer.loads.stage_losses import FixedGear
from drivesizer.machine.budgets import riding_mass, riding_rows
from drivesizer.output.export import FORMATS, WHOLE, accept, write
from drivesizer.output.export.common import Export, behind_gear, brief, export_of, identifier, number
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.spec.description import read_description, rotation
from drivesizer.spec.description_record import Joint, Link, Robot, about
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import DrivePlace, RobotSection
from drivesizer.version import __version__

__all__ = [
    "Adding", "JointDrive", "MachineExport", "RobotExport", "accept_machine", "free_name", "head", "in_urdf",
    "machine_export", "of_drive", "write_machine",
]  # fmt: skip


# -- A sized machine as every format needs it: the robot of a description with its drives, and axes beside it.
#
# The figures of a drive at its joint, with gears that drive, K total ratio, e efficiency, r travel of the joint per
# angle of the driven shaft:
#
# .. math:: F = \frac{K e M}{r}, \quad J = \frac{K^2 e J_m + J_b}{r^2}, \quad b = \frac{K^2 e b_m}{r^2},
#           \quad F_f = \frac{K e M_f + M_b}{r}
#
# J_m, M_f, b_m inertia, dry and viscous friction of the motor; J_b, M_b inertia and friction of a belt's pulleys. As
# in ``common``, whose record a drive has. A gear of fixed ratio i between driven shaft and joint is one with the
# drive: r/i is the joint's travel per angle of the shaft, e that of both. Of what turns with its input (p) and
# output shaft (w)
#
# .. math:: J_b = e_g (J + J_p) + \frac{J_w}{i^2}, \qquad M_b = e_g (M + T_p) + \frac{T_w}{i}
#
# J and M of the belt before it; those of a belt behind it are parts of J_w and T_w.
#
# A description in the convention of URDF: each child's frame on the axis of its joint, which is there at 0.
#
# MJCF has axes beside the child's origin, at the anchor a of the child's frame, and joints whose frames are those of
# a reference position q0. The child's frame moves to the anchor, and is turned back by q0:
#
# .. math:: p' = p + R a, \quad R' = R\, R(z, -q_0) \text{ (turning)}, \qquad p' = p - R z q_0 \text{ (sliding)}
#
# Remarks at the head of a machine's file, as sentences.
#
# Files of single axes joined to one: names with the axis before them, so that none is there twice.


def in_urdf(robot: RobotExport) -> RobotExport:
    """The robot with frames as URDF has them, points of drives and payload in these."""
    above = robot.robot.above
    moved = {name: above[name].anchor if name in above else np.zeros(3) for name in robot.robot.links}
    described = replace(
        robot.robot,
        links={name: _link(link, moved[name]) for name, link in robot.robot.links.items()},
        joints={name: _joint(joint, moved[joint.parent]) for name, joint in robot.robot.joints.items()},
    )
    drives = tuple(replace(drive, place=_point(drive.place, moved[drive.place.link])) for drive in robot.drives)
    payload = robot.payload and _point(robot.payload, moved[robot.payload.link])
    return replace(robot, robot=described, drives=drives, payload=payload)


def _link(link: Link, moved: Array) -> Link:
    return replace(link, centre=link.centre - moved)


def _point(point: Attached, moved: Array) -> Attached:
    return Attached(point.link, point.at - moved)


def _joint(joint: Joint, moved: Array) -> Joint:
    """A joint whose parent's frame has moved too."""
    place, turn = joint.place + joint.turn @ joint.anchor - moved, joint.turn
    if joint.kind == "prismatic":
        place = place - turn @ joint.axis * joint.reference
    elif joint.turns:
        turn = turn @ about(joint.axis, -joint.reference)
    return replace(joint, place=place, turn=turn, anchor=np.zeros(3), reference=0.0)


def head(of: MachineExport) -> list[str]:
    """Remarks on the whole file."""
    said = [f"{of.program}. SI: kg, m, s, N, N*m, rad."]
    if of.robot:
        said += _of_robot(of.robot)
    if of.axes:
        beside = "beside the robot " if of.robot else ""
        said.append(
            f"Axes {beside}({', '.join(name for name, _ in of.axes)}): each a joint of its own at the origin, its load "
            "with all drives that ride on it; names begin with the axis."
        )
    return [*said, *(f"Assumed: {line}." for line in (*of.said, *of.notes))]


def _of_robot(robot: RobotExport) -> list[str]:
    said = [
        "Links, joints and position limits are those of the description, without its shapes; effort, velocity and "
        "friction of a joint are those of its drive, whose mass is at its place."
    ]
    if any(drive.slides for drive in robot.drives):
        said.append("Joints that slide: N, N*s/m and kg in the place of N*m, N*m*s/rad and kg*m^2.")
    if robot.section.friction == "keep" and any(_bearings(robot, drive) for drive in robot.drives):
        said.append("The friction in the description is that of bearings, and is added to that of the drives.")
    if robot.held:
        places = ", ".join(f"{name} {brief(value)}" for name, value in robot.held.items())
        said.append(f"Joints without a drive, as they are held [rad or m]: {places}.")
    return [*said, *robot.robot.notes]


def _bearings(robot: RobotExport, drive: JointDrive) -> bool:
    joint = robot.robot.joints[drive.joint]
    return bool(joint.damping or joint.friction)


def of_drive(drive: JointDrive) -> list[str]:
    """Remarks on the drive of a joint."""
    limits, e = drive.of.limits, drive.efficiency
    lacking = f", without {', '.join(drive.lacking)}, of unknown mass" if drive.lacking else ""
    rotor = brief(drive.armature) if drive.armature == drive.armature else "UNKNOWN"
    lasting = limits.continuous_torque.value * drive.gear_efficiency / drive.travel
    effort, velocity = (one.by or "nothing known" for one in (limits.peak_torque, limits.peak_speed))
    said = [
        f"{drive.of.label}: {brief(drive.mass)} kg{lacking}; total ratio {brief(drive.ratio)}; effort by "
        f"{effort}, continuous {brief(lasting)}; velocity by {velocity}; "
        f"armature {rotor}, rotor and gearhead input by ratio squared, gears driving at an efficiency of {brief(e)}."
    ]
    if drive.back_efficiency != drive.gear_efficiency:
        back = drive.of.train.efficiency * drive.back_efficiency
        said.append(f"Where the load drives the motor, the gears have an efficiency f of {brief(back)}.")
    if drive.coupled:
        others = ", ".join(
            f"{'' if share > 0 else '-'}{name}" for name, share in drive.turns_by.items() if name != drive.joint
        )
        said.append(f"Its belt passes other joints: the drive turns by the sum of this joint and {others}.")
    return said


_NAMES = ("name", "joint", "link", "actuator", "site", "tendon")  # attributes that name something


def free_name(wanted: str, taken: Collection[str]) -> str:
    """A name that is not taken, with underscores behind it where it is.

    Examples
    --------
    >>> free_name("payload", {"payload"})
    'payload_'
    """
    while wanted in taken:
        wanted += "_"
    return wanted


class Adding:
    """A document to which those of single axes are added."""

    def __init__(self, root: Element, tags: Collection[str]) -> None:
        self.tags = tags
        self.taken = set(self._names(root))

    def _names(self, root: Element) -> list[tuple[str, str]]:
        return [
            (str(one.tag), one.attrib["name"]) for one in root.iter() if one.tag in self.tags and "name" in one.attrib
        ]

    def add(self, axis: str, tree: Element, target: Element, *, kept: str = "", instead: str = "") -> None:
        """Add what is in the document of one axis."""
        before = identifier(axis)
        for element in tree.iter():
            for attribute in _NAMES:
                name = element.attrib.get(attribute)
                if name is not None:
                    element.attrib[attribute] = instead if name == kept else f"{before}_{name}"
        children = [one for one in tree if not (kept and one.attrib.get("name") == instead)]
        for key in [name for one in children for name in self._names(one)]:
            if key in self.taken:
                raise InputError(f"axis {quoted(axis)}: a {key[0]} {quoted(key[1])} is there already; rename the axis")
            self.taken.add(key)
        target.append(Comment(f" Axis {before}. "))
        target.extend(children)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointDrive:
    """The drive of a joint of a description."""

    joint: str
    of: Export
    travel: float  # of the joint per angle of the driven shaft [1, or m/rad]
    turns_by: Mapping[str, float]  # joints by whose angles the drive turns: its own 1, and those that its belt passes
    mass: float  # kg, of what is known of it, without its controller
    lacking: tuple[str, ...]  # parts of unknown mass
    place: Attached  # of the mass
    stage_inertia: float  # kg*m^2 at the driven shaft, of a belt and a further gear that drives
    stage_friction: float  # N*m
    gear_efficiency: float = 1.0  # of a further gear, driving
    back_efficiency: float = 1.0  # of it where the load drives
    slides: bool = False  # the joint

    @property
    def coupled(self) -> bool:
        """Whether its belt passes other joints."""
        return len(self.turns_by) > 1

    @property
    def ratio(self) -> float:
        """Motor angle per turn of the joint [1], or per travel [rad/m]."""
        return self.of.train.ratio / self.travel

    @property
    def efficiency(self) -> float:
        """Efficiency of all gears between motor and joint, driving."""
        return self.of.train.efficiency * self.gear_efficiency

    @property
    def armature(self) -> float:
        """Inertia of the drive at the joint [kg*m^2, or kg]; NaN where that of the rotor is unknown."""
        return (self.of.reflected_inertia * self.gear_efficiency + self.stage_inertia) / self.travel**2

    @property
    def damping(self) -> float:
        """Viscous friction of the drive at the joint [N*m*s/rad, or N*s/m]."""
        return self.of.damping * self.gear_efficiency / self.travel**2

    @property
    def friction(self) -> float:
        """Dry friction of the drive at the joint [N*m, or N]."""
        train = self.of.train
        return (train.friction * train.ratio * self.efficiency + self.stage_friction) / self.travel

    @property
    def limits(self) -> dict[str, str]:
        """Effort and velocity of the joint as text; what is unknown is left out."""
        peak, fastest = self.of.limits.peak_torque, self.of.limits.peak_speed
        named = {
            "effort": (peak, peak.value * self.gear_efficiency / self.travel),
            "velocity": (fastest, fastest.value * self.travel),
        }
        return {name: number(value) for name, (limit, value) in named.items() if limit.by}


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotExport:
    """A robot description with drives."""

    robot: Robot
    section: RobotSection
    drives: tuple[JointDrive, ...]  # in the order of the description
    held: Mapping[str, float]  # rad or m, joints that do not move
    payload: Attached | None
    payload_mass: float  # kg
    base: Array  # turn of the base against the world, shape (3, 3)
    motion: JointMotion

    @property
    def keeps_friction(self) -> bool:
        """Whether the friction in the description is that of bearings, and stays."""
        return self.section.friction == "keep"

    @property
    def coupled(self) -> JointDrive | None:
        """The first drive whose belt passes other joints."""
        return next((drive for drive in self.drives if drive.coupled), None)

    def drive(self, joint: str) -> JointDrive | None:
        """The drive of a joint; None where it has none."""
        return next((drive for drive in self.drives if drive.joint == joint), None)


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineExport:
    """All axes of a machine."""

    name: str
    program: str
    robot: RobotExport | None
    axes: tuple[tuple[str, Export], ...]  # beside the robot, by name
    gravity: float  # m/s^2
    said: tuple[str, ...]  # how the drives were chosen

    @property
    def exports(self) -> tuple[Export, ...]:
        """The drives of all axes."""
        robot = tuple(drive.of for drive in self.robot.drives) if self.robot else ()
        return (*robot, *(of for _, of in self.axes))

    @property
    def notes(self) -> tuple[str, ...]:
        """Assumptions on all drives, each once with the axes that it is of."""
        found: dict[str, list[str]] = {}
        named = [(drive.joint, drive.of) for drive in self.robot.drives] if self.robot else []
        for name, of in (*named, *self.axes):
            for line in of.said:
                found.setdefault(line, []).append(name)
        return tuple(f"{', '.join(names)}: {line}" for line, names in found.items())


def machine_export(sizing: MachineSizing, *, one_rate: bool = False) -> MachineExport:
    """The record of a machine that a sizing found."""
    machine = sizing.machine
    exports = {axis.name: _exported(axis, None) for axis in sizing.axes}
    periods = {of.period for of in exports.values() if of.controller}
    if one_rate and len(periods) > 1:
        rate = 1.0 / max(periods)
        exports = {axis.name: _exported(axis, rate) for axis in sizing.axes}
    joints = {axis.name for axis in machine.axes if axis.is_joint}
    return MachineExport(
        name=machine.name,
        program=f"drivesizer {__version__}",
        robot=_robot(sizing, {name: of for name, of in exports.items() if name in joints}) if machine.robot else None,
        axes=tuple((name, of) for name, of in exports.items() if name not in joints),
        gravity=machine.environment.gravity,
        said=(*sizing.notes, *_platforms(sizing.axes)),
    )


def _platforms(axes: Sequence[AxisSizing]) -> list[str]:
    """Axes of which a file of their own has more: platforms, here one shaft."""
    names = [axis.name for axis in axes if axis.spec.platform is not None]
    return [
        f"{name}: the shaft of one wheel; exported as an axis of its own it is the base with all of them"
        for name in names
    ]


def _exported(axis: AxisSizing, rate: float | None) -> Export:
    """The drive of an axis, its controller at its own rate or a given one [Hz]."""
    assert axis.best is not None

    def at_rate(spec: RobotSpec) -> RobotSpec:
        return spec.model_copy(update={"control": spec.control.model_copy(update={"rate": rate})})

    return replace(export_of(axis.spec if rate is None else axis.spec.changed(at_rate), axis.best), name=axis.name)


def _robot(sizing: MachineSizing, exports: Mapping[str, Export]) -> RobotExport:
    """The description, with the drives of its joints."""
    machine = sizing.machine
    section = machine.robot
    assert section is not None
    robot = read_description(path_from_spec(machine.file, section.description, "robot.description"))
    joints = tuple(name for name in robot.joints if name in exports)
    held = fixed_positions(section, robot, joints)
    places = drive_places(section, robot, joints)
    turned = coupling(section, robot, held, joints)
    mounting = section.mounting
    return RobotExport(
        robot=robot,
        section=section,
        drives=tuple(
            _drive(sizing.axis(name), exports[name], (robot, section), places, dict(zip(joints, row, strict=True)))
            for name, row in zip(joints, turned.tolist(), strict=True)
        ),
        held=held,
        payload=payload_place(section, robot, joints),
        payload_mass=section.payload.mass if section.payload else 0.0,
        base=rotation(np.array([mounting.roll, mounting.pitch, mounting.yaw])),
        motion=motion_of(section, robot, machine.file),
    )


def _drive(
    axis: AxisSizing, of: Export, described: tuple[Robot, RobotSection], places: Mapping[str, Attached],
    turned: Mapping[str, float],
) -> JointDrive:  # fmt: skip
    """The drive of one joint."""
    robot, section = described
    assert axis.best is not None
    of = replace(of, said=tuple(line for line in of.said if line not in behind_gear(axis.spec)))
    place, stages = section.drives.get(axis.name, DrivePlace()), _stages(axis)
    return JointDrive(
        joint=axis.name,
        of=of,
        travel=radius_of(robot.joints[axis.name], place.travel_per_turn) / stages.ratio,
        turns_by={name: share for name, share in turned.items() if share},
        mass=riding_mass(axis.result.problem, axis.best),
        lacking=tuple(row.name for row in riding_rows(axis.result.problem, axis.best) if isnan(row.each)),
        place=places.get(axis.name) or Attached(_root(robot, axis.name), np.zeros(3)),
        stage_inertia=stages.efficiency * stages.pinion_inertia + stages.wheel_inertia / stages.ratio**2,
        stage_friction=stages.efficiency * stages.pinion_friction + stages.wheel_friction / stages.ratio,
        gear_efficiency=stages.efficiency,
        back_efficiency=stages.back_efficiency,
        slides=not robot.joints[axis.name].turns,
    )


def _stages(axis: AxisSizing) -> FixedGear:
    """The stages between driven shaft and joint, a belt among them, as one gear; of ratio 1 where there is none."""
    gear, belt = axis.spec.gear, axis.spec.belt
    inertia, friction = (belt.inertia, belt.friction_torque) if belt else (0.0, 0.0)
    if gear is None:
        return FixedGear(1.0, 1.0, 1.0, inertia, 0.0, friction)
    before = belt is not None and axis.spec.gear_before_belt
    found = gear.fixed_gear((belt.ratio or 1.0) if belt and before else 1.0)
    if found.back_efficiency <= 0.0:
        raise InputError(
            f"{axis.name}: its {gear.kind} locks itself, and simulators have no gear that only one side turns; "
            "expected --axis, which exports the shaft before it"
        )
    if before:
        wheel = found.wheel_inertia + inertia, found.wheel_friction + friction
        return found._replace(wheel_inertia=wheel[0], wheel_friction=wheel[1])
    pinion = found.pinion_inertia + inertia, found.pinion_friction + friction
    return found._replace(pinion_inertia=pinion[0], pinion_friction=pinion[1])


def _root(robot: Robot, joint: str) -> str:
    """Link that a joint's chain begins with: where a drive on the base is."""
    parent = robot.joints[joint].parent
    chain = robot.chain(parent)
    return chain[-1].parent if chain else parent


def accept_machine(form: str, path: Path) -> None:
    """Refuse a format without several joints, or an impossible target, before time is spent."""
    if form in FORMATS and form not in WHOLE:
        raise InputError(f"--format: {form} is of a single axis; expected --axis beside it, or {', '.join(WHOLE)}")
    accept(form, path)


def write_machine(of: MachineExport, form: str, path: Path) -> list[Path]:
    """Write a machine to a file of a format, whole or not at all."""
    accept_machine(form, path)
    return write(of, form, path, "machine")
