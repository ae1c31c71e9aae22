"""Loads that gravity turns: a mass on a lever about an axis that does not stand upright."""

from __future__ import annotations

import math
from typing import NamedTuple

from drivesizer.spec.loads import Arm, Load, RotaryTable

__all__ = ["Lever", "lever_of"]

_LEVEL = 1e-5  # of the weight: what gets through a smaller share of it is none; files round 90 degrees to 1.5708 rad


class Lever(NamedTuple):
    """A mass away from the axis that it turns about."""

    mass: float  # kg
    length: float  # m, from the axis to its centre
    share: float  # of its weight that the axis' tilt leaves across it: 1 for a level axis
    start: float  # rad, of the lever above the level line when the cycle starts

    def moment(self, gravity: float) -> float:
        """Torque of the weight when the lever lies level, M [N*m]; 0 where it turns level but for rounding."""
        return self.mass * gravity * self.length * self.share if abs(self.share) > _LEVEL else 0.0


def lever_of(load: Load) -> Lever | None:
    """The whole machine's lever; None for loads of another kind. One whose moment is 0 is balanced, or turns level."""
    if isinstance(load, Arm):
        return Lever(load.mass, load.length, math.cos(load.tilt), load.start_angle)
    if isinstance(load, RotaryTable):
        return Lever(load.mass, load.eccentricity, math.sin(load.tilt), load.start_angle)
    return None
