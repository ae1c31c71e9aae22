"""Catalogues on the terminal: lists, a part's page, parts side by side, how complete they are."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from math import isnan
from types import SimpleNamespace
from typing import Any, cast

from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.compare import Row
from drivesizer.catalog.lookup import families, origins, partners
from drivesizer.catalog.parts import Column
from drivesizer.catalog.query import Hit, Selection
from drivesizer.report.datasheet import datasheets
from drivesizer.results import DriveSet
from drivesizer.terminal_tables import bare, console, heading
from drivesizer.units import label, show

__all__ = ["comparison", "counted", "figure", "listing", "overview", "page", "searched"]

_SHOWN: dict[str, tuple[tuple[str, str], ...]] = {  # head, column
    "motors": (
        ("power", "assigned_power"), ("voltage", "nominal_voltage"), ("torque", "nominal_torque"),
        ("speed", "no_load_speed"), ("mass", "mass"), ("price", "price"),
    ),
    "gearheads": (
        ("ratio", "reduction"), ("torque", "continuous_torque"), ("input", "continuous_input_speed"),
        ("eff.", "efficiency"), ("mass", "mass"), ("price", "price"),
    ),
    "encoders": (
        ("counts", "counts_per_turn"), ("ch.", "channels"), ("frequency", "max_frequency"), ("speed", "max_speed"),
        ("mass", "mass"), ("price", "price"),
    ),
    "controllers": (
        ("drives", "drives"), ("from", "supply_min"), ("to", "supply_max"), ("cont.", "continuous_current"),
        ("peak", "peak_current"), ("price", "price"),
    ),
}  # fmt: skip
_NOTES = {
    "motors": "torque nominal, speed without load",
    "gearheads": "torque and input speed continuous",
    "encoders": "",
    "controllers": "supply from and to; current continuous and peak",
}
_LINE = (
    ("no load", "no_load_speed", "", "no_load_current"),
    ("nominal", "nominal_speed", "nominal_torque", "nominal_current"),
    ("stall", "", "stall_torque", "stall_current"),
)
_DOUBT = {"quoted": "", "secondary": "cyan", "derived": "yellow", "recalled": "red"}
_BESIDE = 4  # parts side by side on 80 columns


def figure(value: Any, column: Column, *, unit: bool = True) -> str:
    """A figure as a data sheet prints it; one that is unknown says so."""
    if isinstance(value, str):
        return value or "unknown"
    if column.kind.startswith("price") and not isnan(value):
        text = f"{value:.2f} {column.unit}"  # to the cent, as money is
    else:
        text = show(value, column.unit, column.kind, 5)
    return text if unit else text.removesuffix(label(column.unit)).strip()


def overview(shelf: Mapping[str, Catalog]) -> None:
    """The families of each section."""
    out = console()
    for section, names in families(shelf).items():
        count = sum(map(len, names.values()))
        heading(out, section, f"{count} parts in {len(names)} families")
        out.print(counted({name: len(hits) for name, hits in sorted(names.items())}, out.width))
        out.print()
    out.print(Text("drivesizer catalog list motors --family 'RE 25' lists a family, '--power >=20W' more than one."))


def counted(counts: Mapping[str, int], width: int, head: str = "") -> Text:
    """Names with their counts, one after the other; a line ends between two of them."""
    glue = "\u00a0"  # no line ends here
    items = [
        f"{name or 'no family'} ({count})".replace(" ", glue).replace("-", "\u2011") for name, count in counts.items()
    ]
    text = textwrap.fill(f"{head}{', '.join(items)}", width, break_long_words=False)
    return Text(text.replace(glue, " ").replace("\u2011", "-"))


def listing(section: str, found: Selection, limit: int, extra: Sequence[str]) -> None:
    """The parts of a selection, a line each; further columns are those that were asked for."""
    out, schema = console(), columns_of(section)
    usual = [(head, schema[name]) for head, name in _SHOWN[section]]
    there = {column.name for _, column in usual} | {"part", "family", "manufacturer"}
    asked = [(name.replace("_", "\n"), schema[name]) for name in dict.fromkeys(extra) if name not in there]
    hits = found.hits[:limit]
    while len(usual) > 1 and _width(hits, usual + asked) > out.width:
        usual.pop()  # what was asked for is of more use than the last of the usual columns
    if hits:
        out.print(_table(hits, usual + asked))
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


def _width(hits: Sequence[Hit], shown: Sequence[tuple[str, Column]]) -> int:
    """How wide a table would be that breaks no word."""
    table = _table(hits, shown)
    return Measurement.get(Console(width=1000), Console(width=1000).options, table).maximum


def _short(value: Any, column: Column) -> Text:
    text = figure(value, column, unit=False)
    return Text("–", style="dim") if text == "unknown" else Text(text)


def _footer(section: str, found: Selection, limit: int) -> list[str]:
    count = len(found.hits)
    more = f"the first {limit} of {count} {section}; --limit shows more" if count > limit else f"{count} {section}"
    said = [f"{more}{f'; {_NOTES[section]}' if count and _NOTES[section] else ''}"]
    if found.undecided:
        said.append(f"{found.undecided} more may fit: a figure that is asked for is unknown")
    if found.excluded:
        said.append(f"{found.excluded} more are excluded from sizing by a note; --excluded lists them (×)")
    return said


def page(hit: Hit, *, sources: bool = False) -> None:
    """One part as a data sheet: figures, torque and speed, what goes with it, and what its figures rest on."""
    out, sheet = console(), _sheet(hit)
    reduction = f" {hit['reduction']}" if hit.section == "gearheads" else ""
    head = f"{sheet['maker']} {sheet['family']}{reduction}".strip()
    heading(out, head, f"{hit.part} · {hit.section[:-1]} in {hit.catalogue}")
    _figures(out, hit, sheet, sources)
    if hit.section == "motors":
        out.print(_torque_speed(hit))
    _partners(out, hit)
    _remarks(out, hit, sheet, sources)
    out.print()


def _sheet(hit: Hit) -> dict[str, Any]:
    """The report's data sheet of one part."""
    roles: dict[str, Any] = dict.fromkeys(("motor", "gearhead", "encoder", "controller"))
    roles[hit.section[:-1]] = hit.table.record(hit.row)
    return datasheets(cast(DriveSet, SimpleNamespace(**roles)), hit.catalog)[0]


