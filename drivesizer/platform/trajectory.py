"""Motion of a platform through the world: pieces of time, splines of postures, what lies between."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError
from drivesizer.physics.load_cycle import end_times, places
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.platform.equations import Array
from drivesizer.platform.kinematics import seen_by_robot

# -- Motion of a platform through the world, as pieces of time.


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Posture, velocity and acceleration at both ends of each of n pieces, in the world's axes; straight between.

    The first axis has forwards-x, left-y and heading; the last one left and right end: an acceleration may jump
    between two pieces, a velocity and a posture may not.
    """

    duration: Array  # (n,) s, above 0
    posture: Array  # (3, n, 2): m, m, rad
    velocity: Array  # (3, n, 2): m/s, m/s, rad/s
    acceleration: Array  # (3, n, 2): m/s^2, m/s^2, rad/s^2

    @property
    def total(self) -> float:
        """Length in time [s]."""
        return float(self.duration.sum())

    @property
    def time(self) -> Array:
        """Time at both ends of each piece, from the start [s]; shape (n, 2)."""
        return end_times(self.duration)

    def at(self, time: Any) -> Array:
        """Posture at any times [m, m, rad], shape (3, ...): a cubic of time in each piece, exact for a constant jerk.

        Before the start and after the end it is the first and the last one.
        """
        i, u = self.places(time)
        T = self.duration[i]
        (p_0, p_1), (v_0, v_1) = np.moveaxis(self.posture[:, i], -1, 0), np.moveaxis(self.velocity[:, i], -1, 0)
        inner = T * (v_0 * (1.0 - u) - v_1 * u) + (p_1 - p_0) * (2.0 * u - 1.0)
        return np.asarray(p_0 + (p_1 - p_0) * u + u * (1.0 - u) * inner)

    def places(self, time: Any) -> tuple[Any, Array]:
        """The piece of each of some times, and the share of it that is over; no less than 0, no more than all."""
        edges = np.concatenate([[0.0], np.cumsum(self.duration)])
        moment = np.clip(np.asarray(time, dtype=float), 0.0, edges[-1])
        piece = np.clip(np.searchsorted(edges, moment, side="right") - 1, 0, len(self.duration) - 1)
        return piece, (moment - edges[piece]) / self.duration[piece]

    @property
    def length(self) -> float:
        """Length of the path, by the mean speed of both ends of each piece [m]."""
        return float(np.hypot(*self.velocity[:2]).mean(axis=1) @ self.duration)

    def in_robot(self) -> tuple[Array, Array]:
        """Velocity and its rate of change in the robot's frame, η and dη/dt: shape (3, n, 2) both."""
        return seen_by_robot(self.posture[2], self.velocity, self.acceleration)


def rest(posture: Array, time: float) -> Trajectory:
    """Rest at a posture, as one piece."""
    still = np.zeros((3, 1, 2))
    return Trajectory(np.array([time]), still + np.reshape(posture, (3, 1, 1)), still, still.copy())


def joined(parts: Sequence[Trajectory]) -> Trajectory:
    """Trajectories one after the other, each of which starts where the one before ends."""
    columns = (np.concatenate([getattr(p, n) for p in parts], axis=1) for n in ("posture", "velocity", "acceleration"))
    return Trajectory(np.concatenate([p.duration for p in parts]), *columns)


# -- A path coordinate from 0 to 1 over time, from rest to rest, in pieces: of what moves together.


