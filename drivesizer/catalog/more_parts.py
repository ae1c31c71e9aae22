"""Records of further kinds of parts, and the tables of batteries and steppers: discharges, pull-out torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.belt import pitch_diameter

__all__ = [
    "DATA", "DISCHARGES", "HELD", "INTEGERS", "NO_DISCHARGES", "NO_PULL_OUTS", "PULL_OUTS", "TABLE", "Actuator",
    "Battery", "Belt", "BeltDrive", "Brake", "BrakeResistor", "Column", "Discharges", "PartRecord", "PowerSupply",
    "PullOuts", "Pulley", "Screw", "Stepper", "columns", "figure", "point_columns", "text",
]  # fmt: skip


# -- Declaration of a part's figures in a record: each field with its kind of quantity and its datasheet unit.


DATA = "data_temperature"  # stands at the head of a file, for all motors and actuators that have none of their own


class PartRecord:
    """A record of a part, whose figures laws read by name (``physics.figures``)."""

    __slots__ = ()
    part: str
    family: str
    manufacturer: str
    price: float

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


class Column(NamedTuple):
    """One field of a part: name, kind of quantity (or ``text``), datasheet unit, smallest allowed value."""

    name: str
    kind: str
    unit: str
    least: float


def figure(kind: str, unit: str, *, least: float = 0.0) -> Any:
    """A field of a part that holds a figure in SI."""
    return field(default=nan, metadata={"kind": kind, "unit": unit, "least": least})


def text() -> Any:
    """A field of a part that holds text; empty unless given."""
    return field(default="", metadata={"kind": "text", "unit": ""})


def columns(record: Any) -> dict[str, Column]:
    """The columns of a record, in the order of its fields."""
    return {
        f.name: Column(f.name, f.metadata["kind"], f.metadata["unit"], f.metadata.get("least", 0.0))
        for f in fields(record)
    }


# -- Discharge tables of batteries in memory: at which current or power, to which end voltage, how long.
#
# Every printed figure is one entry of columns that belong to a row of the batteries' table; tables of current leave
# the power unknown, and the other way round.


DISCHARGES = "discharges"  # the section of a catalogue file, and the name for all of a battery's in a note
HELD = {"current": "A", "power": "W"}  # what is held while a battery empties
TABLE = ("battery", "source", "held", "cells", "columns", "rows")


class Discharges(NamedTuple):
    """Printed discharges of all batteries: columns, in the order of the file."""

    battery: NDArray[np.int32]  # row of the batteries' table
    source: NDArray[np.int32]  # index into Catalog.sources
    cutoff_voltage: NDArray[np.float64]  # V, at which it ends, of the part
    time: NDArray[np.float64]  # s
    current: NDArray[np.float64]  # A; NaN where power is held
    power: NDArray[np.float64]  # W of the part; NaN where current is held

    def on(self, rows: Any) -> Discharges:
        """Some of the entries."""
        return Discharges(*(column[rows] for column in self))


INTEGERS = ("battery", "source")
NO_DISCHARGES = Discharges(*(np.zeros(0, np.int32 if n in INTEGERS else float) for n in Discharges._fields))


# -- Printed pull-out torque of steppers over speed, in memory: each curve at a supply voltage, with a driver.
#
# Every printed point is one entry of columns that belong to a row of the steppers' table.


PULL_OUTS = "pull_outs"  # the section of a catalogue file, and the name for all of a stepper's in a note


class PullOuts(NamedTuple):
    """Printed points of all curves: columns, in the order of the file."""

    stepper: NDArray[np.int32]  # row of the steppers' table
    source: NDArray[np.int32]  # index into Catalog.sources
    curve: NDArray[np.int32]  # number of the curve
    voltage: NDArray[np.float64]  # V, of the driver's supply
    current: NDArray[np.float64]  # A, amplitude of a phase's current that the driver was set to; NaN unknown
    speed: NDArray[np.float64]  # rad/s, rising along a curve
    torque: NDArray[np.float64]  # N*m
    driver: NDArray[np.str_]  # as printed; empty where it is not

    def on(self, rows: Any) -> PullOuts:
        """Some of the entries."""
        return PullOuts(*(column[rows] for column in self))


_TYPES = {"stepper": np.int32, "source": np.int32, "curve": np.int32, "driver": np.str_}
NO_PULL_OUTS = PullOuts(*(np.zeros(0, _TYPES.get(name, np.float64)) for name in PullOuts._fields))


def point_columns(points: Sequence[tuple[Any, ...]]) -> PullOuts:
    """Columns of points, each with the fields of ``PullOuts`` in their order."""
    columns = zip(PullOuts._fields, zip(*points, strict=True), strict=True)
    return PullOuts(*(np.array(values, _TYPES.get(name, np.float64)) for name, values in columns))


# -- Records of the catalogue's further kinds of parts, beside motor, gearhead, encoder and controller.
#
# An actuator or gearmotor is sold as one part; ``search_view`` splits it for the search. Belts, pulleys, screws,
# brakes, steppers and batteries are parts of their own.


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator(PartRecord):
    """A motor sold with its gearhead inside, maybe with encoder and controller: figures at the output, as printed."""

    part: str = text()
    order_number: str = text()  # what is bought, where rows of one part are its figures at several voltages
    also_called: str = text()  # its other names, separated by semicolons
    family: str = text()
    manufacturer: str = text()
    kind: str = text()  # of the motor: brushed or brushless
    gearing: str = text()  # planetary, spur, strain wave, cycloidal, none
    reduction: str = text()  # as printed: 9:1
    ratio: float = figure("ratio", "1")
    stages: float = figure("dimensionless", "1")
    direction: float = figure("dimensionless", "1", least=-1.0)
    efficiency: float = figure("dimensionless", "%")  # of the gear inside
    coulomb_friction: float = figure("torque", "N*m")  # of motor and gear at the output, unloaded, at any speed
    viscous_friction: float = figure("damping", "N*m*s/rad")  # the same, per speed of the output
    load_friction: float = figure("dimensionless", "%")  # share of the load's torque lost; where no efficiency is known
    nominal_voltage: float = figure("voltage", "V")
    no_load_speed: float = figure("rotary_speed", "rpm")  # of the output, like all speeds here
    no_load_current: float = figure("current", "A")
    nominal_speed: float = figure("rotary_speed", "rpm")
    nominal_torque: float = figure("torque", "N*m")  # of the output, continuous, like all torques here
    nominal_current: float = figure("current", "A")
    stall_torque: float = figure("torque", "N*m")
    stall_current: float = figure("current", "A")
    peak_torque: float = figure("torque", "N*m")  # for a short time
    peak_current: float = figure("current", "A")
    max_speed: float = figure("rotary_speed", "rpm")
    torque_constant: float = figure("torque_constant", "N*m/A")  # at the output, losses of the gear included
    motor_torque_constant: float = figure("torque_constant", "mN*m/A")  # of the motor inside
    motor_back_emf_constant: float = figure("back_emf_constant", "mV*s/rad")  # where it is not that
    data_temperature: float = figure("temperature", "degC")  # at which resistance and all figures hold
    rated_ambient: float = figure("temperature", "degC")  # of the nominal current, where it is not data_temperature
    resistance: float = figure("resistance", "ohm")  # terminal to terminal
    inductance: float = figure("inductance", "mH")
    rotor_inertia: float = figure("inertia", "g*cm^2")  # of the motor inside, the gear's input included
    output_inertia: float = figure("inertia", "kg*m^2")  # all of it as the output feels it
    pole_pairs: float = figure("dimensionless", "1")
    thermal_resistance_winding: float = figure("thermal_resistance", "K/W")
    thermal_resistance_housing: float = figure("thermal_resistance", "K/W")
    winding_time_constant: float = figure("time", "s")
    motor_time_constant: float = figure("time", "s")
    max_winding_temperature: float = figure("temperature", "degC")
    ambient_min: float = figure("temperature", "degC")
    ambient_max: float = figure("temperature", "degC")
    backlash: float = figure("angle", "deg")
    max_radial_load: float = figure("force", "N")
    max_axial_load: float = figure("force", "N")
    steps_per_turn: float = figure("dimensionless", "1")  # of the output, that its encoder resolves
    controller: str = text()  # integrated, or the name of the one inside; empty: it needs one
    buses: str = text()  # of the one inside, separated by semicolons
    supply_min: float = figure("voltage", "V")
    supply_max: float = figure("voltage", "V")
    standby_current: float = figure("current", "mA")  # of the controller inside, whatever the motor takes
    diameter: float = figure("length", "mm")
    length: float = figure("length", "mm")
    dimensions: str = text()
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Brake(PartRecord):
    """A holding brake that releases when it has current."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    principle: str = text()  # spring, permanent magnet
    mounting: str = text()  # flange: sold apart, for any shaft; else built into the motors that are listed
    shaft: str = text()  # that it sits on where it is not the motor's: load
    static_torque: float = figure("torque", "N*m")
    dynamic_torque: float = figure("torque", "N*m")  # while it slips
    supply: float = figure("voltage", "V")
    power: float = figure("power", "W")  # of the coil, released
    holding_power: float = figure("power", "W")  # that keeps it released, where the current is lowered
    release_time: float = figure("time", "ms")
    engage_time: float = figure("time", "ms")  # until it has its torque
    inertia: float = figure("inertia", "g*cm^2")
    max_speed: float = figure("rotary_speed", "rpm")
    energy_per_stop: float = figure("energy", "J")  # at most
    energy_per_hour: float = figure("energy", "J")
    total_energy: float = figure("energy", "kJ")  # of all stops in its life
    emergency_stops: float = figure("dimensionless", "1")  # in its life, where they are counted
    backlash: float = figure("angle", "deg")
    diameter: float = figure("length", "mm")
    added_length: float = figure("length", "mm")
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Stepper(PartRecord):
    """One wiring of a stepper motor; its pull-out torque over speed is in ``pull_outs``."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    wiring: str = text()  # bipolar, unipolar, series, parallel
    frame: str = text()  # NEMA 17
    full_steps: float = figure("dimensionless", "1")  # per turn
    phase_current: float = figure("current", "A")  # continuous, in both phases at once
    holding_torque: float = figure("torque", "N*m")  # with that current in both phases
    detent_torque: float = figure("torque", "N*m")
    start_speed: float = figure("rotary_speed", "rpm")  # at which the rotor alone starts without a ramp, unloaded
    pull_out_share: float = figure(
        "dimensionless", "%"
    )  # of what ``physics.stepper`` has of the torque; no file has it
    resistance: float = figure("resistance", "ohm")  # of a phase
    inductance: float = figure("inductance", "mH")  # of a phase
    rotor_inertia: float = figure("inertia", "g*cm^2")
    max_radial_load: float = figure("force", "N")
    max_axial_load: float = figure("force", "N")
    supply_min: float = figure("voltage", "V")
    supply_max: float = figure("voltage", "V")
    ambient_min: float = figure("temperature", "degC")
    ambient_max: float = figure("temperature", "degC")
    shaft_diameter: float = figure("length", "mm")
    diameter: float = figure("length", "mm")  # side of the flange
    length: float = figure("length", "mm")
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Belt(PartRecord):
    """One toothed belt, closed."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    profile: str = text()  # HTD, GT2, RT25
    pitch: float = figure("length", "mm")
    teeth: float = figure("dimensionless", "1")
    width: float = figure("length", "mm")
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulley(PartRecord):
    """One pulley for toothed belts."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    profile: str = text()
    pitch: float = figure("length", "mm")
    teeth: float = figure("dimensionless", "1")
    width: float = figure("length", "mm")  # of the widest belt
    bore: str = text()  # as printed
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Screw(PartRecord):
    """One nut with its shaft, of steel, as long as the machine needs."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    kind: str = text()  # ball, trapezoidal, lead
    diameter: float = figure("length", "mm")  # nominal
    lead: float = figure("length", "mm")
    starts: float = figure("dimensionless", "1")
    root_diameter: float = figure("length", "mm")  # of the core
    ball_diameter: float = figure("length", "mm")  # of the ball centres
    pitch_diameter: float = figure("length", "mm")  # of a sliding thread
    shaft_diameter: float = figure("length", "mm")  # outside, where it is not the nominal one
    dynamic_load: float = figure("force", "N")
    static_load: float = figure("force", "N")
    permissible_thrust: float = figure("force", "N")  # of a sliding nut
    stiffness: float = figure("stiffness", "N/um")  # axial, of the nut
    axial_play: float = figure("length", "mm")
    efficiency: float = figure("dimensionless", "%")  # of the screw that drives the nut
    back_efficiency: float = figure("dimensionless", "%")  # of the nut that drives the screw
    dn_max: float = figure("dimensionless", "1")  # mm rpm, by the ball centres where their diameter is known
    nut_mass: float = figure("mass", "kg")
    mass: float = figure("mass", "kg")  # of nut and shaft; of the machine's length where it is chosen
    price: float = figure("price", "EUR")


