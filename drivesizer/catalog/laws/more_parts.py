"""Laws of the further kinds of parts, from actuators to brake resistors, as tables."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from drivesizer.catalog.laws.law import (
    DEFINITION,
    ENERGY,
    HANDBOOK,
    ROUNDED,
    USAGE,
    Band,
    Beside,
    Formula,
    Law,
    Numbers,
    Side,
    against_similar,
    bands,
    cylinder,
    formulas,
    orders,
    reductions,
    shares,
    usual,
    whole_numbers,
)
from drivesizer.catalog.tables import Table

__all__ = ["LAWS_OF_MORE_PARTS"]

# --- actuators -------------------------------------------------------------------------------------------------------


def _output_torque_constant(a: Table[Any]) -> Numbers:
    """Torque constant at the output, friction left out."""
    return np.asarray(a["ratio"] * a["efficiency"] * a["motor_torque_constant"])


def _idle_speed(a: Table[Any], current: Any) -> Numbers:
    """Speed of the output at nominal voltage with some current."""
    k_e = np.where(np.isnan(a["motor_back_emf_constant"]), a["motor_torque_constant"], a["motor_back_emf_constant"])
    return np.asarray((a["nominal_voltage"] - current * a["resistance"]) / (a["ratio"] * k_e))


def _idle_current(a: Table[Any]) -> Numbers:
    """Current that friction takes at the no-load speed."""
    torque = a["coulomb_friction"] + a["viscous_friction"] * a["no_load_speed"]
    return np.asarray(torque / (a["ratio"] * a["motor_torque_constant"]))


_GEARED = ("ratio", "efficiency", "motor_torque_constant")
_IDLE = ("nominal_voltage", "ratio", "motor_torque_constant")

_ACTUATOR_LAWS: list[Formula] = [
    ("stall current", "I_A = V / R", "stall_current", "=",
     None, ("nominal_voltage", "resistance"), 0.0, ROUNDED),
    ("stall torque", "M_H = i eta k_m (I_A - I_0)", "stall_torque", "=",
     None,
     (*_GEARED, "stall_current"), 0.02, "the rounding of I_0, which is little; efficiencies are worked out of it"),
    ("stall torque without friction", "not above i eta k_m I_A", "stall_torque", "<=",
     lambda a: _output_torque_constant(a) * a["stall_current"], (*_GEARED, "stall_current"), 0.02,
     "5 per mille of 125, Dynamixel"),
    ("nominal torque without friction", "not above i eta k_m I_N", "nominal_torque", "<=",
     lambda a: _output_torque_constant(a) * a["nominal_current"], (*_GEARED, "nominal_current"), 0.14,
     "brushless motors, whose k_m is not one number: LK-Tech by 11 %"),
    ("no-load speed without friction", "not above V / (i k_m)", "no_load_speed", "<=",
     lambda a: _idle_speed(a, 0.0), _IDLE, 0.1,
     "k_m falls as the field turns; 22 % would be a k_m of the current's effective value"),
]  # fmt: skip

_ENERGY_LAWS: list[Formula] = [
    ("energy at stall and no load", "M_H w_0 not above V I_A", "stall_torque", "<=",
     lambda a: a["nominal_voltage"] * a["stall_current"] / a["no_load_speed"],
     ("nominal_voltage", "stall_current", "no_load_speed"), 0.0, ROUNDED),
    ("energy at the nominal point", "M_N w_N not above V I_N", "nominal_torque", "<=",
     lambda a: a["nominal_voltage"] * a["nominal_current"] / a["nominal_speed"],
     ("nominal_voltage", "nominal_current", "nominal_speed"), 0.0, ROUNDED),
]  # fmt: skip

# --- belts and pulleys -----------------------------------------------------------------------------------------------

# profile and the pitches that it is made in, mm
_PITCHES = {
    "HTD": (3.0, 5.0, 8.0, 14.0, 20.0), "GT2": (2.0, 3.0, 5.0, 8.0, 14.0), "RT25": (6.35,), "MXL": (2.032,),
    "XL": (5.08,), "L": (9.525,), "H": (12.7,), "XH": (22.225,), "T2.5": (2.5,), "T5": (5.0,), "T10": (10.0,),
    "T20": (20.0,), "AT3": (3.0,), "AT5": (5.0,), "AT10": (10.0,), "AT20": (20.0,),
}  # fmt: skip
_LEAST_TEETH = {"belts": 16.0, "pulleys": 8.0}


def _nearest(values: Any, made: tuple[float, ...]) -> Numbers:
    """The nearest by ratio of the sizes that are made; unknown for an unknown value."""
    sizes = np.array(made)
    nearest = sizes[np.abs(np.log(np.asarray(values)[:, None] / sizes)).argmin(axis=1)]
    return np.where(np.isnan(values), np.nan, nearest)


def _pitch_of_profile(b: Table[Any]) -> Numbers:
    """The pitch of the belt's profile; unknown where the profile is."""
    found = np.full(len(b), np.nan)
    for profile, made in _PITCHES.items():
        found = np.where(b["profile"] == profile, _nearest(b["pitch"] * 1e3, made) / 1e3, found)
    return found


