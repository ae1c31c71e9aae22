r"""From waypoints to a trajectory: straight in the posture from one to the next, as fast as all limits allow.

Between two waypoints place and heading change together, in proportion to one path coordinate s from 0 to 1, from rest
to rest; the limits of driving and of turning both become limits of s, and the tighter ones count. Without a limit of
jerk the speed is a trapezoid, else an S-curve of seven phases. Where the next leg goes on in the same direction of
x, y and heading, the platform does not stop between.

Headings. A waypoint with one is reached with it, and the platform turns evenly on the leg; one without is reached
looking along the leg: the platform turns on the spot, through the smaller angle, then drives forwards, which is what a
differential drive can do. Headings are taken as they are: from 0 to 540 deg it turns one and a half times, from
170 deg to -170 deg back by 340 deg. Only after a waypoint without a heading is the smaller angle taken to one with it.

Pieces. Wheel speeds and torques are taken as straight between the ends of pieces. A phase without jerk or turning is
one piece, and exact. Others fall into 32 pieces or more, none of which turns by more than 1/32 rad: a straight line
h apart is off by :math:`h^2/8` of the second derivative, so speeds and torques are off by less than 1/1000 of the
largest in their leg.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.physics.motion_curves import fastest_ramp
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.trajectory import Trajectory, joined, rest

__all__ = ["Limits", "Waypoint", "plan"]

_PIECES = 32  # of a phase with jerk or turning, and of a radian
_SAME = 1e-9  # m, rad: postures closer than this are one; also of the directions of legs, of length 1
_ROUNDING = 1e-12  # of a leg's time: a shorter cruise is none
_LARGEST = 1e9  # of any figure, in SI
_MOST_PIECES = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a platform's motion; without jerk its speed is a trapezoid, without turning it keeps its heading."""

    speed: float  # m/s
    acceleration: float  # m/s^2
    jerk: float | None = None  # m/s^3
    turning_speed: float | None = None  # rad/s
    turning_acceleration: float | None = None  # rad/s^2
    turning_jerk: float | None = None  # rad/s^3; None: turning has no limit of jerk of its own

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if value is not None and not 0.0 < value < _LARGEST:  # written so that NaN fails too
                raise InputError(f"limits: {f.name} must be a number above 0 and below {_LARGEST:g}, got {value!r}")
        turning = (self.turning_speed, self.turning_acceleration)
        if (None in turning and turning != (None, None)) or (self.turning_jerk and None in turning):
            raise InputError("limits: turning takes both turning_speed and turning_acceleration; give both or no limit")


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """Posture at which the platform stands for a moment, or for a pause."""

    x: float  # m
    y: float  # m
    heading: float | None = None  # rad; None looks along the leg to it, at the first one along the leg from it
    pause: float = 0.0  # s, standing

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if value is not None and not abs(value) < _LARGEST:
                raise InputError(f"waypoint: {f.name} must be a number below {_LARGEST:g}, got {value!r}")
        if self.pause < 0.0:
            raise InputError(f"waypoint: pause must be 0 or more, got {self.pause!r}")


class _Stop(NamedTuple):
    posture: Array  # (3,) m, m, rad
    pause: float  # s
    number: int  # of the waypoint, from 1


class _Phase(NamedTuple):
    """Of the path coordinate: time [s], acceleration at both ends [1/s^2], pieces."""

    time: float
    start: float
    end: float
    pieces: int


def plan(waypoints: Sequence[Waypoint], limits: Limits) -> Trajectory:
    """The fastest trajectory through waypoints within limits.

    Parameters
    ----------
    waypoints
        Two or more; two in one place turn on the spot or pause.
    limits
        Of driving and turning. On a leg that does both, the tighter one of each kind.

    Returns
    -------
    Trajectory
        From rest to rest, its pauses included.

    Raises
    ------
    InputError
        When nothing moves, or a leg turns and no limit of turning is given.

    Examples
    --------
    One metre at 1 m/s and 2 m/s² takes 1/1 + 1/2 s; a quarter turn first, at 3 rad/s², 2 √(π/2 / 3) s:

    >>> limits = Limits(speed=1.0, acceleration=2.0, turning_speed=3.0, turning_acceleration=3.0)
    >>> plan([Waypoint(x=0.0, y=0.0, heading=0.0), Waypoint(x=0.0, y=1.0)], limits).total
    2.947202509
    """
    stops = _joined(_stops(waypoints))
    if len(stops) < 2:
        raise InputError(f"waypoints: {len(waypoints)} given and nothing moves; expected two postures that differ")
    parts, pieces = _pause_at(stops[0]), 0
    for before, stop in pairwise(stops):
        leg = _leg(before, stop, limits)
        parts += [leg, *_pause_at(stop)]
        pieces += len(leg.duration)
        if pieces > _MOST_PIECES:
            raise InputError(
                f"waypoints: the path turns for too long, over {_MOST_PIECES} pieces; expected fewer turns"
            )
    return joined(parts)


