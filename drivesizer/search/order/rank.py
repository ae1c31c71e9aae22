"""Order of drives before their margins count, and how many of them margins decide between.

Before the objective goes the certainty that a drive passes: of open ones how probable it is, of unknown ones how few
checks are undecided and how few times a known limit must be doubled for them. Margins need the waveform, so that they
are computed of as few as are equal to the last that is shown.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.order import ranking
from drivesizer.search.order.open_checks import passing
from drivesizer.search.order.ranking import Ranking
from drivesizer.search.order.sifting import OPEN, PASSES, UNKNOWN, Sifted

__all__ = ["Rank", "better_but_unknown", "equals_of_the_last", "ranked", "waveforms"]

Array = NDArray[np.float64]
_CELLS = 50_000  # drives times pieces of the load cycle, of which margins are computed to order equals
_SAMPLED = 32  # open drives at most
_HARDLY = 4  # unknown checks behind which one stands that passes in less than a tenth of its band
_TENTHS = 12  # places for tenths of a probability, and for what is not sampled


class Rank(NamedTuple):
    """Columns over drives that pass or may pass: less is better, the first one first."""

    precedence: NDArray[
        np.int64
    ]  # certainty; of open drives how probable it is that none fails, of unknown ones how few
    missing: NDArray[np.int64]  # parts of which the objective is unknown
    value: Array  # of the objective

    @property
    def columns(self) -> Array:
        """All of them, where rounding makes no difference: shape (3, drives)."""
        return np.stack([self.precedence, self.missing, ranking.rounded(self.value)])

    def order(
        self, catalog: Catalog, sets: Candidates, rows: Any = slice(None), margin: Array | None = None
    ) -> NDArray[np.int64]:
        """Some drives from best to worst, by their places among these."""
        before = [self.precedence[rows]]
        return ranking.order(catalog, sets.on(rows), self.value[rows], self.missing[rows], before=before, margin=margin)


def ranked(problem: Problem, kept: Sifted, objective: Ranking, top: int) -> Rank:
    """Columns that order the drives that pass or may pass."""
    value, missing = ranking.values(problem.catalog, kept.sets, kept.figures, objective)
    return Rank(_precedence(problem, kept, value, missing, top), missing, value)


def _precedence(
    problem: Problem, kept: Sifted, value: Array, missing: NDArray[np.int64], top: int
) -> NDArray[np.int64]:
    """Order that goes before the objective: of open ones as many are sampled as an order of those shown may need."""
    precedence = _TENTHS * kept.certainty + kept.lacking
    opened = np.flatnonzero(kept.certainty == OPEN)
    if len(opened) < 2 or np.count_nonzero(kept.certainty == PASSES) >= top:
        return precedence
    precedence[opened] += _TENTHS - 1
    count = max(min(_SAMPLED, waveforms(problem)), top)
    best = opened[ranking.order(problem.catalog, kept.sets.on(opened), value[opened], missing[opened])][:count]
    few = by_physics(problem, kept.sets.on(best), False)
    for place, row in enumerate(best.tolist()):
        one = few.candidates.on(np.array([place]))._replace(
            controller=few.controller[[place]], brake=few.brake[[place]]
        )
        together = passing(problem, one, few.open_checks(place), each=False)[""]
        tenths = int(10.0 * together)
        precedence[row] = _TENTHS * (OPEN + 1) - 1 - tenths if tenths else _TENTHS * UNKNOWN + _HARDLY
    return precedence


def equals_of_the_last(problem: Problem, rank: Rank, order: NDArray[np.int64], top: int) -> int:
    """Number of the first in order that are ordered by margin: up to the equals of the last shown, in bounds."""
    if not len(order):
        return 0
    same = rank.columns[:, order]
    last = same[:, [min(top, len(order)) - 1]]
    count = int(np.flatnonzero((same == last).all(axis=0))[-1]) + 1
    return min(count, max(waveforms(problem), top))


def waveforms(problem: Problem) -> int:
    """Number of drives whose waveforms may be computed to order them."""
    return _CELLS // max(case.at_belt.pieces for case in problem.cases)


def better_but_unknown(problem: Problem, kept: Sifted, rank: Rank, best: NDArray[np.int64]) -> NDArray[np.int64]:
    """The best of those that are better than the first shown and only stand behind it for a figure that is missing."""
    if not len(best) or kept.certainty[best[0]] != PASSES:
        return best[:0]
    first, shown = ranking.rounded(rank.value), best[0]
    better = (rank.missing <= rank.missing[shown]) & (first < first[shown])
    rows = np.flatnonzero((kept.certainty != PASSES) & better)
    least = [kept.certainty[rows], kept.lacking[rows]]
    order = ranking.order(problem.catalog, kept.sets.on(rows), rank.value[rows], rank.missing[rows], before=least)
    return rows[order[:1]]
