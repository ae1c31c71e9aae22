"""Simulation of one drive period by period: sampled controllers, exact steps, temperatures, limits and sums.

Arrays as in ``layout``. Symbols as in ``drive_train``; f twist [rad], T torque of the driven shaft [N*m]. A stretch in
steady state is carried in one step.
"""

from __future__ import annotations

import math
import sys
from typing import Any

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.files.machine_code import Kernel, defined_in
from drivesizer.kernel import heat as law_of_heat
from drivesizer.kernel.heat import Bodies, Law, added, law_of, slopes, spread

# -- The mode of a drive train and its torques: directions of motor and load, contact, direction of power.


def direction(speed: float, push: float, up: float, down: float) -> int:
    """Direction of motion: that of the speed; at rest that in which a torque overcomes the holding torque."""
    if speed != 0.0:
        return 1 if speed > 0.0 else -1
    return 1 if push > up else -1 if push < down else 0


def shaft_torque(p: Array, contact: float, w: float, f: float, v: float) -> float:
    """Torque of a flexible shaft in contact."""
    return float(p[at.C] * (f - contact * 0.5 * p[at.GAP]) + p[at.DAMP] * (w / p[at.RATIO] - v))


def holding_torque(p: Array, T: float, side: float) -> float:
    """Torque at the motor that overcomes friction and a load's torque."""
    return float(side * p[at.F_M] + T * (p[at.DRIVE] if T * side > 0.0 else p[at.BRAKE]))


def mode_of(p: Array, i: float, w: float, f: float, v: float, l: float) -> int:
    """The mode of a state as one number, of directions from 0 to 2: motor, 3 times load, 9 times the shaft's torque."""
    push = p[at.K_T] * i
    if p[at.TWO] != 0.0:
        c = 1 if f > 0.0 else -1  # side of the backlash that is in contact; without backlash the sign of the torque
        if p[at.GAP] == 0.0:
            c = 1 if shaft_torque(p, 0.0, w, f, v) >= 0.0 else -1
        elif not (abs(f) > 0.5 * p[at.GAP] and c * shaft_torque(p, float(c), w, f, v) > 0.0):
            c = 0
        T = shaft_torque(p, float(c), w, f, v) if c != 0 else 0.0
        motor = direction(w, push, holding_torque(p, T, 1.0), holding_torque(p, T, -1.0))
        load = direction(v, T - l, p[at.T_F], p[at.T_B])
        return motor + 1 + 3 * (load + 1) + 9 * (c + 1)
    side = direction(w, push, holding_torque(p, p[at.T_F] + l, 1.0), holding_torque(p, p[at.T_B] + l, -1.0))
    if side == 0:
        return 13
    T = (p[at.T_F] if side > 0 else p[at.T_B]) + l
    M = push - side * p[at.F_M] - p[at.B_M] * w
    return 4 * (side + 1) + (18 if T * p[at.RATIO] * p[at.J_M] + p[at.J_L] * M > 0.0 else 0)


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
    return float((T * across + p[at.J_L] * M) / (across + p[at.J_L] * share))


def gear_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque at the gearhead's output: the driven shaft's through the belt."""
    power = (code % 3 - 1) * (code // 9 - 1)
    share = p[at.G_D] if power > 0 else p[at.G_B] if power < 0 else p[at.G_0]
    return float(driven_torque(p, code, i, w, f, v, l) * share)


def matrix_of(p: Array, code: int) -> int:
    """Number of a mode's matrix in ``drive_train.generators``."""
    side, load, c = code % 3 - 1, code // 3 % 3 - 1, code // 9 - 1
    drives = 1 if c * side >= 0 else 2
    if p[at.TWO] == 0.0:
        return 0 if side == 0 else drives
    return abs(side) + 2 * abs(load) + 4 * (drives if c != 0 else 0)


# -- Records of a simulation: largest magnitudes with times, sums, rows of the time series.


def keep_peak(g: Array, place: int, value: float, t: float) -> None:
    """Keep the largest magnitude and its time."""
    if abs(value) > g[place]:
        g[place], g[place + 1] = abs(value), t


