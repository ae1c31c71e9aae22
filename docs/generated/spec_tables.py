"""Tables of a spec's fields, out of its JSON Schema and the models' own types."""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from typing import Any

from drivesizer.spec.machine import machine_schema
from drivesizer.spec.robot import RobotSpec

__all__ = ["SCHEMA", "SPRINGS", "fields_of", "machine_sections", "sections"]

SCHEMA: dict[str, Any] = RobotSpec.model_json_schema()
_MACHINE: dict[str, Any] = machine_schema()
_DEFS: dict[str, Any] = _MACHINE["$defs"] | SCHEMA["$defs"]
_SECTIONS: dict[str, dict[str, str]] = {  # section of a spec: its models, each with its heading
    "motion": dict.fromkeys(("Trapezoid", "Triangle", "Move", "SCurve", "Harmonic", "Hold"), "")
    | {"Segments": "", "Segment": "Each of `segments`", "Csv": "", "Cam": "", "Track": ""}
    | {"Waypoints": "", "Waypoint": "Each of `waypoints`"},
    "platform": {
        "Platform": "", "WheelPlace": "Each of `wheels`", "Mecanum": "`layout` of `kind: mecanum`",
        "Differential": "`layout` of `kind: differential`", "Omni": "`layout` of `kind: omni`",
        "Skid": "`layout` of `kind: skid`",
        "CasterPlace": "Each of `casters`", "CentreOfMass": "`centre_of_mass`", "PayloadSection": "Each of `payloads`",
        "SizeSection": "`size`", "PassageSection": "Each of `passages`", "Limits": "`limits`",
        "Unknown": "`misjudged`", "UnknownPayload": "`payload` of `misjudged`",
        "Following": "`following`", "Measured": "Each of `measured` of `following`",
    },
    "budget": {"Budget": "", "Item": "Each of `others`"},
    "transmission": {
        "GearheadStage": "", "DirectStage": "", "BeltStage": "", "Pulleys": "`pulleys` of a belt",
        "GearStage": "`kind: gear`, `bevel`, `chain` or `worm`",
    },
    "inertia": {"Solid": ""},
    "supply": {"Supply": ""},
    "brake_resistor": {"BrakeResistor": ""},
    "power_stage": {"PowerStage": ""},
    "brake": {"OwnBrake": ""},
    "battery": {
        "Battery": "", "Charger": "`charger`", "Run": "Each line of `discharge`",
        "OpenCircuit": "`open_circuit`",
        "Polarisation": "`polarisation`",
    },
    "equipment": {"Consumer": "Each of the list"},
    "environment": {"Environment": ""},
    "mounting": {"Mounting": ""},
    "margins": {"Margins": ""},
    "requirements": {"Requirements": "", "Travel": "`travel`"},
    "needs": {"Needs": "", "Lives": "`life` by part"},
    "shaft": {"Shaft": ""},
    "select": {
        "Select": "", "MotorChoice": "`motor`", "Choice": "`gearhead` and `brake`", "EncoderChoice": "`encoder`",
        "ControllerChoice": "`controller`", "Weighted": "Each of several objectives",
    },
    "tolerances": {
        "Tolerances": "", "MotorTolerances": "`motor`", "GearheadTolerances": "`gearhead`",
        "ControllerTolerances": "`controller`",
    },
    "cases": {"Case": ""},
    "design": {"Design": ""},
    "report": {"TitleBlock": ""},
    "mission": {"Mission": "", "Leg": "Each of `legs`"},
    "control": {
        "Control": "", "CurrentLoop": "`current`", "VelocityLoop": "`velocity`", "PositionLoop": "`position`",
        "Feedforward": "`feedforward`",
    },
    "plant": {"Plant": ""},
    "paper_factors": {"PaperFactors": ""},
}  # fmt: skip
_OF_MACHINES = {  # models of machine.yaml that no spec has, each with its heading
    "Axis": "Each of `axes`", "CarriedPlace": "Each of `carries`, where the axis turns", "RobotSection": "`robot`",
    "RobotJointWaypoint": "Each of `waypoints`", "RobotJointLimits": "Each of `limits`", "RobotHold": "Each of `holds`",
    "RobotPointMass": "`payload`", "RobotPayloadCase": "Each of `payloads`", "RobotDrivePlace": "Each of `drives`",
    "RobotMounting": "`mounting` of the robot's base", "RobotLinkForce": "Each of `forces`",
    "RobotCoupling": "Each of `couplings`",
}  # fmt: skip
_BY_KIND = ("Fan", "Screw")  # models of several kinds: what the page says above their fields
_REPEATED = ("rest_time", "there_and_back", "payload", "payload_back")  # fields of several motions
SPRINGS = ("ConstantSpring", "LinearSpring", "TorsionSpring", "GasSpring", "BalanceMass", "SpringEnds")
_LOADS = ("Cylinder", "Cylinders", "ScrewChoice", *SPRINGS)  # further models of loads, which have a page of their own


def sections() -> str:
    """All sections of a spec but the loads, a heading each."""
    shown = {name for names in _SECTIONS.values() for name in names} | set(_LOADS)
    loads = {reference(option) for option in SCHEMA["properties"]["load"]["oneOf"]}
    lost = set(SCHEMA["$defs"]) - shown - loads
    if lost:
        raise ValueError(f"no section of the page shows {', '.join(sorted(lost))}")
    parts = [f"## The whole\n\n{fields_of(SCHEMA)}"]
    for heading, models in _SECTIONS.items():
        parts.append(f"## {heading}")
        parts += [_model(name, title) for name, title in models.items()]
        if heading == "motion":
            common = {name: field for name, field in _DEFS["Trapezoid"]["properties"].items() if name in _REPEATED}
            said = "### Of trapezoid, triangle, move and s_curve\n\nAll four have these fields too."
            parts += [said, fields_of(_DEFS["Trapezoid"] | {"properties": common})]
    return "\n\n".join(parts)


