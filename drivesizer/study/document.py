"""A study as a document: its variants by their outcome, the tables that it wants, its maps, and every variant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import Any

from drivesizer.output.document import records as doc
from drivesizer.output.report.figures.picture import Pictured
from drivesizer.output.words import number_of
from drivesizer.results.check import GRAVEST, sentence_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.study.maps import MAPS
from drivesizer.study.rows import Column, Row
from drivesizer.study.run import INFLUENCE, Outcome

_MOST = 60  # variants on paper; the workbook has all
_HEADS = {  # columns of the table that paper has beside those that vary
    "objective": "by", "status": "", "set": "drive", "machine_mass_kg": "mass (kg)", "machine_price_EUR": "price (EUR)",
    "smallest_margin": "margin", "smallest_margin_check": "tightest check",
}  # fmt: skip
_WIDTHS = {"set": 2.0, "smallest_margin_check": 1.4}  # on paper
_TITLES = {
    "best.csv": "The best variant of each case", "front.csv": "The front: no variant beats these in all goals",
    "influence.csv": "The share of a figure's variance that each field explains alone, with its means at both ends",
}  # fmt: skip


def document_of(outcome: Outcome) -> doc.Document:
    """The study with its results."""
    plan = outcome.plan
    assert plan is not None
    varied = {axis.head for axis in plan.job.axes} | {"spec", "catalogs"}
    sections = [doc.section("outcome", "Outcome", _outcome(outcome))]
    for file, columns, rows in outcome.answers:
        named = {column.head for column in columns} if columns is INFLUENCE else varied
        table = _table(_TITLES[file], columns, rows, named, media="shown")
        sections.append(doc.section(file.removesuffix(".csv"), file.removesuffix(".csv").capitalize(), [table]))
    maps = [doc.Picture(chart.name, chart.title, chart.title) for chart in MAPS if chart.name in outcome.maps]
    if maps:
        sections.append(doc.section("maps", "Maps", maps))
    every_row, caption = outcome.every_row, "Variants with their drives; mass and price of all of them"
    few = f", the first {_MOST} of their rows; the workbook has all" * any(
        True for _ in islice(every_row(), _MOST, None)
    )
    variants = [
        _table(f"{caption}{few}", outcome.columns, islice(every_row(), _MOST), varied, media="print"),
        _table(caption, outcome.columns, every_row(), varied, media="book"),
    ]
    sections.append(doc.section("variants", "Variants", variants))
    pictures = {name: Pictured(drawing) for name, drawing in outcome.maps.items()}
    return doc.Document(name=plan.source.name, subject="study", sections=sections, pictures=pictures,
                        machine=", ".join(axis.name for axis in plan.job.axes))  # fmt: skip


def _outcome(outcome: Outcome) -> Iterator[doc.Block]:
    of = number_of(outcome.variants.total(), "variant"), number_of(outcome.examined, "drive")
    names = [name for name in (*reversed(GRAVEST), "error") if outcome.variants[name]]
    rows = [(name, doc.Quantity(outcome.variants[name])) for name in names]
    yield doc.table("across", f"{of[0]}, {of[1]} examined", rows, more=[doc.Column("value", "variants", "number")])
    if outcome.notes:
        yield doc.Bullets("Notes:", outcome.notes)


def _table(
    caption: str, columns: Sequence[Column], rows: Iterable[Row], varied: set[str], media: doc.Media
) -> doc.Table:  # fmt: skip
    heads = [doc.Column(column.head, _HEADS.get(column.head, column.head), _form(column), _WIDTHS.get(column.head, 0.0),
                        media="all" if column.head in varied or column.head in _HEADS else "book")
             for column in columns]  # fmt: skip
    table_rows = [
        doc.Row({column.head: _cell(column, value) for column, value in zip(columns, row, strict=True)}) for row in rows
    ]
    return doc.Table(caption, heads, table_rows, dense=True, media=media)


def _form(column: Column) -> str:
    return "status" if column.head == "status" else "text" if column.form == "text" else "number"


def _cell(column: Column, value: Any) -> doc.Cell:
    """A value of the table; what is not known is empty."""
    if value is None:
        return ""
    if isinstance(value, str):
        if column.head == "smallest_margin_check":
            return next((sentence_case(of[value].title) for of in CHECKS.values() if value in of), value)
        return (doc.Status(value),) if column.head == "status" and value != "error" else value
    if column.head == "smallest_margin":
        return doc.Quantity(value, "%", "margin")
    return doc.Quantity(value, "1", "count" if column.form == "whole" else "plain", own=f"{value:g}")
