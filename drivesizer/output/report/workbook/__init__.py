"""XLSX: the report as a workbook, a sheet for each subject."""

from __future__ import annotations

from pathlib import Path

from drivesizer.control.validation import Validation
from drivesizer.output.parts import parts_list
from drivesizer.output.report.workbook import tables as tables
from drivesizer.output.report.workbook import words as words
from drivesizer.output.report.workbook.reliability import of_tolerances
from drivesizer.output.report.workbook.sheet import Sheet
from drivesizer.output.report.workbook.writer import written
from drivesizer.results.sizing import SizingResult

__all__ = ["MOST_SAMPLES", "render", "sheets"]

MOST_SAMPLES = 50_000  # of the time series: what a spreadsheet opens at once; the CSV report has all


def render(result: SizingResult, validation: Validation | None, path: Path) -> dict[Path, bytes]:
    """The file of an XLSX report."""
    return {path: written(sheets(result, validation))}


def sheets(result: SizingResult, validation: Validation | None) -> list[Sheet]:
    """The sheets of a report in their order, as plain data.

    Parameters
    ----------
    result
        What the sizing found; without a set, the parts list is empty, and the surest set or the nearest miss is told.
    validation
        The closed loop, where it was simulated.
    """
    bought = parts_list(result.sets[0], result.catalog, result.spec.load.motors) if result.sets else []
    found = [
        words.summary(result, validation, bought), tables.requirements(result), tables.candidates(result),
        tables.checks(result), *of_tolerances(result), words.chosen_set(result), tables.machine(result),
        tables.battery(result),
        tables.parts(bought), tables.closed_loop(validation), tables.time_series(validation, MOST_SAMPLES),
        words.spec(result),
    ]  # fmt: skip
    return [*found, words.about(result, [f"{sheet.name}: {sheet.note}" for sheet in found if sheet.note])]
