"""Motion of a platform through the world, as pieces of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivesizer.platform.kinematics import to_robot
from drivesizer.platform.matrix_equation import Array

__all__ = ["Trajectory", "joined", "rest"]


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

    @property
    def time(self) -> Array:
        """Time at both ends of each piece, from the start [s]; shape (n, 2)."""
        end = np.cumsum(self.duration)
        return np.stack([end - self.duration, end], axis=1)

    def at(self, time: Any) -> Array:
        """Posture at any times [m, m, rad], shape (3, ...): a cubic of time in each piece, exact for a constant jerk.

        Before the start and after the end it is the first and the last one.
        """
        edges = np.concatenate([[0.0], np.cumsum(self.duration)])
        moment = np.clip(np.asarray(time, dtype=float), 0.0, edges[-1])
        i = np.clip(np.searchsorted(edges, moment, side="right") - 1, 0, len(self.duration) - 1)
        T = self.duration[i]
        u = (moment - edges[i]) / T
        (p_0, p_1), (v_0, v_1) = np.moveaxis(self.posture[:, i], -1, 0), np.moveaxis(self.velocity[:, i], -1, 0)
        inner = T * (v_0 * (1.0 - u) - v_1 * u) + (p_1 - p_0) * (2.0 * u - 1.0)
        return np.asarray(p_0 + (p_1 - p_0) * u + u * (1.0 - u) * inner)

    @property
    def length(self) -> float:
        """Length of the path, by the mean speed of both ends of each piece [m]."""
        return float(np.hypot(*self.velocity[:2]).mean(axis=1) @ self.duration)

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


def rest(posture: Array, time: float) -> Trajectory:
    """Rest at a posture, as one piece.

    Parameters
    ----------
    posture
        Where [m, m, rad], shape (3,).
    time
        How long [s].

    Returns
    -------
    Trajectory
        One piece.
    """
    still = np.zeros((3, 1, 2))
    return Trajectory(np.array([time]), still + np.reshape(posture, (3, 1, 1)), still, still.copy())


def joined(parts: Sequence[Trajectory]) -> Trajectory:
    """Trajectories one after the other, each of which starts where the one before ends."""
    columns = (np.concatenate([getattr(p, n) for p in parts], axis=1) for n in ("posture", "velocity", "acceleration"))
    return Trajectory(np.concatenate([p.duration for p in parts]), *columns)
