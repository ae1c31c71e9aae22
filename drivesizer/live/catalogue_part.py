"""One part on the page as ``drivesizer catalog show`` prints it, with its curves, and several side by side."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from drivesizer.live.catalogue import hit_of
from drivesizer.live.held import EngineMemory, Piece

if TYPE_CHECKING:
    from drivesizer.catalog.query import Hit
    from drivesizer.output.part.tables import PartTable

__all__ = ["part", "parts_compared"]


def part(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``part``: figures with confidence and document of each, tables, remarks and curves."""
    from drivesizer.catalog import singular
    from drivesizer.output.part.remarks import head
    from drivesizer.output.report.html.part_plots import part_plots

    hit = hit_of(held, request["catalogue"], request["section"], request["part"])
    yield {
        "kind": "part", "catalogue": hit.catalogue, "section": hit.section, "part": hit.part, "family": hit["family"],
        "head": head(hit), "role": singular(hit.section), "tables": [_plain(table) for table in _tables(hit)],
        "figures": part_plots(hit), **_sheet(hit),
    }  # fmt: skip


def _sheet(hit: Hit) -> Piece:
    """Figures, the documents behind them, and what else is said of a part."""
    from drivesizer.catalog.lookup import origins
    from drivesizer.output.part import remarks
    from drivesizer.output.part.datasheet import datasheet

    sheet = datasheet(hit.section, hit.table.record(hit.row), hit.catalog)
    origin = {name.replace("_", " "): source for name, source in origins(hit).items()}
    documents = list({source.document: source for source in origin.values()}.values())
    named = [source.document for source in documents]
    rows = [[row["name"], row["text"], origin[row["name"]].confidence, named.index(origin[row["name"]].document) + 1]
            for row in sheet["rows"]]  # fmt: skip
    partners = [words + ", ".join(f"{name or 'no family'} ({n})" for name, n in families.items())
                for words, families in remarks.partner_lines(hit)]  # fmt: skip
    excluded = [remarks.EXCLUDED] if hit.table.excluded[hit.row] else []
    return {
        "rows": rows,
        "documents": [[source.document, source.date, source.url] for source in documents],
        "remarks": [*excluded, *partners, *(f"tolerances: {line}" for line in remarks.tolerance_lines(hit)),
                    *(f"note: {remarks.note_line(note)}" for note in sheet["notes"])],
    }  # fmt: skip


def _tables(hit: Hit) -> Iterator[PartTable]:
    """Tables in the order of ``catalog show``."""
    from drivesizer.output.part import tables
    from drivesizer.output.part.heat import heat

    if hit.section in ("motors", "actuators"):
        warmth = heat(hit)
        yield tables.torque_and_speed(hit)
        yield from warmth.tables
        said = "; ".join((*warmth.notes, *([warmth.missing] if warmth.missing else [])))
        if said:
            yield tables.PartTable((), (), closing=said)
    if hit.section == "batteries":
        yield from tables.discharges(hit)
    if hit.section == "steppers":
        yield from tables.pull_outs(hit)
    yield from (table for table in (tables.estimates(hit), tables.limits_of_family(hit)) if table)


def _plain(table: PartTable) -> Piece:
    return {"title": table.title, "heads": [list(head) for head in table.heads], "closing": table.closing,
            "rows": [list(row) for row in table.rows]}  # fmt: skip


def parts_compared(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``beside``: parts of one kind side by side as of ``drivesizer catalog compare``."""
    from drivesizer.catalog.compare import side_by_side
    from drivesizer.output.part.figures import figure
    from drivesizer.output.part.remarks import DIFFERS, closing

    hits = [hit_of(held, name, request["section"], number) for name, number in request["parts"]]
    rows = side_by_side(hits)
    cells: list[Any] = [
        [row.column.name.replace("_", " "), DIFFERS[row.differs], [figure(value, row.column) for value in row.values]]
        for row in rows
    ]
    yield {"kind": "beside", "heads": [[hit.part, hit.catalogue] for hit in hits], "rows": cells,
           "closing": closing(rows)}  # fmt: skip
