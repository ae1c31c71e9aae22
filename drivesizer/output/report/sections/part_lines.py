"""The parts list of the machine as a table: quantity, part, order number, mass and price, and their totals."""

from __future__ import annotations

from collections.abc import Sequence

from drivesizer.output.part_line import PartLine, ordered_as
from drivesizer.output.part_totals import Total, mass_text, money_text, total_text, totals
from drivesizer.output.parts_of_axes import SharedLine
from drivesizer.output.report.sections.blocks import Column, Row, Table
from drivesizer.output.report.sections.texts import Small

__all__ = ["parts_table", "shared_parts_table", "total_of"]


def parts_table(lines: Sequence[PartLine], motors: int, outcome: str) -> Table:
    """Parts to order for the whole machine, with the totals of mass and price."""
    drives = "the one drive" if motors == 1 else f"all {motors} drives"
    return _table(f"Parts of {drives}: {outcome}", [(line, "") for line in lines], totals(lines))


def shared_parts_table(lines: Sequence[SharedLine], every: Sequence[Total], whole: str) -> Table:
    """Parts to order for a machine of several axes, each with the axes that need it."""
    return _table(f"Parts of {whole}", [(one.line, ", ".join(one.axes)) for one in lines], every)


def _table(caption: str, lines: Sequence[tuple[PartLine, str]], every: Sequence[Total]) -> Table:
    """Lines with a note on each, and their totals."""
    axes = any(note for _, note in lines)
    columns = (Column("", "number"), Column("part", "name"), Column("maker and family", width=1.35 if axes else 1.0),
               Column(f"order number{', axes' if axes else ''}", "strong", 1.1), Column("mass of all", "number"),
               Column("price each", "number"), Column("together", "number"))  # fmt: skip
    sums = {name: " + ".join(total_of(t) for t in every if t.name == name) for name in ("mass", "price")}
    total = Row(("", "total", "", "", sums["mass"] or "unknown", "", sums["price"] or "unknown"), total=True)
    dates = ", ".join(dict.fromkeys(line.price_date for line, _ in lines if line.price_date))
    dated = f"; prices of {dates}" if dates else ""
    caption += f"{dated}; without cables, connectors and couplings"
    caption += "; ≈ estimated" if any(total.estimated for total in every) else ""
    rows = [_row(line, note) for line, note in lines]
    return Table(caption, columns, [*rows, total], name="parts", look="parts")


def total_of(total: Total) -> str:
    """A total as reports print it: an estimated mass with a digit less."""
    return total_text(total, 3 if total.estimated else 4)


def _row(line: PartLine, note: str) -> Row:
    maker = line.family if line.maker in line.family else f"{line.maker} {line.family}"
    named = ", ".join(filter(None, (maker.strip(), line.said)))
    if not line.part and not named:
        named = "none is listed for this motor"
    order = ordered_as(line.part, line.order_number)
    return Row((f"{line.quantity} ×", line.role, named, (order, Small(note)) if note else order,
                mass_text(line), money_text(line.price, line.currency),
                money_text(line.quantity * line.price, line.currency)))  # fmt: skip
