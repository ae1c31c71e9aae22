"""How near a platform comes to the jambs of a passage while it moves along a trajectory.

At each moment the part of its rectangle that is between the faces of the wall, |s| <= d/2 along the way through, takes
up the passage from one side to the other. What is left beside it is the clearance; below 0 the jamb is hit. Pieces of
the trajectory are halved until nothing in them moves by more than a step, so that is how exact a clearance is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivesizer.platform.between import control_points, halves
from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.notation import Array
from drivesizer.platform.trajectory import Trajectory

__all__ = ["Clearance", "clearances", "side_room"]

_STEPS = 1000  # in a passage's width


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
        Where they are in the world. One counts while some of the platform is between its jambs: a way beside it, or
        through another door of the same wall, does not.
    """
    return tuple(_clearance(trajectory, size, passage) for passage in passages)


def _clearance(trajectory: Trajectory, size: Size, passage: Passage) -> Clearance:
    time, posture = _moments(trajectory, size, passage)
    left, right = side_room(posture, size, passage.width, passage.depth)
    if not np.isfinite(left).any():
        return Clearance(passage.name, math.nan, math.nan, "")
    least = np.fmin(left, right)
    at = int(np.nanargmin(least))
    return Clearance(passage.name, float(least[at]), float(time[at]), "left" if left[at] <= right[at] else "right")


def _moments(trajectory: Trajectory, size: Size, passage: Passage) -> tuple[Array, Array]:
    """Times and postures in the passage's axes, (n,) and (3, n), so close that nothing moves by more than a step."""
    points = _in_passage(control_points(trajectory), passage)
    start = np.cumsum(trajectory.duration) - trajectory.duration
    length, done = trajectory.duration, []
    while points.shape[1]:
        near = _near(points, size, passage)
        points, start, length = points[:, near], start[near], length[near]
        extent = np.ptp(points, axis=-1)
        small = np.hypot(extent[0], extent[1]) + size.reach * extent[2] <= passage.width / _STEPS
        done += [(start[small], points[:, small, 0]), ((start + length)[small], points[:, small, 3])]
        left, right = halves(points[:, ~small])
        points = np.concatenate([left, right], axis=1)
        length = np.tile(length[~small] / 2.0, 2)
        start = np.tile(start[~small], 2)
        start[len(start) // 2 :] += length[len(start) // 2 :]
    if not done:
        return np.zeros(0), np.zeros((3, 0))
    time, posture = np.concatenate([t for t, _ in done]), np.concatenate([p for _, p in done], axis=1)
    order = np.argsort(time, kind="stable")
    return time[order], posture[:, order]


def _in_passage(points: Array, passage: Passage) -> Array:
    """Postures along the way through, across it to the left, and their heading against it."""
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
        Along the way through and across it to the left, from the passage's middle [m], and heading [rad]; (3, n).
    size
        Of the platform.
    width, depth
        Of the passage [m].
    """
    cos, sin = np.cos(posture[2]), np.sin(posture[2])
    x, y = (c[:, None] for c in size.corners)
    s, t = posture[0] + cos * x - sin * y, posture[1] + sin * x + cos * y  # (4, n)
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
