"""A first spec from a robot description: a vehicle by its wheels, an arm by one joint, a machine of all joints."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.spec.description import read_description, read_urdf, urdf_of
from drivesizer.spec.description_record import Joint, Link, Robot, read_tree

__all__ = ["carried", "has_wheels", "joints_to_drive", "machine_of", "spec_of"]


# -- A first spec from a URDF: a vehicle by its wheels, or an arm by one joint.
#
# Wheels are continuous joints with a limit whose link has a cylinder about the joint's axis, or a sphere. Any other
# machine is taken as an arm that one revolute joint swings, all joints beyond it at 0:
#
# .. math:: m = \sum m_n, \qquad J = \sum \left( a^T I_n a + m_n |a \times (r_n - p)|^2 \right)
#
# a axis and p place of the joint, r_n centre of mass and I_n inertia of each link that it carries. What a URDF lacks
# (times of the motion, friction, supply) is marked in the text.


Array = NDArray[np.float64]
_ALIKE = 0.01  # share by which wheels that are driven alike may differ
_PARALLEL = 0.99  # of the axes of a wheel and of its cylinder
_CENTRED = 1e-5  # m, of a centre of mass that lies on the axis
_MOST_REACH = 20.0  # s of motion of a joint without limits


class Carried(NamedTuple):
    """Mass properties of all that a joint carries, the joints beyond it at 0."""

    mass: float  # kg
    lever: float  # m, from the joint's axis to the centre of mass
    inertia: float  # kg*m^2, about the joint's axis
    tilt: float  # rad, of the joint's axis from level, in the frame of the root


def spec_of(path: Path, joint: str | None = None) -> str:
    """The text of a robot.yaml."""
    robot = read_urdf(path)
    wheels = [] if joint is not None else _wheels(robot)
    if wheels:
        return _vehicle(robot, wheels)
    return _arm(robot, _arm_joint(robot, joint))


def has_wheels(path: Path) -> bool:
    """Whether a file is a URDF with driven wheels."""
    root = read_tree(path)
    return root.tag == "robot" and bool(_wheels(urdf_of(root, path)))


def _wheels(robot: Robot) -> list[tuple[Joint, float]]:
    """Driven joints with the radius of what they turn [m]."""
    return [
        (joint, radius)
        for joint in robot.joints.values()
        if joint.kind == "continuous" and joint.limited and (radius := _radius(robot.links[joint.child], joint)) > 0.0
    ]


def _radius(link: Link, joint: Joint) -> float:
    for radius, axis in link.radii:
        if not axis.any() or abs(float(axis @ joint.axis)) >= _PARALLEL:
            return radius
    return 0.0


def _limits(robot: Robot, joint: Joint) -> tuple[float, float]:
    """Effort and velocity of a joint."""
    for name in ("effort", "velocity"):
        value = getattr(joint, name)
        if not value > 0.0:
            found = "has no" if math.isnan(value) else f"has {value:g} as"
            raise InputError(
                f"{robot.file}:{joint.line}: joint {quoted(joint.name)} {found} limit of {name}; expected more than 0"
            )
    return joint.effort, joint.velocity


def _vehicle(robot: Robot, wheels: list[tuple[Joint, float]]) -> str:
    joints, radii = [joint for joint, _ in wheels], [radius for _, radius in wheels]
    if max(radii) - min(radii) > _ALIKE * max(radii):
        sizes = ", ".join(f"{joint.name} {radius:g} m" for joint, radius in wheels)
        raise InputError(f"{robot.file}: driven wheels of one size are expected, found radii {sizes}"[:300])
    efforts, speeds = zip(*(_limits(robot, joint) for joint in joints), strict=True)
    mass = sum(link.mass for link in robot.links.values())
    inertia = max(carried(robot, joint).inertia for joint in joints)
    for what, value, unit in (("mass", mass, "kg"), ("inertia of a wheel", inertia, "kg·m²")):
        if not value > 0.0:
            raise InputError(f"{robot.file}: the {what} is 0 {unit}; expected <inertial> with more")
    speed = min(speeds) * radii[0]
    return _VEHICLE.format(
        name=_name(robot), file=_yaml(Path(robot.file).name), mass=_shown(mass), wheels=len(wheels),
        diameter=_shown(2.0 * radii[0]), inertia=_shown(inertia), speed=_shown(speed), effort=_shown(min(efforts)),
        turning=_shown(min(speeds)), joints=_yaml(", ".join(joint.name for joint in joints)),
    )  # fmt: skip


def _arm_joint(robot: Robot, name: str | None) -> Joint:
    """The joint of the arm."""
    if name is not None:
        if name not in robot.joints:
            raise InputError(
                f"--joint: {quoted(name)} is not in {robot.file}; "
                f"expected {', '.join(robot.joints) or 'none'}{nearest(name, robot.joints)}"
            )
        joint = robot.joints[name]
        if joint.kind not in ("revolute", "continuous"):
            raise InputError(f"--joint: {quoted(name)} is {quoted(joint.kind)}; expected revolute or continuous")
        return joint
    turning = [joint for joint in robot.joints.values() if joint.kind in ("revolute", "continuous")]
    if not turning:
        raise InputError(f"{robot.file}: no joint turns; expected wheels or a revolute joint with a <limit>")
    if len(turning) > 1:
        names = ", ".join(joint.name for joint in turning[:8])
        raise InputError(
            f"{robot.file}: {len(turning)} joints turn and none is a driven wheel; name one with --joint: {names}"
        )
    return turning[0]


def _arm(robot: Robot, joint: Joint) -> str:
    effort, velocity = _limits(robot, joint)
    load = carried(robot, joint)
    if not (load.mass > 0.0 and load.inertia > 0.0):
        raise InputError(f"{robot.file}:{joint.line}: joint {quoted(joint.name)} carries no mass")
    reach = joint.upper - joint.lower
    span = min(reach / velocity, _MOST_REACH) if reach > 0.0 else _MOST_REACH / 4
    text = _ARM if load.lever > _CENTRED else _TABLE
    return text.format(
        name=_name(robot), file=_yaml(Path(robot.file).name), joint=_yaml(joint.name), mass=_shown(load.mass),
        length=_shown(load.lever), inertia=_shown(load.inertia), tilt=f"{math.degrees(load.tilt):.9g}",
        speed=_shown(velocity), ramp=_shown(span / 2), cruise=_shown(span / 2), effort=_shown(effort),
    )  # fmt: skip


def carried(robot: Robot, joint: Joint) -> Carried:
    """Mass, lever, inertia and tilt of the links that a joint moves."""
    places = _places(robot)
    place, turn = places[joint.child]
    axis = turn @ joint.axis
    mass, moment, inertia = 0.0, np.zeros(3), 0.0
    for name in _beyond(robot, joint.child):
        link, (position, turned) = robot.links[name], places[name]
        arm = position + turned @ link.centre - place
        off = np.cross(axis, arm)
        mass, moment = mass + link.mass, moment + link.mass * arm
        inertia += float(axis @ turned @ link.inertia @ turned.T @ axis) + link.mass * float(off @ off)
    lever = float(np.linalg.norm(np.cross(axis, moment))) / mass if mass > 0.0 else 0.0
    return Carried(mass, lever, inertia, abs(math.asin(min(1.0, max(-1.0, float(axis[2]))))))


def _places(robot: Robot) -> dict[str, tuple[Array, Array]]:
    """Place and turn of every link in the frame of its root."""
    above = {joint.child: joint for joint in robot.joints.values()}
    found: dict[str, tuple[Array, Array]] = {
        name: (np.zeros(3), np.eye(3)) for name in robot.links if name not in above
    }
    for name in above:
        chain, link = [], name
        while link not in found:
            chain.append(above[link])
            link = above[link].parent
        for joint in reversed(chain):
            place, turn = found[joint.parent]
            found[joint.child] = place + turn @ joint.place, turn @ joint.turn
    return found


def _beyond(robot: Robot, name: str) -> list[str]:
    """A link and all links beyond it."""
    found = [name]
    for link in found:
        found += [joint.child for joint in robot.joints.values() if joint.parent == link]
    return found


# --- as text


def _shown(value: float) -> str:
    return f"{value:.6g}"


def _yaml(text: str) -> str:
    """A user's name inside a comment: on one line and printable."""
    return quoted(text)[1:-1]


