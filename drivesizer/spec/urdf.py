"""Reader of URDF files: links with mass and size, and joints.

expat parses the XML; document types, and so entities, are refused, size and depth are bounded. Convention of URDF:
lengths in m, angles in rad, roll, pitch and yaw about the fixed axes; inertia about the centre of mass.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import read_bytes

__all__ = ["Joint", "Link", "Node", "Robot", "read_urdf", "rotation"]

Array = NDArray[np.float64]
_LARGEST = 16_000_000  # bytes
_DEEPEST = 60
_MOST = 20_000  # elements


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


@dataclass(frozen=True, slots=True)
class Link:
    """A body; mass 0 and inertia 0 where the file gives none."""

    name: str
    mass: float  # kg
    centre: Array  # m, of mass, in the link's frame
    inertia: Array  # kg*m^2, about the centre of mass, along the link's axes
    radii: tuple[tuple[float, Array], ...]  # m, of its cylinders and spheres; axis of each, zeros for a sphere


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


@dataclass(frozen=True, slots=True)
class Robot:
    """All links and joints by name, in the order of the file."""

    file: str
    name: str
    links: dict[str, Link]
    joints: dict[str, Joint]


def read_urdf(path: Path) -> Robot:
    """Links and joints of a file.

    Raises
    ------
    InputError
        One line with file, line, what was found and what is expected.
    """
    root = _tree(read_bytes(path, _LARGEST), path)
    if root.tag != "robot":
        raise InputError(f"{path}:{root.line}: <{root.tag[:40]}> is no URDF; expected <robot>")
    links = _named([_link(node, path) for node in root.all("link")], "link", path)
    joints = _named([_joint(node, path) for node in root.all("joint")], "joint", path)
    for joint in joints.values():
        for end in (joint.parent, joint.child):
            if end not in links:
                raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)}: there is no link {quoted(end)}")
    _a_tree(joints, path)
    return Robot(str(path), root.attributes.get("name", ""), links, joints)


def _tree(raw: bytes, path: Path) -> Node:
    """Elements of a file, without text between them."""
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
        raise InputError(f"{path}:{parser.CurrentLineNumber}: a document type is not taken; expected plain URDF")

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


def _named(found: list[tuple[Node, Link]] | list[tuple[Node, Joint]], what: str, path: Path) -> dict[str, Any]:
    named: dict[str, Any] = {}
    for node, one in found:
        if one.name in named:
            raise InputError(f"{path}:{node.line}: {what} {quoted(one.name)} is there twice")
        named[one.name] = one
    return named


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


# --- one link, one joint


def _link(node: Node, path: Path) -> tuple[Node, Link]:
    name = _name(node, path)
    inertial = node.first("inertial")
    mass, centre, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    if inertial is not None:
        mass, (centre, turn) = _mass(inertial, name, path), _origin(inertial, path)
        inertia = turn @ _inertia(inertial, name, path) @ turn.T
    return node, Link(name, mass, centre, inertia, tuple(_radii(node, path)))


def _mass(inertial: Node, name: str, path: Path) -> float:
    node = inertial.first("mass")
    if node is None:
        raise InputError(f"{path}:{inertial.line}: link {quoted(name)}: <inertial> has no <mass>")
    mass = _figure(node, "value", path)
    if not mass >= 0.0:
        raise InputError(f"{path}:{node.line}: link {quoted(name)}: a mass of {mass:g} kg is none; expected 0 or more")
    return mass


def _inertia(inertial: Node, name: str, path: Path) -> Array:
    node = inertial.first("inertia")
    if node is None:
        raise InputError(f"{path}:{inertial.line}: link {quoted(name)}: <inertial> has no <inertia>")
    xx, yy, zz = (_figure(node, f"i{a}{a}", path) for a in "xyz")
    xy, xz, yz = (_figure(node, f"i{a}", path, 0.0) for a in ("xy", "xz", "yz"))
    if min(xx, yy, zz) < 0.0:
        raise InputError(f"{path}:{node.line}: link {quoted(name)}: an inertia below 0 is none")
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _radii(link: Node, path: Path) -> Iterator[tuple[float, Array]]:
    """Radii of cylinders about their axis z and of spheres; collision shapes before visual ones."""
    for part in (*link.all("collision"), *link.all("visual")):
        shape = part.first("geometry")
        for kind in ("cylinder", "sphere") if shape else ():
            node = shape.first(kind) if shape else None
            if node is not None:
                radius = _figure(node, "radius", path)
                if not radius > 0.0:
                    raise InputError(f"{path}:{node.line}: a radius of {radius:g} m is none; expected more than 0")
                yield radius, _origin(part, path)[1][:, 2] if kind == "cylinder" else np.zeros(3)


def _joint(node: Node, path: Path) -> tuple[Node, Joint]:
    name, (place, turn) = _name(node, path), _origin(node, path)
    ends = [end.attributes.get("link", "") if (end := node.first(what)) else "" for what in ("parent", "child")]
    along, limit = node.first("axis"), node.first("limit")
    axis = _vector(along, "xyz", path, (1.0, 0.0, 0.0)) if along else np.array([1.0, 0.0, 0.0])
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise InputError(f"{path}:{node.line}: joint {quoted(name)}: an axis of length 0 has no direction")
    effort, velocity, lower, upper = (
        _figure(limit, what, path, math.nan) if limit else math.nan for what in ("effort", "velocity", "lower", "upper")
    )
    return node, Joint(
        name, node.attributes.get("type", ""), node.line, ends[0], ends[1], place, turn, axis / length,
        effort, velocity, lower, upper, limit is not None,
    )  # fmt: skip


def _name(node: Node, path: Path) -> str:
    name = node.attributes.get("name", "")
    if not name:
        raise InputError(f"{path}:{node.line}: <{node.tag}> has no name")
    return name


def _origin(node: Node, path: Path) -> tuple[Array, Array]:
    """Place and turn of an element's frame."""
    origin = node.first("origin")
    if origin is None:
        return np.zeros(3), np.eye(3)
    return _vector(origin, "xyz", path), rotation(_vector(origin, "rpy", path))


def rotation(rpy: Array) -> Array:
    """Rotation matrix of roll, pitch and yaw [rad] about fixed axes."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ])  # fmt: skip


def _figure(node: Node, name: str, path: Path, otherwise: float | None = None) -> float:
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
    if not math.isfinite(value) or "_" in written:
        raise InputError(f"{path}:{node.line}: <{node.tag}> {name}: {quoted(written)} is no number")
    return value


def _vector(node: Node, name: str, path: Path, otherwise: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
    written = node.attributes.get(name)
    if written is None:
        return np.array(otherwise)
    parts = written.split()
    if len(parts) != 3:
        raise InputError(f"{path}:{node.line}: <{node.tag}> {name}: {quoted(written)} is no vector; expected 3 numbers")
    return np.array([_number(part, node, name, path) for part in parts])
