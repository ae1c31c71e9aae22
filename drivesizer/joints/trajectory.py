"""Joints that move and joints that are held; their trajectory within limits, recorded or between waypoints."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.files.sheets import CsvFile, path_from_spec
from drivesizer.joints.inverse_dynamics import Array, JointMotion
from drivesizer.loads.motions import LAWS
from drivesizer.physics.load_cycle import places
from drivesizer.physics.motion_curves import fastest_ramp, periodic_parabola
from drivesizer.platform import trajectory as curves
from drivesizer.spec.description import Joint, Robot
from drivesizer.spec.robot_section import JointFigure, JointLimits, RobotSection
from drivesizer.units import RANGES

# -- Joints that a machine moves and those that it holds, out of a description.


Field = tuple[str | int, ...]
_SLACK = 1e-6  # of a limit, by which rounding may leave it
_ROTARY = ("angle", "rotary_speed", "angular_acceleration", "angular_jerk")


def joint_of(robot: Robot, name: str, field: Field) -> Joint:
    """A joint that is moved."""
    joint = robot.joints.get(name)
    if joint is None:
        raise FieldError(field, f"{quoted(name)} is no joint of {robot.file}{nearest(name, robot.joints)}")
    where = f"joint {quoted(name)} ({robot.file}:{joint.line})"
    if not joint.moves:
        raise FieldError(field, f"{where} is {quoted(joint.kind)}; expected one that turns or slides")
    if joint.mimic:
        raise FieldError(field, f"{where} follows {quoted(joint.mimic)}; expected a joint with a drive of its own")
    if joint.kind != "continuous" and not joint.lower <= joint.upper:
        raise FieldError(field, f"{where} has no limits of position; expected lower and upper")
    return joint


def figure_of(figure: JointFigure, joint: Joint, field: Field) -> float:
    """SI value of a figure of a joint."""
    if (figure.kind in _ROTARY) != joint.turns:
        words = "a figure of a joint that turns" if figure.kind in _ROTARY else "a figure of a joint that slides"
        verb = "turns" if joint.turns else "slides"
        raise FieldError(
            field, f"{words}, and {quoted(joint.name)} {verb}; expected e.g. {'10 deg' if joint.turns else '10 mm'}"
        )
    return figure.value


def check_link(robot: Robot, link: str, field: Field) -> None:
    """Refuse a link that there is not."""
    if link not in robot.links:
        raise FieldError(field, f"{quoted(link)} is no link of {robot.file}{nearest(link, robot.links)}")


def unit_of(joint: Joint) -> str:
    """SI unit of a joint's position."""
    return "rad" if joint.turns else "m"


def within(joint: Joint, position: float) -> bool:
    """Whether a position is inside the limits of a joint, up to rounding."""
    if joint.kind == "continuous" or not joint.lower <= joint.upper:
        return True
    slack = _SLACK * max(abs(joint.lower), abs(joint.upper))
    return joint.lower - slack <= position <= joint.upper + slack


def fixed_positions(section: RobotSection, robot: Robot, moving: Collection[str]) -> dict[str, float]:
    """Positions of all joints that do not move."""
    for name in section.held:
        if name in moving:
            raise FieldError(("robot", "held", name), f"{quoted(name)} is moved by the trajectory; leave it out")
        joint_of(robot, name, ("robot", "held", name))
    others = {name: joint for name, joint in robot.joints.items() if name not in moving and joint.kind != "fixed"}
    positions = {name: _fixed_position(section, robot, joint) for name, joint in others.items() if not joint.mimic}
    for joint in others.values():
        if joint.mimic:
            position = positions.get(joint.mimic, math.nan)
            if math.isnan(position) or robot.joints[joint.mimic].mimic:
                where = f"{robot.file}:{joint.line}: joint {quoted(joint.name)} follows {quoted(joint.mimic)}"
                raise InputError(f"{where}; expected it to follow a joint that is held, or none")
            positions[joint.name] = joint.factor * position + joint.offset
    return positions


