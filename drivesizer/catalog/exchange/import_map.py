"""Map of a table to import: its columns, and figures that all parts have in common.

manufacturer: Anymaker
family: M 20                       # where no column gives it
source: {name: sheet, document: "data sheet, page 3", confidence: quoted, date: "2024-05", url: "https://..."}
unknown: ["-", n/a]                # further cells that mean unknown, besides an empty one and ~
common: {kind: brushed, diameter: 20 mm}
columns:
  Order no.: part
  Nominal voltage: nominal_voltage
  Remark: ~                        # not imported
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from drivesizer.catalog.parts import PARTS, columns_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.yaml_source import Path_, YamlSource, read

__all__ = ["Plan", "plan"]

_KEYS = ("manufacturer", "family", "source", "unknown", "common", "columns")
_SOURCE = ("name", "document", "confidence", "date", "url")


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Map and options combined."""

    section: str
    columns: Mapping[str, str | None]  # header in the table -> column of the catalogue, None: not imported
    manufacturer: str
    family: str
    source_name: str
    source: Mapping[str, str]  # document, confidence, date, url
    unknown: tuple[str, ...]
    common: Mapping[str, Any]


def plan(section: str, path: Path | None, options: Mapping[str, str | None]) -> Plan:
    """Plan of an import from a map file and options; an option takes precedence over the map."""
    if section not in PARTS:
        raise InputError(f"--section: {quoted(section)} is not known; expected {', '.join(PARTS)}")
    file = read(path) if path else YamlSource("{}", "")
    given = _mapping(file, file.data, (), _KEYS)
    stated = _stated(file, given, options)
    return Plan(
        section=section,
        columns=_columns(file, section, given.get("columns")),
        manufacturer=stated["manufacturer"],
        family=stated["family"],
        source_name=stated["name"] or "table",
        source={key: stated[key] for key in ("document", "date", "confidence", "url")},
        unknown=_unknown(file, given.get("unknown")),
        common=_common(file, section, given.get("common")),
    )


def _stated(file: YamlSource, given: dict[str, Any], options: Mapping[str, str | None]) -> dict[str, str]:
    """Maker, family and source, from an option where it is given, else from the map."""
    source = _mapping(file, given.get("source"), ("source",), _SOURCE)
    stated = {key: _text(file, source.get(key), ("source", key)) for key in _SOURCE}
    stated |= {key: _text(file, given.get(key), (key,)) for key in ("manufacturer", "family")}
    stated |= {key: value for key, value in options.items() if value}
    if not stated["document"]:
        raise InputError("--document: the source of the figures is missing; expected e.g. 'data sheet, 2024-05'")
    if stated["confidence"] not in CONFIDENCE:
        raise InputError(f"--confidence: {quoted(stated['confidence'])}; expected one of {', '.join(CONFIDENCE)}")
    return stated


def _mapping(file: YamlSource, value: Any, path: Path_, allowed: tuple[str, ...] = ()) -> dict[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise InputError(f"{file.where(path)}: expected fields such as {', '.join(allowed or ('Order no.: part',))}")
    for key in value if allowed else ():
        if key not in allowed:
            raise InputError(f"{file.where((*path, key))}: unknown key {quoted(key)}; expected {', '.join(allowed)}")
    return value


def _text(file: YamlSource, value: Any, path: Path_) -> str:
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"{file.where(path)}: expected text")
    return str(value)


def _columns(file: YamlSource, section: str, value: Any) -> dict[str, str | None]:
    known = columns_of(section)
    found: dict[str, str | None] = {}
    for theirs, ours in _mapping(file, value, ("columns",)).items():
        if ours is not None and (not isinstance(ours, str) or ours not in known):
            hint = nearest(str(ours), known) or f"; expected one such as {', '.join(list(known)[:4])}"
            raise InputError(f"{file.where(('columns', theirs))}: {section} have no column {quoted(ours)}{hint}")
        found[theirs] = ours
    return found


def _common(file: YamlSource, section: str, value: Any) -> dict[str, Any]:
    found = _mapping(file, value, ("common",))
    for name, given in found.items():
        path: Path_ = ("common", name)
        if name not in columns_of(section) or name in ("part", "family", "manufacturer"):
            raise InputError(f"{file.where(path)}: not a figure that parts have in common")
        if isinstance(given, dict | list | bool):
            raise InputError(f"{file.where(path)}: expected a figure with its unit, or text")
    return found


def _unknown(file: YamlSource, value: Any) -> tuple[str, ...]:
    if value is not None and not isinstance(value, list):
        raise InputError(f'{file.where(("unknown",))}: expected a list, e.g. ["-", n/a]')
    return tuple(_text(file, cell, ("unknown", place)) for place, cell in enumerate(value or []))
