r"""Rotor of a stepper behind the field of its pulses; compiled as machine code.

With :math:`\theta_c` the angle that the pulses command, w_c the speed of the profile, p the teeth of the rotor and
:math:`T_p` the pull-out torque at that speed, the motor's torque is [1]_

.. math:: T = T_p(w_c) \sin p(\theta_c - \theta)
    + 2 \zeta \sqrt{p\, T_p(w_c)\, J}\, (w_c - w) \max\!\left(1 - \frac{|w_c - w|}{2 w_n / p},\ 0\right)

and rotor and load turn as one body. Swings are damped, a rotor that slips is not dragged along: no swing about a
moving field is faster than :math:`2 w_n / p`, with :math:`w_n = \sqrt{p\, T_p / J}`. At rest the driver gives its idle
current, and the torque is in proportion. Gears take their loss by the
direction of power. Between pulses the classical Runge-Kutta method of fourth order steps; where friction brings the
rotor to rest, the step ends there.

References
----------
.. [1] P. Acarnley, *Stepping Motors: a guide to theory and practice*, 4th ed., IET, 2002, chapters 3 and 4.

Units are SI, angles and speeds at the motor's shaft. ``p`` are figures of the drive, ``table`` its pull-out torque at
even steps of the speed from 0, ``pieces`` the motion: rows of duration, speed, its slope, load torque at the driven
shaft beyond inertia and direction, its slope. ``g`` are tallies, ``rows`` the time series.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.engine.layout import places
from drivesizer.files.machine_code import Kernel, defined_in

Array = NDArray[np.float64]


# inertia of motor and load; ratio and efficiency of the gears; friction at the motor; load forward, backward, at rest;
# teeth; damping, and speed at which it has faded, per root of the torque; a microstep; speed from which pulses are a
# ramp; longest step; step of the speed in the table; share of the pull-out torque, of that at rest, and present share;
# whether anything rubs; lag at which it ends; interval of the rows
_PARAMETERS = """
    J_M J_L RATIO EFF FRICTION T_F T_B T_0 TEETH DAMP FADES MICRO RAMP H V_STEP SHARE IDLE NOW
    RUBS ENDS EVERY
"""
PARAMETERS = _PARAMETERS.split()
(
    J_M, J_L, RATIO, EFF, FRICTION, T_F, T_B, T_0, TEETH, DAMP, FADES, MICRO, RAMP, H, V_STEP, SHARE, IDLE, NOW,
    RUBS, ENDS, EVERY,
) = places(PARAMETERS)  # fmt: skip

# largest magnitudes with their times: lag of the rotor behind the field (electrical), distance from the profile,
# torque of the driven shaft, speed of the motor; when the lag first passed half a turn; at the end lag, distance from
# the profile, time; steps taken; rows kept
_TALLY = """
    lag lag_time error error_time gear gear_time speed speed_time slipped end_lag end_error time steps rows
"""
TALLY = _TALLY.split()
(
    G_LAG, G_LAG_TIME, G_ERROR, G_ERROR_TIME, G_GEAR, G_GEAR_TIME, G_SPEED, G_SPEED_TIME, G_SLIPPED, G_END_LAG,
    G_END_ERROR, G_TIME, G_STEPS, G_ROWS,
) = places(TALLY)  # fmt: skip

_ROW = "time reference motor_speed position_error load_angle motor_torque gear_torque"
ROW = _ROW.split()

HALVINGS = 24  # until a moment of rest is known
NONE = 1e-9  # of a microstep: no distance from a pulse


def torque_of(p: Array, table: Array, lag: float, v: float, w: float) -> float:
    """Torque of the motor [N*m] at a lag behind the field, its speed v and the rotor's w."""
    place = abs(v) / p[V_STEP]
    k = min(int(place), table.shape[0] - 2)
    pull_out = p[NOW] * (table[k] + (place - k) * (table[k + 1] - table[k]))
    root, slip = math.sqrt(max(pull_out, 0.0)), v - w
    fades = max(1.0 - abs(slip) / (p[FADES] * root), 0.0) if root > 0.0 else 0.0
    found: float = pull_out * math.sin(p[TEETH] * lag) + p[DAMP] * root * slip * fades
    return found


