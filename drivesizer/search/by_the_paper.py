"""The search by the paper's rule: it compares the reductions of a family, so that all candidates are at hand."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search.columns.bought import chosen
from drivesizer.search.columns.candidates import Candidates, candidates, pairs
from drivesizer.search.columns.evaluation import Evaluation, evaluate, smallest_margin
from drivesizer.search.order import ranking
from drivesizer.search.order.families import best_of_other_families
from drivesizer.search.order.found import Judge, Passing, SearchResult
from drivesizer.search.order.in_order import but_for, failing_before, ordered_in_machine, without_rejected
from drivesizer.search.order.rank import Rank
from drivesizer.search.order.ranking import Ranking
from drivesizer.search.order.sifting import UNKNOWN
from drivesizer.search.paper.rule import FEW

__all__ = ["search_by_paper"]

Rows = NDArray[np.int64]


def search_by_paper(
    problem: Problem,
    top: int,
    objective: Ranking,
    misses: int | None,
    pareto: tuple[str, ...],
    judge: Judge | None,
    others: int,
) -> SearchResult:
    """Search all candidates by the paper's rule."""
    every = _paper_order(problem, objective, rejected=misses is not None)
    found, sets = every.evaluation, every.evaluation.candidates
    of_parts = found._replace(checks=[])  # budgets of the machine look at no other checks
    kept = ordered_in_machine(judge, sets, of_parts.on, every.passing, len(sets.motor) if pareto else top)
    best, short = kept.best[:top], kept.rejected[:top]
    near = every.rejected[: _closest(misses, top, len(best), every.counts.feasible)]
    on_front = best[:0]
    if pareto:
        figures = {name: column[kept.best] for name, column in every.figures.items()}
        of_all = ranking.front(problem.catalog, sets.on(kept.best), figures, pareto)
        on_front = kept.best[of_all]
    unlike = best[:0]
    if others:
        unlike = best_of_other_families(
            judge, problem.catalog, sets, found.on, every.passing, best[:1], others, every.rank.columns
        )
    few = np.concatenate([best, near, but_for(on_front, best), short, but_for(unlike, best)])
    places = {int(row): n for n, row in enumerate(few)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    return SearchResult(
        found.on(few), len(best), without_rejected(every.counts, kept, ~found.unknown), front, below,
        failing_before(kept, every.passing), others=beside, every=every.all_passing(best),
    )  # fmt: skip


class _PaperOrder(NamedTuple):
    """All candidates by the rule, in order."""

    evaluation: Evaluation
    margin: NDArray[np.float64]  # the smallest of each
    figures: dict[str, NDArray[np.float64]]  # it and the parts that go with each
    rank: Rank
    passing: Rows  # those that pass, the best first
    rejected: Rows  # the others, the nearest first
    counts: Counts

    def all_passing(self, best: Rows) -> Passing:
        """All that pass, and which of them are given."""
        some, found = self.passing, self.evaluation
        figures = {name: column[some] for name, column in self.figures.items()}
        return Passing(
            found.candidates.on(some), self.rank.precedence[some] * UNKNOWN, figures,
            _places(some, best, len(self.margin)), lambda rows: found.on(some[rows]),
        )  # fmt: skip


def _paper_order(problem: Problem, objective: Ranking, rejected: bool) -> _PaperOrder:
    """Evaluate all candidates; of the rejected perhaps not all."""
    every = _all_candidates(problem)
    found = evaluate(problem, every, rejected=rejected)
    margin, failed, unknown = smallest_margin(found.checks), found.failed, found.unknown
    each = np.array([check.failed for check in found.checks])
    figures = {"margin": margin, **chosen(found.encoder, found.controller, found.brake, needs_encoder=True)}
    value, missing = ranking.values(problem.catalog, found.candidates, figures, objective)
    before = [
        np.where(failed, 2, unknown.astype(int)),
        np.where(failed, -margin, 0.0),  # of those that fail first the nearest
        np.where(failed, each.sum(axis=0), 0),
    ]
    order = ranking.order(problem.catalog, found.candidates, value, missing, margin=margin, before=before)
    passes = ~failed if problem.spec.select.unknown == "allow" else ~failed & ~unknown
    tally = {check.name: count for check, count in zip(found.checks, each.sum(axis=1).tolist(), strict=True) if count}
    left_out = int(np.count_nonzero(~failed & ~passes))
    counts = Counts(
        considered=len(every.motor), feasible=int(passes.sum()), passing=int((~failed & ~unknown).sum()),
        left_out=left_out, failed_by=tally,
    )  # fmt: skip
    rank = Rank(unknown.astype(np.int64), missing, value)
    return _PaperOrder(found, margin, figures, rank, order[passes[order]], order[~passes[order]], counts)


def _closest(misses: int | None, top: int, given: int, feasible: int) -> int:
    """Number of the closest rejected that are given."""
    if misses is None:
        return 0
    return min(misses, max(top - given, 0)) if feasible else top


def _all_candidates(problem: Problem) -> Candidates:
    """All of them: of few the same record again, which variants of a spec have in common."""
    belts = tuple(problem.belt_ratios)
    if len(pairs(problem).motor) * len(belts) > FEW:
        return candidates(problem)
    key, of = ("candidates", problem.spec.is_direct, belts), (problem.spec.select,)
    found: Candidates = problem.catalog.once(key, lambda: candidates(problem), of)
    return found


def _places(rows: NDArray[np.int64], some: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Places of some of the rows among them all, in the order of all."""
    wanted = np.zeros(count, bool)
    wanted[some] = True
    return np.flatnonzero(wanted[rows])
