r"""A file of postures as a trajectory: timed ones as they are, waypoints by the planner.

Two kinds of CSV, both with a row of units below the header and columns in any order:

- a timed track has the columns t (or time), x, y and heading (or theta). A cubic spline goes through all postures, see
  ``curve``: velocity and acceleration are its own. Headings are taken through the smaller angle from sample to
  sample, so they may be wrapped or not.
- waypoints have x and y, with heading and pause where they are wanted; an empty cell is a heading along the leg, or
  no pause. They are planned within limits, see ``planner``.

A load cycle repeats, so a track starts and ends at rest, and the spline is clamped to it: a parabola through its first
three postures may have at most a quarter of their mean speed at the first, or 1/100 of the largest speed of the track;
likewise at its end.

A spline through jumps is no motion. Speed from sample to sample, and acceleration from step to step, may be up to twice
the limits where they are given; else up to 50 m/s and 10 g, turning 100 rad/s and 1000 rad/s², more than any wheel on a
floor makes of a platform. With smoothing that holds from knot to knot, and no sample between may be off by more than is
driven at that speed from one to the next.

Nor is a spline through rounded figures: 0.01 mm every 10 ms is up to 0.6 m/s² of acceleration that no motion has,
6 q/h² of the last digit q. Where that is more than a fifth of the largest acceleration the track needs more digits, or
smoothing: a spline whose knots are that far apart, as near to all samples as least squares brings it. It also takes
noise out, and rounds what changes faster. Digits coarser than 1 mm or 1 mrad are taken as exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.files.csv_columns import (
    factors_of,
    miscount,
    number_of,
    plain_number,
    refuse_impossible,
    rows_of,
    values_of,
)
from drivesizer.files.text import read_text
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.platform.curve import spline, thinned
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.planner import Limits, Waypoint, plan
from drivesizer.platform.trajectory import Trajectory

__all__ = ["last_digit", "read_track"]

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
_EXACT, _MOST_NOISE = 1e-3, 0.2  # m or rad; of the largest acceleration
_SLOW, _CREEP = 0.25, 0.01  # what is at rest: of the mean speed of two steps; of the largest of all


def read_track(
    path: str | Path, limits: Limits | None = None, smoothing: float = 0.0, where: str = "smoothing"
) -> Trajectory:
    """The trajectory in a file.

    Parameters
    ----------
    path
        A CSV file in UTF-8.
    limits
        Of the platform: waypoints are planned within them, and a timed track that leaves them far behind has jumps.
    smoothing
        Least time between the knots of a timed track's spline [s]; 0 goes through all samples.
    where
        What a message calls it: where a spec has it.

    Returns
    -------
    Trajectory
        From rest to rest.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
    file = Path(path)
    text = read_text(file)
    rows = rows_of(file, text, len(_TIMED))
    header, factors = _head(file, rows)
    if "time" not in header:
        if limits is None:
            raise InputError(f"{file}: waypoints have no times; expected limits to plan with, or a column t")
        return _planned(file, _waypoints(file, rows, header, factors), limits)
    convert = float if text.isascii() and "_" not in text else plain_number
    found = values_of(file, rows, header, factors, convert)
    refuse_impossible(file, [*found.T], header, _KINDS, factors)
    time, *posture = (found[:, header.index(name)] for name in _KINDS if name in _TIMED)
    if len(time) < _FEWEST:
        raise InputError(f"{file}: rows: {len(time)} found; expected at least {_FEWEST} below the units")
    made = np.array([posture[0], posture[1], np.unwrap(posture[2])])
    if not np.ptp(made, axis=1).any():
        raise InputError(f"{file}: rows: nothing moves; expected a track of a motion")
    span = float(time[-1] - time[0])
    if not 0.0 <= smoothing <= span / _FEWEST:
        most = f"{span / _FEWEST:.4g} s, a quarter of the time of {file}"
        raise InputError(f"{where}: {smoothing:g} s; expected between 0 and {most}")
    _no_jumps(file, time, made, limits, thinned(time, smoothing))
    _no_outliers(file, time, made, limits, thinned(time, smoothing))
    _refuse_moving_ends(file, time, made, thinned(time, smoothing))
    if smoothing == 0.0:
        known = dict(zip(header, factors, strict=True))
        _enough_digits(file, time, posture, [known[name] for name in ("x", "y", "heading")])
    return spline(time, made, smoothing)


def _head(path: Path, rows: Iterator[tuple[int, list[str]]]) -> tuple[list[str], list[float]]:
    """Names of the columns, and what brings them to SI."""
    line, cells = next(rows, (1, []))
    names = [_NAMES.get(cell.strip().lower(), cell.strip().lower()) for cell in cells]
    known, single = set(names), len(set(names)) == len(names)
    if not single or not (known == _TIMED or {"x", "y"} <= known <= {"x", "y", "heading", "pause"}):
        shown = quoted(",".join(cells)) if cells else "nothing"
        raise InputError(f"{path}:{line}: header: {shown}; {_EXPECTED}")
    return names, factors_of(path, names, _KINDS, next(rows, None))


