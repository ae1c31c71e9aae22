"""Kinds of quantities: the units in which each may be written, and the range that a machine's figure lies in."""

from __future__ import annotations

import math
import re
from typing import Any, NamedTuple

# -- Kinds of quantities: the name of each, an example, and the units in which it may be written.


class Kind(NamedTuple):
    """A kind of quantity: its name in a sentence, its SI unit, an example, and the units accepted for it."""

    noun: str
    si: str
    example: str
    units: dict[str, str]  # pint expression -> further spellings, separated by blanks


# kind | example | smallest magnitude but 0 and largest, in SI | accepted units, the SI unit first, each followed by its
# further spellings.
# What follows from a unit by rule is not listed: N*m is also read as N·m, N m, N-m and Nm; m^2 as m2, m² and m**2.
_KINDS = """
length               | 118 mm      | 1e-9 1e7    | m; mm; cm; um; km; in inch inches "; thou mil; ft foot feet; yd
mass                 | 45 kg       | 1e-7 1e8    | kg; g; mg; t; lb lbs; oz
inertia              | 142 g*cm^2  | 1e-15 1e9   | kg*m^2; g*cm^2; kg*cm^2; g*m^2; g*mm^2; kg*mm^2; lb*in^2; oz*in^2
.                    |             |             | lb*ft^2
.                    |             |             | ozf*in*s^2 oz*in*s^2; lbf*in*s^2 lb*in*s^2
.                    |             |             | lbf*ft*s^2 lb*ft*s^2 slug*ft^2
.                    |             |             | kgf*m*s^2 kg*m*s^2 kp*m*s^2; kgf*cm*s^2 kg*cm*s^2; gf*cm*s^2 g*cm*s^2
torque               | 71 mN*m     | 1e-10 1e9   | N*m; mN*m; uN*m; kN*m; N*cm; N*mm; ozf*in oz*in in*oz in*ozf
.                    |             |             | lbf*in lb*in in*lb in*lbf; lbf*ft lb*ft ft*lb ft*lbf
.                    |             |             | kgf*cm kg*cm; kgf*m kg*m kp*m; gf*cm g*cm
energy               | 12 W*h      | 1e-10 1e13  | J; kJ; MJ; mJ; W*h; kW*h; W*s
power                | 20 W        | 1e-10 1e10  | W; mW; kW; hp HP; PS
force                | 50 N        | 1e-10 1e9   | N; mN; kN; lbf; ozf; kgf kp; gf
speed                | 1.5 m/s     | 1e-12 100000 | m/s; mm/s; cm/s; km/h kmh kph; m/min; mm/min; ft/s fps; ft/min fpm
.                    |             |             | cm/min; in/s ips; in/min ipm; yd/min; mi/h mph
rotary_speed         | 3000 rpm    | 1e-12 1e6   | rad/s; rpm RPM 1/min min-1 r/min rev/min U/min; krpm; deg/s
.                    |             |             | turn/s rev/s rps
frequency            | 5 Hz        | 1e-6 1e10   | Hz; kHz; MHz
acceleration         | 0.75 m/s^2  | 1e-12 1e7   | m/s^2; mm/s^2; cm/s^2; ft/s^2; in/s^2; g_0
angular_acceleration | 10 rad/s^2  | 1e-12 1e10  | rad/s^2; deg/s^2; rpm/s; turn/s^2 rev/s^2
jerk                 | 5 m/s^3     | 1e-12 1e12  | m/s^3; mm/s^3
angular_jerk         | 100 rad/s^3 | 1e-12 1e15  | rad/s^3; deg/s^3; turn/s^3 rev/s^3
area                 | 0.6 m^2     | 1e-12 1e8   | m^2; cm^2; mm^2; ft^2; in^2
capacitance          | 4.7 mF      | 1e-15 1e6   | F; mF; uF
time                 | 2 s         | 1e-9 1e10   | s sec; ms; us; min; h hr; d
voltage              | 24 V        | 1e-6 1e6    | V; mV; kV
current              | 1.16 A      | 1e-9 1e6    | A; mA; uA
charge               | 7 A*h       | 1e-6 1e9    | A*s; A*h; mA*h
resistance           | 2.32 ohm    | 1e-8 1e8    | ohm Ohm ohms; mohm mOhm; kohm kOhm
inductance           | 0.238 mH    | 1e-10 10000 | H; mH; uH
torque_constant      | 23.4 mN*m/A | 1e-7 100000 | N*m/A; mN*m/A; N*cm/A; ozf*in/A oz*in/A; lbf*in/A lb*in/A
.                    |             |             | V*s/rad V*s
.                    |             |             | V/rpm; mV/rpm; V/krpm
back_emf_constant    | 2.45 mV/rpm | 1e-7 100000 | V*s/rad V*s; mV*s/rad mV*s; V/rpm; mV/rpm mV/min-1; V/krpm; N*m/A
.                    |             |             | mN*m/A
speed_constant       | 408 rpm/V   | 1e-5 1e7    | rad/s/V rad/(V*s) rad/(s*V); rpm/V 1/min/V min-1/V
speed_torque_gradient | 40.5 rpm/mN*m | 1e-9 1e15   | rad/s/(N*m); rpm/(mN*m) 1/min/mNm min-1/mNm; rpm/(N*m)
.                    |             |             | rpm/(ozf*in) rpm/oz*in
thermal_resistance   | 3.1 K/W     | 1e-5 1e6    | K/W degC/W
heat_capacity        | 12 J/K      | 1e-7 1e9    | J/K
current_per_temperature | 0.2 A/K     | 1e-9 1e6    | A/K A/degC; mA/K
temperature          | 25 degC     | 1 3000      | K; degC C; degF F
temperature_difference | 75 K        | 1e-6 3000   | K
angle                | 2 deg       | 1e-9 1e9    | rad; deg; arcmin '; arcsec "; turn rev
density              | 7850 kg/m^3 | 0.0001 1e6  | kg/m^3; g/cm^3 g/cc; lb/in^3; lb/ft^3
stiffness            | 20 N/mm     | 1e-6 1e13   | N/m; N/mm; kN/m; N/um; lbf/in lb/in
torsional_stiffness  | 1.2 N*m/arcmin | 1e-9 1e13   | N*m/rad; N*m/deg; N*m/arcmin; mN*m/rad
damping              | 1e-6 N*m*s  | 1e-15 1e7   | N*m*s/rad N*m*s; mN*m/rpm mNm*min
dimensionless        | 0.02 or 2 % | 1e-12 1e12  | 1 :1; %
ratio                | 27          | 1e-5 1e7    | 1
price                | 46.55 EUR   | 1e-6 1e12   | EUR €; USD $ US$; CHF; GBP £; JPY ¥; CNY RMB; CAD; AUD; SEK; DKK
.                    |             |             | NOK; PLN; CZK; KRW; INR
price_eur            | 46.55 EUR   | 1e-6 1e12   | EUR €
price_chf            | 51.20 CHF   | 1e-6 1e12   | CHF
"""
_NOUNS = {
    "back_emf_constant": "back-EMF constant",
    "speed_torque_gradient": "speed/torque gradient",
    "dimensionless": "plain number",
    "price_eur": "price in EUR",
    "price_chf": "price in CHF",
}


