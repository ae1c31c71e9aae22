r"""The link that a drive moves: axis, mass and centre of mass, in a world whose z points up.

A load that gravity turns is a mass on its lever, so that the simulator's own gravity makes the torque

.. math:: M \cos(\varphi_0 + \varphi), \qquad M = m g l s

s is the share of the weight that acts across the tilted axis. The lever's level line lies
along x; the axis is level but for its tilt, and turning forward raises the lever. Every other load turns about z, and
its mass does not count.
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

from drivesizer.output.export.common import Export

__all__ = ["LEAST_INERTIA", "Link", "Vector", "far_above", "link_of"]

Vector = tuple[float, float, float]
LEAST_INERTIA = 1e-12  # kg*m^2: no simulator takes a moving link without any
_FAR = 1e3  # lengths of the lever


class Link(NamedTuple):
    """One moving body."""

    axis: Vector  # unit vector; forward by the right-hand rule
    centre: Vector  # m, of mass, from the axis
    mass: float  # kg
    inertia: float  # kg*m^2 about its centre of mass, in every direction
    said: str  # remark


def link_of(of: Export, inertia: float) -> Link:
    """The link of a drive.

    Parameters
    ----------
    of
        The drive.
    inertia
        Of the link about the axis [kg*m^2].

    Returns
    -------
    Link
        Axis, centre, mass and inertia.
    """
    lever = of.lever
    if lever is None:
        said = "The mass does not count: the link turns about its own axis. All of the load is in its inertia."
        return Link((0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 1.0, max(inertia, LEAST_INERTIA), said)
    axis, up = _across(lever.share)
    along, high = lever.length * cos(lever.start), lever.length * sin(lever.start)
    about_centre = inertia - lever.mass * lever.length**2
    said = "One drive's share of the mass, at its position at the start of the cycle: gravity makes its torque."
    centre = (along, high * up[1], high * up[2])
    return Link(axis, centre, lever.mass, max(about_centre, LEAST_INERTIA), said)


def far_above(of: Export) -> Vector:
    """A point so far up, across the axis, that every line from it to the lever is plumb to 1e-3 [m]."""
    assert of.lever is not None
    _, up = _across(of.lever.share)
    return (0.0, _FAR * of.lever.length * up[1], _FAR * of.lever.length * up[2])


def _across(share: float) -> tuple[Vector, Vector]:
    """An axis tilted so far, and the direction across it and the level line that leads up."""
    rest = sqrt(max(1.0 - share * share, 0.0))
    return (0.0, -share, rest), (0.0, rest, share)
