r"""Loads along a line, seen from the shaft that moves them through a drum, a pinion or a screw.

.. math:: T = \frac{1}{N} \left( \frac{F r}{e} + J α + T_d \, \mathrm{sgn} ω \right) \; (F v > 0), \qquad
          \frac{1}{N} \left( F r e_b + J α + T_d \, \mathrm{sgn} ω \right) \; (F v < 0)

The force F on what moves, its own inertia included, goes through the stage with its losses; what turns with the shaft
does not. At rest nothing is lost or won, T = F r / N: the ideal holding torque, whatever friction may help to hold; and
nothing at all where the stage is self-locking (e_b not above 0), because then it holds by itself.
F is linear within a segment of the motion, so that the segments are cut exactly where the power turns round.

Source: maxon Formulae Handbook (J. Braun), mechanical drives: efficiency in either direction of power.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drivesizer.loads.course import Course
from drivesizer.physics.load_cycle import Ends, LoadCycle

__all__ = ["OnIncline", "force_along", "through_stage"]


class OnIncline(Protocol):
    """A load that is moved along an incline, with friction."""

    @property
    def mass(self) -> float:
        """Of what climbs [kg]."""

    @property
    def incline(self) -> float:
        """Of the forward motion, upward positive [rad]."""

    @property
    def friction_coefficient(self) -> float:
        """Of what rubs on its guide or bed."""

    @property
    def friction_force(self) -> float:
        """Of seals and scrapers, against the motion [N]."""

    @property
    def force(self) -> float:
        """Further force against the forward motion, at rest too [N]."""


def force_along(course: Course, load: OnIncline, gravity: float, moved: NDArray[np.float64] | float) -> Ends:
    """Force that moves a load along its incline: friction, weight, further force and inertia [N].

    Parameters
    ----------
    course
        How the load moves.
    load
        What is moved; its ``mass`` climbs.
    gravity
        Acceleration of free fall [m/s^2].
    moved
        What rubs and is accelerated, the load's mass among it, a payload of the course not [kg].

    Returns
    -------
    array
        Force at both ends of each segment [N], shape (segments, 2).
    """
    moved, climbing = moved + course.payload, load.mass + course.payload
    friction = load.friction_coefficient * moved * gravity * math.cos(load.incline) + load.friction_force
    climb = climbing * gravity * math.sin(load.incline)
    force: Ends = friction * course.direction + (climb + load.force) + moved * course.acceleration
    return force


def through_stage(
    course: Course,
    force: Ends,
    radius: float,
    efficiency: tuple[float, float],
    *,
    mass: float,
    turning: float,
    motors: int,
    drag: float = 0.0,
) -> LoadCycle:
    """Load cycle at the shaft, with the losses of a stage.

    Parameters
    ----------
    course
        How the load moves.
    force
        That moves it against all that resists, its inertia included, at both ends of each segment [N].
    radius
        Travel of the load per angle of the shaft [m].
    efficiency
        Of the stage when the shaft drives the load and when the load drives the shaft; the latter below 0 where the
        shaft has to drive even then.
    mass
        Of all that moves along the line, but a payload of the course [kg].
    turning
        Inertia of what turns with the shaft [kg*m^2].
    motors
        Number of drives that share the load equally.
    drag
        Torque against the motion at the shaft, whatever the force [N*m].

    Returns
    -------
    LoadCycle
        At the shaft of one drive, cut where the direction of power changes.
    """
    forward, backward = efficiency
    ideal = course.cycle(force * radius, radius)
    direction = np.sign(ideal.speed.mean(axis=1, keepdims=True))
    flow = direction * np.sign(ideal.torque.mean(axis=1, keepdims=True))
    at_rest = 1.0 if backward > 0.0 else 0.0
    factor = np.where(flow > 0.0, 1.0 / forward, np.where(flow < 0.0, backward, at_rest))
    torque = ideal.torque * factor + turning * ideal.acceleration + drag * direction
    inertia = turning + (mass + course.heaviest) * radius * radius
    return replace(ideal, torque=torque / motors, inertia=inertia / motors).split()
