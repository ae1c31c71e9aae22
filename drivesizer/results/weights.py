"""Drives by weights: each figure as a multiple of the best one, and the weighted mean of these multiples.

.. math:: s = \\frac{\\sum_k w_k \\, x_k / x_{k,best}}{\\sum_k w_k}

Every :math:`x_k` is a figure of which less is better, :math:`x_{k,best}` the least of all drives; of a margin m it is
the share of its limit that is used, :math:`1 / (1 + m)`. So the score is 1 for a drive that is the best in all that
counts, 1.1 for one that is a tenth worse on the average, and the same in any units. An energy may be zero or negative,
where a drive regenerates; then there is no multiple, and :math:`1 + (x - x_{best}) / \\max |x|` is in its place. The
page has the same rule in ``output/report/html/weights.js``.

References
----------
.. [1] R. T. Marler, J. S. Arora, *Survey of multi-objective optimization methods for engineering*, Structural and
   Multidisciplinary Optimization 26 (2004), pp. 369-395: weighted sum, objectives made comparable by their best values.
.. [2] C.-L. Hwang, K. Yoon, *Multiple Attribute Decision Making*, Springer 1981: simple additive weighting.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.drive_set import DriveParts

__all__ = ["CRITERIA", "Choice", "Choices", "Scored", "multiples", "used_share", "weighted_order"]

Array = NDArray[np.float64]
CRITERIA = ("mass", "price", "energy", "margin")  # objectives that drives are compared by, whatever ranks them
_EQUAL = 1e9  # scores are equal that agree in so many parts of 1
_LEAST = 1e-9  # limit over demand


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A drive that passes, with the figures that it can be chosen by."""

    parts: DriveParts
    figures: dict[str, float]  # by the name of the objective, SI; NaN unknown


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """Drives out of those that pass, among which are those that weights may make the best."""

    drives: tuple[Choice, ...]  # the larger smallest margin first
    first: int  # which of them is the best by the spec's objective
    weights: dict[str, float]  # of the spec's objective
    passing: int  # drives that they were picked from, as certain as the best; in a machine not all of them were checked
    judged: bool  # whether these were checked in their machine as well
    whole: bool  # whether the best of all of those by any weights is among these


class Scored(NamedTuple):
    """Drives in the order of their scores."""

    order: NDArray[np.int64]  # rows, the best first
    score: Array  # of each row; over the figures that are known, NaN where none is
    lacking: NDArray[np.int64]  # figures of each row that count and are unknown


def used_share(margin: Any) -> Any:
    """Share of its limit that a demand uses, by its margin.

    >>> float(used_share(0.25))
    0.8
    """
    return 1.0 / np.maximum(1.0 + margin, _LEAST)


def multiples(values: Array, known: NDArray[np.bool_]) -> Array:
    """A figure of several drives as multiples of the least one: 1 is the best, 1.1 a tenth worse.

    Examples
    --------
    >>> multiples(np.array([200.0, 250.0]), np.array([True, True]))
    array([1.  , 1.25])
    >>> multiples(np.array([-4.0, 1.0]), np.array([True, True]))
    array([1.  , 2.25])
    """
    if not known.any():
        return np.ones_like(values)
    least, most = values[known].min(), np.abs(values[known]).max()
    found: Array = values / least if least > 0.0 else 1.0 + (values - least) / (most or 1.0)
    return found


def weighted_order(figures: Mapping[str, Array], weights: Mapping[str, float]) -> Scored:
    """The order of drives by several figures with weights."""
    count = len(next(iter(figures.values()), ()))
    total, share, lacking = np.zeros(count), np.zeros(count), np.zeros(count, np.int64)
    for name, values in figures.items():
        weight, known = weights.get(name, 0.0), ~np.isnan(values)
        if weight > 0.0:
            total += np.where(known, weight * multiples(values, known), 0.0)
            share += np.where(known, weight, 0.0)
            lacking += ~known
    with np.errstate(invalid="ignore"):
        score = total / share  # NaN where nothing is known
    rank = np.floor(np.where(np.isnan(score), np.inf, score) * _EQUAL + 0.5)
    return Scored(np.lexsort((rank, lacking)).astype(np.int64), score, lacking)
