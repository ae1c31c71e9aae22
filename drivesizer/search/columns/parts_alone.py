"""The first stage: limits of the load, of a gearhead or of a motor alone, once per part and not per combination.

A pair fails where one of its parts does, so that most pairs are judged behind all belts without being made: of those
whose motor fails nothing hangs on the belt.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.several_belts import AtGearheads
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.columns.candidates import Candidates, Crossed, Rows
from drivesizer.search.columns.encoders import counts_check
from drivesizer.search.columns.limits import gearhead_limits, load_limits
from drivesizer.search.columns.offers import Offers, limits_behind_each, worst_of_all
from drivesizer.search.columns.shaft_limits import loads_on_gearheads
from drivesizer.search.columns.survivors import Amount, Rejected, Sieve, amounting, bound_of

__all__ = ["Started", "all_of_them", "behind", "by_their_parts"]

Array = NDArray[np.float64]
_ENOUGH = 100  # rejected candidates, to find the closest among
_ROWS = 1 << 15  # candidates behind several belts that go on together
_MOST = 1 << 16  # of those behind one belt


class Started(NamedTuple):
    """Candidates that go on, behind one belt after the other."""

    sets: Candidates
    sieve: Sieve
    cycles: list[AtGearhead]  # of each load case


class _Judged(NamedTuple):
    """Checks of parts, what they amount to, and what the smallest margin of each part is at most."""

    checks: list[CheckColumn]
    amount: Amount
    bound: Array


def _judged(checks: list[CheckColumn], count: int, margins: bool) -> _Judged:
    return _Judged(checks, amounting(checks, count, margins), bound_of(checks, count))


class _Parts(NamedTuple):
    """All that is judged alone."""

    load: list[_Judged]  # behind each belt, of one row
    gearhead: _Judged  # all gearheads behind the first belt, then behind the next
    motor: _Judged


def by_their_parts(problem: Problem, offered: Offers, crossed: Crossed, margins: bool) -> Iterator[Started]:
    """Of pairs behind several belts those of which no part fails, so many at a time.

    Parameters
    ----------
    problem, offered
        The problem, and what there is for each motor.
    crossed
        All candidates.
    margins
        Compute the smallest margin of each.

    Yields
    ------
    Started
        At least one; what failed is counted in the first.
    """
    parts = _of_the_catalog(problem, offered, crossed.belts, margins)
    left, rejected = _sorted_out(crossed.pairs, parts)
    counted: Counter[str] = _failed_by(crossed, parts)
    for numbers in _several([len(rows) for rows in left], np.concatenate(left)):
        started = _started(problem, crossed, numbers, parts, margins)
        started.sieve.failed_by, started.sieve.rejected = counted, rejected
        counted, rejected = Counter(), []
        yield started


def _of_the_catalog(problem: Problem, offered: Offers, belts: Sequence[float], margins: bool) -> _Parts:
    """Every motor with its best encoder, and behind each belt the load and every gearhead."""
    catalog, count = problem.catalog, len(problem.catalog.gearheads)
    motor = [*offered.motor_limits, *counts_check(problem.spec, catalog, offered.encoders.last)]
    which = np.repeat(np.arange(len(belts)), count)
    every = Rows(catalog.gearheads, np.tile(np.arange(count), len(belts)))
    cycles = [behind(case, belts, which) for case in problem.cases]
    return _Parts(
        [_judged(_loads(problem, [c.at_belt.behind(belt) for c in problem.cases]), 1, margins) for belt in belts],
        _judged(_gearheads(problem, cycles, every), len(which), margins),
        _judged(motor, len(catalog.motors), margins),
    )


def behind(case: LoadCase, belts: Sequence[float], which: NDArray[np.int64]) -> AtGearhead:
    """The load cycle behind several belts; ``which``: number of each candidate's belt, never falling."""
    return AtGearheads([case.at_belt.behind(belt) for belt in belts], which).on(slice(None))


def _loads(problem: Problem, cycles: Sequence[AtGearhead]) -> list[CheckColumn]:
    """Limits of the load behind one belt: columns of one figure."""
    drive = problem.belt_drive(cycles[0].belt)
    return worst_of_all(problem, lambda k: load_limits(problem.cases[k].spec, cycles[k], drive))


def _gearheads(problem: Problem, cycles: Sequence[AtGearhead], gearhead: Rows) -> list[CheckColumn]:
    """Limits of gearheads, each behind its belt."""

    def limits(k: int) -> list[CheckColumn]:
        spec, count = problem.cases[k].spec, len(gearhead.rows)
        on_shaft = limits_behind_each(
            problem, cycles[k], lambda at, drive, rows: loads_on_gearheads(spec, at, drive, gearhead.on(rows)), count
        )
        return gearhead_limits(spec, cycles[k], gearhead) + on_shaft

    return worst_of_all(problem, limits)


