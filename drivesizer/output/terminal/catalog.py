"""Catalogues at the terminal: overview, lists, comparison, one part as a data sheet."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, columns_of, singular
from drivesizer.catalog.conditions import OPTIONS
from drivesizer.catalog.parts import Column
from drivesizer.catalog.query import Hit, Row, Selection, families
from drivesizer.output import part_curves
from drivesizer.output.document import part
from drivesizer.output.document.records import Picture, listed
from drivesizer.output.terminal.render import blocks
from drivesizer.output.terminal.tables import Axis, Series, bare, chart, console, heading, width_of
from drivesizer.output.words import figure, first_columns, number_of
from drivesizer.units import from_si, label

# -- Catalogues at the terminal: overview, lists of parts, comparison, search.


_BESIDE = 4  # parts side by side on 80 columns


_FEW = 5  # catalogues of which the families are named, else their makers


def overview(shelf: Mapping[str, Catalog]) -> None:
    """Print the families of each section; of many catalogues the makers."""
    out = console()
    for section, names in families(shelf).items():
        hits = [hit for some in names.values() for hit in some]
        if not hits:
            continue
        heading(out, section, f"{number_of(len(hits), 'part')} in {part.family_count(len(names))}")
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
    note, usual = first_columns(section)
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    requested = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(extra) if name not in there]
    hits = found.hits[:limit]
    while len(usual) > 1 and width_of(_table(hits, usual + requested)) > out.width:
        usual.pop()  # requested columns go before the last of the usual ones
    if hits:
        out.print(_table(hits, usual + requested))
    for line in _footer(section, found, limit, note):
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


def _footer(section: str, found: Selection, limit: int, note: str) -> list[str]:
    count = len(found.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    said = [f"{more}; {note}" if count and note else more]
    if found.undecided:
        said.append(f"{found.undecided} more may fit: a required figure is unknown")
    if found.excluded:
        said.append(f"{found.excluded} more are excluded from sizing by a note; --excluded lists them (×)")
    return said


def comparison(hits: Sequence[Hit], rows: Sequence[Row]) -> None:
    """Print parts side by side; a row in which they differ is marked, ? where some are unknown."""
    blocks(console(), part.comparison(hits, rows, _BESIDE))


def searched(groups: Mapping[str, Mapping[str, Sequence[Hit]]], parts: Sequence[Hit], limit: int) -> None:
    """Print the families and parts in which a text was found."""
    out = console()
    rows = [(section, name, str(len(hits)), _kinds(hits), _catalogues(hits))
            for section, names in groups.items() for name, hits in sorted(names.items())]  # fmt: skip
    heads = (("", "left"), ("family", "left"), ("parts", "right"), ("kind", "left"), ("catalogue", "left"))
    blocks(out, [listed(heads, rows)])
    of_parts = (("", "left"), ("part", "left"), ("family", "left"), ("catalogue", "left"))
    blocks(out, [listed(of_parts, [(hit.section, hit.part, hit["family"], hit.catalogue) for hit in parts[:limit]])])
    if len(parts) > limit:
        out.print(Text(f"the first {limit} of {number_of(len(parts), 'part')}; --limit shows more"))


def _kinds(hits: Sequence[Hit]) -> str:
    column = OPTIONS["kind"][hits[0].section]
    return ", ".join(kind for kind in Counter(hit[column] for hit in hits) if kind)


def _catalogues(hits: Sequence[Hit]) -> str:
    return ", ".join(dict.fromkeys(hit.catalogue for hit in hits))


# -- One part at the terminal as a data sheet: figures, torque and speed, heat, matching parts, tolerances, sources.


_LOOKS: dict[str, dict[str, Any]] = {  # of a curve in the chart
    "line": {}, "continuous": {"gap": 2, "style": "green"}, "peak": {"gap": 4, "style": "yellow"},
    "nominal": {"mark": "●", "style": "green"},
}  # fmt: skip
_WIDEST = 160  # columns of the chart, however wide the terminal
_HEIGHT = 8  # columns of the terminal to a line of the chart's field


def page(hit: Hit, *, sources: bool = False) -> None:
    """Print one part as a data sheet."""
    out = console()
    heading(out, part.head(hit), f"{hit.part} · {singular(hit.section)} in {hit.catalogue}")
    blocks(out, [part.figures_of(hit, sources=sources)])
    for block in part.behaviour(hit):
        if isinstance(block, Picture):
            chart_of(out, hit)
        else:
            blocks(out, [block])
    out.print()
    for line, partners in part.partner_lines(hit):
        out.print(counts_text(partners, out.width, line) if partners else Text(line))
    blocks(out, part.remarks(hit, sources=sources))
    out.print()


def chart_of(out: Console, hit: Hit) -> None:
    """Print speed over torque; nothing where neither a line nor a continuous region is known."""
    if hit.section not in ("motors", "actuators"):
        return
    torque, speed = (columns_of(hit.section)[name] for name in ("nominal_torque", "no_load_speed"))
    series = [
        Series(one.name, from_si(np.asarray(one.torque), torque.unit, torque.kind).tolist(),
               from_si(np.asarray(one.speed), speed.unit, speed.kind).tolist(), **_LOOKS[one.kind])
        for one in part_curves.speed_torque(hit)
    ]  # fmt: skip
    if not series:
        return
    width = min(out.width, _WIDEST)
    level = Axis("torque", label(torque.unit), from_si(part_curves.reach_of(hit), torque.unit, torque.kind))
    upright = Axis("speed", label(speed.unit), max(y for one in series for y in one.y))
    out.print()
    out.print(*chart(series, level, upright, width, width // _HEIGHT), sep="\n")
