"""How warm a winding is at each moment of a cycle that repeats, for many motors at once: what its resistance then is.

The mathematics is that of ``heat_cycle``, with motors along the last axis, a block of them at a time;
``heat_cycle_columns`` has bounds of the peak.
Convention: temperatures are absolute; a motor with an unknown figure gives NaN, one that runs away an infinite peak and
else NaN.
Symbols: I current [A], P_h loss at the housing [W].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.heat_cycle import Periodic, highest, mean_rise, periodic, tops
from drivesizer.physics.heat_cycle_columns import some_of
from drivesizer.physics.heat_step import Array
from drivesizer.physics.thermal import TwoBodies

__all__ = ["WindingCourse", "of_pieces", "winding_course"]

_CELLS = 1 << 14  # motors times pieces in a block: what stays in the processor's cache


class WindingCourse(NamedTuple):
    """Temperatures of n windings over the P pieces of a cycle that repeats."""

    peak: Array  # K, also within a piece: (n,)
    peak_time: Array  # s from the cycle's start
    mean: Array  # K, over time
    ends: Array  # K, at both ends of each piece; its highest, where nothing else changes in it: (n, P, 2)
    means: Array  # K, over each piece: (n, P)


def winding_course(
    motor: TwoBodies, ambient: float, duration: Array, I2: Array, P_h: Array, steady: NDArray[np.bool_]
) -> WindingCourse:
    """Temperatures of many windings over a cycle that repeats for ever.

    Parameters
    ----------
    motor
        Windings and housings: columns over n motors, or a figure that all have.
    ambient
        Temperature around the motors [K].
    duration
        Of each piece [s].
    I2, P_h
        Mean square current [A^2] and mean loss at the housing [W] of each piece: n x P.
    steady
        Pieces in which current and speed stay what they are: of these the warmer end stands for the warmest moment,
        which may be within, so that what is largest there is found at the ends.
    """
    n, count = I2.shape
    peak, when, mean = np.full((3, n), np.nan)
    found = WindingCourse(peak, when, mean, np.full((n, count, 2), np.nan), np.full((n, count), np.nan))
    known = np.flatnonzero(np.broadcast_to(motor.known, n) & ~np.isnan(I2.sum(axis=1) + P_h.sum(axis=1) + ambient))
    size = max(_CELLS // count, 1)
    for rows in (known[first : first + size] for first in range(0, len(known), size)):
        part = _block(some_of(motor, n, rows), ambient, duration, I2[rows], P_h[rows], steady)
        for whole, values in zip(found, part, strict=True):
            whole[rows] = values
    return found


def _block(
    motor: TwoBodies, ambient: float, t: Array, I2: Array, P_h: Array, steady: NDArray[np.bool_]
) -> WindingCourse:
    """Of motors all of whose figures are known."""
    time = np.cumsum(t) - t
    with np.errstate(over="ignore", invalid="ignore"):  # where a motor runs away
        found = periodic(motor, ambient, t[:, None], np.ascontiguousarray(I2.T), np.ascontiguousarray(P_h.T))
        peak, mean = highest(found, 1.0, 0.0), mean_rise(found, 0)
        ends, means = of_pieces(found, steady[:, None])
    good = found.settles
    return WindingCourse(
        np.where(good, peak.rise + ambient, np.inf),
        np.where(good, time[peak.segment] + peak.until, np.nan),
        np.where(good, mean + ambient, np.nan),
        np.where(good[:, None, None], np.moveaxis(ends, -1, 0) + ambient, np.nan),
        np.where(good[:, None], means.T + ambient, np.nan),
    )


def of_pieces(found: Periodic, steady: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Rises of the winding [K] at both ends of the segments, (segments, 2, motors), and their means over each.

    Parameters
    ----------
    found
        The periodic state.
    steady
        As in ``winding_course``: (segments, 1).
    """
    left, right = found.rises[0][:-1], found.rises[0][1:]
    top, later = tops(found), right >= left
    ends = [np.where(steady & warmer, top, x) for x, warmer in ((left, ~later), (right, later))]
    change = found.weight.slope_integral * found.slopes[0] + found.weight.pull_integral * found.pulls[0]
    means = left + np.divide(change, found.t, out=np.zeros_like(change), where=found.t > 0.0)
    return np.stack(ends, axis=1), means