def keep_demand(p: Array, s: Array, g: Array, demand: float, t: float) -> None:
    """Keep the largest voltage demand, and that at the power stage with what resistances and commutation take."""
    keep_peak(g, at.G_U_DEMAND, demand, t)
    along = max(0.0, s[at.I] if demand >= 0.0 else -s[at.I])
    keep_peak(g, at.G_U_STAGE, abs(demand) + p[at.LEADS] * along + commutated(p, s[at.I], s[at.W], demand), t)


def square_of(first: float, last: float, area: float, dt: float) -> float:
    """Integral of a square by the ends and the integral; exact for a parabola (its Legendre polynomials)."""
    mean, rise, bend = area / dt, last - first, (first + last) / 2.0 - area / dt
    return dt * (mean * mean + rise * rise / 12.0 + bend * bend / 5.0)


def add_energy(p: Array, g: Array, work: float, charge: float, square: float) -> None:
    """Add energy into the power stage, by that of the motor, and charge and square of the current over that time."""
    energy = work + p[at.LOSS] * abs(charge) + p[at.R_B] * square
    if energy > 0.0:
        g[at.G_IN] += energy
    else:
        g[at.G_RETURNED] -= energy


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


def keep_row(rows: Array, marks: Any, size: Any, always: bool, k: int, row: Any) -> None:
    """Keep a row: all while few, else evenly thinned, those after a corner always.

    A row at the time of the last one replaces it: a stretch ends where the next begins.
    """
    if (not always or size[2] <= 0) and k % size[1] != 0:
        return
    n = size[0]
    if n > 0 and rows[n - 1, 0] == row[0]:
        n -= 1
    marks[n] = always and size[2] > 0
    size[2] -= marks[n]
    for c in range(len(row)):
        rows[n, c] = row[c]
    size[0] = n + 1
    if n + 1 < rows.shape[0] - 1:
        return
    m, odd = 0, False
    for n in range(size[0]):
        odd = odd if marks[n] != 0 else not odd
        if marks[n] != 0 or odd:
            for c in range(rows.shape[1]):
                rows[m, c] = rows[n, c]
            marks[m] = marks[n]
            m += 1
    size[0], size[1] = m, size[1] * 2


# -- One period under a held voltage: exact steps of the machine, halved where its mode changes.


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
            if before_w * s[at.W] < 0.0:  # a reversal passes through rest, where friction may hold
                s[at.W] = 0.0
                if p[at.TWO] == 0.0:
                    s[at.V] = 0.0
            if before_v * s[at.V] < 0.0:
                s[at.V] = 0.0
            code = mode_of(p, s[at.I], s[at.W], s[at.F], s[at.V], l + dl * end)
            record_gear_torque(p, s, g, code, l + dl * end, t + end, 0.0)
        left -= 1 << level
        s[at.STEPS] += 1.0
        level = min(level + 1, top)
    s[at.CODE] = code


# -- Temperatures of winding and housing, by the law of ``kernel.heat``.


def heat_law(p: Array, square: float, loss: float) -> Law:
    """The law at a mean square current [A^2] and a loss at the housing [W]."""
    bodies = Bodies(p[at.FEEDBACK], p[at.A_WW], p[at.A_WH], p[at.A_HW], p[at.A_HH], p[at.BY_SQUARE], p[at.BY_LOSS])
    return law_of(bodies, square, loss)


def warm(p: Array, s: Array, place: int, law: Law, square: float, resistance: float, dt: float) -> None:
    """Rises of winding and housing after a time, and the copper's heat [J], which is behind them."""
    w, h = s[place], s[place + 1]
    more_w, more_h, mean = added(law, spread(law, dt), dt, w, h)
    s[place], s[place + 1] = w + more_w, h + more_h
    s[place + 2] += (resistance + p[at.ALPHA] * (w + mean)) * square * dt


def heat(p: Array, s: Array, g: Array, turned: float, swept: float, dt: float) -> None:
    """Temperatures after a period, or a long stretch at one speed; turned: angle [rad], swept: integral of w^2 dt."""
    square = s[at.SQUARE] / dt
    s[at.SQUARE] = 0.0
    if p[at.HEAT] == 0.0:
        s[at.Q] += p[at.R25] * square * dt
        return
    law = heat_law(p, square, (p[at.P_1] * turned + p[at.P_2] * swept) / dt)
    warm(p, s, at.T_W, law, square, p[at.R_A], dt)
    g[at.G_WINDING], g[at.G_HOUSING] = max(g[at.G_WINDING], s[at.T_W]), max(g[at.G_HOUSING], s[at.T_H])
    s[at.RES] = p[at.R_A] + p[at.ALPHA] * s[at.T_W]


