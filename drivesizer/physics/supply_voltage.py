"""Voltages of a supply: what a controller can apply to its motor at the lowest, and the rise by returned energy.

Symbols: V voltage [V], C capacitance [F], I current [A].
"""

from __future__ import annotations

from math import nan
from typing import Any

import numpy as np

__all__ = ["bus_voltage", "least_capacitance", "usable_in", "usable_voltage"]

_FASTEST_CHOPPING = 100e3  # Hz, of controllers for small motors: assumed
_RIPPLE = 0.1  # of the supply's voltage, at most: assumed


def usable_voltage(lowest: float, max_duty: Any, voltage_drop: Any) -> Any:
    """Voltage that a controller can apply at the lowest supply voltage [V]: duty times supply less its voltage drop.

    Parameters
    ----------
    lowest
        Lowest supply voltage [V].
    max_duty
        Largest duty cycle of the controller [1].
    voltage_drop
        Of its power stage [V].

    Returns
    -------
    float or array
        Voltage [V].

    Examples
    --------
    >>> round(float(usable_voltage(24.0, 0.9, 1.0)), 1)
    20.7
    """
    return np.maximum(max_duty * (lowest - voltage_drop), 0.0)


def usable_in(lowest: float, controller: Any) -> float:
    """Voltage that a drive's controller can apply at the lowest supply voltage [V]; NaN without a controller.

    Parameters
    ----------
    lowest
        Lowest supply voltage [V].
    controller
        The drive's controller, or None.

    Returns
    -------
    float
        Voltage [V].
    """
    if controller is None:
        return nan
    return float(usable_voltage(lowest, controller.max_duty, controller.voltage_drop))


def bus_voltage(highest: Any, stored: Any, capacitance: Any) -> Any:
    r"""Voltage of the bus after returned energy is stored in its capacitance, :math:`\sqrt{V^2 + 2 E / C}`.

    Parameters
    ----------
    highest
        Voltage before, the supply's highest [V].
    stored
        Energy that stays on the bus [J].
    capacitance
        Of the bus [F].

    Returns
    -------
    float or array
        Voltage [V].

    Examples
    --------
    >>> round(float(bus_voltage(24.0, 1.0, 0.01)), 3)
    27.857
    """
    return np.sqrt(highest**2 + 2.0 * stored / capacitance)


def least_capacitance(current: Any, voltage: Any) -> Any:
    r"""Least capacitance of a power stage's own bus capacitor [F].

    .. math:: C \ge I D (1 - D) / (f s V) = I / (4 f s V) \text{ at half duty}

    Parameters
    ----------
    current
        Continuous current that the stage chops, I [A].
    voltage
        Of the supply, V [V].

    Returns
    -------
    float or array
        Capacitance [F].

    Notes
    -----
    A stage holds the ripple within a share s at a chopping frequency f. That no stage chops faster than 100 kHz with
    more ripple than a tenth is an assumption.

    References
    ----------
    .. [1] STMicroelectronics, data sheet A6902D, equation (14), without the capacitor's resistance.
    """
    return current / (4.0 * _FASTEST_CHOPPING * _RIPPLE * voltage)
