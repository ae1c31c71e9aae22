"""Record of a robot description: links with their mass, joints with their limits and losses, whatever the format."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted

Array = NDArray[np.float64]


# -- Mass, centre and inertia of solids of even density, and of several together.
#
# .. math::
#     \text{box } a, b, c \text{ (half sizes): } V = 8abc, \; J_x = m \frac{b^2 + c^2}{3} \qquad
#     \text{ellipsoid: } V = \tfrac{4}{3} π abc, \; J_x = m \frac{b^2 + c^2}{5}
#
#     \text{cylinder } r, h \text{ (half length): } V = 2πr^2h, \; J_z = \frac{m r^2}{2}, \;
#     J_x = m \left( \frac{r^2}{4} + \frac{h^2}{3} \right)
#
# A capsule is a cylinder and two half spheres, whose centres of mass are 3r/8 beyond its ends:
#
# .. math::
#     m_s = m \frac{2r}{2r + 3h}, \quad J_z = \frac{(m - m_s) r^2}{2} + \frac{2 m_s r^2}{5}, \quad
#     J_x = (m - m_s) \left( \frac{r^2}{4} + \frac{h^2}{3} \right)
#     + m_s \left( \frac{2r^2}{5} + h^2 + \frac{3rh}{4} \right)
#
# Source: handbooks of mechanics, e.g. Dubbel, moments of inertia of bodies; bodies together by Steiner's theorem.


class Body(NamedTuple):
    """A rigid body in some frame."""

    mass: float  # kg
    centre: Array  # m, of mass
    inertia: Array  # kg*m^2, 3 x 3, about the centre of mass


def shape_of(kind: str, size: Sequence[float]) -> tuple[float, Array]:
    """Volume of a solid about its own centre, and inertia by mass.

    Examples
    --------
    >>> shape_of("box", (0.5, 1.0, 1.5))
    (6.0, array([1.0833, 0.8333, 0.4167]))
    """
    if kind in ("box", "ellipsoid", "sphere"):
        a, b, c = size if len(size) == 3 else (size[0],) * 3
        volume = 8.0 * a * b * c if kind == "box" else 4.0 / 3.0 * math.pi * a * b * c
        share = 3.0 if kind == "box" else 5.0
        return volume, np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / share
    r, h = size
    shell = 2.0 * r / (2.0 * r + 3.0 * h) if kind == "capsule" else 0.0  # share of both ends
    across = (1.0 - shell) * (r * r / 4.0 + h * h / 3.0) + shell * (0.4 * r * r + h * h + 0.75 * r * h)
    along = (1.0 - shell) * r * r / 2.0 + shell * 0.4 * r * r
    ends = 4.0 / 3.0 * math.pi * r**3 if kind == "capsule" else 0.0
    return 2.0 * math.pi * r * r * h + ends, np.array([across, across, along])


def together(bodies: Sequence[Body]) -> Body:
    """Several bodies of one frame as one."""
    mass = sum(body.mass for body in bodies)
    centre = sum((body.mass * body.centre for body in bodies), np.zeros(3))
    centre = centre / mass if mass > 0.0 else centre
    inertia = np.zeros((3, 3))
    for body in bodies:
        arm = body.centre - centre
        inertia = inertia + body.inertia + body.mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Body(mass, centre, inertia)


# -- Record of a robot description: links with their mass, joints with their limits and losses, whatever the format.
#
# Convention of URDF: each joint has a frame, fixed in its parent link, and its child's frame is that frame turned
# about, or moved along, the axis. In MJCF the axis of a hinge may pass beside the child's origin: through
# ``anchor``.


TURNING = ("revolute", "continuous")  # kinds of joints that turn; of prismatic ones effort is N, velocity m/s


@dataclass(frozen=True, slots=True)
class Link:
    """A body; mass 0 and inertia 0 where the file gives none."""

    name: str
    line: int
    mass: float = 0.0  # kg
    centre: Array = field(default_factory=lambda: np.zeros(3))  # m, of mass, in the link's frame
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))  # kg*m^2, about its centre, along the link's axes
    radii: tuple[tuple[float, Array], ...] = ()  # m, of its cylinders and spheres; axis of each, zeros for a sphere
    lacking: str = ""  # reason why its mass is unknown, such as a mesh alone; empty where it is known
    gravcomp: float = 0.0  # share of its weight that something else than the drives carries


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
    effort: float = math.nan  # N*m, or N
    velocity: float = math.nan  # rad/s, or m/s
    lower: float = math.nan
    upper: float = math.nan
    limited: bool = False  # the file has a limit
    anchor: Array = field(default_factory=lambda: np.zeros(3))  # m, a point of the axis in the child's frame
    reference: float = 0.0  # position at which the child's frame is the joint's [rad or m]
    damping: float = 0.0  # N*m*s/rad, or N*s/m
    friction: float = 0.0  # N*m, or N, of Coulomb
    armature: float = 0.0  # kg*m^2, or kg, of a rotor behind its gear
    stiffness: float = 0.0  # N*m/rad, or N/m, of a spring beside its drive
    slack: float = 0.0  # position at which that spring is at rest [rad or m]
    gravity_on_drive: bool = False  # its drive carries the weight that gravcomp takes off links
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


def robot_of(path: Path, name: str, links: Iterable[Link], joints: Iterable[Joint], notes: Iterable[str] = ()) -> Robot:
    """A robot, its names unique and its joints a tree."""
    found, named, above = dict[str, Link](), dict[str, Joint](), dict[str, Joint]()
    for link in links:
        if found.setdefault(link.name, link) is not link:
            raise InputError(f"{path}:{link.line}: link {quoted(link.name)} is there twice")
    for joint in joints:
        if named.setdefault(joint.name, joint) is not joint:
            raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)} is there twice")
    for joint in named.values():
        for end in (joint.parent, joint.child):
            if end not in found:
                raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)}: there is no link {quoted(end)}")
        if above.setdefault(joint.child, joint) is not joint:
            raise InputError(f"{path}:{joint.line}: link {quoted(joint.child)} hangs on two joints")
    try:
        TopologicalSorter({child: [joint.parent] for child, joint in above.items()}).prepare()
    except CycleError as error:
        joint = next(above[link] for link in error.args[1] if link in above)
        raise InputError(
            f"{path}:{joint.line}: joint {quoted(joint.name)} is part of a ring; expected a tree"
        ) from None
    return Robot(str(path), name, found, named, tuple(notes))


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
