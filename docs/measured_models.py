"""Predictions of the drive model for the measured drives, from data sheets alone, and with refinements.

Predictions call the program. Refinements are fits made here only. The catalogue's current of a brushless motor
is that of the DC motor with the same loss and torque: sqrt(3)/2 of the amplitude in a phase (the q current).
Symbols: w speed [rad/s], V voltage [V], I current [A], R resistance [ohm], M torque [N*m], T temperature [K],
C heat capacity [J/K], R_th thermal resistance [K/W].
"""

from __future__ import annotations

from functools import cache
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.lookup import find
from drivesizer.catalog.query import Hit, open_all
from drivesizer.machine.part_curves import line
from drivesizer.physics.heat_step import drive, modes, weights
from drivesizer.physics.motor_demand import friction
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE, TwoBodies

__all__ = ["DC", "Thermal", "chain", "fit_thermal", "hot", "part", "sheet_free_speed", "sheet_lift", "two_body_course"]

Array = NDArray[np.float64]

DC = sqrt(3.0) / 2.0  # current of the equivalent DC motor by amplitude in a phase
NO_COOLING = 1e3  # K/W, housing to ambient: a record of 72 s does not distinguish it from none


@cache
def part(catalogue: str, name: str) -> Hit:
    """A part of a catalogue that ships."""
    return find(open_all([catalogue]), name)[0]


# --- geared servo ----------------------------------------------------------------------------------------------------


def sheet_free_speed(servo: Hit, V: Array) -> Array:
    """Speed of the free horn: the sheet's, by the voltage. No no-load current is printed, so the line meets zero."""
    return np.asarray(line(servo).speed * V / servo["nominal_voltage"])


def sheet_lift(servo: Hit, V: Array) -> tuple[Array, Array]:
    """Current and torque at standstill."""
    I = np.asarray(V / servo["resistance"])
    return I, servo["ratio"] * servo["motor_torque_constant"] * servo["efficiency"] * I


def with_offset(V: Array, w: Array, least: float = 3.0) -> tuple[float, float]:
    """The straight line of speed from a voltage on: its slope [rad/(s*V)], the voltage at which it starts [V]."""
    slope, start = np.polyfit(V[least <= V], w[least <= V], 1)
    return float(slope), float(-start / slope)


def through_zero(x: Array, y: Array) -> float:
    """Slope of the line through zero with least squared errors."""
    return float(x @ y / (x @ x))


# --- brushless motor: torque, loss, friction -------------------------------------------------------------------------


def hot(R_25: float, T: Array) -> Array:
    """Resistance of a warm winding."""
    return np.asarray(R_25 * (1.0 + COPPER * (T - DATA_TEMPERATURE)))


def signed_line(I: Array, M: Array) -> tuple[float, float]:
    """Slope of torque over current, and the torque by which it is off at either sign [N*m]."""
    (slope, off), *_ = np.linalg.lstsq(np.stack([I, np.sign(I)], axis=1), M, rcond=None)
    return float(slope), float(off)


def driver_loss(I: Array, rest: Array, warmth: Array) -> tuple[float, float]:
    """Resistance at 25 degC [ohm] and loss by current [W/A] that make a measured loss.

    Parameters
    ----------
    I
        Current [A].
    rest
        Loss less standby [W].
    warmth
        Resistance over that at 25 degC [1].
    """
    (R, by_current), *_ = np.linalg.lstsq(np.stack([warmth * I**2, I], axis=1), rest, rcond=None)
    return float(R), float(by_current)


def idle_current(w: Array, k_t: float, I_0: float, w_0: float, kind: str) -> Array:
    """No-load current over speed as the program reads a sheet of that kind, with I_0 at a speed w_0."""
    figures = {"torque_constant": k_t, "no_load_current": I_0, "no_load_speed": w_0, "kind": kind,
               "winding": "", "friction_torque": np.nan, "viscous_friction": np.nan}  # fmt: skip
    coulomb, viscous = friction({name: np.array([value]) for name, value in figures.items()})
    return np.asarray((coulomb + viscous * w) / k_t)


def saturating(w: Array, I: Array) -> tuple[float, float, float]:
    """Current at rest, its growth [A] and the speed over which it grows [rad/s]: I_c + I_v (1 - exp(-w / w_s))."""
    from scipy.optimize import least_squares

    def errors(z: Array) -> Array:
        return np.asarray(z[0] + z[1] * (1.0 - np.exp(-w / z[2])) - I)

    found = least_squares(errors, [I[0], I[-1] - I[0], w.mean()])
    return float(found.x[0]), float(found.x[1]), float(found.x[2])


# --- heat ------------------------------------------------------------------------------------------------------------


class Thermal(NamedTuple):
    """A row of bodies of heat, the winding first, the housing last, and what a sensor makes of it."""

    C: Array  # J/K, of each body
    R_th: Array  # K/W, to the next one
    lag: float  # s, of the sensor at the winding
    shares: tuple[float, ...]  # heat at the sensor's place over that of the first hold, for the later ones


