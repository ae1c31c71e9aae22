"""The load cycle, the waist of the program: speed, acceleration and torque of a driven shaft; its figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.physics.figures import Alike, Array, Mask, Whole

# -- The load cycle: speed, acceleration and torque of the shaft that one drive turns, whatever the machine.
#
# Segments over time, each with its values at the left and the right end and straight lines between. Segments, not
# points: at the corner of a trapezoid the torque jumps, and a point has one value only. Every machine is reduced to
# this (``loads``), and whatever follows knows nothing else.
# Several cycles lie side by side along a last axis, those of samples: what all of them share has a length of 1 there.
# Symbols: w speed [rad/s], a acceleration [rad/s^2], T torque that the load takes, its own inertia included [N*m].


Ends = Array  # at the left and the right end: (segments, 2); of several cycles (segments, 2, cycles)


_NO_PART = 1e-250  # of a segment: a smaller one would have no duration in floating point
_LARGEST = 1e60  # of any figure: products of a few of them can still be computed with


class OwnLimit(NamedTuple):
    """A limit of the load itself, whatever drives it, such as the grip of a wheel."""

    name: str
    demand: Alike  # SI; NaN unknown
    limit: Alike
    time: Alike = nan  # s, of the worst moment


@dataclass(frozen=True, slots=True)
class LoadCycle:
    """Speed, acceleration and torque of the driven shaft over one cycle, or several side by side."""

    name: str
    duration: Array  # s, of each segment; 0 where another of several cycles has a segment more
    speed: Ends  # rad/s
    acceleration: Ends  # rad/s^2
    torque: Ends  # N*m, the load's own inertia included
    inertia: Alike = nan  # kg*m^2, of all that moves with the shaft, seen at it
    own: tuple[OwnLimit, ...] = ()
    radius: Alike = 1.0  # m, travel of the load per angle of the shaft; 1 where it turns with the shaft
    holding_torque: Alike = nan  # N*m, largest torque that holds it at rest on its path; NaN not looked at

    def __post_init__(self) -> None:
        shape, alone = (len(self.duration), 2), self.duration.ndim == 1
        columns = (self.speed, self.acceleration, self.torque)
        if not len(self.duration) or any(c.shape[:2] != shape or (c.ndim == 2) != alone for c in columns):
            raise InputError(f"load cycle {self.name}: expected segments with two ends each")
        if not ((self.duration > 0.0) if alone else (self.duration >= 0.0)).all():  # written so that NaN fails too
            raise InputError(f"load cycle {self.name}: a segment must last longer than 0 s")
        if not all(_within(c) for c in (self.duration, *columns)):
            raise InputError(f"load cycle {self.name}: a figure leaves the range of numbers that can be computed with")

    @classmethod
    def from_arrays(
        cls, time: Any, speed: Any, torque: Any, *, inertia: float = nan, name: str = "arrays"
    ) -> LoadCycle:
        """A load cycle of samples, with straight lines between them.

        Parameters
        ----------
        time
            Of the samples, rising [s].
        speed
            Of the driven shaft [rad/s].
        torque
            That the load takes at it, its own inertia included [N*m].
        inertia
            Of all that moves with the shaft, as far as it is known [kg*m^2].
        name
            In messages.

        Returns
        -------
        LoadCycle
            A segment between each two samples, cut where speed or torque changes its sign.

        Raises
        ------
        InputError
            When the arrays do not go together, or a time does not rise.

        Examples
        --------
        >>> LoadCycle.from_arrays([0, 1, 3], [0, 10, 10], [2, 2, 1]).total
        3.0
        """
        columns = [np.asarray(column, float) for column in (time, speed, torque)]
        if any(column.ndim != 1 or column.shape != columns[0].shape or len(column) < 2 for column in columns):
            raise InputError(f"load cycle {name}: expected time, speed and torque of as many samples each, two or more")
        duration = np.diff(columns[0])
        speeds, torques = (np.stack([column[:-1], column[1:]], axis=1) for column in columns[1:])
        with np.errstate(all="ignore"):  # a time that does not rise is refused
            slope = np.repeat(np.diff(speeds, axis=1) / duration[:, None], 2, axis=1)
        return cls(name, duration, speeds, slope, torques, inertia).split()

    @property
    def total(self) -> Alike:
        """Length of the cycle [s]."""
        return float(self.duration.sum()) if self.duration.ndim == 1 else self.duration.sum(axis=0)

    @property
    def samples(self) -> int:
        """Number of cycles side by side; 1 of one, and where all are the same."""
        single = (
            self.inertia,
            self.radius,
            self.holding_torque,
            *(x for limit in self.own for x in (limit.demand, limit.limit)),
        )
        wide = [
            c.shape[-1] for c in (self.duration, self.speed, self.acceleration, self.torque) if self.duration.ndim > 1
        ]
        return int(max([1, *wide, *map(np.size, single)]))

    def on(self, rows: Any) -> LoadCycle:
        """Some of several cycles side by side."""

        def at_rows(column: Any) -> Any:
            return column[..., rows] if np.ndim(column) and column.shape[-1] > 1 else column

        own = tuple(
            limit._replace(demand=at_rows(limit.demand), limit=at_rows(limit.limit), time=at_rows(limit.time))
            for limit in self.own
        )
        names = (*CYCLE_COLUMNS, "inertia", "radius", "holding_torque")
        return replace(self, own=own, **{name: at_rows(getattr(self, name)) for name in names})

    def side_by_side(self) -> LoadCycle:
        """One cycle as one of several."""
        return replace(self, duration=self.duration[:, None], **{n: getattr(self, n)[..., None] for n in _COLUMNS})

    @property
    def time(self) -> Ends:
        """Time at both ends of each segment, from the start of the cycle [s]."""
        return end_times(self.duration)

    @property
    def direction(self) -> Ends:
        """Sign of the speed within each segment, 0 at rest: shape (segments, 1, ...)."""
        return np.sign(self.speed.mean(axis=1, keepdims=True))

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
            ends = getattr(cycle, name)
            if (ends[:, 0] * ends[:, 1] < 0.0).any():
                pieces, shares, column = cut_points(ends, cycle.speed)
                cut, lines = cuts(pieces, shares), {n: getattr(cycle, n) for n in _COLUMNS} | {name: column}
                columns: dict[str, Any] = {n: cut.line(line, crosses=n == name) for n, line in lines.items()}
                cycle = replace(cycle, duration=cycle.duration[cut.owner] * (cut.end - cut.start), **columns)
        return cycle


def _within(column: Array) -> bool:
    """Whether all figures can be computed with; without an array of their amounts, for a long cycle's takes room."""
    return float(column.max()) < _LARGEST and float(column.min()) > -_LARGEST


