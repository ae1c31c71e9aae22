"""The JSON report: one document of sizing, parts list and closed loop, and the schema that it obeys."""

import json
from dataclasses import fields

import jsonschema
import pytest
from synthetic_validation import synthetic_validation

from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.document.axes import content_of
from drivesizer.output.json.documents import MOST_SAMPLES, SCHEMA, as_text, plain, series
from drivesizer.output.json.schema import report_schema
from drivesizer.output.report import report_json, write
from drivesizer.results.machine import of_one_axis
from drivesizer.results.sizing import SizingResult
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec

REPORT = report_schema()
VALIDATOR = jsonschema.Draft202012Validator(REPORT)


def reported(found: SizingResult) -> dict:
    return json.loads(report_json(content_of(found, None)), parse_constant=pytest.fail)


@pytest.fixture(scope="module")
def result(spec: RobotSpec) -> SizingResult:
    return size(spec, top=3)


@pytest.fixture(scope="module")
def document(result, tmp_path_factory) -> dict:
    (path,) = write(result, validate(result.spec, result.sets[0]), [tmp_path_factory.mktemp("json") / "report.json"])
    return json.loads(path.read_text(encoding="utf-8"), parse_constant=pytest.fail)


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(REPORT)


def test_the_report_obeys_the_schema(document):
    VALIDATOR.validate(document)
    assert document["axes"][0]["validation"]["loops"] and document["parts_list"]


def test_it_is_the_document_of_the_terminal_and_more(document, result):
    told = json.loads(as_text(of_one_axis(result)))
    (axis,), (own,) = document["axes"], told["axes"]
    assert document["schema"] == told["schema"] == SCHEMA == 2
    assert {key: axis[key] for key in own} == own and set(axis) - set(own) == {"validation", "series", "path"}
    assert {key: document[key] for key in told if key != "axes"} == {key: told[key] for key in told if key != "axes"}
    assert set(document) - set(told) == {"parts_list"}
    driven = axis["validation"]
    assert driven["drive_set"] == axis["result"]["sets"][0] and driven["spec"] == document["machine"]


def test_without_a_set_and_without_a_loop(example_text):
    text = example_text.replace("mass: 45 kg", "mass: 450 kg")
    told = reported(size(read_spec(YamlSource(text, "robot.yaml")), top=2))
    VALIDATOR.validate(told)
    (axis,) = told["axes"]
    assert (axis["result"]["sets"], told["parts_list"], axis["validation"], told["status"]) == ([], [], None, "fail")
    assert axis["result"]["misses"] and axis["result"]["relaxations"]


def test_actuators_and_what_is_unknown_obey_it(example_text):
    text = example_text[: example_text.index("select:")].replace("method: paper", "method: physics")
    select = "{catalogs: [robstride, cubemars, maxon], estimates: off, motor: {family: [RobStride, AK 3.0, EC 40]}}"
    spec = read_spec(YamlSource(f"{text}select: {select}\n", "robot.yaml"))
    told = reported(size(spec, top=20, pareto=("mass", "energy")))
    VALIDATOR.validate(told)
    found = told["axes"][0]["result"]
    shown = [*found["sets"], *found["misses"], *found["front"]]
    assert found["front"] and any(s["actuator"] for s in shown) and not all(s["actuator"] for s in shown)
    assert any(c["status"] == "unknown" and c["margin"] is None for s in shown for c in s["checks"])


def test_a_field_that_a_record_gets_is_in_document_and_schema(result):
    """Keys are the fields of the records, and no other."""
    best = result.sets[0]
    for one in (best.checks[0], best.requirements[0], result.counts):
        own = {field.name for field in fields(one)} - {"declared", "inputs", "origins", "turns_on"}
        assert own <= set(plain(one)) <= set(REPORT["$defs"][type(one).__name__]["properties"])


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d.pop("axes"),
        lambda d: d.update(schema=3),
        lambda d: d.update(colour="blue"),
        lambda d: d["parts_list"][0]["line"].update(price="127.73"),
        lambda d: d["parts_list"][0]["line"].update(quantity=None),
        lambda d: d["axes"][0]["result"]["sets"][0]["motor"].pop("rotor_inertia"),
        lambda d: d["axes"][0]["result"]["sets"][0]["checks"][0].update(status="good"),
        lambda d: d["axes"][0]["result"]["requirements"][0].update(value="208"),
        lambda d: d["axes"][0]["validation"]["figures"][0].pop("unit"),
        lambda d: d["axes"][0]["series"]["columns"].update(time="0 s"),
        lambda d: d["axes"][0]["validation"]["loops"][0]["poles"][0].append(0.0),
    ],
)
def test_what_is_wrong_does_not(change, document):
    damaged = json.loads(json.dumps(document))
    change(damaged)
    assert not VALIDATOR.is_valid(damaged)


def test_the_series_is_thinned_with_its_peaks(result):
    proof = synthetic_validation(result, step=0.02)
    told = plain(series(proof))
    assert told["thinned_from"] == len(proof.series["time"]) > len(told["columns"]["time"]) <= MOST_SAMPLES
    assert told["units"]["motor_speed"] == "rad/s"
    for name in ("time", "speed", "error", "current"):
        values = proof.series[name]
        assert (min(told["columns"][name]), max(told["columns"][name])) == (values.min(), values.max())
