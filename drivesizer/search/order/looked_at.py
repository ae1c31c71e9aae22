"""Drives that are looked at in full: as few as decide the order of those that are shown, and the closest rejected.

An evaluation of few drives costs about the same whatever their number. So what decides or is shown is evaluated in one
go, as far as it is known beforehand and waveforms are short: of the closest rejected by bounds, which order them, and
in full.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates, joined
from drivesizer.search.columns.evaluation import Evaluation, by_physics, smallest_margin
from drivesizer.search.order import ranking
from drivesizer.search.order.rank import Rank, waveforms
from drivesizer.search.order.sifting import Sifted

__all__ = ["FullDrives", "drives_by_margin"]

Rows = NDArray[np.int64]
_FEW = 32  # drives of the largest possible margins, that mostly decide which of many equals have the largest


class FullDrives(NamedTuple):
    """Some drives and the closest rejected in full."""

    sets: Candidates  # all drives that pass or may pass
    rows: Rows  # of those that were looked at; they are the first of the evaluation
    nearest: Candidates  # the rejected; from the closest on where any of them was looked at
    closest: Rows  # their rows of the evaluation, of as many as are in it
    evaluation: Evaluation

    def at(self, rows: Rows) -> Evaluation:
        """Some drives: out of the evaluation where all of them are in it."""
        places = self._places(rows)
        return self.anew(rows) if places is None else self.evaluation.on(places)

    def anew(self, rows: Rows) -> Evaluation:
        """Some drives, computed by themselves."""
        return by_physics(self.evaluation.problem, self.sets.on(rows), True)

    def by_bounds(self, rows: Rows) -> Evaluation:
        """Some drives without their waveforms, where bounds decide."""
        return by_physics(self.evaluation.problem, self.sets.on(rows), False)

    def shown(self, first: Rows, misses: int, last: Rows) -> Evaluation:
        """Some drives, so many of the closest rejected, and others: out of the evaluation, or anew."""
        places, problem = self._places(np.concatenate([first, last])), self.evaluation.problem
        if places is None or misses > len(self.closest):
            nearest = _in_order(problem, self.nearest) if misses > len(self.closest) else self.nearest
            several = [self.sets.on(first), nearest.on(slice(misses)), self.sets.on(last)]
            return by_physics(problem, joined(several), True)
        few, others = np.split(places, [len(first)])
        return self.evaluation.on(np.concatenate([few, self.closest[:misses], others]))

    def _places(self, rows: Rows) -> Rows | None:
        """Places of some drives among those looked at; None where one is not there."""
        if len(rows) > len(self.rows):
            return None
        place = {row: n for n, row in enumerate(self.rows.tolist())}
        found = [place.get(row, -1) for row in rows.tolist()]
        return None if min(found, default=0) < 0 else np.array(found, np.int64)


def drives_by_margin(
    problem: Problem, kept: Sifted, rank: Rank, tied: Rows, beside: Rows, rejected: Candidates, misses: int, top: int
) -> tuple[FullDrives, Rows]:
    """The first drives in order of their margins too, and what was looked at for that."""
    several = max(_FEW, 2 * top)
    few, others = np.split(tied[rank.order(problem.catalog, kept.sets, tied, kept.most[tied])], [several])
    if several < len(others) and np.isfinite(kept.most[others[0]]):
        found, margin = _look(problem, kept, np.concatenate([few, beside]), rejected, misses)
        with_next = np.append(few, others[0]), np.append(margin[:several], kept.most[others[0]])
        order = rank.order(problem.catalog, kept.sets, *with_next)
        if not (order[:top] == several).any():  # nor is one behind it better than it could be
            return found, np.concatenate([few[order[order < several]], others])
    found, margin = _look(problem, kept, np.concatenate([tied, beside]), rejected, misses)
    return found, tied[rank.order(problem.catalog, kept.sets, tied, margin[: len(tied)])]


def _look(
    problem: Problem, kept: Sifted, rows: Rows, rejected: Candidates, misses: int
) -> tuple[FullDrives, NDArray[np.float64]]:
    """Some drives and the closest rejected in full, and the smallest margins of all that was evaluated."""
    count, several = len(rows), len(rejected.motor) if misses else 0
    if not several or count + 2 * several > waveforms(problem):
        nearest = _in_order(problem, rejected) if several else rejected
        found = by_physics(problem, joined([kept.sets.on(rows), nearest.on(slice(misses))]), True)
        closest = np.arange(count, len(found.controller))
        return FullDrives(kept.sets, rows, nearest, closest, found), smallest_margin(found.checks)
    in_full = np.repeat([True, False, True], [count, several, several])
    found = by_physics(problem, joined([kept.sets.on(rows), rejected, rejected]), in_full)
    order = _closest(found.on(np.arange(count, count + several)))
    looked_at = FullDrives(kept.sets, rows, rejected.on(order), count + several + order, found)
    return looked_at, smallest_margin(found.checks)


def _in_order(problem: Problem, rejected: Candidates) -> Candidates:
    """The rejected from the closest on."""
    return rejected.on(_closest(by_physics(problem, rejected, True))) if len(rejected.motor) else rejected


def _closest(found: Evaluation) -> Rows:
    """The rejected in order of their smallest margin, then of the number of failed checks."""
    count = len(found.controller)
    fails = np.sum([check.failed for check in found.checks if not check.advice], axis=0)
    before = [ranking.rounded(-smallest_margin(found.checks)), fails]
    value = np.zeros(count), np.zeros(count, np.int64)
    return ranking.order(found.catalog, found.candidates, *value, before=before)
