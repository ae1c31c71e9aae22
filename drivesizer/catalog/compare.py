"""Parts side by side: every figure that one of them has, and whether they differ in it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from drivesizer.catalog import columns_of
from drivesizer.catalog.columns import Column
from drivesizer.catalog.query import Hit
from drivesizer.errors import InputError

__all__ = ["Row", "side_by_side"]


class Row(NamedTuple):
    """A column of the catalogue with the value of each part; NaN or an empty text where it is unknown."""

    column: Column
    values: tuple[Any, ...]
    differs: bool | None  # None: those that are known are the same, and some are not known


def side_by_side(hits: Sequence[Hit]) -> list[Row]:
    """The columns in which at least one part has something."""
    sections = list(dict.fromkeys(hit.section for hit in hits))
    if len(sections) > 1:
        kinds = ", ".join(f"{hit.part} of {hit.section}" for hit in hits)
        raise InputError(f"parts of one kind can be compared; found {kinds}")
    rows = (_row(column, tuple(hit[name] for hit in hits)) for name, column in columns_of(sections[0]).items())
    return [row for row in rows if row is not None and row.column.name != "part"]


def _row(column: Column, values: tuple[Any, ...]) -> Row | None:
    known = [value for value in values if _known(value)]
    if not known:
        return None
    differs = any(not _same_text(value, known[0]) for value in known)
    return Row(column, values, True if differs else None if len(known) < len(values) else False)


def _known(value: Any) -> bool:
    return value != "" if isinstance(value, str) else not math.isnan(value)


def _same_text(one: Any, other: Any) -> bool:
    return one == other if isinstance(one, str) else math.isclose(one, other, rel_tol=1e-9)
