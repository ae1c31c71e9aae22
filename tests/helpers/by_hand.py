"""The drive model once more in plain Python: one set, one segment, one moment at a time, to hold the program against.

Written from the handbooks' physics and not from the program: no columns, no moments, no hulls. Where a quantity is a
straight line within a piece of the cycle its ends are enough; products of two lines are integrated by Simpson's rule,
which is exact for them. Parts are records with their figures by name; NaN is unknown.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import load

ALPHA = 0.0039  # 1/K, copper
ROOM = 298.15  # K, of datasheets
NAN = math.nan
COMMUTATED = 25e3 * math.pi / 30  # rad/s, that controllers reach of which none is printed

Pair = tuple[float, float]  # values at the left and the right end


class Segment(NamedTuple):
    """Of a load cycle, at the load's shaft."""

    time: float
    speed: Pair
    acceleration: Pair
    torque: Pair


class Piece(NamedTuple):
    """Of one direction and one direction of power."""

    start: float
    time: float
    gear_torque: Pair  # at the gearhead's output
    gear_speed: Pair
    way: int  # of the motion: 1, -1, 0 at rest
    current: Pair
    speed: Pair  # of the motor


def segments_of(cycle: Any) -> list[Segment]:
    """A load cycle of the program as a list."""
    columns = (cycle.speed, cycle.acceleration, cycle.torque)
    rows = zip(cycle.duration.tolist(), *(c.tolist() for c in columns), strict=True)
    return [Segment(t, tuple(w), tuple(a), tuple(T)) for t, w, a, T in rows]


def largest(values: list[float]) -> float:
    """The maximum, NaN if any is."""
    return NAN if any(map(math.isnan, values)) else max(values)


def product(time: float, a: Pair, b: Pair) -> float:
    """Integral of the product of two lines: Simpson."""
    middle = (a[0] + a[1]) / 2 * (b[0] + b[1]) / 2
    return time / 6 * (a[0] * b[0] + 4 * middle + a[1] * b[1])


def crossing(ends: Pair) -> list[float]:
    """Share of a piece after which a line passes through zero, if it does."""
    return [ends[0] / (ends[0] - ends[1])] if ends[0] * ends[1] < 0.0 else []


def between(ends: Pair, left: float, right: float) -> Pair:
    """A line between two shares of it; what is nothing but rounding beside its ends is zero."""
    first, last = ends
    size = 1e-13 * max(abs(first), abs(last))
    a, b = first + left * (last - first), first + right * (last - first)
    return 0.0 if abs(a) < size else a, 0.0 if abs(b) < size else b


def drive(motor: Any, head: Any, more_inertia: float, belt: float, e_belt: float, cycle: list[Segment]) -> list[Piece]:
    """What the motor does in each piece of the cycle."""
    pieces, now = [], 0.0
    inertia = motor.rotor_inertia + head.inertia + more_inertia
    k, i, e = motor.torque_constant, head.ratio, head.efficiency
    for segment in cycle:
        cuts = sorted({0.0, *crossing(segment.speed), *crossing(segment.torque), 1.0})
        for left, right in itertools.pairwise(cuts):
            w, a, T = (between(c, left, right) for c in segment[1:])
            way = (w[0] + w[1] > 0) - (w[0] + w[1] < 0)
            power = way * (T[0] + T[1])
            if power > 0:  # to the load: every stage asks for more
                T_g = T[0] / (belt * e_belt), T[1] / (belt * e_belt)
                T_m = T_g[0] / (i * e), T_g[1] / (i * e)
            elif power < 0:  # from the load: every stage keeps some
                T_g = T[0] * e_belt / belt, T[1] * e_belt / belt
                T_m = T_g[0] * e / i, T_g[1] * e / i
            else:
                T_g = T[0] / belt, T[1] / belt
                T_m = T_g[0] / i, T_g[1] / i
            w_g = w[0] * belt, w[1] * belt
            w_m = w_g[0] * i, w_g[1] * i
            dry, per_speed = friction(motor)
            loss = [dry * way + per_speed * x for x in w_m]
            tau = [T_m[n] + inertia * a[n] * belt * i + loss[n] for n in (0, 1)]
            time = segment.time * (right - left)
            pieces.append(Piece(now + segment.time * left, time, T_g, w_g, way, (tau[0] / k, tau[1] / k), w_m))
        now += segment.time
    return pieces


def friction(motor: Any) -> tuple[float, float]:
    """That of no load: dry are 65 % of a brushed motor, 45 % of a servo, 37 % without slots, else 55 %."""
    lost = motor.torque_constant * motor.no_load_current
    if motor.kind == "brushed":
        share = 0.45 if motor.inside else 0.65
    else:
        share = 0.37 if motor.winding == "slotless" else 0.55
    return share * lost, (1 - share) * lost / motor.no_load_speed


@dataclass
class Asked:
    """What the cycle asks of one set."""

    gear_rms: float
    gear_peak: float
    gear_speed: float
    gear_sustained: float
    gear_mean_power: float
    gear_peak_power: float
    speed: float
    I_rms: float
    I_peak: float
    V_start: float  # V, cold
    V_peak: Pair  # at least, at most: by heat where it is not known, and by commutation
    copper: float  # W, mean
    settled: float  # K, steady mean
    winding: Pair  # K, peak over the repeating cycle
    power: Pair
    drawn: float
    returned: float
    stored: Pair


@cache
def lasting(pieces: tuple[tuple[float, Pair], ...], on_end: float, share: float) -> float:
    """The speed that a repeating cycle exceeds for longer than so long on end or so much of the time: by bisection."""
    total = sum(time for time, _ in pieces)
    twice = [(time, abs(a), abs(b), min(abs(a), abs(b)), max(abs(a), abs(b))) for time, (a, b) in pieces] * 2
    slowest = min(low for *_, low, _ in twice)

    def too_long(v: float) -> bool:
        if slowest > v:  # for ever
            return True
        above, run, longest = 0.0, 0.0, 0.0
        for time, a, b, low, high in twice:
            part = time * (1.0 if low > v else 0.0 if high <= v else (high - v) / (high - low))
            above += part / 2
            run = run + part if a > v else part
            longest = max(longest, run)
            run = run if b > v else 0.0
        return longest > on_end * (1 + 1e-9) or above > share * total * (1 + 1e-9)

    low, high = 0.0, max(high for *_, high in twice)
    if not too_long(low):
        return 0.0
    while low < (middle := (low + high) / 2) < high:  # until no figure lies between
        low, high = (middle, high) if too_long(middle) else (low, middle)
    return high


