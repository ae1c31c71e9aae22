"""Long tables of numbers in a workbook: rows put into the finished file, a whole row at a time.

xlsxwriter keeps and looks at each cell by itself, which takes four times as long. It writes the head and the first row;
the others are made alike, as sheets are in ECMA-376 part 1, 18.3.1: cells ``c`` with their place, format and value.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Mapping, Sequence

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
    """A workbook with the rest of its long tables.

    Parameters
    ----------
    book
        The file, with the head and the first row of each such table.
    tables
        All rows of each, without text, by the number of their sheet, from 1.

    Returns
    -------
    bytes
        The file; what is unknown is left empty.
    """
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
    whole = "".join(cells)
    made = (_row(n, [*row.values()], cells, whole) for n, row in enumerate(rows[1:], 3))
    head, end, rest = sheet.partition(_END)
    head = _EXTENT.sub(rf"A1:\g<1>{len(rows) + 1}", head)
    return "".join((head, *made, end, rest))


def _row(number: int, values: list[float], cells: list[str], whole: str) -> str:
    """A row of the sheet: at once where all is known."""
    if math.isfinite(sum(values)):
        body = whole % tuple(part for value in values for part in (number, value))
    else:
        body = "".join(c % (number, v) for c, v in zip(cells, values, strict=True) if math.isfinite(v))
    return f'<row r="{number}">{body}</row>'


def _letters(place: int) -> str:
    """Name of a column, from 0.

    >>> _letters(0), _letters(25), _letters(26)
    ('A', 'Z', 'AA')
    """
    return (_letters(place // 26 - 1) if place >= 26 else "") + chr(ord("A") + place % 26)