def _name(robot: Robot) -> str:
    """The name as a quoted YAML text; a blank stands for what a spec refuses because it cannot be seen."""
    names = (robot.name, Path(robot.file).stem)
    seen = ("".join(c if c.isprintable() else " " for c in name).strip() for name in names)
    return quoted(next(filter(None, seen), "robot").replace("\\", "/").replace('"', "'"), 200)


_HEAD = """# Made of {file} by drivesizer; what a URDF does not say is marked "not in the URDF".
# Every quantity carries its unit. Then: drivesizer size robot.yaml

name: {name}

"""
_TAIL = """
transmission:
  - kind: gearhead                 # searched; or kind: direct, any motor without a gearhead

supply:
  nominal: 24 V                    # not in the URDF

select:
  catalogs: [maxon]
  objective: mass
"""
_VEHICLE = (
    _HEAD
    + """load:
  kind: wheeled_vehicle
  mass: {mass} kg                  # all links; the payload is not in the URDF
  driven_wheels: {wheels}          # {joints}
  wheel_diameter: {diameter} m
  rolling_resistance: 0.015        # not in the URDF
  inertia: {inertia} kg*m^2        # of one wheel about its joint, the largest

motion:
  profile: trapezoid
  speed: {speed} m/s               # the velocity limit of the joints, {turning} rad/s, at the wheel's radius
  acceleration_time: 1 s           # not in the URDF; its effort limit is {effort} N*m a wheel
  cruise_time: 20 s                # not in the URDF
  rest_time: 5 s                   # not in the URDF
"""
    + _TAIL
)
_TURNING = """
motion:
  profile: trapezoid
  speed: {speed} rad/s             # the velocity limit of the joint
  acceleration_time: {ramp} s      # not in the URDF; its effort limit is {effort} N*m
  cruise_time: {cruise} s          # so that the joint goes from end to end, where it has ends
  rest_time: 1 s                   # not in the URDF
  there_and_back: true
"""
_ARM = (
    _HEAD
    + """load:
  kind: arm
  mass: {mass} kg                  # all links that joint {joint} carries; a payload is not in the URDF
  length: {length} m               # from the axis to their centre of mass
  inertia: {inertia} kg*m^2        # about the axis, the joints beyond it at 0
  start_angle: 0 deg               # not in the URDF: above the level line, when the cycle starts
  tilt: {tilt} deg                 # of the axis from level
  friction_torque: 0 N*m           # not in the URDF
"""
    + _TURNING
    + _TAIL
)
_TABLE = (  # a balanced load has no torque of gravity
    _HEAD
    + """load:
  kind: rotary_table
  inertia: {inertia} kg*m^2        # of all links that joint {joint} carries, about its axis, the joints beyond it at 0
  friction_torque: 0 N*m           # not in the URDF
"""
    + _TURNING
    + _TAIL
)


