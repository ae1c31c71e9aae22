r"""Mass, centre and inertia of solids of even density, and of several together.

.. math::
    \text{box } a, b, c \text{ (half sizes): } V = 8abc, \; J_x = m \frac{b^2 + c^2}{3} \qquad
    \text{ellipsoid: } V = \tfrac{4}{3} π abc, \; J_x = m \frac{b^2 + c^2}{5}

    \text{cylinder } r, h \text{ (half length): } V = 2πr^2h, \; J_z = \frac{m r^2}{2}, \;
    J_x = m \left( \frac{r^2}{4} + \frac{h^2}{3} \right)

A capsule is a cylinder and two half spheres, whose centres of mass are 3r/8 beyond its ends:

.. math::
    m_s = m \frac{2r}{2r + 3h}, \quad J_z = \frac{(m - m_s) r^2}{2} + \frac{2 m_s r^2}{5}, \quad
    J_x = (m - m_s) \left( \frac{r^2}{4} + \frac{h^2}{3} \right)
    + m_s \left( \frac{2r^2}{5} + h^2 + \frac{3rh}{4} \right)

Source: handbooks of mechanics, e.g. Dubbel, moments of inertia of bodies; bodies together by Steiner's theorem.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Body", "shape_of", "together"]

Array = NDArray[np.float64]


class Body(NamedTuple):
    """A rigid body in some frame."""

    mass: float  # kg
    centre: Array  # m, of mass
    inertia: Array  # kg*m^2, 3 x 3, about the centre of mass


def shape_of(kind: str, size: Sequence[float]) -> tuple[float, Array]:
    """Volume of a solid about its own centre, and inertia by mass.

    Examples
    --------
    >>> shape_of("box", (0.5, 1.0, 1.5))
    (6.0, array([1.0833, 0.8333, 0.4167]))
    """
    if kind in ("box", "ellipsoid", "sphere"):
        a, b, c = size if len(size) == 3 else (size[0],) * 3
        volume = 8.0 * a * b * c if kind == "box" else 4.0 / 3.0 * math.pi * a * b * c
        share = 3.0 if kind == "box" else 5.0
        return volume, np.array([b * b + c * c, a * a + c * c, a * a + b * b]) / share
    r, h = size
    shell = 2.0 * r / (2.0 * r + 3.0 * h) if kind == "capsule" else 0.0  # share of both ends
    across = (1.0 - shell) * (r * r / 4.0 + h * h / 3.0) + shell * (0.4 * r * r + h * h + 0.75 * r * h)
    along = (1.0 - shell) * r * r / 2.0 + shell * 0.4 * r * r
    ends = 4.0 / 3.0 * math.pi * r**3 if kind == "capsule" else 0.0
    return 2.0 * math.pi * r * r * h + ends, np.array([across, across, along])


def together(bodies: Sequence[Body]) -> Body:
    """Several bodies of one frame as one."""
    mass = sum(body.mass for body in bodies)
    centre = sum((body.mass * body.centre for body in bodies), np.zeros(3))
    centre = centre / mass if mass > 0.0 else centre
    inertia = np.zeros((3, 3))
    for body in bodies:
        arm = body.centre - centre
        inertia = inertia + body.inertia + body.mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Body(mass, centre, inertia)
