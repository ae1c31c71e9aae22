"""Energy to and from the bus of a machine over one of its load cases, all drives together.

What one drive regenerates while another draws is not burnt. Symbols: E energy [J], P power [W], U voltage [V].
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isnan, nan
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.supply_power import DrivePower, drive_power, together
from drivesizer.physics.elements.brake_resistor import burning, burnt_energy, largest_mean, largest_pulse
from drivesizer.physics.power_stage import bus_voltage
from drivesizer.physics.waveform import most_stored
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec

__all__ = ["Burnt", "OnTheBus", "Regenerated", "raised_voltage", "regenerated", "regenerated_of"]

Array = NDArray[np.float64]


class Burnt(NamedTuple):
    """Load of a brake resistor in periodic steady state; NaN is unknown."""

    energy: float  # J per cycle
    peak: float  # W, largest regenerated power while the bus is full
    mean: float  # W, over the worst window
    pulse: float  # J, of the largest uninterrupted braking


class OnTheBus(Protocol):
    """Energies to and from a bus that limits are held against: of one course over time, or of courses at any phase."""

    @property
    def case(self) -> str:
        """Name of the load case."""

    @property
    def spec(self) -> RobotSpec:
        """The machine in it, with its supply."""

    @property
    def known(self) -> bool:
        """Whether the energies are."""

    @property
    def energy(self) -> float:
        """Regenerated energy per cycle that the supply does not store [J]."""

    @property
    def stored(self) -> float:
        """Largest energy that is regenerated and not drawn again [J]."""

    @property
    def mean_drawn(self) -> float:
        """Mean power out of the source [W]."""

    def highest_voltage(self, more: float = 0.0) -> float:
        """Highest voltage of the bus without a brake resistor [V]."""

    def burnt(self, capacity: float, window: float, continuous: float = 0.0) -> Burnt:
        """Load of a brake resistor beside a bus that stores so much."""

    def longest_above(self, power: float) -> float:
        """Longest uninterrupted time in which the power out of the source exceeds one [s]."""


class Regenerated(NamedTuple):
    """Energies of a load case, piece by piece; unknown where the drive's demand is."""

    case: str
    spec: RobotSpec
    duration: Array  # s
    drawn: Array  # J, from the bus
    returned: Array  # J, to the bus, without what the supply stores
    returned_peak: Array  # W, largest in each piece
    drawn_peak: Array  # W, largest out of the source in each piece
    mean_drawn: float  # W out of the source

    @property
    def known(self) -> bool:
        """Whether the energies are."""
        return not isnan(float(self.returned.sum() + self.drawn.sum()))

    @property
    def energy(self) -> float:
        """Regenerated energy per cycle that the supply does not store [J]."""
        return float(self.returned.sum())

    @property
    def stored(self) -> float:
        """Largest energy that is regenerated and not drawn again [J]; infinite where more with every cycle."""
        if not self.known:
            return nan
        if self.energy > float(self.drawn.sum()):
            return inf
        steps = np.stack([-self.drawn, self.returned], axis=1).reshape(1, -1)
        return float(most_stored(steps)[0])

    def highest_voltage(self, more: float = 0.0) -> float:
        """Highest voltage of the bus without a brake resistor [V]; NaN where its capacitance is unknown.

        ``more``: capacitance beside that of the spec [F].
        """
        return raised_voltage(self.spec, self.stored, more)

    def burnt(self, capacity: float, window: float, continuous: float = 0.0) -> Burnt:
        """Load of a brake resistor beside a bus that stores so much."""
        if not self.known:
            return Burnt(nan, nan, nan, nan)
        steady = 0.0 if isnan(continuous) else continuous
        energy = burnt_energy(self.drawn, self.returned, capacity)
        course = burning(self.duration, self.returned, self.returned_peak, energy, steady)
        mean, pulse = largest_mean(*course[:2], window), largest_pulse(*course[:2], steady)
        return Burnt(float(energy.sum()), course.peak, mean, pulse)

    def longest_above(self, power: float) -> float:
        """Longest uninterrupted time in which the power out of the source exceeds one [s], by whole pieces."""
        if not self.known:
            return nan
        return largest_pulse(self.duration, np.where(self.drawn_peak > power, self.duration, 0.0))


def raised_voltage(spec: RobotSpec, stored: float, more: float = 0.0) -> float:
    """Voltage to which a bus rises by an energy."""
    if stored == 0.0:
        return spec.supply.highest
    capacitance = (spec.supply.capacitance or nan) + more
    return float(bus_voltage(spec.supply.highest, stored, capacitance))


def regenerated(problem: Problem, one: DriveParts) -> list[Regenerated]:
    """Energies to and from the bus in each load case of a machine."""
    found = []
    for numbers in problem.machine_cases:
        some = [problem.cases[number] for number in numbers]
        name, spec = problem.name_of(numbers), some[0].spec
        if len(some) == 1:
            timed = spec.supply.peak_current is not None and spec.supply.current is not None  # each moment counts
            found.append(regenerated_of(name, spec, drive_power(spec, one, some[0].at_belt, merged=not timed)))
        else:
            found.append(_of_several(name, spec, [drive_power(case.spec, one, case.at_belt) for case in some]))
    return found


def _of_several(case: str, spec: RobotSpec, powers: Sequence[DrivePower]) -> Regenerated:
    """Sum of drives that act at the same time; what one draws of another's return goes no further."""
    found = regenerated_of(case, spec, together(powers))
    net: Any = found.drawn - found.returned
    return found._replace(drawn=np.maximum(net, 0.0), returned=np.maximum(-net, 0.0))


def regenerated_of(case: str, spec: RobotSpec, power: DrivePower) -> Regenerated:
    """Energies to and from the bus of a machine whose power is known."""
    share = 1.0 - spec.supply.regeneration
    return Regenerated(
        case=case,
        spec=spec,
        duration=power.duration,
        drawn=power.bus_drawn * power.duration,
        returned=share * power.returned * power.duration,
        returned_peak=share * power.returned_peak,
        drawn_peak=power.peak,
        mean_drawn=power.mean(power.drawn),
    )
