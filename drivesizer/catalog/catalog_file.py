"""Reader of catalogue files: YAML in the project's own schema to columns, checked; which parts go together."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.identities import derived
from drivesizer.catalog.more_parts import DATA, DISCHARGES, PULL_OUTS, Column
from drivesizer.catalog.parts import DIRECT, PARTS, RELATIONS, columns_of, printed, singular
from drivesizer.catalog.section_readers import (
    Reader,
    did_you_mean,
    read_discharges,
    read_maker_tolerances,
    read_pull_outs,
)
from drivesizer.catalog.tables import (
    CONFIDENCE,
    NO_GEARHEAD_SOURCE,
    Across,
    Catalog,
    Note,
    Pairs,
    Source,
    Table,
    unique_pairs,
    with_no_gearhead,
)
from drivesizer.catalog.tolerances import TOLERANCES
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.units import label, noun, possible, scale, show, to_si
from drivesizer.units.kinds import AT_MOST, MAY_BE_ZERO, outside

__all__ = ["SCHEMA", "parse"]


# -- Parts of a catalogue file that go together: families and part numbers resolved to rows of its tables.
#
# A list may name parts of another catalogue, as ``{maxon: GP 26 A}``. Those are kept by name until catalogues are
# loaded together.


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


# -- Reader of catalogue files: YAML in the project's own schema to columns, checked.
#
# The schema is ``parts``: a table's header names fields and the unit of each column, so a unit is read once per
# column and not once per cell. Every error is one line that names file, line, table and field.


SCHEMA = 1
_TOP = {
    "catalog",
    "manufacturer",
    "overrides",
    "sources",
    DATA,
    *PARTS,
    DISCHARGES,
    PULL_OUTS,
    TOLERANCES,
    "compatibility",
}
_HOLDS = ("motors", "actuators")  # whose figures hold at a temperature
_TABLE = {"family", "source", "common", "columns", "rows", "notes"}
_NOTE = {"parts", "fields", "text", "confidence", "source", "exclude", "accepted", "rule"}
_SOURCE = {"document", "date", "confidence", "url"}
_NOT_A_COLUMN = {
    "family": "family stands at the head of its table",
    "manufacturer": "manufacturer stands at the head of its file",
    "inside": "inside is not given: it is of the parts of an actuator",
}
RATIO = re.compile(r"([0-9]{1,15}/[1-9][0-9]{0,14}|[0-9]{1,9}(?:\.[0-9]{1,9})?(?=:1$))(?::1)?")  # 3249/121, 27:1
_HEADER = re.compile(r"(\w+)(?:\s*\((.+)\))?")


def parse(source: YamlSource, name: str, digest: str) -> Catalog:
    """A catalogue from its YAML."""
    reader = Reader(source)
    data = reader.mapping(source.data, (), _TOP, {"catalog", "manufacturer", "sources"})
    if data["catalog"] != SCHEMA or data["catalog"] is True:
        raise reader.fail(("catalog",), f"schema {quoted(data['catalog'])} is not known; expected {SCHEMA}")
    _read_sources(reader, data["sources"])
    maker = reader.plain_text(data["manufacturer"], ("manufacturer",))
    tables: dict[str, Any] = {s: _section(reader, s, data.get(s) or [], maker) for s in PARTS}
    _at_temperature(reader, data.get(DATA), tables)
    reader.notes += derived(tables)
    families = {part: _names(tables, section) for part, section in (("motor", "motors"), ("gearhead", "gearheads"))}
    tolerances = read_maker_tolerances(reader, data.get(TOLERANCES), maker, families)
    tables["gearheads"] = _with_direct(reader, tables["gearheads"], data.get("compatibility"))
    pairs = relations(reader, tables, data.get("compatibility") or {})
    return Catalog(
        **tables,
        **pairs,
        discharges=read_discharges(reader, data.get(DISCHARGES), tables["batteries"].rows),
        pull_outs=read_pull_outs(reader, data.get(PULL_OUTS), tables["steppers"].rows),
        sources=tuple(reader.sources.values()),
        notes=tuple(reader.notes),
        digests={name: digest},
        tolerances=tolerances,
        overrides=reader.flag(data.get("overrides", False), ("overrides",)),
    )


def _at_temperature(reader: Reader, given: Any, tables: dict[str, Any]) -> None:
    """Give motors and actuators the temperature that the head of their file states."""
    if given is None:
        return
    for section in _HOLDS:
        column = tables[section][DATA]
        column[np.isnan(column)] = _figure(reader, columns_of(section)[DATA], given, (DATA,))


def _names(tables: dict[str, Any], section: str) -> set[str]:
    """The families of a section, and of the actuators, which have such a part inside."""
    return {str(name) for where in (section, "actuators") for name in np.unique(tables[where]["family"])} - {""}


def _read_sources(reader: Reader, given: Any) -> None:
    if not given:
        raise reader.fail(("sources",), "expected at least one, e.g. sheet: {document: ..., confidence: quoted}")
    for key, entry in reader.mapping(given, ("sources",), given if isinstance(given, dict) else ("sheet",)).items():
        path: Path_ = ("sources", key)
        entry = reader.mapping(entry, path, _SOURCE, {"document", "confidence"})
        _known_confidence(reader, entry["confidence"], path)
        texts = {k: reader.plain_text(v, (*path, k)) for k, v in entry.items()}
        reader.sources[key] = Source(**texts)


def _known_confidence(reader: Reader, value: Any, path: Path_) -> str:
    if value not in CONFIDENCE:
        raise reader.fail(path, f"confidence {quoted(value)} is not one of {', '.join(CONFIDENCE)}")
    return str(value)


def _section(reader: Reader, section: str, given: Any, maker: str) -> Table[Any]:
    """All tables of a section under each other."""
    schema = columns_of(section)
    parts: list[dict[str, NDArray[Any]]] = []
    source: list[NDArray[np.int32]] = []
    places: list[Path_] = []  # of every row, for messages
    for index, entry in enumerate(reader.sequence(given, (section,))):
        path: Path_ = (section, index)
        entry = reader.mapping(entry, path, _TABLE, {"family", "source", "columns", "rows"})
        columns = _table(reader, section, entry, path)
        count = len(columns["part"])
        columns["manufacturer"] = np.full(count, maker)
        columns["family"] = np.full(count, reader.plain_text(entry["family"], (*path, "family")))
        parts.append({name: columns.get(name, _unknown(column, count)) for name, column in schema.items()})
        places += [(*path, "rows", row) for row in range(count)]
        source.append(np.full(count, reader.source_number(entry["source"], (*path, "source")), np.int32))
        _read_notes(reader, section, entry, path, columns)
    empty = {name: _unknown(column, 0) for name, column in schema.items()}
    columns = {name: np.concatenate([p[name] for p in parts] or [empty[name]]) for name in schema}
    _unique(reader, columns["part"], places)
    _at_several_voltages(reader, columns, places)
    out = {p for note in reader.notes if note.section == section and note.exclude for p in note.parts}
    excluded = np.isin(columns["part"], sorted(out)) if out else np.zeros(len(columns["part"]), bool)
    return Table(section, columns, np.concatenate(source or [np.zeros(0, np.int32)]), excluded)


def _with_direct(reader: Reader, table: Table[Any], compatibility: Any) -> Table[Any]:
    """The gearheads, with direct drive where the file lists motors that drive the load themselves."""
    groups = compatibility.get("motor_gearhead") if isinstance(compatibility, dict) else None
    named = [g.get("gearheads") for g in groups if isinstance(g, dict)] if isinstance(groups, list) else []
    if not any(isinstance(names, list) and DIRECT in names for names in named):
        return table
    reader.sources[DIRECT] = NO_GEARHEAD_SOURCE
    return with_no_gearhead(table, len(reader.sources) - 1)


def _unknown(column: Column, count: int) -> NDArray[Any]:
    return np.full(count, "") if column.kind == "text" else np.full(count, np.nan)


def _unique(reader: Reader, parts: NDArray[Any], places: list[Path_]) -> None:
    first = np.unique(parts, return_index=True)[1]
    again = np.setdiff1d(np.arange(len(parts)), first)
    if len(again):
        raise reader.fail(places[again[0]], f"part {quoted(parts[again[0]])} is given twice")


def _at_several_voltages(reader: Reader, columns: dict[str, NDArray[Any]], places: list[Path_]) -> None:
    """Refuse two rows of an order number at one voltage, or at none: no supply says which of them counts."""
    found: dict[tuple[str, float], str] = {}
    for row, order in enumerate(columns.get("order_number", np.array([])).tolist()):
        volts = float(columns["nominal_voltage"][row])
        if not order:
            continue
        if np.isnan(volts):
            raise reader.fail(
                places[row], f"order_number {quoted(order)} needs nominal_voltage, at which its figures hold"
            )
        first = found.setdefault((order, volts), part := str(columns["part"][row]))
        if first != part:
            raise reader.fail(
                places[row], f"{quoted(part)} and {quoted(first)} are {quoted(order)} at {volts:g} V; give one"
            )


def _table(reader: Reader, section: str, entry: dict[str, Any], path: Path_) -> dict[str, NDArray[Any]]:
    """The columns of one table, its common figures repeated for every row."""
    headers = _headers(reader, section, entry["columns"], (*path, "columns"))
    rows = reader.sequence(entry["rows"], (*path, "rows"))
    for index, row in enumerate(rows):
        if not isinstance(row, list) or len(row) != len(headers):
            have = len(row) if isinstance(row, list) else 0
            raise reader.fail((*path, "rows", index), f"expected {len(headers)} cells as in `columns`, found {have}")
    found: dict[str, NDArray[Any]] = {}
    for place, (column, *factors) in enumerate(headers):
        cells = [row[place] for row in rows]
        found[column.name] = _column(reader, column, factors, cells, _cell_path(path, place))
    schema = columns_of(section)
    for name, value in reader.mapping(entry.get("common") or {}, (*path, "common"), schema).items():
        at: Path_ = (*path, "common", name)
        if name in found:
            raise reader.fail(at, f"{name} is a column of this table as well; give it once")
        if name in _NOT_A_COLUMN:
            raise reader.fail(at, _NOT_A_COLUMN[name])
        found[name] = np.full(len(rows), _figure(reader, schema[name], value, at))
    return found


def _cell_path(path: Path_, place: int) -> Callable[[int], Path_]:
    return lambda row: (*path, "rows", row, place)


def _headers(reader: Reader, section: str, given: Any, path: Path_) -> list[tuple[Column, float, float]]:
    """The columns that a table names, each with the factor and offset of its unit."""
    schema, given_columns = columns_of(section), {*printed(section), *_NOT_A_COLUMN}
    headers: list[tuple[Column, float, float]] = []
    for index, text in enumerate(reader.sequence(given, path)):
        match = _HEADER.fullmatch(str(text).strip())
        name = match.group(1) if match else str(text)
        if name not in schema:
            raise reader.fail((*path, index), f"unknown column {quoted(name)}{did_you_mean(name, schema)}")
        if name in _NOT_A_COLUMN or name not in given_columns:
            said = _NOT_A_COLUMN.get(name, f"{name} of {section} is not given: the search fills it")
            raise reader.fail((*path, index), said)
        unit = (match.group(2) or "") if match else ""
        headers.append((schema[name], *_unit(reader, schema[name], unit, (*path, index))))
    names = [header[0].name for header in headers]
    if len(set(names)) < len(names) or "part" not in names:
        raise reader.fail(path, "a table needs the column `part`, and every column once")
    return headers


def _unit(reader: Reader, column: Column, unit: str, path: Path_) -> tuple[float, float]:
    """Factor and offset that bring a column's numbers to SI."""
    if column.kind in ("text", "ratio") and unit:
        raise reader.fail(path, f"{column.name} has no unit, found {quoted(unit)}")
    if not unit:
        if column.kind not in ("text", "ratio", "dimensionless"):
            raise reader.fail(path, f"{column.name} needs its unit in brackets, e.g. {column.name} ({column.unit})")
        return 1.0, 0.0
    try:
        return scale(unit, column.kind)
    except InputError as error:
        raise reader.fail(path, f"{column.name}: {error}; expected e.g. {column.name} ({column.unit})") from None


