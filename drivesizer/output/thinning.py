"""Thinning of long records and curves that keeps their peaks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def extremes(values: NDArray[np.float64], most: int) -> NDArray[np.int64]:
    """Indices of the least and the largest value in equal bins, and of both ends; all where they are few.

    Examples
    --------
    >>> extremes(np.array([0.0, 0.0, 9.0, 0.0, -9.0, 0.0, 0.0, 1.0]), 4).tolist()
    [0, 2, 4, 7]
    """
    count = len(values)
    size = -(-count // (most // 2))
    if size <= 2:
        return np.arange(count)
    bins = np.minimum(np.arange(-(-count // size) * size), count - 1).reshape(-1, size)  # the last one filled up
    samples, pick = np.nan_to_num(values)[bins], np.arange(len(bins))
    return np.unique(np.concatenate([bins[pick, samples.argmin(1)], bins[pick, samples.argmax(1)], [0, count - 1]]))


def curve_points(columns: tuple[NDArray[np.float64], ...], most: int) -> NDArray[np.int64]:
    """Indices of points along smooth curves over one axis, evenly, with the peaks and troughs of each."""
    count = len(columns[0])
    if count <= most:
        return np.arange(count)
    share = most // (2 * len(columns)) - 2  # the ends come on top
    even = np.linspace(0, count - 1, most // 2).round().astype(np.int64)
    return np.unique(np.concatenate([even, *(extremes(column, share) for column in columns)]))
