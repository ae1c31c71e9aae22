"""Platforms of the tests: the paper's four mecanum wheels, textbook sets."""

import math

import numpy as np

from drivesizer.platform.dynamics import LEVEL, Moving, required_force
from drivesizer.platform.kinematics import Platform, Wheel, table_wheel

ALPHA, LENGTH, RADIUS = math.radians(29.5), 0.27406, 0.0762  # of Table 1
MASS, INERTIA, WHEEL = 45.0, 2.34, 3.2e-3  # kg, kg*m^2: 45 kg as a plate of 707 x 350 mm; one wheel


def mecanum(**more):
    """The paper's robot by its Table 1: front right, front left, rear left, rear right."""
    directions = (2 * math.pi - ALPHA, ALPHA, math.pi - ALPHA, math.pi + ALPHA)
    rollers = (math.pi / 4, -math.pi / 4, math.pi / 4, -math.pi / 4)
    wheels = tuple(
        table_wheel(LENGTH, a, math.pi / 2 - a, g, RADIUS, **({"inertia": WHEEL} | more))
        for a, g in zip(directions, rollers, strict=True)
    )
    return Platform(wheels=wheels, mass=MASS, inertia=INERTIA)


def omni_three(radius, arm):
    """Three omni wheels about the middle; the first stands in front and rolls to the left."""
    return [
        Wheel(x=arm * math.cos(a), y=arm * math.sin(a), heading=a + math.pi / 2, radius=radius)
        for a in (0.0, 2 * math.pi / 3, -2 * math.pi / 3)
    ]


def differential(track=0.5, radius=0.1, **more):
    """Two fixed wheels on one axle, right and left; the reference point between them."""
    wheels = tuple(Wheel(x=0.0, y=y, radius=radius, held=True, **more) for y in (-track / 2, track / 2))
    return Platform(wheels=wheels, mass=30.0, inertia=1.7)


def car(wheelbase, track, steering):
    """Two driven wheels at the rear, right and left, and one steered in front; reference point on the rear axle."""
    rear = tuple(Wheel(x=0.0, y=y, radius=0.15, held=True) for y in (-track / 2, track / 2))
    front = Wheel(x=wheelbase, y=0.0, radius=0.15, heading=steering, held=True, drive="free")
    return Platform(wheels=(*rear, front), mass=80.0, inertia=9.0)


def acceleration(d, eta, torques, *, theta=0.0, ground=LEVEL):
    """Rate of change of a platform's velocity under torques of its driven wheels."""
    S, driven = d.kinematics.motions, list(d.kinematics.driven)
    allowed = Moving(S @ np.linalg.pinv(S) @ eta, np.zeros(3), theta, ground)
    left = d.kinematics.E[driven].T @ torques - required_force(d, allowed)
    return S @ np.linalg.solve(S.T @ d.M @ S, S.T @ left)
