"""Prices of a table in their currency: euros, francs, or any other, kept as it is."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from drivesizer.catalog.exchange.import_map import Plan
from drivesizer.catalog.parts import columns_of

__all__ = ["currency_of", "foreign_prices"]

_SIGNS = {"$": "USD", "US$": "USD", "£": "GBP", "¥": "JPY", "€": "EUR"}


def currency_of(unit: str) -> str:
    """Code of a currency, of its sign or of the code itself; empty where a unit is none."""
    return _SIGNS.get(unit, unit if re.fullmatch(r"[A-Z]{3}", unit) else "")


def foreign_prices(
    units: Sequence[str], plan: Plan, taken: Mapping[str, int]
) -> tuple[list[str], Plan, dict[str, int]]:
    """Prices in another currency than euros, in the columns for them; nothing is converted."""
    place = taken.get("price", taken.get("foreign_price", len(units)))
    unit = currency_of(units[place]) if place < len(units) else ""
    if not unit or unit == "EUR":
        return list(units), plan, dict(taken)
    francs = unit == "CHF" and "list_price" in columns_of(plan.section)
    own = "list_price" if francs else "foreign_price"
    renamed = {own if at == place else name: at for name, at in taken.items()}
    cleared = [*units[:place], "CHF" if francs else "", *units[place + 1 :]]
    stated = {} if francs or "currency" in taken else {"currency": unit}
    return cleared, replace(plan, common={**stated, **plan.common}), renamed
