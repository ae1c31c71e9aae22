"""A section of a report: one record that PDF, HTML, XLSX and CSV print, made of blocks, texts and sheets."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from typing import Any, NamedTuple

from drivesizer.control.validation import Validation
from drivesizer.output.parts import PartLine, machine_parts
from drivesizer.output.report.figures.all_figures import report_drawings
from drivesizer.output.report.figures.set_behaviour import Behaviour
from drivesizer.output.report.figures.style import Drawing
from drivesizer.output.report.lines.rows import Row as FigureRow
from drivesizer.output.report.lines.rows import every_list, first_wheel, outcome
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check import Status as CheckStatus
from drivesizer.results.check import gravest
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.units import KINDS, from_si, label, show

__all__ = [
    "LIMITS", "NOTE", "RANK", "STATUS", "VALUES", "Block", "Bullets", "Cell", "Checks", "Code", "Column", "Content",
    "CsvRows", "Equation", "Facts", "Fragment", "Heading", "Mark", "Math", "Number", "Pair", "Picture", "Row",
    "Section", "Sheet", "SheetColumn", "Small", "Status", "Strong", "Table", "TableLink", "Text", "Tiles", "Verdict",
    "Words", "as_data", "headed", "quantity", "ranked", "rows_of", "sheets_of", "text_of",
]  # fmt: skip


# -- Texts of a report with marks such as bold letters, and cells with numbers.
#
# A text is a string, or a tuple of strings and of marks; PDF and HTML render a mark by the name of its class.


@dataclass(frozen=True)
class _Marked:
    text: str


class Strong(_Marked):
    """Bold letters."""


class Small(_Marked):
    """Small letters on a line of their own, below what is before them."""


class Code(_Marked):
    """Letters of one width, such as a file name."""


class Status(_Marked):
    """``pass``, ``fail`` or ``unknown`` in its colour."""


class Mark(_Marked):
    """The confidence of a figure that is not quoted, such as ``derived``; nothing where it is empty."""


@dataclass(frozen=True, slots=True)
class Math:
    """Typst mathematics, of our own declarations and of numbers only."""

    symbol: str


@dataclass(frozen=True, slots=True)
class TableLink:
    """A reference to the table of that name."""

    name: str


Inline = Strong | Small | Code | Status | Mark | Math | TableLink
Text = str | tuple[str | Inline, ...]


@dataclass(frozen=True, slots=True)
class Number:
    """A cell with a number: as it is printed, and as other programs read it."""

    text: str
    value: float | None  # None: unknown
    unit: str = "1"
    si_value: float | None = None
    si_unit: str = "1"


def quantity(value: float, unit: str, kind: str) -> Number:
    """A cell with a physical quantity.

    Examples
    --------
    >>> quantity(0.25, "mN*m", "torque").text
    '250 mN·m'
    """
    known = value == value
    return Number(
        text=show(value, unit, kind), value=float(from_si(value, unit, kind)) if known else None, unit=unit,
        si_value=value if known else None, si_unit=KINDS[kind].si,
    )  # fmt: skip


def text_of(text: Text | Number) -> str:
    """A text without its marks.

    >>> text_of(("passes on ", Strong("all"), " checks"))
    'passes on all checks'
    """
    if isinstance(text, Number):
        return text.text
    parts = (text,) if isinstance(text, str) else text
    return "".join(part if isinstance(part, str) else getattr(part, "text", "") for part in parts)


# -- Blocks of a report's sections: paragraphs, lists, tables, checks, figures and equations, as plain records.
#
# PDF and HTML have one renderer for each kind of block (``typst/blocks.typ``, ``html/blocks.html``), by the name of
# its class in lower case.


@dataclass(frozen=True, slots=True)
class Words:
    """A paragraph."""

    text: Text
    look: str = ""  # "note": small and grey; "alarm": in the colour of what fails


@dataclass(frozen=True, slots=True)
class Bullets:
    """A sentence, and below it a list."""

    intro: Text
    items: Sequence[str]
    look: str = ""


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading inside a section, one level below its title."""

    title: str


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table: its head, the form of its cells, and its width as a share; 0 is as wide as needed."""

    head: str
    form: str = "text"  # text, name, number, strong, small, status, mark, code, math or share
    width: float = 0.0
    merged: bool = False  # equal cells below one another are one, on paper


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table: its cells, and what programs that read the page find at it."""

    cells: Sequence[Any]  # Text or Number
    data: dict[str, str] | None = None
    status: str = ""
    total: bool = False  # a sum, in bold letters


@dataclass(frozen=True, slots=True)
class Table:
    """A table with its caption."""

    caption: Text
    columns: Sequence[Column]
    rows: Sequence[Row]
    name: str = ""
    look: str = "wide"  # class on the page
    dense: bool = False  # smaller letters on paper
    sortable: bool = False  # on the page, by a click on a head
    halves: bool = False  # two columns of rows beside each other on paper


@dataclass(frozen=True, slots=True)
class Facts:
    """Names and figures without a limit, each with the moment at which it is reached."""

    caption: Text
    rows: Sequence[dict[str, Any]]  # title, text, at
    name: str = ""
    halves: bool = False


