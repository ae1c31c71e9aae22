"""Simulation of one drive period by period: sampled controllers, long stretches in one step; see ``layout``."""

from __future__ import annotations

import math
from typing import Any

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.steps import (
    add_energy,
    add_square,
    add_steady_errors,
    advance,
    available_voltage,
    follow,
    friction_holds,
    gear_torque,
    heat,
    keep_demand,
    keep_peak,
    keep_row,
    matrix_of,
    permitted_current,
    record_bus,
    record_errors,
    record_gear_torque,
    square_of,
    step,
    warm,
)

__all__ = ["feedforward_current", "simulate_one"]


# -- Sampled controllers: voltage PID, cascade of current, velocity and position loops, counted speed.
#
# Arrays as in ``layout``.


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
    if still and p[at.KEPT] != 1.0 and s[at.OUTER] != 0.0 and friction_holds(p, s[at.F], l):
        least = p[at.TOL_I] if p[at.CASCADE] != 0.0 else p[at.TOL_U]
        s[at.OUTER] = s[at.OUTER] * p[at.KEPT] if abs(s[at.OUTER]) > least else 0.0


def whole_counts(p: Array, angle: float) -> float:
    """An angle in whole counts."""
    return float(math.floor(angle * p[at.EDGES] / (2.0 * math.pi)))


def position_error(p: Array, s: Array, angle: float) -> float:
    """Position error [rad]; with counts in whole counts, so that a motor within its count may rest."""
    if p[at.EDGES] == 0.0:
        return float(angle - s[at.X])
    return (whole_counts(p, angle) - whole_counts(p, s[at.X])) * 2.0 * math.pi / float(p[at.EDGES])


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
    """Feedforward of the current by the model's friction and inertia."""
    sign = 1.0 if speed > 0.0 else -1.0 if speed < 0.0 else 0.0
    return float(p[at.FFV] * speed + p[at.FFF] * sign + p[at.FFA] * slope)


def limit_current(p: Array, s: Array, demand: float) -> None:
    """Limit a current demand by the I2t integral."""
    s[at.LIMIT] = permitted_current(p, s, p[at.H] * p[at.N_V])
    s[at.I_DEMAND] = min(max(demand, -s[at.LIMIT]), s[at.LIMIT])
    s[at.I_CUT] = demand - s[at.I_DEMAND]


def outer_loops(p: Array, s: Array, ring: Array, k: int, speed: float, slope: float, angle: float, l: float) -> None:
    """The outer loops of the cascade at their samples: position, then velocity; each one of its periods late."""
    n_v, n_p = int(p[at.N_V]), int(p[at.N_P])
    if k % n_v != 0:
        return
    late = p[at.DELAY] != 0.0
    if late:
        limit_current(p, s, s[at.I_NEXT])
    w = measured_speed(p, s, ring)
    if n_p > 0 and k % (n_v * n_p) == 0:
        more = p[at.PKP] * position_error(p, s, angle)
        s[at.W_ADD] = s[at.W_NEXT] if late else more
        s[at.W_NEXT] = more
    error = speed + s[at.W_ADD] - w
    drain(p, s, error, speed, slope, l)
    s[at.I_NEXT] = feedforward_current(p, speed, slope) + pid(
        p, s, at.OUTER, error, s[at.I_CUT] * error > 0.0 or s[at.U_CUT] * error > 0.0
    )
    if not late:
        limit_current(p, s, s[at.I_NEXT])


def limited_voltage(p: Array, s: Array, g: Array, demand: float, t: float, weight: float) -> float:
    """A voltage demand limited by the bus [V]."""
    keep_demand(p, g, demand, s[at.I], t)
    most = available_voltage(p, s[at.I], demand)
    u = min(max(demand, -most), most)
    s[at.U_CUT] = demand - u
    if u != demand:
        g[at.G_SATURATED] += weight
    return u


def current_loop(p: Array, s: Array, g: Array, t: float, weight: float) -> float:
    """The current loop: voltage applied from now on [V]."""
    keep_peak(g, at.G_AHEAD, s[at.I_DEMAND] + s[at.I_CUT], t)
    if s[at.I_CUT] != 0.0:
        g[at.G_LIMITED] += weight
    error = s[at.I_DEMAND] - s[at.I]
    if not s[at.U_CUT] * error > 0.0:
        s[at.INNER] += p[at.CKI] * error
    demand = p[at.CKP] * error + s[at.INNER]
    if p[at.DELAY] != 0.0 and p[at.PROMPT] == 0.0:
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
    keep_peak(g, at.G_AHEAD, idle + per_volt * u, t + p[at.H])
    s[at.LIMIT] = permitted_current(p, s, p[at.H])
    if abs(idle + per_volt * u) > s[at.LIMIT]:
        g[at.G_LIMITED] += weight
        most = available_voltage(p, s[at.I], u)
        u = ((s[at.LIMIT] if idle + per_volt * u > 0.0 else -s[at.LIMIT]) - idle) / per_volt
        u = min(max(u, -most), most)
    error = speed - measured_speed(p, s, ring)
    drain(p, s, error, speed, slope, l)
    s[at.I_CUT] = demand - u - s[at.U_CUT]
    s[at.PEND] = pid(p, s, at.OUTER, error, (demand - u) * error > 0.0)
    return u


