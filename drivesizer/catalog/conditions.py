"""Conditions on columns of the catalogue as one types them: ``--voltage '24 V'``, ``max_speed>=8000 rpm``.

An unknown figure neither meets a condition nor fails it.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import PARTS, Column, columns_of
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.units import to_si

_SIGNS: dict[str, Callable[[Any, Any], Any]] = {
    "<=": operator.le, ">=": operator.ge, "!=": operator.ne, "==": operator.eq, "<": operator.lt, ">": operator.gt,
    "=": operator.eq,
}  # fmt: skip
_CONDITION = re.compile(r"\s*([A-Za-z][\w -]*?)\s*(<=|>=|!=|==|<|>|=)\s*(.*?)\s*", re.DOTALL)
_OPTION = re.compile(r"\s*(<=|>=|!=|==|<|>|=)?\s*(.*?)\s*", re.DOTALL)

# Options of the command line: the column that each tests in a section. A controller serves a range of voltages.
OPTIONS: dict[str, dict[str, str]] = {
    "family": dict.fromkeys(PARTS, "family"),
    "voltage": {"motors": "nominal_voltage", "controllers": "supply_min supply_max", "actuators": "nominal_voltage",
     "brakes": "supply", "batteries": "nominal_voltage", "power_supplies": "nominal_voltage",
     "brake_resistors": "chopper_voltage_min chopper_voltage_max"},
    "diameter": dict.fromkeys(("motors", "gearheads", "encoders", "actuators", "screws"), "diameter"),
    "power": {"motors": "assigned_power", "gearheads": "continuous_power", "brake_resistors": "power"},
    "kind": {"motors": "kind", "gearheads": "kind", "encoders": "kind", "controllers": "drives", "actuators": "gearing",
     "steppers": "wiring", "belts": "profile", "pulleys": "profile", "screws": "kind", "batteries": "chemistry",
     "brakes": "family", "power_supplies": "kind", "brake_resistors": "kind"},
}  # fmt: skip


class Condition(NamedTuple):
    """Condition on a column: a figure in SI, or a text in which ``*`` matches anything."""

    column: Column
    sign: str
    value: float | str

    def met(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Mask of a column's values that meet the condition; an unknown one does not."""
        if isinstance(self.value, str):
            pattern = re.compile(re.escape(self.value).replace(r"\*", ".*"), re.IGNORECASE | re.DOTALL)
            both = "both" if self.column.name == "drives" else None
            same = np.array([bool(pattern.fullmatch(v)) or v == both for v in values.tolist()], bool)
            return same if self.sign in ("=", "==") else np.asarray(~same & (values != ""), bool)
        near: NDArray[np.bool_] = np.isclose(values, self.value, rtol=1e-9, atol=0.0)
        if self.sign in ("=", "=="):
            return near
        found: NDArray[np.bool_] = _SIGNS[self.sign](values, self.value) & ~np.isnan(values)
        return found | near if self.sign in ("<=", ">=") else found & ~near

    def unknown(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Mask of a column's values that are not known."""
        return np.asarray(values == "" if isinstance(self.value, str) else np.isnan(values), bool)


def where(section: str, text: str) -> Condition:
    """A condition such as ``max_speed>=8000 rpm`` on a section's column."""
    match = _CONDITION.fullmatch(text)
    if match is None:
        raise InputError(f"--where: {quoted(text)} is not a condition; expected e.g. 'max_speed>=8000 rpm'")
    return _condition(section, column_name(match[1]), match[2], match[3], "--where")


def name_of(text: str) -> str:
    """The column that a condition names; empty when it is none."""
    match = _CONDITION.fullmatch(text)
    return column_name(match[1]) if match else ""


def column_name(text: str) -> str:
    """Name of a column that a user wrote with blanks or hyphens."""
    return re.sub(r"[ -]+", "_", text.strip())


def has(section: str, given: Iterable[str], sort: str = "") -> bool:
    """Whether a section has all columns that conditions and sorting name."""
    names = {column_name(sort.removeprefix("-")), *map(name_of, given)} - {""}
    return names <= set(columns_of(section))


def option(section: str, name: str, text: str) -> list[Condition] | None:
    """The conditions of an option such as ``--diameter '<=26 mm'``; None where the section has no such figure."""
    if section not in OPTIONS[name]:
        return None
    match = _OPTION.fullmatch(text)
    sign, value = (match[1] or "=", match[2]) if match else ("=", text)
    columns = OPTIONS[name][section].split()
    if len(columns) == 1:
        return [_condition(section, columns[0], sign, value, f"--{name}")]
    signs = {"=": ("<=", ">="), "==": ("<=", ">=")}.get(sign, (sign, ""))
    if sign.startswith(">"):
        signs = ("", sign)
    return [_condition(section, c, s, value, f"--{name}") for c, s in zip(columns, signs, strict=True) if s]


def _condition(section: str, name: str, sign: str, text: str, said: str) -> Condition:
    columns = columns_of(section)
    if name not in columns:
        raise InputError(f"{said}: {section} have no column {quoted(name)}; expected e.g. mass{nearest(name, columns)}")
    column = columns[name]
    if column.kind == "text":
        if sign not in ("=", "==", "!=") or not text:
            raise InputError(f"{said}: {name} is text; expected = or != and a text, in which * matches anything")
        return Condition(column, sign, text)
    try:
        return Condition(column, sign, to_si(text, column.kind))
    except InputError as error:
        raise InputError(f"{said}: {name}: {error}") from None


def conditions(section: str, options: Mapping[str, str | None], given: Sequence[str]) -> list[Condition] | None:
    """All conditions on a section; None when it lacks a figure that an option names."""
    found: list[Condition] = []
    for name, text in options.items():
        more = [] if text is None else option(section, name, text)
        if more is None:
            return None
        found += more
    return found + [where(section, text) for text in given]
