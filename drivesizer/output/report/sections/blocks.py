"""Blocks of a report's sections: paragraphs, lists, tables, checks, figures and equations, as plain records.

PDF and HTML have one renderer for each kind of block (``typst/blocks.typ``, ``html/blocks.html``), by the name of its
class in lower case.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from drivesizer.output.report.sections.texts import Text

__all__ = [
    "Block", "Bullets", "Checks", "Column", "Equation", "Facts", "Fragment", "Heading", "Pair", "Picture", "Row",
    "Table", "Tiles", "Verdict", "Words", "as_data",
]  # fmt: skip


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
