"""Drives over samples: probability that all checks pass, the figures of each, the assumptions that matter most."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.view import has_steppers
from drivesizer.errors import InputError
from drivesizer.load_cases.platform import WheelLoad
from drivesizer.physics.figures import Array, Mask
from drivesizer.results.check import Check, Driver, FigureSpread, Reliability, Spread, Uncertain, Uncertainty
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_SAMPLED, CHECKS
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.uncertainty import uncertain_figures
from drivesizer.search.uncertainty.options import POOL, Sampling
from drivesizer.search.uncertainty.sampled_drive import (
    Prepared,
    SetRows,
    blocks,
    checks_of,
    figure_columns,
    prepared,
)
from drivesizer.search.uncertainty.sampling import (
    first_order,
    mean_and_error,
    rank_correlations,
    sample,
    values_of,
)
from drivesizer.search.uncertainty.uncertain_figures import Assumption

Found = TypeVar("Found")
_QUANTILES = (0.05, 0.5, 0.95)
_KEPT = 1_000_000  # segments times samples that are kept in memory for all drives
_TOGETHER = 8  # drives whose samples are held at a time
_OF_A_FACTOR = ("pull_out_torque",)  # whose margin is required to be some 100 %: what exceeds that is the tight part


class Subject(NamedTuple):
    """A drive that is sampled, with its checks at nominal figures."""

    rows: SetRows
    nominal: tuple[Check, ...]


def subject(evaluation: Evaluation, row: int, beside: tuple[Check, ...] = ()) -> Subject:
    """A drive that a search found, with its checks by physics."""
    given = evaluation.candidates
    rows = SetRows(
        int(given.motor[row]), int(given.gearhead[row]), int(evaluation.encoder[row]), int(evaluation.controller[row]),
        float(given.belt[row]), int(evaluation.brake[row]),
    )  # fmt: skip
    return Subject(rows, tuple(c for c in (*evaluation.checks_of(row), *beside) if c.method == "physics"))


# -- Checks over samples, and what they amount to together.


class Over(NamedTuple):
    """One check over all samples."""

    passed: Mask
    failed: Mask
    margin: Array  # NaN where there is none
    tightness: Array


class Examined(NamedTuple):
    """Result of the samples of a drive."""

    reliability: Reliability
    smallest: Array  # margin of each sample, over all checks that have one


def over_samples(checks: Sequence[Check | None]) -> Over:
    """A check of each sample; where a sample has none there is nothing to fail."""
    known = [(one.status == "pass", one.status == "fail", one.margin, one.margin if one.is_comparable else math.inf)
             if one else (True, False, math.inf, math.inf) for one in checks]  # fmt: skip
    return Over(*(np.array(column) for column in zip(*known, strict=True)))


def examined(given: Prepared, catalog: Catalog, subjects: Sequence[Subject]) -> list[Examined]:
    """Checks of drives over all samples."""
    titles = {name: CHECKS["budget"][name].title for name in BATTERY_SAMPLED}
    return [
        reduced(every, {check.name: check.title for check in one.nominal} | titles)
        for one, every in zip(subjects, _every_check(given, catalog, subjects), strict=True)
    ]


def passing_shares(given: Prepared, catalog: Catalog, subjects: Sequence[Subject]) -> list[float]:
    """Share of the samples in which no check of a drive fails, of each drive: without the margins of the checks."""
    every = _every_check(given, catalog, subjects, margins=False)
    return [float(np.mean(~np.logical_or.reduce([over.failed for over in checks.values()]))) for checks in every]


def by_processes(
    work: Callable[[Prepared, Catalog, Sequence[Subject]], list[Found]], given: Prepared, catalog: Catalog,
    subjects: Sequence[Subject], processes: int = 1,
) -> list[Found]:  # fmt: skip
    """Checks and figures of drives over all samples, by several processes each with some of the drives."""
    if processes <= 1 or len(subjects) <= 1:
        return work(given, catalog, subjects)
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    share = -(-len(subjects) // processes)
    parts = [subjects[first : first + share] for first in range(0, len(subjects), share)]
    with ProcessPoolExecutor(len(parts), mp_context=get_context("spawn")) as pool:
        found = pool.map(work, [given] * len(parts), [catalog] * len(parts), parts)
        return [one for part in found for one in part]


def _every_check(
    given: Prepared, catalog: Catalog, subjects: Sequence[Subject], *, margins: bool = True
) -> Iterator[dict[str, Over]]:
    """The checks of each drive over all samples; those that no sample changes are as they are nominally."""
    belts = sorted({one.rows.belt for one in subjects})
    kept = [*blocks(given, catalog, belts)] if given.cells <= _KEPT else None
    for first in range(0, len(subjects), _TOGETHER):
        some = subjects[first : first + _TOGETHER]
        parts: list[list[dict[str, Over]]] = [[] for _ in some]
        for block in kept or blocks(given, catalog, belts):
            for part, one in zip(parts, some, strict=True):
                part.append({n: _over(c, block.size, margins) for n, c in checks_of(catalog, one.rows, block).items()})
        for one, part in zip(some, parts, strict=True):
            sampled = part[0] if len(part) == 1 else {
                name: Over(*map(np.concatenate, zip(*(each[name] for each in part), strict=True)))
                for name in part[0]
            }  # fmt: skip
            every = dict[str, Over]()
            for check in one.nominal:
                if check.name in sampled and not check.advice:
                    every[check.name] = sampled[check.name]
                elif not check.advice:
                    every[check.name] = Over._make(np.broadcast_to(x, len(given.values)) for x in over_samples([check]))
            yield every | {name: sampled[name] for name in BATTERY_SAMPLED if name in sampled}


def _over(check: CheckColumn, count: int, margins: bool) -> Over:
    """A check over samples; of the pull-out torque the tightness is what exceeds the required factor."""
    margin = check.margin if margins else np.full(count, np.nan)
    tight = check.tight(margin) if margins else margin
    if check.name in _OF_A_FACTOR:
        tight = (1.0 + tight) / (1.0 + check.needed) - 1.0
    columns = (check.passed, check.failed, margin, tight)
    return Over._make(x if x.shape == (count,) else np.broadcast_to(x, count) for x in columns)


def reduced(every: Mapping[str, Over], titles: Mapping[str, str]) -> Examined:
    """Reliability of several checks together."""
    count = len(next(iter(every.values())).passed)
    failed, smallest, place = np.zeros(count, bool), np.full(count, np.inf), np.full(count, -1)
    for number, over in enumerate(every.values()):
        failed |= over.failed
        tighter = over.tightness < smallest
        if tighter.any():  # few checks are ever the tightest
            place[tighter] = number
            smallest = np.minimum(smallest, over.tightness)
    weakest = np.bincount(place + 1, minlength=len(every) + 1)[1:] / count
    spreads = []
    for (name, over), tightest in zip(every.items(), weakest, strict=True):
        low, middle, high = quantiles(over.margin)
        spreads.append(Spread(
            name=name, title=titles[name], passes=np.count_nonzero(over.passed) / count,
            fails=np.count_nonzero(over.failed) / count, weakest=float(tightest), low=low, middle=middle, high=high,
        ))  # fmt: skip
    share = mean_and_error(~failed)
    low, middle, high = quantiles(smallest)
    reliability = Reliability(
        probability=share.value, error=share.error, unknown=tuple(s.title for s in spreads if s.passes + s.fails < 1.0),
        weakest=max(spreads, key=lambda s: (s.fails, s.weakest)).title, low=low, middle=middle, high=high,
        checks=tuple(spreads),
    )  # fmt: skip
    return Examined(reliability, smallest)


def quantiles(values: Array) -> tuple[float, float, float]:
    """The values that 5 %, 50 % and 95 % of all lie below."""
    least = float(values.min())
    if least != least or least == values.max():  # NaN, or all the same
        return (least,) * 3
    places = [int(q * len(values)) for q in _QUANTILES]
    low, middle, high = np.partition(values, places)[places].tolist()
    return low, middle, high


# -- Sensitivity: one assumption varied at a time, at its 5 % and at its 95 % quantile.


def at_ends(problem: Problem, given: Sequence[Assumption]) -> Prepared:
    """The nominal figures, then two samples an assumption."""
    values = np.tile([assumption.nominal for assumption in given], (1 + 2 * len(given), 1))
    ends = values_of(given, np.tile([[0.05], [0.95]], len(given)))
    for k in range(len(given)):
        values[_ends(k), k] = ends[:, k]
    return prepared(problem, given, values, every=True)


def _ends(k: int) -> slice:
    """The rows in which the assumption of that number is varied."""
    return slice(1 + 2 * k, 3 + 2 * k)


def _counting(one: Subject, ends: Prepared) -> list[int]:
    """Numbers of the assumptions that count for a drive: the spec's, and the classes that hold for its parts."""
    rows, tolerances = (one.rows.motor, one.rows.gearhead, one.rows.controller), ends.problem.spec.tolerances.given
    held = uncertain_figures.holding_of_a_set(ends.problem.catalog, tolerances, *rows)
    return [k for k, one in enumerate(ends.given) if one.catalogue is None or one.catalogue in held]


