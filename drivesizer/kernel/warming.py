"""Winding and housing of motors from given temperatures on: after a span, in the long run, until an overload's end.

The kernel's own equations, over a single piece. Temperatures are absolute [K], figures are floats or columns.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivesizer.kernel.cycle import HEAT, Course
from drivesizer.kernel.evaluate import evaluate
from drivesizer.kernel.records import Drive
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.thermal import COPPER, TwoBodies, resistance_at, steady_winding_temperature

_NO_TIME = 1e-300  # s
_EARLIEST, _LATEST = 1e-9, 1e5  # time constants, of winding and housing, between which an overload ends
_TIMES, _ROUNDS = 512, 7  # that are looked at in each round of that search, until no float lies between


class State(NamedTuple):
    """Temperatures of winding and housing [K]: of one motor, or columns."""

    winding: Alike
    housing: Alike


def after(bodies: TwoBodies, ambient: Figure, start: State, I2: Figure, P_h: Figure, t: Figure) -> State:
    r"""Temperatures after a span of constant mean square current and constant loss at the housing.

    Parameters
    ----------
    bodies, ambient
        The motor and the temperature around it [K].
    start
        Temperatures at the start of the span [K].
    I2
        Mean square current [A^2].
    P_h
        Loss at the housing [W].
    t
        Span [s].

    Returns
    -------
    State
        Temperatures at its end; infinite where the winding has run away.

    Examples
    --------
    >>> motor = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)
    >>> [round(float(T) - 298.15, 2) for T in after(motor, 298.15, State(298.15, 298.15), 1.0, 0.0, 60.0)]
    [9.14, 2.33]
    """
    still = Drive(*np.zeros(len(Drive._fields)))
    drive = still._replace(  # one that turns at 1 rad/s under a torque of 1 N*m
        driving=np.sqrt(I2), R=resistance_at(bodies.R_25, ambient), R_rise=COPPER * bodies.R_25, R_th1=bodies.R_th1,
        R_th2=bodies.R_th2, C_w=bodies.capacity_w, C_h=bodies.capacity_h, friction=P_h, finest=np.inf,
        winding_start=start.winding - ambient, housing_start=start.housing - ambient,
    )  # fmt: skip
    shape, unit = np.broadcast_shapes(*map(np.shape, (*drive, t))), np.ones((1, 2, 1))
    spans = np.broadcast_to(np.maximum(t, _NO_TIME), shape).reshape(1, -1)
    span = Course(spans, unit, 0.0 * unit, unit, steps=np.zeros((0, 0), np.int64))  # steps are those of its memory
    ends = evaluate(drive._replace(course=np.ones(shape)), span, HEAT)
    rises = (np.where(np.isinf(ends.winding), np.inf, x) for x in (ends.winding_end, ends.housing_end))
    return State(*((ambient + rise)[()] for rise in rises))


def steady_state(motor: TwoBodies, ambient: float, I_rms: float, P_h: float = 0.0) -> State:
    """Temperatures of one motor in the long run at a constant RMS current.

    Parameters
    ----------
    motor, ambient
        The motor and the temperature around it [K].
    I_rms
        Root mean square current [A].
    P_h
        Mean loss at the housing [W].

    Returns
    -------
    State
        Infinite at thermal runaway, NaN where a figure of the motor is unknown.
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
    if start.winding >= T_max or math.isinf(T_max):
        return 0.0 if start.winding >= T_max else math.inf
    times = np.append(0.0, np.geomspace(_EARLIEST * motor.tau_w, _LATEST * (motor.tau_w + motor.tau_h), _TIMES))
    for _ in range(_ROUNDS):
        hot = after(motor, ambient, start, current * current, P_h, times).winding >= T_max
        if not hot.any():
            return math.inf
        n = int(hot.argmax())
        times = np.linspace(times[n - 1], times[n], _TIMES)
    return float(times[-1])
