"""JSON Schema of machine.yaml, out of those of a spec, of the machine's own fields and of the robot's section.

A section that an axis lays over the machine's need not be whole: there no field of it is required.
"""

from __future__ import annotations

from typing import Any

from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import RobotSection
from drivesizer.spec.several_axes.machine_file import WHOLE, AxisFields, MachineFields

__all__ = ["machine_schema"]

_REF = "#/$defs/"
_ROBOT = "Robot"  # before the models of the robot's section, two of which a spec has by the same name
_PARTIAL = "Axis"  # before models of which no field is required


def machine_schema() -> dict[str, Any]:
    """The JSON Schema of machine.yaml."""
    spec, head, axis = (model.model_json_schema() for model in (RobotSpec, MachineFields, AxisFields))
    robot = RobotSection.model_json_schema(ref_template=f"{_REF}{_ROBOT}{{model}}")
    models = spec["$defs"] | {f"{_ROBOT}{name}": one for name, one in robot.pop("$defs").items()}
    models |= axis["$defs"] | {"RobotSection": robot}
    sections = {name: _partial(field, models) for name, field in spec["properties"].items()}
    own = {name: field for name, field in head["properties"].items() if name not in spec["properties"]}
    whole = {name: spec["properties"][name] for name in head["properties"] if name in spec["properties"]}
    models["Axis"] = {
        "title": "Axis",
        "description": "An axis: sections of a spec, over those of the machine, and what of it others carry.",
        "type": "object",
        "additionalProperties": False,
        "properties": axis["properties"] | {name: one for name, one in sections.items() if name not in WHOLE},
    }
    own["axes"] |= {"additionalProperties": {"$ref": f"{_REF}Axis"}}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drivesizer machine",
        "description": head["description"],
        "type": "object",
        "additionalProperties": False,
        "required": head["required"],
        "anyOf": [{"required": ["axes"]}, {"required": ["robot"]}],
        "properties": {"name": head["properties"]["name"]} | own | sections | whole,
        "$defs": models,
    }


def _partial(field: dict[str, Any], models: dict[str, Any]) -> dict[str, Any]:
    """A section of which no field is required; the models that it needs are added."""
    if "$ref" in field:
        name = field["$ref"].removeprefix(_REF)
        if not models[name].get("required"):
            return field
        models[_PARTIAL + name] = {key: value for key, value in models[name].items() if key != "required"}
        return field | {"$ref": f"{_REF}{_PARTIAL}{name}"}
    options = field.get("oneOf", field.get("anyOf"))
    if options is None:
        return field
    kept = {key: value for key, value in field.items() if key not in ("oneOf", "anyOf", "discriminator")}
    # without its kind a section may be one of several
    return kept | {"anyOf": [_partial(option, models) for option in options]}
