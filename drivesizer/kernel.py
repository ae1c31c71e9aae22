"""The loop of the engine: one motor set marched along pieces, in plain Python that numba can compile.

All that a set is lies in an array of parameters, all that changes in an array of state, all that is kept in an array
of tallies; the names below are their places. ``compiled`` gives the march as machine code, or as it stands here.
A period in which a mode changes is taken in halves of halves until the change lies within a 1024th part.
Symbols: as in ``linear_modes``; f twist [rad], T torque of the driven shaft [N*m], h period [s].
"""

from __future__ import annotations

import math
import tempfile
import warnings
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.cache import digest_of, folder

__all__ = ["PARAMETERS", "ROW", "STATE", "TALLY", "SlowWarning", "compiled", "march_one"]

Array = NDArray[np.float64]


def places(names: list[str]) -> Iterable[int]:
    """Numbers of places; not Python's own integers, for which numba compiles a function once for every number."""
    found: Any = np.arange(len(names))
    places: Iterable[int] = found
    return places


# places of parameters: the machine, the controller (kp, integral gain per sample, share of the derivative that is kept,
# derivative gain per sample), limits, heat, and what is small enough to be at rest
PARAMETERS = [
    "H",
    "R25",
    "K_T",
    "J_M",
    "F_M",
    "F_S",
    "B_M",
    "RATIO",
    "DRIVE",
    "BRAKE",
    "J_L",
    "B_L",
    "T_F",
    "T_B",
    "T_0",
    "C",
    "DAMP",
    "GAP",
    "G_0",
    "G_D",
    "G_B",
    "TWO",
    "CASCADE",
    "N_V",
    "N_P",
    "KP",
    "KI",
    "KEEP",
    "KD",
    "CKP",
    "CKI",
    "PKP",
    "FFV",
    "FFF",
    "FFA",
    "DELAY",
    "EDGES",
    "WINDOW",
    "V_0",
    "R_S",
    "SETS",
    "DUTY",
    "DROP",
    "RAISES",
    "PEAK",
    "CONT2",
    "BUDGET",
    "HEAT",
    "R_1",
    "R_2",
    "C_W",
    "C_H",
    "R_A",
    "ALPHA",
    "AMBIENT",
    "P_0",
    "P_1",
    "NODE_0",
    "NODE_D",
    "NODES",
    "MOST",
    "SENSE",
    "TOL_I",
    "TOL_W",
    "TOL_U",
    "TOL_F",
    "TOL_X",
]
(
    H, R25, K_T, J_M, F_M, F_S, B_M, RATIO, DRIVE, BRAKE, J_L, B_L, T_F, T_B, T_0, C, DAMP, GAP, G_0, G_D, G_B, TWO,
    CASCADE, N_V, N_P, KP, KI, KEEP, KD, CKP, CKI, PKP, FFV, FFF, FFA, DELAY, EDGES, WINDOW, V_0, R_S, SETS, DUTY, DROP,
    RAISES, PEAK, CONT2, BUDGET, HEAT, R_1, R_2, C_W, C_H, R_A, ALPHA, AMBIENT, P_0, P_1, NODE_0, NODE_D, NODES, MOST,
    SENSE, TOL_I, TOL_W, TOL_U, TOL_F, TOL_X,
) = places(PARAMETERS)  # fmt: skip

# places of the state: machine; heat (rises over ambient, copper heat, and what a kelvin at the start makes of them);
# controller: pending voltage, integrals with derivative, last error and its presence, current asked for, what was cut
STATE = [
    "I",
    "W",
    "F",
    "V",
    "X",
    "Y",
    "T_W",
    "T_H",
    "Q",
    "WW",
    "WH",
    "WQ",
    "HW",
    "HH",
    "HQ",
    "CODE",
    "I2T",
    "PEND",
    "OUTER",
    "-",
    "-",
    "-",
    "INNER",
    "-",
    "-",
    "-",
    "I_ASK",
    "I_CUT",
    "U_CUT",
    "W_ADD",
    "LIMIT",
    "STEPS",
    "SQUARE",
    "RES",
    "SEEN",
]
(
    I, W, F, V, X, Y, T_W, T_H, Q, WW, WH, WQ, HW, HH, HQ, CODE, I2T, PEND, OUTER, _, _, _, INNER, _, _, _,
    I_ASK, I_CUT, U_CUT, W_ADD, LIMIT, STEPS, SQUARE, RES, SEEN,
) = places(STATE)  # fmt: skip

