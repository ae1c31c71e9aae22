"""Some pieces of a cycle at a time: the drive's current over each, and how warm its winding is; see ``layout``.

Loop after loop over these few pieces, which stay in the processor's cache: in each the pieces do not wait for one
another, but for the rises, which go from piece to piece.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.one_pass.feeding import keep_largest
from drivesizer.physics.one_pass.heating import Map, followed, joined, reach, top_within, transition, warmed
from drivesizer.physics.one_pass.layout import Array

__all__: list[str] = []  # compiled into ``kernel``

Strides = NDArray[np.int64]


def mean_square(a: float, b: float) -> float:
    """Mean of the square of a line."""
    return (a * a + a * b + b * b) / 3.0


def ends_of(column: Array, strides: Strides, place: int, k: int) -> tuple[float, float]:
    """Both ends of a segment."""
    first = k * strides[place]
    return column[first], column[first + strides[place + 1]]


def copy(
    s: Array, first: int, last: int, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Strides
) -> None:
    """Segments as pieces."""
    for k in range(first, last):
        n = k - first
        s[at.T + n] = duration[k]
        s[at.W_0 + n], s[at.W_1 + n] = ends_of(speed, strides, at.OF_SPEED, k)
        s[at.A_0 + n], s[at.A_1 + n] = ends_of(acceleration, strides, at.OF_ACCELERATION, k)
        s[at.LOAD_0 + n], s[at.LOAD_1 + n] = ends_of(torque, strides, at.OF_TORQUE, k)


def put_currents(d: Array, s: Array, n: int) -> None:
    """Current of the motor at both ends of segments, and in which of them nothing changes."""
    driving, braking, at_rest = d[at.DRIVING], d[at.BRAKING], d[at.AT_REST]
    by_acceleration, direction, by_speed = d[at.ACCELERATION], d[at.DIRECTION], d[at.SPEED]
    for k in range(n):
        w_0, w_1, load_0, load_1 = s[at.W_0 + k], s[at.W_1 + k], s[at.LOAD_0 + k], s[at.LOAD_1 + k]
        a_0, a_1, both = s[at.A_0 + k], s[at.A_1 + k], w_0 + w_1
        c = driving if (load_0 + load_1) * both > 0.0 else braking
        c = at_rest if (w_0 == 0.0) & (w_1 == 0.0) else c
        sign = direction if both > 0.0 else (-direction if both < 0.0 else 0.0)
        s[at.I_0 + k] = c * load_0 + by_acceleration * a_0 + sign + by_speed * w_0
        s[at.I_1 + k] = c * load_1 + by_acceleration * a_1 + sign + by_speed * w_1
        s[at.STEADY + k] = 1.0 if (w_0 == w_1) & (a_0 == a_1) & (load_0 == load_1) else 0.0


def put_counts(d: Array, s: Array, n: int) -> int:
    """In how many pieces segments are cut, so that the winding follows the mean of each; the number of all."""
    quickest, whole, total = d[at.QUICKEST], at.CLOSE * d[at.QUICKEST], 0
    for k in range(n):
        t = s[at.T + k]
        count = min(math.ceil(math.sqrt(t / quickest / at.CLOSE)), at.FINEST * 1.0)
        s[at.COUNT + k] = 1.0 if (s[at.STEADY + k] > 0.0) | (t <= whole) else count
    for k in range(n):
        total += int(s[at.COUNT + k])
    return total


def cut(d: Array, s: Array, n: int) -> tuple[int, int]:
    """Segments in pieces, as many as there is room for: how many of them, and the number of their pieces."""
    count = put_counts(d, s, n)
    while count > at.ROOM:
        n -= 1
        count -= int(s[at.COUNT + n])
    last = count
    for k in range(n - 1, -1, -1):  # from behind, as none is put where one still has to be read
        if last == k + 1:
            break
        last -= int(s[at.COUNT + k])
        cut_one(s, k, last, int(s[at.COUNT + k]))
    return n, count


def cut_one(s: Array, k: int, place: int, count: int) -> None:
    """One segment in so many pieces from a place on that is not before its own."""
    t, steady, i, w = s[at.T + k], s[at.STEADY + k], s[at.I_0 + k], s[at.W_0 + k]
    rise, turn, i_1, w_1 = (s[at.I_1 + k] - i) / count, (s[at.W_1 + k] - w) / count, s[at.I_1 + k], s[at.W_1 + k]
    for n in range(count):
        p = place + n
        s[at.T + p], s[at.STEADY + p] = t / count, steady
        s[at.I_0 + p], s[at.I_1 + p] = i + n * rise, i_1 if count == 1 else i + (n + 1) * rise
        s[at.W_0 + p], s[at.W_1 + p] = w + n * turn, w_1 if count == 1 else w + (n + 1) * turn


def take(
    d: Array, s: Array, first: int, last: int, duration: Array, speed: Array, acceleration: Array, torque: Array,
    strides: Strides,
) -> tuple[int, int]:  # fmt: skip
    """Pieces of the segments from one on, as many as there is room for: the next segment, and their number."""
    last = min(last, first + at.FINEST)
    copy(s, first, last, duration, speed, acceleration, torque, strides)
    put_currents(d, s, last - first)
    if d[at.WANTED] < 0.0:  # nothing is to follow a mean
        return last, last - first
    taken, count = cut(d, s, last - first)
    return first + taken, count


def put_losses(d: Array, s: Array, n: int) -> None:
    """Mean square of the current over pieces, and mean loss at the housing by the speeds at its ends [W]."""
    friction, iron = d[at.FRICTION], d[at.IRON]
    for k in range(n):
        a, b = s[at.W_0 + k], s[at.W_1 + k]
        s[at.SQUARE + k] = mean_square(s[at.I_0 + k], s[at.I_1 + k])
        s[at.HOUSING + k] = friction * (abs(a) + abs(b)) / 2.0 + iron * mean_square(a, b)


def put_transitions(d: Array, s: Array, n: int) -> bool:
    """Put what pieces add to the rises of winding and housing; give whether any is too long for that."""
    c = (
        d[at.FACTORS + 2], d[at.FACTORS + 3], d[at.FACTORS + 4], d[at.FACTORS + 5], d[at.FACTORS + 6],
        d[at.FACTORS + 7], d[at.FACTORS + 8], d[at.FACTORS + 9],
    )  # fmt: skip
    feedback, own, wh, hw, hh = d[at.FEEDBACK], d[at.W_W], d[at.W_H], d[at.H_W], d[at.H_H]
    heat_w, heat_h, others, long = d[at.HEAT_W], d[at.HEAT_H], d[at.W_H] + d[at.H_W] + abs(d[at.H_H]), 0.0
    for k in range(n):
        t, square = s[at.T + k], s[at.SQUARE + k]
        ww = feedback * square + own
        found = transition(c, (ww, wh, hw, hh), t, heat_w * square, heat_h * s[at.HOUSING + k])
        s[at.Q_0 + k], s[at.Q_1 + k] = found[0], found[1]
        s[at.BY_W_W + k], s[at.BY_H_W + k], s[at.MORE_W + k] = found[2], found[3], found[4]
        s[at.BY_W_H + k], s[at.BY_H_H + k], s[at.MORE_H + k] = found[5], found[6], found[7]
        s[at.LONG + k] = 1.0 if (abs(ww) + others) * t > at.BRIEF else 0.0
    for k in range(n):
        long += s[at.LONG + k]
    return long > 0.0


def steps_of(d: Array, square: float, t: float) -> int:
    """In how many steps a piece is taken, so that a series does."""
    size = reach(d, square, t)
    return 1 if size <= 1.0 else math.ceil(size)


def keep_top(
    d: Array, g: Array, square: float, loss: float, t: float, first: float, last: float, start: float
) -> float:
    """Keep the highest rise within a piece at whose ends it rises and falls; that rise."""
    inner, when = top_within(d, square, loss, t, g[at.NOW_W], g[at.NOW_H], first, last)
    keep_largest(g, at.WINDING, inner, start + when)
    return inner


def put_rises(s: Array, k: int, start: float, end: float, mean: float, top: float) -> None:
    """Keep the rises of a piece as voltages take them: with its top, where nothing else changes in it."""
    if s[at.STEADY + k] > 0.0 and top > max(start, end):
        start, end = (start, top) if end >= start else (top, end)
    s[at.START + k], s[at.END + k], s[at.MEAN + k] = start, end, mean


def warm_in_steps(d: Array, g: Array, s: Array, k: int, time: float) -> None:
    """The rises after a piece that may be too long for a short series."""
    t, square, loss = s[at.T + k], s[at.SQUARE + k], s[at.HOUSING + k]
    steps, start, total, top = steps_of(d, square, t), g[at.NOW_W], 0.0, -math.inf
    dt = t / steps
    for n in range(steps):
        w, h, mean, first, last = warmed(d, square, loss, dt, g[at.NOW_W], g[at.NOW_H])
        if first > 0.0 and last < 0.0 and (s[at.STEADY + k] > 0.0 or g[at.NOW_W] + dt * first > g[at.WINDING]):
            top = max(top, keep_top(d, g, square, loss, dt, first, last, time + n * dt))
        keep_largest(g, at.WINDING, w, time + (n + 1) * dt)
        g[at.NOW_W], g[at.NOW_H] = w, h
        total += mean
    put_rises(s, k, start, g[at.NOW_W], total / steps, top)


def put_ends(g: Array, s: Array, n: int) -> None:
    """The rises at the ends of short pieces, from one to the next."""
    w, h = g[at.NOW_W], g[at.NOW_H]
    for k in range(n):
        s[at.W + k], s[at.H + k] = w, h
        more_w = s[at.BY_W_W + k] * w + s[at.BY_H_W + k] * h + s[at.MORE_W + k]
        more_h = s[at.BY_W_H + k] * w + s[at.BY_H_H + k] * h + s[at.MORE_H + k]
        w, h = w + more_w, h + more_h
    s[at.W + n], s[at.H + n] = w, h


def put_means(d: Array, s: Array, n: int) -> None:
    """Slopes of the winding's rise at the ends of short pieces, and its mean over each."""
    feedback, own, wh, hw, hh = d[at.FEEDBACK], d[at.W_W], d[at.W_H], d[at.H_W], d[at.H_H]
    heat_w, heat_h = d[at.HEAT_W], d[at.HEAT_H]
    for k in range(n):
        w, h, after, square = s[at.W + k], s[at.H + k], s[at.W + k + 1], s[at.SQUARE + k]
        ww, heat = feedback * square + own, heat_w * square
        first = ww * w + wh * h + heat
        pull = ww * first + wh * (hw * w + hh * h + heat_h * s[at.HOUSING + k])
        s[at.SLOPE_0 + k], s[at.SLOPE_1 + k] = first, ww * after + wh * s[at.H + k + 1] + heat
        s[at.START + k], s[at.END + k] = w, after
        s[at.MEAN + k] = w + s[at.T + k] * (s[at.Q_0 + k] * first + s[at.Q_1 + k] * pull)


