"""Positions in which a load is held at rest: where its torque may be largest."""

from __future__ import annotations

import math

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.loads.lever import Lever

__all__ = ["held_positions"]


def held_positions(lever: Lever | None, moved: Course) -> Course:
    """Course at rest in each position in which gravity may turn the load most.

    Power may be lost at any time, so that is the worst of the whole path. The torque of a mass on a lever goes as the
    cosine of its angle: it is largest at an end of the path, or level wherever the path passes there. Of any other load
    no position is worse than another.

    Parameters
    ----------
    lever
        The mass that gravity turns; None where there is none.
    moved
        How the load moves.

    Returns
    -------
    Course
        A segment of a second at each position.
    """
    low, high = float(moved.position.min()), float(moved.position.max())
    places = [low, high]
    if lever is not None:
        first, last = (math.ceil((low + lever.start) / math.pi), math.floor((high + lever.start) / math.pi))
        places += [number * math.pi - lever.start for number in range(first, min(last, first + 1) + 1)]
    ends = np.repeat(np.array(places)[:, None], 2, axis=1)
    still = np.zeros_like(ends)
    return Course("held", np.ones(len(places)), ends, still, still)