def _fixed_position(section: RobotSection, robot: Robot, joint: Joint) -> float:
    """Position of a joint that is held."""
    where = f"{robot.file}:{joint.line}: joint {quoted(joint.name)}"
    if not joint.moves:
        raise InputError(f"{where} is {quoted(joint.kind)}; expected joints that are fixed, turn or slide")
    figure, field = section.held.get(joint.name), ("robot", "held", joint.name)
    position = 0.0 if figure is None else figure_of(figure, joint, field)
    if not within(joint, position):
        unit = unit_of(joint)
        place = f"{position:.4g} {unit}; expected {joint.lower:.4g} to {joint.upper:.4g} {unit}, its limits"
        raise FieldError(
            field, f"joint {quoted(joint.name)} ({robot.file}:{joint.line}) does not move and is held at {place}"
        )
    return position


# -- A CSV of joint positions over time as a motion: a cubic spline through all samples, or near them with smoothing.
#
# A joint that is at rest at both ends starts and ends so; wherever three of its samples or more in a row are the
# same it stands, and what moves before and after has a spline of its own. One that is not at rest there must repeat:
# it ends where it starts (without limits, also turns further on), and its spline is periodic. Where samples are far
# apart an interval is divided, so that no joint turns by more than 1/32 rad in one piece and its speed is a straight
# line there to 1/1000 of the largest.
#
# As a track of a platform it needs digits enough: values rounded to q, h apart, are off by up to 6 q/h² in
# acceleration.


_TIME = "time"
_FEWEST = 4  # a cubic has four coefficients
_MOST_PIECES = 200_000  # of a trajectory
_SAME = 1e-6  # rad or m, by which joints that end where they start may be off
_TINY = 1e-300  # instead of a largest speed of 0


def motion_in(path: Path, robot: Robot, smoothing: float = 0.0) -> JointMotion:
    """Joints over time as a file has them."""
    sheet = CsvFile(path, 2)
    header = sheet.names
    joints = _joints(path, sheet.line, header, robot)
    form = {_TIME: "time"} | {joint.name: "angle" if joint.turns else "length" for joint in joints}
    factors = sheet.factors(header, form)
    values = sheet.values(header, form, factors)
    time = values[header.index(_TIME)]
    if len(time) < _FEWEST:
        raise InputError(f"{path}: rows: {len(time)} found; expected at least {_FEWEST} below the units")
    position = np.array([values[header.index(joint.name)] for joint in joints])
    if not np.ptp(position, axis=1).any():
        raise InputError(f"{path}: rows: nothing moves; expected a trajectory, or poses as holds")
    quarter = float(time[-1] - time[0]) / _FEWEST
    if not smoothing <= quarter:
        raise InputError(f"{path}: smoothing of {smoothing:g} s is more than {quarter:.4g} s, a quarter of its time")
    if not smoothing:
        step = float(np.median(np.diff(time)))
        gain = np.abs(np.diff(np.diff(position, axis=1) / np.diff(time), axis=1) / step).max(axis=1)
        for joint, row, most in zip(joints, position, gain.tolist(), strict=True):
            factor = factors[header.index(joint.name)]
            curves.refuse_few_digits(f"{path}: {joint.name}", row, factor, step, most, unit_of(joint))
    courses = [_course(path, time, row, joint, smoothing) for row, joint in zip(position, joints, strict=True)]
    return _pieces(path, time, courses, joints)


def _joints(path: Path, line: int, header: Sequence[str], robot: Robot) -> list[Joint]:
    """Joints that the columns name."""
    where = f"{path}:{line}: header"
    names = [name for name in header if name != _TIME]
    if len(set(header)) != len(header):
        raise InputError(f"{where}: {quoted(','.join(header))} has a column twice")
    if len(names) == len(header) or not names:
        example = ",".join([_TIME, *(name for name, joint in robot.joints.items() if joint.moves)])
        raise InputError(f"{where}: {quoted(','.join(header))}; expected time and joints, e.g. {example[:200]}")
    for name in names:
        if name not in robot.joints:
            raise InputError(f"{where}: {quoted(name)} is no joint of {robot.file}{nearest(name, robot.joints)}")
    return [robot.joints[name] for name in names]


# --- the curve

Curve = Callable[[Array, int], Array]  # of times and the order of a derivative


class _Course(NamedTuple):
    """One joint over time: stretches of intervals, each with a curve of its own."""

    edges: tuple[int, ...]  # intervals at which stretches start, and the end
    curves: tuple[Curve, ...]

    def at(self, interval: NDArray[np.int64], time: Array, order: int) -> Array:
        """Values at times within intervals."""
        values = np.empty_like(time)
        for (first, last), curve in zip(pairwise(self.edges), self.curves, strict=True):
            start, end = np.searchsorted(interval, (first, last))
            values[start:end] = curve(time[start:end], order)
        return values


