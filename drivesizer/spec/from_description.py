"""A first spec from a robot description: a vehicle by its wheels, an arm by one joint, a machine of all joints.

Wheels are continuous joints with a limit whose link has a cylinder about the joint's axis, or a sphere. Any other URDF
is taken as an arm that one revolute joint swings, all joints beyond it at 0:

.. math:: m = \\sum m_n, \\qquad J = \\sum \\left( a^T I_n a + m_n |a \\times (r_n - p)|^2 \\right)

a axis and p place of the joint, r_n centre of mass and I_n inertia of each link that it carries. What a description
lacks (times of the motion, friction, supply) is marked in the text.
"""

from __future__ import annotations

import math
import os
import re
from importlib import resources
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.spec.description import Joint, Robot, plain_tree, read_description, read_urdf, urdf_of

Array = NDArray[np.float64]
_ALIKE = 0.01  # share by which wheels that are driven alike may differ
_PARALLEL = 0.99  # of the axes of a wheel and of its cylinder
_CENTRED = 1e-5  # m, of a centre of mass that lies on the axis
_MOST_REACH = 20.0  # s of motion of a joint without limits
_SWING, _STROKE = math.pi / 4, 0.1  # rad and m, either way at most, of a joint of a machine
_PLAIN = re.compile(r"[^\W_][\w .-]{0,59}")  # names that need no quotes and name an axis
_MASSES = "                  # assumed: of the links; with_drives where they hold the drives already"


def _filled(template: str, **texts: object) -> str:
    """A spec out of ``templates``; figures with six digits."""
    text = (resources.files("drivesizer.spec") / "templates" / f"{template}.yaml").read_text(encoding="utf-8")
    return text.format(**{n: f"{value:.6g}" if isinstance(value, float) else value for n, value in texts.items()})


# -- One axis


def spec_of(path: Path, joint: str | None = None) -> str:
    """The text of a robot.yaml."""
    robot = read_urdf(path)
    wheels = [] if joint is not None else _wheels(robot)
    return _vehicle(robot, wheels) if wheels else _arm(robot, _arm_joint(robot, joint))


def has_wheels(path: Path) -> bool:
    """Whether a file is a URDF with driven wheels."""
    root = plain_tree(path)
    return root.tag == "robot" and bool(_wheels(urdf_of(root)))


def _wheels(robot: Robot) -> list[tuple[Joint, float]]:
    """Driven joints with the radius of what they turn [m]."""
    wheels = []
    for joint in robot.joints.values():
        if joint.kind == "continuous" and joint.limited:
            radii = (radius for radius, axis in robot.links[joint.child].radii
                     if not axis.any() or abs(float(axis @ joint.axis)) >= _PARALLEL)  # fmt: skip
            if (radius := next(radii, 0.0)) > 0.0:
                wheels.append((joint, radius))
    return wheels