def _toothed_part_laws(section: str) -> Iterator[Law]:
    yield Law(section=section, name="pitch of the profile", meaning="one in which the profile is made", figure="pitch",
              relation="=", expected=_pitch_of_profile, fields=("profile",), rounds=False,
              reason="none: a standard")  # fmt: skip
    least = _LEAST_TEETH[section]
    yield Law(section=section, name="teeth, at least", meaning=f"{least:g} teeth at least", figure="teeth",
              relation=">=", expected=lambda b: np.full(len(b), least), fields=(), rounds=False, source=USAGE,
              reason="a smaller pulley would break the belt, which goes round two")  # fmt: skip


# --- actuators with figures at several voltages -----------------------------------------------------------------------


def _of_one_part(figure: str) -> Law:
    """A figure that does not hang on the voltage, the same in all rows of a part."""
    alike = usual("order_number")(figure)
    return Law(section="actuators", name=f"{figure.replace('_', ' ')} at several voltages", figure=figure, relation="=",
               meaning="that of the other rows of its order_number", fields=(), rounds=False, reason="none: one part",
               expected=lambda a: np.where(a["order_number"] == "", np.nan, alike(a)))  # fmt: skip


# --- steppers --------------------------------------------------------------------------------------------------------

_FULL_STEPS = (12.0, 20.0, 24.0, 36.0, 48.0, 60.0, 72.0, 96.0, 100.0, 120.0, 144.0, 180.0, 200.0, 300.0, 400.0, 500.0,
               1000.0)  # fmt: skip

_STEPPER_LAWS: list[Formula] = [
    ("full steps in use", "a usual step: 30 to 0.36 degrees", "full_steps", "=",
     lambda s: _nearest(s["full_steps"], _FULL_STEPS), (), 0.0, "none: a count"),
    ("voltage of a phase", "I R not above the greatest supply", "phase_current", "<=",
     lambda s: s["supply_max"] / s["resistance"], ("supply_max", "resistance"), 0.0, ROUNDED),
]  # fmt: skip

# --- screws ----------------------------------------------------------------------------------------------------------

_SCREW_LAWS: list[Formula] = [
    ("play of a screw", "5 % of the diameter at most", "axial_play", "<=", lambda s: 0.05 * s["diameter"],
     ("diameter",), 0.0, "none: 0 of preloaded nuts to 0.8 % of 385 screws"),
]  # fmt: skip

# --- batteries -------------------------------------------------------------------------------------------------------

# chemistry, W h/kg at least and at most, of which parts
_CHEMISTRIES = [
    ("Li-ion", 100.0, 300.0, "cells for power and cells for energy; 200 to 263 of 13 cells"),
    ("LiFePO4", 70.0, 180.0, "cells for power and cells for energy; 108 and 117 of two"),
    ("lead-acid", 20.0, 60.0, "blocks; 30 to 45 of seven"),
]


def _capacity_for_1_wh_per_kg(chemistry: str) -> Side:
    return lambda b: np.where(b["chemistry"] == chemistry, 3600.0 * b["mass"] / b["nominal_voltage"], np.nan)


