"""Columns that several sheets of a workbook have, and rows of all drives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from drivesizer.output.report.lines.reliability_rows import every_list
from drivesizer.output.report.lines.rows import Row
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.sheet import SheetColumn
from drivesizer.results.drive_set import DriveSet

__all__ = ["LIMITS", "NOTE", "RANK", "STATUS", "VALUES", "ranked"]

RANK = SheetColumn("drive", "set_rank", "count")
STATUS = SheetColumn("status", "status", "status")
NOTE = SheetColumn("note", "note", "", 70)
VALUES = (
    SheetColumn("value", "value"), SheetColumn("unit", "unit", "unit"), SheetColumn("SI value", "si_value"),
    SheetColumn("SI unit", "si_unit", "unit"),
)  # fmt: skip
LIMITS = (
    SheetColumn("value or demand", "value"), SheetColumn("limit", "limit"), SheetColumn("unit", "unit", "unit"),
    SheetColumn("SI value", "si_value"), SheetColumn("SI limit", "si_limit"), SheetColumn("SI unit", "si_unit", "unit"),
    SheetColumn("margin (%)", "margin", "percent"), SheetColumn("needed margin (%)", "needed_margin", "needed"), STATUS,
    SheetColumn("at (s)", "at_time_s"), NOTE,
)  # fmt: skip


def ranked(content: Content, rows: Callable[[DriveSet], Iterable[Row]]) -> Iterator[Row]:
    """Rows of every drive, with its rank."""
    for _, drive in every_list(content.result, front=False):
        yield from (row | {"set_rank": drive.rank} for row in rows(drive))
