"""JSON Schema of a catalogue file for editors, from the same columns as its reader."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog.more_parts import DATA, DISCHARGES, HELD, PULL_OUTS, TABLE, Column
from drivesizer.catalog.parts import PARTS, RELATIONS, columns_of
from drivesizer.catalog.section_readers import COLUMNS, CURVE, FIGURES
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.catalog.tolerances import TOLERANCES
from drivesizer.units import KINDS, noun

__all__ = ["catalog_schema"]

_TEXT: dict[str, Any] = {"type": ["string", "number", "null"]}
_CONFIDENCE = {"enum": list(CONFIDENCE)}
_NAMES = {"type": "array", "items": {"type": ["string", "integer"]}}
_ACROSS = {"type": "object", "minProperties": 1, "maxProperties": 1, "description": "{catalogue: family or part}"}
_FITTING = {"type": "array", "items": {"anyOf": [_NAMES["items"], _ACROSS]}}
_NOT_COMMON = ("part", "family", "manufacturer", "inside")
_SOURCE = {
    "type": "object",
    "description": "a document that figures come from",
    "properties": {"document": {"type": "string"}, "confidence": _CONFIDENCE, "date": _TEXT, "url": _TEXT},
    "required": ["document", "confidence"],
    "additionalProperties": False,
}
_NOTE = {
    "type": "object",
    "properties": {"text": {"type": "string"}, "parts": _NAMES | {"description": "all of the table where not given"},
     "fields": _NAMES | {"description": "the whole row where not given"}, "confidence": _CONFIDENCE,
     "source": {"type": "string"}, "exclude": {"type": "boolean", "description": "leave these parts out of the search"},
     "accepted": {"type": "boolean", "description": "findings of `catalog check` on these fields are accepted"},
     "rule": {"type": "boolean", "description": "these figures are a rule of thumb and no maker's limits"}},
    "required": ["text"],
    "additionalProperties": False,
}  # fmt: skip


def catalog_schema() -> dict[str, Any]:
    """The JSON Schema of a catalogue file."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drivesizer catalogue",
        "type": "object",
        "properties": {
            "catalog": {"const": 1, "description": "number of this schema"},
            "manufacturer": {"type": "string"},
            "overrides": {"type": "boolean", "description": "its parts count before those of catalogues named before"},
            DATA: {
                "type": "string",
                "description": "at which figures of motors and actuators hold, e.g. 22 degC; else 25 degC is assumed",
            },
            "sources": {"type": "object", "additionalProperties": _SOURCE, "minProperties": 1},
            **{section: _tables(section) for section in PARTS},
            DISCHARGES: _discharges(),
            PULL_OUTS: _pull_outs(),
            TOLERANCES: _tolerances(),
            "compatibility": _compatibility(),
        },
        "required": ["catalog", "manufacturer", "sources"],
        "additionalProperties": False,
    }


def _tables(section: str) -> dict[str, Any]:
    """The tables of a section, each a family's or a part of it."""
    columns = columns_of(section).values()
    table = {
        "type": "object",
        "properties": {
            "family": _TEXT,
            "source": {"type": "string", "description": "one of `sources`"},
            "common": {
                "type": "object",
                "description": "figures that all rows share, each with its unit",
                "properties": {c.name: _figure(c) for c in columns if c.name not in _NOT_COMMON},
                "additionalProperties": False,
            },
            "columns": {
                "type": "array",
                "description": "names of columns with their units: " + "; ".join(_header(c) for c in columns),
                "items": {"type": "string", "pattern": _pattern([c.name for c in columns])},
                "contains": {"const": "part"},
            },
            "rows": {"type": "array", "items": {"type": "array", "items": _TEXT}},
            "notes": {"type": "array", "items": _NOTE},
        },
        "required": ["family", "source", "columns", "rows"],
        "additionalProperties": False,
    }
    return {"type": "array", "items": table}


def _figure(column: Column) -> dict[str, Any]:
    if column.kind == "text":
        return _TEXT
    if column.kind in ("ratio", "dimensionless"):
        return {"type": ["number", "string", "null"]}
    return {"type": ["string", "null"], "description": f"{noun(column.kind)}, e.g. {KINDS[column.kind].example}"}


