"""One belt's candidates against the whole of physics: in stages, the cheap ones first, or all of it for a few.

The same checks serve both: the search drops what fails at each stage, so that only survivors meet the next; a set that
is shown or explained goes through them all. In several load cases each check is that of its worst case, and one
controller must do for all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.motor_demand import AtGearhead, demands
from drivesizer.physics.stress import Parts, heat, on
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.search.columns.candidates import Candidates, Rows
from drivesizer.search.columns.encoders import counts_check, encoders_for
from drivesizer.search.columns.limits import (
    gearhead_limits,
    load_limits,
    motor_limits,
    moving_limits,
    shaft_limits,
    size_limits,
)
from drivesizer.search.columns.powered import Moving, powered
from drivesizer.search.columns.problem import Problem, doubted, each, problem
from drivesizer.search.columns.survivors import Alone, Sieve
from drivesizer.spec.robot import RobotSpec

__all__ = ["Examined", "Problem", "doubted", "encoders_of", "examine", "problem"]

Array = NDArray[np.float64]


class Examined(NamedTuple):
    """What was found of the candidates that came through, in their order."""

    rows: NDArray[np.int64]  # which candidates these are
    checks: list[CheckColumn]  # theirs; in stages none are kept
    doubtful: NDArray[np.bool_]  # a check is unknown
    margin: Array  # the smallest; NaN where it was not asked for
    encoder: NDArray[np.int64]
    controller: NDArray[np.int64]
    figures: dict[str, Array]  # what objectives count, SI
    failed_by: Counter[str]  # of all candidates, as far as they were examined
    fallen: NDArray[np.int64]  # candidates that fell, of which the nearest are told
    bound: Array  # their smallest margin is no better than this


def examine(
    given: Problem, belt: float, sets: Candidates, *, staged: bool, exact: bool = True, margins: bool = False
) -> Examined:
    """Candidates behind one belt against every limit.

    Parameters
    ----------
    given
        The spec and its load cycles.
    belt
        Ratio of the belt.
    sets
        The candidates; their own belt column is not looked at.
    staged
        Drop what fails at each stage.
    exact
        Compute the waveform of all that come so far; else only of those that safe bounds leave undecided.
    margins
        Tell the smallest margin of each.
    """
    ats = [base.behind(belt) for base in given.bases]
    sieve = Sieve(sets, staged, margins)
    sieve.parts(_alone(given, ats, staged))
    motor = Rows(given.catalog.motors, sets.motor[sieve.rows])
    gearhead = Rows(given.catalog.gearheads, sets.gearhead[sieve.rows])
    listed = fits("compatibility", True, sets.listed[sieve.rows])
    beside = [*size_limits(given.spec, motor, gearhead), *shaft_limits(given.spec, motor, gearhead)]
    keep = sieve.through([listed, *beside])
    motor, gearhead = motor.on(keep), gearhead.on(keep)
    encoder = encoders_of(given, ats, motor.rows, gearhead["ratio"])
    if not staged:  # in stages each motor was judged by what there is for it
        sieve.through(counts_check(given.spec, given.catalog, encoder))
    parts = Parts(motor, gearhead, Rows(given.catalog.encoders, encoder), None)
    cases = [_moving(spec, at, parts) for spec, at in zip(given.specs, ats, strict=True)]
    keep = sieve.through(
        each(given, lambda k: doubted(moving_limits(given.specs[k], ats[k], *cases[k], parts), cases[k].asked.sure))
    )
    cases, parts = [on(case, keep) for case in cases], parts.on(keep)
    return _powered(given, ats, cases, parts, sieve, exact)


def _moving(spec: RobotSpec, at: AtGearhead, parts: Parts) -> Moving:
    asked = demands(at, parts.motor, parts.gearhead, parts.encoder)
    return Moving(asked, heat(spec.environment.ambient, at, asked, parts.motor))


def encoders_of(given: Problem, ats: Sequence[AtGearhead], motor: NDArray[np.int64], ratio: Array) -> NDArray[np.int64]:
    """An encoder for each candidate that does in the fastest of all cases."""
    fastest = max(at.peak_speed * (1.0 + spec.margins.speed) for spec, at in zip(given.specs, ats, strict=True))
    return encoders_for(given.spec, given.offered, motor, fastest * ratio, ratio * ats[0].belt)


def _alone(given: Problem, ats: Sequence[AtGearhead], staged: bool) -> Alone:
    """What concerns the load, a gearhead or a motor alone: once per part, not per pair.

    In stages that a motor has an encoder with the counts asked for is among it: of those enough, or of all, the most.
    """
    motors, gearheads = given.catalog.motors, given.catalog.gearheads
    counted = counts_check(given.spec, given.catalog, given.offered.last) if staged else []
    return Alone(
        each(given, lambda k: load_limits(given.specs[k], ats[k])),
        each(given, lambda k: gearhead_limits(given.specs[k], ats[k], gearheads)),
        [*each(given, lambda k: motor_limits(given.specs[k], motors)), *counted],
    )


def _powered(
    given: Problem, ats: Sequence[AtGearhead], cases: list[Moving], parts: Parts, sieve: Sieve, exact: bool
) -> Examined:
    """Current, and what needs the waveform, with the smallest controller that does for all cases."""
    found = powered(given, ats, cases, parts, exactly=exact)
    sieve.checks = [check for check in sieve.checks if check.name != "winding_temperature"]
    sieve.failed_by["winding_temperature"] = sieve.failed_by["winding_temperature"] if sieve.staged else 0
    keep = sieve.through(found.checks)
    figures = {name: value[keep] for name, value in found.figures.items()}
    fallen = np.concatenate([sieve.rows[:0], *(rows for rows, _ in sieve.fallen)])
    bound = np.concatenate([sieve.margin[:0], *(bound for _, bound in sieve.fallen)])
    return Examined(
        sieve.rows, sieve.checks, sieve.doubtful, sieve.margin, parts.encoder.on(keep).rows, found.controller[keep],
        figures, sieve.failed_by, fallen, bound,
    )  # fmt: skip
