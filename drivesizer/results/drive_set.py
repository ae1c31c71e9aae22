"""A drive as a record: its parts, checks, figures, losses, energy, braking, and what was estimated of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from math import inf, isnan, nan
from typing import Any, Literal, NamedTuple

from drivesizer.catalog import DIRECT, PARTS, Actuator, Brake, BrakeResistor, Controller, Encoder, Gearhead, Motor
from drivesizer.catalog.parts import NO_PULL_OUTS, BeltDrive, PullOuts
from drivesizer.physics.braking import released_power
from drivesizer.physics.drive_train import MotorAndGears, drive_inertia, motor_and_gears
from drivesizer.physics.equation import Equation
from drivesizer.physics.figures import Alike, Array, Whole
from drivesizer.physics.power_stage import ASSUMED_BAND, ASSUMED_LOSS
from drivesizer.results.check import Check, Confidence, Figure, Reliability, Status, worst
from drivesizer.results.problem import ChosenScrew
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, show, show_band

# -- Figures of a drive's parts that no data sheet gives, as they were estimated from peers.


class EstimatedFigure(NamedTuple):
    """One figure of one part."""

    part: str  # motor, gearhead, encoder, controller, actuator
    figure: str  # column of the catalogue, or ``loss_voltage`` of a controller
    value: float  # SI
    low: float  # 5th percentile
    high: float  # 95th percentile
    kind: str
    unit: str  # of the trade
    law: str  # terms and peers, in words
    confidence: Confidence = "estimated from peers"  # assumed by class where no peers give it

    @property
    def title(self) -> str:
        """Part and figure.

        >>> EstimatedFigure("motor", "rotor_inertia", 1e-6, 7e-7, 2e-6, "inertia", "g*cm^2", "").title
        'motor rotor inertia'
        """
        return f"{self.part} {self.figure.removeprefix(f'{self.part}_').replace('_', ' ')}"

    @property
    def text(self) -> str:
        """Value and band as they are printed."""
        value, low, high = (show(figure, self.unit, self.kind, 2) for figure in (self.value, self.low, self.high))
        return f"{value} ({low} to {high})"


# -- Assumptions of the losses of a controller, as sentences.


def loss_assumptions(spec: RobotSpec, controller: Controller | None) -> Iterator[str]:
    """Assumptions of the losses between supply and motor."""
    bought, stage = controller or Controller(), spec.feed_of(controller).stage
    if stage.assumed:
        loss = show(ASSUMED_LOSS, "V", "voltage")
        yield f"controllers lose {loss} times the motor's current, assumed: neither drop nor efficiency is printed"
    elif bought.inside and not stage.loss:
        yield "losses of the controller inside are in the printed figures of what it is inside of"
    elif not stage.loss and spec.power_stage.voltage_drop is None:
        yield "losses of the controllers not counted: neither drop nor efficiency is printed"
    if spec.power_stage.standby is None and isnan(bought.standby_current):
        yield "standby power of the controllers not counted: it is not printed"


def voltage_assumption(spec: RobotSpec, controller: Controller | None) -> str:
    """Assumption behind the usable voltage of a controller that does not print what it takes of the supply's."""
    feed = spec.feed_of(controller)
    if not isnan(feed.usable):
        return ""
    if isnan(feed.stage.max_duty):
        return "the controller's largest duty is not printed: the supply's voltage is the bound"
    least, most = (show(drop, "V", "voltage") for drop in ASSUMED_BAND)
    return f"the controller's voltage drop is not printed: {least} to {most} assumed"


# -- The motor piece by piece of the motion: a record that every output prints.


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorPiece:
    """Torque and current of the motor in one piece of the motion, SI; NaN unknown."""

    case: str  # load case; empty where there is only one
    name: str  # accelerate, run, brake, rest, or the whole cycle
    start: float  # s, of its first moment
    duration: float  # s, of all pieces alike where they are several
    speed: float  # rad/s, largest of the motor
    load_torque: float  # N*m at the driven shaft of one drive, the largest with its sign
    motor_torque: float  # N*m, the largest with its sign
    rms_torque: float  # N*m of the motor
    current: float  # A, largest
    rms_current: float  # A


# -- The bus while the drives brake: what is regenerated, the brake resistor and the power supply, as records.


