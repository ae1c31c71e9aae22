"""Records of parts: one frozen record per kind of part, which is the catalogue's schema, and its columns.

A field's metadata names its kind of quantity (the reader in ``units``) and the unit in which datasheets print it;
loader, columns, JSON Schema and datasheet pages are derived from them. All figures are SI floats; NaN is *unknown*, and
an empty text is unknown. An actuator or gearmotor is sold as one part; ``search_view`` splits it for the search.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache, lru_cache
from math import inf, nan
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.belt import pitch_diameter
from drivesizer.physics.figures import Figures

DATA = "data_temperature"  # stands at the head of a file, for all motors and actuators that have none of their own


class Column(NamedTuple):
    """One field of a part: name, kind of quantity (or ``text``), datasheet unit, smallest allowed value."""

    name: str
    kind: str
    unit: str
    least: float


def figure(kind: str, unit: str, *, least: float = 0.0) -> Any:
    """A field of a part that holds a figure in SI."""
    return field(default=nan, metadata={"column": (kind, unit, least)})


def text() -> Any:
    """A field of a part that holds text; empty unless given."""
    return field(default="", metadata={"column": ("text", "", 0.0)})


# columns that come first of any part, and those that come last
_FIRST = ("part", "order_number", "also_called", "family", "manufacturer")
_LAST = ("mass", "price", "price_5", "price_20", "list_price", "foreign_price", "currency")


def columns(record: Any) -> dict[str, Column]:
    """The columns of a record, in the order in which they are printed."""
    found = {f.name: Column(f.name, *f.metadata["column"]) for f in fields(record)}
    inner = [name for name in found if name not in (*_FIRST, *_LAST)]
    return {name: found[name] for name in (*_FIRST, *inner, *_LAST) if name in found}


@dataclass(frozen=True, slots=True, kw_only=True)
class PartRecord:
    """Figures that every part has; laws read them by name (``physics.figures``)."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
    mass: float = figure("mass", "g")
    price: float = figure("price_eur", "EUR")  # 1-4 pieces
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor(PartRecord):
    """One winding of a motor, as its data sheet gives it at ``data_temperature``; 25 degC where none is stated."""

    order_number: str = text()  # what is bought, where rows of one part are its figures at several voltages
    also_called: str = text()  # its other names, separated by semicolons
    kind: str = text()  # brushed or brushless; stepper in the search view alone
    commutation: str = text()  # graphite, precious metal CLL, Hall sensors, integrated electronics ...
    bearing: str = text()
    controller: str = text()  # the name of the one inside, beside which it takes no other; empty: it needs one
    winding: str = text()  # slotless: without iron teeth, as of ironless windings
    assigned_power: float = figure("power", "W")
    nominal_voltage: float = figure("voltage", "V")
    max_voltage: float = figure("voltage", "V")  # of a supply, that its insulation permits
    no_load_speed: float = figure("rotary_speed", "rpm")
    no_load_current: float = figure("current", "mA")
    friction_torque: float = figure("torque", "mN*m")  # at any speed, where the maker states it separately
    viscous_friction: float = figure("damping", "N*m*s/rad")  # that grows with speed
    nominal_speed: float = figure("rotary_speed", "rpm")
    nominal_torque: float = figure("torque", "mN*m")
    nominal_current: float = figure("current", "A")
    stall_torque: float = figure("torque", "mN*m")
    stall_current: float = figure("current", "A")
    peak_torque: float = figure("torque", "mN*m")  # permitted for a short time, where the maker limits it
    max_efficiency: float = figure("dimensionless", "%")
    data_temperature: float = figure("temperature", "degC")  # at which resistance and all figures hold
    rated_ambient: float = figure("temperature", "degC")  # of the nominal current, where it is not data_temperature
    resistance: float = figure("resistance", "ohm")  # terminal to terminal
    inductance: float = figure("inductance", "mH")
    torque_constant: float = figure("torque_constant", "mN*m/A")
    speed_constant: float = figure("speed_constant", "rpm/V")
    back_emf_constant: float = figure("back_emf_constant", "mV*s/rad")  # where it is not torque_constant
    speed_torque_gradient: float = figure("speed_torque_gradient", "rpm/(mN*m)")
    mechanical_time_constant: float = figure("time", "ms")
    rotor_inertia: float = figure("inertia", "g*cm^2")
    thermal_resistance_winding: float = figure("thermal_resistance", "K/W")  # winding to housing
    thermal_resistance_housing: float = figure("thermal_resistance", "K/W")  # housing to ambient
    winding_time_constant: float = figure("time", "s")
    motor_time_constant: float = figure("time", "s")
    ambient_min: float = figure("temperature", "degC")
    ambient_max: float = figure("temperature", "degC")
    max_winding_temperature: float = figure("temperature", "degC")
    max_speed: float = figure("rotary_speed", "rpm")
    max_axial_load: float = figure("force", "N")  # dynamic
    max_radial_load: float = figure("force", "N")
    radial_load_distance: float = figure("length", "mm")  # from the flange
    pole_pairs: float = figure("dimensionless", "1")
    standstill_torque: float = figure("torque", "mN*m")  # continuous, at speed 0
    half_speed_torque: float = figure("torque", "mN*m")  # continuous, at half the permissible speed
    top_speed_torque: float = figure("torque", "mN*m")  # continuous, at the permissible speed
    phases: float = figure("dimensionless", "1")
    commutator_segments: float = figure("dimensionless", "1")
    shaft_diameter: float = figure("length", "mm")
    inside: str = text()  # the actuator that it is built into
    holding_torque: float = figure("torque", "N*m")  # this and the next three: of a stepper, see ``view.stepper_view``
    detent_torque: float = figure("torque", "N*m")
    start_speed: float = figure("rotary_speed", "rpm")
    pull_out_share: float = figure("dimensionless", "%")
    mounted_gain: float = figure("dimensionless", "1")  # of its ratings at most, as mounted, where heat figures lack
    diameter: float = figure("length", "mm")
    length: float = figure("length", "mm")
    price_5: float = figure("price_eur", "EUR")  # 5-19 pieces
    price_20: float = figure("price_eur", "EUR")  # 20-49 pieces
    list_price: float = figure("price_chf", "CHF")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gearhead(PartRecord):
    """One reduction of a gearhead."""

    kind: str = text()  # planetary, spur, koaxdrive
    version: str = text()
    reduction: str = text()  # as printed: 27:1
    ratio: float = figure("ratio", "1")  # exact: 3249/121
    stages: float = figure("dimensionless", "1")
    direction: float = figure("dimensionless", "1", least=-1.0)  # -1: output turns against the input
    continuous_torque: float = figure("torque", "N*m")  # at the output
    intermittent_torque: float = figure("torque", "N*m")
    emergency_torque: float = figure("torque", "N*m")  # a thousand times in its life or less
    ratcheting_torque: float = figure("torque", "N*m")  # at which the teeth of a strain wave gear jump
    rated_life: float = figure("time", "h")  # L_10, at continuous_torque and rated_speed
    median_life: float = figure("time", "h")  # L_50, at the same
    rated_speed: float = figure("rotary_speed", "rpm")  # at the input; continuous_input_speed where not given
    life_exponent: float = figure("dimensionless", "1")  # of the torque: 3 of balls, 10/3 of rollers
    efficiency: float = figure("dimensionless", "%")  # the maximum, at rated torque
    backlash: float = figure("angle", "deg")  # at no load
    stiffness: float = figure("torsional_stiffness", "N*m/arcmin")
    no_load_torque: float = figure("torque", "N*m")  # at the input, to turn it
    inertia: float = figure("inertia", "g*cm^2")  # at the input
    continuous_input_speed: float = figure("rotary_speed", "rpm")
    intermittent_input_speed: float = figure("rotary_speed", "rpm")
    continuous_power: float = figure("power", "W")
    intermittent_power: float = figure("power", "W")
    mounting: str = text()  # clamping hub: takes any motor whose shaft it holds
    max_motor_shaft: float = figure("length", "mm")
    max_radial_load: float = figure("force", "N")
    radial_load_distance: float = figure("length", "mm")
    max_axial_load: float = figure("force", "N")
    max_tilting_moment: float = figure("torque", "N*m")  # about the output bearing
    bearing_distance: float = figure("length", "mm")  # of the output bearing, behind the face that distances count from
    bearing_diameter: float = figure("length", "mm")  # pitch circle of a cross roller bearing at the output
    bearing_dynamic_load: float = figure("force", "N")  # its rating C
    bearing_static_load: float = figure("force", "N")  # its rating C0
    max_press_fit: float = figure("force", "N")
    axial_play: str = text()  # as printed, in mm
    radial_play: str = text()  # as printed
    temperature_min: float = figure("temperature", "degC")
    temperature_max: float = figure("temperature", "degC")
    inside: str = text()  # the actuator that it is built into
    diameter: float = figure("length", "mm")
    length: float = figure("length", "mm")
    price_5: float = figure("price_eur", "EUR")
    price_20: float = figure("price_eur", "EUR")
    list_price: float = figure("price_chf", "CHF")


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder(PartRecord):
    """One resolution of an encoder."""

    kind: str = text()  # incremental, incremental with index, absolute ...
    counts_per_turn: float = figure("dimensionless", "1")  # lines; four edges each
    steps_per_turn: float = figure("dimensionless", "1")  # of an absolute one
    channels: float = figure("dimensionless", "1")
    max_frequency: float = figure("frequency", "kHz")
    max_speed: float = figure("rotary_speed", "rpm")  # from the frequency, or printed
    max_mechanical_speed: float = figure("rotary_speed", "rpm")
    supply: str = text()
    line_driver: str = text()
    shaft_diameter: float = figure("length", "mm")
    inertia: float = figure("inertia", "g*cm^2")
    current_draw: float = figure("current", "mA")
    inside: str = text()  # the actuator that it is built into
    diameter: float = figure("length", "mm")
    length: float = figure("length", "mm")  # of its housing
    added_length: float = figure("length", "mm")  # what it adds to the motor

    @property
    def lines(self) -> float:
        """Lines of an incremental encoder of the same resolution."""
        return float(lines(self))

    @property
    def resolution(self) -> str:
        """Resolution as text."""
        if self.counts_per_turn == self.counts_per_turn:
            return f"{self.counts_per_turn:g} counts per turn"
        return f"{self.steps_per_turn:g} steps per turn" if self.steps_per_turn == self.steps_per_turn else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller(PartRecord):
    """One servo controller."""

    drives: str = text()  # brushed, brushless, both of them, or stepper
    buses: str = text()  # separated by semicolons
    supply_min: float = figure("voltage", "V")
    supply_max: float = figure("voltage", "V")
    absolute_min: float = figure("voltage", "V")
    absolute_max: float = figure("voltage", "V")
    continuous_current: float = figure("current", "A")
    peak_current: float = figure("current", "A")
    peak_time: float = figure("time", "s")
    max_power: float = figure("power", "W")  # of the supply, where the maker limits it beside the current ...
    max_power_voltage: float = figure("voltage", "V")  # ... up to this supply voltage; from there it falls
    reduced_power: float = figure("power", "W")  # ... in a straight line to this
    reduced_power_voltage: float = figure("voltage", "V")  # ... at this supply voltage and above
    max_duty: float = figure("dimensionless", "%")
    voltage_drop: float = figure("voltage", "V")
    pwm_frequency: float = figure("frequency", "kHz")
    current_loop: float = figure("frequency", "kHz")
    speed_loop: float = figure("frequency", "kHz")
    position_loop: float = figure("frequency", "kHz")
    max_encoder_frequency: float = figure("frequency", "MHz")
    max_speed_block: float = figure("rotary_speed", "rpm")
    max_speed_sine: float = figure("rotary_speed", "rpm")
    max_efficiency: float = figure("dimensionless", "%")
    standby_current: float = figure("current", "mA")  # of the supply, that flows whatever the motor takes
    microsteps: float = figure("dimensionless", "1")  # of a stepper driver, per full step, at most
    encoder_inputs: str = text()
    choke: str = text()
    derating: str = text()
    full_current_ambient: float = figure("temperature", "degC")  # up to which the continuous current holds
    derating_slope: float = figure("current_per_temperature", "A/K")  # of that current above it
    ambient_max: float = figure("temperature", "degC")
    inside: str = text()  # the actuator that it is built into
    dimensions: str = text()


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator(PartRecord):
    """A motor sold with its gearhead inside, maybe with encoder and controller: figures at the output, as printed."""

    order_number: str = text()  # what is bought, where rows of one part are its figures at several voltages
    also_called: str = text()  # its other names, separated by semicolons
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Brake(PartRecord):
    """A holding brake that releases when it has current."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Stepper(PartRecord):
    """One wiring of a stepper motor; its pull-out torque over speed is in ``pull_outs``."""

    wiring: str = text()  # bipolar, unipolar, series, parallel
    frame: str = text()  # NEMA 17
    full_steps: float = figure("dimensionless", "1")  # per turn
    phase_current: float = figure("current", "A")  # continuous, in both phases at once
    holding_torque: float = figure("torque", "N*m")  # with that current in both phases
    detent_torque: float = figure("torque", "N*m")
    start_speed: float = figure("rotary_speed", "rpm")  # at which the rotor alone starts without a ramp, unloaded
    pull_out_share: float = figure("dimensionless", "%")  # of the torque by ``physics.stepper``; no file has it
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Belt(PartRecord):
    """One toothed belt, closed."""

    profile: str = text()  # HTD, GT2, RT25
    pitch: float = figure("length", "mm")
    teeth: float = figure("dimensionless", "1")
    width: float = figure("length", "mm")


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulley(PartRecord):
    """One pulley for toothed belts."""

    profile: str = text()
    pitch: float = figure("length", "mm")
    teeth: float = figure("dimensionless", "1")
    width: float = figure("length", "mm")  # of the widest belt
    bore: str = text()  # as printed


@dataclass(frozen=True, slots=True, kw_only=True)
class Screw(PartRecord):
    """One nut with its shaft, of steel, as long as the machine needs."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Battery(PartRecord):
    """One cell or block."""

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
    dimensions: str = text()


