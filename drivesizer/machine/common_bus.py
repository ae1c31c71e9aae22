"""Axes on one bus: what one regenerates and another draws, at the same time or at any phase, and where they wait."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import fsum, gcd, inf, isnan, lcm, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.load_cases import load_cycle, rest_left, static_torque, with_rest
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.platform import motion_of
from drivesizer.machine.problem import load_case, quickest_winding
from drivesizer.machine.supply_power import AxisOnBus, Burnt, DrivePower, Regenerated, power_of_cases, together
from drivesizer.physics.braking import largest_mean, largest_pulse
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.machine import Exceeded
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.spec.machine import MachineSpec
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.units import show

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
    fractions = [Fraction(period).limit_denominator(_FINEST) for period in periods]
    if any(abs(float(fraction) - period) > _SAME * period for fraction, period in zip(fractions, periods, strict=True)):
        return nan
    whole = float(
        Fraction(
            lcm(*(fraction.numerator for fraction in fractions)), gcd(*(fraction.denominator for fraction in fractions))
        )
    )
    count = sum(number * whole / period for number, period in zip(pieces, periods, strict=False))
    return whole if whole <= _LONGEST * max(periods) and count <= MOST_PIECES else nan


def exchanged(powers: Sequence[DrivePower], feed: Feed) -> DrivePower:
    """Power of several axes at the same time, each drawing what others regenerate, (1) to (3)."""
    if len(powers) == 1:
        return powers[0]
    total = summed_up(powers, feed)
    mean = total.bus_drawn - total.returned
    low, high = np.minimum(total.least, mean), np.maximum(total.most, mean)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossed = -low * (high - mean) / (high - low)
    most = np.where(low >= 0.0, 0.0, np.where(high <= 0.0, -mean, crossed))
    left = np.minimum(np.maximum(most, -mean), total.returned)
    drawn = mean + left
    out = _source_mean(drawn, np.maximum(low, 0.0), np.maximum(high, 0.0), feed)
    return total._replace(
        drawn=out,
        bus_drawn=drawn,
        returned=left,
        returned_peak=np.minimum(np.maximum(-total.least, 0.0), total.returned_peak),
        resisted=out - drawn,
    )


def summed_up(powers: Sequence[DrivePower], feed: Feed) -> DrivePower:
    """Power of several axes as if none drew what another regenerates: no course of them draws or returns more."""
    if len(powers) == 1:
        return powers[0]
    total = together(powers)
    high = np.maximum(total.most, total.bus_drawn)
    out = _source_mean(total.bus_drawn, np.maximum(total.least, 0.0), np.maximum(high, 0.0), feed)
    travels = [power.distance for power in powers if power.distance == power.distance]
    peak = of_the_source(np.maximum(total.most, 0.0), feed)
    distance = max(travels, default=nan)
    return total._replace(drawn=out, resisted=out - total.bus_drawn, peak=peak, distance=distance)


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
class AtAnyPhase(Regenerated):
    """Energies to and from a bus whose axes run at any phase: no phase makes more of them."""

    singles: tuple[Regenerated, ...]  # of axes, or of those that run together
    feed: Feed

    @property
    def powers(self) -> list[DrivePower]:
        """Power of each of them."""
        return [axis.power for axis in self.singles]

    @cached_property
    def known(self) -> bool:
        """Whether the energies are."""
        return all(axis.known for axis in self.singles)

    @property
    def longest(self) -> float:
        """Longest of the periods [s]."""
        return max(power.total for power in self.powers)

    @cached_property
    def energy(self) -> float:
        """Regenerated energy in the longest period that is not stored and that no axis draws [J], (3).

        Of two axes with one period that of the worst phase, as far as their pieces are few enough to look at all pairs.
        """
        mean = fsum(axis.energy / power.total for axis, power in zip(self.singles, self.powers, strict=True))
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
        return fsum(axis.stored for axis in self.singles) if self.known else nan

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
        back = min(max(-least, 0.0), fsum(float(power.returned_peak.max()) for power in self.powers))
        peak = (1.0 - self.spec.supply.regeneration) * back
        mean = fsum(largest_mean(axis.power.duration, axis.returned, window) for axis in self.singles)
        pulse = 0.0 if peak <= (0.0 if isnan(continuous) else continuous) else self._pulse()
        return Burnt(self.energy, peak, mean, pulse)

    def _pulse(self) -> float:
        """Largest energy of an uninterrupted braking [J], (6)."""
        total = [axis.power.total for axis in self.singles]
        braking = [float(axis.power.duration[axis.returned > 0.0].sum()) for axis in self.singles]
        shares = [part / whole for part, whole in zip(braking, total, strict=True)]
        free = 1.0 - fsum(shares)
        if not free > 0.0:
            return inf
        long = fsum(part * (1.0 - share) for part, share in zip(braking, shares, strict=True)) / free
        if long == 0.0:
            return 0.0
        return fsum(long * largest_mean(axis.power.duration, axis.returned, long) for axis in self.singles)

    def longest_above(self, power: float) -> float:
        """Longest uninterrupted time in which the power out of the source exceeds one [s], (5)."""
        if not self.known:
            return nan
        limit, most = bus_power(power, self.feed), [float(axis.most.max()) for axis in self.powers]
        runs = []
        for axis, own in zip(self.powers, most, strict=True):
            above = axis.most > limit - (fsum(most) - own)
            runs.append(largest_pulse(axis.duration, np.where(above, axis.duration, 0.0)))
        if len(self.powers) != 2 or isnan(common_period([axis.total for axis in self.powers])):
            return min(runs)
        return min(*runs, longest_run_of_two([(axis.duration, axis.most) for axis in self.powers], limit))


def bus_power(power: float, feed: Feed) -> float:
    """Power at the bus for one out of its source: without what the source's resistance turns to heat."""
    most = feed.voltage**2 / (2.0 * feed.resistance) if feed.resistance else inf  # no source gives more to its bus
    limit = min(power, most)
    return float(limit - feed.resistance * (limit / feed.voltage) ** 2)


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


