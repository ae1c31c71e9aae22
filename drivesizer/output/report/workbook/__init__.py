"""XLSX: the report as a workbook, sheets of every section.

May import: ``sections``.
"""

from __future__ import annotations

from pathlib import Path

from drivesizer.output.report.sections import SECTIONS
from drivesizer.output.report.sections.appendix import about
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import sheets_of
from drivesizer.output.report.sections.sheet import Sheet
from drivesizer.output.report.workbook.writer import written

__all__ = ["render", "sheets"]


def render(content: Content, path: Path) -> dict[Path, bytes]:
    """The file of an XLSX report."""
    return {path: written(sheets(content))}


def sheets(content: Content) -> list[Sheet]:
    """The sheets of a report in their order, as plain data."""
    found = [sheet for section in SECTIONS for sheet in sheets_of(section, content)]
    return [*found, about(content, found)]
