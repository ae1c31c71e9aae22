"""The loads as a page: torque at the shaft, fields, and a starter spec of each."""

from __future__ import annotations

import inspect
import re
from importlib import import_module, resources
from typing import Any

import yaml
from docstrings import as_markdown
from spec_tables import SCHEMA, SPRINGS, fields_of, reference

from drivesizer.loads import AXES, MODULES, springs, stage_losses

__all__ = ["loads"]

_TITLES = {
    "lead_screw": "Lead screw and ball screw", "fan": "Fan, pump and flywheel", "rack_pinion": "Rack and pinion",
}  # fmt: skip


def loads() -> str:
    """Every kind of load; kinds that share a model share a section."""
    mapping = SCHEMA["properties"]["load"]["discriminator"]["mapping"]
    models = [reference(option) for option in SCHEMA["properties"]["load"]["oneOf"]]
    kinds = {name: [k for k, at in mapping.items() if at.endswith(f"/{name}")] for name in models}
    for several in kinds.values():
        several.sort(key=list(MODULES).index)
    shared = [("A stage", stage_losses), ("Torques that are no straight lines", springs.Lever)]
    parts = [_load(name, of) for name, of in kinds.items()]
    parts.append(_springs())
    parts += [f"## {title}\n\n{_docstring(subject)}" for title, subject in shared]
    return "\n\n".join(parts)


def _load(name: str, kinds: list[str]) -> str:
    model: dict[str, Any] = SCHEMA["$defs"][name]
    title = _TITLES.get(kinds[0], kinds[0].replace("_", " ").capitalize())
    module = import_module(f"drivesizer.loads.{MODULES[kinds[0]]}")
    axis = {"linear": "along a line", "rotary": "about an axis"}[AXES[kinds[0]]]
    named = " or ".join(f"`kind: {kind}`" for kind in kinds)
    parts = [f"## {title}", f"{named} · its motion is given {axis}", _docstring(module)]
    parts += ["### Fields of " + " and ".join(k.replace("_", " ") for k in kinds), fields_of(model)]
    if "cylinders" in model["properties"]:
        parts += ["`cylinders` has", fields_of(SCHEMA["$defs"]["Cylinders"])]
        parts += ["and each of these", fields_of(SCHEMA["$defs"]["Cylinder"])]
    if "screw" in model["properties"]:
        parts += ["`screw` has", fields_of(SCHEMA["$defs"]["ScrewChoice"])]
    return "\n\n".join([*parts, *(_starter(kind) for kind in kinds)])


def _springs() -> str:
    """Springs and counterweights of any load: their law, and the fields of each kind."""
    parts = ["## Springs and counterweights", _docstring(springs)]
    for name in SPRINGS:
        model = SCHEMA["$defs"][name]
        title = f"`kind: {model['properties']['kind']['const']}`" if "kind" in model["properties"] else "`ends`"
        parts += [f"### {title}", model["description"], fields_of(model)]
    return "\n\n".join(parts)


def _docstring(subject: Any) -> str:
    """The docstring of a module or a class, with its references as links on the page."""
    text = as_markdown(inspect.getdoc(subject) or "").replace("`stage_losses`", "[stage](#a-stage)")
    return text.replace("`weight_on_lever`", "[pieces](#torques-that-are-no-straight-lines)")


def _starter(kind: str) -> str:
    """Load and motion of the spec that ``drivesizer init --kind`` writes."""
    text = (resources.files("drivesizer.spec") / "starters" / f"{kind}.yaml").read_text(encoding="utf-8")
    assert yaml.safe_load(text)["load"]["kind"] == kind
    groups = [re.search(rf"(?ms)^{name}:.*?(?=^\S|\Z)", text) for name in ("load", "motion")]
    shown = "\n".join(line for group in groups if group for line in group[0].splitlines() if "  # " not in line[:5])
    return f"`drivesizer init --kind {kind}` writes a whole spec with\n\n```yaml\n{shown}\n```"