def _waypoints(
    path: Path, rows: Iterator[tuple[int, list[str]]], header: list[str], factors: list[float]
) -> list[Waypoint]:
    found: list[Waypoint] = []
    for line, cells in rows:
        if len(cells) != len(header):
            raise InputError(f"{path}:{line}: row: {miscount(cells, header)}")
        if len(found) == _MOST_WAYPOINTS:
            raise InputError(f"{path}:{line}: row: more than {_MOST_WAYPOINTS} waypoints; expected fewer")
        given = {
            name: number_of(path, line, name, cell, factor)
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


def _no_jumps(path: Path, time: Array, posture: Array, limits: Limits | None, kept: Any) -> None:
    """Refuse a track with jumps of place or heading, or of their speeds."""
    time, posture = time[kept], posture[:, kept]
    step = np.diff(time)
    speed = np.diff(posture, axis=1) / step
    gain = 2.0 * np.diff(speed, axis=1) / (step[1:] + step[:-1])
    for column, (rows, most) in _most(limits).items():
        size = [np.hypot.reduce(c[rows], axis=0) for c in (speed, gain)]
        for values, bound, unit in zip(size, most, _UNITS[column], strict=True):
            if not (values <= bound).all():
                at = int(np.argmin(values <= bound))
                word = f"a jump, {values[at]:.4g} {unit} from row to row"
                raise InputError(
                    f"{path}:{kept[at + 1] + _ABOVE}: {column}: {word}; expected {bound:.4g} {unit} at most"
                )


def _no_outliers(path: Path, time: Array, posture: Array, limits: Limits | None, kept: Any) -> None:
    """Refuse rows between the knots that are farther from the path than a platform gets between two of them."""
    off = posture - np.array([np.interp(time, time[kept], row[kept]) for row in posture])
    for column, (rows, (fastest, _)) in _most(limits).items():
        size, bound = np.hypot.reduce(off[rows], axis=0), fastest * float(np.diff(time[kept]).max())
        if not (size <= bound).all():
            at, unit = int(np.argmin(size <= bound)), _UNITS[column][0].removesuffix("/s")
            word = f"a jump, {size[at]:.4g} {unit} off the path between its neighbours"
            raise InputError(f"{path}:{at + _ABOVE}: {column}: {word}; expected {bound:.4g} {unit} at most")


def _most(limits: Limits | None) -> dict[str, tuple[slice, tuple[float, float]]]:
    """Rows of a posture, and what their speed and acceleration may be."""
    driving, turning = _NO_WHEEL
    if limits is not None:
        driving = (_FAR * limits.speed, _FAR * limits.acceleration)
        if limits.turning_speed is not None and limits.turning_acceleration is not None:
            turning = (_FAR * limits.turning_speed, _FAR * limits.turning_acceleration)
    return {"x, y": (slice(0, 2), driving), "heading": (slice(2, 3), turning)}


def _enough_digits(path: Path, time: Array, posture: Sequence[Array], factors: list[float]) -> None:
    """Refuse a track whose last digits make up much of its acceleration.

    A spline through values rounded to q, h apart, is off by up to 6 q/h² in its second derivative. Digits coarser than
    1 mm or 1 mrad are taken as exact: so a track is written by hand.
    """
    step = float(np.median(np.diff(time)))
    made = np.array([posture[0], posture[1], np.unwrap(posture[2])])
    gain = np.abs(np.diff(np.diff(made, axis=1) / np.diff(time), axis=1) / step)
    for column, row, factor in zip(("x", "y", "heading"), posture, factors, strict=True):
        digit = last_digit(row / factor) * factor
        largest = (gain[2] if column == "heading" else gain[:2]).max()
        noise = 6.0 * digit / step**2
        if digit <= _EXACT and _MOST_NOISE * largest < noise and np.ptp(row) > 0.0:
            unit, rate = ("rad", "rad/s^2") if column == "heading" else ("m", "m/s^2")
            raise InputError(
                f"{path}: {column}: the last digit, {digit:.3g} {unit}, stands for {noise:.3g} {rate} every {step:g} s,"
                f" of {largest:.3g} {rate} in all; expected more digits, or smoothing"
            )


def last_digit(values: Array) -> float:
    """The power of ten that all values are whole multiples of; 0 where they have more than nine decimals.

    >>> last_digit(np.array([1.25, 0.5]))
    0.01
    """
    for digits in range(10):
        scaled = values * 10.0**digits
        if (np.abs(scaled - np.round(scaled)) <= 1e-6 + 1e-15 * np.abs(scaled)).all():
            return float(10.0**-digits)
    return 0.0


def _refuse_moving_ends(path: Path, time: Array, posture: Array, kept: Any) -> None:
    """Refuse a track that does not start and end at rest."""
    time, posture = time[kept], posture[:, kept]
    top = np.abs(np.diff(posture, axis=1) / np.diff(time)).max(axis=1)
    for here, last, word in ((slice(None, 3), 0, "starts"), (slice(-3, None), -1, "ends")):
        t = time[here]
        slope = np.array([local_parabola(t, row[here], 0.0)[1][last] for row in posture])
        mean = (posture[:, here][:, -1] - posture[:, here][:, 0]) / (t[-1] - t[0])
        for column, rows in (("x, y", slice(0, 2)), ("heading", slice(2, 3))):
            along, size = float(slope[rows] @ mean[rows]), float(np.hypot.reduce(mean[rows]))
            if along > size * max(_SLOW * size, _CREEP * float(np.hypot.reduce(top[rows]))):
                line = _ABOVE + int(kept[last])
                raise InputError(
                    f"{path}:{line}: {column}: the track {word} at {along / size:.3g} {_UNITS[column][0]}; expected "
                    "rest, as the cycle repeats: add rows of a ramp, or take a longer part"
                )