def path_coordinate(
    times: tuple[float, float, float], pieces: Callable[[float, bool, bool], int]
) -> tuple[Array, Array, Array, Array]:
    """Duration of the pieces, the coordinate, its rate and its acceleration at both ends of each."""
    jerk_time, hold, cruise = times
    total = 2.0 * (2.0 * jerk_time + hold) + cruise
    cruise = cruise if cruise > _NO_TIME * total else 0.0
    top = 1.0 / (2.0 * jerk_time + hold + cruise) / (jerk_time + hold)  # of the times, so that it ends at 1
    rising, s, v = [], 0.0, 0.0
    for time, start, end in ((jerk_time, 0.0, top), (hold, top, top), (jerk_time, top, 0.0)):
        if time > _NO_TIME * total:
            t = np.linspace(0.0, time, pieces(time, start != end, False) + 1)
            bend = (end - start) / time
            place = s + t * (v + t * (start / 2.0 + t * (bend / 6.0)))
            rate = v + t * (start + t * (bend / 2.0))
            rising.append((t, place, rate, start + t * bend))
            s, v = float(place[-1]), float(rate[-1])
    level = []
    if cruise:
        t = np.linspace(0.0, cruise, pieces(cruise, False, True) + 1)
        along = np.linspace(s, 1.0 - s, len(t))
        level.append((t, along, np.full_like(along, v), np.zeros_like(along)))
    falling = [(t[-1] - t[::-1], 1.0 - s[::-1], v[::-1], -a[::-1]) for t, s, v, a in reversed(rising)]
    parts = [*rising, *level, *falling]
    duration = np.concatenate([np.full(len(t) - 1, t[-1] / (len(t) - 1)) for t, *_ in parts])
    place, rate, gain = (
        np.concatenate([np.stack([part[n][:-1], part[n][1:]], axis=1) for part in parts]) for n in (1, 2, 3)
    )
    return duration, place, rate, gain


# -- What is no recorded motion: figures that are rounded too much, and ends that are not at rest.


_EXACT, _MOST_NOISE = 1e-3, 0.2  # m or rad; of the largest acceleration
_SLOW, _CREEP = 0.25, 0.01  # what is at rest: of the mean speed of two steps; of the largest of all


def refuse_few_digits(where: str, values: Array, factor: float, step: float, most: float, unit: str) -> None:
    """Refuse a recorded column whose last digits make up much of its acceleration.

    A spline through values rounded to q, h apart, is off by up to 6 q/h² in its second derivative. Digits coarser than
    1 mm or 1 mrad are taken as exact: so a track is written by hand.
    """
    digit = last_digit(values / factor) * factor
    noise = 6.0 * digit / step**2
    if digit <= _EXACT and _MOST_NOISE * most < noise and np.ptp(values) > 0.0:
        raise InputError(
            f"{where}: the last digit, {digit:.3g} {unit}, stands for {noise:.3g} {unit}/s^2 every {step:g} s, of "
            f"{most:.3g} {unit}/s^2 in all; expected more digits, or smoothing"
        )


def last_digit(values: Array) -> float:
    """The power of ten that all values are whole multiples of; 0 where they have more than nine decimals.

    >>> last_digit(np.array([1.25, 0.5]))
    0.01
    """
    for digits in range(10):
        scaled = values * 10.0**digits
        if (np.abs(scaled - np.round(scaled)) <= 1e-6 + 1e-15 * np.abs(scaled)).all():
            return float(10.0**-digits)
    return 0.0


def speed_at_end(time: Array, rows: Array, end: int) -> float:
    """Speed along the motion at the first sample (0) or at the last (-1); 0 where that is at rest."""
    here = slice(None, 3) if end == 0 else slice(-3, None)
    t = time[here]
    top = float(np.hypot.reduce(np.abs(np.diff(rows, axis=1) / np.diff(time)).max(axis=1)))
    slope = np.array([local_parabola(t, row[here], 0.0)[1][end] for row in rows])
    mean = (rows[:, here][:, -1] - rows[:, here][:, 0]) / (t[-1] - t[0])
    along, size = float(slope @ mean), float(np.hypot.reduce(mean))
    return along / size if along > size * max(_SLOW * size, _CREEP * top) else 0.0


# -- Postures over time as a trajectory: a cubic spline, twice continuously differentiable, from rest to rest.
#
# It goes through all postures, or, with smoothing, as near as least squares brings a spline whose knots are samples
# that far apart. Wherever three postures or more in a row are the same the platform stands, and what moves before
# and after has a spline of its own, at rest at both ends. An interval is one piece; more, where its speed bends by
# more than 1/1000 of the largest or it turns by more than 1/32 rad.


