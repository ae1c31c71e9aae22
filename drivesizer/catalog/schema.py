"""JSON Schema of a catalogue file: for editors, and for the reader, which knows by it what a group of fields has."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from drivesizer.catalog.parts import DATA, DISCHARGES, HELD, PARTS, PULL_OUTS, RELATIONS, Column, columns_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.catalog.tolerances import CLASSES, TOLERANCES
from drivesizer.units import KINDS, noun

SCHEMA = 1  # its number
# kinds of parts that go together, by the name of the list
LISTS = {relation: ("motors", right) for relation, right in RELATIONS.items()} | {
    "triples": ("motors", "gearheads", "encoders")
}
FIGURES = {part: tuple(f for p, f in CLASSES if p == part) for part in dict.fromkeys(part for part, _ in CLASSES)}
CURVE_COLUMNS = {"speed": ("rotary_speed", "rpm"), "torque": ("torque", "N*m")}  # kind and unit of the trade

_TEXT: dict[str, Any] = {"type": ["string", "number", "null"]}
_WORDS: dict[str, Any] = {"type": "string"}
_CONFIDENCE: dict[str, Any] = {"enum": list(CONFIDENCE)}
_NAMES: dict[str, Any] = {"type": "array", "items": {"type": ["string", "integer"]}}
_ORIGIN = _WORDS | {"description": "one of `sources`"}


def _fields(properties: dict[str, Any], required: Iterable[str], **more: Any) -> dict[str, Any]:
    """A group of fields, no others allowed."""
    return {"type": "object", **more, "properties": properties, "required": list(required),
            "additionalProperties": False}  # fmt: skip


def _list(items: Any, **more: Any) -> dict[str, Any]:
    return {"type": "array", **more, "items": items}


SOURCE = _fields(
    {"document": _WORDS, "confidence": _CONFIDENCE, "date": _TEXT, "url": _TEXT}, ("document", "confidence"),
    description="a document that figures come from",
)  # fmt: skip
NOTE = _fields(
    {"text": _WORDS, "parts": _NAMES | {"description": "all of the table where not given"},
     "fields": _NAMES | {"description": "the whole row where not given"}, "confidence": _CONFIDENCE,
     "source": _WORDS, "exclude": {"type": "boolean", "description": "leave these parts out of the search"},
     "accepted": {"type": "boolean", "description": "findings of `catalog check` on these fields are accepted"},
     "rule": {"type": "boolean", "description": "these figures are a rule of thumb and no maker's limits"}},
    ("text",),
)  # fmt: skip
DISCHARGE = _fields(  # of a battery: end voltages down, times across
    {"battery": _TEXT | {"description": "a part number of this file"}, "source": _ORIGIN,
     "held": _WORDS | {"description": f"held constant: {' or '.join(f'{n} ({unit})' for n, unit in HELD.items())}",
                       "pattern": rf"^({'|'.join(HELD)})( *\(.+\))?$"},
     "cells": {"type": "integer", "minimum": 1, "description": "voltage and power are those of one in so many"},
     "columns": _list(_WORDS, minItems=2) | {"description": "cutoff_voltage (V), then times such as 30 min"},
     "rows": _list(_list({"type": ["number", "null"], "exclusiveMinimum": 0}))},
    ("battery", "source", "held", "columns", "rows"),
)  # fmt: skip
PULL_OUT = _fields(  # of a stepper: speed and torque of each row
    {"stepper": _TEXT | {"description": "a part number of this file"}, "source": _ORIGIN,
     "voltage": _WORDS | {"description": "of the driver's supply, e.g. 24 V"},
     "current": _WORDS | {"description": "amplitude of a phase's current, e.g. 2.2 A"},
     "driver": _WORDS | {"description": "with which it was measured"},
     "columns": _list(_WORDS, description=", ".join(f"{n} ({unit})" for n, (_, unit) in CURVE_COLUMNS.items())),
     "rows": _list(_list({"type": "number", "minimum": 0}, minItems=2, maxItems=2))},
    ("stepper", "source", "voltage", "columns", "rows"),
)  # fmt: skip
_PRICE: dict[str, Any] = {
    "part": "its number, of any catalogue", "price": "of one piece", "currency": "such as USD",
    "pieces": "from so many on", "date": "", "seller": "", "order_number": "by which the seller knows it",
    "delivery": "such as 3 weeks", "manufacturer": "where several makers have such a part", "note": "",
}  # fmt: skip
PRICES = _fields(  # of parts of any catalogue
    {"source": _ORIGIN, "common": _fields({name: _TEXT | {"description": said} for name, said in _PRICE.items()}, ()),
     "columns": _list({"enum": list(_PRICE)}), "rows": _list(_list(_TEXT))},
    ("source", "columns", "rows"),
)  # fmt: skip
_SHARE = _WORDS | {"description": "of the printed figure: +- 10 %, -10 %..30 %, normal(5 %) or none"}
TOLERANCE = _fields(
    {"source": _ORIGIN,
     "families": _NAMES | {"minItems": 1, "description": "to which it applies; all of the maker's if left out"},
     **{part: {"type": "object", "properties": dict.fromkeys(names, _SHARE), "additionalProperties": False,
               "minProperties": 1} for part, names in FIGURES.items()},
     "text": _WORDS},
    ("source",), anyOf=[{"required": [part]} for part in FIGURES],
)  # fmt: skip


def table(section: str) -> dict[str, Any]:
    """One table of a section: a family's or a part of it."""
    columns = columns_of(section)
    inside = ("part", "family", "manufacturer", "inside")
    heads = (name if c.kind in ("text", "ratio") or c.unit == "1" else f"{name} ({c.unit})"
             for name, c in columns.items())  # fmt: skip
    return _fields(
        {"family": _TEXT, "source": _ORIGIN,
         "common": {"type": "object", "description": "figures that all rows share, each with its unit",
                    "properties": {name: _figure(c) for name, c in columns.items() if name not in inside},
                    "additionalProperties": False},
         "columns": _list({"type": "string", "pattern": rf"^({'|'.join(columns)})( *\(.+\))?$"},
                          description="names of columns with their units: " + "; ".join(heads))
         | {"contains": {"const": "part"}},
         "rows": _list(_list(_TEXT)), "notes": _list(NOTE)},
        ("family", "source", "columns", "rows"),
    )  # fmt: skip


