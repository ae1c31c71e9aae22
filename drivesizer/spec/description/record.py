"""Record of a robot description: links with their mass, joints with their limits and losses, whatever the format.

Convention of URDF: each joint has a frame, fixed in its parent link, and its child's frame is that frame turned about,
or moved along, the axis. In MJCF the axis of a hinge may pass beside the child's origin: through ``anchor``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted

__all__ = ["TURNING", "Joint", "Link", "Robot", "about", "placed", "robot_of"]

Array = NDArray[np.float64]
TURNING = ("revolute", "continuous")  # kinds of joints that turn; of prismatic ones effort is N, velocity m/s


def _origin() -> Array:
    return np.zeros(3)


@dataclass(frozen=True, slots=True)
class Link:
    """A body; mass 0 and inertia 0 where the file gives none."""

    name: str
    mass: float  # kg
    centre: Array  # m, of mass, in the link's frame
    inertia: Array  # kg*m^2, about the centre of mass, along the link's axes
    radii: tuple[tuple[float, Array], ...]  # m, of its cylinders and spheres; axis of each, zeros for a sphere
    line: int = 0
    lacking: str = ""  # reason why its mass is unknown, such as a mesh alone; empty where it is known


@dataclass(frozen=True, slots=True)
class Joint:
    """Joint of two links; limits are NaN where the file has none."""

    name: str
    kind: str
    line: int
    parent: str
    child: str
    place: Array  # m, of the child in the parent's frame
    turn: Array  # 3 x 3, from the child's axes to the parent's
    axis: Array  # of length 1, in the child's frame
    effort: float  # N*m, or N
    velocity: float  # rad/s, or m/s
    lower: float
    upper: float
    limited: bool  # the file has a limit
    anchor: Array = field(default_factory=_origin)  # m, a point of the axis in the child's frame
    reference: float = 0.0  # position at which the child's frame is the joint's [rad or m]
    damping: float = 0.0  # N*m*s/rad, or N*s/m
    friction: float = 0.0  # N*m, or N, of Coulomb
    armature: float = 0.0  # kg*m^2, or kg, of a rotor behind its gear
    mimic: str = ""  # joint that it follows, by factor and offset
    factor: float = 1.0
    offset: float = 0.0

    @property
    def turns(self) -> bool:
        """Whether it turns; else it slides, or does not move."""
        return self.kind in TURNING

    @property
    def moves(self) -> bool:
        """Whether it has one degree of freedom."""
        return self.turns or self.kind == "prismatic"


@dataclass(frozen=True, slots=True)
class Robot:
    """All links and joints by name, in the order of the file."""

    file: str
    name: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    notes: tuple[str, ...] = ()  # of what the file has and is left out

    @property
    def above(self) -> dict[str, Joint]:
        """Joint on which each link hangs; roots have none."""
        return {joint.child: joint for joint in self.joints.values()}

    def chain(self, link: str) -> list[Joint]:
        """Joints between a link and its root, the nearest first."""
        above, found = self.above, []
        while link in above:
            found.append(above[link])
            link = above[link].parent
        return found


def robot_of(
    path: Path, name: str, links: Iterable[tuple[int, Link]], joints: Iterable[Joint], notes: Iterable[str] = ()
) -> Robot:
    """A robot, its names unique and its joints a tree."""
    found: dict[str, Link] = {}
    for line, link in links:
        if link.name in found:
            raise InputError(f"{path}:{line}: link {quoted(link.name)} is there twice")
        found[link.name] = link
    named: dict[str, Joint] = {}
    for joint in joints:
        if joint.name in named:
            raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)} is there twice")
        named[joint.name] = joint
    for joint in named.values():
        for end in (joint.parent, joint.child):
            if end not in found:
                raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)}: there is no link {quoted(end)}")
    _a_tree(named, path)
    return Robot(str(path), name, found, named, tuple(notes))


def _a_tree(joints: dict[str, Joint], path: Path) -> None:
    """Refuse a link with two parents, and closed chains."""
    above: dict[str, str] = {}
    for joint in joints.values():
        if joint.child in above:
            raise InputError(f"{path}:{joint.line}: link {quoted(joint.child)} hangs on two joints")
        above[joint.child] = joint.parent
    for joint in joints.values():
        link, steps = joint.parent, 0
        while link in above and steps <= len(above):
            link, steps = above[link], steps + 1
        if steps > len(above):
            raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)} is part of a ring; expected a tree")


def placed(joint: Joint, position: float) -> tuple[Array, Array]:
    """Place and turn of a joint's child in the frame of its parent."""
    moved = position - joint.reference
    if joint.kind == "prismatic":
        return joint.place + joint.turn @ joint.axis * moved, joint.turn
    if not joint.turns:
        return joint.place, joint.turn
    turned = joint.turn @ about(joint.axis, moved)
    return joint.place + joint.turn @ joint.anchor - turned @ joint.anchor, turned


def about(axis: Array, angle: float) -> Array:
    """Rotation matrix about an axis by an angle, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return turned
