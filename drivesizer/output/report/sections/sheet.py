"""A sheet of a workbook as plain data: columns, rows, and a note."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from drivesizer.output.report.lines.rows import Row
from drivesizer.units import label

__all__ = ["Cell", "Sheet", "SheetColumn", "headed"]


class SheetColumn(NamedTuple):
    """A column: its head, the key of its cells in a row, and the form in which they are shown."""

    head: str
    key: str
    form: str = ""  # of ``workbook.writer``; empty: a number with as many decimals as it has at four digits
    widest: int = 44  # letters; what is longer wraps


class Cell(NamedTuple):
    """A cell in another form than its column's."""

    value: Any
    form: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Sheet:
    """A sheet: a head, and rows by the keys of its columns.

    A row of the key ``part`` alone heads those below it, one of ``across`` alone is a text over all columns.
    """

    name: str
    columns: tuple[SheetColumn, ...]
    rows: list[Row]
    note: str = ""  # beside the head
    still: int = 0  # columns that stay when the sheet is scrolled
    filtered: bool = True
    drawn: tuple[str, ...] = ()  # keys of columns in a chart over the first


def headed(title: str, unit: str) -> str:
    """The head of a column with its unit.

    Examples
    --------
    >>> headed("Energy per cycle", "J"), headed("Teeth", "1")
    ('Energy per cycle (J)', 'Teeth')
    """
    return f"{title} ({label(unit)})" if label(unit) else title
