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

Result = TypeVar("Result")
_QUANTILES = (0.05, 0.5, 0.95)
_CELLS_IN_MEMORY = 1_000_000  # segments times samples that are kept in memory for all drives
_TOGETHER = 8  # drives whose samples are held at a time
_OF_A_FACTOR = ("pull_out_torque",)  # whose margin is required to be some 100 %: what exceeds that is the tight part


class Subject(NamedTuple):
    """A drive that is sampled, with its checks at nominal figures."""

    rows: SetRows
    nominal: tuple[Check, ...]


def subject(evaluation: Evaluation, row: int, other_checks: tuple[Check, ...] = ()) -> Subject:
    """A drive that a search found, with its checks by physics."""
    sets = evaluation.candidates
    rows = SetRows(
        int(sets.motor[row]), int(sets.gearhead[row]), int(evaluation.encoder[row]), int(evaluation.controller[row]),
        float(sets.belt[row]), int(evaluation.brake[row]),
    )  # fmt: skip
    return Subject(rows, tuple(c for c in (*evaluation.checks_of(row), *other_checks) if c.method == "physics"))


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
    known = [
        (
            check.status == "pass",
            check.status == "fail",
            check.margin,
            check.margin if check.is_comparable else math.inf,
        )
        if check
        else (True, False, math.inf, math.inf)
        for check in checks
    ]
    return Over(*(np.array(column) for column in zip(*known, strict=True)))


def examined(samples: Prepared, catalog: Catalog, subjects: Sequence[Subject]) -> list[Examined]:
    """Checks of drives over all samples."""
    titles = {name: CHECKS["budget"][name].title for name in BATTERY_SAMPLED}
    return [
        reduced(checks, {check.name: check.title for check in drive.nominal} | titles)
        for drive, checks in zip(subjects, _every_check(samples, catalog, subjects), strict=True)
    ]


def passing_shares(samples: Prepared, catalog: Catalog, subjects: Sequence[Subject]) -> list[float]:
    """Share of the samples in which no check of a drive fails, of each drive: without the margins of the checks."""
    drives = _every_check(samples, catalog, subjects, margins=False)
    return [float(np.mean(~np.logical_or.reduce([over.failed for over in checks.values()]))) for checks in drives]