def follow(p: Array, s: Array, square: float, dt: float) -> None:
    """Follow the derivatives of both temperatures by those at the start; square: integral of I^2 over the time dt."""
    if p[at.HEAT] != 0.0 and dt > 0.0:
        law = heat_law(p, square / dt, 0.0)
        change = Law(law.ww, law.wh, law.hw, law.hh, 0.0, 0.0)
        warm(p, s, at.WW, change, square / dt, 0.0, dt)
        warm(p, s, at.HW, change, square / dt, 0.0, dt)


# -- Limits of voltage by the bus and of current by the I2t integral.


def commutated(p: Array, i: float, w: float, demand: float) -> float:
    """Voltage that commutation takes while the motor drives in the direction of a demand."""
    return float(p[at.X_C] * i * w) if i * demand > 0.0 and w * demand > 0.0 else 0.0


def available_voltage(p: Array, i: float, w: float, demand: float) -> float:
    """Largest voltage at full duty under a current at a speed, by the law of ``physics.power_stage``.

    V_s = V_0 - R_s n I_s with V_s I_s = (duty (V_s - drop) + loss) i; of that duty (V_s - drop) - R_b i is left.
    """
    along = i if demand >= 0.0 else -i
    r = max(p[at.R_S] * p[at.SETS] * along, 0.0)  # what is regenerated a chopper or a battery takes
    V = p[at.V_0]
    if r != 0.0:
        half = 0.5 * (p[at.V_0] - r * p[at.DUTY])
        V = half + math.sqrt(max(0.0, half * half - r * (p[at.LOSS] - p[at.DUTY] * p[at.DROP])))
    left = float(p[at.DUTY]) * (V - p[at.DROP]) - p[at.R_B] * along
    return float(max(0.0, left - commutated(p, i, w, demand)))


def record_bus(p: Array, g: Array, power: float, t: float, dt: float) -> None:
    """Record voltage, current and heat of the bus under the power of all drives, V^2 - V_0 V + R_s P = 0.

    ``power``: into each power stage, over a time; standby power comes to it.
    """
    P = p[at.SETS] * (max(power, 0.0) + p[at.STANDBY])
    V = p[at.V_0]
    if p[at.R_S] > 0.0:
        V = 0.5 * (p[at.V_0] + math.sqrt(max(0.0, p[at.V_0] * p[at.V_0] - 4.0 * p[at.R_S] * P)))
    g[at.G_V_LOW] = min(g[at.G_V_LOW], V)
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


# -- Sampled controllers: voltage PID, cascade of current, velocity and position loops, counted speed.


def pid(p: Array, s: Array, place: int, error: float, rests: bool) -> float:
    """A sampled PID with a filtered derivative; its integral is frozen where it would drive further into a limit."""
    if not rests:
        s[place] += p[at.KI] * error
    change = error - s[place + 2] if s[place + 3] != 0.0 else 0.0
    s[place + 2], s[place + 3] = error, 1.0
    s[place + 1] = p[at.KEEP] * s[place + 1] + p[at.KD] * change
    return float(p[at.KP] * error + s[place] + s[place + 1])


def drain(p: Array, s: Array, error: float, speed: float, slope: float, l: float) -> None:
    """Drain the outer integral at rest, where friction holds: what braking left there would stay as a current."""
    still = speed == 0.0 and slope == 0.0 and abs(error) <= p[at.RESTS] and abs(s[at.W]) <= p[at.RESTS]
    if still and p[at.KEPT] != 1.0 and s[at.OUTER] != 0.0:
        alone = mode_of(p, 0.0, 0.0, s[at.F], 0.0, l)  # without current
        if alone % 3 == 1 and alone // 3 % 3 == 1:
            least = p[at.TOL_I] if p[at.CASCADE] != 0.0 else p[at.TOL_U]
            s[at.OUTER] = s[at.OUTER] * p[at.KEPT] if abs(s[at.OUTER]) > least else 0.0


