r"""Pull-out torque of two-phase stepper motors over speed: by the ideal model, and of printed curves.

Symbols: p rotor teeth, a quarter of the full steps of a turn; I rated current of a phase, with which in both phases the
holding torque T_h is printed; k torque of a phase per ampere; w speed [rad/s]; V supply voltage of a chopper driver.

A phase's torque is sinusoidal, so that with I in both, 45 degrees apart from either,

.. math:: k = \frac{T_h}{\sqrt{2}\, I}

and sinusoidal currents of the amplitude :math:`I_m = \sqrt{2}\, I`, which heat as much, have that torque too. In the
frame of the rotor, x in quadrature to its flux and y along it, the amplitude of the current is held at most at I_m by
the driver and that of the voltage at V:

.. math:: i_x^2 + i_y^2 \le I_m^2, \quad (R i_x - p w L i_y + k w)^2 + (R i_y + p w L i_x)^2 \le V^2, \quad T = k i_x

The load angle is free. The largest :math:`i_x` is the top of the intersection of two discs: of the current's, I_m; of
the voltage's, :math:`V/Z - k w R/Z^2` with :math:`Z^2 = R^2 + (p w L)^2`; or of their crossing, with
:math:`c = (V^2 - (k w)^2 - Z^2 I_m^2) / (2 k w)`

.. math:: i_x = \frac{R c + p w L \sqrt{Z^2 I_m^2 - c^2}}{Z^2}

Not here: iron loss, saturation, the rise of the resistance, resonance. Printed curves lie at 0.51 to 0.95 of it
(:data:`PULL_OUT_SHARE`).

References
----------
.. [1] P. Acarnley, *Stepping Motors: a guide to theory and practice*, 4th ed., IET, 2002, chapter 5 (pull-out torque of
   hybrid motors by phasors of the fundamental).
.. [2] T. Kenjo and A. Sugawara, *Stepping Motors and their Microprocessor Controls*, 2nd ed., Oxford, 1994.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["PULL_OUT_SHARE", "amplitude", "pull_out_torque", "rescaled_torque", "rotor_teeth"]

Array = NDArray[np.float64]

# share of the model's torque, and factor of its band either way: 7 printed curves of 5 steppers by 54 points, of which
# 5 to 95 % lie at 0.52 to 0.89; widened for a motor that is not among the five (Student's t, 4 degrees of freedom)
PULL_OUT_SHARE = (0.67, 1.5)


def rotor_teeth(full_steps: Any) -> Any:
    """Teeth of the rotor of a two-phase hybrid stepper: electrical turns per turn.

    >>> rotor_teeth(200.0)
    50.0
    """
    return full_steps / 4.0


def amplitude(phase_current: Any) -> Any:
    """Amplitude of sinusoidal phase currents that heat as the rated current in both phases does [A]."""
    return np.sqrt(2.0) * phase_current


def pull_out_torque(
    speed: Any, voltage: Any, *, holding_torque: Any, phase_current: Any, resistance: Any, inductance: Any, teeth: Any
) -> Array:
    """Largest torque at a speed on a chopper driver, by the ideal two-phase model.

    Parameters
    ----------
    speed
        Of the motor [rad/s], of either sign.
    voltage
        Of the driver's supply [V].
    holding_torque
        At rated current in both phases [N*m].
    phase_current
        Rated current of a phase [A].
    resistance, inductance
        Of a phase [ohm], [H].
    teeth
        Of the rotor.

    Returns
    -------
    array
        [N*m], 0 from where the back-EMF leaves none; shape of the arguments broadcast.

    Examples
    --------
    >>> float(pull_out_torque(0.0, 24.0, holding_torque=0.59, phase_current=2.0, resistance=1.6, inductance=3e-3,
    ...                       teeth=50.0).round(3))
    0.59
    """
    w = np.abs(np.asarray(speed, float))
    I_m = amplitude(phase_current)
    k = holding_torque / I_m
    e, X = k * w, teeth * w * inductance
    Z2 = resistance**2 + X**2
    with np.errstate(divide="ignore", invalid="ignore"):
        top = voltage / np.sqrt(Z2) - e * resistance / Z2
        of_voltage = top**2 + (e * X / Z2) ** 2 <= I_m**2
        of_current = (resistance * I_m + e) ** 2 + (X * I_m) ** 2 <= voltage**2
        c = (voltage**2 - e**2 - Z2 * I_m**2) / (2.0 * e)
        crossing = (resistance * c + X * np.sqrt(np.maximum(Z2 * I_m**2 - c**2, 0.0))) / Z2
        i_x = np.where(of_current, I_m, np.where(of_voltage, top, crossing))
    known = np.isnan(voltage + I_m + k + Z2 + 0.0 * w)
    found: Array = np.where(known, np.nan, k * np.maximum(i_x, 0.0))
    return found


def rescaled_torque(speed: Any, voltage: Any, at_speed: Array, at_torque: Array, at_voltage: Any) -> Array:
    r"""Torque of a printed curve at another supply voltage: no more at a higher one, compressed at a lower.

    .. math:: T(w, V_2) = T(w \max(1, V_1 / V_2), V_1)

    Without resistance the model's torque is a function of V/w alone. So stretched to a higher voltage, charts of two
    voltages lie up to 51 % above the printed ones (iron loss grows with speed), so none of that is counted. Compressed
    to a lower one they lie 32 % below to 10 % above, over 14 points of 6 pairs of charts.

    Parameters
    ----------
    speed
        Shape (curves, points) [rad/s].
    voltage
        Of the supply, of all or of each, shape (curves,) [V].
    at_speed, at_torque
        Points of each curve, rising in speed, shape (curves, most points); the last repeated where there are fewer.
    at_voltage
        Of each curve [V], shape (curves,).

    Returns
    -------
    array
        [N*m], shape (curves, points): the least up to that speed, for a dip is no torque to rely on; below the first
        point that of the first, above the last unknown.
    """
    w = np.abs(speed) * np.maximum(at_voltage / voltage, 1.0)[:, None]
    least = np.minimum.accumulate(at_torque, axis=1)
    found = np.repeat(least[:, :1], w.shape[1], axis=1)
    for left in range(at_speed.shape[1] - 1):
        (a, b), (low, high) = at_speed[:, left : left + 2].T[:, :, None], least[:, left : left + 2].T[:, :, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            between = low + (high - low) * (w - a) / (b - a)
        found = np.where((w > a) & (b > a), between, found)
    return np.where(w > at_speed[:, -1:] * (1.0 + 1e-9), np.nan, np.where(np.isnan(w), np.nan, found))
