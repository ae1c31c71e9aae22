"""Units at the door: user text to SI floats, SI floats to the units of the trade.

The registry is our own (``units.txt``): pint reads ``3,5 mm`` as 35 mm, 60 rpm as 6.28 Hz and N*m as J. What pint makes
of each listed unit is kept in ``units.json``, so that no start waits for it.

May import: errors, version.

One strict reader serves specs, catalogues and the command line. Text never reaches pint unread: a unit
must be listed for its kind of quantity (``kinds.txt``), a figure must lie in the range of its kind. Kinds that
share a dimension stay apart: torque and energy, rotary speed and frequency, temperature and temperature difference.
"""

from __future__ import annotations

import json
import math
import re
from functools import cache, lru_cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.errors import InputError, quoted

if TYPE_CHECKING:
    import pint


__all__ = [
    "KINDS", "Kind", "digits_of", "from_si", "kind_of_unit", "label", "noun", "number", "possible", "registry",
    "resolved", "scale", "show", "show_band", "tabulate", "to_si",
]  # fmt: skip


# -- Kinds of quantities: the name of each, an example, and the units in which it may be written.


class Kind(NamedTuple):
    """A kind of quantity: its name in a sentence, its SI unit, an example, and the units accepted for it."""

    noun: str
    si: str
    example: str
    units: dict[str, str]  # pint expression -> further spellings, separated by blanks


def _kinds() -> tuple[dict[str, Kind], dict[str, tuple[float, float]]]:
    """The kinds and their ranges out of ``kinds.txt``."""
    kinds, ranges = dict[str, Kind](), dict[str, tuple[float, float]]()
    text = re.sub(r"(?m)^#.*\n", "", Path(__file__).with_name("kinds.txt").read_text(encoding="utf-8"))
    for line in re.sub(r"\n +", "; ", text).splitlines():
        head, example, ends, listed = (cell.strip() for cell in line.split("|"))
        name, _, noun = head.partition(": ")
        units = {words[0]: " ".join(words[1:]) for words in (entry.split() for entry in listed.split(";"))}
        kinds[name] = Kind(noun or name.replace("_", " "), next(iter(units)), example, units)
        least, most = map(float, ends.split())
        ranges[name] = least, most
    return kinds, ranges


# A rotor of 5e-324 kg·m² or a torque of 1e300 N·m is a slip of the pen, and behind the door it ends in a division by
# zero or in an unbounded number. The ranges reach some powers of ten beyond what is built, from watch motors to ship
# drives, so that no real figure is refused; products of figures inside them stay in the range of floats.
KINDS, RANGES = _kinds()


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


# -- Cures for numbers that are written in another way: with commas, or as a ratio.


def with_points(text: str) -> str:
    """A number with commas as it is to be written; where they may part thousands, both ways.

    >>> with_points("45,5 kg"), with_points("1.234,5 kg"), with_points("1,234 kg"), with_points("1,234,567 g")
    ('45.5 kg', '1234.5 kg', '1.234 kg, or 1234 kg', '1234567 g')
    """
    whole, _, last = text.rpartition(",")
    if "," in whole or "." in last:
        return text.replace(",", "")
    written = f"{whole.replace('.', '')}.{last}"
    return f"{written}, or {whole}{last}" if "." not in whole and re.match(r"[0-9]{3}(?![0-9])", last) else written


def as_quotient(value: float, rest: str) -> str:
    """A ratio as the one number that is meant; empty for anything else.

    Parameters
    ----------
    value
        The number that its text starts with.
    rest
        What follows it, as the ``:3`` of 1:3.

    Returns
    -------
    str
        The cure.

    Examples
    --------
    >>> as_quotient(1.0, ":3"), as_quotient(1.0, " kg")
    ('write the quotient, 0.333333', '')
    """
    below = re.fullmatch(r"\s*[:/]\s*([0-9]+(?:\.[0-9]*)?)", rest)
    divisor = float(below.group(1)) if below else 0.0
    return f"write the quotient, {value / divisor:g}" if divisor else ""


# -- Text to SI and back: the number is parsed here, its unit must be listed for the kind of quantity.
#
# What a listed unit is in SI comes from the one pint registry (definitions in ``units.txt``) and is kept in
# ``units.json``, so that reading needs no pint.


_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*", re.DOTALL)
_RANGE = re.compile(r"\s*[0-9.]+\s*([^\W\d]*\s*(\.\.|to\b)|[-–])\s*[0-9]")  # 50 kg .. 60 kg, 50 to 60 kg, 50-60 kg
_CHARACTERS = str.maketrans("·⋅×µμ²³¹⁻−′″\u00a0\u202f", "***uu231--'\"  ") | {ord("Ω"): "ohm", 0x2126: "ohm"}