def whole_counts(p: Array, angle: float) -> float:
    """An angle in whole counts."""
    return float(math.floor(angle * p[at.EDGES] / (2.0 * math.pi)))


def measured_speed(p: Array, s: Array, ring: Array) -> float:
    """Speed of the motor: exact, or the counts of the last periods over their time."""
    if p[at.EDGES] == 0.0:
        return float(s[at.W])
    count, window = whole_counts(p, s[at.X]), int(p[at.WINDOW])
    slot = int(s[at.SEEN]) % window
    speed = (count - ring[slot]) * 2.0 * math.pi / (p[at.EDGES] * p[at.H] * p[at.N_V] * window)
    ring[slot] = count
    s[at.SEEN] += 1.0
    return float(speed)


def feedforward_current(p: Array, speed: float, slope: float) -> float:
    """Feedforward by friction and inertia: of the current, or of the voltage where the loop acts on that."""
    sign = 1.0 if speed > 0.0 else -1.0 if speed < 0.0 else 0.0
    return float(p[at.FFV] * speed + p[at.FFF] * sign + p[at.FFA] * slope)


def demand_current(s: Array) -> None:
    """Take the current that was computed, within its limit."""
    s[at.I_DEMAND] = min(max(s[at.I_NEXT], -s[at.LIMIT]), s[at.LIMIT])
    s[at.I_CUT] = s[at.I_NEXT] - s[at.I_DEMAND]


def outer_loops(p: Array, s: Array, ring: Array, k: int, speed: float, slope: float, angle: float, l: float) -> None:
    """The outer loops of the cascade at their samples: position, then velocity; one of its periods late, or at once."""
    n_v, n_p = int(p[at.N_V]), int(p[at.N_P])
    if k % n_v != 0:
        return
    s[at.LIMIT] = permitted_current(p, s, p[at.H] * p[at.N_V])
    if p[at.SOON] == 0.0:
        demand_current(s)
    w = measured_speed(p, s, ring)
    if n_p > 0 and k % (n_v * n_p) == 0:
        lag = float(angle - s[at.X])
        if p[at.EDGES] != 0.0:  # in whole counts, so that a motor within its count may rest
            lag = (whole_counts(p, angle) - whole_counts(p, s[at.X])) * 2.0 * math.pi / float(p[at.EDGES])
        before, s[at.W_NEXT] = s[at.W_NEXT], p[at.PKP] * lag
        s[at.W_ADD] = s[at.W_NEXT] if p[at.SOON] != 0.0 else before
    error = p[at.AHEAD] * speed + s[at.W_ADD] - w
    drain(p, s, error, speed, slope, l)
    s[at.I_NEXT] = feedforward_current(p, speed, slope) + pid(
        p, s, at.OUTER, error, s[at.I_CUT] * error > 0.0 or s[at.U_CUT] * error > 0.0
    )
    if p[at.SOON] != 0.0:
        demand_current(s)


def limited_voltage(p: Array, s: Array, g: Array, demand: float, t: float, weight: float) -> float:
    """A voltage demand limited by the bus [V]."""
    keep_demand(p, s, g, demand, t)
    most = available_voltage(p, s[at.I], s[at.W], demand)
    u = min(max(demand, -most), most)
    s[at.U_CUT] = demand - u
    if u != demand:
        g[at.G_SATURATED] += weight
    return u


def current_loop(p: Array, s: Array, g: Array, t: float, weight: float) -> float:
    """The current loop: voltage applied from now on [V]."""
    keep_peak(g, at.G_I_AHEAD, s[at.I_DEMAND] + s[at.I_CUT], t)
    if s[at.I_CUT] != 0.0:
        g[at.G_LIMITED] += weight
    error = s[at.I_DEMAND] - s[at.I]
    if not s[at.U_CUT] * error > 0.0:
        s[at.INNER] += p[at.CKI] * error
    demand = p[at.CKP] * error + s[at.INNER]
    if p[at.PROMPT] == 0.0:
        demand, s[at.PEND] = s[at.PEND], demand
    return limited_voltage(p, s, g, demand, t, weight)


