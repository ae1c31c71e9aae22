"""Robot descriptions, URDF and MJCF, to one record of links and joints: strict, without meshes or a simulator."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.xml_tree import Node, read_tree

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

    def outwards(self, first: str | None = None) -> list[str]:
        """Links from the roots on, or from one, each behind the one that it hangs on."""
        names = [name for name in self.links if name not in self.above] if first is None else [first]
        for name in names:  # grows by the links that hang on each
            names += [joint.child for joint in self.joints.values() if joint.parent == name]
        return names

    def frame(self, link: str, positions: Mapping[str, float]) -> tuple[Array, Array]:
        """Place and turn of a link in the frame of its root, joints without a position at their references."""
        place, turn = np.zeros(3), np.eye(3)
        for joint in reversed(self.chain(link)):
            at, turned = placed(joint, positions.get(joint.name, joint.reference))
            place, turn = place + turn @ at, turn @ turned
        return place, turn

    def chain(self, link: str) -> list[Joint]:
        """Joints between a link and its root, the nearest first."""
        above, joints = self.above, []
        while link in above:
            joints.append(above[link])
            link = above[link].parent
        return joints


def robot_of(path: Path, name: str, links: Iterable[Link], joints: Iterable[Joint], notes: Iterable[str] = ()) -> Robot:
    """A robot, its names unique and its joints a tree."""
    links_by_name, named, above = dict[str, Link](), dict[str, Joint](), dict[str, Joint]()
    for link in links:
        if links_by_name.setdefault(link.name, link) is not link:
            raise InputError(f"{path}:{link.line}: link {quoted(link.name)} is there twice")
    for joint in joints:
        if named.setdefault(joint.name, joint) is not joint:
            raise InputError(f"{path}:{joint.line}: joint {quoted(joint.name)} is there twice")
    for joint in named.values():
        for end in (joint.parent, joint.child):
            if end not in links_by_name:
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
    return Robot(str(path), name, links_by_name, named, tuple(notes))


def placed(joint: Joint, position: float) -> tuple[Array, Array]:
    """Place and turn of a joint's child in the frame of its parent."""
    travel = position - joint.reference
    if joint.kind == "prismatic":
        return joint.place + joint.turn @ joint.axis * travel, joint.turn
    if not joint.turns:
        return joint.place, joint.turn
    turned = joint.turn @ about(joint.axis, travel)
    return joint.place + joint.turn @ joint.anchor - turned @ joint.anchor, turned


