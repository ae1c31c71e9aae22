"""The parts list of a report: how many of what, its order number, and what it costs as of when."""

from __future__ import annotations

from math import isnan
from typing import Any

from drivesizer.catalog import Catalog
from drivesizer.results import DriveSet, made_by, section_of

__all__ = ["order_list"]


def order_list(drive_set: DriveSet, sets: int, catalog: Catalog) -> dict[str, Any]:
    """Rows of the list, the sum of what is known, and what it lacks.

    Parameters
    ----------
    drive_set
        The set; a part that no catalogue names is a row without a number.
    sets
        How many motor sets there are.
    catalog
        Where the parts are from: a price is of the date of its source.
    """
    rows, total, lacks = [], 0.0, []
    for role, part in drive_set.parts.items():
        price = float("nan") if part is None else part.price
        total += 0.0 if isnan(price) else sets * price
        lacks += [role] if isnan(price) else []
        rows.append({
            "count": f"{sets} ×", "role": role, "family": "unknown" if part is None else made_by(part),
            "part": "" if part is None else part.part, "each": _money(price), "all": _money(sets * price),
            "dated": "" if isnan(price) else _dated(part, catalog),
        })  # fmt: skip
    whole = float("nan") if len(lacks) == len(rows) else total
    return {"order": rows, "order_sum": _money(whole), "order_lacks": f"without {', '.join(lacks)}" if lacks else ""}


def _money(price: float) -> str:
    return "unknown" if isnan(price) else f"{price:.2f} EUR"


def _dated(part: Any, catalog: Catalog) -> str:
    """When a price was: the date of the note on it, else of the row's source."""
    section = section_of(part)
    table = catalog.table(section)
    if part.part not in table.rows:
        return ""
    own = [note.source for note in catalog.notes_on(section, part.part) if "price" in note.fields and note.source]
    return own[0] if own else catalog.sources[table.source[table.rows[part.part]]].date or "no date"
