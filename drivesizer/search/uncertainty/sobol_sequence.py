"""Scrambled Sobol points, kept in the cache folder once they are drawn.

SciPy's statistics take about as long to load as a whole sizing takes, and the same points are needed repeatedly.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from contextlib import suppress
from importlib import metadata

import numpy as np
from numpy.typing import NDArray

from drivesizer.files.cache import digest_of, folder, keep, kept

__all__ = ["sobol"]

_PLACES = 64  # files at most, and as many of few points; a new one takes the place of another
_LARGEST = 2_000_000  # bytes of points that are kept


def sobol(figures: int, power: int, seeds: Sequence[Sequence[int]]) -> NDArray[np.float64]:
    """Points of the cube from 0 to 1: for each seed as many as a power of two, one seed after the other.

    Parameters
    ----------
    figures
        Dimensions of the cube.
    power
        Of two.
    seeds
        Of the scrambling.

    Returns
    -------
    array
        Points, shape (seeds times 2 to the power, figures).
    """
    digest = digest_of(metadata.version("scipy").encode(), repr((figures, power, [*map(tuple, seeds)])).encode())
    kind = "sobol" if len(seeds) > 1 else "sobol_of_one"  # of a fit: in no sample's place, which would be drawn anew
    path = folder() / f"{kind}{int(digest[:4], 16) % _PLACES}-{digest}.npy"
    body = kept(path)
    if body is not None:
        found: NDArray[np.float64] = np.load(io.BytesIO(body), allow_pickle=False)
        return found
    from scipy.stats import qmc

    drawn = [qmc.Sobol(figures, scramble=True, rng=np.random.default_rng(seed)).random_base2(power) for seed in seeds]
    found = np.concatenate(drawn)
    if found.nbytes <= _LARGEST:
        buffer = io.BytesIO()
        np.save(buffer, found)
        with suppress(OSError):  # a folder without write access was reported when the catalogue was not kept
            keep(path, buffer.getvalue())
    return found