@lru_cache(maxsize=1)
def registry() -> pint.UnitRegistry[Any]:
    """The one pint registry, built from ``units.txt`` on first use."""
    import pint

    with resources.as_file(resources.files("drivesizer.units") / "units.txt") as path:
        return pint.UnitRegistry(path)


def _key(spelling: str) -> str:
    """A unit's spelling with separators and exponents made alike: ``N m``, ``N·m`` -> ``N*m``."""
    text = spelling.translate(_CHARACTERS).replace("°C", "degC").replace("°F", "degF").replace("°", "deg")
    text = re.sub(r"\s*(\*\*|[*/^()])\s*", r"\1", text.strip()).replace("**", "").replace("^", "")
    return re.sub(r"(?<=[A-Za-z])[\s-]+(?=[A-Za-z])", "*", text)


@cache
def _spellings(kind: str) -> dict[str, str]:
    """Every accepted spelling of a kind's units, as keys to the pint expression."""
    units: dict[str, str] = {}
    for unit, others in KINDS[kind].units.items():
        for spelling in (unit, *others.split()):
            key = _key(spelling)
            bare = key.replace("(", "").replace(")", "")
            for variant in (key, bare, key.replace("*", ""), bare.replace("*", "")):
                units.setdefault(variant, unit)
    return units


@cache
def _table() -> dict[str, dict[str, list[float]]]:
    """Factor and offset of every unit by kind: what :func:`tabulate` found, kept so that no start waits for pint."""
    return json.loads((resources.files("drivesizer.units") / "units.json").read_text(encoding="utf-8"))


def tabulate() -> dict[str, dict[str, list[float]]]:
    """Factor and offset to SI of every listed unit, from pint: ``si = number * factor + offset``.

    ``python -m drivesizer.units`` prints it as ``units.json``; a test holds file and pint together.
    """
    ureg, factors = registry(), {}
    for name, kind in KINDS.items():
        factors[name] = {unit: [1.0, 0.0] for unit in kind.units}
        if name.startswith("price"):  # stays in its currency: rates are no units
            continue
        for unit in (u for u in kind.units if u != kind.si):
            step = f"delta_{ureg.get_name(unit)}" if name == "temperature" else unit
            zero = ureg.Quantity(0.0, unit).to(kind.si).magnitude if name == "temperature" else 0.0
            factors[name][unit] = [float(ureg.Quantity(1.0, step).to(kind.si).magnitude), float(zero)]
    return factors


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
        raise InputError(f"{quoted(text)} has a comma in its number; write a decimal point: {with_points(text)}")
    if re.match(r"['’_][0-9]|[0-9]{3}(?![0-9])", rest):
        plain = re.sub(r"(?<=[0-9])['’_\s]+(?=[0-9])", "", text)
        raise InputError(f"{quoted(text)} has a separator in its number; write it without: {plain}")
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

    Returns
    -------
    float
        The quantity [SI unit of the kind].

    Raises
    ------
    InputError
        When number or unit are missing, malformed, of another kind, or outside what exists.

    Examples
    --------
    >>> to_si("142 gcm2", "inertia"), to_si("25 °C", "temperature")
    (1.42e-05, 298.15)
    """
    return _remembered(text, kind) if isinstance(text, str | int | float) else _in_si(text, kind)


def _in_si(text: object, kind: str) -> float:
    expected = KINDS[kind]
    hint = f"expected {noun(kind)}, e.g. {expected.example}"
    if text is None:
        raise InputError(f"is empty; {hint}")
    if isinstance(text, list):
        raise InputError(f"a list is not a quantity; {hint}")
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise InputError(f"{quoted(text)} is not a quantity; {hint}")
    try:
        value, unit = number(text) if isinstance(text, str) else number(repr(text))
    except InputError as error:
        raise InputError(f"{error}; {hint}") from None
    if not unit and expected.si != "1":
        raise InputError(f"{quoted(text)} has no unit; {hint}")
    name = _spellings(kind).get(_key(unit)) if unit else "1"
    if name is None and _RANGE.match(str(text)):
        raise InputError(f"{quoted(text)} is a range; its usual figure goes first, as in 0.02 in 0.015..0.03; {hint}")
    if name is None:
        quotient = as_quotient(value, unit) if expected.si == "1" else ""  # of a ratio, the number that is meant
        raise InputError(f"{quoted(text)}: {quotient or _misfit(unit, kind)}; {hint}")
    factor, offset = _table()[kind][name]
    result = value * factor + offset
    if not math.isfinite(result):
        raise InputError(f"{quoted(text)} is outside the range of numbers that can be computed with; {hint}")
    if kind == "temperature" and result < 0.0:
        raise InputError(f"{quoted(text)} is below absolute zero; {hint}")
    if outside(result, kind):
        raise InputError(f"{quoted(text)} is no {noun(kind)} of a machine; {possible(kind)}")
    return result


_remembered = lru_cache(maxsize=4096, typed=True)(_in_si)  # variants of a spec have most of their figures in common


def possible(kind: str) -> str:
    """Permitted range of a kind of figure, as it stands at the end of a message.

    >>> possible("inertia")
    'expected 1e-15 to 1e+09 kg·m², e.g. 142 g*cm^2'
    """
    least, most = RANGES[kind]
    return f"expected {f'{least:g} to {most:g} {label(KINDS[kind].si)}'.rstrip()}, e.g. {KINDS[kind].example}"


def scale(unit: str, kind: str) -> tuple[float, float]:
    """Factor and offset that bring numbers in a listed unit to SI: ``si = number * factor + offset``.

    Parameters
    ----------
    unit
        A spelling of a unit, such as ``gcm2``.
    kind
        A key of :data:`KINDS`.

    Returns
    -------
    tuple of float
        Factor and offset [SI].

    Raises
    ------
    InputError
        When the unit is not one of the kind's.

    Examples
    --------
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
    key = _key(unit)
    return next((kind for kind in KINDS if key in _spellings(kind)), None)


