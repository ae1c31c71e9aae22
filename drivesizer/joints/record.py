"""Record of joints over time: segments with both ends of each, as a load cycle has them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.load_cycle import end_times

__all__ = ["Array", "JointMotion"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Positions, speeds and accelerations of joints over one cycle."""

    joints: tuple[str, ...]
    duration: Array  # s, of each segment, shape (segments,)
    position: Array  # rad or m, at both ends, shape (segments, 2, joints)
    speed: Array  # rad/s or m/s
    acceleration: Array  # rad/s^2 or m/s^2

    @property
    def time(self) -> Array:
        """Time at both ends of each segment [s], shape (segments, 2)."""
        return end_times(self.duration)

    @property
    def returns(self) -> bool:
        """Whether all joints end where they start."""
        first, last = self.position[0, 0], self.position[-1, 1]
        return bool((np.abs(last - first) <= 1e-6 * (1.0 + np.abs(first))).all())