def asked(pieces: list[Piece], motor: Any, head: Any, ambient: float, kept: float = 1.0) -> Asked:
    """Every demand of one set whose controller loses nothing, the time above a current apart."""
    return by_controller(pieces, motor, head, ambient, kept)(0.0, 0.0)


def by_controller(
    pieces: list[Piece], motor: Any, head: Any, ambient: float, kept: float = 1.0
) -> Callable[[float, float], Asked]:
    """Every demand of one set by its controller's loss per ampere and the least that this may be [V]."""
    total = sum(p.time for p in pieces)
    running = [p for p in pieces if p.way]
    ran = sum(p.time for p in running)
    mean = sum(p.time * abs(p.gear_speed[0] + p.gear_speed[1]) / 2 for p in running) / ran if ran else 0.0
    fastest = max(abs(w) for p in pieces for w in p.gear_speed)
    I_rms = math.sqrt(sum(product(p.time, p.current, p.current) for p in pieces) / total)
    steady = settled(motor, ambient, I_rms, sum(housing(p, motor) for p in pieces) / total)
    I_peak = largest([abs(amps) for p in pieces for amps in p.current])
    fine, temperatures, winding = periodic(pieces, motor, ambient, steady)
    cold = Warm(ambient, ambient, ambient, ambient)
    permitted, all_the_time = motor.max_winding_temperature, hottest(pieces, motor, ambient, I_peak)
    if math.isinf(winding) and not math.isnan(permitted):  # taken as hot as it may be, where it fails
        temperatures = [Warm(permitted, permitted, permitted, permitted)] * len(fine)
    both = [temperatures, temperatures]
    bounds = winding, winding
    unknown = math.isnan(winding) or any(math.isnan(T.mean) for T in temperatures)
    if unknown:  # between cold and as hot as it may be
        most = [T for T in (all_the_time, permitted) if math.isfinite(T)]
        most = min(most) if most else NAN
        both = [[cold] * len(fine), [Warm(most, most, most, most)] * len(fine)]
        bounds = (steady, all_the_time) if math.isnan(winding) else bounds
    at_start = largest([abs(v) for p in pieces for v in volts(p, motor, cold.left)])
    V = [
        largest([at_start, *(abs(v) + x for p, T in zip(fine, Ts, strict=True)
                             for v, x in zip(hottest_volts(p, motor, T), commutating(p, motor, share), strict=True))])
        for Ts, share in zip(both, (0.4, 1.15), strict=True)
    ]  # fmt: skip
    if unknown and math.isfinite(steady):  # without time constants: as a cycle makes it that is short against them
        temperatures = [Warm(steady, steady, steady, steady)] * len(fine)
    copper = (
        sum(
            resistance(motor, T.mean) * product(p.time, p.current, p.current)
            for p, T in zip(fine, temperatures, strict=True)
        )
        / total
    )

    before = Asked(
        gear_rms=math.sqrt(sum(product(p.time, p.gear_torque, p.gear_torque) for p in running) / ran),
        gear_peak=max(abs(T) for p in pieces for T in p.gear_torque),
        gear_speed=fastest,
        gear_sustained=max(mean, lasting(tuple((p.time, p.gear_speed) for p in pieces), 1.0, 0.1)),
        gear_mean_power=sum(abs(product(p.time, p.gear_torque, p.gear_speed)) for p in running) / ran,
        gear_peak_power=max(abs(p.gear_torque[n] * p.gear_speed[n]) for p in pieces for n in (0, 1)),
        speed=fastest * head.ratio,
        I_rms=I_rms,
        I_peak=I_peak,
        V_start=at_start,
        V_peak=(V[0], V[1]),
        copper=copper,
        settled=steady,
        winding=bounds,
        power=(NAN, NAN),
        drawn=NAN,
        returned=NAN,
        stored=(NAN, NAN),
    )
    hottest_flows = [
        flow(fine, [hottest_volts(p, motor, T) for p, T in zip(fine, Ts, strict=True)])
        for Ts in (both if unknown else both[:1])
    ]
    mean_flow = flow(fine, [volts(p, motor, T.mean) for p, T in zip(fine, temperatures, strict=True)])
    cold_flow = flow(fine, [volts(p, motor, ambient) for p in fine]) if unknown else mean_flow

    @cache
    def at(loss: float, least: float) -> Asked:
        power = [largest([strongest(I, behind(I, V, loss)) for _, I, V in each]) for each in hottest_flows]
        drawn, returned, stored = energy(mean_flow, kept, loss=loss)
        stored = stored if least == loss else energy(mean_flow, kept, loss=least)[2]
        coldest = energy(cold_flow, kept, loss=least)[2] if unknown else stored
        return replace(
            before,
            power=(power[0], power[-1]),
            drawn=drawn,
            returned=returned,
            stored=(stored, coldest),  # the colder, the more comes back
        )

    return at


def flow(pieces: list[Piece], voltages: list[Pair]) -> list[tuple[float, Pair, Pair]]:
    """Time, current and voltage of the parts of each piece that a change of the current's sign makes."""
    return [
        (p.time * (b - a), between(p.current, a, b), between(V, a, b))
        for p, V in zip(pieces, voltages, strict=True)
        for a, b in itertools.pairwise(sorted({0.0, *crossing(p.current), 1.0}))
    ]


def behind(I: Pair, V: Pair, loss: float) -> Pair:
    """Voltage at the input of a power stage that loses so much per ampere [V]."""
    more = math.copysign(loss, sum(I))
    return V[0] + more, V[1] + more


class Warm(NamedTuple):
    """A winding in a piece: at its left and right end, at its warmest, and in the mean [K]."""

    left: float
    right: float
    top: float
    mean: float


def resistance(motor: Any, temperature: float) -> float:
    """Of the winding [ohm]."""
    return motor.resistance * (1 + ALPHA * (temperature - ROOM))


