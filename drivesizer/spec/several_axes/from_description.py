"""A first machine.yaml from a robot description: every joint that moves is an axis.

What a description lacks (trajectory, accelerations, payload, supply) is filled in and marked in the text.
"""

from __future__ import annotations

import math
import os
import re
from pathlib import Path

from drivesizer.errors import InputError, quoted
from drivesizer.spec.description import read_description
from drivesizer.spec.description.record import Joint, Robot

__all__ = ["joints_to_drive", "machine_of"]

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
        acceleration=acceleration, further=_limits(joints, turns=joints[0].turns) + _drives(sliding),
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


def _limits(joints: list[Joint], *, turns: bool) -> str:
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
