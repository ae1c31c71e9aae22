"""The pass: segments of a load cycle in pieces, the drive's current over each, and all that hangs on it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.one_pass.feeding import (
    add_energy,
    add_stored,
    at_stage,
    keep_largest,
    keep_power,
    keep_time_above,
    keep_voltage,
)
from drivesizer.physics.one_pass.heating import Map, followed, put_before, reach, top_within, warmed
from drivesizer.physics.one_pass.layout import Array

__all__: list[str] = []  # compiled into ``kernel``

Strides = NDArray[np.int64]


def currents(
    d: Array, w_0: float, w_1: float, a_0: float, a_1: float, load_0: float, load_1: float
) -> tuple[float, float]:
    """Current of the motor at both ends of a segment."""
    c, sign = d[at.AT_REST], 0.0
    if w_0 != 0.0 or w_1 != 0.0:
        both = w_0 + w_1
        c = d[at.DRIVING] if (load_0 + load_1) * both > 0.0 else d[at.BRAKING]
        sign = d[at.DIRECTION] if both > 0.0 else (-d[at.DIRECTION] if both < 0.0 else 0.0)
    first = c * load_0 + d[at.ACCELERATION] * a_0 + sign + d[at.SPEED] * w_0
    return first, c * load_1 + d[at.ACCELERATION] * a_1 + sign + d[at.SPEED] * w_1


def pieces(d: Array, changing: bool, t: float) -> int:
    """In how many pieces a segment is cut, so that the winding follows the mean of each."""
    if not changing or t <= at.CLOSE * d[at.QUICKEST]:
        return 1
    return int(min(math.ceil(math.sqrt(t / d[at.QUICKEST] / at.CLOSE)), at.FINEST))


def mean_square(a: float, b: float) -> float:
    """Mean of the square of a line."""
    return (a * a + a * b + b * b) / 3.0


def housing_loss(d: Array, a: float, b: float) -> float:
    """Mean loss at the housing over a piece, by the speeds at its ends [W]."""
    loss: float = d[at.FRICTION] * (abs(a) + abs(b)) / 2.0 + d[at.IRON] * mean_square(a, b)
    return loss


def steps_of(d: Array, square: float, t: float) -> int:
    """In how many steps a piece is taken, so that a series does."""
    size = reach(d, square, t)
    return 1 if size <= 1.0 else math.ceil(size)


def warm_up_to(d: Array, g: Array, square: float, loss: float, t: float, changing: bool) -> tuple[float, float, float]:
    """The rises after a piece; of the winding at its start and end as voltages take them, and the mean over it."""
    if d[at.FIXED] > 0.0:
        return d[at.AT_ENDS], d[at.AT_ENDS], d[at.MEANS]
    steps, start, total, top = steps_of(d, square, t), g[at.NOW_W], 0.0, -math.inf
    dt = t / steps
    for k in range(steps):
        w, h, mean, first, last = warmed(d, square, loss, dt, g[at.NOW_W], g[at.NOW_H])
        if first > 0.0 and last < 0.0 and (not changing or g[at.NOW_W] + dt * first > g[at.WINDING]):
            inner, when = top_within(d, square, loss, dt, g[at.NOW_W], g[at.NOW_H], first, last)
            keep_largest(g, at.WINDING, inner, g[at.TIME] + k * dt + when)
            top = max(top, inner)
        keep_largest(g, at.WINDING, w, g[at.TIME] + (k + 1) * dt)
        g[at.NOW_W], g[at.NOW_H] = w, h
        total += mean
    end = g[at.NOW_W]
    if not changing and top > max(start, end):
        start, end = (start, top) if end >= start else (top, end)
    return start, end, total / steps


def between(ends: tuple[float, float], share: float) -> float:
    """The value of a line after a share of the way."""
    return ends[0] + share * (ends[1] - ends[0])


def feed_half(
    d: Array, g: Array, i: tuple[float, float], w: tuple[float, float], v: tuple[float, float], mean: float,
    start: float, t: float,
) -> None:  # fmt: skip
    """Power and energy over a piece with a current of one sign; ``v``: voltages, the winding as warm as at its ends."""
    e_0, e_1 = d[at.SURPLUS] * w[0], d[at.SURPLUS] * w[1]
    more_0, more_1, ohm = at_stage(d, i[0], i[1], e_0, e_1, d[at.LOSS])
    more_0, more_1 = more_0 + ohm * i[0], more_1 + ohm * i[1]
    keep_power(g, i[0], i[1], v[0] + more_0, v[1] + more_1, start, t)
    if d[at.WANTED] < 2.0:
        return
    v_0, v_1 = d[at.EMF] * w[0] + mean * i[0], d[at.EMF] * w[1] + mean * i[1]
    add_energy(d, g, i[0], i[1], v_0 + more_0, v_1 + more_1, t)
    if d[at.KEPT] > 0.0:
        if d[at.LEAST_LOSS] != d[at.LOSS]:
            more_0, more_1, ohm = at_stage(d, i[0], i[1], e_0, e_1, d[at.LEAST_LOSS])
            more_0, more_1 = more_0 + ohm * i[0], more_1 + ohm * i[1]
        add_stored(d, g, i[0], i[1], v_0 + more_0, v_1 + more_1, t)


def feed(
    d: Array, g: Array, i: tuple[float, float], w: tuple[float, float], v: tuple[float, float], mean: float, t: float
) -> None:
    """Power and energy over a piece, in halves that meet where the current changes its sign."""
    if not i[0] * i[1] < 0.0:
        feed_half(d, g, i, w, v, mean, g[at.TIME], t)
        return
    share = i[0] / (i[0] - i[1])
    i_m, w_m, v_m = between(i, share), between(w, share), between(v, share)
    feed_half(d, g, (i[0], i_m), (w[0], w_m), (v[0], v_m), mean, g[at.TIME], share * t)
    feed_half(d, g, (i_m, i[1]), (w_m, w[1]), (v_m, v[1]), mean, g[at.TIME] + share * t, (1.0 - share) * t)


def go_through(d: Array, g: Array, i_0: float, i_1: float, w_0: float, w_1: float, t: float, changing: bool) -> None:
    """One piece."""
    if d[at.WANTED] != 0.0:
        keep_time_above(d, g, i_0, i_1, g[at.TIME], t)
    if d[at.WANTED] < 0.0:
        g[at.TIME] += t
        return
    square = mean_square(i_0, i_1)
    start, end, mean = warm_up_to(d, g, square, housing_loss(d, w_0, w_1), t, changing)
    v_0 = d[at.EMF] * w_0 + (d[at.R_AMBIENT] + d[at.R_RISE] * start) * i_0
    v_1 = d[at.EMF] * w_1 + (d[at.R_AMBIENT] + d[at.R_RISE] * end) * i_1
    R = d[at.R_AMBIENT] + d[at.R_RISE] * mean
    keep_voltage(d, g, i_0, v_0, g[at.TIME])
    keep_voltage(d, g, i_1, v_1, g[at.TIME] + t)
    g[at.COPPER] += R * square * t
    if d[at.WANTED] > 0.0:
        feed(d, g, (i_0, i_1), (w_0, w_1), (v_0, v_1), R, t)
    g[at.TIME] += t


def over_segment(
    d: Array, g: Array, t: float, w: tuple[float, float], a: tuple[float, float], load: tuple[float, float]
) -> None:
    """One segment."""
    i_0, i_1 = currents(d, w[0], w[1], a[0], a[1], load[0], load[1])
    changing = w[0] != w[1] or a[0] != a[1] or load[0] != load[1]
    count = pieces(d, changing, t)
    rise, turn = (i_1 - i_0) / count, (w[1] - w[0]) / count
    for k in range(count):
        i, j, x, y = i_0 + k * rise, i_0 + (k + 1) * rise, w[0] + k * turn, w[0] + (k + 1) * turn
        go_through(d, g, i, j, x, y, t / count, changing)


def map_segment(
    d: Array, m: Map, t: float, w: tuple[float, float], a: tuple[float, float], load: tuple[float, float]
) -> Map:
    """A map of rises with a segment after it."""
    i_0, i_1 = currents(d, w[0], w[1], a[0], a[1], load[0], load[1])
    count = pieces(d, w[0] != w[1] or a[0] != a[1] or load[0] != load[1], t)
    rise, turn, dt = (i_1 - i_0) / count, (w[1] - w[0]) / count, t / count
    for k in range(count):
        square = mean_square(i_0 + k * rise, i_0 + (k + 1) * rise)
        loss = housing_loss(d, w[0] + k * turn, w[0] + (k + 1) * turn)
        steps = steps_of(d, square, dt)
        for _ in range(steps):
            m = followed(d, m, square, loss, dt / steps)
    return m


def ends_of(column: Array, strides: Strides, place: int, k: int) -> tuple[float, float]:
    """Both ends of a segment."""
    first = k * strides[place]
    return column[first], column[first + strides[place + 1]]


def over_segments(
    d: Array, g: Array, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Strides
) -> None:
    """All segments, one after the other."""
    for k in range(len(duration)):
        w, a = ends_of(speed, strides, at.OF_SPEED, k), ends_of(acceleration, strides, at.OF_ACCELERATION, k)
        over_segment(d, g, duration[k], w, a, ends_of(torque, strides, at.OF_TORQUE, k))


def map_segments(
    d: Array, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Strides, first: int, last: int
) -> Map:
    """The map of rises over some segments, less one."""
    m = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for k in range(first, last):
        w, a = ends_of(speed, strides, at.OF_SPEED, k), ends_of(acceleration, strides, at.OF_ACCELERATION, k)
        m = map_segment(d, m, duration[k], w, a, ends_of(torque, strides, at.OF_TORQUE, k))
    return m


def forgets(g: Array) -> bool:
    """Whether what was before the blocks so far has no effect after them."""
    left: float = max(abs(1.0 + g[at.MAP]), abs(g[at.MAP + 1]), abs(g[at.MAP + 2]), abs(1.0 + g[at.MAP + 3]))
    return left < at.FORGOTTEN


def periodic_start(d: Array, g: Array) -> bool:
    """The rises that a cycle ends with as it started, from its map; False where they are not approached."""
    a, c, b, e = g[at.MAP], g[at.MAP + 1], g[at.MAP + 2], g[at.MAP + 3]
    w, h = g[at.MAP + 4], g[at.MAP + 5]
    determinant = a * e - b * c
    if not (determinant > 0.0 and a < 0.0 and math.isfinite(determinant + h)):
        return False
    d[at.PERIODIC_W], d[at.PERIODIC_H] = (b * h - e * w) / determinant, (c * w - a * h) / determinant
    return True


def pass_over(
    d: Array, g: Array, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Strides
) -> int:
    """One drive over a cycle in periodic steady state; 1 where its winding runs away and nothing is found."""
    count = len(duration)
    if d[at.FIXED] == 0.0:
        last = count
        while last > 0 and not forgets(g):  # from the end, as far back as it has an effect
            first = max(last - at.AT_ONCE, 0)
            put_before(g, map_segments(d, duration, speed, acceleration, torque, strides, first, last))
            last = first
        if not periodic_start(d, g):
            return 1
        g[at.NOW_W], g[at.NOW_H] = d[at.PERIODIC_W], d[at.PERIODIC_H]
    over_segments(d, g, duration, speed, acceleration, torque, strides)
    return 1 if d[at.FIXED] == 0.0 and not g[at.WINDING] < at.BEYOND else 0
