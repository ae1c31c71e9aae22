r"""Speeds that a platform reaches with its drives, by direction, and accelerations that it is sized for.

A drive turns its wheel as fast as the lowest supply voltage V permits while the platform rolls at constant speed on a
level floor, T being the torque of that:

.. math:: K w = \frac{k_t V - R \left( M_f + \frac{T}{K e} \right)}{k_t k_e + R b}

or as the parts permit where that is less. The platform's speed in a direction is w over the largest of the wheels'
speeds in it; a limit that the spec sets is kept. Accelerations are the spec's limits, else the largest of its motion.
"""

from __future__ import annotations

from math import inf, isfinite, nan
from typing import NamedTuple

import numpy as np

from drivesizer.joints.record import Array
from drivesizer.output.export.common import Export
from drivesizer.output.export.limits import speed_at
from drivesizer.platform.kinematics import Kinematics
from drivesizer.spec.platform import Limits

__all__ = ["Reach", "reached", "wheel_speed"]


class Reach(NamedTuple):
    """Largest figures of a platform's motion, in one direction at a time; NaN where there is none."""

    forwards: float  # m/s
    sideways: float  # m/s; NaN where its wheels do not allow it
    turning: float  # rad/s
    acceleration: float  # m/s^2
    jerk: float  # m/s^3
    turning_acceleration: float  # rad/s^2
    turning_jerk: float  # rad/s^3


def wheel_speed(of: Export, rolling: float) -> float:
    """Speed that a drive keeps at its wheel on the lowest supply voltage [rad/s].

    Parameters
    ----------
    of
        The drive; of a stepper the highest speed of its motion.
    rolling
        Torque at the wheel at constant speed [N*m].

    Returns
    -------
    float
        NaN where nothing limits it.
    """
    permitted, train = of.limits.peak_speed, of.train
    most = permitted.value if permitted.by else inf
    if not of.stepper:
        driven = speed_at(train, of.voltage, train.friction + rolling / (train.ratio * train.efficiency))
        most = min(most, max(driven, 0.0) / train.ratio)
    return most if most < inf else nan


def reached(k: Kinematics, wheel: float, limits: Limits, eta_dot: Array) -> Reach:
    """Speeds and accelerations of a platform.

    Parameters
    ----------
    k
        Its wheels.
    wheel
        Highest speed of a driven one [rad/s].
    limits
        That the spec sets.
    eta_dot
        Rate of change of the velocity in the robot's frame over the spec's motion, shape (3, ...).

    Returns
    -------
    Reach
        SI.
    """
    most = np.abs(k.E[list(k.driven)]).max(axis=0)
    speed, aside, turning = (wheel / each if each > _NOTHING * most.max() else nan for each in most.tolist())
    along, about = float(np.hypot(eta_dot[0], eta_dot[1]).max()), float(np.abs(eta_dot[2]).max())
    return Reach(
        forwards=_least(speed, limits.speed),
        sideways=_least(aside, limits.speed) if k.mobility > 2 else nan,
        turning=_least(turning, limits.turning_speed),
        acceleration=limits.acceleration or along or nan,
        jerk=limits.jerk or nan,
        turning_acceleration=limits.turning_acceleration or about or nan,
        turning_jerk=limits.turning_jerk or nan,
    )


def _least(value: float, limit: float | None) -> float:
    """The smaller of two that are known; NaN where none is."""
    known = [one for one in (value, limit) if one is not None and isfinite(one)]
    return min(known, default=nan)


_NOTHING = 1e-9  # of the largest entry: rounding
