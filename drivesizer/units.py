"""Units at the door: user text to SI floats, SI floats to the units of the trade.

One strict reader serves specs, catalogues and the command line. Text never reaches pint unread: the number
is parsed here, the unit must be one that is listed for the quantity's kind, and only its listed name is
handed to the one pint registry (definitions in ``units.txt``). Kinds that share a dimension stay apart:
torque and energy, rotary speed and frequency, temperature and temperature difference.
"""

from __future__ import annotations

import math
import re
from functools import cache, lru_cache
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.errors import InputError, quoted

if TYPE_CHECKING:
    import pint

__all__ = ["KINDS", "Kind", "from_si", "kind_of_unit", "label", "noun", "number", "registry", "scale", "show", "to_si"]


class Kind(NamedTuple):
    """A kind of quantity: its SI unit, an example for messages, and the units accepted for it."""

    si: str
    example: str
    units: dict[str, str]  # pint expression -> further spellings, separated by blanks
    noun: str = ""


_PREFIXED_TORQUE = {
    "N*m": "", "mN*m": "", "uN*m": "", "kN*m": "", "N*cm": "", "ozf*in": "oz*in ozin in*oz in*ozf",
    "lbf*in": "lb*in in*lb in*lbf lbin", "lbf*ft": "lb*ft ft*lb ft*lbf lbft",
    "kgf*cm": "kg*cm kgcm", "kgf*m": "kg*m kgm kp*m kpm", "gf*cm": "g*cm gcm",
}  # fmt: skip

KINDS: dict[str, Kind] = {
    "length": Kind("m", "118 mm", {"m": "", "mm": "", "cm": "", "um": "", "km": "", "in": "inch inches \"", "ft": "foot feet"}),
    "mass": Kind("kg", "45 kg", {"kg": "", "g": "", "mg": "", "t": "", "lb": "lbs", "oz": ""}),
    "inertia": Kind("kg*m^2", "142 g*cm^2", {
        "kg*m^2": "", "g*cm^2": "", "kg*cm^2": "", "g*m^2": "", "g*mm^2": "", "kg*mm^2": "",
        "lb*in^2": "lbin2", "oz*in^2": "ozin2", "lb*ft^2": "lbft2", "ozf*in*s^2": "oz*in*s^2 oz*in*s2 ozins2",
        "lbf*in*s^2": "lb*in*s^2 lbins2"}),
    "torque": Kind("N*m", "71 mN*m", _PREFIXED_TORQUE),
    "energy": Kind("J", "12 W*h", {"J": "", "kJ": "", "MJ": "", "mJ": "", "W*h": "", "kW*h": "", "W*s": ""}),
    "power": Kind("W", "20 W", {"W": "", "mW": "", "kW": "", "hp": "HP", "PS": ""}),
    "force": Kind("N", "50 N", {"N": "", "mN": "", "kN": "", "lbf": "", "ozf": "", "kgf": "kp", "gf": ""}),
    "speed": Kind("m/s", "1.5 m/s", {
        "m/s": "", "mm/s": "", "cm/s": "", "km/h": "kmh kph", "m/min": "", "mm/min": "", "ft/s": "fps",
        "ft/min": "fpm", "in/s": "ips", "mi/h": "mph"}),
    "rotary_speed": Kind("rad/s", "3000 rpm", {
        "rad/s": "", "rpm": "RPM 1/min min-1 r/min rev/min U/min", "krpm": "", "deg/s": "", "turn/s": "rev/s rps"}, "rotary speed"),
    "frequency": Kind("Hz", "5 Hz", {"Hz": "", "kHz": "", "MHz": ""}),
    "acceleration": Kind("m/s^2", "0.75 m/s^2", {"m/s^2": "", "mm/s^2": "", "cm/s^2": "", "ft/s^2": "", "in/s^2": "", "g_0": ""}),
    "angular_acceleration": Kind("rad/s^2", "10 rad/s^2", {"rad/s^2": "", "deg/s^2": "", "rpm/s": "", "turn/s^2": "rev/s2"}, "angular acceleration"),
    "jerk": Kind("m/s^3", "5 m/s^3", {"m/s^3": "", "mm/s^3": ""}),
    "time": Kind("s", "2 s", {"s": "sec", "ms": "", "us": "", "min": "", "h": "hr", "d": ""}),
    "voltage": Kind("V", "24 V", {"V": "", "mV": "", "kV": ""}),
    "current": Kind("A", "1.16 A", {"A": "", "mA": "", "uA": ""}),
    "charge": Kind("A*s", "7 A*h", {"A*s": "", "A*h": "", "mA*h": ""}),
    "resistance": Kind("ohm", "2.32 ohm", {"ohm": "Ohm ohms", "mohm": "mOhm", "kohm": "kOhm"}),
    "inductance": Kind("H", "0.238 mH", {"H": "", "mH": "", "uH": ""}),
    "torque_constant": Kind("N*m/A", "23.4 mN*m/A", {
        "N*m/A": "", "mN*m/A": "", "N*cm/A": "", "ozf*in/A": "oz*in/A ozin/A", "lbf*in/A": "lb*in/A",
        "V*s/rad": "V*s", "V/rpm": "", "mV/rpm": "", "V/krpm": ""}, "torque constant"),
    "speed_constant": Kind("rad/s/V", "408 rpm/V", {"rad/s/V": "rad/(V*s) rad/(s*V)", "rpm/V": "1/min/V min-1/V"}, "speed constant"),
    "gradient": Kind("rad/s/(N*m)", "40.5 rpm/mN*m", {
        "rad/s/(N*m)": "", "rpm/(mN*m)": "1/min/mNm min-1/mNm", "rpm/(N*m)": "", "rpm/(ozf*in)": "rpm/oz*in rpm/ozin"}, "speed/torque gradient"),
    "thermal_resistance": Kind("K/W", "3.1 K/W", {"K/W": "degC/W"}, "thermal resistance"),
    "heat_capacity": Kind("J/K", "12 J/K", {"J/K": ""}, "heat capacity"),
    "temperature": Kind("K", "25 degC", {"K": "", "degC": "C", "degF": "F"}),
    "temperature_difference": Kind("K", "75 K", {"K": ""}, "temperature difference"),
    "angle": Kind("rad", "2 deg", {"rad": "", "deg": "", "arcmin": "'", "arcsec": "\"", "turn": "rev"}),
    "density": Kind("kg/m^3", "7850 kg/m^3", {"kg/m^3": "", "g/cm^3": "g/cc", "lb/in^3": "", "lb/ft^3": ""}),
    "stiffness": Kind("N/m", "20 N/mm", {"N/m": "", "N/mm": "", "kN/m": "", "lbf/in": "lb/in"}),
    "torsional_stiffness": Kind("N*m/rad", "1.2 N*m/arcmin", {"N*m/rad": "", "N*m/deg": "", "N*m/arcmin": "", "mN*m/rad": ""}, "torsional stiffness"),
    "damping": Kind("N*m*s/rad", "1e-6 N*m*s", {"N*m*s/rad": "N*m*s Nms", "mN*m/rpm": "mNm*min"}),
    "dimensionless": Kind("1", "0.02 or 2 %", {"1": "", "%": ""}, "plain number"),
    "price": Kind("EUR", "46.55 EUR", {"EUR": "€"}, "price in EUR"),
    "price_chf": Kind("CHF", "51.20 CHF", {"CHF": ""}, "price in CHF"),
}  # fmt: skip

