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
    both,
    change_of,
    law_of,
    left_over,
    mean_square,
    periodic,
    slopes,
    spread,
    top_within,
)
from drivesizer.kernel.records import Drive, Figures, Piece
from drivesizer.kernel.supply import (
    Above,
    Line,
    Store,
    Top,
    along,
    at_stage,
    drawn_of,
    filled,
    larger,
    largest_power,
    longest_above,
    most_stored,
    returned_of,
    source_heat,
    time_above,
    with_losses,
    work_of,
)

Array = NDArray[np.float64]

HEAT, POWER, ENERGY, ACCOUNT = 0, 1, 2, 3  # levels: each computes what those before it do, too
FINEST = 200  # pieces of a segment at most
FORGOTTEN = 1e-15  # share of a rise that is left when what was before is of no effect
LEVEL = 1e-9  # share of a slope that is 0 but for rounding
BEYOND = 1e9  # K: a winding that is warmer has run away


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


class Held(NamedTuple):
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
            whole = both(change_of(law, spread(law, piece.t), piece.t), whole)
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
    return filled(filled(store, s.t * work.first, d.kept), s.t * work.second, d.kept)


def over_cycle(
    d: Drive,
    c: Course,
    count: int,
    cycle: int,
    held: Held,
    start: tuple[float, float],
    level: int,
    cuts: int,
    rows: Array,
) -> Figures:
    """A drive over a cycle, its winding in a course that begins with rises of winding and housing, or held."""
    b, course, time = bodies_of(d.R, d.R_rise, d.R_th1, d.R_th2, d.C_w, d.C_h), not math.isnan(start[0]), 0.0
    w, h = start
    none = Top(-math.inf, -math.inf, 0.0)
    current, winding, voltage, power, least = none, none, none, none, w
    square_time = mean_time = copper = 0.0
    above, store = Above(0.0, 0.0, -1.0, 0.0), Store(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    drawn = returned = heat = motor = unlike = 0.0
    pending = Piece(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    written, stores = 0, level >= ENERGY and d.kept > 0.0
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
            voltage = larger(voltage, max(abs(v_0), abs(v_0 + d.leads * p.I_0)), time)
            voltage = larger(voltage, max(abs(v_1), abs(v_1 + d.leads * p.I_1)), time + p.t)
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
        voltage.value, voltage.time, copper / time,
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
    found = 0
    for k in range(count):
        s, steady = segment_of(d, c, k, 0)
        found += pieces_of(d, s, steady)
    return found


def one_drive(d: Drive, c: Course, count: int, cycle: int, level: int, cuts: int, rows: Array) -> Figures:
    """A drive over a cycle; one whose winding runs away is held at its permitted rise."""
    held, unknown = Held(d.held, d.held_mean, math.nan), (math.nan, math.nan)
    start = (d.winding_start, d.housing_start) if d.course > 0.0 else unknown
    if d.course > 0.0 and math.isnan(d.winding_start):
        start = periodic_start(d, c, count, cycle)
    away = Held(d.permitted, d.permitted, math.inf)
    if math.isinf(start[0] + start[1]):
        held, start = away, unknown
    while True:
        found = over_cycle(d, c, count, cycle, held, start, level, cuts, rows)
        if math.isnan(start[0]) or found.winding < BEYOND:
            return found
        held, start = away, unknown


def drive_of(x: Array) -> Drive:
    """A drive of a row."""
    return Drive(
        x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[9], x[10], x[11], x[12], x[13], x[14], x[15], x[16],
        x[17], x[18], x[19], x[20], x[21], x[22], x[23], x[24], x[25], x[26], x[27], x[28], x[29], x[30], x[31], x[32],
    )  # fmt: skip


def evaluate_rows(
    drives: Array, found: Array, duration: Array, speed: Array, acceleration: Array, torque: Array,
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
            found[r, k] = figures[k]
    return 0