def volts(piece: Piece, motor: Any, left: float, right: float | None = None) -> Pair:
    """Voltage at both ends of temperatures [K]: what the resistance takes and what the motion induces."""
    at = left, left if right is None else right
    k = motor.torque_constant
    return tuple(resistance(motor, at[n]) * piece.current[n] + k * piece.speed[n] for n in (0, 1))  # type: ignore[return-value]


def hottest_volts(piece: Piece, motor: Any, T: Warm) -> Pair:
    """The same of a winding as warm as it then is; where nothing else changes one end stands for its warmest moment."""
    if piece.current[0] != piece.current[1] or piece.speed[0] != piece.speed[1]:
        return volts(piece, motor, T.left, T.right)
    return volts(piece, motor, T.left, T.top) if T.right >= T.left else volts(piece, motor, T.top, T.right)


def commutation(motor: Any) -> float:
    """What six commutations in a period take of the voltage, per current and speed: 3/(2 pi) p L [V*s/(A*rad)]."""
    X = 0.0 if motor.kind == "brushed" else 3.0 / (2.0 * math.pi) * motor.pole_pairs * motor.inductance
    return 0.0 if math.isnan(X) else X


def commutating(piece: Piece, motor: Any, share: float) -> Pair:
    """A share of it at both ends, where the motor drives [V]."""
    X = share * commutation(motor)
    return tuple(X * max(piece.current[n] * piece.speed[n], 0.0) for n in (0, 1))  # type: ignore[return-value]


def hottest(pieces: list[Piece], motor: Any, ambient: float, I_peak: float) -> float:
    """The steady temperature with the largest current and loss all the time [K]."""
    fastest = max(abs(w) for p in pieces for w in p.speed)
    always = Piece(0.0, 1.0, (0.0, 0.0), (0.0, 0.0), 1, (I_peak, I_peak), (fastest, fastest))
    return settled(motor, ambient, I_peak, housing(always, motor))


def strongest(I: Pair, V: Pair) -> float:
    """Largest product of two lines: at an end, or where the parabola through three values of it turns."""
    p0, p1 = I[0] * V[0], I[1] * V[1]
    middle = (I[0] + I[1]) / 2 * (V[0] + V[1]) / 2
    a, b = 2 * (p0 - 2 * middle + p1), 4 * middle - 3 * p0 - p1
    best = largest([p0, p1])
    if a < 0 and 0 < -b / (2 * a) < 1:
        best = max(best, p0 - b * b / (4 * a))
    return best


def loss_per_ampere(controller: Any, otherwise: float = 1.0) -> float:
    """Power that a power stage loses per ampere [V]: the larger of two printed figures, 1 V where there is none."""
    if controller is None:
        return otherwise
    duty = 1.0 if math.isnan(controller.max_duty) else controller.max_duty
    printed = controller.voltage_drop, (1.0 / controller.max_efficiency - 1.0) * duty * controller.supply_max
    return max((x for x in printed if not math.isnan(x)), default=otherwise)


def charge(pieces: list[Piece]) -> float:
    """Integral of the absolute current [A s]."""
    spans = [(p, *ends) for p in pieces for ends in itertools.pairwise(sorted({0.0, *crossing(p.current), 1.0}))]
    return sum(abs(product(p.time * (b - a), between(p.current, a, b), (1.0, 1.0))) for p, a, b in spans)


def energy(flow: list[tuple[float, Pair, Pair]], kept: float = 1.0, *, loss: float = 0.0) -> tuple[float, float, float]:
    """Drawn and returned over a cycle, and the most in a store that takes what is kept of that and gives first.

    ``loss``: of the power stage, per ampere [V].
    """
    steps = []
    for time, I, V in flow:
        U = behind(I, V, loss)
        for left, right in itertools.pairwise(sorted({0.0, *crossing(U), 1.0})):
            steps.append(product(time * (right - left), between(I, left, right), between(U, left, right)))
    if any(map(math.isnan, steps)):
        return NAN, NAN, NAN
    drawn, returned = sum(s for s in steps if s > 0), -sum(s for s in steps if s < 0)
    if kept * returned > drawn:
        return drawn, returned, math.inf  # more every time
    held = most = 0.0
    for step in steps * 2:
        held = max(held - (step if step > 0 else kept * step), 0.0)
        most = max(most, held)
    return drawn, returned, most


def above(pieces: list[Piece], limit: float) -> float:
    """Longest time on end with more than a current, the cycle repeating."""
    if math.isnan(limit) or any(math.isnan(p.current[0]) for p in pieces):
        return NAN
    spans: list[list[float]] = []  # from, to
    total = sum(p.time for p in pieces)
    for p in pieces:
        a, b = p.current
        at = [(level - a) / (b - a) for level in (limit, -limit)] if a != b else []
        cuts = sorted({0.0, *(s for s in at if 0 < s < 1), 1.0})
        for left, right in itertools.pairwise(cuts):
            if abs(a + (left + right) / 2 * (b - a)) > limit:
                begin, end = p.start + left * p.time, p.start + right * p.time
                if spans and abs(spans[-1][1] - begin) < 1e-9 * total:
                    spans[-1][1] = end
                else:
                    spans.append([begin, end])
    if not spans:
        return 0.0
    lengths = [end - begin for begin, end in spans]
    if len(spans) > 1 and spans[0][0] < 1e-9 * total and total - spans[-1][1] < 1e-9 * total:
        lengths.append(lengths[0] + lengths[-1])
    return min(max(lengths), total)


# --- heat ---


def housing(piece: Piece, motor: Any) -> float:
    """Energy lost at the housing over a piece [J]: brushes and bearings, or iron calibrated at the nominal point."""
    dry, per_speed = friction(motor)
    turned, squared = abs(sum(piece.speed)) / 2 * piece.time, product(piece.time, piece.speed, piece.speed)
    if motor.kind == "brushed":
        return dry * turned + per_speed * squared
    R_1, R_2 = motor.thermal_resistance_winding, motor.thermal_resistance_housing
    rise = motor.max_winding_temperature - ROOM
    copper = motor.resistance * (1 + ALPHA * rise) * motor.nominal_current**2
    iron = (rise - (R_1 + R_2) * copper) / R_2  # W at nominal speed
    iron = 0.0 if iron < 0 else iron  # over the speed it goes as friction does
    at_nominal = (dry + per_speed * motor.nominal_speed) * motor.nominal_speed
    return iron * (dry * turned + per_speed * squared) / at_nominal