def _course(path: Path, time: Array, row: Array, joint: Joint, smoothing: float) -> _Course:
    """The curve of one joint."""
    knots = curves.thinned(time, smoothing)
    if not any(curves.speed_at_end(time[knots], row[None, knots], end) for end in (0, -1)):
        return _from_rest(time, row, smoothing)
    gap = float(row[-1] - row[0])
    turns = round(gap / (2.0 * np.pi)) * 2.0 * np.pi if joint.kind == "continuous" else 0.0
    if abs(gap - turns) > _SAME:
        raise InputError(
            f"{path}: {joint.name}: moves at its ends, {abs(gap):.4g} {unit_of(joint)} apart; expected "
            "rest at both, or an end as the start, as the cycle repeats"
        )
    return _Course((0, len(time) - 1), (_periodic(time, row, smoothing),))


def _from_rest(time: Array, row: Array, smoothing: float) -> _Course:
    """From rest to rest, and at rest where samples in a row are the same: three, and for longer than the smoothing."""
    resting = np.diff(row) == 0.0
    for first, last in pairwise(curves.edges_of(resting)):
        if last - first < 2 or time[last] - time[first] < smoothing:
            resting[first:last] = False
    edges = tuple(curves.edges_of(resting))
    stretches = [
        _still(float(row[a])) if resting[a] else _rising(time[a : b + 1], row[a : b + 1], smoothing)
        for a, b in pairwise(edges)
    ]
    return _Course(edges, tuple(stretches))


def _still(value: float) -> Curve:
    return lambda at, order: np.full_like(at, 0.0 if order else value)


def _rising(time: Array, row: Array, smoothing: float) -> Curve:
    """A stretch between rests; its ends are at rest but for rounding, which is left out."""
    curve = curves.curve_at_rest(time, row[None], smoothing)

    def at(when: Array, order: int) -> Array:
        values = curve(when, order)[0]
        return np.where((when == time[0]) | (when == time[-1]), 0.0, values) if order == 1 else values

    return at


def _periodic(time: Array, row: Array, smoothing: float) -> Curve:
    """A curve whose speed and acceleration are the same at both ends; a steady advance is left out and added."""
    from scipy.interpolate import CubicSpline

    knots, span, gap = curves.thinned(time, smoothing), time[-1] - time[0], row[-1] - row[0]
    level = row - gap * (time - time[0]) / span
    if len(knots) < len(time):
        level = periodic_parabola(time, level, smoothing)[0]
    level = level[knots]
    level[-1] = level[0]
    through = CubicSpline(time[knots], level, bc_type="periodic")
    steady = (lambda at: gap * (at - time[0]) / span, lambda at: gap / span)
    return lambda at, order: np.asarray(through(at, order)) + (steady[order](at) if order < 2 else 0.0)


def _pieces(path: Path, time: Array, courses: Sequence[_Course], joints: Sequence[Joint]) -> JointMotion:
    """The curves at both ends of pieces that are short enough."""
    step, intervals = np.diff(time), np.arange(len(time) - 1)
    ends = (time[:-1], time[1:])
    speed = np.array([[np.abs(course.at(intervals, t, 1)) for t in ends] for course in courses]).max(axis=1)
    bend = np.array([np.abs(course.at(intervals, time[:-1] + step / 2.0, 3)) for course in courses]) * step**2 / 8.0
    share = (bend / np.maximum(speed.max(axis=1), _TINY)[:, None]).max(axis=0)
    turned = (speed * step * np.array([joint.turns for joint in joints])[:, None]).max(axis=0)
    count = curves.parts_of(share, turned)
    if count.sum() > _MOST_PIECES:
        raise InputError(f"{path}: rows: {len(time)} found; expected a trajectory of at most {_MOST_PIECES} pieces")
    owner, place = places(count)
    starts = time[owner] + step[owner] * (place / count[owner])
    knots = (starts, np.append(starts[1:], time[-1]))
    columns = [
        np.array([[course.at(owner, t, order) for course in courses] for t in knots]).transpose(2, 0, 1)
        for order in range(3)
    ]
    return JointMotion(tuple(joint.name for joint in joints), knots[1] - knots[0], *columns)