_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)
_CHARACTERS = str.maketrans(
    {"·": "*", "⋅": "*", "×": "*", "µ": "u", "μ": "u", "Ω": "ohm", "\u2126": "ohm", "²": "2", "³": "3", "−": "-",
     "\u00a0": " ", "\u202f": " ", "⁻": "-", "¹": "1", "′": "'", "″": '"'}  # fmt: skip
)


@lru_cache(maxsize=1)
def registry() -> pint.UnitRegistry[Any]:
    """The one pint registry, built from ``units.txt`` on first use."""
    import pint

    with resources.as_file(resources.files("drivesizer") / "units.txt") as path:
        return pint.UnitRegistry(path)


def _key(spelling: str) -> str:
    """A unit's spelling with separators and exponents made alike: ``N m``, ``N·m`` -> ``N*m``."""
    text = spelling.translate(_CHARACTERS).replace("°C", "degC").replace("°F", "degF").replace("°", "deg")
    text = re.sub(r"\s*(\*\*|[*/^()])\s*", r"\1", text.strip()).replace("**", "").replace("^", "")
    return re.sub(r"(?<=[A-Za-z])[\s-]+(?=[A-Za-z])", "*", text)


@cache
def _spellings(kind: str) -> dict[str, str]:
    """Every accepted spelling of a kind's units, as keys to the pint expression."""
    found: dict[str, str] = {}
    for unit, others in KINDS[kind].units.items():
        for spelling in (unit, *others.split()):
            key = _key(spelling)
            bare = key.replace("(", "").replace(")", "")
            for variant in (key, bare, key.replace("*", ""), bare.replace("*", "")):
                found.setdefault(variant, unit)
    return found


@cache
def _factor(unit: str, si: str) -> float:
    if unit == si:
        return 1.0
    return float(registry().Quantity(1.0, unit).to(si).magnitude)


def number(text: str) -> tuple[float, str]:
    """The number that a text starts with and the rest, read strictly.

    Raises
    ------
    InputError
        When there is no number, a decimal comma, or a value that a float cannot hold.

    >>> number("142 gcm2")
    (142.0, 'gcm2')
    """
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise InputError(f"{quoted(text)} does not start with a number")
    digits, rest = match.groups()
    if re.match(r",[0-9]", rest):
        raise InputError(f"{quoted(text)} has a comma in its number; write a decimal point")
    value = float(digits)
    if not math.isfinite(value) or (value == 0.0 and re.search(r"[1-9]", re.split("[eE]", digits)[0])):
        raise InputError(f"{quoted(text)} is outside the range of numbers that can be computed with")
    return value, rest


