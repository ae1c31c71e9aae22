"""Coverage of catalogues: parts, pairs, number of known figures of each column, and their confidence."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, Catalog
from drivesizer.catalog.parts import printed
from drivesizer.catalog.tables import CONFIDENCE

__all__ = ["Coverage", "coverage", "pairs_of"]


class Coverage(NamedTuple):
    """Coverage of one kind of part in a catalogue."""

    parts: int
    families: int
    excluded: int
    known: dict[str, int]  # parts of which the figure is known, by column
    sure: dict[str, int]  # known figures (texts are not counted) by confidence


def coverage(catalog: Catalog, section: str) -> Coverage:
    """Coverage of a section of a catalogue."""
    table = catalog.table(section)
    real = table["part"] != DIRECT
    known = {name: (table[name] != "" if c.kind == "text" else ~np.isnan(table[name])) & real
             for name, c in printed(section).items()}  # fmt: skip
    figures = [name for name, column in printed(section).items() if column.kind != "text"]
    there = np.array([known[name] for name in figures])
    level = _levels(catalog, section, figures)
    return Coverage(
        parts=int(real.sum()),
        families=len(np.unique(table["family"][real])),
        excluded=int((table.excluded & real).sum()),
        known={name: int(mask.sum()) for name, mask in known.items()},
        sure={name: int((there & (level == place)).sum()) for place, name in enumerate(CONFIDENCE)},
    )


def _levels(catalog: Catalog, section: str, figures: list[str]) -> NDArray[Any]:
    """The confidence of each figure as its place in CONFIDENCE: as Catalog.confidence, for all rows at once."""
    table = catalog.table(section)
    of_source = np.array([CONFIDENCE.index(source.confidence) for source in catalog.sources])
    level = np.tile(of_source[table.source], (len(figures), 1))
    for note in catalog.notes:
        if note.section == section and note.confidence:
            rows = [table.rows[part] for part in note.parts if part in table.rows]
            columns = [place for place, name in enumerate(figures) if not note.fields or name in note.fields]
            level[np.ix_(columns, rows)] = CONFIDENCE.index(note.confidence)
    return level


def pairs_of(catalog: Catalog) -> dict[str, int]:
    """Number of pairs that a catalogue states."""
    direct = catalog.gearheads["part"][catalog.motor_gearhead.right] == DIRECT
    return {
        "motor and gearhead": int((~direct).sum()),
        "motor without gearhead": int(direct.sum()),
        "motor and encoder": len(catalog.motor_encoder.left),
    }
