"""The parts list of the machine as a table: quantity, part, order number, mass and price, and their totals."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan

from drivesizer.output.parts import PartLine, Total, ordered_as, totals
from drivesizer.output.report.sections.blocks import Column, Row, Table
from drivesizer.units import show

__all__ = ["LEAST", "parts_table", "total_text"]

LEAST = "at least "


def parts_table(lines: Sequence[PartLine], motors: int, outcome: str) -> Table:
    """Parts to order for the whole machine, with the totals of mass and price.

    Parameters
    ----------
    lines
        Of :func:`drivesizer.output.parts.machine_parts`.
    motors
        How many drives the machine has.
    outcome
        The drive in words.

    Returns
    -------
    Table
    """
    drives = "the one drive" if motors == 1 else f"all {motors} drives"
    columns = (Column("", "number"), Column("part", "name"), Column("maker and family", width=1.0),
               Column("order number", "strong", 1.1), Column("mass of all", "number"), Column("price each", "number"),
               Column("together", "number"))  # fmt: skip
    sums = {name: " + ".join(total_text(t) for t in totals(lines) if t.name == name) for name in ("mass", "price")}
    total = Row(("", "total", "", "", sums["mass"] or "unknown", "", sums["price"] or "unknown"), total=True)
    dates = ", ".join(dict.fromkeys(line.price_date for line in lines if line.price_date))
    dated = f"; prices of {dates}" if dates else ""
    caption = f"Parts of {drives}: {outcome}{dated}; without cables, connectors and couplings"
    caption += "; ≈ estimated" if any(total.estimated for total in totals(lines)) else ""
    return Table(caption, columns, [*map(_row, lines), total], name="parts", look="parts")


def total_text(total: Total) -> str:
    """A total as it is printed: at least, where a part of it is unknown.

    Parameters
    ----------
    total
        Of mass or price.

    Returns
    -------
    str
    """
    least = LEAST if total.lacks else ""
    if total.name == "price":
        return f"{least}{total.value:.2f} {total.unit}"
    return least + show(total.value, "kg", "mass", 3 if total.estimated else 4)


def _row(line: PartLine) -> Row:
    maker = line.family if line.maker in line.family else f"{line.maker} {line.family}"
    named = ", ".join(filter(None, (maker.strip(), line.said)))
    return Row((f"{line.quantity} ×", line.role, named or "unknown", ordered_as(line.part, line.order_number),
                _mass(line), _money(line.price, line.currency),
                _money(line.quantity * line.price, line.currency)))  # fmt: skip


def _mass(line: PartLine) -> str:
    """The mass of all pieces, marked where it is estimated."""
    mass = line.quantity * line.mass
    return show(mass, "g", "mass") if isnan(line.mass_low) else f"≈ {show(mass, 'g', 'mass', 2)}"


def _money(price: float, currency: str) -> str:
    return "unknown" if isnan(price) else f"{price:.2f} {currency}"
