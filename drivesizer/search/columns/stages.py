"""One belt's candidates against the whole of physics: in stages, the cheap ones first, or all of it for a few.

The same checks serve both: the search drops what fails at each stage, so that only survivors meet the next; a drive
that is shown or explained goes through them all. In several load cases each check is that of its worst case, and one
controller must do for all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.several_belts import AtGearheads, put_together
from drivesizer.physics.stress import Parts, heat, on
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.columns.brakes import at_motor, brake_limits, brakes_for
from drivesizer.search.columns.candidates import Candidates, Rows
from drivesizer.search.columns.encoders import counts_check, encoders_for
from drivesizer.search.columns.limits import (
    gearhead_limits,
    load_limits,
    moving_limits,
    size_limits,
    unpowered_limits,
)
from drivesizer.search.columns.offers import Offers, offers, unknown_where_doubtful, worst_of_all
from drivesizer.search.columns.powered import Moving, Powered, powered
from drivesizer.search.columns.shaft_limits import loads_on_motors
from drivesizer.search.columns.steppers import Frictionless, stepped
from drivesizer.search.columns.survivors import Alone, Sieve
from drivesizer.spec.mounting import loss_at_flange

__all__ = ["Examined", "brakes_of", "encoders_of", "examine", "felt"]

Array = NDArray[np.float64]
_SHORT, _BLOCKS = 256, 64  # pieces of a cycle that count: a longer one is first looked at in so many blocks
_CELLS = 400_000  # candidates times pieces, up to which several belts are looked at together
_BELTS = 16


class Examined(NamedTuple):
    """Results of the candidates that came through, in their order."""

    sets: Candidates  # all that were looked at
    rows: NDArray[np.int64]  # which of them these are
    checks: list[CheckColumn]  # theirs; in stages none are kept
    unknown: NDArray[np.uint64]  # checks that are, as bits in the order of ``check_kinds``, shape (rows, words)
    margin: Array  # the smallest; NaN where margins are not computed
    encoder: NDArray[np.int64]
    controller: NDArray[np.int64]
    brake: NDArray[np.int64]  # -1 none
    figures: dict[str, Array]  # what objectives count, SI
    failed_by: Counter[str]  # of all candidates, as far as they were examined
    rejected: NDArray[np.int64]  # candidates rejected, of which the closest are shown
    bound: Array  # their smallest margin is no better than this


def examine(
    problem: Problem,
    several: Iterable[tuple[float, Candidates]],
    *,
    staged: bool,
    exact: bool = True,
    each: Collection[str] = (),
    margins: bool = False,
) -> Iterator[Examined]:
    """Candidates behind one belt after the other against every limit.

    What needs current and heat is computed for several belts in one go, but of many candidates.

    Parameters
    ----------
    problem
        With its load cycles.
    several
        Ratio of a belt, and candidates behind it; their own belt column is not looked at.
    staged
        Drop what fails at each stage.
    exact
        Compute the waveform of all that come so far; else only of those that safe bounds leave undecided.
    each
        Names of checks to decide of candidates that fail on another as well.
    margins
        Compute the smallest margin of each.

    Yields
    ------
    Examined
        One for each belt, in order.
    """
    offered, waiting = offers(problem), list[_Moved]()
    steppers = has_steppers(problem.catalog)
    for belt, sets in several:
        moved = _moved(problem, offered, belt, sets, staged, margins)
        if waiting and not (len(waiting) < _BELTS if steppers else _together([*waiting, moved])):
            yield from _powered(problem, offered, waiting, exact, each)
            waiting = []
        waiting.append(moved)
    if waiting:
        yield from _powered(problem, offered, waiting, exact, each)


class _Moved(NamedTuple):
    """One belt's candidates that came through the cheap stages."""

    sieve: Sieve
    cycles: list[AtGearhead]
    cases: list[Moving]
    parts: Parts


def _together(waiting: Sequence[_Moved]) -> bool:
    """Whether so much is little enough to be looked at in one go."""
    longest = max(cycle.base.pieces for cycle in waiting[0].cycles)
    pieces = longest if longest <= _SHORT else _BLOCKS
    count = sum(len(one.parts.motor.rows) for one in waiting)
    return len(waiting) <= _BELTS and pieces * count <= _CELLS


