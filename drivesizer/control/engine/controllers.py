"""Sampled controllers: voltage PID, cascade of current, velocity and position loops, counted speed.

Arrays as in ``layout``.
"""

from __future__ import annotations

import math

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.limits import available_voltage, permitted_current
from drivesizer.control.engine.modes import friction_holds, matrix_of
from drivesizer.control.engine.steps import step
from drivesizer.control.engine.tallies import keep_demand, keep_peak

__all__ = ["feedforward_current"]


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
