"""Units at the door: user text to SI floats, SI floats to the units of the trade.

One strict reader serves specs, catalogues and the command line. Text never reaches pint: the number is parsed
here, and the unit must be one that is listed for the quantity's kind. What a listed unit is in SI comes from the one
pint registry (definitions in ``units.txt``) and is kept in ``units.json``. Kinds that share a dimension stay apart:
torque and energy, rotary speed and frequency, temperature and temperature difference.
"""

from __future__ import annotations

import json
import math
import re
from functools import cache, lru_cache
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.errors import InputError, quoted
from drivesizer.ranges import RANGES, outside

if TYPE_CHECKING:
    import pint

__all__ = [
    "KINDS",
    "Kind",
    "from_si",
    "kind_of_unit",
    "label",
    "noun",
    "number",
    "possible",
    "registry",
    "scale",
    "show",
    "tabulate",
    "to_si",
]


class Kind(NamedTuple):
    """A kind of quantity: its name in a sentence, its SI unit, an example, and the units accepted for it."""

    noun: str
    si: str
    example: str
    units: dict[str, str]  # pint expression -> further spellings, separated by blanks


# kind | example | accepted units, the SI unit first, each followed by its further spellings.
# What follows from a unit by rule is not listed: N*m is also read as N·m, N m, N-m and Nm; m^2 as m2, m² and m**2.
_KINDS = """
length               | 118 mm      | m; mm; cm; um; km; in inch inches "; ft foot feet
mass                 | 45 kg       | kg; g; mg; t; lb lbs; oz
inertia              | 142 g*cm^2  | kg*m^2; g*cm^2; kg*cm^2; g*m^2; g*mm^2; kg*mm^2; lb*in^2; oz*in^2; lb*ft^2
.                    |             | ozf*in*s^2 oz*in*s^2; lbf*in*s^2 lb*in*s^2
torque               | 71 mN*m     | N*m; mN*m; uN*m; kN*m; N*cm; ozf*in oz*in in*oz in*ozf; lbf*in lb*in in*lb in*lbf
.                    |             | lbf*ft lb*ft ft*lb ft*lbf; kgf*cm kg*cm; kgf*m kg*m kp*m; gf*cm g*cm
energy               | 12 W*h      | J; kJ; MJ; mJ; W*h; kW*h; W*s
power                | 20 W        | W; mW; kW; hp HP; PS
force                | 50 N        | N; mN; kN; lbf; ozf; kgf kp; gf
speed                | 1.5 m/s     | m/s; mm/s; cm/s; km/h kmh kph; m/min; mm/min; ft/s fps; ft/min fpm
.                    |             | in/s ips; mi/h mph
rotary_speed         | 3000 rpm    | rad/s; rpm RPM 1/min min-1 r/min rev/min U/min; krpm; deg/s; turn/s rev/s rps
frequency            | 5 Hz        | Hz; kHz; MHz
acceleration         | 0.75 m/s^2  | m/s^2; mm/s^2; cm/s^2; ft/s^2; in/s^2; g_0
angular_acceleration | 10 rad/s^2  | rad/s^2; deg/s^2; rpm/s; turn/s^2 rev/s^2
jerk                 | 5 m/s^3     | m/s^3; mm/s^3
angular_jerk         | 100 rad/s^3 | rad/s^3; deg/s^3; turn/s^3 rev/s^3
area                 | 0.6 m^2     | m^2; cm^2; mm^2; ft^2; in^2
capacitance          | 4.7 mF      | F; mF; uF
time                 | 2 s         | s sec; ms; us; min; h hr; d
voltage              | 24 V        | V; mV; kV
current              | 1.16 A      | A; mA; uA
charge               | 7 A*h       | A*s; A*h; mA*h
resistance           | 2.32 ohm    | ohm Ohm ohms; mohm mOhm; kohm kOhm
inductance           | 0.238 mH    | H; mH; uH
torque_constant      | 23.4 mN*m/A | N*m/A; mN*m/A; N*cm/A; ozf*in/A oz*in/A; lbf*in/A lb*in/A; V*s/rad V*s
.                    |             | V/rpm; mV/rpm; V/krpm
back_emf_constant    | 2.45 mV/rpm | V*s/rad V*s; mV*s/rad mV*s; V/rpm; mV/rpm mV/min-1; V/krpm; N*m/A; mN*m/A
speed_constant       | 408 rpm/V   | rad/s/V rad/(V*s) rad/(s*V); rpm/V 1/min/V min-1/V
speed_torque_gradient | 40.5 rpm/mN*m | rad/s/(N*m); rpm/(mN*m) 1/min/mNm min-1/mNm; rpm/(N*m); rpm/(ozf*in) rpm/oz*in
thermal_resistance   | 3.1 K/W     | K/W degC/W
heat_capacity        | 12 J/K      | J/K
temperature          | 25 degC     | K; degC C; degF F
temperature_difference | 75 K      | K
angle                | 2 deg       | rad; deg; arcmin '; arcsec "; turn rev
density              | 7850 kg/m^3 | kg/m^3; g/cm^3 g/cc; lb/in^3; lb/ft^3
stiffness            | 20 N/mm     | N/m; N/mm; kN/m; lbf/in lb/in
torsional_stiffness  | 1.2 N*m/arcmin | N*m/rad; N*m/deg; N*m/arcmin; mN*m/rad
damping              | 1e-6 N*m*s  | N*m*s/rad N*m*s; mN*m/rpm mNm*min
dimensionless        | 0.02 or 2 % | 1; %
ratio                | 27          | 1
price                | 46.55 EUR   | EUR €
price_chf            | 51.20 CHF   | CHF
"""
_NOUNS = {
    "back_emf_constant": "back-EMF constant",
    "speed_torque_gradient": "speed/torque gradient",
    "dimensionless": "plain number",
    "price": "price in EUR",
    "price_chf": "price in CHF",
}


