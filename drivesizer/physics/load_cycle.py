"""The load cycle: speed, acceleration and torque of the shaft that one drive turns, whatever the machine.

Segments over time, each with its values at the left and the right end and straight lines between. Segments, not
points: at the corner of a trapezoid the torque jumps, and a point has one value only. Every machine is reduced to
this (``loads``), and whatever follows knows nothing else.
Functions of ends take several cycles as well, side by side along a last axis.
Symbols: w speed [rad/s], a acceleration [rad/s^2], T torque that the load takes, its own inertia included [N*m].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError

__all__ = [
    "Ends", "Figure", "LoadCycle", "OwnLimit", "cut_points", "end_times", "integral", "mean_product", "middle",
    "places", "rms",
]  # fmt: skip

Ends = NDArray[np.float64]  # at the left and the right end: (segments, 2); of several cycles (segments, 2, cycles)
Figure = Any  # a float of one cycle; of several a column, shape (cycles,)


_NO_PART = 1e-250  # of a segment: a smaller one would have no duration in floating point
_LARGEST = 1e60  # of any figure: products of a few of them can still be computed with


class OwnLimit(NamedTuple):
    """A limit of the load itself, whatever drives it, such as the grip of a wheel."""

    name: str
    demand: Figure  # SI; NaN unknown
    limit: Figure
    time: float = nan  # s, of the worst moment
    turning: float = nan  # kg*m^2, J of a demand max |T - J a| / radius; NaN of any other demand


@dataclass(frozen=True, slots=True)
class LoadCycle:
    """Speed, acceleration and torque of the driven shaft over one cycle."""

    name: str
    duration: NDArray[np.float64]  # s, of each segment
    speed: Ends  # rad/s
    acceleration: Ends  # rad/s^2
    torque: Ends  # N*m, the load's own inertia included
    inertia: float = nan  # kg*m^2, of all that moves with the shaft, seen at it
    own: tuple[OwnLimit, ...] = ()
    radius: float = 1.0  # m, travel of the load per angle of the shaft; 1 where it turns with the shaft
    held: float = nan  # N*m, largest torque that holds it at rest on its path; NaN not looked at

    def __post_init__(self) -> None:
        shape = (len(self.duration), 2)
        if not len(self.duration) or any(c.shape != shape for c in (self.speed, self.acceleration, self.torque)):
            raise InputError(f"load cycle {self.name}: expected segments with two ends each")
        if not (self.duration > 0.0).all():  # written so that NaN fails too
            raise InputError(f"load cycle {self.name}: a segment must last longer than 0 s")
        if not all(_within(c) for c in (self.duration, self.speed, self.acceleration, self.torque)):
            raise InputError(f"load cycle {self.name}: a figure leaves the range of numbers that can be computed with")

    @property
    def total(self) -> float:
        """Length of the cycle [s]."""
        return float(self.duration.sum())

    @property
    def time(self) -> Ends:
        """Time at both ends of each segment, from the start of the cycle [s]."""
        return end_times(self.duration)

    @property
    def power(self) -> Ends:
        """Mechanical power to the load at both ends of each segment [W]."""
        return self.torque * self.speed

    def split(self) -> LoadCycle:
        """The same cycle, cut where speed or torque changes sign: within a segment the direction of power is one.

        >>> up_and_down = LoadCycle("x", np.array([4.0]), np.array([[-1.0, 3.0]]), np.ones((1, 2)), np.ones((1, 2)))
        >>> up_and_down.split().duration
        array([1., 3.])
        """
        cycle = self
        for name in ("speed", "torque"):
            cycle = cycle._cut(name)
        return cycle

    def _cut(self, name: str) -> LoadCycle:
        ends = getattr(self, name)
        if not (ends[:, 0] * ends[:, 1] < 0.0).any():
            return self
        pieces, shares, column = cut_points(ends)
        first = np.cumsum(pieces) - pieces  # place of each segment's first piece
        crosses = pieces == 2
        second = (first + 1)[crosses]

        def cut(ends: Ends, *, zero: bool = False) -> Ends:
            out = np.repeat(ends, pieces, axis=0)
            middle = np.zeros(crosses.sum()) if zero else (ends[:, 0] + shares * (ends[:, 1] - ends[:, 0]))[crosses]
            out[first[crosses], 1] = middle
            out[second, 0] = middle
            return out

        duration = np.repeat(self.duration, pieces)
        duration[first] *= shares
        duration[second] *= (1.0 - shares)[crosses]
        columns = {n: cut(column, zero=True) if n == name else cut(getattr(self, n)) for n in _COLUMNS}
        return replace(self, duration=duration, **columns)  # type: ignore[arg-type]


def _within(column: NDArray[np.float64]) -> bool:
    """Whether all figures can be computed with; without an array of their amounts, for a long cycle's takes room."""
    return float(column.max()) < _LARGEST and float(column.min()) > -_LARGEST