def about(axis: Array, angle: float) -> Array:
    """Rotation matrix about an axis by an angle, by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def read_description(path: Path) -> Robot:
    """Links and joints of a file, URDF or MJCF by its root element."""
    root = plain_tree(path)
    if root.tag not in ("mujoco", "robot"):
        raise root.fault("is no robot; expected <robot> of URDF or <mujoco> of MJCF")
    return mjcf_of(root) if root.tag == "mujoco" else urdf_of(root)


def plain_tree(path: Path) -> Node:
    """Root element of a file that is no xacro: macros are worked out before by its own program."""
    root = read_tree(path)
    if path.suffix == ".xacro" or any(node.tag.startswith("xacro:") for node in root.children):
        urdf = path.name.removesuffix(".xacro").removesuffix(".urdf") + ".urdf"
        urdf = f"plain_{urdf}" if urdf == path.name else urdf  # a shell would empty the file before xacro reads it
        text = f"is xacro, of which its program makes URDF; expected URDF: ros2 run xacro xacro {path.name} > {urdf}"
        raise InputError(f"{path}: {text}")
    return root


def _above_zero(node: Node, what: str, value: float, of: str | None = None) -> float:
    """A mass, which may be 0."""
    if not value >= 0.0:
        raise node.fault(f"{what} of {value:g} kg is none; expected 0 or more", of)
    return value


# -- URDF: links with mass and size, and joints.
#
# Lengths in m, angles in rad, roll, pitch and yaw about the fixed axes; inertia about the centre of mass.


def read_urdf(path: Path) -> Robot:
    """Links and joints of a file."""
    root = plain_tree(path)
    if root.tag != "robot":
        raise root.fault("is no URDF; expected <robot>")
    return urdf_of(root)


def urdf_of(root: Node) -> Robot:
    """Links and joints of a root element."""
    links, joints = map(_link, root.all("link")), map(_urdf_joint, root.all("joint"))
    return robot_of(root.path, root.attributes.get("name", ""), list(links), list(joints))


def _link(node: Node) -> Link:
    inertial, of = node.first("inertial"), f"link {quoted(node.name)}"
    radii = tuple(_radii(node))
    if inertial is None:
        shaped = node.first("visual") or node.first("collision")
        lacking = "has a shape and no <inertial>, so that its mass is unknown" if shaped else ""
        return Link(node.name, node.line, radii=radii, lacking=lacking)
    weight, tensor = inertial.first("mass"), inertial.first("inertia")
    if weight is None:
        raise inertial.fault("<inertial> has no <mass>", of)
    mass = _above_zero(weight, "a mass", weight.figure("value"), of)
    centre, turn = _origin(inertial)
    if tensor is None:
        raise inertial.fault("<inertial> has no <inertia>", of)
    xx, yy, zz = (tensor.figure(f"i{a}{a}") for a in "xyz")
    xy, xz, yz = (tensor.figure(f"i{a}", 0.0) for a in ("xy", "xz", "yz"))
    if min(xx, yy, zz) < 0.0:
        raise tensor.fault("an inertia below 0 is none", of)
    inertia = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
    return Link(node.name, node.line, mass, centre, inertia, radii)


def _radii(link: Node) -> list[tuple[float, Array]]:
    """Radii of cylinders about their axis z and of spheres; collision shapes before visual ones."""
    radii = []
    for part in (*link.all("collision"), *link.all("visual")):
        shape = part.first("geometry")
        for kind in ("cylinder", "sphere") if shape else ():
            if shape and (node := shape.first(kind)) is not None:
                radius = node.figure("radius")
                if not radius > 0.0:
                    raise node.fault(f"a radius of {radius:g} m is none; expected more than 0", "")
                radii.append((radius, _origin(part)[1][:, 2] if kind == "cylinder" else np.zeros(3)))
    return radii


def _urdf_joint(node: Node) -> Joint:
    (place, turn), of = _origin(node), f"joint {quoted(node.name)}"
    ends = [end.attributes.get("link", "") if (end := node.first(what)) else "" for what in ("parent", "child")]
    kind, limit = node.attributes.get("type", ""), node.first("limit")
    along = None if kind == "fixed" else node.first("axis")  # a fixed joint has none, whatever its file says
    axis = along.vector("xyz", (1.0, 0.0, 0.0)) if along else np.array([1.0, 0.0, 0.0])
    effort, velocity, lower, upper = (
        limit.figure(what, math.nan) if limit else math.nan for what in ("effort", "velocity", "lower", "upper")
    )
    losses, follows = node.first("dynamics"), node.first("mimic")
    damping, friction = (losses.figure(what, 0.0) if losses else 0.0 for what in ("damping", "friction"))
    if min(damping, friction) < 0.0:
        raise node.fault("damping or friction below 0 is none", of)
    return Joint(
        node.name, kind, node.line, ends[0], ends[1], place, turn, _direction(node, axis, of),
        effort, velocity, lower, upper, limit is not None, damping=damping, friction=friction,
        mimic=follows.attributes.get("joint", "") or "?" if follows else "",
        factor=follows.figure("multiplier", 1.0) if follows else 1.0,
        offset=follows.figure("offset", 0.0) if follows else 0.0,
    )  # fmt: skip


def _direction(node: Node, axis: Array, of: str) -> Array:
    """An axis, of length 1."""
    length = float(np.linalg.norm(axis))
    if not length > 0.0:
        raise node.fault("an axis of length 0 has no direction", of)
    return axis / length


def _origin(node: Node) -> tuple[Array, Array]:
    """Place and turn of an element's frame."""
    origin = node.first("origin")
    if origin is None:
        return np.zeros(3), np.eye(3)
    return origin.vector("xyz"), rotation(origin.vector("rpy"))


