"""Figures of a drive's parts that are not out of the makers' own documents."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.columns import DATA
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.results.drive_set import DriveSet, section_of

__all__ = ["LESS", "confidences", "not_quoted"]


def confidences(part: Any, role: str, found: DriveSet, catalog: Catalog) -> dict[str, str]:
    """Confidence of each known figure of a part; of estimated ones those that the drive's checks rest on."""
    section = section_of(part)
    row = catalog.table(section).rows.get(part.part)
    if row is None:  # a brake that the spec describes
        return {}
    known = catalog.confidence(section, row)
    estimated = {one.figure for one in found.estimated if one.part == role}
    return {
        name: known[name]
        for name, column in columns_of(section).items()
        if name in known
        and column.kind != "text"
        and name != DATA  # a condition of the others
        and (known[name] != ESTIMATED or name in estimated)
    }


def not_quoted(part: Any, role: str, found: DriveSet, catalog: Catalog) -> dict[str, str]:
    """Figures of less confidence than quoted, those of the highest confidence first."""
    figures = confidences(part, role, found, catalog)
    return {name: level for one in LESS for name, level in figures.items() if level == one}


LESS = ("secondary", "derived", "recalled", ESTIMATED)
"""Levels of confidence below quoted, the highest first."""