_BEND, _TURN = 1e-3, 1.0 / 32.0  # of a piece: of the largest speed; rad
_MOST_PARTS = 256  # of an interval
_ROUNDING = 1e-9  # of a time between knots
_NO_TIME = 1e-12  # of a path: a shorter phase is none


def spline(time: Array, posture: Array, smoothing: float = 0.0) -> Trajectory:
    """The trajectory through postures, from rest to rest; at rest where three in a row are the same.

    Parameters
    ----------
    time
        Rising [s], shape (n,).
    posture
        Headings continuous [m, m, rad], shape (3, n).
    smoothing
        Least time between the knots of the curve [s]; 0 goes through all postures.

    Returns
    -------
    Trajectory
        One piece between two knots.

    Examples
    --------
    >>> x = np.array([0.0, 0.1, 0.4, 0.9, 1.2, 1.3])
    >>> moved = spline(np.arange(6.0), np.array([x, 0 * x, 0 * x]))
    >>> moved.at([2.0, 5.0])[0]
    array([0.4, 1.3])
    """
    same = (np.diff(posture, axis=1) == 0.0).all(axis=0)
    padded = np.concatenate([[False], same, [False]])
    resting = same & (padded[:-2] | padded[2:])
    x, y, turn = np.diff(posture, axis=1) / np.diff(time)
    top = np.array([np.hypot(x, y).max(), np.abs(turn).max()])  # m/s, rad/s
    pieces = []
    for first, last in pairwise(edges_of(resting)):
        t, p = time[first : last + 1], posture[:, first : last + 1]
        still = rest(p[:, 0], float(t[-1] - t[0])) if resting[first] else None
        pieces.append(still or _moving(t, p, top, smoothing))
    return joined(pieces)


def edges_of(resting: NDArray[np.bool_]) -> list[int]:
    """Intervals at which a stretch of rest or motion starts, and the end."""
    return [0, *(np.flatnonzero(np.diff(resting)) + 1).tolist(), len(resting)]


def parts_of(bend: Array, turned: Array) -> NDArray[np.int64]:
    """Number of pieces of each interval in which a speed bends by a share of the largest, and turns by an angle."""
    return np.ceil(np.maximum(np.sqrt(bend / _BEND), turned / _TURN)).clip(1.0, _MOST_PARTS).astype(np.int64)


def _moving(time: Array, posture: Array, top: Array, smoothing: float) -> Trajectory:
    """A stretch between rests."""
    curve = curve_at_rest(time, posture, smoothing)
    step = np.diff(time)
    x, y, turn = curve(time[:-1] + step / 2.0, 3) * step**2 / 8.0
    bend = np.array([np.hypot(x, y), np.abs(turn)])
    share = np.divide(bend, top[:, None], out=np.zeros_like(bend), where=top[:, None] > 0.0).max(axis=0)
    turned = np.abs(curve(time, 1)[2])
    turned = np.maximum(turned[1:], turned[:-1]) * step
    count = parts_of(share, turned)
    owner, place = places(count)
    knots = np.append(time[owner] + step[owner] * (place / count[owner]), time[-1])
    columns = [curve(knots, order) for order in range(3)]
    columns[0][:, [0, -1]], columns[1][:, [0, -1]] = posture[:, [0, -1]], 0.0
    return Trajectory(np.diff(knots), *(np.stack([c[:, :-1], c[:, 1:]], axis=2) for c in columns))


def curve_at_rest(time: Array, posture: Array, smoothing: float) -> Callable[[Array, int], Array]:
    """The curve and its derivatives, of shape (rows, times): a cubic between samples, at rest at both ends."""
    from scipy.interpolate import BSpline, CubicSpline

    knots = time[thinned(time, smoothing)]
    if len(knots) == len(time):
        still = np.zeros(len(posture))
        through = CubicSpline(time, posture, axis=1, bc_type=((1, still), (1, still)))
        return lambda at, order: np.asarray(through(at, order))
    knot_vector = np.concatenate([np.repeat(knots[0], 3), knots, np.repeat(knots[-1], 3)])
    near = BSpline(knot_vector, _coefficients(time, posture, knot_vector), 3)
    return lambda at, order: np.asarray(near(at, order)).T


