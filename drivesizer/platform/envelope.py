r"""Room that a platform needs: doors, corridors, turning on the spot, a corner between two corridors.

Seen from above the platform is a rectangle, length L along its heading and width W across. At a heading error t from
the direction of a passage it takes up :math:`W \cos t + L \sin t` while it moves along the passage with its heading
held, whether the passage is a door or a corridor. A platform that drives along its own heading instead takes up
:math:`(W + d \sin t) / \cos t` of a passage of depth d. Lengths in m, angles in rad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform.matrix_equation import Array

__all__ = [
    "Passage", "Size", "corner_width", "heading_tolerance", "heading_tolerance_driving", "turning_circle", "width_at",
]  # fmt: skip


def _checked(record: object, what: str, **figures: float) -> None:
    for name, value in figures.items():
        if not 0.0 < value < math.inf:  # written so that NaN fails too
            raise InputError(f"{what}: {name} must be above 0, got {value!r}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    """Outer box of a platform, its middle at (x, y) from the reference point."""

    length: float  # m, along the heading
    width: float  # m
    height: float  # m above the floor
    x: float = 0.0  # m, of the rectangle's middle
    y: float = 0.0  # m

    def __post_init__(self) -> None:
        _checked(self, "size", length=self.length, width=self.width, height=self.height)
        if not math.isfinite(self.x) or not math.isfinite(self.y):
            raise InputError("size: x and y must be finite numbers")

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

    def __post_init__(self) -> None:
        _checked(self, f"passage {self.name}", width=self.width)
        if self.height is not None:
            _checked(self, f"passage {self.name}", height=self.height)
        if not 0.0 <= self.depth < math.inf:
            raise InputError(f"passage {self.name}: depth must be 0 or more, got {self.depth!r}")
        if not all(math.isfinite(v) for v in (self.x, self.y, self.direction)):
            raise InputError(f"passage {self.name}: x, y and direction must be finite numbers")


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


def corner_width(length: float, one: float, other: float) -> float:
    r"""Width of the widest rectangle of a length that turns through a right-angled corner of two corridors [m].

    It keeps both ends of its outer side on the outer walls. At an angle t to them the inner corner is
    :math:`a \sin t + b \cos t - L \sin t \cos t` away; the least of that is what it may be wide. A line of no width
    gives the ladder's :math:`L = (a^{2/3} + b^{2/3})^{3/2}`.

    Parameters
    ----------
    length
        Of the rectangle [m].
    one, other
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
    a, b, L = one, other, length
    roots = np.roots([-a - L, -2.0 * b, 6.0 * L, -2.0 * b, a - L])
    t = np.concatenate([[0.0, math.pi / 2.0], 2.0 * np.arctan(np.clip(roots.real, 0.0, 1.0))])
    return float((a * np.sin(t) + b * np.cos(t) - L * np.sin(t) * np.cos(t)).min())
