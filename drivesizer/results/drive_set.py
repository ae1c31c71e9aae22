"""A drive: motor, gearhead, belt, brake, encoder and controller, with its checks, figures and changes."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isnan, nan
from typing import Any

from drivesizer.catalog import DIRECT, PARTS, Actuator, Brake, Controller, Encoder, Gearhead, Motor
from drivesizer.catalog.belt_drive import BeltDrive
from drivesizer.catalog.pull_outs import NO_PULL_OUTS, PullOuts
from drivesizer.physics.drive_train import MotorAndGears, drive_inertia, motor_and_gears
from drivesizer.physics.elements.braking import released_power
from drivesizer.results.braking import BrakingBudget
from drivesizer.results.check import Check, Figure, Status
from drivesizer.results.energy import EnergyBudget
from drivesizer.results.estimated import EstimatedFigure
from drivesizer.results.mass import MassRow
from drivesizer.results.notebook import checks_table, html_table
from drivesizer.results.pieces import MotorPiece
from drivesizer.results.reliability import Reliability
from drivesizer.results.requirement import Requirement
from drivesizer.results.screws import ChosenScrew
from drivesizer.units import show

__all__ = ["Comparison", "DriveParts", "DriveSet", "Relaxation", "made_by", "section_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """One limit as both methods see it, and why they differ."""

    paper: Check
    physics: Check
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Relaxation:
    """Change of one figure of the spec at which a drive passes."""

    field: str
    now: str
    needed: str
    set_label: str
    share: float  # how far that is, as a share of what it is now
    kind: str
    unit: str  # of the trade
    before: float  # SI
    after: float
    status: Status = "pass"  # of the drive then: where it is open or unknown no check of it fails


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveParts:
    """Motor, gearhead, belt, brake, encoder and controller that belong together."""

    motor: Motor
    gearhead: Gearhead
    encoder: Encoder | None
    controller: Controller | None
    belt_ratio: float
    belt_efficiency: float
    total_ratio: float
    actuator: Actuator | None = None  # that motor and gearhead are inside of
    brake: Brake | None = None  # a holding brake, where there is one
    belt_drive: BeltDrive | None = None  # belt and pulleys, where they are out of the catalogues
    chosen_screw: ChosenScrew | None = None  # nut and shaft, where they are out of the catalogues
    quickest: float = inf  # s, time constant of the quickest winding of its catalogues: as fine its cycle is cut
    pull_outs: PullOuts = field(default=NO_PULL_OUTS, compare=False, repr=False)  # printed curves of a stepper, row 0

    @property
    def steps(self) -> bool:
        """Whether the motor is a stepper, which runs without an encoder."""
        return self.motor.kind == "stepper"

    @property
    def brake_inertia(self) -> float:
        """Inertia of its brake as the motor's shaft feels it [kg*m^2]; 0 without one, NaN unknown."""
        if self.brake is None:
            return 0.0
        return self.brake.inertia / (self.total_ratio**2 if self.brake.shaft == "load" else 1.0)

    @property
    def at_motor(self) -> MotorAndGears[float]:
        """Ratio, inertia, friction and losses of motor and gears."""
        return MotorAndGears(*map(float, motor_and_gears(self.motor, self.gearhead, self.encoder, self.brake_inertia)))

    @property
    def unknown_inertias(self) -> list[str]:
        """Parts whose inertia is unknown, beside the rotor's."""
        known = {"brake": self.brake_inertia, "gearhead": self.gearhead.inertia}
        known |= {"encoder": self.encoder.inertia} if self.encoder else {}
        return [name for name, inertia in known.items() if isnan(inertia)]

    def inertia(self, unknown: float = nan) -> float:
        """Its inertia at the motor's shaft, brake and encoder included, by ``drive_inertia`` [kg*m^2]."""
        return float(drive_inertia(self.motor, self.gearhead, self.encoder, self.brake_inertia, unknown=unknown))

    @property
    def rotors_at_load(self) -> float:
        """The same at the load's shaft, as far as it is known [kg*m^2]."""
        return self.total_ratio**2 * self.inertia(unknown=0.0)

    @property
    def released_power(self) -> float:
        """Power that keeps its brake released [W]; 0 without one, or where it is unknown."""
        return float(released_power(self.brake)) if self.brake else 0.0

    @property
    def label(self) -> str:
        """The drive in a line: motor, gearhead, belt."""
        belt = f" + belt {self.belt_name}" if self.belt_name else ""
        if self.actuator:
            return f"{self.motor_name} ({self.gearhead.reduction or 'geared'} inside){belt}"
        names = self.gearhead.family, self.gearhead.reduction, self.gearhead.part
        gearhead = (
            names[2] if names[2].startswith(names[0]) else " ".join(filter(None, names))
        )  # the part number may begin with the family
        if self.gearhead.kind == DIRECT:
            return f"{self.motor_name} without gearhead{belt}"
        return f"{self.motor_name} + {gearhead}{belt}"

    @property
    def order_numbers(self) -> str:
        """Motor and gearhead, or the actuator, as ``--set`` takes them."""
        return self.actuator.part if self.actuator else f"{self.motor.part}/{self.gearhead.part or DIRECT}"

    @property
    def belt_name(self) -> str:
        """The belt's ratio, by the teeth of its pulleys where they are known; empty without a belt."""
        if self.belt_drive:
            return self.belt_drive.name
        return f"{self.belt_ratio:g}" if self.belt_ratio != 1.0 else ""

    @property
    def belt_running(self) -> tuple[str, ...]:
        """Course of the belt round its pulleys, in words; nothing where they are not known."""
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
        """The parts as they are bought, by role; None where none is known. What is inside one is no part of its own."""
        turning: dict[str, Any] = {"motor": self.motor, "gearhead": self.gearhead}
        held = {"brake": self.brake} if self.brake else {}
        controlling: dict[str, Any] = {**held, "encoder": self.encoder, "controller": self.controller}
        controlling = {role: part for role, part in controlling.items() if not getattr(part, "inside", "")}
        if self.steps and self.encoder is None:
            del controlling["encoder"]
        belt: dict[str, Any] = dict(self.belt_drive.parts) if self.belt_drive else {}
        belt |= {"screw": self.chosen_screw.screw} if self.chosen_screw else {}
        if not self.actuator:
            return {role: part for role, part in turning.items() if part.part != DIRECT} | belt | controlling
        return {"actuator": self.actuator} | belt | controlling


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveSet(DriveParts):
    """The parts of a drive with its checks and figures."""

    rank: int
    status: Status
    mass: float
    mass_of: tuple[str, ...]
    objective: float
    objective_of: tuple[str, ...]
    requirements: tuple[Requirement, ...]  # (17)-(20) for this drive
    checks: tuple[Check, ...]  # of the method that ranked
    figures: tuple[Figure, ...]  # what it does that has no limit of its own
    beside: tuple[Check, ...]  # of the other method, for the same set
    budget: tuple[Check, ...]  # of the machine with the drive in it: mass, room, footing, grip, battery
    machine: tuple[Figure, ...]  # of that machine, what has no limit of its own
    masses: tuple[MassRow, ...]  # what it weighs, part by part
    energy: EnergyBudget | None  # what draws from the battery, and how long it lasts; of the worst load case
    braking: BrakingBudget | None  # regenerated energy, the brake resistor for it, and the power supply
    comparison: tuple[Comparison, ...]  # where both methods look at the same limit
    changes: tuple[Relaxation, ...]  # where it fails: what would let it pass, each alone
    reliability: Reliability | None  # its probability, where tolerances were sampled
    estimated: tuple[EstimatedFigure, ...] = ()  # figures of its parts that no data sheet gives
    pieces: tuple[MotorPiece, ...] = ()  # its motor's torque piece by piece of the motion, of the first load cases
    probability: float = nan  # that none of its checks fails, where estimated figures leave one open

    @property
    def price(self) -> float:
        """Sum of the known prices of its parts [EUR]; NaN where none is known."""
        every = self.parts
        known = [every[role].price for role in self.price_of]
        return sum(known) if known else nan

    @property
    def price_complete(self) -> bool:
        """Whether the price of every part is known: else ``price`` is the least, and no figure to compare."""
        return len(self.price_of) == len(self.parts)

    @property
    def price_text(self) -> str:
        """The price as it is printed: at least that, where the price of some part is unknown."""
        least = "" if self.price_complete else "at least "
        return f"{least}{self.price:.2f} EUR" if self.price_of else "unknown"

    @property
    def price_of(self) -> tuple[str, ...]:
        """Roles of the parts whose price is known."""
        return tuple(role for role, part in self.parts.items() if part is not None and part.price == part.price)

    @property
    def without_controller(self) -> str:
        """Reason why it has no controller, in words; empty where it has one, or no catalogue lists any."""
        return next((check.note for check in self.own_checks if check.name == "controller_available"), "")

    @property
    def own_checks(self) -> tuple[Check, ...]:
        """The checks of the method that ranked and of the machine."""
        return (*self.checks, *self.budget)

    @property
    def deciding(self) -> tuple[Check, ...]:
        """Those that decide the status: not the informational ones."""
        return tuple(check for check in self.own_checks if not check.advice)

    def _repr_html_(self) -> str:
        """The drive as a table of a notebook: parts, then checks."""
        parts = [
            (role, part.manufacturer, part.family, part.part) if part else (role, "unknown", "", "")
            for role, part in self.parts.items()
        ]
        return html_table(("", "maker", "family", "part"), parts) + checks_table(self.own_checks)

    @property
    def every_check(self) -> tuple[Check, ...]:
        """Those and what the other method says."""
        return (*self.checks, *self.beside, *self.budget)


def section_of(part: Any) -> str:
    """The catalogue's section that a part is listed in, such as ``motors``."""
    return next(section for section, kind in PARTS.items() if isinstance(part, kind))


def made_by(part: Any) -> str:
    """Maker and family of a part; the family alone where it names its maker."""
    return str(part.family if part.manufacturer in part.family else f"{part.manufacturer} {part.family}")
