"""XLSX: a sheet for each section; numbers are numbers, sums and margins are formulas, and no text is computed."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import cache
from math import isclose, isfinite, isinf, isnan
from typing import Any

import numpy as np

from drivesizer.output.document.axes import MachineContent, wide_of
from drivesizer.output.document.content import Content
from drivesizer.output.document.records import (
    BOOK,
    Bar,
    Bullets,
    Cell,
    Code,
    Column,
    Mark,
    Printed,
    Quantity,
    Row,
    Series,
    Status,
    Table,
    Verdict,
    Words,
    flat,
    text_of,
)  # fmt: skip
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.thinning import curve_points
from drivesizer.output.words import likely, visible
from drivesizer.results.check import GRAVEST
from drivesizer.units import from_si, label

MOST_ROWS = 1_048_575  # that a sheet has below its head
MOST_SAMPLES = 50_000  # of series: what a spreadsheet opens at once; the CSV report has all
_UNDATED = datetime(2000, 1, 1)  # a file with the time of its making is never the same again
_PLAIN = {"strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
_Pen = Callable[..., Any]  # look, and how a number is shown: a format of the workbook

_ACCENT, _ALARM, _SOFT = "#0B5B8C", "#C04A00", "#6E6E6E"
_MIDDLE: dict[str, Any] = {"align": "center", "valign": "top"}
_LEFT: dict[str, Any] = {"align": "left", "valign": "top", "indent": 1}  # clear of the number to the left
_HEAD: dict[str, Any] = {
    "bold": True,
    "font_color": "white",
    "bg_color": _ACCENT,
    "text_wrap": True,
    "valign": "vcenter",
}
_LOOKS: dict[str, dict[str, Any]] = {
    "head": {**_HEAD, "align": "left", "indent": 1},
    "right head": {**_HEAD, "align": "right"},
    "part": {"bold": True, "indent": 1, "font_color": _ACCENT, "bottom": 1, "bottom_color": _ACCENT},
    "text": {"text_wrap": True, **_LEFT},
    "code": {"font_name": "Consolas", "font_size": 10},
    "unit": {"font_color": _SOFT, **_LEFT},
    "number": {"valign": "top"},
    "total": {"valign": "top", "bold": True, "top": 1},
    "total text": {"bold": True, "top": 1, **_LEFT},
    "unquoted": {"font_color": _ALARM, "italic": True, **_LEFT},
    "pass": {"bg_color": "#DDF0E6", "font_color": "#00613F", **_MIDDLE},
    "fail": {"bg_color": _ALARM, "font_color": "white", "bold": True, **_MIDDLE},
    "open": {"bg_color": "#FDF0D0", "font_color": "#6B4A00", "italic": True, **_MIDDLE},
    "unknown": {"bg_color": "#EBEBEB", "font_color": "#404040", "italic": True, **_MIDDLE},
}
_FORMS = {
    "margin": "[>=0.0995]+0 %;[Red][<0]-0.0 %;+0.0 %",
    "count": "#,##0",
    "money": "0.00",
}  # by kind; [Red] is a colour
_LINE, _NARROW, _MOST_LINES, _WIDEST = (
    15,
    1.15,
    25,
    60,
)  # points of a line; letters for each digit of width; lines; letters


def shown(value: float, digits: int = 4) -> str:
    """The number format that shows a value with so many digits; an exponent for what is very small or large.

    >>> shown(26.304), shown(5.0), shown(12345.6), shown(2.3e-7)
    ('0.0', '0', '0', '0.000E+00')
    """
    text = f"{value:.{digits}g}"
    if value and not 1e-3 <= abs(value) < 1e6:
        return f"0.{'0' * (digits - 1)}E+00"
    decimals = len(text.partition(".")[2]) if "e" not in text else 0
    return f"0.{'0' * decimals}" if decimals else "0"


@dataclass
class _Page:
    """A sheet as it is filled: the rows so far, and the longest text of each column."""

    page: Any
    pen: _Pen
    row: int = 0
    widths: dict[int, int] = field(default_factory=dict)

    def write(self, place: int, text: str, look: str) -> None:
        """A text; no cell without one."""
        if text:
            self.page.write_string(self.row, place, visible(text), self.pen(look))
            if look != "part":
                longest = (
                    max(map(len, text.splitlines() or [""])) if "head" not in look else max(map(len, text.split(" ")))
                )
                self.widths[place] = min(max(self.widths.get(place, 8), longest), 110 if look == "code" else _WIDEST)


@dataclass
class _Stack:
    """Tables of equal columns as one: of several drives and axes, which then are columns of it."""

    caption: str
    columns: Sequence[Column]
    rows: list[tuple[str, float, Row]] = field(default_factory=list)  # axis, rank of the drive, row


def report_xlsx(content: Content | MachineContent) -> bytes:
    """The report as an XLSX file; the same input gives the same bytes."""
    return written(wide_of(content, BOOK))


def written(sections: Iterable[Printed]) -> bytes:
    """Sections as an XLSX file."""
    from xlsxwriter import Workbook

    stream = io.BytesIO()
    book = Workbook(stream, {"in_memory": True, **_PLAIN})
    book.set_properties({"title": "Drive sizing", "created": _UNDATED})
    pen = cache(lambda look, number="": book.add_format(_LOOKS[look] | ({"num_format": number} if number else {})))
    names, records = list[str](), dict[int, Any]()
    sheets: dict[str, list[Printed]] = {}
    title = ""
    for one in sections:
        title = one.title or title
        sheets.setdefault(title, []).append(one)
    for title, found in sheets.items():
        items = [*_items(found)]
        if any(isinstance(item, _Stack) for item in items):
            _fill(_Page(book.add_worksheet(_name(title, names)), pen), items)
        for one in found:
            for series in (block for block in flat(one.blocks) if isinstance(block, Series)):
                page = book.add_worksheet(_name(f"{one.axis} over time" if one.axis else series.title, names))
                records[len(book.worksheets())] = _series(book, page, series, pen)
    book.close()
    return _with_records(stream.getvalue(), {number: rows for number, rows in records.items() if len(rows) > 1})


def _name(title: str, taken: list[str]) -> str:
    """The name of a sheet, of which a workbook has each once whatever its capitals, and that it cuts."""
    bare = re.sub(r"[\[\]:*?/\\]", " ", title).strip("' ") or "Sheet"
    for number in range(1, 2 + len(taken)):
        end = "" if number == 1 else f" {number}"
        name = bare[: 31 - len(end)].strip() + end
        if name.lower() not in taken:
            break
    taken.append(name.lower())
    return name


def _items(found: Sequence[Printed]) -> Iterable[_Stack | Verdict | Words | Bullets]:
    """Tables and texts of a sheet in their order; those of drives and axes by their columns."""
    stacks: dict[tuple[str, ...], _Stack] = {}
    items: list[Any] = []
    for one in found:
        shared = bool(one.axis) or not isnan(one.rank)
        for block in flat(one.blocks):
            if isinstance(block, Verdict | Words | Bullets) and not shared:
                items.append(block)
            elif isinstance(block, Table) and block.media in BOOK and block.rows:
                columns = [column for column in block.columns if column.media in BOOK]
                key = (*(column.key for column in columns), *([] if shared else [str(len(items))]))
                if key not in stacks:
                    stacks[key] = _Stack(text_of(block.caption) if not shared else "", columns)
                    items.append(stacks[key])
                stacks[key].rows += [(one.axis, one.rank, row) for row in block.rows]
    return items


def _fill(sheet: _Page, items: Sequence[Any]) -> None:
    """Write the tables and texts of a sheet, the first table at its top; and set up how it is seen and printed."""
    tables = [item for item in items if isinstance(item, _Stack)]
    across, still = max(2, *(len(stack.columns) for stack in tables)), 1
    for item in items if len(tables) > 1 else sorted(items, key=lambda item: not isinstance(item, _Stack)):
        if sheet.row:
            sheet.row += 1
        if not isinstance(item, _Stack):
            _write_texts(sheet, item, across)
            continue
        if len(tables) > 1 and item.caption:
            sheet.write(0, item.caption, "part")
            sheet.row += 1
        columns, first = _write_table(sheet, item)
        across = max(across, columns)
        if len(tables) == 1:
            sheet.page.autofilter(first, 0, sheet.row - 1, columns - 1)
            still = 1 + next((n for n, column in enumerate(item.columns) if column.key == "title"), 0)
    for place in range(across):
        sheet.page.set_column(place, place, sheet.widths.get(place, 8) + 2.5)
    sheet.page.freeze_panes(1, still if len(tables) == 1 else 0)
    sheet.page.set_landscape()
    sheet.page.set_paper(9)  # A4
    sheet.page.fit_to_pages(1 if across <= 16 else 2, 0)
    sheet.page.repeat_rows(0)
    sheet.page.set_footer("&L&A&Rpage &P of &N")


def _write_texts(sheet: _Page, block: Verdict | Words | Bullets, across: int) -> None:
    """Texts over all columns, a row each."""
    heads = [block.intro] if isinstance(block, Bullets) else []
    texts = (
        block.paragraphs if isinstance(block, Verdict) else block.items if isinstance(block, Bullets) else [block.text]
    )
    for look, text in [*(("part", text) for text in heads), *(("text", text) for text in texts)]:
        shown_text = visible(text_of(text))
        sheet.page.merge_range(sheet.row, 0, sheet.row, across - 1, "", sheet.pen(look))
        sheet.page.write_string(sheet.row, 0, shown_text, sheet.pen(look))
        lines = _lines(shown_text, sum(sheet.widths.get(place, 12) for place in range(across)))
        sheet.page.set_row(sheet.row, _LINE * min(max(lines, 1), _MOST_LINES))
        sheet.row += 1


def _write_table(sheet: _Page, stack: _Stack) -> tuple[int, int]:
    """A table with its head; how many columns it has, and the row of its head."""
    rows, head = stack.rows, sheet.row
    places: dict[str, int] = {}  # of each column by its key
    layout: list[
        tuple[str, str, Column | None, str]
    ] = []  # key, head, column, what of a cell: value, unit, si or si unit
    if any(axis for axis, _, _ in rows):
        layout.append(("axis", "axis", None, "axis"))
    if any(not isnan(rank) for _, rank, _ in rows):
        layout.append(("drive", "drive", None, "rank"))
    units_before: list[str] = []
    for column in stack.columns:
        cells = [row.cells.get(column.key, "") for _, _, row in rows if not row.total]
        units = [cell.unit if isinstance(cell, Quantity) and cell.unit not in ("1", "%") else "" for cell in cells]
        found = {unit for unit in units if unit}
        named = column.head or ("status" if column.form == "status" else column.key)
        named += f" ({label(found.copy().pop())})" if len(found) == 1 else ""
        places[column.key] = len(layout)
        layout.append((column.key, named, column, "value"))
        if len(found) > 1 and units != units_before:
            layout.append((column.key, "unit", column, "unit"))
        units_before = units if len(found) > 1 else units_before
        if len(found) > 1 and column.key == "value":
            layout += [(column.key, "SI value", column, "si"), (column.key, "SI unit", column, "si unit")]
    for place, (_, named, wanted, part) in enumerate(layout):
        right = part in ("si", "rank") or (part == "value" and wanted is not None and wanted.form == "number")
        sheet.write(place, named, "right head" if right else "head")
    sheet.page.set_row(
        head,
        _LINE * 1.5 * max(1, *(_lines(named, sheet.widths.get(n, 8)) for n, (_, named, _, _) in enumerate(layout))),
    )
    sheet.row += 1
    for axis, rank, row in rows[: MOST_ROWS - sheet.row]:
        lines = 1
        for place, (key, _, wanted, part) in enumerate(layout):
            cell = row.cells.get(key, "")
            if part == "axis":
                sheet.write(place, axis, "text")
            elif part == "rank":
                if not isnan(rank):
                    sheet.page.write_number(sheet.row, place, rank, sheet.pen("number", "0"))
            elif part == "value" and wanted is not None:
                unit = next(
                    (c.unit for _, _, r in rows if isinstance(c := r.cells.get(key), Quantity) and not r.total), ""
                )
                _write_cell(sheet, place, cell, wanted, row, places, head + 1, rows, unit)
                if not isinstance(cell, Quantity | Bar) and wanted.form != "code":
                    lines = max(lines, _lines(text_of(cell), _WIDEST))
            elif isinstance(cell, Quantity) and part == "si":
                _write_number(sheet, place, cell.value, shown(cell.value) if isfinite(cell.value) else "", "number")
            elif isinstance(cell, Quantity):
                sheet.write(place, label(cell.unit if part == "unit" else cell.si_unit), "unit")
        if lines > 1:
            sheet.page.set_row(
                sheet.row, _LINE * min(lines, _MOST_LINES)
            )  # not all spreadsheets make room for what wraps
        sheet.row += 1
    return len(layout), head


def _write_cell(sheet: _Page, place: int, cell: Cell, column: Column, row: Row, places: Mapping[str, int], first: int,
                rows: Sequence[tuple[str, float, Row]], unit: str) -> None:  # fmt: skip
    """One cell; what is unknown is left empty, sums and what a column's formula gives are formulas."""
    if isinstance(cell, Bar):
        return
    if not isinstance(cell, Quantity):
        mark = cell[0] if isinstance(cell, tuple) and cell else ""
        text = text_of(cell)
        look: str = (
            text
            if isinstance(mark, Status) and text in GRAVEST
            else "code"
            if isinstance(mark, Code) or column.form == "code"
            else "text"
        )
        look = "unquoted" if isinstance(mark, Mark) and text not in ("quoted", "computed", "") else look
        sheet.write(place, text, "total text" if row.total and look == "text" else look)
        return
    if row.total and unit and cell.unit != unit and cell.kind not in ("money", "count"):
        cell = Quantity(cell.value, unit, cell.kind, cell.digits)
    number = cell.number
    form = _FORMS.get(cell.kind) or (
        f"0.{'0' * _decimals(number)} %" if cell.kind == "probability" and isfinite(number) else ""
    )
    form = form or (shown(number, cell.digits) if isfinite(number) else "")
    formula = _formula(sheet, cell, column, row, places, first, rows)
    _write_number(sheet, place, number, form, "total" if row.total else "number", formula)


