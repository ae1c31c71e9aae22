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

from collections.abc import Iterable
from dataclasses import replace
from math import asin, atan2, hypot, isnan, pi
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array
from drivesizer.output.export import common
from drivesizer.output.export.common import brief, identifier, number, remark, vector
from drivesizer.output.export.machine import MachineExport, RobotExport, free_name, head, in_urdf
from drivesizer.output.export.platform import BASE as PLATFORM_BASE
from drivesizer.output.export.platform import PlatformExport, wheel_name
from drivesizer.spec.description import Body, together

FOOTPRINT = "base_footprint"
BASE = "base"
_TINY = 1e-14  # of a rotation: no angle
_WIDTH = 0.5  # of a wheel, over its radius: assumed, to be seen
_CASTER = 0.25  # radius of a caster over that of the wheels: assumed
_SDF = "1.7"  # the first with parent="world"; read by every Gazebo since


def render(of: MachineExport) -> bytes:
    """The file of a machine, with transmissions as ROS 1 and MoveIt read them; ros2_control has its own."""
    root = robot_of(of)
    for drive in of.drives:
        added = SubElement(root, "transmission", name=f"{drive.joint}_transmission")
        SubElement(added, "type").text = "transmission_interface/SimpleTransmission"
        interface = "Position" if drive.of.stepper else "Effort"
        of_joint = SubElement(added, "joint", name=drive.joint)
        SubElement(of_joint, "hardwareInterface").text = f"hardware_interface/{interface}JointInterface"
        of_motor = SubElement(added, "actuator", name=drive.motor)
        SubElement(of_motor, "mechanicalReduction").text = number(drive.ratio)
    return common.document(root)


def robot_of(of: MachineExport, direction: float = 1.0) -> Element:
    """Links and joints; of a platform wheels that turn forwards or the other way round."""
    root, base = Element("robot", name=identifier(of.name)), BASE
    if of.platform:
        _platform(root, of.platform, direction)
        return root
    remark(root, *(common.remarks(of.alone) if of.alone else head(of)))
    if of.robot:
        described = in_urdf(of.robot)
        _robot(root, described)
        base = next(name for name in described.robot.links if name not in described.robot.above)
    else:
        SubElement(root, "link", name=BASE)
    for name, drive in of.shafts:
        one, before = drive.of, drive.joint.removesuffix("shaft")
        if name:
            remark(root, f"Axis {identifier(name)}.", *common.remarks(one))
        moved = common.link_of(one, reflected=True)
        link = SubElement(root, "link", name=f"{before}load")
        remark(link, moved.said)
        inertial = SubElement(link, "inertial")
        if any(moved.centre):
            SubElement(inertial, "origin", xyz=vector(moved.centre), rpy="0 0 0")
        SubElement(inertial, "mass", value=number(moved.mass))
        SubElement(inertial, "inertia", _moments(moved.inertia * np.eye(3)))
        joint = SubElement(root, "joint", name=drive.joint, type="continuous")
        _between(joint, base, f"{before}load")
        SubElement(joint, "axis", xyz=vector(moved.axis))
        SubElement(joint, "limit", _required(one.label, drive.limits))
        SubElement(joint, "dynamics", damping=number(one.damping), friction=number(one.friction))
        common.refuse_doubles(root, ("link", "joint"), name)
    return root


def _between(joint: Element, parent: str, child: str) -> None:
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=child)


def _fixed(root: Element, name: str, parent: str, child: str, at: Iterable[float]) -> None:
    joint = SubElement(root, "joint", name=name, type="fixed")
    _between(joint, parent, child)
    SubElement(joint, "origin", xyz=vector(at), rpy="0 0 0")


def _required(label: str, known: dict[str, str]) -> dict[str, str]:
    """Effort and velocity, which URDF requires."""
    for name, of_what in (("effort", "torque"), ("velocity", "speed")):
        if name not in known:
            raise InputError(f"--format: no limit of {of_what} of {label} is known, and URDF needs one")
    return known


def _moments(J: Array) -> dict[str, str]:
    rows = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    return {name: number(J[row, column] + 0.0) for name, row, column in rows}


