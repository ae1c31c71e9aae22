"""Catalogues at the terminal: overview, lists of parts, comparison, search."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.columns import Column
from drivesizer.catalog.compare import Row
from drivesizer.catalog.conditions import OPTIONS
from drivesizer.catalog.lookup import families
from drivesizer.catalog.query import Hit, Selection
from drivesizer.output.counted import number_of
from drivesizer.output.part.figures import FIRST_NOTES, figure, first_columns
from drivesizer.output.part.remarks import DIFFERS, closing, family_count
from drivesizer.output.terminal.tables import bare, console, heading, width_of
from drivesizer.units import label

__all__ = ["comparison", "counts_text", "listing", "overview", "searched"]

_BESIDE = 4  # parts side by side on 80 columns


_FEW = 5  # catalogues of which the families are named, else their makers


def overview(shelf: Mapping[str, Catalog]) -> None:
    """Print the families of each section; of many catalogues the makers."""
    out = console()
    for section, names in families(shelf).items():
        hits = [hit for some in names.values() for hit in some]
        if not hits:
            continue
        heading(out, section, f"{number_of(len(hits), 'part')} in {family_count(len(names))}")
        if len(shelf) > _FEW:
            counts: Mapping[str, int] = dict(Counter(hit["manufacturer"] for hit in hits).most_common())
        else:
            counts = {name: len(some) for name, some in sorted(names.items())}
        out.print(counts_text(counts, out.width))
        out.print()
    if len(shelf) > _FEW:
        out.print(Text("drivesizer catalog list --catalog maxon shows the families of one catalogue."))
    out.print(Text("drivesizer catalog list motors --family 'RE 25' lists a family, '--power >=20W' more than one."))


def counts_text(counts: Mapping[str, int], width: int, head: str = "") -> Text:
    """Names with their counts as wrapped text; no line breaks inside a name."""
    glue = "\u00a0"  # no line ends here
    items = [
        f"{name or 'no family'} ({count})".replace(" ", glue).replace("-", "\u2011") for name, count in counts.items()
    ]
    text = textwrap.fill(f"{head}{', '.join(items)}", width, break_long_words=False)
    return Text(text.replace(glue, " ").replace("\u2011", "-"))


def listing(section: str, found: Selection, limit: int, extra: Sequence[str]) -> None:
    """Print the parts of a selection, a line each."""
    out, schema = console(), columns_of(section)
    usual = first_columns(section)
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    requested = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(extra) if name not in there]
    hits = found.hits[:limit]
    while len(usual) > 1 and width_of(_table(hits, usual + requested)) > out.width:
        usual.pop()  # requested columns go before the last of the usual ones
    if hits:
        out.print(_table(hits, usual + requested))
    for line in _footer(section, found, limit):
        out.print(Text(line))


def _table(hits: Sequence[Hit], shown: Sequence[tuple[str, Column]]) -> Table:
    heads = [(f"{head}\n{label(c.unit)}".rstrip(), "left" if c.kind == "text" else "right") for head, c in shown]
    table = bare(("part", "left"), ("family", "left"), *heads)
    table.padding = (0, 1, 0, 0)
    for hit in hits:
        mark = Text(" ×" if hit.table.excluded[hit.row] else "", style="red")
        table.add_row(Text(hit.part) + mark, Text(hit["family"]), *(_short(hit[c.name], c) for _, c in shown))
    return table


def _short(value: Any, column: Column) -> Text:
    text = figure(value, column, unit=False)
    return Text("–", style="dim") if text == "unknown" else Text(text)


def _footer(section: str, found: Selection, limit: int) -> list[str]:
    count = len(found.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    said = [f"{more}{f'; {FIRST_NOTES[section]}' if count and FIRST_NOTES[section] else ''}"]
    if found.undecided:
        said.append(f"{found.undecided} more may fit: a required figure is unknown")
    if found.excluded:
        said.append(f"{found.excluded} more are excluded from sizing by a note; --excluded lists them (×)")
    return said


def comparison(hits: Sequence[Hit], rows: Sequence[Row]) -> None:
    """Print parts side by side; a row in which they differ is marked, ? where some are unknown."""
    out = console()
    for start in range(0, len(hits), _BESIDE):
        some = slice(start, start + _BESIDE)
        table = bare(("", "left"), ("", "left"), *((escape(f"{h.part}\n{h.catalogue}"), "right") for h in hits[some]))
        for row in rows:
            mark = DIFFERS[row.differs]
            cells = (figure(value, row.column) for value in row.values[some])
            style = "bold" if row.differs else ""
            table.add_row(mark, Text(row.column.name.replace("_", " "), style=style), *map(Text, cells))
        out.print(table)
    out.print(Text(closing(rows)))


def searched(groups: Mapping[str, Mapping[str, Sequence[Hit]]], parts: Sequence[Hit], limit: int) -> None:
    """Print the families and parts in which a text was found."""
    out = console()
    if any(groups.values()):
        table = bare(("", "left"), ("family", "left"), ("parts", "right"), ("kind", "left"), ("catalogue", "left"))
        for section, names in groups.items():
            for name, hits in sorted(names.items()):
                table.add_row(section, *map(Text, (name, str(len(hits)), _kinds(hits), _catalogues(hits))))
        out.print(table)
    if parts:
        table = bare(("", "left"), ("part", "left"), ("family", "left"), ("catalogue", "left"))
        for hit in parts[:limit]:
            table.add_row(hit.section, *map(Text, (hit.part, hit["family"], hit.catalogue)))
        out.print(table)
    if len(parts) > limit:
        out.print(Text(f"the first {limit} of {number_of(len(parts), 'part')}; --limit shows more"))


def _kinds(hits: Sequence[Hit]) -> str:
    column = OPTIONS["kind"][hits[0].section]
    return ", ".join(kind for kind in Counter(hit[column] for hit in hits) if kind)


def _catalogues(hits: Sequence[Hit]) -> str:
    return ", ".join(dict.fromkeys(hit.catalogue for hit in hits))
