"""Quasi-random samples of all uncertain figures, in replicates that give the error of sampling.

A scrambled Sobol sequence fills the cube of all assumptions more evenly than chance; it is scrambled anew for each
of 8 replicates. The spread of the replicates is the error of sampling (Owen 1998; Lemieux, *Monte Carlo and
Quasi-Monte Carlo Sampling*, 2009, section 6.2).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.search.uncertainty.sobol_sequence import normal_deviations, sobol
from drivesizer.search.uncertainty.uncertain_figures import Assumption

__all__ = ["REPLICATES", "Sample", "Share", "first_of_each", "mean_and_error", "sample", "values_of"]

Array = NDArray[np.float64]
REPLICATES = 8
_STUDENT = 2.3646242510102993  # of 95 % to both sides, with as many replicates less one


class Sample(NamedTuple):
    """Values of all assumptions: one row a machine, replicate after replicate."""

    cube: Array  # (samples, assumptions), 0 to 1
    values: Array  # (samples, assumptions), SI; of a catalogue figure its factor

    @property
    def size(self) -> int:
        """Number of samples."""
        return len(self.values)


class Share(NamedTuple):
    """A share of all machines, and how far it may be off by sampling: 95 % to both sides."""

    value: float
    error: float


def sample(given: Sequence[Assumption], samples: int, seed: int, drawn: Sequence[Assumption] = ()) -> Sample:
    """Samples of assumptions: the same seed, the same samples."""
    columns = [one.column for one in drawn or given]
    each = -(-samples // REPLICATES)
    power = max(int(np.ceil(np.log2(each))), 0)
    points = sobol(max(len(columns), 1), power, [(seed, number) for number in range(REPLICATES)])
    rows = first_of_each(each * REPLICATES, len(points))
    cube = points[rows][:, [columns.index(one.column) for one in given]]
    return Sample(cube, values_of(given, cube))


def first_of_each(samples: int, size: int) -> NDArray[np.int64]:
    """Rows of the first samples of every replicate."""
    each = np.arange(REPLICATES)[:, None] * (size // REPLICATES) + np.arange(samples // REPLICATES)
    return each.reshape(-1)


def values_of(given: Sequence[Assumption], cube: Array) -> Array:
    """Values of assumptions at points of the cube."""
    normal = [k for k, one in enumerate(given) if one.distribution.by_deviations]
    deviations = dict(zip(normal, normal_deviations(cube[:, normal]).T, strict=True)) if normal else {}
    values = [one.distribution.at(cube[:, k], deviations.get(k)) for k, one in enumerate(given)]
    return np.stack(values, axis=1) if values else np.zeros((len(cube), 0))


def mean_and_error(hits: NDArray[np.bool_]) -> Share:
    r"""The share of samples that are hits, and its error.

    .. math:: \pm t_{0.975, R-1} \sqrt{\frac{1}{R (R-1)} \sum_r (p_r - p)^2}

    Where all samples agree the replicates give no error; then 3/n, since so many samples miss a rarer event with
    a probability of 5 % (the rule of three).
    """
    each = hits.reshape(REPLICATES, -1).mean(axis=1)
    error = _STUDENT * float(np.std(each, ddof=1)) / np.sqrt(REPLICATES)
    return Share(float(hits.mean()), max(float(error), 3.0 / len(hits) if hits.all() or not hits.any() else 0.0))
