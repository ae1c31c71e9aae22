"""Deviation of a platform from its desired posture.

Position and heading are compared at the same time. Along and across are relative to the direction of the desired
motion; at rest, the last one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivesizer.control.path_following.following import Followed
from drivesizer.platform.matrix_equation import Array

__all__ = ["Deviation", "Extreme", "deviation", "extremes"]


@dataclass(frozen=True, slots=True, eq=False)
class Deviation:
    """Actual less desired posture at k instants."""

    time: Array  # (k,) s
    travel: Array  # (k,) m, along the desired path
    turned: Array  # (k,) rad, desired, all turns added up
    position: Array  # (k,) m, distance
    along: Array  # (k,) m, above 0: ahead
    across: Array  # (k,) m, above 0: to the left
    heading: Array  # (k,) rad


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest magnitude, with its time and place."""

    title: str
    value: float  # SI
    kind: str
    unit: str  # of the trade
    time: float  # s
    travel: float  # m, along the desired path


def deviation(f: Followed) -> Deviation:
    """Deviation of a platform from its desired posture."""
    wanted, off = f.planned.posture, f.posture - f.planned.posture
    steps = np.abs(np.diff(wanted[2], prepend=wanted[2, 0]))
    travel = np.cumsum(np.hypot(*np.diff(wanted[:2], axis=1, prepend=wanted[:2, :1])))
    x, y = _direction(f.planned.velocity)
    along, across = x * off[0] + y * off[1], x * off[1] - y * off[0]
    return Deviation(f.planned.time, travel, np.cumsum(steps), np.hypot(off[0], off[1]), along, across, off[2])


def _direction(velocity: Array) -> Array:
    """Unit vectors of motion, (2, k); at rest the last one, before all motion the first, and x where there is none."""
    size = np.hypot(velocity[0], velocity[1])
    moves = size > 1e-9 * (size.max() or 1.0)
    if not moves.any():
        return np.stack([np.ones_like(size), np.zeros_like(size)])
    last = np.maximum.accumulate(np.where(moves, np.arange(len(size)), -1))
    last[last < 0] = int(moves.argmax())
    return np.asarray(velocity[:2, last] / size[last])


def extremes(f: Followed) -> tuple[Extreme, ...]:
    """Largest deviations, slip, torque and use of the grip, with their times and places."""
    d = deviation(f)
    used = np.divide(f.traction, f.friction * f.load, out=np.zeros_like(f.load), where=f.load > 0.0)
    rows = (
        ("position", d.position, "length", "m"),
        ("along the path", d.along, "length", "m"),
        ("across the path", d.across, "length", "m"),
        ("heading", d.heading, "angle", "deg"),
        ("slip", f.slip, "speed", "mm/s"),
        ("torque of a wheel", f.torque, "torque", "N*m"),
        ("use of the floor's grip", used, "dimensionless", "%"),
    )
    return tuple(_extreme(title, values, kind, unit, d) for title, values, kind, unit in rows)


def _extreme(title: str, values: Array, kind: str, unit: str, d: Deviation) -> Extreme:
    """The largest value in size; of all wheels where there are more."""
    worst = values if values.ndim == 1 else values[np.abs(values).argmax(axis=0), np.arange(values.shape[1])]
    k = int(np.abs(worst).argmax())
    return Extreme(title, float(worst[k]), kind, unit, float(d.time[k]), float(d.travel[k]))
