r"""Sensitivity to assumptions: first-order Sobol indices and rank correlations, from given samples.

The first-order index of an input is the share of the output's variance that it makes alone,

.. math:: S_k = \mathrm{Var}(E[y | x_k]) / \mathrm{Var}(y)

Sorted by the input, the output's conditional mean is approximated by its lowest cosines (Plischke 2010, there with
sines and cosines). The share of noise alone in so many cosines is subtracted (Tissot and Prieur 2012).

References
----------
.. [1] E. Plischke, "An effective algorithm for computing global sensitivity indices (EASI)", Reliability Engineering &
   System Safety 95, 2010, 354-360.
.. [2] J.-Y. Tissot, C. Prieur, "Bias correction for the estimation of sensitivity indices based on random balance
   designs", Reliability Engineering & System Safety 107, 2012, 205-213.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["first_order", "rank_correlations"]

Array = NDArray[np.float64]
_COSINES = 8


def first_order(inputs: Array, output: Array) -> Array:
    """First-order Sobol indices of each input [1]; 0 where the output does not vary.

    Examples
    --------
    >>> from scipy.stats import qmc
    >>> x = qmc.Sobol(2, rng=np.random.default_rng(1)).random(4096)
    >>> first_order(x, 3 * x[:, 0] + 4 * x[:, 1]).round(3)
    array([0.36, 0.64])
    """
    count = len(output)
    centred = output - output.mean()
    total = float(centred @ centred)
    if not total > 0.0 or count <= 2 * _COSINES:
        return np.zeros(inputs.shape[1])
    angle = np.pi * (np.arange(count) + 0.5) / count
    cosines = np.cos(np.outer(np.arange(1, _COSINES + 1), angle)) * np.sqrt(2.0 / count)
    order = np.argsort(inputs, axis=0, kind="stable")
    share = np.square(cosines @ centred[order]).sum(axis=0) / total
    noise = _COSINES / (count - 1)
    found: Array = np.clip((share - noise) / (1.0 - noise), 0.0, 1.0)
    return found


def rank_correlations(inputs: Array, output: Array) -> Array:
    """Spearman's rank correlation of each input with the output [1]; 0 where the output does not vary."""
    y = _ranks(output[:, None])[:, 0]
    x = _ranks(inputs)
    size = np.sqrt((x * x).sum(axis=0) * (y @ y))
    return np.where(size > 0.0, (y @ x) / np.where(size > 0.0, size, 1.0), 0.0)


def _ranks(columns: Array) -> Array:
    """Ranks less their mean; equal values share one."""
    found = np.empty_like(columns)
    for k, column in enumerate(columns.T):
        _, where, many = np.unique(column, return_inverse=True, return_counts=True)
        last = np.cumsum(many)
        found[:, k] = (last - (many - 1) / 2.0)[where]
    found -= found.mean(axis=0)
    return found
