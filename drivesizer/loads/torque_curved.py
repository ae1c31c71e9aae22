r"""Torques that are no straight lines within a segment of the motion: cut finer, to a stated error.

Weight on a lever: :math:`T = M \cos(φ_0 + φ)`. A chord over the time Δt is off by at most
:math:`M (ω^2 + |α|) Δt^2 / 8`; pieces with :math:`\sqrt{ω^2 + |α|} \, Δt \le` half a degree keep that to 1e-5 of M.
No cycle is cut into more than some 10 000 pieces: beyond 13 turns they grow longer and the error with their square, to
4e-3 of M at 10 degrees (some 270 turns); a cycle of more turns than that is refused. A lever that turns level to within
1e-5 rad, nearer than files that round 90 degrees to 1.5708 rad, feels no weight.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import FieldError
from drivesizer.loads.course import Course
from drivesizer.loads.model import Lever
from drivesizer.physics.load_cycle import Ends

__all__ = ["capped", "weight_on_lever"]

_MOST = 10_000  # pieces of a cycle
_STEP = math.radians(0.5)
_LONGEST_STEP = math.radians(10.0)


def capped(pieces: NDArray[np.float64]) -> NDArray[np.int64]:
    """Whole pieces per segment, at least one, of some 10 000 in all at most.

    >>> capped(np.array([0.0, 2.5])), capped(np.array([30_000.0, 10_000.0]))
    (array([1, 3]), array([7500, 2500]))
    """
    share = min(1.0, _MOST / max(float(pieces.sum()), 1.0))
    return np.maximum(np.ceil(pieces * share), 1.0).astype(np.int64)


def weight_on_lever(lever: Lever, gravity: float, course: Course) -> tuple[Course, Ends]:
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
        The course in finer segments, and the torque of the weight at both ends of each [N*m], shape (segments, 2).

    Raises
    ------
    FieldError
        When the cycle has too many turns to follow.
    """
    moment = lever.moment(gravity)
    if moment == 0.0:
        return course, np.zeros_like(course.speed)
    rate = np.abs(course.speed).max(axis=1)
    slope = np.abs(np.diff(course.speed, axis=1)[:, 0]) / course.duration
    pieces = np.hypot(rate, np.sqrt(slope)) * course.duration / _STEP
    if not pieces.sum() <= _MOST * _LONGEST_STEP / _STEP:  # written so that NaN fails too
        raise FieldError(
            ("motion",),
            "the weight turns round more than 250 times in one cycle; expected a shorter cycle, or a balanced load",
        )
    course = course.finer(capped(pieces))
    return course, moment * np.cos(lever.start + course.position)
