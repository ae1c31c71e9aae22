"""Records of a document: marked texts, quantities, tables, pictures and sections, which every medium prints."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import import_module
from math import isnan, nan
from operator import attrgetter
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from drivesizer.files.text import listed as rows_of_file
from drivesizer.output.derivation import margin
from drivesizer.output.words import likely
from drivesizer.units import KINDS, from_si, label, show

# A text is a string, or a tuple of strings and of marks; a renderer shows a mark by the name of its class.


@dataclass(frozen=True)
class _Marked:
    text: str


class Strong(_Marked):
    """Bold letters."""


class Small(_Marked):
    """Small letters on a line of their own, below what is before them."""


class Note(_Marked):
    """Small letters behind what is before them; nothing where it is empty."""


class Code(_Marked):
    """Letters of one width, such as a file name."""


class Status(_Marked):
    """``pass``, ``fail``, ``open`` or ``unknown`` in its colour."""


class Mark(_Marked):
    """The confidence of a figure that is not quoted, such as ``derived``; nothing where it is empty."""


@dataclass(frozen=True, slots=True)
class Math:
    """Typst mathematics, of our own declarations and of numbers only, and the same as a line of text."""

    symbol: str
    text: str = ""


@dataclass(frozen=True, slots=True)
class TableLink:
    """A reference to the table of that name on paper, with the words before it."""

    name: str
    before: str = ""


Text = str | tuple[str | Strong | Small | Note | Code | Status | Mark | Math | TableLink, ...]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A cell with a number, its unit and kind.

    Beside the kinds of quantities there are ``count``, ``margin`` and ``probability``, shares of 1 that are shown in
    per cent, ``money`` in the currency that the unit names, and ``plain``, of which the unit is that of the SI.
    """

    value: float  # SI; NaN unknown
    unit: str = "1"
    kind: str = "count"
    digits: int = 4
    own: str = ""  # its text, where that is another than the usual
    note: str = ""  # small letters below it

    @property
    def text(self) -> str:
        """The figure as it is printed.

        >>> Quantity(0.25, "mN*m", "torque").text, Quantity(0.052, "%", "margin").text
        ('250 mN·m', '+5.2 %')
        >>> Quantity(9.5, "EUR", "money").text, Quantity(2345.0).text
        ('9.50 EUR', '2,345')
        """
        if self.own:
            return self.own
        if self.kind == "margin":
            return margin(self.value)
        if isnan(self.value):
            return "unknown"
        match self.kind:
            case "count":
                return f"{self.value:,.0f}"
            case "probability":
                return likely(self.value)
            case "money":
                return f"{self.value:.2f} {self.unit}"
            case "plain":
                return f"{self.value:.{self.digits}g} {label(self.unit)}".rstrip()
        return show(self.value, self.unit, self.kind, self.digits)

    @property
    def number(self) -> float:
        """The figure in its unit; shares as shares of 1."""
        return float(from_si(self.value, self.unit, self.kind)) if self.kind in KINDS else float(self.value)

    @property
    def si_unit(self) -> str:
        """The unit of its value."""
        return KINDS[self.kind].si if self.kind in KINDS else "1" if self.unit == "%" else self.unit


def quantities(unit: str, kind: str, **values: float) -> dict[str, Cell]:
    """Cells of one unit by the keys of their columns."""
    return {key: Quantity(value, unit, kind) for key, value in values.items()}


@dataclass(frozen=True, slots=True)
class Bar:
    """The used share of a limit, and where the margin begins that is required; None is unknown."""

    use: float | None
    allowed: float | None = 1.0
    status: str = "pass"


Cell = Text | Quantity | Bar


def text_of(cell: Cell) -> str:
    """A cell without its marks, and without what is small.

    >>> text_of(("passes on ", Strong("all"), " checks", Small("of the drive")))
    'passes on all checks'
    """
    if isinstance(cell, Bar):
        return ""
    if isinstance(cell, Quantity):
        return cell.text
    parts = (cell,) if isinstance(cell, str) else cell
    return "".join(
        part if isinstance(part, str) else getattr(part, "text", "")
        for part in parts
        if not isinstance(part, Small | Note)
    )


# Media that a column, a table or a section is printed in: ``paper`` is PDF and page, ``wide`` workbook and CSV,
# ``print`` terminal and paper, ``listed`` terminal and wide, ``book`` the workbook alone, ``shown`` all but the CSV.

Media = Literal["all", "print", "paper", "terminal", "wide", "listed", "book", "shown"]
TERMINAL = frozenset({"all", "print", "terminal", "listed", "shown"})
PAPER = frozenset({"all", "print", "paper", "shown"})
WIDE = frozenset({"all", "wide", "listed"})
BOOK = WIDE | {"book", "shown"}