def _drivers(one: Subject, ends: Prepared, ready: Prepared, smallest: Array) -> tuple[Driver, ...]:
    """Effect of each assumption on the smallest margin of a drive, the largest first."""
    known, own = np.isfinite(smallest), _counting(one, ends)
    if not own:
        return ()
    values = ready.values[known][:, own]
    shares = first_order(values, smallest[known]).tolist()
    signs = rank_correlations(values, smallest[known]).tolist()
    every, found = next(_every_check(ends, ends.problem.catalog, [one])), []
    margins = np.min([over.tightness for over in every.values()], axis=0)
    for k, share, sign in zip(own, shares, signs, strict=True):
        assumption = ends.given[k]
        (low, high), (low_margin, high_margin) = ends.values[_ends(k), k], margins[_ends(k)].tolist()
        found.append(Driver(
            name=assumption.name, title=assumption.title, share=share, rank_correlation=sign, low_margin=low_margin,
            high_margin=high_margin, low=assumption.shown(low), high=assumption.shown(high),
        ))  # fmt: skip
    return tuple(sorted(found, key=lambda driver: (-driver.share, driver.name)))


def without_effect(drives: Sequence[Subject], catalog: Catalog, ends: Prepared) -> list[Assumption]:
    """Figures of the spec that leave every sampled check of some drives as it is."""
    changed = np.zeros(len(ends.values), bool)
    for one in drives:
        first: dict[str, list[Array]] = {}
        row = 0
        for block in blocks(ends, catalog, [one.rows.belt]):
            for name, check in checks_of(catalog, one.rows, block).items():
                columns = [np.broadcast_to(x, block.size) for x in (check.demand, check.limit)]
                nominal = first.setdefault(name, [column[:1] for column in columns])
                for column, figure in zip(columns, nominal, strict=True):
                    changed[row : row + block.size] |= (column != figure) & ~(np.isnan(column) & np.isnan(figure))
            row += block.size
    return [one for k, one in enumerate(ends.given) if one.given is not None and not changed[_ends(k)].any()]


