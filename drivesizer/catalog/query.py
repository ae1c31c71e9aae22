"""Queries of catalogues: parts that meet conditions.

Catalogues are searched one by one and not joined, so that every part keeps the name of its catalogue. An unknown
figure neither meets a condition nor fails it; such parts are counted separately.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, PARTS, Catalog, Table, columns_of, load, path_of, shipped
from drivesizer.catalog.conditions import Condition, column_name
from drivesizer.catalog.tables import spelling
from drivesizer.errors import InputError, nearest, quoted

__all__ = ["Hit", "Selection", "Shelf", "contains", "every", "open_catalogs", "select"]

Shelf = Mapping[str, Catalog]  # catalogues by name


@dataclass(frozen=True, slots=True)
class Hit:
    """A part with its catalogue, section and row."""

    catalogue: str
    catalog: Catalog
    section: str
    row: int

    @property
    def table(self) -> Table[Any]:
        """The part's table."""
        return self.catalog.table(self.section)

    @property
    def part(self) -> str:
        """The part number."""
        return str(self["part"])

    def __getitem__(self, name: str) -> Any:
        """A figure in SI or a text, by its column."""
        return self.table[name][self.row].item()


class Selection(NamedTuple):
    """The parts that meet all conditions, and the number of those that may, some figures being unknown."""

    hits: list[Hit]
    undecided: int
    excluded: int  # meet all conditions, but the catalogue excludes them from sizing


def open_catalogs(names: Iterable[str] = ()) -> dict[str, Catalog]:
    """Catalogues by name, those that ship when none is given."""
    found: dict[str, Catalog] = {}
    files = {name if name == "all" else os.path.realpath(path_of(name)): name for name in names or shipped()}
    for given in files.values():
        catalog = load([given])
        name = ", ".join(catalog.digests)
        if name in found:
            raise InputError(f"two catalogues are called {quoted(name)}; rename one of the files")
        found[name] = catalog
    return found


def every(shelf: Shelf, sections: Iterable[str] = PARTS) -> Iterator[Hit]:
    """All parts of some sections, without direct drive."""
    for section in sections:
        for name, catalog in shelf.items():
            parts = catalog.table(section)["part"].tolist()
            yield from (Hit(name, catalog, section, row) for row, part in enumerate(parts) if part != DIRECT)


def select(
    shelf: Shelf,
    section: str,
    wanted: Sequence[Condition],
    *,
    sort: str = "",
    excluded: bool = False,
    piece: tuple[str, Sequence[str]] = ("", ()),
) -> Selection:
    """The parts of a section that meet all conditions, sorted by a column; unknown figures come last."""
    hits: list[Hit] = []
    undecided = left_out = 0
    for name, catalog in shelf.items():
        table = catalog.table(section)
        met = contains(table, *piece) & (table["part"] != DIRECT)
        possible = met.copy()
        for one in wanted:
            met &= one.met(table[one.column.name])
            possible &= one.met(table[one.column.name]) | one.unknown(table[one.column.name])
        offered = np.ones(len(table), bool) if excluded else ~table.excluded
        left_out += int((met & ~offered).sum())
        undecided += int((possible & ~met & offered).sum())
        hits += [Hit(name, catalog, section, int(row)) for row in np.flatnonzero(met & offered)]
    return Selection(_sorted(hits, section, sort), undecided, left_out)


def contains(table: Table[Any], text: str, names: Sequence[str]) -> NDArray[np.bool_]:
    """Rows of a table that have a text in one of some columns; case, blanks and hyphens do not matter."""
    piece = spelling(text) or text.strip()
    found = np.full(len(table), not piece)
    for name in (name for name in names if piece and name in table.columns):
        found |= np.array([piece in spelling(value) for value in table[name].tolist()], bool)
    return found


def _sorted(hits: list[Hit], section: str, name: str) -> list[Hit]:
    if not name:
        return hits
    column = columns_of(section).get(column_name(name.removeprefix("-")))
    if column is None:
        hint = nearest(name, columns_of(section))
        raise InputError(f"--sort: {section} have no column {quoted(name)}; expected e.g. mass{hint}")
    known = [hit for hit in hits if not _missing(hit[column.name])]
    unknown = [hit for hit in hits if _missing(hit[column.name])]
    return sorted(known, key=lambda hit: hit[column.name], reverse=name.startswith("-")) + unknown


def _missing(value: Any) -> bool:
    return value == "" if isinstance(value, str) else math.isnan(value)
