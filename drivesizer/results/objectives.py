"""What sets can be ranked by: names, units, and what a set has of each."""

from __future__ import annotations

from math import nan
from typing import NamedTuple

from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Figure, worst

__all__ = ["OBJECTIVE", "SUMS", "objective_figure"]

SUMS: dict[str, tuple[str, tuple[str, ...]]] = {  # figure and the parts that it is summed over
    "mass": ("mass", ("motor", "gearhead")),
    "price": ("price", ("motor", "gearhead")),
    "length": ("length", ("motor", "gearhead")),
    "power": ("assigned_power", ("motor",)),
}


class _Shown(NamedTuple):
    """How an objective is called, and its kind and unit."""

    title: str
    kind: str
    unit: str


OBJECTIVE: dict[str, _Shown] = {
    "mass": _Shown("mass", "mass", "g"),
    "price": _Shown("price", "price", "EUR"),
    "length": _Shown("length", "length", "mm"),
    "power": _Shown("assigned power", "power", "W"),
    "energy": _Shown("energy per cycle", "energy", "J"),
    "joule_heat": _Shown("heat of the winding", "power", "W"),
    "peak_current": _Shown("peak current", "current", "A"),
    "winding_temperature": _Shown("winding temperature", "temperature", "degC"),
    "margin": _Shown("smallest margin", "dimensionless", "%"),
}


def objective_figure(drive_set: DriveSet, objective: str) -> Figure:
    """What a set has of an objective, whether it was ranked by it or not; NaN where that is unknown."""
    shown = OBJECTIVE[objective]
    value = _of(drive_set, objective)
    return Figure(name=objective, title=shown.title, value=value, kind=shown.kind, unit=shown.unit)


def _of(drive_set: DriveSet, objective: str) -> float:
    if objective == "margin":
        tight = worst(drive_set.checks)
        return tight.margin if tight else nan
    if objective in SUMS:  # first: what is called power among the figures is that of the supply
        name, over = SUMS[objective]
        return float(sum(getattr(getattr(drive_set, part), name) for part in over))
    return {figure.name: figure.value for figure in drive_set.figures}.get(objective, nan)
