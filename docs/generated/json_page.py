"""Tables of the JSON documents' records, out of their schemas."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

from drivesizer.catalog import PARTS
from drivesizer.output.export.machine import export_schema
from drivesizer.output.json.schema import record_schema, report_schema
from drivesizer.results.identification import Comparison, Identification
from drivesizer.results.prediction import Prediction

__all__ = ["json_documents"]

_DOCUMENTS = {
    "Sizing and report": report_schema,
    "Prediction": partial(record_schema, Prediction),
    "Identification": partial(record_schema, Identification),
    "Comparison": partial(record_schema, Comparison),
    "Export": export_schema,
}


def json_documents() -> str:
    """Each document, and each record in it once, by its name; parts have the columns of the catalogues."""
    parts, made, tables = {part.__name__ for part in PARTS.values()}, set[str](), []
    for title, schema in _DOCUMENTS.items():
        document = schema()
        records = {name: one for name, one in document["$defs"].items() if name not in made | parts}
        made |= records.keys()
        tables.append(f"## {title}\n\n{_table(document['properties'], parts)}")
        tables += [f"### {name}\n\n{_table(one['properties'], parts)}" for name, one in sorted(records.items())]
    return "\n\n".join(tables)


def _table(properties: dict[str, Any], parts: set[str]) -> str:
    """A row for each key; behind a type that may be null stands a question mark."""
    rows = []
    for key, of in properties.items():
        kind = re.sub(r"(.+) or null$", r"\1?", _type(of, parts))
        said = f"{kind}; {of['description']}" if "description" in of else kind
        rows.append(f"| `{key}` | {said} |")
    return "\n".join(("| key | type; what it is |", "|---|---|", *rows))


def _type(of: dict[str, Any], parts: set[str]) -> str:
    """The type of a key in words."""
    if "$ref" in of:
        name = of["$ref"].rpartition("/")[2]
        return f"[{name}](catalogues.md#columns)" if name in parts else f"[{name}](#{name.lower()})"
    if "anyOf" in of:
        every = " or ".join(_type(one, parts) for one in of["anyOf"])
        return " or ".join(dict.fromkeys(every.split(" or ")))
    if "enum" in of:
        return " or ".join(f"`{one}`" for one in of["enum"])
    if "const" in of:
        return f"`{of['const']}`"
    if of.get("type") == "array":
        return (
            f"[{_type(of['items'], parts)}]"
            if of.get("items") and "$ref" not in of["items"]
            else (f"list of {_type(of['items'], parts)}" if of.get("items") else "list")
        )
    if isinstance(of.get("additionalProperties"), dict) and of["additionalProperties"]:
        return f"object of {_type(of['additionalProperties'], parts)}"
    kinds = of.get("type", "any")
    return kinds if isinstance(kinds, str) else " or ".join(kinds)
