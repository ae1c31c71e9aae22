"""Equations between the figures of one part: one table for the check and for the reader.

The check solves an equation for the figure that it compares with the printed one; the reader solves it for a figure
that a data sheet leaves out, and notes what that rests on. An equation is linear in every figure that it is solved for.

>>> figures = {"nominal_voltage": 12.0, "stall_current": 85.0, "resistance": float("nan")}
>>> round(float(solved("stall_current * resistance = nominal_voltage", figures, "resistance")), 4)
0.1412
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from types import CodeType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.tables import Catalog, Note, Table
from drivesizer.physics.drive_train import ELECTRONICS

__all__ = ["DERIVED", "IDENTITIES", "as_printed", "derived", "solved"]

Array = NDArray[np.float64]

# k_e: the back-EMF constant; k_t where none is printed. Torques of actuators are at the output, friction taken off
IDENTITIES: dict[str, dict[str, str]] = {
    "motors": {
        "speed constant": "speed_constant * k_e = 1",
        "back-EMF constant": "back_emf_constant = torque_constant",
        "stall current": "stall_current * resistance = nominal_voltage",
        "stall torque": "stall_torque = torque_constant * stall_current",
        "speed-torque gradient": "speed_torque_gradient * torque_constant * k_e = resistance",
        "mechanical time constant": "mechanical_time_constant * torque_constant * k_e = rotor_inertia * resistance",
        "no-load speed": "no_load_speed * k_e = nominal_voltage - no_load_current * resistance",
        "friction": "torque_constant * no_load_current = friction_torque + viscous_friction * no_load_speed",
        "nominal torque of brushed motors": "nominal_torque = torque_constant * (nominal_current - no_load_current)",
        "nominal speed": "nominal_speed = no_load_speed - speed_torque_gradient * nominal_torque",
        "speed that it reaches": "max_speed = no_load_speed",
        "maximum efficiency": "max_efficiency = (1 - (no_load_current * resistance / nominal_voltage) ** 0.5) ** 2",
    },
    "actuators": {
        "stall current": "stall_current * resistance = nominal_voltage",
        "stall torque at the output": "stall_torque = torque_constant * (stall_current - no_load_current)",
        "stall torque": "stall_torque = ratio * efficiency * motor_torque_constant * (stall_current - no_load_current)",
        "efficiency": "torque_constant * no_load_speed = efficiency * (nominal_voltage - no_load_current * resistance)",
        "no-load speed":
            "no_load_speed * ratio * motor_torque_constant = nominal_voltage - no_load_current * resistance",
    },
}  # fmt: skip


class Derived(NamedTuple):
    """A figure that the reader solves an identity for, with what is assumed thereby."""

    section: str
    figure: str
    identity: str
    assumed: str


_NO_LIMIT = (
    "assumed: the stall current is the winding's; where a controller or a warm winding set it, R is up to 40 % high"
)
_GROSS = (
    "assumed: the stall torque is the winding's, I_0 not taken off; with it taken off k_t is I_A / (I_A - I_0) of this"
)
_NET = "assumed: the stall torque is what the output gives, I_0 taken off, and the current is no controller's limit"
_ONE_CONSTANT = "assumed: k_t = k_e"

# in the order in which they are tried; a figure that is known by then stays
DERIVED: tuple[Derived, ...] = tuple(
    Derived(*line)
    for line in (
        (
            "motors",
            "max_speed",
            "speed that it reaches",
            "nobody prints more of such a motor, and this speed it reaches",
        ),
        ("motors", "resistance", "stall current", _NO_LIMIT),
        ("motors", "torque_constant", "stall torque", _GROSS),
        ("motors", "torque_constant", "back-EMF constant", _ONE_CONSTANT),
        ("motors", "torque_constant", "speed constant", _ONE_CONSTANT),
        ("motors", "torque_constant", "no-load speed", _ONE_CONSTANT),
        ("motors", "resistance", "speed-torque gradient", ""),
        ("motors", "no_load_speed", "no-load speed", ""),
        ("motors", "no_load_current", "friction", ""),
        ("motors", "no_load_current", "nominal torque of brushed motors", ""),
        ("motors", "nominal_current", "nominal torque of brushed motors", ""),
        ("motors", "nominal_torque", "nominal torque of brushed motors", ""),
        ("motors", "rotor_inertia", "mechanical time constant", ""),
        ("actuators", "resistance", "stall current", _NO_LIMIT),
        ("actuators", "motor_torque_constant", "no-load speed", _ONE_CONSTANT),
        ("actuators", "torque_constant", "stall torque at the output", _NET),
        ("actuators", "efficiency", "stall torque", _NET),
        ("actuators", "efficiency", "efficiency", _NET),
    )
)
_BRUSHED = "nominal torque of brushed motors"
_INSTEAD = {  # figures of actuators that give the same
    "efficiency": "load_friction", "torque_constant": "motor_torque_constant",
    "motor_torque_constant": "torque_constant",
}  # fmt: skip
_MOST_EFFICIENT = 0.95  # a stall point that makes more is of another voltage or a limit of the gears


def solved(equation: str, figures: Mapping[str, Any], unknown: str) -> Array:
    """The figure that fulfils an equation in which it is linear."""
    code = _residual(equation)
    with np.errstate(all="ignore"):
        at_0, at_1 = (_value(code, {**_equation_figures(code, figures), unknown: value}) for value in (0.0, 1.0))
        return np.asarray(at_0 / (at_0 - at_1))


@cache
def _residual(equation: str) -> CodeType:
    left, right = equation.split(" = ")
    return compile(f"({left}) - ({right})", equation, "eval")


def _equation_figures(code: CodeType, figures: Mapping[str, Any]) -> dict[str, Any]:
    """The figures that an equation names."""
    names = {
        name
        for each in code.co_names
        for name in (("back_emf_constant", "torque_constant") if each == "k_e" else (each,))
    }
    return {name: figures[name] for name in names}


def _value(code: CodeType, figures: dict[str, Any]) -> Any:
    if "k_e" in code.co_names:
        own, k_t = figures["back_emf_constant"], figures["torque_constant"]
        figures["k_e"] = np.where(np.isnan(own), k_t, own)
    return eval(code, {"__builtins__": {}}, figures)  # noqa: S307  of this table


def derived(tables: Mapping[str, Table[Any]]) -> list[Note]:
    """Fill in what follows from other figures of a part, and note what it rests on."""
    notes: dict[Derived, list[str]] = {}
    for one in DERIVED * 2:  # once more with what was found
        table = tables[one.section]
        if not len(table) or not (lacking := np.isnan(table[one.figure])).any():
            continue
        values = solved(IDENTITIES[one.section][one.identity], table.columns, one.figure)
        rows = np.flatnonzero(
            lacking & _applies(table, one) & np.isfinite(values) & (values > 0.0) & _possible(one, values)
        )
        table[one.figure][rows] = values[rows]
        if len(rows):
            notes.setdefault(one, []).extend(table["part"][rows].tolist())
    return [_note(one, parts) for one, parts in notes.items()]


def _applies(table: Table[Any], one: Derived) -> Any:
    """Whether the identity is one of the part: what a controller inside limits is not the winding's."""
    if one.section == "actuators":
        own = (table["kind"] == "brushed") | (table["controller"] == "")
        return own & np.isnan(table[_INSTEAD[one.figure]]) if one.figure in _INSTEAD else own
    own = table["commutation"] != ELECTRONICS
    if one.figure == "max_speed":  # of those that are known by their points at stall and without load
        return own & np.isnan(table["torque_constant"]) & ~np.isnan(table["stall_torque"] + table["stall_current"])
    return own & (table["kind"] == "brushed") if one.identity == _BRUSHED else own


def _possible(one: Derived, values: Array) -> Any:
    return values < _MOST_EFFICIENT if one.figure == "efficiency" else True


def _note(one: Derived, parts: list[str]) -> Note:
    text = f"follows from {IDENTITIES[one.section][one.identity]}" + (f"; {one.assumed}" if one.assumed else "")
    return Note(one.section, tuple(parts), (one.figure,), text, "derived", derived=True)


def as_printed(catalog: Catalog) -> Catalog:
    """A catalogue without what the reader derived: the same where that is nothing."""
    tables: dict[str, dict[str, Array]] = {}
    for note in catalog.notes:
        if note.derived:
            table, (name,) = catalog.table(note.section), note.fields
            columns = tables.setdefault(note.section, dict(table.columns))
            columns[name] = columns[name].copy()
            columns[name][np.isin(table["part"], note.parts)] = np.nan
    if not tables:
        return catalog
    printed: dict[str, Any] = {name: replace(catalog.table(name), columns=found) for name, found in tables.items()}
    return replace(catalog, **printed, notes=tuple(note for note in catalog.notes if not note.derived))