@dataclass(frozen=True, slots=True, kw_only=True)
class BrakeResistor(PartRecord):
    """A resistor for a chopper, a shunt regulator, which has both, or what a drive has of them inside."""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class PowerSupply(PartRecord):
    """A power supply unit, or a converter from one direct voltage to another."""

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


EDGES = 4  # of an incremental encoder per line, evaluated in quadrature
DIRECT = "direct"  # the part that represents direct drive, without a gearhead
# Direct drive weighs nothing and limits nothing: infinity here is the absence of a limit, not an unknown figure.
NO_GEARHEAD = Gearhead(
    part=DIRECT, family=DIRECT, kind=DIRECT, reduction="1:1", ratio=1.0, stages=0.0, direction=1.0, efficiency=1.0,
    continuous_torque=inf, intermittent_torque=inf, continuous_input_speed=inf, intermittent_input_speed=inf,
    continuous_power=inf, intermittent_power=inf, max_radial_load=inf, max_axial_load=inf, max_tilting_moment=inf,
    emergency_torque=inf, ratcheting_torque=inf, rated_life=inf, median_life=inf, temperature_min=0.0,
    temperature_max=inf, backlash=0.0, inertia=0.0, diameter=0.0, length=0.0, mass=0.0, price=0.0,
)  # fmt: skip

