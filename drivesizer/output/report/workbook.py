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
from typing import Any, NamedTuple

import numpy as np

from drivesizer.output.document import records as doc
from drivesizer.output.document.axes import Reportable, wide_of
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
_HEAD: dict[str, Any] = {"bold": True, "font_color": "white", "bg_color": _ACCENT, "text_wrap": True,
                         "valign": "vcenter"}  # fmt: skip
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
_FORMS = {"margin": "[>=0.0995]+0 %;[Red][<0]-0.0 %;+0.0 %", "count": "#,##0", "money": "0.00"}  # [Red] is a colour
_LINE, _MOST_LINES = 15, 25  # points of a line; lines of a row
_NARROW, _WIDEST = 1.15, 60  # letters for each digit of width; letters of a column


def number_format(value: float, digits: int = 4) -> str:
    """The number format that shows a value with so many digits; an exponent for what is very small or large.

    >>> tuple(map(number_format, (26.304, 5.0, 12345.6, 2.3e-7)))
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
        if not text:
            return
        self.page.write_string(self.row, place, visible(text), self.pen(look))
        if look != "part":
            pieces = text.split(" ") if "head" in look else text.splitlines() or [""]
            most = 110 if look == "code" else _WIDEST
            self.widths[place] = min(max(self.widths.get(place, 8), *map(len, pieces)), most)

    def number(self, place: int, number: float, form: str, look: str, formula: str = "") -> None:
        """A number, or a formula that gives it; what is unknown is left empty."""
        if isinf(number):
            self.write(place, "unbounded" if number > 0.0 else "unbounded below", "text")
        elif formula:
            self.page.write_formula(self.row, place, formula, self.pen(look, form), number)
        elif not isnan(number):
            self.page.write_number(self.row, place, number, self.pen(look, form))

    def high(self, row: int, lines: float) -> None:
        """Room for a row: not all spreadsheets make it for what wraps."""
        self.page.set_row(row, _LINE * min(lines, _MOST_LINES))


class _Line(NamedTuple):
    """A row of a table, of a drive and of an axis."""

    axis: str
    rank: float
    row: doc.Row


@dataclass
class _Stack:
    """Tables of equal columns as one: of several drives and axes, which then are columns of it."""

    caption: str
    columns: Sequence[doc.Column]
    lines: list[_Line] = field(default_factory=list)

    def numbers(self, key: str) -> list[doc.Quantity]:
        """The figures of a column without its sum."""
        cells = (line.row.cells.get(key) for line in self.lines if not line.row.total)
        return [cell for cell in cells if isinstance(cell, doc.Quantity)]


class _Place(NamedTuple):
    """A column of a sheet: what it shows of the cells of a table's column."""

    head: str
    key: str
    part: str  # axis, rank, value, unit, SI value or SI unit
    form: str = ""


def report_xlsx(content: Reportable) -> bytes:
    """The report as an XLSX file; the same input gives the same bytes."""
    return written(wide_of(content, doc.BOOK))


def written(sections: Iterable[doc.Printed]) -> bytes:
    """Sections as an XLSX file."""
    from xlsxwriter import Workbook

    stream = io.BytesIO()
    book = Workbook(stream, {"in_memory": True, **_PLAIN})
    book.set_properties({"title": "Drive sizing", "created": _UNDATED})
    pen = cache(lambda look, number="": book.add_format(_LOOKS[look] | ({"num_format": number} if number else {})))
    names, records = list[str](), dict[int, Any]()
    sheets: dict[str, list[doc.Printed]] = {}
    title = ""
    for section in sections:
        title = section.title or title
        sheets.setdefault(title, []).append(section)
    for title, printed in sheets.items():
        items = [*_items(printed)]
        if any(isinstance(item, _Stack) for item in items):
            _fill(_Page(book.add_worksheet(_name(title, names)), pen), items)
        for section in printed:
            for series in (block for block in doc.flat(section.blocks) if isinstance(block, doc.Series)):
                page = book.add_worksheet(_name(f"{section.axis} over time" if section.axis else series.title, names))
                records[len(book.worksheets())] = _series(book, page, series, pen)
    book.close()
    return _with_records(stream.getvalue(), {number: rows for number, rows in records.items() if len(rows) > 1})


