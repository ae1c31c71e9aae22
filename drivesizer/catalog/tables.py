"""A catalogue in memory: parts as columns for the search, as records for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import DIRECT, PARTS, Controller, Encoder, Gearhead, Motor, columns_of
from drivesizer.errors import CatalogError, quoted

__all__ = ["Catalog", "Note", "Pairs", "Source", "Table"]

Part = TypeVar("Part", Motor, Gearhead, Encoder, Controller)


class Source(NamedTuple):
    """Where figures come from."""

    document: str
    confidence: str  # quoted, secondary, derived or recalled
    date: str = ""
    url: str = ""


class Note(NamedTuple):
    """A remark on some parts' figures: another confidence, another source, an exclusion, an accepted oddity."""

    section: str
    parts: tuple[str, ...]
    fields: tuple[str, ...]  # empty: the whole row
    text: str
    confidence: str = ""
    source: str = ""  # the document
    exclude: bool = False
    accepted: bool = False


class Pairs(NamedTuple):
    """Which rows of two tables go together, and which source says so."""

    left: NDArray[np.int32]
    right: NDArray[np.int32]
    source: NDArray[np.int32]  # index into Catalog.sources


@dataclass(frozen=True)
class Table(Generic[Part]):
    """All parts of one kind: one array per field, NaN or an empty text where the figure is unknown."""

    section: str
    columns: Mapping[str, NDArray[Any]]
    source: NDArray[np.int32]  # per row, index into Catalog.sources
    excluded: NDArray[np.bool_]  # per row: in the file with its reason, but not offered

    def __len__(self) -> int:
        return len(self.source)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    def record(self, row: int) -> Part:
        """One part, as its record."""
        kind = PARTS[self.section]
        return kind(**{f.name: self.columns[f.name][row].item() for f in fields(kind)})  # type: ignore[return-value]

    @cached_property
    def rows(self) -> dict[str, int]:
        """Row by part number."""
        return {str(part): row for row, part in enumerate(self.columns["part"])}


@dataclass(frozen=True)
class Catalog:
    """Everything that was loaded: parts, which go together, and where each figure comes from."""

    motors: Table[Motor]
    gearheads: Table[Gearhead]
    encoders: Table[Encoder]
    controllers: Table[Controller]
    motor_gearhead: Pairs
    motor_encoder: Pairs
    sources: tuple[Source, ...]
    notes: tuple[Note, ...]
    digests: Mapping[str, str]  # catalogue name -> digest of its file, so that a result can be traced
    overrides: bool = False  # its parts count before those of the catalogues named before it
    replaced: tuple[str, ...] = ()  # parts that an overriding catalogue gives in place of another, in words

    def table(self, section: str) -> Table[Any]:
        """The table of a section, such as ``motors``."""
        found: Table[Any] = getattr(self, section)
        return found

    def notes_on(self, section: str, part: str) -> list[Note]:
        """What the catalogue remarks on a part."""
        return [note for note in self.notes if note.section == section and part in note.parts]

    def confidence(self, section: str, row: int) -> dict[str, str]:
        """How sure each known figure of a part is: its row's confidence, changed by the notes on it."""
        table = self.table(section)
        base = self.sources[table.source[row]].confidence
        known = {name for name, column in columns_of(section).items() if _is_known(table[name][row], column.kind)}
        found = dict.fromkeys((n for n in columns_of(section) if n in known), base)
        for note in self.notes_on(section, str(table["part"][row])):
            if note.confidence:
                found |= {name: note.confidence for name in (note.fields or known) if name in known}
        return found


def _is_known(value: Any, kind: str) -> bool:
    return bool(value != "") if kind == "text" else bool(value == value)


