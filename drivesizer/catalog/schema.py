"""JSON Schema of a catalogue file: for editors, and for the reader, which knows by it what a group of fields has."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog.parts import DISCHARGES, PARTS, PULL_OUTS, RELATIONS, Column, columns_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.catalog.tolerances import CLASSES, TOLERANCES
from drivesizer.files.yaml_source import shipped_data
from drivesizer.units import KINDS, noun

# kinds of parts that go together, by the name of the list
LISTS = {relation: ("motors", right) for relation, right in RELATIONS.items()} | {
    "triples": ("motors", "gearheads", "encoders")
}
FIGURES = {part: tuple(f for p, f in CLASSES if p == part) for part in dict.fromkeys(part for part, _ in CLASSES)}
CURVE_COLUMNS = {"speed": ("rotary_speed", "rpm"), "torque": ("torque", "N*m")}  # kind and unit of the trade

_GROUPS: dict[str, Any] = shipped_data("drivesizer.catalog", "schema.yaml")
SCHEMA = _GROUPS["file"]["properties"]["catalog"]["const"]  # its number
_GROUPS["confidence"]["enum"][:] = CONFIDENCE  # which several groups share
SOURCE, NOTE, DISCHARGE, PULL_OUT, PRICES = (
    _GROUPS[name] for name in ("source", "note", "discharge", "pull_out", "prices")
)


def _list(items: Any) -> dict[str, Any]:
    return {"type": "array", "items": items}


def _with(group: dict[str, Any], **more: Any) -> dict[str, Any]:
    """A group of fields with further ones."""
    return group | {"properties": group["properties"] | more}


_SHARES = {
    part: {"type": "object", "properties": dict.fromkeys(names, _GROUPS["share"]), "additionalProperties": False,
           "minProperties": 1} for part, names in FIGURES.items()
}  # fmt: skip
TOLERANCE = {"type": "object", "anyOf": [{"required": [part]} for part in FIGURES]}
TOLERANCE |= _with(_GROUPS["tolerance"], **_SHARES, text=_GROUPS["words"])


def table(section: str) -> dict[str, Any]:
    """One table of a section: a family's or a part of it."""
    group, columns = _GROUPS["table"], columns_of(section)
    common, heads = group["properties"]["common"], group["properties"]["columns"]
    inside = ("part", "family", "manufacturer", "inside")
    figures = {name: _figure(column) for name, column in columns.items() if name not in inside}
    listed = "; ".join(column.head for column in columns.values())
    return _with(
        group, common=common | {"properties": figures},
        columns=heads | {"description": f"names of columns with their units: {listed}",
                         "items": {"type": "string", "pattern": rf"^({'|'.join(columns)})( *\(.+\))?$"}},
    )  # fmt: skip


def _figure(column: Column) -> dict[str, Any]:
    if column.kind == "text":
        return _GROUPS["text"]
    if column.kind in ("ratio", "dimensionless"):
        return {"type": ["number", "string", "null"]}
    return {"type": ["string", "null"], "description": f"{noun(column.kind)}, e.g. {KINDS[column.kind].example}"}


def group(relation: str) -> dict[str, Any]:
    """Parts that go together, by family or part number; `direct` is no gearhead."""
    parts, names = LISTS[relation], _GROUPS["names"]
    fitting = _list({"anyOf": [names["items"], _GROUPS["across"]]})
    fields = {"name": _GROUPS["text"], "source": _GROUPS["words"], "without": names, **dict.fromkeys(parts, fitting)}
    return {"type": "object", "properties": fields, "required": ["source", *parts], "additionalProperties": False}


TOP = _with(
    _GROUPS["file"],
    sources={"type": "object", "additionalProperties": SOURCE, "minProperties": 1},
    **{section: _list(table(section)) for section in PARTS},
    prices=_list(PRICES),
    **{DISCHARGES: _list(DISCHARGE), PULL_OUTS: _list(PULL_OUT), TOLERANCES: _list(TOLERANCE)},
    compatibility={"type": "object", "properties": {name: _list(group(name)) for name in LISTS},
                   "additionalProperties": False},
)  # fmt: skip


def catalog_schema() -> dict[str, Any]:
    """The JSON Schema of a catalogue file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "drivesizer catalogue", **TOP}
