"""Figures of a set that more than one report prints: sums over its parts, and what it has of an objective."""

from __future__ import annotations

from math import isnan, nan

from drivesizer.ranking import SUMS
from drivesizer.results import DriveSet, Figure, worst

__all__ = ["objective_figure", "price_of", "unknown_of"]

_PARTS = ("motor", "gearhead", "encoder", "controller")


def price_of(drive_set: DriveSet) -> tuple[float, tuple[str, ...]]:
    """The sum of the prices that are known [EUR], and of which parts it is; NaN when none is known."""
    parts = {name: getattr(drive_set, name) for name in _PARTS}
    prices = {name: part.price for name, part in parts.items() if part is not None and not isnan(part.price)}
    return (sum(prices.values()) if prices else nan), tuple(prices)


def unknown_of(known: tuple[str, ...]) -> tuple[str, ...]:
    """The parts of a set that a sum does not cover.

    >>> unknown_of(("motor", "gearhead"))
    ('encoder', 'controller')
    """
    return tuple(name for name in _PARTS if name not in known)


_OBJECTIVES = {  # how an objective is called; kind and unit
    "mass": ("mass", "mass", "g"),
    "price": ("price", "price", "EUR"),
    "length": ("length", "length", "mm"),
    "power": ("assigned power", "power", "W"),
    "energy": ("energy per cycle", "energy", "J"),
    "peak_current": ("peak current", "current", "A"),
    "winding_temperature": ("winding temperature", "temperature", "degC"),
    "margin": ("smallest margin", "dimensionless", "%"),
}


def objective_figure(drive_set: DriveSet, objective: str) -> Figure:
    """What a set has of an objective, whether it was ranked by it or not; NaN where that is unknown."""
    title, kind, unit = _OBJECTIVES[objective]
    return Figure(name=objective, title=title, value=_of(drive_set, objective), kind=kind, unit=unit)


def _of(drive_set: DriveSet, objective: str) -> float:
    if objective == "margin":
        tight = worst(drive_set.checks)
        return tight.margin if tight else nan
    if objective in SUMS:  # first: what is called power among the figures is that of the supply
        name, over = SUMS[objective]
        return float(sum(getattr(getattr(drive_set, part), name) for part in over))
    return {figure.name: figure.value for figure in drive_set.figures}.get(objective, nan)
