"""Documents that an earlier program wrote obey today's schemas: no key is renamed, removed or of another type.

The samples are as printed of a belt axis (`report`, `export --format json`), of a machine of two axes (`size`) and of
`predict`, of each list the first two entries, packed by `xz -9e`. They are made anew when the version of the contract
grows, and not before: docs/json.md, "Versions".
"""

from __future__ import annotations

import copy
import json
import lzma
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from drivesizer.output.export.json_document import export_schema
from drivesizer.output.json.documents import SCHEMA
from drivesizer.output.json.schema import prediction_schema, report_schema

SAMPLES = Path(__file__).parent / f"documents_of_version_{SCHEMA}"
REPORT = report_schema()
SCHEMAS = {"report": REPORT, "machine": REPORT, "predict": prediction_schema(), "export": export_schema()}


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


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("report", lambda d: d["axes"][0]["result"]["sets"][0].update(drive=1)),
        ("report", lambda d: d["axes"][0]["result"]["sets"][0]["motor"].update(inertia=1.0)),
        ("report", lambda d: d["axes"][0]["result"]["sets"][0]["checks"][0].update(margin="5 %")),
        ("report", lambda d: d["axes"][0]["validation"]["loops"][0].update(stable="yes")),
        ("machine", lambda d: d["axes"][1]["result"]["counts"].update(considered=None)),
        ("machine", lambda d: d.update(schema=1)),
        ("predict", lambda d: d["figures"][0]["band"].update(p95="fast")),
        ("export", lambda d: d["axes"][0].update(set=d["axes"][0].pop("label"))),
    ],
)
def test_a_key_renamed_or_of_another_type_is_seen(name, change, documents):
    changed = copy.deepcopy(documents[name])
    change(changed)
    assert not VALIDATORS[name].is_valid(changed)
