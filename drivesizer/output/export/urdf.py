"""URDF: joints with the limits, friction and inertia of drives at the load, of one axis, a machine and a platform."""

from __future__ import annotations

from math import asin, atan2, hypot, isnan, pi
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.errors import InputError
from drivesizer.joints.inverse_dynamics import Array
from drivesizer.output.export.common import (
    BASE,
    JOINT,
    LEAST_INERTIA,
    LINK,
    Export,
    brief,
    document,
    identifier,
    inertial,
    limited,
    link_of,
    number,
    remark,
    remarks,
    vector,
)
from drivesizer.output.export.machine import (
    Adding,
    JointDrive,
    MachineExport,
    RobotExport,
    free_name,
    head,
    in_urdf,
    of_drive,
)
from drivesizer.output.export.platform import (
    BASE as PLATFORM_BASE,
)
from drivesizer.output.export.platform import (
    PlatformExport,
    of_wheel,
    rollers,
    wheel_name,
)
from drivesizer.output.export.platform import (
    head as platform_head,
)
from drivesizer.spec.description_record import Body, Joint, together
from drivesizer.spec.description_record import Link as RobotLink

__all__ = ["FOOTPRINT", "render", "robot", "robot_of_machine", "robot_of_platform"]


# -- URDF: one joint with the limits, friction and inertia of the drive at the load, and its transmission.
#
# URDF requires both effort and velocity: an unknown one is refused.


def render(of: Export) -> bytes:
    """The file of a drive."""
    return document(tree(of))


def tree(of: Export) -> Element:
    """The robot with its transmission; as :func:`robot`."""
    root = robot(of)
    transmission(root, JOINT, of.train.ratio, "motor", steps=of.stepper is not None)
    return root


def robot(of: Export) -> Element:
    """Two links and the joint between them."""
    root = Element("robot", name=identifier(of.name))
    remark(root, *remarks(of))
    SubElement(root, "link", name=BASE)
    moved = link_of(of, of.known_inertia)
    inertial(SubElement(root, "link", name=LINK), moved, nested=False)
    joint = SubElement(root, "joint", name=JOINT, type="continuous")
    SubElement(joint, "parent", link=BASE)
    SubElement(joint, "child", link=LINK)
    SubElement(joint, "axis", xyz=vector(moved.axis))
    SubElement(joint, "limit", _required_limits(of))
    SubElement(joint, "dynamics", damping=number(of.damping), friction=number(of.friction))
    return root


def _required_limits(of: Export) -> dict[str, str]:
    return required_limits(of.label, limited(of))


def required_limits(label: str, known: dict[str, str]) -> dict[str, str]:
    """Effort and velocity, which URDF requires."""
    for name, of_what in (("effort", "torque"), ("velocity", "speed")):
        if name not in known:
            raise InputError(f"--format: no limit of {of_what} of {label} is known, and URDF needs one")
    return known


def transmission(root: Element, joint: str, ratio: float, actuator: str, *, steps: bool) -> None:
    """Add a transmission as ROS 1 and MoveIt read it; ros2_control has its own."""
    added = SubElement(root, "transmission", name=f"{joint}_transmission")
    SubElement(added, "type").text = "transmission_interface/SimpleTransmission"
    of_joint = SubElement(added, "joint", name=joint)
    interface = "Position" if steps else "Effort"
    SubElement(of_joint, "hardwareInterface").text = f"hardware_interface/{interface}JointInterface"
    of_motor = SubElement(added, "actuator", name=actuator)
    SubElement(of_motor, "mechanicalReduction").text = number(ratio)


# -- URDF of a machine: the description with its drives in links and joints, axes beside it as joints of their own.
#
# A drive is a point mass m at p of its link; mass, centre and inertia about the common centre c of both by the
# parallel-axis theorem, as ``spec.description.solids.together``:
#
# .. math:: J = \sum_k J_k + m_k \left( |c_k - c|^2 E - (c_k - c)(c_k - c)^T \right)
#
# The payload is a link of its own at a fixed joint, so that it can be taken off. URDF has no armature: remarks have
# it.


_TINY = 1e-14  # of a rotation: no angle


def render_machine(of: MachineExport) -> bytes:
    """The file of a machine."""
    root = robot_of_machine(of)
    for drive in of.robot.drives if of.robot else ():
        steps = drive.of.stepper is not None
        transmission(root, drive.joint, drive.ratio, f"{drive.joint}_motor", steps=steps)
    for name, one in of.axes:
        joint = f"{identifier(name)}_shaft"
        transmission(root, joint, one.train.ratio, f"{identifier(name)}_motor", steps=one.stepper is not None)
    return document(root)


def robot_of_machine(of: MachineExport) -> Element:
    """Links and joints."""
    root = Element("robot", name=identifier(of.name))
    remark(root, *head(of))
    if of.robot is None:
        SubElement(root, "link", name=BASE)
    else:
        described = in_urdf(of.robot)
        _links(root, described)
        for joint in described.robot.joints.values():
            _joint(root, joint, described)
        _payload(root, described)
    adding = Adding(root, ("link", "joint"))
    for name, one in of.axes:
        limited(one)
        adding.add(name, robot(one), root, kept=BASE, instead=_ground(of))
    return root


