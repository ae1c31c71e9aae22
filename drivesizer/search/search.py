"""The search over all candidates: drives that meet all limits in order, and the closest rejected.

By physics the candidates go through in chunks, behind some belts at a time: those that pass are kept as rows of a few
numbers, the rejected only while they are among the closest. So memory grows with the drives that pass, not with the
candidates. The drives that are shown are then computed in full.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search.by_the_paper import search_by_paper
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.order import ranking
from drivesizer.search.order.families import best_of_other_families, margin_candidates
from drivesizer.search.order.found import BudgetFilter, Judge, Passing, SearchResult
from drivesizer.search.order.in_order import but_for, failing_before, ordered_in_machine, without_rejected
from drivesizer.search.order.looked_at import FullDrives, drives_by_margin
from drivesizer.search.order.rank import Rank, better_but_unknown, equals_of_the_last, ranked, waveforms
from drivesizer.search.order.ranking import Ranking
from drivesizer.search.order.sifting import Progress, Sifted, any_passes, examined_by, sifted

__all__ = ["any_drive", "search"]

Rows = NDArray[np.int64]
_QUICK = "mass"  # objective that needs no waveform


class _SearchOptions(NamedTuple):
    """Results that a search is to give, as ``search`` takes them."""

    top: int
    misses: int | None
    pareto: tuple[str, ...]
    others: int

    def closest(self, passing: Rows) -> int:
        """Number of the closest rejected."""
        return 0 if self.misses is None else self.misses if len(passing) else self.top


class _Searched(NamedTuple):
    """A search so far."""

    problem: Problem
    kept: Sifted
    rank: Rank
    order: Rows  # of those kept, the best first
    looked_at: FullDrives


def search(
    problem: Problem,
    *,
    top: int,
    objective: Ranking,
    misses: int | None = 3,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    judge: Judge | None = None,
    others: int = 0,
    margins: bool = False,
    made: dict[Hashable, Any] | None = None,
) -> SearchResult:
    """Search all candidates."""
    if problem.spec.method == "paper":
        return search_by_paper(problem, top, objective, misses, pareto, judge, others)
    names, wanted = {*ranking.names_of(objective), *pareto}, _SearchOptions(top, misses, pareto, others)
    made, key = {} if made is None else made, examined_by(names, margins)
    one = None if pareto else objective
    several = 4 * top if judge else top
    sifting = made.get(key) or sifted(problem, names, progress, margins=margins, objective=one, wanted=several)
    if not sifting[2].undecided:
        made[key] = sifting
    kept, rejected, counts = sifting
    rank = ranked(problem, kept, objective, top)
    order = rank.order(problem.catalog, kept.sets)
    tied, rest = np.split(order, [equals_of_the_last(problem, rank, order, top)])
    alone = not (judge or pareto or others)  # then no more than the first are looked at
    looked_at, tied = drives_by_margin(
        problem, kept, rank, tied, _drives_beside(problem, kept, rank, order, len(tied), others), rejected,
        wanted.closest(tied), top if alone else len(tied),
    )  # fmt: skip
    found = _Searched(problem, kept, rank, np.concatenate([tied, rest]), looked_at)
    in_machine = ordered_in_machine(judge, kept.sets, looked_at.at, found.order, len(order) if pareto else top)
    return _shown(found, wanted, judge, in_machine, counts)


def _drives_beside(problem: Problem, kept: Sifted, rank: Rank, order: Rows, first: int, others: int) -> Rows:
    """Drives that may be shown and are not among the first; none where waveforms take long.

    Those of other motor families, and one that is held back.
    """
    found = better_but_unknown(problem, kept, rank, order[:1])
    if others:
        alike = margin_candidates(problem.catalog, kept.sets, order, first, others, rank.columns)
        found = np.concatenate([but_for(found, alike), alike])
    found = but_for(found, order[:first])
    return found if first + len(found) <= waveforms(problem) else order[:0]


def _shown(
    found: _Searched, wanted: _SearchOptions, judge: Judge | None, in_machine: BudgetFilter, counts: Counts
) -> SearchResult:
    """The best, the closest rejected and the others in full."""
    problem, kept, rank, order, looked_at = found
    best, short = in_machine.best[: wanted.top], in_machine.rejected[: wanted.top]
    misses = min(wanted.closest(best), len(looked_at.nearest.motor))  # a budget of the machine may reject all
    on_front = _front(found, wanted, in_machine.best)
    held = better_but_unknown(problem, kept, rank, best)
    unlike = best_of_other_families(
        judge, problem.catalog, kept.sets, looked_at.at, order, best[:1], wanted.others, rank.columns,
        None if waveforms(problem) else looked_at.by_bounds,
    )  # fmt: skip
    extra = np.concatenate([but_for(on_front, best), short, held, but_for(unlike, best)])
    places = {int(row): n for n, row in enumerate(best)}
    places |= {int(row): len(best) + misses + n for n, row in enumerate(extra)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    counts = without_rejected(counts, in_machine, kept.passes)
    return SearchResult(
        looked_at.shown(best, misses, extra), len(best), counts, front, below,
        failing_before(in_machine, order), next((places[int(row)] for row in held), None), beside,
        Passing(kept.sets, kept.certainty, kept.figures, best, looked_at.anew),
    )  # fmt: skip


def _front(found: _Searched, wanted: _SearchOptions, passing: Rows) -> Rows:
    """Of the drives that pass those on the Pareto front, where one is wanted."""
    if not wanted.pareto:
        return passing[:0]
    figures = {name: column[passing] for name, column in found.kept.figures.items()}
    return passing[ranking.front(found.problem.catalog, found.kept.sets.on(passing), figures, wanted.pareto)]


def any_drive(problem: Problem, judge: Judge | None) -> bool:
    """Whether a search finds a drive, whatever ranks it: without waveforms of all, and no more examined than needed."""
    if problem.spec.method == "paper":
        return search_by_paper(problem, 1, _QUICK, None, (), judge, 0).passing > 0
    if judge is None:
        return any_passes(problem)
    kept, _, _ = sifted(problem, {_QUICK}, None)
    value = ranking.values(problem.catalog, kept.sets, kept.figures, _QUICK)
    order = ranking.order(problem.catalog, kept.sets, *value, before=[kept.certainty])
    found = ordered_in_machine(judge, kept.sets, lambda rows: by_physics(problem, kept.sets.on(rows), True), order, 1)
    return len(found.best) > 0