def rotation(rpy: Array) -> Array:
    """Rotation matrix of roll, pitch and yaw [rad] about fixed axes."""
    x, y, z = (about(axis, float(angle)) for axis, angle in zip(np.eye(3), rpy, strict=True))
    return z @ y @ x


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
_ORIENTATIONS = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}  # numbers of each


@dataclass(slots=True)
class Settings:
    """Compiler settings and, by class and element, the attributes that an element has where it gives none."""

    degrees: float = math.pi / 180.0  # factor of angles to rad
    sequence: str = "xyz"
    autolimits: bool = True
    from_geoms: str = "auto"
    classes: dict[str, dict[str, dict[str, str]]] = field(default_factory=lambda: {"main": {}})

    def whole(self, node: Node, childclass: str) -> Node:
        """An element with the attributes of its class added."""
        class_name = node.attributes.get("class", childclass)
        if class_name not in self.classes:
            raise node.fault(f"there is no default class {quoted(class_name)}{nearest(class_name, self.classes)}", "")
        attributes = {**self.classes[class_name].get(node.tag, {}), **node.attributes}
        return Node(node.tag, node.path, node.line, attributes, node.children)


def settings_of(root: Node) -> Settings:
    """Settings and classes of a file."""
    settings = Settings()
    for node in root.all("compiler"):
        for name, value in node.attributes.items():
            neutral = name in _NEUTRAL and value.split() == _NEUTRAL[name].split()
            if not neutral and name not in _HARMLESS:
                raise node.fault(f"{name}={quoted(value)} is not read; expected masses and joints as they are written")
        _setting(node, "coordinate", "local")
        settings.degrees = 1.0 if _setting(node, "angle", "degree", "radian") == "radian" else math.pi / 180.0
        settings.autolimits = _setting(node, "autolimits", "true", "false") == "true"
        settings.from_geoms = _setting(node, "inertiafromgeom", "auto", "true", "false")
        settings.sequence = node.attributes.get("eulerseq", "xyz")
        if len(settings.sequence) != 3 or set(settings.sequence.lower()) - set("xyz"):
            raise node.fault(f"eulerseq: {quoted(settings.sequence)}; expected three of x, y, z")
    for node in root.all("default"):
        _add_class(node, settings, {}, "main")
    return settings


def _setting(node: Node, name: str, *values: str) -> str:
    """Value of a setting; the first where it is not given."""
    value = node.attributes.get(name, values[0])
    if value not in values:
        raise node.fault(f"{name}: {quoted(value)}; expected {' or '.join(values)}")
    return value


def _add_class(node: Node, settings: Settings, inherited: dict[str, dict[str, str]], otherwise: str) -> None:
    """Attributes of a class and of those in it."""
    name = node.attributes.get("class", otherwise)
    if not name:
        raise node.fault("has no class")
    attributes = {tag: dict(inherited.get(tag, {})) for tag in _CLASSED}
    for tag in _CLASSED:
        for element in node.all(tag):
            attributes[tag].update(element.attributes)
    settings.classes[name] = attributes
    for inner in node.all("default"):
        _add_class(inner, settings, attributes, "")


def frame_of(node: Node, settings: Settings) -> tuple[Array, Array]:
    """Place and turn of an element in the frame of its parent."""
    orientations = [name for name in _ORIENTATIONS if name in node.attributes]
    if len(orientations) > 1:
        raise node.fault(f"has {' and '.join(orientations)}; expected one orientation")
    place = node.vector("pos")
    if not orientations:
        return place, np.eye(3)
    (kind,) = orientations
    values, count, written = node.figures(kind), _ORIENTATIONS[kind], quoted(node.attributes[kind])
    if len(values) != count:
        raise node.fault(f"{kind}: {written}; expected {count} numbers")
    turned = _turned(kind, values, settings)
    if not np.isfinite(turned).all():
        raise node.fault(f"{kind}: {written} has no direction")
    return place, turned


