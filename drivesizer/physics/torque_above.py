"""Times for which the torque at the gearhead's output is above a limit: of a short cycle by columns, or in one look."""

from __future__ import annotations

import math

import numpy as np

from drivesizer.physics.cycle_at_gearhead import AT_REST, AtGearhead
from drivesizer.physics.groups.census import times_above
from drivesizer.physics.waveform import Wave, longest_above, share_above

__all__ = ["torque_above"]


def torque_above(cycle: AtGearhead, limit: float) -> tuple[float, float]:
    """Longest time without a break for which the torque is above a limit, and the share of all such time.

    Parameters
    ----------
    cycle
        The load cycle at the gearhead's output, behind one belt.
    limit
        Of the torque there [N*m].

    Returns
    -------
    tuple of floats
        Time [s] and share [1]; NaN where the limit is unknown.
    """
    base, load = cycle.base, cycle.load_cycle
    if base.census is None:
        torque = base.functions[None, :, :, : AT_REST + 1].sum(axis=3) / cycle.belt
        found, limits = Wave(load.duration, torque, torque), np.array([limit])
        return float(longest_above(found, limits)[0]), float(share_above(found, limits)[0])
    if math.isnan(limit):
        return math.nan, math.nan
    if not base.scalars.peak_torque / cycle.belt > limit:
        return 0.0, 0.0
    longest, total = times_above(load.duration, base.torque)(limit * cycle.belt)
    return max(longest - 8 * float(np.spacing(load.total)), 0.0), total / load.total
