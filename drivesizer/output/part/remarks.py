"""Remarks on one part as lines: parts that it goes with, tolerances, notes, sources, and marks of a comparison."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drivesizer.catalog.compare import Row
from drivesizer.catalog.lookup import origins, partners, tolerances
from drivesizer.catalog.query import Hit
from drivesizer.catalog.view.search_view import CLAMPING_HUB
from drivesizer.output.counted import number_of

__all__ = [
    "DIFFERS",
    "EXCLUDED",
    "closing",
    "documents",
    "family_count",
    "head",
    "note_line",
    "partner_lines",
    "source_line",
    "sources_of",
    "tolerance_lines",
]  # fmt: skip

DIFFERS = {True: "≠", False: "", None: "?"}  # mark of a row of parts side by side
EXCLUDED = "excluded from sizing by a note"


def head(hit: Hit) -> str:
    """Maker and family of a part, with its reduction where it has one."""
    reduction = f" {hit['reduction']}" if hit.section in ("gearheads", "actuators") else ""
    return f"{hit['manufacturer']} {hit['family']}{reduction}".strip()


def family_count(count: int) -> str:
    """A number of families.

    >>> of_families(1), of_families(2)
    ('1 family', '2 families')
    """
    return number_of(count, "family", "families")


def partner_lines(hit: Hit) -> list[tuple[str, dict[str, int]]]:
    """Parts that go with a part: a line for each kind, and of each of its families how many."""
    found: list[tuple[str, dict[str, int]]] = []
    for section, counts in partners(hit).items():
        if counts:
            found.append((f"{section}: {sum(counts.values())} in {family_count(len(counts))}: ", counts))
        else:
            found.append((f"{section}: none is listed; one may still exist", {}))
    if hit.section == "gearheads" and hit["mounting"] == CLAMPING_HUB:
        found.append(("motors: of any maker, with a shaft that fits the clamping hub", {}))
    return found


def tolerance_lines(hit: Hit) -> list[str]:
    """The maker's tolerances, a line for each document."""
    stated: dict[tuple[int, str], list[str]] = {}
    for one in tolerances(hit):
        figure = f"losses of the {one.part}" if one.figure == "efficiency" else one.figure.replace("_", " ")
        stated.setdefault((one.source, one.text), []).append(f"{figure} {one.tolerance}")
    lines = []
    for (number, text), figures in stated.items():
        source = hit.catalog.sources[number]
        said = f"{', '.join(figures)}{f'; {text}' if text else ''}"
        lines.append(f"{said} ({source.document}; {source.confidence})")
    return lines


def note_line(note: dict[str, Any]) -> str:
    """A note of a data sheet, with the figures that it is on."""
    words = "; ".join(text for text in (note["text"], note["confidence"]) if text)
    return f"{note['where']}: {words}" if note["where"] else words


def source_line(sheet: dict[str, Any]) -> str:
    """Source of a data sheet, with its confidence."""
    return f"{sheet['source']} ({sheet['confidence']})"


def documents(hit: Hit) -> list[str]:
    """The documents behind a part's figures, each once."""
    return list(dict.fromkeys(source.document for source in origins(hit).values()))


def sources_of(hit: Hit) -> list[str]:
    """The documents behind a part's figures with date and address, in the order of :func:`documents`."""
    known = {source.document: source for source in origins(hit).values()}
    each = ((document, known[document].date, known[document].url) for document in documents(hit))
    return [", ".join(part for part in parts if part) for parts in each]


def closing(rows: Sequence[Row]) -> str:
    """Meaning of the marks of parts side by side, with the number of rows that differ."""
    differing = sum(row.differs is True for row in rows)
    return f"≠ differs ({differing} of {len(rows)} rows), ? undecided: a figure is unknown"
