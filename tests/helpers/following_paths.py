"""Platforms and paths of the tests of following."""

import math

import numpy as np
from platforms import ALPHA, LENGTH, differential, mecanum
from routes import route

from drivesizer.control.path_following.slip import Contact
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
