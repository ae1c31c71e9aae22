r"""A machine as one file for a simulator or a robot's software: a list of axes, a described robot, or a platform.

The axes of a machine are joints of their own, each with its share of the load; the joints of a robot's description, and
the wheels of a platform, have bodies whose masses are described, and drives at their joints.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.files.sheets import path_from_spec
from drivesizer.joints.inverse_dynamics import Array, Attached, JointMotion
from drivesizer.joints.mass_columns import coupling, drive_places, payload_place, radius_of
from drivesizer.joints.trajectory import fixed_positions, motion_of
from drivesizer.loads.stage_losses import FixedGear
from drivesizer.machine.budgets import riding_mass, riding_unknown
from drivesizer.output.export import common
from drivesizer.output.export.common import PROGRAM, Export, TorqueLaw, brief, identifier, sentences, torque_law
from drivesizer.output.export.joint_drive import JointDrive
from drivesizer.output.export.platform import PlatformExport, platform_export
from drivesizer.output.json.documents import as_text, plain
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.spec.description import Joint, Robot, about, read_description, rotation
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import DrivePlace, RobotSection


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotExport:
    """A robot description with drives."""

    robot: Robot
    section: RobotSection
    drives: tuple[JointDrive, ...]  # in the order of the description
    fixed_joints: Mapping[str, float]  # rad or m, joints that do not move
    payload: Attached | None
    payload_mass: float  # kg
    base: Array  # turn of the base against the world, shape (3, 3)
    motion: JointMotion

    def drive(self, joint: str) -> JointDrive | None:
        """The drive of a joint; None where it has none."""
        return next((drive for drive in self.drives if drive.joint == joint), None)

    def resistance(self, joint: Joint) -> tuple[float, float]:
        """Damping and friction that a joint has by itself: of a driven one those of the description if of bearings."""
        stays = self.section.friction == "keep" or self.drive(joint.name) is None
        return (joint.damping, joint.friction) if stays else (0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineExport:
    """All axes of a machine; of one alone, whose names have nothing before them, by an empty name."""

    name: str
    gravity: float  # m/s^2
    axes: tuple[tuple[str, Export], ...] = ()  # that are joints of their own, by name
    robot: RobotExport | None = None
    platform: PlatformExport | None = None
    notes: tuple[str, ...] = ()  # how the drives were chosen

    @property
    def exports(self) -> tuple[tuple[str, Export], ...]:
        """The drives of all axes, by name."""
        robot = tuple((drive.joint, drive.of) for drive in self.robot.drives) if self.robot else ()
        platform = (("", self.platform.of),) if self.platform else ()
        return (*robot, *platform, *self.axes)

    @property
    def shafts(self) -> tuple[tuple[str, JointDrive], ...]:
        """The axes with their drives, whose names begin with that of the axis where there are several."""
        named = [(name, f"{identifier(name)}_" if name else "", of) for name, of in self.axes]
        return tuple((name, JointDrive(joint=f"{b}shaft", motor=f"{b}motor", of=of)) for name, b, of in named)

    @property
    def drives(self) -> tuple[JointDrive, ...]:
        """The drives of all joints."""
        own = (*(self.robot.drives if self.robot else ()), *(self.platform.drives.values() if self.platform else ()))
        return (*own, *(drive for _, drive in self.shafts))

    @property
    def alone(self) -> Export | None:
        """The drive of an axis alone."""
        return self.axes[0][1] if self.axes and not self.axes[0][0] else None

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Assumptions on all drives, each once with the axes that it is of."""
        if self.platform:
            return self.platform.assumptions
        axes: dict[str, list[str]] = {}
        for name, of in self.exports:
            for line in of.assumptions:
                axes.setdefault(line, []).append(name)
        return tuple(f"{', '.join(names)}: {line}".removeprefix(": ") for line, names in axes.items())


def one_axis(of: Export) -> MachineExport:
    """A machine of one axis alone."""
    return MachineExport(name=of.name, gravity=of.gravity, axes=(("", of),))


def platform_alone(of: PlatformExport) -> MachineExport:
    """A machine that is a platform with all its wheels."""
    return MachineExport(name=of.name, gravity=of.ground.gravity, platform=of)


def drive_export(spec: RobotSpec, drive: DriveSet, *, wheel: int | None = None, bodies: bool = True) -> MachineExport:
    """The record of a drive alone; of a platform that with all its wheels, where there are bodies and none is named."""
    if wheel is None and spec.platform is not None and bodies:
        return platform_alone(platform_export(spec, drive))
    return one_axis(common.export_of(spec, drive, wheel))


