"""All candidates at once: which sets stand, in which order, and which of those that fell came nearest.

By physics the candidates go through in chunks, a belt at a time: what stands is kept as a row of a few numbers, what
falls only while it is among the nearest. So 10 million sets need no more memory than those that stand. The sets that
are shown are then computed in full.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates, candidates, joined, pairs
from drivesizer.search.columns.evaluation import Evaluation, by_physics, evaluate
from drivesizer.search.columns.stages import Examined, examine
from drivesizer.search.ranking import COUNTED, Ranking
from drivesizer.spec.select import OBJECTIVES

__all__ = ["Evaluated", "Found", "Judge", "Kept", "search", "smallest_margin"]

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]  # sets examined, sets in all

_FIRST = 1 << 12  # sets that are judged at first
_CHUNK = 1 << 16  # pairs at a time
_NEAREST = 32  # of those that fell, kept until all are known
_WAVEFORM = {name for name, declared in OBJECTIVES.items() if declared.by_waveform}


class Found(NamedTuple):
    """What a search found: sets in full, those that stand first and in order."""

    evaluation: Evaluation
    standing: int  # how many of the evaluation's rows stand
    counts: Counts
    front: tuple[int, ...]  # rows on the Pareto front, where one was asked for
    short: tuple[int, ...] = ()  # rows of the best that a budget of the machine makes fall
    better: int = 0  # sets that do, before the first that stands


class Kept(NamedTuple):
    """Of the sets that no check makes fall those that stand in their machine, as far as they were judged."""

    best: NDArray[np.int64]  # which of them, in order
    fallen: NDArray[np.int64]  # which of them fall by a budget, in order
    judged: int
    by: Counter[str]  # how many by each budget


Evaluated = Callable[[NDArray[np.int64]], Evaluation]  # some rows of the sets in full
Judge = Callable[[Candidates, Evaluated, int], Kept]  # sets in order, and how many that stand are wanted


class _Kept(NamedTuple):
    """Candidates as rows of a few numbers."""

    sets: Candidates
    doubtful: NDArray[np.bool_]  # a check is unknown
    figures: dict[str, Array]


def search(
    problem: Problem,
    *,
    top: int,
    objective: Ranking,
    misses: int = 3,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    judge: Judge | None = None,
) -> Found:
    """Search all candidates.

    Parameters
    ----------
    problem
        The machine with its load cycles, and the catalogues.
    top
        How many sets to give.
    objective
        What ranks those that stand.
    misses
        How many of the nearest that fell to give below them; ``top`` of them when nothing stands.
    pareto
        Objectives of which the front is wanted.
    progress
        Called after each chunk.
    judge
        Which of those that no check makes fall stand in the machine as well; all of them where not given.
    """
    if problem.spec.method == "paper":
        return _by_the_paper(problem, top, objective, misses, pareto, judge)
    names, catalog = {*ranking.names_of(objective), *pareto}, problem.catalog
    kept, fallen, counts = _sifted(problem, bool(names & _WAVEFORM), progress)
    value = ranking.values(catalog, kept.sets, kept.figures, objective)
    order = ranking.order(catalog, kept.sets, *value, before=[kept.doubtful])
    stood = _stood(
        judge,
        kept.sets,
        lambda rows: by_physics(problem, kept.sets.on(rows), True),
        order,
        len(order) if pareto else top,
    )
    best, short = stood.best[:top], stood.fallen[:top]
    nearest = fallen.on(_nearest(problem, fallen)[: misses if len(best) else top])
    on_front = best[:0]
    if pareto:
        figures = {name: column[stood.best] for name, column in kept.figures.items()}
        on_front = stood.best[ranking.front(catalog, kept.sets.on(stood.best), figures, pareto)]
    extra = np.concatenate([on_front[~np.isin(on_front, best)], short])
    shown = evaluate(problem, joined([kept.sets.on(best), nearest, kept.sets.on(extra)]))
    places = {int(row): n for n, row in enumerate(best)}
    places |= {int(row): len(best) + len(nearest.motor) + n for n, row in enumerate(extra)}
    front, fell = (tuple(places[int(row)] for row in rows) for rows in (on_front, short))
    return Found(shown, len(best), _without(counts, stood), front, fell, _before(stood, order))


def _stood(judge: Judge | None, sets: Candidates, evaluated: Evaluated, order: NDArray[np.int64], wanted: int) -> Kept:
    """Of sets in order those that stand in the machine, until so many are found or none is left."""
    if judge is None:
        return Kept(order, order[:0], 0, Counter())
    best, fallen, by, start, size = [order[:0]], [order[:0]], Counter[str](), 0, _FIRST
    while start < len(order) and sum(map(len, best)) < wanted:
        rows = order[start : start + size]
        found = judge(sets.on(rows), _among(evaluated, rows), wanted - sum(map(len, best)))
        best.append(rows[found.best])
        fallen.append(rows[found.fallen])
        by.update(found.by)
        start, size = start + found.judged, min(16 * size, _CHUNK)
    return Kept(np.concatenate(best), np.concatenate(fallen), start, by)


def _among(evaluated: Evaluated, rows: NDArray[np.int64]) -> Evaluated:
    """The same of some of the sets, by their places among these."""
    return lambda few: evaluated(rows[few])


def _without(counts: Counts, stood: Kept) -> Counts:
    """The counts without those that were judged to fall by a budget of the machine."""
    by = {name: count for name, count in stood.by.items() if count}
    left = counts.feasible - len(stood.fallen)
    return replace(counts, feasible=left, judged=stood.judged, failed_by_budget=by)


def _before(stood: Kept, order: NDArray[np.int64]) -> int:
    """How many fall by a budget before the first that stands."""
    if not len(stood.best):
        return len(stood.fallen)
    return int(np.argmax(order == stood.best[0]))  # all before it were judged


def _nearest(problem: Problem, fallen: Candidates) -> NDArray[np.int64]:
    """Those that fell, by how far their worst check is off, then by how many they fail; by bounds, that is."""
    count = len(fallen.motor)
    if not count:
        return np.zeros(0, np.int64)
    checks = evaluate(problem, fallen, exact=False).checks
    fails = np.sum([check.failed for check in checks if not check.advice], axis=0)
    value = np.zeros(count), np.zeros(count, np.int64)
    return ranking.order(problem.catalog, fallen, *value, before=[-smallest_margin(checks), fails])


def smallest_margin(checks: list[CheckColumn]) -> Array:
    """The smallest margin of each candidate that is known; what passes by choice is left out."""
    found: Array = np.minimum.reduce([check.tightness for check in checks]) if checks else np.zeros(0)
    return found


def _on(evaluation: Evaluation, rows: NDArray[np.int64]) -> Evaluation:
    """Some rows of an evaluation."""
    return evaluation._replace(
        candidates=evaluation.candidates.on(rows),
        wheel={name: r.on(rows) for name, r in evaluation.wheel.items()},
        shaft={name: r.on(rows) for name, r in evaluation.shaft.items()},
        checks=[check.on(rows) for check in evaluation.checks],
        encoder=evaluation.encoder[rows],
        controller=evaluation.controller[rows],
        figures={name: column[rows] for name, column in evaluation.figures.items()},
    )


def _sifted(problem: Problem, exact: bool, progress: Progress | None) -> tuple[_Kept, Candidates, Counts]:
    """What stands, the nearest that fell, and how many there were of each."""
    every, belts = pairs(problem), problem.belt_ratios
    total, done, failed_by = len(every.motor) * len(belts), 0, Counter[str]()
    kept: list[_Kept] = []
    fallen: list[tuple[Candidates, Array]] = []
    for one in examine(problem, _chunks(every, belts), staged=True, exact=exact, margins=exact):
        chunk = one.sets
        failed_by.update(one.failed_by)
        figures = {name: one.figures[name] for name in COUNTED} | {"margin": one.margin}
        kept.append(_Kept(chunk.on(one.rows), one.doubtful, figures))
        fallen = [_best([*fallen, _fallen(chunk, one)])]
        done += len(chunk.motor)
        if progress:
            progress(done, total)
    standing = _joined(kept, every)
    if problem.spec.select.unknown == "reject":
        sure = np.flatnonzero(~standing.doubtful)
        figures = {name: column[sure] for name, column in standing.figures.items()}
        standing = _Kept(standing.sets.on(sure), standing.doubtful[sure], figures)
    tally = {name: count for name, count in failed_by.items() if count}
    counts = Counts(considered=total, feasible=len(standing.sets.motor), failed_by=tally)
    return standing, fallen[0][0] if fallen else every.on(np.zeros(0, np.int64)), counts


def _chunks(every: Candidates, belts: list[float]) -> Iterator[tuple[float, Candidates]]:
    for belt in belts:
        for start in range(0, len(every.motor), _CHUNK):
            chunk = every.on(slice(start, start + _CHUNK))
            yield belt, chunk._replace(belt=np.full(len(chunk.motor), belt))


def _fallen(chunk: Candidates, one: Examined) -> tuple[Candidates, Array]:
    rows, bound = one.fallen, one.bound
    if len(rows) > _NEAREST:
        few = np.argpartition(-bound, _NEAREST)[:_NEAREST]
        rows, bound = rows[few], bound[few]
    return chunk.on(rows), bound


def _best(several: list[tuple[Candidates, Array]]) -> tuple[Candidates, Array]:
    """The nearest of those that fell in several chunks."""
    sets = joined([s for s, _ in several])
    bound = np.concatenate([b for _, b in several])
    rows = np.lexsort((sets.belt, sets.gearhead, sets.motor, -bound))[:_NEAREST]
    return sets.on(rows), bound[rows]


def _joined(kept: list[_Kept], every: Candidates) -> _Kept:
    if not kept:
        none = every.on(slice(0, 0))
        return _Kept(none, none.listed, dict.fromkeys((*COUNTED, "margin"), none.belt))
    return _Kept(
        joined([k.sets for k in kept]),
        np.concatenate([k.doubtful for k in kept]),
        {name: np.concatenate([k.figures[name] for k in kept]) for name in kept[0].figures},
    )


def _by_the_paper(
    problem: Problem,
    top: int,
    objective: Ranking,
    misses: int,
    pareto: tuple[str, ...],
    judge: Judge | None,
) -> Found:
    """The paper's rule over all candidates: it compares the reductions of a family, so all of them are at hand."""
    found, catalog = evaluate(problem, candidates(problem)), problem.catalog
    margin = smallest_margin(found.checks)
    fails = np.sum([check.failed for check in found.checks], axis=0)
    figures = {"margin": margin}
    value = ranking.values(catalog, found.candidates, figures, objective)
    order = ranking.order(catalog, found.candidates, *value, before=[
        np.where(found.failed, 2, found.unknown.astype(int)),
        np.where(found.failed, -margin, 0.0),
        np.where(found.failed, fails, 0),
    ])  # fmt: skip
    stands = ~found.failed if problem.spec.select.unknown == "allow" else ~found.failed & ~found.unknown
    tally = {check.name: int(check.failed.sum()) for check in found.checks if check.failed.any()}
    counts = Counts(considered=len(stands), feasible=int(stands.sum()), failed_by=tally)
    standing, fell = order[stands[order]], order[~stands[order]]
    sets = found.candidates
    stood = _stood(judge, sets, lambda rows: _on(found, rows), standing, len(order) if pareto else top)
    best, short = stood.best[:top], stood.fallen[:top]
    near = fell[: min(misses, max(top - len(best), 0)) if counts.feasible else top]
    on_front = best[:0]
    if pareto:
        of_all = ranking.front(catalog, sets.on(stood.best), {"margin": margin[stood.best]}, pareto)
        on_front = stood.best[of_all]
    few = np.concatenate([best, near, on_front[~np.isin(on_front, best)], short])
    places = {int(row): n for n, row in enumerate(few)}
    front, below = (tuple(places[int(row)] for row in rows) for rows in (on_front, short))
    return Found(_on(found, few), len(best), _without(counts, stood), front, below, _before(stood, standing))
