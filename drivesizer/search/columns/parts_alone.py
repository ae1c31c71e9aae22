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

from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.several_belts import AtGearheads
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates, Crossed, Rows
from drivesizer.search.columns.encoders import counts_check
from drivesizer.search.columns.limits import gearhead_limits, load_limits
from drivesizer.search.columns.offers import Offers, limits_behind_each, worst_of_all
from drivesizer.search.columns.shaft_limits import loads_on_gearheads
from drivesizer.search.columns.survivors import Amount, Rejected, Sieve, amounting, bound_of

__all__ = ["Started", "all_of_them", "belts_together", "by_their_parts"]

Array = NDArray[np.float64]
_ENOUGH = 100  # rejected candidates, to find the closest among
_ROWS = 1 << 15  # candidates behind several belts that go on together
_MOST = 1 << 16  # of those behind one belt
_SHORT = 256  # pieces of a load cycle
_MANY_BELTS, _BELTS = 64, 16  # whose load cycles are held at a time


class Started(NamedTuple):
    """Candidates that go on, behind one belt after the other."""

    sets: Candidates
    sieve: Sieve
    cycles: list[AtGearhead]  # of each load case


class _Judged(NamedTuple):
    """Checks of parts, and what they amount to."""

    checks: list[CheckColumn]
    amount: Amount
    bound: Array  # what the smallest margin of each part is at most


def _judged(checks: list[CheckColumn], count: int, margins: bool) -> _Judged:
    return _Judged(checks, amounting(checks, count, margins), bound_of(checks, count))


class _Parts(NamedTuple):
    """All that is judged alone."""

    load: list[_Judged]  # behind each belt, of one row
    gearhead: list[CheckColumn]  # of all gearheads behind the first belt, then behind the next
    motor: _Judged
    behind: list[list[AtGearhead]]  # the load cycle of each case behind each belt


def by_their_parts(problem: Problem, offered: Offers, crossed: Crossed, margins: bool) -> Iterator[Started]:
    """Of pairs behind several belts those of which no part fails, so many at a time."""
    parts = _of_the_catalog(problem, offered, crossed.belts, margins)
    left, near = _sorted_out(crossed, parts)
    gearheads = _worth(parts, crossed.pairs.gearhead, (left, near), margins)
    counted, rejected = _failed_by(crossed, parts), [_bounded(crossed, near, parts, gearheads)]
    counts = np.bincount(left.belt, minlength=len(crossed.belts))
    for rows in _several(counts.tolist(), len(crossed.belts)):
        started = _started(crossed, _Numbers(left.belt[rows], left.row[rows]), parts, gearheads, margins)
        started.sieve.failed_by, started.sieve.rejected = counted, rejected
        counted, rejected = Counter(), []
        yield started


def _of_the_catalog(problem: Problem, offered: Offers, belts: Sequence[float], margins: bool) -> _Parts:
    """Every motor with its best encoder, and behind each belt the load and every gearhead."""
    catalog, count = problem.catalog, len(problem.catalog.gearheads)
    motor = [*offered.motor_limits, *counts_check(problem.spec, catalog, offered.encoders.last)]
    every = Rows(catalog.gearheads, np.tile(np.arange(count), len(belts)))
    behind = [[case.at_belt.behind(belt) for belt in belts] for case in problem.cases]
    which = np.repeat(np.arange(len(belts)), count)
    return _Parts(
        [_judged(_loads(problem, cycles), 1, margins) for cycles in zip(*behind, strict=True)],
        _gearheads(problem, [_behind_each(ats, which) for ats in behind], every),
        _judged(motor, len(catalog.motors), margins),
        behind,
    )


def _behind_each(ats: Sequence[AtGearhead], which: NDArray[np.int64]) -> AtGearhead:
    """A load cycle behind several belts; ``which``: number of each candidate's belt, never falling."""
    return AtGearheads(ats, which).on(slice(None))


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