def settled(motor: Any, ambient: float, I_rms: float, loss: float) -> float:
    """Winding in the long run: R grows with the rise x; x (1 - a c) = c (1 + a (T_a - 25 degC)) + R_2 loss."""
    R_2 = motor.thermal_resistance_housing
    c = (motor.thermal_resistance_winding + R_2) * motor.resistance * I_rms**2
    if math.isnan(c + loss):
        return NAN
    if ALPHA * c >= 1:
        return math.inf
    return ambient + (c * (1 + ALPHA * (ambient - ROOM)) + R_2 * loss) / (1 - ALPHA * c)


def _network(motor: Any, ambient: float, square: float, loss: float) -> tuple[tuple[float, ...], Pair]:
    """Winding and housing as rises over the ambient, x' = A x + b."""
    R_1, R_2 = motor.thermal_resistance_winding, motor.thermal_resistance_housing
    C_w, C_h = motor.winding_time_constant / R_1, motor.motor_time_constant / R_2
    P = motor.resistance * square
    matrix = ((ALPHA * P - 1 / R_1) / C_w, 1 / (R_1 * C_w), 1 / (R_1 * C_h), -(1 / R_1 + 1 / R_2) / C_h)
    return matrix, (P * (1 + ALPHA * (ambient - ROOM)) / C_w, loss / C_h)


QUICKEST = float(np.nanmin(load(["maxon"]).motors["winding_time_constant"]))  # s


def finer(p: Piece) -> list[Piece]:
    """A piece in which something changes in so many that a winding feels the mean of each: x/12n² is 0.1 % at most."""
    changing = any(a != b for a, b in (p.gear_torque, p.gear_speed, p.current))
    n = min(math.ceil(math.sqrt(p.time / QUICKEST / 0.012)), 200) if changing else 1
    cuts = [k / n for k in range(n + 1)]
    return [
        Piece(p.start + p.time * a, p.time / n, *(line(x, a, b) for x in (p.gear_torque, p.gear_speed)), p.way,
              *(line(x, a, b) for x in (p.current, p.speed)))
        for a, b in itertools.pairwise(cuts)
    ]  # fmt: skip


def line(ends: Pair, left: float, right: float) -> Pair:
    """A line between two shares of it."""
    return ends[0] + left * (ends[1] - ends[0]), ends[0] + right * (ends[1] - ends[0])


def periodic(pieces: list[Piece], motor: Any, ambient: float, steady: float) -> tuple[list[Piece], list[Warm], float]:
    """The cycle so fine that a winding feels the mean of each piece, how warm it is in each, and its peak."""
    pieces = [part for p in pieces for part in finer(p)]
    nowhere = [Warm(NAN, NAN, NAN, NAN)] * len(pieces)
    if math.isnan(motor.winding_time_constant + motor.motor_time_constant) or math.isnan(steady):
        return pieces, nowhere, NAN
    steps = []
    x = (0.0, 0.0)  # particular solution, and the two of the homogeneous equation
    y, z = (1.0, 0.0), (0.0, 1.0)
    for p in pieces:
        square, loss = product(p.time, p.current, p.current) / p.time, housing(p, motor) / p.time
        step = _Step(*_network(motor, ambient, square, loss))
        if step.fast * p.time > 300 or step.slow * p.time > 300:
            return pieces, nowhere, math.inf
        steps.append((step, p.time))
        x, y, z = step.after(x, p.time), step.after(y, p.time, 0.0), step.after(z, p.time, 0.0)
    if not largest([*map(abs, y), *map(abs, z)]) < 1e100:
        return pieces, nowhere, math.inf
    trace, det = y[0] + z[1], y[0] * z[1] - y[1] * z[0]
    if trace / 2 + math.sqrt(max(trace * trace / 4 - det, 0.0)) >= 1:
        return pieces, nowhere, math.inf
    a, b, c, d = 1 - y[0], -z[0], -y[1], 1 - z[1]
    whole = a * d - b * c
    x = ((x[0] * d - b * x[1]) / whole, (a * x[1] - c * x[0]) / whole)
    found = []
    for step, time in steps:
        after = step.after(x, time)
        rises = x[0], after[0], max(x[0], after[0], step.highest(x, time)), step.mean(x, time)
        found.append(Warm(*(ambient + rise for rise in rises)))
        x = after
    return pieces, found, max(T.top for T in found)


class _Step:
    """Winding and housing under constant losses, in closed form."""

    def __init__(self, matrix: tuple[float, ...], b: Pair) -> None:
        m11, m12, m21, m22 = self.matrix = matrix
        root = math.sqrt((m11 - m22) ** 2 / 4 + m12 * m21)
        self.slow, self.fast = (m11 + m22) / 2 + root, (m11 + m22) / 2 - root
        self.b = b

    def _modes(self, x: Pair, drive: float) -> tuple[Pair, Pair]:
        """Both modes of the rates of change: where the rises would rest may be millions of kelvin off."""
        m11, m12, m21, m22 = self.matrix
        d_1, d_2 = (m11 * x[0] + m12 * x[1] + drive * self.b[0], m21 * x[0] + m22 * x[1] + drive * self.b[1])
        Md_1, Md_2 = m11 * d_1 + m12 * d_2, m21 * d_1 + m22 * d_2
        s, f, span = self.slow, self.fast, self.slow - self.fast
        return ((Md_1 - f * d_1) / span, (Md_2 - f * d_2) / span), ((s * d_1 - Md_1) / span, (s * d_2 - Md_2) / span)

    def after(self, x: Pair, time: float, drive: float = 1.0) -> Pair:
        slow, fast = self._modes(x, drive)
        s, f = math.expm1(self.slow * time) / self.slow, math.expm1(self.fast * time) / self.fast
        return tuple(x[n] + slow[n] * s + fast[n] * f for n in (0, 1))  # type: ignore[return-value]

    def mean(self, x: Pair, time: float) -> float:
        """Of the winding, over the time: Simpson in steps so fine that nothing is left of the fast mode between."""
        n = 2 * max(8, math.ceil(-40 * self.fast * time))
        slow, fast = self._modes(x, 1.0)
        (s, of_s), (f, of_f) = (slow[0] / self.slow, self.slow), (fast[0] / self.fast, self.fast)
        if n > 4000:
            return x[0] + sum(c * (math.expm1(r * time) / (r * time) - 1.0) for c, r in ((s, of_s), (f, of_f)))
        moments = [time * k / n for k in range(n + 1)]
        values = [x[0] + s * math.expm1(of_s * t) + f * math.expm1(of_f * t) for t in moments]
        return (values[0] + values[-1] + 4 * sum(values[1:-1:2]) + 2 * sum(values[2:-1:2])) / (3 * n)

    def highest(self, x: Pair, time: float) -> float:
        """Where the winding's rate is zero, if that is within."""
        slow, fast = self._modes(x, 1.0)
        rates = slow[0], -fast[0]
        if rates[0] * rates[1] <= 0:
            return -math.inf
        at = math.log(rates[0] / rates[1]) / (self.fast - self.slow)
        return self.after(x, at)[0] if 0 < at < time else -math.inf


