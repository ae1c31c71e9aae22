"""A load cycle at the gearhead's output, behind one belt or the belts of candidates: exact, integrated once.

For one load cycle and one belt the motor's torque is linear in six functions of time at the gearhead's output:
driving torque, braking torque, torque at rest, acceleration, direction and speed. So mean squares are quadratic forms
in one 6 x 6 matrix of exact segment integrals, and peaks lie at the few ends of segments that ``extremes`` keeps.
Another belt ratio scales the functions, so that nothing is integrated twice. The functions of a long cycle are there
part by part, for all of them take much room. Several load cycles go side by side along a last axis: those of samples.
Symbols: i ratio, e efficiency, T torque [N*m], w speed [rad/s].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf
from typing import Any, NamedTuple

import numpy as np

from drivesizer.physics import load_cycle as cycles
from drivesizer.physics.extremes import extremes, first_largest
from drivesizer.physics.figures import Alike, Array, Figure, Mask, product
from drivesizer.physics.gear_life import turned_load

_FEW = 16  # points, of which the largest of each is found quicker column by column
_PART = 1 << 16  # segments of a long cycle whose functions are there at a time
_LOST = (0.0, 0.05, 0.15, 0.35, 0.6)  # of the largest power that is given back
ROUNDING = 1e-9  # share of a function's largest value that is 0 but for rounding
DRIVING, BRAKING, AT_REST, ACCELERATION, DIRECTION, SPEED = range(6)


class Scalars(NamedTuple):
    """Single figures of a load cycle at the gearhead's output; of several cycles columns."""

    rms_torque: Alike  # N*m, while running; of a cycle that never runs over all of it
    peak_torque: Alike  # N*m
    holding_torque: (
        Alike  # N*m, largest that holds the load at rest; of a recording while it rests, NaN where it never does
    )
    load_torque: Alike  # N*m, largest at the load
    mean_speed: Alike  # rad/s, while running; where more, what it exceeds for long
    sustained_speed: Alike  # rad/s, what it exceeds for longer than shortly
    mean_power: Alike  # W, transmitted in either direction while running
    peak_power: Alike  # W
    drawn_power: Alike  # W, largest that drives it while nothing behind slows down: no motor draws less of its supply


# by which power of the belt's ratio each of them grows
_BY_RATIO = dict(zip(Scalars._fields, (-1, -1, -1, 0, 1, 1, 0, 0, 0), strict=True))


