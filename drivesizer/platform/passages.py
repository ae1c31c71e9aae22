"""Clearance of a platform to the jambs of a passage along a trajectory.

At each moment the part of its rectangle that is between the faces of the wall, |s| <= d/2 along the passage, takes
up the passage from one side to the other. What is left beside it is the clearance; below 0 the jamb is hit. Pieces of
the trajectory are halved until nothing in them moves by more than a thousandth of the passage's width, and at the
narrowest place by a hundred-thousandth.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.extremes_between_samples import control_points, halves
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.trajectory import Trajectory

__all__ = ["Clearance", "clearances", "side_room"]

_STEPS = (1e-3, 1e-5)  # of a passage's width: the whole path, then beside the narrowest place


class Clearance(NamedTuple):
    """The least room beside a platform while it is in a passage."""

    passage: str
    least: float  # m; NaN where it never is in it
    time: float  # s
    side: str  # left or right, seen along the passage's direction


def clearances(trajectory: Trajectory, size: Size, passages: tuple[Passage, ...]) -> tuple[Clearance, ...]:
    """The least clearance to the jambs of each passage.

    Parameters
    ----------
    trajectory
        In the world.
    size
        Of the platform.
    passages
        Where they are in the world. One counts while some of the platform is between its jambs: a path beside it, or
        through another door of the same wall, does not.

    Returns
    -------
    tuple of Clearance
        In the order of the passages.
    """
    return tuple(_clearance(trajectory, size, passage) for passage in passages)


def _clearance(trajectory: Trajectory, size: Size, passage: Passage) -> Clearance:
    start = np.cumsum(trajectory.duration) - trajectory.duration
    pieces = _Pieces(_passage_postures(control_points(trajectory), passage), start, trajectory.duration)
    least, found = math.nan, Clearance(passage.name, math.nan, math.nan, "")
    for step in _STEPS:
        pieces = _halved(pieces, size, passage, passage.width * step)
        left, right = side_room(pieces.ends, size, passage.width, passage.depth)
        room = np.fmin(left, right)
        if np.isnan(room).all():
            return found
        side, at = (int(i) for i in np.unravel_index(np.nanargmin(room), room.shape))
        if not room[side, at] >= least:  # written so that NaN is no least
            least, nearer = float(room[side, at]), "left" if left[side, at] <= right[side, at] else "right"
            found = Clearance(passage.name, least, float((pieces.start + side * pieces.length)[at]), nearer)
        pieces = pieces.on(slice(max(at - 2, 0), at + 3))
    return found


class _Pieces(NamedTuple):
    """Pieces of a motion in the passage's axes, in Bézier's form."""

    points: Array  # (3, n, 4)
    start: Array  # (n,) s
    length: Array  # (n,) s

    def on(self, taken: Any) -> _Pieces:
        """Some of them."""
        return _Pieces(self.points[:, taken], self.start[taken], self.length[taken])

    @property
    def ends(self) -> Array:
        """Postures at both ends, (3, 2, n)."""
        return np.stack([self.points[..., 0], self.points[..., 3]], axis=1)


def _halved(pieces: _Pieces, size: Size, passage: Passage, step: float) -> _Pieces:
    """Pieces near the passage, halved until nothing in one moves by more than a step; in the order of time."""
    done = [pieces.on(slice(0))]
    while pieces.start.size:
        pieces = pieces.on(_near(pieces.points, size, passage))
        extent = np.ptp(pieces.points, axis=-1)
        small = np.hypot(extent[0], extent[1]) + size.reach * extent[2] <= step
        done.append(pieces.on(small))
        long = pieces.on(~small)
        half = long.length / 2.0
        both = zip(halves(long.points), (long.start, long.start + half), strict=True)
        pieces = _joined([_Pieces(points, start, half) for points, start in both])
    found = _joined(done)
    return found.on(np.argsort(found.start, kind="stable"))


def _joined(parts: list[_Pieces]) -> _Pieces:
    points, start, length = zip(*parts, strict=True)
    return _Pieces(np.concatenate(points, axis=1), np.concatenate(start), np.concatenate(length))


def _passage_postures(points: Array, passage: Passage) -> Array:
    """Postures along the passage, across it to the left, and their heading against it."""
    x, y = points[0] - passage.x, points[1] - passage.y
    cos, sin = math.cos(passage.direction), math.sin(passage.direction)
    return np.stack([cos * x + sin * y, cos * y - sin * x, points[2] - passage.direction])


def _near(points: Array, size: Size, passage: Passage) -> Array:
    """Pieces that may come between the jambs."""
    low, high = points[:2].min(axis=-1) - size.reach, points[:2].max(axis=-1) + size.reach
    half = np.array([[passage.depth / 2.0], [passage.width / 2.0]])
    return np.asarray(((low <= half) & (high >= -half)).all(axis=0))


def side_room(posture: Array, size: Size, width: float, depth: float) -> tuple[Array, Array]:
    """Room to the left and to the right jamb [m]; NaN where nothing of the platform is between them.

    Parameters
    ----------
    posture
        Along the passage and across it to the left, from the passage's middle [m], and heading [rad]; (3, ...).
    size
        Of the platform.
    width, depth
        Of the passage [m].

    Returns
    -------
    tuple of arrays
        Left and right [m], shape (...).
    """
    cos, sin = np.cos(posture[2]), np.sin(posture[2])
    x, y = (c.reshape(-1, *[1] * cos.ndim) for c in size.corners)
    s, t = posture[0] + cos * x - sin * y, posture[1] + sin * x + cos * y  # (4, ...)
    found = [np.where(np.abs(s) <= depth / 2.0, t, np.nan)]
    to_s, to_t = np.roll(s, -1, axis=0), np.roll(t, -1, axis=0)
    for face in {-depth / 2.0, depth / 2.0}:  # where the edges enter the wall and leave it
        crosses = (s - face) * (to_s - face) < 0.0
        share = np.where(crosses, face - s, 0.0) / np.where(crosses, to_s - s, 1.0)
        found.append(np.where(crosses, t + share * (to_t - t), np.nan))
    places = np.concatenate(found)
    most, least = np.fmax.reduce(places, axis=0), np.fmin.reduce(places, axis=0)
    inside = (most > -width / 2.0) & (least < width / 2.0)
    return np.where(inside, width / 2.0 - most, np.nan), np.where(inside, width / 2.0 + least, np.nan)
