"""Joints that move and joints that are held, places of their drives and payload, belts that pass other joints."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter

import numpy as np

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.joints.inverse_dynamics import Array, Attached
from drivesizer.spec.description import Joint, Robot
from drivesizer.spec.robot_section import DrivePlace, JointFigure, RobotSection

# -- Joints that a machine moves and those that it holds, out of a description.


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


def check_link(robot: Robot, link: str, field: Field) -> None:
    """Refuse a link that there is not."""
    if link not in robot.links:
        raise FieldError(field, f"{quoted(link)} is no link of {robot.file}{nearest(link, robot.links)}")


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
            position = found.get(joint.mimic, math.nan)
            if math.isnan(position) or robot.joints[joint.mimic].mimic:
                where = f"{robot.file}:{joint.line}: joint {quoted(joint.name)} follows {quoted(joint.mimic)}"
                raise InputError(f"{where}; expected it to follow a joint that is held, or none")
            found[joint.name] = joint.factor * position + joint.offset
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


# -- Places of drives and payload on the links, and who carries whom.


def drive_places(section: RobotSection, robot: Robot, joints: Sequence[str]) -> dict[str, Attached]:
    """Points of links at which the drives of joints hang; those on the base hang on none and are left out."""
    for name in section.drives:
        if name not in joints:
            wrong = f"{quoted(name)} is no joint that moves{nearest(name, joints)}; expected {', '.join(joints)[:200]}"
            raise FieldError(("robot", "drives", name), wrong)
    found: dict[str, Attached] = {}
    pairs = {one.joints[1]: one.joints[0] for one in section.couplings}  # whose drives sit side by side
    on_frame = {name for one in section.couplings if one.kind == "corexy" for name in one.joints}
    for name in joints:
        place, joint = section.drives.get(name, DrivePlace()), robot.joints[name]
        if place.on == "base" or name in on_frame:
            continue
        if name in pairs and name not in section.drives:
            joint = robot.joints[pairs[name]]
        if place.link is not None:
            check_link(robot, place.link, ("robot", "drives", name, "link"))
        at = np.zeros(3) if place.link else joint.place + joint.turn @ joint.anchor  # its axis, in the frame before it
        found[name] = Attached(place.link or joint.parent, at if place.at is None else np.array(place.at))
    return found


def payload_place(section: RobotSection, robot: Robot, joints: Sequence[str]) -> Attached | None:
    """Point at which the payload hangs; None without any."""
    payload, field = section.payload, ("robot", "payload")
    if payload is None:
        return None
    link = payload.link
    if link is None:
        parents = {joint.parent for joint in robot.joints.values()}
        last = [name for name in robot.links if name not in parents]
        if len(last) != 1:
            raise FieldError(field, f"{len(last)} links are last ones; expected link, one of {', '.join(last)[:200]}")
        link = last[0]
    check_link(robot, link, (*field, "link"))
    if not any(joint.name in joints for joint in robot.chain(link)):
        raise FieldError((*field, "link"), f"nothing moves link {quoted(link)}; expected one behind a joint that moves")
    return Attached(link, np.array(payload.at))


def carried_by(robot: Robot, drives: Mapping[str, Attached], joints: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Joints whose drives ride beyond each joint; a drive on a link that it moves rides beyond its own."""
    under = {name: {joint.name for joint in robot.chain(point.link)} for name, point in drives.items()}
    return {joint: tuple(name for name in joints if joint in under.get(name, ())) for joint in joints}