# places of the tallies: largest magnitudes with their times, then what adds up [s, A^2 s, J, (rad/s)^2 s, rad^2 s],
# then highest and lowest
TALLY = [
    "I",
    "T_I",
    "U_ASKED",
    "T_U_ASKED",
    "U",
    "T_U",
    "W",
    "T_W",
    "E_W",
    "T_E_W",
    "E_X",
    "T_E_X",
    "G",
    "T_G",
    "I_AHEAD",
    "T_I_AHEAD",
    "POWER",
    "T_POWER",
    "BUS",
    "T_BUS",
    "SQUARE",
    "SATURATED",
    "LIMITED",
    "IN",
    "BACK",
    "E2_W",
    "E2_X",
    "G_SQUARE",
    "RUNNING",
    "I2T",
    "WINDING",
    "HOUSING",
    "V_LOW",
    "V_HIGH",
]
(
    G_I, _, G_U_ASKED, _, G_U, _, G_W, _, G_E_W, _, G_E_X, _, G_G, _, G_AHEAD, _, G_POWER, _, G_BUS, _, G_SQUARE,
    G_SATURATED, G_LIMITED, G_IN, G_BACK, G_E2_W, G_E2_X, G_G_SQUARE, G_RUNNING, G_I2T, G_WINDING, G_HOUSING, G_V_LOW,
    G_V_HIGH,
) = places(TALLY)  # fmt: skip

_ROW = "time reference motor_speed current voltage gear_torque load_speed position_error current_asked winding"
ROW = _ROW.split()

FRESH = 0.01  # K by which the winding may move before its resistance is taken anew: 0.004 % of it
STEADY = 11  # figures that are compared to see whether anything changes
VAST = 1e100  # beyond any machine, and small enough that squares stay finite
GOOD, NOT_FINITE, TOO_LONG = 0, 1, 2


class SlowWarning(UserWarning):
    """The closed loop runs uncompiled."""


def see(g: Array, at: int, value: float, t: float) -> None:
    """Keep the largest magnitude and its time."""
    if abs(value) > g[at]:
        g[at], g[at + 1] = abs(value), t


def way(speed: float, push: float, up: float, down: float) -> int:
    """Direction of motion: that of the speed; at rest that in which a push overcomes what holds."""
    if speed != 0.0:
        return 1 if speed > 0.0 else -1
    return 1 if push > up else -1 if push < down else 0


def shaft(p: Array, contact: float, w: float, f: float, v: float) -> float:
    """Torque of a flexible shaft in contact."""
    return float(p[C] * (f - contact * 0.5 * p[GAP]) + p[DAMP] * (w / p[RATIO] - v))


def touching(p: Array, w: float, f: float, v: float) -> int:
    """Which side of the backlash is in contact: one that presses; without backlash the sign of the torque."""
    if p[GAP] == 0.0:
        return 1 if shaft(p, 0.0, w, f, v) >= 0.0 else -1
    side = 1 if f > 0.0 else -1
    beyond = abs(f) > 0.5 * p[GAP] and side * shaft(p, float(side), w, f, v) > 0.0
    return side if beyond else 0


def held(p: Array, T: float, side: float) -> float:
    """Torque at the motor that overcomes stiction and a load's torque, in a direction."""
    return float(side * p[F_S] + T * (p[DRIVE] if T * side > 0.0 else p[BRAKE]))


def coded(motor: int, load: int, power: int) -> int:
    """A mode as one number: directions of motor and load, and of the shaft's torque."""
    return motor + 1 + 3 * (load + 1) + 9 * (power + 1)


