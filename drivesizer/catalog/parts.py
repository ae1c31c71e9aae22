"""What a catalogue knows of a part: one frozen record per kind of part.

These classes are the catalogue's schema. A field's metadata names its kind of quantity (the reader in
``units``) and the unit in which datasheets print it; loader, columns, JSON Schema and datasheet pages are
derived from them. All figures are SI floats; NaN is *unknown*, and an empty text is unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from math import inf, nan
from typing import Any, NamedTuple

__all__ = [
    "DIRECT",
    "EDGES",
    "NO_GEARHEAD",
    "PARTS",
    "Column",
    "Controller",
    "Encoder",
    "Gearhead",
    "Motor",
    "columns_of",
]


def _figure(kind: str, unit: str, *, least: float = 0.0) -> Any:
    return field(default=nan, metadata={"kind": kind, "unit": unit, "least": least})


def _text() -> Any:
    return field(default="", metadata={"kind": "text", "unit": ""})


class Column(NamedTuple):
    """One field of a part: name, kind of quantity (or ``text``), datasheet unit, smallest allowed value."""

    name: str
    kind: str
    unit: str
    least: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """One winding of a motor, as its datasheet gives it at 25 degC."""

    part: str = _text()
    family: str = _text()
    manufacturer: str = _text()
    kind: str = _text()  # brushed or brushless
    commutation: str = _text()  # graphite, precious metal CLL, Hall sensors ...
    bearing: str = _text()
    assigned_power: float = _figure("power", "W")
    nominal_voltage: float = _figure("voltage", "V")
    no_load_speed: float = _figure("rotary_speed", "rpm")
    no_load_current: float = _figure("current", "mA")
    friction_torque: float = _figure("torque", "mN*m")  # at any speed, where the maker tells it apart
    viscous_friction: float = _figure("damping", "N*m*s/rad")  # that grows with speed
    nominal_speed: float = _figure("rotary_speed", "rpm")
    nominal_torque: float = _figure("torque", "mN*m")
    nominal_current: float = _figure("current", "A")
    stall_torque: float = _figure("torque", "mN*m")
    stall_current: float = _figure("current", "A")
    peak_torque: float = _figure("torque", "mN*m")  # permitted for a short time, where the maker limits it
    max_efficiency: float = _figure("dimensionless", "%")
    resistance: float = _figure("resistance", "ohm")  # terminal to terminal
    inductance: float = _figure("inductance", "mH")
    torque_constant: float = _figure("torque_constant", "mN*m/A")
    speed_constant: float = _figure("speed_constant", "rpm/V")
    speed_torque_gradient: float = _figure("speed_torque_gradient", "rpm/(mN*m)")
    mechanical_time_constant: float = _figure("time", "ms")
    rotor_inertia: float = _figure("inertia", "g*cm^2")
    thermal_resistance_winding: float = _figure("thermal_resistance", "K/W")  # winding to housing
    thermal_resistance_housing: float = _figure("thermal_resistance", "K/W")  # housing to ambient
    winding_time_constant: float = _figure("time", "s")
    motor_time_constant: float = _figure("time", "s")
    ambient_min: float = _figure("temperature", "degC")
    ambient_max: float = _figure("temperature", "degC")
    max_winding_temperature: float = _figure("temperature", "degC")
    max_speed: float = _figure("rotary_speed", "rpm")
    max_axial_load: float = _figure("force", "N")  # dynamic
    max_radial_load: float = _figure("force", "N")
    radial_load_distance: float = _figure("length", "mm")  # from the flange
    pole_pairs: float = _figure("dimensionless", "1")
    phases: float = _figure("dimensionless", "1")
    commutator_segments: float = _figure("dimensionless", "1")
    diameter: float = _figure("length", "mm")
    length: float = _figure("length", "mm")
    mass: float = _figure("mass", "g")
    price: float = _figure("price", "EUR")  # 1-4 pieces
    price_5: float = _figure("price", "EUR")  # 5-19 pieces
    price_20: float = _figure("price", "EUR")  # 20-49 pieces
    list_price: float = _figure("price_chf", "CHF")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gearhead:
    """One reduction of a gearhead."""

    part: str = _text()
    family: str = _text()
    manufacturer: str = _text()
    kind: str = _text()  # planetary, spur, koaxdrive
    version: str = _text()
    reduction: str = _text()  # as printed: 27:1
    ratio: float = _figure("ratio", "1")  # exact: 3249/121
    stages: float = _figure("dimensionless", "1")
    direction: float = _figure("dimensionless", "1", least=-1.0)  # -1: output turns against the input
    continuous_torque: float = _figure("torque", "N*m")  # at the output
    intermittent_torque: float = _figure("torque", "N*m")
    efficiency: float = _figure("dimensionless", "%")  # the maximum, at rated torque
    backlash: float = _figure("angle", "deg")  # at no load
    inertia: float = _figure("inertia", "g*cm^2")  # at the input
    continuous_input_speed: float = _figure("rotary_speed", "rpm")
    intermittent_input_speed: float = _figure("rotary_speed", "rpm")
    continuous_power: float = _figure("power", "W")
    intermittent_power: float = _figure("power", "W")
    max_motor_shaft: float = _figure("length", "mm")
    max_radial_load: float = _figure("force", "N")
    radial_load_distance: float = _figure("length", "mm")
    max_axial_load: float = _figure("force", "N")
    max_press_fit: float = _figure("force", "N")
    axial_play: str = _text()  # as printed, in mm
    radial_play: str = _text()  # as printed
    temperature_min: float = _figure("temperature", "degC")
    temperature_max: float = _figure("temperature", "degC")
    diameter: float = _figure("length", "mm")
    length: float = _figure("length", "mm")
    mass: float = _figure("mass", "g")
    price: float = _figure("price", "EUR")
    price_5: float = _figure("price", "EUR")
    price_20: float = _figure("price", "EUR")
    list_price: float = _figure("price_chf", "CHF")


@dataclass(frozen=True, slots=True, kw_only=True)
class Encoder:
    """One resolution of an encoder."""

    part: str = _text()
    family: str = _text()
    manufacturer: str = _text()
    kind: str = _text()  # incremental, incremental with index, absolute ...
    counts_per_turn: float = _figure("dimensionless", "1")  # lines; four edges each
    channels: float = _figure("dimensionless", "1")
    max_frequency: float = _figure("frequency", "kHz")
    max_speed: float = _figure("rotary_speed", "rpm")  # from the frequency, or printed
    max_mechanical_speed: float = _figure("rotary_speed", "rpm")
    supply: str = _text()
    line_driver: str = _text()
    shaft_diameter: float = _figure("length", "mm")
    inertia: float = _figure("inertia", "g*cm^2")
    current_draw: float = _figure("current", "mA")
    diameter: float = _figure("length", "mm")
    length: float = _figure("length", "mm")  # of its housing
    added_length: float = _figure("length", "mm")  # what it adds to the motor
    mass: float = _figure("mass", "g")
    price: float = _figure("price", "EUR")


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """One servo controller."""

    part: str = _text()
    family: str = _text()
    manufacturer: str = _text()
    drives: str = _text()  # brushed, brushless, or both
    buses: str = _text()  # separated by semicolons
    supply_min: float = _figure("voltage", "V")
    supply_max: float = _figure("voltage", "V")
    absolute_min: float = _figure("voltage", "V")
    absolute_max: float = _figure("voltage", "V")
    continuous_current: float = _figure("current", "A")
    peak_current: float = _figure("current", "A")
    peak_time: float = _figure("time", "s")
    max_duty: float = _figure("dimensionless", "%")
    voltage_drop: float = _figure("voltage", "V")
    pwm_frequency: float = _figure("frequency", "kHz")
    current_loop: float = _figure("frequency", "kHz")
    speed_loop: float = _figure("frequency", "kHz")
    position_loop: float = _figure("frequency", "kHz")
    max_encoder_frequency: float = _figure("frequency", "MHz")
    max_speed_block: float = _figure("rotary_speed", "rpm")
    max_speed_sine: float = _figure("rotary_speed", "rpm")
    max_efficiency: float = _figure("dimensionless", "%")
    encoder_inputs: str = _text()
    choke: str = _text()
    derating: str = _text()
    dimensions: str = _text()
    mass: float = _figure("mass", "g")
    price: float = _figure("price", "EUR")


EDGES = 4  # of an incremental encoder per line, evaluated in quadrature
DIRECT = "direct"  # the part that stands for no gearhead at all
# What is not there weighs nothing and has no limit; infinity here is not an unknown figure but the lack of any limit.
NO_GEARHEAD = Gearhead(
    part=DIRECT, family=DIRECT, kind=DIRECT, reduction="1:1", ratio=1.0, stages=0.0, direction=1.0, efficiency=1.0,
    continuous_torque=inf, intermittent_torque=inf, continuous_input_speed=inf, intermittent_input_speed=inf,
    continuous_power=inf, intermittent_power=inf, max_radial_load=inf, max_axial_load=inf, temperature_min=0.0,
    temperature_max=inf, backlash=0.0, inertia=0.0, diameter=0.0, length=0.0, mass=0.0, price=0.0,
)  # fmt: skip

PARTS: dict[str, type[Motor] | type[Gearhead] | type[Encoder] | type[Controller]] = {
    "motors": Motor,
    "gearheads": Gearhead,
    "encoders": Encoder,
    "controllers": Controller,
}


def columns_of(section: str) -> dict[str, Column]:
    """The columns of a catalogue section, in the order of the record's fields.

    >>> columns_of("motors")["rotor_inertia"].unit
    'g*cm^2'
    """
    return {
        f.name: Column(f.name, f.metadata["kind"], f.metadata["unit"], f.metadata.get("least", 0.0))
        for f in fields(PARTS[section])
    }
