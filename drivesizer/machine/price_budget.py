"""Price of all drives of a machine and of what feeds them, against its limit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import Any

from drivesizer.catalog import Catalog
from drivesizer.results.check import Check
from drivesizer.results.check_columns import at_most
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.units import show

__all__ = ["BY_PIECES", "Item", "of_drives", "of_supply", "price_check", "price_of_each"]

Item = tuple[str, Any, int]  # role, part or None where none is known, and how many
BY_PIECES = (("price_20", 20), ("price_5", 5))


def of_drives(problem: Problem, one: DriveParts) -> Iterator[Item]:
    """The parts of all drives of one kind that are to be bought."""
    spec = problem.spec
    needless = "encoder" if one.encoder is None and not spec.wants_encoder else ""
    parts = {role: part for role, part in one.parts.items() if role != needless}
    unknown = ["brake"] * (spec.names_brake and one.brake is None)
    unknown += ["belt and pulleys"] * (one.belt_ratio != 1.0 and one.belt_drive is None)
    unknown += [spec.gear.kind] if spec.gear else []
    for role, part in (*parts.items(), *((role, None) for role in unknown)):
        yield role, part, spec.load.motors


def of_supply(part: str | None, resistor: Any, catalog: Catalog) -> Iterator[Item]:
    """Power supply and brake resistor of a machine, as far as they are out of catalogues."""
    if part is not None:
        yield "power supply", catalog.power_supplies.record(catalog.power_supplies.rows[part]), 1
    if resistor is not None and resistor.part:
        yield "brake resistor", resistor, 1


def price_of_each(part: Any, pieces: int) -> float:
    """The price of a part where so many are bought."""
    prices = (getattr(part, name, nan) for name, least in BY_PIECES if pieces >= least)
    return next((price for price in prices if not isnan(price)), getattr(part, "price", nan))


def price_check(items: Sequence[Item], limit: float) -> Check:
    """The known prices of what is bought against what it may cost."""
    pieces = Counter[str]()
    for _, part, number in items:
        if part is not None:
            pieces[part.part] += number
    prices = [number * price_of_each(part, pieces[part.part]) if part else nan for _, part, number in items]
    lacking = dict.fromkeys(role for (role, *_), price in zip(items, prices, strict=True) if isnan(price))
    column = at_most("price", sum(price for price in prices if not isnan(price)), limit)
    if not lacking:
        return column.at((), "budget")
    left = show(max(limit - float(column.demand), 0.0), "EUR", "price")
    note = f"at least: no price is known of {', '.join(lacking)}, for which {left} is left"
    unknown = replace(column, passed=column.passed & False)
    return replace(unknown.at((), "budget"), note="" if column.failed else note)