def _turned(kind: str, values: Array, settings: Settings) -> Array:
    """Rotation matrix of an orientation; NaN of one without a direction."""
    if kind == "euler":  # turns about axes that move along (lower case) or stay (upper case)
        turned = np.eye(3)
        for angle, axis in zip(values * settings.degrees, settings.sequence, strict=True):
            turn = about(np.eye(3)["xyz".index(axis.lower())], float(angle))
            turned = turned @ turn if axis.islower() else turn @ turned
        return turned
    with np.errstate(all="ignore"):
        if kind == "quat":
            w, v = values[0] / np.linalg.norm(values), values[1:] / np.linalg.norm(values)
            cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
            return np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross
        if kind == "axisangle":
            return about(values[:3] / np.linalg.norm(values[:3]), float(values[3]) * settings.degrees)
        if kind == "zaxis":
            return _least_turn(values / np.linalg.norm(values))
        x = values[:3] / np.linalg.norm(values[:3])
        y = values[3:] - x * float(x @ values[3:])
        y = y / np.linalg.norm(y)
        return np.stack([x, y, np.cross(x, y)], axis=1)


def _least_turn(z: Array) -> Array:
    """The smallest turn that brings the axis z to a direction."""
    axis, cosine = np.cross([0.0, 0.0, 1.0], z), float(z[2])
    sine = float(np.linalg.norm(axis))
    if np.isfinite(sine) and sine < 1e-10:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    return about(axis / sine, math.atan2(sine, cosine))


def _scalar(node: Node, name: str) -> float:
    """One number of an attribute; laws of several coefficients are refused."""
    if len(node.attributes.get(name, "0").split()) != 1:
        raise node.fault(f"{name}: {quoted(node.attributes[name])} is not read; expected one number")
    return node.figure(name, 0.0)


# -- Mass of a body of an MJCF file: its inertial, or its solids by mass or density; of a mesh it stays unknown.


_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_FLAT = ("plane", "hfield")  # without volume
_WATER = 1000.0  # kg/m^3, the density of MJCF where none is given
_NONE = Body(0.0, np.zeros(3), np.zeros((3, 3)))


def mass_of(node: Node, settings: Settings, childclass: str) -> tuple[Body, str]:
    """Mass of one body without those that hang on it, and what is lacking of it."""
    inertial = node.first("inertial")
    if settings.from_geoms != "true" and inertial is not None:
        return _inertial(inertial, settings), ""
    solids: list[Body] = []
    for geom in node.all("geom") if settings.from_geoms != "false" else ():
        whole = settings.whole(geom, childclass)
        attributes = whole.attributes
        light = whole.figure("mass", 1.0) == 0.0 or ("mass" not in attributes and whole.figure("density", 1.0) == 0.0)
        if attributes.get("type", "sphere") in _FLAT or light:
            continue
        kind = attributes.get("type", "mesh" if "mesh" in attributes else "sphere")
        if kind not in _SIZES or "mesh" in attributes:
            return _NONE, f"has a {kind} of unknown mass on line {geom.line}; expected <inertial>"
        solids.append(_solid(whole, kind, settings))
    return together(solids) if solids else _NONE, ""


def _inertial(node: Node, settings: Settings) -> Body:
    """Figures of the element as written."""
    mass, (centre, turn) = node.figure("mass"), frame_of(node, settings)
    if "pos" not in node.attributes:
        raise node.fault("has no pos")
    _above_zero(node, "a mass", mass, "<inertial>")
    full, principal = node.figures("fullinertia"), node.figures("diaginertia")
    if (len(full), len(principal)) not in ((6, 0), (0, 3)):
        raise node.fault("expected diaginertia of 3 numbers, or fullinertia of 6", "<inertial>")
    inertia: Array = turn @ np.diag(principal) @ turn.T if len(principal) else full[[0, 3, 4, 3, 1, 5, 4, 5, 2]]
    inertia = inertia.reshape(3, 3)
    if inertia.diagonal().min() < 0.0:
        raise node.fault("an inertia below 0 is none", "<inertial>")
    return Body(mass, centre, inertia)