def thinned(time: Array, smoothing: float) -> NDArray[np.int64]:
    """Places of samples at least so far apart, both ends among them.

    >>> thinned(np.array([0.0, 0.1, 0.2, 0.35, 0.5, 0.6]), 0.2)
    array([0, 2, 5])
    """
    if smoothing <= float(np.diff(time).min()):
        return np.arange(len(time))
    number = np.floor((time - time[0]) / smoothing * (1.0 + _ROUNDING))
    first = np.flatnonzero(np.diff(number, prepend=-1.0))
    apart = np.concatenate([[True], np.diff(time[first]) >= smoothing * (1.0 - _ROUNDING)])
    before_end = (time[-1] - time[first] >= smoothing * (1.0 - _ROUNDING)) | (first == 0)
    return np.append(first[apart & before_end], len(time) - 1)


def _coefficients(time: Array, posture: Array, knot_vector: Array) -> Array:
    """Of the B-spline that fits best and is at rest at both ends, where its last two coefficients are the same."""
    from scipy.interpolate import BSpline
    from scipy.sparse.linalg import spsolve

    coefficients = np.empty((len(knot_vector) - 4, len(posture)))
    coefficients[:2], coefficients[-2:] = posture[:, 0], posture[:, -1]
    if len(coefficients) > 4:
        basis = BSpline.design_matrix(time, knot_vector, 3)
        ends, inner = basis[:, [0, 1, -2, -1]], basis[:, 2:-2]
        left = posture.T - ends @ coefficients[[0, 1, -2, -1]]
        best: Any = spsolve((inner.T @ inner).tocsc(), inner.T @ left)
        coefficients[2:-2] = np.reshape(best, (-1, len(posture)))
    return coefficients


# -- A trajectory between the ends of its pieces: cubics through both ends, with the velocities there.
#
# Where an acceleration is straight over a piece the cubic is the motion itself. In Bézier's form a piece stays
# inside the hull of its four control points, so that it can be said where it does not come.


def control_points(trajectory: Trajectory) -> Array:
    """Bézier points of the posture over each piece, shape (3, n, 4) [m, m, rad]."""
    left, right = trajectory.posture[..., 0], trajectory.posture[..., 1]
    third = trajectory.duration / 3.0
    return np.stack(
        [left, left + third * trajectory.velocity[..., 0], right - third * trajectory.velocity[..., 1], right], axis=-1
    )


def halves(points: Array) -> tuple[Array, Array]:
    """Both halves of pieces in Bézier's form, by de Casteljau; the shape is that of ``points``."""
    first = (points[..., 1:] + points[..., :-1]) / 2.0
    second = (first[..., 1:] + first[..., :-1]) / 2.0
    middle = (second[..., 1] + second[..., 0]) / 2.0
    left = np.stack([points[..., 0], first[..., 0], second[..., 0], middle], axis=-1)
    right = np.stack([middle, second[..., 1], first[..., 2], points[..., 3]], axis=-1)
    return left, right


def finer(trajectory: Trajectory, turning: float = 0.05) -> Trajectory:
    """The same trajectory in pieces that turn by less than an angle."""
    turned = np.ptp(control_points(trajectory)[2], axis=-1)
    parts = np.maximum(np.ceil(turned / turning), 1.0).astype(int)
    if parts.max(initial=1) == 1:
        return trajectory
    piece, step = places(parts)
    share = (step[:, None] + np.array([0.0, 1.0])) / parts[piece, None]  # (pieces, 2)
    points = control_points(trajectory)[:, piece, None, :]
    weights = np.stack([(1 - share) ** 3, 3 * share * (1 - share) ** 2, 3 * share**2 * (1 - share), share**3], axis=-1)

    def straight(values: Array) -> Array:
        left, right = values[:, piece, :1], values[:, piece, 1:]
        return np.asarray(left + share * (right - left))

    return Trajectory(
        duration=trajectory.duration[piece] / parts[piece],
        posture=np.asarray((points * weights).sum(axis=-1)),
        velocity=straight(trajectory.velocity),
        acceleration=straight(trajectory.acceleration),
    )
