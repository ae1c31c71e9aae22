"""The moments of a trajectory at which a platform is nearest to tipping over, or to lifting a wheel."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from drivesizer.platform.contact_loads import LEVEL, Ground, centre_acceleration, contact_loads
from drivesizer.platform.extremes_between_samples import finer
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.stability import carrying, edge_distances, support_polygon, zero_moment_point
from drivesizer.platform.trajectory import Trajectory
from drivesizer.platform.wheels import Platform

__all__ = ["Moment", "least_load", "least_margin", "least_margin_share", "least_share", "of_centre"]


class Moment(NamedTuple):
    """The worst moment of a trajectory."""

    value: float
    time: float  # s
    contact: int  # wheel or caster, counted from 1; of an edge its first


def of_centre(platform: Platform, trajectory: Trajectory) -> Array:
    """Acceleration of the centre of mass along a trajectory, in the robot's axes [m/s^2]; shape (2, n, 2).

    Parameters
    ----------
    platform
        Where its centre of mass is.
    trajectory
        In the world, n pieces.

    Returns
    -------
    array
        Along and across the robot [m/s^2], shape (2, n, 2).
    """
    return centre_acceleration(platform, *trajectory.in_robot())


def least_load(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL) -> Moment:
    """The least that a wheel or caster carries over a trajectory [N], which, and when.

    Parameters
    ----------
    platform
        Contact points, mass and centre of mass.
    trajectory
        In the world.
    ground
        The floor, the same everywhere.

    Returns
    -------
    Moment
        Load [N], time [s] and number of the contact.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    support_polygon(platform)
    fine = finer(trajectory)
    loads = contact_loads(platform, fine.posture[2], ground, of_centre(platform, fine))
    return _worst(loads, fine, tuple(range(len(loads))))


def least_share(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL) -> Moment:
    """The least that a wheel or caster carries over a trajectory as a share of what it does on a level floor at rest.

    Below 0 it has lifted off; minus infinity where it carries nothing at rest.

    Parameters
    ----------
    platform, trajectory, ground
        As in ``least_load``.

    Returns
    -------
    Moment
        Share [1], time [s] and number of the contact.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    support_polygon(platform)
    fine = finer(trajectory)
    loads = contact_loads(platform, fine.posture[2], ground, of_centre(platform, fine))
    at_rest = contact_loads(platform, ground=Ground(gravity=ground.gravity))
    return _worst(_share(loads, at_rest), fine, tuple(range(len(loads))))


def least_margin(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL) -> Moment:
    """The least distance of the zero moment point from the edge of the support polygon [m], where, and when.

    Parameters
    ----------
    platform, trajectory, ground
        As in ``least_load``.

    Returns
    -------
    Moment
        Distance [m], time [s] and number of the contact where the edge begins.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    fine = finer(trajectory)
    point = zero_moment_point(platform, fine.posture[2], ground, of_centre(platform, fine))
    return _worst(edge_distances(platform, point), fine, support_polygon(platform))


def least_margin_share(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL) -> Moment:
    """The same as a share of the distance at rest on a level floor; minus infinity where there is none.

    Parameters
    ----------
    platform, trajectory, ground
        As in ``least_load``.

    Returns
    -------
    Moment
        Share [1], time [s] and number of the contact where the edge begins.

    Raises
    ------
    InputError
        When the contact points lie on one line.
    """
    fine = finer(trajectory)
    point = zero_moment_point(platform, fine.posture[2], ground, of_centre(platform, fine))
    found, at_rest = edge_distances(platform, point), edge_distances(platform, (platform.x, platform.y))
    return _worst(_share(found, at_rest), fine, support_polygon(platform))


def _share(found: Array, at_rest: Array) -> Array:
    """Figures over (row, piece, end) as shares of those at rest."""
    carries = carrying(at_rest)[:, None, None]
    return np.where(carries, found / np.where(carries, at_rest[:, None, None], 1.0), -math.inf)


def _worst(found: Array, trajectory: Trajectory, contacts: tuple[int, ...]) -> Moment:
    """The least of figures over (row, piece, end)."""
    row, piece, side = (int(i) for i in np.unravel_index(found.argmin(), found.shape))
    return Moment(float(found[row, piece, side]), float(trajectory.time[piece, side]), contacts[row] + 1)