@dataclass(frozen=True, slots=True, kw_only=True)
class Battery(PartRecord):
    """One cell or block."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    chemistry: str = text()  # Li-ion, LiFePO4, lead-acid
    format: str = text()  # 21700, 18650, block
    nominal_voltage: float = figure("voltage", "V")
    charge_voltage: float = figure("voltage", "V")
    cutoff_voltage: float = figure("voltage", "V")
    capacity: float = figure("charge", "A*h")
    rated_time: float = figure("time", "h")  # in which the capacity is drawn
    capacity_10h: float = figure("charge", "A*h")
    capacity_5h: float = figure("charge", "A*h")
    capacity_1h: float = figure("charge", "A*h")
    continuous_current: float = figure("current", "A")
    peak_current: float = figure("current", "A")
    max_charge_current: float = figure("current", "A")
    resistance: float = figure("resistance", "mohm")  # to direct current, where the maker states it separately
    peukert_exponent: float = figure("dimensionless", "1")
    mass: float = figure("mass", "g")
    dimensions: str = text()
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class BrakeResistor(PartRecord):
    """A resistor for a chopper, a shunt regulator, which has both, or what a drive has of them inside."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    kind: str = text()  # resistor, shunt regulator, inside a drive
    resistance: float = figure("resistance", "ohm")
    resistance_min: float = figure("resistance", "ohm")  # of a size that is made in any resistance up to the next
    resistance_max: float = figure("resistance", "ohm")
    min_resistance: float = figure("resistance", "ohm")  # of an external resistor in place of the one inside
    power: float = figure("power", "W")  # continuous, at the rated ambient
    rated_ambient: float = figure("temperature", "degC")
    zero_power_ambient: float = figure("temperature", "degC")  # at which none is left
    peak_power: float = figure("power", "W")  # for a short time
    pulse_energy: float = figure("energy", "J")  # of a single braking
    chopper_voltage_min: float = figure("voltage", "V")  # least at which its own chopper switches on
    chopper_voltage_max: float = figure("voltage", "V")  # and greatest
    chopper_current: float = figure("current", "A")
    supply_min: float = figure("voltage", "V")
    supply_max: float = figure("voltage", "V")
    capacitance: float = figure("capacitance", "uF")  # that it adds to the bus
    max_voltage: float = figure("voltage", "V")  # across a resistor
    cooling: str = text()  # with which the power holds
    dimensions: str = text()
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerSupply(PartRecord):
    """A power supply unit, or a converter from one direct voltage to another."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    kind: str = text()  # DIN rail, enclosed, DC-DC
    input: str = text()  # as printed
    nominal_voltage: float = figure("voltage", "V")
    voltage_min: float = figure("voltage", "V")  # to which the output can be set
    voltage_max: float = figure("voltage", "V")
    continuous_current: float = figure("current", "A")
    peak_current: float = figure("current", "A")
    peak_time: float = figure("time", "s")
    overvoltage_min: float = figure("voltage", "V")  # least at which its protection trips
    overvoltage_max: float = figure("voltage", "V")
    return_voltage: float = figure("voltage", "V")  # from outside, that its output withstands
    hold_up: float = figure("time", "ms")
    efficiency: float = figure("dimensionless", "%")
    overload: str = text()  # as printed
    dimensions: str = text()
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


# -- A toothed belt and its pair of pulleys as catalogue parts, with the geometry between them.


@dataclass(frozen=True, slots=True, kw_only=True)
class BeltDrive:
    """A belt and two pulleys out of a catalogue."""

    driving: Pulley  # on the shaft of the gearhead, or of the motor where there is none
    driven: Pulley  # on the load's shaft
    belt: Belt
    centre_distance: float  # m
    teeth_in_mesh: float  # on the small pulley

    @property
    def ratio(self) -> float:
        """Turns of the driving pulley per turn of the driven one; below 1 it is a step up."""
        return self.driven.teeth / self.driving.teeth

    @property
    def name(self) -> str:
        """The ratio by its teeth, as 36:24."""
        return f"{self.driven.teeth:.0f}:{self.driving.teeth:.0f}"

    @property
    def driven_diameter(self) -> float:
        """Pitch diameter of the load's pulley [m]."""
        return float(pitch_diameter(self.driven.teeth, self.driven.pitch))

    @property
    def parts(self) -> dict[str, Belt | Pulley]:
        """Parts of the belt drive, by role."""
        return {"driving pulley": self.driving, "belt": self.belt, "driven pulley": self.driven}
