"""Robot descriptions, URDF and MJCF, to one record of links and joints: strict, without meshes or a simulator."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.spec.description_record import (
    Body,
    Joint,
    Link,
    Node,
    Robot,
    about,
    figure,
    figures,
    name_of,
    read_tree,
    robot_of,
    shape_of,
    together,
    vector,
)

# -- Reader of URDF files: links with mass and size, and joints.
#
# Convention of URDF: lengths in m, angles in rad, roll, pitch and yaw about the fixed axes; inertia about the centre
# of mass.


Array = NDArray[np.float64]


def read_urdf(path: Path) -> Robot:
    """Links and joints of a file."""
    root = read_tree(path)
    if root.tag != "robot":
        raise InputError(f"{path}:{root.line}: <{root.tag[:40]}> is no URDF; expected <robot>")
    return urdf_of(root, path)


def urdf_of(root: Node, path: Path) -> Robot:
    """Links and joints of a root element."""
    links = [_link(node, path) for node in root.all("link")]
    joints = [_urdf_joint(node, path) for node in root.all("joint")]
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
    return Link(name, node.line, mass, centre, inertia, tuple(_radii(node, path)), lacking)


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


def _urdf_joint(node: Node, path: Path) -> Joint:
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


# -- Settings of an MJCF file that hold for all its elements: the compiler's, and classes of defaults.


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


# -- Mass of a body of an MJCF file: its inertial, or its solids by mass or density; of a mesh it stays unknown.


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_FLAT = ("plane", "hfield")  # without volume
_WATER = 1000.0  # kg/m^3, the density of MJCF where none is given
_NONE = Body(0.0, np.zeros(3), np.zeros((3, 3)))


def mass_of(node: Node, settings: Settings, childclass: str) -> tuple[Body, str]:
    """Mass of one body without those that hang on it."""
    inertial = node.first("inertial")
    if settings.from_geoms != "true" and inertial is not None:
        return _inertial(inertial, settings), ""
    if settings.from_geoms == "false":
        return _NONE, ""
    solids: list[Body] = []
    for geom in node.all("geom"):
        whole = settings.whole(geom, childclass)
        if _weightless(whole, settings):
            continue
        kind = whole.attributes.get("type", "mesh" if "mesh" in whole.attributes else "sphere")
        if kind not in _SIZES or "mesh" in whole.attributes:
            return _NONE, f"has a {kind} of unknown mass on line {geom.line}; expected <inertial>"
        solids.append(_solid(whole, kind, settings))
    return together(solids) if solids else _NONE, ""


def _weightless(geom: Node, settings: Settings) -> bool:
    """Whether a geom adds no mass, whatever its size."""
    path, given = settings.path, geom.attributes
    if given.get("type", "sphere") in _FLAT:
        return True
    return figure(geom, "mass", path, 1.0) == 0.0 or ("mass" not in given and figure(geom, "density", path, 1.0) == 0.0)


def _inertial(node: Node, settings: Settings) -> Body:
    """Figures of the element as written."""
    path, where = settings.path, f"{settings.path}:{node.line}: <inertial>"
    mass, (centre, turn) = figure(node, "mass", path), frame_of(node, settings)
    if "pos" not in node.attributes:
        raise InputError(f"{where} has no pos")
    if not mass >= 0.0:
        raise InputError(f"{where}: a mass of {mass:g} kg is none; expected 0 or more")
    full, principal = figures(node, "fullinertia", path), figures(node, "diaginertia", path)
    if (len(full), len(principal)) not in ((6, 0), (0, 3)):
        raise InputError(f"{where}: expected diaginertia of 3 numbers, or fullinertia of 6")
    if len(full):
        xx, yy, zz, xy, xz, yz = full
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        inertia = turn @ np.diag(principal) @ turn.T
    if inertia.diagonal().min() < 0.0:
        raise InputError(f"{where}: an inertia below 0 is none")
    return Body(mass, centre, inertia)


def _solid(geom: Node, kind: str, settings: Settings) -> Body:
    """A geom by its size and mass, or density."""
    path, where = settings.path, f"{settings.path}:{geom.line}: <geom>"
    if geom.attributes.get("shellinertia", "false") != "false":
        raise InputError(f"{where} shellinertia is not read; expected solids")
    size = figures(geom, "size", path).tolist()
    centre, turn = frame_of(geom, settings)
    if "fromto" in geom.attributes:
        if kind not in ("capsule", "cylinder"):
            raise InputError(f"{where} fromto of a {kind} is not read; expected pos and size")
        centre, turn, half = _between(geom, settings)
        size = [*size[:1], half]
    size = size[: _SIZES[kind]]
    if len(size) != _SIZES[kind] or not min(size) > 0.0:
        found = quoted(geom.attributes.get("size", ""))
        raise InputError(f"{where} size: {found}; expected {_SIZES[kind]} numbers above 0 of a {kind}")
    volume, radii = shape_of(kind, size)
    mass = figure(geom, "mass", path, figure(geom, "density", path, _WATER) * volume)
    if not mass >= 0.0:
        raise InputError(f"{where}: a mass of {mass:g} kg is none; expected 0 or more")
    return Body(mass, centre, mass * turn @ np.diag(radii) @ turn.T)


def _between(geom: Node, settings: Settings) -> tuple[np.ndarray, np.ndarray, float]:
    """Middle, turn and half the length of a geom between two points."""
    ends = figures(geom, "fromto", settings.path)
    where = f"{settings.path}:{geom.line}: <geom> fromto: {quoted(geom.attributes['fromto'])}"
    if len(ends) != 6:
        raise InputError(f"{where}; expected 6 numbers")
    along = ends[:3] - ends[3:]
    length = float(np.linalg.norm(along))
    if not length > 0.0:
        raise InputError(f"{where} has no length")
    direction = " ".join(repr(float(x)) for x in along)
    turned = frame_of(Node("geom", geom.line, {"zaxis": direction}), settings)[1]
    return (ends[:3] + ends[3:]) / 2.0, turned, length / 2.0


# -- Reader of MJCF files: bodies as links and their joints, without MuJoCo.
#
# Read are bodies with joints that turn or slide, their inertials, or their solids with mass or density, classes of
# defaults and the compiler's settings. What changes masses or joints in another manner is refused: files that are
# included, equalities, tendons, ball joints, springs. A free joint of a body of the world is held: the base is
# fixed.


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
    reader = _Reader(settings_of(root, path), root.line)
    for node in root.all("option"):
        for name in _FLUID:
            if figure(node, name, path, 0.0) != 0.0:
                raise InputError(f"{path}:{node.line}: <option> {name}: a fluid is not read; expected 0")
    for world in root.all("worldbody"):
        reader.bodies(world, WORLD, world.attributes.get("childclass", "main"))
    if not reader.joints:
        raise InputError(f"{path}:{root.line}: <mujoco> has no bodies; expected <worldbody> with <body>")
    return robot_of(path, root.attributes.get("model", ""), reader.links, reader.joints, reader.notes)


class _Reader:
    """Links and joints, as they are found."""

    def __init__(self, settings: Settings, line: int) -> None:
        self.settings, self.path = settings, settings.path
        self.links, self.joints, self.notes = [Link(WORLD, line)], list[Joint](), list[str]()

    def bodies(self, parent: Node, above: str, childclass: str) -> None:
        """Bodies of a body or the world, and all beyond them."""
        for node in parent.children:
            if node.tag not in _IN_BODIES:
                where = f"{self.path}:{node.line}: <{node.tag[:40]}>"
                raise InputError(f"{where} is not read; expected bodies with joints, geoms and inertials")
        for node in parent.all("body"):
            name, chosen = name_of(node, self.path), node.attributes.get("childclass", childclass)
            if node.attributes.get("mocap", "false") != "false" or scalar(node, "gravcomp", self.settings) != 0.0:
                where = f"{self.path}:{node.line}: <body>"
                raise InputError(f"{where} mocap or gravcomp is not read; expected a body that its joints carry")
            mass, lacking = mass_of(node, self.settings, chosen)
            self.links.append(Link(name, node.line, *mass, lacking=lacking))
            self._hang(node, above, name, chosen)
            self.bodies(node, name, chosen)

    def _hang(self, node: Node, above: str, name: str, chosen: str) -> None:
        """Joints between a body and its parent, with the attributes of their classes; a free one of a base is held."""
        moving = []
        for one in node.children:
            whole = self.settings.whole(one, chosen) if one.tag == "joint" else one
            if one.tag == "freejoint" or (one.tag == "joint" and whole.attributes.get("type") == "free"):
                if above != WORLD:
                    raise InputError(f"{self.path}:{one.line}: a free joint belongs to a body of the world")
                self.notes.append(
                    f"body {quoted(node.attributes.get('name', ''))} is free in the description; held here"
                )
            elif one.tag == "joint":
                moving.append(whole)
        place, turn = frame_of(node, self.settings)
        if not moving:
            fixed = f"{name} (fixed)", "fixed", node.line, above, name
            self.joints.append(Joint(*fixed, place, turn, np.array([0.0, 0.0, 1.0])))
        for number, one in enumerate(moving):
            joint = name_of(one, self.path)
            child = name if number == len(moving) - 1 else f"{name} (behind {joint})"
            if child != name:
                self.links.append(Link(child, one.line))
            self.joints.append(_moved(one, joint, above, child, (place, turn), self.settings))
            above, place, turn = child, np.zeros(3), np.eye(3)


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


def read_description(path: Path) -> Robot:
    """Links and joints of a file, URDF or MJCF by its root element."""
    root = read_tree(path)
    if root.tag == "mujoco":
        return mjcf_of(root, path)
    if root.tag == "robot":
        return urdf_of(root, path)
    raise InputError(f"{path}:{root.line}: <{root.tag[:40]}> is no robot; expected <robot> of URDF or <mujoco> of MJCF")
