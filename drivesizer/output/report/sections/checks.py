"""The checks of the reported drive by part, and by physics where the method of the paper ranked."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.drive import check_row
from drivesizer.output.report.sections.blocks import Block, Checks, Column, Row, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.sheets import LIMITS, RANK, ranked
from drivesizer.output.report.sections.texts import Status
from drivesizer.results.check_parts import part_of, sorted_by_part
from drivesizer.results.drive_set import Comparison, DriveSet

__all__ = ["CHECKS", "DRIVE", "PHYSICS"]


_TITLES = {"found": "The selected drive", "unsure": "The most probable drive", "missed": "The closest rejected drive"}


def _intro(content: Content) -> Iterator[Block]:
    if content.drive:
        yield Words((f"{content.drive.label}: ", Status(content.drive.status)))


DRIVE = Section(name="drive", title=lambda content: _TITLES[content.outcome], blocks=_intro, tabled=False)


def _blocks(content: Content) -> Iterator[Block]:
    best = content.drive
    if best is None:
        return
    worst = "; each in its worst load case, the one as specified where none is named" if content.cases else ""
    worst = "; each at its worst wheel" if content.wheel else worst
    yield Checks(
        f"All checks of {best.label}{worst}. The bar is the used share of the limit, the long tick 100 %, a "
        "short one where the margin begins that the spec requires",
        [*map(check_row, sorted_by_part(best.checks))],
        "checks",
        grouped=True,
    )


def _physics(content: Content) -> Iterator[Block]:
    """The drive by physics, where the method of the paper ranked; the other way round it is left out."""
    best = content.drive
    if best is None or content.result.method != "paper" or not best.beside:
        return
    yield Words("The drive was ranked by the method of the paper, and its verdict is that method's. Here the same "
                "drive by physics: the whole load cycle, no factors of the paper.")  # fmt: skip
    yield Checks("Checks by physics", [*map(check_row, sorted_by_part(best.beside))], "beside", grouped=True)
    columns = (Column("demand", "name"), Column("paper", "number"), Column("", "status"),
               Column("physics", "number"), Column("", "status"),
               Column("why they differ", "small", 1.0))  # fmt: skip
    yield Table("Both methods where they check the same limit", columns, [_compared(one) for one in best.comparison])


PHYSICS = Section(name="physics", title="The same drive by physics", blocks=_physics, appendix=True, tabled=False)


def _compared(pair: Comparison) -> Row:
    """A limit by both methods."""
    cells = [(c.shown(c.demand), (Status(c.status),)) for c in (pair.paper, pair.physics)]
    return Row((pair.paper.title, *cells[0], *cells[1], pair.why))


def _sheet(content: Content) -> list[Sheet]:
    """Every check of every drive, by both methods."""
    columns = (RANK, SheetColumn("part", "part"), SheetColumn("check", "title"), SheetColumn("method", "method"),
               SheetColumn("load case", "case"), *LIMITS)  # fmt: skip
    rows = ranked(content, _rows)
    return [Sheet(name="Checks", columns=columns, rows=list(rows), still=3)]


def _rows(drive: DriveSet) -> Iterator[table.Row]:
    yield from (table.check_row("check", c) | {"part": part_of(c.name)} for c in drive.every_check)


def _drive_rows(_: Content, __: str, drive: DriveSet) -> Iterator[table.Row]:
    yield from map(table.requirement_row, drive.requirements)
    yield from (table.figure_row("figure", f) for f in drive.figures)
    yield from (table.check_row("check", c) for c in drive.every_check)


CHECKS = Section(
    name="checks", title="Checks", level=2, blocks=_blocks, sheets=_sheet, csv=CsvRows(of_drive=_drive_rows)
)
