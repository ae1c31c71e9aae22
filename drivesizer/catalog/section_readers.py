"""Readers of a catalogue file's sections: fields, discharge tables, pull-out curves, tolerances of makers."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence, Set
from typing import Any

import numpy as np

from drivesizer.catalog.more_parts import (
    DISCHARGES,
    HELD,
    INTEGERS,
    NO_DISCHARGES,
    NO_PULL_OUTS,
    PULL_OUTS,
    TABLE,
    Discharges,
    PullOuts,
    point_columns,
)
from drivesizer.catalog.tables import Note, Source
from drivesizer.catalog.tolerances import CLASSES, TOLERANCES, MakerTolerance, share
from drivesizer.errors import CatalogError, InputError, quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.units import scale, to_si

__all__ = [
    "COLUMNS", "CURVE", "FIGURES", "Reader", "did_you_mean", "read_discharges", "read_maker_tolerances",
    "read_pull_outs",
]  # fmt: skip


# -- One catalogue file while it is read: places of fields, and the checks that all its sections share.


class Reader:
    """A catalogue file with its sources and notes; errors name file, line and field."""

    def __init__(self, source: YamlSource) -> None:
        self.file = source
        self.sources: dict[str, Source] = {}
        self.notes: list[Note] = []

    def fail(self, path: Path_, message: str) -> CatalogError:
        """The error at a place of the file."""
        return CatalogError(f"{self.file.where(path)}: {message}")

    def mapping(self, value: Any, path: Path_, allowed: Iterable[str], required: Iterable[str] = ()) -> dict[str, Any]:
        """A mapping with no other keys than those allowed, and all that are required."""
        if not isinstance(value, dict):
            raise self.fail(path, f"expected fields such as {', '.join(sorted(required) or sorted(allowed)[:3])}")
        for key in value:
            if key not in allowed:
                raise self.fail((*path, key), f"unknown key {quoted(key)}{did_you_mean(key, allowed)}")
        for key in sorted(required):
            if key not in value:
                raise self.fail(path, f"{quoted(key)} is missing")
        return value

    def sequence(self, value: Any, path: Path_) -> list[Any]:
        """A list."""
        if not isinstance(value, list):
            raise self.fail(path, "expected a list")
        return value

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


def did_you_mean(key: str, allowed: Iterable[str]) -> str:
    """Hint for an unknown word: the nearest allowed one, or all of them."""
    close = difflib.get_close_matches(key, sorted(allowed), 1)
    return f"; did you mean {quoted(close[0])}?" if close else f"; expected one of {', '.join(sorted(allowed))}"


# -- Discharge tables out of a catalogue file, as makers print them: rows are end voltages, columns times.


def read_discharges(reader: Reader, given: Any, batteries: dict[str, int]) -> Discharges:
    """The tables of a catalogue file."""
    seen: dict[tuple[float, ...], Path_] = {}
    found = [NO_DISCHARGES]
    for index, entry in enumerate(reader.sequence(given or [], (DISCHARGES,))):
        path: Path_ = (DISCHARGES, index)
        found.append(_table(reader, reader.mapping(entry, path, TABLE, set(TABLE) - {"cells"}), path, batteries, seen))
    return Discharges(*(np.concatenate(columns) for columns in zip(*found, strict=True)))


def _table(
    reader: Reader, entry: dict[str, Any], path: Path_, batteries: dict[str, int], seen: dict[tuple[float, ...], Path_]
) -> Discharges:
    part = reader.part_number(entry["battery"], (*path, "battery"))
    if part not in batteries:
        raise reader.fail((*path, "battery"), f"{quoted(part)} is not a battery of this file")
    source = reader.source_number(entry["source"], (*path, "source"))
    held, factor = _stored_quantity(reader, entry["held"], (*path, "held"))
    cells = _cells(reader, entry.get("cells", 1), (*path, "cells"))
    volts, times = _head(reader, entry["columns"], (*path, "columns"))
    factor *= cells if held == "power" else 1.0  # the cells of a block carry the same current
    rows: list[tuple[float, ...]] = []
    for number, row in enumerate(reader.sequence(entry["rows"], (*path, "rows"))):
        at: Path_ = (*path, "rows", number)
        if not isinstance(row, list) or len(row) != len(times) + 1:
            have = len(row) if isinstance(row, list) else 0
            raise reader.fail(at, f"expected {len(times) + 1} cells as in `columns`, found {have}")
        cutoff = _above_zero(reader, row[0], (*at, 0)) * volts * cells
        for place, time in enumerate(times, 1):
            if row[place] is not None:
                draw = _above_zero(reader, row[place], (*at, place)) * factor
                _once(reader, (batteries[part], float(held == "power"), cutoff, time), (*at, place), seen)
                pair = (draw, np.nan) if held == "current" else (np.nan, draw)
                rows.append((batteries[part], source, cutoff, time, *pair))
    return _columns(rows)


def _columns(rows: Sequence[tuple[float, ...]]) -> Discharges:
    columns = np.array(rows, float).reshape(-1, len(Discharges._fields)).T
    named = zip(Discharges._fields, columns, strict=True)
    typed: Any = (column.astype(np.int32) if name in INTEGERS else column for name, column in named)
    return Discharges(*typed)


def _stored_quantity(reader: Reader, text: Any, path: Path_) -> tuple[str, float]:
    """Quantity that is held, and the factor of its unit: ``current (A)``."""
    name, _, unit = str(text).rstrip(") ").partition("(")
    name = name.strip()
    if name not in HELD or not unit:
        raise reader.fail(path, f"{quoted(text)} is not known; expected current (A) or power (W)")
    try:
        return name, scale(unit, name)[0]
    except InputError as error:
        raise reader.fail(path, str(error)) from None


def _cells(reader: Reader, value: Any, path: Path_) -> int:
    """Of how many cells in series voltage and power are printed for one."""
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise reader.fail(path, f"{quoted(value)} is not a number of cells in series")
    return value


def _head(reader: Reader, given: Any, path: Path_) -> tuple[float, list[float]]:
    """Factor of the end voltages' unit, and the times [s]: ``[cutoff_voltage (V), 5 min, 1 h]``."""
    first, *others = [str(text) for text in reader.sequence(given, path)] or [""]
    name, _, unit = first.rstrip(") ").partition("(")
    if name.strip() != "cutoff_voltage" or not unit or not others:
        raise reader.fail(path, "expected cutoff_voltage (V) and then times, e.g. [cutoff_voltage (V), 30 min, 1 h]")
    times = []
    for place, text in enumerate(others, 1):
        try:
            times.append(to_si(text, "time"))
        except InputError as error:
            raise reader.fail((*path, place), str(error)) from None
        if not times[-1] > 0.0:
            raise reader.fail((*path, place), f"{quoted(text)} is not above 0 s")
    try:
        return scale(unit, "voltage")[0], times
    except InputError as error:
        raise reader.fail((*path, 0), str(error)) from None