def _name(title: str, names: list[str]) -> str:
    """The name of a sheet, of which a workbook has each once whatever its capitals, and that it cuts."""
    bare = re.sub(r"[\[\]:*?/\\]", " ", title).strip("' ") or "Sheet"
    for number in range(1, 2 + len(names)):
        end = "" if number == 1 else f" {number}"
        name = bare[: 31 - len(end)].strip() + end
        if name.lower() not in names:
            break
    names.append(name.lower())
    return name


def _items(sections: Sequence[doc.Printed]) -> Iterable[Any]:
    """Tables and texts of a sheet in their order; those of drives and axes by their columns."""
    stacks: dict[tuple[str, ...], _Stack] = {}
    items: list[Any] = []
    for section in sections:
        shared = bool(section.axis) or not isnan(section.rank)
        for block in doc.flat(section.blocks):
            if isinstance(block, doc.Verdict | doc.Words | doc.Bullets) and not shared:
                items.append(block)
            elif isinstance(block, doc.Table) and block.media in doc.BOOK and block.rows:
                columns = [column for column in block.columns if column.media in doc.BOOK]
                key = (*(column.key for column in columns), *([] if shared else [str(len(items))]))
                if key not in stacks:
                    stacks[key] = _Stack("" if shared else doc.text_of(block.caption), columns)
                    items.append(stacks[key])
                stacks[key].lines += [_Line(section.axis, section.rank, row) for row in block.rows]
    return items


def _fill(sheet: _Page, items: Sequence[Any]) -> None:
    """Write the tables and texts of a sheet, the first table at its top; and set up how it is seen and printed."""
    tables = [item for item in items if isinstance(item, _Stack)]
    across, still = max(2, *(len(stack.columns) for stack in tables)), 0
    for item in items if len(tables) > 1 else sorted(items, key=lambda item: not isinstance(item, _Stack)):
        sheet.row += bool(sheet.row)
        if not isinstance(item, _Stack):
            _write_texts(sheet, item, across)
            continue
        if len(tables) > 1 and item.caption:
            sheet.write(0, item.caption, "part")
            sheet.row += 1
        first, columns = sheet.row, _write_table(sheet, item)
        across = max(across, columns)
        if len(tables) == 1:
            sheet.page.autofilter(first, 0, sheet.row - 1, columns - 1)
            still = 1 + next((n for n, column in enumerate(item.columns) if column.key == "title"), 0)
    for place in range(across):
        sheet.page.set_column(place, place, sheet.widths.get(place, 8) + 2.5)
    sheet.page.freeze_panes(1, still)
    sheet.page.set_landscape()
    sheet.page.set_paper(9)  # A4
    sheet.page.fit_to_pages(1 if across <= 16 else 2, 0)
    sheet.page.repeat_rows(0)
    sheet.page.set_footer("&L&A&Rpage &P of &N")


def _write_texts(sheet: _Page, block: doc.Verdict | doc.Words | doc.Bullets, across: int) -> None:
    """Texts over all columns, a row each."""
    match block:
        case doc.Verdict():
            texts = [("text", text) for text in block.paragraphs]
        case doc.Bullets():
            texts = [("part", block.intro), *(("text", text) for text in block.items)]
        case _:
            texts = [("text", block.text)]
    for look, text in texts:
        plain = visible(doc.text_of(text))
        sheet.page.merge_range(sheet.row, 0, sheet.row, across - 1, "", sheet.pen(look))
        sheet.page.write_string(sheet.row, 0, plain, sheet.pen(look))
        sheet.high(sheet.row, max(1, _lines(plain, sum(sheet.widths.get(place, 12) for place in range(across)))))
        sheet.row += 1


