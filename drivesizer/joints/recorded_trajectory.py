"""A CSV of joint positions over time as a motion: a cubic spline through all samples, or near them with smoothing.

A joint that is at rest at both ends starts and ends so; wherever three of its samples or more in a row are the same it
stands, and what moves before and after has a spline of its own. One that is not at rest there must repeat: it ends
where it starts (without limits, also turns further on), and its spline is periodic. Where samples are far apart an
interval is divided, so that no joint turns by more than 1/32 rad in one piece and its speed is a straight line there
to 1/1000 of the largest.

As a track of a platform it needs digits enough: values rounded to q, h apart, are off by up to 6 q/h² in acceleration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.csv_columns import factors_of, plain_number, refuse_impossible, rows_of, values_of
from drivesizer.files.text import read_text
from drivesizer.joints.record import Array, JointMotion
from drivesizer.physics.load_cycle import places
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.platform.curve import curve_at_rest, thinned
from drivesizer.platform.track import last_digit
from drivesizer.spec.description.record import Joint, Robot

__all__ = ["motion_in"]

_TIME = "time"
_FEWEST = 4  # a cubic has four coefficients
_BEND, _TURN = 1e-3, 1.0 / 32.0  # of a piece: of the largest speed; rad
_MOST_PARTS, _MOST_PIECES = 256, 200_000  # of an interval; of a trajectory
_SLOW, _CREEP = 0.25, 0.01  # what is at rest: of the mean speed of two steps; of the largest of all
_SAME = 1e-6  # rad or m, by which joints that end where they start may be off
_TINY = 1e-300  # instead of a largest speed of 0
_EXACT, _MOST_NOISE = 1e-3, 0.2  # m or rad; of the largest acceleration


def motion_in(path: Path, robot: Robot, smoothing: float = 0.0) -> JointMotion:
    """Joints over time as a file has them."""
    text = read_text(path)
    rows = rows_of(path, text, 2)
    line, cells = next(rows, (1, []))
    joints = _joints(path, line, [cell.strip() for cell in cells], robot)
    header = [cell.strip() for cell in cells]
    form = {_TIME: "time"} | {joint.name: "angle" if joint.turns else "length" for joint in joints}
    factors = factors_of(path, header, form, next(rows, None))
    convert = float if text.isascii() and "_" not in text else plain_number
    values = values_of(path, rows, header, factors, convert)
    refuse_impossible(path, [*values.T], header, form, factors)
    if len(values) < _FEWEST:
        raise InputError(f"{path}: rows: {len(values)} found; expected at least {_FEWEST} below the units")
    time = values[:, header.index(_TIME)]
    position = np.array([values[:, header.index(joint.name)] for joint in joints])
    _moves(path, time, position, smoothing)
    if not smoothing:
        known = dict(zip(header, factors, strict=True))
        _enough_digits(path, time, position, joints, [known[joint.name] for joint in joints])
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


def _moves(path: Path, time: Array, position: Array, smoothing: float) -> None:
    if not np.ptp(position, axis=1).any():
        raise InputError(f"{path}: rows: nothing moves; expected a trajectory, or poses as holds")
    span = float(time[-1] - time[0])
    if not smoothing <= span / _FEWEST:
        raise InputError(
            f"{path}: smoothing of {smoothing:g} s is more than {span / _FEWEST:.4g} s, a quarter of its time"
        )


def _enough_digits(path: Path, time: Array, position: Array, joints: Sequence[Joint], factors: Sequence[float]) -> None:
    """Refuse a file whose last digits make up much of its acceleration; coarse ones are taken as exact."""
    step = float(np.median(np.diff(time)))
    gain = np.abs(np.diff(np.diff(position, axis=1) / np.diff(time), axis=1) / step)
    for joint, row, factor, most in zip(joints, position, factors, gain.max(axis=1), strict=True):
        digit = last_digit(row / factor) * factor
        noise = 6.0 * digit / step**2
        if digit <= _EXACT and _MOST_NOISE * most < noise and np.ptp(row) > 0.0:
            unit = "rad" if joint.turns else "m"
            raise InputError(
                f"{path}: {joint.name}: the last digit, {digit:.3g} {unit}, stands for {noise:.3g} {unit}/s^2 every "
                f"{step:g} s, of {most:.3g} {unit}/s^2 in all; expected more digits, or smoothing"
            )


# --- the curve

Curve = Callable[[Array, int], Array]  # of times and the order of a derivative


class _Course(NamedTuple):
    """One joint over time: stretches of intervals, each with a curve of its own."""

    edges: tuple[int, ...]  # intervals at which stretches start, and the end
    curves: tuple[Curve, ...]

    def at(self, interval: NDArray[np.int64], time: Array, order: int) -> Array:
        """Values at times within intervals."""
        found = np.empty_like(time)
        for (first, last), curve in zip(pairwise(self.edges), self.curves, strict=True):
            start, end = np.searchsorted(interval, (first, last))
            found[start:end] = curve(time[start:end], order)
        return found


def _course(path: Path, time: Array, row: Array, joint: Joint, smoothing: float) -> _Course:
    """The curve of one joint."""
    kept = thinned(time, smoothing)
    if not _moves_at_ends(time[kept], row[kept]):
        return _from_rest(time, row, smoothing)
    gap = float(row[-1] - row[0])
    turns = round(gap / (2.0 * np.pi)) * 2.0 * np.pi if joint.kind == "continuous" else 0.0
    if abs(gap - turns) > _SAME:
        raise InputError(
            f"{path}: {joint.name}: moves at its ends, {abs(gap):.4g} {'rad' if joint.turns else 'm'} apart; expected "
            "rest at both, or an end as the start, as the cycle repeats"
        )
    return _Course((0, len(time) - 1), (_periodic(time, row, smoothing),))


def _moves_at_ends(time: Array, row: Array) -> bool:
    """Whether a joint is not at rest at one of its ends."""
    top = np.abs(np.diff(row) / np.diff(time)).max()
    for here, at in ((slice(None, 3), 0), (slice(-3, None), -1)):
        t, x = time[here], row[here]
        slope, mean = local_parabola(t, x, 0.0)[1][at], (x[-1] - x[0]) / (t[-1] - t[0])
        if slope * np.sign(mean) > max(_SLOW * abs(mean), _CREEP * top):  # against the motion: a bend, no speed
            return True
    return False


def _from_rest(time: Array, row: Array, smoothing: float) -> _Course:
    """From rest to rest, and at rest where samples in a row are the same: three, and for longer than the smoothing."""
    resting = np.diff(row) == 0.0
    for first, last in pairwise(_edges(resting)):
        if last - first < 2 or time[last] - time[first] < smoothing:
            resting[first:last] = False
    edges = _edges(resting)
    curves = [
        _still(float(row[a])) if resting[a] else _rising(time[a : b + 1], row[a : b + 1], smoothing)
        for a, b in pairwise(edges)
    ]
    return _Course(edges, tuple(curves))


def _edges(resting: NDArray[np.bool_]) -> tuple[int, ...]:
    """Intervals at which a stretch of rest or motion starts, and the end."""
    return (0, *(np.flatnonzero(np.diff(resting)) + 1).tolist(), len(resting))


def _still(value: float) -> Curve:
    return lambda at, order: np.full_like(at, 0.0 if order else value)


def _rising(time: Array, row: Array, smoothing: float) -> Curve:
    """A stretch between rests; its ends are at rest but for rounding, which is left out."""
    curve = curve_at_rest(time, row[None], smoothing)

    def at(when: Array, order: int) -> Array:
        found = curve(when, order)[0]
        return np.where((when == time[0]) | (when == time[-1]), 0.0, found) if order == 1 else found

    return at


def _periodic(time: Array, row: Array, smoothing: float) -> Curve:
    """A curve whose speed and acceleration are the same at both ends; a steady advance is left out and added."""
    from scipy.interpolate import CubicSpline

    kept, span, gap = thinned(time, smoothing), time[-1] - time[0], row[-1] - row[0]
    level = row - gap * (time - time[0]) / span
    if len(kept) < len(time):
        level = _means(time, level, smoothing)
    level = level[kept]
    level[-1] = level[0]
    through = CubicSpline(time[kept], level, bc_type="periodic")
    steady = (lambda at: gap * (at - time[0]) / span, lambda at: gap / span)
    return lambda at, order: np.asarray(through(at, order)) + (steady[order](at) if order < 2 else 0.0)


def _means(time: Array, row: Array, window: float) -> Array:
    """Values of local parabolas through a periodic row."""
    span, count = time[-1] - time[0], len(time) - 1
    around = np.concatenate([time[:-1] - span, time, time[1:] + span])
    wrapped = np.concatenate([row[:-1] - row[-1] + row[0], row, row[1:] - row[0] + row[-1]])
    return local_parabola(around, wrapped, window)[0][count : 2 * count + 1]


def _pieces(path: Path, time: Array, courses: Sequence[_Course], joints: Sequence[Joint]) -> JointMotion:
    """The curves at both ends of pieces that are short enough."""
    step, every = np.diff(time), np.arange(len(time) - 1)
    ends = (time[:-1], time[1:])
    speed = np.array([[np.abs(course.at(every, t, 1)) for t in ends] for course in courses]).max(axis=1)
    bend = np.array([np.abs(course.at(every, time[:-1] + step / 2.0, 3)) for course in courses]) * step**2 / 8.0
    share = (bend / np.maximum(speed.max(axis=1), _TINY)[:, None]).max(axis=0)
    turned = (speed * step * np.array([joint.turns for joint in joints])[:, None]).max(axis=0)
    count = np.ceil(np.maximum(np.sqrt(share / _BEND), turned / _TURN)).clip(1.0, _MOST_PARTS).astype(np.int64)
    if count.sum() > _MOST_PIECES:
        raise InputError(f"{path}: rows: {len(time)} found; expected a trajectory of at most {_MOST_PIECES} pieces")
    owner, place = places(count)
    starts = time[owner] + step[owner] * (place / count[owner])
    knots = (starts, np.append(starts[1:], time[-1]))
    found = [
        np.array([[course.at(owner, t, order) for course in courses] for t in knots]).transpose(2, 0, 1)
        for order in range(3)
    ]
    return JointMotion(tuple(joint.name for joint in joints), knots[1] - knots[0], *found)
