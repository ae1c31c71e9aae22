"""Consumers of a battery and how long it lasts, as records."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.check import Check, Figure, Status

__all__ = ["Consumption", "EnergyBudget"]

Array = NDArray[np.float64]


class Consumption(NamedTuple):
    """One line of the table of consumers."""

    name: str
    number: int
    mean: float  # W at the battery, over the whole time; negative where energy is regenerated
    peak: float  # W
    duty: float  # share of the time; NaN where it does not apply
    assumed: bool  # its figures are a guess of the spec


@dataclass(frozen=True, slots=True, kw_only=True)
class EnergyBudget:
    """Consumers, battery, and the time and range that follow; NaN is unknown."""

    battery: str  # its name
    start: float  # share of its charge at the start
    usable: float  # share that may be drawn
    consumers: tuple[Consumption, ...]
    duration: Array  # s, pieces of one cycle
    power: Array  # W from the battery, mean of each piece
    mean_power: float  # W
    peak_power: float  # W
    full_time: float  # s, until all charge is drawn
    autonomy: float  # s, until the usable share is
    range: float  # m in that time; NaN for what does not travel
    required: float  # s that it must last; NaN where nothing is required
    status: Status
    checks: tuple[Check, ...]
    figures: tuple[Figure, ...]
    assumptions: tuple[str, ...]
