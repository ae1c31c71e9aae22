"""The order: numbers, prices, sellers and delivery of parts, by axis and for the machine; and what is missing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import fsum, isnan, nan
from typing import NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.output.document import records as doc
from drivesizer.output.document.axes import MachineContent
from drivesizer.output.parts import PartLine


class Ordered(NamedTuple):
    """A line of a quote: of an axis, or of several, or of the whole machine."""

    axis: str
    line: PartLine

    @property
    def missing(self) -> str:
        """The facts without which it cannot be ordered, or has no price."""
        line = self.line
        if not line.part:
            return "no part is known"
        number = f"order number of {line.ordered_with} with {line.role}" if line.ordered_with else "order number"
        lacks = [number] * (not line.order_number) + ["price"] * isnan(line.price)
        return f"no {' and no '.join(lacks)}" if lacks else ""


def lines_of(content: MachineContent) -> list[Ordered]:
    """Lines of what is ordered for each axis, at the prices of the quantity of all, then for all axes together."""
    if alone := content.alone:
        return [Ordered("", line) for line in alone.bought] if alone.outcome != "missed" else []
    own = [Ordered(axis.name, line) for axis in content.axes for line in axis.lines]
    shared = ("power supply", "brake resistor")
    of_axes = {(line.role, line.part) for _, line in own}
    common = (shared_line.line for shared_line in content.bought if shared_line.line.role in shared)
    return own + [Ordered("", line) for line in common if (line.role, line.part) not in of_axes]


def quote_table(caption: str, lines: Sequence[Ordered], catalog: Catalog) -> doc.Table:
    """The lines, and totals for each currency; by rates one for all, where there are several."""
    axes = list(dict.fromkeys(axis for axis, _ in lines))
    rows = [_row(line) for line in lines]
    for axis in axes if len(axes) > 1 else ():
        rows += _totals([line for of, line in lines if of == axis], {}, axis or "common")
    rows += _totals([line for _, line in lines], catalog.rates, "machine" if len(axes) > 1 else "", catalog.currency)
    return doc.table("quote", caption, rows, without=() if any(axes) else ("axis",))


def _row(ordered: Ordered) -> doc.Row:
    line = ordered.line
    named = line.family if line.part in (line.order_number, line.family, "") else f"{line.family} {line.part}".strip()
    return doc.row("quote", line, name=line.role.replace(" ", "_"), axis=ordered.axis, missing=ordered.missing,
                   description=", ".join(filter(None, (named, line.said))))  # fmt: skip


def _totals(lines: Sequence[PartLine], rates: Mapping[str, float], axis: str, into: str = "") -> Iterator[doc.Row]:
    """A total for each currency with the number of lines that it lacks, and all of them in one by rates."""
    by_currency: dict[str, list[float]] = {}
    for line in lines:
        if not isnan(line.price):
            by_currency.setdefault(line.currency, []).append(line.quantity * line.price)
    lacks = sum(isnan(line.price) for line in lines)
    missing = f"no price of {lacks} of {len(lines)}" if lacks else ""
    totals = [(code, fsum(prices), "") for code, prices in by_currency.items()]
    if len(by_currency) > 1 and by_currency.keys() <= rates.keys():
        total = fsum(rates[code] * value for code, value, _ in totals)
        totals.append(
            (
                into,
                total,
                f"all of them, by the rates of the spec: {', '.join(_rates_in_words(rates, by_currency, into))}",
            )
        )
    for code, value, note in totals or [("", nan, "")]:
        yield doc.Row({"axis": axis, "role": "total", "together": doc.Quantity(value, code, "money"), "currency": code,
                       "missing": missing, "note": note}, name="total", total=True)  # fmt: skip


def _rates_in_words(rates: Mapping[str, float], codes: Mapping[str, object], into: str) -> Iterator[str]:
    return (f"1 {code} is {rates[code]:.6g} {into}" for code in codes if code != into)


def quote_sections(content: MachineContent) -> Iterator[doc.Printed]:
    """The sheets of a quote: the machine, each of several axes, what is missing."""
    lines = whole = lines_of(content)
    catalog = content.catalog
    if not content.alone:
        whole = [Ordered(", ".join(shared_line.axes), shared_line.line) for shared_line in content.bought]
    tables = {"Quote": quote_table(f"Parts of {content.name}", whole, catalog)}
    for axis in dict.fromkeys(axis for axis, _ in lines if axis):
        own = [Ordered("", line) for of, line in lines if of == axis]
        tables[axis] = quote_table(f"Parts of {axis}", own, catalog)
    lacks = [doc.Row({"role": ordered.line.role, "description": ordered.line.part or ordered.line.said,
                      "axis": ordered.axis, "missing": ordered.missing})
             for ordered in whole if ordered.missing]  # fmt: skip
    if lacks:
        heads = [column for column in doc.declared()["quote"][1] if column.key in lacks[0].cells]
        tables["Missing"] = doc.Table("Missing to order", heads, lacks)
    for title, table in tables.items():
        yield doc.section("quote", title, [table])


def quote_lines(content: MachineContent) -> doc.Table:
    """The quote as one table, by axis."""
    return quote_table(f"Parts of {content.name}", lines_of(content), content.catalog)