# -- Figures of one drive over the same samples, in each sample of its worst load case.


def figure_spreads(given: Prepared, catalog: Catalog, one: SetRows) -> tuple[FigureSpread, ...]:
    """Percentiles of the figures of a drive."""
    each = [figure_columns(catalog, one, block) for block in blocks(given, catalog, [one.belt])]
    found, turning = [], "stepper" if has_steppers(catalog) else "servo"
    for name, title, kind, unit in (cells for head, cells in uncertain_figures.TABLE if head == turning):
        low, middle, high = quantiles(np.concatenate([columns[name] for columns in each]))
        found.append(FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high))
    return tuple(found)


# -- Reliability of a sizing's drives: in how many samples each passes, and what decides it.


class SampledDrives(NamedTuple):
    """Drives over samples, by their rows in the result of the search."""

    good: list[int]  # in their order; with a required confidence those that reach it
    bad: list[int]  # that do not, the most reliable first
    subjects: dict[int, Subject]  # both
    ready: Prepared
    how: Sampling
    ends: Prepared | None  # one figure varied at a time; None where the probabilities are all that is wanted
    known: dict[int, Examined]  # of those that were examined

    def examined(self, rows: Collection[int]) -> dict[int, Examined]:
        """Probability, and every check over the samples, of some of them."""
        new = [row for row in rows if row not in self.known]
        some = [self.subjects[row] for row in new]
        found = by_processes(examined, self.ready, self.ready.problem.catalog, some, self.how.processes)
        self.known.update(zip(new, found, strict=True))
        return {row: self.known[row] for row in rows}


def sample_drives(
    problem: Problem, subjects: Mapping[int, Subject], how: Sampling, *, brief: bool = False
) -> SampledDrives:
    """Reliability of drives."""
    rows = [(one.rows.motor, one.rows.gearhead, one.rows.controller) for one in subjects.values()]
    machine = problem.machine
    held = uncertain_figures.used(problem.catalog, machine.tolerances.given, rows)
    if machine.needs.start_speed is None:
        held = tuple(one for one in held if one.figure != "start_speed")  # no check depends on it
    given = uncertain_figures.assumptions(machine, held)
    ready = prepared(problem, given, sample(given, how.samples, how.seed, uncertain_figures.assumptions(machine)))
    ends = None if brief else at_ends(problem, given)
    found = SampledDrives([*subjects], [], {**subjects}, ready, how, ends, {})
    if how.confidence is None:
        return found
    shares = by_processes(passing_shares, ready, problem.catalog, [*subjects.values()], how.processes)
    share = dict(zip(subjects, shares, strict=True))
    good = [row for row in subjects if share[row] >= how.confidence]
    return found._replace(
        good=good, bad=sorted((row for row in subjects if row not in good), key=lambda row: -share[row])
    )