def _drawn_as_long(hours: float) -> Side:
    """The capacity, where it is drawn in that time or longer."""
    return lambda b: np.where(b["rated_time"] >= hours * 3600.0, b["capacity"], np.nan)


def _peukert(b: Table[Any]) -> Numbers:
    """I^k t is the same for every current I that empties it in t; read at one hour."""
    return np.asarray(b["capacity"] * (3600.0 / b["rated_time"]) ** (1 - 1 / b["peukert_exponent"]))


_BATTERY_LAWS: list[Formula] = [
    ("Peukert exponent, at least", "1 at least", "peukert_exponent", ">=", lambda b: np.ones(len(b)), (), 0.0,
     "none: at 1 every current draws the same charge"),
    ("Peukert exponent, at most", "1.5 at most", "peukert_exponent", "<=", lambda b: np.full(len(b), 1.5), (), 0.0,
     "1.14 to 1.36 of four lead-acid blocks; other chemistries have less"),
]  # fmt: skip


def _capacities() -> Iterator[Law]:
    """Capacity in some hours compared with that in the rated time."""
    for hours in (10, 5, 1):
        yield Law(section="batteries", name=f"capacity {hours} h and capacity", figure=f"capacity_{hours}h",
                  meaning="not above the capacity drawn more slowly", relation="<=", expected=_drawn_as_long(hours),
                  fields=("capacity", "rated_time"), rounds=False, reason="none: rounding keeps the order")  # fmt: skip


# --- tables ----------------------------------------------------------------------------------------------------------

# the orders of two figures, by section
_ORDERS = {
    "actuators": (
        "nominal_speed < no_load_speed", "nominal_speed <= max_speed", "nominal_torque < stall_torque",
        "nominal_torque <= peak_torque", "nominal_current < stall_current", "nominal_current <= peak_current",
        "no_load_current < nominal_current", "coulomb_friction < stall_torque", "coulomb_friction < nominal_torque",
        "winding_time_constant < motor_time_constant", "ambient_min < ambient_max",
        "ambient_max <= max_winding_temperature", "supply_min < supply_max", "nominal_voltage >= supply_min",
        "nominal_voltage <= supply_max",
    ),
    "brakes": (
        "dynamic_torque <= static_torque", "holding_power <= power", "energy_per_stop <= total_energy",
        "energy_per_stop <= energy_per_hour",
    ),
    "steppers": (
        "supply_min < supply_max", "detent_torque < holding_torque", "shaft_diameter < diameter",
        "ambient_min < ambient_max",
    ),
    "screws": ("root_diameter < diameter", "diameter < ball_diameter", "pitch_diameter < diameter",
               "root_diameter < pitch_diameter", "shaft_diameter <= ball_diameter", "back_efficiency < efficiency",
               "nut_mass <= mass"),
    "batteries": (
        "cutoff_voltage < nominal_voltage", "nominal_voltage < charge_voltage", "capacity_1h <= capacity_5h",
        "capacity_5h <= capacity_10h", "peak_current >= continuous_current",
    ),
    "power_supplies": (
        "voltage_min <= nominal_voltage", "nominal_voltage <= voltage_max", "continuous_current < peak_current",
        "voltage_max <= overvoltage_min", "overvoltage_min <= overvoltage_max", "voltage_max < return_voltage",
    ),
    "brake_resistors": (
        "resistance_min < resistance_max", "min_resistance <= resistance", "power < peak_power",
        "rated_ambient < zero_power_ambient", "chopper_voltage_min <= chopper_voltage_max", "supply_min < supply_max",
        "chopper_voltage_max < max_voltage",
    ),
}  # fmt: skip

