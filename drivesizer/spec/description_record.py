"""Record of a robot description: links with their mass, joints with their limits; elements of an XML file."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import read_bytes

# -- Elements of an XML file with their lines.
#
# expat parses; document types, and so entities, are refused, size and depth are bounded.


Array = NDArray[np.float64]
_LARGEST = 16_000_000  # bytes
_DEEPEST = 60
_MOST = 20_000  # elements
_FARTHEST = 1e50  # of any figure: products of a few of them can still be computed with


@dataclass(slots=True)
class Node:
    """An element with its line in the file."""

    tag: str
    line: int
    attributes: dict[str, str]
    children: list[Node] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Node]:
        """Children of a tag."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Node | None:
        """First child of a tag; None without any."""
        return next(self.all(tag), None)


def read_tree(path: Path) -> Node:
    """Root element of a file, without text between the elements."""
    raw = read_bytes(path, _LARGEST)
    top, open_, count = Node("", 0, {}), [], 0
    open_.append(top)
    parser = expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if len(open_) > _DEEPEST or count > _MOST:
            raise InputError(f"{path}:{parser.CurrentLineNumber}: expected at most {_MOST} elements, {_DEEPEST} deep")
        node = Node(tag, parser.CurrentLineNumber, attributes)
        open_[-1].children.append(node)
        open_.append(node)

    def refuse(*_: object) -> None:
        raise InputError(f"{path}:{parser.CurrentLineNumber}: a document type is not taken; expected plain XML")

    parser.StartElementHandler, parser.EndElementHandler = start, lambda _: open_.pop()
    parser.StartDoctypeDeclHandler, parser.EntityDeclHandler = refuse, refuse
    try:
        parser.Parse(raw, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        line, reason = getattr(error, "lineno", 1), expat.ErrorString(getattr(error, "code", 0)) or "unknown encoding"
        raise InputError(f"{path}:{line}: this is no XML ({reason})") from None
    return top.children[0]


def name_of(node: Node, path: Path) -> str:
    """Name of an element that must have one."""
    name = node.attributes.get("name", "")
    if not name:
        raise InputError(f"{path}:{node.line}: <{node.tag}> has no name")
    return name


def figure(node: Node, name: str, path: Path, otherwise: float | None = None) -> float:
    """Number in an attribute."""
    written = node.attributes.get(name)
    if written is None:
        if otherwise is None:
            raise InputError(f"{path}:{node.line}: <{node.tag}> has no {name}")
        return otherwise
    return _number(written, node, name, path)


def _number(written: str, node: Node, name: str, path: Path) -> float:
    try:
        value = float(written)
    except ValueError:
        value = math.nan
    plain = written.isascii() and "_" not in written  # float() takes digits of other scripts
    if not (plain and abs(value) < _FARTHEST):  # written so that NaN fails too
        raise InputError(f"{path}:{node.line}: <{node.tag}> {name}: {quoted(written)} is no number")
    return value


def figures(node: Node, name: str, path: Path) -> Array:
    """Numbers in an attribute, separated by blanks; none where it is not there."""
    return np.array([_number(part, node, name, path) for part in node.attributes.get(name, "").split()])


def vector(node: Node, name: str, path: Path, otherwise: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
    """Three numbers in an attribute."""
    written = node.attributes.get(name)
    if written is None:
        return np.array(otherwise)
    parts = written.split()
    if len(parts) != 3:
        raise InputError(f"{path}:{node.line}: <{node.tag}> {name}: {quoted(written)} is no vector; expected 3 numbers")
    return figures(node, name, path)


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


def _origin() -> Array:
    return np.zeros(3)


@dataclass(frozen=True, slots=True)
class Link:
    """A body; mass 0 and inertia 0 where the file gives none."""

    name: str
    line: int
    mass: float = 0.0  # kg
    centre: Array = field(default_factory=_origin)  # m, of mass, in the link's frame
    inertia: Array = field(
        default_factory=lambda: np.zeros((3, 3))
    )  # kg*m^2, about the centre of mass, along the link's axes
    radii: tuple[tuple[float, Array], ...] = ()  # m, of its cylinders and spheres; axis of each, zeros for a sphere
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
    effort: float = math.nan  # N*m, or N
    velocity: float = math.nan  # rad/s, or m/s
    lower: float = math.nan
    upper: float = math.nan
    limited: bool = False  # the file has a limit
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


def robot_of(path: Path, name: str, links: Iterable[Link], joints: Iterable[Joint], notes: Iterable[str] = ()) -> Robot:
    """A robot, its names unique and its joints a tree."""
    found: dict[str, Link] = {}
    for link in links:
        if found.setdefault(link.name, link) is not link:
            raise InputError(f"{path}:{link.line}: link {quoted(link.name)} is there twice")
    named: dict[str, Joint] = {}
    for joint in joints:
        if named.setdefault(joint.name, joint) is not joint:
            raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)} is there twice")
    above: dict[str, str] = {}
    for joint in named.values():
        for end in (joint.parent, joint.child):
            if end not in found:
                raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)}: there is no link {quoted(end)}")
    for joint in named.values():
        if joint.child in above:
            raise InputError(f"{path}:{joint.line}: link {quoted(joint.child)} hangs on two joints")
        above[joint.child] = joint.parent
    for joint in named.values():
        up, steps = joint.parent, 0
        while up in above and steps <= len(above):
            up, steps = above[up], steps + 1
        if steps > len(above):
            raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)} is part of a ring; expected a tree")
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
