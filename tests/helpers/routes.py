"""A way of straight pieces and arcs, driven at one speed with a ramp at either end, as a trajectory.

The heading is what is asked for, whatever the way does: it turns smoothly along stretches of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from drivesizer.platform.equations import Array
from drivesizer.platform.trajectory import Trajectory

__all__ = ["route"]


def route(
    legs: Sequence[tuple[float, float]],
    *,
    speed: float,
    acceleration: float,
    turns: Sequence[tuple[float, float, float]] = (),
    step: float = 0.01,
) -> Trajectory:
    """A way of straight pieces and arcs from rest to rest.

    Parameters
    ----------
    legs
        Length [m] and curvature [1/m] of each; it is positive to the left.
    speed, acceleration
        Of travel [m/s], and of the ramps at the ends [m/s^2]. Turning into an arc at speed is a jump of acceleration.
    turns
        Stretches of the way [m], from and to, and by how much the heading changes there [rad].
    step
        Longest piece of time [s].

    Examples
    --------
    >>> there = route([(3.0, 0.0)], speed=1.0, acceleration=1.0)
    >>> there.total, float(there.posture[0, -1, 1])
    (4.0, 3.0)
    """
    ends = np.cumsum([length for length, _ in legs])
    time, rate = _times(ends, turns, speed, acceleration, step)
    both = np.stack([time[:-1], time[1:]], axis=-1)
    s, v = _along(both, rate, ends[-1])
    a = np.where(both.mean(axis=-1) < rate[1], rate[0], np.where(both.mean(axis=-1) > rate[2], -rate[0], 0.0))
    leg = np.minimum(np.searchsorted(ends, s.mean(axis=-1)), len(legs) - 1)
    return _moving(np.asarray(legs), leg[:, None], ends, s, v, a[:, None] + 0.0 * s, turns, both)


def _times(
    ends: Array, turns: Sequence[tuple[float, float, float]], speed: float, acceleration: float, step: float
) -> tuple[Array, tuple[float, float, float, float]]:
    """Ends of the pieces of time; acceleration, ends of ramp and cruise, the whole time."""
    whole = float(ends[-1])
    top = min(speed, math.sqrt(acceleration * whole))
    ramp = top / acceleration
    total = 2.0 * ramp + (whole - top * ramp) / top
    rate = acceleration, ramp, total - ramp, total
    marks = np.array([*ends[:-1], *(p for start, end, _ in turns for p in (start, end) if 0.0 < p < whole)])
    near, far = marks < top * ramp / 2.0, marks > whole - top * ramp / 2.0
    at = np.where(near, np.sqrt(2.0 * np.minimum(marks, whole) / acceleration), ramp / 2.0 + marks / top)
    at = np.where(far, total - np.sqrt(2.0 * np.maximum(whole - marks, 0.0) / acceleration), at)
    corners = np.unique(np.round(np.array([0.0, ramp, total - ramp, total, *at]), 12))
    corners[-1] = total
    parts = [np.linspace(a, b, max(math.ceil((b - a) / step), 1) + 1)[:-1] for a, b in pairwise(corners)]
    return np.concatenate([*parts, [total]]), rate


def _along(time: Array, rate: tuple[float, float, float, float], whole: float) -> tuple[Array, Array]:
    """Way [m] and speed [m/s] at times."""
    a, ramp, brake, total = rate
    left = total - time
    s = np.where(time < ramp, a * time**2 / 2.0, a * ramp * (time - ramp / 2.0))
    s = np.where(time > brake, whole - a * left**2 / 2.0, s)
    return s, a * np.minimum(np.minimum(time, ramp), left)


def _moving(
    legs: Array, leg: Array, ends: Array, s: Array, v: Array, a: Array, turns: Sequence[tuple[float, float, float]],
    time: Array,
) -> Trajectory:  # fmt: skip
    """Posture, velocity and acceleration on the way."""
    corner = _corners(legs)
    bend, into = legs[leg, 1], s - (ends - legs[:, 0])[leg]
    x0, y0, psi0 = corner[leg].transpose(2, 0, 1)
    psi = psi0 + bend * into
    chord = into * np.sinc(bend * into / 2.0 / np.pi)
    x, y = x0 + chord * np.cos(psi0 + bend * into / 2.0), y0 + chord * np.sin(psi0 + bend * into / 2.0)
    theta, per, change = 0.0 * s, 0.0 * s, 0.0 * s
    for start, end, angle in turns:
        q = np.clip((s - start) / (end - start), 0.0, 1.0)
        theta = theta + angle * q**3 * (10.0 - 15.0 * q + 6.0 * q**2)
        per = per + angle / (end - start) * 30.0 * q**2 * (1.0 - q) ** 2
        change = change + angle / (end - start) ** 2 * 60.0 * q * (1.0 - q) * (1.0 - 2.0 * q)
    c, z = np.cos(psi), np.sin(psi)
    return Trajectory(
        duration=np.diff(time, axis=-1)[:, 0],
        posture=np.array([x, y, theta]),
        velocity=np.array([v * c, v * z, v * per]),
        acceleration=np.array([a * c - v**2 * bend * z, a * z + v**2 * bend * c, a * per + v**2 * change]),
    )


def _corners(legs: Array) -> Array:
    """Place and direction where each leg begins, (legs, 3)."""
    found = [(0.0, 0.0, 0.0)]
    for length, bend in legs[:-1]:
        x, y, psi = found[-1]
        chord, middle = length * np.sinc(bend * length / 2.0 / np.pi), psi + bend * length / 2.0
        found.append((x + chord * math.cos(middle), y + chord * math.sin(middle), psi + bend * length))
    return np.array(found)