def _places(stack: _Stack) -> list[_Place]:
    """The columns of a sheet: units beside figures of several units, and the SI beside a value."""
    places = [_Place("axis", "", "axis")] if any(line.axis for line in stack.lines) else []
    places += [_Place("drive", "", "rank")] if any(not isnan(line.rank) for line in stack.lines) else []
    before: list[str] = []
    for column in stack.columns:
        cells = (line.row.cells.get(column.key, "") for line in stack.lines if not line.row.total)
        units = [c.unit if isinstance(c, doc.Quantity) and c.unit not in ("1", "%") else "" for c in cells]
        kinds = {unit for unit in units if unit}
        named = column.head or ("status" if column.form == "status" else column.key)
        named += f" ({label(min(kinds))})" if len(kinds) == 1 else ""
        places.append(_Place(named, column.key, "value", column.form))
        if len(kinds) > 1:
            places += [_Place("unit", column.key, "unit")] if units != before else []
            places += [_Place(f"SI {of}", column.key, f"SI {of}") for of in ("value", "unit") if column.key == "value"]
            before = units
    return places


def _write_table(sheet: _Page, stack: _Stack) -> int:
    """A table with its head; how many columns of the sheet it has."""
    places, first = _places(stack), sheet.row + 1
    for n, place in enumerate(places):
        right = place.part in ("SI value", "rank") or (place.part == "value" and place.form == "number")
        sheet.write(n, place.head, "right head" if right else "head")
    sheet.high(sheet.row, 1.5 * max(1, *(_lines(place.head, sheet.widths.get(n, 8)) for n, place in enumerate(places))))
    sheet.row += 1
    letters = {place.key: _letters(n) for n, place in enumerate(places) if place.part == "value"}
    columns = {column.key: column for column in stack.columns}
    units = {key: next((cell.unit for cell in stack.numbers(key)), "") for key in columns}
    for line in stack.lines[: MOST_ROWS - sheet.row]:
        lines = 1
        for n, place in enumerate(places):
            cell = line.row.cells.get(place.key, "")
            if place.part == "axis":
                sheet.write(n, line.axis, "text")
            elif place.part == "rank":
                sheet.number(n, line.rank, "0", "number")
            elif isinstance(cell, doc.Quantity):
                _write_figure(sheet, n, place, cell, line.row, units[place.key],
                              _formula(sheet, stack, columns[place.key], line.row, letters, first))  # fmt: skip
            elif place.part == "value" and not isinstance(cell, doc.Bar):
                _write_text(sheet, n, cell, place.form, total=line.row.total)
                lines = max(lines, _lines(doc.text_of(cell), _WIDEST) if place.form != "code" else 1)
        if lines > 1:
            sheet.high(sheet.row, lines)
        sheet.row += 1
    return len(places)


def _write_text(sheet: _Page, n: int, cell: doc.Cell, form: str, *, total: bool) -> None:
    mark, text = cell[0] if isinstance(cell, tuple) and cell else "", doc.text_of(cell)
    look = "total text" if total else "text"
    if isinstance(mark, doc.Status) and text in GRAVEST:
        look = text
    elif isinstance(mark, doc.Code) or form == "code":
        look = "code"
    elif isinstance(mark, doc.Mark) and text not in ("quoted", "computed", ""):
        look = "unquoted"
    sheet.write(n, text, look)


def _write_figure(
    sheet: _Page, n: int, place: _Place, cell: doc.Quantity, row: doc.Row, unit: str, formula: str
) -> None:  # fmt: skip
    """A figure in its unit, its unit, or the same in SI; what is unknown is left empty."""
    if place.part in ("unit", "SI unit"):
        sheet.write(n, label(cell.unit if place.part == "unit" else cell.si_unit), "unit")
        return
    if place.part == "SI value":
        sheet.number(n, cell.value, number_format(cell.value) if isfinite(cell.value) else "", "number")
        return
    if row.total and unit and cell.unit != unit and cell.kind not in ("money", "count"):
        cell = doc.Quantity(cell.value, unit, cell.kind, cell.digits)
    number = cell.number
    form = _FORMS.get(cell.kind, "")
    if not form and isfinite(number):
        decimals = len(likely(number).removesuffix(" %").partition(".")[2]) if cell.kind == "probability" else 0
        form = f"0.{'0' * decimals} %" if cell.kind == "probability" else number_format(number, cell.digits)
    sheet.number(n, number, form, "total" if row.total else "number", formula)


