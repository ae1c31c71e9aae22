"""Permitted time of an overload, and the states from which one starts: cold, or settled.

Convention: temperatures are absolute; one constant current, one constant loss at the housing (see ``heat_step``).
Not here: a current that varies (see ``heat_cycle``).
Symbols: T temperature [K], P_h loss at the housing [W], w winding and h housing: rises over ambient [K].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivesizer.physics.heat_step import Array, Modes, drive, modes, turning_time, weights
from drivesizer.physics.thermal import TwoBodies, steady_winding_temperature

__all__ = ["State", "cold", "overload_time", "steady_state"]

_DOUBLINGS = 128  # of the fast time constant: 1e38 of them is taken as infinite
_ROUNDS, _PARTS = (
    10,
    64,
)  # of the search for a crossing, in each of which the span is so many times shorter: to rounding


class State(NamedTuple):
    """Temperatures of winding and housing [K]."""

    winding: float
    housing: float


def cold(ambient: float) -> State:
    """A motor at ambient temperature [K]."""
    return State(ambient, ambient)


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
        Temperatures at the start: ``cold(ambient)``, ``steady_state(...)`` or any other [K].
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
    At a constant current the winding's temperature turns round once at most, so that it rises over one span of time;
    the crossing is bracketed within it and narrowed down.

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
    square = np.array([current * current])
    span, constant = modes(motor, square), drive(motor, ambient, square, np.array([P_h]))
    w, h = np.array([start.winding - ambient]), np.array([start.housing - ambient])
    slope_w, slope_h = (s + b for s, b in zip(span.slopes(w, h), constant, strict=True))
    return _crossing(span, slope_w, span.pulls(slope_w, slope_h)[0], T_max - start.winding)


def _crossing(span: Modes, slope: Array, pull: Array, climb: float) -> float:
    """First time at which the winding is warmer than at the start by a climb."""

    def above(t: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):
            weight = weights(span.fast, span.slow, t)
            return np.asarray(weight.slope * slope + (weight.pull * pull if pull.any() else 0.0) - climb)

    turn = float(turning_time(span.slow - span.fast, slope, pull)[0])
    rises_first = slope[0] > 0.0 or (slope[0] == 0.0 and pull[0] > 0.0)
    first, last = (0.0, turn) if rises_first else (turn, math.inf)
    if math.isinf(first) or math.isinf(climb):
        return math.inf
    times = np.append(first, np.minimum(first + np.ldexp(-1.0 / span.fast[0], np.arange(_DOUBLINGS)), last))
    hits = np.flatnonzero(above(times) >= 0.0)
    if not hits.size:
        return math.inf
    low, high = times[max(hits[0] - 1, 0)], times[hits[0]]
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _PARTS + 1)
        n = max(int((above(grid) >= 0.0).argmax()), 1)
        low, high = grid[n - 1], grid[n]
    return float(high)
