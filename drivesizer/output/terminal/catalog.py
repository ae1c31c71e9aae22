"""Catalogues at the terminal: overview, lists, comparison, one part as a data sheet."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, columns_of, singular
from drivesizer.catalog.conditions import OPTIONS
from drivesizer.catalog.parts import Column
from drivesizer.catalog.query import Hit, Row, Selection, families, origins
from drivesizer.output.part import (
    DIFFERS,
    EXCLUDED,
    PartTable,
    closing,
    datasheet,
    discharges,
    documents,
    estimates,
    family_count,
    head,
    heat,
    limits_of_family,
    note_line,
    partner_lines,
    pull_outs,
    reach_of,
    source_line,
    sources_of,
    speed_torque,
    tolerance_lines,
    torque_and_speed,
)
from drivesizer.output.terminal.tables import Axis, Series, bare, chart, console, heading, width_of
from drivesizer.output.words import FIRST_NOTES, figure, first_columns, number_of
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


# -- One part at the terminal as a data sheet: figures, torque and speed, heat, matching parts, tolerances, sources.


_DOUBT = {"quoted": "", "secondary": "cyan", "derived": "yellow", "recalled": "red"}
_LOOKS: dict[str, dict[str, Any]] = {  # of a curve in the chart
    "line": {}, "continuous": {"gap": 2, "style": "green"}, "peak": {"gap": 4, "style": "yellow"},
    "nominal": {"mark": "●", "style": "green"},
}  # fmt: skip
_WIDEST = 160  # columns of the chart, however wide the terminal
_HEIGHT = 8  # columns of the terminal to a line of the chart's field


def page(hit: Hit, *, sources: bool = False) -> None:
    """Print one part as a data sheet."""
    out, sheet = console(), datasheet(hit.section, hit.table.record(hit.row), hit.catalog)
    heading(out, head(hit), f"{hit.part} · {singular(hit.section)} in {hit.catalogue}")
    _figures(out, hit, sheet, sources)
    if hit.section in ("motors", "actuators"):
        out.print(_set(torque_and_speed(hit)))
        out.print(*_chart(hit, min(out.width, _WIDEST)), sep="\n")
        _heat(out, hit)
        out.print()
    if hit.section == "batteries":
        out.print(*map(_set, discharges(hit)), sep="\n")
    if hit.section == "steppers":
        out.print(*map(_set, pull_outs(hit)), sep="\n")
    for table in (estimates(hit), limits_of_family(hit)):
        if table:
            out.print(_set(table))
            out.print(Text(table.closing, style="dim"))
    _remarks(out, hit, sheet, sources)
    out.print()


def _set(table: PartTable) -> Table:
    found = bare(*table.heads, title=table.title)
    for row in table.rows:
        found.add_row(*row)
    return found


# --- figures, partners, sources --------------------------------------------------------------------------------------


def _figures(out: Console, hit: Hit, sheet: dict[str, Any], sources: bool) -> None:
    origin = {name.replace("_", " "): source for name, source in origins(hit).items()}
    named = documents(hit)
    rows = []
    for row in sheet["rows"]:
        source = origin[row["name"]]
        confidence = source.confidence if sources else row["mark"]
        number = [f"[{named.index(source.document) + 1}]"] if sources else []
        cells = (row["name"], row["text"], Text(confidence, style=_DOUBT[source.confidence]), *map(Text, number))
        rows.append([Text(c) if isinstance(c, str) else c for c in cells])
    half = (len(rows) + 1) // 2
    halves = [_block(part, sources) for part in (rows[:half], rows[half:])]
    if not _side_by_side(out, halves):
        out.print(_block(rows, sources))


def _block(rows: Sequence[Sequence[Text]], sources: bool) -> Table:
    table = bare(("", "left"), ("", "right"), ("", "left"), *([("source", "right")] if sources else []), headed=sources)
    for row in rows:
        table.add_row(*row)
    return table


def _side_by_side(out: Console, tables: Sequence[RenderableType]) -> bool:
    """Print tables side by side; False, without printing, where they do not fit."""
    if sum(width_of(table) + 2 for table in tables) > out.width:
        return False
    grid = Table.grid(padding=(0, 2, 0, 0))
    grid.add_row(*tables)
    out.print(grid)
    return True


def _remarks(out: Console, hit: Hit, sheet: dict[str, Any], sources: bool) -> None:
    """Print parts that it goes with, tolerances, notes and sources."""
    for line, partners in partner_lines(hit):
        out.print(counts_text(partners, out.width, line) if partners else Text(line))
    if hit.table.excluded[hit.row]:
        out.print(Text(EXCLUDED, style="red"))
    named = [("tolerances", line) for line in tolerance_lines(hit)]
    named += [("note", note_line(note)) for note in sheet["notes"]]
    named += [] if sources else [("source", source_line(sheet))]
    for name, line in named:
        out.print(Text(f"{name}: ", style="bold") + Text(line))
    for place, line in enumerate(sources_of(hit) if sources else (), 1):
        out.print(Text(f"[{place}] {line}"))


# --- torque and speed ------------------------------------------------------------------------------------------------


def _chart(hit: Hit, width: int) -> list[Text]:
    """Speed over torque; nothing where neither a line nor a continuous region is known."""
    torque, speed = (columns_of(hit.section)[name] for name in ("nominal_torque", "no_load_speed"))
    series = [
        Series(
            curve.name,
            [from_si(M, torque.unit, torque.kind) for M in curve.torque],
            [from_si(w, speed.unit, speed.kind) for w in curve.speed],
            **_LOOKS[curve.kind],
        )
        for curve in speed_torque(hit)
    ]
    if not series:
        return []
    level = Axis("torque", label(torque.unit), from_si(reach_of(hit), torque.unit, torque.kind))
    upright = Axis("speed", label(speed.unit), max(y for one in series for y in one.y))
    return chart(series, level, upright, width, width // _HEIGHT)


# --- heat ------------------------------------------------------------------------------------------------------------


def _heat(out: Console, hit: Hit) -> None:
    """Print continuous current over ambient temperature and overload times at 25 degC, or what is missing for them."""
    found = heat(hit)
    tables = [_set(table) for table in found.tables]
    if tables:
        out.print()
    if not tables or not _side_by_side(out, tables):
        for table in tables:
            out.print(table)
    for line in (*found.notes, *([found.missing] if found.missing else [])):
        out.print(Text(line))
