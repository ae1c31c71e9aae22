"""Of all candidates those that pass or may pass, and the closest rejected: in chunks, a belt at a time.

Candidates are examined at the favourable end of the bands of estimated figures; those that have any once more at the
other end: it passes where it passes at both, is open where at one, and fails where at none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Set
from itertools import cycle
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search.columns.bands import at_ends, estimated
from drivesizer.search.columns.candidates import Candidates, joined, pairs
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.columns.stages import Examined, examine
from drivesizer.search.ranking import BRAKE, COUNTED, order, rounded
from drivesizer.spec.select import OBJECTIVES

__all__ = ["OPEN", "PASSES", "UNKNOWN", "Progress", "Sifted", "any_passes", "sifted"]

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]  # drives examined, drives in all
PASSES, OPEN, UNKNOWN = range(3)  # certainty
_WAVEFORM = {name for name, declared in OBJECTIVES.items() if declared.by_waveform}
_CHUNK = 1 << 16  # pairs at a time
_NEAREST = 32  # of the rejected, kept until all are known


class Sifted(NamedTuple):
    """Candidates that pass or may pass, as rows of a few numbers."""

    sets: Candidates
    certainty: NDArray[np.int64]  # PASSES, OPEN by estimated figures, or UNKNOWN by one that has no band
    figures: dict[str, Array]  # that objectives count
    lacking: NDArray[np.int64]  # number of checks that are unknown, but for those that are so of all


class _Found(NamedTuple):
    """The same of one belt's chunk, with the rejected."""

    examined: int
    sets: Candidates
    opened: NDArray[np.bool_]
    unknown: NDArray[np.uint64]  # checks, as bits, shape (rows, words)
    figures: dict[str, Array]
    failed_by: Counter[str]
    rejected: Candidates
    bound: Array  # the smallest margin of each of the rejected is no better


def sifted(
    problem: Problem, names: Set[str], progress: Progress | None, *, margins: bool = False
) -> tuple[Sifted, Candidates, Counts]:
    """The drives that pass or may pass, the closest rejected, and the counts.

    Parameters
    ----------
    problem
        The machine with its load cycles, and the catalogues.
    names
        Objectives.
    progress
        Called after each chunk.
    margins
        Compute the smallest margin of each; by bounds where no objective needs the waveform.

    Returns
    -------
    tuple
        Those that pass or may pass, candidates near the limits, and how many failed on what.
    """
    every, belts = pairs(problem), problem.belt_ratios
    total, done, failed_by = len(every.motor) * len(belts), 0, Counter[str]()
    kept: list[_Found] = []
    rejected = [(every.on(slice(0, 0)), np.zeros(0))]
    exact = bool(names & _WAVEFORM)
    for one in _examined(problem, every, belts, exact, margins or exact):
        failed_by.update(one.failed_by)
        kept.append(one)
        rejected = [_nearest(problem, [*rejected, (one.rejected, one.bound)])]
        done += one.examined
        if progress:
            progress(done, total)
    passing = _joined(problem, kept, every, names)
    tally = {name: count for name, count in failed_by.items() if count}
    opened = int(np.count_nonzero(passing.certainty == OPEN))
    left_out = sum(len(one.unknown) for one in kept) - len(passing.sets.motor)
    counts = Counts(considered=total, feasible=len(passing.sets.motor), left_out=left_out, open=opened, failed_by=tally)
    return passing, rejected[0][0], counts


def any_passes(problem: Problem) -> bool:
    """Whether any candidate passes or may pass: no more of them are examined than answer that.

    Parameters
    ----------
    problem
        The machine with its load cycles, and the catalogues.

    Returns
    -------
    bool
        Whether ``sifted`` would find one.
    """
    every, belts = pairs(problem), problem.belt_ratios
    if problem.spec.select.unknown == "reject":
        return any((~one.unknown.any(axis=1)).any() for one in _examined(problem, every, belts, False, False))
    uncertain = every.on(estimated(problem, every))
    favourable, unfavourable = at_ends(problem) if len(uncertain.motor) else (problem, problem)
    sides = ((favourable, every), (unfavourable, uncertain))
    found = (one for side, sets in sides for one in examine(side, _chunks(sets, belts), staged=True, exact=False))
    return any(len(one.rows) for one in found)


def _examined(problem: Problem, every: Candidates, belts: list[float], exact: bool, margins: bool) -> Iterator[_Found]:
    """One belt's chunk after the other: all at the favourable end, where printed figures are as printed."""
    uncertain = np.zeros(len(every.motor), bool)
    uncertain[estimated(problem, every)] = True
    favourable, unfavourable = at_ends(problem) if uncertain.any() else (problem, problem)
    rows = [np.flatnonzero(uncertain[start : start + _CHUNK]) for start in range(0, len(uncertain), _CHUNK)]
    easy = examine(favourable, _chunks(every, belts), staged=True, exact=exact, margins=margins)
    some = (
        (belt, chunk.on(few))
        for (belt, chunk), few in zip(_chunks(every, belts), cycle(rows), strict=False)
        if len(few)
    )
    hard = examine(unfavourable, some, staged=True, exact=exact, margins=margins)
    for one, few in zip(easy, cycle(rows), strict=False):
        if len(few):
            yield _at_both(problem, one, few, next(hard))
        else:
            yield _found(problem, one, np.zeros(len(one.rows), bool))


