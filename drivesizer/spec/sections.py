"""Sections of robot.yaml on the machine: its purpose, load cases, surroundings, supply, margins, lives."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from drivesizer.files.fields import (
    Allowance,
    Altitude,
    Angle,
    Capacitance,
    Consumed,
    Current,
    Drop,
    Duration,
    Factor,
    Force,
    Frequency,
    Gravity,
    Length,
    Mass,
    Part,
    Power,
    Price,
    Quantity,
    Ratio,
    Resistance,
    Section,
    Share,
    Temperature,
    Torque,
    TorqueAbove,
    Turning,
    Velocity,
    Voltage,
    all_defaults,
    default,
    no_entries,
)

__all__ = [
    "Case", "Environment", "Lives", "Margins", "Mission", "Needs", "PaperFactors", "PowerStage", "Requirements",
    "Supply", "TitleBlock", "required_life",
]  # fmt: skip


# -- Required life: of all parts that have one, or of some of them by name.


LifeOf = Literal["screw", "gearhead", "output_bearing"]


class Lives(Section):
    """Life of parts by name, in hours of the cycle, rests included; of the others none is required."""

    screw: Duration | None = Field(default=None, description="of a ball screw")
    gearhead: Duration | None = Field(default=None, description="of its gears, by its rated life")
    output_bearing: Duration | None = Field(default=None, description="of the gearhead's output, under section shaft")

    @model_validator(mode="after")
    def _some(self) -> Self:
        if self.screw is self.gearhead is self.output_bearing is None:
            raise ValueError("give screw, gearhead or output_bearing, or one time for all, e.g. life: 20000 h")
        return self


Life = Annotated[
    Annotated[Duration, Tag("of all")] | Annotated[Lives, Tag("by part")],
    Discriminator(lambda given: "by part" if isinstance(given, dict | Lives) else "of all"),
]


def required_life(life: Any, part: LifeOf) -> Any:
    """Life that is required of a part.

    Examples
    --------
    >>> required_life(3600.0, "screw"), required_life(Lives(gearhead="1 h"), "screw")
    (3600.0, None)
    """
    return getattr(life, part) if isinstance(life, Lives) else life


# -- Section of a spec on what the machine is for, as far as no other section has it.


class Travel(Section):
    """A distance that a vehicle must cover in a time."""

    distance: Length
    within: Duration


class Requirements(Section):
    """Requirements on the machine; autonomy and range stand in `battery`, doors in `platform`, the mass in `budget`."""

    travel: Travel | None = Field(default=None, description="by a vehicle, at the mean speed of its motion")
    speed: Velocity | None = Field(default=None, description="that the motion must reach")
    devices: Annotated[list[Annotated[str, Field(min_length=1, max_length=60)]], Field(max_length=100)] = no_entries(
        description="that it must carry: names of `equipment`, of `others` of `budget` or of payloads"
    )

    @model_validator(mode="after")
    def _something(self) -> Self:
        if self.travel is None and self.speed is None and not self.devices:
            raise ValueError("give travel, speed or devices, e.g. travel: {distance: 7 km, within: 80 min}")
        if len(set(self.devices)) != len(self.devices):
            raise ValueError("expected devices with names of their own")
        return self


# -- The sections of robot.yaml that are not load, motion, transmission, loop, choice, battery or platform.


class PaperFactors(Section):
    """The paper's factors; it gives no values for them."""

    speed_reserve: Share = Field(default=1, description="η of (1)")
    bearing: Share = Field(default=1, description="δ of (2)")
    robot_efficiency: Share = Field(default=1, description="η of (10)")
    confidence: Share = Field(default=1, description="κ of (7)")
    oversize: Factor = Field(default=1, description="PF of (7) and (10)")


