"""Candidates against the whole of physics in stages, the cheap ones first: parts alone, then combinations."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.view.mounted import has_steppers
from drivesizer.physics.cycle_at_gearhead import AtGearhead, CycleAtBelt
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.winding import Parts, belts_of, heat, on
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.columns.brakes import at_motor, brake_limits, brakes_for, counts_check, encoders_for
from drivesizer.search.columns.candidates import Amount, Candidates, Crossed, Rejected, Rows, Sieve, amounting, bound_of
from drivesizer.search.columns.limits import gearhead_limits, inertia_limits, load_limits, moving_limits, size_limits
from drivesizer.search.columns.limits_over_time import Exactly
from drivesizer.search.columns.offers import (
    Offers,
    limits_behind_each,
    offers,
    placed,
    unknown_where_doubtful,
    worst_of_all,
)
from drivesizer.search.columns.powered import Moving, Powered, powered
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors
from drivesizer.search.columns.steppers import Frictionless, stepped
from drivesizer.spec.mounting import loss_at_flange

# -- The first stage: limits of the load, of a gearhead or of a motor alone, once per part and not per combination.
#
# A pair fails where one of its parts does, so that most pairs are judged behind all belts without being made: of
# those whose motor fails nothing hangs on the belt.


Array = NDArray[np.float64]
_ENOUGH = 100  # rejected candidates, to find the closest among
_ROWS = 1 << 15  # candidates behind several belts that go on together
_MOST_BEHIND_ONE_BELT = 1 << 16  # of those behind one belt
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
    bases: list[CycleAtBelt]  # the load cycle of each case


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
    return _Parts(
        [_judged(_loads(problem, cycles), 1, margins) for cycles in zip(*behind, strict=True)],
        _gearheads(problem, [case.at_belt.behind(np.repeat(belts, count)) for case in problem.cases], every),
        _judged(motor, len(catalog.motors), margins),
        [case.at_belt for case in problem.cases],
    )


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
    """The candidates that no part fails, and of the others those that are near to that."""
    bad_motor, belts, pairs = parts.motor.amount.failed, len(parts.load), crossed.pairs
    failed = np.logical_or.reduce([check.failed for check in parts.gearhead]).reshape(belts, -1)
    alive = np.flatnonzero(~bad_motor[pairs.motor])
    of_alive = pairs.gearhead[alive]
    left, rejected = list[NDArray[np.int64]](), list[NDArray[np.int64]]()
    for number, one in enumerate(parts.load):
        bad = failed[number] | one.amount.failed
        fails = bad[of_alive]
        near = alive[fails]
        if len(near) < _ENOUGH:  # those of a motor that fails too are hardly among the nearest
            near = np.flatnonzero(bad[pairs.gearhead] | bad_motor[pairs.motor])
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
    found, belts, pairs = Counter[str](), len(crossed.belts), crossed.pairs
    for one in parts.load:
        for check in one.checks:
            found[check.name] += len(pairs.motor) * int(check.failed)
    for check in parts.motor.checks:
        found[check.name] += belts * _together(pairs.motor, check.failed)
    for check in parts.gearhead:
        found[check.name] += _together(pairs.gearhead, check.failed.reshape(belts, -1).sum(axis=0))
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
        for start in range(first, max(last, first + 1), _MOST_BEHIND_ONE_BELT):
            yield slice(start, min(start + _MOST_BEHIND_ONE_BELT, last))


def belts_together(problem: Problem) -> int:
    """Number of belts whose load cycles are held at a time."""
    kept = max(len(case.at_belt.load_cycle.duration) for case in problem.cases)
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
    cycles = [base.behind(sets.belt) for base in parts.bases]
    return Started(sets, Sieve(crossed.number(*some), unknown, doublings, margin, margins), cycles)


def all_of_them(problem: Problem, offered: Offers, sets: Candidates) -> Iterator[Started]:
    """All candidates, with the checks of their parts in full, so many at a time."""
    counts = np.unique(sets.belt, return_counts=True)[1]
    for rows in _several(counts.tolist(), belts_together(problem)) if len(counts) else ():
        some = sets.on(rows)
        cycles = [case.at_belt.behind(some.belt) for case in problem.cases]
        checks = [
            *_loads_of_each(problem, cycles, len(some.belt)),
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


# -- Candidates against the whole of physics: in stages, the cheap ones first, or all of it for a few.
#
# The same checks serve both: the search drops what fails at each stage, so that only survivors meet the next; a
# drive that is shown or explained goes through them all. In several load cases each check is that of its worst case,
# and one controller must do for all of them.


_CELLS, _MOST = (
    1_000_000,
    1 << 16,
)  # candidates times these, and of a long cycle candidates, that are looked at together


class Examined(NamedTuple):
    """Results of the candidates that came through, in their order."""

    rows: NDArray[np.int64]  # which of those that were looked at these are
    checks: list[CheckColumn]  # theirs; in stages none are kept
    unknown: NDArray[np.uint64]  # checks that are, as bits in the order of ``check_kinds``, shape (rows, words)
    doublings: NDArray[np.int64]  # of known limits up to the demands, over these
    margin: Array  # the smallest; where margins are not computed, in stages what it is at most by the gearhead alone
    encoder: NDArray[np.int64]
    controller: NDArray[np.int64]
    brake: NDArray[np.int64]  # -1 none
    figures: dict[str, Array]  # what objectives count, SI
    failed_by: Counter[str]  # in stages, how many of those looked at, as far as they were
    rejected: NDArray[np.int64]  # of those rejected the ones among which the closest are
    bound: Array  # their smallest margin is no better than this


def examine(
    problem: Problem,
    sets: Candidates | Crossed,
    *,
    exact: Exactly = True,
    each: Collection[str] = (),
    margins: bool = False,
    offered: Offers | None = None,
) -> Iterator[Examined]:
    """Candidates against every limit: pairs behind several belts in stages, a list of candidates all the way.

    Those behind several belts go together, as many as stay within the processor's cache.
    """
    offered = offered or offers(problem)
    if isinstance(sets, Crossed):
        started = by_their_parts(problem, offered, sets, margins)
    else:
        started = all_of_them(problem, offered, sets)
    for some in started:
        yield from _powered(problem, offered, _moved(problem, offered, some), exact, each)


class _Moved(NamedTuple):
    """Candidates that came through the cheap stages."""

    sieve: Sieve
    cycles: list[AtGearhead]
    cases: list[Moving]
    parts: Parts

    def split(self, places: Sequence[slice]) -> list[_Moved]:
        """Some of them at a time."""
        return [
            _Moved(sieve, [c.on(rows) for c in self.cycles], [on(c, rows) for c in self.cases], self.parts.on(rows))
            for sieve, rows in zip(self.sieve.split(places), places, strict=True)
        ]


def _moved(problem: Problem, offered: Offers, started: Started) -> _Moved:
    """The stages up to what moves."""
    sieve, catalog, sets = started.sieve, problem.catalog, started.sets
    given = None if sets.controller is None else Rows(catalog.controllers, sets.controller)
    motor, gearhead = Rows(catalog.motors, sets.motor), Rows(catalog.gearheads, sets.gearhead)
    keep = sieve.through(_combined(problem, offered, started, motor, gearhead))
    motor, gearhead, cycles = motor.on(keep), gearhead.on(keep), [cycle.on(keep) for cycle in started.cycles]
    encoder = encoders_of(problem, offered, cycles, motor.rows, gearhead["ratio"])
    if not sieve.staged:  # in stages each motor was judged by what there is for it
        sieve.through(counts_check(problem.spec, catalog, encoder))
    parts = Parts(motor, gearhead, Rows(catalog.encoders, encoder), None if given is None else given.on(keep))
    if offered.brakes:
        chosen = None if sets.brake is None else sets.brake[keep]
        parts = parts._replace(brake=_brakes_of_each(problem, offered, cycles, parts, chosen))
        keep = sieve.through(size_limits(problem.spec, motor, gearhead, parts.brake))
        parts, cycles = parts.on(keep), [cycle.on(keep) for cycle in cycles]
    steppers = has_steppers(catalog)
    turning = parts._replace(motor=Frictionless(parts.motor)) if steppers else parts
    cases = [_moving(case, cycle, turning) for case, cycle in zip(problem.cases, cycles, strict=True)]
    keep = sieve.through(worst_of_all(problem, partial(_in_motion, problem, offered, cycles, cases, parts)))
    return _Moved(sieve, [cycle.on(keep) for cycle in cycles], [on(case, keep) for case in cases], parts.on(keep))


def _combined(problem: Problem, offered: Offers, started: Started, motor: Rows, gearhead: Rows) -> list[CheckColumn]:
    """Limits of a combination at rest: that it is listed, its size, and loads on the shaft of a motor alone."""
    spec, listed = problem.spec, started.sets.listed

    def on_shaft(k: int) -> list[CheckColumn]:
        case = problem.cases[k].spec
        return limits_behind_each(
            problem, started.cycles[k],
            lambda at, drive, rows: loads_on_motors(case, at, drive, motor.on(rows), gearhead.on(rows)), len(listed),
        )  # fmt: skip

    found = [fits("compatibility", True, listed)]
    if not offered.brakes:
        found += size_limits(spec, motor, gearhead)
    return found + worst_of_all(problem, on_shaft)


def _in_motion(
    problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], cases: Sequence[Moving], parts: Parts, k: int
) -> list[CheckColumn]:
    """Limits of combinations in one load case that its moments decide."""
    spec, cycle, case = problem.cases[k].spec, cycles[k], cases[k]
    if has_steppers(problem.catalog):
        checks = inertia_limits(spec, cycle, case.demand, parts)
    else:
        checks = moving_limits(spec, cycle, *case, parts)
    if offered.brakes and parts.brake is not None:
        listed = offered.brakes.goes(parts.motor.rows, parts.brake.rows)
        checks += brake_limits(spec, cycle, parts, case.demand, listed)
    return unknown_where_doubtful(checks, case.demand.complete)


def _moving(case: LoadCase, cycle: AtGearhead, parts: Parts) -> Moving:
    demand = demands(cycle, parts.motor, parts.gearhead, parts.encoder, felt(cycle, parts))
    at_flange = loss_at_flange(case.spec, cycle, parts.gearhead)
    return Moving(demand, heat(case.spec.environment.ambient, cycle, demand, parts.motor, from_gearhead=at_flange))


def felt(cycle: AtGearhead, parts: Parts) -> Any:
    """Inertia of brakes as the motor's shaft feels it [kg*m^2]; 0 where no drive has one."""
    if parts.brake is None:
        return 0.0
    return at_motor(parts.brake, "inertia", parts.gearhead["ratio"] * cycle.belt)


