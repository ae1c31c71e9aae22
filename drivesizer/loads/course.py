"""Motion of a load over one cycle: a profile of speed, and as columns over segments for the torque laws.

Along a line in metres or about an axis in radians, as the load moves; positions count from the start of the cycle.
Figures of a profile may be columns over samples; then a course has its samples along a last axis.
Symbols: s position [m or rad], v speed [m/s or rad/s], a acceleration [m/s^2 or rad/s^2], r radius [m].
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import fsum, nan

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import Cuts, Ends, LoadCycle, OwnLimit, cut_points, cuts, end_times

_SHORT = 256  # breakpoints of a profile of which the course is kept


@dataclass(frozen=True, slots=True)
class Profile:
    """Speed over time, piecewise linear; over samples each figure is a column."""

    name: str
    time: tuple[float, ...]  # s, strictly rising
    speed: tuple[float, ...]  # m/s, or rad/s of a load that turns
    acceleration: tuple[float, ...] | None = None  # where it is continuous; else that of each straight piece
    payload: tuple[float, ...] | None = None  # kg, on each straight piece beside the load's own mass; none where None
    ends: tuple[tuple[float, float], ...] | None = None  # or at both ends of each piece, where it jumps between them

    @property
    def duration(self) -> float:
        """From the first breakpoint to the last [s]."""
        return self.time[-1] - self.time[0]

    @property
    def top_speed(self) -> float:
        """Largest speed in either direction [m/s or rad/s]."""
        return max(abs(v) for v in self.speed)

    @property
    def distance(self) -> float:
        """Displacement over the profile [m or rad]."""
        return fsum((t1 - t0) * (v0 + v1) / 2 for t0, t1, v0, v1 in self.pieces())

    def pieces(self) -> Iterator[tuple[float, float, float, float]]:
        """The straight pieces: start and end [s], speeds there [m/s or rad/s]."""
        return zip(self.time, self.time[1:], self.speed, self.speed[1:], strict=False)


@dataclass(frozen=True, slots=True)
class Course:
    """Columns over segments; each quantity has its values at both ends, with straight lines between for v and a."""

    name: str
    duration: NDArray[np.float64]  # s
    position: Ends
    speed: Ends
    acceleration: Ends
    payload: NDArray[np.float64] | float = 0.0  # kg, beside the load's own mass; shape (segments, 1, ...)
    resisting: Ends | float = 0.0  # N or N*m, of springs and counterweights against the forward motion
    balance: Alike = 0.0  # kg or kg*m^2, of counterweights, whose acceleration is in ``resisting``

    @property
    def heaviest(self) -> Alike:
        """Largest payload [kg]."""
        return self.payload if isinstance(self.payload, float) else self.payload.max(axis=(0, 1))

    @property
    def direction(self) -> NDArray[np.float64]:
        """Sign of the speed within each segment, 0 at rest: shape (segments, 1, ...)."""
        return np.sign(self.speed.mean(axis=1, keepdims=True))

    def split(self) -> Course:
        """The same course, cut where it turns round: within a segment the direction is one."""
        pieces, shares, speed = cut_points(self.speed, self.speed)
        return replace(self, speed=speed)._in_pieces(cuts(pieces, shares), turns=True)

    def finer(self, pieces: NDArray[np.int64] | int) -> Course:
        """The same course with each segment in so many equal pieces, for torques that are not linear in it."""
        count = np.broadcast_to(np.asarray(pieces, dtype=np.int64), len(self.duration))
        return self._in_pieces(cuts(count, (1.0 / count).reshape(-1, *[1] * (self.duration.ndim - 1))))

    def _in_pieces(self, cut: Cuts, *, turns: bool = False) -> Course:
        return Course(
            self.name,
            self.duration[cut.owner] * (cut.end - cut.start),
            self.position[cut.owner, :1] + cut.travel(self.duration, self.speed),
            cut.line(self.speed, crosses=turns),
            cut.line(self.acceleration),
            self.payload if isinstance(self.payload, float) else self.payload[cut.owner],
            self.resisting if isinstance(self.resisting, float) else cut.line(self.resisting),
            self.balance,
        )

    def cycle(
        self, torque: Ends, radius: Figure = 1.0, *, inertia: Figure = nan, own: tuple[OwnLimit, ...] = ()
    ) -> LoadCycle:
        """The load cycle at a shaft that moves the load at a radius, cut where the direction of power changes.

        Parameters
        ----------
        torque
            That the load takes at the shaft, its inertia included, at both ends of each segment [N*m].
        radius
            Travel of the load per angle of the shaft [m]; 1 where the load turns with it.
        inertia
            Of all that moves, seen at the shaft [kg*m^2].
        own
            Limits of the load itself.
        """
        speed, acceleration = self.speed / radius, self.acceleration / radius
        return LoadCycle(self.name, self.duration, speed, acceleration, torque, inertia, own, radius).split()


def columns_of(figures: Sequence[Figure]) -> NDArray[np.float64]:
    """Figures in a row, of which some may be columns over samples: shape (figures,) or (figures, samples)."""
    return np.stack(np.broadcast_arrays(*figures)) if any(np.ndim(x) for x in figures) else np.array(figures)


def course(profile: Profile, *, sampled: bool = False) -> Course:
    """A profile as columns, cut where it turns round.

    Parameters
    ----------
    profile
        Speed over time; its figures may be columns over samples.
    sampled
        Whether the course has an axis of samples, if only of one for all.

    Returns
    -------
    Course
        Columns over segments.

    Examples
    --------
    >>> moved = course(Profile("x", (0.0, 2.0, 5.0, 6.0), (0.0, 3.0, 3.0, 0.0)))
    >>> moved.position[:, 1]
    array([ 3. , 12. , 13.5])
    """
    return _course(profile, sampled) if sampled or len(profile.time) > _SHORT else _remembered(profile, sampled)


def _course(profile: Profile, sampled: bool) -> Course:
    def rows(figures: Sequence[Figure]) -> NDArray[np.float64]:
        columns = columns_of(figures)
        return columns[:, None] if sampled and columns.ndim == 1 else columns

    time, speed = rows(profile.time), rows(profile.speed)
    duration, ends = np.diff(time, axis=0), np.stack([speed[:-1], speed[1:]], axis=1)
    if profile.ends is not None:
        left, right = (rows(column) for column in zip(*profile.ends, strict=True))
        acceleration = np.stack([left, right], axis=1)
    elif profile.acceleration is None:
        lasting = np.where(duration > 0.0, duration, 1.0)
        acceleration = np.repeat(np.diff(ends, axis=1) / lasting[:, None], 2, axis=1)
    else:
        slope = rows(profile.acceleration)
        acceleration = np.stack([slope[:-1], slope[1:]], axis=1)
    travel = np.cumsum(duration * ends.mean(axis=1), axis=0)
    position = np.stack([np.concatenate([np.zeros_like(travel[:1]), travel[:-1]]), travel], axis=1)
    payload = 0.0 if profile.payload is None else rows(profile.payload)[:, None]
    return Course(profile.name, duration, position, ends, acceleration, payload).split()


_remembered = lru_cache(maxsize=16)(_course)  # of short profiles: variants of a spec mostly move as it does


def at_largest(size: Ends, duration: NDArray[np.float64], *columns: Ends) -> list[Alike]:
    """The moment at which something is largest, and columns there; of each sample its own.

    Parameters
    ----------
    size
        At both ends of each segment, shape (segments, 2, ...).
    duration
        Of each segment [s].
    columns
        Quantities at both ends of each segment.

    Returns
    -------
    list
        The moment [s], then the value of each column.
    """
    place = size.reshape(-1, *size.shape[2:]).argmax(axis=0)
    flat = [
        np.broadcast_to(column, size.shape).reshape(-1, *size.shape[2:]) for column in (end_times(duration), *columns)
    ]
    return [float(x[place]) if size.ndim == 2 else np.take_along_axis(x, place[None], axis=0)[0] for x in flat]
