"""Sections of robot.yaml on the machine: its purpose, load cases, surroundings, supply, battery, margins, lives."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import ConfigDict, Discriminator, Field, PrivateAttr, Tag, model_validator

from drivesizer.errors import InputError
from drivesizer.files import fields
from drivesizer.files.yaml_source import Path_
from drivesizer.units import to_si

FREE, EXPRESSION = "free", "expression"  # keys in place of a figure
_Text = Annotated[str, Field(min_length=1, max_length=400)]


class Design(fields.Section):
    """Goals and limits of the spec's free figures, for `drivesizer design`."""

    minimise: _Text | None = fields.optional(
        "mass, price, energy, time, -autonomy, or an expression; the objective under select where not given",
        example="mass + 0.1 * price",
    )
    subject_to: Annotated[list[_Text], Field(max_length=50)] = fields.no_entries(
        "limits beside all checks, such as autonomy >= 3 h"
    )
    pareto: Annotated[list[_Text], Field(max_length=4)] = fields.no_entries(
        "figures of which no machine of the front is worse in all, such as [mass, energy]"
    )
    evaluations: Annotated[int, Field(ge=10, le=1_000_000)] = fields.default(
        2000, "machines that are sized at most before the best is refined; a grid of fewer is sized whole"
    )
    seed: Annotated[int, Field(ge=0)] = fields.default(0, "of the search where not all are sized")


def open_figures(data: Any, path: Path_ = ()) -> Iterator[tuple[Path_, dict[str, Any]]]:
    """Places of a document where a range, a choice or an expression stands for a figure, in its order."""
    if isinstance(data, dict) and (FREE in data or EXPRESSION in data):
        yield path, data
    elif isinstance(data, dict | list):
        for step, below in data.items() if isinstance(data, dict) else enumerate(data):
            yield from open_figures(below, (*path, step))


# -- Required life: of all parts that have one, or of some of them by name.


LifeOf = Literal["screw", "gearhead", "output_bearing"]


class Lives(fields.Section):
    """Life of parts by name, in hours of the cycle, rests included; of the others none is required."""

    screw: fields.Duration | None = fields.optional("of a ball screw", example="20000 h")
    gearhead: fields.Duration | None = fields.optional("of its gears, by its rated life", example="20000 h")
    output_bearing: fields.Duration | None = fields.optional(
        "of the gearhead's output, under section shaft", example="20000 h"
    )

    def _contradictions(self) -> Iterator[str]:
        if self.screw is self.gearhead is self.output_bearing is None:
            yield "give screw, gearhead or output_bearing, or one time for all, e.g. life: 20000 h"


