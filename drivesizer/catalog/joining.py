"""Several catalogues as one: rows concatenated, pairs renumbered, overridden parts left out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.maker_tolerances import join_maker_tolerances
from drivesizer.catalog.parts import DIRECT, PARTS, RELATIONS, singular
from drivesizer.catalog.tables import Across, Catalog, Pairs, Table, unique_pairs
from drivesizer.errors import CatalogError, nearest, quoted

__all__ = ["joined"]


def joined(catalogs: Sequence[Catalog]) -> Catalog:
    """Several catalogues as one."""
    if len(catalogs) == 1 and not catalogs[0].across:
        return catalogs[0]
    replaced = (*_replaced(catalogs), *_not_loaded(catalogs))
    first_source = np.cumsum([0, *(len(c.sources) for c in catalogs)])[:-1]
    tables = {name: _joined_tables([c.table(name) for c in catalogs], first_source) for name in PARTS}
    places = {name: _places(table) for name, table in tables.items()}
    pairs: dict[str, Any] = {}
    for relation, right in RELATIONS.items():
        listed = _joined_pairs(catalogs, relation, first_source)
        pairs[relation] = _moved(listed, places["motors"], places[right])
    tolerances, instead = join_maker_tolerances([(", ".join(c.digests), c.tolerances, c.overrides) for c in catalogs],
                                  first_source.tolist())  # fmt: skip
    left: dict[str, Any] = {name: _last_rows(table, places[name]) for name, table in tables.items()}
    return Catalog(
        **left,
        **pairs,
        discharges=_printed(catalogs, "discharges", "batteries", places, first_source),
        pull_outs=_printed(catalogs, "pull_outs", "steppers", places, first_source),
        sources=tuple(source for c in catalogs for source in c.sources),
        notes=tuple(note for c in catalogs for note in c.notes),
        digests={name: digest for c in catalogs for name, digest in c.digests.items()},
        replaced=(*replaced, *instead),
        tolerances=tolerances,
    )


def _replaced(catalogs: Sequence[Catalog]) -> tuple[str, ...]:
    """Parts that are in two catalogues; refused where the later one does not mean to replace them."""
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
                said.append(f"{singular(section)} {part}: {name} in place of {first}")
    return tuple(said)


def _not_loaded(catalogs: Sequence[Catalog]) -> tuple[str, ...]:
    """Catalogues that others name for parts that go together, and that are not among them."""
    loaded = {name for c in catalogs for name in c.digests}
    said: dict[str, None] = {}
    for catalog in catalogs:
        for given in catalog.across:
            for other, part in (*given.motors, *given.others):
                if other and other not in loaded:
                    own = ", ".join(catalog.digests)
                    said[f"{own} lists {part} of {other}, which is not among the catalogues: left out"] = None
    return tuple(said)


def _places(table: Table[Any]) -> NDArray[np.int32]:
    """New place of each row when of rows with the same part number the last is left."""
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


def _last_rows(table: Table[Any], place: NDArray[np.int32]) -> Table[Any]:
    """The rows that are left: of those that go to one place, the last."""
    if not len(place) or place[-1] == len(place) - 1:
        return table
    rows = np.empty(place.max() + 1, np.int64)
    rows[place] = np.arange(len(place))  # the last assignment counts
    return table.taken(rows)


def _moved(pairs: Pairs, left: NDArray[np.int32], right: NDArray[np.int32]) -> Pairs:
    """Pairs by the rows that are left, each once with the first source that states it."""
    moved = left[pairs.left], right[pairs.right]
    return unique_pairs(*moved, pairs.source)


def _joined_tables(tables: Sequence[Table[Any]], first_source: NDArray[Any]) -> Table[Any]:
    columns = {name: np.concatenate([t[name] for t in tables]) for name in tables[0].columns}
    source = np.concatenate([t.source + first for t, first in zip(tables, first_source, strict=True)])
    return Table(tables[0].section, columns, source, np.concatenate([t.excluded for t in tables]))


def _printed(
    catalogs: Sequence[Catalog],
    name: str,
    section: str,
    places: Mapping[str, NDArray[np.int32]],
    first_source: NDArray[Any],
) -> Any:
    """Printed entries of a section's parts, each with its row first; of a replaced part only those of the last file."""
    place, number = places[section], 0
    last = np.zeros(int(place.max(initial=-1)) + 1, np.int64)
    last[place] = np.arange(len(place))  # the last assignment counts
    found = []
    for own, start, first in zip(
        (getattr(c, name) for c in catalogs), _starts(catalogs, section), first_source, strict=False
    ):
        rows = own[0] + start
        moved = own._replace(**{own._fields[0]: place[rows], "source": (own.source + first).astype(np.int32)})
        if "curve" in own._fields:  # numbered through all files
            moved = moved._replace(curve=own.curve + number)
            number += int(own.curve.max(initial=-1)) + 1
        found.append(moved.on(last[place[rows]] == rows))
    return type(found[0])(*(np.concatenate(columns) for columns in zip(*found, strict=True)))


def _joined_pairs(catalogs: Sequence[Catalog], relation: str, first_source: NDArray[Any]) -> Pairs:
    """All pairs of a relation, by the rows of the tables under each other."""
    starts = {section: _starts(catalogs, section) for section in ("motors", RELATIONS[relation])}
    none: NDArray[Any] = np.zeros(0, np.int32)
    left, right, source = [none], [none], [none]
    for place, catalog in enumerate(catalogs):
        own: Pairs = getattr(catalog, relation)
        groups: list[tuple[NDArray[Any], ...]] = [
            (own.left + starts["motors"][place], own.right + starts[RELATIONS[relation]][place], own.source)
        ]
        groups += [_across(catalogs, place, given, starts) for given in catalog.across if given.relation == relation]
        for motors, others, whence in groups:
            left.append(motors)
            right.append(others)
            source.append(whence + first_source[place])
    return Pairs(*(np.concatenate(side) for side in (left, right, source)))


def _starts(catalogs: Sequence[Catalog], section: str) -> list[int]:
    """The first row of each catalogue in a section's table of all."""
    counts = np.cumsum([0, *(len(c.table(section)) for c in catalogs)])
    return [int(count) for count in counts]


def _across(
    catalogs: Sequence[Catalog], own: int, given: Across, starts: Mapping[str, list[int]]
) -> tuple[NDArray[Any], ...]:
    """Pairs that a catalogue lists with parts of others, where those are loaded too."""
    motors, others = (
        np.concatenate([np.zeros(0, np.int64), *_named(catalogs, own, section, names, starts[section])])
        for section, names in (("motors", given.motors), (RELATIONS[given.relation], given.others))
    )
    left, right = np.repeat(motors, len(others)), np.tile(others, len(motors))
    return left, right, np.full(len(left), given.source)


def _named(
    catalogs: Sequence[Catalog], own: int, section: str, names: Any, starts: list[int]
) -> Iterator[NDArray[Any]]:
    """Rows, in the table of all, of families and parts by name; of a catalogue that is not loaded there are none."""
    places = {name: place for place, c in enumerate(catalogs) for name in c.digests}
    for other, name in names:
        place = places.get(other) if other else own
        if place is None:
            continue
        members = catalogs[place].table(section).members
        if name not in members:
            said = f"{', '.join(catalogs[own].digests)}, compatibility: {quoted(name)} is no family or part of {other}"
            raise CatalogError(f"{said}{nearest(name, members, 1)}")
        yield members[name] + starts[place]