@dataclass(frozen=True, eq=False)
class CycleAtBelt:
    r"""A load cycle, or several, through a belt of ratio 1; the direction of power decides on which side its loss is.

    .. math:: T_g = \frac{T}{e} \; (T w > 0), \quad T e \; (T w < 0), \quad T \; (w = 0)
    """

    load_cycle: cycles.LoadCycle  # at the load, split at changes of direction; or several as columns
    efficiency: Alike = 1.0  # of the belt, the same when driven backward; of all cycles, or of each
    quickest: float = inf  # s, shortest time constant of the windings
    coarse: dict[tuple[str, float], Any] = field(default_factory=dict)  # what was computed of it, by use and number

    @cached_property
    def functions(self) -> Array:
        """The six at both ends of each segment: (segments, 2, 6); of several cycles (6, segments, 2, cycles)."""
        return self._functions(slice(None))

    def _functions(self, rows: slice) -> Array:
        """The six of some segments."""
        speed, torque = self.load_cycle.speed[rows], self.torque[rows]
        running = np.any(speed != 0.0, axis=1)[:, None]
        drives = (cycles.middle(self.load_cycle.torque[rows]) * cycles.middle(speed))[:, None] > 0.0
        six = (
            np.where(running & drives, torque, 0.0),
            np.where(running & ~drives, torque, 0.0),
            np.where(running, 0.0, torque),
            *(np.broadcast_to(x, torque.shape)
              for x in (self.load_cycle.acceleration[rows], np.sign(cycles.middle(speed))[:, None], speed)),
        )  # fmt: skip
        return np.stack(six, axis=2 if torque.ndim == 2 else 0)

    @property
    def parts(self) -> Iterator[tuple[slice, Array]]:
        """Of one cycle: so many segments at a time, and their functions."""
        count = len(self.load_cycle.duration)
        if count <= _PART:
            yield slice(0, count), self.functions
            return
        for first in range(0, count, _PART):
            rows = slice(first, min(first + _PART, count))
            yield rows, self._functions(rows)

    @cached_property
    def acts(self) -> Mask:
        """Mask of the functions that are ever not 0: (6,)."""
        if self.load_cycle.torque.ndim == 3:
            return np.array([function.any() for function in self.functions])
        return np.any([f.any(axis=(0, 1)) for _, f in self.parts], axis=0)

    @cached_property
    def moments(self) -> Array:
        """Means of products of the functions over the cycle: (6, 6) or (6, 6, cycles)."""
        duration, total = self.load_cycle.duration, self.load_cycle.total
        if self.load_cycle.torque.ndim == 3:
            share, active = duration / total, np.flatnonzero(self.acts)
            means = np.zeros((6, 6, self.functions.shape[-1]))
            for a in active.tolist():
                for b in active[active <= a].tolist():
                    means[a, b] = means[b, a] = cycles.integral(share, self.functions[a], self.functions[b])
            return means
        means = np.zeros((6, 6))
        for rows, f in self.parts:
            (left, right), t = (f[:, 0], f[:, 1]), duration[rows, None]
            means += (t * (2.0 * left + right)).T @ left + (t * (left + 2.0 * right)).T @ right
        return (means + means.T) / (12.0 * total)

    @cached_property
    def time(self) -> Array:
        """Time at both ends of each segment [s]: shape (segments, 2, ...)."""
        return cycles.end_times(self.load_cycle.duration)

    @cached_property
    def torque(self) -> Array:
        """Torque at the output, driving, braking and at rest, at both ends of each segment [N*m]."""
        speed, torque = self.load_cycle.speed, self.load_cycle.torque
        drives = cycles.middle(torque) * cycles.middle(speed) > 0.0
        factor = np.where(drives, 1.0 / self.efficiency, self.efficiency)
        return torque * np.where(np.any(speed != 0.0, axis=1), factor, 1.0)[:, None]

    @cached_property
    def speed(self) -> Array:
        """Speed at the output, at both ends of each segment [rad/s]."""
        return np.broadcast_to(self.load_cycle.speed, self.load_cycle.torque.shape)

    @cached_property
    def peak_speed(self) -> Alike:
        """Highest speed [rad/s]."""
        peak = np.maximum(self.load_cycle.speed.max(axis=(0, 1)), -self.load_cycle.speed.min(axis=(0, 1)))
        return float(peak) if self.load_cycle.speed.ndim == 2 else peak

    @cached_property
    def scalars(self) -> Scalars:
        """Single figures; of one cycle from the segments in which it runs, of several the others as of no time."""
        cycle, torque, speed = self.load_cycle, self.torque, self.load_cycle.speed
        running, alone = np.any(speed != 0.0, axis=1), speed.ndim == 2
        loads_gears = running | ~running.any(axis=0)  # a cycle that never runs loads gears at rest
        time, rows = (
            (cycle.duration[loads_gears], loads_gears)
            if alone
            else (np.where(loads_gears, cycle.duration, 0.0), slice(None))
        )
        total, power = time.sum(axis=0), np.abs(cycles.mean_product(torque, speed)[rows])
        rests = ~running & (cycle.duration > 0.0)
        at_rest = np.where(rests[:, None], np.abs(torque), -1.0).max(axis=(0, 1))
        at_rest = np.where(at_rest >= 0.0, at_rest, np.nan)
        figures = Scalars(
            rms_torque=cycles.rms(time, torque[rows]),
            peak_torque=np.abs(torque).max(axis=(0, 1)),
            holding_torque=self.efficiency * np.where(np.isnan(cycle.holding_torque), at_rest, cycle.holding_torque),
            load_torque=np.abs(cycle.torque).max(axis=(0, 1)),
            **cycles.lasting_speeds(cycle.duration, speed),
            mean_power=(time * power).sum(axis=0) / np.where(total > 0.0, total, 1.0),
            peak_power=np.abs(torque * speed).max(axis=(0, 1)),
            drawn_power=np.where(cycle.acceleration * speed >= 0.0, torque * speed, 0.0).max(axis=(0, 1)),
        )
        return Scalars(*map(float, figures)) if alone else figures

    @cached_property
    def corners(self) -> tuple[Array, Array]:
        """Of one cycle: the points at which anything linear in the functions is largest, by time [s].

        Those at which it is smallest are among them with the other sign.
        """
        points = [extremes(f, self.time[rows]) for rows, f in self.parts]
        if len(points) > 1:
            high, high_time, low, low_time = (np.concatenate(same) for same in zip(*points, strict=True))
            points = [extremes(np.concatenate([high, low]), np.concatenate([high_time, low_time]))]
        time = np.concatenate([points[0].high_time, points[0].low_time])
        order = np.argsort(time, kind="stable")
        return np.concatenate([points[0].high, -points[0].low])[order], time[order]

    @cached_property
    def braked(self) -> Array:
        """Of one cycle: work of each function against the motion, of torques [J]: shape (6,)."""
        against = -self.moments[:, SPEED] * self.load_cycle.total
        work: Array = np.maximum(against, 0.0)  # a torque has one direction of power
        work[ACCELERATION] = sum(_against(self.load_cycle.duration[rows], f) for rows, f in self.parts)
        return work

    @cached_property
    def hardest_braking(self) -> list[tuple[Array, Array, float]]:
        """Of one cycle: stretches in which the load gives back most, less so much power that is lost meanwhile.

        Of each the integrals of products of the functions, shape (6, 6), the work of each against the motion, as
        ``braked`` has it, and the duration [s].
        """
        cycle, duration = self.load_cycle, self.load_cycle.duration
        power, stretches = cycles.mean_product(self.torque, cycle.speed), {}
        for share in _LOST:
            work = np.append(0.0, np.cumsum(duration * (power - share * power.min())))
            end = int((np.maximum.accumulate(work) - work).argmax())
            start = int(work[: end + 1].argmax())
            if start < end and (start, end) not in stretches:
                four = ("duration", "speed", "acceleration", "torque")
                stretch = replace(cycle, **{name: getattr(cycle, name)[start:end] for name in four})
                own, total = CycleAtBelt(stretch, self.efficiency), float(stretch.total)
                stretches[start, end] = own.moments * total, own.braked, total
        return list(stretches.values())

    def turned(self, exponent: float) -> Alike:
        """Mean over the cycle of the torque to an exponent, times speed: ``turned_load`` of it."""
        store, name = self.coarse, ("turned", exponent)
        if name not in store:
            store[name] = turned_load(self.load_cycle.duration, self.torque, self.speed, exponent)
        return store[name]

    def behind(self, ratio: Figure) -> AtGearhead:
        """The cycle behind a belt of a ratio, or behind the belts of candidates."""
        return AtGearhead(self, ratio)


