"""What a sizing gives: requirements, drive sets and their checks, as plain records.

Terminal, JSON, CSV and reports all print these records and compute nothing of their own. Figures are SI
floats; each carries its kind and the unit of the trade it is shown in. NaN is *unknown*.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.belts import BeltDrive
from drivesizer.cascade import Cascade, ControllerGain
from drivesizer.catalog import DIRECT, Actuator, Catalog, Controller, Encoder, Gearhead, Motor
from drivesizer.checked import Check, Figure, Status, verdict, worst
from drivesizer.declare import Equation
from drivesizer.energy_records import EnergyBudget
from drivesizer.loops import Loop
from drivesizer.mass_rows import MassRow
from drivesizer.spec import RobotSpec
from drivesizer.tolerances.records import Reliability, Uncertainty
from drivesizer.units import from_si, show

__all__ = [
    "Check",
    "Comparison",
    "Counts",
    "DriveSet",
    "Explanation",
    "Figure",
    "Gains",
    "Relaxation",
    "Requirement",
    "SizingResult",
    "Status",
    "Validation",
    "made_by",
    "section_of",
    "verdict",
    "worst",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """A quantity that the load asks for, with the equation and the numbers it came from."""

    name: str
    title: str
    symbol: str
    value: Any  # SI; one figure, or a column while the search runs
    kind: str
    unit: str  # of the trade
    declared: Equation | None = None  # None: given in the spec
    inputs: dict[str, Any] = field(default_factory=dict)  # SI, by the equation's own names
    note: str = ""

    @property
    def equation(self) -> int | None:
        """The paper's number, None for what it does not number."""
        return self.declared.number if self.declared else None

    @property
    def shown(self) -> float:
        """The value in the unit of the trade."""
        return float(from_si(self.value, self.unit, self.kind))

    @property
    def text(self) -> str:
        """The value as it is printed."""
        return show(self.value, self.unit, self.kind)

    def at(self, index: int) -> Requirement:
        """The figure of one candidate out of a column."""

        def pick(value: Any) -> Any:
            return float(value[index]) if getattr(value, "ndim", 0) else value

        return replace(self, value=pick(self.value), inputs={k: pick(v) for k, v in self.inputs.items()})

    def on(self, rows: NDArray[np.int64]) -> Requirement:
        """The figures of some candidates out of a column."""

        def pick(value: Any) -> Any:
            return value[rows] if getattr(value, "ndim", 0) else value

        return replace(self, value=pick(self.value), inputs={k: pick(v) for k, v in self.inputs.items()})


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """One limit as both methods see it, and why they differ."""

    paper: Check
    physics: Check
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Relaxation:
    """How far one figure of the spec must move until a set passes."""

    field: str
    now: str
    needed: str
    set_label: str
    share: float  # how far that is, as a share of what it is now
    kind: str
    unit: str  # of the trade
    before: float  # SI
    after: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveSet:
    """Motor, gearhead, belt, encoder and controller that belong together, and how they do."""

    rank: int
    status: Status
    motor: Motor
    gearhead: Gearhead
    encoder: Encoder | None
    controller: Controller | None
    belt_ratio: float
    belt_efficiency: float
    total_ratio: float
    mass: float
    mass_of: tuple[str, ...]
    objective: float
    objective_of: tuple[str, ...]
    requirements: tuple[Requirement, ...]  # (17)-(20) for this set
    checks: tuple[Check, ...]  # of the method that ranked
    figures: tuple[Figure, ...] = ()  # what it does that has no limit of its own
    beside: tuple[Check, ...] = ()  # of the other method, for the same set
    budget: tuple[Check, ...] = ()  # of the machine with the set in it: mass, room, footing, grip, battery
    machine: tuple[Figure, ...] = ()  # of that machine, what has no limit of its own
    masses: tuple[MassRow, ...] = ()  # what it weighs, part by part
    energy: EnergyBudget | None = None  # what draws from the battery, and how long it lasts; of the worst load case
    comparison: tuple[Comparison, ...] = ()  # where both methods look at the same limit
    changes: tuple[Relaxation, ...] = ()  # where it fails: what would let it pass, each alone
    actuator: Actuator | None = None  # that motor and gearhead are inside of
    belt_drive: BeltDrive | None = None  # belt and pulleys, where they are out of the catalogues
    reliability: Reliability | None = None  # how sure it is, where tolerances were sampled
    quickest: float = inf  # s, time constant of the quickest winding of its catalogues: as fine its cycle is cut

    @property
    def own_checks(self) -> tuple[Check, ...]:
        """The checks of the method that ranked and of the machine."""
        return (*self.checks, *self.budget)

    @property
    def deciding(self) -> tuple[Check, ...]:
        """Of those what a set stands or falls by: not mere advice."""
        return tuple(check for check in self.own_checks if not check.advice)

    @property
    def every_check(self) -> tuple[Check, ...]:
        """Those and what the other method says."""
        return (*self.checks, *self.beside, *self.budget)

    @property
    def label(self) -> str:
        """The set in a line: motor, gearhead, belt."""
        belt = f" + belt {self.belt_name}" if self.belt_name else ""
        if self.actuator:
            return f"{self.motor_name} ({self.gearhead.reduction or 'geared'} inside){belt}"
        names = self.gearhead.family, self.gearhead.reduction, self.gearhead.part
        gearhead = names[2] if names[2].startswith(names[0]) else " ".join(filter(None, names))  # its part may tell all
        if self.gearhead.kind == DIRECT:
            return f"{self.motor_name} without gearhead{belt}"
        return f"{self.motor_name} + {gearhead}{belt}"

    @property
    def belt_name(self) -> str:
        """The belt's ratio, by the teeth of its pulleys where they are known; empty without a belt."""
        if self.belt_drive:
            return self.belt_drive.name
        return f"{self.belt_ratio:g}" if self.belt_ratio != 1.0 else ""

    @property
    def belt_running(self) -> tuple[str, ...]:
        """How the belt runs round its pulleys, in words; nothing where they are not known."""
        drive = self.belt_drive
        if drive is None:
            return ()
        return (
            f"{drive.name} = {drive.ratio:.4g}",
            show(self.belt_efficiency, "%", "dimensionless") + " efficient",
            f"centre distance {show(drive.centre_distance, 'mm', 'length')}",
            f"{drive.teeth_in_mesh:.1f} teeth in mesh",
        )

    @property
    def motor_name(self) -> str:
        """Family and part of the motor, or of the actuator that it is inside of."""
        family, part = self.motor.family, self.motor.part
        return part if part.startswith(family) else f"{family} {part}"

    @property
    def gearhead_name(self) -> str:
        """Family and reduction of the gearhead, or where it is."""
        if self.gearhead.kind == DIRECT:
            return "none"
        family = "inside" if self.actuator else self.gearhead.family
        return f"{family} {self.gearhead.reduction}".strip()

    @property
    def parts(self) -> dict[str, Any]:
        """The parts as they are bought, by role; None where none is known. An actuator is one part."""
        turning: dict[str, Any] = {"motor": self.motor, "gearhead": self.gearhead}
        controlling = {"encoder": self.encoder, "controller": self.controller}
        belt = self.belt_drive.parts if self.belt_drive else {}
        if not self.actuator:
            return {role: part for role, part in turning.items() if part.part != DIRECT} | belt | controlling
        outside = {role: part for role, part in controlling.items() if part is None or not part.inside}
        return {"actuator": self.actuator} | belt | outside


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """How many sets were looked at, how many stand, and how many fell by which check."""

    considered: int
    feasible: int
    failed_by: dict[str, int]
    judged: int = 0  # of those that no check of the drive makes fall, the best that were held against the machine
    failed_by_budget: dict[str, int] = field(default_factory=dict)  # of these, how many fell by which budget