# -- A first machine.yaml from a robot description: every joint that moves is an axis.
#
# What a description lacks (trajectory, accelerations, payload, supply) is filled in and marked in the text.


_SWING = math.pi / 4  # rad, either way at most
_STROKE = 0.1  # m
_MASSES = "                  # assumed: of the links; with_drives where they hold the drives already"
_PLAIN = re.compile(r"[^\W_][\w .-]{0,59}")  # names that need no quotes and name an axis

_TEXT = """# Made of {file} by drivesizer: every joint that moves is an axis, the outer drives load of the inner ones.
# What the description does not say is marked "assumed". Needs: pip install "drivesizer[robot]"

name: {name}

robot:
  description: {description}
  masses: {masses}{assumed}
  # payload: {{mass: 1 kg, link: {last}}}
  waypoints:                       # assumed: or trajectory: moves.csv, columns time and joints by name
    - positions: {{{here}}}
      pause: 0.5 s
    - positions: {{{there}}}
      pause: 0.5 s
    - positions: {{{here}}}
  limits:
    all: {{acceleration: {acceleration}}}    # assumed
{further}
supply:
  nominal: 48 V                    # assumed
  current: 20 A
  accepts: all                     # a battery, or a brake resistor

select:
  catalogs: [maxon]
  objective: mass
{axes}"""


