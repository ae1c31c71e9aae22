"""Reader of MJCF files: bodies as links and their joints, without MuJoCo.

Read are bodies with joints that turn or slide, their inertials, or their solids with mass or density, classes of
defaults and the compiler's settings. What changes masses or joints in another manner is refused: files that are
included, equalities, tendons, ball joints, springs. A free joint of a body of the world is held: the base is fixed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.spec.description.mjcf_bodies import mass_of
from drivesizer.spec.description.mjcf_classes import Settings, frame_of, scalar, settings_of
from drivesizer.spec.description.record import Joint, Link, Robot, robot_of
from drivesizer.spec.description.xml_tree import Node, figure, figures, name_of, vector

__all__ = ["WORLD", "mjcf_of"]

Array = NDArray[np.float64]
WORLD = "world"
_READ = frozenset({"compiler", "default", "option", "worldbody"})
_ELSEWHERE = frozenset({
    "actuator", "asset", "contact", "custom", "keyframe", "sensor", "size", "statistic", "visual",
})  # fmt: skip
_IN_BODIES = frozenset({"body", "camera", "freejoint", "geom", "inertial", "joint", "light", "site"})
_KINDS = {"hinge": "revolute", "slide": "prismatic"}
_FLUID = ("density", "viscosity")


def mjcf_of(root: Node, path: Path) -> Robot:
    """Links and joints of a root element."""
    for node in root.children:
        if node.tag not in _READ | _ELSEWHERE and (node.children or node.tag not in ("equality", "tendon")):
            raise InputError(f"{path}:{node.line}: <{node.tag[:40]}> is not read; expected a description without it")
    settings, reader = settings_of(root, path), _Reader()
    _no_fluid(root, path)
    for world in root.all("worldbody"):
        reader.bodies(world, WORLD, settings, world.attributes.get("childclass", "main"))
    if not reader.joints:
        raise InputError(f"{path}:{root.line}: <mujoco> has no bodies; expected <worldbody> with <body>")
    links = [(root.line, Link(WORLD, 0.0, np.zeros(3), np.zeros((3, 3)), ())), *reader.links]
    return robot_of(path, root.attributes.get("model", ""), links, reader.joints, reader.notes)


def _no_fluid(root: Node, path: Path) -> None:
    for node in root.all("option"):
        for name in _FLUID:
            if figure(node, name, path, 0.0) != 0.0:
                raise InputError(f"{path}:{node.line}: <option> {name}: a fluid is not read; expected 0")


class _Reader:
    """Links and joints, as they are found."""

    def __init__(self) -> None:
        self.links: list[tuple[int, Link]] = []
        self.joints: list[Joint] = []
        self.notes: list[str] = []

    def bodies(self, parent: Node, above: str, settings: Settings, childclass: str) -> None:
        """Bodies of a body or the world, and all beyond them."""
        for node in parent.children:
            if node.tag not in _IN_BODIES:
                where = f"{settings.path}:{node.line}: <{node.tag[:40]}>"
                raise InputError(f"{where} is not read; expected bodies with joints, geoms and inertials")
        for node in parent.all("body"):
            name, chosen = name_of(node, settings.path), node.attributes.get("childclass", childclass)
            _no_more(node, settings)
            mass, lacking = mass_of(node, settings, chosen)
            link = Link(name, mass.mass, mass.centre, mass.inertia, (), node.line, lacking)
            self.links.append((node.line, link))
            self._hang(node, above, name, settings, chosen)
            self.bodies(node, name, settings, chosen)

    def _hang(self, node: Node, above: str, name: str, settings: Settings, chosen: str) -> None:
        """Joints between a body and its parent."""
        place, turn = frame_of(node, settings)
        found = list(self._moving(node, above, settings, chosen))
        if not found:
            self.joints.append(_joint(node, f"{name} (fixed)", above, name, place, turn))
        for number, one in enumerate(found):
            joint = name_of(one, settings.path)
            child = name if number == len(found) - 1 else f"{name} (behind {joint})"
            if child != name:
                self.links.append((one.line, Link(child, 0.0, np.zeros(3), np.zeros((3, 3)), (), one.line)))
            self.joints.append(_moved(one, joint, above, child, (place, turn), settings))
            above, place, turn = child, np.zeros(3), np.eye(3)

    def _moving(self, node: Node, above: str, settings: Settings, chosen: str) -> Iterator[Node]:
        """Joints of a body with the attributes of their classes; a free one of a base is left out."""
        for one in node.children:
            whole = settings.whole(one, chosen) if one.tag == "joint" else one
            if one.tag == "freejoint" or (one.tag == "joint" and whole.attributes.get("type") == "free"):
                if above != WORLD:
                    raise InputError(f"{settings.path}:{one.line}: a free joint belongs to a body of the world")
                self.notes.append(
                    f"body {quoted(node.attributes.get('name', ''))} is free in the description; held here"
                )
            elif one.tag == "joint":
                yield whole


def _no_more(node: Node, settings: Settings) -> None:
    """Refuse a body that follows something else than its joints."""
    if node.attributes.get("mocap", "false") != "false" or scalar(node, "gravcomp", settings) != 0.0:
        where = f"{settings.path}:{node.line}: <body>"
        raise InputError(f"{where} mocap or gravcomp is not read; expected a body that its joints carry")


def _joint(node: Node, name: str, parent: str, child: str, place: Array, turn: Array) -> Joint:
    """One that is fixed."""
    nan = math.nan
    return Joint(
        name, "fixed", node.line, parent, child, place, turn, np.array([0.0, 0.0, 1.0]), nan, nan, nan, nan, False
    )


def _moved(node: Node, name: str, parent: str, child: str, frame: tuple[Array, Array], settings: Settings) -> Joint:
    """One that turns or slides."""
    path, where = settings.path, f"{settings.path}:{node.line}: joint {quoted(name)}"
    written = node.attributes.get("type", "hinge")
    if written not in _KINDS:
        raise InputError(f"{where} is {quoted(written)}; expected hinge or slide")
    for what in ("stiffness", "springdamper"):
        if figures(node, what, path).any():
            raise InputError(f"{where}: a spring ({what}) is not read; expected a joint without")
    axis = vector(node, "axis", path, (0.0, 0.0, 1.0))
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise InputError(f"{where}: an axis of length 0 has no direction")
    factor = settings.degrees if written == "hinge" else 1.0
    lower, upper = (value * factor for value in _range(node, settings))
    damping, friction, armature = (scalar(node, key, settings) for key in ("damping", "frictionloss", "armature"))
    if min(damping, friction, armature) < 0.0:
        raise InputError(f"{where}: damping, frictionloss or armature below 0 is none")
    limited = not math.isnan(lower)
    kind = "continuous" if written == "hinge" and not limited else _KINDS[written]
    effort = figures(node, "actuatorfrcrange", path)
    return Joint(
        name, kind, node.line, parent, child, *frame, axis / length,
        float(np.abs(effort).min()) if len(effort) else math.nan, math.nan, lower, upper, limited,
        anchor=vector(node, "pos", path), reference=figure(node, "ref", path, 0.0) * factor,
        damping=damping, friction=friction, armature=armature,
    )  # fmt: skip


def _range(node: Node, settings: Settings) -> tuple[float, float]:
    """Limits as written; NaN of a joint without."""
    limited, given = node.attributes.get("limited", "auto"), figures(node, "range", settings.path)
    where = f"{settings.path}:{node.line}: <joint>"
    if len(given) not in (0, 2) or (len(given) == 2 and not given[0] <= given[1]):
        raise InputError(f"{where} range: {quoted(node.attributes['range'])}; expected its two ends, the lower first")
    if limited not in ("auto", "true", "false"):
        raise InputError(f"{where} limited: {quoted(limited)}; expected true, false or auto")
    if limited == "false" or not len(given):
        return math.nan, math.nan
    if limited == "auto" and not settings.autolimits:
        raise InputError(f"{where} has a range and no limited; expected limited, as autolimits is false")
    return float(given[0]), float(given[1])
