"""A drive over a load cycle, segment by segment and piece by piece."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.kernel.heat import (
    Bodies,
    Change,
    Law,
    added,
    bodies_of,
    change_of,
    in_sequence,
    law_of,
    left_over,
    mean_square,
    periodic,
    slopes,
    spread,
    top_within,
)
from drivesizer.kernel.records import Drive, Figures, Piece
from drivesizer.physics.gear_life import SIX

Array = NDArray[np.float64]

HEAT, POWER, ENERGY, ACCOUNT = 0, 1, 2, 3  # levels: each computes what those before it do, too
FINEST = 200  # pieces of a segment at most
FORGOTTEN = 1e-15  # share of a rise that is left when what was before is of no effect
LEVEL = 1e-9  # share of a slope that is 0 but for rounding
BEYOND = 1e9  # K: a winding that is warmer has run away
ALIKE = 1e-9  # share by which values differ that are alike
NODES = tuple((1.0 + float(node)) / 2.0 for node in SIX[0])  # of a quadrature from 0 to 1
WEIGHTS = tuple(float(weight) / 2.0 for weight in SIX[1])


# -- Power and energy of a piece at motor, power stage and source, and times above a current.
#
# .. math::
#
#     P &= V I + \max(0,\ 2 (k_t - k_e) w I), \qquad V = k_e w + R I \\
#     P_{in} &= P + V_l |I| + R_b I^2, \qquad V_s I_s = P_{in} + P_0, \quad V_s = V_0 - n R_s I_s
#
# Current and voltage are straight lines within a piece, so power is a product of two lines: its sign changes where one
# of theirs does, and it is largest at an end or at the vertex between. Within a stretch of one sign of the current the
# losses are a voltage beside V.


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


# -- The cycle, segment by segment and piece by piece.


class Course(NamedTuple):
    """Load cycles as they lie in memory."""

    duration: Array  # s
    speed: Array  # rad/s
    acceleration: Array  # rad/s^2
    torque: Array  # N*m
    steps: NDArray[np.int64]  # items from segment to segment, end to end and cycle to cycle, of each of these


class Segment(NamedTuple):
    """A segment as a drive has it, or a piece of one."""

    t: float  # s
    I_0: float  # A
    I_1: float
    w_0: float  # rad/s, of the load
    w_1: float


class WindingRise(NamedTuple):
    """A winding whose course is not computed."""

    rise: float  # K
    mean: float  # K, for the mean loss
    highest: float  # K, to be given as its highest


class Rises(NamedTuple):
    """Rises of a winding in a piece as voltages take them [K]."""

    start: float
    end: float
    mean: float


class Fed(NamedTuple):
    """Power and energy of a stretch."""

    power: float  # W, largest into the stage
    share: float  # after which of its time
    least: float  # W
    drawn: float  # J at the stage
    returned: float  # J
    source_heat: float  # J
    motor_drawn: float  # J
    motor_returned: float  # J
    unlike: float  # J


def segment_of(d: Drive, c: Course, k: int, cycle: int) -> tuple[Segment, bool]:
    """A segment of a cycle, and whether nothing changes in it."""
    t, steps = c.duration[k * c.steps[0, 0] + cycle * c.steps[0, 2]], c.steps
    m, n = k * steps[1, 0] + cycle * steps[1, 2], steps[1, 1]
    w_0, w_1 = c.speed[m], c.speed[m + n]
    m, n = k * steps[2, 0] + cycle * steps[2, 2], steps[2, 1]
    a_0, a_1 = c.acceleration[m], c.acceleration[m + n]
    m, n = k * steps[3, 0] + cycle * steps[3, 2], steps[3, 1]
    T_0, T_1 = c.torque[m], c.torque[m + n]
    forward = w_0 + w_1
    per_torque = d.driving if (T_0 + T_1) * forward > 0.0 else d.braking
    if w_0 == 0.0 and w_1 == 0.0:
        per_torque = d.resting
    friction = d.direction if forward > 0.0 else (-d.direction if forward < 0.0 else 0.0)
    I_0 = per_torque * T_0 + d.accelerating * a_0 + friction + d.turning * w_0
    I_1 = per_torque * T_1 + d.accelerating * a_1 + friction + d.turning * w_1
    return Segment(t, I_0, I_1, w_0, w_1), w_0 == w_1 and a_0 == a_1 and T_0 == T_1


def pieces_of(d: Drive, s: Segment, steady: bool) -> int:
    """In how many pieces a segment is cut, so that the winding follows the mean of each."""
    return 1 if steady or not s.t > d.finest else int(min(math.ceil(math.sqrt(s.t / d.finest)), FINEST))


def part(s: Segment, n: int, count: int) -> Segment:
    """One of so many equal parts."""
    if count == 1:
        return s
    a, b = n / count, (n + 1) / count
    return Segment(
        s.t / count, along(s.I_0, s.I_1, a), along(s.I_0, s.I_1, b), along(s.w_0, s.w_1, a), along(s.w_0, s.w_1, b)
    )


def heating(d: Drive, b: Bodies, s: Segment) -> Law:
    """The equations of heat over a piece."""
    loss = d.friction * 0.5 * (abs(s.w_0) + abs(s.w_1)) + d.iron * mean_square(s.w_0, s.w_1)
    return law_of(b, mean_square(s.I_0, s.I_1), loss)


def periodic_start(d: Drive, c: Course, count: int, cycle: int) -> tuple[float, float]:
    """Rises with which a cycle begins in periodic steady state; infinite where there is none."""
    b, whole, k = bodies_of(d.R, d.R_rise, d.R_th1, d.R_th2, d.C_w, d.C_h), Change(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), count
    while k > 0 and not left_over(whole) < FORGOTTEN:  # from the end, as far back as it has an effect
        k -= 1
        s, steady = segment_of(d, c, k, cycle)
        pieces = pieces_of(d, s, steady)
        for n in range(pieces - 1, -1, -1):
            piece = part(s, n, pieces)
            law = heating(d, b, piece)
            whole = in_sequence(change_of(law, spread(law, piece.t), piece.t), whole)
    return periodic(whole)


def fed_half(d: Drive, s: Segment, r: Rises, level: int) -> Fed:
    """Power and energy of a stretch with a current of one sign: power with the winding at its ends, else its mean."""
    warm = Line(
        s.I_0,
        s.I_1,
        d.emf * s.w_0 + (d.R + d.R_rise * r.start) * s.I_0,
        d.emf * s.w_1 + (d.R + d.R_rise * r.end) * s.I_1,
    )
    line = at_stage(d, warm, s.w_0, s.w_1, d.loss)
    power, share = largest_power(line)
    if level < ENERGY:
        return Fed(power, share, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    mean = mean_line(d, s, r.mean)
    inner = at_stage(d, mean, s.w_0, s.w_1, d.loss)
    work, heat = work_of(inner), 0.0
    if d.R_source > 0.0 and s.t > 0.0:
        heat = s.t * (source_heat(d, inner, 0.0, work.cut) + source_heat(d, inner, work.cut, 1.0))
    drawn, returned = s.t * drawn_of(work), s.t * returned_of(work)
    if level < ACCOUNT:
        return Fed(power, share, 0.0, drawn, returned, heat, 0.0, 0.0, 0.0)
    least = -largest_power(Line(line.I_0, line.I_1, -line.V_0, -line.V_1))[0]
    motor = work_of(with_losses(d, mean, s.w_0, s.w_1, 0.0))
    unlike = s.t * abs(d.surplus * work_of(Line(s.I_0, s.I_1, s.w_0, s.w_1)).first)
    return Fed(power, share, least, drawn, returned, heat, s.t * drawn_of(motor), s.t * returned_of(motor), unlike)


def mean_line(d: Drive, s: Segment, rise: float) -> Line:
    """Current and voltage with the winding as warm as it is in the mean."""
    R = d.R + d.R_rise * rise
    return Line(s.I_0, s.I_1, d.emf * s.w_0 + R * s.I_0, d.emf * s.w_1 + R * s.I_1)


def top_voltage(s: Segment, V_0: float, V_1: float, X: float) -> Top:
    """The largest voltage over a piece, with what commutation takes where the motor drives, and when."""
    first, last = V_0 + X * max(s.I_0 * s.w_0, 0.0), V_1 + X * max(s.I_1 * s.w_1, 0.0)
    rise_I, rise_w, share = s.I_1 - s.I_0, s.w_1 - s.w_0, 1.0 if last > first else 0.0
    bend, slope = X * rise_I * rise_w, V_1 - V_0 + X * (s.I_0 * rise_w + s.w_0 * rise_I)
    drives = s.I_0 * s.w_0 >= 0.0 and s.I_1 * s.w_1 >= 0.0
    if drives and bend < 0.0 and slope > 0.0 and slope + 2.0 * bend < 0.0:
        share = -slope / (2.0 * bend)
        inner = first + share * (slope + share * bend)
        return Top(inner, inner, share * s.t)
    return Top(max(first, last), max(first, last), share * s.t)


def halves(s: Segment) -> tuple[Segment, Segment, float]:
    """A piece up to where its current changes its sign, what follows, and the share of the first."""
    share = s.I_0 / (s.I_0 - s.I_1)
    w = along(s.w_0, s.w_1, share)
    return Segment(share * s.t, s.I_0, 0.0, s.w_0, w), Segment((1.0 - share) * s.t, 0.0, s.I_1, w, s.w_1), share


def fed(d: Drive, s: Segment, r: Rises, level: int) -> Fed:
    """Power and energy of a piece."""
    if not s.I_0 * s.I_1 < 0.0:
        return fed_half(d, s, r, level)
    first, then, share = halves(s)
    middle = along(r.start, r.end, share)
    a = fed_half(d, first, Rises(r.start, middle, r.mean), level)
    b = fed_half(d, then, Rises(middle, r.end, r.mean), level)
    top = larger(Top(a.power, a.power, share * a.share), b.power, share + (1.0 - share) * b.share)
    heat = a.source_heat + b.source_heat
    return Fed(
        top.value, top.time, min(a.least, b.least), a.drawn + b.drawn, a.returned + b.returned, heat,
        a.motor_drawn + b.motor_drawn, a.motor_returned + b.motor_returned, a.unlike + b.unlike,
    )  # fmt: skip


def stored(d: Drive, store: Store, s: Segment, rise: float) -> Store:
    """The store on the bus after a piece, with the least loss of the stage."""
    if s.I_0 * s.I_1 < 0.0:
        first, then, _ = halves(s)
        return stored_half(d, stored_half(d, store, first, rise), then, rise)
    return stored_half(d, store, s, rise)


def stored_half(d: Drive, store: Store, s: Segment, rise: float) -> Store:
    """The same after a stretch with a current of one sign."""
    work = work_of(at_stage(d, mean_line(d, s, rise), s.w_0, s.w_1, d.least_loss))
    return filled(filled(store, s.t * work.first, d.bus_share), s.t * work.second, d.bus_share)


def over_cycle(
    d: Drive,
    c: Course,
    count: int,
    cycle: int,
    held: WindingRise,
    start: tuple[float, float],
    level: int,
    cuts: int,
    rows: Array,
) -> Figures:
    """A drive over a cycle, its winding in a course that begins with rises of winding and housing, or held."""
    b, course, time = bodies_of(d.R, d.R_rise, d.R_th1, d.R_th2, d.C_w, d.C_h), not math.isnan(start[0]), 0.0
    w, h = start
    none = Top(-math.inf, -math.inf, 0.0)
    current, winding, voltage, lower, power, least = none, none, none, none, none, w
    square_time = mean_time = copper = 0.0
    above, store = Above(0.0, 0.0, -1.0, 0.0), Store(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    drawn = returned = heat = motor = unlike = 0.0
    pending = Piece(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    written, stores = 0, level >= ENERGY and d.bus_share > 0.0
    parts = max(cuts, 1)
    for k in range(count):
        s, steady = segment_of(d, c, k, cycle)
        pieces = pieces_of(d, s, steady)
        for n in range(pieces):
            p = part(s, n, pieces)
            rises, at_w, at_h = Rises(held.rise, held.rise, held.mean), w, h
            if course:
                law = heating(d, b, p)
                more_w, more_h, mean = added(law, spread(law, p.t), p.t, w, h)
                rises = Rises(w, w + more_w, w + mean)
                rising, later = slopes(law, w, h)[0], slopes(law, w + more_w, h + more_h)[0]
                if rising > 0.0 and later < LEVEL * rising and (steady or w + p.t * rising > winding.value):
                    top, when = top_within(law, p.t, w, h)
                    winding = larger(winding, top, time + when)
                    if steady:  # nothing else changes: its warmest moment stands at its warmer end
                        rises = Rises(w, top, w + mean) if more_w >= 0.0 else Rises(top, w + more_w, w + mean)
                w, h = w + more_w, h + more_h
                winding, least = larger(winding, w, time + p.t), min(least, w)
            square = mean_square(p.I_0, p.I_1)
            square_time, mean_time = square_time + p.t * square, mean_time + p.t * rises.mean
            copper += p.t * (d.R + d.R_rise * rises.mean) * square
            v_0 = d.emf * p.w_0 + (d.R + d.R_rise * rises.start) * p.I_0
            v_1 = d.emf * p.w_1 + (d.R + d.R_rise * rises.end) * p.I_1
            v_0, v_1 = max(abs(v_0), abs(v_0 + d.leads * p.I_0)), max(abs(v_1), abs(v_1 + d.leads * p.I_1))
            most, least_of = top_voltage(p, v_0, v_1, d.commutation), top_voltage(p, v_0, v_1, d.least_commutation)
            voltage = larger(voltage, most.value, time + most.time)
            lower = larger(lower, least_of.value, time + least_of.time)
            current = larger(larger(current, abs(p.I_0), time), abs(p.I_1), time + p.t)
            if level >= POWER:
                above = time_above(above, d.limit, p.I_0, p.I_1, time, p.t)
                for m in range(parts):
                    q, of = part(p, m, parts), rises
                    if parts > 1:
                        ends = along(rises.start, rises.end, m / parts), along(rises.start, rises.end, (m + 1) / parts)
                        of = Rises(ends[0], ends[1], rises.mean)
                    f = fed(d, q, of, level)
                    power = larger(power, f.power, time + (m + f.share) * q.t)
                    drawn, returned, heat = drawn + f.drawn, returned + f.returned, heat + f.source_heat
                    motor, unlike = motor + (f.motor_drawn - f.motor_returned), unlike + f.unlike
                    if level >= ACCOUNT:
                        piece = Piece(
                            q.t, q.I_0, q.I_1, q.w_0, q.w_1, of.start, of.end, of.mean, at_w, at_h, f.drawn, f.returned,
                            f.source_heat, f.motor_drawn, f.motor_returned, f.power, f.least,
                        )  # fmt: skip
                        if cuts == 0 and pending.returned == 0.0 and piece.returned == 0.0:
                            pending = joined(pending, piece)
                        else:
                            written = put(rows, written, pending)
                            pending = piece
                if stores:
                    store = stored(d, store, p, rises.mean)
            time += p.t
    written = put(rows, written, pending)
    return Figures(
        math.sqrt(square_time / time), current.value, current.time,
        winding.value if course else held.highest, winding.time if course else math.nan, mean_time / time,
        least, start[0], start[1], w, h,
        voltage.value, voltage.time, lower.value, lower.time, copper / time,
        longest_above(above, time) if level >= POWER and not math.isnan(d.limit) else math.nan,
        above.in_all if level >= POWER and not math.isnan(d.limit) else math.nan,
        power.value if level >= POWER else math.nan, power.time if level >= POWER else math.nan,
        drawn if level >= ENERGY else math.nan, returned if level >= ENERGY else math.nan,
        heat if level >= ENERGY else math.nan, most_stored(store) if stores else (0.0 if level >= ENERGY else math.nan),
        motor if level >= ACCOUNT else math.nan, unlike if level >= ACCOUNT else math.nan, float(written),
    )  # fmt: skip


def joined(a: Piece, b: Piece) -> Piece:
    """Two pieces as one."""
    if a.duration == 0.0:
        return b
    t = a.duration + b.duration
    return Piece(
        t, a.I_0, b.I_1, a.w_0, b.w_1, a.rise_0, b.rise_1, (a.duration * a.rise_mean + b.duration * b.rise_mean) / t,
        a.winding, a.housing, a.drawn + b.drawn, a.returned + b.returned, a.source_heat + b.source_heat,
        a.motor_drawn + b.motor_drawn, a.motor_returned + b.motor_returned, max(a.most, b.most), min(a.least, b.least),
    )  # fmt: skip


def put(rows: Array, written: int, piece: Piece) -> int:
    """Write a piece behind those that are written, where there is room; one without duration is none."""
    if piece.duration == 0.0:
        return written
    if written < len(rows):
        for k in range(len(piece)):
            rows[written, k] = piece[k]
    return written + 1


def count_pieces(d: Drive, c: Course, count: int) -> int:
    """Pieces of a cycle."""
    total = 0
    for k in range(count):
        s, steady = segment_of(d, c, k, 0)
        total += pieces_of(d, s, steady)
    return total


def one_drive(d: Drive, c: Course, count: int, cycle: int, level: int, cuts: int, rows: Array) -> Figures:
    """A drive over a cycle; one whose winding runs away is held at its permitted rise."""
    held, unknown = WindingRise(d.rise, d.mean_rise, math.nan), (math.nan, math.nan)
    start = (d.winding_start, d.housing_start) if d.course > 0.0 else unknown
    if d.course > 0.0 and math.isnan(d.winding_start):
        start = periodic_start(d, c, count, cycle)
    away = WindingRise(d.permitted, d.permitted, math.inf)
    if math.isinf(start[0] + start[1]):
        held, start = away, unknown
    while True:
        figures = over_cycle(d, c, count, cycle, held, start, level, cuts, rows)
        if math.isnan(start[0]) or figures.winding < BEYOND:
            return figures
        held, start = away, unknown


def drive_of(x: Array) -> Drive:
    """A drive of a row."""
    return Drive(
        x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[9], x[10], x[11], x[12], x[13], x[14], x[15], x[16],
        x[17], x[18], x[19], x[20], x[21], x[22], x[23], x[24], x[25], x[26], x[27], x[28], x[29], x[30], x[31], x[32],
        x[33], x[34],
    )  # fmt: skip


def evaluate_rows(
    drives: Array, columns: Array, duration: Array, speed: Array, acceleration: Array, torque: Array,
    steps: NDArray[np.int64], cycles: NDArray[np.int64], sizes: NDArray[np.int64], rows: Array,
) -> int:  # fmt: skip
    """Drives one after the other, each over one of the cycles; ``sizes``: segments, level, cuts of a piece."""
    c = Course(duration, speed, acceleration, torque, steps)
    count, level, cuts = int(sizes[0]), sizes[1], int(sizes[2])
    if level < 0:
        return count_pieces(drive_of(drives[0]), c, count)
    for r in range(len(drives)):
        figures = one_drive(drive_of(drives[r]), c, count, cycles[r], level, cuts, rows)
        for k in range(len(figures)):
            columns[r, k] = figures[k]
    return 0
