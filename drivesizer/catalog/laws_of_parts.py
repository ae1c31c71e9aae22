"""Laws of data sheets as tables, a row each: of all kinds of parts, of discharge tables and of pull-out curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog.identities import IDENTITIES, solved
from drivesizer.catalog.law import (
    DEFINITION,
    ENERGY,
    HANDBOOK,
    ROUNDED,
    SLACK,
    USAGE,
    Band,
    Beside,
    Formula,
    Law,
    Numbers,
    Side,
    above_zero,
    across_offers,
    against_similar,
    bands,
    cylinder,
    decimal_places,
    formulas,
    groups,
    half_last_digit,
    only,
    orders,
    per_stage,
    reductions,
    shares,
    usual,
    whole_numbers,
    words,
)
from drivesizer.catalog.more_parts import DISCHARGES, HELD, PULL_OUTS, Discharges, PullOuts
from drivesizer.catalog.tables import Table
from drivesizer.physics.thermal import continuous_current, nominal_current, rated_ambient, resistance_25
from drivesizer.units import show

__all__ = ["LAWS", "odd_discharges", "odd_pull_outs"]


# -- Consistency of a battery's discharge tables: among each other, with its capacities and with its voltages.
#
# Each figure is compared with a neighbour in its table, so that a misprint is located. Charge is a constant current
# times its time, energy a constant power times its time; the tolerance is half of the last printed digit of both.


_HOURS = {"capacity": np.nan, "capacity_10h": 10.0, "capacity_5h": 5.0, "capacity_1h": 1.0}  # the first: rated_time
_RESTING = {"lead-acid": 1.1}  # full and at rest, per nominal voltage: 2.15 to 2.2 V of 2 V
_MEAN = 0.02  # relative: power over current is the mean voltage of two discharges that are not quite the same


class Odd(NamedTuple):
    """A contradicting entry: the battery's row, and the fields of the finding on it."""

    row: int
    finding: dict[str, Any]


def odd_discharges(given: Discharges, batteries: Table[Any]) -> Iterator[Odd]:
    """Contradictions in discharge tables."""
    for row in np.unique(given.battery).tolist():
        own = given.on(given.battery == row)
        for held, unit in HELD.items():
            some = own.on(~np.isnan(getattr(own, held)))
            draw, digit = getattr(some, held), _digit(some, held)
            yield from _along_time(row, some, draw, digit, held, unit)
            yield from _along_voltage(row, some, draw, digit, held, unit)
        yield from _capacities_by_table(row, own, batteries)
        yield from _mean_voltage(row, own, batteries)


def _digit(some: Discharges, held: str) -> Numbers:
    """Half of the last printed digit, relative: three digits, and no decimal place that no figure of that time has."""
    draw = getattr(some, held)
    places = decimal_places(draw)
    column = np.array([10.0 ** -places[some.time == time].max() for time in some.time])
    return half_last_digit(draw, column) if len(draw) else draw


def _pairs(first: Numbers, then: Numbers) -> Iterator[tuple[int, int]]:
    """Neighbours along the second column where the first is the same."""
    order = np.lexsort((then, first))
    for a, b in zip(order[:-1].tolist(), order[1:].tolist(), strict=True):
        if first[a] == first[b]:
            yield a, b


def _along_time(row: int, some: Discharges, draw: Numbers, digit: Numbers, held: str, unit: str) -> Iterator[Odd]:
    """A longer discharge draws less, and gives no less charge or energy in total."""
    total = {"current": ("charge", "A*h"), "power": ("energy", "W*h")}[held]
    for quick, slow in _pairs(some.cutoff_voltage, some.time):
        where = f"{_at(some, slow)}, beside {_hours(some.time[quick])}"
        if not draw[slow] < draw[quick]:
            yield _odd(row, f"{held} falls with time", f"less than for a shorter time: {where}", "<",
                       draw[slow], draw[quick], held, unit, 0.0)  # fmt: skip
        amount = draw * some.time
        span = digit[slow] + digit[quick]
        if amount[slow] < amount[quick] * (1.0 - span - SLACK):
            yield _odd(row, f"{total[0]} and rate", f"not below that of a faster discharge: {where}", ">=",
                       amount[slow], amount[quick], *total, span)  # fmt: skip


