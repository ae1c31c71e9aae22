"""Joints that a machine moves and those that it holds, out of a description."""

from __future__ import annotations

import math
from collections.abc import Collection
from pathlib import Path

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.files.text import missing
from drivesizer.spec.description.record import Joint, Robot
from drivesizer.spec.robot_section import JointFigure, RobotSection

__all__ = ["SLACK", "Field", "figure_of", "file_of", "fixed_positions", "joint_of", "unit_of", "within"]

Field = tuple[str | int, ...]
SLACK = 1e-6  # of a limit, by which rounding may leave it
_ROTARY = ("angle", "rotary_speed", "angular_acceleration", "angular_jerk")


def joint_of(robot: Robot, name: str, field: Field) -> Joint:
    """A joint that is moved."""
    joint = robot.joints.get(name)
    if joint is None:
        raise FieldError(field, f"{quoted(name)} is no joint of {robot.file}{nearest(name, robot.joints)}")
    where = f"joint {quoted(name)} ({robot.file}:{joint.line})"
    if not joint.moves:
        raise FieldError(field, f"{where} is {quoted(joint.kind)}; expected one that turns or slides")
    if joint.mimic:
        raise FieldError(field, f"{where} follows {quoted(joint.mimic)}; expected a joint with a drive of its own")
    if joint.kind != "continuous" and not joint.lower <= joint.upper:
        raise FieldError(field, f"{where} has no limits of position; expected lower and upper")
    return joint


def figure_of(figure: JointFigure, joint: Joint, field: Field) -> float:
    """SI value of a figure of a joint."""
    if (figure.kind in _ROTARY) != joint.turns:
        found = "a figure of a joint that turns" if figure.kind in _ROTARY else "a figure of a joint that slides"
        verb = "turns" if joint.turns else "slides"
        raise FieldError(
            field, f"{found}, and {quoted(joint.name)} {verb}; expected e.g. {'10 deg' if joint.turns else '10 mm'}"
        )
    return figure.value


def file_of(spec_file: str, name: str, field: Field, expected: tuple[str, str]) -> Path:
    """Path of a file that a section names."""
    path = Path(spec_file).parent / name if spec_file else Path(name)
    if reason := missing(path):
        text = f"expected {expected[0]}, its path from the spec's folder, e.g. {expected[1]}"
        raise FieldError(field, f"{quoted(name)} cannot be read ({reason}); {text}")
    return path


def unit_of(joint: Joint) -> str:
    """SI unit of a joint's position."""
    return "rad" if joint.turns else "m"


def within(joint: Joint, position: float) -> bool:
    """Whether a position is inside the limits of a joint, up to rounding."""
    if joint.kind == "continuous" or not joint.lower <= joint.upper:
        return True
    slack = SLACK * max(abs(joint.lower), abs(joint.upper))
    return joint.lower - slack <= position <= joint.upper + slack


def fixed_positions(section: RobotSection, robot: Robot, moved: Collection[str]) -> dict[str, float]:
    """Positions of all joints that do not move."""
    for name in section.held:
        if name in moved:
            raise FieldError(("robot", "held", name), f"{quoted(name)} is moved by the trajectory; leave it out")
        joint_of(robot, name, ("robot", "held", name))
    others = {name: joint for name, joint in robot.joints.items() if name not in moved and joint.kind != "fixed"}
    found = {name: _fixed_position(section, robot, joint) for name, joint in others.items() if not joint.mimic}
    for joint in others.values():
        if joint.mimic:
            found[joint.name] = joint.factor * _followed(robot, joint, found) + joint.offset
    return found


def _fixed_position(section: RobotSection, robot: Robot, joint: Joint) -> float:
    """Position of a joint that is held."""
    where = f"{robot.file}:{joint.line}: joint {quoted(joint.name)}"
    if not joint.moves:
        raise InputError(f"{where} is {quoted(joint.kind)}; expected joints that are fixed, turn or slide")
    given, field = section.held.get(joint.name), ("robot", "held", joint.name)
    position = 0.0 if given is None else figure_of(given, joint, field)
    if not within(joint, position):
        unit = unit_of(joint)
        found = f"{position:.4g} {unit}; expected {joint.lower:.4g} to {joint.upper:.4g} {unit}, its limits"
        raise FieldError(
            field, f"joint {quoted(joint.name)} ({robot.file}:{joint.line}) does not move and is held at {found}"
        )
    return position


def _followed(robot: Robot, joint: Joint, held: dict[str, float]) -> float:
    """Position of the joint that one follows, which must be held."""
    position = held.get(joint.mimic, math.nan)
    if math.isnan(position) or robot.joints[joint.mimic].mimic:
        where = f"{robot.file}:{joint.line}: joint {quoted(joint.name)}"
        raise InputError(f"{where} follows {quoted(joint.mimic)}; expected it to follow a joint that is held, or none")
    return position
