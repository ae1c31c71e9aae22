"""The search over all candidates: drives that meet all limits in order, and the closest rejected.

By physics the candidates go through in chunks, a belt at a time: those that pass are kept as rows of a few numbers, the
rejected only while they are among the closest. So memory grows with the drives that pass, not with the candidates. The
drives that are shown are then computed in full.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates, candidates, joined, pairs
from drivesizer.search.columns.evaluation import Evaluation, by_physics, evaluate
from drivesizer.search.columns.limits_over_time import WAVEFORM_LIMITS
from drivesizer.search.families import family_of, first_of_each
from drivesizer.search.open_checks import passing
from drivesizer.search.paper.rule import FEW
from drivesizer.search.ranking import Ranking
from drivesizer.search.sifting import OPEN, PASSES, UNKNOWN, Progress, Sifted, any_passes, sifted

__all__ = ["Evaluated", "Found", "Judge", "Kept", "Passing", "any_found", "search", "smallest_margin"]

Array = NDArray[np.float64]

_FIRST = 1 << 12  # drives that are judged at first
_MOST = 1 << 16  # at a time
_CELLS = 50_000  # drives times pieces of the load cycle, of which margins are computed to order equals
_SAMPLED = 32  # open drives at most
_ALIKE = 32  # drives of a family that rank alike, of which margins are computed
_QUICK = "mass"  # objective that needs no waveform
_TENTHS = 12  # places for tenths of a probability, and for what is not sampled


Evaluated = Callable[[NDArray[np.int64]], Evaluation]  # some rows of the drives in full


class Found(NamedTuple):
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


class Kept(NamedTuple):
    """Of the drives that pass their own checks those that pass the machine's budgets, as far as they were examined."""

    best: NDArray[np.int64]  # which of them, in order
    rejected: NDArray[np.int64]  # which of them fail on a budget, in order
    judged: int
    by: Counter[str]  # how many by each budget