def machine_export(sizing: MachineSizing, *, one_rate: bool = False, bodies: bool = True) -> MachineExport:
    """The record of a machine that a sizing found.

    With controllers of one rate, the slowest of their own; joints of a robot among its bodies, or as axes.
    """
    machine = sizing.machine
    lacking = next((axis.name for axis in sizing.axes if axis.best is None), None)
    if lacking is not None:
        whose = "" if sizing.alone else f"{lacking}: "
        raise InputError(f"{whose}no drive meets all limits; nothing to export")
    if sizing.alone and (best := sizing.axes[0].best):
        return drive_export(sizing.axes[0].spec, best, bodies=bodies)

    def exported(rate: float | None) -> dict[str, Export]:
        def at_rate(spec: RobotSpec) -> RobotSpec:
            return spec.model_copy(update={"control": spec.control.model_copy(update={"rate": rate})})

        exports = {}
        for axis in sizing.axes:
            assert axis.best is not None
            spec = axis.spec if rate is None else axis.spec.changed(at_rate)
            exports[axis.name] = replace(common.export_of(spec, axis.best), name=axis.name)
        return exports

    exports = exported(None)
    periods = {of.period for of in exports.values() if of.controller}
    if one_rate and len(periods) > 1:
        exports = exported(1.0 / max(periods))
    joints = {axis.name for axis in machine.axes if axis.is_joint and bodies}
    wheels = (
        f"{axis.name}: the shaft of one wheel; exported as an axis of its own it is the base with all of them"
        for axis in sizing.axes
        if axis.spec.platform is not None
    )
    return MachineExport(
        name=machine.name,
        gravity=machine.environment.gravity,
        robot=_robot(sizing, {name: of for name, of in exports.items() if name in joints}) if joints else None,
        axes=tuple((name, of) for name, of in exports.items() if name not in joints),
        notes=(*sizing.notes, *wheels),
    )


def _robot(sizing: MachineSizing, exports: Mapping[str, Export]) -> RobotExport:
    """The description, with the drives of its joints."""
    section, file = sizing.machine.robot, sizing.machine.file
    assert section is not None
    robot = read_description(path_from_spec(file, section.description, ("robot", "description")))
    joints = tuple(name for name in robot.joints if name in exports)
    fixed = fixed_positions(section, robot, joints)
    places = drive_places(section, robot, joints)
    turned = coupling(section, robot, fixed, joints)
    drives = []
    for name, row in zip(joints, turned.tolist(), strict=True):
        axis, own = sizing.axis(name), section.drives.get(name, DrivePlace())
        assert axis.best is not None
        of = exports[name]
        stages, chain = _stages(axis), robot.chain(robot.joints[name].parent)
        root = chain[-1].parent if chain else robot.joints[name].parent  # where a drive on the base is
        place, mass = places.get(name) or Attached(root, np.zeros(3)), riding_mass(axis.result.problem, axis.best)
        of_link = robot.links[place.link].mass if section.masses == "with_drives" else 0.0
        drives.append(JointDrive(
            joint=name,
            motor=f"{name}_motor",
            of=replace(of, assumptions=tuple(x for x in of.assumptions if x not in common.behind_gear(axis.spec))),
            travel=radius_of(robot.joints[name], own.travel_per_turn) / stages.ratio,
            turns_by={other: share for other, share in zip(joints, row, strict=True) if share},
            mass=mass,
            beyond=max(mass - of_link, 0.0),
            lacking=riding_unknown(axis.result.problem, axis.best),
            place=place,
            stage_inertia=stages.efficiency * stages.pinion_inertia + stages.wheel_inertia / stages.ratio**2,
            stage_friction=stages.efficiency * stages.pinion_friction + stages.wheel_friction / stages.ratio,
            gear_efficiency=stages.efficiency,
            back_efficiency=stages.back_efficiency,
            slides=not robot.joints[name].turns,
        ))  # fmt: skip
    mounting = section.mounting
    return RobotExport(
        robot=robot,
        section=section,
        drives=tuple(drives),
        fixed_joints=fixed,
        payload=payload_place(section, robot, joints),
        payload_mass=section.payload.mass if section.payload else 0.0,
        base=rotation(np.array([mounting.roll, mounting.pitch, mounting.yaw])),
        motion=motion_of(section, robot, file),
    )


def _stages(axis: AxisSizing) -> FixedGear:
    """The stages between driven shaft and joint, a belt among them, as one gear; of ratio 1 where there is none."""
    gear, belt = axis.spec.gear, axis.spec.belt
    inertia, friction = (belt.inertia, belt.friction_torque) if belt else (0.0, 0.0)
    if gear is None:
        return FixedGear(1.0, 1.0, 1.0, inertia, 0.0, friction)
    before = belt is not None and axis.spec.gear_before_belt
    fixed = gear.fixed_gear((belt.ratio or 1.0) if belt and before else 1.0)
    if fixed.back_efficiency <= 0.0:
        raise InputError(
            f"{axis.name}: its {gear.kind} locks itself, and simulators have no gear that only one side turns; "
            "expected --axis, which exports the shaft before it"
        )
    if before:
        wheel = fixed.wheel_inertia + inertia, fixed.wheel_friction + friction
        return fixed._replace(wheel_inertia=wheel[0], wheel_friction=wheel[1])
    pinion = fixed.pinion_inertia + inertia, fixed.pinion_friction + friction
    return fixed._replace(pinion_inertia=pinion[0], pinion_friction=pinion[1])