def _against(duration: Array, functions: Array) -> float:
    """Work of the acceleration against the motion: acceleration may change its sign within a segment."""
    (a_0, a_1), (w_0, w_1) = functions[:, :, ACCELERATION].T, functions[:, :, SPEED].T
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = np.where(a_0 * a_1 < 0.0, a_0 / (a_0 - a_1), 1.0)
    a, w = a_0 + cut * (a_1 - a_0), w_0 + cut * (w_1 - w_0)
    first = cut * (2.0 * a_0 * w_0 + a_0 * w + a * w_0 + 2.0 * a * w)
    then = (1.0 - cut) * (2.0 * a * w + a * w_1 + a_1 * w + 2.0 * a_1 * w_1)
    return float(duration @ (np.maximum(-first, 0.0) + np.maximum(-then, 0.0)) / 6.0)


class AtGearhead:
    """A load cycle at the gearhead's output, behind one belt, or behind the belts of candidates: columns."""

    def __init__(self, base: CycleAtBelt, ratio: Alike) -> None:
        self.base, self.belt = base, ratio

    @cached_property
    def scale(self) -> Array:
        """Of each of the functions: shape (6,), or (candidates, 6)."""
        back, same = 1.0 / self.belt, np.ones_like(self.belt)
        return np.stack([back, back, back, self.belt, same, self.belt], axis=-1)

    def __getattr__(self, name: str) -> Any:
        """One of ``Scalars`` behind the belt."""
        if name not in _BY_RATIO:
            raise AttributeError(name)
        return getattr(self.base.scalars, name) * self.belt ** _BY_RATIO[name]

    @property
    def peak_speed(self) -> Alike:
        """Highest speed at the output [rad/s]."""
        return self.base.peak_speed * self.belt

    @property
    def load_cycle(self) -> cycles.LoadCycle:
        """The load cycle at the load."""
        return self.base.load_cycle

    @property
    def acts(self) -> Mask:
        """Mask of the functions that are ever not 0."""
        return self.base.acts

    @cached_property
    def functions(self) -> Array:
        """Behind one belt the six functions at both ends of each segment: shape (segments, 2, 6)."""
        return self.base.functions * self.scale

    def line(self, c: Array) -> Array:
        """Behind one belt the sum c f(t) at both ends of each segment, shape (segments, 2); c of shape (6,)."""
        return np.concatenate([f @ (c * self.scale) for _, f in self.base.parts])

    def turned(self, exponent: float) -> Alike:
        """Mean over the cycle of the output torque to an exponent, times speed there."""
        return self.base.turned(exponent) * self.belt ** (1.0 - exponent)

    def on(self, rows: Any) -> AtGearhead:
        """Of some of the candidates."""
        return AtGearhead(self.base, self.belt[rows]) if np.ndim(self.belt) else self

    def moment(self, a: int, b: int) -> Alike:
        """Mean of the product of two functions over the cycle."""
        return self.base.moments[a, b] * self.scale[..., a] * self.scale[..., b]

    def mean_with(self, c: Array, function: int) -> Array:
        """Mean over the cycle of c f(t) times one of the functions, of each candidate; c of shape (candidates, 6)."""
        return (c * self.scale) @ self.base.moments[:, function] * self.scale[..., function]

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient: shape (candidates, 6)."""
        return (c * self.scale) @ self.base.moments * self.scale

    def peak(self, coefficients: Array, left_out: Mask | None = None) -> Peak:
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
        values = product(coefficients * self.scale, points.T)
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


def bounded(value: Array, time: Array, left_out: Mask | None) -> Peak:
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


def lacking(left_out: Mask) -> Mask:
    """Whether anything was left out of a candidate's coefficients: of the three that may lack a part."""
    return left_out[:, ACCELERATION] | left_out[:, DIRECTION] | left_out[:, SPEED]
