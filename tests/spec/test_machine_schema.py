"""The JSON Schema of machine.yaml: what ships obeys it, and what the reader refuses does not."""

from __future__ import annotations

from copy import deepcopy
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import read
from drivesizer.spec.machine import load_machine, machine_schema

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