def _pause_at(stop: _Stop) -> list[Trajectory]:
    return [rest(stop.posture, stop.pause)] if stop.pause > 0.0 else []


# --- where it stops ---------------------------------------------------------------------------------------------------


def _stops(waypoints: Sequence[Waypoint]) -> list[_Stop]:
    """Stops of the platform, turns on the spot among them; one in the place of the one before adds to it."""
    found: list[_Stop] = []
    for number, w in enumerate(waypoints, 1):
        heading = _first_heading(waypoints) if number == 1 else _next_heading(waypoints, number, found[-1].posture)
        if found and w.heading is None:
            x, y, _ = found[-1].posture
            _reach(found, _Stop(np.array([x, y, heading]), 0.0, number))
        _reach(found, _Stop(np.array([w.x, w.y, heading]), w.pause, number))
    return found


def _reach(found: list[_Stop], stop: _Stop) -> None:
    if found and np.abs(stop.posture - found[-1].posture).max() <= _SAME:
        found[-1] = found[-1]._replace(pause=found[-1].pause + stop.pause)
    else:
        found.append(stop)


def _first_heading(waypoints: Sequence[Waypoint]) -> float:
    first = waypoints[0]
    if first.heading is not None:
        return first.heading
    away = (w for w in waypoints if math.hypot(w.x - first.x, w.y - first.y) > _SAME)
    there = next(away, None)
    return math.atan2(there.y - first.y, there.x - first.x) if there else 0.0


def _next_heading(waypoints: Sequence[Waypoint], number: int, here: Array) -> float:
    """The heading at a waypoint, counted on from the present one."""
    before, w = waypoints[number - 2], waypoints[number - 1]
    if w.heading is not None and before.heading is not None:
        return float(here[2]) + (w.heading - before.heading)
    dx, dy = w.x - float(here[0]), w.y - float(here[1])
    if w.heading is None and math.hypot(dx, dy) <= _SAME:
        return float(here[2])
    turn = math.remainder((math.atan2(dy, dx) if w.heading is None else w.heading) - float(here[2]), math.tau)
    return float(here[2]) + (turn if abs(turn) > _SAME else 0.0)


def _joined(stops: list[_Stop]) -> list[_Stop]:
    """The stops without those that the path goes straight through, place and heading alike."""
    kept = stops[:1]
    for stop, after in zip(stops[1:], [*stops[2:], None], strict=False):
        if after is None or stop.pause > 0.0 or not _straight(kept[-1].posture, stop.posture, after.posture):
            kept.append(stop)
    return kept


def _straight(a: Array, b: Array, c: Array) -> bool:
    there, on = b - a, c - b
    return bool(np.abs(there / np.linalg.norm(there) - on / np.linalg.norm(on)).max() <= _SAME)


# --- how it gets from one to the next ---------------------------------------------------------------------------------


def _leg(before: _Stop, stop: _Stop, limits: Limits) -> Trajectory:
    """From rest to rest, straight in the posture."""
    change = stop.posture - before.posture
    turn = abs(float(change[2]))
    if turn > 0.0 and limits.turning_speed is None:
        degrees = f"{math.degrees(float(change[2])):.4g} deg"
        raise InputError(
            f"waypoint {stop.number}: the leg to it turns by {degrees}; expected limits of turning_speed and "
            "turning_acceleration"
        )
    phases = _phases(float(np.hypot(change[0], change[1])), turn, limits, stop.number)
    duration, s, v, a = _coordinate(phases)
    posture = before.posture[:, None, None] + change[:, None, None] * s
    posture[:, 0, 0], posture[:, -1, 1] = before.posture, stop.posture
    velocity, acceleration = (change[:, None, None] * c + 0.0 for c in (v, a))  # no zero with a minus
    return Trajectory(duration, posture, velocity, acceleration)