def _above_zero(reader: Reader, cell: Any, path: Path_) -> float:
    if isinstance(cell, bool) or not isinstance(cell, int | float) or not cell > 0:
        raise reader.fail(path, f"{quoted(cell)} is not a number above 0; unknown is written ~")
    return float(cell)


def _once(reader: Reader, key: tuple[float, ...], path: Path_, seen: dict[tuple[float, ...], Path_]) -> None:
    if seen.setdefault(key, path) is not path:
        raise reader.fail(path, "this end voltage and time are given twice for the battery")


# -- Pull-out curves of steppers out of a catalogue file: rows are speeds and torques at a supply voltage.


CURVE = ("stepper", "source", "voltage", "current", "driver", "columns", "rows")
COLUMNS = {"speed": ("rotary_speed", "rpm"), "torque": ("torque", "N*m")}  # of a row, with kind and unit of the trade
_OPTIONAL = {"current", "driver"}


def read_pull_outs(reader: Reader, given: Any, steppers: dict[str, int]) -> PullOuts:
    """The curves of a catalogue file."""
    points: list[tuple[Any, ...]] = []
    for number, entry in enumerate(reader.sequence(given or [], (PULL_OUTS,))):
        path: Path_ = (PULL_OUTS, number)
        entry = reader.mapping(entry, path, CURVE, set(CURVE) - _OPTIONAL)
        part = reader.part_number(entry["stepper"], (*path, "stepper"))
        if part not in steppers:
            raise reader.fail((*path, "stepper"), f"{quoted(part)} is not a stepper of this file")
        source = reader.source_number(entry["source"], (*path, "source"))
        volts = _head_above_zero(reader, entry["voltage"], "voltage", path)
        amps = _head_above_zero(reader, entry["current"], "current", path) if "current" in entry else float("nan")
        driver = reader.plain_text(entry["driver"], (*path, "driver")) if "driver" in entry else ""
        rows = _points(reader, entry, path)
        points += [(steppers[part], source, number, volts, amps, *row, driver) for row in rows]
    return point_columns(points) if points else NO_PULL_OUTS


def _head_above_zero(reader: Reader, text: Any, kind: str, path: Path_) -> float:
    """A figure of the curve's head with its unit."""
    try:
        value = to_si(str(text), kind)
    except InputError as error:
        raise reader.fail((*path, kind), str(error)) from None
    if not value > 0.0:
        raise reader.fail((*path, kind), f"{quoted(text)} is not above 0")
    return value