def _moved(problem: Problem, offered: Offers, belt: float, sets: Candidates, staged: bool, margins: bool) -> _Moved:
    """The stages up to what moves."""
    spec, catalog = problem.spec, problem.catalog
    cycles = [case.at_belt.behind(belt) for case in problem.cases]
    sieve = Sieve(sets, staged, margins)
    sieve.parts(_alone(problem, offered, cycles, staged))
    motor = Rows(catalog.motors, sets.motor[sieve.rows])
    gearhead = Rows(catalog.gearheads, sets.gearhead[sieve.rows])
    listed = fits("compatibility", True, sets.listed[sieve.rows])
    drive, specs = problem.belt_drive(belt), [case.spec for case in problem.cases]
    on_shaft = worst_of_all(problem, lambda k: loads_on_motors(specs[k], cycles[k], drive, motor, gearhead))
    beside = [*([] if offered.brakes else size_limits(spec, motor, gearhead)), *on_shaft]
    keep = sieve.through([listed, *beside])
    motor, gearhead = motor.on(keep), gearhead.on(keep)
    encoder = encoders_of(problem, offered, cycles, motor.rows, gearhead["ratio"])
    if not staged:  # in stages each motor was judged by what there is for it
        sieve.through(counts_check(spec, catalog, encoder))
    given = None if sets.controller is None else Rows(catalog.controllers, sets.controller[sieve.rows])
    parts = Parts(motor, gearhead, Rows(catalog.encoders, encoder), given)
    if offered.brakes:
        chosen = None if sets.brake is None else sets.brake[sieve.rows]
        parts = parts._replace(brake=brakes_of(problem, offered, cycles, parts, chosen))
        parts = parts.on(sieve.through(size_limits(spec, motor, gearhead, parts.brake)))
    steppers = has_steppers(catalog)
    turning = parts._replace(motor=Frictionless(parts.motor)) if steppers else parts
    cases = [_moving(case, cycle, turning) for case, cycle in zip(problem.cases, cycles, strict=True)]
    limits = unpowered_limits if steppers else moving_limits

    def moving(k: int) -> list[CheckColumn]:
        checks = limits(problem.cases[k].spec, cycles[k], *cases[k], parts)
        if offered.brakes:
            listed = offered.brakes.goes(parts.motor.rows, parts.brake.rows)
            checks += brake_limits(problem.cases[k].spec, cycles[k], parts, cases[k].demand, listed)
        return unknown_where_doubtful(checks, cases[k].demand.complete)

    keep = sieve.through(worst_of_all(problem, moving))
    cases, parts = [on(case, keep) for case in cases], parts.on(keep)
    return _Moved(sieve, cycles, cases, parts)


def _moving(case: LoadCase, cycle: AtGearhead, parts: Parts) -> Moving:
    demand = demands(cycle, parts.motor, parts.gearhead, parts.encoder, felt(cycle, parts))
    at_flange = loss_at_flange(case.spec, cycle, parts.gearhead)
    return Moving(demand, heat(case.spec.environment.ambient, cycle, demand, parts.motor, from_gearhead=at_flange))


def felt(cycle: AtGearhead, parts: Parts) -> Any:
    """Inertia of brakes as the motor's shaft feels it [kg*m^2]; 0 where no drive has one.

    Parameters
    ----------
    cycle
        The load cycle at the gearhead's output.
    parts
        Of each candidate.

    Returns
    -------
    float or array
    """
    if parts.brake is None:
        return 0.0
    return at_motor(parts.brake, "inertia", parts.gearhead["ratio"] * cycle.belt)


def brakes_of(
    problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], parts: Parts, given: Any = None
) -> Rows | None:
    """A brake for each candidate, that holds the load in all cases; None where the spec wants none.

    Parameters
    ----------
    problem, offered
        The problem, and its brakes.
    cycles
        The load cycle of each case at the gearhead's output.
    parts
        Motor, gearhead and encoder of each candidate.
    given
        Rows of brakes that are chosen already, or ``FREE``.

    Returns
    -------
    Rows or None
        Of the brakes; figures are unknown where there is none.
    """
    if offered.brakes is None:
        return None
    return Rows(problem.catalog.brakes, brakes_for(problem, offered.brakes, cycles, parts[:3], given))


