r"""Torques of a platform's wheels, and the motion that they make.

In the robot's frame, (49): :math:`\bar M \dot η + \bar C η = E^T τ + F`, with

- :math:`\bar M = M_R + E^T M_ϕ E` (50): platform and wheels, rotors among them; the centre of mass may lie off the
  reference point, which couples turning and moving;
- :math:`\bar C` (51), skew-symmetric: it does no work;
- F: weight on a slope, and what resists at the wheels and casters.

Where the set of wheels does not allow every motion, η = S ν and the equation is taken along S: what the wheels hold
does no work. n driven wheels and m motions leave n − m torques open; of all that make the motion, those with the least
sum of squares are given (or of squares over weights), :math:`τ = D (\bar M \dot η + \bar C η - F)`, by the
Moore-Penrose inverse :math:`D = (S^T E^T)^+ S^T`. In the wheels' own space this is (57)-(59).

Rolling resistance is against each wheel's turning and nothing at rest, C_rr N r; N is what the wheel carries at rest.
Its direction at a start is that of ``towards``; what turns no faster than a billionth of the platform's speed stands.
No efficiency is in here: that is the drive's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform import equations_dynamics as eq
from drivesizer.platform.contact_loads import LEVEL, Ground, contact_loads, weight_along
from drivesizer.platform.kinematics import Kinematics, check_allowed, columns, kinematics, map_columns, row_sizes
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.wheels import Platform

__all__ = [
    "Dynamics", "acceleration", "dynamics", "energy", "own_rolling", "required_force", "resistance", "signs",
    "wheel_space", "wheel_torques",
]  # fmt: skip

_ROUNDING = 1e-9  # of the platform's speed: what turns or rolls no faster stands


@dataclass(frozen=True, slots=True, eq=False)
class Dynamics:
    """The matrices of a platform."""

    platform: Platform
    kinematics: Kinematics
    M: Array  # (3, 3), (50): inertia of platform and wheels
    C: Array  # (3, 3), (51) at 1 rad/s
    distribution: Array  # (n, 3), D: torques of the driven wheels over force and moment on the platform


def dynamics(platform: Platform, weights: Sequence[float] | None = None) -> Dynamics:
    """The matrices of a platform.

    Parameters
    ----------
    platform
        Wheels and mass.
    weights
        Of the driven wheels, where torque is not shared alike: one with twice the weight takes twice the torque of
        another in the same place.

    Returns
    -------
    Dynamics
        Platform, kinematics, and the matrices of (41) and (59).

    Raises
    ------
    InputError
        When the wheels are singular (see ``kinematics``) or a weight is not above 0.
    """
    k, p = kinematics(platform.wheels), platform
    M_R = eq.mass_matrix(p.mass, p.inertia + p.mass * (p.x**2 + p.y**2), p.x, p.y)
    M_phi = eq.wheel_inertias(np.array([w.inertia + w.rotor_inertia for w in p.wheels]))
    M, C = eq.inertia_matrix(M_R, k.E, M_phi), eq.coriolis_matrix(1.0, p.mass, p.x, p.y)
    return Dynamics(p, k, M, C, _distribution(k, weights))


def _distribution(k: Kinematics, weights: Sequence[float] | None) -> Array:
    """D: of all torques that make a force, those with the least sum of squares over weights."""
    share = np.ones(len(k.driven)) if weights is None else columns(weights, len(k.driven), "weights")
    if not (share > 0.0).all():
        raise InputError(f"weights: must be above 0, got {', '.join(f'{w:g}' for w in share)}")
    root = np.sqrt(share)[:, None]
    return np.asarray(root * (np.linalg.pinv((root * (k.E[list(k.driven)] @ k.motions)).T) @ k.motions.T))


def signs(rows: Array, eta: Array, reach: float) -> Array:
    """Signs of rows times velocities; 0 where that is nothing beside what so fast a motion makes in other directions.

    Parameters
    ----------
    rows
        Speeds of wheels or rollers over velocity, shape (n, 3).
    eta
        Velocity in the robot's frame [m/s, m/s, rad/s], shape (3, ...).
    reach
        Of the platform [m].

    Returns
    -------
    array
        -1, 0 or 1, shape (n, ...).
    """
    flat = eta.reshape(3, -1)
    value, least = rows @ flat, np.outer(_ROUNDING * row_sizes(rows, reach), _speed(flat, reach))
    value[np.abs(value) <= least] = 0.0
    return np.sign(value, out=value).reshape(-1, *eta.shape[1:])


def _speed(eta: Array, reach: float) -> Array:
    """Of the platform, of its driving and its turning together [m/s]."""
    return np.asarray(np.hypot(eta[0], eta[1]) + reach * np.abs(eta[2]))


def own_rolling(d: Dynamics, loads: Array) -> Array:
    """Torque that each wheel itself takes to roll on, about its own axis [N*m], shape (wheels, ...).

    Parameters
    ----------
    d
        The platform.
    loads
        What wheels, then casters, carry [N], shape (wheels and casters, ...).

    Returns
    -------
    array
        Torques [N*m], shape (wheels, ...).
    """
    wheels = d.platform.wheels
    C_rr, r, friction = np.array([(w.rolling_resistance, w.radius, w.friction) for w in wheels]).T
    across = (slice(None),) + (None,) * (loads.ndim - 1)
    return np.asarray((C_rr * r)[across] * np.maximum(loads[: len(wheels)], 0.0) + friction[across])


def resistance(d: Dynamics, towards: Array, theta: Any = 0.0, ground: Ground = LEVEL) -> Array:
    """Force and moment that wheels, rollers and casters need to roll on [N, N, N*m]; shape (3, ...).

    Parameters
    ----------
    d
        The platform.
    towards
        Velocity whose direction counts [m/s, m/s, rad/s], shape (3, ...).
    theta, ground
        Heading in the world [rad], and the floor. A wheel that would lift off carries nothing and resists nothing.

    Returns
    -------
    array
        Along, across and about the vertical [N, N, N*m], shape (3, ...).
    """
    wheels, casters, k = d.platform.wheels, d.platform.casters, d.kinematics
    C_rr, C_roller, friction = np.array([(w.rolling_resistance, w.roller_resistance, w.friction) for w in wheels]).T
    crawl = np.array([c.rolling_resistance for c in casters])
    if not (C_rr.any() or C_roller.any() or friction.any() or crawl.any()):
        return np.zeros_like(towards)
    loads = np.maximum(contact_loads(d.platform, theta, ground, samples=towards.shape[1:]), 0.0)
    carried, across = loads[: len(wheels)], (slice(None),) + (None,) * (towards.ndim - 1)
    torque = own_rolling(d, loads) * signs(k.E, towards, k.reach)
    total = map_columns(k.E.T, torque)
    if C_roller.any():
        total = total + map_columns(k.rollers.T, C_roller[across] * carried * signs(k.rollers, towards, k.reach))
    for c, load in zip(casters, loads[len(wheels) :], strict=True):
        x, y = towards[0] - c.y * towards[2], towards[1] + c.x * towards[2]
        size = np.hypot(x, y)
        rolls = size > _ROUNDING * _speed(towards, k.reach + math.hypot(c.x, c.y))
        pull = c.rolling_resistance * load * rolls / np.where(rolls, size, 1.0)
        total = total + pull * np.array([x, y, c.x * y - c.y * x])
    return np.asarray(total)


def required_force(
    d: Dynamics, eta: Any, eta_dot: Any, *, theta: Any = 0.0, ground: Ground = LEVEL, towards: Any = None
) -> Array:
    """Force and moment that the driven wheels must make for a motion [N, N, N*m], in the robot's axes; shape (3, ...).

    Parameters
    ----------
    d
        The platform.
    eta, eta_dot
        Velocity [m/s, m/s, rad/s] and its rate of change in the robot's frame, shape (3, ...).
    theta, ground, towards
        As in ``wheel_torques``.

    Returns
    -------
    array
        Along, across and about the vertical [N, N, N*m], shape (3, ...).

    Raises
    ------
    InputError
        When the wheels do not allow the motion, or a figure is not finite.
    """
    eta, eta_dot = columns(eta, 3, "velocity of the platform"), columns(eta_dot, 3, "acceleration of the platform")
    check_allowed(d.kinematics, eta, "velocity of the platform")
    check_allowed(d.kinematics, eta_dot, "acceleration of the platform", "m/s^2")
    rolling = eta if towards is None else columns(towards, 3, "direction of rolling")
    inertia = map_columns(d.M, eta_dot) + eta[2] * map_columns(d.C, eta)
    return np.asarray(inertia - _weight(d, eta, theta, ground) + resistance(d, rolling, theta, ground))


def _weight(d: Dynamics, eta: Array, theta: Any, ground: Ground) -> Array:
    """The weight along the floor, with as many axes as a velocity."""
    force = weight_along(d.platform, theta, ground)
    return force.reshape(3, *[1] * (eta.ndim - 1)) if force.ndim == 1 else force


def wheel_torques(
    d: Dynamics,
    eta: Any,
    eta_dot: Any,
    *,
    theta: Any = 0.0,
    ground: Ground = LEVEL,
    towards: Any = None,
    rotors: bool = True,
) -> Array:
    """Torques of the driven wheels that make a motion [N*m], shape (n, ...).

    Parameters
    ----------
    d
        The platform.
    eta, eta_dot
        Velocity [m/s, m/s, rad/s] and its rate of change [m/s^2, m/s^2, rad/s^2] in the robot's frame, shape (3, ...).
    theta
        Heading in the world [rad], where the floor slopes; one, or one per sample.
    ground
        The floor.
    towards
        Velocity whose direction the resistances take, shape (3, ...); ``eta`` when not given. At rest in ``eta`` it
        says where the platform is about to go.
    rotors
        Whether what turns the driven wheels' own rotors is in. Without it the torques are those of a load cycle, to
        which the drive model adds its rotor.

    Returns
    -------
    array
        Torques [N*m], shape (n, ...).

    Raises
    ------
    InputError
        When the wheels do not allow the motion, or a figure is not finite.
    """
    force = required_force(d, eta, eta_dot, theta=theta, ground=ground, towards=towards)
    torque = map_columns(d.distribution, force)
    if rotors:
        return torque
    driven = list(d.kinematics.driven)
    own = np.array([d.platform.wheels[i].rotor_inertia for i in driven])
    return torque - map_columns(own[:, None] * d.kinematics.E[driven], np.asarray(eta_dot, dtype=float))


def acceleration(d: Dynamics, eta: Any, torques: Any, *, theta: Any = 0.0, ground: Ground = LEVEL) -> Array:
    """Rate of change of the velocity under torques [m/s^2, m/s^2, rad/s^2], in the robot's frame; shape (3, ...).

    Parameters
    ----------
    d
        The platform.
    eta
        Velocity in the robot's frame [m/s, m/s, rad/s], shape (3, ...); at rest nothing resists.
    torques
        Of the driven wheels, rotors included [N*m], shape (n, ...).
    theta, ground
        Heading in the world [rad], and the floor.

    Returns
    -------
    array
        [m/s^2, m/s^2, rad/s^2], shape (3, ...).

    Raises
    ------
    InputError
        When a figure is not finite.
    """
    k, eta = d.kinematics, columns(eta, 3, "velocity of the platform")
    tau = columns(torques, len(k.driven), "torques of the driven wheels")
    force = map_columns(k.E[list(k.driven)].T, tau) - eta[2] * map_columns(d.C, eta)
    force = force + _weight(d, eta, theta, ground) - resistance(d, eta, theta, ground)
    S = k.motions
    return map_columns(S @ np.linalg.inv(S.T @ d.M @ S) @ S.T, force)


def energy(d: Dynamics, eta: Any) -> Array:
    """Kinetic energy of platform, wheels and rotors, (41) [J]; shape (...).

    Parameters
    ----------
    d
        The platform.
    eta
        Velocity in the robot's frame [m/s, m/s, rad/s], shape (3, ...).

    Returns
    -------
    array
        Kinetic energy [J], shape (...).
    """
    eta, p = columns(eta, 3, "velocity of the platform"), d.platform
    inertias = np.array([w.inertia + w.rotor_inertia for w in p.wheels]).reshape(-1, *[1] * (eta.ndim - 1))
    x, y = eta[0] - p.y * eta[2], eta[1] + p.x * eta[2]  # of the centre of mass
    speeds = map_columns(d.kinematics.E, eta)
    return np.asarray(eq.kinetic_energy(p.mass, x, y, p.inertia, eta[2], inertias, speeds))


def wheel_space(d: Dynamics) -> tuple[Array, Array]:
    """Inertia [kg*m^2] and, at a turning speed of 1 rad/s, Coriolis matrix [kg*m^2/s] of (57)-(59), both (n, n).

    M ϕ̈ + θ̇ C ϕ̇ = τ for speeds of the driven wheels that a motion makes; θ̇ is the third entry of ``velocity``. Their
    rank is the number of motions at most, never n where wheels are redundant: do not invert them.
    """
    D, K_plus = d.distribution, d.kinematics.K_plus
    return eq.wheel_space_inertia(D, d.M, K_plus), eq.wheel_space_coriolis(D, d.C, K_plus)