def to_si(text: object, kind: str) -> float:
    """A quantity given as text, in the SI unit of its kind.

    Parameters
    ----------
    text
        Number and unit, such as ``"16 oz-in"``; a plain number only where the kind is dimensionless.
    kind
        A key of :data:`KINDS`.

    Raises
    ------
    InputError
        When number or unit are missing, malformed, of another kind, or outside what exists.

    Examples
    --------
    >>> to_si("142 gcm2", "inertia"), to_si("25 °C", "temperature")
    (1.42e-05, 298.15)
    """
    expected = KINDS[kind]
    hint = f"expected {noun(kind)}, e.g. {expected.example}"
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise InputError(f"{quoted(text)} is not a quantity; {hint}")
    try:
        value, unit = number(text) if isinstance(text, str) else number(repr(text))
    except InputError as error:
        raise InputError(f"{error}; {hint}") from None
    if not unit and kind != "dimensionless":
        raise InputError(f"{quoted(text)} has no unit; {hint}")
    name = _spellings(kind).get(_key(unit)) if unit else "1"
    if name is None:
        raise InputError(f"{quoted(text)}: {_misfit(unit, kind)}; {hint}")
    if kind == "temperature":
        return _kelvin(value, name, text)
    result = value * _factor(name, expected.si)
    if not math.isfinite(result):
        raise InputError(f"{quoted(text)} is outside the range of numbers that can be computed with; {hint}")
    return result


def scale(unit: str, kind: str) -> tuple[float, float]:
    """Factor and offset that bring numbers in a listed unit to SI: ``si = number * factor + offset``.

    Raises
    ------
    InputError
        When the unit is not one of the kind's.

    >>> scale("gcm2", "inertia")
    (1e-07, 0.0)
    """
    name = _spellings(kind).get(_key(unit))
    if name is None:
        raise InputError(f"{_misfit(unit, kind)}; expected one such as in {KINDS[kind].example}")
    if kind == "temperature":
        zero = float(registry().Quantity(0.0, name).to("K").magnitude)
        return _factor(f"delta_{registry().get_name(name)}" if zero else name, "K"), zero
    return _factor(name, KINDS[kind].si), 0.0


def _kelvin(value: float, unit: str, text: object) -> float:
    kelvin = float(registry().Quantity(value, unit).to("K").magnitude)
    if not kelvin >= 0.0:
        raise InputError(f"{quoted(text)} is below absolute zero; expected temperature, e.g. 25 degC")
    return kelvin


def _misfit(unit: str, kind: str) -> str:
    other = kind_of_unit(unit)
    if other is None or other == kind:
        return f"{quoted(unit)} is not a unit of {noun(kind)}"
    return f"{quoted(unit)} is a unit of {noun(other)}, not of {noun(kind)}"


def kind_of_unit(unit: str) -> str | None:
    """The first kind that lists a unit, or None."""
    return next((kind for kind in KINDS if _key(unit) in _spellings(kind)), None)


def noun(kind: str) -> str:
    """A kind's name in a sentence."""
    return KINDS[kind].noun or kind


def from_si(value: Any, unit: str, kind: str) -> Any:
    """An SI value (float or array) in one of the units listed for its kind.

    >>> from_si(1.0, "rpm", "rotary_speed")
    9.549296585513721
    """
    if kind == "temperature" and unit != "K":
        return registry().Quantity(value, "K").to(unit).magnitude
    return value / _factor(unit, KINDS[kind].si)


def label(unit: str) -> str:
    """A unit as it is printed: ``N*m`` -> ``N·m``, ``degC`` -> ``°C``."""
    if unit == "1":
        return ""
    pretty = unit.replace("*", "·").replace("degC", "°C").replace("deg", "°").replace("ohm", "Ω")
    pretty = pretty.replace("ozf·in", "oz·in").replace("(", "").replace(")", "").replace("^2", "²").replace("^3", "³")
    return re.sub(r"\bu(?=[A-Za-z])", "µ", pretty)


def show(value: float, unit: str, kind: str, digits: int = 4) -> str:
    """An SI value as text in a unit of the trade, or ``unknown``.

    >>> show(0.0263, "mN*m", "torque")
    '26.3 mN·m'
    """
    if math.isnan(value):
        return "unknown"
    text = f"{from_si(value, unit, kind):.{digits}g}"
    if "e" in text and abs(float(text)) < 1e6:
        text = f"{float(text):f}".rstrip("0").rstrip(".") if abs(float(text)) >= 1e-3 else text
    return f"{text} {label(unit)}".rstrip()
