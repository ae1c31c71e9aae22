r"""Power of several axes on one bus at the same time: what one regenerates another draws at the same moment.

.. math::

    P(t) &= \sum_i P_i(t), \qquad P_i = P_{drawn,i} - P_{returned,i} \qquad (1) \\
    E_{left} &= \int \max(-P, 0)\,dt \le \sum_i E_{returned,i} \qquad (2)

Of each piece of a course mean, largest and least power are known. Where the sum changes its sign within a piece, the
returned power is the most that these three allow, never more than the sum of the single ones:

.. math:: \bar P_{left} \le \frac{-P_{min} (P_{max} - \bar P)}{P_{max} - P_{min}} \qquad (3)

Sources: (1), (2) Mitsubishi Electric, MELSERVO-J5 (MR-J5W3), User's Manual, 6.2 Regenerative option: energies of the
axes summed at each timing of the cycle, those that stay negative count; ABB, Common DC configuration for ACS850-04,
3AUA0000073108: peaks and means of the system's power profile; (3) Edmundson's bound of a convex function's mean.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import gcd, lcm, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.supply_power import DrivePower, side_by_side
from drivesizer.physics.power_stage import Feed, of_the_source

__all__ = ["MOST_PIECES", "common_period", "exchanged", "fitted", "from_start", "summed_up"]

Array = NDArray[np.float64]
_LONGEST = 60.0  # common period, in the longest of the single ones
MOST_PIECES = 20_000  # of all courses together
_FINEST = 10**6  # largest denominator of a period in seconds
_SAME = 1e-9  # relative: two periods


def from_start(power: DrivePower, start: float) -> DrivePower:
    """A course that repeats, begun so much later."""
    cut = power.total - start % power.total
    ends = np.cumsum(power.duration)
    piece = min(int(np.searchsorted(ends, cut, side="right")), len(ends) - 1)
    before = cut - (ends[piece] - power.duration[piece])  # of that piece, before the cut
    order = [*range(piece, len(ends)), *range(piece + 1)]
    duration = power.duration[order]
    duration[0], duration[-1] = power.duration[piece] - before, before
    lasting = duration > _SAME * power.total
    return power.at(duration[lasting], np.array(order)[lasting])


def fitted(power: DrivePower, window: float) -> DrivePower:
    """A course repeated as often as it goes into a window, its time stretched to fill that where it is no multiple."""
    count = max(round(window / power.total), 1)
    scale = window / (count * power.total)
    pieces = np.tile(np.arange(len(power.duration)), count)
    long = power.at(np.tile(power.duration * scale, count), pieces)
    return long._replace(distance=power.distance * window / power.total)


def common_period(periods: Sequence[float], pieces: Sequence[int] = ()) -> float:
    """Shortest time that is a multiple of all periods.

    Examples
    --------
    >>> common_period([1.2, 0.8]), common_period([1.0, 2.0**0.5])
    (2.4, nan)
    """
    if max(periods) - min(periods) <= _SAME * max(periods):
        return max(periods)
    found = [Fraction(period).limit_denominator(_FINEST) for period in periods]
    if any(abs(float(one) - period) > _SAME * period for one, period in zip(found, periods, strict=True)):
        return nan
    whole = float(Fraction(lcm(*(one.numerator for one in found)), gcd(*(one.denominator for one in found))))
    taken = sum(number * whole / period for number, period in zip(pieces, periods, strict=False))
    return whole if whole <= _LONGEST * max(periods) and taken <= MOST_PIECES else nan


def exchanged(powers: Sequence[DrivePower], feed: Feed) -> DrivePower:
    """Power of several axes at the same time, each drawing what others regenerate, (1) to (3)."""
    if len(powers) == 1:
        return powers[0]
    both = summed_up(powers, feed)
    mean = both.bus_drawn - both.returned
    low, high = np.minimum(both.least, mean), np.maximum(both.most, mean)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossed = -low * (high - mean) / (high - low)
    most = np.where(low >= 0.0, 0.0, np.where(high <= 0.0, -mean, crossed))
    left = np.minimum(np.maximum(most, -mean), both.returned)
    drawn = mean + left
    out = _source_mean(drawn, np.maximum(low, 0.0), np.maximum(high, 0.0), feed)
    return both._replace(
        drawn=out,
        bus_drawn=drawn,
        returned=left,
        peak=of_the_source(np.maximum(both.most, 0.0), feed),
        returned_peak=np.minimum(np.maximum(-both.least, 0.0), both.returned_peak),
        resisted=out - drawn,
    )


def summed_up(powers: Sequence[DrivePower], feed: Feed) -> DrivePower:
    """Power of several axes as if none drew what another regenerates: no course of them draws or returns more."""
    if len(powers) == 1:
        return powers[0]
    cut = side_by_side(powers)
    columns: dict[str, Any] = {
        name: np.sum([getattr(one, name) for one in cut], axis=0)
        for name in DrivePower._fields
        if name not in ("duration", "distance")
    }
    low, high = columns["least"], np.maximum(columns["most"], columns["bus_drawn"])
    out = _source_mean(columns["bus_drawn"], np.maximum(low, 0.0), np.maximum(high, 0.0), feed)
    travels = [one.distance for one in powers if one.distance == one.distance]
    return DrivePower(
        duration=cut[0].duration,
        distance=max(travels, default=nan),
        **columns
        | {
            "drawn": out,
            "resisted": out - columns["bus_drawn"],
            "peak": of_the_source(np.maximum(columns["most"], 0.0), feed),
        },
    )


def _source_mean(mean: Array, low: Array, high: Array, feed: Feed) -> Array:
    """Largest mean power out of a source with a resistance, of a power at the bus between two values [W]."""
    if not np.any(feed.resistance):
        return mean
    low = np.minimum(low, mean)
    ends = of_the_source(low, feed), of_the_source(np.maximum(high, mean), feed)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (mean - low) / (np.maximum(high, mean) - low)
        between = ends[0] + share * (ends[1] - ends[0])
    return np.asarray(np.where(mean > low, between, ends[0]))