def _kinds() -> dict[str, Kind]:
    joined = _KINDS.replace("\n.                    |             |", ";")
    found = {}
    for line in joined.strip().splitlines():
        name, example, listed = (cell.strip() for cell in line.split("|"))
        units = {words[0]: " ".join(words[1:]) for words in (entry.split() for entry in listed.split(";"))}
        found[name] = Kind(_NOUNS.get(name, name.replace("_", " ")), next(iter(units)), example, units)
    return found


KINDS: dict[str, Kind] = _kinds()

_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)
_CHARACTERS = str.maketrans("·⋅×µμ²³¹⁻−′″\u00a0\u202f", "***uu231--'\"  ") | {ord("Ω"): "ohm", 0x2126: "ohm"}


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
def _table() -> dict[str, dict[str, list[float]]]:
    """Factor and offset of every unit by kind: what :func:`tabulate` found, kept so that no start waits for pint."""
    found: dict[str, dict[str, list[float]]] = json.loads(
        (resources.files("drivesizer") / "units.json").read_text(encoding="utf-8")
    )
    return found


def tabulate() -> dict[str, dict[str, list[float]]]:
    """Factor and offset to SI of every listed unit, from pint: ``si = number * factor + offset``.

    ``python -m drivesizer.units`` prints it as ``units.json``; a test holds file and pint together.
    """
    ureg, found = registry(), {}
    for name, kind in KINDS.items():
        found[name] = {unit: [1.0, 0.0] for unit in kind.units}
        for unit in (u for u in kind.units if u != kind.si):
            step = f"delta_{ureg.get_name(unit)}" if name == "temperature" else unit
            zero = ureg.Quantity(0.0, unit).to(kind.si).magnitude if name == "temperature" else 0.0
            found[name][unit] = [float(ureg.Quantity(1.0, step).to(kind.si).magnitude), float(zero)]
    return found


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
    if not unit and expected.si != "1":
        raise InputError(f"{quoted(text)} has no unit; {hint}")
    name = _spellings(kind).get(_key(unit)) if unit else "1"
    if name is None:
        raise InputError(f"{quoted(text)}: {_misfit(unit, kind)}; {hint}")
    factor, offset = _table()[kind][name]
    result = value * factor + offset
    if not math.isfinite(result):
        raise InputError(f"{quoted(text)} is outside the range of numbers that can be computed with; {hint}")
    if kind == "temperature" and result < 0.0:
        raise InputError(f"{quoted(text)} is below absolute zero; {hint}")
    if outside(result, kind):
        raise InputError(f"{quoted(text)} is no {noun(kind)} of a machine; {possible(kind)}")
    return result


def possible(kind: str) -> str:
    """What a figure of a kind can be, as it stands at the end of a message.

    >>> possible("inertia")
    'expected 1e-15 to 1e+09 kg·m², e.g. 142 g*cm^2'
    """
    least, most = RANGES[kind]
    return f"expected {f'{least:g} to {most:g} {label(KINDS[kind].si)}'.rstrip()}, e.g. {KINDS[kind].example}"


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
        raise InputError(_misfit(unit, kind))
    factor, offset = _table()[kind][name]
    return factor, offset


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
    return KINDS[kind].noun


def from_si(value: Any, unit: str, kind: str) -> Any:
    """An SI value (float or array) in one of the units listed for its kind.

    >>> from_si(1.0, "rpm", "rotary_speed")
    9.549296585513721
    """
    factor, offset = _table()[kind][unit]
    return (value - offset) / factor


def label(unit: str) -> str:
    """A unit as it is printed: ``N*m`` -> ``N·m``, ``degC`` -> ``°C``."""
    if unit == "1":
        return ""
    pretty = unit.replace("*", "·").replace("degC", "°C").replace("deg", "°").replace("ohm", "Ω")
    pretty = pretty.replace("ozf·in", "oz·in").replace("^2", "²").replace("^3", "³")
    return re.sub(r"\bu(?=[A-Za-z])", "µ", pretty)


def show(value: float, unit: str, kind: str, digits: int = 4) -> str:
    """An SI value as text in a unit of the trade, or ``unknown``.

    >>> show(0.0263, "mN*m", "torque")
    '26.3 mN·m'
    """
    if math.isnan(value):
        return "unknown"
    if math.isinf(value):
        return "without end" if value > 0 else "minus without end"
    text = f"{from_si(value, unit, kind):.{digits}g}"
    if "e" in text and abs(float(text)) < 1e6:
        text = f"{float(text):f}".rstrip("0").rstrip(".") if abs(float(text)) >= 1e-3 else text
    return f"{text} {label(unit)}".rstrip()


if __name__ == "__main__":
    lines = (f"{json.dumps(kind)}: {json.dumps(units)}" for kind, units in tabulate().items())
    print("{\n" + ",\n".join(lines) + "\n}")