class _Numbers(NamedTuple):
    """Candidates, by the number of their belt and the row of their pair."""

    belt: NDArray[np.int64]
    row: NDArray[np.int64]

    @classmethod
    def of(cls, rows: Sequence[NDArray[np.int64]]) -> _Numbers:
        """Those behind each belt, one after the other."""
        return cls(np.repeat(np.arange(len(rows)), [len(some) for some in rows]), np.concatenate(rows))


def _sorted_out(crossed: Crossed, parts: _Parts) -> tuple[_Numbers, _Numbers]:
    """The candidates that no part fails, and of the others that count those that are near to that."""
    bad_motor, belts, pairs, counted = parts.motor.amount.failed, len(parts.load), crossed.pairs, crossed.counted
    failed = np.logical_or.reduce([check.failed for check in parts.gearhead]).reshape(belts, -1)
    alive = np.flatnonzero(~bad_motor[pairs.motor])
    of_alive, end = pairs.gearhead[alive], np.searchsorted(alive, len(counted.motor))
    left, rejected = list[NDArray[np.int64]](), list[NDArray[np.int64]]()
    for number, one in enumerate(parts.load):
        bad = failed[number] | one.amount.failed
        fails = bad[of_alive]
        near = alive[:end][fails[:end]]
        if len(near) < _ENOUGH:  # those of a motor that fails too are hardly among the nearest
            near = np.flatnonzero(bad[counted.gearhead] | bad_motor[counted.motor])
        rejected.append(near)
        left.append(alive[~fails])
    return _Numbers.of(left), _Numbers.of(rejected)


class _Gearheads(NamedTuple):
    """Amount of the checks of those gearheads that some candidates have, behind each belt."""

    amount: Amount
    bound: Array  # what the smallest margin of each is at most
    place: NDArray[np.int64]  # of each gearhead among them
    several: int  # behind each belt

    def of(self, belt: NDArray[np.int64], gearhead: NDArray[np.int64]) -> NDArray[np.int64]:
        """Places of some gearheads behind some belts among them."""
        found: NDArray[np.int64] = belt * self.several
        found += self.place.take(gearhead)
        return found