def _header(column: Column) -> str:
    return column.name if column.kind in ("text", "ratio") or column.unit == "1" else f"{column.name} ({column.unit})"


def _pattern(names: list[str]) -> str:
    return rf"^({'|'.join(names)})( *\(.+\))?$"


def _discharges() -> dict[str, Any]:
    """Discharge tables of batteries: end voltages down, times across."""
    cell = {"type": ["number", "null"], "exclusiveMinimum": 0}
    columns = {"type": "array", "items": {"type": "string"}, "minItems": 2}
    named = " or ".join(f"{name} ({unit})" for name, unit in HELD.items())
    table = {
        "type": "object",
        "properties": {
            "battery": _TEXT | {"description": "a part number of this file"},
            "source": {"type": "string", "description": "one of `sources`"},
            "held": {"type": "string", "description": f"held constant: {named}", "pattern": _pattern(list(HELD))},
            "cells": {"type": "integer", "minimum": 1, "description": "voltage and power are those of one in so many"},
            "columns": columns | {"description": "cutoff_voltage (V), then times such as 30 min"},
            "rows": {"type": "array", "items": {"type": "array", "items": cell}},
        },
        "required": [name for name in TABLE if name != "cells"],
        "additionalProperties": False,
    }
    return {"type": "array", "items": table}


def _pull_outs() -> dict[str, Any]:
    """Pull-out curves of steppers: speed and torque of each row."""
    heads = ", ".join(f"{name} ({unit})" for name, (_, unit) in COLUMNS.items())
    cell = {"type": "number", "minimum": 0}
    curve = {
        "type": "object",
        "properties": {
            "stepper": _TEXT | {"description": "a part number of this file"},
            "source": {"type": "string", "description": "one of `sources`"},
            "voltage": {"type": "string", "description": "of the driver's supply, e.g. 24 V"},
            "current": {"type": "string", "description": "amplitude of a phase's current, e.g. 2.2 A"},
            "driver": {"type": "string", "description": "with which it was measured"},
            "columns": {"type": "array", "items": {"type": "string"}, "description": heads},
            "rows": {"type": "array", "items": {"type": "array", "items": cell, "minItems": 2, "maxItems": 2}},
        },
        "required": [name for name in CURVE if name not in ("current", "driver")],
        "additionalProperties": False,
    }
    return {"type": "array", "items": curve}


def _tolerances() -> dict[str, Any]:
    """Tolerances that the maker states for its figures."""
    share = {"type": "string", "description": "of the printed figure: +- 10 %, -10 %..30 %, normal(5 %) or none"}
    figures = {
        part: {
            "type": "object",
            "properties": dict.fromkeys(names, share),
            "additionalProperties": False,
            "minProperties": 1,
        }
        for part, names in FIGURES.items()
    }
    entry = {
        "type": "object",
        "properties": {
            "source": {"type": "string", "description": "one of `sources`"},
            "families": _NAMES | {"minItems": 1, "description": "to which it applies; all of the maker's if left out"},
            **figures,
            "text": {"type": "string"},
        },
        "required": ["source"],
        "anyOf": [{"required": [part]} for part in figures],
        "additionalProperties": False,
    }
    return {"type": "array", "items": entry}


def _compatibility() -> dict[str, Any]:
    """Parts that go together, by family or part number; `direct` is no gearhead."""
    sections: dict[str, tuple[str, ...]] = {name: ("motors", right) for name, right in RELATIONS.items()}
    sections["triples"] = ("motors", "gearheads", "encoders")
    return {
        "type": "object",
        "properties": {name: {"type": "array", "items": _group(parts)} for name, parts in sections.items()},
        "additionalProperties": False,
    }


def _group(parts: tuple[str, ...]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {
            "name": _TEXT,
            "source": {"type": "string"},
            "without": _NAMES,
            **dict.fromkeys(parts, _FITTING),
        },
        "required": ["source", *parts],
        "additionalProperties": False,
    }