# section, name, figure, expected, least and most share of it, other figures, reason
_BANDS: list[Band] = [
    ("actuators", "no-load speed beside (V - I_0 R) / (i k_m)", "no_load_speed",
     lambda a: _idle_speed(a, a["no_load_current"]), 0.8, 1.05, _IDLE,
     "drivers that cannot give all of V: 0.85 to 0.90 of RobStride, 0.91 to 1.01 of 86 others"),
    ("actuators", "torque constant beside i eta k_m", "torque_constant", _output_torque_constant, 0.85, 1.05, _GEARED,
     "some count friction, stall torque by stall current: 0.86 to 0.94 of Feetech; 0.96 to 1.01 of 45 others"),
    ("actuators", "output inertia beside i^2 J", "output_inertia", lambda a: a["ratio"] ** 2 * a["rotor_inertia"],
     1.0, 1.3, ("ratio", "ratio", "rotor_inertia"), "the flange and the last stage, which the motor hardly feels"),
    ("actuators", "no-load current beside (M_c + b w_0) / (i k_m)", "no_load_current", _idle_current, 0.4, 2.5,
     ("coulomb_friction", "viscous_friction", "no_load_speed", "ratio", "motor_torque_constant"),
     "one printed, the other identified: 0.66 of STS3215, 1.5 of XL-320"),
    ("actuators", "efficiency beside 1 / (1 + s)", "efficiency", lambda a: 1.0 / (1.0 + a["load_friction"]), 0.7, 1.4,
     ("load_friction",), "one of the stall figures, the other identified: 0.79 to 1.28 of Dynamixel and STS3215"),
    ("actuators", "power by mass", "nominal_torque", lambda a: a["mass"] / a["nominal_speed"], 1.0, 1500.0,
     ("mass", "nominal_speed"), "W/kg: 11 to 760 of 91 actuators"),
    ("actuators", "torque by mass", "nominal_torque", lambda a: a["mass"], 0.05, 200.0, ("mass",),
     "N m/kg: 0.6 to 56 of 224 actuators, without gear 0.9"),
    ("actuators", "mass beside diameter", "mass", lambda a: a["diameter"] ** 3, 200.0, 25000.0, ("diameter",),
     "kg/m^3: a flat ring and five diameters of steel; 515 to 6600 of 75 actuators"),
    ("actuators", "mass beside volume", "mass", cylinder, 500.0, 9000.0, ("diameter", "length"),
     "kg/m^3: hollow plastic and solid copper"),
    ("brakes", "torque by mass", "static_torque", lambda b: b["mass"], 0.5, 60.0, ("mass",),
     "N m/kg, wide: 5 to 18 of six springs, permanent magnets to 30 by experience"),
    ("brakes", "torque by power", "static_torque", lambda b: b["power"], 0.005, 10.0, ("power",),
     "N m/W, wide: 0.03 of the smallest to 3.5 of big ones, of 82"),
    ("brakes", "torque by inertia", "static_torque", lambda b: b["inertia"], 1e4, 1e7, ("inertia",),
     "rad/s^2: 3.1e4 of a part of an actuator, 4e4 to 2.3e6 of 17 others"),
    ("steppers", "copper loss by mass", "mass", lambda s: 2 * s["phase_current"] ** 2 * s["resistance"],
     1 / 150, 1 / 2, ("phase_current", "phase_current", "resistance"),
     "2 to 150 W/kg with current in two phases: 5 to 28 of five, 80 of the smallest by experience"),
    ("steppers", "torque by mass", "holding_torque", lambda s: s["mass"], 0.1, 6.0, ("mass",),
     "N m/kg: 0.7 to 1.8 of six, 0.3 of the smallest by experience"),
    ("steppers", "inductance by resistance", "inductance", lambda s: s["resistance"], 1e-4, 0.03, ("resistance",),
     "s: 0.35 to 9.4 ms of 47 steppers"),
    ("steppers", "rotor inertia by mass", "rotor_inertia", lambda s: s["mass"] ** (5 / 3), 3e-6, 3e-4, ("mass",),
     "kg m^2/kg^(5/3), alike bodies have it alike: 2.3e-5 to 5.2e-5 of six"),
    ("belts", "width beside pitch", "width", lambda b: b["pitch"], 1.0, 20.0, ("pitch",), "1.8 to 5 of 1311 belts"),
    ("belts", "mass by area", "mass", lambda b: b["pitch"] * b["teeth"] * b["width"], 0.8, 15.0,
     ("pitch", "teeth", "width"), "kg/m^2: GT2 2 mm 1.4, HTD 5 mm 4, 20 mm 12"),
    ("pulleys", "width beside pitch", "width", lambda b: b["pitch"], 1.0, 20.0, ("pitch",),
     "1.8 to 8.5 of 84 pulleys"),
    ("pulleys", "mass beside volume", "mass", lambda p: (p["pitch"] * p["teeth"]) ** 2 * p["width"] / (4 * np.pi),
     150.0, 30000.0, ("pitch", "pitch", "teeth", "teeth", "width"),
     "kg/m^3: a plastic rim on spokes; a steel one with a hub twice as long as the belt is wide"),
    ("screws", "core beside diameter", "root_diameter", lambda s: s["diameter"], 0.65, 0.98, ("diameter",),
     "0.74 to 0.95 of 765 screws"),
    ("screws", "ball centres beside diameter", "ball_diameter", lambda s: s["diameter"], 1.0, 1.12, ("diameter",),
     "1.015 to 1.07 of 616 screws"),
    ("screws", "shaft beside diameter", "shaft_diameter", lambda s: s["diameter"], 0.85, 1.02, ("diameter",),
     "0.875 to 1.002 of 136 screws"),
    ("screws", "lead beside diameter", "lead", lambda s: s["diameter"], 0.03, 4.5, ("diameter",),
     "0.06 to 2.5 of 919 screws"),
    ("screws", "static beside dynamic load", "static_load", lambda s: s["dynamic_load"], 1.0, 5.5, ("dynamic_load",),
     "1.2 to 4.5 of 868 screws"),
    ("screws", "static load by area", "static_load", lambda s: s["diameter"] ** 2, 5e6, 5e8, ("diameter", "diameter"),
     "Pa: 1.5e7 to 3.7e8 of 868 screws"),
    ("screws", "thrust by area", "permissible_thrust", lambda s: s["diameter"] ** 2, 5e6, 1e8,
     ("diameter", "diameter"), "Pa: 2.0e7 to 2.7e7 of 13 screws"),
    ("screws", "stiffness by diameter", "stiffness", lambda s: s["diameter"], 3e8, 1e11, ("diameter",),
     "N/m^2: 1.5e9 to 6.0e10 of 734 screws"),
    ("screws", "permissible diameter times speed", "dn_max", lambda s: np.ones(len(s)), 5e3, 5e5, (),
     "mm rpm: 1.8e4 to 1.6e5 of 817 screws"),
    ("power_supplies", "power", "continuous_current", lambda p: 1.0 / p["nominal_voltage"], 5.0, 2e4,
     ("nominal_voltage",), "W: 60 to 3000 of 74 units"),
    ("power_supplies", "peak beside continuous current", "peak_current", lambda p: p["continuous_current"], 1.0, 4.0,
     ("continuous_current",), "1.5 to 3 of 14 units"),
    ("power_supplies", "time of the peak", "peak_time", lambda p: np.ones(len(p)), 1e-3, 60.0, (),
     "s: 12 ms to 5 s of 14 units"),
    ("power_supplies", "over-voltage beside nominal voltage", "overvoltage_max", lambda p: p["nominal_voltage"], 1.05,
     1.6, ("nominal_voltage",), "1.35 to 1.4 of 18 units"),
    ("power_supplies", "hold-up", "hold_up", lambda p: np.ones(len(p)), 1e-3, 0.5, (), "s: 12 to 28 ms of 15 units"),
    ("brake_resistors", "power while on beside continuous power", "power",
     lambda b: b["chopper_voltage_max"] ** 2 / b["resistance"], 1e-3, 1.5,
     ("chopper_voltage_max", "chopper_voltage_max", "resistance"), "0.017 to 0.38 of four shunt regulators"),
    ("brake_resistors", "pulse beside continuous power", "pulse_energy", lambda b: b["power"], 0.1, 3000.0, ("power",),
     "s: 25 and 133 of two resistors of Siemens, 5 of a small one of Vishay"),
    ("brake_resistors", "power by mass", "power", lambda b: b["mass"], 5.0, 1000.0, ("mass",),
     "W/kg: 140 and 160 of two"),
    ("brake_resistors", "current beside power", "chopper_current", lambda b: b["peak_power"] / b["chopper_voltage_max"],
     0.5, 3.0, ("peak_power", "chopper_voltage_max"), "0.93 of one"),
    ("brake_resistors", "capacitance", "capacitance", lambda b: np.ones(len(b)), 1e-6, 1.0, (),
     "F: 0.94 and 1.65 mF of two"),
    *(("batteries", f"energy by mass, {name}", "capacity", _capacity_for_1_wh_per_kg(name), least, most,
       ("mass", "nominal_voltage", "chemistry"), f"W h/kg: {reason}") for name, least, most, reason in _CHEMISTRIES),
    ("batteries", "peak current beside V / R", "peak_current", lambda b: b["nominal_voltage"] / b["resistance"],
     0.005, 0.6, ("nominal_voltage", "resistance"),
     "at half of it a battery gives most power, and full ones have more than V; 0.08 to 0.36 of 19"),
    ("batteries", "Peukert's law at 1 h", "capacity_1h", _peukert, 0.9, 1.35,
     ("capacity", "rated_time", "peukert_exponent"),
     "the exponent is one of a range of currents, and 1 h may go down to less volts: 0.99 to 1.28 of four blocks"),
]  # fmt: skip

