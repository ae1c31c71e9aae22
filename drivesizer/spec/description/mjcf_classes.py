"""Settings of an MJCF file that hold for all its elements: the compiler's, and classes of defaults."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.spec.description.record import about
from drivesizer.spec.description.xml_tree import Node, figure, figures, vector

__all__ = ["Settings", "frame_of", "scalar", "settings_of"]

Array = NDArray[np.float64]
_CLASSED = ("joint", "geom")  # elements whose defaults count
_HARMLESS = frozenset({
    "alignfree", "assetdir", "autolimits", "angle", "convexhull", "coordinate", "discardvisual", "eulerseq",
    "exactmeshinertia", "fitaabb", "fusestatic", "inertiafromgeom", "meshdir", "saveinertial", "strippath",
    "texturedir", "usethread",
})  # fmt: skip
_NEUTRAL = {  # value with which a setting of the compiler changes no mass
    "balanceinertia": "false", "boundinertia": "0", "boundmass": "0", "inertiagrouprange": "0 5", "settotalmass": "-1",
}  # fmt: skip
_ORIENTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")


@dataclass(slots=True)
class Settings:
    """Compiler settings and, by class and element, the attributes that an element has where it gives none."""

    path: Path
    degrees: float = math.pi / 180.0  # factor of angles to rad
    sequence: str = "xyz"
    autolimits: bool = True
    from_geoms: str = "auto"
    classes: dict[str, dict[str, dict[str, str]]] = field(default_factory=lambda: {"main": {}})

    def whole(self, node: Node, childclass: str) -> Node:
        """An element with the attributes of its class added."""
        chosen = node.attributes.get("class", childclass)
        if chosen not in self.classes:
            hint = nearest(chosen, self.classes)
            raise InputError(f"{self.path}:{node.line}: there is no default class {quoted(chosen)}{hint}")
        return Node(node.tag, node.line, {**self.classes[chosen].get(node.tag, {}), **node.attributes}, node.children)


def settings_of(root: Node, path: Path) -> Settings:
    """Settings and classes of a file."""
    found = Settings(path)
    for node in root.all("compiler"):
        _compiler(node, found)
    for node in root.all("default"):
        _class(node, found, {}, "main")
    return found


def _compiler(node: Node, found: Settings) -> None:
    given, where = node.attributes, f"{found.path}:{node.line}: <compiler>"
    for name, value in given.items():
        if name in _NEUTRAL and value.split() == _NEUTRAL[name].split():
            continue
        if name not in _HARMLESS:
            raise InputError(
                f"{where} {name}={quoted(value)} is not read; expected masses and joints as they are written"
            )
    _setting(where, given, "coordinate", ("local",))
    found.degrees = 1.0 if _setting(where, given, "angle", ("degree", "radian")) == "radian" else math.pi / 180.0
    found.autolimits = _setting(where, given, "autolimits", ("true", "false")) == "true"
    found.from_geoms = _setting(where, given, "inertiafromgeom", ("auto", "true", "false"))
    found.sequence = given.get("eulerseq", "xyz")
    if len(found.sequence) != 3 or set(found.sequence.lower()) - set("xyz"):
        raise InputError(f"{where} eulerseq: {quoted(found.sequence)}; expected three of x, y, z")


def _setting(where: str, given: Mapping[str, str], name: str, values: tuple[str, ...]) -> str:
    """Value of a setting; the first where it is not given."""
    value = given.get(name, values[0])
    if value not in values:
        raise InputError(f"{where} {name}: {quoted(value)}; expected {' or '.join(values)}")
    return value


def _class(node: Node, found: Settings, inherited: Mapping[str, dict[str, str]], otherwise: str) -> None:
    """Attributes of a class and of those in it."""
    name = node.attributes.get("class", otherwise)
    if not name:
        raise InputError(f"{found.path}:{node.line}: <default> has no class")
    made = {tag: dict(inherited.get(tag, {})) for tag in _CLASSED}
    for tag in _CLASSED:
        for one in node.all(tag):
            made[tag].update(one.attributes)
    found.classes[name] = made
    for inner in node.all("default"):
        _class(inner, found, made, "")


def frame_of(node: Node, settings: Settings) -> tuple[Array, Array]:
    """Place and turn of an element in the frame of its parent."""
    given = [name for name in _ORIENTATIONS if name in node.attributes]
    where = f"{settings.path}:{node.line}: <{node.tag}>"
    if len(given) > 1:
        raise InputError(f"{where} has {' and '.join(given)}; expected one orientation")
    place = vector(node, "pos", settings.path)
    if not given:
        return place, np.eye(3)
    values, wanted = figures(node, given[0], settings.path), _COUNT[given[0]]
    if len(values) != wanted:
        raise InputError(f"{where} {given[0]}: {quoted(node.attributes[given[0]])}; expected {wanted} numbers")
    turned = _turned(given[0], values, settings)
    if not np.isfinite(turned).all():
        raise InputError(f"{where} {given[0]}: {quoted(node.attributes[given[0]])} has no direction")
    return place, turned


_COUNT = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}


def _turned(kind: str, values: Array, settings: Settings) -> Array:
    """Rotation matrix of an orientation; NaN of one without a direction."""
    with np.errstate(all="ignore"):
        if kind == "quat":
            w, v = values[0] / np.linalg.norm(values), values[1:] / np.linalg.norm(values)
            cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
            turned: Array = np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross
            return turned
        if kind == "axisangle":
            return about(values[:3] / np.linalg.norm(values[:3]), float(values[3]) * settings.degrees)
        if kind == "euler":
            return _euler(values * settings.degrees, settings.sequence)
        if kind == "zaxis":
            return _least_turn(values / np.linalg.norm(values))
        x = values[:3] / np.linalg.norm(values[:3])
        y = values[3:] - x * float(x @ values[3:])
        y = y / np.linalg.norm(y)
        return np.stack([x, y, np.cross(x, y)], axis=1)


def _euler(angles: Array, sequence: str) -> Array:
    """Turns about axes that move along (lower case) or stay (upper case), in turn."""
    turned = np.eye(3)
    for angle, axis in zip(angles, sequence, strict=True):
        one = about(np.eye(3)["xyz".index(axis.lower())], float(angle))
        turned = turned @ one if axis.islower() else one @ turned
    return turned


def _least_turn(z: Array) -> Array:
    """The smallest turn that brings the axis z to a direction."""
    axis, cosine = np.cross([0.0, 0.0, 1.0], z), float(z[2])
    sine = float(np.linalg.norm(axis))
    if np.isfinite(sine) and sine < 1e-10:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    return about(axis / sine, math.atan2(sine, cosine))


def scalar(node: Node, name: str, settings: Settings) -> float:
    """One number of an attribute; laws of several coefficients are refused."""
    if len(node.attributes.get(name, "0").split()) != 1:
        where = f"{settings.path}:{node.line}: <{node.tag}> {name}"
        raise InputError(f"{where}: {quoted(node.attributes[name])} is not read; expected one number")
    return figure(node, name, settings.path, 0.0)