def _ground(of: MachineExport) -> str:
    """Link on which axes beside the robot stand: its root."""
    if of.robot is None:
        return BASE
    above = of.robot.robot.above
    return next(name for name in of.robot.robot.links if name not in above)


# --- links


def _links(root: Element, robot: RobotExport) -> None:
    for link in robot.robot.links.values():
        element = SubElement(root, "link", name=link.name)
        on_it = [drive for drive in robot.drives if drive.place.link == link.name]
        for drive in on_it:
            where = vector(drive.place.at)
            remark(element, f"Drive of {drive.joint}, {brief(drive.mass)} kg at {where}, is in it as a point mass.")
        if link.lacking:
            remark(element, f"In the description it {link.lacking}.")
        add_inertial(element, laden(link, on_it))


def laden(link: RobotLink, drives: list[JointDrive]) -> Body:
    """A link with drives on it."""
    own = Body(link.mass, link.centre, link.inertia)
    if not drives:
        return own
    return together([own, *(Body(drive.mass, drive.place.at, np.zeros((3, 3))) for drive in drives)])


def add_inertial(element: Element, body: Body) -> None:
    """Add mass, centre and inertia; none of a link without any."""
    if not body.mass and not body.inertia.any():
        return
    inertial = SubElement(element, "inertial")
    SubElement(inertial, "origin", xyz=vector(body.centre), rpy="0 0 0")
    SubElement(inertial, "mass", value=number(body.mass))
    J = body.inertia if body.inertia.any() else LEAST_INERTIA * np.eye(3)
    rows = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
    SubElement(inertial, "inertia", {name: number(J[row, column] + 0.0) for name, row, column in rows})


def _payload(root: Element, robot: RobotExport) -> None:
    """The payload as a link of its own."""
    if robot.payload is None:
        return
    link = free_name("payload", robot.robot.links)
    remark(root, "The payload: leave out this joint and its link for the robot without it.")
    element = SubElement(root, "link", name=link)
    add_inertial(element, Body(robot.payload_mass, np.zeros(3), np.zeros((3, 3))))
    joint = SubElement(root, "joint", name=free_name("payload_mount", robot.robot.joints), type="fixed")
    SubElement(joint, "parent", link=robot.payload.link)
    SubElement(joint, "child", link=link)
    SubElement(joint, "origin", xyz=vector(robot.payload.at), rpy="0 0 0")


# --- joints


def _joint(root: Element, joint: Joint, robot: RobotExport) -> None:
    """A joint as it was described, with the figures of its drive where it has one."""
    drive = robot.drive(joint.name)
    element = SubElement(root, "joint", name=joint.name, type=joint.kind)
    if drive:
        remark(element, *of_drive(drive))
    SubElement(element, "parent", link=joint.parent)
    SubElement(element, "child", link=joint.child)
    SubElement(element, "origin", xyz=vector(joint.place), rpy=vector(roll_pitch_yaw(joint.turn)))
    if not joint.moves:
        return
    SubElement(element, "axis", xyz=vector(joint.axis))
    _limit(element, joint, drive)
    damping, friction = (joint.damping, joint.friction) if drive is None or robot.keeps_friction else (0.0, 0.0)
    if drive:
        damping, friction = damping + drive.damping, friction + drive.friction
    if damping or friction:
        SubElement(element, "dynamics", damping=number(damping), friction=number(friction))
    if joint.mimic:
        follows = {"joint": joint.mimic, "multiplier": number(joint.factor), "offset": number(joint.offset)}
        SubElement(element, "mimic", follows)


def _limit(element: Element, joint: Joint, drive: JointDrive | None) -> None:
    """Position limits of the description; effort and velocity of the drive, or as described."""
    described = {"lower": joint.lower, "upper": joint.upper}
    if drive is None:
        described |= {"effort": joint.effort, "velocity": joint.velocity}
    found = {name: number(value) for name, value in described.items() if not isnan(value)}
    found |= required_limits(drive.of.label, drive.limits) if drive else {}
    if found:
        SubElement(element, "limit", found)


