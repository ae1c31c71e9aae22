"""Reliability of a sizing's drives: in how many samples each passes, and what decides it."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.view.mounted import has_steppers
from drivesizer.errors import InputError
from drivesizer.load_cases.platform import WheelLoad
from drivesizer.results.check import Check, Reliability, Uncertain, Uncertainty
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_SAMPLED
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.columns.limits_over_time import waveform_limits
from drivesizer.search.uncertainty.options import POOL, Sampling
from drivesizer.search.uncertainty.prepare import Prepared, prepared
from drivesizer.search.uncertainty.probabilities import (
    Examined,
    Subject,
    at_ends,
    blocks_of,
    by_processes,
    counting,
    drivers,
    examined,
    figure_spreads,
    without_effect,
)
from drivesizer.search.uncertainty.sampled_battery import battery_limits
from drivesizer.search.uncertainty.sampled_checks import Moving, checks_of, moving_checks, over_time_checks
from drivesizer.search.uncertainty.sampled_parts import Block, SetRows
from drivesizer.search.uncertainty.sampled_waveform import Side, sampled_bounds
from drivesizer.search.uncertainty.sampling import Sample, sample
from drivesizer.search.uncertainty.uncertain_figures import Assumption, assumptions, reason, used

__all__ = [
    "MostFirst", "SampledDrives", "counted", "failing", "passing", "reliabilities", "sample_drives", "subject",
    "uncertainty",
]  # fmt: skip


# -- In how many samples a drive passes: all that is needed of drives before it is known which of them are shown.
#
# The checks are those of ``probabilities``, which has their margins, quantiles and shares too. Bounds over the
# waveform decide most samples; the course of the winding's temperature is left to drives of which they do not show
# enough.


Failed = NDArray[np.bool_]


class Passing(NamedTuple):
    """Samples in which no check of a drive fails."""

    least: int  # number of those that certainly pass
    opened: NDArray[np.int64]  # those that may

    @property
    def most(self) -> int:
        """Number of those that may pass, with those that certainly do."""
        return self.least + len(self.opened)


def passing(given: Prepared, catalog: Catalog, subjects: Sequence[Subject], processes: int = 1) -> list[Passing]:
    """In how many samples drives pass, by bounds."""
    if processes > 1 and len(subjects) > 1:
        return by_processes(passing, given, catalog, subjects, processes)
    parts = [[_known(catalog, one, block) for one in subjects] for block in blocks_of(given, catalog, subjects)]
    found = []
    for each in zip(*parts, strict=True):
        failed, opened = (np.concatenate(some) for some in zip(*each, strict=True))
        found.append(Passing(int(np.count_nonzero(~(failed | opened))), np.flatnonzero(opened)))
    return found


def counted(given: Prepared, catalog: Catalog, one: Subject, known: Passing) -> int:
    """In how many samples a drive passes: of those that bounds leave open what needs the waveform is computed."""
    if not len(known.opened):
        return known.least
    wanted = {*_deciding(one), *BATTERY_SAMPLED}
    count = 0
    for block in blocks_of(given.on(known.opened), catalog, [one]):
        failed = np.zeros(block.size, bool)
        for check in over_time_checks(catalog, one.rows, block):
            if check.name in wanted:
                failed |= check.failed
        count += int(np.count_nonzero(~failed))
    return known.least + count


def failing(given: Prepared, catalog: Catalog, subjects: Sequence[Subject], processes: int = 1) -> list[Failed]:
    """Whether some check fails, of each drive in each sample."""
    if processes > 1 and len(subjects) > 1:
        return by_processes(failing, given, catalog, subjects, processes)
    parts = [[_fails(catalog, one, block) for one in subjects] for block in blocks_of(given, catalog, subjects)]
    return [np.concatenate(each) for each in zip(*parts, strict=True)]


def _fails(catalog: Catalog, one: Subject, block: Block) -> Failed:
    """Whether some check of a drive fails in each sample of a block; what no sample changes as it is nominally."""
    found, decide = checks_of(catalog, one.rows, block), _deciding(one)
    failed = np.full(block.size, any(status == "fail" for name, status in decide.items() if name not in found))
    for name in {*decide, *BATTERY_SAMPLED} & found.keys():
        failed |= found[name].failed
    return failed


def _deciding(one: Subject) -> dict[str, str]:
    """Status at nominal figures of the checks that count, by name."""
    return {check.name: check.status for check in one.nominal if not check.advice}


# --- by bounds


def _known(catalog: Catalog, one: Subject, block: Block) -> tuple[Failed, Failed]:
    """Samples in which a check fails, and others in which one may; none of these where there are no bounds."""
    sides = None if has_steppers(catalog) else _bounded(catalog, one, block)
    if sides is None:
        return _fails(catalog, one, block), np.zeros(block.size, bool)
    decide = _deciding(one)
    before = [check for case, _, _ in sides for check in case.checks]
    over_time = [*_of_the_waveform(sides), *_of_the_battery(block, one.rows.belt, sides)]
    seen = {check.name for check in (*before, *(high for _, high in over_time))}
    failed = np.full(block.size, any(status == "fail" for name, status in decide.items() if name not in seen))
    opened = np.zeros(block.size, bool)
    for check in before:
        if check.name in decide:
            failed |= check.failed
    for low, high in over_time:
        if (high.name in decide or high.name in BATTERY_SAMPLED) and not high.passed.all():
            fails, unknown = _by_low(low(), high)
            failed |= fails
            opened |= ~(high.passed | unknown)
    return failed, opened & ~failed


Sides = list[tuple[Moving, Side, Side]]  # load cases, with lower and upper bounds


def _bounded(catalog: Catalog, one: Subject, block: Block) -> Sides | None:
    """A drive in each load case with its bounds; None where some case has none."""
    found = Sides()
    for case in moving_checks(catalog, one.rows, block):
        both = sampled_bounds(case.spec, case.at, case.required, case.warmth, case.peaks, case.parts)
        if both is None:
            return None
        found.append((case, *both))
    return found


def _by_low(low: CheckColumn, high: CheckColumn) -> tuple[Failed, Failed]:
    """Samples in which a check fails by its lower bound, and in which it is unknown whatever the demand is."""
    bare = np.isnan(low.limit) & np.isnan(high.limit) & np.isfinite(high.demand)
    lacking = np.isnan(low.demand) & np.isnan(high.demand) if high.name in BATTERY_SAMPLED else False
    return low.failed, bare | lacking


Both = Iterator[tuple[Callable[[], CheckColumn], CheckColumn]]  # by lower bounds, where wanted, and by upper ones


def _of_the_waveform(sides: Sides) -> Both:
    for case, low, high in sides:
        made = partial(waveform_limits, case.spec, low.found, low.found, case.parts)
        for n, check in enumerate(waveform_limits(case.spec, high.found, high.found, case.parts)):
            yield partial(_nth, made, n), check


def _of_the_battery(block: Block, belt: float, sides: Sides) -> Both:
    for feeds, numbers in block.feeds:
        spec, at = block.specs[numbers[0]], block.ats[numbers[0]][belt]
        draws = [[side[place].draw for side in (sides[n][1:] for n in numbers)] for place in (0, 1)]
        made = partial(battery_limits, spec, feeds, at, draws[0])
        for n, check in enumerate(battery_limits(spec, feeds, at, draws[1])):
            yield partial(_nth, made, n), check


def _nth(made: Callable[[], list[CheckColumn]], n: int) -> CheckColumn:
    return made()[n]


# --- in order


class MostFirst(Sequence[int]):
    """Rows of drives, those that pass most samples first; of equals the first.

    Which comes next is known once the bounds of none of the others exceed its count: only such drives are counted.
    """

    def __init__(self, most: Mapping[int, int], count: Callable[[int], int]) -> None:
        """``most``: upper bounds of the counts, by row; ``count``: the count itself, of a row."""
        self._count = count
        self._heap = [(-bound, False, place, row) for place, (row, bound) in enumerate(most.items())]
        heapq.heapify(self._heap)
        self._known: list[int] = []
        self._size = len(self._heap)

    def __len__(self) -> int:
        return self._size

    @overload
    def __getitem__(self, place: int) -> int: ...
    @overload
    def __getitem__(self, place: slice) -> list[int]: ...
    def __getitem__(self, place: int | slice) -> int | list[int]:
        wanted = range(self._size)[place]  # as a list refuses what is beyond its ends
        last = wanted if isinstance(wanted, int) else max(wanted, default=-1)
        while len(self._known) <= last:
            _, counted, nth, row = heapq.heappop(self._heap)
            if counted:
                self._known.append(row)
            else:
                heapq.heappush(self._heap, (-self._count(row), True, nth, row))
        return self._known[place] if isinstance(place, int) else self._known[: last + 1][place]


# -- Reliability of a sizing's drives: uncertain figures, samples, checks of the drives over them, sensitivities.


class SampledDrives(NamedTuple):
    """Drives over samples, by their rows in the result of the search."""

    good: list[int]  # in their order; with a required confidence those that reach it
    bad: Sequence[int]  # that do not, the most reliable first
    subjects: dict[int, Subject]  # both
    ready: Prepared
    drawn: Sample
    how: Sampling
    ends: Prepared | None  # one figure varied at a time; None where the probabilities are all that is wanted

    def examined(self, rows: Collection[int]) -> dict[int, Examined]:
        """Probability, and every check over the samples, of some of them."""
        some = [self.subjects[row] for row in rows]
        found = examined(self.ready, self.ready.problem.catalog, some, self.how.processes)
        return dict(zip(rows, found, strict=True))


def sample_drives(
    problem: Problem, subjects: Mapping[int, Subject], how: Sampling, *, brief: bool = False
) -> SampledDrives:
    """Reliability of drives."""
    rows = [(one.rows.motor, one.rows.gearhead, one.rows.controller) for one in subjects.values()]
    catalog, machine = problem.catalog, problem.machine
    held = used(catalog, machine.tolerances.given, rows)
    if machine.needs.start_speed is None:
        held = tuple(one for one in held if one.figure != "start_speed")  # no check depends on it
    given = assumptions(machine, held)
    drawn = sample(given, how.samples, how.seed, assumptions(machine))
    ready = prepared(problem, given, drawn.values)
    good, bad = _divided(ready, subjects, how)
    ends = None if brief else at_ends(problem, given)
    return SampledDrives(good, bad, {**subjects}, ready, drawn._replace(values=ready.values), how, ends)


def _divided(ready: Prepared, subjects: Mapping[int, Subject], how: Sampling) -> tuple[list[int], Sequence[int]]:
    """Rows of drives that reach the required confidence, and of those that do not, the most reliable first.

    Drives of which bounds say enough are not looked at any closer.
    """
    if how.confidence is None:
        return [*subjects], []
    catalog, required = ready.problem.catalog, how.confidence
    some = passing(ready, catalog, [*subjects.values()], how.processes)
    found = dict(zip(subjects, some, strict=True))

    @cache
    def count(row: int) -> int:
        return counted(ready, catalog, subjects[row], found[row])

    def enough(samples: int) -> bool:
        return samples / len(ready.values) >= required

    good = [row for row, one in found.items() if enough(one.least) or (enough(one.most) and enough(count(row)))]
    return good, MostFirst({row: one.most for row, one in found.items() if row not in good}, count)


def subject(evaluation: Evaluation, row: int, beside: tuple[Check, ...] = ()) -> Subject:
    """A drive that a search found, with its checks by physics."""
    given = evaluation.candidates
    rows = SetRows(
        int(given.motor[row]), int(given.gearhead[row]), int(evaluation.encoder[row]), int(evaluation.controller[row]),
        float(given.belt[row]), int(evaluation.brake[row]),
    )  # fmt: skip
    return Subject(rows, tuple(c for c in (*evaluation.checks_of(row), *beside) if c.method == "physics"))


def reliabilities(
    sampled: SampledDrives, rows: Collection[int], finalists: Mapping[int, DriveParts]
) -> dict[int, Reliability]:
    """Reliability of drives, with the sensitivities of each unless they were sampled in brief."""
    catalog, ends, described = sampled.ready.problem.catalog, sampled.ends, {}
    for row, found in sampled.examined(rows).items():
        described[row], one = found.reliability, sampled.subjects[row]
        if ends is None:
            continue
        matters = drivers(one, catalog, ends, sampled.drawn, found.smallest)
        figures = figure_spreads(sampled.ready, catalog, one.rows)
        described[row] = replace(described[row], drivers=matters, figures=figures)
        if row in finalists and sampled.how.loop > 0 and not sampled.ready.spec.steps:
            described[row] = _in_the_loop(sampled, one, finalists[row], described[row])
    return described


def _in_the_loop(sampled: SampledDrives, examined_: Subject, one: DriveParts, found: Reliability) -> Reliability:
    """With the share of samples that pass in closed loop, or why there is none: the model may lack a figure."""
    from drivesizer.search.uncertainty.sampled_closed_loop import loop_share

    ready = sampled.ready
    own = counting(examined_, ready.problem.catalog, ready.spec, ready.given)
    values = sampled.drawn.values[:, own]
    try:
        share = loop_share(ready.spec, one, [ready.given[k] for k in own], values, sampled.how.loop)
    except InputError as error:
        return replace(found, no_loop=str(error))
    return replace(found, loop=share)


def uncertainty(one: SampledDrives) -> Uncertainty:
    """Assumptions and samples, which all drives have in common."""
    return Uncertainty(
        assumptions=tuple(_uncertain(given) for given in one.ready.given),
        samples=one.drawn.size,
        seed=one.how.seed,
        confidence=one.how.confidence,
        examined=len(one.subjects),
        reached=len(one.good),
        notes=(*_notes(one.ready, one.how, len(one.subjects)), *_idle(one)),
    )


def _uncertain(one: Assumption) -> Uncertain:
    text = one.given.text if one.given else one.catalogue.text if one.catalogue else ""
    title = one.name if one.given else one.catalogue.title if one.catalogue else one.name
    return Uncertain(name=one.name, title=title, text=text, source=one.catalogue.why if one.catalogue else "spec")


def _notes(ready: Prepared, how: Sampling, examined_: int) -> tuple[str, ...]:
    """Notes on the basis of the probabilities."""
    deviating = (
        "a stepper's driver is held against the current that is set, not against what it is off"
        if ready.spec.steps
        else "the voltage drop of the controller goes with its losses"
    )
    notes = [
        f"limits are the catalogue's, as printed, but {deviating}; "
        "encoder and controller are those of the nominal drive; all drives of the machine deviate alike",
        "the probability is that no check of the physics fails, nor the battery's autonomy, range, peak and voltage; "
        "other budgets of the machine are at nominal figures",
    ]
    if ready.spec.method == "paper":
        notes.append("the paper's factors do not enter: the sampled checks are those of the physics beside it")
    if ready.fitted > 1e-12:
        notes.append(f"load cycles of the samples are fitted to {ready.fitted:.0e} of their largest value")
    if len(ready.values) < how.samples:
        notes.append(f"each sample's load cycle is computed by itself: {len(ready.values)} samples, not {how.samples}")
    if ready.spec.steps:
        notes.append("of the pull-out torque the smallest margin counts what exceeds the required factor")
    if ready.spec.steps and how.loop > 0:
        notes.append("steppers run open-loop: they are not sampled in closed loop")
    if isinstance(ready.spec.load, WheelLoad):
        notes.append("platforms on a path are not sampled in closed loop; peaks and voltage of the battery are nominal")
    if how.confidence is not None and examined_ >= POOL:
        notes.append(f"only the best {POOL} drives that meet all limits at nominal figures were sampled")
    return tuple(notes)


_LOOKED_AT = 3  # drives


def _idle(one: SampledDrives) -> list[str]:
    """Notes on tolerances of the spec that change no sampled check of the first drives, each reason once."""
    if one.ends is None:
        return []
    drives = [*one.subjects.values()][:_LOOKED_AT]
    by_reason: dict[str, list[str]] = {}
    for figure in without_effect(drives, one.ready.problem.catalog, one.ends):
        looped = (
            one.how.confidence is not None and one.how.loop > 0 and figure.given and figure.given.path[0] == "plant"
        )
        if figure.given and not looped:
            by_reason.setdefault(reason(figure.given.path), []).append(figure.name)
    return [
        f"no sampled check depends on {', '.join(names)}: that tolerance has no effect here{f'; {why}' if why else ''}"
        for why, names in by_reason.items()
    ]
