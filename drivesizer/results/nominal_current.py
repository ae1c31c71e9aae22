"""The motor's RMS current against its nominal current, derated for the ambient temperature."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.thermal import current_derating, rated_ambient
from drivesizer.results.check_columns import CheckColumn, at_most

__all__ = ["nominal_current_limit"]

Array = NDArray[np.float64]


def nominal_current_limit(rms: Array | float, motor: Any, ambient: Array | float, needed: float = 0.0) -> CheckColumn:
    """The RMS current against the nominal one in an ambient.

    Colder than the rating, with an unknown permitted temperature, the motor withstands more by an unknown amount: up
    to the nominal current it passes, and what is above is unknown.

    Parameters
    ----------
    rms
        RMS current [A].
    motor
        Figures by field name.
    ambient
        Temperature around the motor [K].
    needed
        Margin that must be there.

    Returns
    -------
    CheckColumn
        Of the candidates; unknown where an unknown permitted temperature decides.
    """
    T_max, rated = motor["max_winding_temperature"], rated_ambient(motor)
    limit = np.asarray(motor["nominal_current"] * current_derating(ambient, T_max, rated))
    found = at_most("motor_nominal_current", rms, limit, needed=needed)
    least = np.isnan(T_max) & (ambient < np.asarray(rated)) & ~found.passed
    if not least.any():
        return found
    return at_most("motor_nominal_current", rms, np.where(least, np.nan, limit), needed=needed)