_COLUMNS = ("speed", "acceleration", "torque")
CYCLE_COLUMNS = ("duration", *_COLUMNS)


def cut_points(column: Ends, speed: Ends) -> tuple[Whole, Array, Ends]:
    """Places where a quantity changes sign within segments.

    Of several cycles a segment is cut where any of them has it cut; one whose quantity keeps its sign at the end at
    which it is faster, so that its piece of no duration moves as the segment does.

    Parameters
    ----------
    column, speed
        The quantity, and the speed, at both ends of each segment, shape (segments, 2) or (segments, 2, cycles).

    Returns
    -------
    tuple
        Number of pieces of each segment (1 or 2); the share of it before the change [1] (1 without one); and the
        column, with an end that is beyond its change of sign by less than rounding set to 0.
    """
    left, right = column[:, 0], column[:, 1]
    crosses = left * right < 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(crosses, left / (left - right), 0.5)
    column = np.where(np.stack([crosses & (share <= _NO_PART), crosses & (share >= 1.0)], axis=1), 0.0, column)
    crosses &= (share > _NO_PART) & (share < 1.0)
    if column.ndim == 2:
        return np.where(crosses, 2, 1), np.where(crosses, share, 1.0), column
    cut: Mask = np.any(crosses, axis=1)
    at_the_start = cut[:, None] & (np.abs(speed[:, 0]) > np.abs(speed[:, 1]))
    return np.where(cut, 2, 1), np.where(crosses, share, np.where(at_the_start, 0.0, 1.0)), column


class Cuts(NamedTuple):
    """Pieces of segments: the segment of each, and from which share of it to which it goes."""

    owner: Whole
    start: Array  # shape (pieces,) or (pieces, cycles)
    end: Array

    def travel(self, duration: Array, speed: Ends) -> Ends:
        """Way along straight lines of speed at both ends of the pieces, from the start of their segment."""
        first, share = speed[self.owner, :1], np.stack([self.start, self.end], axis=1)
        return duration[self.owner, None] * (first * share + (speed[self.owner, 1:] - first) * share**2 / 2)

    def line(self, ends: Ends, *, crosses: bool = False) -> Ends:
        """A straight line over segments at both ends of their pieces; ``crosses``: it is 0 where it is cut."""
        left, right = ends[self.owner, 0], ends[self.owner, 1]
        at = [
            np.where(x <= 0.0, left, np.where(x >= 1.0, right, 0.0 if crosses else left + x * (right - left)))
            for x in (self.start, self.end)
        ]
        return np.stack(at, axis=1)


