"""Long tables of numbers in a workbook: rows put into the finished file, a whole row at a time.

xlsxwriter keeps and looks at each cell by itself, which takes four times as long. It writes the head and the first row;
the others are made alike, as sheets are in ECMA-376 part 1, 18.3.1: cells ``c`` with their place, format and value.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Collection, Iterable, Mapping, Sequence

from drivesizer.output.report.lines.rows import Row
from drivesizer.output.report.sections.sheet import Sheet

__all__ = ["filled", "sampled"]

_LEVEL = 3  # of packing: digits of a record hardly pack better at more
_END = "</sheetData>"
_FORMAT = re.compile(r'<c r="A2" s="(\d+)">')
_EXTENT = re.compile(r'(?<=<dimension ref=")A1:([A-Z]+)2(?=")')


def sampled(sheet: Sheet) -> bool:
    """Whether a sheet has nothing but numbers in one format."""
    return len(sheet.rows) > 1 and all(column.form == "sample" for column in sheet.columns)


def filled(book: bytes, tables: Mapping[int, Sequence[Row]]) -> bytes:
    """A workbook with the rest of its long tables."""
    if not tables:
        return book
    stream, names = io.BytesIO(), {f"xl/worksheets/sheet{number}.xml": rows for number, rows in tables.items()}
    with zipfile.ZipFile(io.BytesIO(book)) as old, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename in names:
                content = _with_rows(content.decode(), names[entry.filename]).encode()
            new.writestr(entry, content, compresslevel=_LEVEL)
    return stream.getvalue()


def _with_rows(sheet: str, rows: Sequence[Row]) -> str:
    """A sheet whose rows behind the first are added."""
    found = _FORMAT.search(sheet)
    assert found is not None
    cells = [f'<c r="{_letters(place)}%d" s="{found[1]}"><v>%.16G</v></c>' for place in range(len(rows[0]))]
    made = _rows([row.values() for row in rows[1:]], cells)
    head, end, rest = sheet.partition(_END)
    head = _EXTENT.sub(rf"A1:\g<1>{len(rows) + 1}", head)
    return "".join((head, *made, end, rest))


def _rows(rows: Sequence[Collection[float]], cells: Sequence[str]) -> Iterable[str]:
    """The rows from the third on: each at once where all is known, as of most records."""
    columns, numbers = [*zip(*rows, strict=True)], range(3, len(rows) + 3)
    if all(math.isfinite(sum(column)) for column in columns):
        parts = (part for column in columns for part in (numbers, column))
        whole = f'<row r="%d">{"".join(cells)}</row>'
        return map(whole.__mod__, zip(numbers, *parts, strict=True))
    return (f'<row r="{n}">{_known(n, row, cells)}</row>' for n, row in zip(numbers, rows, strict=True))


def _known(number: int, values: Iterable[float], cells: Sequence[str]) -> str:
    """The cells of a row that are known."""
    return "".join(cell % (number, v) for cell, v in zip(cells, values, strict=True) if math.isfinite(v))


def _letters(place: int) -> str:
    """Name of a column, from 0.

    >>> _letters(0), _letters(25), _letters(26)
    ('A', 'Z', 'AA')
    """
    return (_letters(place // 26 - 1) if place >= 26 else "") + chr(ord("A") + place % 26)