def joined(catalogs: Sequence[Catalog]) -> Catalog:
    """Several catalogues as one.

    Raises
    ------
    CatalogError
        When a part is in two of them and the later one does not say that it overrides.
    """
    if len(catalogs) == 1:
        return catalogs[0]
    replaced = _replaced(catalogs)
    first_source = np.cumsum([0, *(len(c.sources) for c in catalogs)])[:-1]
    tables = {name: _joined_tables([c.table(name) for c in catalogs], first_source) for name in PARTS}
    places = {name: _places(table) for name, table in tables.items()}
    pairs = {}
    for right in ("gearheads", "encoders"):
        listed = _joined_pairs(catalogs, f"motor_{right[:-1]}", right, first_source)
        pairs[right] = _moved(listed, places["motors"], places[right])
    left: dict[str, Any] = {name: _kept(table, places[name]) for name, table in tables.items()}
    return Catalog(
        **left,
        motor_gearhead=pairs["gearheads"],
        motor_encoder=pairs["encoders"],
        sources=tuple(source for c in catalogs for source in c.sources),
        notes=tuple(note for c in catalogs for note in c.notes),
        digests={name: digest for c in catalogs for name, digest in c.digests.items()},
        replaced=replaced,
    )


def _replaced(catalogs: Sequence[Catalog]) -> tuple[str, ...]:
    """What is in two catalogues; refused where the later one does not mean to replace it."""
    owner: dict[tuple[str, str], str] = {}
    said = []
    for catalog in catalogs:
        name = ", ".join(catalog.digests)
        for section in PARTS:
            for part in catalog.table(section).rows:
                first = owner.setdefault((section, part), name)
                if first == name or part == DIRECT:
                    continue
                if not catalog.overrides:
                    raise CatalogError(
                        f"part {quoted(part)} is in two catalogues: {first} and {name}; "
                        "`overrides: true` in the second makes its row count"
                    )
                said.append(f"{section[:-1]} {part}: {name} in place of {first}")
    return tuple(said)


def _places(table: Table[Any]) -> NDArray[np.int32]:
    """Where each row goes when of rows with the same part number the last is left."""
    _, last = np.unique(table["part"][::-1], return_index=True)
    keep = np.zeros(len(table), bool)
    keep[len(table) - 1 - last] = True
    if keep.all():
        return np.arange(len(table), dtype=np.int32)
    place = np.cumsum(keep, dtype=np.int32) - 1
    of_part = {str(table["part"][row]): place[row] for row in np.flatnonzero(keep)}
    again = np.flatnonzero(~keep)
    place[again] = [of_part[str(table["part"][row])] for row in again]
    return place


def _kept(table: Table[Any], place: NDArray[np.int32]) -> Table[Any]:
    """The rows that are left: of those that go to one place, the last."""
    if not len(place) or place[-1] == len(place) - 1:
        return table
    rows = np.empty(place.max() + 1, np.int64)
    rows[place] = np.arange(len(place))  # the last assignment stands
    columns = {name: column[rows] for name, column in table.columns.items()}
    return Table(table.section, columns, table.source[rows], table.excluded[rows])


def _moved(pairs: Pairs, left: NDArray[np.int32], right: NDArray[np.int32]) -> Pairs:
    """Pairs by the rows that are left, each once with the first source that states it."""
    moved = left[pairs.left], right[pairs.right]
    _, first = np.unique(moved[0].astype(np.int64) << 32 | moved[1].astype(np.int64), return_index=True)
    return Pairs(moved[0][first], moved[1][first], pairs.source[first])


def _joined_tables(tables: Sequence[Table[Any]], first_source: NDArray[Any]) -> Table[Any]:
    columns = {name: np.concatenate([t[name] for t in tables]) for name in tables[0].columns}
    source = np.concatenate([t.source + first for t, first in zip(tables, first_source, strict=True)])
    return Table(tables[0].section, columns, source, np.concatenate([t.excluded for t in tables]))


def _joined_pairs(catalogs: Sequence[Catalog], name: str, right: str, first_source: NDArray[Any]) -> Pairs:
    motors = np.cumsum([0, *(len(c.motors) for c in catalogs)])
    others = np.cumsum([0, *(len(c.table(right)) for c in catalogs)])
    pairs: list[Pairs] = [getattr(c, name) for c in catalogs]
    return Pairs(
        np.concatenate([p.left + motors[k] for k, p in enumerate(pairs)]),
        np.concatenate([p.right + others[k] for k, p in enumerate(pairs)]),
        np.concatenate([p.source + first_source[k] for k, p in enumerate(pairs)]),
    )
