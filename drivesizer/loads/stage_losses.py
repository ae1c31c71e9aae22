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

from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import Ends, LoadCycle


class OnIncline(Protocol):
    """A load that is moved along an incline, with friction; figures, or columns over samples."""

    mass: float  # kg, of what climbs
    incline: float  # rad, of the forward motion, upward positive
    friction_coefficient: float  # of what rubs on its guide or bed
    friction_force: float  # N, of seals and scrapers, against the motion
    force: float  # N, further force against the forward motion, at rest too


def force_along(course: Course, load: OnIncline, gravity: Figure, mass: Figure) -> Ends:
    """Force that moves a load along its incline: friction, weight, further force, springs and inertia [N].

    Parameters
    ----------
    course
        How the load moves.
    load
        What is moved; its ``mass`` climbs.
    gravity
        Acceleration of free fall [m/s^2].
    mass
        What rubs and is accelerated, the load's mass among it, a payload of the course not [kg].

    Returns
    -------
    array
        Force at both ends of each segment [N], shape (segments, 2, ...).
    """
    mass, climbing = mass + course.payload, load.mass + course.payload
    friction = load.friction_coefficient * mass * gravity * np.cos(load.incline) + load.friction_force
    climb = climbing * gravity * np.sin(load.incline)
    force: Ends = friction * course.direction + (climb + load.force) + mass * course.acceleration
    return force + course.resisting


def through_stage(
    course: Course, force: Ends, radius: Figure, efficiency: tuple[Figure, Figure], *, mass: Figure, turning: Figure,
    motors: int, drag: Figure = 0.0,
) -> LoadCycle:  # fmt: skip
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
    ideal = course.cycle(force * radius, radius)
    torque = ideal.torque * _factor(ideal, *efficiency) + turning * ideal.acceleration + drag * ideal.direction
    inertia = turning + (mass + course.heaviest + course.balance) * radius * radius
    return replace(ideal, torque=torque / motors, inertia=inertia / motors).split()


def _factor(cycle: LoadCycle, forward: Figure, backward: Figure) -> Ends:
    """By which a stage changes a torque that drives, is driven, or holds: nothing holds a stage that locks itself."""
    flow = cycle.direction * np.sign(cycle.torque.mean(axis=1, keepdims=True))
    at_rest = np.where(np.greater(backward, 0.0), 1.0, 0.0)
    return np.where(flow > 0.0, 1.0 / forward, np.where(flow < 0.0, backward, at_rest))


# -- A gear of fixed ratio behind gearhead or belt: the load cycle at its input shaft.
#
# .. math:: T_w = T + J_w α + T_{f,w} \, \mathrm{sgn} ω, \qquad
#           T_1 = \frac{T_w}{i e} \; (T_w ω > 0), \quad \frac{T_w e_b}{i} \; (T_w ω < 0), \quad
#           \frac{T_w}{i} \; (ω = 0), \\
#           T_{in} = T_1 + J_p \, i α + T_{f,p} \, \mathrm{sgn} ω, \qquad ω_{in} = i ω, \quad
#           J_{in} = J_p + \frac{J + J_w}{i^2}
#
# Index w is of what turns with the output shaft, p of what turns with the input shaft; J inertia, T_f friction at
# any load. Losses follow the direction of power. With e_b not above 0 the gear is self-locking: the motor drives
# even where the load would, and at rest nothing reaches the motor.
#
# Worked example: a slide of 250 kg, μ 0.2, on a screw of 10 mm lead and 20 mm by 1 m, efficiency 0.9, behind a gear
# of 2 : 1 with 0.40 kg·cm²: 0.43 N·m and 2.29 kg·cm² at the motor (Yaskawa, servomotor selection, selection
# calculations). Source of the losses by direction: maxon Formulae Handbook (J. Braun), mechanical drives.


class FixedGear(NamedTuple):
    """A gear between two shafts, SI."""

    ratio: Alike  # turns of the input shaft per turn of the output shaft
    efficiency: Alike  # when the input shaft drives
    back_efficiency: Alike  # when the output shaft drives; not above 0: self-locking
    pinion_inertia: Alike = 0.0  # kg*m^2, turns with the input shaft
    wheel_inertia: Alike = 0.0  # kg*m^2, turns with the output shaft
    pinion_friction: Alike = 0.0  # N*m, at the input shaft, at any load
    wheel_friction: Alike = 0.0  # N*m, at the output shaft


def through_gear(cycle: LoadCycle, gear: FixedGear) -> LoadCycle:
    """The load cycle at the input shaft of a gear.

    Parameters
    ----------
    cycle
        At its output shaft.
    gear
        The gear.

    Returns
    -------
    LoadCycle
        At its input shaft, cut where the direction of power changes.
    """
    i = gear.ratio
    torque = cycle.torque + gear.wheel_inertia * cycle.acceleration + gear.wheel_friction * cycle.direction
    at_wheel = replace(cycle, torque=torque).split()
    acceleration = at_wheel.acceleration * i
    torque = at_wheel.torque * _factor(at_wheel, gear.efficiency, gear.back_efficiency) / i
    torque = torque + gear.pinion_inertia * acceleration + gear.pinion_friction * at_wheel.direction
    return replace(
        at_wheel, speed=at_wheel.speed * i, acceleration=acceleration, torque=torque, radius=cycle.radius / i,
        inertia=gear.pinion_inertia + (cycle.inertia + gear.wheel_inertia) / i**2,
        holding_torque=cycle.holding_torque * np.where(np.greater(gear.back_efficiency, 0.0), 1.0, 0.0) / i,
    ).split()  # fmt: skip