# -- Long stretches in steady state, carried in one step; arrays as in ``layout``.


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


# -- Simulation of one drive along pieces of its task, period by period; arrays as in ``layout``.


def record_row(p: Array, s: Array, rows: Array, kept: Any, size: Any, reference: Any, k: int, near: bool) -> None:
    """Record a row: the reference (time, speed, angle, load, voltage) and the state."""
    t, speed, angle, l, u = reference
    torque = gear_torque(p, int(s[at.CODE]), s[at.I], s[at.W], s[at.F], s[at.V], l)
    winding = s[at.T_W] + p[at.AMBIENT]
    lag, behind = angle - s[at.X], angle / p[at.RATIO] - s[at.Y]
    row = (t, speed, s[at.W], s[at.I], u, torque, s[at.V], lag, behind, s[at.I_DEMAND], winding)
    keep_row(rows, kept, size, near, k, row)


def control(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, ring: Array, rows: Array,
           kept: Any, size: Any, piece: Array, k: int, near: bool) -> float:  # fmt: skip
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
        record_row(p, s, rows, kept, size, (t, speed, angle, l, u), k, near)
    return u


def status_of(p: Array, s: Array) -> int:
    """Reason for which a simulation ends early, by the codes of ``layout``."""
    if not abs(s[at.I] + s[at.W] + s[at.V] + s[at.F] + s[at.PEND] + s[at.T_W]) < at.VAST:
        return at.NOT_FINITE
    return at.TOO_LONG if s[at.STEPS] > p[at.MOST] else at.GOOD


def lag_at(p: Array, s: Array, piece: Array, k: int) -> float:
    """Lag of the motor's angle behind a reference of constant speed [rad]."""
    h, speed = p[at.H], piece[3]
    return float(s[at.TURN] + piece[5] + speed * ((k - 1) * h - piece[2]) + speed * h - s[at.X])


def carry_steady(p: Array, s: Array, g: Array, piece: Array, k: int, u: float) -> int:
    """Carry a steady state as far as possible; the number of periods."""
    h, speed, lag = p[at.H], piece[3], lag_at(p, s, piece, k)
    carry = periods_to_carry(p, s, int(piece[1]) - k)
    if carry > 0:
        behind = (lag + s[at.X]) / p[at.RATIO] - s[at.Y]
        add_steady_errors(p, s, g, speed - s[at.W], lag, behind, carry * h)
        carry_state(p, s, g, u, piece[6], k * h, carry * h)
    return carry


def simulate_one(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, mind: Array,
                 pieces: Array, ring: Array, rows: Array, kept: Any, size: Any) -> int:  # fmt: skip
    """Simulate a drive along all pieces."""
    h, near = p[at.H], size[3]
    n_v, cycle = int(p[at.N_V]), int(p[at.N_V] * max(p[at.N_P], 1.0))
    pause = n_v * int(max(p[at.EVERY], 1.0))
    corner, turned, swept, spent, felt, since, u = 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for n in range(pieces.shape[0]):
        piece = pieces[n]
        k, end, constant = int(piece[0]), int(piece[1]), piece[4] == 0.0 and piece[7] == 0.0
        corner = k if piece[8] != 0.0 else corner
        mind[:] = math.nan
        record_gear_torque(p, s, g, int(s[at.CODE]), piece[6] + piece[7] * (k * h - piece[2]), k * h, 0.0)
        while k < end:
            t, x, w, taken = k * h, s[at.X], s[at.W], g[at.G_IN] - g[at.G_RETURNED]
            u = control(p, s, g, M, work, stamp, z, ring, rows, kept, size, piece, k, k - corner < near)
            advance(p, s, g, M, work, stamp, z, u, piece[6] + piece[7] * (t - piece[2]), piece[7], t)
            record_bus(p, g, (g[at.G_IN] - g[at.G_RETURNED] - taken) / h, t, h)
            turned, swept = turned + abs(s[at.X] - x), swept + square_of(w, s[at.W], s[at.X] - x, h)
            spent, k = spent + h, k + 1
            steady = constant and (cycle == 1 or k % cycle == 0) and is_steady(p, s, mind, lag_at(p, s, piece, k))
            if n_v == 1 or k % n_v == 0 or k == end:
                felt, since = felt + s[at.SQUARE], since + spent
                heat(p, s, g, turned, swept, spent)
                turned = swept = spent = 0.0
            if k % pause == 0 or k == end or steady:
                follow(p, s, felt, since)
                felt = since = 0.0
            status = status_of(p, s)
            if status != at.GOOD:
                return status
            if steady:
                k += carry_steady(p, s, g, piece, k, u)
    if rows.shape[0] > 0:
        piece = pieces[-1]
        t, since = piece[1] * h, piece[1] * h - piece[2]
        angle = piece[5] + (piece[3] + 0.5 * piece[4] * since) * since
        reference = (t, piece[3] + piece[4] * since, angle, piece[6] + piece[7] * since, u)
        record_row(p, s, rows, kept, size, reference, 0, False)
    return at.GOOD
