"""Closed loops of all axes: side by side in a chapter, and in tables as those of a single axis with its name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from drivesizer.output.report.lines.drive import check_row
from drivesizer.output.report.lines.machine import driven_over
from drivesizer.output.report.lines.rows import COLUMNS, Row, closed_loop_rows
from drivesizer.output.report.machine.content import AxisContent, MachineContent
from drivesizer.output.report.sections.blocks import Block, Column, Table, Words
from drivesizer.output.report.sections.blocks import Row as Cells
from drivesizer.output.report.sections.loop import LOOP_COLUMNS, time_series
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.summary import check_line
from drivesizer.output.report.sections.texts import Status
from drivesizer.output.report.table.csv import encoded, timeseries_csv
from drivesizer.results.check import worst

__all__ = ["loop_blocks", "loop_files", "loop_sheet", "loop_summary", "time_series_sheets"]


def loop_blocks(content: MachineContent) -> Iterator[Block]:
    """A row for each axis with a drive: what it was simulated over, and its tightest check."""
    if not content.proofs:
        return
    columns = (Column("axis", "name", 0.7), Column("simulated in", width=1.0), Column("tightest check", "small", 1.0),
               Column("demand", "number"), Column("limit", "number"), Column("margin", "number"),
               Column("", "status"))  # fmt: skip
    rows = [Cells(_cells(one), {"axis": one.name}) for one in content.axes if one.sizing.best]
    caption = "Every axis simulated in its hardest load case, with the drives that ride on it"
    yield Table(caption, columns, rows, "axes_loops", "wide")
    yield Words("Figures, gains and the loop over time are in the chapter of each axis.", "note")


def _cells(one: AxisContent) -> tuple[object, ...]:
    v = one.content.validation
    if v is None:
        return one.name, "not simulated, see its warnings", "", "", "", "", (Status("unknown"),)
    tight = worst(v.checks)
    row = check_row(tight) if tight else {"title": "", "demand": "", "limit": "", "margin": ""}
    shown = (row[name] for name in ("title", "demand", "limit", "margin"))
    return one.name, f"{v.loop}, {driven_over(v)}", *shown, (Status(v.status),)


# -- the workbook


def loop_summary(content: MachineContent) -> Iterator[Row]:
    """Rows of the first sheet: each axis by the tightest check of its closed loop."""
    if content.proofs:
        yield {"part": "Closed loop of each axis, by its tightest check"}
    for name, v in content.proofs.items():
        tight = worst(v.checks)
        found = check_line(tight) if tight else {}
        title = f"{tight.title}; " if tight else ""
        yield found | {"title": name, "status": v.status, "note": f"{title}{v.loop} over {driven_over(v)}"}


def loop_sheet(content: MachineContent) -> Iterator[Sheet]:
    """One sheet of all closed loops: checks, figures, gains and linear loops; none where nothing was simulated."""
    if content.proofs:
        columns = (SheetColumn("axis", "axis"), *LOOP_COLUMNS)
        yield Sheet(name="Closed loops", columns=columns, rows=[*_rows(content)], still=3)


def _rows(content: MachineContent) -> Iterator[Row]:
    for name, v in content.proofs.items():
        yield from (row | {"axis": name} for row in closed_loop_rows(v))


def time_series_sheets(content: MachineContent, names: dict[str, str]) -> Iterator[Sheet]:
    """A sheet of time series for each axis, all together as long as that of a single axis."""
    for name, v in content.proofs.items():
        yield time_series(v, names[name], len(content.proofs))


# -- CSV


def loop_files(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """Files beside the table of axes: one of all closed loops, and for each axis one of its time series."""
    if not content.proofs:
        return {}
    rows = ([row["axis"], *(row.get(column, "") for column in COLUMNS)] for row in _rows(content))
    files = {path.with_name(f"{path.stem}-loops{path.suffix}"): encoded(["axis", *COLUMNS], rows)}
    for one in content.axes:
        if one.content.validation:
            series = timeseries_csv(one.content.validation)
            files[path.with_name(f"{path.stem}-{one.key}timeseries{path.suffix}")] = series
    return files
