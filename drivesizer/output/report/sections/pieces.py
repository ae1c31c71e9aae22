"""The motor's own torque piece by piece of the motion: accelerate, run, brake, rest, and over the whole cycle."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.pieces_table import FIGURES, by_case
from drivesizer.output.report.sections.blocks import Block, Column, Row, Table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.texts import quantity
from drivesizer.results.pieces import MotorPiece

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


PIECES = Section(name="pieces", title="The motor piece by piece", level=2, blocks=_blocks)