def head(of: MachineExport) -> list[str]:
    """Remarks at the head of the file of an axis, of several, or of a robot, as sentences."""
    if of.alone:
        return common.remarks(of.alone)
    lines, robot = [f"{PROGRAM}. SI: kg, m, s, N, N*m, rad."], of.robot
    if robot:
        driven = [robot.robot.joints[drive.joint] for drive in robot.drives]
        lines += sentences(
            "robot",
            slides=any(drive.slides for drive in robot.drives),
            bearings=robot.section.friction == "keep" and any(joint.damping or joint.friction for joint in driven),
            within=robot.section.masses == "with_drives",
            held=", ".join(f"{name} {brief(value)}" for name, value in robot.fixed_joints.items()),
        )
        lines += robot.robot.notes
    if of.axes:
        lines += sentences("axes", robot=bool(robot), names=", ".join(name for name, _ in of.axes))
    return [*lines, *(f"Assumed: {line}." for line in (*of.notes, *of.assumptions))]


def in_urdf(robot: RobotExport) -> RobotExport:
    """The robot with frames as URDF has them, points of drives and payload in these.

    URDF has each child's frame on the axis of its joint, which is there at 0. MJCF has axes beside the child's origin,
    at the anchor a of the child's frame, and joints whose frames are those of a reference position q0. So the child's
    frame moves to the anchor, and is turned back by q0: p' = p + R a, R' = R R(z, -q0) (turning), p' = p - R z q0
    (sliding).
    """
    above = robot.robot.above
    anchors = {name: above[name].anchor if name in above else np.zeros(3) for name in robot.robot.links}
    joints = {}
    for name, joint in robot.robot.joints.items():
        place, turn = joint.place + joint.turn @ joint.anchor - anchors[joint.parent], joint.turn
        if joint.kind == "prismatic":
            place = place - turn @ joint.axis * joint.reference
        elif joint.turns:
            turn = turn @ about(joint.axis, -joint.reference)
        joints[name] = replace(joint, place=place, turn=turn, anchor=np.zeros(3), reference=0.0)

    def shifted(point: Attached) -> Attached:
        return Attached(point.link, point.at - anchors[point.link])

    links = {name: replace(link, centre=link.centre - anchors[name]) for name, link in robot.robot.links.items()}
    return replace(
        robot,
        robot=replace(robot.robot, links=links, joints=joints),
        drives=tuple(replace(drive, place=shifted(drive.place)) for drive in robot.drives),
        payload=robot.payload and shifted(robot.payload),
    )


# The record of a machine as JSON: its drives, and what each has at the driven shaft; SI, null is unknown.


class AtShaft(NamedTuple):
    """A drive seen at its driven shaft with gears that drive, and its controller as one law."""

    inertia: float  # kg*m^2, of the load, and rotor with gearhead input reflected
    reflected_inertia: float  # kg*m^2, of rotor with gearhead input
    friction: float  # N*m, dry friction of load and motor
    damping: float  # N*m*s/rad, viscous friction of the motor
    weight: float  # N*m, of the load, at the start of the motion
    torque_law: TorqueLaw | None  # at the motor; null: none is designed, for its inertia is unknown, or it is a stepper


def render_json(of: MachineExport) -> bytes:
    """The file of a machine: the drives of all its axes."""
    record = {"name": of.name, "axes": [document(export) for _, export in of.exports]}
    return (as_text(record) + "\n").encode("utf-8", "backslashreplace")


def document(of: Export) -> dict[str, Any]:
    """The figures of a drive as plain data."""
    law = torque_law(of) if of.controller else None
    shaft = AtShaft(of.inertia, of.reflected_inertia, of.friction, of.damping, of.weight, law)
    return plain(of) | plain(shaft)


def export_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer export --format json``."""
    from drivesizer.output.json.schema import Definitions, array_of, document_schema, properties

    defs: Definitions = {}
    drive = properties(Export, defs) | properties(AtShaft, defs)
    of = {"name": {"type": "string"}, "axes": array_of("Drive", drive, defs)}
    return document_schema("drivesizer export", of, defs)


def free_name(name: str, names: Collection[str]) -> str:
    """A name that is not taken, with underscores behind it where it is.

    >>> free_name("payload", {"payload"})
    'payload_'
    """
    while name in names:
        name += "_"
    return name
