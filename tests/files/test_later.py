"""Groups of fields whose model is loaded when a file has one."""

from __future__ import annotations

import subprocess
import sys
from typing import Annotated, Any

import pytest
from pydantic import Field, ValidationError

from drivesizer.files.fields import Section
from drivesizer.files.later import HasLater, Later
from drivesizer.spec.shaft import Shaft


class Now(Section):
    """With the model itself."""

    shaft: Shaft | None = None
    shafts: list[Shaft] = Field(default_factory=list)


class Then(HasLater):
    """With the model by its name."""

    shaft: Annotated[Any, Later("drivesizer.spec.shaft", "Shaft")] | None = None
    shafts: list[Annotated[Any, Later("drivesizer.spec.shaft", "Shaft")]] = Field(default_factory=list)


GIVEN: list[dict[str, Any]] = [
    {},
    {"shaft": {"distance": "12 mm"}, "shafts": [{}, {"load_factor": 2}]},
    {"shaft": None},
    {"shaft": Shaft()},
    {"shaft": 5},
    {"shaft": {"distance": "12 kg", "distnce": 1}, "shafts": [{}, {"load_factor": 0}]},
    {"shafts": {}},
]


def outcome(model: type[Section], given: dict[str, Any]) -> Any:
    try:
        return list(model.model_validate(given))
    except ValidationError as error:
        return [(one["type"], one["loc"], one["msg"]) for one in error.errors()]


@pytest.mark.parametrize("given", GIVEN, ids=str)
def test_read_and_refused_as_by_the_model_itself(given):
    assert outcome(Then, given) == outcome(Now, given)


def test_the_schema_is_that_with_the_model_itself():
    then, now = (model.model_json_schema() for model in (Then, Now))
    assert then | {"title": "", "description": ""} == now | {"title": "", "description": ""}
    assert "Shaft" in then["$defs"]


ASKED = """
import sys
from drivesizer.commands.starting import starter
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.robot import read_spec

read_spec(YamlSource(starter("hoist"), "hoist"))
print(*(name for name in sorted(sys.modules) if name.startswith(("drivesizer.spec.", "drivesizer.loads."))))
"""


def test_a_spec_loads_no_model_of_a_section_or_a_kind_of_load_that_it_lacks():
    done = subprocess.run([sys.executable, "-c", ASKED], capture_output=True, text=True, check=True)
    found = set(done.stdout.split())
    assert {"drivesizer.spec.control", "drivesizer.loads.hoist"} <= found
    assert not {f"drivesizer.spec.{name}" for name in ("battery", "platform", "mounting", "robot_section")} & found
    assert not {f"drivesizer.loads.{name}" for name in ("arm", "screw", "recorded")} & found
