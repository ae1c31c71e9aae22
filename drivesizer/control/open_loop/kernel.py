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

Units are SI, angles and speeds at the motor's shaft. ``p`` are gears and load as the closed loop has them (``layout``),
the motor's torque in the place of its current; ``q`` the figures of the motor, ``table`` its pull-out torque at even
steps of the speed from 0, ``pieces`` the motion: rows of duration, speed, its slope, load torque at the driven shaft
beyond inertia and direction, its slope. ``g`` are tallies, ``rows`` the time series.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from numpy.typing import NDArray

import drivesizer.control.engine.layout as at
from drivesizer.control.engine import kernel as closed_loop
from drivesizer.control.engine.kernel import driven_torque, load_torque, matrix_of, mode_of
from drivesizer.control.engine.layout import places
from drivesizer.files.machine_code import Kernel, defined_in

Array = NDArray[np.float64]


# teeth; damping, and speed at which it has faded, per root of the torque; a microstep; speed from which pulses are a
# ramp; longest step; step of the speed in the table; share of the pull-out torque, of that at rest, and present share;
# whether anything rubs; lag at which it ends; interval of the rows
_FIGURES = "TEETH DAMP FADES MICRO RAMP H V_STEP SHARE IDLE NOW RUBS ENDS T_ROW"
FIGURES = _FIGURES.split()
TEETH, DAMP, FADES, MICRO, RAMP, H, V_STEP, SHARE, IDLE, NOW, RUBS, ENDS, T_ROW = places(FIGURES)

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


def torque_of(q: Array, table: Array, lag: float, v: float, w: float) -> float:
    """Torque of the motor [N*m] at a lag behind the field, its speed v and the rotor's w."""
    place = abs(v) / q[V_STEP]
    k = min(int(place), table.shape[0] - 2)
    pull_out = q[NOW] * (table[k] + (place - k) * (table[k + 1] - table[k]))
    root, slip = math.sqrt(max(pull_out, 0.0)), v - w
    fades = max(1.0 - abs(slip) / (q[FADES] * root), 0.0) if root > 0.0 else 0.0
    return pull_out * math.sin(q[TEETH] * lag) + q[DAMP] * root * slip * fades


def stage(p: Array, q: Array, table: Array, x: float, w: float, sign: float, field: tuple[float, ...],
          t: float) -> float:  # fmt: skip
    """Acceleration at a moment of a step [rad/s^2], over which the rotor moves forward (sign 1) or backward (-1).

    ``field`` is angle, speed, its slope, 1 for a ramp, load, its slope.
    """
    c, v, dv, ramp, load, dl = field
    torque, load = torque_of(q, table, c + ramp * (v + 0.5 * dv * t) * t - x, v + dv * t, w), load + dl * t
    share = p[at.DRIVE] if matrix_of(p, mode_of(p, torque, sign, 0.0, 0.0, load)) == 1 else p[at.BRAKE]
    left = torque - sign * p[at.F_M] - (load_torque(p, int(sign)) + load) * share
    return float(left / (p[at.J_M] + p[at.J_L] * share / p[at.RATIO]))


def stepped(
    p: Array, q: Array, table: Array, x: float, w: float, sign: float, field: tuple[float, ...], h: float
) -> tuple[float, float]:
    """Angle and speed after a step of the Runge-Kutta method."""
    a1 = stage(p, q, table, x, w, sign, field, 0.0)
    w2 = w + 0.5 * h * a1
    a2 = stage(p, q, table, x + 0.5 * h * w, w2, sign, field, 0.5 * h)
    w3 = w + 0.5 * h * a2
    a3 = stage(p, q, table, x + 0.5 * h * w2, w3, sign, field, 0.5 * h)
    w4 = w + h * a3
    a4 = stage(p, q, table, x + h * w3, w4, sign, field, h)
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


def pulse_within(q: Array, v: float, dv: float, angle: float, count: float, h: float) -> tuple[float, float]:
    """Step up to the next pulse, if there is one within it, and the pulse: 1 forward, -1 backward, 0 none."""
    gap, none = (count + 0.5) * q[MICRO] - angle, NONE * q[MICRO]
    ahead, back = crossing(gap, v, dv, none), crossing(q[MICRO] - gap, -v, -dv, none)
    if min(ahead, back) > h:
        return h, 0.0
    return min(ahead, back), 1.0 if ahead < back else -1.0