def keep_tops(d: Array, g: Array, s: Array, n: int) -> None:
    """Keep the winding's highest rise at the ends of short pieces and within them."""
    time = g[at.TIME]
    for k in range(n):
        t, first, last = s[at.T + k], s[at.SLOPE_0 + k], s[at.SLOPE_1 + k]
        if first > 0.0 and last < 0.0 and (s[at.STEADY + k] > 0.0 or s[at.W + k] + t * first > g[at.WINDING]):
            g[at.NOW_W], g[at.NOW_H] = s[at.W + k], s[at.H + k]
            top = keep_top(d, g, s[at.SQUARE + k], s[at.HOUSING + k], t, first, last, time)
            put_rises(s, k, s[at.W + k], s[at.W + k + 1], s[at.MEAN + k], top)
        keep_largest(g, at.WINDING, s[at.W + k + 1], time + t)
        time += t
    g[at.NOW_W], g[at.NOW_H] = s[at.W + n], s[at.H + n]


def warm(d: Array, g: Array, s: Array, n: int) -> None:
    """The rises over pieces, from one to the next, and the winding's highest."""
    if d[at.FIXED] > 0.0:
        for k in range(n):
            s[at.START + k], s[at.END + k], s[at.MEAN + k] = d[at.AT_ENDS], d[at.AT_ENDS], d[at.MEANS]
    elif put_transitions(d, s, n):
        time = g[at.TIME]
        for k in range(n):
            warm_in_steps(d, g, s, k, time)
            time += s[at.T + k]
    else:
        put_ends(g, s, n)
        put_means(d, s, n)
        keep_tops(d, g, s, n)


def map_pieces(d: Array, s: Array, n: int, m: Map) -> Map:
    """A map of rises less one with pieces after it."""
    long = put_transitions(d, s, n)
    for k in range(n):
        if long:
            t, square, loss = s[at.T + k], s[at.SQUARE + k], s[at.HOUSING + k]
            steps = steps_of(d, square, t)
            for _ in range(steps):
                m = followed(d, m, square, loss, t / steps)
        else:
            m = joined(m, s, k)
    return m
