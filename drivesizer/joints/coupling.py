r"""Drives mounted before other joints, their belts passing over the axes of those: coupled angles.

The pulleys over the passed axes turn freely, 1:1, so that the shaft of drive k keeps its angle against its own link,
whatever the joints between do. With parallel axes, s = 1 or -1 by their direction:

.. math:: \theta_k = q_k + \sum_{j\,passed} s_{jk} q_j, \quad \theta = C q, \quad T = C^{-T} \tau,
          \quad J_k = d_k^T M d_k

d_k is column k of the inverse of C: the joints' motion when drive k turns alone. So a passed joint's own drive has
less to do than its joint: the belt carries part of its torque.

Source: M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, Wiley, 2006, section 7.4, planar elbow
manipulator with remotely driven link.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from drivesizer.errors import FieldError, quoted
from drivesizer.joints.moving import Field
from drivesizer.joints.record import Array
from drivesizer.spec.description.record import Joint, Robot, placed
from drivesizer.spec.robot_section import DrivePlace, RobotSection

__all__ = ["coupling"]

_PARALLEL = 1e-6  # rad


def coupling(section: RobotSection, robot: Robot, held: Mapping[str, float], joints: Sequence[str]) -> Array:
    """Angles of drives per angle of joints."""
    found = np.eye(len(joints))
    for row, name in enumerate(joints):
        place, field = section.drives.get(name, DrivePlace()), ("robot", "drives", name, "belt_passes")
        if place.belt_passes:
            for other in _passed(robot, place, robot.joints[name], joints, field):
                found[row, joints.index(other.name)] = _direction(robot, held, robot.joints[name], other, field)
    return found


def _passed(robot: Robot, place: DrivePlace, joint: Joint, joints: Sequence[str], field: Field) -> list[Joint]:
    """Joints that move between the link of a drive and its own joint."""
    before = {one.name for one in robot.chain(place.link)} if place.link else set()
    found = [one for one in robot.chain(joint.parent) if one.name in joints and one.name not in before]
    if not found:
        raise FieldError(field, f"no joint moves between the drive of {quoted(joint.name)} and its joint; leave it out")
    return found


def _direction(robot: Robot, held: Mapping[str, float], joint: Joint, other: Joint, field: Field) -> float:
    """1 of a joint that turns in the same direction about a parallel axis, or -1."""
    along = float(_axis(robot, held, joint) @ _axis(robot, held, other))
    if not (joint.turns and other.turns) or 1.0 - abs(along) > _PARALLEL**2 / 2.0 + 1e-15:
        message = (
            f"the belt of {quoted(joint.name)} passes joint {quoted(other.name)}; expected one about a parallel axis"
        )
        raise FieldError(field, message)
    return 1.0 if along > 0.0 else -1.0


def _axis(robot: Robot, held: Mapping[str, float], joint: Joint) -> Array:
    """Axis of a joint in the frame of the root, the joints that move at their references."""
    axis = joint.turn @ joint.axis
    for one in robot.chain(joint.parent):
        axis = placed(one, held.get(one.name, one.reference))[1] @ axis
    return axis
