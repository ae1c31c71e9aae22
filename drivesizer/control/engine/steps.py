"""One period under a held voltage: the machine's mode, exact steps, temperatures, limits, sums; see ``layout``."""

from __future__ import annotations

import math
from typing import Any

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array

__all__ = ["available_voltage", "friction_holds", "holding_torque", "load_torque", "mode_of"]


# -- The mode of a drive train and its torques: directions of motor and load, contact, direction of power.
#
# Arrays as in ``layout``. Symbols as in ``linear_modes``; f twist [rad], T torque of the driven shaft [N*m].


def direction(speed: float, push: float, up: float, down: float) -> int:
    """Direction of motion: that of the speed; at rest that in which a torque overcomes the holding torque."""
    if speed != 0.0:
        return 1 if speed > 0.0 else -1
    return 1 if push > up else -1 if push < down else 0


def shaft_torque(p: Array, contact: float, w: float, f: float, v: float) -> float:
    """Torque of a flexible shaft in contact."""
    return float(p[at.C] * (f - contact * 0.5 * p[at.GAP]) + p[at.DAMP] * (w / p[at.RATIO] - v))


def contact_side(p: Array, w: float, f: float, v: float) -> int:
    """Side of the backlash that is in contact under pressure; without backlash the sign of the torque."""
    if p[at.GAP] == 0.0:
        return 1 if shaft_torque(p, 0.0, w, f, v) >= 0.0 else -1
    side = 1 if f > 0.0 else -1
    beyond = abs(f) > 0.5 * p[at.GAP] and side * shaft_torque(p, float(side), w, f, v) > 0.0
    return side if beyond else 0


def holding_torque(p: Array, T: float, side: float) -> float:
    """Torque at the motor that overcomes stiction and a load's torque."""
    return float(side * p[at.F_S] + T * (p[at.DRIVE] if T * side > 0.0 else p[at.BRAKE]))


def mode_code(motor: int, load: int, power: int) -> int:
    """A mode as one number: directions of motor and load, and of the shaft's torque."""
    return motor + 1 + 3 * (load + 1) + 9 * (power + 1)


def mode_of(p: Array, i: float, w: float, f: float, v: float, l: float) -> int:
    """The mode of a state."""
    push = p[at.K_T] * i
    if p[at.TWO] != 0.0:
        c = contact_side(p, w, f, v)
        T = shaft_torque(p, float(c), w, f, v) if c != 0 else 0.0
        motor = direction(w, push, holding_torque(p, T, 1.0), holding_torque(p, T, -1.0))
        return mode_code(motor, direction(v, T - l, p[at.T_F], p[at.T_B]), c)
    side = direction(w, push, holding_torque(p, p[at.T_F] + l, 1.0), holding_torque(p, p[at.T_B] + l, -1.0))
    if side == 0:
        return mode_code(side, side, side)
    T = (p[at.T_F] if side > 0 else p[at.T_B]) + l + p[at.B_L] * w / p[at.RATIO]
    M = push - side * p[at.F_M] - p[at.B_M] * w
    return mode_code(side, side, 1 if T * p[at.RATIO] * p[at.J_M] + p[at.J_L] * M > 0.0 else -1)


def friction_holds(p: Array, f: float, l: float) -> bool:
    """Whether friction alone holds a motor at rest."""
    code = mode_of(p, 0.0, 0.0, f, 0.0, l)
    return code % 3 == 1 and code // 3 % 3 == 1


def load_torque(p: Array, side: int) -> float:
    """Constant torque of the load by direction of motion."""
    return float(p[at.T_F] if side > 0 else p[at.T_B] if side < 0 else p[at.T_0])


