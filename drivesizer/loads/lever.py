r"""A mass on a lever about an axis that does not stand upright, and its weight, which is no straight line over time.

Weight on a lever: :math:`T = M \cos(φ_0 + φ)`. A chord over the time Δt is off by at most
:math:`M (ω^2 + |α|) Δt^2 / 8`; pieces with :math:`\sqrt{ω^2 + |α|} \, Δt \le` half a degree keep that to 1e-5 of M.
No cycle is cut into more than some 10 000 pieces: beyond 13 turns they grow longer and the error with their square, to
4e-3 of M at 10 degrees (some 270 turns); a cycle of more turns than that is refused. A lever that turns level to within
1e-5 rad, nearer than files that round 90 degrees to 1.5708 rad, feels no weight.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import FieldError
from drivesizer.loads.course import Course
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import Ends

_LEVEL = 1e-5  # of the weight: what gets through a smaller share of it is none; files round 90 degrees to 1.5708 rad
_MOST = 10_000  # pieces of a cycle
_STEP, _LONGEST_STEP = math.radians(0.5), math.radians(10.0)


class Lever(NamedTuple):
    """A mass away from the axis that it turns about."""

    mass: Alike  # kg
    length: Alike  # m, from the axis to its centre
    share: Alike  # of its weight that the axis' tilt leaves across it: 1 for a level axis
    start: Alike  # rad, of the lever above the level line when the cycle starts

    def moment(self, gravity: Figure) -> Alike:
        """Torque of the weight when the lever lies level, M [N*m]; 0 where it turns level but for rounding."""
        return self.mass * gravity * self.length * np.where(np.abs(self.share) > _LEVEL, self.share, 0.0)


def too_light(inertia: float, mass: float, length: float, name: str) -> Iterator[str]:
    """What is said of an inertia below that of all the mass in its centre, 2 % apart for rounded figures."""
    least = mass * length * length
    if inertia < 0.98 * least:
        yield f"inertia must be at least mass times {name} squared, {least:.4g} kg·m²"


def capped(pieces: NDArray[np.float64]) -> NDArray[np.int64]:
    """Whole pieces per segment, at least one, of some 10 000 in all at most; of samples the most that one takes.

    >>> capped(np.array([0.0, 2.5])), capped(np.array([30_000.0, 10_000.0]))
    (array([1, 3]), array([7500, 2500]))
    """
    most = pieces.reshape(len(pieces), -1).max(axis=1)
    share = min(1.0, _MOST / max(float(most.sum()), 1.0))
    return np.asarray(np.maximum(np.ceil(most * share), 1.0), dtype=np.int64)


def pieces_of_turn(course: Course) -> NDArray[np.float64]:
    """Pieces of each segment of a course that turns in which a weight on a lever is a straight line to 1e-5 of it."""
    lasting = np.where(course.duration > 0.0, course.duration, 1.0)
    slope = np.abs(np.diff(course.speed, axis=1)[:, 0]) / lasting
    found: NDArray[np.float64] = np.hypot(np.abs(course.speed).max(axis=1), np.sqrt(slope)) * course.duration / _STEP
    return found


def weight_on_lever(lever: Lever, gravity: Figure, course: Course) -> tuple[Course, Ends]:
    """The course in pieces that are fine enough, and the torque of a weight about the axis.

    Parameters
    ----------
    lever
        The mass and where it is.
    gravity
        Acceleration of free fall [m/s^2].
    course
        How the lever turns.

    Returns
    -------
    tuple
        The course in finer segments, and the torque of the weight at both ends of each [N*m], shape (segments, 2, ...).

    Raises
    ------
    FieldError
        When the cycle has too many turns to follow.
    """
    moment = lever.moment(gravity)
    if not np.any(moment):
        return course, np.zeros_like(course.speed)
    pieces = pieces_of_turn(course)
    if not (pieces.sum(axis=0) <= _MOST * _LONGEST_STEP / _STEP).all():  # written so that NaN fails too
        raise FieldError(
            ("motion",),
            "the weight turns round more than 250 times in one cycle; expected a shorter cycle, or a balanced load",
        )
    course = course.finer(capped(pieces))
    return course, moment * np.cos(lever.start + course.position)
