"""The JSON report: one document of sizing, parts list and closed loop, and the schema that it obeys."""

import json

import jsonschema
import pytest
from synthetic_validation import synthetic_validation

from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.json import documents as json_documents
from drivesizer.output.json import documents as json_file
from drivesizer.output.json.schema import report_schema
from drivesizer.output.report import write
from drivesizer.results.sizing import SizingResult
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec

VALIDATOR = jsonschema.Draft202012Validator(report_schema())


@pytest.fixture(scope="module")
def result(spec: RobotSpec) -> SizingResult:
    return size(spec, top=3)


@pytest.fixture(scope="module")
def document(result, tmp_path_factory) -> dict:
    (path,) = write(result, validate(result.spec, result.sets[0]), [tmp_path_factory.mktemp("json") / "report.json"])
    return json.loads(path.read_text(encoding="utf-8"), parse_constant=pytest.fail)


def test_the_schema_is_one():
    jsonschema.Draft202012Validator.check_schema(report_schema())


def test_the_report_obeys_the_schema(document):
    VALIDATOR.validate(document)
    assert document["validation"]["loops"] and document["parts_list"]


def test_it_is_the_document_of_the_terminal_and_more(document, result):
    assert document["schema_version"] == json_documents.SCHEMA_VERSION
    told = json.loads(json_documents.as_text(json_documents.sizing(result)))
    assert {key: document[key] for key in told} == told
    assert set(document) - set(told) == {"parts_list", "validation", "platform"}
    driven = document["validation"]
    assert driven["set"] == document["sets"][0] and driven["spec"] == document["spec"]


def test_without_a_set_and_without_a_loop(example_text):
    text = example_text.replace("mass: 45 kg", "mass: 450 kg")
    found = size(read_spec(YamlSource(text, "robot.yaml")), top=2)
    told = json.loads(json_documents.as_text(json_file.document(found, None)), parse_constant=pytest.fail)
    VALIDATOR.validate(told)
    assert (told["sets"], told["parts_list"], told["validation"]) == ([], [], None)
    assert told["misses"] and told["relaxations"]


def test_actuators_and_what_is_unknown_obey_it(example_text):
    text = example_text[: example_text.index("select:")].replace("method: paper", "method: physics")
    select = "{catalogs: [robstride, cubemars, maxon], estimates: off, motor: {family: [RobStride, AK 3.0, EC 40]}}"
    spec = read_spec(YamlSource(f"{text}select: {select}\n", "robot.yaml"))
    found = size(spec, top=20, pareto=("mass", "energy"))
    told = json.loads(json_documents.as_text(json_file.document(found, None)))
    VALIDATOR.validate(told)
    shown = [*told["sets"], *told["misses"], *told["pareto"]["sets"]]
    assert told["pareto"]["sets"] and any(s["actuator"] for s in shown)
    assert any(s["results"]["physics"]["unknown"] for s in shown) and not all(s["actuator"] for s in shown)


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d.pop("parts_list"),
        lambda d: d.update(schema_version=2),
        lambda d: d.update(colour="blue"),
        lambda d: d["parts_list"][0].update(price="127.73"),
        lambda d: d["parts_list"][0].update(quantity=None),
        lambda d: d["sets"][0]["motor"].pop("rotor_inertia"),
        lambda d: d["sets"][0]["checks"][0].update(status="good"),
        lambda d: d["requirements"]["nominal_speed"].update(value="208"),
        lambda d: d["validation"]["figures"]["bandwidth"].pop("si"),
        lambda d: d["validation"]["series"]["columns"].update(time="0 s"),
        lambda d: d["validation"]["loops"][0]["poles"][0].append(0.0),
    ],
)
def test_what_is_wrong_does_not(change, document):
    damaged = json.loads(json.dumps(document))
    change(damaged)
    assert not VALIDATOR.is_valid(damaged)


def test_the_series_is_thinned_with_its_peaks(result):
    proof = synthetic_validation(result, step=0.02)
    told = json_file.document(result, proof)["validation"]["series"]
    assert told["thinned_from"] == len(proof.series["time"]) > len(told["columns"]["time"]) <= json_file.MOST_SAMPLES
    assert told["units"]["motor_speed"] == "rad/s"
    for name in ("time", "speed", "error", "current"):
        values = proof.series[name]
        assert (min(told["columns"][name]), max(told["columns"][name])) == (values.min(), values.max())