def _figures(out: Console, hit: Hit, sheet: dict[str, Any], sources: bool) -> None:
    origin = {name.replace("_", " "): source for name, source in origins(hit).items()}
    documents = _documents(hit)
    table = bare(("", "left"), ("", "right"), ("", "left"), *([("source", "right")] if sources else []))
    table.show_header = sources
    for row in sheet["rows"]:
        source = origin[row["name"]]
        sure = source.confidence if sources else row["mark"]
        number = [f"[{documents.index(source.document) + 1}]"] if sources else []
        cells = (row["name"], row["text"], Text(sure, style=_DOUBT[source.confidence]), *map(Text, number))
        table.add_row(*(Text(c) if isinstance(c, str) else c for c in cells))
    out.print(table)


def _documents(hit: Hit) -> list[str]:
    """The documents behind a part's figures, each once."""
    return list(dict.fromkeys(source.document for source in origins(hit).values()))


def _torque_speed(hit: Hit) -> Any:
    """Three points of the line at nominal voltage, as the maker gives them."""
    schema = columns_of("motors")
    table = bare(("", "left"), ("speed", "right"), ("torque", "right"), ("current", "right"), title="torque and speed")
    for name, *columns in _LINE:
        cells = [figure(hit[c], schema[c]) if c else "0" for c in columns]
        table.add_row(name, *cells)
    return table


def _partners(out: Console, hit: Hit) -> None:
    for section, counts in partners(hit).items():
        if counts:
            out.print(counted(counts, out.width, f"{section}: {sum(counts.values())} in {len(counts)} families: "))
        else:
            out.print(Text(f"{section}: none is listed; one may still exist"))
    if hit.table.excluded[hit.row]:
        out.print(Text("excluded from sizing by a note", style="red"))


def _remarks(out: Console, hit: Hit, sheet: dict[str, Any], sources: bool) -> None:
    for note in sheet["notes"]:
        said = "; ".join(text for text in (note["text"], note["confidence"]) if text)
        out.print(Text("note: ", style="bold") + Text(f"{note['where']}: {said}" if note["where"] else said))
    if not sources:
        out.print(Text("source: ", style="bold") + Text(f"{sheet['source']} ({sheet['confidence']})"))
        return
    known = {source.document: source for source in origins(hit).values()}
    for place, document in enumerate(_documents(hit), 1):
        parts = (document, known[document].date, known[document].url)
        out.print(Text(f"[{place}] " + ", ".join(part for part in parts if part)))


def comparison(hits: Sequence[Hit], rows: Sequence[Row]) -> None:
    """Parts side by side; a row in which they differ is marked, ? where some are unknown."""
    out = console()
    for start in range(0, len(hits), _BESIDE):
        some = slice(start, start + _BESIDE)
        table = bare(("", "left"), ("", "left"), *((escape(f"{h.part}\n{h.catalogue}"), "right") for h in hits[some]))
        for row in rows:
            mark = "?" if row.differs is None else "≠" if row.differs else ""
            cells = (figure(value, row.column) for value in row.values[some])
            style = "bold" if row.differs else ""
            table.add_row(mark, Text(row.column.name.replace("_", " "), style=style), *map(Text, cells))
        out.print(table)
    differing = sum(row.differs is True for row in rows)
    out.print(Text(f"≠ differs ({differing} of {len(rows)} rows), ? cannot be told: a figure is unknown"))


def searched(groups: Mapping[str, Mapping[str, Sequence[Hit]]], parts: Sequence[Hit], limit: int) -> None:
    """Families and parts that a text was found in."""
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
        out.print(Text(f"the first {limit} of {len(parts)} parts; --limit shows more"))


def _kinds(hits: Sequence[Hit]) -> str:
    column = "drives" if hits[0].section == "controllers" else "kind"
    return ", ".join(kind for kind in Counter(hit[column] for hit in hits) if kind)


def _catalogues(hits: Sequence[Hit]) -> str:
    return ", ".join(dict.fromkeys(hit.catalogue for hit in hits))