def driven_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque of the driven shaft in a mode."""
    side, c = code % 3 - 1, code // 9 - 1
    if p[at.TWO] != 0.0:
        return shaft_torque(p, float(c), w, f, v) if c != 0 or p[at.GAP] == 0.0 else 0.0
    T = load_torque(p, side) + l
    if side == 0:
        return T
    share = p[at.DRIVE] if c * side > 0 else p[at.BRAKE]
    M = p[at.K_T] * i - side * p[at.F_M] - p[at.B_M] * w
    across = p[at.RATIO] * p[at.J_M]
    return float(((T + p[at.B_L] * w / p[at.RATIO]) * across + p[at.J_L] * M) / (across + p[at.J_L] * share))


def gear_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque at the gearhead's output: the driven shaft's through the belt."""
    power = (code % 3 - 1) * (code // 9 - 1)
    share = p[at.G_D] if power > 0 else p[at.G_B] if power < 0 else p[at.G_0]
    return float(driven_torque(p, code, i, w, f, v, l) * share)


def matrix_of(p: Array, code: int) -> int:
    """Number of a mode's matrix in ``linear_modes.generators``."""
    side, load, c = code % 3 - 1, code // 3 % 3 - 1, code // 9 - 1
    drives = 1 if c * side >= 0 else 2
    if p[at.TWO] == 0.0:
        return 0 if side == 0 else drives
    return abs(side) + 2 * abs(load) + 4 * (drives if c != 0 else 0)


# -- Records of a simulation: largest magnitudes with times, sums, rows of the time series; arrays as in ``layout``.


def keep_peak(g: Array, place: int, value: float, t: float) -> None:
    """Keep the largest magnitude and its time."""
    if abs(value) > g[place]:
        g[place], g[place + 1] = abs(value), t


def keep_demand(p: Array, g: Array, demand: float, i: float, t: float) -> None:
    """Keep the largest voltage demand, and that at the power stage with what resistances take of its voltage."""
    keep_peak(g, at.G_U_DEMAND, demand, t)
    keep_peak(g, at.G_U_STAGE, abs(demand) + p[at.LEADS] * max(0.0, i if demand >= 0.0 else -i), t)


def square_of(first: float, last: float, area: float, dt: float) -> float:
    """Integral of a square by the ends and the integral; exact for a parabola (its Legendre polynomials)."""
    mean, rise, bend = area / dt, last - first, (first + last) / 2.0 - area / dt
    return dt * (mean * mean + rise * rise / 12.0 + bend * bend / 5.0)


def add_energy(p: Array, g: Array, work: float, charge: float, square: float) -> None:
    """Add energy into the power stage, by that of the motor, and charge and square of the current over that time."""
    taken = work + p[at.LOSS] * abs(charge) + p[at.R_B] * square
    if taken > 0.0:
        g[at.G_IN] += taken
    else:
        g[at.G_RETURNED] -= taken


def add_square(p: Array, s: Array, g: Array, square: float, dt: float) -> None:
    """Add a step: square of the current, and its I2t integral."""
    s[at.SQUARE] += square
    s[at.I2T] = max(0.0, s[at.I2T] + square - p[at.CONT2] * dt)
    g[at.G_I2T] = max(g[at.G_I2T], s[at.I2T])
    g[at.G_SQUARE] += square


def record_gear_torque(p: Array, s: Array, g: Array, code: int, l: float, t: float, dt: float) -> None:
    """Record the torque of the gearhead; its square over its running time."""
    torque = gear_torque(p, code, s[at.I], s[at.W], s[at.F], s[at.V], l)
    keep_peak(g, at.G_G, torque, t)
    if code % 3 != 1:
        g[at.G_G_SQUARE] += torque * torque * dt
        g[at.G_RUNNING] += dt


def record_errors(p: Array, s: Array, g: Array, speed: float, angle: float, u: float, t: float, weight: float) -> None:
    """Record errors of motor and load, and voltage, at a sample."""
    error, lag = speed - s[at.W], angle - s[at.X]
    slow, behind = speed / p[at.RATIO] - s[at.V], angle / p[at.RATIO] - s[at.Y]
    keep_peak(g, at.G_E_W, error, t)
    keep_peak(g, at.G_E_X, lag, t)
    keep_peak(g, at.G_E_V, slow, t)
    keep_peak(g, at.G_E_Y, behind, t)
    keep_peak(g, at.G_U, u, t)
    add_error_squares(g, error, lag, slow, behind, weight)


def add_error_squares(g: Array, error: float, lag: float, slow: float, behind: float, time: float) -> None:
    """Add squares of errors: speed and angle of the motor, speed and angle of the load."""
    g[at.G_E2_W] += error * error * time
    g[at.G_E2_X] += lag * lag * time
    g[at.G_E2_V] += slow * slow * time
    g[at.G_E2_Y] += behind * behind * time


def add_steady_errors(p: Array, s: Array, g: Array, error: float, lag: float, behind: float, time: float) -> None:
    """Add a steady stretch: errors, and time at the limits; behind: error of the load's angle [rad]."""
    add_error_squares(g, error, lag, error / p[at.RATIO], behind, time)
    g[at.G_SATURATED] += time if s[at.U_CUT] != 0.0 else 0.0
    g[at.G_LIMITED] += time if s[at.I_CUT] != 0.0 else 0.0


def keep_row(rows: Array, kept: Any, size: Any, always: bool, k: int, row: Any) -> None:
    """Keep a row: all while few, else evenly thinned, those after a corner always.

    A row at the time of the last one replaces it: a stretch ends where the next begins.
    """
    if (not always or size[2] <= 0) and k % size[1] != 0:
        return
    n = size[0]
    if n > 0 and rows[n - 1, 0] == row[0]:
        n -= 1
    kept[n] = always and size[2] > 0
    size[2] -= kept[n]
    for c in range(len(row)):
        rows[n, c] = row[c]
    size[0] = n + 1
    if n + 1 < rows.shape[0] - 1:
        return
    m, odd = 0, False
    for n in range(size[0]):
        odd = odd if kept[n] != 0 else not odd
        if kept[n] != 0 or odd:
            for c in range(rows.shape[1]):
                rows[m, c] = rows[n, c]
            kept[m] = kept[n]
            m += 1
    size[0], size[1] = m, size[1] * 2


# -- One period under a held voltage: exact steps of the machine, halved where its mode changes.
#
# Arrays as in ``layout``. Symbols as in ``linear_modes``; f twist [rad], T torque of the driven shaft [N*m].


def update_matrix(p: Array, s: Array, M: Array, work: Array, stamp: Array, mode: int, level: int) -> None:
    """Interpolate a mode's matrix at the winding's temperature: a cubic through four nodes."""
    place = (s[at.T_W] - p[at.NODE_0]) / p[at.NODE_D]
    n = min(max(int(place) - 1, 0), int(p[at.NODES]) - 4)
    x = min(max(place - n, 0.0), 3.0)
    a, b = -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0
    c, d = -x * (x - 1.0) * (x - 3.0) / 2.0, x * (x - 1.0) * (x - 2.0) / 6.0
    for r in range(M.shape[3]):
        for m in range(M.shape[4]):
            work[mode, level, r, m] = (
                a * M[n, mode, level, r, m] + b * M[n + 1, mode, level, r, m]
                + c * M[n + 2, mode, level, r, m] + d * M[n + 3, mode, level, r, m]
            )  # fmt: skip
    stamp[mode, level] = s[at.T_W]


def step(p: Array, s: Array, M: Array, work: Array, stamp: Array, z: Array, code: int, level: int, u: float, l: float,
         dl: float, rows: int) -> None:  # fmt: skip
    """State after a step, in the second half of z: the current alone, or all rows."""
    side, load = code % 3 - 1, code // 3 % 3 - 1
    mode = matrix_of(p, code)
    if p[at.HEAT] != 0.0 and not abs(s[at.T_W] - stamp[mode, level]) <= at.FRESH:
        update_matrix(p, s, M, work, stamp, mode, level)
    m = work[mode, level]
    i, w, friction, resistance = s[at.I], s[at.W], -side * p[at.F_M], load_torque(p, load) + l
    if p[at.TWO] == 0.0:
        for r in range(rows):
            z[8 + r] = (
                m[r, 0] * i + m[r, 1] * w + m[r, 2] * u + m[r, 3] * friction + m[r, 4] * resistance + m[r, 5] * dl
            )
        return
    offset = (code // 9 - 1) * 0.5 * p[at.GAP]
    f, v = s[at.F] - offset, s[at.V]
    for r in range(rows + 2 if rows > 1 else 1):
        z[8 + r] = (
            m[r, 0] * i + m[r, 1] * w + m[r, 2] * f + m[r, 3] * v + m[r, 4] * u + m[r, 5] * friction
            + m[r, 6] * resistance + m[r, 7] * dl
        )  # fmt: skip
    z[10] += offset


def accept(p: Array, s: Array, g: Array, z: Array, code: int, u: float, t: float, dt: float) -> None:
    """Record a step that ends at a time, and move the state to its end."""
    two = p[at.TWO] != 0.0
    q, x = (z[12], z[13]) if two else (z[10], z[11])
    first, last = s[at.I], z[8]
    square = square_of(first, last, q, dt)
    add_square(p, s, g, square, dt)
    add_energy(p, g, u * q, q, square)
    keep_peak(g, at.G_I, last, t)
    keep_peak(g, at.G_W, z[9], t)
    most = first if (first > last) == (u > 0.0) else last
    power = u * most + p[at.LOSS] * abs(most) + p[at.R_B] * most * most
    if power > g[at.G_POWER]:
        keep_peak(g, at.G_POWER, power, t)
    if two:
        s[at.Y] += x / p[at.RATIO] - (z[10] - s[at.F])
        s[at.F], s[at.V] = z[10], z[11]
    else:
        s[at.Y] += x / p[at.RATIO]
        s[at.V] = z[9] / p[at.RATIO]
    s[at.I], s[at.W] = last, z[9]
    s[at.X] += x


def stop_at_reversal(p: Array, s: Array, w: float, v: float) -> None:
    """Pass a reversal through rest, where friction may hold."""
    if w * s[at.W] < 0.0:
        s[at.W] = 0.0
        if p[at.TWO] == 0.0:
            s[at.V] = 0.0
    if v * s[at.V] < 0.0:
        s[at.V] = 0.0


def advance(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, u: float, l: float, dl: float,
            t: float) -> None:  # fmt: skip
    """Advance one period under a held voltage and a linear load torque."""
    top = work.shape[1] - 1
    left, level, unit = 1 << top, top, p[at.H] / (1 << top)
    code = int(s[at.CODE])
    while left > 0:
        while (1 << level) > left:
            level -= 1
        dt, end = unit * (1 << level), unit * ((1 << top) - left + (1 << level))
        step(p, s, M, work, stamp, z, code, level, u, l + dl * (end - dt), dl, 4)
        after = mode_of(p, z[8], z[9], z[10], z[11], l + dl * end)
        if after != code and level > 0:
            level -= 1
            continue
        before_w, before_v = s[at.W], s[at.V]
        accept(p, s, g, z, code, u, t + end, dt)
        record_gear_torque(p, s, g, code, l + dl * end, t + end, dt)
        if after != code:
            stop_at_reversal(p, s, before_w, before_v)
            code = mode_of(p, s[at.I], s[at.W], s[at.F], s[at.V], l + dl * end)
            record_gear_torque(p, s, g, code, l + dl * end, t + end, 0.0)
        left -= 1 << level
        s[at.STEPS] += 1.0
        level = min(level + 1, top)
    s[at.CODE] = code


# -- Temperatures of winding and housing; arrays as in ``layout``.


def warm(p: Array, s: Array, place: int, I2: float, loss: float, R: float, dt: float) -> None:
    """Integrate both temperatures and the copper heat at a mean square current (Runge-Kutta, to 1e-8 of the rise)."""
    rate = (1.0 / p[at.R_1] + p[at.ALPHA] * I2) / p[at.C_W] + (1.0 / p[at.R_1] + 1.0 / p[at.R_2]) / p[at.C_H]
    n = int(min(max(20.0 * rate * dt, 1.0), p[at.MOST])) if rate * dt < 1e9 else 1
    h = dt / n
    a, b = 0.0, 0.0
    for _ in range(n):
        w, hot, copper = s[place], s[place + 1], 0.0
        sum_w, sum_h = 0.0, 0.0
        x, y = w, hot
        for stage in range(4):
            heat, across = (R + p[at.ALPHA] * x) * I2, (x - y) / p[at.R_1]
            a, b = (heat - across) / p[at.C_W], (across - y / p[at.R_2] + loss) / p[at.C_H]
            weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
            sum_w, sum_h, copper = sum_w + weight * a, sum_h + weight * b, copper + weight * heat
            reach = h if stage == 2 else 0.5 * h
            x, y = w + reach * a, hot + reach * b
        s[place], s[place + 1], s[place + 2] = w + sum_w, hot + sum_h, s[place + 2] + copper


def warm_briefly(p: Array, s: Array, I2: float, loss: float, dt: float) -> None:
    """The same over a single period, far shorter than the winding's time constant: by the rates in its middle."""
    g_1, g_2, by_w, by_h = p[at.G_1], p[at.G_2], p[at.BY_W], p[at.BY_H]
    w, h, copper = s[at.T_W], s[at.T_H], 0.0
    x, y = w, h
    for reach in (0.5 * dt, dt):
        copper, across = (p[at.R_A] + p[at.ALPHA] * x) * I2, (x - y) * g_1
        x, y = w + reach * (copper - across) * by_w, h + reach * (across - y * g_2 + loss) * by_h
    s[at.T_W], s[at.T_H], s[at.Q] = x, y, s[at.Q] + dt * copper


def heat(p: Array, s: Array, g: Array, turned: float, swept: float, dt: float) -> None:
    """Temperatures after a period, or a long stretch at one speed; turned: angle [rad], swept: integral of w^2 dt."""
    I2 = s[at.SQUARE] / dt
    s[at.SQUARE] = 0.0
    if p[at.HEAT] == 0.0:
        s[at.Q] += p[at.R25] * I2 * dt
        return
    loss = p[at.P_0] + (p[at.P_1] * turned + p[at.P_2] * swept) / dt
    if p[at.EVERY] > 1.0 and dt < 1.5 * p[at.N_V] * p[at.H]:
        warm_briefly(p, s, I2, loss, dt)
    else:
        warm(p, s, at.T_W, I2, loss, p[at.R_A], dt)
    g[at.G_WINDING], g[at.G_HOUSING] = max(g[at.G_WINDING], s[at.T_W]), max(g[at.G_HOUSING], s[at.T_H])
    s[at.RES] = p[at.R_A] + p[at.ALPHA] * s[at.T_W]


def follow(p: Array, s: Array, square: float, dt: float) -> None:
    """Follow the derivatives of both temperatures by those at the start; square: integral of I^2 over the time dt."""
    if p[at.HEAT] != 0.0 and p[at.SENSE] != 0.0 and dt > 0.0:
        warm(p, s, at.WW, square / dt, 0.0, 0.0, dt)
        warm(p, s, at.HW, square / dt, 0.0, 0.0, dt)


# -- Limits of voltage by the bus and of current by the I2t integral; arrays as in ``layout``.


def available_voltage(p: Array, i: float, demand: float) -> float:
    """Largest voltage at full duty under a current, by the law of ``physics.power_stage``.

    V_s = V_0 - R_s n I_s with V_s I_s = (duty (V_s - drop) + loss) i; of that duty (V_s - drop) - R_b i is left.
    """
    along = i if demand >= 0.0 else -i
    r = p[at.R_S] * p[at.SETS] * along
    if r < 0.0 and p[at.RAISES] == 0.0:
        r = 0.0
    V = p[at.V_0]
    if r != 0.0:
        half = 0.5 * (p[at.V_0] - r * p[at.DUTY])
        V = half + math.sqrt(max(0.0, half * half - r * (p[at.LOSS] - p[at.DUTY] * p[at.DROP])))
    return float(max(0.0, float(p[at.DUTY]) * (V - p[at.DROP]) - p[at.R_B] * along))


def record_bus(p: Array, g: Array, power: float, t: float, dt: float) -> None:
    """Record voltage, current and heat of the bus under the power of all drives, V^2 - V_0 V + R_s P = 0.

    ``power``: into each power stage, over a time; standby power comes to it.
    """
    P = p[at.SETS] * power
    if P < 0.0 and p[at.RAISES] == 0.0:
        P = 0.0
    P += p[at.SETS] * p[at.STANDBY]
    V = p[at.V_0]
    if p[at.R_S] > 0.0:
        V = 0.5 * (p[at.V_0] + math.sqrt(max(0.0, p[at.V_0] * p[at.V_0] - 4.0 * p[at.R_S] * P)))
    g[at.G_V_LOW], g[at.G_V_HIGH] = min(g[at.G_V_LOW], V), max(g[at.G_V_HIGH], V)
    if P > 0.0:
        keep_peak(g, at.G_BUS, P / V, t)
        if p[at.R_S] > 0.0:
            g[at.G_RESISTED] += p[at.R_S] * P / V * P / V * dt


def permitted_current(p: Array, s: Array, h: float) -> float:
    """Largest current for a period h [A]: the peak, then what just fills the I2t integral, then the continuous one."""
    left = max(0.0, p[at.BUDGET] - s[at.I2T])
    if left > at.AMPLE * p[at.PEAK] * p[at.PEAK] * h:
        return float(p[at.PEAK])
    return float(min(p[at.PEAK], math.sqrt(p[at.CONT2] + left / h)))
