"""Voltage that a controller can apply to its motor at the lowest supply voltage."""

from __future__ import annotations

from math import nan
from typing import Any

import numpy as np

__all__ = ["most_voltage", "usable_in", "usable_voltage"]


def most_voltage(lowest: float, max_duty: Any, voltage_drop: Any, needed: Any) -> Any:
    """The usable voltage; where it is unknown, the supply's own for those that need more than that, and so fail.

    Parameters
    ----------
    lowest
        Lowest supply voltage [V].
    max_duty
        Largest duty cycle of the controller [1].
    voltage_drop
        Of its power stage [V].
    needed
        Required voltage [V].

    Returns
    -------
    array
        Voltage [V]; NaN where it is unknown and does not decide.
    """
    usable = usable_voltage(lowest, max_duty, voltage_drop)
    return np.where(np.isnan(usable) & (needed > lowest), lowest, usable)


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
