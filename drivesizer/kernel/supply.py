r"""Power and energy of a piece at motor, power stage and source, and times above a current.

.. math::

    P &= V I + \max(0,\ 2 (k_t - k_e) w I), \qquad V = k_e w + R I \\
    P_{in} &= P + V_l |I| + R_b I^2, \qquad V_s I_s = P_{in} + P_0, \quad V_s = V_0 - n R_s I_s

Current and voltage are straight lines within a piece, so power is a product of two lines: its sign changes where one
of theirs does, and it is largest at an end or at the vertex between. Within a stretch of one sign of the current the
losses are a voltage beside V.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from drivesizer.kernel.records import Drive
from drivesizer.physics.gear_life import SIX

ALIKE = 1e-9  # share by which values differ that are alike
NODES = tuple((1.0 + float(node)) / 2.0 for node in SIX[0])  # of a quadrature from 0 to 1
WEIGHTS = tuple(float(weight) / 2.0 for weight in SIX[1])


class Top(NamedTuple):
    """A largest value, and value and time of the first that is no less but by rounding."""

    value: float
    first: float
    time: float


class Above(NamedTuple):
    """Times above a limit so far: the longest, the end of what is above at first, the begin of the last, all [s]."""

    longest: float
    end: float
    begin: float  # below 0: it was never below the limit
    in_all: float


class Store(NamedTuple):
    """A store that is empty at first, filled by what is returned and emptied by what is drawn [J]."""

    sum: float
    lowest: float
    highest: float
    level: float
    risen: float
    came: float


class Line(NamedTuple):
    """Current and a voltage over a stretch with a current of one sign."""

    I_0: float
    I_1: float
    V_0: float
    V_1: float


class Work(NamedTuple):
    """Work over a stretch before and after the voltage changes its sign, per time of the stretch [W]; and where [1]."""

    first: float
    second: float
    cut: float


def larger(top: Top, value: float, time: float) -> Top:
    """The larger of both."""
    if value <= top.value:
        return top
    if top.first >= min(value * (1.0 - ALIKE), value * (1.0 + ALIKE)):
        return Top(value, top.first, top.time)
    return Top(value, value, time)


def along(a: float, b: float, share: float) -> float:
    """A line after a share of its way."""
    return a + share * (b - a)


def with_losses(d: Drive, line: Line, w_0: float, w_1: float, loss: float) -> Line:
    """The line whose power is that into the stage, or, without its losses, into the motor."""
    forward = line.I_0 + line.I_1
    sign = 1.0 if forward > 0.0 else (-1.0 if forward < 0.0 else 0.0)
    twice = -2.0 * d.surplus if forward * d.surplus * (w_0 + w_1) < 0.0 else 0.0
    more = loss * sign
    return Line(line.I_0, line.I_1, line.V_0 + twice * w_0 + more, line.V_1 + twice * w_1 + more)


def at_stage(d: Drive, line: Line, w_0: float, w_1: float, loss: float) -> Line:
    """The line whose power is that into the stage."""
    motor = with_losses(d, line, w_0, w_1, loss)
    return Line(motor.I_0, motor.I_1, motor.V_0 + d.R_stage * motor.I_0, motor.V_1 + d.R_stage * motor.I_1)


def largest_power(line: Line) -> tuple[float, float]:
    """The largest power [W], and after which share of the stretch."""
    rise_I, rise_V = line.I_1 - line.I_0, line.V_1 - line.V_0
    slope, bend = line.I_0 * rise_V + line.V_0 * rise_I, rise_I * rise_V
    share = 1.0 if line.I_1 * line.V_1 > line.I_0 * line.V_0 else 0.0
    if bend < 0.0 and slope > 0.0 and slope + 2.0 * bend < 0.0:
        share = -slope / (2.0 * bend)
    return (line.I_0 + share * rise_I) * (line.V_0 + share * rise_V), share


def work_of(line: Line) -> Work:
    """Work, of one sign each."""
    rise_I, rise_V = line.I_1 - line.I_0, line.V_1 - line.V_0
    bend, slope = rise_I * rise_V / 3.0, (line.I_0 * rise_V + line.V_0 * rise_I) / 2.0
    whole = line.I_0 * line.V_0 + (slope + bend)
    if line.V_0 * line.V_1 < 0.0:
        cut = line.V_0 / (line.V_0 - line.V_1)
        first = cut * (line.I_0 * line.V_0 + cut * (slope + cut * bend))
        return Work(first, whole - first, cut)
    return Work(whole, 0.0, 1.0)


def drawn_of(work: Work) -> float:
    """Of it what is drawn [W]."""
    return max(work.first, 0.0) + max(work.second, 0.0)


def returned_of(work: Work) -> float:
    """Of it what is returned [W]."""
    return max(-work.first, 0.0) + max(-work.second, 0.0)


def source_heat(d: Drive, line: Line, low: float, high: float) -> float:
    """Mean heat of the source's resistance while power is drawn, from one share of the stretch to another [W]."""
    heat, width = 0.0, high - low
    if width <= 0.0:
        return 0.0
    for k in range(len(NODES)):
        x = low + width * NODES[k]
        power = max(along(line.I_0, line.I_1, x) * along(line.V_0, line.V_1, x), 0.0) + d.standby
        if power > 0.0:
            square = d.V_0 * d.V_0 - 4.0 * d.R_source * power * d.drives
            if square < 0.0:
                return math.inf  # no current gives that power
            current = 2.0 * power * d.drives / (d.V_0 + math.sqrt(square))
            heat += WEIGHTS[k] * (d.V_0 * current / d.drives - power)
    return heat * width