def outermost_first(carried: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Joints in an order in which each comes behind those whose drives it carries.

    Examples
    --------
    >>> outermost_first({"shoulder": ("elbow",), "elbow": ()})
    ('elbow', 'shoulder')
    """
    try:
        others = {joint: [other for other in on_it if other != joint] for joint, on_it in carried.items()}
        return tuple(TopologicalSorter(others).static_order())
    except CycleError as error:
        round_ = ", ".join(error.args[1])
        raise FieldError(("robot", "drives"), f"joints carry each other's drives in a circle: {round_}") from None


# -- Drives mounted before other joints, their belts passing over the axes of those: coupled angles.
#
# The pulleys over the passed axes turn freely, 1:1, so that the shaft of drive k keeps its angle against its own
# link, whatever the joints between do. With parallel axes, s = 1 or -1 by their direction:
#
# .. math:: \theta_k = q_k + \sum_{j\,passed} s_{jk} q_j, \quad \theta = C q, \quad T = C^{-T} \tau,
#           \quad J_k = d_k^T M d_k
#
# d_k is column k of the inverse of C: the joints' motion when drive k turns alone. So a passed joint's own drive has
# less to do than its joint: the belt carries part of its torque.
#
# Of a differential wrist (kind: differential) and of a CoreXY gantry both drives move both joints, q_1 when they turn
# alike and q_2 against one another, by i:
#
# .. math:: \theta_1 = q_1 + i q_2, \quad \theta_2 = q_1 - i q_2, \quad T_{1,2} = (\tau_1 \pm \tau_2 / i) / 2
#
# Source: M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, Wiley, 2006, section 7.4, planar
# elbow manipulator with remotely driven link.


_PARALLEL = 1e-6  # rad


def check_couplings(section: RobotSection, robot: Robot, joints: Sequence[str]) -> None:
    """Refuse couplings of joints that do not move, that are coupled already, or of the other kind."""
    seen = set[str]()
    for number, one in enumerate(section.couplings):
        field: Field = ("robot", "couplings", number, "joints")
        for name in one.joints:
            joint = joint_of(robot, name, field)
            if name not in joints or name in seen:
                reason = "is coupled twice" if name in seen else "does not move"
                raise FieldError(field, f"{quoted(name)} {reason}; expected two joints of the trajectory, each once")
            if joint.turns != (one.kind == "differential"):
                verb, kinds = ("turns", "slide") if joint.turns else ("slides", "turn")
                raise FieldError(field, f"{quoted(name)} {verb}; the joints of kind: {one.kind} {kinds}")
            if section.drives.get(name, DrivePlace()).belt_passes:
                raise FieldError(
                    field, f"the belt of {quoted(name)} passes other joints; expected that or the coupling"
                )
            seen.add(name)


def coupling(section: RobotSection, robot: Robot, held: Mapping[str, float], joints: Sequence[str]) -> Array:
    """Angles of drives per angle of joints."""
    found = np.eye(len(joints))

    def axis(joint: Joint) -> Array:
        """In the frame of the root, the joints that move at their references."""
        along: Array = robot.frame(joint.parent, held)[1] @ joint.turn @ joint.axis
        return along

    for row, name in enumerate(joints):
        place, joint = section.drives.get(name, DrivePlace()), robot.joints[name]
        field = ("robot", "drives", name, "belt_passes")
        if not place.belt_passes:
            continue
        before = {one.name for one in robot.chain(place.link)} if place.link else set()
        passed = [one for one in robot.chain(joint.parent) if one.name in joints and one.name not in before]
        if not passed:
            raise FieldError(field, f"no joint moves between the drive of {quoted(name)} and its joint; leave it out")
        for other in passed:
            along = float(axis(joint) @ axis(other))
            if not (joint.turns and other.turns) or 1.0 - abs(along) > _PARALLEL**2 / 2.0 + 1e-15:
                words = f"the belt of {quoted(name)} passes joint {quoted(other.name)}"
                raise FieldError(field, f"{words}; expected one about a parallel axis")
            found[row, joints.index(other.name)] = 1.0 if along > 0.0 else -1.0
    for one in section.couplings:
        pair = [joints.index(name) for name in one.joints]
        found[np.ix_(pair, pair)] = [[1.0, one.ratio], [1.0, -one.ratio]]
    return found
