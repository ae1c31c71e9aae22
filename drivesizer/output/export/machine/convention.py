r"""A description in the convention of URDF: each child's frame on the axis of its joint, which is there at 0.

MJCF has axes beside the child's origin, at the anchor a of the child's frame, and joints whose frames are those of a
reference position q0. The child's frame moves to the anchor, and is turned back by q0:

.. math:: p' = p + R a, \quad R' = R\, R(z, -q_0) \text{ (turning)}, \qquad p' = p - R z q_0 \text{ (sliding)}
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from drivesizer.joints.inverse_dynamics import Attached
from drivesizer.joints.record import Array
from drivesizer.output.export.machine.record import RobotExport
from drivesizer.spec.description.record import Joint, Link, about

__all__ = ["in_urdf"]


def in_urdf(robot: RobotExport) -> RobotExport:
    """The robot with frames as URDF has them, points of drives and payload in these.

    Parameters
    ----------
    robot
        In the frames of its description.

    Returns
    -------
    RobotExport
        The same machine.
    """
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
