"""Of all candidates those that pass or may pass, and the closest rejected; how certain it is, before they rank.

Candidates are examined in chunks, behind some belts at a time: those that pass are kept as rows of a few numbers, the
rejected only while they are among the closest, so that memory grows with the drives that pass. All are examined at the
favourable end of the bands of estimated figures; those that have any once more at the other end: a drive passes where
it passes at both, is open where at one, and fails where at none. Over long cycles no more waveforms are computed than
it takes, in the order of the objective, until enough pass.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.physics.figures import Alike, Array, Mask, Whole, joined, on
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates, Crossed, pairs
from drivesizer.search.columns.controllers import OVER_WAVEFORM, UNDECIDED
from drivesizer.search.columns.evaluation import at_ends, by_physics, estimated, figures_by_physics
from drivesizer.search.columns.limits_over_time import Waveform
from drivesizer.search.columns.stages import Drives, Examined, amount_of, belts_together, bits_of, examine, offers
from drivesizer.search.open_checks import passing
from drivesizer.search.ranking import COUNTED, order, part_rows, rounded
from drivesizer.spec.drive import OBJECTIVES

Progress = Callable[[int, int], None]  # drives examined, drives in all
PASSES, OPEN, UNKNOWN = range(3)  # certainty
_WAVEFORM = {name for name, declared in OBJECTIVES.items() if declared.by_waveform}
_CHUNK = 1 << 20  # drives at a time
_NEAREST = 32  # of the rejected, kept until all are known; as many of those with estimated figures
_LATEST = 1 << 12  # of the rejected, among which the farthest that may be kept is found
# segments of a cycle, and candidates times these, up to which all drives that bounds leave open are computed
_LONG, _MANY = 1 << 14, 200_000_000
_CELLS = 50_000_000  # drives times segments that are computed before none is said to pass but for what all lack
_FIRST, _CELLS_AT_FIRST, _SEEN = (
    32,
    10_000_000,
    200,
)  # drives, and these, that are computed at first; before that is said
_NAMED = 8  # of those that lack figures, at first
_ALIKE = 1e-7  # share of a margin within which rounding makes others equal


class Passing(NamedTuple):
    """Candidates that pass or may pass, as rows of a few numbers."""

    sets: Candidates
    certainty: Whole  # PASSES, OPEN by estimates or ranges, or UNKNOWN by a figure of which no end is known
    figures: dict[str, Array]  # that objectives count
    # of the unknown checks that are so, but for those that are so of all, of the open ones that are, and doublings of
    # limits up to their demands; of what is open by estimates the most
    lacking: Whole
    most: Array  # what the smallest margin of each is at most; infinite where that is not known
    passes: Mask  # none of its checks is unknown or open


class _Survivors(NamedTuple):
    """Candidates that came through all stages."""

    sets: Candidates
    drives: Drives
    opened: Mask  # by estimated figures


class _Rejected(NamedTuple):
    """Candidates that failed."""

    sets: Candidates
    bound: Array  # the smallest margin of each is no better


def sifted(
    problem: Problem,
    *,
    pareto: Sequence[str] = (),
    progress: Progress | None = None,
    margins: bool = False,
    enough: int = 0,
    known: bool = False,
) -> tuple[Passing, Candidates, Counts]:
    """The drives that pass or may pass, the closest rejected, and the counts.

    ``enough``: so many of a long cycle are enough, in the order of the objective; 0 all. ``known``: without those that
    figures leave unknown, which are not counted either.
    """
    all_sets, names = pairs(problem), {*problem.spec.select.weights, *pareto}
    waveform: Waveform = "all" if "energy" in names else "limits" if names & _WAVEFORM else "open"
    total, segments = len(all_sets.motor) * len(problem.belt_ratios), problem.segments
    lazy = waveform == "open" and enough > 0 and not margins and (segments > _LONG or total * segments > _MANY)
    margins = margins or waveform != "open"
    done, undecided = 0, 0
    failed_by, batches = Counter[str](), list[_Survivors]()
    rejected = _Rejected(all_sets.on(slice(0, 0)), np.zeros(0))
    for chunk, result, opened in _examined(problem, all_sets, "bounds" if lazy else waveform, margins, known):
        failed_by.update(result.failed_by)
        batches.append(_Survivors(chunk.on(result.drives.rows), result.drives, opened))
        near = _closest_of_both(problem, chunk, result)
        rejected = _nearest(problem, rejected, _Rejected(chunk.on(result.rejected[near]), result.bound[near]))
        done += len(chunk.pairs.motor) * len(chunk.belts)
        if progress:
            progress(done, total)
    left_out = 0
    if batches:
        survivors = joined(batches)
        figures = survivors.drives.figures | part_rows(survivors.drives, needs_encoder=not problem.spec.steps)
        figures["margin"] = survivors.drives.amount.margin if margins else np.full(len(survivors.opened), np.inf)
        survivors = survivors._replace(drives=survivors.drives._replace(figures=figures))
        if lazy:
            survivors, out, by, undecided = _computed_in_order(problem, survivors, enough)
            failed_by.update(by)
            rejected = _nearest(problem, rejected, out)
        drives = _known_of(problem, survivors, margins, "open" if lazy else waveform, names)
        left_out = len(survivors.opened) - len(drives.passes)
    else:
        none = np.zeros(0, np.int64)
        figures = dict.fromkeys((*COUNTED, "margin", "encoder", "controller", "brake"), np.zeros(0))
        drives = Passing(all_sets.on(none), none, figures, none, np.zeros(0), none == 0)
    counts = Counts(
        considered=total, feasible=len(drives.passes), passing=int(np.count_nonzero(drives.passes)), left_out=left_out,
        open=int(np.count_nonzero(drives.certainty == OPEN)), undecided=undecided,
        failed_by={name: count for name, count in failed_by.items() if count},
    )  # fmt: skip
    return drives, rejected.sets, counts


def any_passes(problem: Problem) -> bool:
    """Whether any candidate passes or may pass: no more of them are examined than answer that."""
    all_sets = pairs(problem)
    if problem.spec.select.unknown == "reject":
        unknowns = (
            result.drives.amount.unknown for _, result, _ in _examined(problem, all_sets, "open", False, known=True)
        )
        return any((~unknown.any(axis=1)).any() for unknown in unknowns)
    uncertain = all_sets.on(estimated(problem, all_sets))
    favourable, unfavourable = at_ends(problem) if len(uncertain.motor) else (problem, problem)
    for side, sets in ((favourable, all_sets), (unfavourable, uncertain)):
        for chunk, _ in _chunks(problem, sets):
            if any(len(result.drives.rows) for result in examine(side, chunk, waveform="open")):
                return True
    return False


def _examined(
    problem: Problem, all_sets: Candidates, waveform: Waveform, margins: bool, known: bool = False
) -> Iterator[tuple[Crossed, Examined, Mask]]:
    """Some of them after the other: all at the favourable end of the bands, those that hang on one at the other too.

    With each which of what came through is open.
    """
    uncertain = _uncertain(problem, all_sets)
    favourable, unfavourable = at_ends(problem) if uncertain.any() else (problem, problem)
    offered = offers(favourable), offers(unfavourable) if uncertain.any() else None
    for chunk, rows in _chunks(problem, all_sets):
        easy = _together(
            examine(favourable, chunk, waveform=waveform, margins=margins, offered=offered[0], known=known)
        )
        few = np.flatnonzero(uncertain[rows])
        if not len(few):
            yield chunk, easy, np.zeros(len(easy.drives.rows), bool)
            continue
        subset = Crossed(chunk.pairs.on(few), chunk.belts)
        hard = _together(examine(unfavourable, subset, waveform=waveform, margins=margins, offered=offered[1]))
        belt, row = np.divmod(hard.drives.rows, len(few))
        hard = hard._replace(drives=hard.drives._replace(rows=belt * len(chunk.pairs.motor) + few[row]))
        yield chunk, *_at_both(easy, hard, np.isin(easy.drives.rows % len(chunk.pairs.motor), few))


def _together(results: Iterable[Examined]) -> Examined:
    """Candidates that were examined some at a time, put together; there is at least one."""
    drives, _, failed_by, rejected, bound = zip(*results, strict=True)
    return Examined(
        joined(drives), [], sum(failed_by, Counter[str]()), np.concatenate(rejected), np.concatenate(bound)
    )  # fmt: skip


def _at_both(easy: Examined, hard: Examined, opened: Mask) -> tuple[Examined, Mask]:
    """Candidates that fail at one end of the bands at most, as at the unfavourable one where they do not fail there.

    Those that fail at neither, and lack the same figures at both, are not open.
    """
    at, end = easy.drives, hard.drives
    _, here, there = np.intersect1d(at.rows, end.rows, assume_unique=True, return_indices=True)
    differs = np.ones(len(end.rows), bool)
    differs[there] = (at.amount.unknown[here] != end.amount.unknown[there]).any(axis=1)
    end.amount.unknown[there] &= at.amount.unknown[here]
    end.amount.opened[there] = np.maximum(end.amount.opened[there], at.amount.opened[here])
    end.amount.doublings[there] = at.amount.doublings[here]
    end.figures[UNDECIDED][there] = np.maximum(end.figures[UNDECIDED][there], at.figures[UNDECIDED][here])
    alone, still = np.setdiff1d(np.arange(len(at.rows)), here), ~np.isin(easy.rejected, end.rows)
    whole = joined([on(at, alone), end])
    in_order = np.argsort(whole.rows)
    result = easy._replace(drives=on(whole, in_order), rejected=easy.rejected[still], bound=easy.bound[still])
    return result, np.concatenate([opened[alone], differs])[in_order]


def _chunks(problem: Problem, all_sets: Candidates) -> Iterator[tuple[Crossed, slice]]:
    """The candidates belt by belt, some at a time, and which pairs these are."""
    belts = problem.belt_ratios
    most = min(max(_CHUNK // max(len(all_sets.motor), 1), 1), belts_together(problem))
    for ratios in np.array_split(np.array(belts), -(-len(belts) // most)):  # alike many at a time
        for start in range(0, len(all_sets.motor), _CHUNK):
            rows = slice(start, start + _CHUNK)
            yield Crossed(all_sets.on(rows), ratios.tolist()), rows


def _closest_of_both(problem: Problem, chunk: Crossed, result: Examined) -> Whole:
    """The closest of the rejected with estimated figures, and of those without.

    What hangs on estimated figures is bounded by their favourable end, which may be far from the middle.
    """
    hangs = _uncertain(problem, chunk.pairs)[result.rejected % len(chunk.pairs.motor)]
    kinds = np.flatnonzero(~hangs), np.flatnonzero(hangs)
    return np.concatenate([rows[_closest(result.bound[rows])] for rows in kinds])


def _uncertain(problem: Problem, sets: Candidates) -> Mask:
    """Mask of the candidates that have an estimated figure."""
    mask = np.zeros(len(sets.motor), bool)
    mask[estimated(problem, sets)] = True
    return mask


def _closest(bound: Array) -> Whole:
    """Rows that are as near to their limits as the nearest, as many as are kept and their equals."""
    if len(bound) <= _NEAREST:
        return np.arange(len(bound))
    farthest = -np.partition(-bound[-_LATEST:], _NEAREST - 1)[_NEAREST - 1]  # of all the last is no farther
    last = -np.partition(-bound[bound >= farthest], _NEAREST - 1)[_NEAREST - 1]
    few = np.flatnonzero(bound >= last - _ALIKE * abs(last))  # rounding makes equals of no others
    far = rounded(-bound[few])
    return few[~(far > np.partition(far, _NEAREST - 1)[_NEAREST - 1])]


def _nearest(problem: Problem, rejected: _Rejected, other: _Rejected) -> _Rejected:
    """The nearest of the rejected of two; of those that are equally far the first by part number."""
    union = joined([rejected, other])
    rows = order(problem.catalog, union.sets, -union.bound, np.zeros(len(union.bound), np.int64))
    hangs = _uncertain(problem, union.sets)[rows]
    number = np.where(hangs, np.cumsum(hangs), np.cumsum(~hangs))  # of each kind by itself
    return on(union, rows[number <= _NEAREST])


def _computed_in_order(
    problem: Problem, survivors: _Survivors, number: int
) -> tuple[_Survivors, _Rejected, Counter[str], int]:
    """Drives that bounds leave open computed in the order of an objective, until so many before the next one pass.

    The rest of them is left out, and counted. Where no drive passes because of what all lack, a look at some says so.
    """
    catalog, objective, sets, drives = problem.catalog, problem.spec.select.objective, survivors.sets, survivors.drives
    undecided, failed, opened = (
        drives.figures[UNDECIDED] > 0.0,
        np.zeros(len(survivors.opened), bool),
        survivors.opened.copy(),
    )
    certain = drives.amount.unknown & ~bits_of(OVER_WAVEFORM)
    own = (certain & ~np.bitwise_and.reduce(certain, axis=0)).any(axis=1)
    # none of these passes, whatever the waveform says, but for what all lack
    lacks = (drives.figures[UNDECIDED] > 1.0) | opened | own
    lacks &= not lacks[undecided].all()
    amount = drives.amount._replace(**{name: x.copy() for name, x in drives.amount._asdict().items()})
    figures = {name: x.copy() for name, x in drives.figures.items()}
    enough, seen = max(_CELLS // problem.segments, _SEEN, 4 * number), 0
    size = max(2 * number, min(_FIRST, _CELLS_AT_FIRST // problem.segments))
    failed_by = Counter[str]()
    while undecided.any():
        # anew, for with its waveform a drive may need a heavier controller
        value, missing = ranking.values(catalog, sets, figures, objective)
        of_all: Alike = np.uint64(0)
        if seen >= enough:
            of_all = np.bitwise_and.reduce(amount.unknown[~(undecided | failed)], axis=0)
        passes = ~(undecided | failed | opened | (amount.opened > 0) | (amount.unknown & ~of_all).any(axis=1))
        rank, value = order(catalog, sets, value, missing, before=[lacks]), rounded(value)
        rows = rank[undecided[rank]][:size]
        first = rows[0]
        better = (missing < missing[first]) | ((missing == missing[first]) & (value <= value[first]))
        if np.count_nonzero(passes & (better | lacks[first])) >= number:
            break
        if not seen:  # the best of those is named beside the first that passes
            others = np.flatnonzero(undecided & lacks)
            few = order(catalog, sets.on(others), value[others], missing[others])[:_NAMED]
            rows = np.union1d(rows, others[few])
        evaluation = by_physics(problem, sets.on(rows), "open")
        checks = [check for check in evaluation.checks if not check.advice]
        failed_by.update({check.name: int(np.count_nonzero(check.failed)) for check in checks})
        opened[rows] = False
        for check in checks:
            opened[rows] |= False if check.least is None else check.opened & ~np.isnan(check.least)
        failed[rows], undecided[rows] = evaluation.failed, False
        for column, computed in zip(amount, amount_of(checks, len(rows)), strict=True):
            column[rows] = computed
        for name, x in part_rows(evaluation, needs_encoder=not problem.spec.steps).items():
            figures[name][rows] = x
        seen, size = seen + len(rows), 2 * size
    left, out = np.flatnonzero(~(failed | undecided)), np.flatnonzero(failed)
    survivors = _Survivors(sets, drives._replace(amount=amount, figures=figures), opened)
    return on(survivors, left), _Rejected(sets.on(out), amount.margin[out]), failed_by, int(np.count_nonzero(undecided))


def _known_of(problem: Problem, survivors: _Survivors, margins: bool, waveform: Waveform, names: set[str]) -> Passing:
    """All that pass or may pass; of estimated figures those that objectives count are at the middle of the band."""
    sets, (_, amount, *_, figures), opened = survivors
    rows = estimated(problem, sets)
    if names & set(COUNTED) and len(rows):
        middle = figures_by_physics(problem, sets.on(rows), "all" if waveform == "open" else waveform)
        for name in COUNTED:
            figures[name][rows] = middle[name]
    most = np.full(len(opened), np.inf) if margins else amount.margin
    known, by_range = ~amount.unknown.any(axis=1), amount.opened > 0
    own = amount.unknown & ~np.bitwise_and.reduce(amount.unknown, axis=0)  # what all lack sets none back
    lacking = np.unpackbits(own.view(np.uint8), axis=1).sum(axis=1, dtype=np.int64)
    lacks = (lacking > 0) | (~known & (amount.doublings > 0))
    certainty = np.where(lacks, UNKNOWN, np.where(opened | by_range, OPEN, PASSES))
    near = np.where(opened, _TENTHS - 1, np.minimum(amount.opened + amount.doublings, _TENTHS - 1))
    lacking = np.where(certainty == OPEN, near, lacking + amount.opened + amount.doublings + (opened & (lacking > 0)))
    lacking[certainty == PASSES] = 0
    drives = Passing(sets, certainty, figures, lacking, most, known & ~opened & ~by_range)
    return on(drives, np.flatnonzero(known)) if problem.spec.select.unknown == "reject" else drives


# -- Order of drives before their margins count.
#
# Before the objective goes the certainty that a drive passes: of open ones how probable it is, of unknown ones how
# few checks are undecided and how few times a known limit must be doubled for them.


_CELLS_OF_RANK = 50_000  # drives times pieces of the load cycle, of which margins are computed to order equals
_SAMPLED = 32  # open drives at most
_HARDLY = 4  # unknown checks behind which one stands that passes in less than a tenth of its band ...
_ONCE = 0.02  # ... and behind so many more one that passes hardly once in it
_TENTHS = 12  # places for tenths of a probability, and for what is not sampled


class Rank(NamedTuple):
    """Columns over drives that pass or may pass: less is better, the first one first."""

    precedence: Whole  # certainty; of open drives how probable it is that none fails, of unknown how few
    missing: Whole  # parts of which the objective is unknown
    value: Array  # of the objective

    @property
    def columns(self) -> Array:
        """All of them, where rounding makes no difference: shape (3, drives)."""
        return np.stack([self.precedence, self.missing, rounded(self.value)])

    def order(
        self, catalog: Catalog, sets: Candidates, rows: Whole | slice = slice(None), margin: Array | None = None
    ) -> Whole:
        """Some drives from best to worst, by their places among these."""
        before = [self.precedence[rows]]
        return order(catalog, sets.on(rows), self.value[rows], self.missing[rows], before=before, margin=margin)


def ranked(problem: Problem, drives: Passing, top: int) -> Rank:
    """Columns that order the drives that pass or may pass.

    Of open checks as many drives are sampled as an order of those shown needs. An open drive is placed by tenths of the
    probability that it passes, an unknown one whose open checks hardly pass behind one of which more is unknown.
    """
    value, missing = ranking.values(problem.catalog, drives.sets, drives.figures, problem.spec.select.objective)
    precedence = _TENTHS * drives.certainty + drives.lacking
    opened = drives.certainty == OPEN
    count = max(min(_SAMPLED, waveforms(problem)), top)
    ahead = np.count_nonzero(drives.certainty == PASSES)
    for rows in (np.flatnonzero(opened), np.flatnonzero(drives.certainty == UNKNOWN)):
        if len(rows) and np.count_nonzero(drives.certainty != PASSES) > 1 and ahead < top:
            before = [precedence[rows]]
            best = rows[order(problem.catalog, drives.sets.on(rows), value[rows], missing[rows], before=before)][:count]
            probable = _probabilities(problem, drives.sets.on(best))
            tenths = (10.0 * np.nan_to_num(probable, nan=1.0)).astype(np.int64)
            hardly = np.where(opened[best], _TENTHS * UNKNOWN, precedence[best]) + _HARDLY
            by_samples = opened[best] & ~np.isnan(probable)
            likely = np.where(by_samples, _TENTHS * (OPEN + 1) - 1 - tenths, precedence[best])
            precedence[best] = np.where(tenths == 0, hardly + _HARDLY * (probable < _ONCE), likely)
        ahead += np.count_nonzero(precedence[rows] < _TENTHS * UNKNOWN)
    return Rank(precedence, missing, value)


def _probabilities(problem: Problem, sets: Candidates) -> Array:
    """Probability that the checks of each drive pass together that estimates leave open; NaN of drives without any."""
    few, probabilities = by_physics(problem, sets, "open"), np.full(len(sets.motor), np.nan)
    names = {place: checks for place in range(len(probabilities)) if (checks := few.sampled_checks(place))}
    if names:
        places = np.array(list(names))
        probabilities[places] = [
            shares[""] for shares in passing(problem, few.with_parts(places), list(names.values()), exact=False)
        ]
    return probabilities


def waveforms(problem: Problem) -> int:
    """Number of drives whose waveforms may be computed to order them."""
    return _CELLS_OF_RANK // problem.segments


_HELD_BACK = 5  # drives that missing figures keep from being the first, which are named


def better_but_unknown(problem: Problem, drives: Passing, rank: Rank, best: Whole) -> Whole:
    """The best, of a motor each, that are better than the first shown and stand behind it for missing figures alone."""
    if not len(best) or drives.certainty[best[0]] != PASSES:
        return best[:0]
    first, leader = rounded(rank.value), best[0]
    better = (rank.missing <= rank.missing[leader]) & (first < first[leader])
    rows = np.flatnonzero((drives.certainty != PASSES) & better)
    least = [drives.certainty[rows], drives.lacking[rows]]
    rows = rows[order(problem.catalog, drives.sets.on(rows), rank.value[rows], rank.missing[rows], before=least)]
    motors = np.unique(drives.sets.motor[rows], return_index=True)[1]
    return rows[np.sort(motors)[:_HELD_BACK]]
