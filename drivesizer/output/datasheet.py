"""Parts as the report prints them: every known figure, how sure it is, and where it comes from."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog import Catalog, Note, columns_of, one_of
from drivesizer.results.drive_set import DriveSet, section_of
from drivesizer.units import show

__all__ = ["datasheet", "datasheets"]

_NAMES = {"part", "family", "manufacturer"}  # in the heading already


def datasheets(drive_set: DriveSet, catalog: Catalog) -> list[dict[str, Any]]:
    """The known figures of each part of a set, those that are not quoted from a maker's document marked."""
    parts = {(section_of(part), part.part): part for part in drive_set.parts.values() if part is not None}  # each once
    return [datasheet(section, part, catalog) for (section, _), part in parts.items()]


def datasheet(section: str, part: Any, catalog: Catalog) -> dict[str, Any]:
    """The known figures of one part, as its section's record."""
    table = catalog.table(section)
    row = table.rows[part.part]
    source = catalog.sources[table.source[row]]
    sure = catalog.confidence(section, row)
    return {
        "role": one_of(section),
        "part": part.part,
        "family": part.family,
        "maker": part.manufacturer,
        "rows": [
            _row(part, name, section, sure) for name in columns_of(section) if name in sure and name not in _NAMES
        ],
        "source": ", ".join(text for text in (source.document, source.date) if text),
        "confidence": source.confidence,
        "url": source.url,
        "notes": [_note(note) for note in catalog.notes_on(section, part.part)],
    }


def _row(part: Any, name: str, section: str, sure: dict[str, str]) -> dict[str, str]:
    column, value = columns_of(section)[name], getattr(part, name)
    if column.kind.startswith("price") and value == value:
        text = f"{value:.2f} {column.unit}"  # to the cent, as money is
    else:
        text = value if column.kind == "text" else show(value, column.unit, column.kind, 6)
    mark = "" if sure[name] == "quoted" else sure[name]
    return {"name": name.replace("_", " "), "text": text, "mark": mark}


def _note(note: Note) -> dict[str, str]:
    where = ", ".join(name.replace("_", " ") for name in note.fields)
    return {"where": where, "text": note.text, "confidence": note.confidence, "source": note.source}