def voltage_loop(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, ring: Array, l: float,
           dl: float, t: float, speed: float, slope: float, weight: float) -> float:  # fmt: skip
    """The voltage PID: a period late, limited in voltage and current, the current predicted over a period."""
    demand = s[at.PEND]
    u = limited_voltage(p, s, g, demand, t, weight)
    step(p, s, M, work, stamp, z, int(s[at.CODE]), work.shape[1] - 1, 0.0, l, dl, 1)
    n = 4 if p[at.TWO] != 0.0 else 2
    idle, per_volt = z[8], work[matrix_of(p, int(s[at.CODE])), work.shape[1] - 1, 0, n]
    keep_peak(g, at.G_I_AHEAD, idle + per_volt * u, t + p[at.H])
    s[at.LIMIT] = permitted_current(p, s, p[at.H])
    if abs(idle + per_volt * u) > s[at.LIMIT]:
        g[at.G_LIMITED] += weight
        most = available_voltage(p, s[at.I], s[at.W], u)
        u = ((s[at.LIMIT] if idle + per_volt * u > 0.0 else -s[at.LIMIT]) - idle) / per_volt
        u = min(max(u, -most), most)
    error = speed - measured_speed(p, s, ring)
    drain(p, s, error, speed, slope, l)
    s[at.I_CUT] = demand - u - s[at.U_CUT]
    s[at.PEND] = feedforward_current(p, speed, slope) + pid(p, s, at.OUTER, error, (demand - u) * error > 0.0)
    return u


# -- Long stretches in steady state, carried in one step.


def regulated(p: Array, s: Array) -> bool:
    """Whether an integral keeps the current while the winding's resistance changes; else the voltage stays."""
    if s[at.U_CUT] != 0.0:
        return False
    return bool(p[at.CKI] != 0.0 if p[at.CASCADE] != 0.0 else p[at.KI] != 0.0 and s[at.W] != 0.0)


def carry_state(p: Array, s: Array, g: Array, u: float, l: float, t: float, duration: float) -> None:
    """Carry a steady state over a duration; the controller follows the winding's resistance."""
    R, Q0 = s[at.RES], s[at.Q]
    square = s[at.I] * s[at.I] * duration
    add_square(p, s, g, square, duration)
    record_gear_torque(p, s, g, int(s[at.CODE]), l, t, duration)
    heat(p, s, g, abs(s[at.W]) * duration, s[at.W] * s[at.W] * duration, duration)
    follow(p, s, square, duration)
    work = (u - R * s[at.I]) * s[at.I] * duration + (s[at.Q] - Q0)  # what turns into motion, and the copper's heat
    add_energy(p, g, work, s[at.I] * duration, square)
    s[at.X] += s[at.W] * duration
    s[at.Y] += s[at.V] * duration
    rise = (s[at.RES] - R) * s[at.I] if regulated(p, s) else 0.0
    s[at.PEND] += rise
    s[at.INNER if p[at.CASCADE] != 0.0 else at.OUTER] += rise
    power = (u + rise) * s[at.I] + p[at.LOSS] * abs(s[at.I]) + p[at.R_B] * s[at.I] * s[at.I]
    record_bus(p, g, power, t + duration, duration)
    keep_peak(g, at.G_U, u + rise, t + duration)
    keep_demand(p, s, g, u + rise + s[at.U_CUT], t + duration)
    if power > g[at.G_POWER]:
        keep_peak(g, at.G_POWER, power, t + duration)


def is_steady(p: Array, s: Array, mind: Array, lag: float) -> bool:
    """Whether nothing changed since the last call; with counts never while the motor turns, for they go on."""
    if p[at.EDGES] != 0.0 and s[at.W] != 0.0:
        mind[0] = math.nan
        return False
    now = (
        s[at.I], s[at.W], s[at.F], s[at.V], s[at.PEND], s[at.OUTER], s[at.OUTER + 1], s[at.INNER], s[at.I_DEMAND],
        s[at.I_NEXT], s[at.W_ADD], s[at.W_NEXT], lag if p[at.PKP] > 0.0 else 0.0, s[at.U_CUT],
    )  # fmt: skip
    demand = p[at.TOL_I] if p[at.CASCADE] != 0.0 else p[at.TOL_U]
    limits = (
        p[at.TOL_I], p[at.TOL_W], p[at.TOL_F], p[at.TOL_W] / p[at.RATIO], p[at.TOL_U], demand, demand, p[at.TOL_U],
        p[at.TOL_I], p[at.TOL_I], p[at.TOL_W], p[at.TOL_W], p[at.TOL_X], p[at.TOL_U],
    )  # fmt: skip
    same = True
    for n in range(at.STEADY):
        same = same and abs(now[n] - mind[n]) <= limits[n]
        mind[n] = now[n]
    return bool(same)


