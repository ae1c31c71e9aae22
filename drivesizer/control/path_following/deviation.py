r"""How far a platform is from where it should be, and what a misjudged figure alone comes to.

Position and heading are compared at the same time. Along and across are by the direction of the desired motion; at
rest, the last one.

Laws, open-loop and without slip. Radii that are 1 + e of what is believed: the way is longer by e of it. Wheels apart
by 1 + e of what is believed: every turn is smaller by e/(1 + e) of it. Radii of 1 + e on the right of a differential
drive of track b and of 1 - e on its left: a straight line becomes an arc of curvature 2 e / b.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivesizer.control.path_following.following import Followed
from drivesizer.platform.matrix_equation import Array

__all__ = ["Deviation", "Extreme", "deviation", "extremes"]


@dataclass(frozen=True, slots=True, eq=False)
class Deviation:
    """True against desired at k instants."""

    time: Array  # (k,) s
    way: Array  # (k,) m, of the desired path
    turned: Array  # (k,) rad, desired, all turns added up
    position: Array  # (k,) m, distance
    along: Array  # (k,) m, above 0: ahead
    across: Array  # (k,) m, above 0: to the left
    heading: Array  # (k,) rad


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest value, in size, and where it is."""

    title: str
    value: float  # SI
    kind: str
    unit: str  # of the trade
    time: float  # s
    way: float  # m


def deviation(f: Followed) -> Deviation:
    """How far a platform is from where it should be.

    Parameters
    ----------
    f
        What it did.
    """
    wanted, off = f.planned.posture, f.posture - f.planned.posture
    steps = np.abs(np.diff(wanted[2], prepend=wanted[2, 0]))
    way = np.cumsum(np.hypot(*np.diff(wanted[:2], axis=1, prepend=wanted[:2, :1])))
    x, y = _direction(f.planned.velocity)
    along, across = x * off[0] + y * off[1], x * off[1] - y * off[0]
    return Deviation(f.planned.time, way, np.cumsum(steps), np.hypot(off[0], off[1]), along, across, off[2])


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
    """Largest deviations, slip, torque and use of the floor, with when and where they are.

    Parameters
    ----------
    f
        What a platform did.
    """
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
    return Extreme(title, float(worst[k]), kind, unit, float(d.time[k]), float(d.way[k]))