def _column(
    reader: Reader, column: Column, factors: list[float], cells: list[Any], at: Callable[[int], Path_]
) -> NDArray[Any]:
    """One column of cells in SI (or text)."""
    if column.name == "part":
        return np.array([reader.part_number(cell, at(row)) for row, cell in enumerate(cells)] or [""])[: len(cells)]
    if column.kind == "text":
        return np.array([reader.plain_text(cell, at(row)) for row, cell in enumerate(cells)] or [""])[: len(cells)]
    factor, offset = factors
    values = np.array([_cell(reader, column, cell, at(row)) for row, cell in enumerate(cells)], float)
    values = values * factor + offset
    if wrong := _impossible(column, values):
        row, words = wrong
        raise reader.fail(at(row), f"{column.name} {quoted(cells[row])} {words}")
    return values


def _impossible(column: Column, values: NDArray[Any]) -> tuple[int, str] | None:
    """The first of some SI figures that no part can have, and why; None where all can be."""
    most, zero = AT_MOST.get(column.name, np.inf), column.name in MAY_BE_ZERO
    example = f"expected {label(column.unit) or 'a plain number'} above 0, ~ where it is unknown"
    for bad, words in (
        (values < column.least, f"is below {column.least:g}"),
        ((values <= 0.0) & ((column.kind == "ratio") | (values == 0.0)) & (not zero), f"is not above 0; {example}"),
        (values > most, f"is above {show(most, column.unit, column.kind)}"),
        (outside(values, column.kind), f"is no {noun(column.kind)} of a machine; {possible(column.kind)}"),
    ):
        if bad.any():
            return int(np.flatnonzero(bad)[0]), words
    return None


