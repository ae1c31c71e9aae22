r"""Torques of all joints as functions of the masses that ride on the links: exactly linear.

.. math:: \tau_i(t) = \tau_i^0(t) + \sum_k m_k \, c_{ik}(t)

The drive of joint k is a point mass on the link before it, on the joint's axis, unless the section says elsewhere; one
on the base is carried by no joint and has no column. Only joints between a mass and the base have other than 0 there.
What a drive adds by its own inertia about its centre, and the gyroscopic torques of its rotor, are left out; the
rotor's inertia by the ratio squared is of the joint's own search. Armature in the description is of the drive that is
to be replaced, and left out. Payloads are columns as well, so that load cases with another one cost nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drivesizer.files.csv_columns import beside
from drivesizer.joints.inverse_dynamics import Attached, Torques, torques_of
from drivesizer.joints.joint_load import JointLoad, cycle_of, joint_load, radius_of
from drivesizer.joints.moving import held_joints, unit_of
from drivesizer.joints.places import carried_by, drive_places, outermost_first, payload_place
from drivesizer.joints.record import Array, JointMotion
from drivesizer.joints.trajectory import held_poses, motion_of
from drivesizer.spec.description import read_description
from drivesizer.spec.description.record import Robot
from drivesizer.spec.description.urdf import rotation
from drivesizer.spec.robot_section import RobotSection

__all__ = ["JointTorques", "JointsCase", "joint_loads", "joint_torques"]

_GRAVITY = 9.80665  # m/s^2
_PAYLOAD = ""  # its name among those of the points


class JointsCase(NamedTuple):
    """A load case of the robot: a motion with a payload, and the columns of its torques."""

    name: str  # empty for the trajectory with its own payload
    payload: float  # kg
    motion: JointMotion
    torques: Torques  # shape (sets, segments * 2, joints)


@dataclass(frozen=True, slots=True)
class JointTorques:
    """Torques of the joints of a description over their load cases, as columns; loads for any masses of the drives."""

    section: RobotSection
    robot: Robot
    joints: tuple[str, ...]  # those that move, in the order of the description
    held: Mapping[str, float]  # rad or m, of joints that do not
    points: tuple[str, ...]  # of the columns behind the description's own: drives by joint, then the payload, ""
    cases: tuple[JointsCase, ...]  # the trajectory first
    carried: Mapping[
        str, tuple[str, ...]
    ]  # by joint, those whose drives ride beyond it: their masses count in its load
    order: tuple[str, ...]  # joints, each behind those that it carries
    notes: tuple[str, ...]  # of what was assumed

    def load(self, joint: str, masses: Mapping[str, float], case: int = 0) -> JointLoad:
        """Load of one joint with drives of given masses.

        Parameters
        ----------
        joint
            One that moves.
        masses
            Of the drive of each joint [kg]; 0 of those that are not named.
        case
            Number of the load case; 0 is the trajectory.

        Returns
        -------
        JointLoad
            At the shaft that the joint's drive turns.
        """
        motion, column = self.cases[case].motion, self.joints.index(joint)
        torque, static, inertia = (self._sum(values, column, masses, case) for values in self.cases[case].torques)
        own, place = self.robot.joints[joint], self.section.drives.get(joint)
        cycle = cycle_of(
            own, motion.duration, (motion.speed[:, :, column], motion.acceleration[:, :, column]),
            torque.reshape(-1, 2), static.reshape(-1, 2), float(inertia.max()),
            radius=radius_of(own, place.travel_per_turn if place else None),
            friction=self.section.friction == "keep",
        )  # fmt: skip
        return joint_load(cycle, joint, self.cases[case].name)

    def loads(self, masses: Mapping[str, float]) -> dict[str, JointLoad]:
        """Loads of all joints along the trajectory; parameters as of ``load``."""
        return {joint: self.load(joint, masses) for joint in self.joints}

    def _sum(self, values: Array, column: int, masses: Mapping[str, float], case: int) -> Array:
        """A quantity of one joint in all states of a case."""
        unknown = sorted(set(masses) - set(self.joints))
        if unknown:
            raise ValueError(f"no joint of the robot moves: {', '.join(unknown)}")
        weights = [
            1.0,
            *(self.cases[case].payload if name == _PAYLOAD else masses.get(name, 0.0) for name in self.points),
        ]
        found: Array = np.array(weights) @ values[:, :, column]
        return found


def joint_loads(
    section: RobotSection, spec_file: str, masses: Mapping[str, float], gravity: float = _GRAVITY
) -> dict[str, JointLoad]:
    """Loads of all joints along the trajectory, the drives' masses known.

    Parameters
    ----------
    section
        Of the machine.
    spec_file
        From whose folder files count; empty for a spec that is no file.
    masses
        Of the drive of each joint [kg]; 0 of those that are not named.
    gravity
        Acceleration of free fall [m/s^2].

    Returns
    -------
    dict
        By joint, in the order of the description.

    Raises
    ------
    InputError
        As :func:`joint_torques`, which serves further masses at little cost.
    """
    return joint_torques(section, spec_file, gravity).loads(masses)


def joint_torques(section: RobotSection, spec_file: str, gravity: float = _GRAVITY) -> JointTorques:
    """Torques of the joints of a section, over all its load cases.

    Parameters
    ----------
    section
        Of the machine.
    spec_file
        From whose folder files count; empty for a spec that is no file.
    gravity
        Acceleration of free fall [m/s^2].

    Returns
    -------
    JointTorques
        Columns of all drives and of the payload.

    Raises
    ------
    FieldError
        A field of the section is wrong; the caller adds file and line.
    InputError
        A file is wrong, or MuJoCo is not installed.
    """
    robot = read_description(beside(spec_file, section.description, "robot.description"))
    motion = _ordered(motion_of(section, robot, spec_file), robot)
    held = held_joints(section, robot, motion.joints)
    drives = drive_places(section, robot, motion.joints)
    payload = payload_place(section, robot, motion.joints)
    points = drives if payload is None else {**drives, _PAYLOAD: payload}
    for joint in motion.joints:
        place = section.drives.get(joint)
        radius_of(robot.joints[joint], place.travel_per_turn if place else None)
    carried = carried_by(robot, drives, motion.joints)
    order = outermost_first(carried)
    down = rotation(np.array([section.mounting.roll, section.mounting.pitch, section.mounting.yaw])).T[:, 2] * -gravity
    cases = tuple(_cases(section, robot, motion, held, list(points.values()), down))
    notes = (*robot.notes, *_notes(section, robot, motion, held))
    return JointTorques(section, robot, motion.joints, held, tuple(points), cases, carried, order, notes)


def _ordered(motion: JointMotion, robot: Robot) -> JointMotion:
    """A motion with its joints in the order of the description."""
    names = tuple(name for name in robot.joints if name in motion.joints)
    at = [motion.joints.index(name) for name in names]
    columns = (c[:, :, at] for c in (motion.position, motion.speed, motion.acceleration))
    return JointMotion(names, motion.duration, *columns)


def _cases(
    section: RobotSection, robot: Robot, motion: JointMotion, held: Mapping[str, float], points: Sequence[Attached],
    down: Array,
) -> Iterator[JointsCase]:  # fmt: skip
    """The trajectory, the same with other payloads, and poses that are held."""
    found = _columns(robot, held, points, motion, down)
    payload = section.payload.mass if section.payload else 0.0
    yield JointsCase("", payload, motion, found)
    for case in section.payloads:
        yield JointsCase(case.name, case.mass, motion, found)
    for name, mass, pose in held_poses(section, robot, motion):
        yield JointsCase(name, payload if mass is None else mass, pose, _columns(robot, held, points, pose, down))


def _columns(
    robot: Robot, held: Mapping[str, float], points: Sequence[Attached], motion: JointMotion, down: Array
) -> Torques:
    """Torques at both ends of each segment; one state where a segment starts as the one before ends."""
    count = len(motion.joints)
    states = [c.reshape(-1, count) for c in (motion.position, motion.speed, motion.acceleration)]
    new = np.concatenate([[True], np.any([(c[1:] != c[:-1]).any(axis=1) for c in states], axis=0)])
    position, speed, acceleration = (c[new] for c in states)
    found = torques_of(robot, held, points, motion.joints, (position, speed, acceleration), down)
    return Torques(*(values[:, np.cumsum(new) - 1] for values in found))


def _notes(section: RobotSection, robot: Robot, motion: JointMotion, held: Mapping[str, float]) -> Iterator[str]:
    """Sentences on what was assumed."""
    if held:
        places = ", ".join(f"{name} at {value:.4g} {unit_of(robot.joints[name])}" for name, value in held.items())
        yield f"joints that the trajectory does not move are held: {places}"
    own = [robot.joints[name] for name in motion.joints]
    if any(joint.armature for joint in own):
        yield "the armature in the description is of the drives that are to be replaced, and is left out"
    if any(joint.friction or joint.damping for joint in own):
        kept = "is kept as that of their bearings" if section.friction == "keep" else "is left out"
        yield f"the friction of joints in the description {kept}"
    if not motion.returns:
        yield "the trajectory ends elsewhere than it starts, and the cycle repeats from its start"
