"""Figures of parts as texts, and which of them an engineer looks for first."""

from __future__ import annotations

from math import isnan
from typing import Any

from drivesizer.catalog import columns_of
from drivesizer.catalog.columns import Column
from drivesizer.units import label, show

__all__ = ["FIRST_NOTES", "figure", "first_columns"]

_FIRST: dict[str, tuple[tuple[str, str], ...]] = {  # head, column
    "motors": (
        ("power", "assigned_power"), ("voltage", "nominal_voltage"), ("torque", "nominal_torque"),
        ("speed", "no_load_speed"), ("mass", "mass"), ("price", "price"),
    ),
    "gearheads": (
        ("ratio", "reduction"), ("torque", "continuous_torque"), ("input", "continuous_input_speed"),
        ("eff.", "efficiency"), ("mass", "mass"), ("price", "price"),
    ),
    "encoders": (
        ("counts", "counts_per_turn"), ("ch.", "channels"), ("frequency", "max_frequency"), ("speed", "max_speed"),
        ("mass", "mass"), ("price", "price"),
    ),
    "controllers": (
        ("drives", "drives"), ("from", "supply_min"), ("to", "supply_max"), ("cont.", "continuous_current"),
        ("peak", "peak_current"), ("price", "price"),
    ),
    "actuators": (
        ("ratio", "reduction"), ("voltage", "nominal_voltage"), ("torque", "nominal_torque"), ("peak", "peak_torque"),
        ("speed", "no_load_speed"), ("mass", "mass"), ("price", "price"),
    ),
    "brakes": (
        ("torque", "static_torque"), ("supply", "supply"), ("power", "power"), ("inertia", "inertia"),
        ("stop", "energy_per_stop"), ("mass", "mass"),
    ),
    "steppers": (
        ("wiring", "wiring"), ("steps", "full_steps"), ("current", "phase_current"), ("torque", "holding_torque"),
        ("resistance", "resistance"), ("inductance", "inductance"), ("mass", "mass"),
    ),
    "belts": (("profile", "profile"), ("pitch", "pitch"), ("teeth", "teeth"), ("width", "width")),
    "pulleys": (("profile", "profile"), ("pitch", "pitch"), ("teeth", "teeth"), ("width", "width"), ("bore", "bore")),
    "screws": (
        ("diameter", "diameter"), ("lead", "lead"), ("core", "root_diameter"), ("C", "dynamic_load"),
        ("C0", "static_load"), ("eff.", "efficiency"), ("dn", "dn_max"),
    ),
    "batteries": (
        ("chemistry", "chemistry"), ("voltage", "nominal_voltage"), ("capacity", "capacity"),
        ("cont.", "continuous_current"), ("resistance", "resistance"), ("mass", "mass"),
    ),
    "power_supplies": (
        ("kind", "kind"), ("voltage", "nominal_voltage"), ("cont.", "continuous_current"), ("peak", "peak_current"),
        ("for", "peak_time"), ("trips", "overvoltage_min"),
    ),
    "brake_resistors": (
        ("kind", "kind"), ("resistance", "resistance"), ("power", "power"), ("peak", "peak_power"),
        ("on from", "chopper_voltage_min"), ("current", "chopper_current"),
    ),
}  # fmt: skip
FIRST_NOTES = {
    "motors": "torque nominal, speed without load",
    "gearheads": "torque and input speed continuous",
    "encoders": "",
    "controllers": "supply from and to; current continuous and peak",
    "actuators": "at the output: torque continuous and peak, speed without load",
    "brakes": "torque static; energy of one stop",
    "steppers": "current, resistance and inductance of a phase; torque at standstill",
    "belts": "",
    "pulleys": "width of the widest belt",
    "screws": "ratings dynamic and static; dn in mm rpm",
    "batteries": "",
    "power_supplies": "current continuous and peak; over-voltage protection from",
    "brake_resistors": "power continuous and peak; current of the chopper",
}
"""What the heads of these columns leave out."""


def first_columns(section: str) -> list[tuple[str, Column]]:
    """The columns of a list of parts, each with its head, the most wanted first."""
    schema = columns_of(section)
    return [(head, schema[name]) for head, name in _FIRST[section]]


def figure(value: Any, column: Column, *, unit: bool = True, digits: int = 5) -> str:
    """A figure as a data sheet prints it; "unknown" where it is."""
    if isinstance(value, str):
        return value or "unknown"
    if column.kind.startswith("price") and not isnan(value):
        text = f"{value:.2f} {column.unit}"  # to the cent, as money is
    else:
        text = show(value, column.unit, column.kind, digits)
    return text if unit else text.removesuffix(label(column.unit)).strip()
