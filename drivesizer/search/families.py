"""Motor families among drives in order: alternatives that differ from the best, not its other windings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog

__all__ = ["family_of", "first_of_each"]


def family_of(catalog: Catalog, motor: NDArray[np.int64]) -> NDArray[np.int64]:
    """The motor family of drives, as a number.

    Parameters
    ----------
    catalog
        The catalogue of the motors.
    motor
        Rows of the motors, shape (drives,).

    Returns
    -------
    ndarray
        Equal for motors of one family, shape (drives,).
    """
    _, number = np.unique(catalog.motors["family"].astype(str), return_inverse=True)
    found: NDArray[np.int64] = number[motor]
    return found


def first_of_each(family: NDArray[np.int64]) -> NDArray[np.int64]:
    """Places of the first drive of each family, rising.

    >>> first_of_each(np.array([7, 2, 7, 7, 0, 2])).tolist()
    [0, 1, 4]
    """
    return np.sort(np.unique(family, return_index=True)[1])