PARTS: dict[str, type[Any]] = {
    "motors": Motor,
    "gearheads": Gearhead,
    "encoders": Encoder,
    "controllers": Controller,
    "actuators": Actuator,
    "brakes": Brake,
    "steppers": Stepper,
    "belts": Belt,
    "pulleys": Pulley,
    "screws": Screw,
    "batteries": Battery,
    "power_supplies": PowerSupply,
    "brake_resistors": BrakeResistor,
}


def lines(encoder: Figures) -> Any:
    """Lines of incremental encoders of the same resolution: their own, or an absolute one's steps over four.

    >>> float(lines({"counts_per_turn": np.nan, "steps_per_turn": 4096.0}))
    1024.0
    """
    own = encoder["counts_per_turn"]
    return np.where(np.isnan(own), encoder["steps_per_turn"] / EDGES, own)


# Parts that go with a motor, by the name of the list of pairs.
RELATIONS = {"motor_gearhead": "gearheads", "motor_encoder": "encoders", "motor_brake": "brakes"}


class OneRow:
    """A part's figures as columns of one; without a part every figure is unknown.

    >>> OneRow(NO_GEARHEAD)["ratio"], OneRow(None)["inertia"]
    (array([1.]), array([nan]))
    """

    def __init__(self, part: Any) -> None:
        self.part, self.taken = part, dict[str, NDArray[Any]]()

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.taken:
            self.taken[name] = np.array([np.nan if self.part is None else getattr(self.part, name)])
            self.taken[name].flags.writeable = False  # others take it as well
        return self.taken[name]