def _inertial(element: Element, body: Body) -> None:
    """Mass, centre and inertia; none of a link without any."""
    if not body.mass and not body.inertia.any():
        return
    inertial = SubElement(element, "inertial")
    SubElement(inertial, "origin", xyz=vector(body.centre), rpy="0 0 0")
    SubElement(inertial, "mass", value=number(body.mass))
    least = common.LEAST_INERTIA * np.eye(3)
    SubElement(inertial, "inertia", _moments(body.inertia if body.inertia.any() else least))


def _robot(root: Element, robot: RobotExport) -> None:
    """Links of the description with the drives on them, its joints with the figures of their drives, the payload."""
    for link in robot.robot.links.values():
        element = SubElement(root, "link", name=link.name)
        on_it = [drive for drive in robot.drives if drive.place.link == link.name]
        for one in on_it:
            where = vector(one.place.at)
            remark(element, f"Drive of {one.joint}, {brief(one.mass)} kg at {where}, is in it as a point mass.")
        if link.lacking:
            remark(element, f"In the description it {link.lacking}.")
        own = Body(link.mass, link.centre, link.inertia)
        points = [Body(one.mass, one.place.at, np.zeros((3, 3))) for one in on_it]
        _inertial(element, together([own, *points]) if points else own)
    for joint in robot.robot.joints.values():
        drive = robot.drive(joint.name)
        element = SubElement(root, "joint", name=joint.name, type=joint.kind)
        if drive:
            remark(element, *drive.remarks)
        _between(element, joint.parent, joint.child)
        SubElement(element, "origin", xyz=vector(joint.place), rpy=vector(roll_pitch_yaw(joint.turn)))
        if not joint.moves:
            continue
        SubElement(element, "axis", xyz=vector(joint.axis))
        described = {"lower": joint.lower, "upper": joint.upper}
        if drive is None:
            described |= {"effort": joint.effort, "velocity": joint.velocity}
        limit = {name: number(value) for name, value in described.items() if not isnan(value)}
        limit |= _required(drive.of.label, drive.limits) if drive else {}
        if limit:
            SubElement(element, "limit", limit)
        damping, friction = (joint.damping, joint.friction) if drive is None or robot.keeps_friction else (0.0, 0.0)
        if drive:
            damping, friction = damping + drive.damping, friction + drive.friction
        if damping or friction:
            SubElement(element, "dynamics", damping=number(damping), friction=number(friction))
        if joint.mimic:
            follows = {"joint": joint.mimic, "multiplier": number(joint.factor), "offset": number(joint.offset)}
            SubElement(element, "mimic", follows)
    if robot.payload:
        remark(root, "The payload: leave out this joint and its link for the robot without it.")
        name = free_name("payload", robot.robot.links)
        element = SubElement(root, "link", name=name)
        _inertial(element, Body(robot.payload_mass, np.zeros(3), np.zeros((3, 3))))
        mount = free_name("payload_mount", robot.robot.joints)
        _fixed(root, mount, robot.payload.link, name, robot.payload.at)


