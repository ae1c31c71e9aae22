"""Room that a platform needs: doors, corridors, corners, and its clearance to the jambs of passages."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drivesizer.platform.equations import Array
from drivesizer.platform.trajectory import Trajectory, control_points, halves

# -- Room that a platform needs: doors, corridors, turning on the spot, a corner between two corridors.
#
# Seen from above the platform is a rectangle, length L along its heading and width W across. At a heading error t
# from the direction of a passage it takes up :math:`W \cos t + L \sin t` while it moves along the passage with its
# heading held, whether the passage is a door or a corridor. A platform that drives along its own heading instead
# takes up :math:`(W + d \sin t) / \cos t` of a passage of depth d. Lengths in m, angles in rad.


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    """Outer box of a platform, its middle at (x, y) from the reference point."""

    length: float  # m, along the heading
    width: float  # m
    height: float  # m above the floor
    x: float = 0.0  # m, of the rectangle's middle
    y: float = 0.0  # m

    @property
    def corners(self) -> Array:
        """The four corners in the robot's frame, counterclockwise from the front right [m]; shape (2, 4)."""
        along, across = self.length / 2.0, self.width / 2.0
        shape = np.array([[along, along, -along, -along], [-across, across, across, -across]])
        return np.asarray(shape + np.array([[self.x], [self.y]]))

    @property
    def reach(self) -> float:
        """Distance of the farthest corner from the reference point [m]."""
        return float(np.hypot(*self.corners).max())


@dataclass(frozen=True, slots=True, kw_only=True)
class Passage:
    """A door or a piece of corridor; where it is in the world, if that matters."""

    name: str
    width: float  # m, between the jambs
    height: float | None = None  # m; None: open above
    depth: float = 0.0  # m, along the passage; 0 is a thin wall
    x: float = 0.0  # m, of its middle in the world
    y: float = 0.0  # m
    direction: float = 0.0  # rad, of passing through


def width_at(size: Size, heading: float, aside: float = 0.0) -> float:
    """Width that a platform takes up of a passage along which it moves [m], the same to both sides of the middle.

    Parameters
    ----------
    size
        Of the platform.
    heading
        Error of its heading against the passage [rad].
    aside
        How far its middle runs beside that of the passage [m].

    Returns
    -------
    float
        Width [m].

    Examples
    --------
    >>> round(width_at(Size(length=0.707, width=0.350, height=0.184), math.radians(3.0)), 4)
    0.3865
    """
    turned = size.width * abs(math.cos(heading)) + size.length * abs(math.sin(heading))
    return turned + 2.0 * abs(aside)


def heading_tolerance(size: Size, opening: float, aside: float = 0.0) -> float:
    """Largest heading error at which a platform passes that moves along the passage and holds its heading [rad].

    Parameters
    ----------
    size
        Of the platform.
    opening
        Width of the passage, of any depth [m].
    aside
        How far the platform's middle runs beside that of the passage [m].

    Returns
    -------
    float
        Every error up to it fits; π/2 where any heading does, NaN where not even the straight platform does.

    Examples
    --------
    >>> round(math.degrees(heading_tolerance(Size(length=0.707, width=0.350, height=0.184), 0.4)), 2)
    4.13
    """
    room, diagonal = opening - 2.0 * abs(aside), math.hypot(size.length, size.width)
    if size.width > room:
        return math.nan
    if room >= diagonal:
        return math.pi / 2.0
    return math.atan2(size.length, size.width) - math.acos(room / diagonal)


def heading_tolerance_driving(size: Size, opening: float, depth: float = 0.0, aside: float = 0.0) -> float:
    r"""Largest heading error at which a platform passes that drives straight along its own heading [rad].

    It drives through the middle of the passage, all of it: :math:`W + d \sin t \le b \cos t`. The length does not
    matter, the depth does.

    Parameters
    ----------
    size
        Of the platform.
    opening, depth
        Width and depth of the passage [m].
    aside
        How far beside the passage's middle the platform is at its centre [m].

    Returns
    -------
    float
        Every error up to it fits; NaN where not even the straight platform does.

    Examples
    --------
    >>> size = Size(length=0.707, width=0.350, height=0.184)
    >>> [round(math.degrees(heading_tolerance_driving(size, 0.4, depth)), 2) for depth in (0.0, 0.2)]
    [28.96, 11.93]
    """
    room = opening - 2.0 * abs(aside)
    if size.width > room:
        return math.nan
    return math.acos(size.width / math.hypot(room, depth)) - math.atan2(depth, room)


def turning_circle(size: Size) -> float:
    """Diameter of the circle that a platform sweeps when it turns about its reference point [m].

    About its middle that is the diagonal.

    >>> round(turning_circle(Size(length=0.707, width=0.350, height=0.184)), 4)
    0.7889
    """
    return 2.0 * size.reach


def corner_width(length: float, a: float, b: float) -> float:
    r"""Width of the widest rectangle of a length that turns through a right-angled corner of two corridors [m].

    It keeps both ends of its outer side on the outer walls. At an angle t to them the inner corner is
    :math:`a \sin t + b \cos t - L \sin t \cos t` away; the least of that is what it may be wide. A line of no width
    gives the ladder's :math:`L = (a^{2/3} + b^{2/3})^{3/2}`.

    Parameters
    ----------
    length
        Of the rectangle [m].
    a, b
        Widths of the corridors [m].

    Returns
    -------
    float
        Negative where not even a line of that length passes: by how much it is lacking.

    Notes
    -----
    Written in u = tan(t/2) the least distance is at a root of a polynomial of the fourth degree, or at an end; one more
    angle that is looked at does no harm, so complex roots need not be sorted out.

    No other way of turning needs less room: rectangle and inner corner are apart when a line along the rectangle's
    outer side parts them, or when all of it is in one corridor, which parts them so as well.
    """
    L = length
    roots = np.roots([-a - L, -2.0 * b, 6.0 * L, -2.0 * b, a - L])
    t = np.concatenate([[0.0, math.pi / 2.0], 2.0 * np.arctan(np.clip(roots.real, 0.0, 1.0))])
    return float((a * np.sin(t) + b * np.cos(t) - L * np.sin(t) * np.cos(t)).min())


