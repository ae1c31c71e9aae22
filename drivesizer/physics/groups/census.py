"""Kinds of segments of a long load cycle, found in one look: their sums and their extreme points."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import drivesizer.physics.groups.layout as at
from drivesizer.physics.groups.kernel import compiled

__all__ = ["LEVEL", "SHORT", "Census", "Group", "census", "columns_of", "times_above"]

Array = NDArray[np.float64]
SHORT = 1 << 15  # segments up to which a cycle is looked at as a whole
LEVEL = 1e-9  # of the largest acceleration: less is what rounding leaves of a steady speed
_ROOM = 1 << 16  # points of a group that none exceeds; what is unused takes no memory
_PAIRS = np.triu_indices(4)
_OF_TORQUE, _BESIDE = 0, (at.ACCELERATION, at.DIRECTION, at.SPEED)


class Group(NamedTuple):
    """Segments of one direction of power and one kind of motion."""

    torque: int  # which of the first three functions
    motion: int  # 0 at rest; 1 braking, 2 steady, 3 gaining speed, and 4 to 6 backward
    sums: Array  # as in ``layout``
    fronts: tuple[Array, Array, Array, Array]  # highest ends, lowest, bounds of segments above and below: (points, 4)

    @property
    def way(self) -> float:
        """Direction of the motion."""
        return float(np.sign(self.motion) - 2 * (self.motion > 3))

    def functions(self, front: int, factor: float) -> Array:
        """The six functions at the points of a front, torques times a factor: (points, 6)."""
        points = self.fronts[front] * ((1.0, -1.0)[front % 2])
        found = np.zeros((len(points), 6))
        found[:, self.torque], found[:, at.ACCELERATION], found[:, at.SPEED] = factor * points[:, 0], *points.T[1:3]
        found[:, at.DIRECTION] = self.way
        return found

    def moments(self, factor: float) -> Array:
        """Integrals of products of the six functions, torques times a factor: (6, 6)."""
        own = np.zeros((4, 4))
        own[_PAIRS] = self.sums[at.PRODUCTS : at.PRODUCTS + len(_PAIRS[0])]
        own = own + np.triu(own, 1).T
        own[0] *= factor
        own[:, 0] *= factor
        found = np.zeros((6, 6))
        places = [self.torque, *_BESIDE]
        found[np.ix_(places, places)] = own
        return found


class Single(NamedTuple):
    """Single figures of the torque behind a belt, while running; of a cycle that never runs over all of it."""

    rms_torque: float  # N*m
    peak_torque: float  # N*m
    at_rest: float  # N*m, largest; NaN where it never rests
    mean_power: float  # W
    peak_power: float  # W


class Census(NamedTuple):
    """A long load cycle by its groups."""

    groups: list[Group]
    runs: int  # stretches of one kind of motion
    times: Array  # s, of the points at the ends of segments, by ``places``
    places: Array  # numbers of these ends, rising

    def starts(self, motion: int) -> list[float]:
        """Times at which each group of a kind of motion is first met [s]."""
        return [float(group.sums[at.STARTS]) for group in self.groups if group.motion == motion]

    def of(self, name: int) -> Array:
        """A sum or largest amount of each group."""
        found: Array = np.array([group.sums[name] for group in self.groups])
        return found

    def acts(self) -> NDArray[np.bool_]:
        """Mask of the six functions that are ever not 0."""
        torque = [any(g.torque == k and g.sums[at.MOST_LOAD] > 0.0 for g in self.groups) for k in range(3)]
        turns = any(g.motion for g in self.groups)
        return np.array([*torque, self.of(at.MOST_A).max() > 0.0, turns, self.of(at.MOST_W).max() > 0.0])

    def moments(self, factors: Array) -> Array:
        """Integrals of products of the six functions over the cycle: (6, 6)."""
        found: Array = np.sum([group.moments(factors[group.torque]) for group in self.groups], axis=0)
        return found

    def braked(self, factors: Array) -> Array:
        """Work of each function against the motion [J]: (6,)."""
        found, work = np.zeros(6), self.moments(factors)[: at.AT_REST + 1, at.SPEED]
        found[: at.AT_REST + 1] = np.maximum(-work, 0.0)  # a torque of one kind has one direction of power
        found[at.ACCELERATION] = self.of(at.BRAKED_A).sum()
        return found

    def mean_running(self) -> float:
        """Mean speed while it is not 0; 0 of a cycle at rest."""
        running = np.array([group.torque != at.AT_REST for group in self.groups])
        total = float(self.of(at.LASTS)[running].sum())
        return float(self.of(at.PRODUCTS + 8)[running].sum()) / total if total > 0.0 else 0.0

    def figures(self, factors: Array) -> Single:
        """Single figures of the torque, by what the belt makes of each kind."""
        kinds = np.array([group.torque for group in self.groups])
        counted = kinds != at.AT_REST
        counted |= ~counted.any()  # a cycle that never runs loads gears at rest
        factor, total = factors[kinds], float(self.of(at.LASTS)[counted].sum())
        square, power = factor**2 * self.of(at.PRODUCTS), factor * np.abs(self.of(at.PRODUCTS + 3))
        rests = self.of(at.MOST_LOAD)[kinds == at.AT_REST]
        return Single(
            rms_torque=float(np.sqrt(square[counted].sum() / total)),
            peak_torque=float((factor * self.of(at.MOST_LOAD)).max()),
            at_rest=float(rests.max()) if len(rests) else np.nan,
            mean_power=float(power[counted].sum() / total),
            peak_power=float((factor * self.of(at.MOST_POWER)).max()),
        )

    def when(self, front: Array) -> Array:
        """Time of the points of a front [s]."""
        found: Array = self.times[np.searchsorted(self.places, front[:, 3])]
        return found

    def points(self, front: int, factors: Array) -> tuple[Array, Array]:
        """The six functions at the points of a front, torques times one factor for each kind, and their times [s]."""
        found = np.concatenate([one.functions(front, factors[one.torque]) for one in self.groups])
        return found, np.concatenate([self.when(one.fronts[front]) for one in self.groups])


def columns_of(cycle: Any) -> tuple[list[Array], NDArray[np.int64]]:
    """Columns of a load cycle (``load_cycle.LoadCycle``) as machine code takes them, and their strides."""
    ends = [_laid_out(column) for column in (cycle.speed, cycle.acceleration, cycle.torque)]
    return [cycle.duration, *(column for column, _ in ends)], np.array([step for _, steps in ends for step in steps])


def _laid_out(ends: Array) -> tuple[Array, list[int]]:
    """Both ends of segments as they lie in memory, and the steps from segment to segment and from end to end.

    Of a recording neighbours may share an end, and an acceleration may be there once: they are not written out.
    """
    steps = [step // ends.itemsize for step in ends.strides]
    if min(steps) < 0 or any(step % ends.itemsize for step in ends.strides):
        return np.ascontiguousarray(ends).reshape(-1), [2, 1]
    count = (len(ends) - 1) * steps[0] + steps[1] + 1
    return np.lib.stride_tricks.as_strided(ends, (count,), (ends.itemsize,)), steps


def census(cycle: Any) -> Census | None:
    """A long load cycle by its groups.

    Parameters
    ----------
    cycle
        At the load, split at changes of direction.

    Returns
    -------
    Census or None
        None of a short one, without machine code, or where too many points are extreme.
    """
    look = compiled() if len(cycle.duration) > SHORT else None
    if look is None:
        return None
    sums, window = np.zeros((at.GROUPS + 1, at.SUMS)), np.empty((4 * at.GROUPS, 4, _ROOM))
    counts = np.zeros(4 * at.GROUPS, np.int64)
    level = LEVEL * max(float(cycle.acceleration.max()), -float(cycle.acceleration.min()))
    highest = np.full((4 * at.GROUPS, at.BINS, at.BINS), -np.inf)
    columns, strides = columns_of(cycle)
    if look(0.0, level, *columns, strides, sums, window, counts, highest, _ranges(cycle)):
        return None
    groups = list(_groups(sums, window, counts))
    places = np.unique(np.concatenate([front[:, 3] for group in groups for front in group.fronts]))
    end = np.cumsum(cycle.duration)
    segment, last = np.divmod(places.astype(np.int64), 2)
    times = np.where(last == 1, end[segment], end[segment] - cycle.duration[segment])
    return Census(groups, int(sums[at.GROUPS, 0]), times, places)


def _ranges(cycle: Any) -> Array:
    """Start and bins per unit of acceleration and of speed, and of both with the other sign."""
    found = []
    for sign in (1.0, -1.0):
        for column in (cycle.acceleration, cycle.speed):
            low, high = sorted((sign * float(column.min()), sign * float(column.max())))
            found += [low, at.BINS / (high - low) if high > low else 0.0]
    return np.array(found)


def _groups(sums: Array, window: Array, counts: NDArray[np.int64]) -> Iterator[Group]:
    """The groups that have segments."""
    for number in np.flatnonzero(sums[: at.GROUPS, at.LASTS] > 0.0).tolist():
        fronts = [window[row, :, : counts[row]].T.copy() for row in range(4 * number, 4 * number + 4)]
        for front in fronts:
            front[:] = front[np.argsort(front[:, 3], kind="stable")]
        torque, motion = divmod(number, at.MOTIONS)
        yield Group(torque, motion, sums[number], (fronts[0], fronts[1], fronts[2], fronts[3]))


def times_above(duration: Array, line: Array) -> Callable[[float], tuple[float, float]]:
    """Times for which the amount of a quantity of a long cycle is above a level, as a function of the level.

    Parameters
    ----------
    duration
        Of each segment [s].
    line
        The quantity at both ends of each, of one sign within it: (segments, 2).

    Returns
    -------
    Callable
        Of a level in the line's unit: the longest time without a break above it, and all such time [s]; the cycle
        repeats: a run over its end continues at its start.
    """
    look = compiled()
    assert look is not None  # where there is a census
    ends, steps = _laid_out(line)
    columns, unused = (duration, ends, ends, ends, np.array(3 * steps)), (np.zeros((1, 1, 1)), np.zeros(8))
    blocks, counts = np.empty((1, -(-len(duration) // at.BLOCK), 4)), np.zeros(1, np.int64)
    look(1.0, 0.0, *columns, np.zeros((1, at.SUMS)), blocks, counts, *unused)

    def above(level: float) -> tuple[float, float]:
        sums = np.zeros((1, at.SUMS))
        look(2.0, level, *columns, sums, blocks, counts, *unused)
        return float(sums[0, at.LONGEST]), float(sums[0, at.IN_ALL])

    return above
