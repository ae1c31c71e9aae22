"""A platform and its floor as the arrays of the simulation."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from drivesizer.control.path_following import kernel_layout as at
from drivesizer.control.path_following.slip import Contact
from drivesizer.errors import InputError
from drivesizer.platform import equations_dynamics as eq
from drivesizer.platform.contact_loads import Ground, contact_loads
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.misjudged import Misjudged, per_wheel
from drivesizer.platform.wheels import Platform, Wheel

__all__ = ["Arrays", "arrays", "first_state"]

_KINDS = {"motor": 0.0, "free": 1.0, "blocked": 2.0}


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """Wheels, casters, platform and floor as in ``kernel_layout``; inertia and Coriolis matrix without the wheels."""

    W: Array
    K: Array
    B: Array
    M: Array  # (3, 3) kg, kg*m, kg*m^2
    C: Array  # (3, 3), at 1 rad/s
    lever: float  # m, farthest contact point


def arrays(platform: Platform, misjudged: Misjudged, contact: Contact, ground: Ground) -> Arrays:
    """The actual platform and its floor as arrays."""
    if np.ndim(ground.slope) or np.ndim(ground.uphill):
        raise InputError("following: expected one slope for the whole path")
    p, n = platform, len(platform.wheels)
    N0, S = _resting_loads(p, ground)
    strength = per_wheel(misjudged.motor, n, "misjudged motor")
    W, K = np.zeros((n, at.COLUMNS)), np.zeros((len(p.casters), at.CASTER_COLUMNS))
    for i, w in enumerate(p.wheels):
        W[i] = *_wheel(w, i, contact), N0[i], *S[i], 1.0 + strength[i]
    for j, c in enumerate(p.casters):
        K[j, : at.CASTER_FX] = c.x, c.y, c.rolling_resistance, N0[n + j], *S[n + j]
    weight = p.mass * ground.gravity
    B = np.zeros(at.TURNROUND + 1)
    B[: at.HEIGHT + 1] = p.x, p.y, weight, weight * math.sin(ground.slope), ground.uphill, p.height
    B[at.FRICTION :] = contact.friction, contact.slip_speed, contact.creep, contact.turnround
    M = eq.mass_matrix(p.mass, p.inertia + p.mass * (p.x**2 + p.y**2), p.x, p.y)
    C = eq.coriolis_matrix(1.0, p.mass, p.x, p.y)
    return Arrays(W, K, B, np.asarray(M, float), np.asarray(C, float), max(math.hypot(*q) for q in p.contacts))


def _wheel(w: Wheel, number: int, contact: Contact) -> tuple[float, ...]:
    """Columns of a wheel up to its load."""
    inertia = w.inertia + w.rotor_inertia
    if w.drive != "blocked" and not inertia > 0.0:
        raise InputError(f"following: wheel {number + 1} has no inertia; give inertia or rotor_inertia")
    if not w.held and not w.roller_resistance < contact.friction:
        raise InputError(
            f"following: the rollers of wheel {number + 1} resist by {w.roller_resistance:g} of the load, "
            f"no less than the floor's friction, {contact.friction:g}"
        )
    along = w.heading + w.roller_angle
    c, s = math.cos(along), math.sin(along)
    rows = (c, s, w.x * s - w.y * c, -s, c, w.x * c + w.y * s)
    turns = w.radius * math.cos(w.roller_angle), w.radius * math.sin(w.roller_angle), w.radius, inertia or 1.0
    resists = w.rolling_resistance, w.roller_resistance, w.friction
    return *rows, *turns, *resists, float(w.held), _KINDS[w.drive]


def _resting_loads(p: Platform, ground: Ground) -> tuple[Array, Array]:
    """Loads without a force at the floor [N], and their decrease by forces ahead and to the left at 1 m [1/m]."""
    pull = ground.gravity * math.sin(ground.slope)
    upward = pull * math.cos(ground.uphill), pull * math.sin(ground.uphill)
    free = (-upward[0], -upward[1])  # sliding down freely: the floor holds nothing
    still = contact_loads(p, ground=ground, accelerated=free)
    share = [
        (still - contact_loads(p, ground=ground, accelerated=(free[0] + (k == 0), free[1] + (k == 1))))
        / (p.mass * p.height or math.inf)
        for k in range(2)
    ]
    return still, np.array(share).T


def first_state(a: Arrays, posture: Array, velocity: Array) -> Array:
    """The state of a platform that rolls without slip."""
    W = a.W
    turning = W[:, at.AX : at.AT + 1] @ velocity / W[:, at.RA] * (W[:, at.KIND] != 2.0)
    return np.concatenate([posture, velocity, turning, np.zeros(at.TALLIES)])
