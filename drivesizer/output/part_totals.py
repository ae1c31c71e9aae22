"""Totals of a parts list, mass and prices, and how they are printed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import isnan, nan

from drivesizer.output.part_line import PartLine
from drivesizer.units import show

__all__ = ["LEAST", "Total", "mass_text", "money_text", "named_totals", "total_text", "total_texts", "totals"]


LEAST = "at least "
"""Before a total that lacks a part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Total:
    """A total of a parts list, as far as known."""

    name: str  # mass, price
    value: float  # kg, or in the currency
    unit: str  # kg or the currency
    over: tuple[str, ...]  # roles that it sums
    lacks: tuple[str, ...]  # roles that it leaves out, unknown
    low: float  # with estimated figures at their 5th percentile
    high: float  # and at their 95th
    estimated: tuple[str, ...] = ()  # roles whose figure is estimated


def totals(lines: Sequence[PartLine]) -> list[Total]:
    """Mass and price of the whole list; prices by currency, and no line for what no part has."""
    return named_totals(lines, [line.role for line in lines])


def named_totals(lines: Sequence[PartLine], names: Sequence[str]) -> list[Total]:
    """Mass and price of lines of which several may have a role."""
    masses = [(x.quantity * x.mass, x.quantity * x.mass_low, x.quantity * x.mass_high) for x in lines]
    wanted: list[tuple[str, str, list[tuple[float, float, float]]]] = [("mass", "kg", masses)]
    for currency in dict.fromkeys(line.currency for line in lines if line.currency):
        prices = [(x.quantity * x.price if x.currency == currency else nan, nan, nan) for x in lines]
        wanted.append(("price", currency, prices))
    roles = [(line.role, name) for line, name in zip(lines, names, strict=True)]
    found = [_total(name, unit, [*zip(roles, values, strict=True)]) for name, unit, values in wanted]
    return [total for total in found if total.over]


def _total(name: str, unit: str, values: Sequence[tuple[tuple[str, str], tuple[float, float, float]]]) -> Total:
    """Sum of value, low and high end of each line; what has no band counts at its value at both ends."""
    known = [(role, value) for (role, _), value in values if not isnan(value[0])]
    low, high = (sum(v[0] if isnan(v[end]) else v[end] for _, v in known) for end in (1, 2))
    over = _once(role for role, _ in known)
    return Total(
        name=name, value=sum(value[0] for _, value in known), unit=unit, over=over,
        lacks=_once(named if role in over else role for (role, named), value in values if isnan(value[0])),
        low=low, high=high, estimated=_once(role for role, value in known if not isnan(value[1])),
    )  # fmt: skip


def _once(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(names))


def money_text(price: float, currency: str) -> str:
    """A price as it is printed."""
    return "unknown" if isnan(price) else f"{price:.2f} {currency}"


def mass_text(line: PartLine) -> str:
    """The mass of all pieces of a line as it is printed, marked where it is estimated."""
    mass = line.quantity * line.mass
    return show(mass, "g", "mass") if isnan(line.mass_low) else f"≈ {show(mass, 'g', 'mass', 2)}"


def total_text(total: Total, digits: int) -> str:
    """A total as it is printed: at least, where a part of it is unknown."""
    least = LEAST if total.lacks else ""
    if total.name == "price":
        return f"{least}{total.value:.2f} {total.unit}"
    return least + show(total.value, "kg", "mass", digits)


def total_texts(lines: Sequence[PartLine], text: Callable[[Total], str]) -> str:
    """Mass and prices of a parts list in a line; of which no part's is known is said."""
    found = totals(lines)
    known = {one.name for one in found}
    texts = [] if "mass" in known else ["mass unknown"]
    texts += map(text, found)
    return "; ".join(texts if "price" in known else [*texts, "no price is known"])