def _worth(parts: _Parts, gearhead: NDArray[np.int64], candidates: Sequence[_Numbers], margins: bool) -> _Gearheads:
    """The gearheads of some candidates, of which row each pair has the one that ``gearhead`` says."""
    belts, used = len(parts.load), np.zeros(len(parts.gearhead[0].failed) // len(parts.load), bool)
    pairs = np.zeros(len(gearhead), bool)
    for some in candidates:
        pairs[some.row] = True
    used[gearhead[pairs]] = True
    rows = np.flatnonzero(used)
    every = (np.arange(belts)[:, None] * len(used) + rows).ravel()
    judged = _judged([check.on(every) for check in parts.gearhead], len(every), margins)
    return _Gearheads(judged.amount, judged.bound, np.cumsum(used) - 1, len(rows))


def _bounded(crossed: Crossed, some: _Numbers, parts: _Parts, gearheads: _Gearheads) -> Rejected:
    """Rejected candidates, and what the smallest margin of their parts is at most."""
    of_pair = parts.motor.bound.take(crossed.pairs.motor)
    place = gearheads.of(some.belt, crossed.pairs.gearhead.take(some.row))
    bound = np.minimum(gearheads.bound.take(place), of_pair.take(some.row))
    of_load = np.concatenate([one.bound for one in parts.load])
    return crossed.number(*some), np.minimum(bound, of_load.take(some.belt), out=bound)


def _failed_by(crossed: Crossed, parts: _Parts) -> Counter[str]:
    """Number of candidates that each check of a part fails."""
    found, belts, counted = Counter[str](), len(crossed.belts), crossed.counted
    for one in parts.load:
        for check in one.checks:
            found[check.name] += len(counted.motor) * int(check.failed)
    for check in parts.motor.checks:
        found[check.name] += belts * _together(counted.motor, check.failed)
    for check in parts.gearhead:
        found[check.name] += _together(counted.gearhead, check.failed.reshape(belts, -1).sum(axis=0))
    return found


def _together(owner: NDArray[np.int64], failures: NDArray[Any]) -> int:
    """Failures of pairs, of which each part has so many."""
    used = np.bincount(owner, minlength=len(failures))
    return int(used @ failures)


def _several(counts: Sequence[int], most: int) -> Iterator[slice]:
    """Candidates that go on together, of so many behind each belt: behind few belts, or some of those behind one."""
    start = end = belts = 0
    ends = [0]
    for count in counts:
        if end > start and (end + count - start > _ROWS or belts == most):
            ends.append(start := end)
            belts = 0
        end, belts = end + count, belts + 1
    for first, last in pairwise([*ends, end]):
        for start in range(first, max(last, first + 1), _MOST):
            yield slice(start, min(start + _MOST, last))


def belts_together(problem: Problem) -> int:
    """Number of belts whose load cycles are held at a time."""
    kept = max(0 if case.at_belt.census else case.at_belt.pieces for case in problem.cases)
    return _MANY_BELTS if kept <= _SHORT and not has_steppers(problem.catalog) else _BELTS


def _started(crossed: Crossed, some: _Numbers, parts: _Parts, gearheads: _Gearheads, margins: bool) -> Started:
    """Some of the candidates, with what the checks of their parts amount to."""
    sets, motor = crossed.pairs.on(some.row)._replace(belt=np.array(crossed.belts)[some.belt]), parts.motor.amount
    place = gearheads.of(some.belt, sets.gearhead)
    unknown = gearheads.amount.unknown.take(place, axis=0) | motor.unknown.take(sets.motor, axis=0)
    unknown |= np.concatenate([one.amount.unknown for one in parts.load]).take(some.belt, axis=0)
    doublings = gearheads.amount.doublings[place] + motor.doublings[sets.motor]
    doublings += np.concatenate([one.amount.doublings for one in parts.load])[some.belt]
    margin = gearheads.bound[place]
    if margins:
        of_load = np.concatenate([one.amount.margin for one in parts.load])
        margin = np.minimum.reduce([gearheads.amount.margin[place], motor.margin[sets.motor], of_load[some.belt]])
    cycles = [_behind_each(ats, some.belt) for ats in parts.behind]
    counted = None if crossed.first is None else some.row < crossed.first
    return Started(sets, Sieve(crossed.number(*some), unknown, doublings, margin, margins, counted), cycles)


def all_of_them(problem: Problem, offered: Offers, sets: Candidates) -> Iterator[Started]:
    """All candidates, with the checks of their parts in full, so many at a time."""
    counts = np.unique(sets.belt, return_counts=True)[1]
    for rows in _several(counts.tolist(), belts_together(problem)) if len(counts) else ():
        some = sets.on(rows)
        belts, which = np.unique(some.belt, return_inverse=True)
        cycles = [_behind_each([case.at_belt.behind(x) for x in belts.tolist()], which) for case in problem.cases]
        checks = [
            *_loads_of_each(problem, cycles, len(which)),
            *_gearheads(problem, cycles, Rows(problem.catalog.gearheads, some.gearhead)),
            *(check.on(some.motor) for check in offered.motor_limits),
        ]
        yield Started(some, Sieve.of_all(np.arange(rows.start, rows.stop), checks), cycles)


def _loads_of_each(problem: Problem, cycles: Sequence[AtGearhead], count: int) -> list[CheckColumn]:
    """Limits of the load of each candidate."""

    def limits(k: int) -> list[CheckColumn]:
        spec = problem.cases[k].spec
        return limits_behind_each(problem, cycles[k], lambda at, drive, _: load_limits(spec, at, drive), count)

    return worst_of_all(problem, limits)