def _limits(robot: Robot, joint: Joint) -> tuple[float, float]:
    """Effort and velocity of a joint."""
    for name in ("effort", "velocity"):
        value = getattr(joint, name)
        if not value > 0.0:
            text = "has no" if math.isnan(value) else f"has {value:g} as"
            raise InputError(
                f"{robot.file}:{joint.line}: joint {quoted(joint.name)} {text} limit of {name}; expected more than 0"
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
    return _filled(
        "vehicle", name=_name(robot), file=quoted(Path(robot.file).name)[1:-1], mass=float(mass), wheels=len(wheels),
        diameter=2.0 * radii[0], inertia=inertia, speed=min(speeds) * radii[0], effort=min(efforts),
        turning=min(speeds), joints=quoted(", ".join(joint.name for joint in joints))[1:-1],
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
        if not joint.turns:
            raise InputError(f"--joint: {quoted(name)} is {quoted(joint.kind)}; expected revolute or continuous")
        return joint
    turning = [joint for joint in robot.joints.values() if joint.turns]
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
    return _filled(
        "arm" if load.lever > _CENTRED else "table",  # a balanced load has no torque of gravity
        name=_name(robot), file=quoted(Path(robot.file).name)[1:-1], joint=quoted(joint.name)[1:-1], mass=load.mass,
        length=load.lever, inertia=load.inertia, tilt=f"{math.degrees(load.tilt):.9g}", speed=velocity,
        ramp=span / 2, cruise=span / 2, effort=effort,
    )  # fmt: skip


class Carried(NamedTuple):
    """Mass properties of all that a joint carries, the joints beyond it at 0."""

    mass: float  # kg
    lever: float  # m, from the joint's axis to the centre of mass
    inertia: float  # kg*m^2, about the joint's axis
    tilt: float  # rad, of the joint's axis from level, in the frame of the root


def carried(robot: Robot, joint: Joint) -> Carried:
    """Mass, lever, inertia and tilt of the links that a joint moves."""
    place, turn = robot.frame(joint.child, {})
    axis = turn @ joint.axis
    mass, moment, inertia = 0.0, np.zeros(3), 0.0
    for name in robot.outwards(joint.child):
        link, (position, turned) = robot.links[name], robot.frame(name, {})
        arm = position + turned @ link.centre - place
        off = np.cross(axis, arm)
        mass, moment = mass + link.mass, moment + link.mass * arm
        inertia += float(axis @ turned @ link.inertia @ turned.T @ axis) + link.mass * float(off @ off)
    lever = float(np.linalg.norm(np.cross(axis, moment))) / mass if mass > 0.0 else 0.0
    return Carried(mass, lever, inertia, abs(math.asin(min(1.0, max(-1.0, float(axis[2]))))))


def _name(robot: Robot) -> str:
    """The name as a quoted YAML text; a blank stands for what a spec refuses because it cannot be seen."""
    seen = (_printable(name).strip() for name in (robot.name, Path(robot.file).stem))
    return quoted(next(filter(None, seen), "robot"), 200)


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text).replace("\\", "/").replace('"', "'")


# -- A machine: every joint that moves is an axis


def joints_to_drive(path: Path) -> int:
    """Number of joints of a description that move by themselves."""
    return sum(joint.moves and not joint.mimic for joint in read_description(path).joints.values())


def machine_of(path: Path, folder: Path, masses: str = "") -> str:
    """The text of a machine.yaml whose axes are the joints of a description."""
    robot = read_description(path)
    joints = [joint for joint in robot.joints.values() if joint.moves and not joint.mimic]
    if not joints:
        raise InputError(f"{path}: no joint moves; expected revolute, continuous or prismatic ones with limits")
    for joint in joints:
        if not _PLAIN.fullmatch(joint.name):
            text = f"joint {quoted(joint.name)} names no axis; expected letters and digits, e.g. elbow"
            raise InputError(f"{path}:{joint.line}: {text}")
    turns, further = joints[0].turns, ""
    accelerations = {True: "5 rad/s^2", False: "2 m/s^2"}
    for joint in joints:  # limits that the description or the line for all does not give
        limits = [] if joint.velocity > 0.0 else [f"speed: {'2 rad/s' if joint.turns else '0.2 m/s'}"]
        limits += [f"acceleration: {accelerations[joint.turns]}"] if joint.turns != turns else []
        further += f"    {_quoted(joint.name)}: {{{', '.join(limits)}}}    # assumed\n" if limits else ""
    sliding = [f"    {_quoted(joint.name)}: {{travel_per_turn: 10 mm}}    # assumed: lead of its screw\n"
               for joint in joints if not joint.turns]  # fmt: skip
    here, there = (", ".join(f"{_quoted(joint.name)}: {_position(joint, side)}" for joint in joints)
                   for side in (-1, 1))  # fmt: skip
    return _filled(
        "machine", masses=masses or "without", assumed="" if masses else _MASSES, file=quoted(path.name)[1:-1],
        name=_quoted(robot.name or path.stem), last=_quoted(joints[-1].child), here=here, there=there,
        description=_quoted(os.path.relpath(path, folder)), acceleration=accelerations[turns],
        further=further + "".join(["  drives:\n", *sliding] if sliding else []), joint=joints[0].name,
    )  # fmt: skip


def _position(joint: Joint, side: int) -> str:
    """A quarter of a joint's range from the middle, to one side."""
    most = _SWING if joint.turns else _STROKE
    bounded = joint.limited and math.isfinite(joint.lower) and joint.upper > joint.lower
    middle, reach = ((joint.lower + joint.upper) / 2, (joint.upper - joint.lower) / 4) if bounded else (0.0, most)
    value = middle + side * min(reach, most)
    return f"{math.degrees(value):.4g} deg" if joint.turns else f"{1e3 * value:.4g} mm"


def _quoted(text: str) -> str:
    """A name as YAML text, in quotes where it needs them."""
    name = _printable(text)
    plain = re.fullmatch(r"[A-Za-z][\w-]*", name) and name.lower() not in ("true", "false", "null")
    return name if plain else f'"{name}"'