# -- Moves of several joints between waypoints, each a straight line in the space of the joints: synchronised.
#
# All joints of a move follow one path variable s from 0 to 1, so that its limits are the least of theirs, d the
# travel of each:
#
# .. math:: \dot s_{max} = \min_j \frac{v_j}{|d_j|}, \quad \ddot s_{max} = \min_j \frac{a_j}{|d_j|}
#
# The fastest move is a trapezoid of speed, or with limits of jerk seven phases. By the polynomial of 5th order,
# :math:`s = 10x^3 - 15x^4 + 6x^5` with :math:`C_v = 15/8` and :math:`C_a = 10/\sqrt 3`, the time is
#
# .. math:: T = \max_j \left( C_v \frac{|d_j|}{v_j}, \sqrt{C_a \frac{|d_j|}{a_j}}, \sqrt[3]{60 \frac{|d_j|}{j_j}}
# \right)
#
# Worked example: 1 rad at 1 rad/s and 2 rad/s²: 0.5 s up, 0.5 s at speed, 0.5 s down; by the polynomial 1.875 s.


_PIECES = 128  # of a move
_ALL = "all"
_C_V, _C_A, _C_J = 15.0 / 8.0, 10.0 / math.sqrt(3.0), 60.0


def moves_of(section: RobotSection, robot: Robot) -> JointMotion:
    """Joints over time through the waypoints of a section."""
    assert section.waypoints is not None
    joints, stops = _stops(section, robot)
    if not joints:
        raise FieldError(
            ("robot", "waypoints"), "no joint moves; expected its positions, e.g. {positions: {elbow: 90 deg}}"
        )
    limits = _limits(section, robot, joints)
    motions: list[JointMotion] = []
    names = tuple(joint.name for joint in joints)
    pauses = [waypoint.pause for waypoint in section.waypoints]
    for number, stop in enumerate(stops):
        if number and (stop != stops[number - 1]).any():
            motions.append(_along(names, stops[number - 1], stop, limits, section.law))
        if pauses[number]:
            still = np.zeros((1, 2, len(names)))
            motions.append(JointMotion(names, np.array([pauses[number]]), still + stop, still, still))
    if not any(motion.speed.any() for motion in motions):
        raise FieldError(("robot", "waypoints"), "nothing moves; expected waypoints at different positions")
    columns = ("duration", "position", "speed", "acceleration")
    return JointMotion(names, *(np.concatenate([getattr(motion, name) for motion in motions]) for name in columns))


def _stops(section: RobotSection, robot: Robot) -> tuple[list[Joint], Array]:
    """Joints that waypoints name, in the order of the description, and their positions, shape (waypoints, joints)."""
    assert section.waypoints is not None
    named: dict[str, Field] = {}
    for number, waypoint in enumerate(section.waypoints):
        for name in waypoint.positions:
            named.setdefault(name, ("robot", "waypoints", number, "positions", name))
    moving = {name: joint_of(robot, name, field) for name, field in named.items()}
    joints = [joint for name, joint in robot.joints.items() if name in moving]
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
            figure = waypoint.positions.get(joint.name)
            field: Field = ("robot", "waypoints", number, "positions", joint.name)
            stops[number, column] = stops[number - 1, column] if figure is None else figure_of(figure, joint, field)
    return joints, stops


def _limits(section: RobotSection, robot: Robot, joints: Sequence[Joint]) -> list[Array]:
    """Speed, acceleration and jerk of each joint: its own, those of all, the description's; jerk may be infinite."""
    for name in section.limits:
        if name != _ALL:
            joint_of(robot, name, ("robot", "limits", name))
    columns = []
    for what in ("speed", "acceleration", "jerk"):
        values = []
        for joint in joints:
            value = {"speed": joint.velocity, "acceleration": math.nan, "jerk": math.inf}[what]
            for name in (joint.name, _ALL):
                figure = getattr(section.limits.get(name, JointLimits()), what)
                if figure is not None:
                    value = figure_of(figure, joint, ("robot", "limits", name, what))
                    break
            if not value > 0.0:
                unit = unit_of(joint) + ("/s" if what == "speed" else "/s^2")
                message = f"joint {quoted(joint.name)} has no limit of {what}; expected {what} here, e.g. 2 {unit}"
                raise FieldError(("robot", "limits"), message)
            values.append(value)
        columns.append(np.array(values))
    return columns


