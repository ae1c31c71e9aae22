"""The JSON Schemas that editors get: what ships obeys them, and what is wrong does not."""

from __future__ import annotations

import json
from contextlib import nullcontext
from copy import deepcopy
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from rows import hold

from drivesizer.catalog import shipped
from drivesizer.catalog.schema import catalog_schema
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import read
from drivesizer.spec.machine import is_machine, load_machine, machine_schema
from drivesizer.spec.robot import RobotSpec, load_spec
from drivesizer.study.plan import StudyFile

SPECS = [Path(str(p)) for p in (resources.files("drivesizer.spec") / "starters").iterdir() if p.name.endswith(".yaml")]
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
STUDY = EXAMPLES / "study.yaml"
SPECS += (path for path in EXAMPLES.glob("*.yaml") if path != STUDY and not is_machine(read(path)))


def test_shipped_catalogues_obey_the_schema():
    schema = jsonschema.Draft202012Validator(catalog_schema())
    hold(lambda path: schema.validate(read(path).data), {name: (path,) for name, path in shipped().items()})


@pytest.mark.parametrize("path", sorted(SPECS), ids=lambda p: p.stem)
def test_starters_and_examples_obey_the_schema(path):
    jsonschema.Draft202012Validator(RobotSpec.model_json_schema()).validate(read(path).data)


@pytest.mark.parametrize(("mission", "good"), [
    ({"duration": "2 h"}, True),
    ({"legs": [{"time": "40 min"}, {"time": "20 min", "charges": True}]}, True),
    ({"duration": "2 h", "legs": [{"time": "40 min"}]}, True),
    ({}, False),
    ({"legs": []}, False),
])  # fmt: skip
def test_a_mission_has_a_duration_or_legs(mission, good):
    """The schema takes what the reader takes, of a spec and of a machine."""
    spec = read(EXAMPLES / "sps_robot.yaml").data | {"mission": mission}
    assert jsonschema.Draft202012Validator(RobotSpec.model_json_schema()).is_valid(spec) == good
    whole = {"name": "one", "supply": {"nominal": "48 V"}, "mission": mission, "axes": {"a": {}}}
    assert jsonschema.Draft202012Validator(machine_schema()).is_valid(whole) == good
    with nullcontext() if good else pytest.raises(InputError, match="mission"):
        load_spec(spec)


def test_the_example_of_a_study_obeys_the_schema():
    schema = jsonschema.Draft202012Validator(StudyFile.model_json_schema())
    study = read(STUDY).data
    schema.validate(study)
    schema.validate(study | {"sampling": {"latin_hypercube": 50, "seed": 2}})
    for wrong in ({"sampling": "dice"}, {"top": 0}, {"very": {"load.mass": ["3 kg"]}}, {"specs": "robot.yaml"}):
        with pytest.raises(jsonschema.ValidationError):
            schema.validate(study | wrong)


@pytest.mark.parametrize("change", [
    lambda c: c.pop("sources"),
    lambda c: c["sources"]["sheet"].update(confidence="certain"),
    lambda c: c["motors"][0]["columns"].append("torqe (N*m)"),
    lambda c: c["motors"][0]["columns"].remove("part"),
    lambda c: c["motors"][0]["common"].update(weight="1 kg"),
    lambda c: c.update(pumps=[]),
    lambda c: c["compatibility"]["motor_gearhead"][0].pop("source"),
    lambda c: c.update(catalog=2),
])  # fmt: skip
def test_what_is_wrong_does_not(change):
    catalogue = {
        "catalog": 1,
        "manufacturer": "M",
        "sources": {"sheet": {"document": "a sheet", "confidence": "quoted"}},
        "motors": [{"family": "F", "source": "sheet", "common": {"mass": "1 kg"},
                    "columns": ["part", "resistance (ohm)"], "rows": [["a", 1.5], ["b", None]]}],
        "compatibility": {"motor_gearhead": [{"source": "sheet", "motors": ["F"], "gearheads": ["direct"]}]},
    }  # fmt: skip
    validator = jsonschema.Draft202012Validator(catalog_schema())
    validator.validate(catalogue)
    change(catalogue)
    assert not validator.is_valid(catalogue)


def test_schemas_from_the_command_line(run):
    for arguments, title in ((["schema"], "RobotSpec"), (["schema", "catalog"], "drivesizer catalogue")):
        status, out, _ = run(*arguments)
        assert status == 0
        assert json.loads(out)["title"] == title
    status, _, err = run("schema", "catalogue")
    assert status == 2
    assert "expected spec or catalog" in err


# --- machines of several axes

STARTERS = Path(str(resources.files("drivesizer.spec") / "starters" / "machines"))
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "six_joint_arm.yaml"
MACHINE: dict[str, Any] = {
    "name": "cell", "supply": {"nominal": "48 V"}, "few_kinds": "10 %", "timing": "independent",
    "motion": {"acceleration_time": "0.3 s", "cruise_time": "0.5 s"},
    "axes": {
        "swing": {
            "load": {"kind": "arm", "mass": "4 kg", "length": "0.3 m"}, "carries": {"lift": {"at": "300 mm"}},
            "motion": {"speed": "90 deg/s"},
        },
        "lift": {
            "load": {"kind": "rack_pinion", "mass": "3 kg", "pinion_diameter": "30 mm"}, "start": "0.5 s",
            "motion": {"speed": "0.5 m/s"}, "supply": {"regeneration": 0.5},
        },
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = machine_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("path", [*sorted(STARTERS.glob("*.yaml")), EXAMPLE], ids=lambda path: path.stem)
def test_starters_and_the_example_obey_the_schema(path: Path, validator: jsonschema.Draft202012Validator) -> None:
    validator.validate(read(path).data)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("axes", "lift", "strat"), "1 s"),
        (("axes", "lift", "load", "kind"), "rack"),
        (("axes", "lift", "load", "weight"), "3 kg"),
        (("axes", "lift", "start"), 0.5),
        (("axes", "lift", "battery"), {"part": "x"}),
        (("axes", "swing", "carries"), 3),
        (("axes", "swing", "carries"), {"lift": {"place": "1 m"}}),
        (("timing",), "never"),
        (("few_kinds",), ["10 %"]),
        (("supply",), {"current": "10 A"}),
        (("margin",), {"torque": "10 %"}),
        (("robot",), {"trajectory": "moves.csv"}),
        (("robot",), {"description": "a.urdf", "trajectory": "a.csv", "held": {"a": 3}}),
        (("axes",), None),
    ],
)
def test_what_the_reader_refuses_does_not(
    place: tuple[str, ...], value: object, validator: jsonschema.Draft202012Validator
) -> None:
    load_machine(MACHINE)
    validator.validate(MACHINE)
    wrong = deepcopy(MACHINE)
    inner = wrong
    for key in place[:-1]:
        inner = inner[key]
    if value is None:
        del inner[place[-1]]
    else:
        inner[place[-1]] = value
    assert not validator.is_valid(wrong)
    with pytest.raises(InputError):
        load_machine(wrong)
