"""The sheet and the CSV rows of the parts list, and the data sheets of the parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from drivesizer.catalog import Catalog, columns_of, singular
from drivesizer.catalog.lookup import origins
from drivesizer.catalog.query import Hit
from drivesizer.output.part.datasheet import datasheets
from drivesizer.output.part_line import PartLine
from drivesizer.output.part_totals import totals
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.sections.blocks import Block, Fragment, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Cell, Sheet, SheetColumn
from drivesizer.output.report.sections.sheets import NOTE, STATUS
from drivesizer.output.report.sections.summary import OUTCOMES
from drivesizer.output.report.sections.texts import Mark
from drivesizer.results.drive_set import section_of
from drivesizer.units import KINDS, from_si

__all__ = ["DATA_SHEETS", "PARTS", "PART_COLUMNS", "part_sheet_row", "sheet_blocks"]


PART_COLUMNS = (
    SheetColumn("role", "role"), SheetColumn("maker", "maker"), SheetColumn("family", "family"),
    SheetColumn("part", "part"), SheetColumn("order number", "order_number"), STATUS, SheetColumn("is", "said"),
    SheetColumn("quantity", "quantity", "count"), SheetColumn("mass of one (g)", "mass_g"),
    SheetColumn("from (g)", "mass_low_g"), SheetColumn("to (g)", "mass_high_g"),
    SheetColumn("mass of all (g)", "masses_g"), SheetColumn("price of one", "price", "money"),
    SheetColumn("price of all", "prices", "money"), SheetColumn("currency", "currency"),
    SheetColumn("price from (pieces)", "pieces", "count"), SheetColumn("price date", "price_date"),
    SheetColumn("price confidence", "price_confidence", "confidence"),
    SheetColumn("part confidence", "confidence", "confidence"), NOTE,
    SheetColumn("price source", "price_source", "line"), SheetColumn("part source", "document", "line"),
    SheetColumn("source date", "date"), SheetColumn("page", "url", "line"),
)  # fmt: skip


def _sheet(content: Content) -> list[Sheet]:
    rows = [part_sheet_row(line) for line in content.bought]
    known = "mass and price are empty where no catalogue has them; a mass with from and to is estimated"
    note = known if rows else "no drive meets all limits: nothing to buy"
    return [Sheet(name="Parts list", columns=PART_COLUMNS, rows=rows, note=note, still=1)]


def part_sheet_row(line: PartLine) -> table.Row:
    """A part by the keys of ``PART_COLUMNS``."""
    grams, low, high = (from_si(mass, "g", "mass") for mass in (line.mass, line.mass_low, line.mass_high))
    row = {name: getattr(line, name) for name in line.__slots__}
    return row | {"status": "" if line.order_number else "unknown", "mass_g": grams, "mass_low_g": low,
                  "mass_high_g": high, "masses_g": line.quantity * grams,
                  "prices": line.quantity * line.price}  # fmt: skip


def _csv(content: Content) -> Iterator[table.Row]:
    rows = [row for line in content.bought for row in table.part_rows(line)]
    yield from (row | {"set_rank": 1} for row in (*rows, *table.total_rows(totals(content.bought))))


def _no_blocks(_: Content) -> tuple[()]:
    """None: its table is in the summary."""
    return ()


PARTS = Section(name="parts", title="Parts list", level=2, blocks=_no_blocks, sheets=_sheet, csv=CsvRows(after=_csv))


# -- data sheets


def _datasheets(content: Content) -> Iterator[Block]:
    if content.drive is not None:
        yield from sheet_blocks(datasheets(content.drive, content.result.catalog))


def sheet_blocks(sheets: Sequence[dict[str, Any]]) -> Iterator[Block]:
    """Data sheets of parts, below the meaning of their marks."""
    yield Words((
        "Figures without a mark are quoted from the maker's own document. Marked ones are not: ", Mark("secondary"),
        " copied by others, ", Mark("derived"), " computed or inferred, ", Mark("recalled"),
        " from memory, to be checked before anything is built. Figures that the catalogue does not know are not "
        "listed.",
    ))  # fmt: skip
    yield Fragment("datasheets", sheets)


_FIGURES = (
    SheetColumn("part", "role"), SheetColumn("maker", "maker"), SheetColumn("family", "family"),
    SheetColumn("number", "number"), SheetColumn("figure", "title"), SheetColumn("value", "value"),
    SheetColumn("unit", "unit", "unit"), SheetColumn("SI value", "si_value"), SheetColumn("SI unit", "si_unit", "unit"),
    SheetColumn("confidence", "confidence", "confidence"), NOTE, SheetColumn("source date", "date"),
    SheetColumn("source", "document", "line"),
)  # fmt: skip


def _figures_sheet(content: Content) -> list[Sheet]:
    """Every known figure of the drive's parts with its source and confidence, and the figures of the drive."""
    result, best = content.result, content.drive
    if best is None:
        return [Sheet(name="Selected drive", columns=_FIGURES, rows=[], note="no drive was examined")]
    figures = [table.figure_row("figure", f) | {"role": "drive", "confidence": "computed"} for f in best.figures]
    once = {(section_of(part), part.part): part for part in best.parts.values() if part is not None}
    rows = [row for (section, _), part in once.items() for row in _figures(section, part, result.catalog)]
    note = "" if result.sets else OUTCOMES[content.outcome]
    return [Sheet(name="Selected drive", columns=_FIGURES, rows=[*rows, *figures], note=note, still=5)]


_IN_HEAD = {"part", "family", "manufacturer"}


def _figures(section: str, part: Any, catalog: Catalog) -> Iterator[table.Row]:
    """The known figures of a part, and the notes on them."""
    known = origins(Hit("", catalog, section, catalog.table(section).rows[part.part]))
    notes = catalog.notes_on(section, part.part)
    named = {"role": singular(section), "maker": part.manufacturer, "family": part.family, "number": part.part}
    of_part = "; ".join(note.text for note in notes if not note.fields)
    yield named | _sourced(known["part"]) | {"title": "part", "value": part.part, "note": of_part}
    for name, column in columns_of(section).items():
        if name in known and name not in _IN_HEAD:
            note = "; ".join(note.text for note in notes if name in note.fields)
            yield named | _measured(getattr(part, name), column) | _sourced(known[name]) | {
                "title": name.replace("_", " "), "note": note}  # fmt: skip


def _measured(value: Any, column: Any) -> table.Row:
    if column.kind == "text":
        return {"value": value}
    form = "money" if column.kind.startswith("price") else "datum"
    return {"value": Cell(from_si(value, column.unit, column.kind), form), "unit": column.unit, "si_value": value,
            "si_unit": KINDS[column.kind].si}  # fmt: skip


def _sourced(source: Any) -> table.Row:
    return {"confidence": source.confidence, "document": source.document, "date": source.date}


DATA_SHEETS = Section(
    name="datasheets",
    title="Data sheets",
    blocks=_datasheets,
    sheets=_figures_sheet,
    appendix=True,
    tabled=False,
)
