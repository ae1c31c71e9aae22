"""Candidates against the whole of physics: in stages, the cheap ones first, or all of it for a few.

Load, gearhead and motor are checked once per part, and a pair of which one fails is never made. Combinations go by
moments, survivors by peaks, voltage and controller, the rest by the waveform. The search drops what fails at each
stage, so that only survivors meet the next; a drive that is shown or explained goes through the same checks all the
way. In several load cases each check is that of its worst case, and one controller must do for all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import BeltDrive
from drivesizer.catalog.view import has_steppers
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.figures import Array, Mask, Whole, on
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.winding import Parts, belts_of
from drivesizer.results.check_columns import CheckColumn, fits, over_ends, together
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.columns import brakes, limits, steppers
from drivesizer.search.columns.candidates import FREE, Candidates, Crossed, Rows
from drivesizer.search.columns.controllers import Moving, Usable, powered, usable_controllers
from drivesizer.search.columns.limits_over_time import Waveform
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors
from drivesizer.spec.mounting import heat_of
from drivesizer.spec.robot import RobotSpec

_ENOUGH = 100  # rejected candidates, to find the closest among
_ROWS = 1 << 15  # candidates behind several belts that go on together: as many as stay within the processor's cache
_MOST = 1 << 16  # of those behind one belt, and of those whose waveforms are long
_CELLS = 1_000_000  # candidates times segments that are computed together
_SHORT = 256  # segments of a load cycle
_MANY_BELTS, _BELTS = 64, 16  # whose load cycles are held at a time
_WORD = 64  # bits of a word of the checks that are unknown
_BY_INERTIA = {"inertia_ratio", "first_resonance", "gearhead_stop_torque"}  # more inertia at the motor may help these
_BITS = {name: (place // _WORD, np.uint64(1 << place % _WORD)) for place, name in enumerate(CHECKS["physics"])}


class Offers(NamedTuple):
    """For every motor of the catalogues its encoders, controllers, brakes, and the limits that no load changes."""

    encoders: brakes.EncoderOffers
    controllers: Usable
    motor_limits: list[CheckColumn]
    brakes: brakes.OfferedBrakes | None  # None where the spec wants none


def offers(problem: Problem) -> Offers:
    """The encoders, controllers, brakes and own limits of every motor, at the supply and ambient of all load cases."""
    spec, catalog = problem.spec, problem.catalog
    own = limits.worst_of_all(limits.motor_limits(case.spec, catalog.motors) for case in problem.cases)
    hottest = max(case.spec.environment.ambient for case in problem.cases)
    controllers = usable_controllers(spec, catalog, problem.supply, hottest)
    return Offers(brakes.offered_encoders(spec, catalog), controllers, own, brakes.offered_brakes(spec, catalog))


class Amount(NamedTuple):
    """Outcome of several checks together: columns over parts or candidates."""

    failed: Mask  # whether any fails
    unknown: NDArray[np.uint64]  # which are, as bits in the order of ``checks.txt``, shape (rows, words)
    opened: Whole  # how many are open, whatever estimates say
    doublings: Whole  # of known limits up to the demands, over the checks that are undecided
    margin: Array  # the smallest, -1 where a check fails that has none; infinite where margins are not computed

    def plus(self, other: Amount) -> Amount:
        """Together with further checks of the same rows."""
        return Amount(
            self.failed | other.failed, self.unknown | other.unknown, self.opened + other.opened,
            self.doublings + other.doublings, np.minimum(self.margin, other.margin),
        )  # fmt: skip


def amount_of(checks: Sequence[CheckColumn], count: int, margins: bool = True) -> Amount:
    """The outcome of some checks together."""
    failed, unknown = np.zeros(count, bool), np.zeros((count, 1 + len(_BITS) // _WORD), np.uint64)
    opened, doublings = np.zeros(count, np.int64), np.zeros(count, np.int64)
    for check in checks:
        failed |= check.failed
        if not check.passed.all():
            word, bit = _BITS[check.name]
            unknown[:, word] |= np.where(check.passed | check.opened, np.uint64(0), bit)
            opened += check.opened
            doublings += check.doublings
    return Amount(failed, unknown, opened, doublings, _least_margin(checks if margins else (), count))


def bits_of(names: Collection[str]) -> NDArray[np.uint64]:
    """The bits of some checks, as ``Amount.unknown`` has them."""
    bits = np.zeros(1 + len(_BITS) // _WORD, np.uint64)
    for word, bit in (_BITS[name] for name in names):
        bits[word] |= bit
    return bits


def _least_margin(checks: Sequence[CheckColumn], count: int) -> Array:
    least = np.full(count, np.inf)
    for check in checks:
        margin = check.margin
        lost = check.failed & np.isnan(margin)
        np.minimum(least, np.where(lost, -1.0, check.tight(margin)), out=least)
    return least


class Drives(NamedTuple):
    """Candidates that came through: columns."""

    rows: Whole  # which of those that went in these are
    amount: Amount  # of their checks, where they went in stages
    encoder: Whole
    controller: Whole
    brake: Whole  # -1 none
    figures: dict[str, Array]  # what objectives count, SI


class Examined(NamedTuple):
    """Results of candidates that were examined together."""

    drives: Drives
    checks: list[CheckColumn]  # theirs; in stages none are kept
    failed_by: Counter[str]  # in stages, how many of those that went in, as far as they were examined
    rejected: Whole  # of those rejected the ones among which the closest are
    bound: Array  # their smallest margin is no better than this


class _Sieve:
    """Candidates through the stages: those that are left, and what their checks amount to."""

    def __init__(
        self, rows: Whole, amount: Amount, *, margins: bool = False, staged: bool = True, known: bool = False
    ) -> None:
        self.rows, self.amount, self.margins, self.staged, self.known = rows, amount, margins, staged, known
        self.checks: list[CheckColumn] = []
        self.aside: list[tuple[Whole, Array]] = []
        self.failed_by: Counter[str] = Counter()
        self.rejected: list[tuple[Whole, Array]] = []

    def on(self, rows: Whole | slice) -> _Sieve:
        """Some of the candidates that are left, of which nothing is counted."""
        kind = {"margins": self.margins, "staged": self.staged, "known": self.known}
        sieve = _Sieve(self.rows[rows], on(self.amount, rows), **kind)
        sieve.checks = [check.on(rows) for check in self.checks]
        return sieve

    def part(self, rows: slice) -> _Sieve:
        """Some of the candidates that are left; what was counted goes with the first."""
        sieve = self.on(rows)
        sieve.aside = self.aside
        if not rows.start:
            sieve.failed_by, sieve.rejected = self.failed_by, self.rejected
        return sieve

    def with_encoders(self, inertia: Array, checks: list[CheckColumn]) -> Whole | slice:
        """The same of candidates with encoders; what fails by the inertia of one alone is set aside for an easier one.

        ``inertia``: of these encoders [kg*m^2]; 0 where none is easier.
        """
        lost, counted = inertia > 0.0, [check for check in (*self.checks, *checks) if not check.advice]
        if lost.any():
            hangs = [CHECKS["physics"][check.name].on_inertia for check in counted]
            by, other = (
                np.logical_or.reduce([c.failed for c, on_it in zip(counted, hangs, strict=True) if on_it is kind])
                for kind in (True, False)
            )
            lost &= by & ~other
        if not lost.any():
            return self.through(checks)
        self.aside.append((self.rows[lost], inertia[lost]))
        left = np.flatnonzero(~lost)
        self.rows, self.amount, self.checks, checks = on((self.rows, self.amount, self.checks, checks), left)
        return left[self.through(checks)]

    def through(self, checks: Sequence[CheckColumn]) -> Whole | slice:
        """Keep what does not fail; which of the rows these are. In stages advice does not count."""
        if not self.staged:
            self.checks += checks
            return slice(None)
        checks, rows = [check for check in checks if not check.advice], slice(None)
        if not checks or not len(self.rows):
            return rows
        for check in checks:
            self.failed_by[check.name] += int(np.count_nonzero(check.failed))
        amount = amount_of(checks, len(self.rows), self.margins)
        gone = amount.failed | (self.amount.unknown | amount.unknown).any(axis=1) if self.known else amount.failed
        if not gone.any():
            self.amount = self.amount.plus(amount)
            return rows
        out, left = np.flatnonzero(amount.failed), np.flatnonzero(~gone)
        self.rejected.append((self.rows[out], _least_margin([check.on(out) for check in checks], len(out))))
        self.rows, self.amount = self.rows[left], on(self.amount, left).plus(on(amount, left))
        return left


def examine(
    problem: Problem,
    sets: Candidates | Crossed,
    *,
    waveform: Waveform = "all",
    exact_checks: Collection[str] = (),
    margins: bool = False,
    offered: Offers | None = None,
    known: bool = False,
) -> Iterator[Examined]:
    """Candidates against every limit: pairs behind several belts in stages, a list of candidates all the way.

    ``known``: in stages only those of which no check is unknown.
    """
    offered = offered or offers(problem)
    if isinstance(sets, Crossed):
        started = _by_parts(problem, offered, sets, margins, known)
    else:
        started = _all_the_way(problem, offered, sets)
    for sieve, batch in started:
        yield from _combined(problem, offered, sieve, batch, waveform, exact_checks)


# -- The first stage: load, gearhead and motor alone.


def _by_parts(
    problem: Problem, offered: Offers, crossed: Crossed, margins: bool, known: bool
) -> Iterator[tuple[_Sieve, Candidates]]:
    """Of pairs behind several belts those of which no part fails, so many at a time.

    Every motor goes with its best encoder; behind each belt there are the load and every gearhead.
    """
    catalog, pairs, belts, count = problem.catalog, crossed.pairs, len(crossed.belts), len(problem.catalog.gearheads)
    of_motor = [*offered.motor_limits, *brakes.counts_check(problem.spec, catalog, offered.encoders.last)]
    gearheads = Rows(catalog.gearheads, np.tile(np.arange(count), belts))
    of_gear = _of_gearheads(problem, _behind(problem, np.repeat(crossed.belts, count)), gearheads)
    of_load = _of_load(problem, _behind(problem, np.array(crossed.belts)), belts)
    motor, gear, load = (
        amount_of(checks, rows)
        for checks, rows in ((of_motor, len(catalog.motors)), (of_gear, belts * count), (of_load, belts))
    )
    alive = np.flatnonzero(~motor.failed[pairs.motor])
    left, near = list[Whole](), list[Whole]()
    for bad in gear.failed.reshape(belts, -1) | load.failed[:, None]:
        fails = bad[pairs.gearhead[alive]]
        left.append(alive[~fails])
        near.append(alive[fails])
        if len(near[-1]) < _ENOUGH:  # those of a motor that fails too are hardly among the nearest
            near[-1] = np.flatnonzero(bad[pairs.gearhead] | motor.failed[pairs.motor])

    def margin(belt: Whole, row: Whole) -> Array:
        at = belt * count + pairs.gearhead[row]
        least: Array = np.minimum(gear.margin[at], motor.margin[pairs.motor[row]])
        return np.minimum(least, load.margin[belt], out=least)

    motors = np.bincount(pairs.motor, minlength=len(catalog.motors))
    gears = np.bincount(pairs.gearhead, minlength=count)
    failed_by = Counter[str]()
    for checks, number in ((of_motor, belts * motors), (of_load, np.full(belts, len(pairs.motor))),
                           (of_gear, np.tile(gears, belts))):  # fmt: skip
        for check in checks:
            failed_by[check.name] += int(number @ check.failed)
    belt, row = (np.concatenate(x) for x in (_numbers(near), near))
    rejected = [(belt * len(pairs.motor) + row, margin(belt, row))]
    belt, row = (np.concatenate(x) for x in (_numbers(left), left))
    for rows in _together([len(rows) for rows in left], belts):
        b, r = belt[rows], row[rows]
        sets = pairs.on(r)._replace(belt=np.array(crossed.belts)[b])
        amount = on(gear, b * count + sets.gearhead).plus(on(motor, sets.motor)).plus(on(load, b))
        sieve = _Sieve(b * len(pairs.motor) + r, amount, margins=margins, known=known)
        sieve.failed_by, sieve.rejected = failed_by, rejected
        yield sieve, sets
        failed_by, rejected = Counter(), []


def _numbers(rows: Sequence[Whole]) -> list[Whole]:
    return [np.full(len(group), number) for number, group in enumerate(rows)]


def _all_the_way(problem: Problem, offered: Offers, sets: Candidates) -> Iterator[tuple[_Sieve, Candidates]]:
    """All candidates, with the checks of their parts in full, so many at a time."""
    counts = np.unique(sets.belt, return_counts=True)[1]
    for rows in _together(counts.tolist(), belts_together(problem)) if len(counts) else ():
        batch, count = sets.on(rows), rows.stop - rows.start
        cycles = _behind(problem, batch.belt)
        sieve = _Sieve(np.arange(rows.start, rows.stop), amount_of((), count), staged=False)
        sieve.checks = [
            *_of_load(problem, cycles, count),
            *_of_gearheads(problem, cycles, Rows(problem.catalog.gearheads, batch.gearhead)),
            *(check.on(batch.motor) for check in offered.motor_limits),
        ]
        yield sieve, batch


def _behind(problem: Problem, belt: Array) -> list[AtGearhead]:
    return [case.at_belt.behind(belt) for case in problem.cases]


def _of_load(problem: Problem, cycles: Sequence[AtGearhead], count: int) -> list[CheckColumn]:
    """Limits of the load behind each belt."""

    def of_one(spec: RobotSpec, at: AtGearhead, drive: BeltDrive | None, _: slice) -> list[CheckColumn]:
        return limits.load_limits(spec, at, drive)

    return limits.worst_of_all(_behind_each(problem, cycles, count, of_one))


def _of_gearheads(problem: Problem, cycles: Sequence[AtGearhead], gearhead: Rows) -> list[CheckColumn]:
    """Limits of gearheads, each behind its belt."""

    def on_shaft(spec: RobotSpec, at: AtGearhead, drive: BeltDrive | None, rows: slice) -> list[CheckColumn]:
        return loads_on_gearheads(spec, at, drive, gearhead.on(rows))

    loads = _behind_each(problem, cycles, len(gearhead.rows), on_shaft)
    return limits.worst_of_all(
        limits.gearhead_limits(case.spec, cycle, gearhead) + load
        for case, cycle, load in zip(problem.cases, cycles, loads, strict=True)
    )


def _behind_each(
    problem: Problem,
    cycles: Sequence[AtGearhead],
    count: int,
    checks: Callable[[RobotSpec, AtGearhead, BeltDrive | None, slice], list[CheckColumn]],
) -> Iterator[list[CheckColumn]]:
    """Limits that hang on the belt itself, of each load case: those behind each belt put together."""
    for case, cycle in zip(problem.cases, cycles, strict=True):
        belts = [(at, rows, problem.belt_drive(at.belt)) for at, rows in belts_of(cycle, count)]
        yield together([(rows, checks(case.spec, at, drive, rows)) for at, rows, drive in belts], count)


def belts_together(problem: Problem) -> int:
    """Number of belts whose load cycles are held at a time."""
    return _MANY_BELTS if problem.segments <= _SHORT and not has_steppers(problem.catalog) else _BELTS


def _together(counts: Sequence[int], most: int) -> Iterator[slice]:
    """Candidates that go on together, of so many behind each belt: behind few belts, or some of those behind one."""
    start = end = belts = 0
    for count in counts:
        if end > start and (end + count - start > _ROWS or belts == most):
            yield slice(start, end)
            start, belts = end, 0
        end, belts = end + count, belts + 1
        while end - start > _MOST:
            yield slice(start, start + _MOST)
            start += _MOST
    yield slice(start, end)


# -- Combinations: at rest, in motion by moments, then with a controller over the waveform.


def _combined(
    problem: Problem,
    offered: Offers,
    sieve: _Sieve,
    sets: Candidates,
    waveform: Waveform,
    exact_checks: Collection[str],
    below: Array | float = np.inf,
) -> Iterator[Examined]:
    """Candidates of which no part fails, some at a time; those that fail with an encoder again with an easier one.

    ``below``: inertia of the encoders that are left [kg*m^2].
    """
    catalog, spec, steps = problem.catalog, problem.spec, has_steppers(problem.catalog)
    entered, all_sets = sieve.on(slice(None)), sets
    cycles, cases = _behind(problem, sets.belt), problem.cases
    motor, gearhead = Rows(catalog.motors, sets.motor), Rows(catalog.gearheads, sets.gearhead)

    def on_shaft(spec: RobotSpec, at: AtGearhead, drive: BeltDrive | None, rows: slice) -> list[CheckColumn]:
        return loads_on_motors(spec, at, drive, motor.on(rows), gearhead.on(rows))

    at_rest = [fits("compatibility", True, sets.listed)]
    if not offered.brakes:
        at_rest += limits.size_limits(spec, motor, gearhead)
    keep = sieve.through(at_rest + limits.worst_of_all(_behind_each(problem, cycles, len(sets.motor), on_shaft)))
    sets, cycles = sets.on(keep), [cycle.on(keep) for cycle in cycles]
    parts, turned = parts_of(problem, offered, cycles, sets, motor.on(keep), gearhead.on(keep), below)
    if not sieve.staged:  # in stages each motor was judged by what there is for it
        sieve.through(brakes.counts_check(spec, catalog, parts.encoder.rows))
    if offered.brakes:
        keep = sieve.through(limits.size_limits(spec, parts.motor, parts.gearhead, parts.brake))
        parts, cycles, turned = on((parts, cycles, turned), keep)

    def motion(k: int, parts: Parts) -> Moving:
        turning = parts._replace(motor=steppers.Frictionless(parts.motor)) if steps else parts
        return in_motion(cases[k], cycles[k], turning)

    def at_moments(k: int, parts: Parts, moving: Moving) -> list[CheckColumn]:
        listed = (
            offered.brakes.goes(parts.motor.rows, parts.brake.rows)
            if offered.brakes and parts.brake
            else np.ones(1, bool)
        )
        heating = None if steps else moving.heating
        return limits.moving_limits(cases[k].spec, cycles[k], moving.demand, heating, parts, listed, parts.motor)

    moving = [motion(k, parts) for k in range(len(cases))]

    def by_moments(k: int) -> list[CheckColumn]:
        checks = at_moments(k, parts, moving[k])
        if problem.opposite is None or not any(check.name in _BY_INERTIA for check in checks):
            return checks
        tables = [problem.opposite.table(name) for name in ("motors", "gearheads", "encoders", "controllers", "brakes")]
        pairs = zip(tables, parts, strict=True)
        there = Parts._make(None if part is None else Rows(table, part.rows) for table, part in pairs)
        ends = {check.name: check for check in at_moments(k, there, motion(k, there))}
        rows = np.arange(len(parts.motor.rows))
        return [over_ends(c, [ends[c.name]], rows) if c.name in _BY_INERTIA else c for c in checks]

    keep = sieve.with_encoders(turned, limits.worst_of_all(map(by_moments, range(len(cases)))))
    parts, cycles, moving, turned = on((parts, cycles, moving, turned), keep)
    sieve.checks = [check for check in sieve.checks if check.name != "winding_temperature"]  # that of the mean
    for rows in _computed_together(problem, cycles[0], len(parts.motor.rows), steps):
        batch, few = sieve.part(rows), parts.on(rows)
        behind, of_cases = [cycle.on(rows) for cycle in cycles], [on(case, rows) for case in moving]
        if steps:
            demand = [case.demand for case in of_cases]
            result = steppers.stepped(problem, offered.controllers, behind, demand, few, staged=sieve.staged)
        else:
            result = powered(
                problem, offered.controllers, behind, of_cases, few, waveform=waveform, exact_checks=exact_checks
            )
        keep = batch.with_encoders(turned[rows], result.checks)
        brake = np.full(len(few.motor.rows), -1) if few.brake is None else few.brake.rows
        parts_and_figures = on((few.encoder.rows, result.controller, brake, result.figures), keep)
        none = batch.rows[:0], np.zeros(0)
        rejected = [np.concatenate(columns) for columns in zip(none, *batch.rejected, strict=True)]
        yield Examined(Drives(batch.rows, batch.amount, *parts_and_figures), batch.checks, batch.failed_by, *rejected)
    if sieve.aside:
        numbers, inertia = (np.concatenate(columns) for columns in zip(*sieve.aside, strict=True))
        in_order = np.argsort(numbers)
        left = np.searchsorted(entered.rows, numbers[in_order])
        yield from _combined(
            problem, offered, entered.on(left), all_sets.on(left), waveform, exact_checks, inertia[in_order]
        )


def parts_of(
    problem: Problem,
    offered: Offers,
    cycles: Sequence[AtGearhead],
    sets: Candidates,
    motor: Rows,
    gearhead: Rows,
    below: Array | float = np.inf,
) -> tuple[Parts, Array]:
    """Parts of candidates: an encoder that does in the fastest of all load cases, a brake that holds in all of them.

    With them the inertia of encoders than which another is easier to turn, else 0.
    """
    catalog, ratio = problem.catalog, gearhead["ratio"]
    fastest = np.maximum.reduce([
        cycle.peak_speed * (1.0 + case.spec.margins.speed) for case, cycle in zip(problem.cases, cycles, strict=True)
    ])  # fmt: skip
    row, turned = brakes.encoders_for(
        problem.spec, offered.encoders, motor.rows, fastest * ratio, ratio * cycles[0].belt, below
    )
    if sets.encoder is not None:
        free = sets.encoder == FREE
        row, turned = np.where(free, row, sets.encoder), np.where(free, turned, 0.0)
    controller = None if sets.controller is None else Rows(catalog.controllers, sets.controller)
    parts = Parts(motor, gearhead, Rows(catalog.encoders, row), controller)
    if offered.brakes is None:
        return parts, turned
    brake = brakes.brakes_for(problem, offered.brakes, cycles, parts, sets.brake)
    return parts._replace(brake=Rows(catalog.brakes, brake)), turned


def in_motion(case: LoadCase, cycle: AtGearhead, parts: Parts) -> Moving:
    """Demands of candidates in a load case, and their heat."""
    braking = brakes.brake_inertia(parts, cycle.belt)
    demand = demands(cycle, parts.motor, parts.gearhead, parts.encoder, braking)
    return Moving(demand, heat_of(case.spec, cycle, demand, parts.motor, parts.gearhead))


def _computed_together(problem: Problem, cycle: AtGearhead, count: int, steps: bool) -> list[slice]:
    """Candidates that are computed together: behind as many belts as their waveforms have room."""
    most = _CELLS // problem.segments if problem.segments <= _SHORT else _MOST
    slices = list[slice]()
    for _, rows in belts_of(cycle, count):
        start = slices[-1].start if slices else 0
        if slices and (steps or rows.stop - start <= most):
            slices[-1] = slice(start, rows.stop)
        else:
            slices.append(rows)
    return slices if len(slices) > 1 else [slice(None)]
