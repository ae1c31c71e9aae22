"""Pull-out curves of steppers out of a catalogue file: rows are speeds and torques at a supply voltage."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog.field_reader import Reader
from drivesizer.catalog.pull_outs import NO_PULL_OUTS, PULL_OUTS, PullOuts, point_columns
from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import Path_
from drivesizer.units import scale, to_si

__all__ = ["COLUMNS", "CURVE", "read_pull_outs"]

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
        volts = _above_zero(reader, entry["voltage"], "voltage", path)
        amps = _above_zero(reader, entry["current"], "current", path) if "current" in entry else float("nan")
        driver = reader.plain_text(entry["driver"], (*path, "driver")) if "driver" in entry else ""
        rows = _points(reader, entry, path)
        points += [(steppers[part], source, number, volts, amps, *row, driver) for row in rows]
    return point_columns(points) if points else NO_PULL_OUTS


def _above_zero(reader: Reader, text: Any, kind: str, path: Path_) -> float:
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
