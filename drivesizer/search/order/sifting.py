"""Of all candidates those that pass or may pass, and the closest rejected: in chunks, behind some belts at a time.

Candidates are examined at the favourable end of the bands of estimated figures; those that have any once more at the
other end: it passes where it passes at both, is open where at one, and fails where at none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterator, Set
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.stress import put
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search.columns.bands import BothEnds, at_ends, both_ends, estimated
from drivesizer.search.columns.bought import chosen
from drivesizer.search.columns.candidates import Candidates, Crossed, joined, pairs
from drivesizer.search.columns.evaluation import by_physics, figures_by_physics, smallest_margin
from drivesizer.search.columns.limits_over_time import Exactly, Wanted
from drivesizer.search.columns.parts_alone import belts_together
from drivesizer.search.columns.powered import UNDECIDED
from drivesizer.search.columns.stages import Examined, examine
from drivesizer.search.columns.survivors import amounting, bound_of
from drivesizer.search.order.ranking import COUNTED, Ranking, order, rounded, values
from drivesizer.spec.select import OBJECTIVES

__all__ = ["OPEN", "PASSES", "UNKNOWN", "Progress", "Sifted", "any_passes", "examined_by", "sifted"]

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]  # drives examined, drives in all
PASSES, OPEN, UNKNOWN = range(3)  # certainty
_WAVEFORM = {name for name, declared in OBJECTIVES.items() if declared.by_waveform}
_CHUNK = 1 << 20  # drives at a time
_NEAREST = 32  # of the rejected, kept until all are known
_SOME = 1 << 12  # of the rejected, among which the farthest that may be kept is found
_OF_ROWS = ("rows", "unknown", "doublings", "margin", "encoder", "controller", "brake")  # of what was examined
_LONG = 1 << 14  # segments of a cycle, up to which all drives that bounds leave open are computed
_CELLS = 50_000_000  # drives times segments that are computed before none is said to pass but for what all lack
_FIRST, _SEEN = 32, 200  # drives that are computed at first, and at least before that is said
_ALIKE = 1e-7  # share of a margin within which rounding makes others equal


class Sifted(NamedTuple):
    """Candidates that pass or may pass, as rows of a few numbers."""

    sets: Candidates
    certainty: NDArray[np.int64]  # PASSES, OPEN by estimated figures, or UNKNOWN by one that has no band
    figures: dict[str, Array]  # that objectives count
    lacking: NDArray[
        np.int64
    ]  # checks that are unknown, but for those that are so of all, and doublings up to their demands; 1 if any is open
    most: Array  # what the smallest margin of each is at most; infinite where that is not known
    passes: NDArray[np.bool_]  # none of its checks is unknown or open


class _Found(NamedTuple):
    """The same of some candidates, with the rejected."""

    examined: int
    sets: Candidates
    opened: NDArray[np.bool_]
    unknown: NDArray[np.uint64]  # checks, as bits, shape (rows, words)
    doublings: NDArray[np.int64]  # of known limits up to the demands, over these
    figures: dict[str, Array]
    most: Array
    failed_by: Counter[str]
    rejected: Candidates
    bound: Array  # the smallest margin of each of the rejected is no better


def sifted(
    problem: Problem,
    names: Set[str],
    progress: Progress | None,
    *,
    margins: bool = False,
    objective: Ranking | None = None,
    wanted: int = 0,
) -> tuple[Sifted, Candidates, Counts]:
    """The drives that pass or may pass, the closest rejected, and the counts."""
    every = pairs(problem)
    total, done, failed_by = len(every.motor) * len(problem.belt_ratios), 0, Counter[str]()
    kept: list[_Found] = []
    rejected = [(every.on(slice(0, 0)), np.zeros(0))]
    exact: Exactly = _wanted(names)
    if objective is not None and not exact and not margins and "margin" not in names and _is_long(problem):
        exact = "bounds"
    for one in _examined(problem, every, exact, margins or bool(exact)):
        failed_by.update(one.failed_by)
        kept.append(one)
        rejected = [_nearest(problem, [*rejected, (one.rejected, one.bound)])]
        done += one.examined
        if progress:
            progress(done, total)
    whole, undecided = _put_together(kept), 0
    if whole is not None and objective is not None and exact == "bounds":
        whole, undecided = _computed(problem, whole, objective, wanted)
        failed_by.update(whole.failed_by)
        rejected = [_nearest(problem, [*rejected, (whole.rejected, whole.bound)])]
    passing = _joined(problem, whole, every, names)
    tally = {name: count for name, count in failed_by.items() if count}
    opened = int(np.count_nonzero(passing.certainty == OPEN))
    left_out = (0 if whole is None else len(whole.unknown)) - len(passing.sets.motor)
    passes = int(np.count_nonzero(passing.passes))
    counts = Counts(
        considered=total, feasible=len(passing.sets.motor), passing=passes, left_out=left_out, open=opened,
        failed_by=tally, undecided=undecided,
    )  # fmt: skip
    return passing, rejected[0][0], counts


def examined_by(names: Set[str], margins: bool) -> tuple[Hashable, ...]:
    """All of objectives that ``sifted`` hangs on."""
    return _wanted(names), margins, bool(names & set(COUNTED))


def any_passes(problem: Problem) -> bool:
    """Whether any candidate passes or may pass: no more of them are examined than answer that."""
    every = pairs(problem)
    if problem.spec.select.unknown == "reject":
        return any((~one.unknown.any(axis=1)).any() for one in _examined(problem, every, False, False))
    uncertain = every.on(estimated(problem, every))
    favourable, unfavourable = at_ends(problem) if len(uncertain.motor) else (problem, problem)
    sides = ((favourable, every), (unfavourable, uncertain))
    chunks = ((side, some) for side, sets in sides for some, _ in _chunks(problem, sets))
    found = (one for side, some in chunks for one in examine(side, some, exact=False))
    return any(len(one.rows) for one in found)


def _examined(problem: Problem, every: Candidates, exact: Exactly, margins: bool) -> Iterator[_Found]:
    """Some of them after the other: all at the favourable end, where printed figures are as printed."""
    uncertain = estimated(problem, every)
    ends = both_ends(problem, every.on(uncertain)) if len(uncertain) else None
    for some, pairs_ in _chunks(problem, every):
        if ends is None:
            found = _together(examine(problem, some, exact=exact, margins=margins))
            yield _found(problem, some, found, np.zeros(len(found.rows), bool), margins)
        else:
            first, last = np.searchsorted(uncertain, (pairs_.start, pairs_.stop))
            few = uncertain[first:last] - pairs_.start
            twice = joined([some.pairs, ends.unfavourable(some.pairs.on(few))])
            both = Crossed(twice, some.belts, len(some.pairs.motor))
            examined = examine(ends.problem, both, exact=exact, margins=margins, offered=ends.offered)
            yield _at_both(problem, both, _together(examined), few, ends, margins)


def _together(found: Iterator[Examined]) -> Examined:
    """Candidates that were examined some at a time, put together; there is at least one."""
    several = list(found)
    if len(several) == 1:
        return several[0]
    whole = {name: np.concatenate([getattr(one, name) for one in several]) for name in (*_OF_ROWS, "rejected", "bound")}
    figures = {name: np.concatenate([one.figures[name] for one in several]) for name in several[0].figures}
    failed_by = sum((one.failed_by for one in several), Counter[str]())
    return Examined(checks=[], figures=figures, failed_by=failed_by, **whole)


def _found(problem: Problem, every: Crossed, one: Examined, opened: NDArray[np.bool_], margins: bool) -> _Found:
    """Some candidates as they were found, with the nearest of the rejected."""
    not_known = np.full_like(one.margin, np.inf)
    margin, most = (one.margin, not_known) if margins else (not_known, one.margin)
    figures = {name: one.figures[name] for name in COUNTED} | {"margin": margin}
    figures |= chosen(one.encoder, one.controller, one.brake, needs_encoder=not problem.spec.steps)
    figures[UNDECIDED] = one.figures.get(UNDECIDED, np.zeros(len(margin)))
    few = _closest(one.bound)
    failing = _nearest(problem, [(every.on(one.rejected[few]), one.bound[few])])
    count = len(every.counted.motor) * len(every.belts)
    return _Found(count, every.on(one.rows), opened, one.unknown, one.doublings, figures, most, one.failed_by, *failing)


def _closest(bound: Array) -> NDArray[np.int64]:
    """Rows that are as near to their limits as the nearest, as many as are kept and their equals."""
    if len(bound) <= _NEAREST:
        return np.arange(len(bound))
    farthest = -np.partition(-bound[-_SOME:], _NEAREST - 1)[_NEAREST - 1]  # of all the last is no farther
    last = -np.partition(-bound[bound >= farthest], _NEAREST - 1)[_NEAREST - 1]
    few = np.flatnonzero(bound >= last - _ALIKE * abs(last))  # rounding makes equals of no others
    far = rounded(-bound[few])
    near: NDArray[np.int64] = few[~(far > np.partition(far, _NEAREST - 1)[_NEAREST - 1])]
    return near


def _at_both(
    problem: Problem, every: Crossed, found: Examined, few: NDArray[np.int64], ends: BothEnds, margins: bool
) -> _Found:
    """Candidates that pass at the favourable end, then those of the other end alone; ``few`` pairs were at both."""
    count, row = len(every.counted.motor), found.rows % len(every.pairs.motor)
    at_hard = row >= count
    easy, hard = (_on_rows(found, np.flatnonzero(side)) for side in (~at_hard, at_hard))
    there = row[at_hard]
    hard = hard._replace(rows=hard.rows - there + few[there - count], brake=ends.brakes(hard.brake))
    place = np.searchsorted(easy.rows, hard.rows)  # rows rise
    both = np.append(easy.rows, -1)[place] == hard.rows
    opened = np.isin(row[~at_hard], few)
    whole = _at_the_unfavourable(easy, opened, place[both], _on_rows(hard, np.flatnonzero(both)))
    if not both.all():
        whole, opened = _with_others(whole, opened, _on_rows(hard, np.flatnonzero(~both)), len(every.pairs.motor))
    return _found(problem, every, whole, opened, margins)


def _at_the_unfavourable(
    easy: Examined, opened: NDArray[np.bool_], place: NDArray[np.int64], hard: Examined
) -> Examined:
    """Candidates that pass, with those that do so at both ends as they are at the unfavourable one: they are not open.

    But for those that lack other figures there.
    """
    unknown = easy.unknown[place]
    opened[place] = (unknown != hard.unknown).any(axis=1)
    if UNDECIDED in hard.figures:  # at either end
        hard.figures[UNDECIDED] = np.maximum(hard.figures[UNDECIDED], easy.figures[UNDECIDED][place])
    return easy._replace(
        unknown=put(easy.unknown, place, unknown & hard.unknown),
        margin=put(easy.margin, place, hard.margin),
        controller=put(easy.controller, place, hard.controller),
        brake=put(easy.brake, place, hard.brake),
        figures={name: put(column, place, hard.figures[name]) for name, column in easy.figures.items()},
    )


def _with_others(
    found: Examined, opened: NDArray[np.bool_], others: Examined, pairs_: int
) -> tuple[Examined, NDArray[np.bool_]]:
    """Candidates with those that pass at the unfavourable end alone, which come last behind each belt and are open."""
    kept = np.flatnonzero(~np.isin(found.rejected, others.rows))
    columns: dict[str, Any] = {
        name: np.concatenate([getattr(one, name) for one in (found, others)]) for name in _OF_ROWS
    }
    figures = {name: np.append(column, others.figures[name]) for name, column in found.figures.items()}
    whole = found._replace(figures=figures, rejected=found.rejected[kept], bound=found.bound[kept], **columns)
    by_belt = np.argsort(whole.rows // pairs_, kind="stable")
    return _on_rows(whole, by_belt), np.append(opened, np.ones(len(others.rows), bool))[by_belt]


def _on_rows(found: Examined, rows: NDArray[np.int64]) -> Examined:
    """Some of those that came through."""
    columns: dict[str, Any] = {name: getattr(found, name)[rows] for name in _OF_ROWS}
    return found._replace(figures={name: column[rows] for name, column in found.figures.items()}, **columns)


def _chunks(problem: Problem, every: Candidates) -> Iterator[tuple[Crossed, slice]]:
    """The candidates belt by belt, some at a time, and which pairs these are."""
    belts = problem.belt_ratios
    most = min(max(_CHUNK // max(len(every.motor), 1), 1), belts_together(problem))
    for some in np.array_split(np.array(belts), -(-len(belts) // most)):  # alike many at a time
        for start in range(0, len(every.motor), _CHUNK):
            rows = slice(start, start + _CHUNK)
            yield Crossed(every.on(rows), some.tolist()), rows


def _wanted(names: Set[str]) -> Wanted | bool:
    """Share of the waveform that objectives need of every drive: energy too, what has limits, or none of it."""
    return "energy" in names or (bool(names & _WAVEFORM) and "limits")


def _nearest(problem: Problem, several: list[tuple[Candidates, Array]]) -> tuple[Candidates, Array]:
    """The nearest of the rejected in several chunks; of those that are equally far the first by part number."""
    sets = joined([s for s, _ in several])
    bound = np.concatenate([b for _, b in several])
    rows = order(problem.catalog, sets, -bound, np.zeros(len(bound), np.int64))[:_NEAREST]
    return sets.on(rows), bound[rows]


def _is_long(problem: Problem) -> bool:
    """Whether a cycle has so many segments that no more drives are computed than are shown."""
    return max(len(case.at_belt.load_cycle.duration) for case in problem.cases) > _LONG


def _computed(problem: Problem, found: _Found, objective: Ranking, wanted: int) -> tuple[_Found, int]:
    """Drives that bounds leave open computed in the order of an objective, until so many before the next one pass.

    The rest of them is left out, and counted. Where no drive passes because of what all lack, a look at some says so.
    """
    catalog, failed_by = problem.catalog, Counter[str]()
    undecided = found.figures[UNDECIDED] > 0.0
    rank = order(catalog, found.sets, *values(catalog, found.sets, found.figures, objective))
    rows, segments = rank[undecided[rank]], max(len(case.at_belt.load_cycle.duration) for case in problem.cases)
    enough = max(_CELLS // segments, _SEEN, 4 * wanted)
    failed, opened = np.zeros(len(rank), bool), found.opened.copy()
    unknown, doublings, most = found.unknown.copy(), found.doublings.copy(), found.most.copy()
    figures, bound = {name: x.copy() for name, x in found.figures.items()}, np.full(len(rank), np.inf)
    start, size = 0, max(2 * wanted, _FIRST)
    while start < len(rows):
        of_all = np.bitwise_and.reduce(unknown[~(undecided | failed)], axis=0) if start >= enough else np.uint64(0)
        passes = ~(undecided | failed | opened | (unknown & ~of_all).any(axis=1))
        if np.count_nonzero(passes[rank[: int(np.argmax(rank == rows[start]))]]) >= wanted:
            break
        some = rows[start : start + size]
        one = by_physics(problem, found.sets.on(some), False)  # at least those that bounds leave open
        checks = [check for check in one.checks if not check.advice]
        failed_by.update({check.name: int(np.count_nonzero(check.failed)) for check in checks})
        known = [c if c.opened is None else replace(c, passed=c.passed | c.opened) for c in checks]
        opens = [c.opened for c in checks if c.opened is not None]
        opened[some] = np.logical_or.reduce(opens) if opens else False
        failed[some], undecided[some] = one.failed, False
        amount = amounting(known, len(some), False)
        unknown[some], doublings[some], most[some] = amount.unknown, amount.doublings, smallest_margin(one.checks)
        bound[some] = bound_of(checks, len(some))
        for name, x in chosen(one.encoder, one.controller, one.brake, needs_encoder=not problem.spec.steps).items():
            figures[name][some] = x
        start, size = start + size, 2 * size
    left, out = np.flatnonzero(~(failed | undecided)), np.flatnonzero(failed)
    figures = {name: x[left] for name, x in figures.items()}
    return found._replace(
        sets=found.sets.on(left), opened=opened[left], unknown=unknown[left], doublings=doublings[left],
        figures=figures, most=most[left], failed_by=failed_by, rejected=found.sets.on(out), bound=bound[out],
    ), int(np.count_nonzero(undecided))  # fmt: skip


def _put_together(kept: list[_Found]) -> _Found | None:
    """All that pass or may pass."""
    if not kept:
        return None
    names = ("opened", "unknown", "doublings", "most")
    columns: Any = {name: np.concatenate([getattr(k, name) for k in kept]) for name in names}
    figures = {name: np.concatenate([k.figures[name] for k in kept]) for name in kept[0].figures}
    return kept[0]._replace(sets=joined([k.sets for k in kept]), figures=figures, **columns)


def _joined(problem: Problem, found: _Found | None, every: Candidates, names: Set[str]) -> Sifted:
    """All that pass or may pass; of estimated figures those that objectives count are at the middle of the band."""
    if found is None:
        none = every.on(slice(0, 0))
        nothing = np.zeros(0, np.int64)
        figures = dict.fromkeys((*COUNTED, "margin"), none.belt) | chosen(nothing, nothing, nothing, needs_encoder=True)
        return Sifted(none, nothing, figures, nothing, none.belt, nothing == 0)
    sets, opened, unknown, most, figures = found.sets, found.opened, found.unknown, found.most, found.figures
    doublings = found.doublings
    rows = estimated(problem, sets)
    if names & set(COUNTED) and len(rows):
        middle = figures_by_physics(problem, sets.on(rows), _wanted(names) or True)
        for name in COUNTED:
            figures[name][rows] = middle[name]
    known = ~unknown.any(axis=1)
    if problem.spec.select.unknown == "reject":
        nothing = np.zeros(len(opened), np.int64)
        return _on(Sifted(sets, opened * OPEN, figures, nothing, most, ~opened), np.flatnonzero(known))
    own = unknown & ~np.bitwise_and.reduce(unknown, axis=0)  # what all lack sets none back
    lacking = np.unpackbits(own.view(np.uint8), axis=1).sum(axis=1, dtype=np.int64)
    lacking += doublings + (opened & (lacking > 0))  # some checks of these are open besides
    certainty = np.where(lacking > 0, UNKNOWN, np.where(opened, OPEN, PASSES))
    return Sifted(sets, certainty, figures, lacking, most, known & ~opened)


def _on(found: Sifted, rows: NDArray[np.int64]) -> Sifted:
    figures = {name: column[rows] for name, column in found.figures.items()}
    columns = (getattr(found, name)[rows] for name in ("lacking", "most", "passes"))
    return Sifted(found.sets.on(rows), found.certainty[rows], figures, *columns)
