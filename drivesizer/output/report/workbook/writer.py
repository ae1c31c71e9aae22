"""Sheets as the bytes of an XLSX file: numbers are numbers, and no text is computed or made a link.

xlsxwriter is imported when a workbook is made. The same input gives the same bytes: the file carries no date.
"""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from datetime import datetime
from functools import cache
from typing import Any

from drivesizer.output.cells import visible
from drivesizer.output.probability import likely
from drivesizer.output.report.lines.rows import Row
from drivesizer.output.report.sections.sheet import Cell, Sheet, SheetColumn
from drivesizer.output.report.workbook.chart import draw
from drivesizer.output.report.workbook.samples import filled, sampled
from drivesizer.results.check import GRAVEST
from drivesizer.units import label

__all__ = ["MOST_ROWS", "share", "shown", "written"]

MOST_ROWS = 1_048_575  # that a sheet has below its head
_UNDATED = datetime(2000, 1, 1)  # a file with the time of its making is never the same again
_PLAIN = {"strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
_Pen = Callable[..., Any]  # look, and how a number is shown: a format of the workbook


def written(sheets: Sequence[Sheet]) -> bytes:
    """Sheets as an XLSX file; of one that has more rows than a sheet may have, the first, and a note says so."""
    from xlsxwriter import Workbook

    stream = io.BytesIO()
    book = Workbook(stream, {"in_memory": True, **_PLAIN})
    book.set_properties({"title": "Drive sizing", "created": _UNDATED})
    pen = cache(lambda look, number="": book.add_format(_LOOKS[look] | ({"num_format": number} if number else {})))
    tables = {}
    for number, sheet in enumerate(sheets, 1):
        rows = sheet.rows[:MOST_ROWS]
        page = book.add_worksheet(sheet.name)
        _write(page, sheet, rows, pen)
        if sampled(sheet):
            tables[number] = rows
        if sheet.drawn and rows:
            draw(book, page, sheet, len(rows))
    book.close()
    return filled(stream.getvalue(), tables)


_ACCENT, _ALARM, _SOFT = "#0B5B8C", "#C04A00", "#6E6E6E"
_MIDDLE: dict[str, Any] = {"align": "center", "valign": "top"}
_LEFT: dict[str, Any] = {"align": "left", "valign": "top", "indent": 1}  # clear of the number to the left
_HEAD: dict[str, Any] = {
    "bold": True, "font_color": "white", "bg_color": _ACCENT, "text_wrap": True, "valign": "vcenter",
}  # fmt: skip
_LOOKS: dict[str, dict[str, Any]] = {
    "head": {**_HEAD, "align": "left", "indent": 1},
    "right head": {**_HEAD, "align": "right"},
    "part": {"bold": True, "indent": 1, "font_color": _ACCENT, "bottom": 1, "bottom_color": _ACCENT},
    "note": {"italic": True, "indent": 1, "font_color": _SOFT, "valign": "vcenter"},
    "text": {"text_wrap": True, **_LEFT},
    "line": _LEFT,
    "code": {"font_name": "Consolas", "font_size": 10},
    "unit": {"font_color": _SOFT, **_LEFT},
    "number": {"valign": "top"},
    "unquoted": {"font_color": _ALARM, "italic": True, **_LEFT},
    "pass": {"bg_color": "#DDF0E6", "font_color": "#00613F", **_MIDDLE},
    "fail": {"bg_color": _ALARM, "font_color": "white", "bold": True, **_MIDDLE},
    "open": {"bg_color": "#FDF0D0", "font_color": "#6B4A00", "italic": True, **_MIDDLE},
    "unknown": {"bg_color": "#EBEBEB", "font_color": "#404040", "italic": True, **_MIDDLE},
}
_NUMBERS = {  # form -> how a spreadsheet shows it; [Red] is a colour of every spreadsheet
    "percent": "[>=0.0995]+0 %;[Red][<0]-0.0 %;+0.0 %",
    "needed": "0.0 %",
    "error": "0.00 %",
    "correlation": "0.00",
    "count": "0",
    "money": "0.00",
    "sample": "General",
}


def shown(value: float, digits: int = 4) -> str:
    """The number format that shows a value with so many digits; General for what is very small or large.

    Examples
    --------
    >>> shown(26.304), shown(5.0), shown(12345.6), shown(2.3e-7)
    ('0.0', '0', '0', '0.000E+00')
    """
    text = f"{value:.{digits}g}"
    if value and not 1e-3 <= abs(value) < 1e6:
        return f"0.{'0' * (digits - 1)}E+00"
    decimals = len(text.partition(".")[2]) if "e" not in text else 0
    return f"0.{'0' * decimals}" if decimals else "0"


def share(value: float) -> str:
    """The number format of a probability, with the digits that are printed elsewhere: never 100 % where a sample fails.

    >>> share(0.6866), share(0.99996), share(1.0)
    ('0.0 %', '0.000 %', '0 %')
    """
    decimals = len(likely(value).removesuffix(" %").partition(".")[2])
    return f"0.{'0' * decimals} %" if decimals else "0 %"


def _write(page: Any, sheet: Sheet, rows: Sequence[Row], pen: _Pen) -> None:
    note = sheet.note if len(rows) == len(sheet.rows) else f"the first {len(rows)} of {len(sheet.rows)} rows"
    widths = [_width(column, rows) for column in sheet.columns]
    for place, (column, width) in enumerate(zip(sheet.columns, widths, strict=True)):
        page.write_string(0, place, visible(column.head), pen("right head" if _counts(column, rows) else "head"))
        page.set_column(place, place, width + 2.5)
    if note:
        page.write_string(0, len(sheet.columns), visible(note), pen("note"))
    for number, row in enumerate(rows[:1] if sampled(sheet) else rows, 1):
        lines = _write_row(page, number, sheet.columns, widths, row, pen)
        if lines > 1:
            page.set_row(number, _LINE * lines)  # not all spreadsheets make room for what wraps
    page.set_row(0, _LINE * (0.5 + max(_lines(c.head, w) for c, w in zip(sheet.columns, widths, strict=True))))
    _set_up(page, sheet, len(rows))


_LINE = 15  # points
_ONE_LINE = ("code", "line")


def _write_row(
    page: Any, number: int, columns: Sequence[SheetColumn], widths: Sequence[float], row: Row, pen: _Pen
) -> int:
    """One row; how many lines of text it takes."""
    if set(row) <= {"part", "across"}:
        return _write_across(page, number, widths, row, pen)
    lines = 1
    for place, column in enumerate(columns):
        value = row.get(column.key)
        form, value = (value.form, value.value) if isinstance(value, Cell) else (column.form, value)
        _write_cell(page, number, place, value, form, pen)
        if isinstance(value, str) and form not in _ONE_LINE:
            lines = max(lines, _lines(value, widths[place]))
    return min(lines, _MOST_LINES)


def _write_across(page: Any, number: int, widths: Sequence[float], row: Row, pen: _Pen) -> int:
    """A row of one text over all columns; how many lines it takes."""
    ((look, text),) = row.items()
    page.merge_range(number, 0, number, len(widths) - 1, "", pen(_ACROSS[look]))
    page.write_string(number, 0, visible(text), pen(_ACROSS[look]))
    return min(_lines(text, sum(widths)), _MOST_LINES)


_ACROSS = {"part": "part", "across": "text"}
_MOST_LINES = 25  # a row may be 409 points high


def _lines(text: str, width: float) -> int:
    return sum(math.ceil(max(len(line), 1) / (_NARROW * width)) for line in text.splitlines())


_NARROW = 1.15  # letters of a text for each digit that a column is wide


def _write_cell(page: Any, row: int, place: int, value: Any, form: str, pen: _Pen) -> None:
    """One cell; what is unknown is left empty."""
    if isinstance(value, str):
        text = label(value) if form == "unit" else visible(value)
        if text:
            page.write_string(row, place, text, pen(_look(text, form)))
    elif value is not None and math.isinf(value):
        page.write_string(row, place, _endless(value), pen("text"))
    elif value is not None and not math.isnan(value):
        number = share(value) if form == "share" else _NUMBERS.get(form) or shown(value, 6 if form == "datum" else 4)
        page.write_number(row, place, value, pen("number", number))


def _endless(value: float) -> str:
    return "unbounded" if value > 0.0 else "unbounded below"


def _look(text: str, form: str) -> str:
    if form == "status" and text in GRAVEST:
        return text
    if form == "confidence" and text not in ("quoted", "computed"):
        return "unquoted"
    return form if form in ("code", "line", "unit") else "text"


def _counts(column: SheetColumn, rows: Sequence[Row]) -> bool:
    """Whether a column holds a number at all: its head stands to the right then, as numbers do."""
    values = (row.get(column.key) for row in rows)
    return any(isinstance(value, float | int | Cell) for value in values)


def _width(column: SheetColumn, rows: Sequence[Row]) -> int:
    """Letters of the longest text, within bounds, and room for a number; a head may wrap."""
    longest = max(8, *(len(word) for word in (column.head or " ").split(" ")))
    values = (row.get(column.key) for row in rows)
    texts = (line for text in values if isinstance(text, str) for line in text.splitlines())
    return min(max(longest, max(map(len, texts), default=0)), column.widest)


_ON_PAPER = 16  # columns that can still be read on one sheet


def _set_up(page: Any, sheet: Sheet, count: int) -> None:
    """Set up the frozen panes, the filter and the printed page."""
    page.freeze_panes(1, sheet.still)
    if sheet.filtered:
        page.autofilter(0, 0, max(count, 1), len(sheet.columns) - 1)
    page.set_landscape()
    page.set_paper(9)  # A4
    page.fit_to_pages(1 if len(sheet.columns) <= _ON_PAPER else 2, 0)
    page.repeat_rows(0)
    page.print_area(0, 0, max(count, 1), len(sheet.columns) - 1)
    page.set_footer("&L&A&Rpage &P of &N")
