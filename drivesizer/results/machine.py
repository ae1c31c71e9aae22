"""Results of a machine: the sizing of each axis, what rides on it, and what all draw from one supply."""

from __future__ import annotations

from dataclasses import dataclass
from math import fsum, isnan, nan
from typing import NamedTuple

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.results.check import Check, Status, verdict
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine_power import MachinePower
from drivesizer.results.sizing import SizingResult
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import OBJECTIVES
from drivesizer.spec.several_axes.machine import MachineSpec

__all__ = ["SUMMED", "AxisSizing", "CarriedMass", "MachineSizing", "objective_sum"]

# objectives of which the sum over all drives is that of the machine
SUMMED = tuple(name for name, kind in OBJECTIVES.items() if not kind.more_is_better and kind.kind != "temperature")


def objective_sum(objective: str, one: DriveSet, drives: int) -> float:
    """An objective of all drives of an axis."""
    return one.objective * (1 if objective == "energy" else drives)


class CarriedMass(NamedTuple):
    """Drives of another axis that ride on this one."""

    of: str  # the other axis
    mass: float  # kg, of all of them: what is estimated at the upper end of its band
    distance: float | None  # m, from the carrying axis; None along a line
    lacking: tuple[str, ...]  # parts whose mass is unknown


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSizing:
    """An axis, sized with what rides on it."""

    name: str
    result: SizingResult
    carried: tuple[CarriedMass, ...]
    for_all: bool = False  # whether its drive is the best for the machine, and not for the axis alone

    @property
    def spec(self) -> RobotSpec:
        """The axis alone, drives of others in its load."""
        return self.result.spec

    @property
    def best(self) -> DriveSet | None:
        """The drive that is recommended; None where none meets all limits."""
        return next(iter(self.result.sets), None)

    @property
    def drives(self) -> int:
        """Drives of this kind on the axis."""
        return self.spec.load.motors

    @property
    def carried_mass(self) -> float:
        """Of all drives that ride on it [kg]."""
        return fsum(one.mass for one in self.carried)


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSizing:
    """A machine: its axes in the order of the file, and the machine's own checks."""

    machine: MachineSpec
    axes: tuple[AxisSizing, ...]
    objective: str
    searches: int  # sizings of single axes that were made
    certain: bool  # whether no other choice of carried drives can be better by the objective
    notes: tuple[str, ...]  # how the drives were chosen, as sentences
    checks: tuple[Check, ...] = ()  # of the supply, battery and budget of all axes together
    power: MachinePower | None = None  # of all axes on the supply; None of one axis, or where one has no drive

    @property
    def status(self) -> Status:
        """The worst of all axes and of the machine's own checks; a fail where an axis has no drive."""
        bests = [axis.best for axis in self.axes]
        found = [best.status if best else "fail" for best in bests] + [verdict(self.checks)]
        order: tuple[Status, ...] = ("fail", "unknown", "open")
        return next((status for status in order if status in found), "pass")

    @property
    def complete(self) -> bool:
        """Whether every axis has a drive."""
        return all(axis.best for axis in self.axes)

    def axis(self, name: str) -> AxisSizing:
        """The axis of a name."""
        found = next((axis for axis in self.axes if axis.name == name), None)
        if found is None:
            names = [axis.name for axis in self.axes]
            listed = f"{', '.join(names)}{nearest(name, names)}"
            raise InputError(f"--axis: there is no axis {quoted(name)}; expected {listed}")
        return found

    @property
    def total(self) -> float:
        """Sum of the objective over all drives, SI; NaN where it is no sum, one is unknown, or an axis has no drive."""
        if self.objective not in SUMMED:
            return nan
        found = [objective_sum(self.objective, one.best, one.drives) if one.best else nan for one in self.axes]
        return nan if any(map(isnan, found)) else fsum(found)
