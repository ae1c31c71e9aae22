r"""Winding and housing over time: after a span of constant load, in the long run, until an overload's end.

.. math::

    C_w \dot T_w &= R_{25} I^2 (1 + \alpha (T_w - T_{25})) - (T_w - T_h) / R_{th1} \\
    C_h \dot T_h &= P_h + (T_w - T_h) / R_{th1} - (T_h - T_a) / R_{th2}

The winding's resistance grows with its temperature, so that the square of the current stands in the matrix of x' = A x
+ b. A couples two bodies, so its eigenvalues are real and distinct, and the lower one is negative also when the winding
runs away. Convention: temperatures are absolute; all functions are elementwise: floats, or columns over motors that
broadcast against the spans. Over a whole cycle the kernel computes them, by the same equations in rises over ambient.
Not here: magnets that weaken with heat. Symbols: T temperature [K], R resistance [ohm], R_th thermal resistance [K/W],
tau time constant [s], I current [A], P_h loss at the housing [W].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.figures import Figure
from drivesizer.physics.thermal import (
    COPPER,
    TwoBodies,
    Value,
    resistance_at,
    steady_winding_temperature,
)

Array = NDArray[np.float64]
_MOST = 80.0  # of an exponent, of what has run away long before
_EARLIEST, _LATEST = 1e-9, 1e5  # time constants, of winding and housing, between which an overload ends
_TIMES, _ROUNDS = 4096, 5  # that are looked at in each round of that search


class State(NamedTuple):
    """Temperatures of winding and housing [K]: of one motor, or columns."""

    winding: Figure
    housing: Figure


class _Modes(NamedTuple):
    """The matrix A, its eigenvalues fast < slow, and the diagonal of A - fast, which is above zero: all [1/s]."""

    fast: Array
    slow: Array  # above zero where the current alone would let the motor run away
    ww: Array
    wh: Value
    hw: Value
    hh: Value
    ww_fast: Array
    hh_fast: Array


def _modes(bodies: TwoBodies, I2: Figure) -> _Modes:
    """Matrix and eigenvalues, without cancellation: the determinant is known, and (A_ww - fast)(A_hh - fast) too."""
    ratio = bodies.R_th2 / bodies.R_th1
    feedback = (COPPER * bodies.R_25 * bodies.R_th1) * np.asarray(I2)
    wh, hw, hh = 1.0 / bodies.tau_w, ratio / bodies.tau_h, -(1.0 + ratio) / bodies.tau_h
    ww = (feedback - 1.0) / bodies.tau_w
    half = (ww - hh) / 2.0
    large = np.abs(half) + np.sqrt(half * half + wh * hw)
    small = wh * hw / large
    ww_fast, hh_fast = np.where(half > 0.0, large, small), np.where(half > 0.0, small, large)
    fast = hh - hh_fast
    slow = (1.0 - feedback * (1.0 + ratio)) / (bodies.tau_w * bodies.tau_h) / fast
    return _Modes(fast, slow, ww, wh, hw, hh, ww_fast, hh_fast)


def after(bodies: TwoBodies, ambient: Figure, start: State, I2: Figure, P_h: Figure, t: Figure) -> State:
    r"""Temperatures after a span of constant mean square current and constant loss at the housing.

    .. math:: x(t) = x_0 + \left(\varphi_f + \frac{\varphi_s - \varphi_f}{s - f} (A - f)\right) \dot x_0, \qquad
              \varphi_f = \frac{e^{f t} - 1}{f}

    Parameters
    ----------
    bodies
        Winding and housing.
    ambient
        Temperature around the motor [K].
    start
        Temperatures at the start [K].
    I2
        Mean square current over the span [A^2].
    P_h
        Mean loss at the housing over the span [W].
    t
        Duration of the span [s].

    Returns
    -------
    State
        Temperatures at its end [K]; f and s are the eigenvalues of A.

    Examples
    --------
    >>> bodies = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> [round(float(T) - 298.15, 2) for T in after(bodies, 298.15, State(298.15, 298.15), 1.0, 0.0, 60.0)]
    [9.14, 2.33]
    """
    m = _modes(bodies, I2)
    w, h = start.winding - ambient, start.housing - ambient
    slope_w = m.ww * w + m.wh * h + resistance_at(bodies.R_25, ambient) / bodies.capacity_w * I2
    slope_h = m.hw * w + m.hh * h + P_h / bodies.capacity_h
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        fast, slow = (np.where(x == 0.0, t, np.expm1(np.minimum(x * t, _MOST)) / x) for x in (m.fast, m.slow))
        pair = (slow - fast) / (m.slow - m.fast)
        return State(
            start.winding + fast * slope_w + pair * (m.ww_fast * slope_w + m.wh * slope_h),
            start.housing + fast * slope_h + pair * (m.hw * slope_w + m.hh_fast * slope_h),
        )


def steady_state(motor: TwoBodies, ambient: float, I_rms: float, P_h: float = 0.0) -> State:
    """Temperatures of one motor in the long run at a constant RMS current.

    Parameters
    ----------
    motor
        Winding and housing.
    ambient
        Temperature around the motor [K].
    I_rms
        RMS current [A].
    P_h
        Loss at the housing [W].

    Returns
    -------
    State
        As ``steady_winding_temperature`` and ``TwoBodies.housing`` have them; NaN where a figure is unknown.

    Examples
    --------
    >>> motor = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> [round(T - 298.15, 2) for T in steady_state(motor, 298.15, 1.0)]
    [46.93, 38.43]
    """
    if not motor.known:
        return State(math.nan, math.nan)
    winding = float(steady_winding_temperature(ambient, motor.R_25, motor.R_th1, motor.R_th2, I_rms, P_h))
    return State(winding, float(motor.housing(ambient, winding, P_h)))


def overload_time(
    motor: TwoBodies, ambient: float, start: State, T_max: float, current: float, P_h: float = 0.0
) -> float:
    """Time until the winding reaches its permitted temperature at a constant current.

    Parameters
    ----------
    motor
        Winding and housing.
    ambient
        Temperature around the motor [K].
    start
        Temperatures at the start [K].
    T_max
        Permitted winding temperature [K].
    current
        Current, RMS [A].
    P_h
        Loss at the housing [W].

    Returns
    -------
    float
        Time [s]; 0 where the start is at the limit already, infinite where it is never reached, NaN where a figure is
        unknown.

    Notes
    -----
    The first of many times at which the winding is there, and between this and the one before again.

    Examples
    --------
    >>> motor = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> round(overload_time(motor, 298.15, State(298.15, 298.15), 373.15, 4.0), 1)
    9.9
    """
    if not motor.known or math.isnan(ambient + start.winding + start.housing + T_max + current + P_h):
        return math.nan
    if start.winding >= T_max:
        return 0.0
    times = np.append(0.0, np.geomspace(_EARLIEST * motor.tau_w, _LATEST * (motor.tau_w + motor.tau_h), _TIMES))
    for _ in range(_ROUNDS):
        hot = after(motor, ambient, start, current * current, P_h, times).winding >= T_max
        if not hot.any():
            return math.inf
        n = int(hot.argmax())
        times = np.linspace(times[n - 1], times[n], _TIMES)
    return float(times[-1])
