"""Documents that an earlier program wrote obey today's schemas: no key is renamed, removed or of another type.

The samples are as printed of a belt axis (`report`, `export --format json`), of a machine of two axes (`size`) and of
`predict`, of each list the first two entries, packed by `xz -9e`. They are made anew when the version of the contract
grows, and not before: docs/json.md, "Versions".
"""

from __future__ import annotations

import json
import lzma
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from drivesizer.output.export.machine import export_schema
from drivesizer.output.json.documents import SCHEMA
from drivesizer.output.json.schema import record_schema, report_schema
from drivesizer.results.prediction import Prediction

SAMPLES = Path(__file__).parent / f"documents_of_version_{SCHEMA}"
REPORT = report_schema()
SCHEMAS = {"report": REPORT, "machine": REPORT, "predict": record_schema(Prediction), "export": export_schema()}


def without_required(schema: Any) -> Any:
    """A schema that does not miss keys: those that came since the document was written."""
    if isinstance(schema, dict):
        # a property may be named "required": then it holds a schema
        kept = {key: inner for key, inner in schema.items() if not (key == "required" and isinstance(inner, list))}
        return {key: without_required(inner) for key, inner in kept.items()}
    return [without_required(inner) for inner in schema] if isinstance(schema, list) else schema


VALIDATORS = {name: jsonschema.Draft202012Validator(without_required(schema)) for name, schema in SCHEMAS.items()}


@pytest.fixture(scope="module")
def documents() -> dict[str, Any]:
    return {path.name.split(".")[0]: json.loads(lzma.open(path).read()) for path in SAMPLES.iterdir()}


@pytest.mark.parametrize("name", SCHEMAS)
def test_an_old_document_obeys_the_schema_of_today(name, documents):
    assert documents[name]["schema"] == SCHEMA and len(documents[name]) >= 4
    VALIDATORS[name].validate(documents[name])
