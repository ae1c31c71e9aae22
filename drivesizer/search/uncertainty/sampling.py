"""Quasi-random samples of uncertain figures, scrambled Sobol points, and sensitivities that follow from them."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, partial
from importlib import metadata
from typing import NamedTuple

import numpy as np

from drivesizer.catalog.tolerances import CUT, deviations_at
from drivesizer.files.cache import cached_bytes, digest_of, folder, keep
from drivesizer.physics.figures import Array, Mask, Whole
from drivesizer.search.uncertainty.uncertain_figures import Assumption

# -- Scrambled Sobol points, and normal deviations at them, kept in the cache folder once they are made.
#
# SciPy's statistics take about as long to load as a whole sizing takes, and the same points are needed repeatedly.


_PLACES = 64  # files at most, and as many of few points; a new one takes the place of another
_LARGEST = 2_000_000  # bytes of points that are kept
_FEW = 16  # points that are no sample


def sobol(figures: int, power: int, seeds: Sequence[Sequence[int]]) -> Array:
    """Points of the cube from 0 to 1: for each seed as many as a power of two, one seed after the other."""
    name = "sobol" if len(seeds) > 1 else "sobol_of_one"  # of a fit: in no sample's place, which would be drawn anew
    return _cached(
        name, repr((figures, power, [*map(tuple, seeds)])).encode(), partial(_sobol_points, figures, power, seeds)
    )


def _sobol_points(figures: int, power: int, seeds: Sequence[Sequence[int]]) -> Array:
    from scipy.stats import qmc

    points = [qmc.Sobol(figures, scramble=True, rng=np.random.default_rng(seed)).random_base2(power) for seed in seeds]
    return np.concatenate(points)


def normal_deviations(share: Array) -> Array:
    """Normal deviations at points (``distributions.deviations_at``), kept too: to load SciPy takes longer."""
    name = "deviations" if len(share) > _FEW else "deviations_of_few"
    return _cached(name, repr((share.shape, CUT)).encode() + share.tobytes(), partial(deviations_at, share))


def _cached(name: str, of: bytes, make: Callable[[], Array]) -> Array:
    """Points made of some input, out of the cache folder where this SciPy made them before."""
    digest = digest_of(_scipy(), of)
    path = folder() / f"{name}{int(digest[:4], 16) % _PLACES}-{digest}.npy"
    body = cached_bytes(path)
    if body is not None:
        return np.load(io.BytesIO(body), allow_pickle=False)
    points = make()
    if points.nbytes <= _LARGEST:
        buffer = io.BytesIO()
        np.save(buffer, points)
        with suppress(OSError):  # a folder without write access was reported when the catalogue was not kept
            keep(path, buffer.getvalue())
    return points


@cache
def _scipy() -> bytes:
    """Its version, which takes longer to look up than the points."""
    return metadata.version("scipy").encode()


# -- Quasi-random samples of all uncertain figures, in replicates that give the error of sampling.
#
# A scrambled Sobol sequence fills the cube of all assumptions more evenly than chance; it is scrambled anew for each
# of 8 replicates. The spread of the replicates is the error of sampling (Owen 1998; Lemieux, *Monte Carlo and
# Quasi-Monte Carlo Sampling*, 2009, section 6.2).


REPLICATES = 8
_STUDENT = 2.3646242510102993  # of 95 % to both sides, with as many replicates less one


class Share(NamedTuple):
    """A share of all machines, and how far it may be off by sampling: 95 % to both sides."""

    value: float
    error: float


def sample(
    assumptions: Sequence[Assumption], samples: int, seed: int, all_assumptions: Sequence[Assumption] = ()
) -> Array:
    """Values of assumptions, a row a machine, replicate after replicate: the same seed, the same samples."""
    columns = [assumption.column for assumption in all_assumptions or assumptions]
    count = -(-samples // REPLICATES)
    power = max(int(np.ceil(np.log2(count))), 0)
    points = sobol(max(len(columns), 1), power, [(seed, number) for number in range(REPLICATES)])
    rows = first_of_each(count * REPLICATES, len(points))
    return values_of(assumptions, points[rows][:, [columns.index(assumption.column) for assumption in assumptions]])


def first_of_each(samples: int, size: int) -> Whole:
    """Rows of the first samples of every replicate."""
    rows = np.arange(REPLICATES)[:, None] * (size // REPLICATES) + np.arange(samples // REPLICATES)
    return rows.reshape(-1)


def values_of(assumptions: Sequence[Assumption], cube: Array) -> Array:
    """Values of assumptions at points of the cube."""
    normal = [k for k, assumption in enumerate(assumptions) if assumption.distribution.by_deviations]
    deviations = dict(zip(normal, normal_deviations(cube[:, normal]).T, strict=True)) if normal else {}
    values = [assumption.distribution.at(cube[:, k], deviations.get(k)) for k, assumption in enumerate(assumptions)]
    return np.stack(values, axis=1) if values else np.zeros((len(cube), 0))


def mean_and_error(hits: Mask) -> Share:
    r"""The share of samples that are hits, and its error.

    .. math:: \pm t_{0.975, R-1} \sqrt{\frac{1}{R (R-1)} \sum_r (p_r - p)^2}

    Where all samples agree the replicates give no error; then 3/n, since so many samples miss a rarer event with
    a probability of 5 % (the rule of three).
    """
    shares = hits.reshape(REPLICATES, -1).mean(axis=1)
    error = _STUDENT * float(np.std(shares, ddof=1)) / np.sqrt(REPLICATES)
    return Share(float(hits.mean()), max(float(error), 3.0 / len(hits) if hits.all() or not hits.any() else 0.0))


# -- Sensitivity to assumptions: first-order Sobol indices and rank correlations, from given samples.
#
# The first-order index of an input is the share of the output's variance that it makes alone,
#
# .. math:: S_k = \mathrm{Var}(E[y | x_k]) / \mathrm{Var}(y)
#
# Sorted by the input, the output's conditional mean is approximated by its lowest cosines (Plischke 2010, there with
# sines and cosines). The share of noise alone in so many cosines is subtracted (Tissot and Prieur 2012).
#
# References ---------- .. [1] E. Plischke, "An effective algorithm for computing global sensitivity indices (EASI)",
# Reliability Engineering & System Safety 95, 2010, 354-360. .. [2] J.-Y. Tissot, C. Prieur, "Bias correction for the
# estimation of sensitivity indices based on random balance designs", Reliability Engineering & System Safety 107,
# 2012, 205-213.


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
    return np.clip((share - noise) / (1.0 - noise), 0.0, 1.0)


def rank_correlations(inputs: Array, output: Array) -> Array:
    """Spearman's rank correlation of each input with the output [1]; 0 where the output does not vary."""
    y = _ranks(output[:, None])[:, 0]
    x = _ranks(inputs)
    size = np.sqrt((x * x).sum(axis=0) * (y @ y))
    return np.where(size > 0.0, (y @ x) / np.where(size > 0.0, size, 1.0), 0.0)


def _ranks(columns: Array) -> Array:
    """Ranks less their mean; equal values share one."""
    ranks = np.empty_like(columns)
    for k, column in enumerate(columns.T):
        _, where, many = np.unique(column, return_inverse=True, return_counts=True)
        last = np.cumsum(many)
        ranks[:, k] = (last - (many - 1) / 2.0)[where]
    ranks -= ranks.mean(axis=0)
    return ranks
