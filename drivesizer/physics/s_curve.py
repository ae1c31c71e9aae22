"""The fastest motion over a distance under limits of speed, acceleration and jerk."""

from __future__ import annotations

import math

__all__ = ["fastest_ramp"]


def fastest_ramp(distance: float, speed: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """Times of the fastest move [s]: of each jerk phase, at the greatest acceleration, at the greatest speed.

    From ruckig, whose tolerances are fixed numbers: distance and time are scaled to those of the move, and
    a distance longer than needed to reach the speed is cut short, which leaves the ramps as they are.

    Parameters
    ----------
    distance
        From rest to rest [m].
    speed, acceleration, jerk
        Limits [m/s], [m/s^2], [m/s^3], above 0.

    Returns
    -------
    tuple of floats
        The three times [s].

    Raises
    ------
    ArithmeticError
        When there is no such move within the range of numbers.
    """
    import ruckig

    v, a, j = speed, acceleration, jerk
    length = min(distance, 4 * v * max(v / a, math.sqrt(v / j)))
    unit = max(length / v, 2 * math.sqrt(length / a), math.cbrt(32 * length / j))
    task, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
    task.target_position = [1.0]
    limits = [v * unit / length, a * unit * unit / length, j * unit * unit * unit / length]
    task.max_velocity, task.max_acceleration, task.max_jerk = ([limit] for limit in limits)
    try:
        ruckig.Ruckig(1).calculate(task, found)
    except ruckig.RuckigError as error:
        raise ArithmeticError(str(error)) from None
    t = found.profiles[0][0].t  # of the seven phases; from rest to rest the last three are the first three, mirrored
    return t[0] * unit, t[1] * unit, t[3] * unit + (distance - length) / v
