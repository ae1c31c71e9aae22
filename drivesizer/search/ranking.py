"""Ranking: objectives as columns, the order of drives by them; candidates sifted for those that pass."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError, quoted
from drivesizer.physics.extremes import undominated
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts, multiples, used_share
from drivesizer.search.columns.candidates import Candidates, Crossed, amounting, bound_of, joined, pairs
from drivesizer.search.columns.evaluation import (
    at_ends,
    by_physics,
    estimated,
    figures_by_physics,
    smallest_margin,
)
from drivesizer.search.columns.limits_over_time import Exactly, Wanted
from drivesizer.search.columns.offers import CONTROLLING, bought, chosen, offers
from drivesizer.search.columns.powered import UNDECIDED
from drivesizer.search.columns.stages import Examined, belts_together, examine
from drivesizer.search.open_checks import passing
from drivesizer.spec.drive import OBJECTIVES, Ranking, Weighted
from drivesizer.units.kinds import RANGES

# -- Ranking: objectives as columns, the order of drives by them, and the Pareto front.


Array = NDArray[np.float64]
COUNTED = tuple(name for name, declared in OBJECTIVES.items() if not declared.over and name != "margin")
_BEHIND = len(CONTROLLING) + 1  # so that what is unknown of a motor goes before what is of all else
_DIGITS = 9  # in which equal objectives agree


def objective_of(text: str) -> Ranking:
    """An objective as the command line gives it: a name, or names with weights such as ``mass=2,price=1``."""
    parts = [part.partition("=") for part in text.split(",")]
    for name, _, _ in parts:
        if name.strip() not in OBJECTIVES:
            raise InputError(f"objective {quoted(name.strip())} is not known; expected {', '.join(OBJECTIVES)}")
    names = [name.strip() for name, _, _ in parts]
    if twice := [name for name in names if names.count(name) > 1]:
        raise InputError(f"objective {quoted(twice[0])} is given twice; expected each once, e.g. mass=2,price=1")
    if len(parts) == 1 and not parts[0][1]:
        return names[0]
    found, (least, most) = [], RANGES["dimensionless"]
    for name, equals, weight in parts:
        try:
            value = float(weight) if equals else 1.0
        except ValueError:
            value = np.nan
        if not least <= value <= most:  # written so that NaN fails too
            said = f"weight {quoted(weight)} is not a number above 0 ({least:g} to {most:g})"
            raise InputError(f"objective {quoted(name)}: {said}, e.g. mass=2")
        found.append(Weighted.model_validate({"objective": name.strip(), "weight": value}))
    return found


def title_of(objective: Ranking) -> str:
    """An objective in a word or a line.

    >>> title_of("mass"), title_of(objective_of("mass=2,price=1"))
    ('mass', '2 mass + 1 price')
    """
    if isinstance(objective, str):
        return objective
    return " + ".join(f"{part.weight:g} {part.objective}" for part in objective)


def values(
    catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], objective: Ranking
) -> tuple[Array, NDArray[np.int64]]:
    """An objective of each drive, less is better, and of how many parts it is unknown."""
    if isinstance(objective, str):
        value, missing = single(catalog, sets, figures, objective)
        if objective == "price" and missing.any():  # what is known of a price says nothing of the rest of it
            value = np.where(missing > 0, single(catalog, sets, figures, "mass")[0], value)
        return value, _BEHIND * missing + controlling_unknown(catalog, sets, figures, objective)
    total, missing = np.zeros(len(sets.motor)), np.zeros(len(sets.motor), np.int64)
    for part in objective:
        value, lacking = single(catalog, sets, figures, part.objective)
        if OBJECTIVES[part.objective].more_is_better:  # a margin, counted as what is used of the limit
            value = used_share(-value)
        total += part.weight * multiples(value, lacking == 0)
        missing += lacking
    return total, missing


def single(
    catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], name: str
) -> tuple[Array, NDArray[np.int64]]:
    """One objective of each drive as far as it is known, less is better, and what is unknown of it."""
    declared = OBJECTIVES[name]
    if not declared.over:
        value = np.where(np.isinf(figures[name]), np.nan, -figures[name]) if declared.more_is_better else figures[name]
        return np.nan_to_num(value, nan=0.0), np.isnan(value).astype(np.int64)
    found = bought(catalog, sets, figures, declared.figure, declared.over, 0 if catalog.ends else None)
    turning = [role not in CONTROLLING for role in declared.over]
    total = np.nansum(found, 0)
    return -total if declared.more_is_better else total, np.isnan(found[turning]).sum(0)


def controlling_unknown(
    catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], objective: str
) -> NDArray[np.int64]:
    """Number of encoder and controller of each drive of which an objective is unknown."""
    declared = OBJECTIVES[objective]
    over = [role for role in declared.over if role in CONTROLLING]
    unknown: NDArray[np.int64] = np.isnan(
        bought(catalog, sets, figures, declared.figure, over, 0 if catalog.ends else None)
    ).sum(0)
    return unknown


def order(
    catalog: Catalog,
    sets: Candidates,
    value: Array,
    missing: NDArray[np.int64],
    before: Sequence[NDArray[Any]] = (),
    margin: Array | None = None,
) -> NDArray[np.int64]:
    """Drives from best to worst.

    An objective that is known of all parts goes before one that is not, then the better one, then the larger smallest
    margin where that is at hand, then part numbers: the same input gives the same order.
    """
    return np.lexsort((
        sets.belt,
        catalog.gearheads.alphabetical[sets.gearhead],
        catalog.motors.alphabetical[sets.motor],
        np.zeros(len(value)) if margin is None else rounded(-np.nan_to_num(margin, nan=-np.inf)),
        rounded(value),
        missing,
        *reversed(before),
    )).astype(np.int64)  # fmt: skip


def rounded(value: Array) -> Array:
    """Values of which those that differ by rounding alone are equal."""
    with np.errstate(divide="ignore", invalid="ignore"):
        place = 10.0 ** (_DIGITS - np.ceil(np.log10(np.abs(value))))
        found: Array = np.round(value * place) / place
    return np.where(np.isfinite(found), found, value)


def front(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], names: Sequence[str]) -> NDArray[np.int64]:
    """Drives that no other drive equals or beats in every one of several objectives, in order of the first.

    Drives of which one of the objectives is not wholly known are left out.
    """
    columns = [single(catalog, sets, figures, name) for name in names]
    known = np.flatnonzero(sum(missing for _, missing in columns) == 0)
    values_ = np.stack([rounded(value[known]) for value, _ in columns], axis=1)
    ordered = order(catalog, sets.on(known), values_[:, 0], np.zeros(len(known), np.int64))
    best = ordered[np.sort(undominated(-values_[ordered]))]
    found: NDArray[np.int64] = known[best]
    return found


# -- Of all candidates those that pass or may pass, and the closest rejected: in chunks, behind some belts at a time.
#
# Candidates are examined at the favourable end of the bands of estimated figures; those that have any once more at
# the other end: it passes where it passes at both, is open where at one, and fails where at none.


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
_NAMED = 8  # of those that lack figures, at first
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
    *,
    pareto: Sequence[str] = (),
    progress: Progress | None = None,
    margins: bool = False,
    wanted: int = 0,
) -> tuple[Sifted, Candidates, Counts]:
    """The drives that pass or may pass, the closest rejected, and the counts.

    ``wanted``: so many of a long cycle are enough, in the order of the objective; 0 all.
    """
    every, names = pairs(problem), {*problem.spec.select.weights, *pareto}
    total, done, failed_by = len(every.motor) * len(problem.belt_ratios), 0, Counter[str]()
    kept: list[_Found] = []
    rejected = [(every.on(slice(0, 0)), np.zeros(0))]
    exact: Exactly = _wanted(names)
    if wanted and not exact and not margins and "margin" not in names and _is_long(problem):
        exact = "bounds"
    for one in _examined(problem, every, exact, margins or bool(exact)):
        failed_by.update(one.failed_by)
        kept.append(one)
        rejected = [_nearest(problem, [*rejected, (one.rejected, one.bound)])]
        done += one.examined
        if progress:
            progress(done, total)
    whole, undecided = _put_together(kept), 0
    if whole is not None and exact == "bounds":
        whole, undecided = _computed(problem, whole, wanted)
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
    """Some of them after the other: all at the favourable end of the bands, those that hang on one at the other too."""
    uncertain = np.zeros(len(every.motor), bool)
    uncertain[estimated(problem, every)] = True
    favourable, unfavourable = at_ends(problem) if uncertain.any() else (problem, problem)
    offered = offers(favourable), offers(unfavourable) if uncertain.any() else None
    for some, rows in _chunks(problem, every):
        found = _together(examine(favourable, some, exact=exact, margins=margins, offered=offered[0]))
        opened, few = np.zeros(len(found.rows), bool), np.flatnonzero(uncertain[rows])
        if len(few):
            opened = np.isin(found.rows % len(some.pairs.motor), few)
            again = Crossed(some.pairs.on(few), some.belts)
            hard = _together(examine(unfavourable, again, exact=exact, margins=margins, offered=offered[1]))
            belt, row = np.divmod(hard.rows, len(few))
            found, opened = _at_both(found, opened, hard._replace(rows=some.number(belt, few[row])))
        yield _found(problem, some, found, opened, margins)


def _together(found: Iterable[Examined]) -> Examined:
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
    count = len(every.pairs.motor) * len(every.belts)
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


def _at_both(easy: Examined, opened: NDArray[np.bool_], hard: Examined) -> tuple[Examined, NDArray[np.bool_]]:
    """Candidates that fail at one end of the bands at most, as at the unfavourable one where they do not fail there.

    Those that fail at neither, and lack the same figures at both, are not open.
    """
    _, here, there = np.intersect1d(easy.rows, hard.rows, assume_unique=True, return_indices=True)
    of_hard = np.ones(len(hard.rows), bool)
    of_hard[there] = (easy.unknown[here] != hard.unknown[there]).any(axis=1)
    hard.unknown[there] &= easy.unknown[here]
    hard.doublings[there] = easy.doublings[here]
    if UNDECIDED in hard.figures:  # at either end
        hard.figures[UNDECIDED][there] = np.maximum(hard.figures[UNDECIDED][there], easy.figures[UNDECIDED][here])
    left, kept = np.setdiff1d(np.arange(len(easy.rows)), here), ~np.isin(easy.rejected, hard.rows)
    whole = _together(
        [
            _on_rows(easy, left)._replace(rejected=easy.rejected[kept], bound=easy.bound[kept]),
            hard._replace(rejected=hard.rejected[:0], bound=hard.bound[:0], failed_by=Counter()),
        ]
    )
    in_order = np.argsort(whole.rows)
    return _on_rows(whole, in_order), np.concatenate([opened[left], of_hard])[in_order]


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


def _computed(problem: Problem, found: _Found, wanted: int) -> tuple[_Found, int]:
    """Drives that bounds leave open computed in the order of an objective, until so many before the next one pass.

    The rest of them is left out, and counted. Where no drive passes because of what all lack, a look at some says so.
    """
    catalog, failed_by = problem.catalog, Counter[str]()
    undecided = found.figures[UNDECIDED] > 0.0
    segments = max(len(case.at_belt.load_cycle.duration) for case in problem.cases)
    enough = max(_CELLS // segments, _SEEN, 4 * wanted)
    failed, opened = np.zeros(len(undecided), bool), found.opened.copy()
    unknown, doublings, most = found.unknown.copy(), found.doublings.copy(), found.most.copy()
    figures, bound = {name: x.copy() for name, x in found.figures.items()}, np.full(len(undecided), np.inf)
    seen, size = 0, max(2 * wanted, _FIRST)
    lacks = figures[UNDECIDED] > 1.0  # none of these passes, whatever the waveform says
    lacks &= not lacks[undecided].all()  # but for what all lack
    while undecided.any():
        # anew, for with its waveform a drive may need a heavier controller
        value, missing = values(catalog, found.sets, figures, problem.spec.select.objective)
        of_all = np.bitwise_and.reduce(unknown[~(undecided | failed)], axis=0) if seen >= enough else np.uint64(0)
        passes = ~(undecided | failed | opened | (unknown & ~of_all).any(axis=1))
        rank, value = order(catalog, found.sets, value, missing, before=[lacks]), rounded(value)
        some = rank[undecided[rank]][:size]
        better = (missing < missing[some[0]]) | ((missing == missing[some[0]]) & (value < value[some[0]]))
        if np.count_nonzero(passes & (better | lacks[some[0]])) >= wanted:
            break
        if not seen:  # the best of those is named beside the first that passes
            others = np.flatnonzero(undecided & lacks)
            few = order(catalog, found.sets.on(others), value[others], missing[others])[:_NAMED]
            some = np.union1d(some, others[few])
        one = by_physics(problem, found.sets.on(some), False)  # at least those that bounds leave open
        checks = [check for check in one.checks if not check.advice]
        failed_by.update({check.name: int(np.count_nonzero(check.failed)) for check in checks})
        known = [replace(c, passed=c.passed | c.opened) for c in checks]
        opened[some] = np.any([np.broadcast_to(c.opened, len(some)) for c in checks], axis=0)
        failed[some], undecided[some] = one.failed, False
        amount = amounting(known, len(some), False)
        unknown[some], doublings[some], most[some] = amount.unknown, amount.doublings, smallest_margin(one.checks)
        bound[some] = bound_of(checks, len(some))
        for name, x in chosen(one.encoder, one.controller, one.brake, needs_encoder=not problem.spec.steps).items():
            figures[name][some] = x
        seen, size = seen + len(some), 2 * size
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


# -- Order of drives before their margins count, and how many of them margins decide between.
#
# Before the objective goes the certainty that a drive passes: of open ones how probable it is, of unknown ones how
# few checks are undecided and how few times a known limit must be doubled for them. Margins need the waveform, so
# that they are computed of as few as are equal to the last that is shown.


_CELLS_OF_RANK = 50_000  # drives times pieces of the load cycle, of which margins are computed to order equals
_SAMPLED = 32  # open drives at most
_HARDLY = 4  # unknown checks behind which one stands that passes in less than a tenth of its band ...
_ONCE = 0.02  # ... and behind so many more one that passes hardly once in it
_TENTHS = 12  # places for tenths of a probability, and for what is not sampled


class Rank(NamedTuple):
    """Columns over drives that pass or may pass: less is better, the first one first."""

    precedence: NDArray[
        np.int64
    ]  # certainty; of open drives how probable it is that none fails, of unknown ones how few
    missing: NDArray[np.int64]  # parts of which the objective is unknown
    value: Array  # of the objective

    @property
    def columns(self) -> Array:
        """All of them, where rounding makes no difference: shape (3, drives)."""
        return np.stack([self.precedence, self.missing, rounded(self.value)])

    def order(
        self, catalog: Catalog, sets: Candidates, rows: Any = slice(None), margin: Array | None = None
    ) -> NDArray[np.int64]:
        """Some drives from best to worst, by their places among these."""
        before = [self.precedence[rows]]
        return order(catalog, sets.on(rows), self.value[rows], self.missing[rows], before=before, margin=margin)


def ranked(problem: Problem, kept: Sifted, top: int) -> Rank:
    """Columns that order the drives that pass or may pass."""
    value, missing = values(problem.catalog, kept.sets, kept.figures, problem.spec.select.objective)
    return Rank(_precedence(problem, kept, value, missing, top), missing, value)


def _precedence(
    problem: Problem, kept: Sifted, value: Array, missing: NDArray[np.int64], top: int
) -> NDArray[np.int64]:
    """Order that goes before the objective; of open checks as many drives are sampled as an order of those shown needs.

    An open drive is placed by tenths of the probability that it passes, an unknown one whose open checks hardly pass
    behind one of which more is unknown.
    """
    precedence = _TENTHS * kept.certainty + kept.lacking
    opened = kept.certainty == OPEN
    precedence[opened] += _TENTHS - 1
    count = max(min(_SAMPLED, waveforms(problem)), top)
    ahead = np.count_nonzero(kept.certainty == PASSES)
    for rows in (np.flatnonzero(opened), np.flatnonzero(kept.certainty == UNKNOWN)):
        if len(rows) > 1 and ahead < top:
            before = [precedence[rows]]
            best = rows[order(problem.catalog, kept.sets.on(rows), value[rows], missing[rows], before=before)][:count]
            probable = _probabilities(problem, kept.sets.on(best))
            tenths = (10.0 * probable).astype(np.int64)
            hardly = np.where(opened[best], _TENTHS * UNKNOWN, precedence[best]) + _HARDLY
            likely = np.where(opened[best], _TENTHS * (OPEN + 1) - 1 - tenths, precedence[best])
            precedence[best] = np.where(tenths == 0, hardly + _HARDLY * (probable < _ONCE), likely)
        ahead += len(rows)
    return precedence


def _probabilities(problem: Problem, sets: Candidates) -> Array:
    """Probability that the open checks of each drive pass together; 1 of drives without any."""
    few, found = by_physics(problem, sets, False), np.ones(len(sets.motor))
    for place in range(len(found)):
        if names := few.open_checks(place):
            controller, brake = few.controller[[place]], few.brake[[place]]
            one = few.candidates.on(np.array([place]))._replace(controller=controller, brake=brake)
            found[place] = passing(problem, one, names, each=False)[""]
    return found


def equals_of_the_last(problem: Problem, rank: Rank, order: NDArray[np.int64], top: int) -> int:
    """Number of the first in order that are ordered by margin: up to the equals of the last shown, in bounds."""
    if not len(order):
        return 0
    same = rank.columns[:, order]
    last = same[:, [min(top, len(order)) - 1]]
    count = int(np.flatnonzero((same == last).all(axis=0))[-1]) + 1
    return min(count, max(waveforms(problem), top))


def waveforms(problem: Problem) -> int:
    """Number of drives whose waveforms may be computed to order them."""
    return _CELLS_OF_RANK // max(len(case.at_belt.load_cycle.duration) for case in problem.cases)


def better_but_unknown(problem: Problem, kept: Sifted, rank: Rank, best: NDArray[np.int64]) -> NDArray[np.int64]:
    """The best of those that are better than the first shown and only stand behind it for a figure that is missing."""
    if not len(best) or kept.certainty[best[0]] != PASSES:
        return best[:0]
    first, shown = rounded(rank.value), best[0]
    better = (rank.missing <= rank.missing[shown]) & (first < first[shown])
    rows = np.flatnonzero((kept.certainty != PASSES) & better)
    least = [kept.certainty[rows], kept.lacking[rows]]
    best = order(problem.catalog, kept.sets.on(rows), rank.value[rows], rank.missing[rows], before=least)
    return rows[best[:1]]
