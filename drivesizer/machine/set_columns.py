"""A part as columns of one row, for what is written for all candidates."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import one_row
from drivesizer.physics.motor_demand import Coefficients, coefficients
from drivesizer.physics.stress import housing_loss

__all__ = ["own_coefficients", "own_losses"]


@lru_cache(maxsize=256)
def own_coefficients(acts: tuple[bool, ...], motor: Any, gearhead: Any, encoder: Any, braking: float) -> Coefficients:
    """Coefficients of a drive's demands, which hang on it alone: of drives of late as they were.

    Parameters
    ----------
    acts
        Which of the six functions of the cycle are ever not 0.
    motor, gearhead, encoder
        Parts out of a catalogue.
    braking
        Inertia of a brake as the motor's shaft feels it [kg*m^2].

    Returns
    -------
    Coefficients
        Of one row, not to be changed.
    """
    found = coefficients(np.array(acts), one_row(motor), one_row(gearhead), one_row(encoder), np.float64(braking))
    for column in found:
        column.flags.writeable = False
    return found


@lru_cache(maxsize=256)
def own_losses(motor: Any, ratio: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Losses of friction and iron of a motor behind a gearhead (``stress.housing_loss``): of drives of late as before.

    Parameters
    ----------
    motor
        Out of a catalogue.
    ratio
        Of the gearhead.

    Returns
    -------
    tuple of arrays
        Of one row, as ``stress.housing_loss`` gives them.
    """
    return housing_loss(one_row(motor), np.array([ratio]))
