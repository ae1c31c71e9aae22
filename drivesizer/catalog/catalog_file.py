"""Reader of catalogue files: YAML in the project's own schema to columns, checked; which parts go together.

The schema is ``parts`` and ``schema``: a table's header names fields and the unit of each column, so a unit is read
once per column and not once per cell. Every error is one line that names file, line, table and field.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import parts, schema, tables
from drivesizer.catalog.laws import derived
from drivesizer.catalog.parts import PARTS, Column, columns_of
from drivesizer.catalog.prices import iso_date
from drivesizer.catalog.tables import Catalog, Note, Source, Table
from drivesizer.catalog.tolerances import TOLERANCES, MakerTolerance, share
from drivesizer.errors import CatalogError, InputError, nearest, quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.units import label, noun, outside, possible, scale, show, to_si

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
    data = reader.fields(source.data, (), schema.TOP)
    if data["catalog"] != schema.SCHEMA or data["catalog"] is True:
        raise reader.fail(("catalog",), f"schema {quoted(data['catalog'])} is not known; expected {schema.SCHEMA}")
    _read_sources(reader, data["sources"])
    maker = reader.plain_text(data["manufacturer"], ("manufacturer",))
    sections: dict[str, Any] = {s: _section(reader, s, data.get(s), maker) for s in PARTS}
    if data.get(parts.DATA) is not None:
        for section in ("motors", "actuators"):
            column = sections[section][parts.DATA]
            column[np.isnan(column)] = _figure(reader, columns_of(section)[parts.DATA], data[parts.DATA], (parts.DATA,))
    reader.notes += derived(sections)
    families = {part: {str(name) for s in (f"{part}s", "actuators") for name in np.unique(sections[s]["family"])} - {""}
                for part in ("motor", "gearhead")}  # fmt: skip
    tolerances = _maker_tolerances(reader, data.get(TOLERANCES), maker, families)
    lists = data.get("compatibility")
    groups = lists.get("motor_gearhead") if isinstance(lists, dict) else None
    named = [g.get("gearheads") for g in groups if isinstance(g, dict)] if isinstance(groups, list) else []
    if any(isinstance(names, list) and parts.DIRECT in names for names in named):
        reader.sources[parts.DIRECT] = tables.NO_GEARHEAD_SOURCE
        sections["gearheads"] = tables.with_no_gearhead(sections["gearheads"], len(reader.sources) - 1)
    return Catalog(
        **sections,
        **_pairs(reader, sections, lists or {}),
        discharges=_discharges(reader, data.get(parts.DISCHARGES), sections["batteries"].rows),
        pull_outs=_pull_outs(reader, data.get(parts.PULL_OUTS), sections["steppers"].rows),
        sources=tuple(reader.sources.values()),
        notes=tuple(reader.notes),
        digests={name: digest},
        tolerances=tolerances,
        overrides=reader.flag(data.get("overrides", False), ("overrides",)),
        prices=tuple(_prices(reader, data.get("prices"), name)),
    )


class Reader:
    """A catalogue file with its sources and notes while it is read; errors name file, line and field."""

    def __init__(self, source: YamlSource) -> None:
        self.file = source
        self.sources: dict[str, Source] = {}
        self.notes: list[Note] = []

    def fail(self, path: Path_, message: str) -> CatalogError:
        """The error at a place of the file."""
        return CatalogError(f"{self.file.where(path)}: {message}")

    def fields(self, value: Any, path: Path_, shape: Mapping[str, Any]) -> dict[str, Any]:
        """A group of fields as its JSON Schema has it: no others than those allowed, and all that are required."""
        allowed, required = shape["properties"], shape.get("required", ())
        if not isinstance(value, dict):
            raise self.fail(path, f"expected fields such as {', '.join(sorted(required) or sorted(allowed)[:3])}")
        for key in value:
            if key not in allowed:
                raise self.fail((*path, key), f"unknown key {quoted(key)}{_did_you_mean(key, allowed)}")
        for key in sorted(required):
            if key not in value:
                raise self.fail(path, f"{quoted(key)} is missing")
        return value

    def mapping(self, value: Any, path: Path_, example: str) -> dict[str, Any]:
        """A group of fields by names of the user's, which may be left out."""
        named = {"properties": value if isinstance(value, dict) else (example,)}
        return {} if value is None else self.fields(value, path, named)

    def sequence(self, value: Any, path: Path_) -> list[Any]:
        """A list."""
        if not isinstance(value, list):
            raise self.fail(path, "expected a list")
        return value

    def entries(self, items: Any, path: Path_, shape: Mapping[str, Any]) -> Iterator[tuple[dict[str, Any], Path_]]:
        """Groups of fields of a list that may be left out, each with its place."""
        for index, entry in enumerate(self.sequence([] if items is None else items, path)):
            yield self.fields(entry, (*path, index), shape), (*path, index)

    def rows(self, rows: Any, path: Path_, width: int) -> Iterator[tuple[list[Any], Path_]]:
        """Rows of a table, each with its place."""
        for index, row in enumerate(self.sequence(rows, path)):
            if not isinstance(row, list) or len(row) != width:
                have = len(row) if isinstance(row, list) else 0
                raise self.fail((*path, index), f"expected {width} cells as in `columns`, found {have}")
            yield row, (*path, index)

    def source_number(self, name: Any, path: Path_) -> int:
        """The place of a named source among the file's."""
        if not isinstance(name, str) or name not in self.sources:
            raise self.fail(path, f"{quoted(name)} is not one of the file's sources ({', '.join(self.sources)})")
        return list(self.sources).index(name)

    def plain_text(self, value: Any, path: Path_) -> str:
        """A text; numbers count as what they look like."""
        if value is None:
            return ""
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise self.fail(path, "expected text")
        return str(value)

    def part_number(self, value: Any, path: Path_) -> str:
        """A part number, quoted or not."""
        if isinstance(value, bool) or not isinstance(value, str | int) or not str(value).strip():
            raise self.fail(path, f"{quoted(value)} is not a part number; quote it")
        return str(value)

    def flag(self, value: Any, path: Path_) -> bool:
        """True or false."""
        if not isinstance(value, bool):
            raise self.fail(path, f"{quoted(value)} is not true or false")
        return value

    def read(self, path: Path_, convert: Callable[..., Any], *arguments: Any) -> Any:
        """A text by a reader of units or tolerances."""
        try:
            return convert(*arguments)
        except InputError as error:
            raise self.fail(path, str(error)) from None


