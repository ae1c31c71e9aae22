"""Scrambled Sobol points, and normal deviations at them, kept in the cache folder once they are made.

SciPy's statistics take about as long to load as a whole sizing takes, and the same points are needed repeatedly.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache, partial
from importlib import metadata

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.tolerances.distributions import CUT, deviations_at
from drivesizer.files.cache import cached_bytes, digest_of, folder, keep

__all__ = ["normal_deviations", "sobol"]

_PLACES = 64  # files at most, and as many of few points; a new one takes the place of another
_LARGEST = 2_000_000  # bytes of points that are kept
_FEW = 16  # points that are no sample


def sobol(figures: int, power: int, seeds: Sequence[Sequence[int]]) -> NDArray[np.float64]:
    """Points of the cube from 0 to 1: for each seed as many as a power of two, one seed after the other."""
    name = "sobol" if len(seeds) > 1 else "sobol_of_one"  # of a fit: in no sample's place, which would be drawn anew
    return _kept(name, repr((figures, power, [*map(tuple, seeds)])).encode(), partial(_drawn, figures, power, seeds))


def _drawn(figures: int, power: int, seeds: Sequence[Sequence[int]]) -> NDArray[np.float64]:
    from scipy.stats import qmc

    drawn = [qmc.Sobol(figures, scramble=True, rng=np.random.default_rng(seed)).random_base2(power) for seed in seeds]
    return np.concatenate(drawn)


def normal_deviations(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normal deviations at points (``distributions.deviations_at``), kept too: to load SciPy takes longer."""
    name = "deviations" if len(share) > _FEW else "deviations_of_few"
    return _kept(name, repr((share.shape, CUT)).encode() + share.tobytes(), partial(deviations_at, share))


def _kept(name: str, of: bytes, make: Callable[[], NDArray[np.float64]]) -> NDArray[np.float64]:
    """Points made of some input, out of the cache folder where this SciPy made them before."""
    digest = digest_of(_scipy(), of)
    path = folder() / f"{name}{int(digest[:4], 16) % _PLACES}-{digest}.npy"
    body = cached_bytes(path)
    if body is not None:
        found: NDArray[np.float64] = np.load(io.BytesIO(body), allow_pickle=False)
        return found
    found = make()
    if found.nbytes <= _LARGEST:
        buffer = io.BytesIO()
        np.save(buffer, found)
        with suppress(OSError):  # a folder without write access was reported when the catalogue was not kept
            keep(path, buffer.getvalue())
    return found


@cache
def _scipy() -> bytes:
    """Its version, which takes longer to look up than the points."""
    return metadata.version("scipy").encode()
