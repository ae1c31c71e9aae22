r"""URDF, and SDFormat of axes: joints with the limits, friction and inertia of their drives, and transmissions.

URDF requires both effort and velocity: an unknown one is refused. It has no armature, nor rollers: remarks have them.

A drive on a link is a point mass m at p of it; mass, centre and inertia about the common centre c of both by the
parallel-axis theorem, as ``spec.description.together``:

.. math:: J = \sum_k J_k + m_k \left( |c_k - c|^2 E - (c_k - c)(c_k - c)^T \right)

The payload is a link of its own at a fixed joint, so that it can be taken off. Of a platform ``base_footprint`` is the
reference point on the floor, without mass; ``base_link`` is above it, at the height of the axles, and has the mass of
all but the wheels. A wheel's joint turns about its axle and rolls forwards where it is positive.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from math import isnan, pi
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from scipy.spatial.transform import Rotation

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array
from drivesizer.output.export import common
from drivesizer.output.export.common import brief, identifier, number, remark, texts, vector
from drivesizer.output.export.joint_drive import JointDrive
from drivesizer.output.export.machine import MachineExport, RobotExport, free_name, head, in_urdf
from drivesizer.output.export.platform import BASE as PLATFORM_BASE
from drivesizer.output.export.platform import PlatformExport, wheel_name
from drivesizer.spec.description import Body, together

FOOTPRINT = "base_footprint"
BASE = "base"
_WIDTH = 0.5  # of a wheel, over its radius: assumed, to be seen
_CASTER = 0.25  # radius of a caster over that of the wheels: assumed
_SDF = "1.7"  # the first with parent="world"; read by every Gazebo since


def render(of: MachineExport) -> bytes:
    """The file of a machine, with transmissions as ROS 1 and MoveIt read them; ros2_control has its own."""
    root = robot_of(of)
    for drive in of.drives:
        added = SubElement(root, "transmission", name=f"{drive.joint}_transmission")
        texts(added, type="transmission_interface/SimpleTransmission")
        interface = f"hardware_interface/{'Position' if drive.of.stepper else 'Effort'}JointInterface"
        texts(SubElement(added, "joint", name=drive.joint), hardwareInterface=interface)
        texts(SubElement(added, "actuator", name=drive.motor), mechanicalReduction=number(drive.ratio))
    return common.document(root)


def robot_of(of: MachineExport, direction: float = 1.0) -> Element:
    """Links and joints; of a platform wheels that turn forwards or the other way round."""
    root, base = Element("robot", name=identifier(of.name)), BASE
    if of.platform:
        _platform(root, of.platform, direction)
        return root
    remark(root, *head(of))
    if of.robot:
        described = in_urdf(of.robot)
        _robot(root, described)
        base = next(name for name in described.robot.links if name not in described.robot.above)
    else:
        SubElement(root, "link", name=BASE)
    for drive, load, link in _shafts(root, of):
        export = drive.of
        _inertial(link, Body(load.mass, np.array(load.centre), load.inertia * np.eye(3)), shifted=any(load.centre))
        _joint(
            root, drive.joint, "continuous", base, link.attrib["name"], axis={"xyz": vector(load.axis)},
            limit=_required(export.label, drive.limits),
            dynamics={"damping": number(export.damping), "friction": number(export.friction)},
        )  # fmt: skip
    return root


def _shafts(parent: Element, of: MachineExport) -> Iterator[tuple[JointDrive, common.Link, Element]]:
    """Axes that are joints of their own, each with its load as it moves and the link for that."""
    for name, drive in of.shafts:
        if name:
            remark(parent, f"Axis {identifier(name)}.", *common.remarks(drive.of))
        load = common.link_of(drive.of, reflected=True)
        link = SubElement(parent, "link", name=f"{drive.joint.removesuffix('shaft')}load")
        remark(link, load.remark)
        yield drive, load, link
        common.refuse_doubles(parent, ("link", "joint"), name)


def _joint(
    root: Element, name: str, kind: str, parent: str, child: str, remarks: Iterable[str] = (),
    at: Iterable[float] | None = None, turn: Iterable[float] = (0.0, 0.0, 0.0), **elements: dict[str, str],
) -> None:  # fmt: skip
    """A joint between two links; its origin where it has a place, and its further elements that have attributes."""
    joint = SubElement(root, "joint", name=name, type=kind)
    remark(joint, *remarks)
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=child)
    if at is not None:
        SubElement(joint, "origin", xyz=vector(at), rpy=vector(turn))
    for tag, attributes in elements.items():
        if attributes:
            SubElement(joint, tag, attributes)


def _required(label: str, known: dict[str, str]) -> dict[str, str]:
    """Effort and velocity, which URDF requires."""
    for name, of_what in (("effort", "torque"), ("velocity", "speed")):
        if name not in known:
            raise InputError(f"--format: no limit of {of_what} of {label} is known, and URDF needs one")
    return known


def _moments(J: Array) -> dict[str, str]:
    rows = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    return {name: number(J[row, column] + 0.0) for name, row, column in rows}


def _inertial(element: Element, body: Body, *, shifted: bool = True) -> None:
    """Mass, centre and inertia; none of a link without any."""
    if not body.mass and not body.inertia.any():
        return
    inertial = SubElement(element, "inertial")
    if shifted:
        SubElement(inertial, "origin", xyz=vector(body.centre), rpy="0 0 0")
    SubElement(inertial, "mass", value=number(body.mass))
    least = common.LEAST_INERTIA * np.eye(3)
    SubElement(inertial, "inertia", _moments(body.inertia if body.inertia.any() else least))


def _robot(root: Element, robot: RobotExport) -> None:
    """Links of the description with the drives on them, its joints with the figures of their drives, the payload."""
    for link in robot.robot.links.values():
        element = SubElement(root, "link", name=link.name)
        on_it = [drive for drive in robot.drives if drive.place.link == link.name and drive.beyond]
        for rider in on_it:
            where, more = vector(rider.place.at), " more than the link" if rider.beyond < rider.mass else ""
            remark(
                element, f"Drive of {rider.joint}, {brief(rider.beyond)} kg{more} at {where}, is in it as a point mass."
            )
        if link.lacking:
            remark(element, f"In the description it {link.lacking}.")
        own = Body(link.mass, link.centre, link.inertia)
        points = [Body(drive.beyond, drive.place.at, np.zeros((3, 3))) for drive in on_it]
        _inertial(element, together([own, *points]) if points else own)
    for joint in robot.robot.joints.values():
        drive, elements = robot.drive(joint.name), dict[str, dict[str, str]]()
        if joint.moves:
            described = {"lower": joint.lower, "upper": joint.upper}
            if drive is None:
                described |= {"effort": joint.effort, "velocity": joint.velocity}
            limit = {name: number(value) for name, value in described.items() if not isnan(value)}
            limit |= _required(drive.of.label, drive.limits) if drive else {}
            damping, friction = robot.resistance(joint)
            if drive:
                damping, friction = damping + drive.damping, friction + drive.friction
            dynamics = {"damping": number(damping), "friction": number(friction)} if damping or friction else {}
            elements = {"axis": {"xyz": vector(joint.axis)}, "limit": limit, "dynamics": dynamics}
            if joint.mimic:
                elements["mimic"] = {"joint": joint.mimic, "multiplier": number(joint.factor),
                                     "offset": number(joint.offset)}  # fmt: skip
        turn = Rotation.from_matrix(joint.turn).as_euler("xyz")
        _joint(root, joint.name, joint.kind, joint.parent, joint.child, drive.remarks if drive else (), joint.place,
               turn, **elements)  # fmt: skip
    if robot.payload:
        remark(root, "The payload: leave out this joint and its link for the robot without it.")
        name = free_name("payload", robot.robot.links)
        element = SubElement(root, "link", name=name)
        _inertial(element, Body(robot.payload_mass, np.zeros(3), np.zeros((3, 3))))
        mount = free_name("payload_mount", robot.robot.joints)
        _joint(root, mount, "fixed", robot.payload.link, name, at=robot.payload.at)


def _platform(root: Element, of: PlatformExport, direction: float) -> None:
    """Base above its footprint, wheels with their joints, casters as balls that slide."""
    rollers = any(wheel.roller_angle or not wheel.held for wheel in of.platform.wheels)
    angles = ", ".join(number(wheel.roller_angle) for wheel in of.platform.wheels)
    notes = common.sentences("URDF: platform", rollers=rollers, angles=angles)
    remark(root, *of.head, *notes, *of.rollers)
    SubElement(root, "link", name=FOOTPRINT)
    link, size = SubElement(root, "link", name=PLATFORM_BASE), of.size
    _inertial(link, of.base._replace(centre=of.base.centre - np.array([0.0, 0.0, of.radius])))
    if size:
        visual = SubElement(link, "visual")
        SubElement(visual, "origin", xyz=vector((size.x, size.y, size.height / 2.0 - of.radius)), rpy="0 0 0")
        SubElement(SubElement(visual, "geometry"), "box", size=vector((size.length, size.width, size.height)))
    _joint(root, "base_joint", "fixed", FOOTPRINT, PLATFORM_BASE, at=(0.0, 0.0, of.radius))
    for place, at in enumerate(of.platform.wheels):
        name, drive = wheel_name(place), of.drives.get(place)
        link = SubElement(root, "link", name=f"{name}_link")
        _inertial(link, of.wheel)
        for shape in ("visual", "collision"):
            element = SubElement(link, shape)
            SubElement(element, "origin", xyz="0 0 0", rpy=vector((pi / 2.0, 0.0, 0.0)))
            round_ = {"radius": number(at.radius), "length": number(_WIDTH * at.radius)}
            SubElement(SubElement(element, "geometry"), "cylinder", round_)
        damping, friction = (drive.damping, drive.friction) if drive else (0.0, 0.0)
        _joint(
            root, name, "continuous", PLATFORM_BASE, f"{name}_link", [of.of_wheel(place)], (at.x, at.y, 0.0),
            (0.0, 0.0, at.heading), axis={"xyz": vector((0.0, direction, 0.0))},
            limit=_required(drive.of.label, drive.limits) if drive else {},
            dynamics={"damping": number(damping), "friction": number(friction + of.rolling[place])},
        )  # fmt: skip
    for n, caster in enumerate(of.platform.casters, 1):
        link = SubElement(root, "link", name=f"caster_{n}_link")
        for shape in ("visual", "collision"):
            ball = SubElement(SubElement(SubElement(link, shape), "geometry"), "sphere")
            ball.set("radius", number(_CASTER * of.radius))
        at_floor = (caster.x, caster.y, (_CASTER - 1.0) * of.radius)
        _joint(root, f"caster_{n}", "fixed", PLATFORM_BASE, f"caster_{n}_link", at=at_floor)


# SDFormat 1.7, for Gazebo: axes as joints of one model.


def render_sdf(of: MachineExport) -> bytes:
    """The file of the axes of a machine, joints of a robot among them as axes: Gazebo reads its links as URDF."""
    of = replace(of, robot=None, axes=of.exports)
    root = Element("sdf", version=_SDF)
    no_transmission = "SDFormat has no transmission: the reduction is in the figures alone."
    remark(root, *head(of), no_transmission)
    model = SubElement(root, "model", name=identifier(of.name))
    base = SubElement(model, "link", name=BASE)
    remark(base, "The base stands on the world; its own figures do not count.")
    texts(SubElement(model, "joint", name="stand", type="fixed"), parent="world", child=BASE)
    for drive, load, link in _shafts(model, of):
        inertial = SubElement(link, "inertial")
        if any(load.centre):
            texts(inertial, pose=f"{vector(load.centre)} 0 0 0")
        texts(inertial, mass=number(load.mass))
        texts(SubElement(inertial, "inertia"), **_moments(load.inertia * np.eye(3)))
        joint = SubElement(model, "joint", name=drive.joint, type="revolute")
        texts(joint, parent=BASE, child=link.attrib["name"])
        axis = SubElement(joint, "axis")
        texts(axis, xyz=vector(load.axis))
        texts(SubElement(axis, "limit"), lower="-1e16", upper="1e16", **drive.limits)
        springs = {"spring_reference": "0", "spring_stiffness": "0"}  # required by the format
        texts(
            SubElement(axis, "dynamics"),
            damping=number(drive.of.damping),
            friction=number(drive.of.friction),
            **springs,
        )
    return common.document(root)