def encoders_of(
    problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], motor: NDArray[np.int64], ratio: Array
) -> NDArray[np.int64]:
    """An encoder for each candidate that does in the fastest of all load cases.

    Parameters
    ----------
    problem, offered
        The problem, and its encoders.
    cycles
        The load cycle of each case at the gearhead's output.
    motor, ratio
        Row of each candidate's motor, and ratio of its gearhead, shape (candidates,).

    Returns
    -------
    ndarray
        Row of each candidate's encoder; -1 where none is listed for its motor.
    """
    specs = [case.spec for case in problem.cases]
    fastest = max(cycle.peak_speed * (1.0 + spec.margins.speed) for spec, cycle in zip(specs, cycles, strict=True))
    return encoders_for(problem.spec, offered.encoders, motor, fastest * ratio, ratio * cycles[0].belt)


def _alone(problem: Problem, offered: Offers, cycles: Sequence[AtGearhead], staged: bool) -> Alone:
    """Limits of the load, a gearhead or a motor alone: once per part, not per combination.

    In stages the counts of a motor's best encoder are checked as well.
    """
    catalog, specs = problem.catalog, [case.spec for case in problem.cases]
    counted = counts_check(problem.spec, catalog, offered.encoders.last) if staged else []
    drive = problem.belt_drive(cycles[0].belt)
    return Alone(
        worst_of_all(problem, lambda k: load_limits(specs[k], cycles[k], drive)),
        worst_of_all(problem, lambda k: gearhead_limits(specs[k], cycles[k], catalog.gearheads, drive)),
        [*offered.motor_limits, *counted],
    )


def _powered(
    problem: Problem, offered: Offers, moved: Sequence[_Moved], exact: bool, each: Collection[str]
) -> list[Examined]:
    """Current, and what needs the waveform, with the smallest controller that does for all cases; or steppers."""
    counts = [len(one.parts.motor.rows) for one in moved]
    cycles, cases, parts = _joined(moved, np.repeat(np.arange(len(moved)), counts))
    if has_steppers(problem.catalog):
        demand = [case.demand for case in cases]
        found = Powered(*stepped(problem, offered, cycles, demand, parts, staged=moved[0].sieve.staged))
    else:
        staged = moved[0].sieve.staged
        found = powered(problem, offered, cycles, cases, parts, exactly=exact, each=each, staged=staged)
    if len(moved) == 1:
        return [_examined(moved[0], found)]
    ends = np.cumsum(counts).tolist()
    places = [slice(end - count, end) for end, count in zip(ends, counts, strict=True)]
    return [_examined(one, found.on(rows)) for one, rows in zip(moved, places, strict=True)]


def _joined(moved: Sequence[_Moved], which: NDArray[np.int64]) -> tuple[list[AtGearhead], list[Moving], Parts]:
    """Several belts' candidates one after the other; ``which``: the number of each one's belt."""
    if len(moved) == 1:
        return moved[0].cycles, moved[0].cases, moved[0].parts
    cycles = [AtGearheads(same, which).on(slice(None)) for same in zip(*(one.cycles for one in moved), strict=True)]
    cases = [put_together(same) for same in zip(*(one.cases for one in moved), strict=True)]
    parts = (
        None if same[0] is None else Rows(same[0].table, np.concatenate([part.rows for part in same]))
        for same in zip(*(one.parts for one in moved), strict=True)
    )
    return cycles, cases, Parts(*parts)


def _examined(moved: _Moved, found: Powered) -> Examined:
    """Results of one belt's candidates."""
    sieve = moved.sieve
    sieve.checks = [check for check in sieve.checks if check.name != "winding_temperature"]
    sieve.failed_by["winding_temperature"] = sieve.failed_by["winding_temperature"] if sieve.staged else 0
    keep = sieve.through(found.checks)
    figures = {name: value[keep] for name, value in found.figures.items()}
    rejected = np.concatenate([sieve.rows[:0], *(rows for rows, _ in sieve.rejected)])
    bound = np.concatenate([sieve.margin[:0], *(bound for _, bound in sieve.rejected)])
    return Examined(
        sieve.sets, sieve.rows, sieve.checks, sieve.unknown, sieve.margin, moved.parts.encoder.on(keep).rows,
        found.controller[keep], _row_of(moved.parts.brake, len(moved.parts.motor.rows))[keep], figures,
        sieve.failed_by, rejected, bound,
    )  # fmt: skip


def _row_of(brake: Rows | None, count: int) -> NDArray[np.int64]:
    return np.full(count, -1) if brake is None else brake.rows
