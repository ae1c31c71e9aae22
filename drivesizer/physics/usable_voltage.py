"""The voltage that a controller can give its motor at the lowest supply voltage."""

from __future__ import annotations

from math import nan
from typing import Any

import numpy as np

__all__ = ["most_voltage", "usable_in", "usable_voltage"]


def most_voltage(lowest: float, max_duty: Any, voltage_drop: Any, needed: Any) -> Any:
    """The usable voltage; where it is unknown, the supply's own for those that need more than that: a sure failure."""
    usable = usable_voltage(lowest, max_duty, voltage_drop)
    return np.where(np.isnan(usable) & (needed > lowest), lowest, usable)


def usable_voltage(lowest: float, max_duty: Any, voltage_drop: Any) -> Any:
    """What a controller can give a motor at the lowest supply voltage [V]: duty times what its stages leave.

    >>> round(float(usable_voltage(24.0, 0.9, 1.0)), 1)
    20.7
    """
    return np.maximum(max_duty * (lowest - voltage_drop), 0.0)


def usable_in(lowest: float, controller: Any) -> float:
    """What a set's controller can give its motor at the lowest supply voltage [V]; NaN where none is known."""
    if controller is None:
        return nan
    return float(usable_voltage(lowest, controller.max_duty, controller.voltage_drop))
