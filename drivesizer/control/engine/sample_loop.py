"""Simulation of one drive along pieces of its task, period by period; arrays as in ``layout``."""

from __future__ import annotations

import math
from typing import Any

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.controllers import current_loop, outer_loops, voltage_loop
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.limits import record_bus
from drivesizer.control.engine.modes import gear_torque
from drivesizer.control.engine.steady import carry_state, is_steady, periods_to_carry
from drivesizer.control.engine.steps import advance
from drivesizer.control.engine.tallies import add_steady_errors, keep_row, record_errors, record_gear_torque, square_of
from drivesizer.control.engine.warming import follow, heat

__all__ = ["simulate_one"]


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
