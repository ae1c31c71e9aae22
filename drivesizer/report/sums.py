"""Figures of a set that more than one report prints: sums over its parts, and what it has of an objective."""

from __future__ import annotations

from math import isnan, nan

from drivesizer.results import DriveSet

__all__ = ["price_of", "unknown_of"]


def price_of(drive_set: DriveSet) -> tuple[float, tuple[str, ...]]:
    """The sum of the prices that are known [EUR], and of which parts it is; NaN when none is known."""
    prices = {name: part.price for name, part in drive_set.parts.items() if part is not None and not isnan(part.price)}
    return (sum(prices.values()) if prices else nan), tuple(prices)


def unknown_of(drive_set: DriveSet, known: tuple[str, ...]) -> tuple[str, ...]:
    """The parts of a set that a sum does not cover."""
    return tuple(name for name in drive_set.parts if name not in known)
