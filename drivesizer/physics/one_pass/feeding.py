"""Peaks, power and energy of a drive over a piece of its cycle; arrays as in ``layout``.

The figures are those of ``waveform`` and ``power_stage``: current and voltage are straight lines within a piece.
"""

from __future__ import annotations

import math

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.groups.look import below
from drivesizer.physics.one_pass.layout import Array

__all__: list[str] = []  # compiled into ``kernel``


def keep_largest(g: Array, place: int, value: float, t: float) -> None:
    """Keep the largest value, and the first that is no less but by rounding; an unknown one is kept for good."""
    if not value <= g[place]:
        g[place] = value
        if not g[place + 1] >= min(value * (1.0 - at.ALIKE), value * (1.0 + at.ALIKE)):
            g[place + 1], g[place + 2] = value, t


def keep_voltage(d: Array, g: Array, i: float, v: float, t: float) -> None:
    """Keep the largest voltage, with what resistances take where that makes it more."""
    keep_largest(g, at.VOLTAGE, max(abs(v), abs(v + d[at.LEADS] * i)) if d[at.LEADS] > 0.0 else abs(v), t)


def at_stage(d: Array, i_0: float, i_1: float, e_0: float, e_1: float, loss: float) -> tuple[float, float, float]:
    """Additions to the voltage at both ends, of a current of one sign, and per ampere, for the power into the stage.

    ``e``: by how much the induced voltage is above torque constant times speed (``waveform.balanced``).
    """
    both = i_0 + i_1
    sign = 1.0 if both > 0.0 else (-1.0 if both < 0.0 else 0.0)
    twice = -2.0 if both * (e_0 + e_1) < 0.0 else 0.0
    return twice * e_0 + loss * sign, twice * e_1 + loss * sign, d[at.OHM]


def largest_power(i_0: float, i_1: float, v_0: float, v_1: float) -> tuple[float, float]:
    """The largest power, at an end or at the vertex between them, and after which share of the time."""
    rise_i, rise_v = i_1 - i_0, v_1 - v_0
    first, last, slope = i_0 * v_0, i_1 * v_1, i_0 * rise_v + v_0 * rise_i
    bend = rise_i * rise_v
    share = 1.0 if last > first else 0.0
    if bend < 0.0 and slope > 0.0 and slope + 2.0 * bend < 0.0:
        share = -slope / (2.0 * bend)
    return (i_0 + share * rise_i) * (v_0 + share * rise_v), share


def keep_power(g: Array, i_0: float, i_1: float, v_0: float, v_1: float, start: float, t: float) -> None:
    """Keep the largest power."""
    power, share = largest_power(i_0, i_1, v_0, v_1)
    keep_largest(g, at.POWER, power, start + share * t)


def source_heat(d: Array, i_0: float, v_0: float, rise_i: float, rise_v: float, low: float, high: float) -> float:
    """Mean heat of the supply's resistance, while power is drawn, times the share of the piece in which it is [W]."""
    heat, width = 0.0, high - low
    if width <= 0.0:
        return 0.0
    for k in range(at.POINTS):
        x = low + width * d[at.NODES + k]
        power = max((i_0 + x * rise_i) * (v_0 + x * rise_v), 0.0) + d[at.STANDBY]
        if power > 0.0:
            every = power * d[at.DRIVES]
            root = math.sqrt(d[at.SOURCE] * d[at.SOURCE] - 4.0 * d[at.RESISTANCE] * every)
            current = 2.0 * every / (d[at.SOURCE] + root) if root >= 0.0 else math.inf
            heat += d[at.NODES + at.POINTS + k] * (d[at.SOURCE] * current / d[at.DRIVES] - power)
    return heat * width


def add_work(d: Array, g: Array, work: float) -> None:
    """Add energy of one sign, drawn or returned."""
    if work >= 0.0:
        g[at.DRAWN] += work
    else:
        g[at.RETURNED] -= work


def put_in_store(d: Array, g: Array, work: float) -> None:
    """Fill a store with what is returned and stays on the bus; what is drawn goes out of it."""
    came = -work * d[at.KEPT] if work < 0.0 else 0.0
    g[at.CAME] += came
    g[at.SUM] += came - max(work, 0.0)
    g[at.LOWEST] = min(g[at.LOWEST], g[at.SUM])
    g[at.HIGHEST] = max(g[at.HIGHEST], g[at.SUM])
    g[at.LEVEL] = max(g[at.LEVEL] + (came - max(work, 0.0)), 0.0)  # not the sum above its lowest: that has less digits
    g[at.RISEN] = max(g[at.RISEN], g[at.LEVEL])