def joints_to_drive(path: Path) -> int:
    """Number of joints of a description that move by themselves."""
    return len(_driven(read_description(path)))


def machine_of(path: Path, folder: Path, masses: str = "") -> str:
    """The text of a machine.yaml whose axes are the joints of a description."""
    robot = read_description(path)
    joints = _driven(robot)
    if not joints:
        raise InputError(f"{path}: no joint moves; expected revolute, continuous or prismatic ones with limits")
    for joint in joints:
        if not _PLAIN.fullmatch(joint.name):
            text = f"joint {quoted(joint.name)} names no axis; expected letters and digits, e.g. elbow"
            raise InputError(f"{path}:{joint.line}: {text}")
    sliding = [joint.name for joint in joints if not joint.turns]
    acceleration = "5 rad/s^2" if joints[0].turns else "2 m/s^2"
    return _TEXT.format(
        masses=masses or "without", assumed="" if masses else _MASSES, file=quoted(path.name)[1:-1],
        name=_quoted(robot.name or path.stem), last=_quoted(joints[-1].child),
        description=_quoted(os.path.relpath(path, folder)), here=_positions(joints, -1), there=_positions(joints, 1),
        acceleration=acceleration, further=_limit_lines(joints, turns=joints[0].turns) + _drives(sliding),
        axes=f"\n# axes:                          # what a joint needs beside its motion\n"
             f"#   {joints[0].name}: {{needs: {{hold_unpowered: true}}}}\n",
    )  # fmt: skip


def _driven(robot: Robot) -> list[Joint]:
    return [joint for joint in robot.joints.values() if joint.moves and not joint.mimic]


def _positions(joints: list[Joint], side: int) -> str:
    """A waypoint: each joint a quarter of its range from the middle, to one side."""
    return ", ".join(f"{_quoted(joint.name)}: {_position(joint, side)}" for joint in joints)


def _position(joint: Joint, side: int) -> str:
    most = _SWING if joint.turns else _STROKE
    bounded = joint.limited and math.isfinite(joint.lower) and joint.upper > joint.lower
    middle, reach = ((joint.lower + joint.upper) / 2, (joint.upper - joint.lower) / 4) if bounded else (0.0, most)
    value = middle + side * min(reach, most)
    return f"{math.degrees(value):.4g} deg" if joint.turns else f"{1e3 * value:.4g} mm"


def _limit_lines(joints: list[Joint], *, turns: bool) -> str:
    """Limits of joints that the description or the line for all does not give."""
    lines = []
    for joint in joints:
        found = [] if joint.velocity > 0.0 else [f"speed: {'2 rad/s' if joint.turns else '0.2 m/s'}"]
        if joint.turns != turns:
            found.append(f"acceleration: {'5 rad/s^2' if joint.turns else '2 m/s^2'}")
        if found:
            lines.append(f"    {_quoted(joint.name)}: {{{', '.join(found)}}}    # assumed\n")
    return "".join(lines)


def _drives(sliding: list[str]) -> str:
    """Travel per turn of joints that slide."""
    if not sliding:
        return ""
    lines = [f"    {_quoted(name)}: {{travel_per_turn: 10 mm}}    # assumed: lead of its screw\n" for name in sliding]
    return "  drives:\n" + "".join(lines)


def _quoted(text: str) -> str:
    """A name as YAML text, in quotes where it needs them."""
    shown = "".join(c if c.isprintable() else " " for c in text).replace("\\", "/").replace('"', "'")
    plain = re.fullmatch(r"[A-Za-z][\w-]*", shown) and shown.lower() not in ("true", "false", "null")
    return shown if plain else f'"{shown}"'
