"""A section of a report: one record that PDF, HTML, XLSX and CSV print.

``blocks`` is what PDF and HTML show, in the order of the list in ``sections``. XLSX and CSV print all drives with all
figures: a section whose tables are to have more there than on paper gives ``sheets`` and ``csv`` itself; of any other
the tables of its blocks become a sheet each, and each of their numbers a row of the CSV.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from drivesizer.output.report.lines.rows import Row
from drivesizer.output.report.sections.blocks import Block, Pair, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.texts import Number, text_of
from drivesizer.results.drive_set import DriveSet

__all__ = ["CsvRows", "Section", "rows_of", "sheets_of"]


def _no_rows(*_: Any) -> tuple[()]:
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CsvRows:
    """Rows of the CSV: before those of the drives, of each drive with the list that it is on, and after them."""

    before: Callable[[Content], Iterable[Row]] = _no_rows
    of_drive: Callable[[Content, str, DriveSet], Iterable[Row]] = _no_rows
    after: Callable[[Content], Iterable[Row]] = _no_rows


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A section by its name, which is also its address on the page."""

    name: str
    title: str | Callable[[Content], str]
    blocks: Callable[[Content], Iterable[Block]]  # no block: PDF and HTML leave the section out
    level: int = 1  # 2: inside the section of level 1 above it
    new_page: bool = False  # on paper
    appendix: bool = False
    tabled: bool = True  # tables in its blocks make sheets and rows of the CSV, where it gives none itself
    sheets: Callable[[Content], Iterable[Sheet]] | None = None
    csv: CsvRows | None = None

    def headed(self, content: Content) -> str:
        """The title in a report of that content."""
        return self.title if isinstance(self.title, str) else self.title(content)


def sheets_of(section: Section, content: Content) -> list[Sheet]:
    """Sheets of a workbook."""
    if section.sheets or not section.tabled:
        return [*section.sheets(content)] if section.sheets else []
    blocks = [*_flat(section.blocks(content))]
    words = [{"across": text_of(block.text)} for block in blocks if isinstance(block, Words)]
    made: list[Sheet] = []
    for table in (block for block in blocks if isinstance(block, Table)):
        rows = [dict(_cells(row.cells)) for row in table.rows]
        name = f"{section.headed(content)[:28]}{f' {len(made) + 1}' if made else ''}"
        made.append(Sheet(name=name, columns=_columns(table, rows), rows=[*rows, *(() if made else words)],
                          note=text_of(table.caption), filtered=False))  # fmt: skip
    return made


def _cells(cells: Iterable[Any]) -> Iterator[tuple[str, Any]]:
    """Cells of a row by the keys of a sheet; a number is two of them, value and unit."""
    for n, cell in enumerate(cells):
        if isinstance(cell, Number):
            yield from ((f"cell {n}", cell.value), (f"unit {n}", "" if cell.unit == "1" else cell.unit))
        else:
            yield f"cell {n}", text_of(cell)


def _columns(table: Table, rows: list[Row]) -> tuple[SheetColumn, ...]:
    made = []
    for n, column in enumerate(table.columns):
        made.append(SheetColumn(column.head, f"cell {n}"))
        if any(row.get(f"unit {n}") for row in rows):
            made.append(SheetColumn("unit", f"unit {n}", "unit"))
    return tuple(made)


def rows_of(section: Section, content: Content) -> CsvRows:
    """Rows of the CSV."""
    if section.csv or not section.tabled:
        return section.csv or CsvRows()
    tables = [block for block in _flat(section.blocks(content)) if isinstance(block, Table)]
    return CsvRows(after=lambda _: (row for table in tables for row in _numbers(section.name, table)))


def _numbers(section: str, table: Table) -> Iterator[Row]:
    several = sum(column.form == "number" for column in table.columns) > 1
    for row in table.rows:
        head = next((text_of(cell) for cell in row.cells if not isinstance(cell, Number)), "")
        for column, cell in zip(table.columns, row.cells, strict=True):
            if isinstance(cell, Number):
                title = f"{head}, {column.head}" if several else head
                name = re.sub(r"\W+", "_", title.lower()).strip("_")
                yield {"section": section, "name": name, "title": title, "value": cell.value, "unit": cell.unit,
                       "si_value": cell.si_value, "si_unit": cell.si_unit,
                       "status": "unknown" if cell.value is None else ""}  # fmt: skip


def _flat(blocks: Iterable[Block]) -> Iterator[Block]:
    for block in blocks:
        if isinstance(block, Pair):
            yield from _flat((*block.left, *block.right))
        else:
            yield block