# section, figure, side, largest multiple of the median of similar parts, reason
_BESIDE: list[Beside] = [
    ("actuators", "mass", usual("family"), 8.0, "of the family's parts: several sizes"),
    ("actuators", "efficiency", usual("family"), 3.0, "of the family's parts: one to six stages"),
    ("actuators", "price", usual("family"), 10.0, "of the family's parts: several sizes"),
    ("brakes", "price", usual("family"), 10.0, "of the family's parts: several sizes"),
    ("steppers", "mass", usual("family"), 10.0, "of the family's parts: several sizes"),
    ("steppers", "price", usual("family"), 10.0, "of the family's parts: several sizes"),
    ("belts", "price", usual("family", "width"), 10.0, "of the family's belts of that width: all lengths"),
    ("pulleys", "price", usual("family", "width"), 10.0, "of the family's pulleys of that width: all sizes"),
    ("screws", "nut_mass", usual("family"), 300.0, "of the family's nuts: all sizes"),
    ("screws", "price", usual("family"), 100.0, "of the family's screws: all sizes and lengths"),
    ("power_supplies", "price", usual("manufacturer"), 30.0, "of the maker's units: all sizes"),
    ("brake_resistors", "price", usual("manufacturer"), 30.0, "of the maker's resistors: all sizes"),
    ("batteries", "price", usual("family", "nominal_voltage"), 30.0, "of the family's parts of that voltage"),
]

_SHARES = [("actuators", "efficiency"), ("screws", "efficiency"), ("power_supplies", "efficiency")]

_WHOLE = [("actuators", "pole_pairs"), ("actuators", "stages"), ("steppers", "full_steps"), ("belts", "teeth"),
          ("pulleys", "teeth"), ("screws", "starts")]  # fmt: skip

LAWS_OF_MORE_PARTS: tuple[Law, ...] = (
    *formulas("actuators", _ACTUATOR_LAWS, HANDBOOK),
    *formulas("actuators", _ENERGY_LAWS, ENERGY),
    *formulas("steppers", _STEPPER_LAWS, USAGE),
    *formulas("screws", _SCREW_LAWS, USAGE),
    *formulas("batteries", _BATTERY_LAWS, DEFINITION),
    *_capacities(),
    *reductions("actuators", "gearing"),
    *map(_of_one_part, ("mass", "ratio", "output_inertia")),
    *_toothed_part_laws("belts"),
    *_toothed_part_laws("pulleys"),
    *orders(_ORDERS),
    *bands(_BANDS),
    *against_similar(_BESIDE),
    *shares(_SHARES),
    *whole_numbers(_WHOLE),
)
