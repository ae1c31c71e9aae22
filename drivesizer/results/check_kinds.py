"""Every check there is, declared once: its title, unit, the part that it concerns, the figures that it rests on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from typing import Any

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.catalog.view.search_view import printed_field
from drivesizer.results.check import Check, sentence_case
from drivesizer.results.drive_set import DriveSet
from drivesizer.units import show

__all__ = [
    "BATTERY_LASTING", "BATTERY_SAMPLED", "BATTERY_VOLTAGES", "CHECKS", "OWN_REQUIREMENTS", "PARTS", "REQUIREMENTS",
    "figure_words", "marked_figures", "missing_figures", "part_of", "refuse_undeclared", "rests_on", "sorted_by_part",
    "unknown_figures",
]  # fmt: skip


# -- Every check there is, declared once: its title, its unit, the figures that it rests on.
#
# One table per method, in the order in which people read them; search, terminal, reports, tolerances and closed loop
# read them here, and a column of any other name is refused. A name may stand under several methods.
#
# A figure that a check rests on is one whose lack would leave it unknown or change it, such as ``motor.resistance``.
# A word in capitals stands for figures that depend on the motor or the encoder, see ``figures_behind_checks``:
# ``CURRENT``, ``COUNTS``, ``HOUSING``, ``DERATING``, ``LEVER``.


@dataclass(frozen=True, slots=True)
class CheckKind:
    """Properties of a check that are the same for every candidate."""

    title: str
    kind: str = "dimensionless"  # of quantity
    unit: str = "1"  # of the trade
    rests_on: tuple[str, ...] = ()
    on_inertia: bool = False  # of rotor or gearhead, through the current or by itself: unknown, it cannot pass
    rotary: tuple[str, str] | None = None  # kind and unit where the load turns about an axis, where they are others


_SPEED, _NM, _MNM, _AMPS = ("rotary_speed", "rpm"), ("torque", "N*m"), ("torque", "mN*m"), ("current", "A")
_VOLTS, _NEWTON, _MM, _DEG = ("voltage", "V"), ("force", "N"), ("length", "mm"), ("angle", "deg")
_WATT, _CELSIUS, _SHARE, _GAIN = (
    ("power", "W"),
    ("temperature", "degC"),
    ("dimensionless", "%"),
    ("acceleration", "m/s^2"),
)

_RATIO, _ROTOR = ("gearhead.ratio",), ("motor.rotor_inertia",)
_INERTIA = (*_RATIO, "gearhead.inertia", *_ROTOR)
_BRAKING = ("brake.inertia", "brake.static_torque", "brake.dynamic_torque", "brake.engage_time")
_HOT = (  # the winding at its mean temperature
    "CURRENT", "motor.resistance", "motor.thermal_resistance_winding", "motor.thermal_resistance_housing", "HOUSING",
)  # fmt: skip
_WARM = (*_HOT, "motor.winding_time_constant", "motor.motor_time_constant")  # as warm as it is at each moment
_LIFE = (  # of a gear
    *_RATIO, "gearhead.rated_life", "gearhead.rated_speed", "gearhead.continuous_torque", "gearhead.life_exponent",
)  # fmt: skip
EMF = ("motor.back_emf_constant", "motor.speed_constant")  # where the maker prints one
_DRAWN = (*_WARM, *EMF)
_FED = (*_DRAWN, "controller.voltage_drop", "controller.max_efficiency")  # what hangs on the power out of the supply
_POWER = tuple(f"controller.{name}_power{of}" for name in ("max", "reduced") for of in ("", "_voltage"))
_CHAIN = (*_RATIO, "gearhead.efficiency", *_ROTOR)  # of the paper's torque at the motor
_BY_CURRENT = (*_CHAIN, "motor.torque_constant", "motor.no_load_current")  # of the paper's current
_SUPPLIES = ("controller.supply_min", "controller.supply_max")

_PHYSICS = {
    "compatibility": CheckKind("Motor and gearhead fit together"),
    "gearhead_continuous_torque": CheckKind("Gearhead continuous torque", *_NM, ("gearhead.continuous_torque",)),
    "gearhead_intermittent_torque": CheckKind("Gearhead intermittent torque", *_NM, ("gearhead.intermittent_torque",)),
    "gearhead_continuous_speed": CheckKind(
        "Gearhead continuous input speed", *_SPEED, (*_RATIO, "gearhead.continuous_input_speed")
    ),
    "gearhead_intermittent_speed": CheckKind(
        "Gearhead intermittent input speed", *_SPEED, (*_RATIO, "gearhead.intermittent_input_speed")
    ),
    "gearhead_continuous_power": CheckKind("Gearhead continuous power", *_WATT, ("gearhead.continuous_power",)),
    "gearhead_intermittent_power": CheckKind("Gearhead intermittent power", *_WATT, ("gearhead.intermittent_power",)),
    "gearhead_emergency_torque": CheckKind("Gearhead emergency stop torque", *_NM, ("gearhead.emergency_torque",)),
    "gearhead_ratcheting": CheckKind("Gearhead ratcheting torque", *_NM, ("gearhead.ratcheting_torque",)),
    "gearhead_life": CheckKind("Gearhead nominal life", "time", "h", _LIFE),
    "gearhead_radial_load": CheckKind("Gearhead radial load", *_NEWTON, ("gearhead.max_radial_load", "LEVER")),
    "gearhead_axial_load": CheckKind("Gearhead axial load", *_NEWTON, ("gearhead.max_axial_load",)),
    "gearhead_tilting_moment": CheckKind(
        "Gearhead tilting moment", *_NM, ("gearhead.max_tilting_moment", "gearhead.bearing_distance")
    ),
    "gearhead_bearing_static": CheckKind(
        "Gearhead output bearing, static load with its safety", *_NEWTON,
        ("gearhead.bearing_static_load", "gearhead.bearing_diameter", "gearhead.bearing_distance"),
    ),
    "gearhead_bearing_life": CheckKind(
        "Gearhead output bearing, nominal life", "time", "h",
        ("gearhead.bearing_dynamic_load", "gearhead.bearing_diameter", "gearhead.bearing_distance"),
    ),
    "gearhead_temperature_range": CheckKind(
        "Gearhead temperature range", *_CELSIUS, ("gearhead.temperature_min", "gearhead.temperature_max")
    ),
    "backlash_at_load": CheckKind("Backlash at the load", *_DEG, ("gearhead.backlash",)),
    "motor_radial_load": CheckKind("Motor radial load", *_NEWTON, ("motor.max_radial_load",)),
    "motor_axial_load": CheckKind("Motor axial load", *_NEWTON, ("motor.max_axial_load",)),
    "pull_out_torque": CheckKind(
        "Pull-out torque at the speed", *_NM,
        (*_RATIO, "gearhead.efficiency", "gearhead.inertia", *_ROTOR, "PULL_OUT"), on_inertia=True,
    ),
    "idle_torque": CheckKind(
        "Holding torque at idle current", *_NM, (*_RATIO, "gearhead.efficiency", "PULL_OUT")
    ),
    "start_speed": CheckKind(
        "Start without a ramp", *_SPEED,
        (*_INERTIA, "gearhead.efficiency", "motor.start_speed", "motor.holding_torque", "motor.pull_out_share"),
        on_inertia=True,
    ),
    "step_resolution": CheckKind(
        "Angle of a microstep at the load", *_DEG, (*_RATIO, "motor.pole_pairs", "controller.microsteps")
    ),
    "step_resonance": CheckKind(
        "Steady step rate and natural frequency apart",
        rests_on=(*_INERTIA, "motor.pole_pairs", "motor.holding_torque"), on_inertia=True,
    ),
    "motor_speed": CheckKind("Motor permissible speed", *_SPEED, (*_RATIO, "motor.max_speed")),
    "motor_nominal_current": CheckKind(
        "Motor nominal current (RMS)", *_AMPS, ("CURRENT", "motor.nominal_current", "DERATING"), on_inertia=True
    ),
    "motor_nominal_torque": CheckKind(
        "Motor nominal torque (RMS)", *_MNM, (*_INERTIA, "gearhead.efficiency", "motor.nominal_torque"), on_inertia=True
    ),
    "motor_peak_torque": CheckKind("Motor peak torque", *_MNM, ("CURRENT", "motor.peak_torque"), on_inertia=True),
    "winding_temperature": CheckKind(
        "Winding temperature, peak", *_CELSIUS, (*_WARM, "motor.max_winding_temperature"), on_inertia=True
    ),
    "hottest_phase": CheckKind(
        "Hottest phase at rest", *_CELSIUS, (*_HOT, "motor.max_winding_temperature"), on_inertia=True
    ),
    "motor_temperature_range": CheckKind(
        "Motor temperature range", *_CELSIUS, ("motor.ambient_min", "motor.ambient_max")
    ),
    "motor_supply_voltage": CheckKind(
        "Motor permissible supply voltage", *_VOLTS,
        ("motor.max_voltage", "motor.nominal_voltage", "motor.max_speed", *EMF),
    ),
    "inertia_ratio": CheckKind("Inertia ratio, load to motor", rests_on=_INERTIA, on_inertia=True),
    "first_resonance": CheckKind("First resonance", "frequency", "Hz", _INERTIA, on_inertia=True),
    "brake_fits": CheckKind("Brake fits the motor", rests_on=("brake.part",)),
    "holding": CheckKind(
        "Holding without power", *_MNM, (*_RATIO, "gearhead.efficiency", "brake.static_torque")
    ),
    "gearhead_holding": CheckKind("Gearhead torque held at rest", *_NM, ("gearhead.intermittent_torque",)),
    "brake_speed": CheckKind("Brake speed", *_SPEED, (*_RATIO, "brake.max_speed")),
    "brake_voltage": CheckKind("Brake coil voltage", *_VOLTS, ("brake.supply",)),
    "brake_stop_energy": CheckKind(
        "Emergency stop, energy in the brake", "energy", "J",
        (*_INERTIA, *_BRAKING, "brake.energy_per_stop"), on_inertia=True,
    ),
    "brake_stops": CheckKind(
        "Emergency stops in the brake's life",
        rests_on=(*_INERTIA, *_BRAKING, "brake.total_energy", "brake.emergency_stops"), on_inertia=True,
    ),
    "gearhead_stop_torque": CheckKind(
        "Gearhead torque of an emergency stop", *_NM,
        (*_INERTIA, *_BRAKING, "gearhead.emergency_torque", "gearhead.intermittent_torque"), on_inertia=True,
    ),
    "controller_available": CheckKind("Controller for bus, voltage and motor", rests_on=_SUPPLIES),
    "supply_voltage": CheckKind(
        "Motor voltage, cold and hot", *_VOLTS, (*_DRAWN, "controller.max_duty", "controller.voltage_drop"),
        on_inertia=True,
    ),
    "controller_continuous_current": CheckKind(
        "Controller continuous current", *_AMPS, ("CURRENT", "controller.continuous_current", "CONTROLLER_DERATING"),
        on_inertia=True,
    ),
    "controller_peak_current": CheckKind(
        "Controller peak current", *_AMPS, ("CURRENT", "controller.peak_current"), on_inertia=True
    ),
    "controller_peak_time": CheckKind(
        "Time above continuous current", "time", "s",
        ("CURRENT", "controller.continuous_current", "CONTROLLER_DERATING", "controller.peak_time"), on_inertia=True,
    ),
    "controller_power": CheckKind("Controller power", *_WATT, (*_FED, *_POWER), on_inertia=True),
    "controller_speed": CheckKind(
        "Controller electrical speed", *_SPEED, (*_RATIO, "motor.pole_pairs", "controller.max_speed_sine")
    ),
    "supply_current": CheckKind("Supply current, all drives", *_AMPS, _FED, on_inertia=True),
    "supply_power": CheckKind("Supply power, all drives", *_WATT, _FED, on_inertia=True),
    "bus_voltage": CheckKind("Bus voltage, energy returned", *_VOLTS, (*_FED, "controller.supply_max")),
    "common_bus_voltage": CheckKind("Highest voltage of the common supply", *_VOLTS, ("controller.supply_max",)),
    "encoder_counts": CheckKind("Encoder counts per turn", rests_on=("COUNTS",)),
    "encoder_speed": CheckKind("Encoder speed", *_SPEED, (*_RATIO, "encoder.max_speed")),
    "encoder_frequency": CheckKind(
        "Encoder frequency", "frequency", "kHz",
        (*_RATIO, "COUNTS", "encoder.max_frequency", "controller.max_encoder_frequency"),
    ),
    "encoder_resolution": CheckKind("Encoder resolution at the load", *_DEG, (*_RATIO, "COUNTS")),
    "traction": CheckKind("Traction per wheel", *_NEWTON),
    "belt_tension": CheckKind("Belt effective tension", *_NEWTON),
    "belt_speed": CheckKind("Belt speed", "speed", "m/s"),
    "belt_teeth_in_mesh": CheckKind("Belt teeth in mesh, small pulley"),
    "belt_axis_tension": CheckKind("Belt axis, effective tension", *_NEWTON),
    "screw_buckling": CheckKind("Screw axial load, buckling and core", *_NEWTON),
    "screw_static_load": CheckKind("Screw static load with its safety", *_NEWTON),
    "screw_thrust": CheckKind("Screw thrust of the nut", *_NEWTON),
    "screw_critical_speed": CheckKind("Screw critical speed", *_SPEED),
    "screw_dn": CheckKind("Screw DN value, mm rpm"),
    "screw_life": CheckKind("Screw nominal life", "time", "h"),
    "diameter": CheckKind("Diameter of motor and gearhead", *_MM, ("motor.diameter", "gearhead.diameter")),
    "length": CheckKind(
        "Length of motor and gearhead", *_MM, ("motor.length", "gearhead.length", "brake.added_length")
    ),
    "mass": CheckKind("Mass of motor and gearhead", "mass", "g", ("motor.mass", "gearhead.mass", "brake.mass")),
    "price": CheckKind(
        "Price of motor and gearhead", "price", "EUR", ("motor.price", "gearhead.price", "brake.price")
    ),
}  # fmt: skip

_PAPER = {
    "compatibility": CheckKind("Motor and gearhead fit together"),
    "gearhead_continuous_torque": CheckKind(
        "Gearhead continuous torque", *_NM, (*_ROTOR, "gearhead.continuous_torque")
    ),
    "gearhead_intermittent_torque": CheckKind(
        "Gearhead intermittent torque", *_NM, (*_ROTOR, "gearhead.intermittent_torque")
    ),
    "backlash_at_load": CheckKind("Backlash at the load", *_DEG, ("gearhead.backlash",)),
    "encoder_counts": CheckKind("Encoder counts per turn", rests_on=("COUNTS",)),
    "controller_available": CheckKind("Controller for bus, voltage and motor", rests_on=_SUPPLIES),
    "controller_continuous_current": CheckKind(
        "Controller continuous current", *_AMPS, (*_BY_CURRENT, "controller.continuous_current", "CONTROLLER_DERATING")
    ),
    "controller_peak_current": CheckKind(
        "Controller peak current", *_AMPS, (*_BY_CURRENT, "controller.peak_current")
    ),
    "gearhead_input_speed": CheckKind(
        "Gearhead input speed", *_SPEED, (*_RATIO, "gearhead.continuous_input_speed")
    ),
    "largest_reduction": CheckKind(
        "Largest reduction allowed",
        rests_on=(*_RATIO, "gearhead.continuous_torque", "gearhead.intermittent_torque",
                  "gearhead.continuous_input_speed", *_ROTOR),
    ),
    "motor_speed": CheckKind("Motor speed (no-load speed)", *_SPEED, (*_RATIO, "motor.no_load_speed")),
    "motor_continuous_torque": CheckKind("Motor continuous torque", *_MNM, (*_CHAIN, "motor.nominal_torque")),
    "motor_maximum_torque": CheckKind("Motor maximum torque (stall)", *_MNM, (*_CHAIN, "motor.stall_torque")),
    "motor_power": CheckKind("Motor continuous power", *_WATT, (*_ROTOR, "motor.assigned_power")),
    "speed_constant": CheckKind(
        "Speed constant", "speed_constant", "rpm/V",
        (*_CHAIN, "motor.speed_torque_gradient", "motor.nominal_voltage", "motor.speed_constant"),
    ),
}  # fmt: skip

_BUDGET = {  # of the machine with a drive in it
    "travel_time": CheckKind("Time over the required distance", "time", "min"),
    "motion_speed": CheckKind("Speed of the motion", "speed", "m/s", rotary=_SPEED),
    "devices": CheckKind("Required devices carried"),
    "mass": CheckKind("Mass of the machine", "mass", "kg"),
    "price": CheckKind("Price of all drives", "price", "EUR"),
    "mass_sized_for": CheckKind("Mass that the drive is sized for", "mass", "kg"),
    "passage_width": CheckKind("Width of a passage", *_MM),
    "passage_height": CheckKind("Height of a passage", *_MM),
    "passage_turning": CheckKind("Turning on the spot in a passage", *_MM),
    "passage_corner": CheckKind("Corner of two corridors", *_MM),
    "passage_clearance": CheckKind("Width of a passage, along the trajectory", *_MM),
    "centre_of_mass": CheckKind("Every wheel carries at rest"),
    "lift_off": CheckKind("Acceleration and slope before a wheel lifts off", *_GAIN),
    "tipping": CheckKind("Acceleration and slope before it tips over", *_GAIN),
    "wheel_unloading": CheckKind("Load taken off a wheel, along the trajectory", *_SHARE),
    "tipping_motion": CheckKind("Distance to the tipping edge, along the trajectory", *_SHARE),
    "grip_slope": CheckKind("Slope that the floor's grip holds", *_DEG),
    "grip_acceleration": CheckKind("Acceleration that the floor transmits", *_GAIN),
    "grip_motion": CheckKind("Friction needed, along the trajectory"),
    "battery_autonomy": CheckKind("Battery autonomy", "time", "h", _FED),
    "battery_range": CheckKind("Range on one charge", "length", "km", _FED),
    "battery_power": CheckKind("Battery power, largest", *_WATT, _FED),
    "battery_voltage": CheckKind("Battery voltage at the peak, lowest supply", *_VOLTS, _FED),
    "battery_cutoff": CheckKind("Battery voltage at the peak, end of discharge", *_VOLTS, _FED),
    "battery_charge_voltage": CheckKind("Battery voltage while charging", *_VOLTS),
    "battery_overcharge": CheckKind("Battery voltage at the return, end of charge", *_VOLTS, _FED),
    "battery_return_voltage": CheckKind("Battery voltage at the return, highest supply", *_VOLTS, _FED),
    "battery_room": CheckKind("Regenerated charge, room for it", "charge", "A*h", _FED),
    "battery_continuous_current": CheckKind("Battery continuous current (RMS)", *_AMPS, _FED),
    "battery_peak_current": CheckKind("Battery peak current", *_AMPS, _FED),
    "battery_charger_current": CheckKind("Battery charge current, charger", *_AMPS),
    "battery_charge_current": CheckKind("Battery charge current, energy returned", *_AMPS, _FED),
    "supply_voltage": CheckKind(
        "Motor voltage, current of all axes",
        *_VOLTS,
        (*_FED, "controller.max_duty"),
    ),
    "supply_current": CheckKind("Supply current, all axes", *_AMPS, _FED),
    "supply_power": CheckKind("Supply power, all axes", *_WATT, _FED),
    "bus_voltage": CheckKind("Bus voltage, energy returned by all axes", *_VOLTS, (*_FED, "controller.supply_max")),
    "supply_confidence": CheckKind("Probability that no limit of the supply is exceeded", "dimensionless", "%"),
    "machine_cycle": CheckKind("Motions within the machine's cycle"),
    "supply_overvoltage": CheckKind("Bus voltage, trip of the power supply", *_VOLTS, _FED),
    "supply_continuous_current": CheckKind("Power supply continuous current", *_AMPS, _FED),
    "supply_peak_time": CheckKind("Power supply, time above continuous current", "time", "s", _FED),
    "resistor_available": CheckKind("Brake resistor in the catalogues"),
    "chopper_voltage": CheckKind("Chopper voltage above the supply", *_VOLTS),
    "chopper_bus_voltage": CheckKind("Chopper voltage, limit of the controller", *_VOLTS, ("controller.supply_max",)),
    "chopper_current": CheckKind("Chopper current", *_AMPS, _FED),
    "resistor_resistance": CheckKind("Brake resistor resistance", "resistance", "ohm", _FED),
    "resistor_peak_power": CheckKind("Brake resistor peak power", *_WATT, _FED),
    "resistor_mean_power": CheckKind("Brake resistor mean power", *_WATT, _FED),
    "resistor_pulse_energy": CheckKind("Brake resistor pulse energy", "energy", "J", _FED),
}

OWN_REQUIREMENTS = ("travel_time", "motion_speed", "devices")  # of the section ``requirements`` alone
REQUIREMENTS = {  # of the machine, in the order in which people read them: which end of the check is required
    "travel_time": "limit", "motion_speed": "demand", "passage_width": "limit", "passage_height": "limit",
    "passage_turning": "limit", "passage_corner": "limit", "passage_clearance": "limit", "mass": "limit",
    "price": "limit", "battery_autonomy": "demand", "battery_range": "demand", "devices": "demand",
}  # fmt: skip
BATTERY_LASTING = ("battery_autonomy", "battery_range")
BATTERY_VOLTAGES = ("battery_voltage", "battery_cutoff")
# budgets that are checked sample by sample too
BATTERY_SAMPLED = (*BATTERY_LASTING, "battery_power", "battery_peak_current", *BATTERY_VOLTAGES)

_CLOSED_LOOP = {  # of one drive that was simulated: missing figures are among the checks of the drive
    "stability": CheckKind("Stability of the linear loops"),
    "phase_margin": CheckKind("Phase margin", *_DEG),
    "tracking_error": CheckKind("Tracking error", "speed", "m/s", rotary=_SPEED),
    "bandwidth": CheckKind("Closed-loop bandwidth", "frequency", "Hz"),
    "supply_voltage": CheckKind("Motor voltage", *_VOLTS),
    "controller_peak_current": CheckKind("Controller peak current", *_AMPS),
    "controller_i2t": CheckKind("I²t of the peak current", *_SHARE),
    "controller_continuous_current": CheckKind("Controller continuous current (RMS)", *_AMPS),
    "supply_current": CheckKind("Supply current, all drives", *_AMPS),
    "motor_nominal_current": CheckKind("Motor nominal current (RMS)", *_AMPS),
    "winding_temperature": CheckKind("Winding temperature", *_CELSIUS),
    "gearhead_continuous_torque": CheckKind("Gearhead continuous torque (RMS)", *_NM),
    "gearhead_intermittent_torque": CheckKind("Gearhead intermittent torque", *_NM),
    "gearhead_continuous_speed": CheckKind("Gearhead continuous input speed", *_SPEED),
    "gearhead_intermittent_speed": CheckKind("Gearhead intermittent input speed", *_SPEED),
    "motor_speed": CheckKind("Motor permissible speed", *_SPEED),
    "encoder_speed": CheckKind("Encoder speed", *_SPEED),
    "encoder_frequency": CheckKind("Encoder frequency of encoder lines", "frequency", "kHz"),
    "controller_frequency": CheckKind("Controller frequency of encoder lines", "frequency", "kHz"),
    "controller_electrical_speed": CheckKind("Controller electrical speed", *_SPEED),
    "traction": CheckKind("Traction per wheel", *_NEWTON),
}

_OPEN_LOOP = {  # of one drive with a stepper that was simulated
    "lost_steps": CheckKind("No step is lost"),
    "pull_out_share": CheckKind("Share of the pull-out torque that keeps step", *_SHARE),
    "start_share": CheckKind("The same, of the start without a ramp", *_SHARE),
    "load_angle": CheckKind("Load angle of the rotor", *_DEG),
    "gearhead_intermittent_torque": CheckKind("Gearhead intermittent torque", *_NM),
    "gearhead_intermittent_speed": CheckKind("Gearhead intermittent input speed", *_SPEED),
}

CHECKS: dict[str, dict[str, CheckKind]] = {
    "paper": _PAPER, "physics": _PHYSICS, "budget": _BUDGET, "closed loop": _CLOSED_LOOP, "open loop": _OPEN_LOOP,
}  # fmt: skip
_NAMES = frozenset(name for declared in CHECKS.values() for name in declared)


def refuse_undeclared(name: str) -> None:
    """Refuse a check that no method declares."""
    if name not in _NAMES:
        raise LookupError(f"check {name!r} is not declared in results/check_kinds.py")


# -- The part of the machine that each check concerns, by which reports group them.


_OF_PART = (  # part, and how the names of its checks begin
    (
        "Motor",
        ("motor_", "winding_", "hottest_", "speed_constant", "pull_out_", "start_", "step_", "lost_", "load_angle"),
    ),
    ("Gearhead", ("gearhead_", "backlash_", "largest_reduction")),
    ("Brake", ("brake_", "holding")),
    ("Belt", ("belt_",)),
    ("Screw", ("screw_",)),
    ("Encoder", ("encoder_",)),
    ("Controller", ("controller_",)),
    ("Supply", ("supply_", "bus_")),
    ("Brake resistor", ("resistor_", "chopper_")),
    ("Battery", ("battery_",)),
    ("Control loop", ("stability", "phase_margin", "tracking_error", "bandwidth")),
)
_MACHINE = "Machine"  # whatever concerns the drive as a whole, or the machine
PARTS = (*(part for part, _ in _OF_PART), _MACHINE)


def part_of(name: str) -> str:
    """The part that a check concerns.

    >>> part_of("winding_temperature"), part_of("backlash_at_load"), part_of("traction")
    ('Motor', 'Gearhead', 'Machine')
    """
    return next((part for part, begins in _OF_PART if name.startswith(begins)), _MACHINE)


def sorted_by_part(checks: Sequence[Check]) -> list[Check]:
    """Checks sorted by part; those of one part in the order given."""
    return sorted(checks, key=lambda check: PARTS.index(part_of(check.name)))


# -- The catalogue figures that each check rests on: those that are unknown, and those that are not quoted.
#
# ``results.check_kinds`` declares them; here its words in capitals become the figures of a drive's motor.
# ``rests_on`` names every figure whose lack would leave a check of the drive unknown or change it; a test takes them
# away one by one and looks.


_DERATING = ("full_current_ambient", "derating_slope", "ambient_max")
_MODEL = ("holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", "pull_out_share")
_GEAR = ("gearhead.ratio", "gearhead.efficiency", "gearhead.inertia", "motor.rotor_inertia", "motor.torque_constant")


def rests_on(check: Check, drive_set: DriveSet) -> tuple[str, ...]:
    """The figures that a check of a drive rests on, such as ``motor.resistance``; none for what has none."""
    found: list[str] = []
    for name in CHECKS[check.method][check.name].rests_on:
        found += _figures_of_word(name, drive_set) if name.isupper() else [name]
    return tuple(dict.fromkeys(found))


def _figures_of_word(word: str, drive_set: DriveSet) -> list[str]:
    motor, gearhead, encoder = drive_set.motor, drive_set.gearhead, drive_set.encoder
    if word == "COUNTS":
        absolute = encoder is not None and isnan(encoder.counts_per_turn)
        return ["encoder.steps_per_turn" if absolute else "encoder.counts_per_turn"]
    if word == "LEVER":  # of a radial load, where the limit has a distance
        return [] if isnan(gearhead.max_radial_load) else ["gearhead.radial_load_distance"]
    if word == "DERATING":
        return ["motor.max_winding_temperature"]
    if word == "CONTROLLER_DERATING":
        controller = drive_set.controller
        known = controller is not None and not isnan(controller.full_current_ambient)
        return [f"controller.{name}" for name in _DERATING] if known else []
    if word == "PULL_OUT":
        return [f"motor.{name}" for name in _MODEL]
    if motor.kind == "stepper":  # whose current is the rated one, whatever the load
        return ["motor.nominal_current"]
    if word == "HOUSING":
        iron = ["motor.max_winding_temperature", "motor.nominal_current", "motor.nominal_speed"]
        return [] if motor.kind == "brushed" else iron
    rubbing = [f"motor.{name}" for name in ("friction_torque", "viscous_friction") if not isnan(getattr(motor, name))]
    if len(rubbing) < 2:  # the rest is what the no-load current leaves
        by_speed = bool(rubbing) or motor.kind != "brushed"
        rubbing += ["motor.no_load_current", *(["motor.no_load_speed"] if by_speed else [])]
    idle = [] if isnan(gearhead.no_load_torque) else ["gearhead.no_load_torque", "gearhead.continuous_torque"]
    own = ["encoder.inertia"] if encoder and not isnan(encoder.inertia) else []
    return [*_GEAR, *rubbing, *idle, *own]


def unknown_figures(drive_set: DriveSet) -> list[list[str]]:
    """For each unknown check its title, and which figures are not known."""
    return [
        [check.title, ", ".join(_lacking(check, drive_set)) or _stated(check)]
        for check in _reported(drive_set)
        if check.status == "unknown"
    ]


def _reported(drive_set: DriveSet) -> tuple[Check, ...]:
    """Checks that a report prints: those of the method that ranked, and by physics too where that is the paper's."""
    by_paper = any(check.method == "paper" for check in drive_set.checks)
    return drive_set.every_check if by_paper else drive_set.own_checks