def _kinds() -> tuple[dict[str, Kind], dict[str, tuple[float, float]]]:
    kinds, ranges = dict[str, Kind](), dict[str, tuple[float, float]]()
    for line in re.sub(r"\n[.][ |]+", "; ", _KINDS).strip().splitlines():
        name, example, ends, listed = (cell.strip() for cell in line.split("|"))
        units = {words[0]: " ".join(words[1:]) for words in (entry.split() for entry in listed.split(";"))}
        kinds[name] = Kind(_NOUNS.get(name, name.replace("_", " ")), next(iter(units)), example, units)
        least, most = map(float, ends.split())
        ranges[name] = least, most
    return kinds, ranges


# A rotor of 5e-324 kg·m² or a torque of 1e300 N·m is a slip of the pen, and behind the door it ends in a division by
# zero or in an unbounded number. The ranges reach some powers of ten beyond what is built, from watch motors to ship
# drives, so that no real figure is refused; products of figures inside them stay in the range of floats.
KINDS, RANGES = _kinds()

# figures of parts that may be 0: what a part has none of; any other figure of 0 is unknown, and written ~
MAY_BE_ZERO = frozenset({
    "added_length", "ambient_max", "ambient_min", "axial_play", "backlash", "commutator_segments", "coulomb_friction",
    "current_draw",
    "direction", "friction_torque", "inertia", "load_friction", "mass", "max_axial_load", "max_press_fit",
    "max_radial_load", "no_load_current", "no_load_torque", "phases", "pole_pairs", "price", "price_5", "price_20",
    "list_price", "foreign_price", "radial_load_distance", "stages",
    "thermal_resistance_winding", "viscous_friction", "voltage_drop", "bearing_distance",
})  # fmt: skip

# figures of parts that have an end by what they are
AT_MOST = {"efficiency": 1.0, "max_efficiency": 1.0, "max_duty": 1.0, "direction": 1.0}


def resolved(value: float, kind: str) -> float:
    """A computed figure without what rounding leaves of nothing: 0 below the range of its kind, infinite above it.

    Parameters
    ----------
    value
        The figure [SI].
    kind
        A key of :data:`RANGES`.

    Returns
    -------
    float
        The figure, 0 or infinite [SI].

    Examples
    --------
    >>> resolved(1.394e-35, "energy"), resolved(1.822e20, "resistance"), resolved(50.8, "energy")
    (0.0, inf, 50.8)
    """
    least, most = RANGES[kind]
    return 0.0 if abs(value) < least else math.copysign(math.inf, value) if abs(value) > most else value


def outside(values: Any, kind: str) -> Any:
    """Whether an SI figure of a kind (a float, or an array of them) lies outside its range; 0 and the unknown do not.

    Parameters
    ----------
    values
        The figure, or an array of them [SI].
    kind
        A key of :data:`RANGES`.

    Returns
    -------
    bool or array of bool, in the shape of ``values``.

    Examples
    --------
    >>> [outside(figure, "inertia") for figure in (0.0, 5e-324, 1e-5, 1e300)]
    [False, True, False, True]
    """
    least, most = RANGES[kind]
    size = abs(values)
    return (size > most) | ((size < least) & (size > 0.0))
