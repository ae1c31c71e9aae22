"""Waypoints or a file of postures to a trajectory, as fast as all limits allow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.files.sheets import CsvFile
from drivesizer.physics.motion_curves import fastest_ramp
from drivesizer.platform.equations import Array
from drivesizer.platform.trajectory import (
    Trajectory,
    joined,
    path_coordinate,
    refuse_few_digits,
    rest,
    speed_at_end,
    spline,
    thinned,
)  # fmt: skip

# -- From waypoints to a trajectory: straight in the posture from one to the next, as fast as all limits allow.
#
# Between two waypoints place and heading change together, in proportion to one path coordinate s from 0 to 1, from
# rest to rest; the limits of driving and of turning both become limits of s, and the tighter ones count. Without a
# limit of jerk the speed is a trapezoid, else an S-curve of seven phases. Where the next leg goes on in the same
# direction of x, y and heading, the platform does not stop between.
#
# Headings. A waypoint with one is reached with it, and the platform turns evenly on the leg; one without is reached
# looking along the leg: the platform turns on the spot, through the smaller angle, then drives forwards, which is
# what a differential drive can do. Headings are taken as they are: from 0 to 540 deg it turns one and a half times,
# from 170 deg to -170 deg back by 340 deg. Only after a waypoint without a heading is the smaller angle taken to one
# with it.
#
# Pieces. Wheel speeds and torques are taken as straight between the ends of pieces. A phase without jerk or turning
# is one piece, and exact. Others fall into 32 pieces or more, none of which turns by more than 1/32 rad: a straight
# line h apart is off by :math:`h^2/8` of the second derivative, so speeds and torques are off by less than 1/1000 of
# the largest in their leg.


_PIECES = 32  # of a phase with jerk or turning, and of a radian
_SAME = 1e-9  # m, rad: postures closer than this are one; also of the directions of legs, of length 1
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


def plan(waypoints: Sequence[Waypoint], limits: Limits) -> Trajectory:
    """The fastest trajectory through waypoints within limits.

    One metre at 1 m/s and 2 m/s² takes 1/1 + 1/2 s; a quarter turn first, at 3 rad/s², 2 √(π/2 / 3) s:

    >>> limits = Limits(speed=1.0, acceleration=2.0, turning_speed=3.0, turning_acceleration=3.0)
    >>> plan([Waypoint(x=0.0, y=0.0, heading=0.0), Waypoint(x=0.0, y=1.0)], limits).total
    2.947202509
    """
    stops = _joined(_stops(waypoints)) if waypoints else []
    if len(stops) < 2:
        raise InputError(f"waypoints: {len(waypoints)} given and nothing moves; expected two postures that differ")
    parts: list[Trajectory] = []
    pieces = 0
    for before, stop in zip([None, *stops], stops, strict=False):
        if before is not None:
            parts.append(_leg(before, stop, limits))
            pieces += len(parts[-1].duration)
        if stop.pause > 0.0:
            parts.append(rest(stop.posture, stop.pause))
        if pieces > _MOST_PIECES:
            raise InputError(
                f"waypoints: the path turns for too long, over {_MOST_PIECES} pieces; expected fewer turns"
            )
    return joined(parts)


# --- where it stops ---------------------------------------------------------------------------------------------------


def _stops(waypoints: Sequence[Waypoint]) -> list[_Stop]:
    """Stops of the platform, turns on the spot among them; one in the place of the one before adds to it."""
    stops: list[_Stop] = []

    def reach(x: float, y: float, heading: float, pause: float, number: int) -> None:
        posture = np.array([x, y, heading])
        if stops and np.abs(posture - stops[-1].posture).max() <= _SAME:
            stops[-1] = stops[-1]._replace(pause=stops[-1].pause + pause)
        else:
            stops.append(_Stop(posture, pause, number))

    first = waypoints[0]
    away = next((w for w in waypoints if math.hypot(w.x - first.x, w.y - first.y) > _SAME), first)
    ahead = math.atan2(away.y - first.y, away.x - first.x)
    reach(first.x, first.y, ahead if first.heading is None else first.heading, first.pause, 1)
    for number, (before, w) in enumerate(pairwise(waypoints), 2):
        x, y, heading = stops[-1].posture.tolist()  # counted on from there
        if w.heading is not None and before.heading is not None:
            heading += w.heading - before.heading
        elif w.heading is not None or math.hypot(w.x - x, w.y - y) > _SAME:
            towards = math.atan2(w.y - y, w.x - x) if w.heading is None else w.heading
            turn = math.remainder(towards - heading, math.tau)
            heading += turn if abs(turn) > _SAME else 0.0
        if w.heading is None:
            reach(x, y, heading, 0.0, number)
        reach(w.x, w.y, heading, w.pause, number)
    return stops


def _joined(stops: list[_Stop]) -> list[_Stop]:
    """The stops without those that the path goes straight through, place and heading alike."""
    corners = stops[:1]
    for stop, after in zip(stops[1:], [*stops[2:], None], strict=False):
        if after is not None and stop.pause == 0.0:
            there, on = stop.posture - corners[-1].posture, after.posture - stop.posture
            if np.abs(there / np.linalg.norm(there) - on / np.linalg.norm(on)).max() <= _SAME:
                continue
        corners.append(stop)
    return corners


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
    distance = float(np.hypot(change[0], change[1]))
    speed = _tightest((limits.speed, distance), (limits.turning_speed, turn))
    most = _tightest((limits.acceleration, distance), (limits.turning_acceleration, turn))
    jerk = _tightest((limits.jerk, distance), (limits.turning_jerk, turn))
    try:
        times = fastest_ramp(1.0, speed, most, jerk)
    except ArithmeticError:
        times = math.nan, math.nan, math.nan
    total = 2.0 * (2.0 * times[0] + times[1]) + times[2]
    if not 0.0 < total < _LARGEST or turn * _PIECES > _MOST_PIECES:
        raise InputError(
            f"waypoint {stop.number}: the leg to it takes {total:.3g} s; expected limits that suit the distance"
        )
    top = 1.0 / (2.0 * times[0] + times[1] + times[2])

    def pieces(time: float, curved: bool, cruises: bool) -> int:
        turned = math.ceil(time * top * turn * _PIECES)
        return max(1, turned) if cruises or not (curved or turn) else max(_PIECES, turned)

    duration, s, v, a = path_coordinate(times, pieces)
    posture = before.posture[:, None, None] + change[:, None, None] * s
    posture[:, 0, 0], posture[:, -1, 1] = before.posture, stop.posture
    velocity, acceleration = (change[:, None, None] * c + 0.0 for c in (v, a))  # no zero with a minus
    return Trajectory(duration, posture, velocity, acceleration)


def _tightest(*pairs: tuple[float | None, float]) -> float:
    """The least of limits over sizes; infinite where none counts."""
    return min((limit / size for limit, size in pairs if limit is not None and size > 0.0), default=math.inf)


# -- A file of postures as a trajectory: timed ones as they are, waypoints by the planner.
#
# Two kinds of CSV, both with a row of units below the header and columns in any order:
#
# - a timed track has the columns t (or time), x, y and heading (or theta). A cubic spline goes through all postures,
# see ``curve``: velocity and acceleration are its own. Headings are taken through the smaller angle from sample to
# sample, so they may be wrapped or not. - waypoints have x and y, with heading and pause where they are wanted; an
# empty cell is a heading along the leg, or no pause. They are planned within limits, see ``planner``.
#
# A load cycle repeats, so a track starts and ends at rest, and the spline is clamped to it: a parabola through its
# first three postures may have at most a quarter of their mean speed at the first, or 1/100 of the largest speed of
# the track; likewise at its end.
#
# A spline through jumps is no motion. Speed from sample to sample, and acceleration from step to step, may be up to
# twice the limits where they are given; else up to 50 m/s and 10 g, turning 100 rad/s and 1000 rad/s², more than any
# wheel on a floor makes of a platform. With smoothing that holds from knot to knot, and no sample between may be off
# by more than is driven at that speed from one to the next.
#
# Nor is a spline through rounded figures: 0.01 mm every 10 ms is up to 0.6 m/s² of acceleration that no motion has,
# 6 q/h² of the last digit q. Where that is more than a fifth of the largest acceleration the track needs more
# digits, or smoothing: a spline whose knots are that far apart, as near to all samples as least squares brings it.
# It also takes noise out, and rounds what changes faster. Digits coarser than 1 mm or 1 mrad are taken as exact.


_NAMES = {"t": "time", "theta": "heading"}  # as they may stand -> as they are
_KINDS = {"time": "time", "x": "length", "y": "length", "heading": "angle", "pause": "time"}
_TIMED = {"time", "x", "y", "heading"}
_EXPECTED = "expected t,x,y,heading of a timed track, or x,y of waypoints with heading or pause where wanted"
_MOST_WAYPOINTS = 100_000
_FEWEST = 4  # a cubic has four coefficients
_FAR = 2.0  # times a limit is a jump
_NO_WHEEL = ((50.0, 98.0665), (100.0, 1000.0))  # m/s and m/s^2; rad/s and rad/s^2
_UNITS = {"x, y": ("m/s", "m/s^2"), "heading": ("rad/s", "rad/s^2")}
_ABOVE = 3  # line of the first sample


def read_track(
    path: str | Path, limits: Limits | None = None, smoothing: float = 0.0, where: str = "smoothing"
) -> Trajectory:
    """The trajectory in a file."""
    file = Path(path)
    sheet = CsvFile(file, len(_TIMED))
    header = _header(sheet)
    factors = sheet.factors(header, _KINDS)
    if "time" not in header:
        if limits is None:
            raise InputError(f"{file}: waypoints have no times; expected limits to plan with, or a column t")
        waypoints = _waypoints(sheet, header, factors)
        try:
            return plan(waypoints, limits)
        except InputError as error:
            raise InputError(f"{file}: {error}") from None
    columns = sheet.values(header, _KINDS, factors)
    time, *posture = (columns[header.index(name)] for name in _KINDS if name in _TIMED)
    if len(time) < _FEWEST:
        raise InputError(f"{file}: rows: {len(time)} found; expected at least {_FEWEST} below the units")
    track = np.array([posture[0], posture[1], np.unwrap(posture[2])])
    if not np.ptp(track, axis=1).any():
        raise InputError(f"{file}: rows: nothing moves; expected a track of a motion")
    span = float(time[-1] - time[0])
    if not 0.0 <= smoothing <= span / _FEWEST:
        most = f"{span / _FEWEST:.4g} s, a quarter of the time of {file}"
        raise InputError(f"{where}: {smoothing:g} s; expected between 0 and {most}")
    _refuse_no_motion(file, time, track, limits, thinned(time, smoothing))
    if smoothing == 0.0:
        step = float(np.median(np.diff(time)))
        gain = np.abs(np.diff(np.diff(track, axis=1) / np.diff(time), axis=1) / step)
        for name, row, of_it, unit in zip(
            ("x", "y", "heading"), posture, (gain[:2], gain[:2], gain[2]), ("m", "m", "rad"), strict=True
        ):
            refuse_few_digits(f"{file}: {name}", row, factors[header.index(name)], step, float(of_it.max()), unit)
    return spline(time, track, smoothing)


def _header(sheet: CsvFile) -> list[str]:
    """Names of the columns."""
    names = [_NAMES.get(name.lower(), name.lower()) for name in sheet.names]
    known, single = set(names), len(set(names)) == len(names)
    if not single or not (known == _TIMED or {"x", "y"} <= known <= {"x", "y", "heading", "pause"}):
        header = quoted(",".join(sheet.cells)) if sheet.cells else "nothing"
        raise sheet.fault(sheet.line, "header", f"{header}; {_EXPECTED}")
    return names


def _waypoints(sheet: CsvFile, header: list[str], factors: list[float]) -> list[Waypoint]:
    waypoints: list[Waypoint] = []
    for line, cells in sheet.rows:
        sheet.refuse_miscount(line, cells, header)
        if len(waypoints) == _MOST_WAYPOINTS:
            raise sheet.fault(line, "row", f"more than {_MOST_WAYPOINTS} waypoints; expected fewer")
        values = {
            name: sheet.number(line, name, cell, factor)
            for name, cell, factor in zip(header, cells, factors, strict=True)
            if cell.strip() or name in ("x", "y")
        }
        try:
            waypoints.append(Waypoint(**values))
        except InputError as error:
            raise InputError(f"{sheet.path}:{line}: {error}") from None
    return waypoints


# --- what is no motion of a platform ----------------------------------------------------------------------------------


def _refuse_no_motion(path: Path, time: Array, posture: Array, limits: Limits | None, knot_rows: Any) -> None:
    """Refuse a track that jumps in place, heading or their speeds, has rows far off its path, or ends that move."""
    moment, knots, bounds = time[knot_rows], posture[:, knot_rows], _most(limits)
    step = np.diff(moment)
    speed = np.diff(knots, axis=1) / step
    gain = 2.0 * np.diff(speed, axis=1) / (step[1:] + step[:-1])
    for column, (rows, most) in bounds.items():
        size = [np.hypot.reduce(c[rows], axis=0) for c in (speed, gain)]
        for values, bound, unit in zip(size, most, _UNITS[column], strict=True):
            if not (values <= bound).all():
                at = int(np.argmin(values <= bound))
                word = f"a jump, {values[at]:.4g} {unit} from row to row"
                raise InputError(
                    f"{path}:{knot_rows[at + 1] + _ABOVE}: {column}: {word}; expected {bound:.4g} {unit} at most"
                )
    off = posture - np.array([np.interp(time, moment, row) for row in knots])  # of the rows between knots
    for column, (rows, (fastest, _)) in bounds.items():
        far, bound = np.hypot.reduce(off[rows], axis=0), fastest * float(step.max())
        if not (far <= bound).all():
            at, unit = int(np.argmin(far <= bound)), _UNITS[column][0].removesuffix("/s")
            word = f"a jump, {far[at]:.4g} {unit} off the path between its neighbours"
            raise InputError(f"{path}:{at + _ABOVE}: {column}: {word}; expected {bound:.4g} {unit} at most")
    for last, word in ((0, "starts"), (-1, "ends")):
        for column, (rows, _) in bounds.items():
            if along := speed_at_end(moment, knots[rows], last):
                raise InputError(
                    f"{path}:{_ABOVE + int(knot_rows[last])}: {column}: the track {word} at {along:.3g} "
                    f"{_UNITS[column][0]}; expected rest, as the cycle repeats: add rows of a ramp, or take a "
                    "longer part"
                )


def _most(limits: Limits | None) -> dict[str, tuple[slice, tuple[float, float]]]:
    """Rows of a posture, and what their speed and acceleration may be."""
    driving, turning = _NO_WHEEL
    if limits is not None:
        driving = (_FAR * limits.speed, _FAR * limits.acceleration)
        if limits.turning_speed is not None and limits.turning_acceleration is not None:
            turning = (_FAR * limits.turning_speed, _FAR * limits.turning_acceleration)
    return {"x, y": (slice(0, 2), driving), "heading": (slice(2, 3), turning)}
