"""An axis that waits at rest, its motion done, until the cycle of its machine is over: the rest at the end of its own.

A load with a motion is held as its law says of a rest; a recording, or a load that comes with its cycle, by the torque
of the rest that ends it, or by what its last moment leaves without the torque that decelerates it, friction included.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import isnan

import numpy as np

from drivesizer.loads.course import Profile
from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["rest_left", "resting", "static_torque", "with_rest"]

_NO_TIME = 1e-9  # of the cycle


def static_torque(cycle: LoadCycle) -> float:
    """Torque that holds a load at the end of its motion [N*m]; NaN where an inertia that decelerates is unknown."""
    torque, acceleration = float(cycle.torque[-1, 1]), float(cycle.acceleration[-1, 1])
    return torque if acceleration == 0.0 else torque - cycle.inertia * acceleration


def with_rest(cycle: LoadCycle, until: float | None, held: float) -> LoadCycle:
    """A load cycle with a rest at its end."""
    rest = rest_left(cycle.total, until)
    if not rest or isnan(held):
        return cycle
    still = np.zeros((1, 2))
    return replace(
        cycle,
        duration=np.append(cycle.duration, rest),
        speed=np.concatenate([cycle.speed, still]),
        acceleration=np.concatenate([cycle.acceleration, still]),
        torque=np.concatenate([cycle.torque, still + held]),
    )


def resting(profile: Profile, until: float | None) -> Profile:
    """A motion with a rest at its end, the payload still that of its last piece.

    >>> resting(Profile("x", (0.0, 1.0, 3.0), (0.0, 2.0, 0.0)), 5.0)
    Profile(name='x', time=(0.0, 1.0, 3.0, 5.0), speed=(0.0, 2.0, 0.0, 0.0), acceleration=None, payload=None, ends=None)
    """
    if not rest_left(profile.duration, until):
        return profile
    assert until is not None
    ends, slope = profile.ends, profile.acceleration
    if ends is None and slope is not None:
        ends = tuple(pairwise(slope))
    return replace(
        profile,
        time=(*profile.time, profile.time[0] + until),
        speed=(*profile.speed, 0.0),
        acceleration=None,
        ends=None if ends is None else (*ends, (0.0, 0.0)),
        payload=None if profile.payload is None else (*profile.payload, profile.payload[-1]),
    )


def rest_left(total: float, until: float | None) -> float:
    """Time that an axis waits."""
    return 0.0 if until is None or until - total <= _NO_TIME * until else until - total