def _figure(column: Column) -> dict[str, Any]:
    if column.kind == "text":
        return _TEXT
    if column.kind in ("ratio", "dimensionless"):
        return {"type": ["number", "string", "null"]}
    return {"type": ["string", "null"], "description": f"{noun(column.kind)}, e.g. {KINDS[column.kind].example}"}


def group(relation: str) -> dict[str, Any]:
    """Parts that go together, by family or part number; `direct` is no gearhead."""
    across = {"type": "object", "minProperties": 1, "maxProperties": 1, "description": "{catalogue: family or part}"}
    fitting, parts = _list({"anyOf": [_NAMES["items"], across]}), LISTS[relation]
    names = {"name": _TEXT, "source": _WORDS, "without": _NAMES, **dict.fromkeys(parts, fitting)}
    return _fields(names, ("source", *parts))


TOP = _fields(
    {
        "catalog": {"const": SCHEMA, "description": "number of this schema"},
        "manufacturer": _WORDS,
        "overrides": {"type": "boolean", "description": "its parts count before those of catalogues named before"},
        DATA: _WORDS
        | {"description": "at which figures of motors and actuators hold, e.g. 22 degC; else 25 degC is assumed"},
        "sources": {"type": "object", "additionalProperties": SOURCE, "minProperties": 1},
        **{section: _list(table(section)) for section in PARTS},
        "prices": _list(PRICES),
        DISCHARGES: _list(DISCHARGE),
        PULL_OUTS: _list(PULL_OUT),
        TOLERANCES: _list(TOLERANCE),
        "compatibility": {
            "type": "object",
            "properties": {name: _list(group(name)) for name in LISTS},
            "additionalProperties": False,
        },
    },
    ("catalog", "manufacturer", "sources"),
)


def catalog_schema() -> dict[str, Any]:
    """The JSON Schema of a catalogue file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "drivesizer catalogue", **TOP}
