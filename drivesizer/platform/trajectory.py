"""How a platform moves through the world, as pieces of time."""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer.platform.kinematics import to_robot
from drivesizer.platform.notation import Array

__all__ = ["Trajectory"]


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Posture, velocity and acceleration at both ends of each of n pieces, in the world's axes; straight between.

    The first axis has forwards-x, left-y and heading; the last one left and right end: an acceleration may jump
    between two pieces, a velocity and a posture may not.
    """

    duration: Array  # (n,) s, above 0
    posture: Array  # (3, n, 2): m, m, rad
    velocity: Array  # (3, n, 2): m/s, m/s, rad/s
    acceleration: Array  # (3, n, 2): m/s^2, m/s^2, rad/s^2

    @property
    def total(self) -> float:
        """Length in time [s]."""
        return float(self.duration.sum())

    def in_robot(self) -> tuple[Array, Array]:
        """Velocity and its rate of change in the robot's frame, η and dη/dt: shape (3, n, 2) both.

        dη/dt = R ξ̈ + Ṙ ξ̇: what the robot's own axes see of the acceleration changes as they turn.
        """
        theta = self.posture[2]
        eta, seen = to_robot(theta, self.velocity), to_robot(theta, self.acceleration)
        turning = self.velocity[2]
        seen[0] += turning * eta[1]
        seen[1] -= turning * eta[0]
        return eta, seen