def _did_you_mean(key: str, allowed: Iterable[str]) -> str:
    """Hint for an unknown word: the nearest allowed one, or all of them."""
    close = difflib.get_close_matches(key, sorted(allowed), 1)
    return f"; did you mean {quoted(close[0])}?" if close else f"; expected one of {', '.join(sorted(allowed))}"


def _read_sources(reader: Reader, sources: Any) -> None:
    if not sources:
        raise reader.fail(("sources",), "expected at least one, e.g. sheet: {document: ..., confidence: quoted}")
    for key, entry in reader.mapping(sources, ("sources",), "sheet").items():
        path: Path_ = ("sources", key)
        entry = reader.fields(entry, path, schema.SOURCE)
        _known_confidence(reader, entry["confidence"], path)
        reader.sources[key] = Source(**{k: reader.plain_text(v, (*path, k)) for k, v in entry.items()})


def _known_confidence(reader: Reader, value: Any, path: Path_) -> None:
    if value not in tables.CONFIDENCE:
        raise reader.fail(path, f"confidence {quoted(value)} is not one of {', '.join(tables.CONFIDENCE)}")


# -- Tables of parts


def _section(reader: Reader, section: str, entries: Any, maker: str) -> Table[Any]:
    """All tables of a section under each other."""
    shape, found_tables = schema.table(section), [tables.empty(section)]
    places = list[Path_]()  # of every row, for messages
    for entry, path in reader.entries(entries, (section,), shape):
        head = {"manufacturer": maker, "family": reader.plain_text(entry["family"], (*path, "family"))}
        columns: dict[str, Any] = dict(_table(reader, section, entry, path))
        count = len(columns["part"])
        places += [(*path, "rows", row) for row in range(count)]
        source = np.full(count, reader.source_number(entry["source"], (*path, "source")), np.int32)
        found_tables.append(
            Table(section, tables.filled(section, columns | head, count), source, np.zeros(count, bool))
        )
        _read_notes(reader, section, entry, path, columns | head)
    whole = {name: np.concatenate([table[name] for table in found_tables]) for name in columns_of(section)}
    numbers = whole["part"].tolist()
    first: dict[str, int] = {}
    for row, part in enumerate(numbers):
        if first.setdefault(part, row) != row:
            raise reader.fail(places[row], f"part {quoted(part)} is given twice")
    _at_several_voltages(reader, whole, places)
    out = {p for note in reader.notes if note.section == section and note.exclude for p in note.parts}
    excluded = np.array([part in out for part in numbers], bool)
    return Table(section, whole, np.concatenate([table.source for table in found_tables]), excluded)


