r"""Axes on one bus that run at any phase to one another: bounds of every phase, and the time above a limit.

With phases :math:`\varphi_i` that take any value, each axis' power is a random variable of its own; the sum has the
convolution of their distributions, and its largest value, the sum of the largest, comes about at one phase:

.. math::

    \max_\varphi P &= \sum_i \max P_i, \qquad \Pr(P > L) = \sum_{p > L} (f_1 * f_2 * \dots)(p) \qquad (1), (2) \\
    E_{left} &\le \sum_i E_{returned,i}, \qquad E_{stored} \le \sum_i E_{stored,i} \qquad (3), (4) \\
    T_{P > L} &\le \min_i T\left(P_i > L - \sum_{j \ne i} \max P_j\right) \qquad (5)

A braking that several axes go on with, one after the other, lasts at most

.. math:: T \le \sum_i b_i (1 - d_i) / (1 - \sum_i d_i), \qquad d_i = b_i / T_i \qquad (6)

where an axis brakes for :math:`b_i` of its period :math:`T_i`, since it brakes for no more than :math:`d_i T + b_i (1
- d_i)` of any time T. The energy of it is at most the sum of the largest that each returns in such a time.

Source of (3): Kollmorgen SERVOSTAR S and CD, M-SS-005-03, appendix D: of several axes those that regenerate decelerate
while the others are idle. (2) is the distribution of a sum of independent variables; it is rounded up on its grid.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import fsum, inf, isnan, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.regenerated import Burnt, Regenerated, raised_voltage
from drivesizer.machine.supply_power import DrivePower
from drivesizer.multi_axis.exchange import common_period
from drivesizer.physics.elements.brake_resistor import largest_mean, largest_pulse
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.spec.robot import RobotSpec

__all__ = ["AtAnyPhase", "bus_power", "longest_run_of_two", "returned_over_phases", "share_above", "worst_start"]

Array = NDArray[np.float64]
_CELLS = 4096  # of the grid of powers
_PAIRS = 500_000  # of pieces of two courses
_STEPS = 512  # of the phases of two courses
_ROUNDING = 1e-9  # of a cell
_SAME = 1e-9  # relative: two periods


class AtAnyPhase(NamedTuple):
    """Energies to and from a bus whose axes run at any phase: no phase makes more of them."""

    case: str
    spec: RobotSpec
    powers: tuple[DrivePower, ...]  # of axes, or of those that run together
    singles: tuple[Regenerated, ...]  # the same
    feed: Feed

    @property
    def known(self) -> bool:
        """Whether the energies are."""
        return all(one.known for one in self.singles)

    @property
    def longest(self) -> float:
        """Longest of the periods [s]."""
        return max(power.total for power in self.powers)

    @property
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

    @property
    def stored(self) -> float:
        """Largest energy that is regenerated and not drawn again [J], (4)."""
        return fsum(one.stored for one in self.singles) if self.known else nan

    @property
    def mean_drawn(self) -> float:
        """Mean power out of the source [W]: straight up to the largest, for its losses grow with the square."""
        mean = fsum(power.mean(power.bus_drawn) for power in self.powers)
        most = fsum(max(float(power.most.max()), 0.0) for power in self.powers)
        if not np.any(self.feed.resistance) or not most > 0.0:
            return mean
        return mean * float(of_the_source(np.asarray(most), self.feed)) / most

    def highest_voltage(self, more: float = 0.0) -> float:
        """Highest voltage of the bus without a brake resistor [V]; NaN where its capacitance is unknown."""
        return raised_voltage(self.spec, self.stored, more)

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
