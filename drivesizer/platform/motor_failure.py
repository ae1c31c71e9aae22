"""What a platform can still do when a motor set has failed.

Four mecanum wheels have one motor more than freedoms. With a wheel that turns freely the other three still make every
motion, but no torque is left to choose: straight on, the two wheels of the other axle do all the work, each with twice
the torque, and the third turns with none. With a wheel that is blocked two motions are left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.wheels import Platform, without_motor

__all__ = ["Remaining", "after_failure"]


@dataclass(frozen=True, slots=True, eq=False)
class Remaining:
    """What is left: motions, and what they ask of the motors that work."""

    platform: Platform  # with the wheel that failed
    motions: Array  # (3, m): the velocities that can still be driven are their sums
    torque_ratio: Array  # (m,): to gain speed along each, largest torque of a wheel over that with all motors


def after_failure(platform: Platform, wheel: int, *, blocked: bool = False) -> Remaining:
    """What a platform can still do without one of its motors.

    Parameters
    ----------
    platform
        With all motors.
    wheel
        Whose motor set has failed, counted from 1.
    blocked
        Whether the wheel is held by its brake or gear; it turns freely otherwise, and the others turn its rotor.

    Raises
    ------
    InputError
        When there is no such wheel, or the motors that are left do not hold the platform.
    """
    whole, left = dynamics(platform), dynamics(without_motor(platform, wheel, blocked=blocked))
    motions = left.kinematics.motions
    before, after = (np.abs(d.distribution @ d.M @ motions).max(axis=0) for d in (whole, left))
    return Remaining(left.platform, motions, after / before)