def roll_pitch_yaw(turn: Array) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y and z, one after the other, of a rotation matrix.

    Examples
    --------
    >>> roll_pitch_yaw(np.eye(3))
    (0.0, 0.0, 0.0)
    """
    (xx, xy, _), (yx, yy, _), (zx, zy, zz) = turn.tolist()
    level = hypot(xx, yx)
    if level < _TINY:
        return 0.0, asin(max(-1.0, min(1.0, -zx))), atan2(-xy, yy)
    return atan2(zy, zz), atan2(-zx, level), atan2(yx, xx)


# -- URDF of a platform: its base on the floor, and a continuous joint for each wheel with the figures of its drive.
#
# ``base_footprint`` is the reference point on the floor, without mass; ``base_link`` is above it, at the height of
# the axles, and has the mass of all but the wheels. A wheel's joint turns about its axle and rolls forwards where it
# is positive. URDF has neither armature nor rollers: remarks have them.


FOOTPRINT = "base_footprint"
_WIDTH = 0.5  # of a wheel, over its radius: assumed, to be seen
_CASTER = 0.25  # radius of a caster over that of the wheels: assumed


def render_platform(of: PlatformExport) -> bytes:
    """The file of a platform."""
    root = robot_of_platform(of)
    for place, drive in of.drives.items():
        motor = f"{wheel_name(place)}_motor"
        transmission(root, drive.joint, drive.ratio, motor, steps=drive.of.stepper is not None)
    return document(root)


def robot_of_platform(of: PlatformExport, direction: float = 1.0) -> Element:
    """Links and joints."""
    root = Element("robot", name=identifier(of.name))
    remark(root, *platform_head(of), *_rolling(of))
    SubElement(root, "link", name=FOOTPRINT)
    _base(root, of)
    for place in range(len(of.platform.wheels)):
        _wheel(root, of, place, direction)
    for number_, caster in enumerate(of.platform.casters, 1):
        _caster(root, of, f"caster_{number_}", (caster.x, caster.y))
    return root


def _rolling(of: PlatformExport) -> list[str]:
    """Remarks on what the format has no place for."""
    said = [
        "Shapes are to be seen and to stand on: the width of wheels and the size of casters are assumed. A caster "
        "slides; give it no friction in your simulator."
    ]
    if any(wheel.roller_angle or not wheel.held for wheel in of.platform.wheels):
        angles = ", ".join(number(wheel.roller_angle) for wheel in of.platform.wheels)
        said.append(
            f"Wheels have rollers, at {angles} rad to their heading on the floor. URDF has none: let the floor's "
            "friction act along these directions alone; the format mjcf has it so."
        )
    return [*said, *rollers(of)]


def _base(root: Element, of: PlatformExport) -> None:
    """The base, above its footprint at the height of the axles."""
    link = SubElement(root, "link", name=PLATFORM_BASE)
    up = np.array([0.0, 0.0, of.radius])
    add_inertial(link, of.base._replace(centre=of.base.centre - up))
    if of.size:
        size = of.size
        visual = SubElement(link, "visual")
        SubElement(visual, "origin", xyz=vector((size.x, size.y, size.height / 2.0 - of.radius)), rpy="0 0 0")
        SubElement(SubElement(visual, "geometry"), "box", size=vector((size.length, size.width, size.height)))
    _fixed(root, "base_joint", FOOTPRINT, PLATFORM_BASE, (0.0, 0.0, of.radius))


def _wheel(root: Element, of: PlatformExport, place: int, direction: float) -> None:
    """A wheel with its joint."""
    name, at, drive = wheel_name(place), of.platform.wheels[place], of.drives.get(place)
    link = SubElement(root, "link", name=f"{name}_link")
    add_inertial(link, of.wheel)
    for shape in ("visual", "collision"):
        element = SubElement(link, shape)
        SubElement(element, "origin", xyz="0 0 0", rpy=vector((pi / 2.0, 0.0, 0.0)))
        round_ = {"radius": number(at.radius), "length": number(_WIDTH * at.radius)}
        SubElement(SubElement(element, "geometry"), "cylinder", round_)
    joint = SubElement(root, "joint", name=name, type="continuous")
    remark(joint, of_wheel(of, place))
    SubElement(joint, "parent", link=PLATFORM_BASE)
    SubElement(joint, "child", link=f"{name}_link")
    SubElement(joint, "origin", xyz=vector((at.x, at.y, 0.0)), rpy=vector((0.0, 0.0, at.heading)))
    SubElement(joint, "axis", xyz=vector((0.0, direction, 0.0)))
    if drive:
        SubElement(joint, "limit", required_limits(drive.of.label, drive.limits))
    damping, friction = (drive.damping, drive.friction) if drive else (0.0, 0.0)
    SubElement(joint, "dynamics", damping=number(damping), friction=number(friction + of.rolling[place]))


def _caster(root: Element, of: PlatformExport, name: str, at: tuple[float, float]) -> None:
    """A ball on the floor that slides, in the place of a caster."""
    link = SubElement(root, "link", name=f"{name}_link")
    for shape in ("visual", "collision"):
        ball = SubElement(SubElement(SubElement(link, shape), "geometry"), "sphere")
        ball.set("radius", number(_CASTER * of.radius))
    _fixed(root, name, PLATFORM_BASE, f"{name}_link", (*at, (_CASTER - 1.0) * of.radius))


def _fixed(root: Element, name: str, parent: str, child: str, at: tuple[float, float, float]) -> None:
    joint = SubElement(root, "joint", name=name, type="fixed")
    SubElement(joint, "parent", link=parent)
    SubElement(joint, "child", link=child)
    SubElement(joint, "origin", xyz=vector(at), rpy="0 0 0")