def reliabilities(
    sampled: SampledDrives, rows: Collection[int], finalists: Mapping[int, DriveParts]
) -> dict[int, Reliability]:
    """Reliability of drives, with the sensitivities of each unless they were sampled in brief."""
    ready, how, described = sampled.ready, sampled.how, {}
    for row, (found, smallest) in sampled.examined(rows).items():
        described[row], one = found, sampled.subjects[row]
        if sampled.ends is None:
            continue
        matters = _drivers(one, sampled.ends, ready, smallest)
        figures = figure_spreads(ready, ready.problem.catalog, one.rows)
        described[row] = replace(found, drivers=matters, figures=figures)
        if row in finalists and how.loop > 0 and not ready.problem.spec.steps:
            from drivesizer.search.uncertainty.sampled_closed_loop import loop_share

            own = _counting(one, sampled.ends)
            given, values = [ready.given[k] for k in own], ready.values[:, own]
            try:
                share = loop_share(ready.problem.spec, finalists[row], given, values, how.loop)
                described[row] = replace(described[row], loop=share)
            except InputError as error:  # the model may lack a figure
                described[row] = replace(described[row], no_loop=str(error))
    return described


def uncertainty(one: SampledDrives) -> Uncertainty:
    """Assumptions and samples, which all drives have in common."""
    assumptions = []
    for given in one.ready.given:
        text = given.given.text if given.given else given.catalogue.text if given.catalogue else ""
        title = given.name if given.given else given.catalogue.title if given.catalogue else given.name
        source = given.catalogue.why if given.catalogue else "spec"
        assumptions.append(Uncertain(name=given.name, title=title, text=text, source=source))
    return Uncertainty(
        assumptions=tuple(assumptions), samples=len(one.ready.values), seed=one.how.seed, confidence=one.how.confidence,
        examined=len(one.subjects), reached=len(one.good),
        notes=(*_notes(one.ready, one.how, len(one.subjects)), *_idle(one)),
    )  # fmt: skip


def _notes(ready: Prepared, how: Sampling, examined_: int) -> tuple[str, ...]:
    """Notes on the basis of the probabilities."""
    spec = ready.problem.spec
    deviating = (
        "a stepper's driver is held against the current that is set, not against what it is off"
        if spec.steps
        else "the voltage drop of the controller goes with its losses"
    )
    notes = [
        f"limits are the catalogue's, as printed, but {deviating}; "
        "encoder and controller are those of the nominal drive; all drives of the machine deviate alike",
        "the probability is that no check of the physics fails, nor the battery's autonomy, range, peak and voltage; "
        "other budgets of the machine are at nominal figures",
    ]
    if spec.method == "paper":
        notes.append("the paper's factors do not enter: the sampled checks are those of the physics beside it")
    if len(ready.values) < how.samples:
        notes.append(f"load cycles take long to compute here: {len(ready.values)} samples, not {how.samples}")
    if spec.steps:
        notes.append("of the pull-out torque the smallest margin counts what exceeds the required factor")
    if spec.steps and how.loop > 0:
        notes.append("steppers run open-loop: they are not sampled in closed loop")
    if isinstance(spec.load, WheelLoad):
        notes.append("platforms on a path are not sampled in closed loop; peaks and voltage of the battery are nominal")
    if how.confidence is not None and examined_ >= POOL:
        notes.append(f"only the best {POOL} drives that meet all limits at nominal figures were sampled")
    return tuple(notes)


_FIRST = 3  # drives that are held against a tolerance without effect


def _idle(one: SampledDrives) -> list[str]:
    """Notes on tolerances of the spec that change no sampled check of the first drives, each reason once."""
    if one.ends is None:
        return []
    by_reason: dict[str, list[str]] = {}
    looped = one.how.confidence is not None and one.how.loop > 0
    for figure in without_effect([*one.subjects.values()][:_FIRST], one.ready.problem.catalog, one.ends):
        if figure.given and not (looped and figure.given.path[0] == "plant"):
            by_reason.setdefault(uncertain_figures.reason(figure.given.path), []).append(figure.name)
    return [
        f"no sampled check depends on {', '.join(names)}: that tolerance has no effect here{f'; {why}' if why else ''}"
        for why, names in by_reason.items()
    ]
