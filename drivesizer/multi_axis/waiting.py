"""An axis that waits at rest, its motion done, until the machine's cycle is over.

It is held by the torque of the rest that ends its cycle, or by what its last moment leaves without the torque that
decelerates it, friction included. The motor is as warm as over the whole of the machine's cycle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isnan

import numpy as np

from drivesizer.physics.cycle_at_gearhead import CycleAtBelt, at_gearhead
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.problem import LoadCase

__all__ = ["at_rest", "held_torque", "unknown_at_rest", "waiting"]

_NO_TIME = 1e-9  # of the cycle
_STILL = 1e-9  # of the largest speed


def at_rest(cases: Sequence[LoadCase]) -> bool:
    """Whether a motion begins and ends at rest.

    Parameters
    ----------
    cases
        Drives of an axis that act at the same time.
    """
    return all(
        max(abs(float(case.cycle.speed[0, 0])), abs(float(case.cycle.speed[-1, 1])))
        <= _STILL * float(np.abs(case.cycle.speed).max())
        for case in cases
    )


def held_torque(cycle: LoadCycle) -> float:
    """Torque that holds a load at the end of its motion [N*m]; NaN where an inertia that decelerates is unknown.

    Parameters
    ----------
    cycle
        That ends at rest.

    Returns
    -------
    float
        Of a rest at its end that of the rest.
    """
    torque, acceleration = float(cycle.torque[-1, 1]), float(cycle.acceleration[-1, 1])
    return torque if acceleration == 0.0 else torque - cycle.inertia * acceleration


def waiting(case: LoadCase, until: float) -> CycleAtBelt:
    """The load cycle of an axis with a rest at its end.

    Parameters
    ----------
    case
        The axis, or one of its drives.
    until
        Length of the cycle with that rest [s].

    Returns
    -------
    CycleAtBelt
        As it is where it lasts so long; held by nothing where that is unknown.
    """
    cycle, rest = case.cycle, until - case.cycle.total
    if rest <= _NO_TIME * until:
        return case.at_belt
    still, held = np.zeros((1, 2)), held_torque(cycle)
    held = 0.0 if isnan(held) else held
    longer = replace(
        cycle,
        duration=np.append(cycle.duration, rest),
        speed=np.concatenate([cycle.speed, still]),
        acceleration=np.concatenate([cycle.acceleration, still]),
        torque=np.concatenate([cycle.torque, still + held]),
    )
    return at_gearhead(longer, case.spec.belt_efficiency, case.at_belt.quickest)


def unknown_at_rest(cases: Sequence[LoadCase]) -> str:
    """Reason for which the power at rest is unknown; empty where it is not."""
    lacking = any(isnan(held_torque(case.cycle)) for case in cases)
    return "what holds it at rest is unknown: end its motion with a rest" if lacking else ""
