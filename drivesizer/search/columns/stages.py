"""Candidates against the whole of physics: in stages, the cheap ones first, or all of it for a few.

The same checks serve both: the search drops what fails at each stage, so that only survivors meet the next; a drive
that is shown or explained goes through them all. In several load cases each check is that of its worst case, and one
controller must do for all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.several_belts import belts_of
from drivesizer.physics.stress import Parts, heat, on
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.columns.brakes import at_motor, brake_limits, brakes_for
from drivesizer.search.columns.candidates import Candidates, Crossed, Rows
from drivesizer.search.columns.encoders import counts_check, encoders_for
from drivesizer.search.columns.limits import moving_limits, size_limits, unpowered_limits
from drivesizer.search.columns.limits_over_time import Exactly
from drivesizer.search.columns.offers import (
    Offers,
    limits_behind_each,
    offers,
    placed,
    unknown_where_doubtful,
    worst_of_all,
)
from drivesizer.search.columns.parts_alone import Started, all_of_them, by_their_parts
from drivesizer.search.columns.powered import Moving, Powered, powered
from drivesizer.search.columns.shaft_limits import loads_on_motors
from drivesizer.search.columns.steppers import Frictionless, stepped
from drivesizer.search.columns.survivors import Sieve
from drivesizer.spec.mounting import loss_at_flange

__all__ = ["Examined", "brakes_of", "encoders_of", "examine", "felt"]

Array = NDArray[np.float64]
_SHORT = 256  # pieces of a cycle: a longer one is first looked at by bounds, some candidates at a time
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
    limits = unpowered_limits if has_steppers(problem.catalog) else moving_limits
    spec, cycle, case = problem.cases[k].spec, cycles[k], cases[k]
    checks = limits(spec, cycle, *case, parts)
    if offered.brakes:
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
    for rows in belts_of(cycles[0], count):
        some = None if given is None else given[rows]
        brake = brakes_of(problem, offered, [cycle.on(rows) for cycle in cycles], parts.on(rows), some)
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
    steppers, pieces = has_steppers(problem.catalog), max(c.base.pieces for c in moved.cycles)
    most = _CELLS // pieces if pieces <= _SHORT else _MOST
    found = list[slice]()
    for rows in belts_of(moved.cycles[0], len(moved.parts.motor.rows)):
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