FORMS = ("text", "name", "number", "small", "status", "mark", "code", "math", "share", "bar")
_MARKS: dict[str, type[Status | Mark | Code]] = {"status": Status, "mark": Mark, "code": Code}


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table: the key of its cells, its head, the form of its cells, and its width as a share."""

    key: str
    head: str = ""
    form: str = "text"  # of ``FORMS``
    width: float = 0.0  # 0: as wide as needed
    media: Media = "all"
    merged: bool = False  # equal cells below one another are one, on paper
    yields: bool = False  # left out at a terminal that has no room for it
    formula: tuple[str, ...] = ()  # ``product`` or ``margin``, and the keys of the cells that it is computed from
    of: str = ""  # attribute of a record that its cells are, where it is not named as the key
    unit: str = ""  # of these, or the attribute that has it; the record's own where it is empty
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table: its cells by the keys of the columns, and its name for other programs."""

    cells: Mapping[str, Cell]
    name: str = ""
    status: str = ""
    total: bool = False  # a sum, in bold letters
    data: Mapping[str, str] = field(default_factory=dict)  # what programs that read the page find at it


@dataclass(frozen=True, slots=True)
class Table:
    """A table with its caption."""

    caption: Text
    columns: Sequence[Column]
    rows: Sequence[Row]
    name: str = ""  # by which a text refers to it
    record: str = ""  # kind of thing that a row is, for the CSV; the name of the section where it is empty
    look: str = "wide"
    group: str = ""  # key of cells that head the rows below them where they are equal
    dense: bool = False  # smaller letters on paper
    sortable: bool = False  # on the page, by a click on a head
    halves: bool = False  # two columns of rows beside each other on paper
    media: Media = "all"
    file: str = ""  # end of the name of a CSV file of its own


@cache
def declared() -> dict[str, tuple[dict[str, Any], list[Column]]]:
    """The tables that ``tables.txt`` declares: how each looks, and its columns."""
    tables: dict[str, tuple[dict[str, Any], list[Column]]] = {}
    for head, cells in rows_of_file(__package__, "tables.txt"):
        name, *looks = head.split()
        if name not in tables:
            tables[name] = {key: value or True for key, _, value in (look.partition("=") for look in looks)}, []
        key, title, look, of, unit, formula = (*cells, *[""] * 5)[:6]
        words, (unit, _, kind) = look.split(), unit.partition(" ")
        tables[name][1].append(Column(
            key, title, next((word for word in words if word in FORMS), "text"),
            next((float(word) for word in words if word[0].isdigit()), 0.0),
            next((word for word in get_args(Media) if word in words), "all"),
            "merged" in words, "yields" in words, tuple(formula.split()), of or key, unit, kind,
        ))  # fmt: skip
    return tables


def row(
    table: str, record: Any, /, *, name: str | None = None, outcome: str = "", data: Mapping[str, str] | None = None,
    **cells: Cell,
) -> Row:  # fmt: skip
    """A record as a row of a declared table: its attributes, and the cells that are none of them."""
    for column in declared()[table][1]:
        if column.key not in cells and (value := attribute(record, column.of)) is not None:
            cells[column.key] = _cell(value, column, record)
    return Row(cells, getattr(record, "name", "") if name is None else name, outcome, data=data or {})


def attribute(record: Any, path: str) -> Any:
    """Value of a record at a path; None where it has nothing there."""
    try:
        return attrgetter(path)(record)
    except AttributeError:  # a cell that this row has not
        return None


def _cell(value: Any, column: Column, record: Any) -> Cell:
    if column.form in _MARKS:
        return (_MARKS[column.form](value),)
    if not isinstance(value, int | float):
        return value
    unit = getattr(record, column.unit, column.unit) if column.unit else getattr(record, "unit", "1")
    return Quantity(value, unit, column.kind or getattr(record, "kind", "count"))


def table(
    kind: str, caption: Text, rows: Iterable[Row | Sequence[Cell]], /, *, heads: Mapping[str, str] | None = None,
    without: Collection[str] = (), more: Sequence[Column] = (), **look: Any,
) -> Table:  # fmt: skip
    """A declared table of rows, each given as such or as its cells in order; some of its heads may be other ones."""
    looks, declared_columns = declared()[kind]
    own = heads or {}
    columns = [replace(c, head=own.get(c.key, c.head)) for c in declared_columns if c.key not in without] + [*more]
    table_rows = [row if isinstance(row, Row) else Row({c.key: cell for c, cell in zip(columns, row, strict=False)})
            for row in rows]  # fmt: skip
    return Table(caption, columns, table_rows, **looks | look)


@dataclass(frozen=True, slots=True)
class Series:
    """Columns over the first of them, usually time: a sheet, and a CSV file of its own."""

    title: str
    file: str
    columns: Mapping[str, tuple[NDArray[np.float64], str, str]]  # values [SI], kind, unit
    chart_columns: tuple[str, ...] = ()  # columns of a chart in the workbook
    note: str = ""


