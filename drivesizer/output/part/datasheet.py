"""Parts as data sheets: every known figure, its confidence and its source."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog import Catalog, Note, columns_of, singular
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.output.part.figures import figure
from drivesizer.results.drive_set import DriveSet, section_of

__all__ = ["datasheet", "datasheets"]

_NAMES = {"part", "family", "manufacturer"}  # in the heading already


def datasheets(drive_set: DriveSet, catalog: Catalog) -> list[dict[str, Any]]:
    """The known figures of each part of a drive, marked where not quoted from the maker."""
    parts = {(section_of(part), part.part): part for part in drive_set.parts.values() if part is not None}  # each once
    return [datasheet(section, part, catalog) for (section, _), part in parts.items()]


def datasheet(section: str, part: Any, catalog: Catalog) -> dict[str, Any]:
    """The known figures of one part."""
    table = catalog.table(section)
    row = table.rows[part.part]
    source = catalog.sources[table.source[row]]
    confidence = catalog.confidence(section, row)
    names = [name for name in columns_of(section) if name in confidence and name not in _NAMES]
    return {
        "role": singular(section),
        "part": part.part,
        "family": part.family,
        "maker": part.manufacturer,
        "rows": [_row(part, name, section, confidence) for name in names],
        "source": ", ".join(text for text in (source.document, source.date) if text),
        "confidence": source.confidence,
        "url": source.url,
        "notes": [_note(note) for note in catalog.notes_on(section, part.part)],
    }


def _row(part: Any, name: str, section: str, confidence: dict[str, str]) -> dict[str, str]:
    digits = 3 if confidence[name] == ESTIMATED else 6  # its band is wide
    text = figure(getattr(part, name), columns_of(section)[name], digits=digits)
    mark = "" if confidence[name] == "quoted" else confidence[name]
    return {"name": name.replace("_", " "), "text": text, "mark": mark}


def _note(note: Note) -> dict[str, str]:
    where = ", ".join(name.replace("_", " ") for name in note.fields)
    return {"where": where, "text": note.text, "confidence": note.confidence, "source": note.source}
