r"""A DC motor at a constant voltage: operating point, step from rest, coast-down.

.. math:: V = R I + L \dot I + k_e w + X w I, \qquad J \dot w = k_t I - M - b w

All functions are elementwise: floats, or columns that broadcast against one another; NaN unknown.
Convention: everything at the motor's shaft; M is the torque that does not depend on speed: load, gear and dry friction.
Not here: heat (the winding has one temperature), and what a supply and a controller take of the voltage.
Symbols: V voltage [V], R resistance [ohm], X what commutation takes (``drive_train.commutation``) [V*s/(A*rad)],
L inductance [H], k_t torque constant [N*m/A], k_e back-EMF constant [V*s/rad], M torque [N*m], b viscous friction
[N*m*s/rad], J inertia [kg*m^2], w speed [rad/s], I current [A].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drivesizer.physics.figures import Alike, Array, Figure, Mask, bisected

_INSTANT = 1e-6  # of the mechanical time constant: an electrical one that is as good as none
_HALVINGS = 60
_SETTLED = 60.0  # time constants


class Winding(NamedTuple):
    """Electrical side of a motor: floats or columns."""

    R: Alike  # ohm, leads and supply included
    L: Alike  # H; NaN: taken as none
    k_t: Alike  # N*m/A
    k_e: Alike  # V*s/rad
    X: Alike = 0.0  # V*s/(A*rad)


def operating_point(winding: Winding, voltage: Figure, torque: Figure, viscous: Figure) -> tuple[Array, Array]:
    r"""Speed and current in the long run under a torque.

    .. math:: \frac{X b}{k_t} w^2 + \left(k_e + \frac{R b + X M}{k_t}\right) w = V - \frac{R M}{k_t},
              \qquad I = \frac{M + b w}{k_t}

    Parameters
    ----------
    winding
        R, k_t, k_e and X.
    voltage
        At the winding and its leads [V].
    torque
        Dry friction included [N*m].
    viscous
        Friction per speed [N*m*s/rad].

    Returns
    -------
    tuple of arrays
        Speed [rad/s], below 0 where the torque would turn the motor backward, and current [A].

    Examples
    --------
    >>> speed, current = operating_point(Winding(2.0, 0.0, 0.02, 0.02), 24.0, 0.02, 0.0)
    >>> float(speed), float(current)
    (1100.0, 1.0)
    """
    left = voltage - winding.R * torque / winding.k_t
    slope = winding.k_e + (winding.R * viscous + winding.X * torque) / winding.k_t
    square = winding.X * viscous / winding.k_t
    speed = 2.0 * left / (slope + np.sqrt(slope**2 + 4.0 * square * np.maximum(left, 0.0)))
    return np.asarray(speed), np.asarray((torque + viscous * speed) / winding.k_t)


def step_time(
    winding: Winding,
    voltage: Figure,
    torque: Figure,
    viscous: Figure,
    inertia: Figure,
    share: float,
    limit: Alike = np.inf,
) -> Array:
    r"""Time from rest to a share of the final speed, the voltage being switched on.

    Two poles, from :math:`s^2 + s (R/L + b/J) + (R b + k_t k_e)/(L J) = 0`; before that the current rises to what
    dry friction takes. Where the controller limits the current, inductance is neglected: constant torque up to the
    speed at which the voltage no longer gives that current, then one exponential.

    Parameters
    ----------
    winding
        R, L, k_t and k_e.
    voltage
        At the winding and its leads [V].
    torque, viscous
        Dry friction [N*m], and friction per speed [N*m*s/rad].
    inertia
        Rotor and load at the shaft [kg*m^2].
    share
        Of the final speed, below 1 [1].
    limit
        Of the current, by the controller [A].

    Returns
    -------
    array
        Time [s]; infinite where the motor does not start.

    Examples
    --------
    >>> tau = 2.0 * 1e-5 / 0.02**2  # s, R J / (k_t k_e)
    >>> float(round(step_time(Winding(2.0, 0.0, 0.02, 0.02), 24.0, 0.0, 0.0, 1e-5, 0.95)[()] / tau, 3))
    2.996
    """
    R, L, k_t, k_e, _ = winding
    final, _ = operating_point(winding, voltage, torque, viscous)
    tau = inertia * R / (R * viscous + k_t * k_e)
    limited = np.broadcast_to(limit, np.shape(final)) < voltage / R
    lag = np.maximum(np.nan_to_num(L), _INSTANT * R * tau) / R  # s, electrical time constant
    with np.errstate(divide="ignore", invalid="ignore"):
        free = _two_poles(1.0 / lag + viscous / inertia, 1.0 / (tau * lag), share)
        free = free - lag * np.log1p(-R * torque / (k_t * voltage))
        pushed = k_t * limit - torque  # N*m
        corner = np.maximum((voltage - R * limit) / k_e, 0.0)  # rad/s
        ramp = _ramp(inertia, pushed, viscous, np.minimum(corner, share * final))
        rest = tau * np.log(np.maximum((final - corner) / ((1.0 - share) * final), 1.0))
        time = np.where(limited, np.where(pushed > 0.0, ramp + rest, np.inf), free)
    starts = final > 0.0
    return np.where(starts, time, np.where(np.isnan(final), np.nan, np.inf))


def _two_poles(damping: Array, product: Array, share: float) -> Array:
    """Time at which 1 - (s_2 e^(s_1 t) - s_1 e^(s_2 t))/(s_2 - s_1) first is a share; the sum and product of -s."""
    root = np.sqrt(damping**2 - 4.0 * product + 0j)
    root = np.where(np.abs(root) < 1e-9 * damping, 1e-9 * damping, root)
    fast = -(damping + root) / 2.0
    slow = product / fast
    swings = np.abs(root.imag) > 0.0
    low = np.zeros(np.shape(damping))
    high = np.where(swings, 2.0 * np.pi / np.where(swings, np.abs(root.imag), 1.0), -_SETTLED / slow.real)

    def reached(t: Array) -> Mask:
        left = ((fast * np.exp(slow * t) - slow * np.exp(fast * t)) / (fast - slow)).real
        return np.asarray(1.0 - left >= share)

    return np.asarray(bisected(low, high, reached, _HALVINGS)[1] + 0.0 * damping)


def _ramp(inertia: Figure, torque: Figure, viscous: Figure, speed: Figure) -> Array:
    """Time to a speed by a constant torque against viscous friction: -(J/b) ln(1 - b w/M)."""
    x = np.asarray(viscous * speed / torque)
    slowed = np.where(np.abs(x) > 1e-9, -np.log1p(-x) / np.where(x == 0.0, 1.0, x), 1.0 + x / 2.0)
    return np.asarray(inertia * speed / torque * slowed)


def step_peak_current(
    winding: Winding, voltage: Figure, torque: Figure, inertia: Figure, limit: Figure = np.inf
) -> Array:
    r"""Largest current of a step from rest, viscous friction neglected.

    .. math:: \hat I = I_M + \left(\frac{V}{R} - I_M\right) 2 \zeta
              \exp\!\left(-\frac{\zeta \operatorname{arcosh} \zeta}{\sqrt{\zeta^2 - 1}}\right), \quad
              \zeta = \frac{R}{2} \sqrt{\frac{J}{L k_t k_e}}, \quad I_M = \frac{M}{k_t}

    Parameters
    ----------
    winding
        R, L, k_t and k_e.
    voltage
        At the winding and its leads [V].
    torque
        Dry friction [N*m].
    inertia
        Rotor and load at the shaft [kg*m^2].
    limit
        Of the current, by the controller [A].

    Returns
    -------
    array
        Current [A]; V/R without inductance.

    Examples
    --------
    >>> round(float(step_peak_current(Winding(2.0, 0.0, 0.02, 0.02), 24.0, 0.0, 1e-5)), 3)
    12.0
    """
    R, L, k_t, k_e, _ = winding
    tau = inertia * R / (k_t * k_e)
    L = np.maximum(np.nan_to_num(L), _INSTANT * R * tau)
    zeta = np.asarray(R / 2.0 * np.sqrt(inertia / (L * k_t * k_e)))
    zeta = np.where(np.abs(zeta - 1.0) < 1e-9, 1.0 + 1e-9, zeta)
    inner = (zeta * np.arccosh(zeta + 0j) / np.sqrt(zeta**2 - 1.0 + 0j)).real
    idle = torque / k_t
    return np.asarray(np.minimum(idle + (voltage / R - idle) * 2.0 * zeta * np.exp(-inner), limit))


def coast_down_time(inertia: Figure, torque: Figure, viscous: Figure, speed: Figure, to: Figure = 0.0) -> Array:
    r"""Time of coasting from one speed to another, the terminals open.

    .. math:: t = \frac{J}{b} \ln \frac{M + b w_0}{M + b w_1}

    Parameters
    ----------
    inertia
        Rotor and load at the shaft [kg*m^2].
    torque, viscous
        Dry friction [N*m], and friction per speed [N*m*s/rad].
    speed, to
        At the start and at the end [rad/s].

    Returns
    -------
    array
        Time [s]; infinite to standstill without dry friction.

    Examples
    --------
    >>> round(float(coast_down_time(1e-5, 1e-3, 0.0, 500.0)), 3)
    5.0
    """
    least = np.asarray(torque + viscous * to)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.asarray(viscous * (speed - to) / least)
        slowed = np.where(x > 1e-9, np.log1p(x) / np.where(x > 0.0, x, 1.0), 1.0 - x / 2.0)
        time = inertia * (speed - to) / least * slowed
    return np.where(least == 0.0, np.inf + 0.0 * np.asarray(inertia * speed), time)