@dataclass(frozen=True, slots=True, kw_only=True)
class BrakingBudget:
    """Regenerated energy, and what becomes of it; of the load case in which most is burnt."""

    resistor: BrakeResistor | None  # chosen, or as the spec has it; None where none is wanted or needed
    checks: tuple[Check, ...]  # of resistor, chopper and power supply
    figures: tuple[Figure, ...]
    assumptions: tuple[str, ...]

    @property
    def name(self) -> str:
        """The resistor in words; empty without one."""
        return " ".join(filter(None, (self.resistor.manufacturer, self.resistor.part))) if self.resistor else ""


# -- A line of a mass budget.


@dataclass(frozen=True, slots=True, kw_only=True)
class MassRow:
    """One line of a mass budget."""

    name: str
    each: float  # kg; NaN is unknown
    number: int = 1
    band: tuple[float, float] | None = None  # kg, 5th and 95th percentile where it is estimated

    @property
    def total(self) -> float:
        """Of all of them [kg]."""
        return self.number * self.each

    @property
    def ends(self) -> tuple[float, float]:
        """Of all of them at both ends of the band [kg]; twice the same where it is known."""
        low, high = self.band or (self.each, self.each)
        return self.number * low, self.number * high

    def text(self, mass: float, unit: str) -> str:
        """A mass of the row as it is printed, with the band where it is estimated.

        >>> MassRow(name="encoder", each=0.02, band=(0.005, 0.08)).text(0.02, "g")
        '20 g (5 to 80 g)'
        """
        if self.band is None or not self.each > 0.0:
            return show(mass, unit, "mass")
        low, high = (mass * end / self.each for end in self.band)
        return f"{show(mass, unit, 'mass', 2)} ({show_band(low, high, unit, 'mass')})"


# -- Consumers of a battery and how long it lasts, as records.


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


# -- A requirement: what a load needs of a part, with the equation that it comes from.


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """A quantity that the load requires, with the equation and the numbers it came from."""

    name: str
    title: str
    symbol: str
    value: Alike  # SI; one figure, or a column while the search runs
    kind: str
    unit: str  # of the trade
    declared: Equation | None = None  # None: given in the spec
    inputs: dict[str, Alike] = field(default_factory=dict)  # SI, by the equation's own names
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

    def on(self, rows: Whole | int) -> Requirement:
        """The figures of some candidates out of a column, or the figure of one."""

        def pick(value: Alike) -> Alike:
            own = value[rows] if getattr(value, "ndim", 0) else value
            return own if getattr(own, "ndim", 1) else float(own)

        return replace(self, value=pick(self.value), inputs={k: pick(v) for k, v in self.inputs.items()})


# -- Tables for notebooks, which show what ``_repr_html_`` of a record gives.


def html_table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """An HTML table, every text escaped.

    Examples
    --------
    >>> html_table(("a",), [("<1>",)])
    '<table><tr><th>a</th></tr><tr><td>&lt;1&gt;</td></tr></table>'
    """
    from html import escape  # whose table of names takes a millisecond to load

    lines = ["".join(f"<th>{escape(head)}</th>" for head in heads)]
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def checks_table(checks: Iterable[Check]) -> str:
    """Checks with demand, limit, margin and verdict as an HTML table."""
    rows = (
        (check.title, check.with_unit(check.demand), check.with_unit(check.limit), share(check.margin), check.status)
        for check in checks
    )
    return html_table(("check", "demand", "limit", "margin", ""), rows)


def share(margin: float) -> str:
    """A margin in per cent; empty where there is none."""
    return "" if isnan(margin) else f"{100 * margin:+.0f} %"