def simulated_peak(pieces: list[Piece], motor: Any, ambient: float, least_steps: int) -> float:
    """The same peak by simulation in small steps (Runge-Kutta) with the current of each moment: no closed form."""

    def rates(x: Pair, p: Piece, share: float) -> Pair:
        square = (p.current[0] + share * (p.current[1] - p.current[0])) ** 2
        A, b = _network(motor, ambient, square, housing(p, motor) / p.time)
        return A[0] * x[0] + A[1] * x[1] + b[0], A[2] * x[0] + A[3] * x[1] + b[1]

    def simulate(x: Pair) -> tuple[Pair, float]:
        peak = x[0]
        for p in pieces:
            steps = max(least_steps, math.ceil(20 * p.time / motor.winding_time_constant))
            h = p.time / steps
            for n in range(steps):
                s = n / steps
                k1 = rates(x, p, s)
                k2 = rates((x[0] + h / 2 * k1[0], x[1] + h / 2 * k1[1]), p, s + 0.5 / steps)
                k3 = rates((x[0] + h / 2 * k2[0], x[1] + h / 2 * k2[1]), p, s + 0.5 / steps)
                k4 = rates((x[0] + h * k3[0], x[1] + h * k3[1]), p, s + 1 / steps)
                x = tuple(x[m] + h / 6 * (k1[m] + 2 * k2[m] + 2 * k3[m] + k4[m]) for m in (0, 1))  # type: ignore[assignment]
                peak = max(peak, x[0])
        return x, peak

    g, (p1, _), (p2, _) = simulate((0.0, 0.0))[0], simulate((1.0, 0.0)), simulate((0.0, 1.0))
    a, c = 1 - (p1[0] - g[0]), -(p1[1] - g[1])
    b, d = -(p2[0] - g[0]), 1 - (p2[1] - g[1])
    whole = a * d - b * c
    return ambient + simulate(((g[0] * d - b * g[1]) / whole, (a * g[1] - c * g[0]) / whole))[1]


# --- limits ---


class Verdict(NamedTuple):
    """One check."""

    demand: float
    limit: float
    status: str
    margin: float


def at_most(demand: float, limit: float, needed: float = 0.0, zero: float = 0.0) -> Verdict:
    """A demand against a limit; the margin counts from ``zero``."""
    if demand == zero:
        return Verdict(demand, limit, "pass", NAN)
    if math.isnan(demand):
        return Verdict(demand, limit, "unknown", NAN)
    margin = NAN if math.isinf(demand) and math.isnan(limit) else (limit - zero) / (demand - zero) - 1
    if math.isinf(demand):
        return Verdict(demand, limit, "fail", margin)
    if math.isnan(limit):
        return Verdict(demand, limit, "unknown", NAN)
    return Verdict(demand, limit, "fail" if (demand - zero) * (1 + needed) > limit - zero else "pass", margin)


def for_short(demand: float, limit: float, lasting: float, needed: float) -> Verdict:
    """A demand against a limit for a short time, which where it is not printed is at least the continuous one."""
    if not math.isnan(limit):
        return at_most(demand, limit, needed)
    least = at_most(demand, lasting, needed)
    return Verdict(demand, NAN, "pass" if least.status == "pass" else "unknown", NAN)


def within(value: float, least: float, most: float) -> Verdict:
    """A temperature within a range, of which an end that is missing is that of IEC 60034-1: 0 or 40 degC."""
    if value < least or value > most:
        return Verdict(value, NAN, "fail", NAN)
    beyond = (math.isnan(least) and value < 273.15) or (math.isnan(most) and value > 313.15)
    return Verdict(value, NAN, "unknown" if beyond else "pass", NAN)


class Wanted(NamedTuple):
    """What a controller has to do, with the margins that the spec asks for."""

    carried: float  # A, for ever
    peak: float  # A
    volts: float  # of a cold winding
    turning: float  # rad/s, of the commutation; 0 of a brushed motor
    lines: float  # Hz, of the encoder; 0 where none is asked for


def size_of(spec: Any) -> Callable[[Any], float]:
    """What a controller adds to an objective."""
    sizes = {"mass": lambda c: math.inf if math.isnan(c.mass) else c.mass, "energy": loss_per_ampere}
    return sizes.get(spec.select.objective, lambda _: 0.0)


