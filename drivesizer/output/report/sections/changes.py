"""Changes of the spec that would let a rejected drive pass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivesizer.output.report.lines.rows import change_row
from drivesizer.output.report.sections.blocks import Block, Column, Row, Table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.results.drive_set import Relaxation

__all__ = ["CHANGES", "changes_table"]


def changes_table(caption: str, changes: Sequence[Relaxation]) -> Table:
    """Fields of the spec as they are and as they would have to be."""
    if any(one.status != "pass" for one in changes):
        caption = caption.replace(" passes,", " passes or fails no check,", 1)
    columns = (
        Column("field"),
        Column("now", "number"),
        Column("needed", "number"),
        Column("drive", width=1.0),
    )
    rows = [Row((r.field.replace("_", " ").replace(".", " › "), r.now, r.needed, r.set_label)) for r in changes]
    return Table(caption, columns, rows)


def _blocks(content: Content) -> Iterator[Block]:
    if content.drive and content.drive.changes and not content.result.sets:
        yield changes_table("Changes after which this drive passes, one figure at a time", content.drive.changes)


CHANGES = Section(
    name="changes", title="What would let it pass", level=2, blocks=_blocks, tabled=False,
    csv=CsvRows(of_drive=lambda content, _, drive: map(change_row, drive.changes)),
)  # fmt: skip
