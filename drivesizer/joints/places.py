"""Places of drives and payload on the links, and who carries whom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from graphlib import CycleError, TopologicalSorter

import numpy as np

from drivesizer.errors import FieldError, nearest, quoted
from drivesizer.joints.inverse_dynamics import Attached
from drivesizer.spec.description.record import Robot
from drivesizer.spec.robot_section import DrivePlace, RobotSection

__all__ = ["carried_by", "drive_places", "outermost_first", "payload_place"]


def drive_places(section: RobotSection, robot: Robot, joints: Sequence[str]) -> dict[str, Attached]:
    """Points of links at which the drives of joints hang; those on the base, and those that the
    links' masses hold already, hang on none and are left out.
    """
    for name in section.drives:
        if name not in joints:
            field = ("robot", "drives", name)
            raise FieldError(
                field,
                f"{quoted(name)} is no joint that moves{nearest(name, joints)}; expected {', '.join(joints)[:200]}",
            )
    found: dict[str, Attached] = {}
    if section.masses == "with_drives":
        return found
    for name in joints:
        place = section.drives.get(name, DrivePlace())
        if place.on != "base":
            found[name] = _place(place, robot, name)
    return found


def _place(place: DrivePlace, robot: Robot, name: str) -> Attached:
    """Point of one drive: the joint's axis in the frame of the link before, where the section gives none."""
    joint, field = robot.joints[name], ("robot", "drives", name)
    if place.link is None:
        at = joint.place + joint.turn @ joint.anchor if place.at is None else np.array(place.at)
        return Attached(joint.parent, at)
    if place.link not in robot.links:
        raise FieldError(
            (*field, "link"), f"{quoted(place.link)} is no link of {robot.file}{nearest(place.link, robot.links)}"
        )
    return Attached(place.link, np.zeros(3) if place.at is None else np.array(place.at))


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
    if link not in robot.links:
        raise FieldError((*field, "link"), f"{quoted(link)} is no link of {robot.file}{nearest(link, robot.links)}")
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