def brakes_of(
    problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], parts: Parts, given: Any = None
) -> Rows | None:
    """A brake for each candidate, that holds the load in all cases; None where the spec wants none."""
    if offered.brakes is None:
        return None
    return Rows(problem.catalog.brakes, brakes_for(problem, offered.brakes, cycles, parts[:3], given))


def encoders_of(
    problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], motor: NDArray[np.int64], ratio: Array
) -> NDArray[np.int64]:
    """An encoder for each candidate that does in the fastest of all load cases."""
    specs = [case.spec for case in problem.cases]
    speeds = [cycle.peak_speed * (1.0 + spec.margins.speed) for spec, cycle in zip(specs, cycles, strict=True)]
    fastest = np.maximum.reduce(speeds)
    return encoders_for(problem.spec, offered.encoders, motor, fastest * ratio, ratio * cycles[0].belt)


def _brakes_of_each(
    problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], parts: Parts, given: Any
) -> Rows | None:
    """Brakes for candidates behind any number of belts."""
    if offered.brakes is None:
        return None
    found, count = list[tuple[slice, NDArray[np.int64]]](), len(parts.motor.rows)
    for at, rows in belts_of(cycles[0], count):
        some, behind = None if given is None else given[rows], [cycle.base.behind(at.belt) for cycle in cycles]
        brake = brakes_of(problem, offered, behind, parts.on(rows), some)
        found.append((rows, brake.rows if brake else np.full(0, -1)))
    return Rows(problem.catalog.brakes, placed(found, count, np.int64))