def by_processes(
    work: Callable[[Prepared, Catalog, Sequence[Subject]], list[Result]], samples: Prepared, catalog: Catalog,
    subjects: Sequence[Subject], processes: int = 1,
) -> list[Result]:  # fmt: skip
    """Checks and figures of drives over all samples, by several processes each with some of the drives."""
    if processes <= 1 or len(subjects) <= 1:
        return work(samples, catalog, subjects)
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    share = -(-len(subjects) // processes)
    parts = [subjects[first : first + share] for first in range(0, len(subjects), share)]
    with ProcessPoolExecutor(len(parts), mp_context=get_context("spawn")) as pool:
        results = pool.map(work, [samples] * len(parts), [catalog] * len(parts), parts)
        return [result for part in results for result in part]


def _every_check(
    samples: Prepared, catalog: Catalog, subjects: Sequence[Subject], *, margins: bool = True
) -> Iterator[dict[str, Over]]:
    """The checks of each drive over all samples; those that no sample changes are as they are nominally."""
    belts = sorted({drive.rows.belt for drive in subjects})
    in_memory = [*blocks(samples, catalog, belts)] if samples.cells <= _CELLS_IN_MEMORY else None
    for first in range(0, len(subjects), _TOGETHER):
        group = subjects[first : first + _TOGETHER]
        parts: list[list[dict[str, Over]]] = [[] for _ in group]
        for block in in_memory or blocks(samples, catalog, belts):
            for part, drive in zip(parts, group, strict=True):
                part.append(
                    {n: _over(c, block.size, margins) for n, c in checks_of(catalog, drive.rows, block).items()}
                )
        for drive, part in zip(group, parts, strict=True):
            sampled = part[0] if len(part) == 1 else {
                name: Over(*map(np.concatenate, zip(*(by_name[name] for by_name in part), strict=True)))
                for name in part[0]
            }  # fmt: skip
            checks = dict[str, Over]()
            for check in drive.nominal:
                if check.name in sampled and not check.advice:
                    checks[check.name] = sampled[check.name]
                elif not check.advice:
                    checks[check.name] = Over._make(
                        np.broadcast_to(x, len(samples.values)) for x in over_samples([check])
                    )
            yield checks | {name: sampled[name] for name in BATTERY_SAMPLED if name in sampled}


def _over(check: CheckColumn, count: int, margins: bool) -> Over:
    """A check over samples; of the pull-out torque the tightness is what exceeds the required factor."""
    margin = check.margin if margins else np.full(count, np.nan)
    tight = check.tight(margin) if margins else margin
    if check.name in _OF_A_FACTOR:
        tight = (1.0 + tight) / (1.0 + check.needed) - 1.0
    columns = (check.passed, check.failed, margin, tight)
    return Over._make(x if x.shape == (count,) else np.broadcast_to(x, count) for x in columns)


def reduced(checks: Mapping[str, Over], titles: Mapping[str, str]) -> Examined:
    """Reliability of several checks together."""
    count = len(next(iter(checks.values())).passed)
    failed, smallest, place = np.zeros(count, bool), np.full(count, np.inf), np.full(count, -1)
    for number, over in enumerate(checks.values()):
        failed |= over.failed
        tighter = over.tightness < smallest
        if tighter.any():  # few checks are ever the tightest
            place[tighter] = number
            smallest = np.minimum(smallest, over.tightness)
    weakest = np.bincount(place + 1, minlength=len(checks) + 1)[1:] / count
    spreads = []
    for (name, over), tightest in zip(checks.items(), weakest, strict=True):
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


def at_ends(problem: Problem, assumptions: Sequence[Assumption]) -> Prepared:
    """The nominal figures, then two samples an assumption."""
    values = np.tile([assumption.nominal for assumption in assumptions], (1 + 2 * len(assumptions), 1))
    ends = values_of(assumptions, np.tile([[0.05], [0.95]], len(assumptions)))
    for k in range(len(assumptions)):
        values[_ends(k), k] = ends[:, k]
    return prepared(problem, assumptions, values, all_samples=True)


def _ends(k: int) -> slice:
    """The rows in which the assumption of that number is varied."""
    return slice(1 + 2 * k, 3 + 2 * k)


def _counting(drive: Subject, ends: Prepared) -> list[int]:
    """Numbers of the assumptions that count for a drive: the spec's, and the classes that hold for its parts."""
    rows, tolerances = (
        (drive.rows.motor, drive.rows.gearhead, drive.rows.controller),
        ends.problem.spec.tolerances.classes,
    )
    classes = uncertain_figures.holding_of_a_set(ends.problem.catalog, tolerances, *rows)
    return [
        k
        for k, assumption in enumerate(ends.assumptions)
        if assumption.catalogue is None or assumption.catalogue in classes
    ]


def _drivers(drive: Subject, ends: Prepared, ready: Prepared, smallest: Array) -> tuple[Driver, ...]:
    """Effect of each assumption on the smallest margin of a drive, the largest first."""
    known, own = np.isfinite(smallest), _counting(drive, ends)
    if not own:
        return ()
    values = ready.values[known][:, own]
    shares = first_order(values, smallest[known]).tolist()
    signs = rank_correlations(values, smallest[known]).tolist()
    checks, drivers = next(_every_check(ends, ends.problem.catalog, [drive])), []
    margins = np.min([over.tightness for over in checks.values()], axis=0)
    for k, share, sign in zip(own, shares, signs, strict=True):
        assumption = ends.assumptions[k]
        (low, high), (low_margin, high_margin) = ends.values[_ends(k), k], margins[_ends(k)].tolist()
        drivers.append(Driver(
            name=assumption.name, title=assumption.title, share=share, rank_correlation=sign, low_margin=low_margin,
            high_margin=high_margin, low=assumption.with_unit(low), high=assumption.with_unit(high),
        ))  # fmt: skip
    return tuple(sorted(drivers, key=lambda driver: (-driver.share, driver.name)))


def without_effect(drives: Sequence[Subject], catalog: Catalog, ends: Prepared) -> list[Assumption]:
    """Figures of the spec that leave every sampled check of some drives as it is."""
    changed = np.zeros(len(ends.values), bool)
    for drive in drives:
        first: dict[str, list[Array]] = {}
        row = 0
        for block in blocks(ends, catalog, [drive.rows.belt]):
            for name, check in checks_of(catalog, drive.rows, block).items():
                columns = [np.broadcast_to(x, block.size) for x in (check.demand, check.limit)]
                nominal = first.setdefault(name, [column[:1] for column in columns])
                for column, figure in zip(columns, nominal, strict=True):
                    changed[row : row + block.size] |= (column != figure) & ~(np.isnan(column) & np.isnan(figure))
            row += block.size
    return [
        assumption
        for k, assumption in enumerate(ends.assumptions)
        if assumption.spec_class is not None and not changed[_ends(k)].any()
    ]


# -- Figures of one drive over the same samples, in each sample of its worst load case.


def figure_spreads(samples: Prepared, catalog: Catalog, rows: SetRows) -> tuple[FigureSpread, ...]:
    """Percentiles of the figures of a drive."""
    figures = [figure_columns(catalog, rows, block) for block in blocks(samples, catalog, [rows.belt])]
    spreads, turning = [], "stepper" if has_steppers(catalog) else "servo"
    for name, title, kind, unit in (cells for head, cells in uncertain_figures.TABLE if head == turning):
        low, middle, high = quantiles(np.concatenate([columns[name] for columns in figures]))
        spreads.append(FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high))
    return tuple(spreads)


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
        subjects = [self.subjects[row] for row in new]
        results = by_processes(examined, self.ready, self.ready.problem.catalog, subjects, self.how.processes)
        self.known.update(zip(new, results, strict=True))
        return {row: self.known[row] for row in rows}