def _along_voltage(row: int, some: Discharges, draw: Numbers, digit: Numbers, held: str, unit: str) -> Iterator[Odd]:
    """A discharge to a lower end voltage in the same time gives no less."""
    for deep, shallow in _pairs(some.time, some.cutoff_voltage):
        span = digit[deep] + digit[shallow]
        if draw[deep] < draw[shallow] * (1.0 - span - SLACK):
            where = f"{_at(some, deep)}, beside {_volts(some.cutoff_voltage[shallow])}"
            yield _odd(row, f"{held} and end voltage", f"not below that down to more volts: {where}", ">=",
                       draw[deep], draw[shallow], held, unit, span)  # fmt: skip


def _capacities_by_table(row: int, own: Discharges, batteries: Table[Any]) -> Iterator[Odd]:
    """A printed capacity is current times time of the table, down to the end voltage where they are nearest."""
    charge, digit = own.current * own.time, _digit(own, "current")
    for name, hours in _HOURS.items():
        capacity, time = batteries[name][row], 3600.0 * hours if hours == hours else batteries["rated_time"][row]
        there = np.flatnonzero((np.abs(own.time / time - 1.0) < SLACK) & ~np.isnan(charge))
        if not len(there) or np.isnan(capacity):
            continue
        near = there[np.abs(charge[there] - capacity).argmin()]
        span = digit[near] + 0.005  # a capacity has two digits or more
        if abs(charge[near] - capacity) > capacity * (span + SLACK):
            yield _odd(row, f"{name.replace('_', ' ')} in the table", f"current x time: {_at(own, near)}", "=",
                       charge[near], capacity, "charge", "A*h", span, name)  # fmt: skip


def _mean_voltage(row: int, own: Discharges, batteries: Table[Any]) -> Iterator[Odd]:
    """Power over current for the same time and end voltage is a voltage between that end and that of a full battery."""
    nominal, chemistry = batteries["nominal_voltage"][row], str(batteries["chemistry"][row])
    full = _RESTING[chemistry] * nominal if chemistry in _RESTING else batteries["charge_voltage"][row]
    current, power = ({(v, t): n for n, (v, t, x) in enumerate(zip(own.cutoff_voltage, own.time, column, strict=True))
                       if x == x} for column in (own.current, own.power))  # fmt: skip
    span = _digit(own, "current"), _digit(own, "power")
    for key, n in current.items():
        if key not in power:
            continue
        m = power[key]
        mean, allowed = own.power[m] / own.current[n], span[0][n] + span[1][m] + _MEAN
        for relation, bound in ((">=", key[0]), ("<=", full)):
            if (bound - mean if relation == ">=" else mean - bound) > allowed * bound:
                yield _odd(row, "mean voltage", f"power by current, between the end's and a full one's: {_at(own, n)}",
                           relation, mean, bound, "voltage", "V", allowed)  # fmt: skip


def _odd(
    row: int, identity: str, meaning: str, relation: str, found: float, expected: float, kind: str, unit: str,
    tolerance: float, *fields: str,
) -> Odd:  # fmt: skip
    numbers = {"found": float(found), "expected": float(expected), "deviation": float(found / expected - 1.0)}
    words = {"identity": identity, "meaning": meaning, "relation": relation, "kind": kind, "unit": unit}
    limits = {"tolerance": float(tolerance), "reason": "half of the last printed digits", "source": DEFINITION}
    return Odd(row, words | numbers | limits | {"fields": (DISCHARGES, *fields)})


