"""The JSON Schemas of documents, made from the records that these are of: types, and the comments beside fields."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Mapping
from dataclasses import is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from drivesizer.catalog import PARTS, columns_of
from drivesizer.control.path_following import Extreme
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output.json.documents import SCHEMA, Report, ReportedAxis, added_keys, keys
from drivesizer.output.platform import PlatformNumbers
from drivesizer.results.check import sentence_case
from drivesizer.results.machine import MachineSizing
from drivesizer.units import KINDS

_PLAIN: dict[Any, dict[str, Any]] = {
    float: {"type": ["number", "null"]}, int: {"type": "integer"}, bool: {"type": "boolean"}, str: {"type": "string"},
    NoneType: {"type": "null"}, Any: {}, complex: {"type": "array", "items": {"type": "number"}, "maxItems": 2},
    np.ndarray: {"type": "array"},
}  # fmt: skip
_NAMES = {
    "PlatformNumbers": PlatformNumbers, "Extreme": Extreme, "PermittedSpeeds": PermittedSpeeds,
}  # fmt: skip
_FIELD = re.compile(r"^    (\w+): [^#\n]*(?:  # (.*))?$", re.M)  # of a record, with the comment beside it
Definitions = dict[str, dict[str, Any]]


def report_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer report -o report.json``, and of ``drivesizer size --json``, which has less."""
    defs: Definitions = {}
    document = document_schema("drivesizer report", properties(MachineSizing, defs), defs)
    document["properties"] |= properties(Report, defs)
    defs["AxisSizing"]["properties"] |= properties(ReportedAxis, defs)
    return document


def record_schema(record: type) -> dict[str, Any]:
    """The JSON Schema of a document that is one record, as of ``drivesizer predict --json``."""
    defs: Definitions = {}
    return document_schema(f"drivesizer {record.__name__.lower()}", properties(record, defs), defs)


def document_schema(title: str, of: dict[str, Any], defs: Definitions) -> dict[str, Any]:
    """The schema of a document: its head, and the keys behind it."""
    head = {"schema": {"const": SCHEMA}, "drivesizer": {"type": "string"}}
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title}
    return dialect | _object(head | of) | {"$defs": defs}


def array_of(name: str, of: dict[str, Any], defs: Definitions) -> dict[str, Any]:
    """The schema of several records of these keys, which is put among the definitions."""
    defs[name] = _object(of)
    return {"type": "array", "items": {"$ref": f"#/$defs/{name}"}}


def _object(of: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": of, "required": [*of], "additionalProperties": False}


def properties(record: type, defs: Definitions) -> dict[str, Any]:
    """The keys of a record, each with its type and what it is; the records in it are put among the definitions."""
    own = added_keys(record)
    section = next((name for name, part in PARTS.items() if part is record), None)
    columns = columns_of(section) if section else {}
    types, remarks = get_type_hints(record, localns=_NAMES), _comments(record)
    remarks |= {name: column.remark for name, column in columns.items()}
    schemas = {}
    for key in keys(record):
        kind = get_type_hints(own[key], localns=_NAMES)["return"] if key in own else types[key]
        text = sentence_case((inspect.getdoc(own[key]) or "").rstrip(".")) if key in own else remarks.get(key, "")
        if key in columns and columns[key].kind in KINDS:
            text = KINDS[columns[key].kind].si
        if key == "unit" and "kind" in types:
            text = "SI"
        text = re.sub(r"\b(NaN|None)\b", "null", text)
        figures = {"type": ["number", "array", "null"]}  # one, or a column of them
        schemas[key] = (figures if kind is Any else _schema(kind, defs)) | ({"description": text} if text else {})
    return schemas


def _comments(record: type) -> dict[str, str]:
    """The comment beside each field of a record, those of its bases included."""
    remarks: dict[str, str] = {}
    for base in record.__mro__[::-1]:
        if is_dataclass(base) or hasattr(base, "_fields"):
            source = inspect.getsource(sys.modules[base.__module__])
            body = re.search(rf"^class {base.__name__}\b.*?(?=^\S|\Z)", source, re.M | re.S)
            comments = _FIELD.findall(body[0]) if body else []
            remarks |= {name: remark for name, remark in comments if remark}
    return remarks


def _schema(kind: Any, defs: Definitions) -> dict[str, Any]:
    """The schema of a type; a record is under its name among the definitions."""
    origin, inner = get_origin(kind), get_args(kind)
    if kind in _PLAIN:
        return _PLAIN[kind]
    if isinstance(kind, TypeVar):  # one figure, or one for each of several
        return {}
    if origin is Literal:
        return {"enum": [*inner]}
    if origin in (Union, UnionType):
        return {"anyOf": [_schema(member, defs) for member in inner]}
    if origin is np.ndarray:
        return {"type": "array"}
    if origin is tuple and Ellipsis not in inner:
        return {"type": "array", "prefixItems": [_schema(member, defs) for member in inner], "maxItems": len(inner)}
    if origin in (tuple, list):
        return {"type": "array", "items": _schema(inner[0], defs)}
    if origin in (dict, Mapping):
        return {"type": "object", "additionalProperties": _schema(inner[1], defs)}
    if kind.__name__ not in defs:
        defs[kind.__name__] = {}  # a record may be within itself
        defs[kind.__name__] |= _object(properties(kind, defs))
    return {"$ref": f"#/$defs/{kind.__name__}"}