def cuts(pieces: Whole, shares: Array) -> Cuts:
    """Each segment in so many pieces that all take the same share of it, but for the last, which takes the rest.

    Parameters
    ----------
    pieces
        Of each segment, 1 or more.
    shares
        Of each segment that one piece takes [1], shape (segments,) or (segments, cycles).

    Returns
    -------
    Cuts
        All pieces in their order.
    """
    owner, place = places(pieces)
    number, last = (x.reshape(-1, *[1] * (shares.ndim - 1)) for x in (place, place + 1 == pieces[owner]))
    return Cuts(owner, number * shares[owner], np.where(last, 1.0, (number + 1) * shares[owner]))


def places(count: Whole) -> tuple[Whole, Whole]:
    """The segment of each piece, and the piece's number within it, of so many pieces a segment.

    >>> [x.tolist() for x in places(np.array([2, 3]))]
    [[0, 0, 1, 1, 1], [0, 1, 0, 1, 2]]
    """
    owner = np.repeat(np.arange(len(count)), count)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)


def end_times(duration: Array) -> Ends:
    """Time at both ends of each segment, from the start of the cycle [s]: shape (segments, 2, ...)."""
    end = np.cumsum(duration, axis=0)
    return np.stack([end - duration, end], axis=1)


def middle(ends: Ends) -> Array:
    """Mean of a quantity over each segment, in its own unit: shape (segments, ...); quicker than a mean of any number.

    >>> middle(np.array([[1.0, 3.0], [2.0, 2.0]])).tolist()
    [2.0, 2.0]
    """
    return (ends[:, 0] + ends[:, 1]) / 2


def integral(duration: Array, a: Ends, b: Ends) -> Alike:
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


def mean_product(a: Ends, b: Ends) -> Array:
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
    return (2 * a_0 * b_0 + a_0 * b_1 + a_1 * b_0 + 2 * a_1 * b_1) / 6


def rms(duration: Array, a: Ends) -> Alike:
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
    root = np.sqrt(integral(duration, a, a) / np.where(total > 0.0, total, 1.0))
    return float(root) if duration.ndim == 1 else root


# -- The speed of a cycle that a gearhead's continuous input speed limits.
#
# A gearhead may be driven faster than its continuous input speed for a while. How long is the maker's rule:
#
# - maxon limits the input speed for continuous and for intermittent operation apart, out of concern for life and
# warmth (maxon programme 2024/25, terminology of gears, pages 372 and 454, online.flippingbook.com/view/623537/454).
# That intermittent is at most 1 s uninterrupted and 10 % of the time is *assumed*: the footnote was not available. -
# Makers of servo gearboxes limit the mean: Wittenstein alpha's n1N is the mean input speed (Beckhoff Information
# System, AG3210, infosys.beckhoff.com/content/1033/ag3210_ba/6298081419.html), Harmonic Drive's the average over the
# cycle (manual 1021387, 12/2018, glossary, manualshive.com/ru/manual/harmonic-drive/shg-series/3993247?page=61),
# Apex Dynamics' that of continuous operation S1, beside n1B of cyclic operation S5 (glossary of its catalogue,
# wmhapexcatalogues.co.uk/book-1/inc/html/79.html). More than 20 min uninterrupted is S1 (planetary gearboxes RG,
# interactivepdf.uniflip.com/2/69963/302245/pub/html/7.html). - Of other makers no rule is known: maxon's is
# *assumed*, the stricter one.
#
# ``results.ratings`` has the makers by name. With any of them the mean while running must not exceed the limit. All
# is exact for speeds that are straight lines, and the cycle repeats: a run over its end continues at its start.


_SHORT_OVERLOAD = (1.0, 0.1)  # s uninterrupted, share of the time: so long maxon's limit may be exceeded
_LONG = (1200.0, 1.0)  # and those of the mean
_ROUNDING = 1e-9  # of a time: by so much sums of times may be off


def lasting_speeds(duration: Array, speed: Array) -> dict[str, Array]:
    """The two speeds that makers limit [rad/s]: the mean while running, and what is exceeded for longer than shortly.

    Parameters
    ----------
    duration, speed
        As :func:`mean_running` takes them.

    Returns
    -------
    dict
        ``mean_speed``: the mean while running, or what is exceeded for 20 min uninterrupted where that is more;
        ``sustained_speed``: what is exceeded for more than 1 s uninterrupted or 10 % of the time, or the mean.
    """
    mean = mean_running(duration, speed)
    long, short = (exceeded(duration, speed, permitted) for permitted in (_LONG, _SHORT_OVERLOAD))
    return {"mean_speed": np.maximum(mean, long), "sustained_speed": np.maximum(mean, short)}


