"""Columns that several sheets of a workbook have, and rows of all drives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from drivesizer.output.report.lines.reliability_rows import every_list
from drivesizer.output.report.lines.rows import Row
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.sheet import Column
from drivesizer.results.drive_set import DriveSet

__all__ = ["LIMITS", "NOTE", "RANK", "STATUS", "VALUES", "ranked"]

RANK = Column("drive", "set_rank", "count")
STATUS = Column("status", "status", "status")
NOTE = Column("note", "note", "", 70)
VALUES = (
    Column("value", "value"), Column("unit", "unit", "unit"), Column("SI value", "si_value"),
    Column("SI unit", "si_unit", "unit"),
)  # fmt: skip
LIMITS = (
    Column("value or demand", "value"), Column("limit", "limit"), Column("unit", "unit", "unit"),
    Column("SI value", "si_value"), Column("SI limit", "si_limit"), Column("SI unit", "si_unit", "unit"),
    Column("margin (%)", "margin", "percent"), Column("needed margin (%)", "needed_margin", "needed"), STATUS,
    Column("at (s)", "at_time_s"), NOTE,
)  # fmt: skip


def ranked(content: Content, rows: Callable[[DriveSet], Iterable[Row]]) -> Iterator[Row]:
    """Rows of every drive, with its rank.

    Parameters
    ----------
    content
        What the report is about.
    rows
        Rows of one drive.

    Returns
    -------
    Iterator of rows
    """
    for _, drive in every_list(content.result, front=False):
        yield from (row | {"set_rank": drive.rank} for row in rows(drive))