def advanced(
    p: Array, q: Array, table: Array, x: float, w: float, sign: float, field: tuple[float, ...], h: float
) -> tuple[float, float, float]:
    """Angle and speed after a step, and its length: shorter where the rotor comes to rest."""
    if sign == 0.0 or h == 0.0:
        return x, w, h
    x1, w1 = stepped(p, q, table, x, w, sign, field, h)
    if q[RUBS] == 0.0 or w1 * sign >= 0.0:
        return x1, w1, h
    if w == 0.0:  # it would turn back at once: it rests
        return x, w, h
    low, high, place = 0.0, h, x
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        place, speed = stepped(p, q, table, x, w, sign, field, middle)
        if speed * sign > 0.0:
            low = middle
        else:
            high = middle
    return place, 0.0, high


def noted(q: Array, g: Array, rows: Array, now: tuple[float, ...]) -> None:
    """Tallies and a row at a moment: time, speed of the profile, rotor's speed, error, lag, torque, load's torque."""
    t, _, w, error, lag, _, gear = now
    for place, value in ((G_LAG, lag), (G_ERROR, error), (G_GEAR, gear), (G_SPEED, w)):
        if abs(value) > g[place]:
            g[place], g[place + 1] = abs(value), t
    if abs(lag) > math.pi and g[G_SLIPPED] < 0.0:
        g[G_SLIPPED] = t
    g[G_END_LAG], g[G_END_ERROR], g[G_TIME] = lag, error, t
    k = int(g[G_ROWS])
    if k < rows.shape[0] and t >= k * q[T_ROW]:
        for n in range(7):
            rows[k, n] = now[n]
        g[G_ROWS] = k + 1.0


def turn_rotor(p: Array, q: Array, table: Array, pieces: Array, g: Array, rows: Array, x: float, w: float,
               most: float) -> int:  # fmt: skip
    """Simulate a rotor along a motion."""
    start, turned, count = 0.0, 0.0, 0.0  # time and angle of the profile at the start of a piece; microsteps
    for n in range(pieces.shape[0]):
        lasts, v0, dv, l0, dl = pieces[n, 0], pieces[n, 1], pieces[n, 2], pieces[n, 3], pieces[n, 4]
        q[NOW] = q[SHARE] * (q[IDLE] if v0 == 0.0 and dv == 0.0 else 1.0)
        t = 0.0
        while True:
            v, load, angle = v0 + dv * t, l0 + dl * t, turned + (v0 + 0.5 * dv * t) * t
            ramp = 1.0 if abs(v) > q[RAMP] else 0.0
            if ramp == 1.0 or abs(angle / q[MICRO] - count) > 0.5 + NONE:
                count = math.floor(angle / q[MICRO] + 0.5)
            c = angle if ramp == 1.0 else count * q[MICRO]
            torque = torque_of(q, table, c - x, v, w)
            code = mode_of(p, torque, 1.0 if w == 0.0 and q[RUBS] == 0.0 else w, 0.0, 0.0, load)
            sign = float(code % 3 - 1)  # 0 where friction holds it
            lag = q[TEETH] * (c - x)
            lag += math.copysign(0.5 * ramp * q[TEETH] * q[MICRO], lag)  # as far as a pulse leads a ramp
            noted(q, g, rows, (start + t, v, w, angle - x, lag, torque,
                  driven_torque(p, code, torque, w, 0.0, 0.0, load)))  # fmt: skip
            if abs(lag) > q[ENDS]:
                return 0
            if t >= lasts:
                break
            g[G_STEPS] += 1.0
            if g[G_STEPS] > most:
                return 1
            still = sign == 0.0 and v0 == 0.0 and dv == 0.0 and dl == 0.0
            left, pulse = lasts - t, 0.0
            h = left if still else min(left, q[H])
            if ramp == 0.0 and not still:
                h, pulse = pulse_within(q, v, dv, angle, count, h)
            x, w, elapsed = advanced(p, q, table, x, w, sign, (c, v, dv, ramp, load, dl), h)
            if elapsed == h:
                count += pulse
            t = lasts if elapsed == left else t + elapsed
        start += lasts
        turned += (v0 + 0.5 * dv * lasts) * lasts
    return 0


_THIS = sys.modules[__name__]
_OF_THE_CLOSED_LOOP = tuple(
    f for f in defined_in((closed_loop,)) if f.__name__ in
    ("direction", "shaft_torque", "holding_torque", "mode_of", "load_torque", "driven_torque", "matrix_of")
)  # fmt: skip
KERNEL = Kernel(
    functions=(*_OF_THE_CLOSED_LOOP, *defined_in((_THIS,))),
    modules=(at, closed_loop, _THIS),
    inline=False,
    slow="the simulation of a stepper runs some hundred times slower",
    arguments="d1 d1 d1 d2 d1 d2 d0 d0 d0",
)