def _at_several_voltages(reader: Reader, columns: dict[str, NDArray[Any]], places: list[Path_]) -> None:
    """Refuse two rows of an order number at one voltage, or at none: no supply says which of them counts."""
    part_at: dict[tuple[str, float], str] = {}
    for row, order in enumerate(columns["order_number"].tolist() if "order_number" in columns else ()):
        volts = float(columns["nominal_voltage"][row])
        if not order:
            continue
        if np.isnan(volts):
            raise reader.fail(
                places[row], f"order_number {quoted(order)} needs nominal_voltage, at which its figures hold"
            )
        first = part_at.setdefault((order, volts), part := str(columns["part"][row]))
        if first != part:
            raise reader.fail(
                places[row], f"{quoted(part)} and {quoted(first)} are {quoted(order)} at {volts:g} V; give one"
            )


def _table(reader: Reader, section: str, entry: dict[str, Any], path: Path_) -> dict[str, NDArray[Any]]:
    """The columns of one table in SI, its common figures repeated for every row."""
    columns = columns_of(section)
    headers = _headers(reader, section, entry["columns"], (*path, "columns"))
    rows = list(reader.rows(entry["rows"], (*path, "rows"), len(headers)))
    figures: dict[str, NDArray[Any]] = {}
    for place, (column, factor, offset) in enumerate(headers):
        cells = [(row[place], (*at, place)) for row, at in rows]
        if column.kind == "text":
            read = reader.part_number if column.name == "part" else reader.plain_text
            figures[column.name] = np.array([read(*cell) for cell in cells], str)
            continue
        values = np.array([_cell(reader, column, *cell) for cell in cells], float) * factor + offset
        if wrong := _impossible(column, values):
            cell, here = cells[wrong[0]]
            raise reader.fail(here, f"{column.name} {quoted(cell)} {wrong[1]}")
        figures[column.name] = values
    common = reader.fields(entry.get("common") or {}, (*path, "common"), {"properties": columns})
    for name, value in common.items():
        here = (*path, "common", name)
        if name in figures:
            raise reader.fail(here, f"{name} is a column of this table as well; give it once")
        if name in _NOT_A_COLUMN:
            raise reader.fail(here, _NOT_A_COLUMN[name])
        figures[name] = np.full(len(rows), _figure(reader, columns[name], value, here))
    return figures


def _headers(reader: Reader, section: str, heads: Any, path: Path_) -> list[tuple[Column, float, float]]:
    """The columns that a table names, each with the factor and offset of its unit."""
    columns, headers = columns_of(section), list[tuple[Column, float, float]]()
    for index, text in enumerate(reader.sequence(heads, path)):
        at, (name, unit) = (*path, index), _head(text)
        if name not in columns:
            raise reader.fail(at, f"unknown column {quoted(name)}{_did_you_mean(name, columns)}")
        if name in _NOT_A_COLUMN or name not in parts.printed(section):
            reason = _NOT_A_COLUMN.get(name, f"{name} of {section} is not given: the search fills it")
            raise reader.fail(at, reason)
        column = columns[name]
        bare = column.kind in ("text", "ratio")
        if bare and unit:
            raise reader.fail(at, f"{name} has no unit, found {quoted(unit)}")
        if not unit and not bare and column.kind != "dimensionless":
            raise reader.fail(at, f"{name} needs its unit in brackets, e.g. {name} ({column.unit})")
        try:
            headers.append((column, *(scale(unit, column.kind) if unit else (1.0, 0.0))))
        except InputError as error:
            raise reader.fail(at, f"{name}: {error}; expected e.g. {name} ({column.unit})") from None
    names = [column.name for column, *_ in headers]
    if len(set(names)) < len(names) or "part" not in names:
        raise reader.fail(path, "a table needs the column `part`, and every column once")
    return headers