@lru_cache(maxsize=256)
def one_row(part: Any) -> OneRow:
    """A part's figures as columns of one; of parts of late with those that were taken before."""
    return OneRow(part)


def singular(section: str) -> str:
    """Singular of a section's name.

    >>> singular("motors"), singular("batteries"), singular("brake_resistors")
    ('motor', 'battery', 'brake resistor')
    """
    return re.sub("ies$", "y", section).removesuffix("s").replace("_", " ")


_MADE = {  # columns that no catalogue file gives: the search view has them, of actuators and steppers
    "motors": {"inside", "holding_torque", "detent_torque", "start_speed", "pull_out_share", "mounted_gain"},
    "steppers": {"pull_out_share"},
}


def printed(section: str) -> dict[str, Column]:
    """The columns that a catalogue file may give, without those that only the search view fills."""
    made = _MADE.get(section, {"inside"})
    return {name: column for name, column in columns_of(section).items() if name not in made}


@cache
def columns_of(section: str) -> Mapping[str, Column]:
    """The columns of a catalogue section, in the order of the record's fields.

    >>> columns_of("motors")["rotor_inertia"].unit
    'g*cm^2'
    """
    return MappingProxyType(columns(PARTS[section]))


# -- Tables of batteries and steppers: every printed figure is one entry of columns, in the order of the file