# -- Clearance of a platform to the jambs of a passage along a trajectory.
#
# At each moment the part of its rectangle that is between the faces of the wall, |s| <= d/2 along the passage, takes
# up the passage from one side to the other. What is left beside it is the clearance; below 0 the jamb is hit. Pieces
# of the trajectory are halved until nothing in them moves by more than a thousandth of the passage's width, and at
# the narrowest place by a hundred-thousandth.


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
    start = np.cumsum(trajectory.duration) - trajectory.duration
    points, clearances = control_points(trajectory), []
    for passage in passages:
        x, y = points[0] - passage.x, points[1] - passage.y  # along the passage, and across it to the left
        cos, sin = math.cos(passage.direction), math.sin(passage.direction)
        turned = np.stack([cos * x + sin * y, cos * y - sin * x, points[2] - passage.direction])
        pieces, least = _Pieces(turned, start, trajectory.duration), Clearance(passage.name, math.nan, math.nan, "")
        for step in _STEPS:
            pieces = _halved(pieces, size, passage, passage.width * step)
            left, right = side_room(pieces.ends, size, passage.width, passage.depth)
            room = np.fmin(left, right)
            if np.isnan(room).all():
                break
            side, at = (int(i) for i in np.unravel_index(np.nanargmin(room), room.shape))
            if not room[side, at] >= least.least:  # written so that NaN is no least
                nearer = "left" if left[side, at] <= right[side, at] else "right"
                time = float((pieces.start + side * pieces.length)[at])
                least = Clearance(passage.name, float(room[side, at]), time, nearer)
            pieces = pieces.on(slice(max(at - 2, 0), at + 3))
        clearances.append(least)
    return tuple(clearances)


class _Pieces(NamedTuple):
    """Pieces of a motion in the passage's axes, in Bézier's form."""

    points: Array  # (3, n, 4)
    start: Array  # (n,) s
    length: Array  # (n,) s

    def on(self, index: Any) -> _Pieces:
        """Some of them."""
        return _Pieces(self.points[:, index], self.start[index], self.length[index])

    @property
    def ends(self) -> Array:
        """Postures at both ends, (3, 2, n)."""
        return np.stack([self.points[..., 0], self.points[..., 3]], axis=1)


def _halved(pieces: _Pieces, size: Size, passage: Passage, step: float) -> _Pieces:
    """Pieces near the passage, halved until nothing in one moves by more than a step; in the order of time."""
    done = [pieces.on(slice(0))]
    while pieces.start.size:
        low, high = pieces.points[:2].min(axis=-1) - size.reach, pieces.points[:2].max(axis=-1) + size.reach
        half = np.array([[passage.depth / 2.0], [passage.width / 2.0]])
        pieces = pieces.on(((low <= half) & (high >= -half)).all(axis=0))  # that may come between the jambs
        extent = np.ptp(pieces.points, axis=-1)
        small = np.hypot(extent[0], extent[1]) + size.reach * extent[2] <= step
        done.append(pieces.on(small))
        long = pieces.on(~small)
        half = long.length / 2.0
        sides = zip(halves(long.points), (long.start, long.start + half), strict=True)
        pieces = _joined([_Pieces(points, start, half) for points, start in sides])
    near = _joined(done)
    return near.on(np.argsort(near.start, kind="stable"))


def _joined(parts: list[_Pieces]) -> _Pieces:
    points, start, length = zip(*parts, strict=True)
    return _Pieces(np.concatenate(points, axis=1), np.concatenate(start), np.concatenate(length))


def side_room(posture: Array, size: Size, width: float, depth: float) -> tuple[Array, Array]:
    """Room to the left and to the right jamb [m]; NaN where nothing of the platform is between them."""
    cos, sin = np.cos(posture[2]), np.sin(posture[2])
    x, y = (c.reshape(-1, *[1] * cos.ndim) for c in size.corners)
    s, t = posture[0] + cos * x - sin * y, posture[1] + sin * x + cos * y  # (4, ...)
    offsets = [np.where(np.abs(s) <= depth / 2.0, t, np.nan)]
    to_s, to_t = np.roll(s, -1, axis=0), np.roll(t, -1, axis=0)
    for face in {-depth / 2.0, depth / 2.0}:  # where the edges enter the wall and leave it
        crosses = (s - face) * (to_s - face) < 0.0
        share = np.where(crosses, face - s, 0.0) / np.where(crosses, to_s - s, 1.0)
        offsets.append(np.where(crosses, t + share * (to_t - t), np.nan))
    places = np.concatenate(offsets)
    most, least = np.fmax.reduce(places, axis=0), np.fmin.reduce(places, axis=0)
    inside = (most > -width / 2.0) & (least < width / 2.0)
    return np.where(inside, width / 2.0 - most, np.nan), np.where(inside, width / 2.0 + least, np.nan)