class Supply(Section):
    """The electrical supply of the motor controllers."""

    kind: Literal["power_supply", "battery", "drive_bus"] | None = Field(
        default=None,
        description="power_supply: a unit that takes nothing back; battery: takes all; drive_bus: the rectified bus of "
        "drives, whose capacitors store; only the other fields count where not given",
    )
    part: str | None = Field(default=None, min_length=1, description="power supply of a catalogue, one for the machine")
    nominal: Voltage = Field(
        description="direct voltage at the controllers; of drives at the mains that of their bus: 325 V at 230 V"
    )
    min: Voltage | None = Field(default=None, description="lowest voltage; nominal where not given")
    max: Voltage | None = Field(default=None, description="highest voltage; nominal where not given")
    resistance: Resistance | None = Field(
        default=None, description="of the source and all cables; of the cables alone where a section battery is"
    )
    current: Current | None = Field(default=None, description="that the supply can deliver to all drives")
    power: Power | None = Field(default=None, description="that the supply can deliver to all drives")
    peak_current: Current | None = Field(
        default=None, description="that it can deliver for peak_time; current is then the continuous one"
    )
    peak_time: Duration | None = None
    overvoltage_trip: Voltage | None = Field(
        default=None, description="at which it switches off, or that it withstands from outside"
    )
    regeneration: Part = Field(
        default=0, description="share of regenerated energy that is stored and used again; 0 none"
    )
    accepts: Literal["all", "share"] | None = Field(
        default=None,
        description="all: the rest of it is lost as heat, in a battery or a brake resistor, as where a section battery "
        "is; share: the rest stays on the bus, as of a power supply unit",
    )
    capacitance: Capacitance | None = Field(default=None, description="of the bus, where what is not accepted stays")

    brakes: Voltage | None = Field(
        default=None,
        description="that holding brakes are fed with, as nominal where they share this supply; where not given "
        "brakes of another voltage have a supply of their own",
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not (self.min or self.nominal) <= self.nominal <= (self.max or self.nominal):
            low, high = (None if one is None else f"{one:g} V" for one in (self.min, self.max))
            given = [("min", low), ("nominal", f"{self.nominal:g} V"), ("max", high)]
            found = ", ".join(f"{name} {text}" for name, text in given if text)
            raise ValueError(f'"{found}": expected min <= nominal <= max')
        return self

    @model_validator(mode="after")
    def _of_one_kind(self) -> Self:
        if self.kind == "power_supply" and (self.regeneration or self.accepts == "all"):
            raise ValueError("a power_supply takes nothing back; leave regeneration and accepts out, or another kind")
        if self.kind == "battery" and self.accepts == "share":
            raise ValueError("a battery takes all that is regenerated; leave accepts out, or another kind")
        if self.part is not None and self.kind not in (None, "power_supply"):
            raise ValueError(f"give part for kind: power_supply, not for a {self.kind}")
        return self

    @model_validator(mode="after")
    def _peaks(self) -> Self:
        if self.peak_time is not None and self.peak_current is None and self.part is None:
            raise ValueError("give peak_current with peak_time")
        if self.peak_current is not None:
            if self.current is None and self.part is None:
                raise ValueError("give current with peak_current: the continuous one")
            if self.current is not None and self.peak_current < self.current:
                raise ValueError("expected peak_current >= current")
        if self.overvoltage_trip is not None and self.overvoltage_trip <= self.highest:
            raise ValueError("expected overvoltage_trip above the highest voltage, max or nominal")
        return self

    @property
    def lowest(self) -> float:
        """Lowest supply voltage [V]."""
        return self.nominal if self.min is None else self.min

    @property
    def most_current(self) -> float | None:
        """Largest current that it delivers, for however short a time [A]; None: no limit is given."""
        return self.current if self.peak_current is None else self.peak_current

    @property
    def highest(self) -> float:
        """Highest supply voltage [V]."""
        return self.nominal if self.max is None else self.max


class PowerStage(Section):
    """Losses of each controller, in place of what its catalogue prints or the program assumes; not inside actuators."""

    voltage_drop: Drop | None = Field(
        default=None, description="of the voltage that reaches the motor, and lost per ampere at any current"
    )
    resistance: Resistance | None = Field(default=None, description="in series with the winding; none where not given")
    standby: Consumed | None = Field(default=None, description="that each draws at any time; also inside actuators")


class Environment(Section):
    """Surroundings in which the machine works."""

    ambient: Temperature = default("25 degC")
    altitude: Altitude = default("0 m", description="above sea level: thin air cools less above 1000 m; at most 4000 m")
    gravity: Gravity = default("9.80665 m/s^2")


class Margins(Section):
    """Margins by which every limit must exceed the demand, by physics; the paper has its own factors."""

    torque: Allowance = Field(default=0, description="of gearhead torques, currents, traction, loads of a screw")
    speed: Allowance = Field(default=0, description="of motor, gearhead, encoder and screw speeds, and of voltage")
    temperature: Allowance = Field(default=0, description="of the winding's permitted rise over the ambient")
    pull_out: Factor = Field(default=2, description="a stepper's pull-out torque over the load's, at each speed")


class Mission(Section):
    """Use of the motion, for the closed loop."""

    duration: Duration = Field(description="for which the cycle is repeated, rounded up to whole cycles")


class Needs(Section):
    """Requirements on the drive beyond moving the load."""

    encoder_counts: Annotated[int, Field(ge=1)] | None = Field(default=None, description="counts per motor turn")
    backlash_at_load: Angle | None = Field(default=None, description="lost motion of the gearhead, seen at the load")
    bandwidth: Frequency | None = Field(default=None, description="of the closed velocity loop")
    resolution_at_load: Angle | None = Field(default=None, description="angle of the load per edge of the encoder")
    inertia_ratio: Ratio | None = Field(default=None, description="load's inertia over the motor's, at most")
    start_speed: Turning | None = Field(
        default=None, description="of the motor: a stepper's to which it jumps without a ramp"
    )
    resonance: Frequency | None = Field(default=None, description="of motor and load on the belt, at least")
    hold_unpowered: bool = Field(default=False, description="the load must stay where it is without power")
    life: Life | None = Field(
        default=None,
        description="of gearhead, its output bearing and ball screw: hours of the cycle, rests included; or of some",
    )
    shock_torque: TorqueAbove | None = Field(
        default=None, description="at the load's shaft, in an emergency stop or a collision"
    )
    holding_factor: Factor = Field(default=2, description="of a brake's torque over that of the load at rest")
    holding_friction: Literal["ignored", "counted"] = Field(
        default="ignored", description="printed friction and detent torque of the motor, beside the brake's torque"
    )
    emergency_stops: Annotated[int, Field(ge=1)] | None = Field(
        default=None, description="stops by the brake from the highest speed, in the machine's life"
    )
    radial_load: Force | None = Field(
        default=None,
        description="on the gearhead's shaft, or the motor's without one; added to the load of section shaft",
    )
    axial_load: Force | None = Field(default=None, description="on the same shaft, added to that of section shaft")
    tilting_moment: Torque | None = Field(
        default=None, description="on the gearhead's output, beside that of the radial load at its distance"
    )
    diameter: Length | None = Field(default=None, description="of motor and gearhead, at most")
    length: Length | None = Field(default=None, description="of motor, gearhead and brake together, at most")
    mass: Mass | None = Field(default=None, description="of motor, gearhead and brake together, at most")
    price: Price | None = Field(default=None, description="of motor, gearhead and brake together, at most")

    @model_validator(mode="after")
    def _held(self) -> Self:
        if self.holding_friction == "counted" and not self.hold_unpowered:
            raise ValueError("give hold_unpowered: true with holding_friction: counted")
        return self


class Case(Section):
    """Changes of a further load case; everything else is as in the spec."""

    @model_validator(mode="after")
    def _shared(self) -> Self:
        if self.lasting is not None and self.share is None:
            raise ValueError("lasting: it is of a case with a share of the time; expected share, e.g. 10 %")
        if self.share is not None and (self.supply or self.environment):
            raise ValueError("share: a case that alternates with others keeps supply and environment; leave it out")
        return self

    name: str = Field(min_length=1, max_length=60)
    share: Annotated[float, Quantity("dimensionless", above=0.0, most=0.99)] | None = Field(
        default=None,
        description="of the time: cycles of the case alternate with those as specified, for heat, energy and battery "
        "too; without it the machine is sized as if the case were continuous",
    )
    lasting: Duration | None = Field(
        default=None, description="of a case with a share, uninterrupted; one cycle where not given"
    )
    load: dict[str, Any] = all_defaults()
    motion: dict[str, Any] = all_defaults()
    supply: dict[str, Any] = all_defaults()
    environment: dict[str, Any] = all_defaults()
    platform: dict[str, Any] = all_defaults()


_Line = Annotated[str, Field(min_length=1, max_length=200)]


class TitleBlock(Section):
    """Whom a report is for, and whose it is."""

    customer: _Line | None = None
    project: _Line | None = None
    author: _Line | None = None
    revision: _Line | None = Field(default=None, description='such as "B" or "2.1"; quoted where it is a number')