def _sorted_out(pairs: Candidates, parts: _Parts) -> tuple[list[NDArray[np.int64]], list[Rejected]]:
    """Numbers of the candidates that no part fails, and of the others those near to that: behind each belt."""
    load, gearhead, motor = parts
    bad_motor, total = motor.amount.failed, len(pairs.motor)
    alive = np.flatnonzero(~bad_motor[pairs.motor])
    of_alive, size = pairs.gearhead[alive], len(gearhead.bound) // len(load)
    left, rejected = list[NDArray[np.int64]](), list[Rejected]()
    for number, one in enumerate(load):
        behind_it = slice(number * size, (number + 1) * size)
        bad = gearhead.amount.failed[behind_it] | one.amount.failed
        fails = bad[of_alive]
        near = alive[fails]
        if len(near) < _ENOUGH:  # those of a motor that fails too are hardly among the nearest
            near = np.flatnonzero(bad[pairs.gearhead] | bad_motor[pairs.motor])
        bound = np.minimum(gearhead.bound[behind_it][pairs.gearhead[near]], one.bound)
        rejected.append((near + number * total, np.minimum(bound, motor.bound[pairs.motor[near]])))
        left.append(alive[~fails] + number * total)
    return left, rejected


def _failed_by(crossed: Crossed, parts: _Parts) -> Counter[str]:
    """How many candidates each check of a part fails."""
    found, belts = Counter[str](), len(crossed.belts)
    load, gearhead, motor = parts
    for one in load:
        for check in one.checks:
            found[check.name] += len(crossed.pairs.motor) * int(check.failed)
    for check in motor.checks:
        found[check.name] += belts * _together(crossed.pairs.motor, check.failed)
    for check in gearhead.checks:
        found[check.name] += _together(crossed.pairs.gearhead, check.failed.reshape(belts, -1).sum(axis=0))
    return found


def _together(owner: NDArray[np.int64], failures: NDArray[Any]) -> int:
    """Failures of pairs, of which each part has so many."""
    used = np.bincount(owner, minlength=len(failures))
    return int(used @ failures)


def _several(counts: Sequence[int], numbers: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """The numbers behind some belts at a time, which are few enough to go on together."""
    start = end = 0
    ends = [0]
    for count in counts:
        if end > start and end + count - start > _ROWS:
            ends.append(start := end)
        end += count
    for first, last in pairwise([*ends, end]):
        for start in range(first, max(last, first + 1), _MOST):
            yield numbers[start : min(start + _MOST, last)]


def _started(problem: Problem, crossed: Crossed, numbers: NDArray[np.int64], parts: _Parts, margins: bool) -> Started:
    """Some of the candidates, with what the checks of their parts amount to."""
    sets, (load, gearhead, motor) = crossed.on(numbers), parts
    which = numbers // max(len(crossed.pairs.motor), 1)
    place = which * (len(gearhead.bound) // len(load)) + sets.gearhead
    unknown = gearhead.amount.unknown[place] | motor.amount.unknown[sets.motor]
    unknown |= np.concatenate([one.amount.unknown for one in load])[which]
    margin = np.minimum(gearhead.amount.margin[place], motor.amount.margin[sets.motor])
    margin = np.minimum(margin, np.concatenate([one.amount.margin for one in load])[which])
    cycles = [behind(case, crossed.belts, which) for case in problem.cases]
    return Started(sets, Sieve(numbers, unknown, margin, margins), cycles)


def all_of_them(problem: Problem, offered: Offers, sets: Candidates) -> Iterator[Started]:
    """All candidates, with the checks of their parts in full, so many at a time.

    Parameters
    ----------
    problem, offered
        The problem, and what there is for each motor.
    sets
        The candidates, their belts never falling.

    Yields
    ------
    Started
        None where there are no candidates.
    """
    belts, counts = np.unique(sets.belt, return_counts=True)
    number = np.repeat(np.arange(len(belts)), counts)
    for rows in _several(counts.tolist(), np.arange(len(sets.motor))) if len(belts) else ():
        some = sets.on(rows)
        cycles = [behind(case, belts.tolist(), number[rows]) for case in problem.cases]
        checks = [
            *_loads_of_each(problem, cycles, len(rows)),
            *_gearheads(problem, cycles, Rows(problem.catalog.gearheads, some.gearhead)),
            *(check.on(some.motor) for check in offered.motor_limits),
        ]
        yield Started(some, Sieve.of_all(rows, checks), cycles)


def _loads_of_each(problem: Problem, cycles: Sequence[AtGearhead], count: int) -> list[CheckColumn]:
    """Limits of the load of each candidate."""

    def limits(k: int) -> list[CheckColumn]:
        spec = problem.cases[k].spec
        return limits_behind_each(problem, cycles[k], lambda at, drive, _: load_limits(spec, at, drive), count)

    return worst_of_all(problem, limits)