def _formula(
    sheet: _Page, stack: _Stack, column: doc.Column, row: doc.Row, letters: Mapping[str, str], first: int
) -> str:  # fmt: skip
    """The formula of a cell, of a sum or of its column, where it gives the cell's own number; else nothing."""
    cell = row.cells[column.key]
    assert isinstance(cell, doc.Quantity)
    if row.total:
        here, last = letters[column.key], next(n for n, line in enumerate(stack.lines) if line.row.total)
        known = [quantity.number for quantity in stack.numbers(column.key) if isfinite(quantity.number)]
        unit = next((quantity.unit for quantity in stack.numbers(column.key)), cell.unit)
        summed = cell if cell.kind in ("money", "count") else doc.Quantity(cell.value, unit, cell.kind)
        same = isclose(math.fsum(known), summed.number, rel_tol=1e-9)
        return f"=SUM({here}{first + 1}:{here}{first + last})" if same and last else ""
    kind, *keys = column.formula or ("",)
    values = [c.number for key in keys if isinstance(c := row.cells.get(key), doc.Quantity)]
    if len(values) < 2 or not all(map(isfinite, values)) or not values[0]:
        return ""
    refs = [f"{letters[key]}{sheet.row + 1}" for key in keys]
    product = kind == "product"
    result = values[0] * values[1] if product else values[1] / values[0] - 1.0
    formula = ("={}*{}" if product else "={1}/{0}-1").format(*refs)
    return formula if isclose(result, cell.number, rel_tol=1e-9, abs_tol=1e-12) else ""


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


def _series(book: Any, page: Any, series: doc.Series, pen: _Pen) -> Any:
    """Write the head and the first row; all rows, of a longer record some evenly and with the peaks of every column."""
    names, units = list(series.columns), [unit for _, _, unit in series.columns.values()]
    columns = [from_si(values, unit, kind) for values, kind, unit in series.columns.values()]
    samples = curve_points(tuple(columns), MOST_SAMPLES)
    rows = np.column_stack([values[samples] for values in columns])
    for place, (name, unit) in enumerate(zip(names, units, strict=True)):
        head = f"{name.replace('_', ' ')} ({label(unit)})" if label(unit) else name.replace("_", " ")
        page.write_string(0, place, head, pen("right head"))
        page.set_column(place, place, max(12, len(head) + 1))
        if len(rows) and isfinite(rows[0, place]):
            page.write_number(1, place, rows[0, place], pen("number", "General"))
    thinned = len(samples) < len(columns[0])
    left = f"{len(samples)} of {len(columns[0])} samples, evenly and with the peaks of every column" if thinned else ""
    note = "; ".join(filter(None, (series.note, left)))
    if note:
        page.write_string(0, len(names), note, pen("text"))
    page.freeze_panes(1, 1)
    page.set_landscape()
    curves = [name for name in series.chart_columns if name in names]
    if curves and len(rows):
        chart, sheet = book.add_chart({"type": "scatter", "subtype": "straight"}), page.get_name()
        of = [units[names.index(name)] for name in curves]
        for ink, name, unit in zip(_INKS, curves, of, strict=False):
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
        lines: Iterable[str] = map(whole.__mod__, zip(numbers, *columns, strict=True))
    else:
        known = (
            "".join(cell % (n, v) for cell, v in zip(cells, row, strict=True) if isfinite(v))
            for n, row in zip(numbers, rows[1:].tolist(), strict=True)
        )
        lines = (f'<row r="{n}">{row}</row>' for n, row in zip(numbers, known, strict=True))
    return "".join((head, *lines, end, rest))