@dataclass(frozen=True, slots=True)
class Checks:
    """Checks with their limits, margins and bars."""

    caption: Text
    rows: Sequence[dict[str, Any]]  # of ``rows.check_row``
    name: str = ""
    grouped: bool = False  # under the part that they concern; the rows are in that order


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure; left out by a report that has none of that name."""

    name: str
    caption: Text
    alt: str
    about: str = ""  # a sentence that points at it, without its subject, where figures float
    on_page: Text = ""  # the caption of a figure that can be moved and zoomed, where it differs
    floats: bool = False  # on paper: to the top or the bottom of a page, so that the text goes on beside it


@dataclass(frozen=True, slots=True)
class Pair:
    """Blocks beside each other, where there is room."""

    left: Sequence[Any]
    right: Sequence[Any]


@dataclass(frozen=True, slots=True)
class Equation:
    """A step of the derivation: printed form, computed form, numbers put in."""

    step: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome in a few paragraphs."""

    found: bool
    paragraphs: Sequence[Text]


@dataclass(frozen=True, slots=True)
class Tiles:
    """A few figures in large letters: name, value, note."""

    rows: Sequence[tuple[str, str, str]]


@dataclass(frozen=True, slots=True)
class Fragment:
    """A piece with a renderer of its own in PDF and HTML: ``spec``, ``datasheets``, ``digests`` or ``file``."""

    name: str
    rows: Sequence[Any]


Block = (
    Words | Bullets | Heading | Table | Facts | Checks | Picture | Pair | Equation | Verdict | Tiles | Fragment
)  # fmt: skip


def as_data(value: Any) -> Any:
    """Blocks as lists and dicts, each with its ``kind``, for the templates."""
    if is_dataclass(value) and not isinstance(value, type):
        kind = type(value).__name__.lower()
        return {"kind": kind} | {field.name: as_data(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, dict):
        return {key: as_data(entry) for key, entry in value.items()}
    return [as_data(entry) for entry in value] if isinstance(value, list | tuple) else value


# -- A sheet of a workbook as plain data: columns, rows, and a note.


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
    rows: list[FigureRow]
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


# -- Content of a report: the result, the behaviour of the reported drive over the cycles, and its figures.


@dataclass(frozen=True)
class Content:
    """A sizing and its closed loop; each part that takes time is computed once, when it is used."""

    result: SizingResult
    validation: Validation | None = None

    @property
    def drive(self) -> DriveSet | None:
        """The drive that is reported: the best, else the most probable, else the closest rejected one."""
        return self.result.shown

    @property
    def status(self) -> CheckStatus:
        """The gravest of the reported drive's verdict and that of its closed loop; a fail without a drive."""
        return gravest(
            [self.drive.status if self.drive else "fail", *([self.validation.status] if self.validation else [])]
        )

    @property
    def outcome(self) -> str:
        """``found``, ``unsure`` where no drive reaches the required confidence, or ``missed``."""
        return outcome(self.result)

    @cached_property
    def behaviour(self) -> Behaviour | None:
        """Behaviour of the reported drive over the load cycles."""
        return Behaviour(self.result.problem, self.drive) if self.drive else None

    @cached_property
    def drawings(self) -> dict[str, Drawing]:
        """Every figure by name."""
        return report_drawings(self.result, self.validation, self.behaviour)

    @cached_property
    def cycles(self) -> list[tuple[str, LoadCycle]]:
        """The load cycle of each case by name."""
        return [(case.name, case.cycle) for case in self.result.problem.cases]

    @cached_property
    def wheel(self) -> str:
        """The worst wheel of a platform, such as ``wheel 1``; empty for other machines."""
        return first_wheel(self.result.problem)

    @property
    def cases(self) -> list[str]:
        """The names of the load cases; none where there is one without a name."""
        return [case.name for case in self.result.problem.cases if case.name]

    @property
    def shaft(self) -> str:
        """Shaft at which the load is given."""
        return "wheel" if self.result.spec.load.kind == "wheeled_vehicle" else "load's shaft"

    @property
    def title_block(self) -> list[tuple[str, str]]:
        """Names and texts of the customer, project, author and revision, as far as the spec gives them."""
        given = self.result.spec.report.model_dump(exclude_none=True)
        return [(name.replace("_", " ").capitalize(), str(text)) for name, text in given.items()]

    @property
    def motors(self) -> int:
        """Number of drives of this kind in the machine."""
        return self.result.spec.load.motors

    @cached_property
    def bought(self) -> list[PartLine]:
        """The parts list of the best drive; a rejected one is not bought."""
        return machine_parts(self.result.sets[0], self.result.problem) if self.result.sets else []


# -- Columns that several sheets of a workbook have, and rows of all drives.


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


def ranked(content: Content, rows: Callable[[DriveSet], Iterable[FigureRow]]) -> Iterator[FigureRow]:
    """Rows of every drive, with its rank."""
    for _, drive in every_list(content.result, front=False):
        yield from (row | {"set_rank": drive.rank} for row in rows(drive))


# -- A section of a report: one record that PDF, HTML, XLSX and CSV print.
#
# ``blocks`` is what PDF and HTML show, in the order of the list in ``sections``. XLSX and CSV print all drives with
# all figures: a section whose tables are to have more there than on paper gives ``sheets`` and ``csv`` itself; of
# any other the tables of its blocks become a sheet each, and each of their numbers a row of the CSV.


def _no_rows(*_: Any) -> tuple[()]:
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class CsvRows:
    """Rows of the CSV: before those of the drives, of each drive with the list that it is on, and after them."""

    before: Callable[[Content], Iterable[FigureRow]] = _no_rows
    of_drive: Callable[[Content, str, DriveSet], Iterable[FigureRow]] = _no_rows
    after: Callable[[Content], Iterable[FigureRow]] = _no_rows


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


def _columns(table: Table, rows: list[FigureRow]) -> tuple[SheetColumn, ...]:
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


def _numbers(section: str, table: Table) -> Iterator[FigureRow]:
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