def _found(problem: Problem, one: Examined, opened: NDArray[np.bool_]) -> _Found:
    figures = {name: one.figures[name] for name in COUNTED} | {"margin": one.margin, BRAKE: one.brake.astype(float)}
    sets, rejected, bound = one.sets, one.rejected, one.bound
    if len(rejected) > _NEAREST:
        far = rounded(-bound)
        few = np.flatnonzero(~(far > np.partition(far, _NEAREST - 1)[_NEAREST - 1]))
        rejected, bound = rejected[few], bound[few]
    failing = _nearest(problem, [(sets.on(rejected), bound)])
    return _Found(len(sets.motor), sets.on(one.rows), opened, one.unknown, figures, one.failed_by, *failing)


def _at_both(problem: Problem, easy: Examined, few: NDArray[np.int64], hard: Examined) -> _Found:
    """Candidates that pass at the favourable end, then those of the other end alone; ``few`` were examined at both."""
    passing = few[hard.rows]
    both, alone = np.isin(easy.rows, passing), ~np.isin(passing, easy.rows)
    opened = np.isin(easy.rows, few) & ~both
    unknown, margin = easy.unknown.copy(), easy.margin.copy()
    opened[both] = (unknown[both] != hard.unknown[~alone]).any(axis=1)  # rows of both rise
    unknown[both] &= hard.unknown[~alone]
    margin[both] = hard.margin[~alone]
    figures = {name: column.copy() for name, column in easy.figures.items()}
    for name, column in figures.items():
        column[both] = hard.figures[name][~alone]
    brake = easy.brake.copy()
    brake[both] = hard.brake[~alone]
    rest = np.flatnonzero(~np.isin(easy.rejected, passing))
    whole = easy._replace(
        rows=np.concatenate([easy.rows, passing[alone]]),
        unknown=np.concatenate([unknown, hard.unknown[alone]]),
        margin=np.concatenate([margin, hard.margin[alone]]),
        brake=np.concatenate([brake, hard.brake[alone]]),
        figures={name: np.concatenate([column, hard.figures[name][alone]]) for name, column in figures.items()},
        rejected=easy.rejected[rest],
        bound=easy.bound[rest],
    )
    return _found(problem, whole, np.concatenate([opened, np.ones(np.count_nonzero(alone), bool)]))


def _chunks(every: Candidates, belts: list[float]) -> Iterator[tuple[float, Candidates]]:
    for belt in belts:
        for start in range(0, len(every.motor), _CHUNK):
            chunk = every.on(slice(start, start + _CHUNK))
            yield belt, chunk._replace(belt=np.full(len(chunk.motor), belt))


def _nearest(problem: Problem, several: list[tuple[Candidates, Array]]) -> tuple[Candidates, Array]:
    """The nearest of the rejected in several chunks; of those that are equally far the first by part number."""
    sets = joined([s for s, _ in several])
    bound = np.concatenate([b for _, b in several])
    rows = order(problem.catalog, sets, -bound, np.zeros(len(bound), np.int64))[:_NEAREST]
    return sets.on(rows), bound[rows]


def _joined(problem: Problem, kept: list[_Found], every: Candidates, names: Set[str]) -> Sifted:
    """All that pass or may pass; of estimated figures those that objectives count are at the middle of the band."""
    if not kept:
        none = every.on(slice(0, 0))
        figures, nothing = dict.fromkeys((*COUNTED, "margin", BRAKE), none.belt), np.zeros(0, np.int64)
        return Sifted(none, nothing, figures, nothing)
    sets = joined([k.sets for k in kept])
    opened, unknown = (np.concatenate([getattr(k, name) for k in kept]) for name in ("opened", "unknown"))
    figures = {name: np.concatenate([k.figures[name] for k in kept]) for name in kept[0].figures}
    rows = estimated(problem, sets)
    if names & set(COUNTED) and len(rows):
        middle = by_physics(problem, sets.on(rows), True).figures
        for name in COUNTED:
            figures[name][rows] = middle[name]
    if problem.spec.select.unknown == "reject":
        known = np.flatnonzero(~unknown.any(axis=1))
        return _on(Sifted(sets, opened * OPEN, figures, np.zeros(len(opened), np.int64)), known)
    own = unknown & ~np.bitwise_and.reduce(unknown, axis=0)  # what all lack sets none back
    lacking = np.unpackbits(own.view(np.uint8), axis=1).sum(axis=1, dtype=np.int64)
    return Sifted(sets, np.where(lacking > 0, UNKNOWN, np.where(opened, OPEN, PASSES)), figures, lacking)


def _on(found: Sifted, rows: NDArray[np.int64]) -> Sifted:
    figures = {name: column[rows] for name, column in found.figures.items()}
    return Sifted(found.sets.on(rows), found.certainty[rows], figures, found.lacking[rows])