# -- The cycle of a machine whose axes start together, and the axes that wait at rest until it is over.


_NO_TIME = 1e-9  # of the cycle
_STILL = 1e-9  # of the largest speed
Motions = dict[str, tuple[float, bool]]  # by load case: period [s], and whether it is at rest at both ends of it
Cycles = Mapping[str, Mapping[str, float | None]]  # s, by axis and load case: until when it waits, if it does
# by axis and load case, s: until when it waits; None where it does not


class Moving(NamedTuple):
    """The motion of an axis in a load case."""

    name: str
    start: float  # s, in the machine's cycle
    period: float  # s
    waits: bool  # for the others, when it is done


def cycle_of(axes: Sequence[Moving], cycle_time: float | None) -> float:
    """Length of the machine's cycle: as given, or until the last axis that waits for the others is done."""
    ones = [axis for axis in axes if axis.waits]
    if not ones:
        return max(axis.period for axis in axes)
    if cycle_time is None:
        return max(axis.start + axis.period for axis in ones)
    late = next((axis for axis in ones if axis.period > cycle_time * (1.0 + _NO_TIME)), None)
    if late is not None:
        duration, cycle = (show(value, "s", "time") for value in (late.period, cycle_time))
        raise FieldError(
            ("cycle_time",), f"axis {quoted(late.name)} moves for {duration}; expected no less, not {cycle}"
        )
    return cycle_time


def waiting_times(machine: MachineSpec, spec_of: Callable[[str], RobotSpec]) -> Cycles:
    """Until when each axis waits at rest: for the others, or for the machine's ``cycle_time``."""
    if not machine.synchronised:
        return {}
    motions = {axis.name: _motions(spec_of(axis.name)) for axis in machine.axes if not axis.own_supply}

    def moving(name: str, period: float, at_rest: bool) -> Moving:
        axis = machine.axis(name)
        return Moving(name, axis.start, period, at_rest if axis.repeats is None else not axis.repeats)

    def cycle_in(case: str) -> float:
        """The machine's cycle in a load case [s]; an axis without that case has its first."""
        moves = []
        for name, own in motions.items():
            period, at_rest = own.get(case) or own.get(AS_SPECIFIED) or next(iter(own.values()))
            moves.append(moving(name, period, at_rest))
            if moves[-1].waits and not at_rest:
                where = machine.where(("axes", name, "repeats"))
                raise InputError(f"{where}: its motion is not at rest at both ends; expected true, or a motion that is")
        try:
            return cycle_of(moves, machine.cycle_time)
        except FieldError as error:
            raise InputError(f"{machine.where(error.field)}: {error}") from None

    more = list(dict.fromkeys(name for own in motions.values() for name in own if name))
    cycles = {case: cycle_in(case) for case in more or [""]} if motions else {}
    waiting: dict[str, dict[str, float | None]] = {name: {} for name in motions}
    for name, own in motions.items():
        for case, motion in own.items():
            cycle, move = cycles[case or next(iter(cycles))], moving(name, *motion)
            waiting[name][case] = cycle if move.waits and rest_left(move.period, cycle) else None
    return waiting


def _rests(first: float, last: float, fastest: float) -> bool:
    """Whether a motion is at rest at both ends."""
    return max(abs(first), abs(last)) <= _STILL * fastest


def _motions(spec: RobotSpec) -> Motions:
    """The motion of an axis in its load cases."""
    names = [name for name, _ in spec.load_cases]
    motions: Motions = {}
    for number, _, case in load_cases(spec):
        motion = motion_of(case)
        still = _rests(motion.speed[0], motion.speed[-1], motion.top_speed)
        _, before = motions.get(names[number], (0.0, True))
        motions[names[number]] = motion.duration, still and before
    return motions


