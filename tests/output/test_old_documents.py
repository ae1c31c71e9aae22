"""Documents that an earlier program wrote obey today's schemas: no key is renamed, removed or of another type.

The samples are as printed by commit e5b8b1e, packed by `xz -9e`: `size --top 1 --json` of a belt axis and of a machine
of two axes, `validate --json`, `predict --json` and `export --format json`. They are not to be made anew while the
version of the contract stays: docs/json.md, "Versions".
"""

from __future__ import annotations

import copy
import json
import lzma
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from drivesizer.output.export.json_document import SCHEMA_VERSION as EXPORT_VERSION
from drivesizer.output.export.json_document import export_schema
from drivesizer.output.json.behaviour import prediction_schema
from drivesizer.output.json.documents import SCHEMA_VERSION
from drivesizer.output.json.schema import machine_report_schema, report_schema

SAMPLES = Path(__file__).parent / "documents_of_version_1"
REPORT = report_schema()
SCHEMAS = {
    "size": REPORT, "validate": REPORT["$defs"]["Validation"] | {"$defs": REPORT["$defs"]},
    "machine": machine_report_schema(), "predict": prediction_schema(), "export": export_schema(),
}  # fmt: skip


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


def test_each_kind_has_a_sample_of_this_version(documents):
    assert set(documents) == set(SCHEMAS)
    assert {document["schema_version"] for document in documents.values()} == {SCHEMA_VERSION, EXPORT_VERSION} == {1}


@pytest.mark.parametrize("name", SCHEMAS)
def test_an_old_document_obeys_the_schema_of_today(name, documents):
    assert len(documents[name]) > 8
    VALIDATORS[name].validate(documents[name])


@pytest.mark.parametrize("name", SCHEMAS)
def test_its_keys_are_still_promised(name, documents):
    """A key that may be left out now is one that a program which reads it no longer finds."""
    assert set(documents[name]) <= set(SCHEMAS[name]["required"])


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("size", lambda d: d["sets"][0].update(drive=d["sets"][0].pop("motor"))),
        ("size", lambda d: d["sets"][0]["motor"].update(inertia=d["sets"][0]["motor"].pop("rotor_inertia"))),
        ("size", lambda d: d["sets"][0]["checks"][0].update(margin="5 %")),
        ("machine", lambda d: d["axes"]["lift"]["sizing"]["counts"].update(considered=None)),
        ("machine", lambda d: d.update(schema_version=2)),
        ("validate", lambda d: d["loops"][0].update(stable="yes")),
        ("predict", lambda d: d["figures"]["free_speed"].update(p95="fast")),
        ("export", lambda d: d.update(label=d.pop("set"))),
    ],
)
def test_a_key_renamed_or_of_another_type_is_seen(name, change, documents):
    changed = copy.deepcopy(documents[name])
    change(changed)
    assert not VALIDATORS[name].is_valid(changed)
