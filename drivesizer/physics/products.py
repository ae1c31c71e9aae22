"""Products of matrices a part at a time, each too small to be worth threads: these would wait for one another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["product"]

Array = NDArray[np.float64]
_MULTIPLIED = 1 << 17  # products of figures at a time
_WIDEST = 2048  # columns at a time, where these are too many


def product(rows: Array, columns: Array) -> Array:
    """A matrix product of few figures each, ``rows @ columns``.

    Parameters
    ----------
    rows
        Shape (n, k).
    columns
        Shape (k, m).

    Returns
    -------
    array
        Shape (n, m).

    Examples
    --------
    >>> product(np.array([[1.0, 2.0]]), np.array([[3.0], [4.0]])).tolist()
    [[11.0]]
    """
    if rows.size * columns.shape[1] <= _MULTIPLIED:
        return rows @ columns
    found = np.empty((len(rows), columns.shape[1]))
    wide = min(columns.shape[1], _WIDEST)
    high = max(_MULTIPLIED // (columns.shape[0] * wide), 1)
    for top in range(0, len(rows), high):
        for left in range(0, columns.shape[1], wide):
            part = slice(top, top + high), slice(left, left + wide)
            np.matmul(rows[part[0]], columns[:, part[1]], out=found[part])
    return found