def roll_pitch_yaw(turn: Array) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y and z, one after the other, of a rotation matrix.

    >>> roll_pitch_yaw(np.eye(3))
    (0.0, 0.0, 0.0)
    """
    (xx, xy, _), (yx, yy, _), (zx, zy, zz) = turn.tolist()
    level = hypot(xx, yx)
    if level < _TINY:
        return 0.0, asin(max(-1.0, min(1.0, -zx))), atan2(-xy, yy)
    return atan2(zy, zz), atan2(-zx, level), atan2(yx, xx)


def _platform(root: Element, of: PlatformExport, direction: float) -> None:
    """Base above its footprint, wheels with their joints, casters as balls that slide."""
    rollers = any(wheel.roller_angle or not wheel.held for wheel in of.platform.wheels)
    angles = ", ".join(number(wheel.roller_angle) for wheel in of.platform.wheels)
    said = common.sentences("URDF: platform", rollers=rollers, angles=angles)
    remark(root, *of.head, *said, *of.rollers)
    SubElement(root, "link", name=FOOTPRINT)
    link, size = SubElement(root, "link", name=PLATFORM_BASE), of.size
    _inertial(link, of.base._replace(centre=of.base.centre - np.array([0.0, 0.0, of.radius])))
    if size:
        visual = SubElement(link, "visual")
        SubElement(visual, "origin", xyz=vector((size.x, size.y, size.height / 2.0 - of.radius)), rpy="0 0 0")
        SubElement(SubElement(visual, "geometry"), "box", size=vector((size.length, size.width, size.height)))
    _fixed(root, "base_joint", FOOTPRINT, PLATFORM_BASE, (0.0, 0.0, of.radius))
    for place, at in enumerate(of.platform.wheels):
        name, drive = wheel_name(place), of.drives.get(place)
        link = SubElement(root, "link", name=f"{name}_link")
        _inertial(link, of.wheel)
        for shape in ("visual", "collision"):
            element = SubElement(link, shape)
            SubElement(element, "origin", xyz="0 0 0", rpy=vector((pi / 2.0, 0.0, 0.0)))
            round_ = {"radius": number(at.radius), "length": number(_WIDTH * at.radius)}
            SubElement(SubElement(element, "geometry"), "cylinder", round_)
        joint = SubElement(root, "joint", name=name, type="continuous")
        remark(joint, of.of_wheel(place))
        _between(joint, PLATFORM_BASE, f"{name}_link")
        SubElement(joint, "origin", xyz=vector((at.x, at.y, 0.0)), rpy=vector((0.0, 0.0, at.heading)))
        SubElement(joint, "axis", xyz=vector((0.0, direction, 0.0)))
        if drive:
            SubElement(joint, "limit", _required(drive.of.label, drive.limits))
        damping, friction = (drive.damping, drive.friction) if drive else (0.0, 0.0)
        SubElement(joint, "dynamics", damping=number(damping), friction=number(friction + of.rolling[place]))
    for n, caster in enumerate(of.platform.casters, 1):
        link = SubElement(root, "link", name=f"caster_{n}_link")
        for shape in ("visual", "collision"):
            ball = SubElement(SubElement(SubElement(link, shape), "geometry"), "sphere")
            ball.set("radius", number(_CASTER * of.radius))
        at_floor = (caster.x, caster.y, (_CASTER - 1.0) * of.radius)
        _fixed(root, f"caster_{n}", PLATFORM_BASE, f"caster_{n}_link", at_floor)


# SDFormat 1.7, for Gazebo: axes as joints of one model.


def render_sdf(of: MachineExport) -> bytes:
    """The file of the axes of a machine, joints of a robot among them as axes: Gazebo reads its links as URDF."""
    of = replace(of, robot=None, axes=of.exports)
    root = Element("sdf", version=_SDF)
    no_transmission = "SDFormat has no transmission: the reduction is in the figures alone."
    remark(root, *(common.remarks(of.alone) if of.alone else head(of)), no_transmission)
    model = SubElement(root, "model", name=identifier(of.name))
    base = SubElement(model, "link", name=BASE)
    remark(base, "The base stands on the world; its own figures do not count.")
    fixed = SubElement(model, "joint", name="stand", type="fixed")
    SubElement(fixed, "parent").text = "world"
    SubElement(fixed, "child").text = BASE
    for name, drive in of.shafts:
        one, before = drive.of, drive.joint.removesuffix("shaft")
        if name:
            remark(model, f"Axis {identifier(name)}.", *common.remarks(one))
        moved = common.link_of(one, reflected=True)
        link = SubElement(model, "link", name=f"{before}load")
        remark(link, moved.said)
        inertial = SubElement(link, "inertial")
        if any(moved.centre):
            SubElement(inertial, "pose").text = f"{vector(moved.centre)} 0 0 0"
        SubElement(inertial, "mass").text = number(moved.mass)
        inertia = SubElement(inertial, "inertia")
        for moment, value in _moments(moved.inertia * np.eye(3)).items():
            SubElement(inertia, moment).text = value
        joint = SubElement(model, "joint", name=drive.joint, type="revolute")
        SubElement(joint, "parent").text = BASE
        SubElement(joint, "child").text = f"{before}load"
        axis = SubElement(joint, "axis")
        SubElement(axis, "xyz").text = vector(moved.axis)
        limit = SubElement(axis, "limit")
        for limited, value in {"lower": "-1e16", "upper": "1e16", **drive.limits}.items():
            SubElement(limit, limited).text = value
        dynamics = SubElement(axis, "dynamics")
        springs = {"spring_reference": 0.0, "spring_stiffness": 0.0}  # required by the format
        for figure, amount in {"damping": one.damping, "friction": one.friction, **springs}.items():
            SubElement(dynamics, figure).text = number(amount)
        common.refuse_doubles(root, ("link", "joint"), name)
    return common.document(root)
