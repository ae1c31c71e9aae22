"""The search over all candidates, by physics or by the paper's rule: drives that meet all limits in order.

Few are computed in full: those that decide the order of what is shown, and the closest rejected. An evaluation of few
drives costs about the same whatever their number, so that they go together.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.physics.figures import Array, Whole, joined
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates, candidates, pairs
from drivesizer.search.columns.evaluation import Evaluation, by_physics, evaluate, smallest_margin
from drivesizer.search.columns.paper import FEW
from drivesizer.search.passing import (
    UNKNOWN,
    Passing,
    Progress,
    Rank,
    any_passes,
    better_but_unknown,
    ranked,
    sifted,
    waveforms,
)

Evaluated = Callable[[Whole], Evaluation]  # some rows of the drives in full
_QUICK = "mass"  # objective that needs no waveform
_FIRST = 1 << 12  # drives that are judged in their machine at first
_MOST = 1 << 16  # at a time
_MEMO_SIZE = 1 << 10  # drives in full that are not computed again
_FEW = 32  # drives of the largest possible margins, that mostly decide which of many equals have the largest
_ALIKE = 32  # drives of a family that rank alike, of which margins are computed


class BudgetFilter(NamedTuple):
    """Of the drives that pass their own checks those that pass the machine's budgets, as far as they were examined."""

    best: Whole  # which of them, in order
    rejected: Whole  # which of them fail on a budget, in order
    judged: int
    by: Counter[str]  # how many by each budget


Judge = Callable[[Candidates, Evaluated, int], BudgetFilter]  # drives in order, and how many that pass are wanted


class InOrder(NamedTuple):
    """All drives that pass their own checks, in order, and the closest rejected."""

    drives: Passing
    rank: Rank
    order: Whole  # of the drives, from best to worst
    at: Evaluated  # drives in full; the rejected are numbered behind those that pass
    rejected: Callable[[int], Whole]  # so many of them, from the closest on


class SearchResult(NamedTuple):
    """The result of a search: drives in full, those that pass first and in order."""

    evaluation: Evaluation
    passing: int  # how many of the evaluation's rows pass
    counts: Counts
    front: tuple[int, ...]  # rows on the Pareto front, where one was required
    short: tuple[int, ...]  # rows of the best that a budget of the machine rejects
    better: int  # drives that fail on a budget before the first that passes
    held_back: tuple[
        int, ...
    ]  # rows of the best that would be better than the first, did their checks not lack figures
    others: tuple[int, ...]  # rows of the best of other motor families than the first one's, where required
    in_order: InOrder  # all that pass their own checks
    best: Whole  # which of these the first rows are


def search(
    problem: Problem,
    *,
    top: int,
    misses: int | None = 3,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    judge: Judge | None = None,
    others: int = 0,
    margins: bool = False,
) -> SearchResult:
    """Search all candidates in the order of the objective that the problem's spec has."""
    catalog, by_paper = problem.catalog, problem.spec.method == "paper"
    if by_paper:
        in_order, counts = _by_the_paper(problem, misses is not None)
    else:
        alone = not (judge or pareto or others)  # then no more than the first are looked at
        in_order, counts = _by_physics(
            problem, top, misses, pareto, progress, margins, others, 4 * top if judge else top, alone
        )
    drives, order, at = in_order.drives, in_order.order, in_order.at
    in_budget = ordered_in_machine(judge, drives.sets, at, order, len(order) if pareto else top)
    best, short, front = in_budget.best[:top], in_budget.rejected[:top], order[:0]
    if pareto:
        of_best = {name: column[in_budget.best] for name, column in drives.figures.items()}
        front = in_budget.best[ranking.front(catalog, drives.sets.on(in_budget.best), of_best, pareto)]
    closest = misses or 0
    if misses is not None and not len(order if by_paper else best):  # a budget of the machine may reject all
        closest = top
    elif by_paper:
        closest = min(closest, max(top - len(best), 0))
    held_back = order[:0] if by_paper else better_but_unknown(problem, drives, in_order.rank, best)
    unlike = _best_of_other_families(problem, judge, in_order, best[:1], others)
    further = [but_for(rows, best) for rows in (front, short, held_back, unlike)]
    few = np.concatenate([best, in_order.rejected(closest), *further])
    places = {int(row): n for n, row in enumerate(few)}
    front_, short_, held_, others_ = (
        tuple(places[int(row)] for row in rows) for rows in (front, short, held_back, unlike)
    )
    counts = replace(
        counts, feasible=counts.feasible - len(in_budget.rejected), judged=in_budget.judged,
        passing=counts.passing - int(drives.passes[in_budget.rejected].sum()),
        failed_by_budget={name: count for name, count in in_budget.by.items() if count},
    )  # fmt: skip
    better = (
        int(np.argmax(order == in_budget.best[0])) if len(in_budget.best) else len(in_budget.rejected)
    )  # all before were judged
    return SearchResult(
        at(few), len(best), counts, front_, short_, better, held_, others_, in_order, best
    )  # fmt: skip