def mode_of(p: Array, i: float, w: float, f: float, v: float, l: float) -> int:
    """The mode that a state and the load's torque make."""
    push = p[K_T] * i
    if p[TWO] != 0.0:
        c = touching(p, w, f, v)
        T = shaft(p, float(c), w, f, v) if c != 0 else 0.0
        return coded(way(w, push, held(p, T, 1.0), held(p, T, -1.0)), way(v, T - l, p[T_F], p[T_B]), c)
    side = way(w, push, held(p, p[T_F] + l, 1.0), held(p, p[T_B] + l, -1.0))
    if side == 0:
        return coded(side, side, side)
    T = (p[T_F] if side > 0 else p[T_B]) + l + p[B_L] * w / p[RATIO]
    M = push - side * p[F_M] - p[B_M] * w
    return coded(side, side, 1 if T * p[RATIO] * p[J_M] + p[J_L] * M > 0.0 else -1)


def resisting(p: Array, side: int) -> float:
    """Constant torque of the load by direction."""
    return float(p[T_F] if side > 0 else p[T_B] if side < 0 else p[T_0])


def driven_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque of the driven shaft in a mode."""
    side, c = code % 3 - 1, code // 9 - 1
    if p[TWO] != 0.0:
        return shaft(p, float(c), w, f, v) if c != 0 or p[GAP] == 0.0 else 0.0
    T = resisting(p, side) + l
    if side == 0:
        return T
    share = p[DRIVE] if c * side > 0 else p[BRAKE]
    M = p[K_T] * i - side * p[F_M] - p[B_M] * w
    across = p[RATIO] * p[J_M]
    return float(((T + p[B_L] * w / p[RATIO]) * across + p[J_L] * M) / (across + p[J_L] * share))


def gear_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque at the gearhead's output: the driven shaft's through the belt."""
    power = (code % 3 - 1) * (code // 9 - 1)
    share = p[G_D] if power > 0 else p[G_B] if power < 0 else p[G_0]
    return float(driven_torque(p, code, i, w, f, v, l) * share)


def matrix_of(p: Array, code: int) -> int:
    """Which matrix a mode has (see ``linear_modes.generators``)."""
    side, load, c = code % 3 - 1, code // 3 % 3 - 1, code // 9 - 1
    drives = 1 if c * side >= 0 else 2
    if p[TWO] == 0.0:
        return 0 if side == 0 else drives
    return abs(side) + 2 * abs(load) + 4 * (drives if c != 0 else 0)


def fresh(p: Array, s: Array, M: Array, work: Array, stamp: Array, mode: int, level: int) -> None:
    """Bring a mode's matrix to the winding's temperature: a cubic through four nodes."""
    at = (s[T_W] - p[NODE_0]) / p[NODE_D]
    n = min(max(int(at) - 1, 0), int(p[NODES]) - 4)
    x = min(max(at - n, 0.0), 3.0)
    a, b = -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0
    c, d = -x * (x - 1.0) * (x - 3.0) / 2.0, x * (x - 1.0) * (x - 2.0) / 6.0
    for r in range(M.shape[3]):
        for m in range(M.shape[4]):
            work[mode, level, r, m] = (
                a * M[n, mode, level, r, m] + b * M[n + 1, mode, level, r, m]
                + c * M[n + 2, mode, level, r, m] + d * M[n + 3, mode, level, r, m]
            )  # fmt: skip
    stamp[mode, level] = s[T_W]


def step(p: Array, s: Array, M: Array, work: Array, stamp: Array, z: Array, code: int, level: int, u: float, l: float,
         dl: float, rows: int) -> None:  # fmt: skip
    """What a step makes of the state, in the second half of z: the current alone, or all rows."""
    side, load = code % 3 - 1, code // 3 % 3 - 1
    mode = matrix_of(p, code)
    if p[HEAT] != 0.0 and not abs(s[T_W] - stamp[mode, level]) <= FRESH:
        fresh(p, s, M, work, stamp, mode, level)
    m = work[mode, level]
    i, w, friction, resistance = s[I], s[W], -side * p[F_M], resisting(p, load) + l
    if p[TWO] == 0.0:
        for r in range(rows):
            z[8 + r] = (
                m[r, 0] * i + m[r, 1] * w + m[r, 2] * u + m[r, 3] * friction + m[r, 4] * resistance + m[r, 5] * dl
            )
        return
    offset = (code // 9 - 1) * 0.5 * p[GAP]
    f, v = s[F] - offset, s[V]
    for r in range(rows + 2 if rows > 1 else 1):
        z[8 + r] = (
            m[r, 0] * i + m[r, 1] * w + m[r, 2] * f + m[r, 3] * v + m[r, 4] * u + m[r, 5] * friction
            + m[r, 6] * resistance + m[r, 7] * dl
        )  # fmt: skip
    z[10] += offset


def take(p: Array, s: Array, g: Array, z: Array, code: int, u: float, t: float, dt: float) -> None:
    """Count a step that ends at a time, and go to its end."""
    two = p[TWO] != 0.0
    q, x = (z[12], z[13]) if two else (z[10], z[11])
    first, last = s[I], z[8]
    mean, rise, bend = q / dt, last - first, (first + last) / 2.0 - q / dt
    # exact for a current that is a parabola in time (expansion in Legendre polynomials)
    count(p, s, g, dt * (mean * mean + rise * rise / 12.0 + bend * bend / 5.0), u, q, dt)
    see(g, G_I, last, t)
    see(g, G_W, z[9], t)
    power = u * (first if (first > last) == (u > 0.0) else last)
    if power > g[G_POWER]:
        see(g, G_POWER, power, t)
    if two:
        s[Y] += x / p[RATIO] - (z[10] - s[F])
        s[F], s[V] = z[10], z[11]
    else:
        s[Y] += x / p[RATIO]
        s[V] = z[9] / p[RATIO]
    s[I], s[W] = last, z[9]
    s[X] += x


def count(p: Array, s: Array, g: Array, square: float, u: float, q: float, dt: float) -> None:
    """Add what a step took: square of the current, charge, energy."""
    s[SQUARE] += square
    s[I2T] = max(0.0, s[I2T] + square - p[CONT2] * dt)
    g[G_I2T] = max(g[G_I2T], s[I2T])
    g[G_SQUARE] += square
    if u * q > 0.0:
        g[G_IN] += u * q
    else:
        g[G_BACK] -= u * q


def strain(p: Array, s: Array, g: Array, code: int, l: float, t: float, dt: float) -> None:
    """Watch the torque of the gearhead; its square over the time that it turns."""
    torque = gear_torque(p, code, s[I], s[W], s[F], s[V], l)
    see(g, G_G, torque, t)
    if code % 3 != 1:
        g[G_G_SQUARE] += torque * torque * dt
        g[G_RUNNING] += dt


def advance(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, u: float, l: float, dl: float,
            t: float) -> None:  # fmt: skip
    """March one period under a held voltage and a load torque that runs straight."""
    top = work.shape[1] - 1
    left, level, unit = 1 << top, top, p[H] / (1 << top)
    code = int(s[CODE])
    while left > 0:
        while (1 << level) > left:
            level -= 1
        dt, end = unit * (1 << level), unit * ((1 << top) - left + (1 << level))
        step(p, s, M, work, stamp, z, code, level, u, l + dl * (end - dt), dl, 4)
        after = mode_of(p, z[8], z[9], z[10], z[11], l + dl * end)
        if after != code and level > 0:
            level -= 1
            continue
        before_w, before_v = s[W], s[V]
        take(p, s, g, z, code, u, t + end, dt)
        strain(p, s, g, code, l + dl * end, t + end, dt)
        if after != code:
            stop(p, s, before_w, before_v)
            code = mode_of(p, s[I], s[W], s[F], s[V], l + dl * end)
            strain(p, s, g, code, l + dl * end, t + end, 0.0)
        left -= 1 << level
        s[STEPS] += 1.0
        level = min(level + 1, top)
    s[CODE] = code


def stop(p: Array, s: Array, w: float, v: float) -> None:
    """A reversal passes through rest, where friction may hold."""
    if w * s[W] < 0.0:
        s[W] = 0.0
        if p[TWO] == 0.0:
            s[V] = 0.0
    if v * s[V] < 0.0:
        s[V] = 0.0


def warm(p: Array, s: Array, at: int, I2: float, loss: float, R: float, dt: float) -> None:
    """Heat winding and housing by a mean square current (Runge-Kutta, to 1e-8 of the rise); heat of the copper."""
    rate = (1.0 / p[R_1] + p[ALPHA] * I2) / p[C_W] + (1.0 / p[R_1] + 1.0 / p[R_2]) / p[C_H]
    n = int(min(max(20.0 * rate * dt, 1.0), p[MOST])) if rate * dt < 1e9 else 1
    h = dt / n
    a, b = 0.0, 0.0
    for _ in range(n):
        w, hot, copper = s[at], s[at + 1], 0.0
        sum_w, sum_h = 0.0, 0.0
        x, y = w, hot
        for stage in range(4):
            heat, across = (R + p[ALPHA] * x) * I2, (x - y) / p[R_1]
            a, b = (heat - across) / p[C_W], (across - y / p[R_2] + loss) / p[C_H]
            weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
            sum_w, sum_h, copper = sum_w + weight * a, sum_h + weight * b, copper + weight * heat
            reach = h if stage == 2 else 0.5 * h
            x, y = w + reach * a, hot + reach * b
        s[at], s[at + 1], s[at + 2] = w + sum_w, hot + sum_h, s[at + 2] + copper


def heat(p: Array, s: Array, g: Array, turned: float, dt: float) -> None:
    """Temperatures after a period, or after a long stretch at rest or constant speed."""
    I2 = s[SQUARE] / dt
    s[SQUARE] = 0.0
    if p[HEAT] == 0.0:
        s[Q] += p[R25] * I2 * dt
        return
    warm(p, s, T_W, I2, p[P_0] + p[P_1] * abs(turned) / dt, p[R_A], dt)
    if p[SENSE] != 0.0:
        warm(p, s, WW, I2, 0.0, 0.0, dt)
        warm(p, s, HW, I2, 0.0, 0.0, dt)
    g[G_WINDING], g[G_HOUSING] = max(g[G_WINDING], s[T_W]), max(g[G_HOUSING], s[T_H])
    s[RES] = p[R_A] + p[ALPHA] * s[T_W]


def available(p: Array, i: float, wanted: float) -> float:
    """Voltage that the bus leaves at full duty under a current: V = V_0 - R_s n duty (V - drop) i / V."""
    r = p[R_S] * p[SETS] * p[DUTY] * (i if wanted >= 0.0 else -i)
    if r < 0.0 and p[RAISES] == 0.0:
        r = 0.0
    half = 0.5 * (p[V_0] - r)
    return float(max(0.0, float(p[DUTY]) * (half + math.sqrt(half * half + r * p[DROP]) - p[DROP])))


def bus(p: Array, g: Array, power: float, t: float) -> None:
    """Watch voltage and current of the bus under the power of all sets, V^2 - V_0 V + R_s P = 0."""
    P = p[SETS] * power
    if P < 0.0 and p[RAISES] == 0.0:
        P = 0.0
    V = 0.5 * (p[V_0] + math.sqrt(max(0.0, p[V_0] * p[V_0] - 4.0 * p[R_S] * P))) if p[R_S] > 0.0 else p[V_0]
    g[G_V_LOW], g[G_V_HIGH] = min(g[G_V_LOW], V), max(g[G_V_HIGH], V)
    if P > 0.0:
        see(g, G_BUS, P / V, t)


def permitted(p: Array, s: Array, h: float) -> float:
    """Current that the I2t integral leaves: the peak, then what just fills it, at last the continuous one."""
    return float(min(p[PEAK], math.sqrt(p[CONT2] + max(0.0, p[BUDGET] - s[I2T]) / h)))


def pid(p: Array, s: Array, at: int, error: float, rests: bool) -> float:
    """A sampled PID with a filtered derivative; its integral rests while it would only drive further into a limit."""
    if not rests:
        s[at] += p[KI] * error
    change = error - s[at + 2] if s[at + 3] != 0.0 else 0.0
    s[at + 2], s[at + 3] = error, 1.0
    s[at + 1] = p[KEEP] * s[at + 1] + p[KD] * change
    return float(p[KP] * error + s[at] + s[at + 1])


def measured(p: Array, s: Array, ring: Array) -> float:
    """Speed of the motor: exact, or the counts of the last periods over their time."""
    if p[EDGES] == 0.0:
        return float(s[W])
    count, window = math.floor(s[X] * p[EDGES] / (2.0 * math.pi)), int(p[WINDOW])
    slot = int(s[SEEN]) % window
    speed = (count - ring[slot]) * 2.0 * math.pi / (p[EDGES] * p[H] * p[N_V] * window)
    ring[slot] = count
    s[SEEN] += 1.0
    return float(speed)


def ask(p: Array, s: Array, ring: Array, k: int, speed: float, slope: float, angle: float) -> None:
    """The outer loops of the cascade at their samples: position, then velocity, then the limit of the current."""
    n_v, n_p = int(p[N_V]), int(p[N_P])
    if k % n_v != 0:
        return
    w = measured(p, s, ring)
    if n_p > 0 and k % (n_v * n_p) == 0:
        x = math.floor(s[X] * p[EDGES] / (2.0 * math.pi)) * 2.0 * math.pi / p[EDGES] if p[EDGES] > 0.0 else s[X]
        s[W_ADD] = p[PKP] * (angle - x)
    error = speed + s[W_ADD] - w
    sign = 1.0 if speed > 0.0 else -1.0 if speed < 0.0 else 0.0
    ahead = p[FFV] * speed + p[FFF] * sign + p[FFA] * slope
    wanted = ahead + pid(p, s, OUTER, error, s[I_CUT] * error > 0.0 or s[U_CUT] * error > 0.0)
    s[LIMIT] = permitted(p, s, p[H] * n_v)
    s[I_ASK] = min(max(wanted, -s[LIMIT]), s[LIMIT])
    s[I_CUT] = wanted - s[I_ASK]


def cascade(p: Array, s: Array, g: Array, t: float, weight: float) -> float:
    """The current loop: the voltage applied now."""
    see(g, G_AHEAD, s[I_ASK] + s[I_CUT], t)
    if s[I_CUT] != 0.0:
        g[G_LIMITED] += weight
    error = s[I_ASK] - s[I]
    if not s[U_CUT] * error > 0.0:
        s[INNER] += p[CKI] * error
    wanted = p[CKP] * error + s[INNER]
    if p[DELAY] != 0.0:
        wanted, s[PEND] = s[PEND], wanted
    return clipped(p, s, g, wanted, t, weight)


def clipped(p: Array, s: Array, g: Array, wanted: float, t: float, weight: float) -> float:
    """What the bus leaves of a voltage."""
    see(g, G_U_ASKED, wanted, t)
    most = available(p, s[I], wanted)
    u = min(max(wanted, -most), most)
    s[U_CUT] = wanted - u
    if u != wanted:
        g[G_SATURATED] += weight
    return u


def single(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, ring: Array, l: float,
           dl: float, t: float, speed: float, weight: float) -> float:  # fmt: skip
    """The voltage PID: a period late, held to voltage and current, the current seen a period ahead."""
    wanted = s[PEND]
    u = clipped(p, s, g, wanted, t, weight)
    step(p, s, M, work, stamp, z, int(s[CODE]), work.shape[1] - 1, 0.0, l, dl, 1)
    n = 4 if p[TWO] != 0.0 else 2
    idle, per_volt = z[8], work[matrix_of(p, int(s[CODE])), work.shape[1] - 1, 0, n]
    see(g, G_AHEAD, idle + per_volt * u, t + p[H])
    s[LIMIT] = permitted(p, s, p[H])
    if abs(idle + per_volt * u) > s[LIMIT]:
        g[G_LIMITED] += weight
        most = available(p, s[I], u)
        u = ((s[LIMIT] if idle + per_volt * u > 0.0 else -s[LIMIT]) - idle) / per_volt
        u = min(max(u, -most), most)
    error = speed - measured(p, s, ring)
    s[I_CUT] = wanted - u - s[U_CUT]
    s[PEND] = pid(p, s, OUTER, error, (wanted - u) * error > 0.0)
    return u


def regulated(p: Array, s: Array) -> bool:
    """Whether an integral keeps the current while the winding's resistance moves; else the voltage stays."""
    if s[U_CUT] != 0.0:
        return False
    return bool(p[CKI] != 0.0 if p[CASCADE] != 0.0 else p[KI] != 0.0 and s[W] != 0.0)


def hold(p: Array, s: Array, g: Array, u: float, l: float, t: float, duration: float) -> float:
    """Carry a steady state on; the voltage that it ends with, where the winding's resistance moved."""
    R, Q0 = s[RES], s[Q]
    count(p, s, g, s[I] * s[I] * duration, 0.0, 0.0, duration)
    strain(p, s, g, int(s[CODE]), l, t, duration)
    heat(p, s, g, s[W] * duration, duration)
    work = (u - R * s[I]) * s[I] * duration + (s[Q] - Q0)  # what turns into motion, and the copper's heat
    if work > 0.0:
        g[G_IN] += work
    else:
        g[G_BACK] -= work
    s[X] += s[W] * duration
    s[Y] += s[V] * duration
    rise = (s[RES] - R) * s[I] if regulated(p, s) else 0.0
    s[PEND] += rise
    s[INNER if p[CASCADE] != 0.0 else OUTER] += rise
    return u + rise


def steady(p: Array, s: Array, mind: Array, lag: float) -> bool:
    """Whether nothing changed since it was last asked."""
    now = (
        s[I], s[W], s[F], s[V], s[PEND], s[OUTER], s[OUTER + 1], s[INNER], s[I_ASK], lag if p[PKP] > 0.0 else 0.0,
        s[U_CUT],
    )  # fmt: skip
    asked = p[TOL_I] if p[CASCADE] != 0.0 else p[TOL_U]
    limits = (
        p[TOL_I], p[TOL_W], p[TOL_F], p[TOL_W] / p[RATIO], p[TOL_U], asked, asked, p[TOL_U], p[TOL_I], p[TOL_X],
        p[TOL_U],
    )  # fmt: skip
    same = p[EDGES] == 0.0 or s[W] == 0.0  # counts go on
    for n in range(STEADY):
        same = same and abs(now[n] - mind[n]) <= limits[n]
        mind[n] = now[n]
    return bool(same)


def carried(p: Array, s: Array, left: int) -> int:
    """How many periods a steady state may be carried: until the I2t integral is full, or the current moves."""
    if p[HEAT] != 0.0 and not regulated(p, s):
        rate = abs(s[RES] * s[I] * s[I] - (s[T_W] - s[T_H]) / p[R_1]) / p[C_W]
        left = int(min(FRESH / (rate * p[H] + 1e-300), left))
    grows = (s[I] * s[I] - p[CONT2]) * p[H]
    if grows <= 0.0 or p[BUDGET] == math.inf:
        return left
    free = (p[BUDGET] - s[I2T]) / grows - 2.0 * max(1.0, p[N_V])
    return int(min(max(free, 0.0), left))


def record(rows: Array, kept: Any, size: Any, always: bool, k: int, row: Any) -> None:
    """Keep a row: all while few, else evenly thinned, those after a corner always (size: rows, stride, spare)."""
    if (not always or size[2] <= 0) and k % size[1] != 0:
        return
    n = size[0]
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


def watch(p: Array, s: Array, g: Array, speed: float, angle: float, u: float, t: float, weight: float) -> None:
    """Errors and voltage at a sample."""
    error, lag = speed - s[W], angle - s[X]
    see(g, G_E_W, error, t)
    see(g, G_E_X, lag, t)
    see(g, G_U, u, t)
    g[G_E2_W] += error * error * weight
    g[G_E2_X] += lag * lag * weight


def remain(p: Array, s: Array, g: Array, error: float, lag: float, time: float) -> None:
    """Add what a steady stretch holds: errors, limits."""
    g[G_E2_W] += error * error * time
    g[G_E2_X] += lag * lag * time
    g[G_SATURATED] += time if s[U_CUT] != 0.0 else 0.0
    g[G_LIMITED] += time if s[I_CUT] != 0.0 else 0.0


def march_one(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, mind: Array, pieces: Array,
              ring: Array, rows: Array, kept: Any, size: Any) -> int:  # fmt: skip
    """March a set along all pieces: first, end, start [s], speed, slope, angle, load, its slope, corner."""
    h, near = p[H], max(rows.shape[0] // (2 * pieces.shape[0]), 1)
    n_v, cycle = int(p[N_V]), int(p[N_V] * max(p[N_P], 1.0))
    corner, u, turned, spent = 0, 0.0, 0.0, 0.0
    for n in range(pieces.shape[0]):
        k, end, slope, dl = int(pieces[n, 0]), int(pieces[n, 1]), pieces[n, 4], pieces[n, 7]
        corner = k if pieces[n, 8] != 0.0 else corner
        for c in range(STEADY):
            mind[c] = math.nan
        strain(p, s, g, int(s[CODE]), pieces[n, 6] + dl * (k * h - pieces[n, 2]), k * h, 0.0)
        while k < end:
            t, since = k * h, k * h - pieces[n, 2]
            speed, l = pieces[n, 3] + slope * since, pieces[n, 6] + dl * since
            angle = pieces[n, 5] + (pieces[n, 3] + 0.5 * slope * since) * since
            if p[CASCADE] != 0.0:
                ask(p, s, ring, k, speed, slope, angle)
                u = cascade(p, s, g, t, h)
            else:
                u = single(p, s, g, M, work, stamp, z, ring, l, dl, t, speed, h)
            watch(p, s, g, speed, angle, u, t, h)
            if rows.shape[0] > 0:
                torque = gear_torque(p, int(s[CODE]), s[I], s[W], s[F], s[V], l)
                row = (t, speed, s[W], s[I], u, torque, s[V], angle - s[X], s[I_ASK], s[T_W] + p[AMBIENT])
                record(rows, kept, size, k - corner < near, k, row)
            x, taken = s[X], g[G_IN] - g[G_BACK]
            advance(p, s, g, M, work, stamp, z, u, l, dl, t)
            bus(p, g, (g[G_IN] - g[G_BACK] - taken) / h, t)
            turned, spent, k = turned + abs(s[X] - x), spent + h, k + 1
            if k % n_v == 0 or k == end:
                heat(p, s, g, turned, spent)
                turned = spent = 0.0
            if not abs(s[I] + s[W] + s[V] + s[F] + s[PEND] + s[T_W]) < VAST:
                return NOT_FINITE
            if s[STEPS] > p[MOST]:
                return TOO_LONG
            if slope == 0.0 and dl == 0.0 and k % cycle == 0:
                lag = angle + speed * h - s[X]
                carry = carried(p, s, end - k) if steady(p, s, mind, lag) else 0
                if carry > 0:
                    remain(p, s, g, speed - s[W], lag, carry * h)
                    u = hold(p, s, g, u, l, k * h, carry * h)
                    k += carry
    return GOOD


_CALLED = (
    see, way, shaft, touching, held, coded, mode_of, resisting, driven_torque, gear_torque, matrix_of, fresh, step,
    count, take, strain, stop, advance, warm, heat, available, bus, permitted, pid, measured, ask, clipped, cascade,
    single, regulated, hold, steady, carried, record, watch, remain, march_one,
)  # fmt: skip


@cache
def compiled() -> Callable[..., int]:
    """``march_one`` as machine code, kept in the user's cache folder; as plain Python where numba is not installed.

    Notes
    -----
    Compiled code is kept in a folder named by the digest of this file, so that old code is never met; where that cannot
    be written it is compiled in memory at every start. It runs without the interpreter's lock: threads run beside
    each other.

    Warns
    -----
    SlowWarning
        When numba is not installed.
    """
    try:
        import numba
    except ImportError:
        warnings.warn(
            "numba is not installed: the closed loop runs some hundred times slower", SlowWarning, stacklevel=2
        )
        return march_one
    config: Any = numba.config
    place, before = _folder(), config.CACHE_DIR
    names: dict[str, Any] = dict(globals())
    try:
        config.CACHE_DIR = str(place or before)
        for function in _CALLED:
            whole = function is march_one
            # nothing is allocated inside: without counting references (_nrt) a call costs less than its work
            options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
            options |= {"cache": place is not None} if whole else {"forceinline": True, "no_cpython_wrapper": True}
            names[function.__name__] = numba.njit(**options)(FunctionType(function.__code__, names, function.__name__))
    finally:
        config.CACHE_DIR = before
    march: Callable[..., int] = names["march_one"]
    return march


def _folder() -> Path | None:
    """Where compiled code is kept; None where nothing can be written."""
    place = folder() / "kernels" / digest_of(Path(__file__).read_bytes())
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            return place
    except OSError:
        return None
