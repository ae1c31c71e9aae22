"""An axis that waits at rest, its motion done, until the machine's cycle is over, as its power on the bus.

Axes are sized with that rest; on the bus it is what the cycle of all leaves, which over tolerances is another one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isnan

import numpy as np

from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.waiting import rest_left, static_torque, with_rest
from drivesizer.machine.problem import quickest_winding, with_cycle
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt, at_gearhead
from drivesizer.results.problem import LoadCase, Problem

__all__ = ["moving_alone", "starts_and_ends_at_rest", "unknown_at_rest", "waiting"]

_STILL = 1e-9  # of the largest speed


def moving_alone(problem: Problem) -> Problem:
    """An axis without the rest in which it waits."""
    if all(case.spec.waits_until is None for case in problem.cases):
        return problem
    quickest = quickest_winding(problem.catalog)
    cases = tuple(with_cycle(case, case.spec.waiting({}), quickest) for case in problem.cases)
    return replace(problem, machine=problem.machine.waiting({}), cases=cases)


def starts_and_ends_at_rest(cases: Sequence[LoadCase]) -> bool:
    """Whether a motion begins and ends at rest."""
    return all(
        max(abs(float(case.cycle.speed[0, 0])), abs(float(case.cycle.speed[-1, 1])))
        <= _STILL * float(np.abs(case.cycle.speed).max())
        for case in cases
    )


def waiting(case: LoadCase, until: float) -> CycleAtBelt:
    """The load cycle of an axis with a rest at its end."""
    if not rest_left(case.cycle.total, until):
        return case.at_belt
    cycle = load_cycle(case.spec.waiting(dict.fromkeys([name for name, _ in case.spec.load_cases], until)))
    held = static_torque(cycle)
    cycle = with_rest(cycle, until, 0.0 if isnan(held) else held)
    return at_gearhead(cycle, case.spec.belt_efficiency, case.at_belt.quickest)


def unknown_at_rest(cases: Sequence[LoadCase]) -> str:
    """Reason for which the power at rest is unknown; empty where it is not."""
    lacking = any(isnan(static_torque(case.cycle)) for case in cases)
    return "what holds it at rest is unknown: end its motion with a rest" if lacking else ""