@dataclass(frozen=True, slots=True)
class Words:
    """A paragraph."""

    text: Text
    look: str = ""  # "note": small and grey; "alarm": in the colour of what fails; "names": no line ends inside one
    media: Media = "all"


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
    media: Media = "all"
    note: str = ""  # at its right


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure; left out by a report that has none of that name."""

    name: str
    caption: Text
    alt: str
    about: str = ""  # a sentence that points at it, without its subject, where figures float
    floats: bool = False  # on paper: to the top or the bottom of a page, so that the text goes on beside it
    small: bool = False  # narrower than the text


@cache
def texts(kind: str) -> list[list[str]]:
    """The rows of a list of ``texts.txt``."""
    return [cells for head, cells in rows_of_file(__package__, "texts.txt") if head == kind]


def sentence(key: str, **words: str) -> str:
    """A sentence of ``texts.txt`` with words in it."""
    return next(text for name, text in texts("sentences") if name == key).format(**words)


@cache
def _pictures() -> dict[str, list[str]]:
    return {name: cells for _, (name, *cells) in rows_of_file(__package__, "pictures.txt")}


def picture(declared: str, name: str = "", **words: str) -> Picture:
    """A figure as ``pictures.txt`` declares it, with words in its caption."""
    alt, about, look, caption = (text.format(**words) for text in _pictures()[declared])
    return Picture(name or declared, caption, alt, about, "floats" in look, "small" in look)


@dataclass(frozen=True, slots=True)
class Pair:
    """Blocks beside each other, where there is room."""

    left: Sequence[Any]
    right: Sequence[Any]


@dataclass(frozen=True, slots=True)
class Equation:
    """A step of a derivation: printed form, computed form, numbers put in; and the quantity that it gives."""

    step: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Verdict:
    """The outcome in a few paragraphs."""

    has_drive: bool
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


Block = Words | Bullets | Heading | Table | Series | Picture | Pair | Equation | Verdict | Tiles | Fragment


def flat(blocks: Iterable[Block]) -> Iterator[Block]:
    """Blocks one by one, those of pairs too."""
    for block in blocks:
        if isinstance(block, Pair):
            yield from flat((*block.left, *block.right))
        else:
            yield block


# When a section comes at the terminal: with the answer, on request by an option, or only on paper.
Early = Literal["answer", "checks", "derivation", "paper", "ranking", "rejected", "never"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """A section by its name, which is also its address on the page.

    ``blocks`` makes it of the content, and of a drive where it is ``of_drive``: paper has it of the drive that is
    reported, a workbook and a CSV of every drive. Without a block it is left out.
    """

    name: str
    title: str  # without one its blocks belong to the section above
    blocks: Callable[..., Iterable[Block]]
    of_drive: bool = False
    early: Early = "checks"
    level: int = 1  # 2: inside the section of level 1 above it
    appendix: bool = False
    media: Media = "all"

    def headed(self, content: Any) -> str:
        """The title in a document of that content, which has those that depend on what was computed."""
        return self.title.format(titles=content.titles) if "{" in self.title else self.title


def sections(which: str) -> tuple[Section, ...]:
    """The sections of an axis, or of a machine before or behind its axes, as ``sections.txt`` declares them."""
    declared_sections = []
    for head, (name, function, *cells) in rows_of_file(__package__, "sections.txt"):
        if head == which:
            title, words, *_ = (*cells, "", "")
            module, _, of = function.partition(".")
            parts = (word.partition("=") for word in words.split())
            properties: dict[str, Any] = {key: value or True for key, _, value in parts}
            properties["level"] = int(properties.get("level", 1))
            blocks = getattr(import_module(f"{__package__}.{module}"), of)
            declared_sections.append(Section(name=name, title=title, blocks=blocks, **properties))
    return tuple(declared_sections)


class Printed(NamedTuple):
    """A section with its blocks; in wide media those of one drive out of several."""

    section: Section
    title: str
    blocks: list[Block]
    rank: float = nan  # of the drive; NaN where it is of the whole
    axis: str = ""


def section(name: str, title: str, blocks: Iterable[Block], level: int = 1) -> Printed:
    """A section of a document that is no sizing; a terminal prints its blocks alone."""
    declared = Section(name=name, title=title, blocks=lambda _: (), level=level, early="answer")
    return Printed(declared, title, [*blocks])


@dataclass(frozen=True, slots=True, kw_only=True)
class Document:
    """A title block, and sections in their order."""

    name: str
    machine: str = ""  # in words
    block: Sequence[tuple[str, str]] = ()  # customer, project, author, revision
    sections: Sequence[Printed]
    has_drive: bool = True
    subject: str = "drive sizing"
    headed: bool = True  # whether a terminal prints its name
    pictures: Mapping[str, Any] = field(default_factory=dict)  # figures by name, of one that is no sizing
