"""Discharge tables out of a catalogue file, as makers print them: rows are end voltages, columns times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drivesizer.catalog.discharges import DISCHARGES, HELD, INTEGERS, NO_DISCHARGES, TABLE, Discharges
from drivesizer.catalog.field_reader import Reader
from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import Path_
from drivesizer.units import scale, to_si

__all__ = ["read_discharges"]


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
