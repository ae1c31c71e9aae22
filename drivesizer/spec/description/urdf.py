"""Reader of URDF files: links with mass and size, and joints.

Convention of URDF: lengths in m, angles in rad, roll, pitch and yaw about the fixed axes; inertia about the centre of
mass.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.spec.description.record import Joint, Link, Robot, robot_of
from drivesizer.spec.description.xml_tree import Node, figure, name_of, read_tree, vector

__all__ = ["read_urdf", "rotation", "urdf_of"]

Array = NDArray[np.float64]


def read_urdf(path: Path) -> Robot:
    """Links and joints of a file."""
    root = read_tree(path)
    if root.tag != "robot":
        raise InputError(f"{path}:{root.line}: <{root.tag[:40]}> is no URDF; expected <robot>")
    return urdf_of(root, path)


def urdf_of(root: Node, path: Path) -> Robot:
    """Links and joints of a root element."""
    links = [(node.line, _link(node, path)) for node in root.all("link")]
    joints = [_joint(node, path) for node in root.all("joint")]
    return robot_of(path, root.attributes.get("name", ""), links, joints)


# --- one link, one joint


def _link(node: Node, path: Path) -> Link:
    name = name_of(node, path)
    inertial = node.first("inertial")
    mass, centre, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    if inertial is not None:
        mass, (centre, turn) = _mass(inertial, name, path), _origin(inertial, path)
        inertia = turn @ _inertia(inertial, name, path) @ turn.T
    shaped = inertial is None and bool(node.first("visual") or node.first("collision"))
    lacking = "has a shape and no <inertial>, so that its mass is unknown" if shaped else ""
    return Link(name, mass, centre, inertia, tuple(_radii(node, path)), node.line, lacking)


def _mass(inertial: Node, name: str, path: Path) -> float:
    node = inertial.first("mass")
    if node is None:
        raise InputError(f"{path}:{inertial.line}: link {quoted(name)}: <inertial> has no <mass>")
    mass = figure(node, "value", path)
    if not mass >= 0.0:
        raise InputError(f"{path}:{node.line}: link {quoted(name)}: a mass of {mass:g} kg is none; expected 0 or more")
    return mass


def _inertia(inertial: Node, name: str, path: Path) -> Array:
    node = inertial.first("inertia")
    if node is None:
        raise InputError(f"{path}:{inertial.line}: link {quoted(name)}: <inertial> has no <inertia>")
    xx, yy, zz = (figure(node, f"i{a}{a}", path) for a in "xyz")
    xy, xz, yz = (figure(node, f"i{a}", path, 0.0) for a in ("xy", "xz", "yz"))
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
                radius = figure(node, "radius", path)
                if not radius > 0.0:
                    raise InputError(f"{path}:{node.line}: a radius of {radius:g} m is none; expected more than 0")
                yield radius, _origin(part, path)[1][:, 2] if kind == "cylinder" else np.zeros(3)


def _joint(node: Node, path: Path) -> Joint:
    name, (place, turn) = name_of(node, path), _origin(node, path)
    ends = [end.attributes.get("link", "") if (end := node.first(what)) else "" for what in ("parent", "child")]
    kind, limit = node.attributes.get("type", ""), node.first("limit")
    along = None if kind == "fixed" else node.first("axis")  # a fixed joint has none, whatever its file says
    axis = vector(along, "xyz", path, (1.0, 0.0, 0.0)) if along else np.array([1.0, 0.0, 0.0])
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise InputError(f"{path}:{node.line}: joint {quoted(name)}: an axis of length 0 has no direction")
    effort, velocity, lower, upper = (
        figure(limit, what, path, math.nan) if limit else math.nan for what in ("effort", "velocity", "lower", "upper")
    )
    losses, follows = node.first("dynamics"), node.first("mimic")
    damping, friction = (figure(losses, what, path, 0.0) if losses else 0.0 for what in ("damping", "friction"))
    if min(damping, friction) < 0.0:
        raise InputError(f"{path}:{node.line}: joint {quoted(name)}: damping or friction below 0 is none")
    return Joint(
        name, kind, node.line, ends[0], ends[1], place, turn, axis / length,
        effort, velocity, lower, upper, limit is not None, damping=damping, friction=friction,
        mimic=follows.attributes.get("joint", "") or "?" if follows else "",
        factor=figure(follows, "multiplier", path, 1.0) if follows else 1.0,
        offset=figure(follows, "offset", path, 0.0) if follows else 0.0,
    )  # fmt: skip


def _origin(node: Node, path: Path) -> tuple[Array, Array]:
    """Place and turn of an element's frame."""
    origin = node.first("origin")
    if origin is None:
        return np.zeros(3), np.eye(3)
    return vector(origin, "xyz", path), rotation(vector(origin, "rpy", path))


def rotation(rpy: Array) -> Array:
    """Rotation matrix of roll, pitch and yaw [rad] about fixed axes."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array([
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ])  # fmt: skip
