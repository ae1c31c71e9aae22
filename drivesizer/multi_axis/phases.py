"""Axes on one bus at the same time or at any phase: what one regenerates and another draws, bounds of every phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import fsum, gcd, inf, isnan, lcm, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.supply_power import Burnt, DrivePower, OnTheBus, Regenerated, side_by_side
from drivesizer.physics.braking import largest_mean, largest_pulse
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.spec.robot import RobotSpec

# -- Power of several axes on one bus at the same time: what one regenerates another draws at the same moment.
#
# .. math::
#
#     P(t) &= \sum_i P_i(t), \qquad P_i = P_{drawn,i} - P_{returned,i} \qquad (1) \\
#     E_{left} &= \int \max(-P, 0)\,dt \le \sum_i E_{returned,i} \qquad (2)
#
# Of each piece of a course mean, largest and least power are known. Where the sum changes its sign within a piece,
# the returned power is the most that these three allow, never more than the sum of the single ones:
#
# .. math:: \bar P_{left} \le \frac{-P_{min} (P_{max} - \bar P)}{P_{max} - P_{min}} \qquad (3)
#
# Sources: (1), (2) Mitsubishi Electric, MELSERVO-J5 (MR-J5W3), User's Manual, 6.2 Regenerative option: energies of
# the axes summed at each timing of the cycle, those that stay negative count; ABB, Common DC configuration for
# ACS850-04, 3AUA0000073108: peaks and means of the system's power profile; (3) Edmundson's bound of a convex
# function's mean.


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


# -- Axes on one bus that run at any phase to one another: bounds of every phase, and the time above a limit.
#
# With phases :math:`\varphi_i` that take any value, each axis' power is a random variable of its own; the sum has
# the convolution of their distributions, and its largest value, the sum of the largest, comes about at one phase:
#
# .. math::
#
#     \max_\varphi P &= \sum_i \max P_i, \qquad \Pr(P > L) = \sum_{p > L} (f_1 * f_2 * \dots)(p) \qquad (1), (2) \\
#     E_{left} &\le \sum_i E_{returned,i}, \qquad E_{stored} \le \sum_i E_{stored,i} \qquad (3), (4) \\
#     T_{P > L} &\le \min_i T\left(P_i > L - \sum_{j \ne i} \max P_j\right) \qquad (5)
#
# A braking that several axes go on with, one after the other, lasts at most
#
# .. math:: T \le \sum_i b_i (1 - d_i) / (1 - \sum_i d_i), \qquad d_i = b_i / T_i \qquad (6)
#
# where an axis brakes for :math:`b_i` of its period :math:`T_i`, since it brakes for no more than :math:`d_i T + b_i
# (1 - d_i)` of any time T. The energy of it is at most the sum of the largest that each returns in such a time.
#
# Source of (3): Kollmorgen SERVOSTAR S and CD, M-SS-005-03, appendix D: of several axes those that regenerate
# decelerate while the others are idle. (2) is the distribution of a sum of independent variables; it is rounded up
# on its grid.


_CELLS = 4096  # of the grid of powers
_PAIRS = 500_000  # of pieces of two courses
_STEPS = 512  # of the phases of two courses
_ROUNDING = 1e-9  # of a cell


@dataclass(frozen=True)
class AtAnyPhase(OnTheBus):
    """Energies to and from a bus whose axes run at any phase: no phase makes more of them."""

    case: str
    spec: RobotSpec
    powers: tuple[DrivePower, ...]  # of axes, or of those that run together
    singles: tuple[Regenerated, ...]  # the same
    feed: Feed

    @cached_property
    def known(self) -> bool:
        """Whether the energies are."""
        return all(one.known for one in self.singles)

    @property
    def longest(self) -> float:
        """Longest of the periods [s]."""
        return max(power.total for power in self.powers)

    @cached_property
    def energy(self) -> float:
        """Regenerated energy in the longest period that is not stored and that no axis draws [J], (3).

        Of two axes with one period that of the worst phase, as far as their pieces are few enough to look at all pairs.
        """
        mean = fsum(one.energy / power.total for one, power in zip(self.singles, self.powers, strict=True))
        pairs = float(np.prod([len(power.duration) for power in self.powers]))
        if len(self.powers) == 2 and self.known and pairs <= _PAIRS:
            periods = [power.total for power in self.powers]
            if abs(periods[0] - periods[1]) <= _SAME * self.longest:
                share = 1.0 - self.spec.supply.regeneration
                courses = [(power.duration, power.bus_drawn - power.returned) for power in self.powers]
                mean = min(mean, share * returned_over_phases(*courses)[0])
        return mean * self.longest

    @cached_property
    def stored(self) -> float:
        """Largest energy that is regenerated and not drawn again [J], (4)."""
        return fsum(one.stored for one in self.singles) if self.known else nan

    @cached_property
    def mean_drawn(self) -> float:
        """Mean power out of the source [W]: straight up to the largest, for its losses grow with the square."""
        mean = fsum(power.mean(power.bus_drawn) for power in self.powers)
        most = fsum(max(float(power.most.max()), 0.0) for power in self.powers)
        if not np.any(self.feed.resistance) or not most > 0.0:
            return mean
        return mean * float(of_the_source(np.asarray(most), self.feed)) / most

    def burnt(self, capacity: float, window: float, continuous: float = 0.0) -> Burnt:
        """Load of a brake resistor, as of ``Regenerated.burnt``; no phase makes more of it."""
        if not self.known:
            return Burnt(nan, nan, nan, nan)
        if self.stored <= capacity:
            return Burnt(0.0, 0.0, 0.0, 0.0)
        least = fsum(float(power.least.min()) for power in self.powers)
        back = (1.0 - self.spec.supply.regeneration) * max(-least, 0.0)
        peak = min(back, fsum(float(one.returned_peak.max()) for one in self.singles))
        mean = fsum(largest_mean(one.duration, one.returned, window) for one in self.singles)
        pulse = 0.0 if peak <= (0.0 if isnan(continuous) else continuous) else self._pulse()
        return Burnt(self.energy, peak, mean, pulse)

    def _pulse(self) -> float:
        """Largest energy of an uninterrupted braking [J], (6)."""
        total = [float(one.duration.sum()) for one in self.singles]
        braking = [float(one.duration[one.returned > 0.0].sum()) for one in self.singles]
        shares = [part / whole for part, whole in zip(braking, total, strict=True)]
        free = 1.0 - fsum(shares)
        if not free > 0.0:
            return inf
        long = fsum(part * (1.0 - share) for part, share in zip(braking, shares, strict=True)) / free
        if long == 0.0:
            return 0.0
        return fsum(long * largest_mean(one.duration, one.returned, long) for one in self.singles)

    def longest_above(self, power: float) -> float:
        """Longest uninterrupted time in which the power out of the source exceeds one [s], (5)."""
        if not self.known:
            return nan
        limit, most = bus_power(power, self.feed), [float(one.most.max()) for one in self.powers]
        runs = []
        for one, own in zip(self.powers, most, strict=True):
            above = one.most > limit - (fsum(most) - own)
            runs.append(largest_pulse(one.duration, np.where(above, one.duration, 0.0)))
        if len(self.powers) != 2 or isnan(common_period([one.total for one in self.powers])):
            return min(runs)
        return min(*runs, longest_run_of_two([(one.duration, one.most) for one in self.powers], limit))


def bus_power(power: float, feed: Feed) -> float:
    """Power at the bus for one out of its source: without what the source's resistance turns to heat."""
    most = feed.voltage**2 / (2.0 * feed.resistance) if feed.resistance else inf  # no source gives more to its bus
    taken = min(power, most)
    return float(taken - feed.resistance * (taken / feed.voltage) ** 2)


