"""Tolerance class of a part's figure: the spec's, else its maker's, else the default one.

Drives of several makers are compared in one sizing, so a class may be of one maker's parts alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from drivesizer.catalog import DIRECT, Catalog
from drivesizer.catalog.estimates.assumed import MOUNTED
from drivesizer.catalog.maker_tolerances import MakerTolerance, maker_tolerances_of, owner_of
from drivesizer.catalog.tables import ESTIMATED, Table
from drivesizer.catalog.tolerances.classes import (
    CLASSES,
    NOT_OF_STEPPERS,
    OF_STEPPERS,
    Class,
    class_from_stall,
    class_of,
    classes,
    losses_from_stall,
)
from drivesizer.catalog.tolerances.distributions import Distribution
from drivesizer.catalog.view.stepper_view import STEPPER, has_steppers

__all__ = ["holding", "holding_of_a_set", "used"]

_SECTIONS = {"motor": "motors", "gearhead": "gearheads", "controller": "controllers"}
Given = Mapping[tuple[str, str], str]


def holding(catalog: Catalog, given: Given, part: str, row: int) -> tuple[Class, ...]:
    """The classes of one part's figures, one a figure; none without the part, or of a controller inside an actuator."""
    table = catalog.table(_SECTIONS[part])
    if row < 0 or table["part"][row] == DIRECT or (part == "controller" and table["inside"][row] != ""):
        return ()
    stated = maker_tolerances_of(catalog.tolerances, part, str(table["manufacturer"][row]), str(table["family"][row]))
    found = []
    for default in classes(given):
        if default.part == part and _concerns(catalog, part, row, default.figure):
            mine = stated.get(default.figure)
            if (part, default.figure) in given:
                found.append(default)
            else:
                own = _of_a_maker(catalog, mine) if mine else _of_stall(catalog, part, row, default.figure)
                found.append(_of_peers(catalog, default, part, row) or own or default)
    return tuple(found)


def _concerns(catalog: Catalog, part: str, row: int, figure: str) -> bool:
    """Whether a part has the figure of a class: not a dry share where both frictions are known, nor a printed peak."""
    if (part, figure) in (NOT_OF_STEPPERS if has_steppers(catalog) else OF_STEPPERS):
        return False
    table = catalog.table(_SECTIONS[part])
    if figure in _OF_THE_MODEL:
        return bool(table[STEPPER][row] not in catalog.pull_outs.stepper)
    if figure == "dry_friction":
        printed = [table[name][row] for name in ("friction_torque", "viscous_friction")]
        return bool(table["kind"][row] != "brushed" and all(value != value for value in printed))
    if figure == "peak_torque":
        one = _sold_as(catalog, part, row)
        return bool(one and one.table["peak_torque"][one.row] == one.table["stall_torque"][one.row])
    return True


class _Sold(NamedTuple):
    """A part as its catalogue has it."""

    section: str
    table: Table[Any]
    row: int


def _sold_as(catalog: Catalog, part: str, row: int) -> _Sold | None:
    """The actuator that a part is inside of; None of a part of its own."""
    inside = str(catalog.table(_SECTIONS[part])["inside"][row])
    return _Sold("actuators", catalog.actuators, catalog.actuators.rows[inside]) if inside else None


def _of_stall(catalog: Catalog, part: str, row: int, figure: str) -> Class | None:
    """The class of a figure that is worked out from no-load and stall figures; None of others."""
    if figure not in ("resistance", "torque_constant", "efficiency"):
        return None
    sold = _sold_as(catalog, part, row) or _Sold(_SECTIONS[part], catalog.table(_SECTIONS[part]), row)
    if "stall_current" not in sold.table.columns:
        return None
    one = {name: values[sold.row] for name, values in sold.table.columns.items()}
    if not abs(one["resistance"] * one["stall_current"] / one["nominal_voltage"] - 1.0) < _ROUNDED:
        return None
    confidence = catalog.confidence(sold.section, sold.row)
    k_t = "motor_torque_constant" if sold.section == "actuators" else "torque_constant"
    column = k_t if figure == "torque_constant" else figure
    if not {confidence["resistance"], confidence.get(column, "")} <= _WORKED_OUT:
        return None
    if figure == "torque_constant" and confidence.get("no_load_current", ESTIMATED) != ESTIMATED:
        return None
    if part == "motor":
        return class_from_stall(figure)
    if one["gearing"] != "spur" or not one["efficiency"] < 1.0:
        return None
    return losses_from_stall(str(one["part"]), *(float(one[name]) for name in ("efficiency", "ratio", "stages")))


_WORKED_OUT = {"derived", "recalled"}  # confidences of figures that are not printed
_ROUNDED = 0.05  # of a resistance that is voltage over stall current


_OF_THE_MODEL = ("holding_torque", "inductance")  # which counts where no curve is printed
_COLUMNS = {  # of a class: the columns that it varies, as far as they may be estimated
    ("motor", "friction"): ("no_load_current",),
    ("motor", "rotor_inertia"): ("rotor_inertia",),
    ("motor", "pull_out"): ("pull_out_share",),
    ("motor", "start_speed"): ("start_speed",),
    ("motor", "thermal_resistance"): ("thermal_resistance_housing", "thermal_resistance_winding"),
    ("gearhead", "efficiency"): ("efficiency",),
    ("gearhead", "inertia"): ("inertia",),
}


def _of_peers(catalog: Catalog, default: Class, part: str, row: int) -> Class | None:
    """The class of a figure that is estimated: the band of its law; None where the catalogue has the figure."""
    for name in _COLUMNS.get((part, default.figure), ()):
        one = catalog.estimate_of(_SECTIONS[part], row, name)
        if one is None or one.fit == MOUNTED:  # a mounting is no property of the part
            continue
        value, low, high = (1.0 / x - 1.0 if name == "efficiency" else x for x in one[:3])  # of losses per torque
        least, most = sorted((low / value, high / value))
        text = f"{least:.2f} to {most:.2f} times, 5 to 95 %"
        factor = Distribution("lognormal", least, most, 1.0)
        whose = str(catalog.table(_SECTIONS[part])["part"][row])
        return Class(part, default.figure, f"{default.title}, {whose}", text, factor, "estimated from peers", whose)
    return None


def _of_a_maker(catalog: Catalog, one: MakerTolerance) -> Class:
    source = catalog.sources[one.source]
    certainty = "" if source.confidence == "quoted" else source.confidence
    date = "" if source.date in source.document else source.date
    why = ", ".join(text for text in (f"{one.maker}: {source.document}", date, certainty) if text)
    return class_of(one.part, one.figure, one.tolerance, why, owner_of(catalog.tolerances, one))


def holding_of_a_set(catalog: Catalog, given: Given, *rows: int) -> tuple[Class, ...]:
    """The classes of the figures of a motor, its gearhead and its controller, by their rows."""
    return tuple(one for part, row in zip(_SECTIONS, rows, strict=False) for one in holding(catalog, given, part, row))


def used(catalog: Catalog, given: Given, rows: Iterable[tuple[int, ...]]) -> tuple[Class, ...]:
    """The classes that hold for any of some motors, gearheads and controllers, each once, in a fixed order.

    The order is that of the figures, the default class of each first, then the makers' by name.
    """
    parts = dict.fromkeys(pair for one in rows for pair in zip(_SECTIONS, one, strict=False))
    found = {one for part, row in parts for one in holding(catalog, given, part, row)}
    order = {key: place for place, key in enumerate(CLASSES)}
    return tuple(sorted(found, key=lambda one: (order[one.part, one.figure], one.whose, one.text, one.why)))
