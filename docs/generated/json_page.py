"""Tables of the JSON documents' records, out of their schemas."""

from __future__ import annotations

from typing import Any

from drivesizer.catalog import PARTS
from drivesizer.output.export.json_document import export_schema
from drivesizer.output.json.schema import prediction_schema, report_schema

__all__ = ["json_documents"]

_DOCUMENTS = {"Sizing and report": report_schema, "Prediction": prediction_schema, "Export": export_schema}


def json_documents() -> str:
    """Each document, and each record in it once, by its name; parts have the columns of the catalogues."""
    parts, made, tables = {part.__name__ for part in PARTS.values()}, dict[str, Any](), []
    for title, schema in _DOCUMENTS.items():
        document = schema()
        heads = {}  # a name that another document has for another record is told apart
        for name, one in document["$defs"].items():
            heads[name] = name if made.get(name, one) == one else f"{name} of {title.lower()}"
        records = {heads[n]: one for n, one in document["$defs"].items() if n not in parts and heads[n] not in made}
        made |= records
        links = {name: f"[{head}](#{head.lower().replace(' ', '-')})" for name, head in heads.items()}
        links |= {name: f"[{name}](catalogues.md#columns)" for name in parts}
        tables.append(f"## {title}\n\n{_table(document['properties'], links)}")
        tables += [f"### {name}\n\n{_table(one['properties'], links)}" for name, one in sorted(records.items())]
    return "\n\n".join(tables)


def _table(properties: dict[str, Any], links: dict[str, str]) -> str:
    rows = [f"| `{key}` | {_type(of, links)} | {of.get('description', '')} |" for key, of in properties.items()]
    return "\n".join(("| key | type | what it is |", "|---|---|---|", *rows))


def _type(of: dict[str, Any], links: dict[str, str]) -> str:
    """The type of a key in words."""
    if "$ref" in of:
        return links[of["$ref"].rpartition("/")[2]]
    if "anyOf" in of:
        every = " or ".join(_type(one, links) for one in of["anyOf"])
        return " or ".join(dict.fromkeys(every.split(" or ")))
    if "enum" in of:
        return " or ".join(f"`{one}`" for one in of["enum"])
    if "const" in of:
        return f"`{of['const']}`"
    if of.get("type") == "array":
        return f"array of {_type(of['items'], links)}" if of.get("items") else "array"
    if isinstance(of.get("additionalProperties"), dict) and of["additionalProperties"]:
        return f"object of {_type(of['additionalProperties'], links)}"
    kinds = of.get("type", "any")
    return kinds if isinstance(kinds, str) else " or ".join(kinds)