def worst_start(power: DrivePower) -> float:
    """Moment from which a course begins for its largest power to come first [s], below 0."""
    return -float(power.duration[: int(power.most.argmax())].sum())


def share_above(courses: Sequence[tuple[Array, Array]], limit: float, *, up: bool = True) -> float:
    """Share of the time in which the sum of courses at random phases exceeds a limit, (2).

    Examples
    --------
    Two axes draw 10 W for a quarter of the time and nothing else: both do for a sixteenth.

    >>> one = np.array([1.0, 3.0]), np.array([10.0, 0.0])
    >>> share_above([one, one], 15.0), share_above([one, one], 5.0)
    (0.0625, 0.4375)
    """
    base, spans = [float(values.min()) for _, values in courses], [float(np.ptp(values)) for _, values in courses]
    if isnan(fsum(base) + limit):
        return nan
    cell = fsum(spans) / _CELLS
    if cell == 0.0:
        return float(fsum(base) > limit)
    rounded, law = (np.ceil if up else np.floor), np.ones(1)
    for (duration, values), least in zip(courses, base, strict=True):
        cells = rounded((values - least) / cell + (-_ROUNDING if up else _ROUNDING)).astype(int)
        law = np.convolve(law, np.bincount(np.maximum(cells, 0), duration / duration.sum()))
    power = fsum(base) + cell * np.arange(len(law))
    return min(float(law[power > limit + _ROUNDING * cell].sum()), 1.0)


