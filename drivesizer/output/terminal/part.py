"""One part at the terminal as a data sheet: figures, torque and speed, heat, matching parts, tolerances, sources."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import columns_of, singular
from drivesizer.catalog.lookup import origins
from drivesizer.catalog.query import Hit
from drivesizer.output.part.datasheet import datasheet
from drivesizer.output.part.heat import heat
from drivesizer.output.part.remarks import (
    EXCLUDED,
    documents,
    head,
    note_line,
    partner_lines,
    source_line,
    sources_of,
    tolerance_lines,
)
from drivesizer.output.part.speed_torque import reach_of, speed_torque
from drivesizer.output.part.tables import (
    PartTable,
    discharges,
    estimates,
    limits_of_family,
    pull_outs,
    torque_and_speed,
)
from drivesizer.output.terminal.catalog import counts_text
from drivesizer.output.terminal.chart import Axis, Series, chart
from drivesizer.output.terminal.tables import bare, console, heading, width_of
from drivesizer.units import from_si, label

__all__ = ["page"]

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
    for line, families in partner_lines(hit):
        out.print(counts_text(families, out.width, line) if families else Text(line))
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