def periods_within_voltage(p: Array, s: Array, left: int) -> int:
    """Periods for which the bus has enough voltage for the warming winding, found by halving.

    Winding and housing warm under the present current; a rise of less than about a kelvin to the limit is allowed.
    """
    current = abs(s[at.I])
    u = s[at.RES] * s[at.I] + p[at.K_E] * s[at.W]
    room = available_voltage(p, s[at.I], s[at.W], u) - abs(u)
    rise = room / (p[at.ALPHA] * current + 1e-300)  # K
    rate = abs(slopes(heat_law(p, current * current, 0.0), s[at.T_W], s[at.T_H])[0])
    least = min(at.FRESH / (rate * p[at.H] + 1e-300), 1.0 * left)
    winding, housing, copper = s[at.T_W], s[at.T_H], s[at.Q]
    loss = p[at.P_1] * abs(s[at.W]) + p[at.P_2] * s[at.W] * s[at.W]
    n = left
    while n > least:
        warm(p, s, at.T_W, heat_law(p, current * current, loss), current * current, p[at.R_A], n * p[at.H])
        hotter = s[at.T_W] - winding
        s[at.T_W], s[at.T_H], s[at.Q] = winding, housing, copper
        if hotter <= rise:
            break
        n //= 2
    return n


def periods_to_carry(p: Array, s: Array, left: int) -> int:
    """Periods over which a steady state is carried: until the I2t integral is full, or current or voltage change."""
    if p[at.HEAT] != 0.0 and regulated(p, s):
        left = periods_within_voltage(p, s, left)
    if p[at.HEAT] != 0.0 and not regulated(p, s):
        rate = abs(slopes(heat_law(p, s[at.I] * s[at.I], 0.0), s[at.T_W], s[at.T_H])[0])
        left = int(min(at.FRESH / (rate * p[at.H] + 1e-300), left))
    grows = (s[at.I] * s[at.I] - p[at.CONT2]) * p[at.H]
    if grows <= 0.0 or p[at.BUDGET] == math.inf:
        return left
    free = (p[at.BUDGET] - s[at.I2T]) / grows - 2.0 * max(1.0, p[at.N_V])
    return int(min(max(free, 0.0), left))


# -- Simulation of one drive along pieces of its task, period by period.


def record_row(p: Array, s: Array, rows: Array, marks: Any, size: Any, reference: Any, k: int, near: bool) -> None:
    """Record a row: the reference (time, speed, angle, load, voltage) and the state."""
    t, speed, angle, l, u = reference
    torque = gear_torque(p, int(s[at.CODE]), s[at.I], s[at.W], s[at.F], s[at.V], l)
    winding = s[at.T_W] + p[at.AMBIENT]
    lag, behind = angle - s[at.X], angle / p[at.RATIO] - s[at.Y]
    row = (t, speed, s[at.W], s[at.I], u, torque, s[at.V], lag, behind, s[at.I_DEMAND], winding)
    keep_row(rows, marks, size, near, k, row)


def control(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, ring: Array, rows: Array,
           marks: Any, size: Any, piece: Array, k: int, near: bool) -> float:  # fmt: skip
    """Run the controller at a sample and record it: the voltage that is held over the period [V]."""
    t, h, since, slope, dl = k * p[at.H], p[at.H], k * p[at.H] - piece[2], piece[4], piece[7]
    speed, l = piece[3] + slope * since, piece[6] + dl * since
    angle = s[at.TURN] + piece[5] + (piece[3] + 0.5 * slope * since) * since
    if p[at.CASCADE] != 0.0:
        outer_loops(p, s, ring, k, speed, slope, angle, l)
        u = current_loop(p, s, g, t, h)
    else:
        u = voltage_loop(p, s, g, M, work, stamp, z, ring, l, dl, t, speed, slope, h)
    record_errors(p, s, g, speed, angle, u, t, h)
    if rows.shape[0] > 0:
        record_row(p, s, rows, marks, size, (t, speed, angle, l, u), k, near)
    return u