def _at(own: Discharges, place: int) -> str:
    return f"{_hours(own.time[place])} to {_volts(own.cutoff_voltage[place])}"


def _hours(time: float) -> str:
    return show(time, "h" if time >= 3600.0 else "min", "time")


def _volts(voltage: float) -> str:
    return show(voltage, "V", "voltage")


# -- Consistency of the printed pull-out curves of steppers with the holding torque and with themselves.


_RISE = 0.08  # of the torque at a lower speed: charts are read to about 5 %, and have dips where rotors resonate
_READ = 0.05


def odd_pull_outs(given: PullOuts, steppers: Table[Any]) -> Iterator[Odd]:
    """Points above the holding torque, and points above those at lower speeds."""
    for curve in np.unique(given.curve).tolist():
        own = given.on(given.curve == curve)
        row = int(own.stepper[0])
        least = np.minimum.accumulate(own.torque)
        holding = float(steppers["holding_torque"][row])
        yield from _first(own, row, "pull-out and holding torque", "not above the holding torque",
                          np.full(len(own.torque), holding), _READ, ("holding_torque",))  # fmt: skip
        yield from _first(own, row, "pull-out torque and speed", "not above that at a lower speed", least, _RISE)


def _first(
    own: PullOuts, row: int, identity: str, meaning: str, limit: Any, span: float, fields: tuple[str, ...] = ()
) -> Iterator[Odd]:
    """The first point that is above its limit by more than a share of it."""
    above = np.flatnonzero(own.torque > limit * (1.0 + span))
    if not len(above):
        return
    place = above[0]
    at = f"{show(float(own.voltage[place]), 'V', 'voltage')}, {show(float(own.speed[place]), 'rpm', 'rotary_speed')}"
    found, expected = float(own.torque[place]), float(limit[place])
    yield Odd(row, {
        "identity": identity, "meaning": f"{meaning}: {at}", "fields": (PULL_OUTS, *fields), "relation": "<=",
        "found": found, "expected": expected, "kind": "torque", "unit": "N*m",
        "deviation": found / expected - 1.0, "tolerance": span,
    })  # fmt: skip