# -- An axis that waits at rest, its motion done, until the machine's cycle is over, as its power on the bus.
#
# Axes are sized with that rest; on the bus it is what the cycle of all leaves, which over tolerances is another one.


def moving_alone(problem: Problem) -> Problem:
    """An axis without the rest in which it waits."""
    if all(case.spec.waits_until is None for case in problem.cases):
        return problem
    quickest = quickest_winding(problem.catalog)
    cases = tuple(load_case(case.name, case.number, case.spec.waiting({}), quickest) for case in problem.cases)
    return replace(problem, machine=problem.machine.waiting({}), cases=cases)


def waiting(case: LoadCase, until: float) -> CycleAtBelt:
    """The load cycle of an axis with a rest at its end."""
    if not rest_left(case.cycle.total, until):
        return case.at_belt
    cycle = load_cycle(case.spec.waiting(dict.fromkeys([name for name, _ in case.spec.load_cases], until)))
    torque = static_torque(cycle)
    cycle = with_rest(cycle, until, 0.0 if isnan(torque) else torque)
    return CycleAtBelt(cycle, case.spec.belt_efficiency, case.at_belt.quickest)


def unknown_at_rest(cases: Sequence[LoadCase]) -> str:
    """Reason for which the power at rest is unknown; empty where it is not."""
    lacking = any(isnan(static_torque(case.cycle)) for case in cases)
    return "what holds it at rest is unknown: end its motion with a rest" if lacking else ""


# -- Axes of a machine on one bus in one of its load cases: their courses over the same time, and the sum.
#
# Axes that start together are one course over the machine's cycle, each at its offset; one that rests at both ends
# of its motion waits where that ends, and any other goes on repeating. Others run at any phase: those of independent
# machines, and those whose periods have no multiple in common.


_LONGEST_PERIODS = 20  # of the longest period, where there is no common one
_MOST_IN_PERIOD = 1_000_000  # pieces


class AxisPower(NamedTuple):
    """An axis on the supply."""

    name: str
    problem: Problem
    drive: DriveParts
    start: float = 0.0  # s, of its motion in the machine's cycle
    repeats: bool | None = None  # goes on repeating; where not said, if it is not at rest at both ends of its motion

    def case(self, name: str) -> list[LoadCase]:
        """Its drives in the load case of a name; in the first one where none of that name is sized by itself."""
        numbers = {own: number for number, (own, _) in enumerate(self.problem.machine.load_cases)}
        cases, number = self.problem.cases, numbers.get(name, 0)
        return [case for case in cases if case.number == number] or [case for case in cases if case.number == 0]

    def waits(self, cases: Sequence[LoadCase]) -> bool:
        """Whether it waits for the others when it is done."""
        if self.repeats is not None:
            return not self.repeats
        speeds = [case.cycle.speed for case in cases]  # unless it moves at an end of its motion
        return all(_rests(float(v[0, 0]), float(v[-1, 1]), float(np.abs(v).max())) for v in speeds)


class CommonBus(NamedTuple):
    """All axes in one load case."""

    spec: RobotSpec
    feed: Feed
    axes: list[AxisOnBus]  # over the same time
    total: DrivePower  # as the sum is judged
    on_bus: Regenerated
    together: tuple[DrivePower, ...]  # those that run at any phase to one another, each over its own period
    cycle: float  # s, of the machine; of axes at random phases the longest
    phases: tuple[float, ...]
    synchronised: bool  # whether the axes start together, as far as their periods let them
    exceeded: tuple[Exceeded, ...]  # limits of the supply, at random phases

    @property
    def powers(self) -> list[DrivePower]:
        """Power of each axis over that time."""
        return [axis.power for axis in self.axes]

    @property
    def exchanged(self) -> float:
        """Energy that one axis regenerates and another draws, at random phases none that is certain [J]."""
        apart = fsum(float(power.returned @ power.duration) for power in self.powers)
        return max(apart - float(self.total.returned @ self.total.duration), 0.0)