def any_drive(problem: Problem, judge: Judge | None) -> bool:
    """Whether a search finds a drive, whatever ranks it: without waveforms of all, and no more examined than needed."""
    problem = problem.ranked_by(_QUICK)
    if problem.spec.method == "paper":
        return search(problem, top=1, misses=None, judge=judge).passing > 0
    if judge is None:
        return any_passes(problem)
    drives, _, _ = sifted(problem, known=problem.spec.select.unknown == "reject")
    value = ranking.values(problem.catalog, drives.sets, drives.figures, _QUICK)
    order = ranking.order(problem.catalog, drives.sets, *value, before=[drives.certainty])
    in_budget = ordered_in_machine(judge, drives.sets, lambda rows: by_physics(problem, drives.sets.on(rows)), order, 1)
    return len(in_budget.best) > 0


def _by_the_paper(problem: Problem, rejected: bool) -> tuple[InOrder, Counts]:
    """All candidates by the paper's rule: it compares the reductions of a family, so that all are at hand."""
    catalog, belts, unknown_passes = problem.catalog, tuple(problem.belt_ratios), problem.spec.select.unknown == "allow"
    if len(pairs(problem).motor) * len(belts) > FEW:
        sets = candidates(problem)
    else:  # of few the same record again, which variants of a spec have in common
        key, of = ("candidates", problem.spec.is_direct, belts), (problem.spec.select,)
        sets = catalog.once(key, lambda: candidates(problem), of)
    evaluation = evaluate(problem, sets, rejected=rejected)  # of the rejected perhaps not all
    margin, failed, unknown = smallest_margin(evaluation.checks), evaluation.failed, evaluation.unknown
    fails = np.array([check.failed for check in evaluation.checks])
    figures = {"margin": margin, **ranking.part_rows(evaluation, needs_encoder=True)}
    value, missing = ranking.values(catalog, evaluation.candidates, figures, problem.spec.select.objective)
    before = [np.where(failed, 2, unknown), np.where(failed, -margin, 0.0), np.where(failed, fails.sum(axis=0), 0)]
    order = ranking.order(catalog, evaluation.candidates, value, missing, margin=margin, before=before)
    passes = ~failed if unknown_passes else ~failed & ~unknown
    rows, count = np.concatenate([order[passes[order]], order[~passes[order]]]), int(passes.sum())
    few, certainty = rows[:count], UNKNOWN * unknown[rows[:count]]
    drives = Passing(
        evaluation.candidates.on(few), certainty, {name: x[few] for name, x in figures.items()}, certainty, margin[few],
        ~unknown[few],
    )  # fmt: skip
    tally = {check.name: n for check, n in zip(evaluation.checks, fails.sum(axis=1).tolist(), strict=True) if n}
    counts = Counts(
        considered=len(sets.motor), feasible=count, passing=int((~failed & ~unknown).sum()),
        left_out=int(np.count_nonzero(~failed & ~passes)), failed_by=tally,
    )  # fmt: skip
    rank, places = Rank(certainty, missing[few], value[few]), np.arange(len(rows))
    at, closest = (lambda subset: evaluation.on(rows[subset])), (lambda number: places[count:][:number])
    return InOrder(drives, rank, places[:count], at, closest), counts


