"""Distance of a platform from tipping over and from lifting a wheel, at rest and along a trajectory."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform.dynamics import LEVEL, Ground, Moving, centre_acceleration, contact_loads, weight_along
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.trajectory import Trajectory, finer
from drivesizer.platform.wheels import Platform

# -- Distance of a platform from tipping over, and from lifting a wheel.
#
# It tips about an edge of the hull of its contact points, casters among them, when the line of weight and inertia
# from the centre of mass meets the floor beyond it. That point is :math:`x_c - h f / N` (zero moment point), f the
# force along the floor that the motion needs and N the weight across it. A wheel of a stiff frame on a stiff floor
# may lift before: ``contact_loads`` falls straight with the acceleration. Standing on a slope s is as accelerating
# uphill with :math:`g \tan s` on a level floor. What turns with the wheels is not counted; its moment is small
# beside m a h.


_GRID = 10**9  # lines in the platform's size, on which its contacts are put to find their hull
_FLAT = 1e-6  # of the platform's size: contact points that lie nearer to one line hold nothing up


class TippingEdge(NamedTuple):
    """A line about which the platform can tip."""

    contacts: tuple[int, int]  # wheels, then casters, counted from 1
    distance: float  # m, of the centre of mass from the vertical plane over it; below 0 it has tipped
    angle: float  # rad, of a slope at which it tips about it
    outward: float  # rad, direction in the robot's frame


# --- support polygon --------------------------------------------------------------------------------------------------


def support_polygon(platform: Platform) -> tuple[int, ...]:
    """The contacts that are the hull of all, counterclockwise; places from 0.

    Raises
    ------
    InputError
        When they lie on one line.
    """
    scale = max(math.dist(a, b) for a in platform.contacts for b in platform.contacts) or 1.0
    places = [(round(x / scale * _GRID), round(y / scale * _GRID)) for x, y in platform.contacts]
    order = sorted(range(len(places)), key=lambda i: places[i])
    lower, upper = _chain(places, order), _chain(places, order[::-1])
    hull = tuple(lower[:-1] + upper[:-1])
    area = sum(_turn(places[hull[0]], places[i], places[j]) for i, j in pairwise(hull)) if hull else 0
    if area <= _FLAT * _GRID**2:
        raise InputError("platform: its contact points lie on one line, so nothing keeps it upright; give its casters")
    return hull


def _chain(places: list[tuple[int, int]], order: list[int]) -> list[int]:
    """One half of the hull (Andrew's monotone chain), on a grid, where no turn is lost to rounding."""
    found: list[int] = []
    for i in order:
        while len(found) > 1 and _turn(places[found[-2]], places[found[-1]], places[i]) <= 0:
            found.pop()
        found.append(i)
    return found


def _turn(a: tuple[int, int], b: tuple[int, int], c: tuple[int, int]) -> int:
    """Above 0 where the way from a over b to c turns to the left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _outward(platform: Platform) -> tuple[tuple[int, ...], Array, Array]:
    """Hull, a unit vector outward of each edge (k, 2), and how far out the edge is along it (k,)."""
    hull = support_polygon(platform)
    here = np.array(platform.contacts)[list(hull)]
    along = np.roll(here, -1, axis=0) - here
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(along[:, 0], along[:, 1])[:, None]
    return hull, normal, (normal * here).sum(axis=1)


def edge_distances(platform: Platform, point: Any) -> Array:
    """Distances of a point inside each edge of the support polygon [m]; shape (edges, ...), below 0 outside.

    Parameters
    ----------
    platform
        Its contact points.
    point
        In the robot's frame [m], shape (2, ...).

    Returns
    -------
    array
        Distances [m], shape (edges, ...).

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    _, normal, out = _outward(platform)
    found = np.asarray(point, dtype=float)
    return np.asarray(out.reshape(-1, *[1] * (found.ndim - 1)) - np.tensordot(normal, found, axes=1))


def tipping_edges(platform: Platform) -> tuple[TippingEdge, ...]:
    """The edges about which a platform can tip on a level floor, the nearest first.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    hull, normal, _ = _outward(platform)
    distance = edge_distances(platform, (platform.x, platform.y))
    edges = zip(hull, (*hull[1:], hull[0]), distance, normal, strict=True)
    found = [
        TippingEdge(
            (i + 1, j + 1), float(d), math.atan2(float(d), platform.height), math.atan2(float(n[1]), float(n[0]))
        )
        for i, j, d, n in edges
    ]
    return tuple(sorted(found, key=lambda e: e.distance))


# --- the largest that it stands ---------------------------------------------------------------------------------------


def tipping_acceleration(platform: Platform, direction: float | None = None, gravity: float = LEVEL.gravity) -> float:
    """Largest acceleration on a level floor before the platform tips over [m/s^2]; infinite where none does.

    Parameters
    ----------
    platform
        Contact points, mass and centre of mass.
    direction
        Of the acceleration in the robot's frame [rad]; π is braking. The worst of all where it is not given.
    gravity
        [m/s^2].

    Returns
    -------
    float
        Acceleration [m/s^2].

    Raises
    ------
    InputError
        When the contact points lie on one line.

    Examples
    --------
    A box of half length b and height h of the centre of mass, b / h:

    >>> from drivesizer.platform.wheels import Wheel
    >>> wheels = tuple(Wheel(x=x, y=y, radius=0.1) for x in (-0.3, 0.3) for y in (-0.2, 0.2))
    >>> round(tipping_acceleration(Platform(wheels=wheels, mass=50.0, inertia=3.0, height=0.6), 0.0, 10.0), 9)
    5.0
    """
    return _largest(*_tipping(platform, gravity), direction)


def lift_off_acceleration(platform: Platform, direction: float | None = None, gravity: float = LEVEL.gravity) -> float:
    """Largest acceleration on a level floor before a wheel or caster carries nothing [m/s^2].

    On three contacts both are the same.

    Parameters
    ----------
    platform, direction, gravity
        As in ``tipping_acceleration``.

    Returns
    -------
    float
        Acceleration [m/s^2].
    """
    return _largest(*_lifting(platform, gravity), direction)


def _tipping(platform: Platform, gravity: float) -> tuple[Array, Array]:
    """Distance of the platform inside each edge, times gravity, and the share that an acceleration takes off it."""
    _, normal, _ = _outward(platform)
    inside = edge_distances(platform, (platform.x, platform.y))
    return inside * gravity, platform.height * normal


def _lifting(platform: Platform, gravity: float) -> tuple[Array, Array]:
    """Load of each contact at rest, and the share that an acceleration takes off it."""
    support_polygon(platform)  # on one line nothing keeps it upright
    at_rest, forward, left = (
        contact_loads(platform, ground=Ground(gravity=gravity), accelerated=a)
        for a in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    )
    return at_rest, np.stack([forward - at_rest, left - at_rest], axis=1)


def carrying(at_rest: Array) -> Array:
    """Whether each contact carries, or each edge of the footing lies outside the centre of mass, and not by rounding.

    Parameters
    ----------
    at_rest
        Loads [N], or distances inside the edges [m], at rest on a level floor.
    """
    return np.asarray(at_rest > _FLAT * np.abs(at_rest).max())


def used_footing(
    platform: Platform,
    together: Sequence[tuple[float, float | None]],
    *,
    tips: bool = False,
    gravity: float = LEVEL.gravity,
) -> float:
    """Share of what keeps a platform on its wheels that several accelerations take together; above 1 it does not.

    Parameters
    ----------
    platform
        Contact points, mass and centre of mass.
    together
        Size [m/s^2] and direction in the robot's frame [rad] of each; None is any, the worst for each contact. A slope
        counts as g tan s uphill.
    tips
        Whether it must tip over, rather than a wheel lift off.
    gravity
        [m/s^2].

    Returns
    -------
    float
        Share [1]; infinite where a contact carries nothing at rest.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    at_rest, change = (_tipping if tips else _lifting)(platform, gravity)
    taken = sum((size * _falls(change, direction) for size, direction in together), 0.0 * at_rest)
    if not carrying(at_rest).all():
        return math.inf
    return max(float((taken / at_rest).max()), 0.0)


def _falls(change: Array, direction: float | None) -> Array:
    """Decrease of each figure by 1 m/s² in a direction; in the worst direction where none is given."""
    if direction is None:
        return np.asarray(np.hypot(change[:, 0], change[:, 1]))
    return np.asarray(-change @ np.array([math.cos(direction), math.sin(direction)]))


def _largest(at_rest: Array, change: Array, direction: float | None) -> float:
    """From where one of the figures ``at_rest + a change · (cos, sin)`` is below 0, a along or in any direction."""
    falls = _falls(change, direction)
    falling = falls > 1e-12 * np.abs(change).max()
    if (at_rest < -_FLAT * np.abs(at_rest).max()).any():
        return 0.0
    return float(np.maximum(at_rest[falling] / falls[falling], 0.0).min(initial=math.inf))


def tipping_slope(platform: Platform, uphill: float | None = None) -> float:
    """Steepest slope on which a platform at rest does not tip over [rad].

    Parameters
    ----------
    platform
        Contact points and centre of mass.
    uphill
        In the robot's frame [rad]; the worst of all directions where it is not given.

    Returns
    -------
    float
        Slope [rad].
    """
    return math.atan(tipping_acceleration(platform, uphill, 1.0))


def lift_off_slope(platform: Platform, uphill: float | None = None) -> float:
    """Steepest slope on which every wheel and caster still carries something [rad].

    Parameters
    ----------
    platform, uphill
        As in ``tipping_slope``.

    Returns
    -------
    float
        Slope [rad].
    """
    return math.atan(lift_off_acceleration(platform, uphill, 1.0))


def zero_moment_point(
    platform: Platform, theta: Any = 0.0, ground: Ground = LEVEL, accelerated: Any = (0.0, 0.0)
) -> Array:
    """Point where the floor must push so that the platform does not tip, in the robot's frame [m]; shape (2, ...).

    Parameters
    ----------
    platform
        Mass and centre of mass.
    theta, ground
        Heading in the world [rad], and the floor.
    accelerated
        Acceleration of the centre of mass in the robot's axes [m/s^2], shape (2, ...).

    Returns
    -------
    array
        Along and across the robot [m], shape (2, ...).
    """
    pull = weight_along(platform, theta, ground)[:2]
    lever = platform.height / (platform.mass * ground.gravity * np.cos(ground.slope))
    needed = [platform.mass * np.asarray(a) - p for a, p in zip(accelerated, pull, strict=True)]
    return np.array(
        np.broadcast_arrays(*(c - lever * f for c, f in zip((platform.x, platform.y), needed, strict=True)))
    )


# -- The moments of a trajectory at which a platform is nearest to tipping over, or to lifting a wheel.


class Moment(NamedTuple):
    """The worst moment of a trajectory."""

    value: float
    time: float  # s
    contact: int  # wheel or caster, counted from 1; of an edge its first


def least_load(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL, *, share: bool = False) -> Moment:
    """The least that a wheel or caster carries over a trajectory, which, and when.

    Parameters
    ----------
    platform
        Contact points, mass and centre of mass.
    trajectory
        In the world.
    ground
        The floor, the same everywhere.
    share
        Whether as a share of what it carries on a level floor at rest: below 0 it has lifted off; minus infinity where
        it carries nothing at rest.

    Returns
    -------
    Moment
        Load [N] or share [1], time [s] and number of the contact.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    support_polygon(platform)
    fine = finer(trajectory)
    loads = contact_loads(platform, fine.posture[2], ground, centre_acceleration(platform, Moving(*fine.in_robot())))
    at_rest = contact_loads(platform, ground=Ground(gravity=ground.gravity)) if share else None
    return _worst(loads, at_rest, fine, tuple(range(len(loads))))


def least_margin(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL, *, share: bool = False) -> Moment:
    """The least distance of the zero moment point from the edge of the support polygon, where, and when.

    Parameters
    ----------
    platform, trajectory, ground
        As in ``least_load``.
    share
        Whether as a share of the distance at rest on a level floor; minus infinity where there is none.

    Returns
    -------
    Moment
        Distance [m] or share [1], time [s] and number of the contact where the edge begins.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    fine = finer(trajectory)
    point = zero_moment_point(
        platform, fine.posture[2], ground, centre_acceleration(platform, Moving(*fine.in_robot()))
    )
    at_rest = edge_distances(platform, (platform.x, platform.y)) if share else None
    return _worst(edge_distances(platform, point), at_rest, fine, support_polygon(platform))


def _worst(found: Array, at_rest: Array | None, trajectory: Trajectory, contacts: tuple[int, ...]) -> Moment:
    """The least of figures over (row, piece, end), or of them as shares of those at rest."""
    if at_rest is not None:
        carries = carrying(at_rest)[:, None, None]
        found = np.where(carries, found / np.where(carries, at_rest[:, None, None], 1.0), -math.inf)
    row, piece, side = (int(i) for i in np.unravel_index(found.argmin(), found.shape))
    return Moment(float(found[row, piece, side]), float(trajectory.time[piece, side]), contacts[row] + 1)