def _impossible(column: Column, values: NDArray[Any]) -> tuple[int, str] | None:
    """The first of some SI figures that no part can have, and why; None where all can be."""
    example = f"expected {label(column.unit) or 'a plain number'} above 0, ~ where it is unknown"
    none = values <= 0.0 if column.kind == "ratio" else values == 0.0
    for bad, words in (
        (values < column.least, f"is below {column.least:g}"),
        (none & (not column.zero), f"is not above 0; {example}"),
        (values > column.most, f"is above {show(column.most, column.unit, column.kind)}"),
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
    if column.kind == "ratio" and isinstance(cell, str) and (exact := RATIO.fullmatch(cell)):
        return float(Fraction(exact[1]))
    raise reader.fail(path, f"{column.name}: {quoted(cell)} is not a number; unknown is written ~")


def _figure(reader: Reader, column: Column, value: Any, path: Path_) -> Any:
    """A figure with its unit, as `common` gives it."""
    if column.kind == "text":
        return reader.plain_text(value, path)
    if value is None:
        return np.nan
    if column.kind == "ratio":
        return _cell(reader, column, value, path)
    figure = reader.read(path, to_si, value, column.kind)
    if wrong := _impossible(column, np.array([figure])):
        raise reader.fail(path, f"{quoted(value)} {wrong[1]}")
    return figure


def _read_notes(reader: Reader, section: str, entry: dict[str, Any], path: Path_, columns: Mapping[str, Any]) -> None:
    here = {str(part) for part in columns["part"]}
    for note, at in reader.entries(entry.get("notes"), (*path, "notes"), schema.NOTE):
        numbers = tuple(str(p) for p in reader.sequence(note.get("parts") or sorted(here), (*at, "parts")))
        names = tuple(str(f) for f in reader.sequence(note.get("fields") or [], (*at, "fields")))
        for part in numbers:
            if part not in here:
                raise reader.fail((*at, "parts"), f"{quoted(part)} is not a part of this table")
        for name in names:
            if name not in columns and (section, name) != ("batteries", parts.DISCHARGES):
                raise reader.fail((*at, "fields"), f"{quoted(name)} is not a figure of this table")
        if "confidence" in note:
            _known_confidence(reader, note["confidence"], at)
        if "source" in note:
            reader.source_number(note["source"], (*at, "source"))
        remark: dict[str, Any] = {
            key: reader.plain_text(note.get(key), (*at, key)) for key in ("text", "confidence", "source")
        }
        remark |= {key: reader.flag(note.get(key, False), (*at, key)) for key in ("exclude", "accepted", "rule")}
        if remark["source"]:
            remark["source"] = reader.sources[remark["source"]].document
        reader.notes.append(Note(section=section, parts=numbers, fields=names, **remark))


# -- Parts that go together: families and part numbers resolved to rows.
#
# A list may name parts of another catalogue, as ``{maxon: GP 26 A}``. Those are kept by name until catalogues are
# loaded together.


def _pairs(reader: Reader, whole: Mapping[str, Table[Any]], lists: Any) -> dict[str, Any]:
    """The pairs of each relation, and under ``across`` what names another catalogue."""
    members = {section: table.members for section, table in whole.items()}
    by_relation: dict[str, list[tuple[NDArray[Any], NDArray[Any], int]]] = {
        relation: [] for relation in parts.RELATIONS
    }
    across: list[tables.Across] = []
    for relation, groups in reader.fields(lists, ("compatibility",), {"properties": schema.LISTS}).items():
        left, *rights = sections = schema.LISTS[relation]
        listed = reader.sequence(groups, ("compatibility", relation))
        for group, path in reader.entries(listed, ("compatibility", relation), schema.group(relation)):
            source = reader.source_number(group["source"], (*path, "source"))
            if any(isinstance(name, dict) for s in sections for name in reader.sequence(group[s], (*path, s))):
                if "without" in group:
                    text = "does not go with parts of another catalogue; list those that fit"
                    raise reader.fail((*path, "without"), text)
                sides = {s: _names(reader, members[s], group[s], (*path, s)) for s in sections}
                for right in rights:
                    relation_of = f"motor_{parts.singular(right)}"
                    across.append(tables.Across(relation_of, sides[left], sides[right], source))
                continue
            rows = {s: _rows(reader, members[s], group[s], (*path, s)) for s in sections}
            if "without" in group:
                out = _rows(reader, members[rights[0]], group["without"], (*path, "without"))
                rows[rights[0]] = np.setdiff1d(rows[rights[0]], out)
            for right in rights:
                by_relation[f"motor_{parts.singular(right)}"].append((rows[left], rows[right], source))
    rank = [tables.CONFIDENCE.index(source.confidence) for source in reader.sources.values()]
    pairs: dict[str, Any] = {"across": tuple(across)}
    for name, groups in by_relation.items():  # each pair once with the most reliable source that states it
        all_of = [np.zeros((3, 0), np.int64)]
        for motors, others, source in sorted(groups, key=lambda group: rank[group[2]]):
            pair_rows = np.repeat(motors, len(others)), np.tile(others, len(motors))
            all_of.append(np.array([*pair_rows, np.full(len(pair_rows[0]), source)]))
        pairs[name] = tables.unique_pairs(*np.concatenate(all_of, axis=1))
    return pairs


def _rows(reader: Reader, members: Mapping[str, NDArray[Any]], names: Any, path: Path_) -> NDArray[Any]:
    rows = [np.zeros(0, np.int64)]
    for index, name in enumerate(reader.sequence(names, path)):
        _check_member(reader, members, name, (*path, index))
        rows.append(members[str(name)])
    return np.unique(np.concatenate(rows))


def _check_member(reader: Reader, members: Mapping[str, Any], name: Any, path: Path_) -> None:
    if str(name) not in members:
        hint = nearest(str(name), members, 1)
        raise reader.fail(path, f"{quoted(name)} is neither a family nor a part of this catalogue{hint}")


def _names(reader: Reader, members: Mapping[str, Any], entries: Any, path: Path_) -> tuple[tuple[str, str], ...]:
    """One side of a list that names parts of other catalogues: catalogue, empty for this one, and family or part."""
    names: list[tuple[str, str]] = []
    for index, name in enumerate(entries):
        if not isinstance(name, dict):
            _check_member(reader, members, name, (*path, index))
            names.append(("", str(name)))
        elif len(name) != 1:
            text = "expected one catalogue and a family or part of it, e.g. {maxon: GP 26 A}"
            raise reader.fail((*path, index), text)
        else:
            names += [(str(other), str(part)) for other, part in name.items()]
    return tuple(names)


# -- Discharge tables, as makers print them: rows are end voltages, columns times


def _discharges(reader: Reader, entries: Any, batteries: dict[str, int]) -> parts.Discharges:
    seen: dict[tuple[int, str, float, float], Path_] = {}
    rows: list[tuple[float, ...]] = []
    for entry, path in reader.entries(entries, (parts.DISCHARGES,), schema.DISCHARGE):
        battery = _row(reader, entry, "battery", batteries, path)
        source = reader.source_number(entry["source"], (*path, "source"))
        quantity, unit = _head(entry["held"])
        if quantity not in parts.CONSTANT_DRAWS or not unit:
            text = f"{quoted(entry['held'])} is not known; expected current (A) or power (W)"
            raise reader.fail((*path, "held"), text)
        factor = reader.read((*path, "held"), scale, unit, quantity)[0]
        cells = entry.get("cells", 1)
        if isinstance(cells, bool) or not isinstance(cells, int) or cells < 1:
            raise reader.fail((*path, "cells"), f"{quoted(cells)} is not a number of cells in series")
        volts, times = _discharge_head(reader, entry["columns"], (*path, "columns"))
        factor *= cells if quantity == "power" else 1.0  # the cells of a block carry the same current
        for row, at in reader.rows(entry["rows"], (*path, "rows"), len(times) + 1):
            cutoff = _above_zero(reader, row[0], (*at, 0)) * volts * cells
            for place, time in enumerate(times, 1):
                if row[place] is None:
                    continue
                here = (*at, place)
                draw = _above_zero(reader, row[place], here) * factor
                if seen.setdefault((battery, quantity, cutoff, time), here) is not here:
                    raise reader.fail(here, "this end voltage and time are given twice for the battery")
                pair = (draw, np.nan) if quantity == "current" else (np.nan, draw)
                rows.append((battery, source, cutoff, time, *pair))
    return parts.entries(parts.Discharges, rows)


def _row(reader: Reader, entry: dict[str, Any], what: str, rows: dict[str, int], path: Path_) -> int:
    """The row of the part that a table is of."""
    part = reader.part_number(entry[what], (*path, what))
    if part not in rows:
        raise reader.fail((*path, what), f"{quoted(part)} is not a {what} of this file")
    return rows[part]


def _head(text: Any) -> tuple[str, str]:
    """Name and unit of ``current (A)``."""
    match = _HEADER.fullmatch(str(text).strip())
    return (match[1], match[2] or "") if match else (str(text), "")


def _discharge_head(reader: Reader, columns: Any, path: Path_) -> tuple[float, list[float]]:
    """Factor of the end voltages' unit, and the times [s]: ``[cutoff_voltage (V), 5 min, 1 h]``."""
    first, *others = reader.sequence(columns, path) or [""]
    name, unit = _head(first)
    if name != "cutoff_voltage" or not unit or not others:
        raise reader.fail(path, "expected cutoff_voltage (V) and then times, e.g. [cutoff_voltage (V), 30 min, 1 h]")
    times = []
    for place, text in enumerate(map(str, others), 1):
        times.append(reader.read((*path, place), to_si, text, "time"))
        if not times[-1] > 0.0:
            raise reader.fail((*path, place), f"{quoted(text)} is not above 0 s")
    return reader.read((*path, 0), scale, unit, "voltage")[0], times


def _above_zero(reader: Reader, cell: Any, path: Path_) -> float:
    if isinstance(cell, bool) or not isinstance(cell, int | float) or not cell > 0:
        raise reader.fail(path, f"{quoted(cell)} is not a number above 0; unknown is written ~")
    return float(cell)


# -- Pull-out curves of steppers: rows are speeds and torques at a supply voltage


def _pull_outs(reader: Reader, entries: Any, steppers: dict[str, int]) -> parts.PullOuts:
    points: list[tuple[Any, ...]] = []
    for number, (entry, path) in enumerate(reader.entries(entries, (parts.PULL_OUTS,), schema.PULL_OUT)):
        stepper = _row(reader, entry, "stepper", steppers, path)
        source = reader.source_number(entry["source"], (*path, "source"))
        at_head = {"current": np.nan}
        for kind in (kind for kind in ("voltage", "current") if kind in entry):
            at_head[kind] = reader.read((*path, kind), to_si, str(entry[kind]), kind)
            if not at_head[kind] > 0.0:
                raise reader.fail((*path, kind), f"{quoted(entry[kind])} is not above 0")
        driver = reader.plain_text(entry["driver"], (*path, "driver")) if "driver" in entry else ""
        head = (stepper, source, number, at_head["voltage"], at_head["current"])
        points += [(*head, *point, driver) for point in _points(reader, entry, path)]
    return parts.entries(parts.PullOuts, points)


def _points(reader: Reader, entry: dict[str, Any], path: Path_) -> list[list[float]]:
    """Speed [rad/s] and torque [N*m] of each row."""
    heads, kinds = reader.sequence(entry["columns"], (*path, "columns")), schema.CURVE_COLUMNS
    if [name for name, _ in map(_head, heads)] != list(kinds):
        text = f"{quoted(heads)} is not known; expected [speed (rpm), torque (N*m)]"
        raise reader.fail((*path, "columns"), text)
    factors = [reader.read((*path, "columns"), scale, _head(head)[1], kind)[0]
               for head, (kind, _) in zip(heads, kinds.values(), strict=True)]  # fmt: skip
    points: list[list[float]] = []
    for number, row in enumerate(reader.sequence(entry["rows"], (*path, "rows"))):
        at: Path_ = (*path, "rows", number)
        numbers = isinstance(row, list) and all(isinstance(c, int | float) and not isinstance(c, bool) for c in row)
        if not numbers or len(row) != len(factors) or min(row) < 0:
            raise reader.fail(at, f"{quoted(row)} is not a speed and a torque of 0 or more, e.g. [300, 0.41]")
        point = [float(cell) * factor for cell, factor in zip(row, factors, strict=True)]
        if points and not point[0] > points[-1][0]:
            raise reader.fail(at, f"speed {row[0]:g} is not above that of the row before; expected rising speeds")
        points.append(point)
    if len(points) < 2:
        raise reader.fail((*path, "rows"), f"found {len(points)} points; expected at least 2")
    return points


# -- Prices of parts, of this file or any other


def _prices(reader: Reader, entries: Any, name: str) -> Iterator[tables.Price]:
    for entry, path in reader.entries(entries, ("prices",), schema.PRICES):
        source = list(reader.sources.values())[reader.source_number(entry["source"], (*path, "source"))]
        heads = [str(head) for head in reader.sequence(entry["columns"], (*path, "columns"))]
        shared = reader.fields(entry.get("common") or {}, (*path, "common"), schema.PRICES["properties"]["common"])
        for head in (head for head in heads if head not in schema.PRICES["properties"]["common"]["properties"]):
            raise reader.fail((*path, "columns"), f"unknown column {quoted(head)}; expected part, price, currency ...")
        for cells, at in reader.rows(entry["rows"], (*path, "rows"), len(heads)):
            fields = shared | dict(zip(heads, cells, strict=True))
            row = {key: reader.plain_text(value, at) for key, value in fields.items()}
            amount, code, pieces = row.pop("price", ""), row.pop("currency", "EUR"), row.pop("pieces", "") or "1"
            price = reader.read(at, to_si, f"{amount} {code}", "price")
            if not pieces.isdecimal() or not price > 0.0 or not row.get("part"):
                raise reader.fail(at, "expected a part, a price above 0 and from how many pieces on, e.g. 10")
            date = iso_date(row.pop("date", source.date))
            yield tables.Price(amount=price, currency=code, pieces=max(int(pieces), 1), date=date, file=name,
                               document=source.document, confidence=source.confidence, **row)  # fmt: skip


# -- Tolerances that the maker states, in the notation of a spec


def _maker_tolerances(
    reader: Reader, entries: Any, maker: str, families: Mapping[str, set[str]]
) -> tuple[MakerTolerance, ...]:
    tolerances: list[MakerTolerance] = []
    for entry, path in reader.entries(entries, (TOLERANCES,), schema.TOLERANCE):
        roles = [part for part in schema.FIGURES if part in entry]
        if not roles:
            example = "e.g. motor: {resistance: +- 10 %}"
            raise reader.fail(path, f"expected {' or '.join(schema.FIGURES)}, {example}")
        source = reader.source_number(entry["source"], (*path, "source"))
        text = reader.plain_text(entry.get("text"), (*path, "text"))
        for part in roles:
            named = _families(reader, entry, (*path, "families"), families[part], part)
            allowed, at = schema.FIGURES[part], (*path, part)
            figures = reader.fields(entry[part], at, {"properties": allowed})
            texts = {name: reader.plain_text(value, (*at, name)).strip() for name, value in figures.items()}
            for name, tolerance in texts.items():
                reader.read((*at, name), share, tolerance)
            if not texts:
                raise reader.fail(at, f"expected {', '.join(allowed)}, e.g. {allowed[0]}: +- 10 %")
            for name, tolerance in texts.items():
                maker_tolerance = MakerTolerance(part, name, tolerance, maker, named, text, source)
                _refuse_second(reader, maker_tolerance, tolerances, (*at, name))
                tolerances.append(maker_tolerance)
    return tuple(tolerances)


def _families(reader: Reader, entry: dict[str, Any], at: Path_, known: set[str], part: str) -> tuple[str, ...]:
    """The families of an entry; none where it is of all."""
    if "families" not in entry:
        return ()
    names = [reader.part_number(name, at) for name in reader.sequence(entry["families"], at)]
    if not names:
        raise reader.fail(at, "expected families; without the field it is of all of them")
    for name in names:
        if name not in known:
            listed = f"; expected {', '.join(sorted(known))}" if known else ""
            raise reader.fail(at, f"{quoted(name)} is no family with a {part} in this file{listed}")
    return tuple(dict.fromkeys(names))


def _refuse_second(
    reader: Reader, tolerance: MakerTolerance, tolerances: Sequence[MakerTolerance], path: Path_
) -> None:
    """Refuse a second tolerance of the same figure and family, or of the same figure for all families."""
    for other in (other for other in tolerances if tolerance[:2] == other[:2]):
        common = set(tolerance.families) & set(other.families)
        if common or not (tolerance.families or other.families):
            of = f" of {min(common)}" if common else ""
            raise reader.fail(path, f"{tolerance.part} {tolerance.figure}{of} is given twice")
