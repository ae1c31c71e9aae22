"""The motor's own torque piece by piece of the motion: accelerate, run, brake, rest, and over the whole cycle."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan
from typing import Any

from drivesizer.output.pieces_table import FIGURES, by_case
from drivesizer.output.report.lines.rows import figure_row
from drivesizer.output.report.sections.blocks import Block, Column, Row, Table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn, headed
from drivesizer.output.report.sections.sheets import RANK, ranked
from drivesizer.output.report.sections.texts import quantity
from drivesizer.results.check import Figure
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.pieces import MotorPiece
from drivesizer.units import from_si

__all__ = ["PIECES"]


def _blocks(content: Content) -> Iterator[Block]:
    if content.drive is None:
        return
    columns = Column("piece", "name", 1.0), *(Column(head, "number") for head, *_ in FIGURES)
    for case, pieces in by_case(content.drive.pieces):
        of = f" in load case {case}" if case else ""
        caption = f"The motor in each piece of the motion{of}: largest figures, and RMS; below 0 torque brakes."
        yield Table(caption, columns, [*map(_row, pieces)], "pieces", "figures", dense=True)


def _row(one: MotorPiece) -> Row:
    cells = [quantity(getattr(one, field), unit, kind) for _, field, unit, kind in FIGURES]
    return Row((one.name, *cells), total=one.name == "cycle")


def _sheet(content: Content) -> list[Sheet]:
    """The pieces of every drive, a figure a column."""
    heads = [SheetColumn(headed(head, unit), field) for head, field, unit, _ in FIGURES]
    columns = RANK, SheetColumn("load case", "case"), SheetColumn("piece", "piece"), *heads
    rows = list(ranked(content, lambda drive: map(_cells, drive.pieces)))
    note = "largest figures of each piece of the motion, and RMS; below 0 torque brakes"
    return [Sheet(name="Pieces", columns=columns, rows=rows, still=3, note=note)]


def _cells(one: MotorPiece) -> dict[str, Any]:
    figures = {field: float(from_si(getattr(one, field), unit, kind)) for _, field, unit, kind in FIGURES}
    return {"case": one.case, "piece": one.name} | {name: None if isnan(x) else x for name, x in figures.items()}


def _csv(drive: DriveSet) -> Iterator[dict[str, Any]]:
    """A row for each figure of each piece."""
    for one in drive.pieces:
        name = "_".join(filter(None, (one.case, one.name))).replace(" ", "_")
        for head, field, unit, kind in FIGURES:
            value, title = getattr(one, field), f"{one.name}, {head}"
            yield figure_row("pieces", Figure(name=f"{name}_{field}", title=title, value=value, kind=kind, unit=unit))


PIECES = Section(
    name="pieces", title="The motor piece by piece", level=2, blocks=_blocks, sheets=_sheet,
    csv=CsvRows(of_drive=lambda content, _, drive: _csv(drive)),
)  # fmt: skip
