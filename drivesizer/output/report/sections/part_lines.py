"""The parts list of the machine as a table: quantity, part, order number, mass and price, and their totals."""

from __future__ import annotations

from collections.abc import Sequence

from drivesizer.output.parts import PartLine, Total, mass_text, money_text, ordered_as, total_text, totals
from drivesizer.output.report.sections.blocks import Column, Row, Table

__all__ = ["parts_table", "total_of"]


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
    sums = {name: " + ".join(total_of(t) for t in totals(lines) if t.name == name) for name in ("mass", "price")}
    total = Row(("", "total", "", "", sums["mass"] or "unknown", "", sums["price"] or "unknown"), total=True)
    dates = ", ".join(dict.fromkeys(line.price_date for line in lines if line.price_date))
    dated = f"; prices of {dates}" if dates else ""
    caption = f"Parts of {drives}: {outcome}{dated}; without cables, connectors and couplings"
    caption += "; ≈ estimated" if any(total.estimated for total in totals(lines)) else ""
    return Table(caption, columns, [*map(_row, lines), total], name="parts", look="parts")


def total_of(total: Total) -> str:
    """A total as reports print it: an estimated mass with a digit less."""
    return total_text(total, 3 if total.estimated else 4)


def _row(line: PartLine) -> Row:
    maker = line.family if line.maker in line.family else f"{line.maker} {line.family}"
    named = ", ".join(filter(None, (maker.strip(), line.said)))
    return Row((f"{line.quantity} ×", line.role, named or "unknown", ordered_as(line.part, line.order_number),
                mass_text(line), money_text(line.price, line.currency),
                money_text(line.quantity * line.price, line.currency)))  # fmt: skip