def common_bus(
    name: str, shared: RobotSpec, axes: Sequence[AxisPower], synchronised: bool, cycle_time: float | None
) -> CommonBus:
    """All axes of a machine on its bus in a load case."""
    feed = shared.feed_of(None)._replace(drives=1)
    cases = [axis.case(name) for axis in axes]
    waits = [synchronised and axis.waits(own) for axis, own in zip(axes, cases, strict=True)]
    rows = zip(axes, cases, waits, strict=True)
    moving = [Moving(axis.name, axis.start, own[0].cycle.total, rests) for axis, own, rests in rows]
    cycle = cycle_of(moving, cycle_time)
    alone = len(axes) == 1
    powers = [_axis_power(shared, *row, cycle, alone=alone) for row in zip(axes, cases, waits, strict=True)]
    window = common_period([power.total for power in powers], [len(power.duration) for power in powers])
    if synchronised and not isnan(window) and not alone:
        powers = [from_start(fitted(p, window), axis.start) for axis, p in zip(axes, powers, strict=True)]

    def named(powers: Sequence[DrivePower]) -> list[AxisOnBus]:
        rows = zip(axes, cases, powers, strict=True)
        return [AxisOnBus(axis.name, own[0].spec, axis.drive, power) for axis, own, power in rows]

    if alone or (synchronised and not isnan(window)):
        total = exchanged(powers, feed)
        on_bus = Regenerated(name, shared, total)
        return CommonBus(shared, feed, named(powers), total, on_bus, (total,), cycle, (), synchronised, ())
    side_by_side = [k for k, rests in enumerate(waits) if rests]  # the others run each at any phase
    for k in side_by_side:
        powers[k] = from_start(powers[k], axes[k].start)
    groups = ([side_by_side] if side_by_side else []) + [[k] for k, rests in enumerate(waits) if not rests]
    apart = tuple(exchanged([powers[k] for k in group], feed) for group in groups)
    window = _shown_time(powers) if isnan(window) else window
    phases = {k: worst_start(fitted(whole, window)) for group, whole in zip(groups, apart, strict=True) for k in group}
    in_phase = [from_start(fitted(power, window), phases[k]) for k, power in enumerate(powers)]
    aligned = [from_start(fitted(p, window), phases[group[0]]) for group, p in zip(groups, apart, strict=True)]
    starts = tuple(phases[k] % power.total for k, power in enumerate(powers))
    total, exceeded = summed_up(aligned, feed), _exceeded(shared, apart, feed)
    at_any = AtAnyPhase(name, shared, total, tuple(Regenerated(name, shared, power) for power in apart), feed)
    return CommonBus(shared, feed, named(in_phase), total, at_any, apart, cycle, starts, synchronised, exceeded)


def _shown_time(powers: Sequence[DrivePower]) -> float:
    """Time over which courses without a common period are shown [s]: some of the longest, as pieces allow."""
    longest = max(power.total for power in powers)
    pieces = sum(len(power.duration) * longest / power.total for power in powers)
    if pieces > _MOST_IN_PERIOD:
        shortest = min(power.total for power in powers)
        raise FieldError(
            ("axes",),
            f"cycles of the axes last from {shortest:.4g} s to {longest:.4g} s, too far apart to be taken together; "
            "expected e.g. shorter motions of the slow axis",
        )
    return longest * max(1, min(_LONGEST_PERIODS, int(MOST_PIECES / pieces)))


def _axis_power(
    shared: RobotSpec, axis: AxisPower, cases: Sequence[LoadCase], waits: bool, cycle: float, *, alone: bool
) -> DrivePower:
    """Power of all drives of an axis over its own period, or waiting until the machine's cycle is over.

    Wheels that slip draw more of a battery. Alone on a bus, what one wheel draws of another's return goes no further,
    and over a long cycle each moment counts where the supply's peak current is limited.
    """
    supply, reuse = shared.supply, 1.0 - shared.supply.regeneration
    cycles = [waiting(case, cycle) if waits else case.at_belt for case in cases]
    timed = supply.peak_current is not None and supply.current is not None
    merged = alone and len(cases) == 1 and not timed and shared.battery is None
    power = power_of_cases(cases, axis.drive, cycles, merged=merged)
    if shared.battery is not None:
        power = power.slipping(cases[0].spec.slip)
    elif alone and len(cases) > 1:
        net: Array = power.bus_drawn - reuse * power.returned
        power = power._replace(bus_drawn=np.maximum(net, 0.0), returned=np.maximum(-net, 0.0) / (reuse or 1.0))
    return power.times(nan) if waits and cycle > cases[0].cycle.total and unknown_at_rest(cases) else power


def _exceeded(shared: RobotSpec, apart: Sequence[DrivePower], feed: Feed) -> tuple[Exceeded, ...]:
    """Share of the time in which random phases exceed a limit of the supply."""
    supply = shared.supply
    limits = [
        ("supply_continuous_current", None if supply.peak_current is None else supply.current, supply.lowest),
        ("supply_current", supply.most_current, supply.lowest),
        ("supply_power", supply.power, 1.0),
    ]
    exceeded = []
    for name, limit, scale in limits:
        if limit is None:
            continue
        power = bus_power(limit * scale, feed)
        least, most = (
            share_above([(group.duration, getattr(group, end)) for group in apart], power, up=up)
            for end, up in (("least", False), ("most", True))
        )
        exceeded.append(Exceeded(name, limit * scale, least, most))
    return tuple(exceeded)