# -- A drive: motor, gearhead, belt, brake, encoder and controller, with its checks, figures and changes.


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
    belt_ratio: float  # 1 without a belt
    belt_efficiency: float
    total_ratio: float  # motor turns per turn of the load's shaft
    actuator: Actuator | None = None  # that motor and gearhead are inside of
    brake: Brake | None = None  # a holding brake, where there is one
    belt_drive: BeltDrive | None = None  # belt and pulleys, where they are out of the catalogues
    chosen_screw: ChosenScrew | None = None  # nut and shaft, where they are out of the catalogues
    currency: str = "EUR"  # of the prices of its parts, as they are compared
    quickest: float = inf  # s, time constant of the quickest winding of its catalogues: as fine its cycle is cut
    pull_outs: PullOuts = field(default=NO_PULL_OUTS, compare=False, repr=False)  # printed curves of a stepper, row 0

    @property
    def steps(self) -> bool:
        """Whether the motor is a stepper, which runs without an encoder."""
        return bool(self.motor.kind == "stepper")

    @property
    def brake_inertia(self) -> float:
        """Inertia of its brake as the motor's shaft feels it [kg*m^2]; 0 without one, NaN unknown."""
        if self.brake is None:
            return 0.0
        return float(self.brake.inertia) / (self.total_ratio**2 if self.brake.shaft == "load" else 1.0)

    @property
    def at_motor(self) -> MotorAndGears[float]:
        """Ratio, inertia, friction and losses of motor and gears."""
        return MotorAndGears(*map(float, motor_and_gears(self.motor, self.gearhead, self.encoder, self.brake_inertia)))

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
        brake = {"brake": self.brake} if self.brake else {}
        controlling: dict[str, Any] = {**brake, "encoder": self.encoder, "controller": self.controller}
        controlling = {role: part for role, part in controlling.items() if not getattr(part, "inside", "")}
        if self.steps and self.encoder is None:
            del controlling["encoder"]
        belt: dict[str, Any] = dict(self.belt_drive.parts) if self.belt_drive else {}
        belt |= {"screw": self.chosen_screw.screw} if self.chosen_screw else {}
        if not self.actuator:
            return {role: part for role, part in turning.items() if part.part != DIRECT} | belt | controlling
        return {"actuator": self.actuator} | belt | controlling


Detail = Literal["full", "drives", "headline", "checks"]
"""Of a result all; its drives alone; of these but the first sums and checks; of each its sums and tightest check."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveSet(DriveParts):
    """The parts of a drive with its checks and figures."""

    rank: int  # from 1
    status: Status  # by the method that ranked
    mass: float  # kg, of the parts that ``mass_of`` names
    mass_of: tuple[str, ...]
    objective: float  # SI; of several objectives the weighted sum of shares
    objective_of: tuple[str, ...]  # whose figures are summed
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
    mass_estimated: tuple[str, ...] = ()  # of ``mass_of`` those whose mass is estimated, or assumed
    pieces: tuple[MotorPiece, ...] = ()  # its motor's torque piece by piece of the motion, of the first load cases
    probability: float = nan  # that none of its checks fails, where estimated figures leave one open

    @property
    def price(self) -> float:
        """Sum of the known prices of its parts [its currency]; NaN where none is known."""
        parts = self.parts
        known = [parts[role].price for role in self.price_of]
        return sum(known) if known else nan

    @property
    def price_complete(self) -> bool:
        """Whether the price of every part is known: else ``price`` is the least, and no figure to compare."""
        return len(self.price_of) == len(self.parts)

    @property
    def price_text(self) -> str:
        """The price as it is printed: at least that, where the price of some part is unknown."""
        least = "" if self.price_complete else "at least "
        return f"{least}{self.price:.2f} {self.currency}" if self.price_of else "unknown"

    @property
    def mass_text(self) -> str:
        """The mass as it is printed: at least that where a part's is unknown, about where one is estimated."""
        if isnan(self.mass):
            return "unknown"
        mark = "≥ " if self.unknown_parts("mass", self.mass_of) else "≈ " if self.mass_estimated else ""
        return mark + show(self.mass, "g", "mass", 3 if self.mass_estimated else 4)

    def unknown_parts(self, objective: str, known: Iterable[str]) -> tuple[str, ...]:
        """Roles of the parts that an objective is summed over, and that are not among those known."""
        counted = {"actuator", *OBJECTIVES[objective].over}
        return tuple(role for role in self.parts if role in counted and role not in known)

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

    @property
    def cells(self) -> tuple[str, ...]:
        """Its line in a table; a price that lacks a part is at least that."""
        tight = worst(self.deciding)
        margin = f"{share(tight.margin)} {tight.title}" if tight else ""
        names = self.motor_name, self.gearhead_name
        return (str(self.rank), *names, self.mass_text, self.price_text, margin, self.status)

    def __str__(self) -> str:
        """The drive in a line."""
        return "  ".join(self.cells)

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