def controllers_for(spec: Any, offered: list[Any], kind: str, wanted: Wanted) -> list[tuple[int, Any]]:
    """Those that do what is asked with the number of figures assumed of each: fewest unknown, then by the objective.

    By mass the lightest of those whose mass is known, by energy that with the least loss; then by current.
    """
    size = size_of(spec)
    does = []
    for c in offered:
        if c.supply_min > spec.supply.lowest or not c.supply_max >= spec.supply.highest:
            continue
        if c.drives not in ("", "both", kind) and not (kind == "" and c.drives):
            continue
        given = voltage_of(spec, c)
        if c.continuous_current < wanted.carried or c.peak_current < wanted.peak or given < wanted.volts:
            continue
        if deciding_voltage(spec, c, wanted.volts) < wanted.volts:  # nothing gives more than its supply, known or not
            continue
        if c.max_speed_sine < wanted.turning or c.max_encoder_frequency < wanted.lines:
            continue
        volts = 0.0 if wanted.volts == 0.0 else deciding_voltage(spec, c, wanted.volts)
        figures = [c.supply_min + c.supply_max, c.continuous_current, c.peak_current, volts]
        figures += [c.max_speed_sine] if wanted.turning > COMMUTATED else []
        figures += [c.max_encoder_frequency] if wanted.lines != 0.0 else []
        figures += [c.peak_time] if c.continuous_current < wanted.peak / (1 + spec.margins.torque) else []
        assumed = math.isnan(given) + (math.isnan(c.peak_time) and c.continuous_current < wanted.peak)
        assumed += math.isnan(c.max_speed_sine) and 0.0 < wanted.turning <= COMMUTATED
        does.append((sum(math.isnan(f) for f in figures), assumed, c))

    def place(one: tuple[int, int, Any]) -> tuple[Any, ...]:
        lacks, assumed, c = one
        return lacks, size(c), assumed, math.isnan(c.continuous_current), c.continuous_current, c.part

    return [(assumed, c) for _, assumed, c in sorted(does, key=place)]


def voltage_of(spec: Any, controller: Any) -> float:
    """What a controller can give at the lowest supply [V]."""
    given = controller.max_duty * (spec.supply.lowest - controller.voltage_drop)
    return given if math.isnan(given) else max(given, 0.0)


def deciding_voltage(spec: Any, controller: Any, volts: float) -> float:
    """The same where drop and duty are printed; else of its ends what decides."""
    known = controller is not None and not math.isnan(controller.voltage_drop + controller.max_duty)
    least, bound = voltage_ends(spec, controller)
    return least if volts <= least or known else bound if volts > bound else NAN


def voltage_ends(spec: Any, controller: Any) -> tuple[float, float]:
    """The same at least and at most: with a drop of 0.5 or 1.1 V and a duty of 0.9, or all that the supply has."""
    duty, drop = (NAN, NAN) if controller is None else (controller.max_duty, controller.voltage_drop)
    least, most = (max((other if math.isnan(duty) else duty) * (spec.supply.lowest - (x if math.isnan(drop) else drop)),
                       0.0) for x, other in ((1.1, 0.9), (0.5, NAN)))  # fmt: skip
    return least, spec.supply.lowest if math.isnan(most) else most


def encoders_for(spec: Any, fitting: list[Any], speed: float, reduction: float) -> list[Any | None]:
    """Of those with counts enough one that is known to bear the speed, else one that may; of them one of known
    inertia, of most worth, of the fewest counts. Behind it those to try where the drive fails with it: each is easier
    to turn.
    """
    required = max(spec.needs.encoder_counts or 0, spec.select.encoder.min_counts or 0)
    ordered = sorted(fitting, key=lambda c: (math.isnan(c.counts_per_turn), c.counts_per_turn, c.part))
    enough = [c for c in ordered if c.counts_per_turn >= required]
    if spec.needs.resolution_at_load is not None:
        enough = [
            c for c in enough if 2 * math.pi / (4 * c.counts_per_turn * reduction) <= spec.needs.resolution_at_load
        ]
    if not enough:
        return [ordered[-1] if ordered else None]
    fast = speed * (1 + spec.margins.speed)

    def standing(c: Any) -> int:
        limits = [c.max_speed, c.max_frequency * 2 * math.pi / c.counts_per_turn]
        return 2 if any(limit < fast for limit in limits) else 1 if any(map(math.isnan, limits)) else 0

    def worth(c: Any) -> float:
        if spec.select.objective == "mass":
            return math.inf if math.isnan(c.mass) else float(c.mass)
        if spec.select.objective in ("energy", "peak_current"):
            return inertia(c)
        if not encoder_required(spec):
            return 0.0
        ratios = [c.max_speed / fast, c.max_frequency * 2 * math.pi / c.counts_per_turn / fast]
        ratios += [c.counts_per_turn / required] if required else []
        if spec.needs.resolution_at_load is not None:
            ratios.append(spec.needs.resolution_at_load * 4 * c.counts_per_turn * reduction / (2 * math.pi))
        return -min((x for x in ratios if not math.isnan(x)), default=math.inf)

    def inertia(c: Any) -> float:
        return 0.0 if math.isnan(c.inertia) else float(c.inertia)

    alike, found = [c for c in enough if standing(c) == min(map(standing, enough))], list[Any]()
    while alike:
        found.append(min(alike, key=lambda c: (math.isnan(c.inertia), worth(c), enough.index(c))))
        alike = [c for c in alike if inertia(c) < inertia(found[-1])]
    return found


def encoder_required(spec: Any) -> bool:
    """Whether the spec says anything of an encoder."""
    needs, choice = spec.needs, spec.select.encoder
    return any((needs.encoder_counts, needs.resolution_at_load, choice.min_counts, choice.family, choice.part))


def figure(part: Any | None, name: str) -> float:
    """A figure of a part that may not be there."""
    return NAN if part is None else getattr(part, name)


HANGING = "supply_voltage", "controller_peak_time", "bus_voltage", "controller_power", "supply_current", "supply_power"
OF_CONTROLLER = (
    *HANGING, "controller_continuous_current", "controller_peak_current", "controller_speed", "encoder_frequency",
)  # fmt: skip
ELECTRICAL = (
    *HANGING, "winding_temperature", "motor_peak_torque", "controller_continuous_current", "controller_peak_current",
    "controller_speed", "encoder_speed", "encoder_frequency", "encoder_resolution",
)  # fmt: skip