@dataclass(frozen=True, slots=True, kw_only=True)
class SizingResult:
    """Everything that a sizing found."""

    spec: RobotSpec
    catalog: Catalog
    method: str
    objective: str
    requirements: tuple[Requirement, ...]
    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    misses: tuple[DriveSet, ...]  # the nearest that fall, where fewer stand than were asked for
    relaxations: tuple[Relaxation, ...]
    counts: Counts
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    unrestricted: DriveSet | None = None  # what the whole catalogue would give, where the spec restricts it
    front: tuple[DriveSet, ...] = ()  # the Pareto front, where one was asked for
    pareto: tuple[str, ...] = ()  # its objectives
    unsure: tuple[DriveSet, ...] = ()  # that stand, but not as surely as was asked for; the surest first
    uncertainty: Uncertainty | None = None  # what was uncertain, where tolerances were sampled

    @property
    def shown(self) -> DriveSet | None:
        """The set that is told in full: the best, else the surest, else the nearest miss; None without any."""
        return next(iter((*self.sets, *self.unsure, *self.misses)), None)


class Explanation(NamedTuple):
    """What was found of one pair of motor and gearhead."""

    sets: list[DriveSet]  # with every belt ratio
    uncertainty: Uncertainty | None  # what was uncertain, where tolerances were sampled
    warnings: tuple[str, ...] = ()  # of the motion


def section_of(part: Any) -> str:
    """The catalogue's section that a part is listed in, such as ``motors``."""
    return f"{type(part).__name__.lower()}s"


def made_by(part: Any) -> str:
    """Maker and family of a part; the family alone where it names its maker."""
    return str(part.family if part.manufacturer in part.family else f"{part.manufacturer} {part.family}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """A velocity controller's gains and where they come from."""

    kp: float  # V per rad/s at the motor
    ki: float  # V per rad
    kd: float  # V per rad/s^2
    filter_time: float  # s, of the derivative
    period: float  # s, at which the controller runs
    counted_over: int = 0  # periods, over which counts are taken for a speed; 0: it is measured exactly
    rule: str  # "given in the spec", or the design rule's name
    source: str  # the rule's citation


@dataclass(frozen=True, slots=True, kw_only=True)
class Validation:
    """A drive set driven through a profile in closed loop."""

    spec: RobotSpec
    drive_set: DriveSet
    case: str = ""  # the load case that was driven, where there are several
    profile: str
    status: Status  # what its checks amount to
    checks: tuple[Check, ...]  # with the time of the worst moment
    figures: tuple[Figure, ...]  # tracking error, bandwidth, margins of stability ...
    gains: Gains | Cascade
    series: dict[str, NDArray[np.float64]]  # SI columns over time, "time" first
    series_units: dict[str, tuple[str, str]]  # per column: kind and unit of the trade
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    controller_gains: tuple[ControllerGain, ...] = ()  # the same in the controller's own units, where known
    loops: tuple[Loop, ...] = ()  # what linear theory says of each, from the inside out

    @property
    def over(self) -> str:
        """The profile that was driven, and the load case where there are several and it does not name the profile."""
        return f"{self.profile}, {self.case}" if self.case and self.case not in self.profile else self.profile