def filled(store: Store, work: float, kept: float) -> Store:
    """A store after some work [J]: what is returned comes in as far as it is kept, what is drawn goes out."""
    came = -work * kept if work < 0.0 else 0.0
    more = came - max(work, 0.0)
    level = max(store.level + more, 0.0)  # not the sum above its lowest: that has less digits
    total = store.sum + more
    return Store(
        total, min(store.lowest, total), max(store.highest, total), level, max(store.risen, level), store.came + came
    )


def most_stored(s: Store) -> float:
    """Largest rise of a store over a cycle that repeats [J]; infinite where more comes than goes."""
    if s.sum > 0.0:
        return math.inf
    return min(max(s.risen, s.sum + s.highest - s.lowest), s.came)


def below(limit: float, I_0: float, I_1: float) -> tuple[float, float]:
    """Shares of a piece from when until when the current is not above a limit; beyond 1 where it always is."""
    if max(abs(I_0), abs(I_1)) <= limit:
        return 0.0, 1.0
    if I_0 == I_1:
        return 2.0, 2.0
    up, down = (limit - I_0) / (I_1 - I_0), (-limit - I_0) / (I_1 - I_0)
    enter, leave = min(up, down), max(up, down)
    if enter >= 1.0 or leave <= 0.0:
        return 2.0, 2.0
    return max(enter, 0.0), min(leave, 1.0)


def time_above(above: Above, limit: float, I_0: float, I_1: float, start: float, t: float) -> Above:
    """Times above a limit with a piece more."""
    enter, leave = below(limit, I_0, I_1)
    if enter > 1.0:
        return Above(above.longest, above.end, above.begin, above.in_all + t)
    in_all, begin = above.in_all + t * (1.0 - (leave - enter)), start + leave * t
    if above.begin < 0.0:
        return Above(above.longest, start + enter * t, begin, in_all)
    return Above(max(above.longest, start + enter * t - above.begin), above.end, begin, in_all)


def longest_above(above: Above, total: float) -> float:
    """The longest time above, in a cycle that repeats, less what rounding of the times may have added [s]."""
    if above.begin < 0.0:
        return total
    return max(max(above.longest, total - above.begin + above.end) - 2e-15 * total, 0.0)