def _along(names: tuple[str, ...], start: Array, end: Array, limits: Sequence[Array], law: str) -> JointMotion:
    """A move of all joints from one waypoint to the next."""
    distance = end - start
    size = np.abs(distance)
    with np.errstate(divide="ignore"):
        speed, acceleration, jerk = (float((limit / size).min()) for limit in limits)
        longest = max(1.0 / speed, math.sqrt(1.0 / acceleration), math.cbrt(1.0 / jerk))
    if not longest < RANGES["time"][1]:
        raise FieldError(("robot", "limits"), f"a move takes {longest:.3g} s; expected faster joints")
    if law == "poly5":
        span = max(_C_V / speed, math.sqrt(_C_A / acceleration), math.cbrt(_C_J / jerk))
        x = np.array(list(pairwise(np.linspace(0.0, 1.0, _PIECES + 1))))
        s, (v, a) = x**3 * (10.0 - 15.0 * x + 6.0 * x**2), LAWS["poly5"].at(x)
        duration, v, a = np.full(_PIECES, span / _PIECES), v / span, a / span**2
    else:
        times = fastest_ramp(1.0, speed, acceleration, jerk)
        bend, level, cruise = times
        total = bend + level + bend + cruise + bend + level + bend
        duration, s, v, a = curves.path_coordinate(times, lambda time, *_: max(1, math.ceil(_PIECES * time / total)))
    return JointMotion(names, duration, start + s[:, :, None] * distance, *(c[:, :, None] * distance for c in (v, a)))


# -- Trajectory of a robot section, inside the limits of its joints.


def motion_of(section: RobotSection, robot: Robot, spec_file: str) -> JointMotion:
    """Joints over time, their limits kept."""
    field = ("robot", "waypoints" if section.trajectory is None else "trajectory")
    if section.trajectory is None:
        motion = moves_of(section, robot)
    else:
        path = path_from_spec(spec_file, section.trajectory, field, "a CSV file", "moves.csv")
        motion = motion_in(path, robot, section.smoothing)
    for column, name in enumerate(motion.joints):
        _inside(motion, column, joint_of(robot, name, field), robot, field)
    return motion


def _inside(motion: JointMotion, column: int, joint: Joint, robot: Robot, field: Field) -> None:
    """Refuse positions and speeds outside the limits of a joint."""
    position, speed = motion.position[:, :, column].ravel(), np.abs(motion.speed[:, :, column].ravel())
    unit, name = unit_of(joint), f"joint {quoted(joint.name)}"
    whose = f"its limits in {robot.file}:{joint.line}"
    for value in (position.max(), position.min()):
        if not within(joint, float(value)):
            fault = f"{name} is at {value:.4g} {unit} after {_when(motion, position == value):.4g} s"
            raise FieldError(field, f"{fault}; expected {joint.lower:.4g} to {joint.upper:.4g} {unit}, {whose}")
    top = float(speed.max())
    if joint.velocity > 0.0 and top > joint.velocity * (1.0 + _SLACK):
        fault = f"{name} has {top:.4g} {unit}/s after {_when(motion, speed == top):.4g} s"
        raise FieldError(field, f"{fault}; expected at most {joint.velocity:.4g} {unit}/s, {whose}")


def _when(motion: JointMotion, there: Array) -> float:
    """First time at which something holds [s]."""
    return float(motion.time.ravel()[int(np.argmax(there))])


def static_poses(
    section: RobotSection, robot: Robot, motion: JointMotion
) -> Iterator[tuple[str, float | None, JointMotion]]:
    """Poses that the drives hold: name, payload [kg] where it is another, and one segment at rest."""
    for number, hold in enumerate(section.holds):
        position = motion.position[0, 0].copy()
        for name, figure in hold.positions.items():
            field: Field = ("robot", "holds", number, "positions", name)
            joint = joint_of(robot, name, field)
            if name not in motion.joints:
                raise FieldError(
                    field, f"{quoted(name)} is held at one position throughout; expected it in the trajectory"
                )
            position[motion.joints.index(name)] = figure_of(figure, joint, field)
        still = np.zeros((1, 2, len(position)))
        pose = JointMotion(motion.joints, np.array([hold.time]), still + position, still, still)
        for column, name in enumerate(motion.joints):
            _inside(pose, column, robot.joints[name], robot, ("robot", "holds", number))
        yield hold.name, hold.payload, pose