def acceleration(p: Array, torque: float, load: float, sign: float) -> float:
    """Acceleration of the rotor [rad/s^2] that moves forward (sign 1) or backward (-1)."""
    drag = load + (p[T_F] if sign > 0.0 else p[T_B])
    own = torque - sign * p[FRICTION]
    part = 1.0 / (p[EFF] * p[RATIO])
    found: float = (own - drag * part) / (p[J_M] + p[J_L] * part / p[RATIO])
    if (p[J_L] * found / p[RATIO] + drag) * sign < 0.0:  # the load drives
        part = p[EFF] / p[RATIO]
        found = (own - drag * part) / (p[J_M] + p[J_L] * part / p[RATIO])
    return found


def direction(p: Array, torque: float, load: float, w: float) -> float:
    """Direction in which the rotor moves; 0 where friction holds it."""
    if w != 0.0 or p[RUBS] == 0.0:
        return -1.0 if w < 0.0 else 1.0
    if acceleration(p, torque, load, 1.0) > 0.0:
        return 1.0
    return -1.0 if acceleration(p, torque, load, -1.0) < 0.0 else 0.0


def stage(p: Array, table: Array, x: float, w: float, sign: float, field: tuple[float, ...], t: float) -> float:
    """Acceleration at a moment of a step; ``field`` is angle, speed, its slope, 1 for a ramp, load, its slope."""
    c, v, dv, ramp, load, dl = field
    angle = c + ramp * (v + 0.5 * dv * t) * t
    return acceleration(p, torque_of(p, table, angle - x, v + dv * t, w), load + dl * t, sign)


def stepped(
    p: Array, table: Array, x: float, w: float, sign: float, field: tuple[float, ...], h: float
) -> tuple[float, float]:
    """Angle and speed after a step of the Runge-Kutta method."""
    a1 = stage(p, table, x, w, sign, field, 0.0)
    w2 = w + 0.5 * h * a1
    a2 = stage(p, table, x + 0.5 * h * w, w2, sign, field, 0.5 * h)
    w3 = w + 0.5 * h * a2
    a3 = stage(p, table, x + 0.5 * h * w2, w3, sign, field, 0.5 * h)
    w4 = w + h * a3
    a4 = stage(p, table, x + h * w3, w4, sign, field, h)
    return x + h * (w + 2.0 * w2 + 2.0 * w3 + w4) / 6.0, w + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0


def crossing(gap: float, speed: float, gain: float, none: float) -> float:
    """Time until a gap is covered at a speed and its gain [s]; infinite if it never is, 0 for a gap below ``none``."""
    if gap <= none:
        if speed > 0.0:
            return 0.0
        return -2.0 * speed / gain if gain > 0.0 else math.inf
    inside = speed * speed + 2.0 * gain * gap
    if inside < 0.0:
        return math.inf
    root = math.sqrt(inside)
    if speed > 0.0:
        return 2.0 * gap / (speed + root)
    return (root - speed) / gain if gain > 0.0 else math.inf


def pulse_within(p: Array, v: float, dv: float, angle: float, count: float, h: float) -> tuple[float, float]:
    """Step up to the next pulse, if there is one within it, and the pulse: 1 forward, -1 backward, 0 none."""
    gap, none = (count + 0.5) * p[MICRO] - angle, NONE * p[MICRO]
    ahead, back = crossing(gap, v, dv, none), crossing(p[MICRO] - gap, -v, -dv, none)
    if min(ahead, back) > h:
        return h, 0.0
    return min(ahead, back), 1.0 if ahead < back else -1.0


def advanced(
    p: Array, table: Array, x: float, w: float, sign: float, field: tuple[float, ...], h: float
) -> tuple[float, float, float]:
    """Angle and speed after a step, and its length: shorter where the rotor comes to rest."""
    if sign == 0.0 or h == 0.0:
        return x, w, h
    x1, w1 = stepped(p, table, x, w, sign, field, h)
    if p[RUBS] == 0.0 or w1 * sign >= 0.0:
        return x1, w1, h
    if w == 0.0:  # it would turn back at once: it rests
        return x, w, h
    low, high, place = 0.0, h, x
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        place, speed = stepped(p, table, x, w, sign, field, middle)
        if speed * sign > 0.0:
            low = middle
        else:
            high = middle
    return place, 0.0, high