Life = Annotated[
    Annotated[fields.Duration, Tag("of all")] | Annotated[Lives, Tag("by part")],
    Discriminator(lambda life: "by part" if isinstance(life, dict | Lives) else "of all"),
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


class Travel(fields.Section):
    """A distance that a vehicle must cover in a time."""

    distance: fields.Length = fields.required(example="7 km")
    within: fields.Duration = fields.required(example="80 min")


class Requirements(fields.Section):
    """Requirements on the machine; autonomy and range stand in `battery`, doors in `platform`, the mass in `budget`."""

    travel: Travel | None = fields.optional("by a vehicle, at the mean speed of its motion")
    speed: fields.Velocity | None = fields.optional("that the motion must reach")
    devices: Annotated[list[Annotated[str, Field(min_length=1, max_length=60)]], Field(max_length=100)] = (
        fields.no_entries("that it must carry: names of `equipment`, of `others` of `budget` or of payloads")
    )

    def _contradictions(self) -> Iterator[str]:
        if self.travel is None and self.speed is None and not self.devices:
            yield "give travel, speed or devices, e.g. travel: {distance: 7 km, within: 80 min}"
        if len(set(self.devices)) != len(self.devices):
            yield "expected devices with names of their own"


# -- The sections of robot.yaml that are not load, motion, transmission, loop, choice, battery or platform.


class PaperFactors(fields.Section):
    """The paper's factors; it gives no values for them."""

    speed_reserve: fields.Share = fields.default(1, "η of (1)")
    bearing: fields.Share = fields.default(1, "δ of (2)")
    robot_efficiency: fields.Share = fields.default(1, "η of (10)")
    confidence: fields.Share = fields.default(1, "κ of (7)")
    oversize: fields.Factor = fields.default(1, "PF of (7) and (10)")


class Supply(fields.Section):
    """The electrical supply of the motor controllers."""

    kind: Literal["power_supply", "battery", "drive_bus"] | None = fields.optional(
        "power_supply: a unit that takes nothing back; battery: takes all; drive_bus: the rectified bus of "
        "drives, whose capacitors store; only the other fields count where not given"
    )
    part: str | None = fields.optional("power supply of a catalogue, one for the machine", min_length=1)
    nominal: fields.Voltage = fields.required(
        "direct voltage at the controllers; of drives at the mains that of their bus: 325 V at 230 V"
    )
    min: fields.Voltage | None = fields.optional("lowest voltage; nominal where not given", example="22 V")
    max: fields.Voltage | None = fields.optional("highest voltage; nominal where not given", example="29 V")
    resistance: fields.Resistance | None = fields.optional(
        "of the source and all cables; of the cables alone where a section battery is", example="20 mohm"
    )
    current: fields.Current | None = fields.optional("that the supply can deliver to all drives", example="40 A")
    power: fields.Power | None = fields.optional("that the supply can deliver to all drives", example="1 kW")
    peak_current: fields.Current | None = fields.optional(
        "that it can deliver for peak_time; current is then the continuous one", example="80 A"
    )
    peak_time: fields.Duration | None = None
    overvoltage_trip: fields.Voltage | None = fields.optional(
        "at which it switches off, or that it withstands from outside", example="60 V"
    )
    regeneration: fields.Part = fields.default(0, "share of regenerated energy that is stored and used again; 0 none")
    accepts: Literal["all", "share"] | None = fields.optional(
        "all: the rest of it is lost as heat, in a battery or a brake resistor, as where a section battery "
        "is; share: the rest stays on the bus, as of a power supply unit"
    )
    capacitance: fields.Capacitance | None = fields.optional("of the bus, where what is not accepted stays")

    stalled: bool = fields.default(
        False, "whether it must also deliver what all drives draw when they stall at once, as small servos may"
    )
    brakes: fields.Voltage | None = fields.optional(
        "that holding brakes are fed with, as nominal where they share this supply; where not given "
        "brakes of another voltage have a supply of their own, of no more than this one's voltage or 24 V"
    )

    def _contradictions(self) -> Iterator[str]:
        if not (self.min or self.nominal) <= self.nominal <= (self.max or self.nominal):
            low, high = (None if volts is None else f"{volts:g} V" for volts in (self.min, self.max))
            ends = [("min", low), ("nominal", f"{self.nominal:g} V"), ("max", high)]
            listed = ", ".join(f"{name} {text}" for name, text in ends if text)
            yield f'"{listed}": expected min <= nominal <= max'
        if self.stalled and self.current is None and self.part is None:
            yield "give current with stalled: that the supply can deliver"
        if self.kind == "power_supply" and (self.regeneration or self.accepts == "all"):
            yield "a power_supply takes nothing back; leave regeneration and accepts out, or another kind"
        if self.kind == "battery" and self.accepts == "share":
            yield "a battery takes all that is regenerated; leave accepts out, or another kind"
        if self.part is not None and self.kind not in (None, "power_supply"):
            yield f"give part for kind: power_supply, not for a {self.kind}"
        if self.peak_time is not None and self.peak_current is None and self.part is None:
            yield "give peak_current with peak_time"
        if self.peak_current is not None:
            if self.current is None and self.part is None:
                yield "give current with peak_current: the continuous one"
            if self.current is not None and self.peak_current < self.current:
                yield "expected peak_current >= current"
        if self.overvoltage_trip is not None and self.overvoltage_trip <= self.highest:
            yield "expected overvoltage_trip above the highest voltage, max or nominal"

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


class PowerStage(fields.Section):
    """Losses of each controller, in place of what its catalogue prints or the program assumes; not inside actuators."""

    voltage_drop: fields.Drop | None = fields.optional(
        "of the voltage that reaches the motor, and lost per ampere at any current", example="0.5 V"
    )
    resistance: fields.Resistance | None = fields.optional(
        "in series with the winding; none where not given", example="20 mohm"
    )
    standby: fields.Consumed | None = fields.optional(
        "that each draws at any time; also inside actuators", example="2 W"
    )
    motor_current: fields.Current | None = fields.optional(
        "that each is set to let into its motor at most (stator limit); also inside actuators", example="60 A"
    )


class Environment(fields.Section):
    """Surroundings in which the machine works."""

    ambient: fields.Temperature = fields.default("25 degC")
    altitude: fields.Altitude = fields.default(
        "0 m", "above sea level: thin air cools less above 1000 m; at most 4000 m", example="1500 m"
    )
    gravity: fields.Gravity = fields.default("9.80665 m/s^2")


class Margins(fields.Section):
    """Margins by which every limit must exceed the demand, by physics; the paper has its own factors."""

    torque: fields.Allowance = fields.default(0, "of gearhead torques, currents, traction, loads of a screw")
    speed: fields.Allowance = fields.default(0, "of motor, gearhead, encoder and screw speeds, and of voltage")
    temperature: fields.Allowance = fields.default(0, "of the winding's permitted rise over the ambient")
    pull_out: fields.Factor = fields.default(2, "a stepper's pull-out torque over the load's, at each speed")


class Leg(fields.Section):
    """A part of a mission: driving, docking, standing, or at a charging station."""

    time: fields.Duration = fields.required(example="40 min")
    load: fields.Part | None = fields.optional(
        "share of the mean power of the drives over their cycle: all of it where not given, none while it charges",
        example="30 %",
    )
    charges: bool = fields.default(False, "by the charger of the battery; equipment goes on drawing")

    @property
    def share(self) -> Any:
        """Share of the drives' mean power [1]."""
        return (0.0 if self.charges else 1.0) if self.load is None else self.load


def _by_duration_or_legs(schema: dict[str, Any]) -> None:
    """Let the schema of a mission take legs in place of a duration."""
    schema["anyOf"] = [{"required": schema.pop("required")}, {"required": ["legs"]}]
    schema["properties"]["legs"]["minItems"] = 1


class Mission(fields.Section):
    """Use of the motion, for the closed loop, and the legs of a day for the battery."""

    model_config = ConfigDict(json_schema_extra=_by_duration_or_legs)

    duration: fields.Duration = fields.required(
        "for which the cycle is repeated, rounded up to whole cycles; with legs their sum where not given",
        example="2 h",
    )
    legs: Annotated[list[Leg], Field(max_length=1000)] = fields.no_entries(
        "one after the other, for the charge of the battery on the way"
    )

    @model_validator(mode="before")
    @classmethod
    def _as_long_as_its_legs(cls, mission: Any) -> Any:
        """A mission with legs and no duration lasts as long as they do; what cannot be read is refused leg by leg."""
        legs = mission.get("legs") if isinstance(mission, dict) and "duration" not in mission else None
        try:
            return (
                {**mission, "duration": f"{sum(to_si(leg['time'], 'time') for leg in legs)!r} s"} if legs else mission
            )
        except (InputError, TypeError, KeyError):
            return {**mission, "duration": "1 s"}


class Needs(fields.Section):
    """Requirements on the drive beyond moving the load."""

    encoder_counts: Annotated[int, Field(ge=1)] | None = fields.optional("counts per motor turn")
    backlash_at_load: fields.Angle | None = fields.optional(
        "lost motion of the gearhead, seen at the load", example="1 deg"
    )
    bandwidth: fields.Frequency | None = fields.optional("of the closed velocity loop")
    resolution_at_load: fields.Angle | None = fields.optional(
        "angle of the load per edge of the encoder", example="0.05 deg"
    )
    inertia_ratio: fields.Ratio | None = fields.optional("load's inertia over the motor's, at most")
    start_speed: fields.Turning | None = fields.optional(
        "of the motor: a stepper's to which it jumps without a ramp", example="300 rpm"
    )
    resonance: fields.Frequency | None = fields.optional("of motor and load on the belt, at least", example="20 Hz")
    hold_unpowered: bool = fields.default(False, "the load must stay where it is without power")
    life: Life | None = fields.optional(
        "of gearhead, its output bearing and ball screw: hours of the cycle, rests included; or of some",
        example="20000 h",
    )
    shock_torque: fields.TorqueAbove | None = fields.optional(
        "at the load's shaft, in an emergency stop or a collision", example="20 N*m"
    )
    holding_factor: fields.Factor = fields.default(2, "of a brake's torque over that of the load at rest")
    holding_friction: Literal["ignored", "counted"] = fields.default(
        "ignored", "printed friction and detent torque of the motor, beside the brake's torque"
    )
    emergency_stops: Annotated[int, Field(ge=1)] | None = fields.optional(
        "stops by the brake from the highest speed, in the machine's life"
    )
    radial_load: fields.Force | None = fields.optional(
        "on the gearhead's shaft, or the motor's without one; added to the load of section shaft", example="200 N"
    )
    axial_load: fields.Force | None = fields.optional("on the same shaft, added to that of section shaft")
    tilting_moment: fields.Torque | None = fields.optional(
        "on the gearhead's output, beside that of the radial load at its distance", example="5 N*m"
    )
    diameter: fields.Length | None = fields.optional("of motor and gearhead, at most")
    length: fields.Length | None = fields.optional("of motor, gearhead and brake together, at most")
    mass: fields.Mass | None = fields.optional("of motor, gearhead and brake together, at most")
    price: fields.Price | None = fields.optional("of motor, gearhead and brake together, at most")

    def _contradictions(self) -> Iterator[str]:
        if self.holding_friction == "counted" and not self.hold_unpowered:
            yield "give hold_unpowered: true with holding_friction: counted"


class Case(fields.Section):
    """Changes of a further load case; everything else is as in the spec."""

    def _contradictions(self) -> Iterator[str]:
        if self.lasting is not None and self.share is None:
            yield "lasting: it is of a case with a share of the time; expected share, e.g. 10 %"
        if self.share is not None and self.once:
            yield "once: a case that alternates with others repeats; expected once without share"
        if self.share is not None and (self.supply or self.environment):
            yield "share: a case that alternates with others keeps supply and environment; leave it out"

    name: str = Field(min_length=1, max_length=60)
    share: Annotated[float, fields.Quantity("dimensionless", above=0.0, most=0.99)] | None = fields.optional(
        "of the time: cycles of the case alternate with those as specified, for heat, energy and battery "
        "too; without it the machine is sized as if the case were continuous"
    )
    once: bool | None = fields.optional(
        "the motion is run once, from cold, and the machine then rests until it is cold; as the spec where not given"
    )
    lasting: fields.Duration | None = fields.optional(
        "of a case with a share, uninterrupted; one cycle where not given", example="30 min"
    )
    load: dict[str, Any] = fields.all_defaults()
    motion: dict[str, Any] = fields.all_defaults()
    supply: dict[str, Any] = fields.all_defaults()
    environment: dict[str, Any] = fields.all_defaults()
    platform: dict[str, Any] = fields.all_defaults()


_Line = Annotated[str, Field(min_length=1, max_length=200)]


class TitleBlock(fields.Section):
    """Whom a report is for, and whose it is."""

    customer: _Line | None = None
    project: _Line | None = None
    author: _Line | None = None
    revision: _Line | None = fields.optional('such as "B" or "2.1"; quoted where it is a number')


# -- Sections of a spec on its battery and on further consumers.


Charge = Annotated[float, fields.Quantity("charge", above=0.0)]
Count = Annotated[int, Field(ge=1, le=10_000)]


class Run(fields.Section):
    """One line of a discharge table: a constant current or power, and how long it lasts."""

    current: fields.Current | None = fields.optional(example="5 A")
    power: fields.Power | None = None
    time: fields.Duration = fields.required(example="1 h")

    def _contradictions(self) -> Iterator[str]:
        if (self.current is None) == (self.power is None):
            yield "give current or power, exactly one of them"


class OpenCircuit(fields.Section):
    """Voltage of a cell or block at rest; straight between full and empty."""

    full: fields.Voltage = fields.required(example="4.2 V")
    empty: fields.Voltage = fields.required(example="3.2 V")

    def _contradictions(self) -> Iterator[str]:
        if self.empty > self.full:
            yield "expected empty <= full"


class Polarisation(fields.Section):
    """Polarisation of a cell or block under lasting current: one RC pair."""

    resistance: fields.Resistance = fields.required(example="10 mohm")
    time_constant: fields.Duration = fields.required(example="30 s")


class Charger(fields.Section):
    """Charger of the whole battery, at a constant current."""

    current: fields.Current = fields.required(example="10 A")
    efficiency: fields.Share = fields.default(1, "share of the charge that stays in it")


class Battery(fields.Section):
    """Cells or blocks in series and parallel: a part of a catalogue, its own figures, or both. Figures are of one."""

    part: str | None = fields.optional("cell or block of a catalogue", min_length=1)
    series: Count = fields.default(1, "cells or blocks in series")
    parallel: Count = fields.default(1, "parallel strings")
    chemistry: Literal["lead-acid", "Li-ion", "LiFePO4"] | None = None
    nominal_voltage: fields.Voltage | None = fields.optional(example="3.6 V")
    charge_voltage: fields.Voltage | None = fields.optional(example="4.2 V")
    cutoff_voltage: fields.Voltage | None = fields.optional("at which a discharge ends", example="3 V")
    capacity: Charge | None = fields.optional("drawn in the rated time")
    rated_time: fields.Duration | None = fields.optional("in which the capacity is drawn, e.g. 20 h", example="20 h")
    peukert_exponent: fields.Factor | None = None
    discharge: Annotated[list[Run], Field(min_length=2)] | None = fields.optional(
        "how long constant currents, or powers, last"
    )
    resistance: fields.Resistance | None = fields.optional("to direct current", example="20 mohm")
    polarisation: Polarisation | None = None
    open_circuit: OpenCircuit | None = fields.optional("voltage at rest; the nominal where not given")
    continuous_current: fields.Current | None = fields.optional(example="20 A")
    peak_current: fields.Current | None = fields.optional(example="60 A")
    max_charge_current: fields.Current | None = fields.optional(example="10 A")
    charger: Charger | None = fields.optional("of the whole battery, for the time of charging")
    mass: fields.Mass | None = None
    start: fields.Share = fields.default(1, "share of the charge at the start of the mission")
    usable: fields.Share = fields.default(1, "share of the charge that may be drawn")
    health: fields.Share = fields.default(1, "share of the rated capacity that age and cold leave")
    autonomy: fields.Duration | None = fields.optional("that is required; the mission's where not given", example="4 h")
    range: fields.Length | None = fields.optional("that is required, of a vehicle", example="20 km")
    reserve: fields.Allowance = fields.default(0, "by which autonomy and range must exceed what is required")

    def _contradictions(self) -> Iterator[str]:
        lacking = [n for n in ("nominal_voltage", "capacity") if getattr(self, n) is None]
        if self.part is None and lacking:
            yield f"give a part of a catalogue, or {' and '.join(lacking)} as well"
        if len({run.power is None for run in self.discharge or ()}) > 1:
            yield "give currents or powers in discharge, not both"
        nominal, charge = self.nominal_voltage, self.charge_voltage
        if nominal is not None and charge is not None and charge < nominal:
            yield "expected charge_voltage >= nominal_voltage; both are of one cell or block"
        if self.start + self.usable <= 1.0:
            yield "expected start above the share that may not be drawn, 1 - usable"


class Consumer(fields.Section):
    """Consumer beside the drive that draws from the battery."""

    name: str = Field(min_length=1, max_length=60)
    power: fields.Power = fields.required("of one, while it is on")
    number: Count = 1
    duty: fields.Part | None = fields.optional("share of the time for which it is on; 1 where not given")
    time: fields.Duration | None = fields.optional(
        "for which it is on in the mission, instead of duty", example="30 min"
    )
    peak_power: fields.Power | None = fields.optional("of one; its power where not given")
    efficiency: fields.Share = fields.default(1, "of the converter that supplies it")
    assumed: bool = fields.default(False, "whether its figures are assumed, and reported so")

    def _contradictions(self) -> Iterator[str]:
        if self.duty is not None and self.time is not None:
            yield "give duty or time, not both"
        if self.peak_power is not None and self.peak_power < self.power:
            yield "expected peak_power >= power"

    def share(self, mission: float | None) -> float:
        """Share of a mission's time [s] for which it is on [1]."""
        if self.time is None:
            return 1.0 if self.duty is None else self.duty
        if mission is None:
            raise ValueError(f"expected mission.duration for the time of {self.name}; else give its duty")
        if np.all(self.time > mission):
            raise ValueError(f"expected the time of {self.name} not to be longer than the mission")
        return np.minimum(self.time / mission, 1.0)  # a column where it is sampled

    def power_drawn(self, mission: float | None) -> tuple[float, float]:
        """Power out of the battery in the mean over a mission's time [s] and at most [W]."""
        factor = self.number / self.efficiency
        highest = self.power if self.peak_power is None else self.peak_power
        return factor * self.power * self.share(mission), factor * highest


# -- Section of a spec on the brake resistor of its bus.


_ANY = "any"  # out of the catalogues
_OWN = ("resistance", "power", "peak_power", "pulse_energy")


class BrakeResistor(fields.Section):
    """Resistor that burns regenerated energy: its figures, or out of a catalogue; `any`: the smallest that suffices."""

    family: fields.Names | None = fields.optional("of a catalogue: the smallest that suffices")
    part: fields.Names | None = fields.optional("of a catalogue, one or several")
    resistance: fields.Resistance | None = fields.optional("of a resistor that no catalogue lists", example="10 ohm")
    power: fields.Power | None = fields.optional("continuous", example="50 W")
    peak_power: fields.Power | None = fields.optional("for as long as a braking lasts", example="500 W")
    pulse_energy: fields.Energy | None = fields.optional("of a single braking", example="200 J")
    chopper_voltage: fields.Voltage | None = fields.optional(
        "at which the chopper switches on; that of a shunt regulator where not given", example="56 V"
    )
    chopper_current: fields.Current | None = fields.optional("that the chopper can switch")
    averaging_time: fields.Duration = fields.default("60 s", "over which the mean power counts, at its worst")

    _may_be_none: bool = PrivateAttr(default=False)

    @property
    def may_be_none(self) -> bool:
        """Whether none need be taken: no part and no figures of it are given."""
        return self._may_be_none or (self.resistance is None and not self.part)

    def among(self, parts: list[str], voltage: float) -> Self:
        """The section with the parts that are left to choose from, and the lowest voltage of their choppers [V]."""
        free = self.may_be_none
        section = self.model_copy(update={"part": parts, "family": None, "chopper_voltage": voltage})
        section._may_be_none = free
        return section

    @model_validator(mode="before")
    @classmethod
    def _any(cls, value: Any) -> Any:
        return {} if value == _ANY else value

    def _contradictions(self) -> Iterator[str]:
        if self.resistance is None:
            lone = [name for name in _OWN[1:] if getattr(self, name) is not None]
            if lone:
                yield f"give {lone[0]} with the resistance of a resistor of your own; a part has its own"
            return
        if self.family or self.part:
            yield "give family or part of a catalogue, or resistance, not both"
        if self.chopper_voltage is None:
            yield "give chopper_voltage with resistance: at which the chopper switches it on"
        if self.power and self.peak_power and self.peak_power < self.power:
            yield "expected peak_power >= power"