def _lacking(check: Check, drive_set: DriveSet) -> list[str]:
    """The parts, or figures of parts, that a check lacks."""
    if check.name.startswith(("resistor_", "chopper_")) and isnan(check.limit) and not isnan(check.demand):
        return [sentence_case(check.title)]  # the limit is the resistor's own figure
    lacking = []
    for name in rests_on(check, drive_set):
        role, _, field = name.partition(".")
        part = getattr(drive_set, role)
        if part is None:
            lacking.append(f"any {role}")
        elif name not in EMF and _is_unknown(getattr(part, field)):
            lacking.append(figure_words(role, field, bool(part.inside)))
    return list(dict.fromkeys(lacking))


def figure_words(role: str, field: str, inside: bool = False) -> str:
    """A figure in words; of a part inside an actuator the one that is printed of that."""
    if inside:
        role, field = "actuator", printed_field(role, field)
    return f"{role} {field.removeprefix(f'{role}_').replace('_', ' ')}"


def missing_figures(drive_set: DriveSet) -> list[str]:
    """The parts, and figures of parts, that the unknown checks of a drive lack, each once."""
    unknown = (check for check in drive_set.deciding if check.status == "unknown")
    return list(dict.fromkeys(name for check in unknown for name in _lacking(check, drive_set)))


