"""XLSX: the report as a workbook, sheets of every section; numbers are numbers, and no text is computed."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any

from drivesizer.output.parts import totals
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.rows import Row, driven_over
from drivesizer.output.report.machine import (
    AxisContent,
    MachineContent,
    assumptions,
    drive_name,
    loop_sheet,
    loop_summary,
    notes,
    power_columns,
    time_series_sheets,
    verdict_text,
    warnings,
)
from drivesizer.output.report.sections import SECTIONS
from drivesizer.output.report.sections.appendix import about, about_sheet, file_sheet
from drivesizer.output.report.sections.machine import PART_COLUMNS, part_sheet_row
from drivesizer.output.report.sections.section import (
    LIMITS,
    STATUS,
    Cell,
    Content,
    Sheet,
    SheetColumn,
    headed,
    sheets_of,
    text_of,
)
from drivesizer.output.report.sections.summary import check_line, priced, texts
from drivesizer.output.words import likely, visible
from drivesizer.results.check import GRAVEST, tightest
from drivesizer.results.machine import CarriedMass
from drivesizer.results.sizing import objective_figure
from drivesizer.units import from_si, label

__all__ = ["MOST_ROWS", "share", "sheets", "shown", "written"]


# -- The chart of a workbook: columns of a sheet over its first, drawn by the spreadsheet itself.


_INKS = (COLOURS["grey"], COLOURS["blue"], COLOURS["vermillion"])


def draw(book: Any, page: Any, sheet: Sheet, count: int) -> None:
    """Draw what a sheet names beside its rows; a column in another unit than the first has its own axis."""
    drawing, places = book.add_chart(_SCATTER), {column.key: place for place, column in enumerate(sheet.columns)}
    units = [_unit(sheet.columns[places[key]]) for key in sheet.drawn]
    for ink, key, unit in zip(_INKS, sheet.drawn, units, strict=True):
        drawing.add_series({
            "name": [sheet.name, 0, places[key]],
            "categories": [sheet.name, 1, 0, count, 0],
            "values": [sheet.name, 1, places[key], count, places[key]],
            "line": {"color": ink, "width": 1.0},
            "y2_axis": unit != units[0],
            "categories_data": [], "values_data": [],  # read from the sheet: a copy would double the file
        })  # fmt: skip
    drawing.set_x_axis({"name": sheet.columns[0].head, "min": 0, "label_position": "low"})
    drawing.set_y_axis({"name": units[0], "major_gridlines": {"visible": True, "line": {"color": "#DDDDDD"}}})
    drawing.set_y2_axis({"name": units[-1]})
    drawing.set_legend({"position": "top"})
    drawing.set_size({"width": 900, "height": 380})
    page.insert_chart(1, len(sheet.columns) + 1, drawing)


def _unit(column: SheetColumn) -> str:
    return column.head.partition("(")[2].removesuffix(")")


_SCATTER = {"type": "scatter", "subtype": "straight"}


# -- Long tables of numbers in a workbook: rows put into the finished file, a whole row at a time.
#
# xlsxwriter keeps and looks at each cell by itself, which takes four times as long. It writes the head and the first
# row; the others are made alike, as sheets are in ECMA-376 part 1, 18.3.1: cells ``c`` with their place, format and
# value.


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


# -- Sheets as the bytes of an XLSX file: numbers are numbers, and no text is computed or made a link.
#
# xlsxwriter is imported when a workbook is made. The same input gives the same bytes: the file carries no date.


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


def render(content: Content, path: Path) -> dict[Path, bytes]:
    """The file of an XLSX report."""
    return {path: written(sheets(content))}


def sheets(content: Content) -> list[Sheet]:
    """The sheets of a report in their order, as plain data."""
    found = [sheet for section in SECTIONS for sheet in sheets_of(section, content)]
    return [*found, about(content, found)]


# -- XLSX of a machine: sheets of the machine, its axes, parts and closed loops, then those of each axis.


def render_machine(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """The file of an XLSX report."""
    return {path: written(sheets_of_machine(content))}


def sheets_of_machine(content: MachineContent) -> list[Sheet]:
    """The sheets of a report in their order, as plain data."""
    machine = content.sizing.machine
    file = file_sheet(content.file, machine.text, machine.entered)
    own = [_machine(content), _axes(content), _parts(content), *_power(content), *loop_sheet(content)]
    taken = {sheet.name for sheet in (*own, file)} | {"About"}
    axes, simulated = [one.name for one in content.axes], [*content.proofs]
    names = sheet_names([*axes, *(f"{name} over time" for name in simulated)], taken)
    found = [*own, *(_axis(one, name) for one, name in zip(content.axes, names, strict=False))]
    found += [*time_series_sheets(content, dict(zip(simulated, names[len(axes) :], strict=True))), file]
    return [*found, about_sheet(content.catalogs, content.method, content.sizing.objective, found)]


_LONGEST = 31  # letters of a sheet's name


def sheet_names(names: Iterable[str], taken: Iterable[str]) -> list[str]:
    """Names of sheets, of which a workbook has each once whatever its capitals, and that it cuts.

    Examples
    --------
    >>> sheet_names(["x", "X", "axes"], ["Axes"])
    ['x', 'X 2', 'axes 2']
    """
    used, made = {name.lower() for name in taken}, []
    for name in names:
        for number in range(1, 2 + len(used)):
            end = "" if number == 1 else f" {number}"
            short = name[: _LONGEST - len(end)].strip() + end
            if short.lower() not in used:
                break
        used.add(short.lower())
        made.append(short)
    return made


# -- the machine


_COLUMNS = (
    SheetColumn("Machine", "title"), SheetColumn("value", "value"), SheetColumn("unit", "unit", "unit"),
    STATUS, SheetColumn("note", "note", "", 90),
)  # fmt: skip


def _machine(content: MachineContent) -> Sheet:
    sizing = content.sizing
    rows: list[table.Row] = [{"title": "Machine", "note": sizing.machine.name}]
    rows += [{"title": name, "note": value} for name, value in content.title_block]
    rows += [{"title": "Verdict", "status": content.status, "note": text_of(verdict_text(content))},
             {"title": "Drives", "value": Cell(content.drives, "count")}]  # fmt: skip
    rows += [{"part": "Smallest margin of each axis"}, *map(_tight, content.axes)]
    if sizing.checks:
        rows += [{"part": "Checks of all axes together"}, *map(check_line, sizing.checks)]
    if sizing.power:
        rows += [{"part": "All axes on one supply"}]
        rows += [table.figure_row("power", figure) for figure in sizing.power.figures]
    rows += loop_summary(content)
    if content.bought:
        rows += [{"part": "All parts"}, *map(priced, table.total_rows(content.totals))]
    rows += [*texts("Of all axes together", notes(content)), *texts("Assumptions", assumptions(content)),
             *texts("Warnings", warnings(content))]  # fmt: skip
    return Sheet(name="Machine", columns=_COLUMNS, rows=rows, filtered=False)


def _tight(one: AxisContent) -> table.Row:
    """An axis by its tightest check."""
    drive = one.content.drive
    check = next(iter(tightest(drive.deciding, 1)), None) if drive else None
    named = {"title": one.name, "status": one.status}
    return check_line(check) | named | {"note": check.title} if check else named | {"note": "no candidate"}


# -- axes and parts


_AXES = (
    SheetColumn("axis", "axis"), SheetColumn("drives", "drives", "count"), SheetColumn("drive", "drive", "", 60),
    STATUS, SheetColumn("carries", "carries"), SheetColumn("mass of these (kg)", "carried"),
    SheetColumn("mass of its parts (kg)", "mass"), SheetColumn("price of its parts", "price", "money"),
    SheetColumn("currency", "currency"), SheetColumn("energy of its cycle (J)", "energy"),
    SheetColumn("smallest margin (%)", "margin", "percent"), SheetColumn("tightest check", "check"),
    SheetColumn("not in mass", "no_mass"), SheetColumn("not in price", "no_price"),
)  # fmt: skip


def _axes(content: MachineContent) -> Sheet:
    note = "mass and price are those of all drives of an axis, as far as they are known"
    return Sheet(name="Axes", columns=_AXES, rows=[*map(_axis_row, content.axes)], note=note, still=1)


def _axis_row(one: AxisContent) -> table.Row:
    drive = one.content.drive
    found: table.Row = {"axis": one.name, "drives": one.sizing.drives, "status": one.status,
                        "carries": ", ".join(riding.of for riding in one.sizing.carried),
                        "carried": one.sizing.carried_mass if one.sizing.carried else None}  # fmt: skip
    if drive is None:
        return found | {"drive": "no candidate"}
    check = next(iter(tightest(drive.deciding, 1)), None)
    found |= {"drive": text_of(drive_name(one)), "energy": objective_figure(drive, "energy").value}
    for total in totals(one.lines):
        found |= {total.name: total.value, f"no_{total.name}": ", ".join(total.lacks)}
        found |= {"currency": total.unit} if total.name == "price" else {}
    return found | ({"margin": check.margin, "check": check.title} if check else {})


def _parts(content: MachineContent) -> Sheet:
    """The parts of all axes."""
    columns = (*PART_COLUMNS[:1], SheetColumn("axes", "axes"), *PART_COLUMNS[1:])
    rows = [part_sheet_row(one.line) | {"axes": ", ".join(one.axes)} for one in content.bought]
    known = "mass and price are empty where no catalogue has them; a mass with from and to is estimated"
    note = known if rows else "no drive meets all limits: nothing to buy"
    return Sheet(name="Parts list", columns=columns, rows=rows, note=note, still=1)


# -- power


def _power(content: MachineContent) -> Iterator[Sheet]:
    """Power of all axes over time."""
    power = content.sizing.power
    if power is None:
        return
    columns = power_columns(power)
    heads = tuple(SheetColumn(headed(name, unit), name, "sample") for name, (_, _, unit) in columns.items())
    rows = zip(*(from_si(values, unit, kind).tolist() for values, kind, unit in columns.values()), strict=True)
    yield Sheet(name="Power", columns=heads, note="mean powers, each from its time to that of the next row", still=1,
                filtered=False, rows=[dict(zip(columns, row, strict=True)) for row in rows])  # fmt: skip


# -- one axis


def _carried(found: CarriedMass) -> table.Row:
    lacks = f"without {', '.join(found.lacking)}" if found.lacking else ""
    named = table.plain_row("carried", found.of, f"Drives of {found.of} on it", found.mass, "kg")
    return named | {"note": lacks}


def _axis(one: AxisContent, name: str) -> Sheet:
    columns = (SheetColumn(f"Axis {one.name}", "title"), *LIMITS)
    rows = [*_axis_rows(one)]
    return Sheet(name=name, columns=columns, rows=rows, filtered=False, still=1)


def _axis_rows(one: AxisContent) -> Iterator[table.Row]:
    """Its drive, what it carries, its checks, figures, and the requirements of its load."""
    drive, result = one.content.drive, one.content.result
    if drive is None:
        yield {"title": "Drive", "status": "fail", "note": "no candidate"}
        return
    yield {"title": "Drive", "status": one.status, "note": text_of(drive_name(one))}
    v = one.content.validation
    if v:
        yield {"title": v.loop.capitalize(), "status": v.status, "note": f"over {driven_over(v)}"}
    yield from map(_carried, one.sizing.carried)
    yield {"part": "Parts"}
    yield from table.set_rows(drive, result.objective)
    yield {"part": "Checks"}
    yield from (table.check_row("check", check) for check in drive.every_check)
    yield {"part": "Figures of the drive over the cycle"}
    yield from (table.figure_row("figure", figure) for figure in drive.figures)
    yield {"part": "Requirements of the load"}
    yield from map(table.requirement_row, (*result.requirements, *drive.requirements))
    yield from texts("Assumptions", result.assumptions)
    yield from texts("Warnings", result.warnings)
    if v:
        yield from texts("Assumptions of the simulation", v.assumptions)
        yield from texts("Warnings of the simulation", v.warnings)
