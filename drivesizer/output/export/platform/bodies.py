r"""The mass of a platform as bodies: its wheels, and a base that has all the rest.

The spec has the mass of all together, the inertia about the vertical through its centre, and of a wheel the inertia J
about its axle. A simulator wants bodies. A wheel gets the mass of a homogeneous disc of its inertia, and J about every
axis; the base what is left, so that mass, centre and inertia of all together are those of the spec:

.. math:: m_w = \frac{2J}{r^2}, \quad m_b = m - N m_w, \quad c_b = \frac{m c - m_w \sum p_k}{m_b}, \quad
    I_b = I - \sum_k (J + m_w |p_k - c|^2) - m_b |c_b - c|^2

p_k are the wheels' contact points. Of rolling and pitching the spec has nothing: the base is as slender as its box,
:math:`I_x : I_y : I_z = w^2 + h^2 : l^2 + h^2 : l^2 + w^2`, or flat where that is unknown.
"""

from __future__ import annotations

import numpy as np

from drivesizer.errors import InputError
from drivesizer.output.export.link import LEAST_INERTIA
from drivesizer.platform.envelope import Size
from drivesizer.platform.wheels import Platform
from drivesizer.spec.description.solids import Body

__all__ = ["split"]

_NOTHING = 1e-9  # of a wheel's radius: rounding
_LIGHT, _HEAVY = 1e-3, 0.5  # of the mass that a wheel carries: bounds of its own


def split(platform: Platform, size: Size | None) -> tuple[Body, Body]:
    """Base and one wheel of a platform.

    Parameters
    ----------
    platform
        With its mass.
    size
        Of its box, where that is known.

    Returns
    -------
    tuple of Body
        The base in the robot's frame, whose origin is on the floor; a wheel in its own.

    Raises
    ------
    InputError
        When the wheels have more inertia about the vertical than all together.
    """
    r, share = platform.wheels[0].radius, platform.mass / len(platform.wheels)
    J = max(platform.wheels[0].inertia, LEAST_INERTIA)
    disc = min(max(2.0 * J / r**2, _LIGHT * share), _HEAVY * share)
    for mass in (disc, _LIGHT * share):  # a lighter one where little of the inertia is known
        wheel = Body(mass, np.zeros(3), J * np.eye(3))
        base = _rest(platform, wheel, size)
        if base.inertia[2, 2] > 0.0:
            return base, wheel
    raise InputError(
        f"platform.inertia: {platform.inertia:.4g} kg*m^2 is less than its wheels alone have; expected that of all, "
        "without payloads"
    )


def _rest(platform: Platform, wheel: Body, size: Size | None) -> Body:
    """The base: all of a platform beside its wheels."""
    places = np.array([(w.x, w.y, w.radius) for w in platform.wheels])
    middle = np.array([platform.x, platform.y, platform.height])
    mass = platform.mass - len(places) * wheel.mass
    centre = (platform.mass * middle - wheel.mass * places.sum(axis=0)) / mass

    def levers(points: np.ndarray) -> float:
        return float(((points - middle)[..., :2] ** 2).sum())

    about = platform.inertia - len(places) * wheel.inertia[2, 2] - wheel.mass * levers(places) - mass * levers(centre)
    centre[np.abs(centre) < _NOTHING * platform.wheels[0].radius] = 0.0
    return Body(mass, centre, about * np.diag(_slenderness(size)))


def _slenderness(size: Size | None) -> tuple[float, float, float]:
    """Inertia about x, y and z over that about z, of a box or a flat plate."""
    if size is None:
        return 0.5, 0.5, 1.0
    length, width, height = size.length**2, size.width**2, size.height**2
    return (width + height) / (length + width), (length + height) / (length + width), 1.0
