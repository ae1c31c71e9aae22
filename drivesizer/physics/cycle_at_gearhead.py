"""A load cycle at the gearhead's output, behind one belt: exact, integrated once, whatever motor turns it.

For one load cycle and one belt the motor's torque is linear in six functions of time at the gearhead's output:
driving torque, braking torque, torque at rest, acceleration, direction and speed. So mean squares are quadratic forms
in one 6 x 6 matrix of exact segment integrals, and peaks lie at the few ends of segments that ``extremes`` keeps.
Another belt ratio scales the functions, so that nothing is integrated twice.
All of it takes several load cycles too, side by side along a last axis: those of samples.
Symbols: i ratio, e efficiency, T torque [N*m], w speed [rad/s].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.extremes import Extremes, extremes, extremes_of, first_largest
from drivesizer.physics.figures import product
from drivesizer.physics.gear_life import turned_load
from drivesizer.physics.groups import layout as at
from drivesizer.physics.groups.census import Census, census
from drivesizer.physics.load_cycle import (
    Figure,
    Scalars,
    belt_factors,
    directed_torque,
    end_times,
    moments,
    piece_counts,
    scalars,
    scalars_by_census,
    six_functions,
)
from drivesizer.physics.waveform import Wave, energy

__all__ = [
    "ACCELERATION", "AT_REST", "BRAKING", "DIRECTION", "DRIVING", "ROUNDING", "SPEED", "AtGearhead", "CycleAtBelt",
    "Peak", "at_gearhead", "bounded", "lacking",
]  # fmt: skip

_FEW = 16  # points, of which the largest of each is found quicker column by column
ROUNDING = 1e-9  # share of a function's largest value that is 0 but for rounding
_FINEST = 200  # pieces of a segment at most
DRIVING, BRAKING, AT_REST, ACCELERATION, DIRECTION, SPEED = range(6)
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CycleAtBelt:
    """A load cycle, or several, through a belt of ratio 1, its efficiency included."""

    load_cycle: Any  # at the load: a LoadCycle, or several with the same fields as columns
    acts: NDArray[np.bool_]  # which of them are ever not 0
    moments: Array  # means of their products over the cycle: (6, 6) or (6, 6, cycles)
    quickest: float  # s, shortest time constant of the windings
    efficiency: Figure = 1.0  # of the belt, that is in the functions
    census: Census | None = None  # of a long cycle what it is made of
    coarse: dict[tuple[str, float], Any] = field(default_factory=dict)  # what was computed of it, by use and number

    @cached_property
    def time(self) -> Array:
        """Time at both ends of each segment [s]: shape (segments, 2, ...)."""
        return end_times(self.load_cycle.duration)

    @cached_property
    def scalars(self) -> Scalars:
        """Single figures of it, computed on first use; of several cycles columns."""
        if self.census is not None:
            return scalars_by_census(self.load_cycle, self.census, float(self.efficiency), float(self.peak_speed))
        return scalars(self.load_cycle, self.torque, self.efficiency)

    @cached_property
    def peak_speed(self) -> Figure:
        """Highest speed [rad/s]."""
        if self.census is not None:
            return float(self.census.of(at.MOST_W).max())
        found = np.abs(self.load_cycle.speed).max(axis=(0, 1))
        return float(found) if self.load_cycle.speed.ndim == 2 else found

    @cached_property
    def functions(self) -> Array:
        """The six at both ends of each segment: (segments, 2, 6); of several cycles (6, segments, 2, cycles)."""
        return np.stack(
            six_functions(self.load_cycle, self.efficiency), axis=2 if self.load_cycle.torque.ndim == 2 else 0
        )

    @property
    def factors(self) -> Array:
        """Factors by which the belt changes torques that drive, brake and hold [1]."""
        return belt_factors(self.efficiency)

    @cached_property
    def extremes(self) -> Extremes:
        """Of one cycle: the points at which anything linear in the functions is largest or smallest."""
        if self.census is not None:
            high, low, above, below = (self.census.points(front, self.factors) for front in range(4))
            return extremes_of(high, low, above[0], below[0])
        return extremes(self.functions, self.time)

    @cached_property
    def corners(self) -> tuple[Array, Array]:
        """Of one cycle: those points by time, the lower ones with the other sign, and when they are met [s]."""
        met = self.extremes
        time = np.concatenate([met.high_time, met.low_time])
        order = np.argsort(time, kind="stable")
        return np.concatenate([met.high, -met.low])[order], time[order]

    @cached_property
    def braked(self) -> Array:
        """Of one cycle: work of each function against the motion, of torques [J]: shape (6,)."""
        if self.census is not None:
            return self.census.braked(self.factors)
        each = np.moveaxis(self.functions, 2, 0)
        waves = (Wave(self.load_cycle.duration, one[None], each[SPEED, None]) for one in each)  # a long one takes room
        return np.concatenate([energy(one, storing=False).returned for one in waves])

    @cached_property
    def pieces(self) -> int:
        """Of one cycle: the number of pieces of which the quickest winding follows the mean, to 0.1 %."""
        cycle = self.load_cycle
        changing = np.any([x[:, 0] != x[:, 1] for x in (cycle.torque, cycle.acceleration, cycle.speed)], axis=0)
        return int(piece_counts(cycle.duration, np.where(changing, self.quickest, inf), 1e-3).sum())

    @cached_property
    def torque(self) -> Array:
        """Torque at the output, driving, braking and at rest, at both ends of each segment [N*m]."""
        return directed_torque(self.load_cycle, self.efficiency)[0]

    @cached_property
    def speed(self) -> Array:
        """Speed at the output, at both ends of each segment [rad/s]."""
        found: Array = np.broadcast_to(self.load_cycle.speed, self.load_cycle.torque.shape)
        return found

    def turned(self, exponent: float) -> Figure:
        """Mean over the cycle of the torque to an exponent, times speed: ``turned_load`` of it."""
        store, name = self.coarse, ("turned", exponent)
        if name not in store:
            store[name] = turned_load(self.load_cycle.duration, self.torque, self.speed, exponent)
        return store[name]

    def behind(self, ratio: float) -> AtGearhead:
        """The cycle behind a belt of a ratio."""
        return AtGearhead(self, ratio)


class AtGearhead:
    """A load cycle at the gearhead's output, behind one belt."""

    def __init__(self, base: CycleAtBelt, ratio: Figure) -> None:
        self.base, self.belt = base, ratio
        self.scale = np.array([1 / ratio, 1 / ratio, 1 / ratio, ratio, 1.0, ratio])  # of the functions
        by_pairs = np.outer(self.scale, self.scale).reshape(6, 6, *[1] * (base.moments.ndim - 2))
        self.moments = base.moments * by_pairs  # means of products over the cycle

    @cached_property
    def peak_speed(self) -> Any:
        """Highest speed at the output [rad/s]."""
        return self.base.peak_speed * self.belt

    @property
    def load_speed(self) -> Figure:
        """Highest speed at the load [rad/s]."""
        return self.base.peak_speed

    @property
    def load_torque(self) -> Figure:
        """Largest torque at the load [N*m]."""
        return self.base.scalars.load_torque

    @property
    def rms_torque(self) -> Figure:
        """Torque at the output, RMS while running [N*m]."""
        return self.base.scalars.rms_torque / self.belt

    @property
    def peak_torque(self) -> Figure:
        """Largest torque at the output [N*m]."""
        return self.base.scalars.peak_torque / self.belt

    @property
    def held(self) -> Figure:
        """Largest torque at the output that holds the load at rest [N*m]."""
        return self.base.scalars.held / self.belt

    @property
    def mean_speed(self) -> Figure:
        """Mean speed of the output while running, or what it exceeds for long [rad/s]."""
        return self.base.scalars.mean_speed * self.belt

    @property
    def sustained_speed(self) -> Figure:
        """Speed that the output exceeds for longer than shortly [rad/s]."""
        return self.base.scalars.sustained_speed * self.belt

    @property
    def mean_power(self) -> Figure:
        """Power that is transmitted in either direction, mean while running [W]."""
        return self.base.scalars.mean_power

    @property
    def peak_power(self) -> Figure:
        """Largest power that is transmitted [W]."""
        return self.base.scalars.peak_power

    @property
    def load_cycle(self) -> Any:
        """The load cycle at the load."""
        return self.base.load_cycle

    @property
    def extremes(self) -> Extremes:
        """The points of the functions at which anything linear in them is largest or smallest."""
        return self.base.extremes

    @property
    def braked(self) -> Array:
        """Work of each function against the motion over the cycle: shape (6,)."""
        found: Array = self.base.braked * self.scale * self.scale[SPEED]
        return found

    @cached_property
    def functions(self) -> Array:
        """The six functions at both ends of each segment: shape (segments, 2, 6)."""
        return self._scaled(self.base.functions)

    def _scaled(self, functions: Array) -> Array:
        """Functions behind the belt; the same array where it changes nothing, for a long cycle's takes much room."""
        scaled: Array = functions if (self.scale == 1.0).all() else functions * self.scale
        return scaled

    def turned(self, exponent: float) -> Figure:
        """Mean over the cycle of the output torque to an exponent, times speed there."""
        return self.base.turned(exponent) * self.belt ** (1.0 - exponent)

    def on(self, rows: Any) -> AtGearhead:
        """Of some of the candidates, which all are behind this belt (``several_belts`` has those of several)."""
        return self

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient: shape (candidates, 6)."""
        found: Array = c @ self.moments
        return found

    @property
    def acts(self) -> NDArray[np.bool_]:
        """Mask of the functions that are ever not 0."""
        return self.base.acts

    def peak(self, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
        """Largest absolute value over the cycle of what is linear in the functions, with coefficients of 0 or more.

        Parameters
        ----------
        coefficients
            Of the six functions for each candidate; NaN unknown: the peak is then unknown.
        left_out
            Coefficients of which a part is unknown, if any. The peak is then a lower bound: of the moments at
            which more of them makes it no smaller; unknown where there are none.

        Returns
        -------
        Peak
            Of each candidate.
        """
        points, time = self.base.corners
        points = points * self.scale
        values = product(coefficients, points.T)
        if left_out is not None and len(rows := np.flatnonzero(lacking(left_out))):
            against = (points < -ROUNDING * np.abs(points).max(axis=0)).astype(float)
            values[rows] = np.where(left_out[rows] @ against.T > 0.0, -np.inf, values[rows])
        else:
            left_out = None
        value, place = first_largest(np.asfortranarray(values) if len(points) < _FEW else values)
        return bounded(value, time[place], left_out)


class Peak(NamedTuple):
    """The largest absolute value of something over the cycle, and when."""

    value: Array
    time: Array  # s


def at_gearhead(cycle: Any, efficiency: Figure, quickest: float = inf) -> CycleAtBelt:
    r"""A load cycle, or several, through a belt; the direction of power decides on which side its loss is.

    .. math:: T_g = \frac{T}{i e} \; (T w > 0), \quad \frac{T e}{i} \; (T w < 0), \quad \frac{T}{i} \; (w = 0)

    Parameters
    ----------
    cycle
        At the load, split at changes of direction: a ``LoadCycle``, or a record with the same fields as columns, which
        may have segments of no duration.
    efficiency
        Of the belt [1], the same when driven backward; one figure, or one of each cycle. The ratio comes with
        ``behind``.
    quickest
        Shortest time constant of the windings [s].

    Returns
    -------
    CycleAtBelt
        The cycle behind a belt of ratio 1.
    """
    one = cycle.torque.ndim == 2
    if one and (looked := census(cycle)) is not None:
        return _by_census(cycle, looked, efficiency, quickest)
    six = six_functions(cycle, efficiency)
    duration, total = (cycle.duration, cycle.total) if one else (cycle.duration / cycle.total, 1.0)
    acts = np.array([function.any() for function in six])
    found = CycleAtBelt(cycle, acts, moments(duration, total, six, acts), quickest, efficiency)
    found.__dict__["functions"] = np.stack(six, axis=2 if one else 0)  # at hand
    return found


def _by_census(cycle: Any, looked: Census, efficiency: float, quickest: float) -> CycleAtBelt:
    """A long load cycle through a belt, by its groups of segments: nothing is made of each segment."""
    moments = looked.moments(belt_factors(efficiency)) / cycle.total
    return CycleAtBelt(cycle, looked.acts(), moments, quickest, efficiency, looked)


def bounded(value: Array, time: Array, left_out: NDArray[np.bool_] | None) -> Peak:
    """A peak; unknown where something was left out and no moment is a bound.

    Parameters
    ----------
    value
        Largest absolute value of each candidate.
    time
        When it is met [s].
    left_out
        Coefficients of which a part is unknown, shape (candidates, 6).

    Returns
    -------
    Peak
        NaN where it is unknown.
    """
    if left_out is None:
        return Peak(value, time)
    return Peak(np.where(lacking(left_out) & ~(value > 0.0), np.nan, value), time)


def lacking(left_out: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether anything was left out of a candidate's coefficients: of the three that may lack a part."""
    found: NDArray[np.bool_] = left_out[:, ACCELERATION] | left_out[:, DIRECTION] | left_out[:, SPEED]
    return found