def _by_physics(
    problem: Problem, top: int, misses: int | None, pareto: Sequence[str], progress: Progress | None, margins: bool,
    others: int, enough: int, alone: bool,
) -> tuple[InOrder, Counts]:  # fmt: skip
    """All candidates by physics; of the drives that are equal to the last shown margins decide."""
    drives, rejected, counts = sifted(
        problem, pareto=pareto, progress=progress, margins=margins, enough=0 if pareto else enough,
        known=misses is None and problem.spec.select.unknown == "reject",
    )  # fmt: skip
    catalog, rank, count = problem.catalog, ranked(problem, drives, top), len(drives.passes)
    order = rank.order(catalog, drives.sets)
    failing = count + np.arange(len(rejected.motor))
    few = len(failing) <= waveforms(problem)
    in_full = InFull(problem, joined([drives.sets, rejected]))

    def closest(number: int) -> Whole:
        """The rejected by the share that they have of what is required, then by the number of failed checks."""
        if not number or not len(failing):
            return failing[:0]
        # of a long cycle by bounds, where these decide
        evaluation = in_full.at(failing) if few else by_physics(problem, rejected, "open")
        none = np.zeros(len(failing))
        checks = [check for check in evaluation.checks if not check.advice]
        short = [np.where(c.failed, (1.0 + np.nan_to_num(c.margin, nan=-1.0)) / (1.0 + c.needed), 1.0) for c in checks]
        fails = np.sum([check.failed for check in checks], axis=0)
        least = np.where(fails > 0, np.minimum.reduce(short), -np.inf)  # what is undecided in full stands last
        before = [ranking.rounded(-least), fails]
        return failing[ranking.order(catalog, evaluation.candidates, none, none.astype(np.int64), before=before)][
            :number
        ]

    if len(order):
        columns = rank.columns[:, order]
        same = (columns == columns[:, [min(top, len(order)) - 1]]).all(axis=0)
        tied, rest = np.split(order, [min(int(np.flatnonzero(same)[-1]) + 1, max(waveforms(problem), top))])
        # what may be shown and is not among the first: one that is held back, and drives of other motor families
        further = [better_but_unknown(problem, drives, rank, order[:1])]
        if others:
            family = family_of(catalog, drives.sets.motor[order])
            further += [_alike(order, family, n, columns) for n in family_firsts(family)[: others + 1].tolist()]
        also = but_for(np.unique(np.concatenate(further)), tied)
        also = also if len(tied) + len(also) <= waveforms(problem) else order[:0]
        near = failing if misses and few else failing[:0]
        tied = in_full.by_margin(drives, rank, tied, top if alone else len(tied), np.concatenate([also, near]))
        order = np.concatenate([tied, rest])
    return InOrder(drives, rank, order, in_full.at, closest), counts


class InFull:
    """Drives in full, each of few computed once."""

    def __init__(self, problem: Problem, sets: Candidates) -> None:
        self.problem, self.sets = problem, sets
        self.known: list[tuple[dict[int, int], Evaluation]] = []

    def at(self, rows: Whole) -> Evaluation:
        """Some drives, out of an evaluation where all of them are in it."""
        numbers = rows.tolist()
        for places, evaluation in self.known:
            if len(numbers) <= len(places) and all(row in places for row in numbers):
                return evaluation.on(np.array([places[row] for row in numbers], np.int64))
        evaluation = by_physics(self.problem, self.sets.on(rows))
        if len(numbers) <= _MEMO_SIZE:
            self.known.append(({row: n for n, row in enumerate(numbers)}, evaluation))
        return evaluation

    def by_margin(self, drives: Passing, rank: Rank, rows: Whole, top: int, also: Whole) -> Whole:
        """Drives in order of their margins too, as far as the first need it; others are computed with them."""
        catalog, size = self.problem.catalog, max(_FEW, 2 * top)
        rows = rows[rank.order(catalog, drives.sets, rows, drives.most[rows])]  # the largest possible margins first
        while True:
            margin, few = drives.most[rows], rows[:size]
            margin[:size] = smallest_margin(self.at(np.concatenate([few, also])).checks)[: len(few)]
            order = rank.order(catalog, drives.sets, rows, margin)
            if size >= len(rows) or (order[:top] < size).all():
                return rows[order]
            size = len(rows)


