"""Sections of a document at the terminal: they fit 80 columns and use what there is."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from io import StringIO
from typing import Any

from rich.console import Console
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text as RichText

from drivesizer.output.document import records as doc
from drivesizer.output.report.figures.picture import DASHED, DOTTED, Plot
from drivesizer.output.terminal.tables import MARK, STYLE, Axis, Series, chart, console, heading, width_of
from drivesizer.units import label

_APART = 2  # characters between tables beside each other
_MANY = 6  # columns, beyond which heads take several lines


def document(page: doc.Document) -> None:
    """Print a document that is no sizing: its heading, unless it has none, and its blocks."""
    out = console()
    if page.headed:
        heading(out, page.name, page.machine)
    for section in page.sections:
        blocks(out, section.blocks, page.pictures)


def sections(console: Console, printed_sections: Iterable[doc.Printed]) -> None:
    """Print sections, one below the other."""
    for section in printed_sections:
        if section.title and section.section.early != "answer":
            console.print(RichText(f"\n{section.title}", style="bold underline"))
        blocks(console, section.blocks)


def blocks(console: Console, body: Iterable[doc.Block], pictures: Mapping[str, Any] | None = None) -> None:
    """Print texts and tables, and those pictures that are given; equations and what else is for paper are left out."""
    for block in body:
        if isinstance(block, doc.Pair):
            if not _side_by_side(console, [*doc.flat([block])]):
                blocks(console, doc.flat([block]))
        elif isinstance(block, doc.Table) and block.media in doc.TERMINAL and block.rows:
            half = -(-len(block.rows) // 2)
            halves = [replace(block, caption="", rows=rows) for rows in (block.rows[:half], block.rows[half:])]
            if not (block.halves and _side_by_side(console, halves, doc.text_of(block.caption))):
                _table(console, block)
        elif isinstance(block, doc.Picture) and pictures and block.name in pictures:
            for plot in pictures[block.name].page:
                _picture(console, plot)
        elif isinstance(block, doc.Words) and block.look == "names":
            console.print(_names(doc.text_of(block.text), console.width))
        elif isinstance(block, doc.Words) and block.media in doc.TERMINAL:
            console.print(rich_text(block.text, {"note": "dim", "alarm": "bold red"}.get(block.look, "")))
        elif isinstance(block, doc.Verdict):
            for text in block.paragraphs:
                console.print(rich_text(text))
        elif isinstance(block, doc.Bullets) and block.items:
            console.print(rich_text(block.intro, "red" if block.look == "alarm" else ""))
            for item in block.items:
                console.print(Padding(RichText(item, style="" if block.look == "alarm" else "dim"), (0, 0, 0, 2)))
        elif isinstance(block, doc.Heading) and block.note:
            heading(console, block.title, block.note)
        elif isinstance(block, doc.Heading):
            console.print(RichText(f"\n{block.title}", style="bold"))


def text_of_blocks(body: Iterable[doc.Block], width: int = 120) -> str:
    """Texts and tables as plain text of some width [characters]."""
    written = StringIO()
    blocks(Console(file=written, width=width, highlight=False, emoji=False), body)
    return "\n".join(line.rstrip() for line in written.getvalue().splitlines())


def _names(text: str, width: int) -> RichText:
    """Names behind a colon and between commas; no line ends inside one."""
    head, colon, names = text.rpartition(": ")
    glued = ", ".join(name.replace(" ", "\u00a0").replace("-", "\u2011") for name in names.split(", "))
    lines = textwrap.fill(f"{head}{colon}{glued}", width, break_long_words=False)
    return RichText(lines.replace("\u00a0", " ").replace("\u2011", "-"))


_WIDEST, _HEIGHT = 160, 8  # columns of a chart, however wide the terminal, and of those to a line of its field
_GAPS: dict[Any, int] = {DASHED: 2, DOTTED: 4}  # of a line's dots one in so many is drawn
_INKS = {"green": "green", "vermillion": "yellow"}


def _picture(console: Console, plot: Plot) -> None:
    """The first diagram of a picture as a chart where it is from 0 on; of one of decades or of areas there is none."""
    diagram = plot.diagrams[0]
    if plot.log or diagram.log or not diagram.whole or any(curve.filled for curve in diagram.curves):
        return
    series = [
        Series(curve.name, curve.x, curve.y, _GAPS.get(curve.dashes, 1), "" if curve.joined else "●",
               _INKS.get(curve.colour, ""))
        for curve in diagram.curves
    ]  # fmt: skip
    width = min(console.width, _WIDEST)
    end = plot.ends[1] if plot.ends else max(max(curve.x) for curve in diagram.curves)
    level = Axis(plot.across, label(plot.unit), end)
    upright = Axis(diagram.name, label(diagram.unit), max(max(curve.y) for curve in diagram.curves))
    console.print()
    console.print(*chart(series, level, upright, width, width // _HEIGHT), sep="\n")


def _side_by_side(console: Console, body: Sequence[doc.Block], caption: str = "") -> bool:
    """Print tables beside each other; False, without printing, where they do not fit, or are none."""
    tables = [block for block in body if isinstance(block, doc.Table) and block.media in doc.TERMINAL and block.rows]
    if len(tables) < 2 or len(tables) < len(body):
        return False
    sides = [_rich_table(block, _columns(block)) for block in tables]
    for side, block in zip(sides, tables, strict=True):
        side.title, side.title_justify, side.title_style = _sentence(doc.text_of(block.caption)) or None, "left", "bold"
    if sum(width_of(side) for side in sides) + _APART > console.width:
        return False
    grid = RichTable.grid(padding=(0, _APART, 0, 0))
    grid.add_row(*sides)
    console.print()
    if caption:
        console.print(RichText(_sentence(caption), style="bold"))
    console.print(grid)
    return True


def _columns(block: doc.Table) -> list[doc.Column]:
    columns = [c for c in block.columns if c.media in doc.TERMINAL and c.form not in ("bar", "share")]
    return [c for c in columns if any(row.cells.get(c.key, "") != "" for row in block.rows)]


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"


def rich_text(text: doc.Cell, style: str = "") -> RichText:
    """A text with its marks in the styles of a terminal."""
    if isinstance(text, doc.Quantity):
        doubtful = text.text.startswith(("unknown", "≈"))
        rich = RichText(text.text, style=style or ("yellow" if doubtful else ""))
        return rich.append(f"\n{text.note}", "dim") if text.note else rich
    rich = RichText(style=style)
    for part in (text,) if isinstance(text, str) else text if isinstance(text, tuple) else ():
        match part:
            case str():
                rich.append(part)
            case doc.Status(status):
                rich.append(MARK.get(status, status), STYLE.get(status, ""))
            case doc.Strong(words):
                rich.append(words, "bold")
            case doc.Small(words):
                rich.append(f"\n{words}".removeprefix("" if rich.plain else "\n") if words else "", "dim")
            case doc.Note(words):
                rich.append(f"  {words}" if words else "", "dim")
            case doc.Mark(words):
                rich.append(words, "yellow")
            case doc.Code(words) | doc.Math(_, words):
                rich.append(words)
    return rich


def _table(console: Console, block: doc.Table) -> None:
    """A table below its caption, without columns that are empty, or yield where there is no room; words wrap."""
    columns = _columns(block)
    table = _rich_table(block, columns)
    if width_of(table) > console.width and columns[-1].form == "small":  # below the first column, which has more room
        first, last = columns[0].key, columns.pop().key
        rows = []
        for row in block.rows:
            below = doc.text_of(row.cells[first]), doc.Small(doc.text_of(row.cells[last]))
            rows.append(replace(row, cells={**row.cells, first: below}))
        columns[0] = replace(columns[0], form="text")
        block = replace(block, rows=rows)
        table = _rich_table(block, columns)
    while (over := width_of(table) - console.width) > _spare(table) and any(c.yields for c in columns):
        columns.remove([c for c in columns if c.yields][-1])
        table = _rich_table(block, columns)
    if over > 0:
        wrapped = [column for column in table.columns if not column.no_wrap] or table.columns[:1]
        lines = [
            [line for cell in (column.header, *column.cells) for line in str(cell).split("\n")] for column in wrapped
        ]
        room = console.width - width_of(table) + sum(max(map(len, column_lines)) for column_lines in lines)
        by_length = sorted(zip(wrapped, lines, strict=True), key=lambda pair: max(map(len, pair[1])))
        for n, (column, column_lines) in enumerate(by_length):  # what needs less than its share leaves it to the others
            column.no_wrap, column.width = False, max(min(max(map(len, column_lines)), room // (len(wrapped) - n)), 1)
            room -= column.width
    console.print()
    caption = doc.text_of(block.caption)
    if caption:
        console.print(RichText(_sentence(caption), style="bold"))
    console.print(table)


def _spare(table: RichTable) -> int:
    """Characters that columns of words can give up: a third of their longest line, and no word is broken."""
    spare = 0
    for column in table.columns:
        lines = [] if column.no_wrap else [line for cell in column.cells for line in str(cell).split("\n")]
        longest, word = (max(map(len, texts), default=0) for texts in (lines, " ".join(lines).split()))
        spare += longest - max(word, longest * 2 // 3)
    return spare


def _rich_table(block: doc.Table, columns: Sequence[doc.Column]) -> RichTable:
    apart = 1 if block.look == "listing" else _APART
    table = RichTable(box=None, pad_edge=False, padding=(0, apart, 0, 0), header_style="dim underline",
                     show_header=any(column.head for column in columns))  # fmt: skip
    for column in columns:
        head = column.head.replace(" ", "\n") if len(columns) > _MANY else column.head
        table.add_column(RichText(head), justify="right" if column.form == "number" else "left", overflow="fold")
    group = ""
    for row in block.rows:
        if block.group and row.cells[block.group] != group:
            group = doc.text_of(row.cells[block.group])
            table.add_row(RichText(group, style="bold cyan"), *[""] * (len(columns) - 1))
        table.add_row(*(rich_text(row.cells.get(c.key, ""), "bold" if row.total else "") for c in columns))
    for rich_column, own in zip(table.columns, columns, strict=True):
        rich_column.no_wrap = own.form in ("number", "status") or (own.form == "name" and not own.width)
    return table
