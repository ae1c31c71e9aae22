r"""Distributions of an uncertain figure, evaluated as columns.

All distributions are bounded. A normal one is truncated 4 standard deviations from its mean, beyond which 6 of
100 000 values would lie: a tolerance does not include them, and a mass could be negative there.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["CUT", "END", "Distribution", "deviations_at", "lognormal"]

Array = NDArray[np.float64]
CUT = 4.0  # standard deviations from the mean, at which a normal distribution ends
END = 1.6448536269514722  # standard deviations from the median to the 5th and to the 95th percentile
_TAIL = 3.167124183311986e-05  # of a standard normal distribution, below -CUT


def lognormal(low: Any, median: Any, high: Any, deviations: Array) -> Array:
    """Values of a log-normal figure whose sides have deviations of their own.

    Examples
    --------
    >>> lognormal(0.5, 1.0, 4.0, np.array([-1.6448536269514722, 0.0, 1.6448536269514722])).round(9)
    array([0.5, 1. , 4. ])
    >>> lognormal(0.5, 1.0, np.inf, np.array([1.6448536269514722])).round(9)
    array([2.])
    """
    up, down = np.divide(high, median), np.divide(median, low)
    up, down = np.where(np.isinf(high), down, up), np.where(np.isinf(low), up, down)
    return np.asarray(median * np.where(deviations > 0.0, up, down) ** (deviations / END))


def deviations_at(share: Array) -> Array:
    """Standard deviations from the mean below which given shares of a normal figure's values lie, cut at ``CUT``.

    Examples
    --------
    >>> deviations_at(np.array([0.0, 0.5, 1.0])).round(9) + 0.0
    array([-4.,  0.,  4.])
    """
    from scipy.special import ndtri

    found: Array = ndtri(np.clip(_TAIL + share * (1.0 - 2.0 * _TAIL), _TAIL, 1.0 - _TAIL))
    return found


class Distribution(NamedTuple):
    """A figure's values: uniform between ends, triangular with a peak, or normal with its mean and deviation.

    A log-normal one has its ends as 5th and 95th percentile and its peak as median; either side has its own deviation.
    """

    shape: Literal["uniform", "normal", "triangular", "lognormal"]
    low: float
    high: float
    peak: float  # of the density; the middle of a uniform one

    @property
    def deviation(self) -> float:
        """Standard deviation; of a normal one before it is cut off."""
        a, b, c = self.low, self.high, self.peak
        if self.shape == "normal":
            return (b - a) / (2 * CUT)
        if self.shape == "lognormal":
            return float((b - a) / (2 * END))  # of narrow ones
        if self.shape == "uniform":
            return float((b - a) / np.sqrt(12.0))
        return float(np.sqrt((a * a + b * b + c * c - a * b - a * c - b * c) / 18.0))

    @property
    def by_deviations(self) -> bool:
        """Whether its values come of standard deviations."""
        return self.shape in ("normal", "lognormal")

    def at(self, share: Array, deviations: Array | None = None) -> Array:
        """The values below which given shares of all values lie: the inverse of the distribution function.

        Examples
        --------
        >>> Distribution("triangular", 0.0, 4.0, 1.0).at(np.array([0.0, 0.25, 1.0]))
        array([0., 1., 4.])
        """
        a, b, c = self.low, self.high, self.peak
        if self.shape == "uniform":
            return a + share * (b - a)
        if self.by_deviations:
            deviations = deviations_at(share) if deviations is None else deviations
            if self.shape == "lognormal":
                return lognormal(a, c, b, deviations)
            return np.clip(c + (b - a) / (2 * CUT) * deviations, a, b)
        rising = share * (b - a) * (c - a)
        falling = (1.0 - share) * (b - a) * (b - c)
        return np.where(share * (b - a) < c - a, a + np.sqrt(rising), b - np.sqrt(falling))
