"""Long stretches in steady state, carried in one step; arrays as in ``layout``."""

from __future__ import annotations

import math

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.limits import available_voltage, record_bus
from drivesizer.control.engine.tallies import add_energy, add_square, keep_demand, keep_peak, record_gear_torque
from drivesizer.control.engine.warming import follow, heat, warm

__all__: list[str] = []  # compiled into ``kernel``


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
    keep_demand(p, g, u + rise + s[at.U_CUT], s[at.I], t + duration)
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
    room = available_voltage(p, s[at.I], u) - abs(u)
    rise = room / (p[at.ALPHA] * current + 1e-300)  # K
    rate = abs(s[at.RES] * current * current - (s[at.T_W] - s[at.T_H]) / p[at.R_1]) / p[at.C_W]
    least = min(at.FRESH / (rate * p[at.H] + 1e-300), 1.0 * left)
    winding, housing, copper = s[at.T_W], s[at.T_H], s[at.Q]
    loss = p[at.P_0] + p[at.P_1] * abs(s[at.W]) + p[at.P_2] * s[at.W] * s[at.W]
    n = left
    while n > least:
        warm(p, s, at.T_W, current * current, loss, p[at.R_A], n * p[at.H])
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
        rate = abs(s[at.RES] * s[at.I] * s[at.I] - (s[at.T_W] - s[at.T_H]) / p[at.R_1]) / p[at.C_W]
        left = int(min(at.FRESH / (rate * p[at.H] + 1e-300), left))
    grows = (s[at.I] * s[at.I] - p[at.CONT2]) * p[at.H]
    if grows <= 0.0 or p[at.BUDGET] == math.inf:
        return left
    free = (p[at.BUDGET] - s[at.I2T]) / grows - 2.0 * max(1.0, p[at.N_V])
    return int(min(max(free, 0.0), left))