def _is_unknown(value: Any) -> bool:
    return isinstance(value, float) and isnan(value)


def _stated(check: Check) -> str:
    """The missing figures that the note of a check names, such as masses of parts; else where they belong."""
    if check.name == "brake_fits":
        return "a source that lists it with this motor"
    return check.note.removeprefix("unknown: ") if check.note.startswith("unknown: ") else _OF_THE_SPEC


_OF_THE_SPEC = "a figure of the load or of the spec"


def marked_figures(drive_set: DriveSet, catalog: Catalog) -> list[list[str]]:
    """Figures that are only derived or recalled and that a check rests on: their values, confidences and checks."""
    resting: dict[str, list[str]] = {}
    for check in _reported(drive_set):
        for name in rests_on(check, drive_set):
            resting.setdefault(name, []).append(check.title)
    found = []
    for name, titles in resting.items():
        role, _, field = name.partition(".")
        part, section = getattr(drive_set, role), f"{role}s"
        table = catalog.table(section)
        if part is None or part.part not in table.rows:
            continue
        mark = catalog.confidence(section, table.rows[part.part]).get(field, "")
        if mark in ("derived", "recalled", ESTIMATED):
            column = columns_of(section)[field]
            value = show(getattr(part, field), column.unit, column.kind, 3 if mark == ESTIMATED else 6)
            found.append([figure_words(role, field), value, mark, "; ".join(dict.fromkeys(titles))])
    return found
