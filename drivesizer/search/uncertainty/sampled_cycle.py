"""Load cycles of many samples at the gearhead's output: what ``physics`` knows of one cycle, as columns over samples.

The same six functions of time, their moments and their ends. Arrays have the samples last, so that each step of a
computation runs through memory once; of a cycle that all samples share there is one.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.lasting_speed import lasting_speeds
from drivesizer.physics.load_cycle import OwnLimit
from drivesizer.physics.motor_demand import AT_REST, SPEED, AtGearhead, Peak, bounded
from drivesizer.search.uncertainty.sampled_load_cycles import Cycles

__all__ = ["AtSamples", "Sampled", "Seen", "at_samples", "mean_product"]

Array = NDArray[np.float64]


class Seen(NamedTuple):
    """Of a load cycle what limits ask for beside its functions."""

    own: tuple[OwnLimit, ...]  # with columns
    inertia: Array  # kg*m^2


class Sampled(NamedTuple):
    """Cycles behind a belt of no ratio, its efficiency included."""

    duration: Array  # s, (segments, cycles)
    time: Array  # s, (segments, 2, cycles)
    functions: Array  # (6, segments, 2, cycles)
    moments: Array  # (6, 6, cycles)
    scalars: dict[str, Array]  # of the gearhead's and the load's side, (cycles,)
    seen: Seen

    def on(self, rows: NDArray[np.int64]) -> Sampled:
        """Some of the cycles; all of them where there is only one."""
        if self.duration.shape[-1] == 1:
            return self
        own = tuple(one._replace(demand=one.demand[rows], limit=one.limit[rows]) for one in self.seen.own)  # type: ignore[index]
        return Sampled(
            self.duration[..., rows], self.time[..., rows], self.functions[..., rows], self.moments[..., rows],
            {name: column[rows] for name, column in self.scalars.items()}, Seen(own, self.seen.inertia[rows]),
        )  # fmt: skip


def at_samples(cycles: Cycles, efficiency: Array | float) -> Sampled:
    """Cycles through a belt, as ``physics.at_gearhead`` takes one.

    Parameters
    ----------
    cycles
        At the load, split at changes of direction.
    efficiency
        Of the belt [1]: one figure, or one of each cycle.
    """
    duration, speed = cycles.duration, cycles.speed
    power = (cycles.torque.mean(1) * speed.mean(1))[:, None]
    running = (speed != 0.0).any(axis=1)[:, None]
    torque = cycles.torque * np.where(~running, 1.0, np.where(power > 0.0, 1.0 / efficiency, efficiency))
    functions = np.stack([
        np.where(running & (power > 0.0), torque, 0.0),
        np.where(running & (power <= 0.0), torque, 0.0),
        np.where(~running, torque, 0.0),
        np.broadcast_to(cycles.acceleration, torque.shape),
        np.broadcast_to(np.sign(speed.mean(1))[:, None], torque.shape),
        np.broadcast_to(speed, torque.shape),
    ])  # fmt: skip
    ends = np.cumsum(duration, axis=0)
    seen = Seen(
        tuple(one._replace(demand=cycles.own[one.name][0], limit=cycles.own[one.name][1]) for one in cycles.like.own),  # type: ignore[arg-type]
        cycles.inertia,
    )
    return Sampled(
        duration, np.stack([ends - duration, ends], axis=1), functions, _moments(duration, functions),
        _scalars(cycles, torque, running[:, 0]), seen,
    )  # fmt: skip


def mean_product(a: Array, b: Array) -> Array:
    """Mean of a product over each segment: (segments, cycles)."""
    found: Array = (2 * a[:, 0] * b[:, 0] + a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0] + 2 * a[:, 1] * b[:, 1]) / 6
    return found


def _moments(duration: Array, functions: Array) -> Array:
    """Means of products of the functions over each cycle."""
    found = np.zeros((6, 6, functions.shape[-1]))
    share = duration / duration.sum(axis=0)
    active = [k for k in range(6) if functions[k].any()]
    for a in active:
        for b in active[: active.index(a) + 1]:
            found[a, b] = found[b, a] = (share * mean_product(functions[a], functions[b])).sum(axis=0)
    return found


def _scalars(cycles: Cycles, torque: Array, running: NDArray[np.bool_]) -> dict[str, Array]:
    """What ``AtGearhead`` tells in single figures, of each cycle."""
    duration, speed = cycles.duration, cycles.speed
    time = np.where(running, duration, 0.0)
    total = time.sum(axis=0)
    lasting = np.where(total > 0.0, total, 1.0)
    fastest = np.abs(speed).max(axis=(0, 1))
    resting = (speed == 0.0).all(axis=1) & (duration > 0.0)
    standing = np.where(resting[:, None], np.abs(torque), -1.0).max(axis=(0, 1))
    return {
        "rms_torque": np.sqrt((time * mean_product(torque, torque)).sum(axis=0) / lasting),
        "peak_torque": np.abs(torque).max(axis=(0, 1)),
        "peak_speed": fastest,
        **lasting_speeds(duration, speed),
        "mean_power": (time * np.abs(mean_product(torque, np.broadcast_to(speed, torque.shape)))).sum(axis=0) / lasting,
        "peak_power": np.abs(torque * speed).max(axis=(0, 1)),
        "load_torque": np.abs(cycles.torque).max(axis=(0, 1)),
        "way": cycles.radius * (np.abs(speed).mean(axis=1) * duration).sum(axis=0),  # m, there and back
        "standing": np.where(standing >= 0.0, standing, np.nan),
    }


class AtSamples(AtGearhead):
    """The cycles of samples at the gearhead's output, behind one belt."""

    def __init__(self, sampled: Sampled, ratio: float) -> None:
        self.sampled, self.belt = sampled, ratio
        self.scale = np.array([1 / ratio, 1 / ratio, 1 / ratio, ratio, 1.0, ratio])
        self.moments = sampled.moments * (self.scale[:, None] * self.scale)[:, :, None]
        one = sampled.scalars
        self.rms_torque, self.peak_torque = one["rms_torque"] / ratio, one["peak_torque"] / ratio  # type: ignore[assignment]
        self.peak_speed, self.sustained_speed = one["peak_speed"] * ratio, one["sustained_speed"] * ratio  # type: ignore[assignment]
        self.mean_speed = one["mean_speed"] * ratio  # type: ignore[assignment]
        self.mean_power, self.peak_power = one["mean_power"], one["peak_power"]  # type: ignore[assignment]
        self.active = [k for k in range(6) if sampled.functions[k].any()]
        there = {k: np.flatnonzero(sampled.functions[k].any(axis=(1, 2))) for k in self.active}
        self.where = {k: (int(rows[0]), int(rows[-1]) + 1) for k, rows in there.items()}  # segments in which it counts
        self.kept: tuple[Array, Array] | None = None

    @property
    def cycle(self) -> Any:
        """What the load itself limits, and its inertia."""
        return self.sampled.seen

    @property
    def load_torque(self) -> Array:
        """Largest torque at the load [N*m]."""
        return self.sampled.scalars["load_torque"]

    @property
    def load_speed(self) -> Array:
        """Highest speed of the load [rad/s]."""
        return self.sampled.scalars["peak_speed"]

    @property
    def standing_torque(self) -> Array:
        """Largest torque at the gearhead's output while at rest [N*m]; unknown where the cycle never rests."""
        return self.sampled.scalars["standing"] / self.belt

    def slope(self, c: Array) -> Array:
        """Half of the slope of the mean square of what is linear in the functions, by each coefficient."""
        found = np.zeros_like(c)
        for b in self.active:
            for a in self.active:
                found[:, b] += c[:, a] * self.moments[a, b]
        return found

    def line(self, c: Array) -> Array:
        """What is linear in the functions, at both ends of each segment: (segments, 2, samples)."""
        if self.kept is not None and self.kept[0] is c:
            return self.kept[1]
        count = max(len(c), self.sampled.functions.shape[-1])
        found = np.zeros((*self.sampled.functions.shape[1:3], count))
        term, columns = np.empty_like(found), np.ascontiguousarray(c.T)
        for k, (first, last) in self.where.items():
            some = np.multiply(columns[k] * self.scale[k], self.sampled.functions[k, first:last], out=term[first:last])
            found[first:last] += some
        return found

    def keep(self, c: Array) -> None:
        """Hold a line ready that is asked for again."""
        self.kept = None
        self.kept = c, self.line(c)

    @property
    def acts(self) -> NDArray[np.bool_]:
        """Which of the functions are ever more than nothing, in any of the samples."""
        return np.isin(np.arange(6), self.active)

    def peak(self, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
        """Largest absolute value of what is linear in the functions."""
        line = self.line(coefficients)
        found = np.abs(line)
        if left_out is not None:
            for k in np.flatnonzero(left_out.any(axis=0)):
                against = left_out[:, k] & (line * self.sampled.functions[k] < 0.0)
                found = np.where(against, -np.inf, found)
        found = found.reshape(-1, len(coefficients))
        worst = found.argmax(axis=0)[None]
        time = np.broadcast_to(self.sampled.time.reshape(len(found), -1), found.shape)
        value, when = (np.take_along_axis(x, worst, axis=0)[0] for x in (found, time))
        return bounded(value, when, left_out)

    @cached_property
    def speeds(self) -> Array:
        """Speed at the gearhead's output, at both ends of each segment [rad/s]."""
        scaled: Array = self.sampled.functions[SPEED] * self.belt
        return scaled

    @property
    def rests(self) -> bool:
        """Whether the load asks for a torque at rest."""
        return bool(self.sampled.functions[AT_REST].any())
