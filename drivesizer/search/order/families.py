"""Motor families among drives in order: alternatives that differ from the best, not its other windings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import smallest_margin
from drivesizer.search.columns.limits_over_time import WAVEFORM_LIMITS
from drivesizer.search.order import ranking
from drivesizer.search.order.found import Evaluated, Judge
from drivesizer.search.order.in_order import ordered_in_machine

__all__ = ["best_of_other_families", "family_firsts", "family_of", "margin_candidates"]

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
_ALIKE = 32  # drives of a family that rank alike, of which margins are computed


def family_of(catalog: Catalog, motor: NDArray[np.int64]) -> NDArray[np.int64]:
    """The motor family of drives, as a number."""

    def numbers() -> NDArray[np.int64]:
        return np.unique(catalog.motors["family"].astype(str), return_inverse=True)[1]

    found: NDArray[np.int64] = catalog.once("motor families", numbers)[motor]
    return found


def family_firsts(family: NDArray[np.int64]) -> NDArray[np.int64]:
    """Places of the first drive of each family, rising.

    >>> first_of_each(np.array([7, 2, 7, 7, 0, 2])).tolist()
    [0, 1, 4]
    """
    return np.sort(np.unique(family, return_index=True)[1])


def margin_candidates(catalog: Catalog, sets: Candidates, order: Rows, first: int, wanted: int, rank: Array) -> Rows:
    """Drives of which ``best_of_other_families`` needs margins, as far as the order of the first leaves that open."""
    family = family_of(catalog, sets.motor[order])
    leaders = family_firsts(family)
    beyond = leaders[np.count_nonzero(leaders < first) :]
    few = beyond[: max(wanted + 1 - (len(leaders) - len(beyond)), 0)] if first else beyond[:0]
    return np.concatenate([order[:0], *(_alike(order, family, place, rank) for place in few.tolist())])


def _alike(order: Rows, family: NDArray[np.int64], place: int, rank: Array) -> Rows:
    """The drives of the family of one in order that rank as it does, the first of them."""
    same = (family == family[place]) & (rank[:, order] == rank[:, order[[place]]]).all(axis=0)
    found: Rows = order[same][:_ALIKE]
    return found


def best_of_other_families(
    judge: Judge | None,
    catalog: Catalog,
    sets: Candidates,
    evaluated: Evaluated,
    order: Rows,
    best: Rows,
    wanted: int,
    rank: Array,
    bounded: Evaluated | None = None,
) -> Rows:
    """The best drive of each other motor family than that of the best; of those that rank alike the largest margin."""
    if not wanted or not len(best):
        return best[:0]
    family, own = family_of(catalog, sets.motor[order]), family_of(catalog, sets.motor[best])[0]
    others = family != own
    order, family = order[others], family[others]
    found = ordered_in_machine(judge, sets, evaluated, order[family_firsts(family)], wanted).best[:wanted]
    for n, row in enumerate(found):
        alike = _alike(order, family, int(np.flatnonzero(order == row)[0]), rank)
        if judge or not bounded:  # the machine may reject some of them
            margin = ranking.rounded(smallest_margin(evaluated(alike).checks))
        else:
            margin = _widest(alike, evaluated, bounded)
        found[n] = ordered_in_machine(judge, sets, evaluated, alike[np.argsort(-margin, kind="stable")], 1).best[0]
    return found


def _widest(alike: Rows, evaluated: Evaluated, bounded: Evaluated) -> Array:
    """The smallest margin of each drive, as it is rounded; of those that cannot have the largest minus infinity.

    No more waveforms are computed than decide which drive has the largest.
    """
    if len(alike) == 1:
        return np.zeros(1)
    no_waveform = [check for check in bounded(alike).checks if check.name not in WAVEFORM_LIMITS]
    most, found = ranking.rounded(smallest_margin(no_waveform)), np.full(len(alike), -np.inf)
    for row in np.argsort(-most, kind="stable").tolist():
        if most[row] >= found.max():
            found[[row]] = ranking.rounded(smallest_margin(evaluated(alike[[row]]).checks))
    return found
