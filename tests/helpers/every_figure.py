"""Specs that have every figure of the schema, and one drive for them whose figures are all printed."""

from __future__ import annotations

import json
from pathlib import Path

import yaml

PARTS = Path(__file__).with_name("every_figure.yaml").read_text(encoding="utf-8")
SPECS = yaml.safe_load(Path(__file__).with_name("every_spec.yaml").read_text(encoding="utf-8"))
del SPECS["common"]  # what several have


def text_of(name: str) -> str:
    """A whole spec."""
    motor = {"motor": {"kind": "stepper"}} if name == "stepper" else {}
    return json.dumps({"name": name, **SPECS[name], "select": {"catalogs": ["parts.yaml"], **motor}})
