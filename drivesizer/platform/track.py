r"""A file of postures as a trajectory: timed ones as they are, waypoints by the planner.

Two kinds of CSV, both with a row of units below the header and columns in any order:

- a timed track has the columns t (or time), x, y and heading (or theta). A cubic spline, twice continuously
  differentiable, goes through all postures: velocity and acceleration are its own. Headings are taken the short way
  from sample to sample, so they may be wrapped or not.
- waypoints have x and y, with heading and pause where they are wanted; an empty cell is a heading along the way, or
  no pause. They are planned within limits, see ``planner``.

A load cycle repeats, so a track starts and ends at rest: a parabola through its first three postures may have at most a
quarter of their mean speed at the first, or 1/100 of the largest speed of the track; likewise at its end. The spline is
clamped to rest there, and wherever three postures or more in a row are the same: there the platform stands, and what
moves before and after has a spline of its own. An interval is one piece; more, where its speed bends by more than
1/1000 of the largest or it turns by more than 1/32 rad.

A spline through jumps is no motion. Speed from sample to sample, and acceleration from step to step, may be up to twice
the limits where they are given; else up to 50 m/s and 10 g, turning 100 rad/s and 1000 rad/s², more than any wheel on a
floor makes of a platform. A track that was recorded with noise must be smoothed first: noise of the size s in samples
h apart is noise of 2 s/h² in the acceleration.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.loads.recorded import local_parabola
from drivesizer.platform.notation import Array
from drivesizer.platform.planner import Limits, Waypoint, plan
from drivesizer.platform.trajectory import Trajectory, joined, rest
from drivesizer.recording import _factors, _miscount, _number, _rows, _strict, _values
from drivesizer.textfile import read_text

__all__ = ["read_track", "read_waypoints", "spline"]

_NAMES = {"t": "time", "theta": "heading"}  # as they may stand -> as they are
_KINDS = {"time": "time", "x": "length", "y": "length", "heading": "angle", "pause": "time"}
_TIMED = {"time", "x", "y", "heading"}
_EXPECTED = "expected t,x,y,heading of a timed track, or x,y of waypoints with heading or pause where wanted"
_MOST_WAYPOINTS = 100_000
_MOST_PARTS = 256  # of an interval
_FEWEST = 4  # a cubic has four coefficients
_FAR = 2.0  # times a limit is a jump
_NO_WHEEL = ((50.0, 98.0665), (100.0, 1000.0))  # m/s and m/s^2; rad/s and rad/s^2
_UNITS = {"x, y": ("m/s", "m/s^2"), "heading": ("rad/s", "rad/s^2")}
_ABOVE = 3  # line of the first sample
_SLOW, _CREEP = 0.25, 0.01  # what is at rest: of the mean speed of two steps; of the largest of all
_BEND, _TURN = 1e-3, 1.0 / 32.0  # of a piece: of the largest speed; rad


def read_track(path: str | Path, limits: Limits | None = None) -> Trajectory:
    """The trajectory in a file.

    Parameters
    ----------
    path
        A CSV file in UTF-8.
    limits
        Of the platform: waypoints are planned within them, and a timed track that leaves them far behind has jumps.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
    file = Path(path)
    text = read_text(file)
    rows = _rows(file, text, len(_TIMED))
    header, factors = _head(file, rows)
    if "time" not in header:
        if limits is None:
            raise InputError(f"{file}: waypoints have no times; expected limits to plan with, or a column t")
        return _planned(file, _waypoints(file, rows, header, factors), limits)
    convert = float if text.isascii() and "_" not in text else _strict
    found = _values(file, rows, header, factors, convert)
    time, *posture = (found[:, header.index(name)] for name in _KINDS if name in _TIMED)
    if len(time) < _FEWEST:
        raise InputError(f"{file}: rows: {len(time)} found; expected at least {_FEWEST} below the units")
    made = np.array([posture[0], posture[1], np.unwrap(posture[2])])
    if not np.ptp(made, axis=1).any():
        raise InputError(f"{file}: rows: nothing moves; expected a track of a motion")
    _no_jumps(file, time, made, limits)
    _at_rest(file, time, made)
    return spline(time, made)