DISCHARGES = "discharges"  # the section of a catalogue file, and the name for all of a battery's in a note
PULL_OUTS = "pull_outs"  # the same of a stepper's pull-out torque over speed
HELD = {"current": "A", "power": "W"}  # what is held while a battery empties


class Discharges(NamedTuple):
    """Printed discharges of all batteries: at which current or power, to which end voltage, how long."""

    battery: NDArray[np.int32]  # row of the batteries' table
    source: NDArray[np.int32]  # index into Catalog.sources
    cutoff_voltage: NDArray[np.float64]  # V, at which it ends, of the part
    time: NDArray[np.float64]  # s
    current: NDArray[np.float64]  # A; NaN where power is held
    power: NDArray[np.float64]  # W of the part; NaN where current is held

    def on(self, rows: Any) -> Discharges:
        """Some of the entries."""
        return Discharges(*(column[rows] for column in self))


class PullOuts(NamedTuple):
    """Printed points of all pull-out curves, each curve at a supply voltage, with a driver."""

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


def entries(kind: Any, rows: Sequence[tuple[Any, ...]]) -> Any:
    """Columns of a kind, from rows with its fields in their order."""
    types = {"battery": np.int32, "stepper": np.int32, "source": np.int32, "curve": np.int32, "driver": np.str_}
    each = zip(*rows, strict=True) if rows else [()] * len(kind._fields)
    return kind(*(np.array(values, types.get(n, np.float64)) for n, values in zip(kind._fields, each, strict=True)))


NO_DISCHARGES: Discharges = entries(Discharges, ())
NO_PULL_OUTS: PullOuts = entries(PullOuts, ())
