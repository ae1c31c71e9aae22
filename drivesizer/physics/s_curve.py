"""The fastest motion over a distance under limits of speed, acceleration and jerk."""

from __future__ import annotations

import math

__all__ = ["fastest_ramp"]


def fastest_ramp(distance: float, speed: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """Times of the fastest way [s]: of each jerk phase, at the greatest acceleration, at the greatest speed.

    From ruckig, whose tolerances are fixed numbers: distance and time go to it as shares of what the move is like, and
    a way longer than needed to reach the speed is cut short, which leaves the ramps as they are.

    Raises
    ------
    ArithmeticError
        When there is no such way within the range of numbers.
    """
    import ruckig

    v, a, j = speed, acceleration, jerk
    way = min(distance, 4 * v * max(v / a, math.sqrt(v / j)))
    unit = max(way / v, 2 * math.sqrt(way / a), math.cbrt(32 * way / j))
    asked, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
    asked.target_position = [1.0]
    limits = [v * unit / way, a * unit * unit / way, j * unit * unit * unit / way]
    asked.max_velocity, asked.max_acceleration, asked.max_jerk = ([limit] for limit in limits)
    try:
        ruckig.Ruckig(1).calculate(asked, found)
    except ruckig.RuckigError as error:
        raise ArithmeticError(str(error)) from None
    t = found.profiles[0][0].t  # of the seven phases; from rest to rest the last three are the first three, mirrored
    return t[0] * unit, t[1] * unit, t[3] * unit + (distance - way) / v