def _solid(geom: Node, kind: str, settings: Settings) -> Body:
    """A geom by its size and mass, or density."""
    if geom.attributes.get("shellinertia", "false") != "false":
        raise geom.fault("shellinertia is not read; expected solids")
    size = geom.figures("size").tolist()
    centre, turn = frame_of(geom, settings)
    if "fromto" in geom.attributes:  # the ends of its axis
        if kind not in ("capsule", "cylinder"):
            raise geom.fault(f"fromto of a {kind} is not read; expected pos and size")
        ends, text = geom.figures("fromto"), f"fromto: {quoted(geom.attributes['fromto'])}"
        if len(ends) != 6:
            raise geom.fault(f"{text}; expected 6 numbers")
        along = ends[:3] - ends[3:]
        length = float(np.linalg.norm(along))
        if not length > 0.0:
            raise geom.fault(f"{text} has no length")
        centre, turn, size = (ends[:3] + ends[3:]) / 2.0, _least_turn(along / length), [*size[:1], length / 2.0]
    size = size[: _SIZES[kind]]
    if len(size) != _SIZES[kind] or not min(size) > 0.0:
        written = quoted(geom.attributes.get("size", ""))
        raise geom.fault(f"size: {written}; expected {_SIZES[kind]} numbers above 0 of a {kind}")
    volume, radii = shape_of(kind, size)
    mass = geom.figure("mass", geom.figure("density", _WATER) * volume)
    _above_zero(geom, "a mass", mass, "<geom>")
    return Body(mass, centre, mass * turn @ np.diag(radii) @ turn.T)


# -- MJCF: bodies as links and their joints, without MuJoCo.
#
# Read are bodies with joints that turn or slide, their inertials, or their solids with mass or density, classes of
# defaults and the compiler's settings. What changes masses or joints in another manner is refused: files that are
# included, equalities, tendons, ball joints. A free joint of a body of the world is held: the base is
# fixed.


WORLD = "world"
_ON_TOP = frozenset({
    "compiler", "default", "option", "worldbody",  # read
    "actuator", "asset", "contact", "custom", "keyframe", "sensor", "size", "statistic", "visual",  # of no mass
})  # fmt: skip
_IN_BODIES = frozenset({"body", "camera", "freejoint", "geom", "inertial", "joint", "light", "site"})
_KINDS = {"hinge": "revolute", "slide": "prismatic"}


def mjcf_of(root: Node) -> Robot:
    """Links and joints of a root element."""
    for node in root.children:
        if node.tag not in _ON_TOP and (node.children or node.tag not in ("equality", "tendon")):
            raise node.fault("is not read; expected a description without it")
    reader = _Reader(settings_of(root), [Link(WORLD, root.line)])
    for node in root.all("option"):
        for name in ("density", "viscosity"):
            if node.figure(name, 0.0) != 0.0:
                raise node.fault(f"{name}: a fluid is not read; expected 0")
    for world in root.all("worldbody"):
        reader.bodies(world, WORLD, world.attributes.get("childclass", "main"))
    if not reader.joints:
        raise root.fault("has no bodies; expected <worldbody> with <body>")
    return robot_of(root.path, root.attributes.get("model", ""), reader.links, reader.joints, reader.notes)


