r"""The load as inertia and torques at the shaft, for the closed loop, where the motion is not known beforehand.

A load cycle says what torque a motion takes; in closed loop the motion is the result. So the load is split into
a part that depends on the shaft alone and a remainder over time:

.. math:: T = J \dot w + T_{dir} + T_r(t)

J is the inertia at the shaft. T_dir are three constants, at the start of the motion: creeping forward, creeping
backward and at rest; between the latter two friction holds. They come from the load's own torque
law, so that no formula is repeated here. T_r is the torque of the cycle beyond both, such as the changing weight of a
swinging arm, wind, or losses of a screw's acceleration; it acts at its time, whatever the drive does.
Convention: as in ``load_cycle``; torque is positive when it resists forward motion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError
from drivesizer.load_cases import cycle_of_course, driven_shaft_cycle, load_cycle
from drivesizer.load_cases.profile import profile_of
from drivesizer.load_cases.wheel import WheelLoad
from drivesizer.loads.course import Course, Profile
from drivesizer.loads.hoist import Hoist
from drivesizer.loads.recorded import Recorded
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.robot import RobotSpec

__all__ = ["AtShaft", "at_shaft", "motion_of", "remaining_torque"]

_CREEP = 1e-9  # m/s or rad/s: no drag to speak of, and a direction
_NOTHING = 1e-12  # of the largest torque: what rounding leaves


class AtShaft(NamedTuple):
    """A load as seen from the driven shaft of one drive."""

    inertia: float  # kg*m^2
    radius: float  # m, travel of the load per angle of the shaft; 1 where it turns with it
    forward_torque: float  # N*m that resists when it creeps forward
    backward_torque: float  # N*m, the same backward: below the forward one by friction
    rest_torque: float  # N*m without friction: weight


@np.errstate(all="ignore")  # what leaves the range of numbers is refused with the drive train
def at_shaft(spec: RobotSpec) -> AtShaft:
    """Inertia and torques of a spec's load at the shaft."""
    forward, rest = _creeping(spec, _CREEP), _creeping(spec, 0.0)
    found = (_first(forward), _backward(spec), _first(rest))
    return AtShaft(forward.inertia, forward.radius, *found)


def _creeping(spec: RobotSpec, speed: float) -> LoadCycle:
    """A second at a speed, from where the motion starts; of a recording without its torque."""
    ends, still, load = np.full((1, 2), speed), np.zeros((1, 2)), spec.load
    if isinstance(load, Recorded):
        rolling = load.rolling_torque if isinstance(load, WheelLoad) else 0.0
        torque = np.full((1, 2), math.copysign(rolling, speed) if speed else 0.0)
        alone = LoadCycle("creeping", np.ones(1), ends, still, torque, load.shaft_inertia)
    else:
        alone = cycle_of_course(spec, Course("creeping", np.ones(1), np.array([[0.0, speed]]), ends, still))
    return driven_shaft_cycle(spec, alone)


def _first(cycle: LoadCycle) -> float:
    return float(cycle.torque[0, 0])


def _backward(spec: RobotSpec) -> float:
    try:
        return _first(_creeping(spec, -_CREEP))
    except InputError:
        if not isinstance(spec.load, Hoist):
            raise
        return 0.0  # friction outweighs the load: its rope hangs slack and pulls with nothing


def motion_of(spec: RobotSpec) -> Profile:
    """The motion profile of a spec; that of the shaft where the load is a recording."""
    if not isinstance(spec.load, Recorded):
        return profile_of(spec)
    cycle = load_cycle(spec)
    time = np.append(cycle.time[:, 0], cycle.total)
    speed = np.append(cycle.speed[:, 0], cycle.speed[-1, 1])
    return Profile(cycle.name, tuple(time.tolist()), tuple(speed.tolist()))


def remaining_torque(spec: RobotSpec, profile: Profile, shaft: AtShaft) -> NDArray[np.float64]:
    """Torque of a motion beyond inertia and the constants of its direction."""
    cycle = load_cycle(spec, None if isinstance(spec.load, Recorded) else profile)
    direction = np.sign(cycle.speed.mean(axis=1, keepdims=True))
    known = np.where(direction > 0.0, shaft.forward_torque, shaft.backward_torque)
    known = np.where(direction == 0.0, shaft.rest_torque, known) + shaft.inertia * cycle.acceleration
    largest = float(np.abs(cycle.torque).max() + np.abs(known).max())
    left = cycle.torque - known
    left[np.abs(left) <= _NOTHING * largest] = 0.0
    if not left.any():
        return np.empty((0, 2))
    level = np.abs(left[:, 1] - left[:, 0]) <= _NOTHING * largest
    left[level, 1] = left[level, 0]
    edges = profile.time[0] + np.concatenate([[0.0], np.cumsum(cycle.duration)])
    return _corners(edges, left, _NOTHING * largest)


def _corners(edges: NDArray[np.float64], value: NDArray[np.float64], small: float) -> NDArray[np.float64]:
    """Segments with two ends as rows of rising time; where the ends of two segments meet, one row is enough."""
    time = np.stack([edges[:-1], edges[1:]], axis=1)
    meets = np.append(np.abs(value[1:, 0] - value[:-1, 1]) <= small, False)
    time[:-1, 1] = np.maximum(np.nextafter(time[:-1, 1], -math.inf), time[:-1, 0])
    kept = np.stack([np.ones(len(meets), bool), ~meets], axis=1).ravel()
    rows: NDArray[np.float64] = np.stack([time, value], axis=2).reshape(-1, 2)[kept]
    rises = np.append(np.diff(rows[:, 0]) > 0.0, True)
    found: NDArray[np.float64] = rows[rises]
    return found  # a segment too short for its times to differ: its end
