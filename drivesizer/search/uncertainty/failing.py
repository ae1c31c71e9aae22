"""In how many samples a drive passes: all that is needed of drives before it is known which of them are shown.

The checks are those of ``probabilities``, which has their margins, quantiles and shares too. Bounds over the waveform
decide most samples; the course of the winding's temperature is left to drives of which they do not show enough.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_SAMPLED
from drivesizer.search.columns.limits_over_time import waveform_limits
from drivesizer.search.uncertainty.prepare import Prepared
from drivesizer.search.uncertainty.probabilities import Subject, blocks_of, by_processes
from drivesizer.search.uncertainty.sampled_battery import battery_limits
from drivesizer.search.uncertainty.sampled_checks import Moving, checks_of, moving_checks, over_time_checks
from drivesizer.search.uncertainty.sampled_parts import Block
from drivesizer.search.uncertainty.waveform_bounds import Side, sampled_bounds

__all__ = ["MostFirst", "Passing", "counted", "failing", "passing"]

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
