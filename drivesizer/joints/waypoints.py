r"""Moves of several joints between waypoints, each a straight line in the space of the joints: synchronised.

All joints of a move follow one path variable s from 0 to 1, so that its limits are the least of theirs, d the travel
of each:

.. math:: \dot s_{max} = \min_j \frac{v_j}{|d_j|}, \quad \ddot s_{max} = \min_j \frac{a_j}{|d_j|}

The fastest move is a trapezoid of speed, or with limits of jerk seven phases. By the polynomial of 5th order,
:math:`s = 10x^3 - 15x^4 + 6x^5` with :math:`C_v = 15/8` and :math:`C_a = 10/\sqrt 3`, the time is

.. math:: T = \max_j \left( C_v \frac{|d_j|}{v_j}, \sqrt{C_a \frac{|d_j|}{a_j}}, \sqrt[3]{60 \frac{|d_j|}{j_j}} \right)

Worked example: 1 rad at 1 rad/s and 2 rad/s²: 0.5 s up, 0.5 s at speed, 0.5 s down; by the polynomial 1.875 s.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drivesizer.errors import FieldError, quoted
from drivesizer.joints.moving import Field, figure_of, joint_of, unit_of
from drivesizer.joints.record import Array, JointMotion
from drivesizer.physics.motion_curves import fastest_ramp
from drivesizer.spec.description.record import Joint, Robot
from drivesizer.spec.robot_section import JointLimits, RobotSection
from drivesizer.units.ranges import RANGES

__all__ = ["Path", "moves_of"]

_PIECES = 128  # of a move
_ALL = "all"
_C_V, _C_A, _C_J = 15.0 / 8.0, 10.0 / math.sqrt(3.0), 60.0


class Path(NamedTuple):
    """The path variable over a move: time, itself and its derivatives at both ends of each segment."""

    duration: Array  # s, shape (segments,)
    s: Array  # shape (segments, 2)
    speed: Array  # 1/s
    acceleration: Array  # 1/s^2


class _Limits(NamedTuple):
    speed: Array
    acceleration: Array
    jerk: Array  # infinite without a limit


def moves_of(section: RobotSection, robot: Robot) -> JointMotion:
    """Joints over time through the waypoints of a section."""
    assert section.waypoints is not None
    joints, stops = _stops(section, robot)
    if not joints:
        raise FieldError(
            ("robot", "waypoints"), "no joint moves; expected its positions, e.g. {positions: {elbow: 90 deg}}"
        )
    limits = _limits(section, robot, joints)
    made: list[JointMotion] = []
    names = tuple(joint.name for joint in joints)
    pauses = [waypoint.pause for waypoint in section.waypoints]
    for number, stop in enumerate(stops):
        if number and (stop != stops[number - 1]).any():
            made.append(_along(names, stops[number - 1], stop, limits, section.law))
        if pauses[number]:
            made.append(_rest(names, stop, pauses[number]))
    if not any(one.speed.any() for one in made):
        raise FieldError(("robot", "waypoints"), "nothing moves; expected waypoints at different positions")
    return JointMotion(names, *(np.concatenate(c) for c in zip(*(_columns(one) for one in made), strict=True)))


def _columns(one: JointMotion) -> tuple[Array, Array, Array, Array]:
    return one.duration, one.position, one.speed, one.acceleration


def _stops(section: RobotSection, robot: Robot) -> tuple[list[Joint], Array]:
    """Joints that waypoints name, in the order of the description, and their positions, shape (waypoints, joints)."""
    assert section.waypoints is not None
    named: dict[str, Field] = {}
    for number, waypoint in enumerate(section.waypoints):
        for name in waypoint.positions:
            named.setdefault(name, ("robot", "waypoints", number, "positions", name))
    found = {name: joint_of(robot, name, field) for name, field in named.items()}
    joints = [joint for name, joint in robot.joints.items() if name in found]
    first = section.waypoints[0].positions
    for joint in joints:
        if joint.name not in first:
            raise FieldError(
                ("robot", "waypoints", 0, "positions"),
                f"joint {quoted(joint.name)} moves later; expected its position here too",
            )
    stops = np.zeros((len(section.waypoints), len(joints)))
    for number, waypoint in enumerate(section.waypoints):
        for column, joint in enumerate(joints):
            given = waypoint.positions.get(joint.name)
            field: Field = ("robot", "waypoints", number, "positions", joint.name)
            stops[number, column] = stops[number - 1, column] if given is None else figure_of(given, joint, field)
    return joints, stops


def _limits(section: RobotSection, robot: Robot, joints: Sequence[Joint]) -> _Limits:
    for name in section.limits:
        if name != _ALL:
            joint_of(robot, name, ("robot", "limits", name))
    rows = [_limits_of(section, joint) for joint in joints]
    return _Limits(*(np.array(column) for column in zip(*rows, strict=True)))


def _limits_of(section: RobotSection, joint: Joint) -> tuple[float, float, float]:
    """Speed, acceleration and jerk of one joint: its own, those of all, those of the description."""
    found: list[float] = []
    for what, otherwise in (("speed", joint.velocity), ("acceleration", math.nan), ("jerk", math.inf)):
        value = otherwise
        for name in (joint.name, _ALL):
            given = getattr(section.limits.get(name, JointLimits()), what)
            if given is not None:
                value = figure_of(given, joint, ("robot", "limits", name, what))
                break
        if not value > 0.0:
            unit = unit_of(joint) + ("/s" if what == "speed" else "/s^2")
            message = f"joint {quoted(joint.name)} has no limit of {what}; expected {what} here, e.g. 2 {unit}"
            raise FieldError(("robot", "limits"), message)
        found.append(value)
    return found[0], found[1], found[2]


def _rest(names: tuple[str, ...], stop: Array, pause: float) -> JointMotion:
    still = np.zeros((1, 2, len(names)))
    return JointMotion(names, np.array([pause]), still + stop, still, still)


def _along(names: tuple[str, ...], start: Array, end: Array, limits: _Limits, law: str) -> JointMotion:
    """A move of all joints from one waypoint to the next."""
    distance = end - start
    size = np.abs(distance)
    with np.errstate(divide="ignore"):
        speed, acceleration, jerk = (float((limit / size).min()) for limit in limits)
        longest = max(1.0 / speed, math.sqrt(1.0 / acceleration), math.cbrt(1.0 / jerk))
    if not longest < RANGES["time"][1]:
        raise FieldError(("robot", "limits"), f"a move takes {longest:.3g} s; expected faster joints")
    path = _poly5(speed, acceleration, jerk) if law == "poly5" else _fastest(speed, acceleration, jerk)
    s, v, a = (c[:, :, None] * distance for c in path[1:])
    return JointMotion(names, path.duration, start + s, v, a)


def _poly5(speed: float, acceleration: float, jerk: float) -> Path:
    span = max(_C_V / speed, math.sqrt(_C_A / acceleration), math.cbrt(_C_J / jerk))
    x = np.array(list(pairwise(np.linspace(0.0, 1.0, _PIECES + 1))))
    s = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    v, a = 30.0 * x**2 * (1.0 - x) ** 2, 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x)
    return Path(np.full(_PIECES, span / _PIECES), s, v / span, a / span**2)


def _fastest(speed: float, acceleration: float, jerk: float) -> Path:
    """The fastest way from 0 to 1 under limits of the path variable."""
    phases = list(_phases(speed, acceleration, jerk))
    total = sum(time for time, _, _ in phases)
    rows: list[tuple[float, Array, Array, Array]] = []
    s = v = 0.0
    for time, a, j in phases:
        count = max(1, math.ceil(_PIECES * time / total))
        t = np.array(list(pairwise(np.linspace(0.0, time, count + 1))))
        rows += zip(
            np.full(count, time / count), s + v * t + a * t**2 / 2.0 + j * t**3 / 6.0, v + a * t + j * t**2 / 2.0,
            a + j * t, strict=True,
        )  # fmt: skip
        s, v = s + v * time + a * time**2 / 2.0 + j * time**3 / 6.0, v + a * time + j * time**2 / 2.0
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    columns[2][0, 0] = columns[2][-1, 1] = 0.0  # not what rounding makes of it
    return Path(columns[0], columns[1], columns[2], columns[3])


def _phases(speed: float, acceleration: float, jerk: float) -> Iterator[tuple[float, float, float]]:
    """Duration, acceleration at its start and jerk of each phase that lasts."""
    if math.isinf(jerk):
        up = min(speed / acceleration, 1.0 / math.sqrt(acceleration))
        top = acceleration * up
        made = [(up, acceleration, 0.0), (1.0 / top - up, 0.0, 0.0), (up, -acceleration, 0.0)]
    else:
        bend, level, cruise = fastest_ramp(1.0, speed, acceleration, jerk)
        a = jerk * bend
        up_ = [(bend, 0.0, jerk), (level, a, 0.0), (bend, a, -jerk)]
        down = [(bend, 0.0, -jerk), (level, -a, 0.0), (bend, -a, jerk)]
        made = [*up_, (cruise, 0.0, 0.0), *down]
    total = sum(time for time, _, _ in made)
    return (phase for phase in made if phase[0] > 1e-9 * total)