def _phases(distance: float, turn: float, limits: Limits, number: int) -> list[_Phase]:
    """Of the path coordinate, up to the end of the cruise; what follows is the mirror image."""
    speed = _tightest((limits.speed, distance), (limits.turning_speed, turn))
    most = _tightest((limits.acceleration, distance), (limits.turning_acceleration, turn))
    jerk = _tightest((limits.jerk, distance), (limits.turning_jerk, turn))
    jerk_time, hold, cruise = _times(speed, most, jerk)
    total = 2.0 * (2.0 * jerk_time + hold) + cruise
    cruise = cruise if cruise > _ROUNDING * total else 0.0
    if not 0.0 < total < _LARGEST or turn * _PIECES > _MOST_PIECES:
        raise InputError(
            f"waypoint {number}: the leg to it takes {total:.3g} s; expected limits that suit the distance"
        )
    speed = 1.0 / (2.0 * jerk_time + hold + cruise)  # from the times, so that the distance is exact
    top = speed / (jerk_time + hold)
    ramp = [(jerk_time, 0.0, top), (hold, top, top), (jerk_time, top, 0.0)]

    def pieces(time: float, even: bool) -> int:
        turned = math.ceil(time * speed * turn * _PIECES)
        return max(1, turned) if even else max(_PIECES, turned)

    rising = [_Phase(t, a, b, pieces(t, a == b and turn == 0.0)) for t, a, b in ramp if t > 0.0]
    return [*rising, _Phase(cruise, 0.0, 0.0, pieces(cruise, True))]


def _tightest(*pairs: tuple[float | None, float]) -> float:
    """The least of limits over sizes; infinite where none counts."""
    return min((limit / size for limit, size in pairs if limit is not None and size > 0.0), default=math.inf)


def _times(speed: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """Times of the fastest motion from 0 to 1 [s]: of each phase of jerk, of even acceleration, of even speed."""
    if jerk < math.inf:
        try:
            return fastest_ramp(1.0, speed, acceleration, jerk)
        except ArithmeticError:
            return 0.0, math.nan, math.nan
    speed = min(speed, math.sqrt(acceleration))
    return 0.0, speed / acceleration, max(1.0 / speed - speed / acceleration, 0.0)


def _coordinate(phases: Sequence[_Phase]) -> tuple[Array, ...]:
    """Duration of the pieces, s, its rate and its acceleration at both ends of each."""
    rising, s, v = [], 0.0, 0.0
    for p in phases[:-1]:
        t = np.linspace(0.0, p.time, p.pieces + 1)
        bend = (p.end - p.start) / p.time
        place = s + t * (v + t * (p.start / 2.0 + t * (bend / 6.0)))
        rate = v + t * (p.start + t * (bend / 2.0))
        rising.append(_ends(p, place, rate, p.start + t * bend))
        s, v = float(place[-1]), float(rate[-1])
    cruise, level = phases[-1], []
    if cruise.time > 0.0:
        along = np.linspace(s, 1.0 - s, cruise.pieces + 1)
        level = [_ends(cruise, along, np.full_like(along, v), np.zeros_like(along))]
    parts = [*rising, *level, *(_mirrored(*p) for p in reversed(rising))]
    return tuple(np.concatenate(c) for c in zip(*parts, strict=True))


def _mirrored(duration: Array, s: Array, v: Array, a: Array) -> tuple[Array, Array, Array, Array]:
    """A part of the acceleration as the mirrored part of the deceleration."""
    return duration[::-1], 1.0 - s[::-1, ::-1], v[::-1, ::-1], -a[::-1, ::-1]


def _ends(phase: _Phase, *columns: Array) -> tuple[Array, Array, Array, Array]:
    """Durations, and columns over points as both ends of pieces."""
    s, v, a = (np.stack([c[:-1], c[1:]], axis=1) for c in columns)
    return np.full(phase.pieces, phase.time / phase.pieces), s, v, a