def _decimals(share: float) -> int:
    return len(likely(share).removesuffix(" %").partition(".")[2])


def _write_number(sheet: _Page, place: int, number: float, form: str, look: str, formula: str = "") -> None:
    if isinf(number):
        sheet.write(place, "unbounded" if number > 0.0 else "unbounded below", "text")
    elif formula:
        sheet.page.write_formula(sheet.row, place, formula, sheet.pen(look, form), number)
    elif not isnan(number):
        sheet.page.write_number(sheet.row, place, number, sheet.pen(look, form))


def _formula(sheet: _Page, cell: Quantity, column: Column, row: Row, places: Mapping[str, int], first: int,
             rows: Sequence[tuple[str, float, Row]]) -> str:  # fmt: skip
    """The formula of a cell where it gives the cell's own number; nothing else."""

    def numbers(key: str) -> list[float]:
        return [
            c.number
            for _, _, r in rows
            if not r.total and isinstance(c := r.cells.get(key), Quantity) and isfinite(c.number)
        ]

    if row.total:
        here = _letters(places[column.key])
        last = next(n for n, (_, _, r) in enumerate(rows) if r.total)
        same = isclose(math.fsum(numbers(column.key)), cell.number, rel_tol=1e-9)
        return f"=SUM({here}{first + 1}:{here}{first + last})" if same and last else ""
    if not column.formula:
        return ""
    kind, *keys = column.formula
    given = [row.cells.get(key) for key in keys]
    values = [c.number for c in given if isinstance(c, Quantity)]
    if len(values) < 2 or not all(map(isfinite, values)) or not values[0]:
        return ""
    refs = [f"{_letters(places[key])}{sheet.row + 1}" for key in keys]
    found, formula = (
        (values[0] * values[1], "={}*{}") if kind == "product" else (values[1] / values[0] - 1.0, "={1}/{0}-1")
    )
    return formula.format(*refs) if isclose(found, cell.number, rel_tol=1e-9, abs_tol=1e-12) else ""


