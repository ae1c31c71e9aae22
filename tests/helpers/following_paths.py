"""Platforms and paths of the tests of following."""

import math

import numpy as np
from platforms import ALPHA, LENGTH, differential, mecanum
from routes import route

from drivesizer.control.path_following import Contact, Planned, SpeedLoop, arrays, first_state, simulated
from drivesizer.control.path_following import kernel as at
from drivesizer.platform.dynamics import LEVEL, dynamics
from drivesizer.platform.kinematics import EXACT
from drivesizer.platform.trajectory import Trajectory


def unicycle(speed, turning, seconds, pieces=4000):
    """Ahead and turning, by Gauss's quadrature of three points in each piece."""
    t = np.linspace(0.0, seconds, pieces + 1)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    inside = (t[:-1] + t[1:]) / 2.0 + np.outer(nodes, np.diff(t)) / 2.0
    angle = 2.0 * math.pi / seconds

    def heading(x):  # of a turning speed that is the square of a sine
        return turning * (x / 2.0 - np.sin(2.0 * angle * x) / (4.0 * angle))

    def ahead(x):
        return speed * np.sin(angle * x / 2.0) ** 2

    way = (weights @ (ahead(inside) * np.exp(1j * heading(inside)))) * np.diff(t) / 2.0
    place = np.concatenate([[0.0], np.cumsum(way)])
    v, turn = ahead(t), turning * np.sin(angle * t) ** 2
    a, change = speed * angle / 2.0 * np.sin(angle * t), turning * angle * np.sin(2.0 * angle * t)
    towards = np.exp(1j * heading(t))
    velocity, rate = v * towards, (a + 1j * v * turn) * towards

    def both(column):  # ends of each piece
        return np.stack([column[:, :-1], column[:, 1:]], axis=-1)

    return Trajectory(
        np.diff(t),
        both(np.array([place.real, place.imag, heading(t)])),
        both(np.array([velocity.real, velocity.imag, turn])),
        both(np.array([rate.real, rate.imag, change])),
    )


STIFF = Contact(slip_speed=1e-6)
LEVER = LENGTH * (math.cos(ALPHA) + math.sin(ALPHA))
STRAIGHT = route([(6.0, 0.0)], speed=1.0, acceleration=1.0)
CURVED = route([(2.0, 0.0), (2.0, 0.5), (2.0, -0.4), (1.0, 0.0)], speed=0.8, acceleration=0.8,
               turns=[(0.5, 3.0, 1.2), (3.5, 6.5, -1.8)], step=0.002)  # fmt: skip
AHEAD = unicycle(1.0, 0.5, 8.0)  # turns by 2 rad


def robot(**more):
    return mecanum(**({"rotor_inertia": 0.01} | more))


def cart(**more):
    return differential(**({"inertia": 0.01, "rotor_inertia": 0.02} | more))


def drive(
    platform,
    torques,
    *,
    period,
    velocity=(0.0, 0.0, 0.0),
    heading=0.0,
    speeds=None,
    contact=None,
    ground=LEVEL,
    tolerance=1e-5,
):
    """Simulate a platform under given torques, without controllers; with torques of 0 it coasts."""
    d = dynamics(platform)
    given = np.asarray(torques, dtype=float)
    idle = (0.0,) * len(given)
    held = SpeedLoop(period=period, proportional=idle, integral=idle, limit=(math.inf,) * len(given))
    count = given.shape[1] + 1
    fed = np.zeros((count + 1, len(platform.wheels)))
    fed[: count - 1, d.kinematics.driven] = given.T
    a = arrays(platform, EXACT, contact or Contact(), ground)
    start = first_state(a, np.array([0.0, 0.0, heading]), np.array(velocity, dtype=float))
    if speeds is not None:
        start[at.POSE + 3 : at.POSE + 3 + len(platform.wheels)] = speeds
    still = np.zeros((3, count))
    place = still + np.array([[0.0], [0.0], [heading]])
    plan = Planned(np.asarray(np.arange(count) * period, dtype=float), place, still, still)
    return simulated(a, d, plan, held, None, fed, start, tolerance)
