"""Results of a machine: the sizing of each axis, what rides on it, and what all draw from one supply."""

from __future__ import annotations

from dataclasses import dataclass
from math import fsum, isnan, nan
from typing import NamedTuple

import numpy as np

from drivesizer.physics.figures import Array
from drivesizer.results.check import Check, Figure, Reliability, Status, gravest, verdict, worst
from drivesizer.results.drive_set import BrakingBudget, DriveSet, EnergyBudget
from drivesizer.results.sizing import SizingResult
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.machine import MachineSpec, axis_of, machine_of
from drivesizer.spec.robot import RobotSpec

# -- Power of all axes of a machine on one supply over its cycle, as a record.


class Exceeded(NamedTuple):
    """Share of the time in which axes at random phases draw more than a limit."""

    check: str  # name of the check that has this limit
    limit: float  # W out of the source
    least: float  # share of the time, 1; both are the same but for the width of the pieces
    most: float  # the same


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
        """Power over time in no more than so many pieces, neighbours taken together by their mean.

        Where a recording turns round, pieces may be shorter than the last digit of the time: they are none.
        """
        size = -(-len(self.total) // most)
        first = np.arange(0, len(self.total), size)
        time = np.append(self.time[:-1][first], self.time[-1])
        duration = np.diff(time)
        lasts = duration > 0.0

        def mean(rows: Array) -> Array:
            energy = np.add.reduceat(rows * np.diff(self.time), first, axis=-1)
            return np.asarray(energy[..., lasts] / duration[lasts])

        ends = np.append(time[:-1][lasts], time[-1])
        return Course(ends, *map(mean, (self.drawn, self.returned, self.total, self.left)))


# objectives of which the sum over all drives is that of the machine
SUMMED = tuple(name for name, kind in OBJECTIVES.items() if not kind.more_is_better and kind.kind != "temperature")


def objective_sum(objective: str, value: float, drives: int) -> float:
    """An objective of all drives of an axis, by that of one; the energy of a cycle is that of all already."""
    return value * (1 if objective == "energy" else drives)


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
    def closest(self) -> DriveSet | None:
        """The closest rejected drive."""
        return next(iter((*self.result.unsure, *self.result.misses)), None)

    @property
    def drives(self) -> int:
        """Drives of this kind on the axis."""
        return self.spec.load.motors

    @property
    def carried_mass(self) -> float:
        """Of all drives that ride on it [kg]."""
        return fsum(drive.mass for drive in self.carried)


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
    def alone(self) -> SizingResult | None:
        """The sizing of the axis of a machine that has no other; None of several."""
        return None if self.machine.is_several else self.axes[0].result

    @property
    def status(self) -> Status:
        """The worst of all axes and of the machine's own checks; a fail where an axis has no drive."""
        bests = [axis.best for axis in self.axes]
        return gravest([best.status if best else "fail" for best in bests] + [verdict(self.checks)])

    @property
    def complete(self) -> bool:
        """Whether every axis has a drive."""
        return all(axis.best for axis in self.axes)

    def axis(self, name: str) -> AxisSizing:
        """The axis of a name."""
        return axis_of(self.axes, name)

    def tightest(self, *, rejected: bool = False) -> tuple[Check, str] | None:
        """The check of the smallest margin with its axis, of all axes together with none.

        Of an axis without a drive it may be that of the closest rejected.
        """
        drives = [(axis.best or (axis.closest if rejected else None), axis.name) for axis in self.axes]
        checks = [(worst(drive.deciding), name) for drive, name in drives if drive]
        checks.append((worst(tuple(check for check in self.checks if not check.advice)), ""))
        return min([(check, name) for check, name in checks if check], key=lambda pair: pair[0].margin, default=None)

    @property
    def total(self) -> float:
        """Sum of the objective over all drives, SI; NaN where it is no sum, one is unknown, or an axis has no drive."""
        if self.objective not in SUMMED:
            return nan
        objectives = [
            objective_sum(self.objective, axis.best.objective, axis.drives) if axis.best else nan for axis in self.axes
        ]
        return nan if any(map(isnan, objectives)) else fsum(objectives)


def of_one_axis(result: SizingResult) -> MachineSizing:
    """A machine of one axis."""
    axis = AxisSizing(name=result.spec.name, result=result, carried=())
    return MachineSizing(
        machine=machine_of(result.spec), axes=(axis,), objective=result.objective, searches=1, certain=False, notes=()
    )