def read_waypoints(path: str | Path) -> list[Waypoint]:
    """The waypoints in a file without times.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
    file = Path(path)
    rows = _rows(file, read_text(file), len(_TIMED))
    header, factors = _head(file, rows)
    if "time" in header:
        raise InputError(f"{file}:1: header: times; expected waypoints, x,y with heading or pause where wanted")
    return _waypoints(file, rows, header, factors)


def _head(path: Path, rows: Iterator[tuple[int, list[str]]]) -> tuple[list[str], list[float]]:
    """Names of the columns, and what brings them to SI."""
    line, cells = next(rows, (1, []))
    names = [_NAMES.get(cell.strip().lower(), cell.strip().lower()) for cell in cells]
    known, single = set(names), len(set(names)) == len(names)
    if not single or not (known == _TIMED or {"x", "y"} <= known <= {"x", "y", "heading", "pause"}):
        shown = quoted(",".join(cells)) if cells else "nothing"
        raise InputError(f"{path}:{line}: header: {shown}; {_EXPECTED}")
    return names, _factors(path, names, _KINDS, next(rows, None))


def _waypoints(
    path: Path, rows: Iterator[tuple[int, list[str]]], header: list[str], factors: list[float]
) -> list[Waypoint]:
    found: list[Waypoint] = []
    for line, cells in rows:
        if len(cells) != len(header):
            raise InputError(f"{path}:{line}: row: {_miscount(cells, header)}")
        if len(found) == _MOST_WAYPOINTS:
            raise InputError(f"{path}:{line}: row: more than {_MOST_WAYPOINTS} waypoints; expected fewer")
        given = {
            name: _number(path, line, name, cell, factor)
            for name, cell, factor in zip(header, cells, factors, strict=True)
            if cell.strip() or name in ("x", "y")
        }
        try:
            found.append(Waypoint(**given))
        except InputError as error:
            raise InputError(f"{path}:{line}: {error}") from None
    return found


def _planned(path: Path, waypoints: list[Waypoint], limits: Limits) -> Trajectory:
    try:
        return plan(waypoints, limits)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


# --- what is no motion of a platform ----------------------------------------------------------------------------------


def _no_jumps(path: Path, time: Array, posture: Array, limits: Limits | None) -> None:
    """Refuse a track with jumps of place or heading, or of their speeds."""
    step = np.diff(time)
    speed = np.diff(posture, axis=1) / step
    gain = 2.0 * np.diff(speed, axis=1) / (step[1:] + step[:-1])
    for column, (rows, most) in _most(limits).items():
        size = [np.hypot.reduce(c[rows], axis=0) for c in (speed, gain)]
        for values, bound, unit in zip(size, most, _UNITS[column], strict=True):
            if not (values <= bound).all():
                at = int(np.argmin(values <= bound))
                word = f"a jump, {values[at]:.4g} {unit} from row to row"
                raise InputError(f"{path}:{at + 1 + _ABOVE}: {column}: {word}; expected {bound:.4g} {unit} at most")


def _most(limits: Limits | None) -> dict[str, tuple[slice, tuple[float, float]]]:
    """Rows of a posture, and what their speed and acceleration may be."""
    driving, turning = _NO_WHEEL
    if limits is not None:
        driving = (_FAR * limits.speed, _FAR * limits.acceleration)
        if limits.turning_speed is not None and limits.turning_acceleration is not None:
            turning = (_FAR * limits.turning_speed, _FAR * limits.turning_acceleration)
    return {"x, y": (slice(0, 2), driving), "heading": (slice(2, 3), turning)}


def _at_rest(path: Path, time: Array, posture: Array) -> None:
    """Refuse a track that does not start and end at rest."""
    top = np.abs(np.diff(posture, axis=1) / np.diff(time)).max(axis=1)
    for here, last, word in ((slice(None, 3), 0, "starts"), (slice(-3, None), -1, "ends")):
        t = time[here]
        slope = np.array([local_parabola(t, row[here], 0.0)[1][last] for row in posture])
        mean = (posture[:, here][:, -1] - posture[:, here][:, 0]) / (t[-1] - t[0])
        for column, rows in (("x, y", slice(0, 2)), ("heading", slice(2, 3))):
            along, size = float(slope[rows] @ mean[rows]), float(np.hypot.reduce(mean[rows]))
            if along > size * max(_SLOW * size, _CREEP * float(np.hypot.reduce(top[rows]))):
                line = _ABOVE + (0 if last == 0 else len(time) - 1)
                raise InputError(
                    f"{path}:{line}: {column}: the track {word} at {along / size:.3g} {_UNITS[column][0]}; expected "
                    "rest, as the cycle repeats: add rows of a ramp, or take a longer part"
                )


# --- the spline -------------------------------------------------------------------------------------------------------


def spline(time: Array, posture: Array) -> Trajectory:
    """The trajectory through postures, from rest to rest; it stands where three in a row are the same.

    Parameters
    ----------
    time
        Rising [s], shape (n,).
    posture
        Headings continuous [m, m, rad], shape (3, n).
    """
    same = (np.diff(posture, axis=1) == 0.0).all(axis=0)
    beside = np.concatenate([[False], same, [False]])
    stands = same & (beside[:-2] | beside[2:])
    edges = np.concatenate([[0], np.flatnonzero(np.diff(stands)) + 1, [len(same)]])
    top = _top(np.diff(posture, axis=1) / np.diff(time))
    made = []
    for first, last in pairwise(edges.tolist()):
        t, p = time[first : last + 1], posture[:, first : last + 1]
        still = rest(p[:, 0], float(t[-1] - t[0])) if stands[first] else None
        made.append(still or _moving(t, p, top))
    return joined(made)


def _top(speed: Array) -> Array:
    """The largest speed of driving and of turning [m/s, rad/s]."""
    return np.array([np.hypot(speed[0], speed[1]).max(), np.abs(speed[2]).max()])


def _moving(time: Array, posture: Array, top: Array) -> Trajectory:
    """A stretch between rests."""
    from scipy.interpolate import CubicSpline

    still = np.zeros(3)
    curve = CubicSpline(time, posture, axis=1, bc_type=((1, still), (1, still)))
    step = np.diff(time)
    x, y, turn = 6.0 * curve.c[0].T * step**2 / 8.0
    bend = np.array([np.hypot(x, y), np.abs(turn)])
    share = np.divide(bend, top[:, None], out=np.zeros_like(bend), where=top[:, None] > 0.0).max(axis=0)
    turned = np.abs(curve(time, 1)[2])
    turned = np.maximum(turned[1:], turned[:-1]) * step
    count = np.ceil(np.maximum(np.sqrt(share / _BEND), turned / _TURN)).clip(1.0, _MOST_PARTS).astype(np.int64)
    owner = np.repeat(np.arange(len(step)), count)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    knots = np.append(time[owner] + step[owner] * (place / count[owner]), time[-1])
    columns = [curve(knots, order) for order in range(3)]
    columns[0][:, [0, -1]], columns[1][:, [0, -1]] = posture[:, [0, -1]], 0.0
    return Trajectory(np.diff(knots), *(np.stack([c[:, :-1], c[:, 1:]], axis=2) for c in columns))