def noun(kind: str) -> str:
    """A kind's name in a sentence."""
    return KINDS[kind].noun


def from_si(value: Any, unit: str, kind: str) -> Any:
    """An SI value (float or array) in one of the units listed for its kind.

    Parameters
    ----------
    value
        Figure or array [SI].
    unit
        A unit as the kind lists it.
    kind
        A key of :data:`KINDS`.

    Returns
    -------
    float or array, in that unit.

    Examples
    --------
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

    Parameters
    ----------
    value
        Figure [SI]; NaN where unknown.
    unit, kind
        As for :func:`from_si`; from a thousand on the unit with the next prefix is taken, as far as it is usual, and
        below a thousandth, of an inertia, a smaller one; less than a thousandth of a per cent is 0.
    digits
        Significant digits.

    Returns
    -------
    str
        Number and unit as printed.

    Examples
    --------
    >>> show(0.0263, "mN*m", "torque"), show(5.8, "g", "mass"), show(50790.0, "J", "energy")
    ('26.3 mN·m', '5.8 kg', '50.79 kJ')
    >>> show(1.278e-6, "kg*m^2", "inertia"), show(9.422e-4, "kg*m^2", "inertia"), show(0.0263, "kg*m^2", "inertia")
    ('12.78 g·cm²', '9.422 kg·cm²', '0.0263 kg·m²')
    """
    if math.isnan(value):
        return "unknown"
    if math.isinf(value):
        return "unbounded" if value > 0 else "unbounded below"
    number = float(from_si(value, unit, kind)) + 0.0  # without a negative zero
    while abs(number) >= _THOUSAND and unit in _LARGER:
        unit = _LARGER[unit]
        number = float(from_si(value, unit, kind)) + 0.0
    if abs(number) < _THOUSANDTH:
        number = 0.0 if unit == "%" else number
        while 0.0 < abs(number) < 1.0 and unit in _SMALLER:
            unit = _SMALLER[unit]
            number = float(from_si(value, unit, kind)) + 0.0
    return f"{digits_of(number, digits)} {label(unit)}".rstrip()


def digits_of(number: float, digits: int = 4) -> str:
    """A number to some significant digits, without an exponent from a thousandth to a million."""
    text = f"{number:.{digits}g}"
    if "e" in text and 1e-3 <= abs(float(text)) < 1e6:
        return f"{float(text):f}".rstrip("0").rstrip(".")
    return text


def show_band(low: float, high: float, unit: str, kind: str) -> str:
    """Two SI values as text, their unit once where it is the same, and one value where both are printed alike.

    >>> show_band(0.58, 0.91, "g", "mass"), show_band(0.58, 1.2, "g", "mass"), show_band(26.1, 26.2, "kg", "mass")
    ('580 to 910 g', '580 g to 1.2 kg', '26 kg')
    """
    first, last = show(low, unit, kind, 2), show(high, unit, kind, 2)
    behind = " " + last.rpartition(" ")[2]
    return last if first == last else f"{first.removesuffix(behind)} to {last}"


_LARGER = {"g": "kg", "J": "kJ", "kJ": "MJ", "W": "kW", "mN*m": "N*m", "mA": "A", "mV": "V", "N": "kN"}  # next prefix
_SMALLER = {"kg*m^2": "kg*cm^2", "kg*cm^2": "g*cm^2"}
_THOUSAND, _THOUSANDTH = 999.95, 1e-3  # the former is what four digits show as 1000