def works(i_0: float, i_1: float, v_0: float, v_1: float) -> tuple[float, float, float]:
    """Mean power up to where the voltage changes its sign, and from there on, times their shares; that share."""
    rise_i, rise_v = i_1 - i_0, v_1 - v_0
    bend, slope = rise_i * rise_v / 3.0, (i_0 * rise_v + v_0 * rise_i) / 2.0
    whole = i_0 * v_0 + (slope + bend)
    if v_0 * v_1 < 0.0:
        cut = v_0 / (v_0 - v_1)
        first = cut * (i_0 * v_0 + cut * (slope + cut * bend))
        return first, whole - first, cut
    return whole, 0.0, 1.0


def begin_piece(g: Array) -> None:
    """A piece of which nothing is known yet."""
    g[at.TOOK], g[at.GAVE], g[at.OUT], g[at.BACK] = 0.0, 0.0, 0.0, 0.0


def add_to_piece(g: Array, i_0: float, i_1: float, v_0: float, v_1: float, t: float) -> None:
    """Add what is drawn and returned over a part of a piece, with a current of one sign."""
    first, second, _ = works(i_0, i_1, v_0, v_1)
    g[at.TOOK] += (max(first, 0.0) + max(second, 0.0)) * t
    g[at.GAVE] += (max(-first, 0.0) + max(-second, 0.0)) * t


def keep_powers(g: Array, i_0: float, i_1: float, v_0: float, v_1: float) -> None:
    """Keep the largest power of a piece in either direction."""
    g[at.OUT] = max(g[at.OUT], largest_power(i_0, i_1, v_0, v_1)[0])
    g[at.BACK] = max(g[at.BACK], largest_power(i_0, i_1, -v_0, -v_1)[0])


def keep_piece(d: Array, g: Array, p: Array, t: float) -> None:
    """Put a piece behind those that are kept, or into the last one where neither returns anything."""
    last = int(g[at.KEPT_PIECES]) - 1
    if d[at.WANTED] == 3.0 and last >= 0 and g[at.GAVE] == 0.0 and p[2, last] == 0.0:
        p[0, last] += t
        p[1, last] += g[at.TOOK]
        p[4, last] = max(p[4, last], g[at.OUT])
        return
    p[0, last + 1], p[1, last + 1], p[2, last + 1] = t, g[at.TOOK], g[at.GAVE]
    p[3, last + 1], p[4, last + 1] = g[at.BACK], g[at.OUT]
    g[at.KEPT_PIECES] += 1.0


def add_energy(d: Array, g: Array, i_0: float, i_1: float, v_0: float, v_1: float, t: float) -> None:
    """Energy drawn and returned over a piece, with a current of one sign; and the heat of the supply's resistance."""
    first, second, cut = works(i_0, i_1, v_0, v_1)
    add_work(d, g, first * t)
    add_work(d, g, second * t)
    if d[at.RESISTANCE] > 0.0:
        heat = source_heat(d, i_0, v_0, i_1 - i_0, v_1 - v_0, 0.0, cut)
        g[at.DRAWN] += t * (heat + source_heat(d, i_0, v_0, i_1 - i_0, v_1 - v_0, cut, 1.0))


def add_stored(d: Array, g: Array, i_0: float, i_1: float, v_0: float, v_1: float, t: float) -> None:
    """Keep what stays of that on the bus."""
    first, second, _ = works(i_0, i_1, v_0, v_1)
    put_in_store(d, g, first * t)
    put_in_store(d, g, second * t)


def keep_time_above(d: Array, g: Array, i_0: float, i_1: float, start: float, t: float) -> None:
    """Keep the longest time without a break above a limit."""
    enter, leave = 0.0, 1.0
    if max(abs(i_0), abs(i_1)) > d[at.LIMIT]:
        enter, leave = below(d[at.LIMIT], i_0, i_1)
    if enter > 1.0:
        return
    if g[at.BEGIN] < 0.0:
        g[at.FIRST] = start + enter * t
    else:
        g[at.RUN] = max(g[at.RUN], start + enter * t - g[at.BEGIN])
    g[at.BEGIN] = start + leave * t