# -- Laws of the further kinds of parts, from actuators to brake resistors, as tables.


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
_MORE_ORDERS = {
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
_MORE_BANDS: list[Band] = [
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
_MORE_BESIDE: list[Beside] = [
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

_MORE_SHARES = [("actuators", "efficiency"), ("screws", "efficiency"), ("power_supplies", "efficiency")]

_MORE_WHOLE = [("actuators", "pole_pairs"), ("actuators", "stages"), ("steppers", "full_steps"), ("belts", "teeth"),
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
    *orders(_MORE_ORDERS),
    *bands(_MORE_BANDS),
    *against_similar(_MORE_BESIDE),
    *shares(_MORE_SHARES),
    *whole_numbers(_MORE_WHOLE),
)


# -- Laws of motors, gearheads, encoders and controllers, as tables; and the tuple of all laws.


# --- sides that take more than a formula -----------------------------------------------------------------------------

_of_its_size = usual("family", "diameter")
_of_its_stages = usual("family", "version", "stages")


def _one_stage_less(figure: str, how: Callable[[Numbers], Any]) -> Side:
    """The least or greatest figure of the same gearhead with the next lower number of stages."""

    def values(table: Table[Any]) -> Numbers:
        group, stages = groups(table, "family", "version", "diameter"), table["stages"]
        found = np.full(len(table), np.nan)
        for k in range(int(group.max(initial=-1)) + 1):
            counts = np.unique(stages[(group == k) & ~np.isnan(stages)])
            for less, more in pairwise(counts):
                lesser = across_offers(table, figure, (group == k) & (stages == less), how)
                found[(group == k) & (stages == more)] = lesser
        return found

    return values


def _direction(table: Table[Any]) -> Numbers:
    """Sign of the ratio: every spur stage reverses it, a planetary stage with a fixed ring does not."""
    odd = np.where(np.isnan(table["stages"]), np.nan, 1.0 - 2.0 * (table["stages"] % 2))
    return np.where(table["kind"] == "planetary", 1.0, only(table, "spur", odd))


def _k_e(m: Table[Any]) -> Numbers:
    """The printed back-EMF constant; k_t where none is."""
    return np.where(np.isnan(m["back_emf_constant"]), m["torque_constant"], m["back_emf_constant"])


def _thermal(m: Table[Any], housing_loss: bool) -> Numbers:
    """Continuous current that the thermal figures permit."""
    th1, th2, hot = m["thermal_resistance_winding"], m["thermal_resistance_housing"], m["max_winding_temperature"]
    if housing_loss:
        flow = (m["torque_constant"], m["no_load_current"], m["nominal_speed"])
        return np.asarray(nominal_current(resistance_25(m), th1, th2, hot, *flow, rated_ambient(m)))
    return np.asarray(continuous_current(resistance_25(m), th1, th2, hot, rated_ambient(m)))


def _continuous_torque(m: Table[Any]) -> Numbers:
    """Continuous torque at nominal speed: parabola through those at 0, half and full permissible speed."""
    x = m["nominal_speed"] / m["max_speed"]
    curve = (
        m["standstill_torque"] * (1 - x) * (1 - 2 * x)
        + m["half_speed_torque"] * 4 * x * (1 - x)
        + m["top_speed_torque"] * x * (2 * x - 1)
    )
    return np.where(x <= 1, curve, np.nan)


# --- tables ----------------------------------------------------------------------------------------------------------

_ARC_MINUTE = np.pi / 180 / 60
_HEAT = ("resistance", "thermal_resistance_winding", "thermal_resistance_housing", "max_winding_temperature")
_BRUSHED = ("kind", "torque_constant", "no_load_current", "nominal_current")
_CURVE = ("standstill_torque", "half_speed_torque", "top_speed_torque", "nominal_speed", "max_speed")

_NOMINAL_TORQUE = IDENTITIES["motors"]["nominal torque of brushed motors"]
_MOTOR_LAWS: list[Formula] = [
    ("speed constant", "k_n = 1 / k_e", "speed_constant", "=",
     None, ("torque_constant",), 0.0, ROUNDED),
    ("back-EMF constant", "k_e = k_t", "back_emf_constant", "=",
     None, ("torque_constant",), 0.05,
     "the magnets' temperature and the sine's share of the voltage; more is a k_t of stall, or of other amperes"),
    ("stall current", "I_A = V / R", "stall_current", "=",
     None, ("nominal_voltage", "resistance"), 0.0, ROUNDED),
    ("stall torque", "M_H = k_t I_A", "stall_torque", "=",
     None, ("torque_constant", "stall_current"), 0.0, ROUNDED),
    ("speed-torque gradient", "R / (k_t k_e)", "speed_torque_gradient", "=",
     None,
     ("resistance", "torque_constant", "torque_constant"), 0.0, ROUNDED),
    ("mechanical time constant", "J R / (k_t k_e)", "mechanical_time_constant", "=",
     None,
     ("rotor_inertia", "resistance", "torque_constant", "torque_constant"), 0.0, ROUNDED),
    ("no-load speed", "(V - I_0 R) / k_e", "no_load_speed", "=",
     None,
     ("nominal_voltage", "no_load_current", "resistance", "torque_constant"), 0.045,
     "brush drop and the choke of a driver are not in it: 95 % of 642 maxon motors within 1 %, the worst 3.9 %"),
    ("no-load speed without its current", "not above V / k_e", "no_load_speed", "<=",
     lambda m: np.where(np.isnan(m["no_load_current"]), m["nominal_voltage"] / _k_e(m), np.nan),
     ("nominal_voltage", "torque_constant"), 0.045, "as for the no-load speed"),
    ("friction", "I_0 = (M_R + c w_0) / k_t", "no_load_current", "=",
     None,
     ("friction_torque", "viscous_friction", "no_load_speed", "torque_constant"), 0.1,
     "friction is printed as a typical value"),
    ("nominal torque of brushed motors", "k_t (I_N - I_0)", "nominal_torque", "=",
     lambda m: only(m, "brushed", solved(_NOMINAL_TORQUE, m.columns, "nominal_torque")),
     _BRUSHED, 0.04, "brush friction changes with speed: 300 maxon motors within 3.5 %"),
    ("nominal torque of brushless motors", "not below k_t (I_N - I_0)", "nominal_torque", ">=",
     lambda m: only(m, "brushless", solved(_NOMINAL_TORQUE, m.columns, "nominal_torque")),
     _BRUSHED, 0.0,
     "friction is greatest at no-load speed"),
    ("nominal torque without friction", "not above k_t I_N", "nominal_torque", "<=",
     lambda m: m["torque_constant"] * m["nominal_current"], ("torque_constant", "nominal_current"), 0.14,
     "slotted brushless motors, whose k_t is not one number: 29 of 642 maxon motors above, by up to 13 %"),
    ("nominal speed", "w_0 - gradient M_N", "nominal_speed", "=",
     None,
     ("no_load_speed", "speed_torque_gradient", "nominal_torque"), 0.18,
     "iron losses bend the line: brushless motors down to -17 %"),
    ("maximum efficiency", "(1 - sqrt(I_0 / I_A))^2", "max_efficiency", "=",
     None,
     ("no_load_current", "resistance", "nominal_voltage"), 0.09,
     "friction at the best speed is not that at no load: 642 maxon motors within -8 and +7 %"),
    ("nominal current of brushed motors, from heat", "not above what R, R_th1, R_th2 and T_max permit with friction",
     "nominal_current", "<=", lambda m: only(m, "brushed", _thermal(m, True)),
     (*_BRUSHED[:3], *_HEAT, "nominal_speed"), 0.03,
     "the copper's share of the housing's loss; brushes may set a lower one, so there is no lower bound"),
    ("nominal current, from heat", "not above what R, R_th1, R_th2 and T_max permit without any other loss",
     "nominal_current", "<=", lambda m: _thermal(m, False), _HEAT, 0.14,
     "thermal resistances are typical values: 29 of 334 brushless maxon motors above, by 13.7 %"),
]  # fmt: skip

# the orders of two figures, by section
_ORDERS = {
    "motors": (
        "nominal_speed < no_load_speed", "nominal_speed <= max_speed", "nominal_torque < stall_torque",
        "nominal_torque <= peak_torque", "nominal_current < stall_current", "no_load_current < nominal_current",
        "winding_time_constant < motor_time_constant", "ambient_min < ambient_max",
        "ambient_max <= max_winding_temperature", "half_speed_torque <= standstill_torque",
        "top_speed_torque <= half_speed_torque", "shaft_diameter < diameter", "price_5 <= price", "price_20 <= price_5",
    ),
    "gearheads": (
        "intermittent_torque >= continuous_torque", "emergency_torque >= intermittent_torque",
        "emergency_torque >= continuous_torque", "intermittent_power >= continuous_power",
        "ratcheting_torque >= emergency_torque", "median_life >= rated_life",
        "bearing_static_load >= bearing_dynamic_load",
        "intermittent_input_speed >= continuous_input_speed", "temperature_min < temperature_max", "price_5 <= price",
        "price_20 <= price_5",
    ),
    "encoders": ("max_speed <= max_mechanical_speed",),
    "controllers": (
        "supply_min < supply_max", "supply_max <= absolute_max", "supply_min >= absolute_min",
        "peak_current >= continuous_current", "speed_loop <= current_loop", "position_loop <= speed_loop",
        "max_speed_sine <= max_speed_block", "full_current_ambient < ambient_max", "reduced_power < max_power",
        "max_power_voltage < reduced_power_voltage",
    ),
}  # fmt: skip

_BESIDE: list[Beside] = [
    ("motors", "mass", _of_its_size, 6.0, "of the family's parts of that diameter: rotors of several lengths"),
    ("motors", "price", _of_its_size, 6.0, "of the family's parts of that diameter"),
    ("gearheads", "mass", _of_its_stages, 2.0, "of the family's parts with as many stages"),
    ("gearheads", "length", _of_its_stages, 2.0, "of the family's parts with as many stages"),
    ("gearheads", "efficiency", _of_its_stages, 1.25, "of the family's parts with as many stages"),
    ("gearheads", "continuous_torque", _of_its_stages, 4.0, "of the family's parts with as many stages"),
    ("gearheads", "price", _of_its_stages, 3.0, "of the family's parts with as many stages"),
]

_RATE = "francs for a euro from 2010 on, and what the shop rounds"

_BANDS: list[Band] = [
    ("controllers", "continuous current beside its derating", "continuous_current",
     lambda c: c["derating_slope"] * (c["ambient_max"] - c["full_current_ambient"]), 0.98, 1e3,
     ("derating_slope", "ambient_max", "full_current_ambient"),
     "no more is taken off up to the largest ambient than there is: 3 of maxon lose all of it"),
    ("motors", "assigned power beside M_N w_N", "assigned_power",
     lambda m: m["nominal_torque"] * m["nominal_speed"], 0.4, 4.0, ("nominal_torque", "nominal_speed"),
     "a class of the type and not a figure of the winding: 0.55 to 3.2 of 641 maxon motors"),
    ("motors", "nominal torque beside the operating range", "nominal_torque", _continuous_torque, 0.93, 1.18, _CURVE,
     "of the parabola through the torques at speed 0, half and top: 0.96 to 1.16 of 602 maxon motors, median 1.07"),
    ("motors", "mass beside volume", "mass", cylinder, 1500.0, 9000.0, ("diameter", "length"),
     "kg/m^3: hollow plastic and solid copper"),
    ("motors", "mass beside diameter", "mass", lambda m: m["diameter"] ** 3, 300.0, 25000.0, ("diameter",),
     "kg/m^3: a flat ring and five diameters of steel; 850 to 18200 of 643 maxon motors"),
    ("motors", "rotor inertia beside the whole motor's", "rotor_inertia",
     lambda m: m["mass"] * m["diameter"] ** 2 / 4, 0.003, 1.0, ("mass", "diameter"),
     "of a ring with all its mass at the rim; 0.01 to 0.32 of 643 maxon motors"),
    ("motors", "heat capacity of the winding", "winding_time_constant",
     lambda m: m["thermal_resistance_winding"] * m["mass"] * 390, 0.01, 0.5, ("thermal_resistance_winding", "mass"),
     "of the motor's mass in copper, 390 J/kg K; 0.02 to 0.17 of 642 maxon motors"),
    ("motors", "heat capacity of the housing", "motor_time_constant",
     lambda m: m["thermal_resistance_housing"] * m["mass"] * 450, 0.05, 2.5, ("thermal_resistance_housing", "mass"),
     "of the motor's mass in steel, 450 J/kg K; 0.1 to 1.8 of 642 maxon motors"),
    ("gearheads", "mass beside volume", "mass", cylinder, 1000.0, 12000.0, ("diameter", "length"),
     "kg/m^3: plastic; steel, and the flange and the pinion that the length leaves out"),
    ("gearheads", "no-load torque beside continuous torque / ratio", "no_load_torque",
     lambda g: g["continuous_torque"] / g["ratio"], 0.005, 1.0, ("continuous_torque", "ratio"),
     "seals and oil; 0.02 to 0.48 of 156 Wittenstein gearheads; at 1 the rated torque would only turn it back"),
    ("gearheads", "twist at continuous torque", "stiffness", lambda g: g["continuous_torque"] / _ARC_MINUTE,
     1 / 60, 1 / 0.3, ("continuous_torque",), "0.3 to 60 arcmin; 1.8 to 8.6 of 119 gearheads of four makers"),
    ("gearheads", "lever of the tilting moment", "max_tilting_moment", lambda g: g["max_radial_load"], 0.005, 1.0,
     ("max_radial_load",), "m, from the bearing: 0.05 to 0.17 of 36 Wittenstein gearheads"),
    ("motors", "francs beside euros", "list_price", lambda t: t["price"], 0.9, 1.5, ("price",), _RATE),
    ("gearheads", "francs beside euros", "list_price", lambda t: t["price"], 0.9, 1.5, ("price",), _RATE),
]  # fmt: skip

# figure, and whether a further stage may make it smaller or greater
_STAGES = [("continuous_torque", ">="), ("intermittent_torque", ">="), ("efficiency", "<="), ("mass", ">="),
           ("length", ">=")]  # fmt: skip

# section, figure: below 1 (a share)
_SHARES = [("motors", "max_efficiency"), ("gearheads", "efficiency"), ("controllers", "max_efficiency")]

_WHOLE = [("motors", "pole_pairs"), ("motors", "phases"), ("motors", "commutator_segments"), ("gearheads", "stages"),
          ("encoders", "counts_per_turn"), ("encoders", "steps_per_turn"), ("encoders", "channels")]  # fmt: skip

# thermal_resistance_winding: motors of which only winding to ambient is known have it in the housing's;
# stages: 0 is direct drive
_MAY_BE_ZERO = {"thermal_resistance_winding", "friction_torque", "viscous_friction", "backlash", "axial_play",
                "voltage_drop", "stages", "direction", "price", "price_5", "price_20", "list_price", "added_length",
                "inertia", "bearing_distance"}  # fmt: skip

_OTHERS = (
    Law(section="gearheads", name="efficiency per stage, at least", meaning="0.75 to the power of the stages at least",
        figure="efficiency", relation=">=", expected=lambda g: per_stage(g, "kind", 0.75),
        fields=("stages", "kind"), reason="0.80 to 0.97 of 2215 maxon gearheads", source=USAGE),
    Law(section="gearheads", name="direction", meaning="every spur stage turns it round, a planetary stage does not",
        figure="direction", relation="=", expected=_direction, fields=("kind", "stages"), rounds=False,
        reason="none: a sign"),
    Law(section="encoders", name="speed at the greatest frequency", meaning="not above 60 f / counts",
        figure="max_speed", relation="<=", expected=lambda e: 2 * np.pi * e["max_frequency"] / e["counts_per_turn"],
        fields=("max_frequency", "counts_per_turn"), reason=f"{ROUNDED}; the bearing may set a lower one"),
)  # fmt: skip


def _stage_laws() -> Iterator[Law]:
    for figure, relation in _STAGES:
        word, how = ("least", np.min) if relation == ">=" else ("greatest", np.max)
        yield Law(section="gearheads", name=f"{words(figure)} by stages", figure=figure, relation=relation,
                  meaning=f"against the family's {word} with one stage less", fields=("stages",), rounds=False,
                  expected=_one_stage_less(figure, how), reason="none: a stage more", source=USAGE)  # fmt: skip


LAWS: tuple[Law, ...] = (
    *formulas("motors", _MOTOR_LAWS, HANDBOOK),
    *orders(_ORDERS),
    *reductions("gearheads", "kind"),
    *_OTHERS,
    *bands(_BANDS),
    *against_similar(_BESIDE),
    *_stage_laws(),
    *shares(_SHARES),
    *whole_numbers(_WHOLE),
    *LAWS_OF_MORE_PARTS,
    *above_zero(_MAY_BE_ZERO),
)