def _lines(text: str, width: float) -> int:
    return sum(math.ceil(max(len(line), 1) / (_NARROW * width)) for line in text.splitlines())


def _letters(place: int) -> str:
    """Name of a column, from 0.

    >>> _letters(0), _letters(25), _letters(26)
    ('A', 'Z', 'AA')
    """
    return (_letters(place // 26 - 1) if place >= 26 else "") + chr(ord("A") + place % 26)


# -- Series: long columns of numbers, and a chart of some of them over the first, drawn by the spreadsheet itself.
#
# xlsxwriter keeps and looks at each cell by itself, which takes four times as long. It writes the head and the first
# row; the others are put into the finished file, made as sheets are in ECMA-376 part 1, 18.3.1: cells ``c`` with their
# place, format and value.


_INKS = (COLOURS["grey"], COLOURS["blue"], COLOURS["vermillion"], COLOURS["green"])


def _series(book: Any, page: Any, series: Series, pen: _Pen) -> Any:
    """Write the head and the first row; all rows, of a longer record some evenly and with the peaks of every column."""
    names, units = list(series.columns), [unit for _, _, unit in series.columns.values()]
    columns = [from_si(values, unit, kind) for values, kind, unit in series.columns.values()]
    kept = curve_points(tuple(columns), MOST_SAMPLES)
    rows = np.column_stack([values[kept] for values in columns])
    for place, (name, unit) in enumerate(zip(names, units, strict=True)):
        head = f"{name.replace('_', ' ')} ({label(unit)})" if label(unit) else name.replace("_", " ")
        page.write_string(0, place, head, pen("right head"))
        page.set_column(place, place, max(12, len(head) + 1))
        if len(rows) and isfinite(rows[0, place]):
            page.write_number(1, place, rows[0, place], pen("number", "General"))
    left = (
        f"{len(kept)} of {len(columns[0])} samples, evenly and with the peaks of every column"
        if len(kept) < len(columns[0])
        else ""
    )
    note = "; ".join(filter(None, (series.note, left)))
    if note:
        page.write_string(0, len(names), note, pen("text"))
    page.freeze_panes(1, 1)
    page.set_landscape()
    drawn = [name for name in series.drawn if name in names]
    if drawn and len(rows):
        chart, sheet = book.add_chart({"type": "scatter", "subtype": "straight"}), page.get_name()
        of = [units[names.index(name)] for name in drawn]
        for ink, name, unit in zip(_INKS, drawn, of, strict=False):
            place = names.index(name)
            chart.add_series({
                "name": [sheet, 0, place], "categories": [sheet, 1, 0, len(rows), 0], "values": [sheet, 1, place,
                                                                                                 len(rows), place],
                "line": {"color": ink, "width": 1.0}, "y2_axis": unit != of[0],
                "categories_data": [], "values_data": [],  # read from the sheet: a copy would double the file
            })  # fmt: skip
        chart.set_x_axis({"name": f"time ({units[0]})", "min": 0, "label_position": "low"})
        chart.set_y_axis({"name": label(of[0]), "major_gridlines": {"visible": True, "line": {"color": "#DDDDDD"}}})
        chart.set_y2_axis({"name": label(of[-1])})
        chart.set_legend({"position": "top"})
        chart.set_size({"width": 900, "height": 380})
        page.insert_chart(1, len(names) + 1, chart)
    return rows


def _with_records(book: bytes, tables: Mapping[int, Any]) -> bytes:
    """A workbook with the rest of its series."""
    if not tables:
        return book
    stream, names = io.BytesIO(), {f"xl/worksheets/sheet{number}.xml": rows for number, rows in tables.items()}
    with zipfile.ZipFile(io.BytesIO(book)) as old, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename in names:
                content = _with_rows(content.decode(), names[entry.filename]).encode()
            new.writestr(entry, content, compresslevel=3)  # digits of a record hardly pack better at more
    return stream.getvalue()


def _with_rows(sheet: str, rows: Any) -> str:
    """A sheet whose rows behind the first are added; what is unknown has no cell."""
    style = re.search(r'<c r="[A-Z]+2" s="(\d+)">', sheet)
    look = f' s="{style[1]}"' if style else ""
    cells = [f'<c r="{_letters(place)}%d"{look}><v>%.16G</v></c>' for place in range(rows.shape[1])]
    head, end, rest = sheet.partition("</sheetData>")
    head = re.sub(r'(?<=<dimension ref=")A1:([A-Z]+)\d+(?=")', rf"A1:\g<1>{len(rows) + 1}", head)
    numbers = range(3, len(rows) + 2)
    if np.isfinite(rows).all():
        whole = f'<row r="%d">{"".join(cells)}</row>'
        columns = [part for column in rows[1:].T.tolist() for part in (numbers, column)]
        made: Iterable[str] = map(whole.__mod__, zip(numbers, *columns, strict=True))
    else:
        known = (
            "".join(cell % (n, v) for cell, v in zip(cells, row, strict=True) if isfinite(v))
            for n, row in zip(numbers, rows[1:].tolist(), strict=True)
        )
        made = (f'<row r="{n}">{row}</row>' for n, row in zip(numbers, known, strict=True))
    return "".join((head, *made, end, rest))
