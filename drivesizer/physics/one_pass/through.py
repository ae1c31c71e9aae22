"""The pass: segments of a load cycle in pieces, the drive's current over each, and all that hangs on it."""

from __future__ import annotations

import math

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.one_pass.feeding import (
    add_energy,
    add_stored,
    add_to_piece,
    at_stage,
    begin_piece,
    keep_piece,
    keep_power,
    keep_powers,
    keep_time_above,
    keep_voltage,
)
from drivesizer.physics.one_pass.heating import Map, put_before
from drivesizer.physics.one_pass.layout import Array
from drivesizer.physics.one_pass.pieces import Strides, map_pieces, put_losses, take, warm

__all__: list[str] = []  # compiled into ``kernel``


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
    if d[at.WANTED] > 2.0:
        add_to_piece(g, i[0], i[1], v_0 + more_0, v_1 + more_1, t)
        keep_powers(g, i[0], i[1], v[0] + more_0, v[1] + more_1)
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


def put_through(d: Array, g: Array, s: Array, p: Array, k: int) -> None:
    """One piece, its rises known."""
    i_0, i_1, w_0, w_1, t = s[at.I_0 + k], s[at.I_1 + k], s[at.W_0 + k], s[at.W_1 + k], s[at.T + k]
    v_0 = d[at.EMF] * w_0 + (d[at.R_AMBIENT] + d[at.R_RISE] * s[at.START + k]) * i_0
    v_1 = d[at.EMF] * w_1 + (d[at.R_AMBIENT] + d[at.R_RISE] * s[at.END + k]) * i_1
    R = d[at.R_AMBIENT] + d[at.R_RISE] * s[at.MEAN + k]
    keep_voltage(d, g, i_0, v_0, g[at.TIME])
    keep_voltage(d, g, i_1, v_1, g[at.TIME] + t)
    g[at.COPPER] += R * s[at.SQUARE + k] * t
    if d[at.WANTED] > 0.0:
        begin_piece(g)
        feed(d, g, (i_0, i_1), (w_0, w_1), (v_0, v_1), R, t)
        if d[at.WANTED] > 2.0:
            keep_piece(d, g, p, t)


def go_through(d: Array, g: Array, s: Array, p: Array, n: int) -> None:
    """Some pieces."""
    if d[at.WANTED] >= 0.0:
        put_losses(d, s, n)
        warm(d, g, s, n)
    for k in range(n):
        if d[at.WANTED] != 0.0:
            keep_time_above(d, g, s[at.I_0 + k], s[at.I_1 + k], g[at.TIME], s[at.T + k])
        if d[at.WANTED] >= 0.0:
            put_through(d, g, s, p, k)
        g[at.TIME] += s[at.T + k]


def over_segments(
    d: Array, g: Array, s: Array, p: Array, duration: Array, speed: Array, acceleration: Array, torque: Array,
    strides: Strides,
) -> None:  # fmt: skip
    """All segments, one after the other."""
    first = 0
    while first < len(duration):
        first, n = take(d, s, first, len(duration), duration, speed, acceleration, torque, strides)
        go_through(d, g, s, p, n)


def map_segments(
    d: Array, s: Array, duration: Array, speed: Array, acceleration: Array, torque: Array, strides: Strides, first: int,
    last: int,
) -> Map:  # fmt: skip
    """The map of rises over some segments, less one."""
    m = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    while first < last:
        first, n = take(d, s, first, last, duration, speed, acceleration, torque, strides)
        put_losses(d, s, n)
        m = map_pieces(d, s, n, m)
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
    d: Array, g: Array, s: Array, p: Array, duration: Array, speed: Array, acceleration: Array, torque: Array,
    strides: Strides,
) -> int:  # fmt: skip
    """One drive over a cycle in periodic steady state; 1 where its winding runs away and nothing is found."""
    count = len(duration)
    if d[at.FIXED] == 0.0:
        last = count
        while last > 0 and not forgets(g):  # from the end, as far back as it has an effect
            first = max(last - at.AT_ONCE, 0)
            put_before(g, map_segments(d, s, duration, speed, acceleration, torque, strides, first, last))
            last = first
        if not periodic_start(d, g):
            return 1
        g[at.NOW_W], g[at.NOW_H] = d[at.PERIODIC_W], d[at.PERIODIC_H]
    over_segments(d, g, s, p, duration, speed, acceleration, torque, strides)
    return 1 if d[at.FIXED] == 0.0 and not g[at.WINDING] < at.BEYOND else 0
