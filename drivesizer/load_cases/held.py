"""Positions in which a load is held at rest: where its torque may be largest."""

from __future__ import annotations

import math

import numpy as np

from drivesizer.loads.course import Course
from drivesizer.loads.lever import Lever
from drivesizer.physics.load_cycle import Ends

__all__ = ["heaviest_positions"]


def heaviest_positions(lever: Lever | None, moved: Course) -> Course:
    """Course at rest in each position in which gravity may turn the load most, with the payload that it has there.

    Power may be lost at any time, so that is the worst of the whole path. The torque of a mass on a lever goes as the
    cosine of its angle: it is largest at an end of the path, or level wherever the path passes there. Of any other load
    no position is worse than another. A light load may pull harder than a heavy one: against a counterweight.
    """
    carried = np.broadcast_to(moved.payload, (len(moved.duration), 1))[:, 0]
    found = [
        (place, payload)
        for payload in np.unique(carried)
        for place in _worst(lever, moved.position[carried == payload])
    ]
    places, payloads = (np.array(column)[:, None] for column in zip(*found, strict=True))
    ends = np.repeat(places, 2, axis=1)
    still = np.zeros_like(ends)
    return Course("held", np.ones(len(places)), ends, still, still, payloads)


def _worst(lever: Lever | None, position: Ends) -> list[float]:
    """Ends of a path, and level wherever it passes there."""
    low, high = float(position.min()), float(position.max())
    if lever is None:
        return [low, high]
    first, last = (math.ceil((low + lever.start) / math.pi), math.floor((high + lever.start) / math.pi))
    return [low, high, *(number * math.pi - lever.start for number in range(first, min(last, first + 1) + 1))]
