r"""A slide on a lead screw or a ball screw, seen from the screw.

.. math:: F = m g \sin β + μ m g \cos β \, \mathrm{sgn} v + F_f \, \mathrm{sgn} v + F_0 + m a, \qquad r = \frac{L}{2 π}

With :math:`F r / e` where the screw drives the slide and :math:`F r e_b` where the slide drives the screw
(``stage_losses``),
and on top of either the drag of a preloaded nut and the inertia of the screw. e_b is 2 - 1/e where it is not given:
the same torque is lost in either direction. With e_b below 0 the screw is self-locking: the slide cannot turn it, and
to lower a load the motor has to drive too, with a torque of :math:`|F| r |e_b|`; e_b is taken as it stands, not as 0.
For a square thread e = tan λ / tan(λ + ρ) and e_b = tan(λ - ρ) / tan λ, lead angle λ and angle of friction ρ; there
2 - 1/e makes lowering on a self-locking screw a few per cent too heavy. At rest the screw holds F r, a
self-locking one nothing.

Worked examples: 20 kN on a lead of 10 mm at 70 % efficiency: 20 000 · 0.010 / (2π · 0.7) = 45.5 N·m
(engineeringprep.com, problem 516). A slide of 40 kg, μ 0.05, lead 15 mm, e = 0.9, with a nut preloaded by a third of
19.6 N at a coefficient of 0.3: 19.6 · 0.015 / (2π · 0.9) + 0.3 · 6.53 · 0.015 / 2π = 0.0567 N·m (Oriental Motor,
technical reference, motor sizing: ball screw).
"""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from drivesizer.files.fields import (
    Axis,
    Coefficient,
    Force,
    Incline,
    Length,
    Mass,
    Pull,
    Quantity,
    Share,
    Torque,
    default,
)
from drivesizer.files.inertia import Inertia
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.loads.stage_losses import force_along, through_stage
from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["Screw", "screw"]

BackEfficiency = Annotated[float, Quantity("dimensionless", most=1.0)]


class Screw(SharedLoad):
    """A lead screw or ball screw that moves a slide, level to upright."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = True
    kind: Literal["lead_screw", "ball_screw"]
    mass: Mass = Field(description="of the slide and what is on it")
    lead: Length = Field(description="travel per turn")
    efficiency: Share = Field(description="of screw and nut when it drives the slide")
    back_efficiency: BackEfficiency | None = Field(
        default=None, description="when the slide drives it; 2 - 1/efficiency where not given, below 0 is self-locking"
    )
    incline: Incline = default("0 deg", description="of the forward motion, upward positive; 90 deg lifts")
    friction_coefficient: Coefficient = Field(default=0, description="of the guide")
    friction_force: Force = default("0 N", description="of the guide's seals, against the motion")
    force: Pull = default("0 N", description="further force against the forward motion, at rest too")
    preload_torque: Torque = default("0 N*m", description="drag of a preloaded nut and its bearings")
    inertia: Inertia = Field(description="of screw and coupling")


@np.errstate(over="ignore", invalid="ignore")  # the load cycle refuses what is not finite
def screw(load: Screw, gravity: float, course: Course) -> LoadCycle:
    """Load cycle at the screw.

    Parameters
    ----------
    load
        The slide and its screw.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the slide moves.

    Returns
    -------
    LoadCycle
        At the screw of one drive: speed [rad/s], torque [N*m], per segment its two ends.

    Raises
    ------
    InputError
        When a figure leaves the range of numbers that can be computed with.
    """
    force = force_along(course, load, gravity, load.mass)
    losses = (load.efficiency, _back_efficiency(load))
    radius = load.lead / (2 * math.pi)
    return through_stage(course, force, radius, losses, mass=load.mass, turning=load.inertia, motors=load.motors,
                         drag=load.preload_torque)  # fmt: skip


def _back_efficiency(load: Screw) -> float:
    """Given, or such that the same torque is lost in either direction of power; below 0 is self-locking."""
    return 2.0 - 1.0 / load.efficiency if load.back_efficiency is None else load.back_efficiency
