"""Drives in order through the budgets of their machine: few of them in full, motor families, as many as are wanted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates, joined
from drivesizer.search.columns.evaluation import Evaluation, by_physics, smallest_margin
from drivesizer.search.columns.limits_over_time import WAVEFORM_LIMITS
from drivesizer.search.ranking import Rank, Sifted, waveforms

# -- Results of a search, and how budgets of the machine take part in it.


Array = NDArray[np.float64]
Evaluated = Callable[[NDArray[np.int64]], Evaluation]  # some rows of the drives in full


class SearchResult(NamedTuple):
    """The result of a search: drives in full, those that pass first and in order."""

    evaluation: Evaluation
    passing: int  # how many of the evaluation's rows pass
    counts: Counts
    front: tuple[int, ...]  # rows on the Pareto front, where one was required
    short: tuple[int, ...] = ()  # rows of the best that a budget of the machine rejects
    better: int = 0  # drives that fail on a budget before the first that passes
    held_back: int | None = None  # row of the best that would be better than the first, did its checks not lack figures
    others: tuple[int, ...] = ()  # rows of the best of other motor families than the first one's, where required
    every: Passing | None = None  # all that pass their own checks


class Passing(NamedTuple):
    """All drives that pass their own checks, as rows of a few numbers."""

    sets: Candidates
    certainty: NDArray[np.int64]
    figures: dict[str, Array]  # that objectives count, as far as they were computed
    best: NDArray[np.int64]  # rows of those that are given
    evaluated: Evaluated


class BudgetFilter(NamedTuple):
    """Of the drives that pass their own checks those that pass the machine's budgets, as far as they were examined."""

    best: NDArray[np.int64]  # which of them, in order
    rejected: NDArray[np.int64]  # which of them fail on a budget, in order
    judged: int
    by: Counter[str]  # how many by each budget


Judge = Callable[[Candidates, Evaluated, int], BudgetFilter]  # drives in order, and how many that pass are wanted


# -- Drives in order through the budgets of their machine, as many as are wanted.


_FIRST = 1 << 12  # drives that are judged at first
_MOST = 1 << 16  # at a time


def ordered_in_machine(
    judge: Judge | None, sets: Candidates, evaluated: Evaluated, order: NDArray[np.int64], wanted: int
) -> BudgetFilter:
    """The drives in order that pass the machine's budgets, until so many are found or none is left."""
    if judge is None:
        return BudgetFilter(order, order[:0], 0, Counter())
    best, rejected, by, start, size = [order[:0]], [order[:0]], Counter[str](), 0, _FIRST
    while start < len(order) and sum(map(len, best)) < wanted:
        rows = order[start : start + size]
        found = judge(sets.on(rows), _among(evaluated, rows), wanted - sum(map(len, best)))
        best.append(rows[found.best])
        rejected.append(rows[found.rejected])
        by.update(found.by)
        start, size = start + found.judged, min(16 * size, _MOST)
    return BudgetFilter(np.concatenate(best), np.concatenate(rejected), start, by)


def _among(evaluated: Evaluated, rows: NDArray[np.int64]) -> Evaluated:
    """The same function for some of the drives, by their places among these."""
    return lambda few: evaluated(rows[few])


def without_rejected(counts: Counts, kept: BudgetFilter, passes: NDArray[np.bool_]) -> Counts:
    """The counts without the drives that fail on a budget of the machine."""
    by = {name: count for name, count in kept.by.items() if count}
    left, passing = counts.feasible - len(kept.rejected), counts.passing - int(passes[kept.rejected].sum())
    return replace(counts, feasible=left, passing=passing, judged=kept.judged, failed_by_budget=by)


def failing_before(kept: BudgetFilter, order: NDArray[np.int64]) -> int:
    """Number of drives that fail on a budget before the first that passes."""
    if not len(kept.best):
        return len(kept.rejected)
    return int(np.argmax(order == kept.best[0]))  # all before it were judged


def but_for(rows: NDArray[np.int64], others: NDArray[np.int64]) -> NDArray[np.int64]:
    """Some rows without others."""
    return rows[~np.isin(rows, others)] if len(rows) else rows


# -- Motor families among drives in order: alternatives that differ from the best, not its other windings.


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

    >>> family_firsts(np.array([7, 2, 7, 7, 0, 2])).tolist()
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


# -- Drives that are looked at in full: as few as decide the order of those that are shown, and the closest rejected.
#
# An evaluation of few drives costs about the same whatever their number. So what decides or is shown is evaluated in
# one go, as far as it is known beforehand and waveforms are short: of the closest rejected by bounds, which order
# them, and in full.


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