def lag_at(p: Array, s: Array, piece: Array, k: int) -> float:
    """Lag of the motor's angle behind a reference of constant speed [rad]."""
    h, speed = p[at.H], piece[3]
    return float(s[at.TURN] + piece[5] + speed * ((k - 1) * h - piece[2]) + speed * h - s[at.X])


def simulate_one(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, mind: Array,
                 pieces: Array, ring: Array, rows: Array, marks: Any, size: Any) -> int:  # fmt: skip
    """Simulate a drive along all pieces."""
    h, near = p[at.H], size[3]
    n_v, cycle = int(p[at.N_V]), int(p[at.N_V] * max(p[at.N_P], 1.0))
    pause = n_v * int(max(p[at.HEAT_PERIODS], 1.0))
    corner, turned, swept, spent, square, since, u = 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for n in range(pieces.shape[0]):
        piece = pieces[n]
        k, end, constant = int(piece[0]), int(piece[1]), piece[4] == 0.0 and piece[7] == 0.0
        corner = k if piece[8] != 0.0 else corner
        mind[:] = math.nan
        record_gear_torque(p, s, g, int(s[at.CODE]), piece[6] + piece[7] * (k * h - piece[2]), k * h, 0.0)
        while k < end:
            t, x, w, energy = k * h, s[at.X], s[at.W], g[at.G_IN] - g[at.G_RETURNED]
            u = control(p, s, g, M, work, stamp, z, ring, rows, marks, size, piece, k, k - corner < near)
            advance(p, s, g, M, work, stamp, z, u, piece[6] + piece[7] * (t - piece[2]), piece[7], t)
            record_bus(p, g, (g[at.G_IN] - g[at.G_RETURNED] - energy) / h, t, h)
            turned, swept = turned + abs(s[at.X] - x), swept + square_of(w, s[at.W], s[at.X] - x, h)
            spent, k = spent + h, k + 1
            steady = constant and (cycle == 1 or k % cycle == 0) and is_steady(p, s, mind, lag_at(p, s, piece, k))
            if n_v == 1 or k % n_v == 0 or k == end:
                square, since = square + s[at.SQUARE], since + spent
                heat(p, s, g, turned, swept, spent)
                turned = swept = spent = 0.0
            if k % pause == 0 or k == end or steady:
                follow(p, s, square, since)
                square = since = 0.0
            if not abs(s[at.I] + s[at.W] + s[at.V] + s[at.F] + s[at.PEND] + s[at.T_W]) < at.VAST:
                return at.NOT_FINITE
            if s[at.STEPS] > p[at.MOST]:
                return at.TOO_LONG
            if steady:  # carried as far as possible
                lag, periods = lag_at(p, s, piece, k), periods_to_carry(p, s, int(piece[1]) - k)
                if periods > 0:
                    error, behind, time = piece[3] - s[at.W], (lag + s[at.X]) / p[at.RATIO] - s[at.Y], periods * h
                    add_error_squares(g, error, lag, error / p[at.RATIO], behind, time)
                    g[at.G_SATURATED] += time if s[at.U_CUT] != 0.0 else 0.0
                    g[at.G_LIMITED] += time if s[at.I_CUT] != 0.0 else 0.0
                    carry_state(p, s, g, u, piece[6], k * h, time)
                    k += periods
    if rows.shape[0] > 0:
        piece = pieces[-1]
        t, since = piece[1] * h, piece[1] * h - piece[2]
        angle = piece[5] + (piece[3] + 0.5 * piece[4] * since) * since
        reference = (t, piece[3] + piece[4] * since, angle, piece[6] + piece[7] * since, u)
        record_row(p, s, rows, marks, size, reference, 0, False)
    return at.GOOD


_THIS = sys.modules[__name__]
KERNEL = Kernel(
    functions=defined_in((law_of_heat, _THIS)),
    modules=(at, law_of_heat, _THIS),
    inline=True,
    slow="the closed loop runs some hundred times slower",
    arguments="d1 d1 d1 d5 d4 d2 d1 d1 d2 d1 d2 b1 q1",
)