def chosen(
    spec: Any,
    cycle: Any,
    pieces: list[Piece],
    of: Callable[[Any | None], Asked],
    parts: tuple[Any, Any, Any],
    belt: float,
    offered: list[Any],
) -> tuple[dict[str, Verdict], Any, Asked]:
    """Every check of one set with the best controller: none fails, the fewest are unknown, least cost, the smallest.

    Of equals one goes before that has all figures. Where all fail there is none, for others may exist, but where
    without one a check fails as well; more voltage than the supply has fails with the largest.
    ``of``: demands with a controller, which hang on its loss.
    """

    def with_one(controller: Any | None) -> dict[str, Verdict]:
        return checks(spec, cycle, pieces, of(controller), parts, belt, controller)

    idle = () if encoder_required(spec) else ("encoder_speed", "encoder_frequency")

    def fails(some: dict[str, Verdict], names: Sequence[str] = ELECTRICAL) -> bool:
        return any(some[n].status == "fail" for n in names if n in some and n not in idle)

    def rank(assumed: int, controller: Any, some: dict[str, Verdict]) -> tuple[Any, ...]:
        unknown = sum(some[n].status in ("unknown", "open") for n in OF_CONTROLLER if n in some and n not in idle)
        unknown += math.isnan(controller.supply_min + controller.supply_max)
        cost = size_of(spec)(controller)
        if spec.select.objective == "margin":
            known = (some[n].margin for n in ELECTRICAL if n in some and n not in idle)
            cost = -round(min((x for x in known if not math.isnan(x)), default=math.inf), 9)
        current = controller.continuous_current
        return unknown, cost, assumed, math.isnan(current), current, controller.part

    motor, _, encoder = parts
    found = of(None)
    wanted = _wanted(spec, found, motor, encoder)
    does = controllers_for(spec, offered, motor.kind, wanted)
    one = does[0][1] if does else None
    if not does and wanted.volts > spec.supply.lowest:  # no controller's fault: the largest is named
        nothing = Wanted(0.0, 0.0, 0.0, 0.0, 0.0)
        able = [c for _, c in controllers_for(spec, offered, motor.kind, nothing)]
        able = [c for c in able if not math.isnan(c.supply_min + c.supply_max + c.continuous_current + c.peak_current)]
        one = max(able, key=lambda c: (c.continuous_current, c.part), default=None)
    best = with_one(one)
    if not does or fails(best, [n for n in ELECTRICAL if n not in HANGING]):
        return best, one, of(one)
    more = (1 + spec.margins.speed) * best["supply_voltage"].demand > spec.supply.lowest
    able = [(rank(assumed, c, some), c, some) for assumed, c in does if not more and not fails(some := with_one(c))]
    if able:
        _, one, best = min(able, key=lambda each: each[0])
    elif fails(best) and not more and not fails(with_one(None)):
        best, one = with_one(None), None
    return best, one, of(one)


def _wanted(spec: Any, found: Asked, motor: Any, encoder: Any) -> Wanted:
    """What the set asks of a controller, before its own limits are looked at."""
    more, fast = 1 + spec.margins.torque, 1 + spec.margins.speed
    return Wanted(
        more * found.I_rms, more * found.I_peak, fast * found.V_start,
        0.0 if motor.kind == "brushed" else fast * found.speed * motor.pole_pairs,
        fast * figure(encoder, "counts_per_turn") * found.speed / (2 * math.pi) if encoder_required(spec) else 0.0,
    )  # fmt: skip


def checks(
    spec: Any,
    cycle: Any,
    pieces: list[Piece],
    found: Asked,
    parts: tuple[Any, Any, Any],
    belt: float,
    controller: Any | None,
) -> dict[str, Verdict]:
    """Every check of one set with a controller or with none."""
    motor, head, encoder = parts
    more, fast = spec.margins.torque, spec.margins.speed
    ambient, i, out = spec.environment.ambient, head.ratio, {}
    out["compatibility"] = Verdict(NAN, NAN, "pass", NAN)
    for own in cycle.own:
        if own.name == "screw_axial_force":  # of a shaft that carries the screw: no check by itself
            continue
        out[own.name] = at_most(own.demand, own.limit, more)
    if spec.belt is not None and spec.belt.pulley_diameter is not None:
        r = spec.belt.pulley_diameter / 2
        if spec.belt.max_tension is not None:
            pull = max(abs(x) for s in segments_of(cycle) for x in s.torque) / r
            out["belt_tension"] = at_most(pull, spec.belt.max_tension, more)
        if spec.belt.max_speed is not None:
            out["belt_speed"] = at_most(found.gear_speed / belt * r, spec.belt.max_speed, fast)
    out["gearhead_continuous_torque"] = at_most(found.gear_rms, head.continuous_torque, more)
    out["gearhead_intermittent_torque"] = for_short(
        found.gear_peak, head.intermittent_torque, head.continuous_torque, more
    )
    out["gearhead_continuous_speed"] = at_most(found.gear_sustained * i, head.continuous_input_speed, fast)
    out["gearhead_intermittent_speed"] = for_short(
        found.gear_speed * i, head.intermittent_input_speed, head.continuous_input_speed, fast
    )
    for name, power in (("continuous_power", found.gear_mean_power), ("intermittent_power", found.gear_peak_power)):
        of_power = out[f"gearhead_{name}"] = at_most(power, getattr(head, name), more)
        if of_power.status == "unknown" and not math.isnan(head.continuous_torque + head.continuous_input_speed):
            out[f"gearhead_{name}"] = of_power._replace(status="pass")  # the maker limits torque and speed alone
    out["gearhead_temperature_range"] = within(ambient, head.temperature_min, head.temperature_max)
    out["motor_temperature_range"] = within(ambient, motor.ambient_min, motor.ambient_max)
    out["motor_speed"] = at_most(found.speed, motor.max_speed, fast)
    reached = [x for x in (motor.nominal_speed, motor.no_load_speed / 1.3) if not math.isnan(x)]
    if math.isnan(motor.max_speed) and found.speed * (1.0 + fast) <= max(reached, default=0.0):
        out["motor_speed"] = out["motor_speed"]._replace(status="pass")  # its maker runs it at that
    span = motor.max_winding_temperature - ROOM
    share = math.sqrt(max(motor.max_winding_temperature - ambient, 0.0) / span) if span > 0 else NAN
    share = 1.0 if ambient == ROOM else share  # as the datasheet has it, whatever it permits
    out["motor_nominal_current"] = at_most(found.I_rms, motor.nominal_current * share, more)
    if math.isnan(span) and ambient < ROOM and at_most(found.I_rms, motor.nominal_current, more).status == "pass":
        # in the cold it bears more than in the room, whatever its winding is permitted
        out["motor_nominal_current"] = at_most(found.I_rms, motor.nominal_current, more)
    torque = found.I_peak * motor.torque_constant
    out["motor_peak_torque"] = at_most(torque, math.inf, spec.margins.torque)  # maxon limits heat and speed alone
    out["winding_temperature"] = bounded(
        at_most(T, motor.max_winding_temperature, spec.margins.temperature, zero=ambient) for T in found.winding
    )
    _wishes(spec, cycle, motor, head, encoder, belt, out)
    held = above(pieces, figure(controller, "continuous_current"))
    range_known = not math.isnan(figure(controller, "supply_min") + figure(controller, "supply_max"))
    out["controller_available"] = Verdict(NAN, NAN, "pass" if range_known else "unknown", NAN)
    limits = [deciding_voltage(spec, controller, V * (1 + fast)) for V in found.V_peak]
    volts = bounded(at_most(V, limit, fast) for V, limit in zip(found.V_peak, limits, strict=True))
    if volts.status == "unknown" and all(map(math.isfinite, found.V_peak)):  # both ends of the limit are known
        volts = Verdict(found.V_peak[0], voltage_ends(spec, controller)[0], "open", NAN)
    out["supply_voltage"] = volts
    out["controller_continuous_current"] = at_most(found.I_rms, figure(controller, "continuous_current"), more)
    out["controller_peak_current"] = at_most(found.I_peak, figure(controller, "peak_current"), more)
    out["controller_peak_time"] = at_most(held, figure(controller, "peak_time"))
    out["encoder_speed"] = at_most(found.speed, figure(encoder, "max_speed"), fast)
    rates = [figure(encoder, "max_frequency"), figure(controller, "max_encoder_frequency")]
    edges = figure(encoder, "counts_per_turn") * found.speed / (2 * math.pi)
    sure = [rate for rate in rates if edges * (1 + fast) > rate]  # too slow, whatever the other is
    lowest = min(sure) if sure else NAN if any(map(math.isnan, rates)) else min(rates)
    out["encoder_frequency"] = at_most(edges, lowest, fast)
    turning = 0.0 if motor.kind == "brushed" else found.speed * motor.pole_pairs
    limit = math.inf if motor.kind == "brushed" else figure(controller, "max_speed_sine")
    out["controller_speed"] = at_most(turning, limit, fast)
    if controller is not None and math.isnan(limit) and turning * (1 + fast) <= COMMUTATED:  # as the slowest that print
        out["controller_speed"] = at_most(turning, COMMUTATED, fast)
    _supply(spec, found, controller, out)
    return out