def two_body_course(motor: TwoBodies, ambient: float, dt: float, I2: Array, start: tuple[float, float]) -> Array:
    """Winding and housing after each span of a record, by the program's closed form: shape (spans, 2) [K]."""
    span, constant = modes(motor, I2), drive(motor, ambient, I2, np.zeros_like(I2))
    weight = weights(span.fast, span.slow, np.full_like(I2, dt))
    w, h = (T - ambient for T in start)
    found = np.empty((len(I2), 2))
    for k, ww in enumerate(span.ww):
        slope_w = ww * w + span.wh * h + constant[0][k]
        slope_h = span.hw * w + span.hh * h + constant[1][k]
        pull_w = span.ww_fast[k] * slope_w + span.wh * slope_h
        pull_h = span.hw * slope_w + span.hh_fast[k] * slope_h
        w += weight.slope[k] * slope_w + weight.pull[k] * pull_w
        h += weight.slope[k] * slope_h + weight.pull[k] * pull_h
        found[k] = w, h
    return found + ambient


def chain(model: Thermal, R_25: float, ambient: float, dt: float, I2: Array, start: Array) -> Array:
    """Any number of bodies after each span: shape (spans, bodies) [K]. Heat of a span by its start's resistance."""
    from scipy.linalg import expm

    n, flow = len(model.C), 1.0 / np.append(model.R_th, NO_COOLING)
    rates = np.zeros((n + 1, n + 1))
    for k in range(n):
        rates[k, k] -= flow[k]
        if k + 1 < n:
            rates[k, k + 1] += flow[k]
            rates[k + 1, [k, k + 1]] += [flow[k], -flow[k]]
    rates[0, n] = 1.0
    rates[:n] /= model.C[:, None]
    step = expm(rates * dt)[:n]
    rises, found = start - ambient, np.empty((len(I2), n))
    for k, square in enumerate(I2):
        heat = R_25 * square * (1.0 + COPPER * (rises[0] + ambient - DATA_TEMPERATURE))
        rises = step[:, :n] @ rises + step[:, n] * heat
        found[k] = rises
    return found + ambient


def sensed(model: Thermal, winding: Array, dt: float, start: float) -> Array:
    """What a sensor shows that follows the winding with a lag."""
    if not model.lag > 0.0:
        return winding
    keep, shown, found = np.exp(-dt / model.lag), start, np.empty_like(winding)
    for k, T in enumerate(winding):
        shown = keep * shown + (1.0 - keep) * T
        found[k] = shown
    return found


def followed(model: Thermal, R_25: float, ambient: float, dt: float, I2: Array, start: Array) -> tuple[Array, Array]:
    """What the winding's sensor and the housing's show, after each span [K]."""
    if len(model.C) == 2:
        C_w, C_h = model.C
        motor = TwoBodies(R_25=R_25, R_th1=model.R_th[0], R_th2=NO_COOLING, tau_w=C_w * model.R_th[0],
                          tau_h=C_h * NO_COOLING)  # fmt: skip
        bodies = two_body_course(motor, ambient, dt, I2, (start[0], start[1]))
    else:
        bodies = chain(model, R_25, ambient, dt, I2, start)
    return sensed(model, bodies[:, 0], dt, start[0]), bodies[:, -1]


def fit_thermal(
    first: Thermal, R_25: float, dt: float, I2: Array, hold: NDArray[np.intp], winding: Array, housing: Array
) -> Thermal:
    """The bodies that follow a record best; lag and shares only where the first guess has them.

    Parameters
    ----------
    first
        The first guess.
    R_25
        Resistance at 25 degC [ohm].
    dt
        Length of a span [s].
    I2
        Mean square current of each span [A^2].
    hold
        Which hold of the rotor each span belongs to.
    winding, housing
        Shown after each span [K]. The housing's sensor, the quieter one, counts three times.
    """
    from scipy.optimize import least_squares

    n, lagging = len(first.C), first.lag > 0.0

    def model(z: Array) -> Thermal:
        x = np.exp(z)
        return Thermal(x[:n], x[n : 2 * n - 1], float(x[2 * n - 1]) if lagging else 0.0,
                       tuple(x[2 * n - 1 + lagging :].tolist()))  # fmt: skip

    def errors(z: Array) -> Array:
        found = model(z)
        share = np.array([1.0, *found.shares])[hold] if found.shares else 1.0
        start = np.full(n, winding[0])
        shown = followed(found, R_25, float(housing[0]), dt, I2 * share, start)
        return np.concatenate([shown[0] - winding, 3.0 * (shown[1] - housing)])

    guess = np.log(np.concatenate([first.C, first.R_th, [first.lag] if lagging else [], first.shares]))
    return model(least_squares(errors, guess, bounds=(guess - 4.0, guess + 4.0), max_nfev=80).x)


def settled_start(model: Thermal, R_25: float, dt: float, I2: Array, winding: Array) -> Array:
    """Temperatures at the start of a record that begins without current: of the winding, and one of all else [K]."""
    from scipy.optimize import least_squares

    def start(z: Array) -> Array:
        return np.concatenate([z[:1], np.full(len(model.C) - 1, z[1])])

    def errors(z: Array) -> Array:
        return followed(model, R_25, DATA_TEMPERATURE, dt, I2, start(z))[0] - winding

    return start(least_squares(errors, [winding.mean(), winding.mean() - 1.0]).x)
