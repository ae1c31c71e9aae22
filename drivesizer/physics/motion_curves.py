"""Curves of motion: local parabolas through recorded ones, and the fastest under limits of speed up to jerk."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from drivesizer.physics.figures import Array, Mask, Whole

Column = Array
_PART = 1 << 16  # samples of a long recording at a time
_SLACK = 1e-9  # of a window: a sample on its edge is in it, whatever rounding makes of its time
_LEAST_BEND = 0.01  # share of the fourth moment that the times' bend must keep; below it, they are in two bunches


def local_parabola(time: Column, value: Column, window: float) -> tuple[Column, Column]:
    """Value and slope, at each sample, of the parabola fitted to the samples around it.

    Parameters
    ----------
    time
        Rising, three or more, even or not [s].
    value
        The recorded quantity.
    window
        Width around each sample [s]; three samples where it holds fewer.

    Returns
    -------
    tuple
        Values, and slopes per second.

    Examples
    --------
    >>> time = np.array([0.0, 1.0, 3.0, 4.0, 7.0])
    >>> local_parabola(time, time**2, 5.0)[1]
    array([ 0., 2., 6., 8., 14.])
    """
    half = window / 2 * (1 + _SLACK)
    fit, slope = np.empty_like(time), np.empty_like(time)
    many, widest = np.empty(len(time), bool), 0
    for k in range(0, len(time), _PART):
        rows = slice(k, k + _PART)
        near = slice(max(k - 2, 0), k + _PART + 2)
        fitted = _three_points(time[near], value[near])
        fit[rows], slope[rows] = (x[rows.start - near.start :][: len(time[rows])] for x in fitted)
        first, end = _windows(time, time[rows], half)
        many[rows], widest = end - first >= 4, max(widest, int((end - first).max()))
    for at in _numbers(many, max(_PART, 4 * widest)):  # so that few samples are looked at twice
        first, end = _windows(time, time[at], half)
        start = int(np.searchsorted(time, time[first[0]] - 7 * half)) if len(time) > _PART else 0  # a bin before it
        near = slice(start, end[-1])
        fit[at], slope[at] = _least_squares(time[near], value[near], half, at - start, first - start, end - start)
    return fit, slope


def periodic_parabola(time: Column, value: Column, window: float) -> tuple[Column, Column]:
    """The same of what repeats from its last sample on, as far above or below the first as the last is.

    Parameters
    ----------
    time, value, window
        As for :func:`local_parabola`.

    Returns
    -------
    tuple
        Values, and slopes per second.
    """
    around = [np.append(c[:-1] - c[-1] + c[0], np.append(c, c[1:] + c[-1] - c[0])) for c in (time, value)]
    fit, slope = local_parabola(around[0], around[1], window)
    return fit[len(time) - 1 : 2 * len(time) - 1], slope[len(time) - 1 : 2 * len(time) - 1]


def _numbers(mask: Mask, count: int) -> Iterator[Whole]:
    """Numbers of those that are chosen, so many at a time: all of a long recording's take room."""
    left = np.zeros(0, np.int64)
    for k in range(0, len(mask), count):
        left = np.concatenate([left, k + np.flatnonzero(mask[k : k + count])])
        if len(left) >= count:
            yield left[:count]
            left = left[count:]
    if len(left):
        yield left


def _windows(time: Column, middle: Column, half: float) -> tuple[Whole, Whole]:
    """First sample of windows, and the one behind their last."""
    return np.searchsorted(time, middle - half, side="left"), np.searchsorted(time, middle + half, side="right")


def _three_points(time: Column, value: Column) -> tuple[Column, Column]:
    """The parabola through each sample and its neighbours; at both ends, through the nearest three."""
    step, rise = np.diff(time), np.diff(value)
    chord = rise / step
    bend = np.diff(chord) / (step[:-1] + step[1:])
    slope = np.empty_like(time)
    slope[1:-1] = chord[:-1] + bend * step[:-1]
    slope[0] = chord[0] - bend[0] * step[0]
    slope[-1] = chord[-1] + bend[-1] * step[-1]
    return value.copy(), slope


