"""Records of the parts of a drive: one frozen record per kind of part.

These classes are the catalogue's schema. A field's metadata names its kind of quantity (the reader in
``units``) and the unit in which datasheets print it; loader, columns, JSON Schema and datasheet pages are
derived from them. All figures are SI floats; NaN is *unknown*, and an empty text is unknown.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from math import inf
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.more_parts import (
    Actuator,
    Battery,
    Belt,
    Brake,
    BrakeResistor,
    Column,
    PartRecord,
    PowerSupply,
    Pulley,
    Screw,
    Stepper,
    columns,
    figure,
    text,
)
from drivesizer.physics.figures import Figures

__all__ = [
    "DIRECT",
    "EDGES",
    "NO_GEARHEAD",
    "PARTS",
    "RELATIONS",
    "Controller",
    "Encoder",
    "Gearhead",
    "Motor",
    "OneRow",
    "columns_of",
    "lines",
    "one_row",
    "printed",
    "singular",
]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor(PartRecord):
    """One winding of a motor, as its data sheet gives it at ``data_temperature``; 25 degC where none is stated."""

    part: str = text()
    order_number: str = text()  # what is bought, where rows of one part are its figures at several voltages
    also_called: str = text()  # its other names, separated by semicolons
    family: str = text()
    manufacturer: str = text()
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
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")  # 1-4 pieces
    price_5: float = figure("price", "EUR")  # 5-19 pieces
    price_20: float = figure("price", "EUR")  # 20-49 pieces
    list_price: float = figure("price_chf", "CHF")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Gearhead(PartRecord):
    """One reduction of a gearhead."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
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
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    price_5: float = figure("price", "EUR")
    price_20: float = figure("price", "EUR")
    list_price: float = figure("price_chf", "CHF")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder(PartRecord):
    """One resolution of an encoder."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
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
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD

    @property
    def lines(self) -> float:
        """Lines of an incremental encoder of the same resolution."""
        return self.counts_per_turn if self.counts_per_turn == self.counts_per_turn else self.steps_per_turn / EDGES

    @property
    def resolution(self) -> str:
        """Resolution as text."""
        if self.counts_per_turn == self.counts_per_turn:
            return f"{self.counts_per_turn:g} counts per turn"
        return f"{self.steps_per_turn:g} steps per turn" if self.steps_per_turn == self.steps_per_turn else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller(PartRecord):
    """One servo controller."""

    part: str = text()
    family: str = text()
    manufacturer: str = text()
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
    mass: float = figure("mass", "g")
    price: float = figure("price", "EUR")
    foreign_price: float = figure("dimensionless", "1")  # in its currency, where that is another
    currency: str = text()  # of it, such as USD


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
        self.part = part
        self.taken: dict[str, NDArray[Any]] = {}

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
