r"""Torques of joints beside those of masses: springs, weight that is taken off links, forces on links.

.. math:: \tau_j = c_j (q_j - q_{0,j}) + F_j(q_j) - \sum J^T F

c and q₀ are stiffness and rest of a spring of the description, F_j of the section's own springs (``loads.springs``),
whose travel counts from the start of the trajectory. Weight that a description takes off a link (MJCF: gravcomp) is a
force m c g upward at its centre of mass; the joint whose drive is said to carry it (actuatorgravcomp) still has it.
Forces on links have the directions of the world, whatever the link's own. Those of a file hold between its rows along
straight lines; pieces of the motion are cut there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.files.csv_columns import columns
from drivesizer.joints.inverse_dynamics import Array, Attached, JointMotion, force_torques
from drivesizer.joints.places import file_of, joint_of
from drivesizer.loads.springs import BalanceMass, spring_force, unfit_springs
from drivesizer.spec.description_record import Robot
from drivesizer.spec.robot_section import RobotSection

_SAME = 1e-9  # of the trajectory's time
Rows = tuple[Array, Array]  # time [s] and force [N], shape (rows, 3)


def check_joint_springs(section: RobotSection, robot: Robot, joints: Sequence[str]) -> None:
    """Refuse springs of joints that do not move, and of a kind that a joint has not."""
    for name, springs in section.springs.items():
        field = ("robot", "springs", name)
        joint = joint_of(robot, name, field)
        if name not in joints:
            raise FieldError(field, f"{quoted(name)} does not move; leave its springs out")
        if any(isinstance(one, BalanceMass) for one in springs):
            raise FieldError(field, "a counterweight of a joint is mass of its link; expected it in the description")
        for said in unfit_springs(springs, turns=joint.turns, levels=False):
            raise FieldError(field, said.removeprefix("springs: "))


def forces_in_files(section: RobotSection, spec_file: str, total: float) -> dict[int, Rows]:
    """Forces on links over time, of those that a file has, by their number."""
    found = {}
    for number, one in enumerate(section.forces):
        if one.file is not None:
            path = file_of(spec_file, one.file, ("robot", "forces", number, "file"), ("a CSV file", "foot.csv"))
            form = {"time": "time", "x": "force", "y": "force", "z": "force"}
            rows = columns(Path(path), form)
            time = rows["time"]
            if time[0] > _SAME * total or time[-1] < total * (1.0 - _SAME):
                text = f"time from {time[0]:g} to {time[-1]:g} s; expected all of the trajectory, 0 to {total:g} s"
                raise InputError(f"{path}: {text}")
            found[number] = (time, np.stack([rows[axis] for axis in "xyz"], axis=1))
    return found


def cut_at(motion: JointMotion, times: Array) -> JointMotion:
    """The motion with its pieces cut at some times, at which something else changes."""
    edges = np.concatenate([[0.0], np.cumsum(motion.duration)])
    near = np.abs(times[:, None] - edges[None]).min(axis=1) <= _SAME * edges[-1] if len(times) else times
    inside = np.unique(times[(near == 0) & (times > 0.0) & (times < edges[-1])])
    if not len(inside):
        return motion
    every = np.union1d(edges, inside)
    owner = np.searchsorted(edges, (every[:-1] + every[1:]) / 2.0) - 1
    share = (np.stack([every[:-1], every[1:]], axis=1) - edges[owner, None]) / motion.duration[owner, None]
    x = share[:, :, None]
    lines = [c[owner, :1] + x * (c[owner, 1:] - c[owner, :1]) for c in (motion.speed, motion.acceleration)]
    first, last = motion.speed[owner, :1], motion.speed[owner, 1:]
    travel = motion.duration[owner, None, None] * (first * x + (last - first) * x**2 / 2.0)
    whole = motion.duration[owner, None, None] * (first + last) / 2.0
    gap = motion.position[owner, 1:] - motion.position[owner, :1] - whole
    return JointMotion(motion.joints, np.diff(every), motion.position[owner, :1] + travel + gap * x, *lines)


def spring_torques(section: RobotSection, robot: Robot, moved: JointMotion, start: Array, *, moving: bool) -> Array:
    """Torques that the springs of joints take, shape (segments * 2, joints)."""
    found = np.zeros(moved.position.shape)
    for column, name in enumerate(moved.joints):
        joint, at = robot.joints[name], moved.position[:, :, column]
        found[:, :, column] = joint.stiffness * (at - joint.slack)
        way = np.sign(moved.speed[:, :, column].mean(axis=1, keepdims=True)) * moving
        for one in section.springs.get(name, ()):
            try:
                found[:, :, column] += spring_force(one, at - start[column], way)
            except FieldError as error:
                raise FieldError(("robot", "springs", name), str(error)) from None
    return found.reshape(-1, len(moved.joints))


def link_torques(
    section: RobotSection, robot: Robot, held: Mapping[str, float], moved: JointMotion, gravity: Array, turn: Array,
    files: Mapping[int, Rows],
) -> Array:  # fmt: skip
    """Torques against weight that is taken off links and against forces on them, shape (segments * 2, joints).

    Gravity is in the frame of the root, and ``turn`` leads from it to the world; forces of files count in a motion.
    """
    position, time = moved.position.reshape(-1, len(moved.joints)), moved.time.ravel()
    found = np.zeros(position.shape)
    lighter = [link for link in robot.links.values() if link.gravcomp * link.mass] if section.gravcomp == "keep" else []
    if lighter:
        up = np.array([-link.gravcomp * link.mass * gravity for link in lighter])
        every = np.broadcast_to(up, (len(position), *up.shape))
        points = [Attached(link.name, link.centre) for link in lighter]
        relieved = [not robot.joints[name].gravity_on_drive for name in moved.joints]
        found += force_torques(robot, held, points, moved.joints, position, every) * relieved
    acting = [(n, one) for n, one in enumerate(section.forces) if one.force is not None or n in files]
    if acting:
        values = np.empty((len(position), len(acting), 3))
        for column, (number, one) in enumerate(acting):
            values[:, column] = one.force if one.force is not None else np.stack(
                [np.interp(time, files[number][0], values_) for values_ in files[number][1].T], axis=1
            )  # fmt: skip
        points = [Attached(one.link, np.array(one.at)) for _, one in acting]
        found += force_torques(robot, held, points, moved.joints, position, values @ turn)
    return found


def check_forces(section: RobotSection, robot: Robot) -> None:
    """Refuse forces on links that there are not."""
    for number, one in enumerate(section.forces):
        if one.link not in robot.links:
            wrong = f"{quoted(one.link)} is no link of {robot.file}{nearest(one.link, robot.links)}"
            raise FieldError(("robot", "forces", number, "link"), wrong)