def _supply(spec: Any, found: Asked, controller: Any, out: dict[str, Verdict]) -> None:
    supply, sets, more = spec.supply, spec.load.motors, spec.margins.torque
    out["controller_power"] = bounded(at_most(P, math.inf, more) for P in found.power)  # maxon limits currents alone
    if supply.current is not None:
        out["supply_current"] = bounded(at_most(P * sets / supply.lowest, supply.current, more) for P in found.power)
    if supply.power is not None:
        out["supply_power"] = bounded(at_most(P * sets, supply.power, more) for P in found.power)
    buses = []
    for stored in found.stored:
        if supply.accepts == "all" or (supply.accepts is None and spec.battery):
            bus = supply.highest  # what is not stored is lost in the battery
        elif supply.capacitance is None:
            most = figure(controller, "supply_max")
            ripple = figure(controller, "continuous_current") / (4 * 100e3 * 0.1 * supply.highest)  # a tenth at 100 kHz
            bus = math.sqrt(supply.highest**2 + 2 * stored / ripple) if stored else supply.highest
            bus = bus if bus <= most or not stored else NAN
        else:  # C/2 (U^2 - U_0^2) is what stays
            bus = math.sqrt(supply.highest**2 + 2 * stored * sets / supply.capacitance)
        buses.append(bus)
    out["bus_voltage"] = bounded(at_most(bus, figure(controller, "supply_max")) for bus in buses)


def bounded(bounds: Any) -> Verdict:
    """Of a demand of which only bounds are known: what both say, or the one that decides; open where neither does."""
    low, high = bounds
    if high.status == "pass" or low.demand == high.demand:
        return high
    known = not math.isnan(low.demand + low.limit) and math.isfinite(high.demand) and math.isfinite(high.limit)
    return low if low.status == "fail" else Verdict(low.demand, low.limit, "open" if known else "unknown", NAN)


def _wishes(spec: Any, cycle: Any, motor: Any, head: Any, encoder: Any, belt: float, out: dict[str, Verdict]) -> None:
    needs, K = spec.needs, head.ratio * belt
    counts = figure(encoder, "inertia")
    own = (motor.rotor_inertia + head.inertia + (0.0 if math.isnan(counts) else counts)) * K**2
    if needs.backlash_at_load is not None:
        out["backlash_at_load"] = at_most(head.backlash / belt, needs.backlash_at_load)
    if needs.radial_load is not None:
        out["gearhead_radial_load"] = at_most(needs.radial_load, head.max_radial_load, spec.margins.torque)
        at_motor = motor.max_radial_load if head.kind == "direct" else math.inf
        out["motor_radial_load"] = at_most(needs.radial_load, at_motor, spec.margins.torque)
    if needs.inertia_ratio is not None:
        out["inertia_ratio"] = at_most(cycle.inertia / own, needs.inertia_ratio)
    if needs.resonance is not None:
        c = NAN if spec.belt is None or spec.belt.stiffness is None else spec.belt.stiffness
        rate = math.sqrt(c / own + c / cycle.inertia)
        out["first_resonance"] = at_most(needs.resonance, rate / (2 * math.pi))
    if needs.resolution_at_load is not None:
        step = 2 * math.pi / (4 * figure(encoder, "counts_per_turn") * K)
        out["encoder_resolution"] = at_most(step, needs.resolution_at_load)
    required = max(needs.encoder_counts or 0, spec.select.encoder.min_counts or 0)
    if required:
        there = 0.0 if encoder is None else encoder.counts_per_turn
        verdict = at_most(float(required), there)
        out["encoder_counts"] = verdict._replace(margin=NAN) if verdict.status == "pass" else verdict
    for name in ("length", "mass", "price"):
        if getattr(needs, name):
            out[name] = at_most(getattr(motor, name) + getattr(head, name), getattr(needs, name))
    if needs.diameter:
        out["diameter"] = at_most(largest([motor.diameter, head.diameter]), needs.diameter)