def _points(reader: Reader, entry: dict[str, Any], path: Path_) -> list[tuple[float, float]]:
    """Speed [rad/s] and torque [N*m] of each row."""
    factors = _factors(reader, entry["columns"], (*path, "columns"))
    found: list[tuple[float, float]] = []
    for number, row in enumerate(reader.sequence(entry["rows"], (*path, "rows"))):
        at: Path_ = (*path, "rows", number)
        numbers = isinstance(row, list) and all(isinstance(c, int | float) and not isinstance(c, bool) for c in row)
        if not numbers or len(row) != len(factors) or min(row) < 0:
            raise reader.fail(at, f"{quoted(row)} is not a speed and a torque of 0 or more, e.g. [300, 0.41]")
        speed, torque = (float(cell) * factor for cell, factor in zip(row, factors, strict=True))
        if found and not speed > found[-1][0]:
            raise reader.fail(at, f"speed {row[0]:g} is not above that of the row before; expected rising speeds")
        found.append((speed, torque))
    if len(found) < 2:
        raise reader.fail((*path, "rows"), f"found {len(found)} points; expected at least 2")
    return found


def _factors(reader: Reader, given: Any, path: Path_) -> list[float]:
    """Factors of the units in ``[speed (rpm), torque (N*m)]``."""
    heads = [str(text) for text in reader.sequence(given, path)]
    named = [text.rstrip(") ").partition("(") for text in heads]
    if [name.strip() for name, _, _ in named] != list(COLUMNS):
        raise reader.fail(path, f"{quoted(given)} is not known; expected [speed (rpm), torque (N*m)]")
    try:
        return [scale(unit, kind)[0] for (_, _, unit), (kind, _) in zip(named, COLUMNS.values(), strict=True)]
    except InputError as error:
        raise reader.fail(path, str(error)) from None


# -- Reader of the tolerances that a maker states in a catalogue file, in the notation of a spec.


FIGURES = {part: tuple(f for p, f in CLASSES if p == part) for part in dict.fromkeys(part for part, _ in CLASSES)}
ENTRY = ("source", "families", *FIGURES, "text")


def read_maker_tolerances(
    reader: Reader, given: Any, maker: str, families: Mapping[str, Set[str]]
) -> tuple[MakerTolerance, ...]:
    """Tolerances stated in a catalogue file."""
    found: list[MakerTolerance] = []
    for index, entry in enumerate(reader.sequence(given or [], (TOLERANCES,))):
        path: Path_ = (TOLERANCES, index)
        entry = reader.mapping(entry, path, ENTRY, {"source"})
        parts = [part for part in FIGURES if part in entry]
        if not parts:
            raise reader.fail(path, f"expected {' or '.join(FIGURES)}, e.g. motor: {{resistance: +- 10 %}}")
        source = reader.source_number(entry["source"], (*path, "source"))
        text = reader.plain_text(entry.get("text"), (*path, "text"))
        for part in parts:
            named = _families(reader, entry, path, families[part], part)
            for figure, tolerance in _figures(reader, entry[part], (*path, part), FIGURES[part]).items():
                one = MakerTolerance(part, figure, tolerance, maker, named, text, source)
                _tolerance_once(reader, one, found, (*path, part, figure))
                found.append(one)
    return tuple(found)


def _families(reader: Reader, entry: dict[str, Any], path: Path_, known: Set[str], part: str) -> tuple[str, ...]:
    """The families of an entry; none where it is of all."""
    at: Path_ = (*path, "families")
    if "families" not in entry:
        return ()
    names = tuple(reader.part_number(name, at) for name in reader.sequence(entry["families"], at))
    if not names:
        raise reader.fail(at, "expected families; without the field it is of all of them")
    for name in names:
        if name not in known:
            listed = f"; expected {', '.join(sorted(known))}" if known else ""
            raise reader.fail(at, f"{quoted(name)} is no family with a {part} in this file{listed}")
    return tuple(dict.fromkeys(names))


def _figures(reader: Reader, given: Any, path: Path_, allowed: tuple[str, ...]) -> dict[str, str]:
    """The tolerances of an entry, each readable."""
    found = {}
    for figure, value in reader.mapping(given, path, allowed).items():
        text = reader.plain_text(value, (*path, figure)).strip()
        try:
            share(text)
        except InputError as error:
            raise reader.fail((*path, figure), str(error)) from None
        found[figure] = text
    if not found:
        raise reader.fail(path, f"expected {', '.join(allowed)}, e.g. {allowed[0]}: +- 10 %")
    return found


def _tolerance_once(reader: Reader, one: MakerTolerance, found: list[MakerTolerance], path: Path_) -> None:
    """Refuse a second tolerance of the same figure and family, or of the same figure for all families."""
    for other in found:
        same = set(one.families) & set(other.families) or (not one.families and not other.families)
        if one[:2] == other[:2] and same:
            of = f" of {min(set(one.families) & set(other.families))}" if one.families else ""
            raise reader.fail(path, f"{one.part} {one.figure}{of} is given twice")
