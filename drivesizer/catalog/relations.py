"""Parts of a catalogue file that go together: families and part numbers resolved to rows of its tables.

A list may name parts of another catalogue, as ``{maxon: GP 26 A}``. Those are kept by name until catalogues are loaded
together.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.field_reader import Reader
from drivesizer.catalog.parts import RELATIONS, singular
from drivesizer.catalog.tables import CONFIDENCE, Across, Pairs, Table, unique_pairs
from drivesizer.errors import nearest, quoted
from drivesizer.files.yaml_source import Path_

__all__ = ["LISTS", "relations"]

LISTS: dict[str, tuple[str, ...]] = {relation: ("motors", right) for relation, right in RELATIONS.items()}
LISTS["triples"] = ("motors", "gearheads", "encoders")
Group = tuple[NDArray[Any], NDArray[Any], int]  # rows that all go with rows, by a source


def relations(reader: Reader, tables: Mapping[str, Table[Any]], given: Any) -> dict[str, Any]:
    """The pairs of each relation, and under ``across`` what names another catalogue."""
    members = {section: table.members for section, table in tables.items()}
    found: dict[str, list[Group]] = {relation: [] for relation in RELATIONS}
    across: list[Across] = []
    for relation, groups in reader.mapping(given, ("compatibility",), LISTS).items():
        sections = LISTS[relation]
        for index, group in enumerate(reader.sequence(groups, ("compatibility", relation))):
            path: Path_ = ("compatibility", relation, index)
            group = reader.mapping(group, path, {"name", "source", "without", *sections}, {"source", *sections})
            source = reader.source_number(group["source"], (*path, "source"))
            if any(isinstance(name, dict) for s in sections for name in reader.sequence(group[s], (*path, s))):
                across += _across(reader, relation, group, members, path, source)
                continue
            rows = {s: _rows(reader, members[s], group[s], (*path, s)) for s in sections}
            if "without" in group:
                out = _rows(reader, members[sections[1]], group["without"], (*path, "without"))
                rows[sections[1]] = np.setdiff1d(rows[sections[1]], out)
            for right in sections[1:]:
                found[f"motor_{singular(right)}"].append((rows["motors"], rows[right], source))
    rank = [CONFIDENCE.index(source.confidence) for source in reader.sources.values()]
    pairs: dict[str, Any] = {name: _pairs(sorted(some, key=lambda g: rank[g[2]])) for name, some in found.items()}
    return pairs | {"across": tuple(across)}


def _rows(reader: Reader, members: Mapping[str, NDArray[Any]], given: Any, path: Path_) -> NDArray[Any]:
    found = []
    for index, name in enumerate(reader.sequence(given, path)):
        _known(reader, members, name, (*path, index))
        found.append(members[str(name)])
    return np.unique(np.concatenate(found)) if found else np.zeros(0, int)


def _known(reader: Reader, members: Mapping[str, NDArray[Any]], name: Any, path: Path_) -> None:
    if str(name) not in members:
        hint = nearest(str(name), members, 1)
        raise reader.fail(path, f"{quoted(name)} is neither a family nor a part of this catalogue{hint}")


def _across(
    reader: Reader, relation: str, group: dict[str, Any], members: dict[str, Any], path: Path_, source: int
) -> list[Across]:
    """A list that names parts of other catalogues: as many relations as it has sides beside the motors."""
    if "without" in group:
        raise reader.fail((*path, "without"), "does not go with parts of another catalogue; list those that fit")
    sides: dict[str, tuple[tuple[str, str], ...]] = {}
    for section in LISTS[relation]:
        names = []
        for index, name in enumerate(group[section]):
            at: Path_ = (*path, section, index)
            if isinstance(name, dict):
                if len(name) != 1:
                    raise reader.fail(at, "expected one catalogue and a family or part of it, e.g. {maxon: GP 26 A}")
                names += [(str(other), str(part)) for other, part in name.items()]
            else:
                _known(reader, members[section], name, at)
                names.append(("", str(name)))
        sides[section] = tuple(names)
    rights = LISTS[relation][1:]
    return [Across(f"motor_{singular(right)}", sides["motors"], sides[right], source) for right in rights]


def _pairs(groups: list[Group]) -> Pairs:
    """All pairs of the groups, sorted, each once with the most reliable source that states it."""
    lefts, rights, sources = [], [], []
    for left, right, source in groups:
        lefts.append(np.repeat(left, len(right)))
        rights.append(np.tile(right, len(left)))
        sources.append(np.full(len(left) * len(right), source))
    empty = np.zeros(0, np.int64)
    return unique_pairs(*(np.concatenate(part or [empty]) for part in (lefts, rights, sources)))