def _least_squares(
    time: Column, value: Column, half: float, at: Whole, first: Whole, end: Whole
) -> tuple[Column, Column]:
    """The parabola in windows of four samples or more, all within half a window of the sample.

    Sums over windows are differences of cumulative sums. So that these stay small numbers, time and value count from
    the middle and from the first sample of bins three windows wide; there are two rows of bins, half a bin apart, and a
    window lies in a bin of one of them for certain.
    """
    fit, slope = np.empty(len(at)), np.empty(len(at))
    for row in (0.0, 0.5):
        number = np.floor(time / (6 * half) + row)
        inside = number[first] == number[end - 1]
        s = (time - (number + 0.5 - row) * 6 * half) / half
        start = value[np.searchsorted(number, number, side="left")]
        rows = at[inside]
        fitted = _fitted(s, value - start, s[rows], first[inside], end[inside])
        fit[inside], slope[inside] = fitted[0] + start[rows], fitted[1] / half
    return fit, slope


def _fitted(s: Column, y: Column, here: Column, first: Whole, end: Whole) -> tuple[Column, Column]:
    """Value and slope of the least-squares parabola of y over s in each window, by polynomials orthogonal on it."""

    def total(column: Column) -> Column:
        sums: Column = np.concatenate([[0.0], np.cumsum(column)])
        return sums[end] - sums[first]

    n = (end - first).astype(float)
    mean, level = total(s) / n, total(y) / n
    s2, s3, s4 = (total(s**k) for k in (2, 3, 4))  # power sums about zero, then about the mean
    m2, m3 = s2 - n * mean**2, s3 - 3 * mean * s2 + 2 * n * mean**3
    m4 = s4 - 4 * mean * s3 + 6 * mean**2 * s2 - 3 * n * mean**4
    sy, ssy = total(s * y), total(s * s * y)
    y1 = sy - n * mean * level
    y2 = ssy - 2 * mean * sy + n * mean**2 * level
    skew = m3 / m2
    bend = m4 - skew * m3 - m2**2 / n
    curved = bend > _LEAST_BEND * m4
    c2 = np.where(curved, (y2 - skew * y1 - m2 * level) / np.where(curved, bend, 1.0), 0.0)
    u, c1 = here - mean, y1 / m2
    return level + c1 * u + c2 * (u**2 - skew * u - m2 / n), c1 + c2 * (2 * u - skew)


def fastest_ramp(distance: float, speed: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """Times of the fastest move [s]: of each jerk phase, at the greatest acceleration, at the greatest speed.

    From ruckig, whose tolerances are fixed numbers: distance and time are scaled to those of the move, and
    a distance longer than needed to reach the speed is cut short, which leaves the ramps as they are.

    Parameters
    ----------
    distance
        From rest to rest [m].
    speed, acceleration, jerk
        Limits [m/s], [m/s^2], [m/s^3], above 0; an infinite jerk is no limit: no time in a jerk phase.

    Returns
    -------
    tuple of floats
        The three times [s].

    Raises
    ------
    ArithmeticError
        When there is no such move within the range of numbers.
    """
    v, a, j = speed, acceleration, jerk
    if math.isinf(j):
        up = min(v / a, math.sqrt(distance / a))
        return 0.0, up, max(distance / (a * up) - up, 0.0)
    import ruckig

    length = min(distance, 4 * v * max(v / a, math.sqrt(v / j)))
    unit = max(length / v, 2 * math.sqrt(length / a), math.cbrt(32 * length / j))
    task, trajectory = ruckig.InputParameter(1), ruckig.Trajectory(1)
    task.target_position = [1.0]
    limits = [v * unit / length, a * unit * unit / length, j * unit * unit * unit / length]
    task.max_velocity, task.max_acceleration, task.max_jerk = ([limit] for limit in limits)
    try:
        ruckig.Ruckig(1).calculate(task, trajectory)
    except ruckig.RuckigError as error:
        raise ArithmeticError(str(error)) from None
    t = trajectory.profiles[0][
        0
    ].t  # of the seven phases; from rest to rest the last three are the first three, mirrored
    return t[0] * unit, t[1] * unit, t[3] * unit + (distance - length) / v