def _cell(reader: Reader, column: Column, cell: Any, path: Path_) -> float:
    if cell is None:
        return np.nan
    if isinstance(cell, int | float) and not isinstance(cell, bool):
        return float(cell)
    if column.kind == "ratio" and isinstance(cell, str) and (printed := RATIO.fullmatch(cell)):
        return float(Fraction(printed[1]))
    raise reader.fail(path, f"{column.name}: {quoted(cell)} is not a number; unknown is written ~")


def _figure(reader: Reader, column: Column, value: Any, path: Path_) -> Any:
    """A figure with its unit, as `common` gives it."""
    if column.kind == "text":
        return reader.plain_text(value, path)
    if value is None:
        return np.nan
    if column.kind == "ratio":
        return _cell(reader, column, value, path)
    try:
        figure = to_si(value, column.kind)
    except InputError as error:
        raise reader.fail(path, str(error)) from None
    if wrong := _impossible(column, np.array([figure])):
        raise reader.fail(path, f"{quoted(value)} {wrong[1]}")
    return figure


def _read_notes(
    reader: Reader, section: str, entry: dict[str, Any], path: Path_, columns: dict[str, NDArray[Any]]
) -> None:
    here = {str(part) for part in columns["part"]}
    for index, given in enumerate(reader.sequence(entry.get("notes") or [], (*path, "notes"))):
        at: Path_ = (*path, "notes", index)
        note = reader.mapping(given, at, _NOTE, {"text"})
        parts = tuple(str(p) for p in reader.sequence(note.get("parts") or sorted(here), (*at, "parts")))
        names = tuple(str(f) for f in reader.sequence(note.get("fields") or [], (*at, "fields")))
        for part in parts:
            if part not in here:
                raise reader.fail((*at, "parts"), f"{quoted(part)} is not a part of this table")
        for name in names:
            if name not in columns and (section, name) != ("batteries", DISCHARGES):
                raise reader.fail((*at, "fields"), f"{quoted(name)} is not a figure of this table")
        if "confidence" in note:
            _known_confidence(reader, note["confidence"], at)
        if "source" in note:
            reader.source_number(note["source"], (*at, "source"))
        texts = {key: reader.plain_text(note.get(key), (*at, key)) for key in ("text", "confidence", "source")}
        for key in ("exclude", "accepted", "rule"):
            reader.flag(note.get(key, False), (*at, key))
        flags = {key: note.get(key, False) for key in ("exclude", "accepted", "rule")}
        if texts["source"]:
            texts["source"] = reader.sources[texts["source"]].document
        values: dict[str, Any] = texts | flags
        reader.notes.append(Note(section=section, parts=parts, fields=names, **values))
