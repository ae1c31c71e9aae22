r"""URDF of a machine: the description with its drives in links and joints, axes beside it as joints of their own.

A drive is a point mass m at p of its link; mass, centre and inertia about the common centre c of both by the
parallel-axis theorem, as ``spec.description.solids.together``:

.. math:: J = \sum_k J_k + m_k \left( |c_k - c|^2 E - (c_k - c)(c_k - c)^T \right)

The payload is a link of its own at a fixed joint, so that it can be taken off. URDF has no armature: remarks have it.
"""

from __future__ import annotations

from math import asin, atan2, hypot, isnan
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from drivesizer.joints.record import Array
from drivesizer.output.export.joint import BASE, LEAST_INERTIA, limited
from drivesizer.output.export.machine.record import (
    Adding,
    JointDrive,
    MachineExport,
    RobotExport,
    free_name,
    head,
    in_urdf,
    of_drive,
)
from drivesizer.output.export.markup import brief, document, identifier, number, remark, vector
from drivesizer.output.export.urdf import required_limits, transmission
from drivesizer.output.export.urdf import robot as of_one
from drivesizer.spec.description.record import Joint, Link
from drivesizer.spec.description.solids import Body, together

__all__ = ["add_inertial", "render", "robot"]

_TINY = 1e-14  # of a rotation: no angle


def render(of: MachineExport) -> bytes:
    """The file of a machine."""
    root = robot(of)
    for drive in of.robot.drives if of.robot else ():
        steps = drive.of.stepper is not None
        transmission(root, drive.joint, drive.ratio, f"{drive.joint}_motor", steps=steps)
    for name, one in of.axes:
        joint = f"{identifier(name)}_shaft"
        transmission(root, joint, one.train.ratio, f"{identifier(name)}_motor", steps=one.stepper is not None)
    return document(root)


def robot(of: MachineExport) -> Element:
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
        adding.add(name, of_one(one), root, kept=BASE, instead=_ground(of))
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


def laden(link: Link, drives: list[JointDrive]) -> Body:
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