# -- Drives in order through the budgets of their machine, as many as are wanted.


def ordered_in_machine(
    judge: Judge | None, sets: Candidates, evaluated: Evaluated, order: Whole, number: int
) -> BudgetFilter:
    """The drives in order that pass the machine's budgets, until so many are found or none is left."""
    if judge is None:
        return BudgetFilter(order, order[:0], 0, Counter())
    best, rejected, by, start, size = [order[:0]], [order[:0]], Counter[str](), 0, _FIRST
    while start < len(order) and sum(map(len, best)) < number:
        rows = order[start : start + size]
        in_budget = judge(sets.on(rows), partial(_of_rows, evaluated, rows), number - sum(map(len, best)))
        best.append(rows[in_budget.best])
        rejected.append(rows[in_budget.rejected])
        by.update(in_budget.by)
        start, size = start + in_budget.judged, min(16 * size, _MOST)
    return BudgetFilter(np.concatenate(best), np.concatenate(rejected), start, by)


def _of_rows(evaluated: Evaluated, rows: Whole, few: Whole) -> Evaluation:
    return evaluated(rows[few])


def but_for(rows: Whole, others: Whole) -> Whole:
    """Some rows without others."""
    return rows[~np.isin(rows, others)] if len(rows) else rows


# -- Motor families among drives in order: alternatives that differ from the best, not its other windings.


def family_of(catalog: Catalog, motor: Whole) -> Whole:
    """The motor family of drives, as a number."""

    def numbers() -> Whole:
        return np.unique(catalog.motors["family"].astype(str), return_inverse=True)[1]

    return catalog.once("motor families", numbers)[motor]


def family_firsts(family: Whole) -> Whole:
    """Places of the first drive of each family, rising.

    >>> family_firsts(np.array([7, 2, 7, 7, 0, 2])).tolist()
    [0, 1, 4]
    """
    return np.sort(np.unique(family, return_index=True)[1])


def _alike(order: Whole, family: Whole, place: int, columns: Array) -> Whole:
    """The drives of the family of one in order that rank as it does, the first of them."""
    same = (family == family[place]) & (columns == columns[:, [place]]).all(axis=0)
    return order[same][:_ALIKE]


def _best_of_other_families(
    problem: Problem, judge: Judge | None, in_order: InOrder, best: Whole, number: int
) -> Whole:
    """The best drive of each other motor family than that of the best; of those that rank alike the largest margin."""
    if not number or not len(best):
        return best[:0]
    sets, motors = in_order.drives.sets, in_order.drives.sets.motor
    by_margin = problem.spec.method == "paper" or waveforms(problem) > 0
    order = in_order.order[
        family_of(problem.catalog, motors[in_order.order]) != family_of(problem.catalog, motors[best])
    ]
    family, columns = family_of(problem.catalog, motors[order]), in_order.rank.columns[:, order]
    firsts = ordered_in_machine(judge, sets, in_order.at, order[family_firsts(family)], number).best[:number]
    for n, row in enumerate(firsts):
        alike = _alike(order, family, int(np.flatnonzero(order == row)[0]), columns)
        if by_margin and len(alike) > 1:
            margin = ranking.rounded(smallest_margin(in_order.at(alike).checks))
            alike = alike[np.argsort(-margin, kind="stable")]
            firsts[n] = ordered_in_machine(judge, sets, in_order.at, alike, 1).best[0]
    return firsts
