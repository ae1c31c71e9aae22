"""Assumptions and warnings, and the figures that are estimated, unknown or not from a document."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.probability import about
from drivesizer.output.report.sections.blocks import Block, Bullets, Column, Row, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.texts import Mark, Strong, quantity
from drivesizer.results.figures_behind_checks import marked_figures, unknown_figures

__all__ = ["ASSUMPTIONS", "ESTIMATES", "unknown_blocks"]


def _blocks(content: Content) -> Iterator[Block]:
    result = content.result
    if result.assumptions:
        yield Bullets("Assumptions of the sizing:", list(result.assumptions))
    if result.warnings:
        yield Bullets((Strong("Warnings:"),), list(result.warnings), "alarm")
    yield from unknown_blocks(content)


def unknown_blocks(content: Content) -> Iterator[Block]:
    """Checks that are unknown, and figures behind checks that are from no document."""
    result, best = content.result, content.drive
    if best is None:
        return
    unknown = [Row((title, lacks)) for title, lacks in unknown_figures(best)]
    yield Table(f"Unknown checks{', and the figures that they lack' if unknown else ': none'}",
                (Column("check", "name"), Column("not known", width=1.0)), unknown, "unknown")  # fmt: skip
    marked = [
        Row((name, value, (Mark(mark),), checks)) for name, value, mark, checks in marked_figures(best, result.catalog)
    ]
    if not marked:
        yield Words("No check rests on a figure that is derived, recalled or estimated.")
        return
    columns = (Column("figure", "name"), Column("value", "number"), Column("is", "mark"),
               Column("checks that rest on it", "small", 1.0, merged=True))  # fmt: skip
    yield Table("Figures that a check rests on and that are not from a document: to be confirmed before anything is "
                "built", columns, marked, "marked")  # fmt: skip


ASSUMPTIONS = Section(name="assumptions", title="Assumptions and unknowns", blocks=_blocks, tabled=False)


def _estimates(content: Content) -> Iterator[Block]:
    drive = content.drive
    if drive is None or not drive.estimated:
        return
    yield Words(
        "No data sheet gives these figures; they are estimated from parts of the same kind that have them. One part "
        "in twenty lies below the band, one above. A check passes where it passes at both ends."
    )
    columns = (Column("figure", "name"), Column("estimate", "number"), Column("from", "number"), Column("to", "number"),
               Column("terms; peers", "small", 1.0))  # fmt: skip
    rows = [
        Row(
            (
                one.title,
                *(quantity(value, one.unit, one.kind) for value in (one.value, one.low, one.high)),
                one.law.removeprefix("; "),
            )
        )
        for one in drive.estimated
    ]
    yield Table("Estimated figures", columns, rows)
    hanging = [check for check in drive.own_checks if check.status == "open"]
    if hanging:
        heads = Column("check", "name"), Column("it passes with"), Column("estimated figures behind it", "small", 1.0)
        yield Table("Open checks", heads, [Row((c.title, about(c.probability), c.note)) for c in hanging])


ESTIMATES = Section(name="estimates", title="Estimated figures", level=2, blocks=_estimates)
