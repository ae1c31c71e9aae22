"""Trajectory of a robot section, inside the limits of its joints."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from drivesizer.errors import FieldError, quoted
from drivesizer.joints.moving import SLACK, Field, figure_of, file_of, joint_of, unit_of, within
from drivesizer.joints.record import Array, JointMotion
from drivesizer.joints.recorded_trajectory import motion_in
from drivesizer.joints.waypoints import moves_of
from drivesizer.spec.description.record import Joint, Robot
from drivesizer.spec.robot_section import RobotSection

__all__ = ["motion_of", "static_poses"]


def motion_of(section: RobotSection, robot: Robot, spec_file: str) -> JointMotion:
    """Joints over time, their limits kept."""
    field = ("robot", "waypoints" if section.trajectory is None else "trajectory")
    if section.trajectory is None:
        motion = moves_of(section, robot)
    else:
        path = file_of(spec_file, section.trajectory, field, ("a CSV file", "moves.csv"))
        motion = motion_in(path, robot, section.smoothing)
    for column, name in enumerate(motion.joints):
        _inside(motion, column, joint_of(robot, name, field), robot, field)
    return motion


def _inside(motion: JointMotion, column: int, joint: Joint, robot: Robot, field: Field) -> None:
    """Refuse positions and speeds outside the limits of a joint."""
    position, speed = motion.position[:, :, column].ravel(), np.abs(motion.speed[:, :, column].ravel())
    unit, name = unit_of(joint), f"joint {quoted(joint.name)}"
    whose = f"its limits in {robot.file}:{joint.line}"
    for value in (position.max(), position.min()):
        if not within(joint, float(value)):
            found = f"{name} is at {value:.4g} {unit} after {_when(motion, position == value):.4g} s"
            raise FieldError(field, f"{found}; expected {joint.lower:.4g} to {joint.upper:.4g} {unit}, {whose}")
    top = float(speed.max())
    if joint.velocity > 0.0 and top > joint.velocity * (1.0 + SLACK):
        found = f"{name} has {top:.4g} {unit}/s after {_when(motion, speed == top):.4g} s"
        raise FieldError(field, f"{found}; expected at most {joint.velocity:.4g} {unit}/s, {whose}")


def _when(motion: JointMotion, there: Array) -> float:
    """First time at which something holds [s]."""
    return float(motion.time.ravel()[int(np.argmax(there))])


def static_poses(
    section: RobotSection, robot: Robot, motion: JointMotion
) -> Iterator[tuple[str, float | None, JointMotion]]:
    """Poses that the drives hold: name, payload [kg] where it is another, and one segment at rest."""
    for number, hold in enumerate(section.holds):
        position = motion.position[0, 0].copy()
        for name, figure in hold.positions.items():
            field: Field = ("robot", "holds", number, "positions", name)
            joint = joint_of(robot, name, field)
            if name not in motion.joints:
                raise FieldError(
                    field, f"{quoted(name)} is held at one position throughout; expected it in the trajectory"
                )
            position[motion.joints.index(name)] = figure_of(figure, joint, field)
        still = np.zeros((1, 2, len(position)))
        pose = JointMotion(motion.joints, np.array([hold.time]), still + position, still, still)
        for column, name in enumerate(motion.joints):
            _inside(pose, column, robot.joints[name], robot, ("robot", "holds", number))
        yield hold.name, hold.payload, pose
