"""XLSX: the report as a workbook, sheets of every section.

May import: ``sections``.
"""

from __future__ import annotations

from pathlib import Path

from drivesizer.control.validation import Validation
from drivesizer.output.report.sections import SECTIONS
from drivesizer.output.report.sections.appendix import about
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import sheets_of
from drivesizer.output.report.sections.sheet import Sheet
from drivesizer.output.report.workbook.writer import written
from drivesizer.results.sizing import SizingResult

__all__ = ["render", "sheets"]


def render(result: SizingResult, validation: Validation | None, path: Path) -> dict[Path, bytes]:
    """The file of an XLSX report.

    Parameters
    ----------
    result, validation
        The sizing, and the closed loop where it was simulated.
    path
        Where to.

    Returns
    -------
    dict[Path, bytes]
    """
    return {path: written(sheets(result, validation))}


def sheets(result: SizingResult, validation: Validation | None) -> list[Sheet]:
    """The sheets of a report in their order, as plain data.

    Parameters
    ----------
    result
        The sizing; without a drive that passes the parts list is empty, and the closest rejected drive is reported.
    validation
        The closed loop, where it was simulated.

    Returns
    -------
    list[Sheet]
    """
    content = Content(result, validation)
    found = [sheet for section in SECTIONS for sheet in sheets_of(section, content)]
    return [*found, about(content, found)]
