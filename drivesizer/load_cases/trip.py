"""Time, distance and highest speed of a machine's motion."""

from __future__ import annotations

from math import nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.load_cases.shift import cycle_of_shift
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.load_cycle import LoadCycle, middle
from drivesizer.spec.robot import RobotSpec

__all__ = ["Trip", "distance_of", "trip"]


class Trip(NamedTuple):
    """A motion, from its start to its end."""

    time: float  # s
    distance: float  # m along the path, there and back; NaN of what does not travel
    top_speed: float  # m/s, or rad/s of a load that turns


def trip(spec: RobotSpec) -> Trip:
    """The motion of a load case, as it is specified; with cases that share its time the motion of all of them."""
    if spec.platform is not None:
        from drivesizer.load_cases.platform_wheels import trajectory_of

        if trajectory := trajectory_of(spec):
            fastest = np.hypot(*trajectory.velocity[:2]).max()
            return Trip(trajectory.total, trajectory.length, float(fastest))
    cycle = cycle_of_shift(spec)
    fastest = cycle.radius * float(np.abs(cycle.speed).max())
    return Trip(cycle.total, distance_of(spec, cycle), fastest)


def distance_of(spec: RobotSpec, cycle: LoadCycle) -> float:
    """Distance that a vehicle travels in a cycle."""
    load: Any = spec.load
    if load.is_wheel:
        return float(load.distance)
    if not isinstance(load, WheeledVehicle):
        return nan
    return cycle.radius * float(middle(np.abs(cycle.speed)) @ cycle.duration)