def machine_sections() -> str:
    """Fields of machine.yaml that no spec has, a heading each; its sections of a spec are those of the page."""
    partial = {name for name in _MACHINE["$defs"] if name.removeprefix("Axis") in SCHEMA["$defs"]}
    partial |= {f"Robot{name}" for name in SPRINGS}  # as those of a load
    lost = set(_MACHINE["$defs"]) - partial - set(_OF_MACHINES)
    if lost:
        raise ValueError(f"no section of the page shows {', '.join(sorted(lost))}")
    return "\n\n".join(
        [_own("The machine", _MACHINE), *(_own(title, _DEFS[name]) for name, title in _OF_MACHINES.items())]
    )


def _own(title: str, model: dict[str, Any]) -> str:
    """Fields of a model of a machine without the sections of a spec, which are the same."""
    own = {name: field for name, field in model["properties"].items() if not _of_spec(name, model["title"])}
    said = re.sub(r"\s+", " ", model.get("description", ""))
    return "\n\n".join([f"### {title}", *([said] if said else []), fields_of(model | {"properties": own})])


def _of_spec(name: str, title: str) -> bool:
    return title in (_MACHINE["title"], "Axis") and name in SCHEMA["properties"]


def _model(name: str, title: str) -> str:
    model = _DEFS[name]
    said = re.sub(r"\s+", " ", model.get("description", ""))
    title = title or _chosen_by(model)
    return "\n\n".join([*([f"### {title}"] if title else []), said, fields_of(model, _REPEATED)])


def _chosen_by(model: dict[str, Any]) -> str:
    """The entry of a spec that selects a model, such as ``profile: triangle``."""
    for key in ("profile", "kind"):
        if key in model["properties"] and "const" in model["properties"][key]:
            return f"`{key}: {model['properties'][key]['const']}`"
    return ""


def fields_of(model: dict[str, Any], without: Collection[str] = ()) -> str:
    """The fields of a model as a table: name, bold where it is required; default, or what it takes; what it is."""
    required = set(model.get("required", ()))
    rows = []
    for name, field in sorted(model["properties"].items(), key=lambda item: item[0] not in required):
        if name in without or (name in ("kind", "profile") and ("const" in field or model["title"] in _BY_KIND)):
            continue
        shown = f"**`{name}`**" if name in required else f"`{name}`"
        rows.append(f"| {shown} | {_value(field)} | {_said(field)} |")
    return "\n".join(["| field | value | what it is |", "|---|---|---|", *rows])


def _value(field: dict[str, Any]) -> str:
    """The default of a field, of words before the others; where it has none what it takes, a figure in brackets."""
    default, takes = field.get("default"), _takes(field)
    if own := " or ".join(f"`{one}`" for one in field.get("examples") or ()):
        takes = f"({own})" if takes == "text" else re.sub(r"\(`.*?`\)", f"({own})", takes, count=1)
    if default is None:
        return takes
    shown = f"`{default}`" if isinstance(default, str) else f"`{json.dumps(default)}`"
    if shown in takes and "(" not in takes:
        return " or ".join([shown, *(one for one in takes.split(" or ") if one != shown)])
    return shown


def _said(field: dict[str, Any]) -> str:
    text = field.get("description", "")
    if "$ref" in field and not text:
        text = _DEFS[reference(field)].get("description", "")
    return "" if _kind_alone(text) else re.sub(r"\s+", " ", text).replace("|", "\\|").replace("<", "&lt;")


def _kind_alone(text: str) -> bool:
    """Whether a description says the kind of quantity only, which has its own column."""
    return text.endswith(" with unit") or text == "a plain number or percent"


def _takes(field: dict[str, Any]) -> str:
    """The values that a field takes, in words."""
    if "$ref" in field:
        return "section"
    if {"$ref": "#/$defs/Solid"} in field.get("oneOf", ()):
        return f"{_takes(field['oneOf'][0])}, or [a body](spec.md#inertia), or a list of both"
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return " or ".join(f"`{value}`" for value in field["enum"])
    options = [o for o in (*field.get("anyOf", ()), *field.get("oneOf", ())) if o.get("type") != "null"]
    if options:
        words = dict.fromkeys(_takes(o) for o in options)
        return " or ".join(words).replace(") or (", " or ")
    return _plain(field)


def _plain(field: dict[str, Any]) -> str:
    kind = field.get("type")
    if kind == ["string", "integer"]:
        return "name"
    if kind == ["number", "string"]:
        return "number or %"
    if kind == "array":
        each = _takes(field["items"]) if field.get("items") else "list"
        return "sections" if each == "section" else f"list, each {each}" if field.get("items") else each
    if field.get("examples"):
        return f"({' or '.join(f'`{example}`' for example in field['examples'])})"
    if kind == "integer" and "minimum" in field:
        return f"whole number from {field['minimum']}" + (f" to {field['maximum']}" if "maximum" in field else "")
    return {"string": "text", "boolean": "`true` or `false`", "number": "number", "object": "section"}[str(kind)]


def reference(field: dict[str, Any]) -> str:
    """Name of the model that a field refers to."""
    return str(field["$ref"]).rsplit("/", 1)[1]
