"""Power of all axes of a machine on one supply over its cycle, as a record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.braking import BrakingBudget
from drivesizer.results.check import Check, Figure, Status, verdict
from drivesizer.results.energy import EnergyBudget
from drivesizer.results.reliability import Reliability

__all__ = ["Course", "Exceeded", "MachinePower"]

Array = NDArray[np.float64]


class Exceeded(NamedTuple):
    """Share of the time in which axes at random phases draw more than a limit."""

    check: str  # name of the check that has this limit
    limit: float  # W out of the source
    least: float  # share of the time, 1; both are the same but for the width of the pieces
    most: float


class Course(NamedTuple):
    """Mean powers of pieces of time."""

    time: Array  # s, ends of the pieces
    drawn: Array  # W, of each axis a row
    returned: Array
    total: Array  # W
    left: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MachinePower:
    """Power of all axes in the load case of the largest peak, checks where each is worst; NaN is unknown."""

    axes: tuple[str, ...]  # in the order of the machine
    case: str  # name of the load case; empty where there is one
    synchronised: bool  # one course over time; else courses at any phase, shown with all peaks at one moment
    time: Array  # s, ends of the pieces: shape (pieces + 1,)
    drawn: Array  # W of each axis at the input of its controllers, mean of each piece: shape (axes, pieces)
    returned: Array  # W of each axis, regenerated
    total: Array  # W out of the source, mean of each piece: shape (pieces,)
    left: Array  # W regenerated that no axis draws at the same moment
    peak: float  # W, largest out of the source
    peak_time: float  # s
    peak_axis: str  # that draws most of it; empty where it is unknown
    mean: float  # W out of the source
    energy_left: float  # J per cycle, regenerated, that no axis draws at the same moment
    exchanged: float  # J per cycle, that one axis regenerates and another draws
    phases: tuple[float, ...]  # s, start of each axis at which all peaks fall together; empty where synchronised
    exceeded: tuple[Exceeded, ...]  # of the limits of the supply, at random phases
    unknown: tuple[str, ...]  # axes whose power is unknown, each with the reason
    braking: BrakingBudget | None  # brake resistor and power supply for all axes
    energy: EnergyBudget | None  # battery for all axes
    checks: tuple[Check, ...]
    figures: tuple[Figure, ...]
    assumptions: tuple[str, ...]
    reliability: Reliability | None = None  # of its limits, where tolerances were sampled

    @property
    def status(self) -> Status:
        """Of all checks together."""
        return verdict(self.checks)

    def course(self, most: int = 1000) -> Course:
        """Power over time in no more than so many pieces, neighbours taken together by their mean."""
        size = -(-len(self.total) // most)
        first = np.arange(0, len(self.total), size)
        time = np.append(self.time[:-1][first], self.time[-1])

        def mean(rows: Array) -> Array:
            return np.asarray(np.add.reduceat(rows * np.diff(self.time), first, axis=-1) / np.diff(time))

        return Course(time, *map(mean, (self.drawn, self.returned, self.total, self.left)))