def longest_run_of_two(courses: Sequence[tuple[Array, Array]], limit: float) -> float:
    """Longest uninterrupted time in which the sum of two courses exceeds a limit, at the worst phase [s].

    On a grid over their common period; each cell has the largest power of itself and of the next, so that no phase
    between those of the grid makes more of it.

    Examples
    --------
    >>> one = np.array([1.0, 3.0]), np.array([10.0, 0.0])
    >>> 1.0 <= longest_run_of_two([one, one], 15.0) < 1.02
    True
    """
    whole = common_period([float(duration.sum()) for duration, _ in courses])
    cell = whole / _STEPS
    first, second = (_largest_in_cells(duration, values, cell) for duration, values in courses)
    second = np.maximum(second, np.roll(second, -1))
    phases = (np.arange(_STEPS)[:, None] + np.arange(_STEPS)[None, :]) % _STEPS
    above = first[None, :] + second[phases] > limit
    if above.all(axis=1).any():
        return inf
    return cell * int(_runs(above).max(initial=0))


def _largest_in_cells(duration: Array, values: Array, cell: float) -> Array:
    """Largest power of a course in each cell of the grid."""
    total, ends = float(duration.sum()), np.cumsum(duration)
    start = (np.arange(_STEPS) * cell) % total
    if cell >= total:
        return np.full(_STEPS, values.max())
    twice = np.concatenate([values, values])
    ends = np.concatenate([ends, ends + total])
    first, last = np.searchsorted(ends, start, side="right"), np.searchsorted(ends, start + cell, side="left")
    return np.array([twice[a : b + 1].max() for a, b in zip(first.tolist(), last.tolist(), strict=True)])


def _runs(above: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Longest run of cells in each row, which goes on from its end to its beginning."""
    twice = np.concatenate([above, above], axis=1)
    count = np.arange(1, twice.shape[1] + 1)
    last = np.maximum.accumulate(np.where(twice, 0, count), axis=1)  # of the cells so far the last one without
    return np.asarray((count - last).max(axis=1))


def returned_over_phases(first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[float, float]:
    """Mean power that two courses of one period return together: at the worst phase, and at the best [W].

    The mean is straight in the phase between moments at which an edge of one course meets one of the other, so that its
    second derivative is a sum of impulses there, and its extremes are at such a phase: exact for even powers.

    Examples
    --------
    One draws 4 W while the other returns 6 W, or it returns them at another time:

    >>> one, other = (np.array([1.0, 3.0]), np.array([4.0, 0.0])), (np.array([1.0, 3.0]), np.array([-6.0, 0.0]))
    >>> returned_over_phases(one, other)
    (1.5, 0.5)
    """
    (long, p), (short, q) = first, second
    total = float(long.sum())
    back = np.maximum(-(p[:, None] + q[None, :]), 0.0)
    left, down = np.roll(back, 1, axis=0), np.roll(back, 1, axis=1)  # of the piece before, of each
    impulse = (down - back - np.roll(left, 1, axis=1) + left).ravel()
    starts = [np.cumsum(lasting) - lasting for lasting in (long, short)]
    at = (starts[0][:, None] - starts[1][None, :]).ravel() % total
    order = np.argsort(at)
    at, impulse = at[order], impulse[order]
    slope = -float(impulse @ (total - at)) / total  # so that it ends as it began
    risen = np.concatenate([[0.0], np.cumsum(impulse)[:-1]]) * at - np.concatenate(
        [[0.0], np.cumsum(impulse * at)[:-1]]
    )
    course = slope * at + risen
    level = float(np.outer(long, short).ravel() @ back.ravel()) / total  # mean over all phases, as if independent
    steps = np.diff(np.concatenate([at, [at[0] + total]]))
    ends = (course + np.roll(course, -1)) / 2
    course = course + level - float(ends @ steps) / total
    return max(float(course.max()), 0.0) / total, max(float(course.min()), 0.0) / total
