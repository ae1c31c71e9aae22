"""Figures that no data sheet gives: their bands, and the checks that hang on them."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.probability import about
from drivesizer.output.report.sections.blocks import Block, Column, Row, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.texts import quantity

__all__ = ["ESTIMATES"]


def _blocks(content: Content) -> Iterator[Block]:
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


ESTIMATES = Section(name="estimates", title="Estimated figures", level=2, blocks=_blocks)