_COLUMNS = ("speed", "acceleration", "torque")


def cut_points(column: Ends) -> tuple[NDArray[np.int64], NDArray[np.float64], Ends]:
    """Places where a quantity changes sign within segments.

    Parameters
    ----------
    column
        The quantity at both ends of each segment, shape (segments, 2).

    Returns
    -------
    tuple
        Number of pieces of each segment (1 or 2); the share of it before the change [1] (1 without one); and the
        column, with an end that is beyond its change of sign by less than rounding set to 0.
    """
    left, right = column.T
    crosses = left * right < 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, left / (left - right), 0.5)
    column = np.where(np.stack([crosses & (share <= _NO_PART), crosses & (share >= 1.0)], axis=1), 0.0, column)
    crosses &= (share > _NO_PART) & (share < 1.0)
    return np.where(crosses, 2, 1), np.where(crosses, share, 1.0), column


def places(count: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The segment of each piece, and the piece's number within it, of so many pieces a segment.

    >>> [x.tolist() for x in places(np.array([2, 3]))]
    [[0, 0, 1, 1, 1], [0, 1, 0, 1, 2]]
    """
    owner = np.repeat(np.arange(len(count)), count)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)


def end_times(duration: NDArray[np.float64]) -> Ends:
    """Time at both ends of each segment, from the start of the cycle [s]: shape (segments, 2, ...)."""
    end = np.cumsum(duration, axis=0)
    return np.stack([end - duration, end], axis=1)


def middle(ends: Ends) -> NDArray[np.float64]:
    """Mean of a quantity over each segment, in its own unit: shape (segments, ...); quicker than a mean of any number.

    >>> middle(np.array([[1.0, 3.0], [2.0, 2.0]])).tolist()
    [2.0, 2.0]
    """
    found: NDArray[np.float64] = (ends[:, 0] + ends[:, 1]) / 2
    return found


def integral(duration: NDArray[np.float64], a: Ends, b: Ends) -> Figure:
    r"""Integral of a product of two quantities over the cycle, exact for straight lines.

    .. math:: \int a b \, dt = \sum \Delta t \, (2 a_0 b_0 + a_0 b_1 + a_1 b_0 + 2 a_1 b_1) / 6

    Parameters
    ----------
    duration
        Of each segment [s], shape (segments,) or (segments, cycles).
    a, b
        The quantities at both ends of each segment, shape (segments, 2) or (segments, 2, cycles).

    Returns
    -------
    float or array
        The integral, in the units of a times b times s; of several cycles shape (cycles,).

    Examples
    --------
    >>> integral(np.array([3.0]), np.array([[0.0, 2.0]]), np.array([[0.0, 2.0]]))
    4.0
    """
    mean = mean_product(a, b)
    return float(duration @ mean) if mean.ndim == 1 else (duration * mean).sum(axis=0)


def mean_product(a: Ends, b: Ends) -> NDArray[np.float64]:
    """Mean of a product of two quantities over each segment, exact for straight lines.

    Parameters
    ----------
    a, b
        At both ends of each segment, shape (segments, 2) or (segments, 2, cycles).

    Returns
    -------
    array
        In the units of a times b, shape (segments,) or (segments, cycles).
    """
    a_0, a_1, b_0, b_1 = a[:, 0], a[:, 1], b[:, 0], b[:, 1]
    mean: NDArray[np.float64] = (2 * a_0 * b_0 + a_0 * b_1 + a_1 * b_0 + 2 * a_1 * b_1) / 6
    return mean


def rms(duration: NDArray[np.float64], a: Ends) -> Figure:
    """Root mean square of a quantity over segments, exact for straight lines; 0 without any.

    Parameters
    ----------
    duration
        Of each segment [s], shape (segments,) or (segments, cycles).
    a
        The quantity at both ends of each segment, shape (segments, 2) or (segments, 2, cycles).

    Returns
    -------
    float or array
        In the unit of a; of several cycles shape (cycles,).
    """
    total = duration.sum(axis=0)
    found = np.sqrt(integral(duration, a, a) / np.where(total > 0.0, total, 1.0))
    return float(found) if duration.ndim == 1 else found