@dataclass(slots=True)
class _Reader:
    """Links and joints of an MJCF file, in its order."""

    settings: Settings
    links: list[Link]
    joints: list[Joint] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def bodies(self, parent: Node, above: str, childclass: str) -> None:
        """Bodies of a body or the world, and all beyond them."""
        for node in parent.children:
            if node.tag not in _IN_BODIES:
                raise node.fault("is not read; expected bodies with joints, geoms and inertials")
        for node in parent.all("body"):
            name, own_class = node.name, node.attributes.get("childclass", childclass)
            if node.attributes.get("mocap", "false") != "false":
                raise node.fault("mocap is not read; expected a body that its joints carry")
            mass, lacking = mass_of(node, self.settings, own_class)
            self.links.append(Link(name, node.line, *mass, lacking=lacking, gravcomp=_scalar(node, "gravcomp")))
            self._hang(node, above, name, own_class)
            self.bodies(node, name, own_class)

    def _hang(self, node: Node, above: str, name: str, childclass: str) -> None:
        """Joints between a body and its parent, with the attributes of their classes; a free one of a base is held."""
        moving = []
        for element in node.children:
            whole = self.settings.whole(element, childclass) if element.tag == "joint" else element
            if element.tag == "freejoint" or (element.tag == "joint" and whole.attributes.get("type") == "free"):
                if above != WORLD:
                    raise element.fault("a free joint belongs to a body of the world", "")
                self.notes.append(f"body {quoted(name)} is free in the description; held here")
            elif element.tag == "joint":
                moving.append(whole)
        place, turn = frame_of(node, self.settings)
        if not moving:
            up = np.array([0.0, 0.0, 1.0])
            self.joints.append(Joint(f"{name} (fixed)", "fixed", node.line, above, name, place, turn, up))
        for element in moving:
            child = name if element is moving[-1] else f"{name} (behind {element.name})"
            if child != name:
                self.links.append(Link(child, element.line))
            self.joints.append(_mjcf_joint(element, above, child, (place, turn), self.settings))
            above, place, turn = child, np.zeros(3), np.eye(3)


def _mjcf_joint(node: Node, parent: str, child: str, frame: tuple[Array, Array], settings: Settings) -> Joint:
    """One that turns or slides."""
    of, written = f"joint {quoted(node.name)}", node.attributes.get("type", "hinge")
    if written not in _KINDS:
        raise InputError(f"{node.path}:{node.line}: {of} is {quoted(written)}; expected hinge or slide")
    if node.figures("springdamper").any():
        raise node.fault("springdamper is not read; expected stiffness and damping, as it compiles to", of)
    axis = _direction(node, node.vector("axis", (0.0, 0.0, 1.0)), of)
    factor = settings.degrees if written == "hinge" else 1.0
    lower, upper = (value * factor for value in _range(node, settings))
    keys = ("damping", "frictionloss", "armature", "stiffness")
    damping, friction, armature, stiffness = (_scalar(node, key) for key in keys)
    if min(damping, friction, armature, stiffness) < 0.0:
        raise node.fault(f"{', '.join(keys[:-1])} or {keys[-1]} below 0 is none", of)
    limited, effort = not math.isnan(lower), node.figures("actuatorfrcrange")
    return Joint(
        node.name, "continuous" if written == "hinge" and not limited else _KINDS[written], node.line, parent, child,
        *frame, axis, float(np.abs(effort).min()) if len(effort) else math.nan, math.nan, lower, upper, limited,
        anchor=node.vector("pos"), reference=node.figure("ref", 0.0) * factor,
        damping=damping, friction=friction, armature=armature, stiffness=stiffness,
        slack=_scalar(node, "springref") * factor,
        gravity_on_drive=node.attributes.get("actuatorgravcomp", "false") == "true",
    )  # fmt: skip


def _range(node: Node, settings: Settings) -> tuple[float, float]:
    """Limits as written; NaN of a joint without."""
    limited, ends = node.attributes.get("limited", "auto"), node.figures("range")
    if len(ends) not in (0, 2) or (len(ends) == 2 and not ends[0] <= ends[1]):
        raise node.fault(f"range: {quoted(node.attributes['range'])}; expected its two ends, the lower first")
    if limited not in ("auto", "true", "false"):
        raise node.fault(f"limited: {quoted(limited)}; expected true, false or auto")
    if limited == "false" or not len(ends):
        return math.nan, math.nan
    if limited == "auto" and not settings.autolimits:
        raise node.fault("has a range and no limited; expected limited, as autolimits is false")
    return float(ends[0]), float(ends[1])