def _powered(
    problem: Problem, offered: Offers, moved: _Moved, exact: Exactly, each: Collection[str]
) -> Iterator[Examined]:
    """Current, and what needs the waveform, with the smallest controller that does for all cases; or steppers."""
    places, staged = _places(problem, moved), moved.sieve.staged
    for sieve, cycles, cases, parts in moved.split(places) if len(places) > 1 else [moved]:
        if has_steppers(problem.catalog):
            demand = [case.demand for case in cases]
            found = Powered(*stepped(problem, offered, cycles, demand, parts, staged=staged))
        else:
            which = exact[sieve.rows] if isinstance(exact, np.ndarray) else exact
            found = powered(problem, offered, cycles, cases, parts, exactly=which, each=each)
        yield _examined(sieve, parts, found)


def _places(problem: Problem, moved: _Moved) -> list[slice]:
    """Candidates that are looked at together: behind as many belts as their waveforms have room."""
    steppers, pieces = has_steppers(problem.catalog), max(len(c.load_cycle.duration) for c in moved.cycles)
    most = _CELLS // pieces if pieces <= _SHORT else _MOST
    found = list[slice]()
    for _, rows in belts_of(moved.cycles[0], len(moved.parts.motor.rows)):
        start = found[-1].start if found else 0
        if found and (steppers or rows.stop - start <= most):
            found[-1] = slice(start, rows.stop)
        else:
            found.append(rows)
    return found


def _examined(sieve: Sieve, parts: Parts, found: Powered) -> Examined:
    """Results of some candidates."""
    sieve.checks = [check for check in sieve.checks if check.name != "winding_temperature"]  # that of the mean
    keep = sieve.through(found.checks)
    figures = {name: value[keep] for name, value in found.figures.items()}
    rejected = np.concatenate([sieve.rows[:0], *(rows for rows, _ in sieve.rejected)])
    bound = np.concatenate([sieve.margin[:0], *(bound for _, bound in sieve.rejected)])
    brake = np.full(len(parts.motor.rows), -1) if parts.brake is None else parts.brake.rows
    return Examined(
        sieve.rows, sieve.checks, sieve.unknown, sieve.doublings, sieve.margin, parts.encoder.rows[keep],
        found.controller[keep], brake[keep], figures, sieve.failed_by, rejected, bound,
    )  # fmt: skip