def sample_drives(
    problem: Problem, subjects: Mapping[int, Subject], how: Sampling, *, ends: bool = True
) -> SampledDrives:
    """Drives over samples, and over the ends of each assumption where wanted."""
    rows = [(drive.rows.motor, drive.rows.gearhead, drive.rows.controller) for drive in subjects.values()]
    machine = problem.machine
    classes = uncertain_figures.classes_in_use(problem.catalog, machine.tolerances.classes, rows)
    if machine.needs.start_speed is None:
        classes = tuple(
            tolerance for tolerance in classes if tolerance.figure != "start_speed"
        )  # no check depends on it
    assumptions = uncertain_figures.assumptions(machine, classes)
    ready = prepared(
        problem, assumptions, sample(assumptions, how.samples, how.seed, uncertain_figures.assumptions(machine))
    )
    drives = SampledDrives(
        [*subjects], [], {**subjects}, ready, how, at_ends(problem, assumptions) if ends else None, {}
    )
    if how.confidence is None:
        return drives
    shares = by_processes(passing_shares, ready, problem.catalog, [*subjects.values()], how.processes)
    share = dict(zip(subjects, shares, strict=True))
    good = [row for row in subjects if share[row] >= how.confidence]
    return drives._replace(
        good=good, bad=sorted((row for row in subjects if row not in good), key=lambda row: -share[row])
    )


def reliabilities(
    sampled: SampledDrives, rows: Collection[int], finalists: Mapping[int, DriveParts]
) -> dict[int, Reliability]:
    """Reliability of drives, with the sensitivities of each where the ends were computed."""
    ready, how, described = sampled.ready, sampled.how, {}
    for row, (reliability, smallest) in sampled.examined(rows).items():
        described[row], drive = reliability, sampled.subjects[row]
        if sampled.ends is None:
            continue
        matters = _drivers(drive, sampled.ends, ready, smallest)
        figures = figure_spreads(ready, ready.problem.catalog, drive.rows)
        described[row] = replace(reliability, drivers=matters, figures=figures)
        if row in finalists and how.loop > 0 and not ready.problem.spec.steps:
            from drivesizer.search.uncertainty.sampled_closed_loop import loop_share

            own = _counting(drive, sampled.ends)
            assumptions, values = [ready.assumptions[k] for k in own], ready.values[:, own]
            try:
                share = loop_share(ready.problem.spec, finalists[row], assumptions, values, how.loop)
                described[row] = replace(described[row], loop=share)
            except InputError as error:  # the model may lack a figure
                described[row] = replace(described[row], no_loop=str(error))
    return described


def uncertainty(sampled: SampledDrives) -> Uncertainty:
    """Assumptions and samples, which all drives have in common."""
    assumptions = []
    for assumption in sampled.ready.assumptions:
        catalogue = assumption.catalogue
        figure = catalogue or assumption.spec_class
        assumptions.append(Uncertain(
            name=assumption.name, title=catalogue.title if catalogue else assumption.name,
            text=figure.text if figure else "", source=catalogue.why if catalogue else "spec",
        ))  # fmt: skip
    return Uncertainty(
        assumptions=tuple(assumptions), samples=len(sampled.ready.values), seed=sampled.how.seed,
        confidence=sampled.how.confidence, examined=len(sampled.subjects), reached=len(sampled.good),
        notes=(*_notes(sampled.ready, sampled.how, len(sampled.subjects)), *_idle(sampled)),
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


def _idle(sampled: SampledDrives) -> list[str]:
    """Notes on tolerances of the spec that change no sampled check of the first drives, each reason once."""
    if sampled.ends is None:
        return []
    by_reason: dict[str, list[str]] = {}
    looped = sampled.how.confidence is not None and sampled.how.loop > 0
    for figure in without_effect([*sampled.subjects.values()][:_FIRST], sampled.ready.problem.catalog, sampled.ends):
        if figure.spec_class and not (looped and figure.spec_class.path[0] == "plant"):
            by_reason.setdefault(uncertain_figures.reason(figure.spec_class.path), []).append(figure.name)
    return [
        f"no sampled check depends on {', '.join(names)}: that tolerance has no effect here{f'; {why}' if why else ''}"
        for why, names in by_reason.items()
    ]
