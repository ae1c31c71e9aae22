"""Records of the catalogue's parts between mains and controllers: power supplies and brake resistors."""

from __future__ import annotations

from drivesizer.catalog.columns import figure, text
from drivesizer.files.frozen import dataclass

__all__ = ["BrakeResistor", "PowerSupply"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BrakeResistor:
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
class PowerSupply:
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
