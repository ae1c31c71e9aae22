"""The instant of a platform's motion at which a wheel has its largest torque."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform_wheels import dynamics_of, ground_of, trajectory_of
from drivesizer.physics.load_cycle import end_times
from drivesizer.platform.dynamics import Dynamics, wheel_torques
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.motion import motion
from drivesizer.platform.robot_figures import Instant
from drivesizer.spec.robot import RobotSpec

__all__ = ["HardestInstant", "hardest_instant"]

_SAME = 1e-9  # of the largest torque


class HardestInstant(NamedTuple):
    """A platform where one of its wheels has its largest torque."""

    dynamics: Dynamics
    instant: Instant
    time: float  # s, from the start of the motion
    wheel: int  # from 1
    case: str  # name of the load case; empty where there is one


def hardest_instant(spec: RobotSpec, rotor_inertia: float = 0.0) -> HardestInstant:
    """A platform at the instant of its motion, in the first load case, at which a wheel has its largest torque."""
    name, case = spec.load_cases[0]
    d, trajectory = dynamics_of(case, rotor_inertia), trajectory_of(case)
    if trajectory is None:
        cycle = load_cycle(case)
        at = _largest(cycle.torque, cycle.speed)
        eta, eta_dot = (np.array([cycle.radius * course[at], 0.0, 0.0]) for course in (cycle.speed, cycle.acceleration))
        ground = replace(ground_of(case), uphill=0.0)  # its slope is along its path
        turned = cycle.duration * cycle.speed.mean(axis=1)  # rad, of each segment; its speed is a straight line
        turned[at[0]] *= at[1]  # at its start or at its end
        posture = np.array([cycle.radius * turned[: at[0] + 1].sum(), 0.0, 0.0])
        straight = Instant(posture, eta, eta_dot, ground)
        return HardestInstant(d, straight, float(cycle.time[at]), d.kinematics.driven[0] + 1, name)
    seen = motion(d, trajectory, ground_of(case))
    torque = wheel_torques(d, seen.eta, seen.eta_dot, theta=seen.facing, ground=seen.ground, towards=seen.towards)
    wheel, piece, end = _largest(torque, np.hypot(*seen.eta[:2])[None])
    place, time = (slice(None), piece, end), float(end_times(seen.duration)[piece, end])
    posture = np.array([*trajectory.at(time)[:2], seen.theta[piece, end]])
    instant = Instant(posture, seen.eta[place], seen.eta_dot[place], ground_of(case), seen.towards[place])
    return HardestInstant(d, instant, time, d.kinematics.driven[wheel] + 1, name)


def _largest(torque: Array, speed: Array) -> tuple[int, ...]:
    """Place of the largest torque; of several alike that at the highest speed."""
    size = np.abs(torque)
    fastest = np.where(size >= (1.0 - _SAME) * size.max(), np.abs(speed), -1.0)
    return tuple(int(i) for i in np.unravel_index(fastest.argmax(), size.shape))