def mean_running(duration: Array, speed: Array) -> Array:
    """Mean of the speed while it is not 0; of one cycle, or of several as columns.

    Parameters
    ----------
    duration
        Of each segment [s]: (segments,) or (segments, cycles).
    speed
        At both ends of each segment, without change of sign within [rad/s]: (segments, 2), or with cycles behind.

    Returns
    -------
    float or array
        Mean speed [rad/s]; 0 of a cycle at rest.
    """
    running = np.where((speed != 0.0).any(axis=1), duration, 0.0)
    total = running.sum(axis=0)
    return (running * np.abs(speed).mean(axis=1)).sum(axis=0) / np.where(total > 0.0, total, 1.0)


def exceeded(duration: Array, speed: Array, permitted: tuple[float, float]) -> Array:
    """The highest speed that is exceeded for longer than permitted [rad/s]: below it the limit must not lie.

    Parameters
    ----------
    duration, speed
        As :func:`mean_running` takes them.
    permitted
        Uninterrupted time [s], and share of the cycle [1].

    Returns
    -------
    array
        Speed [rad/s], of each cycle.

    Examples
    --------
    Up to 10 rad/s and down again in 20 s: above 9 rad/s for 2 s in all, above 9.5 rad/s for 1 s uninterrupted.

    >>> exceeded(np.array([10.0, 10.0]), np.array([[0.0, 10.0], [10.0, 0.0]]), (1.0, 0.1)).round(6).item()
    9.5
    """
    shape = np.broadcast_shapes(duration.shape[1:], speed.shape[2:])
    count = int(np.prod(shape))
    time = np.broadcast_to(duration.reshape(len(duration), -1), (len(duration), count))
    ends = np.broadcast_to(np.abs(speed).reshape(len(speed), 2, -1), (len(speed), 2, count))
    slowest, total = ends.min(axis=(0, 1)), time.sum(axis=0)
    if permitted[1] >= 1.0 and (total <= permitted[0]).all():  # exceeded always or not long enough
        return slowest.reshape(shape)
    longest_run, in_all = permitted[0] * (1.0 + _ROUNDING), permitted[1] * total * (1.0 + _ROUNDING)
    time, ends = _from_the_slowest(time, ends)
    levels = np.sort(np.concatenate([np.zeros((1, count)), ends[:, 0], ends[:, 1]]), axis=0)
    known, beyond = np.full(count, -1), np.full(count, len(levels) - 1)  # of levels: too long exceeded, and not
    while (beyond - known > 1).any():
        middle = (known + beyond) // 2
        runs, sums = next(_times(time, ends, levels, middle))
        too_long = (runs.max(axis=0) > longest_run) | (sums[0] > in_all)
        known, beyond = np.where(too_long, middle, known), np.where(too_long, beyond, middle)
    place = np.maximum(known, 0)
    (runs, sums), (runs_then, sums_then) = _times(time, ends, levels, place)
    share = np.maximum(_share(runs, runs_then, np.float64(longest_run)), _share(sums, sums_then, in_all))
    low, high = (levels[place + step, np.arange(count)] for step in (0, 1))
    return np.maximum(np.where(known < 0, 0.0, low + share * (high - low)), slowest).reshape(shape)


def _from_the_slowest(time: Array, ends: Array) -> tuple[Array, Array]:
    """The same cycles from where they are slowest, so that no run above that goes over their end."""
    flat = ends.reshape(-1, ends.shape[-1]).argmin(axis=0)
    rows = (np.arange(len(time))[:, None] + (flat + 1) // 2) % len(time)
    return np.take_along_axis(time, rows, axis=0), np.take_along_axis(ends, rows[:, None, :], axis=0)


def _times(time: Array, ends: Array, levels: Array, place: Whole) -> Iterator[tuple[Array, Array]]:
    """Times above a level and above the next one: uninterrupted up to the end of each segment, and in all.

    Between two neighbours of all speeds at ends of segments, times above a speed are straight lines over it.
    """
    low, high = (levels[place + step, np.arange(levels.shape[1])] for step in (0, 1))
    above = ends > (low + high) / 2
    whole = above.all(axis=1)
    part = above.any(axis=1) & ~whole
    slope = np.where(part, time, 0.0) / np.where(part, np.abs(ends[:, 0] - ends[:, 1]), 1.0)
    joined = above[1:, 0] & above[:-1, 1]  # to the segment before
    most, certain = ends.max(axis=1), np.where(whole, time, 0.0)
    for v in (low, high):
        time_above = certain + slope * (most - v)
        end = np.cumsum(time_above, axis=0)
        starts = np.concatenate([np.zeros((1, end.shape[1])), np.where(joined, 0.0, end[:-1])])
        yield end - np.maximum.accumulate(starts, axis=0), end[-1:]


def _share(first: Array, last: Array, permitted: Array | np.float64) -> Array:
    """Share of the step from one level to the next with times longer than permitted; 0 where they never are."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(last >= permitted, 1.0, (first - permitted) / (first - last))
    return np.where(first > permitted, share, 0.0).max(axis=0)