Judge = Callable[[Candidates, Evaluated, int], Kept]  # drives in order, and how many that pass are wanted


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
) -> Found:
    """Search all candidates.

    Parameters
    ----------
    problem
        The machine with its load cycles, and the catalogues.
    top
        How many drives to give.
    objective
        What ranks those that pass.
    misses
        How many of the closest rejected to give as well, ``top`` of them when nothing passes; None for none at all,
        and by the paper's method without the count of what they fail on.
    pareto
        Objectives of which the front is wanted.
    progress
        Called after each chunk.
    judge
        Which of those that pass their own checks pass the machine's budgets; all of them where not given.
    others
        How many drives of other motor families to give as well, the best of each.
    margins
        Compute the smallest margin of all that pass, by bounds where no objective needs the waveform.

    Returns
    -------
    Found
        The best, the closest rejected, the front, those of other families, and the counts.
    """
    if problem.spec.method == "paper":
        return _by_the_paper(problem, top, objective, misses, pareto, judge, others)
    names, catalog = {*ranking.names_of(objective), *pareto}, problem.catalog
    kept, rejected, counts = sifted(problem, names, progress, margins=margins)
    value = ranking.values(catalog, kept.sets, kept.figures, objective)
    precedence = _precedence(problem, kept, *value, top)
    order = ranking.order(catalog, kept.sets, *value, before=[precedence])
    head = order[: _tied(problem, precedence, order, *value, top)]
    closest = cache(lambda: rejected.on(_nearest(problem, rejected)))

    def few_of_closest(found: NDArray[np.int64]) -> Candidates:
        wanted = 0 if misses is None else misses if len(found) else top
        return closest().on(slice(wanted)) if wanted else rejected.on(slice(0))

    nearest = few_of_closest(head)
    looked_at = by_physics(problem, joined([kept.sets.on(head), nearest]), True)
    order = np.concatenate([head[_by_margin(looked_at, precedence, head, *value)], order[len(head) :]])

    place = {int(row): n for n, row in enumerate(head)}

    def in_full(rows: NDArray[np.int64]) -> Evaluation:
        return by_physics(problem, kept.sets.on(rows), True)

    def by_bounds(rows: NDArray[np.int64]) -> Evaluation:
        return by_physics(problem, kept.sets.on(rows), False)

    bounded = None if _in_cells(problem) else by_bounds

    def at_hand(rows: NDArray[np.int64]) -> Evaluation:  # budgets of the machine look at the parts of a drive alone
        known = [place.get(int(row), -1) for row in rows] if len(rows) <= len(place) else [-1]
        return looked_at.on(np.array(known)) if min(known) >= 0 else in_full(rows)

    kept_in_machine = _passing(judge, kept.sets, at_hand, order, len(order) if pareto else top)
    best, short = kept_in_machine.best[:top], kept_in_machine.rejected[:top]
    nearest = few_of_closest(best)  # a budget of the machine may reject all
    on_front = best[:0]
    if pareto:
        figures = {name: column[kept_in_machine.best] for name, column in kept.figures.items()}
        on_front = kept_in_machine.best[ranking.front(catalog, kept.sets.on(kept_in_machine.best), figures, pareto)]
    held = _held_back(problem, kept, *value, best)
    rank = np.stack([precedence, value[1], ranking.rounded(value[0])])
    unlike = _of_other_families(judge, kept.sets, in_full, order, best[:1], catalog, others, rank, bounded)
    extra = np.concatenate([_without_rows(on_front, best), short, held, _without_rows(unlike, best)])
    shown = _shown(looked_at, kept, nearest, (head, best, extra))
    places = {int(row): n for n, row in enumerate(best)}
    places |= {int(row): len(best) + len(nearest.motor) + n for n, row in enumerate(extra)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    return Found(
        shown, len(best), _without(counts, kept_in_machine), front, below, _before(kept_in_machine, order),
        next((places[int(row)] for row in held), None), beside,
        Passing(kept.sets, kept.certainty, kept.figures, best, in_full),
    )  # fmt: skip


def _of_other_families(
    judge: Judge | None,
    sets: Candidates,
    evaluated: Evaluated,
    order: NDArray[np.int64],
    best: NDArray[np.int64],
    catalog: Catalog,
    wanted: int,
    rank: Array,
    bounded: Evaluated | None = None,
) -> NDArray[np.int64]:
    """The best drive of each other motor family than that of the best; of those that rank alike the largest margin.

    ``rank`` has a row for each figure that orders, shape (figures, drives); ``bounded`` evaluates by bounds, where a
    waveform takes long.
    """
    if not wanted or not len(best):
        return best[:0]
    family, own = family_of(catalog, sets.motor[order]), family_of(catalog, sets.motor[best])[0]
    others = family != own
    order, family = order[others], family[others]
    found = _passing(judge, sets, evaluated, order[first_of_each(family)], wanted).best[:wanted]
    for n, row in enumerate(found):
        same = (family == family[order == row]) & (rank[:, order] == rank[:, [row]]).all(axis=0)
        alike = order[same][:_ALIKE]
        if judge or not bounded:  # the machine may reject some of them
            margin = ranking.rounded(smallest_margin(evaluated(alike).checks))
        else:
            margin = _widest(alike, evaluated, bounded)
        found[n] = _passing(judge, sets, evaluated, alike[np.argsort(-margin, kind="stable")], 1).best[0]
    return found


def _widest(alike: NDArray[np.int64], evaluated: Evaluated, bounded: Evaluated) -> Array:
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


def any_found(problem: Problem, judge: Judge | None) -> bool:
    """Whether a search finds a drive, whatever ranks it: without waveforms of all, and no more examined than needed.

    Parameters
    ----------
    problem, judge
        As for ``search``.

    Returns
    -------
    bool
        Whether any passes or may pass.
    """
    if problem.spec.method == "paper":
        return _by_the_paper(problem, 1, _QUICK, None, (), judge, 0).passing > 0
    if judge is None:
        return any_passes(problem)
    kept, _, _ = sifted(problem, {_QUICK}, None)
    value = ranking.values(problem.catalog, kept.sets, kept.figures, _QUICK)
    order = ranking.order(problem.catalog, kept.sets, *value, before=[kept.certainty])
    found = _passing(judge, kept.sets, lambda rows: by_physics(problem, kept.sets.on(rows), True), order, 1)
    return len(found.best) > 0


def _held_back(
    problem: Problem, kept: Sifted, value: NDArray[np.float64], missing: NDArray[np.int64], best: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The best of those that are better than the first shown and only stand behind it for a figure that is missing."""
    if not len(best) or kept.certainty[best[0]] != PASSES:
        return best[:0]
    first, shown = ranking.rounded(value), best[0]
    rows = np.flatnonzero((kept.certainty != PASSES) & (missing <= missing[shown]) & (first < first[shown]))
    least = [kept.certainty[rows], kept.lacking[rows]]
    order = ranking.order(problem.catalog, kept.sets.on(rows), value[rows], missing[rows], before=least)
    return rows[order[:1]]


def _precedence(
    problem: Problem, kept: Sifted, value: NDArray[np.float64], missing: NDArray[np.int64], top: int
) -> NDArray[np.int64]:
    """Order that goes before the objective: certainty, and of open drives in tenths how probable it is that none fails.

    Of open ones as many are sampled, the best by the objective, as an order of those that are shown may need.
    """
    precedence = _TENTHS * kept.certainty
    opened = np.flatnonzero(kept.certainty == OPEN)
    if len(opened) < 2 or np.count_nonzero(kept.certainty == PASSES) >= top:
        return precedence
    precedence[opened] += _TENTHS - 1
    count = max(min(_SAMPLED, _in_cells(problem)), top)
    best = opened[ranking.order(problem.catalog, kept.sets.on(opened), value[opened], missing[opened])][:count]
    few = by_physics(problem, kept.sets.on(best), False)
    for place, row in enumerate(best.tolist()):
        one = few.candidates.on(np.array([place]))._replace(
            controller=few.controller[[place]], brake=few.brake[[place]]
        )
        together = passing(problem, one, few.open_checks(place), each=False)[""]
        precedence[row] = _TENTHS * (OPEN + 1) - 1 - int(10.0 * together)
    return precedence


def _tied(
    problem: Problem,
    precedence: NDArray[np.int64],
    order: NDArray[np.int64],
    value: NDArray[np.float64],
    missing: NDArray[np.int64],
    top: int,
) -> int:
    """Number of the first in order that are ordered by margin: up to the equals of the last shown, in bounds.

    Margins need the waveform.
    """
    if not len(order):
        return 0
    same = np.stack([precedence, missing, ranking.rounded(value)])[:, order]
    last = same[:, [min(top, len(order)) - 1]]
    count = int(np.flatnonzero((same == last).all(axis=0))[-1]) + 1
    return min(count, max(_in_cells(problem), top))


def _in_cells(problem: Problem) -> int:
    """Drives whose waveforms may be computed to order them."""
    return _CELLS // max(case.at_belt.pieces for case in problem.cases)


def _by_margin(
    looked_at: Evaluation,
    precedence: NDArray[np.int64],
    head: NDArray[np.int64],
    value: NDArray[np.float64],
    missing: NDArray[np.int64],
) -> NDArray[np.int64]:
    """Order of the first that were looked at: precedence, objective, and of equal ones the larger smallest margin."""
    few, before = slice(len(head)), [precedence[head]]
    margin, sets = smallest_margin(looked_at.checks)[few], looked_at.candidates.on(few)
    return ranking.order(looked_at.catalog, sets, value[head], missing[head], before=before, margin=margin)


def _shown(looked_at: Evaluation, kept: Sifted, nearest: Candidates, rows: tuple[NDArray[np.int64], ...]) -> Evaluation:
    """The best, the closest rejected and others in full: out of what was looked at, or anew where some were not."""
    head, best, extra = rows
    place = {int(row): n for n, row in enumerate(head)}
    first, last = ([place.get(int(row), -1) for row in some] for some in (best, extra))
    behind = range(len(head), len(head) + len(nearest.motor))
    if min([*first, *last], default=0) < 0 or len(behind) > len(looked_at.controller) - len(head):
        return by_physics(looked_at.problem, joined([kept.sets.on(best), nearest, kept.sets.on(extra)]), True)
    return looked_at.on(np.array([*first, *behind, *last], dtype=np.int64))


def _passing(
    judge: Judge | None, sets: Candidates, evaluated: Evaluated, order: NDArray[np.int64], wanted: int
) -> Kept:
    """The drives in order that pass the machine's budgets, until so many are found or none is left."""
    if judge is None:
        return Kept(order, order[:0], 0, Counter())
    best, rejected, by, start, size = [order[:0]], [order[:0]], Counter[str](), 0, _FIRST
    while start < len(order) and sum(map(len, best)) < wanted:
        rows = order[start : start + size]
        found = judge(sets.on(rows), _among(evaluated, rows), wanted - sum(map(len, best)))
        best.append(rows[found.best])
        rejected.append(rows[found.rejected])
        by.update(found.by)
        start, size = start + found.judged, min(16 * size, _MOST)
    return Kept(np.concatenate(best), np.concatenate(rejected), start, by)


def _among(evaluated: Evaluated, rows: NDArray[np.int64]) -> Evaluated:
    """The same function for some of the drives, by their places among these."""
    return lambda few: evaluated(rows[few])


def _without(counts: Counts, kept_in_machine: Kept) -> Counts:
    """The counts without the drives that fail on a budget of the machine."""
    by = {name: count for name, count in kept_in_machine.by.items() if count}
    left = counts.feasible - len(kept_in_machine.rejected)
    return replace(counts, feasible=left, judged=kept_in_machine.judged, failed_by_budget=by)


def _without_rows(rows: NDArray[np.int64], others: NDArray[np.int64]) -> NDArray[np.int64]:
    """Some rows without others; mostly there are none, and nothing is to be compared."""
    return rows[~np.isin(rows, others)] if len(rows) else rows


def _before(kept_in_machine: Kept, order: NDArray[np.int64]) -> int:
    """Number of drives that fail on a budget before the first that passes."""
    if not len(kept_in_machine.best):
        return len(kept_in_machine.rejected)
    return int(np.argmax(order == kept_in_machine.best[0]))  # all before it were judged


def _nearest(problem: Problem, rejected: Candidates) -> NDArray[np.int64]:
    """The rejected in order of their smallest margin, then of the number of failed checks; by bounds."""
    count = len(rejected.motor)
    if not count:
        return np.zeros(0, np.int64)
    checks = evaluate(problem, rejected, exact=False).checks
    fails = np.sum([check.failed for check in checks if not check.advice], axis=0)
    value = np.zeros(count), np.zeros(count, np.int64)
    return ranking.order(problem.catalog, rejected, *value, before=[ranking.rounded(-smallest_margin(checks)), fails])


def smallest_margin(checks: list[CheckColumn]) -> Array:
    """The smallest margin of each candidate that is known; what passes by selection is left out."""
    found: Array = np.minimum.reduce([check.tightness for check in checks]) if checks else np.zeros(0)
    return found


def _all_candidates(problem: Problem) -> Candidates:
    """All of them: of few the same record again, which variants of a spec have in common."""
    belts = tuple(problem.belt_ratios)
    if len(pairs(problem).motor) * len(belts) > FEW:
        return candidates(problem)
    key, of = ("candidates", problem.spec.is_direct, belts), (problem.spec.select,)
    found: Candidates = problem.catalog.once(key, lambda: candidates(problem), of)
    return found


def _by_the_paper(
    problem: Problem,
    top: int,
    objective: Ranking,
    misses: int | None,
    pareto: tuple[str, ...],
    judge: Judge | None,
    others: int,
) -> Found:
    """The paper's rule over all candidates: it compares the reductions of a family, so all of them are at hand."""
    every, catalog = _all_candidates(problem), problem.catalog
    found = evaluate(problem, every, rejected=misses is not None)
    margin, failed, unknown = smallest_margin(found.checks), found.failed, found.unknown
    each = np.array([check.failed for check in found.checks])
    fails = each.sum(axis=0)
    figures = {"margin": margin}
    value = ranking.values(catalog, found.candidates, figures, objective)
    order = ranking.order(catalog, found.candidates, *value, margin=margin, before=[
        np.where(failed, 2, unknown.astype(int)),
        np.where(failed, -margin, 0.0),
        np.where(failed, fails, 0),
    ])  # fmt: skip
    passes = ~failed if problem.spec.select.unknown == "allow" else ~failed & ~unknown
    tally = {check.name: count for check, count in zip(found.checks, each.sum(axis=1).tolist(), strict=True) if count}
    left_out = int(np.count_nonzero(~failed & ~passes))
    counts = Counts(considered=len(every.motor), feasible=int(passes.sum()), left_out=left_out, failed_by=tally)
    passing, rejected = order[passes[order]], order[~passes[order]]
    sets = found.candidates
    of_parts = found._replace(checks=[])  # budgets of the machine look at no other checks
    kept_in_machine = _passing(judge, sets, of_parts.on, passing, len(order) if pareto else top)
    best, short = kept_in_machine.best[:top], kept_in_machine.rejected[:top]
    near = rejected[: 0 if misses is None else min(misses, max(top - len(best), 0)) if counts.feasible else top]
    on_front = best[:0]
    if pareto:
        of_all = ranking.front(catalog, sets.on(kept_in_machine.best), {"margin": margin[kept_in_machine.best]}, pareto)
        on_front = kept_in_machine.best[of_all]
    unlike = best[:0]
    if others:
        rank = np.stack([unknown, value[1], ranking.rounded(value[0])])
        unlike = _of_other_families(judge, sets, found.on, passing, best[:1], catalog, others, rank)
    few = np.concatenate([best, near, _without_rows(on_front, best), short, _without_rows(unlike, best)])
    places = {int(row): n for n, row in enumerate(few)}
    front, below, beside = (tuple(places[int(row)] for row in rows) for rows in (on_front, short, unlike))
    return Found(
        found.on(few), len(best), _without(counts, kept_in_machine), front, below, _before(kept_in_machine, passing),
        others=beside,
        every=Passing(sets.on(passing), unknown[passing] * UNKNOWN, {"margin": margin[passing]},
                      np.flatnonzero(np.isin(passing, best)), lambda rows: found.on(passing[rows])),
    )  # fmt: skip