def load_torque(p: Array, torque: float, load: float, sign: float) -> float:
    """Torque of the driven shaft [N*m], the load's inertia included."""
    found: float = load + p[T_0]
    if sign != 0.0:
        found = load + (p[T_F] if sign > 0.0 else p[T_B])
        found += p[J_L] * acceleration(p, torque, load, sign) / p[RATIO]
    return found


def noted(p: Array, g: Array, rows: Array, now: tuple[float, ...]) -> None:
    """Tallies and a row at a moment: time, speed of the profile, rotor's speed, error, lag, torque, load's torque."""
    t, _, w, error, lag, _, gear = now
    for place, value in ((G_LAG, lag), (G_ERROR, error), (G_GEAR, gear), (G_SPEED, w)):
        if abs(value) > g[place]:
            g[place], g[place + 1] = abs(value), t
    if abs(lag) > math.pi and g[G_SLIPPED] < 0.0:
        g[G_SLIPPED] = t
    g[G_END_LAG], g[G_END_ERROR], g[G_TIME] = lag, error, t
    k = int(g[G_ROWS])
    if k < rows.shape[0] and t >= k * p[EVERY]:
        for n in range(7):
            rows[k, n] = now[n]
        g[G_ROWS] = k + 1.0


def turn_rotor(p: Array, table: Array, pieces: Array, g: Array, rows: Array, x: float, w: float, most: float) -> int:
    """Simulate a rotor along a motion."""
    start, turned, count = 0.0, 0.0, 0.0  # time and angle of the profile at the start of a piece; microsteps
    for n in range(pieces.shape[0]):
        lasts, v0, dv, l0, dl = pieces[n, 0], pieces[n, 1], pieces[n, 2], pieces[n, 3], pieces[n, 4]
        p[NOW] = p[SHARE] * (p[IDLE] if v0 == 0.0 and dv == 0.0 else 1.0)
        t = 0.0
        while True:
            v, load, angle = v0 + dv * t, l0 + dl * t, turned + (v0 + 0.5 * dv * t) * t
            ramp = 1.0 if abs(v) > p[RAMP] else 0.0
            if ramp == 1.0 or abs(angle / p[MICRO] - count) > 0.5 + NONE:
                count = math.floor(angle / p[MICRO] + 0.5)
            c = angle if ramp == 1.0 else count * p[MICRO]
            torque = torque_of(p, table, c - x, v, w)
            sign = direction(p, torque, load, w)
            lag = p[TEETH] * (c - x)
            lag += math.copysign(0.5 * ramp * p[TEETH] * p[MICRO], lag)  # as far as a pulse leads a ramp
            gear = load_torque(p, torque, load, sign)
            noted(p, g, rows, (start + t, v, w, angle - x, lag, torque, gear))
            if abs(lag) > p[ENDS]:
                return 0
            if t >= lasts:
                break
            g[G_STEPS] += 1.0
            if g[G_STEPS] > most:
                return 1
            still = sign == 0.0 and v0 == 0.0 and dv == 0.0 and dl == 0.0
            left, pulse = lasts - t, 0.0
            h = left if still else min(left, p[H])
            if ramp == 0.0 and not still:
                h, pulse = pulse_within(p, v, dv, angle, count, h)
            x, w, taken = advanced(p, table, x, w, sign, (c, v, dv, ramp, load, dl), h)
            if taken == h:
                count += pulse
            t = lasts if taken == left else t + taken
        start += lasts
        turned += (v0 + 0.5 * dv * lasts) * lasts
    return 0


_THIS = sys.modules[__name__]
KERNEL = Kernel(
    functions=defined_in((_THIS,)),
    modules=(_THIS,),
    inline=False,
    slow="the simulation of a stepper runs some hundred times slower",
    arguments="d1 d1 d2 d1 d2 d0 d0 d0",
)
