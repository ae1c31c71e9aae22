"""JSON: the record of each drive, and what it has at the driven shaft; SI, null is unknown."""

from __future__ import annotations

from typing import Any, NamedTuple

from drivesizer.output.export.common import Export, TorqueLaw, torque_law
from drivesizer.output.export.machine import MachineExport
from drivesizer.output.json.documents import as_text, plain
from drivesizer.output.json.schema import Definitions, array_of, document_schema, properties


class AtShaft(NamedTuple):
    """A drive seen at its driven shaft with gears that drive, and its controller as one law."""

    inertia: float  # kg*m^2, of the load, and rotor with gearhead input reflected
    reflected_inertia: float  # kg*m^2, of rotor with gearhead input
    friction: float  # N*m, dry friction of load and motor
    damping: float  # N*m*s/rad, viscous friction of the motor
    weight: float  # N*m, of the load, at the start of the motion
    torque_law: TorqueLaw | None  # at the motor; null: none is designed, for its inertia is unknown, or it is a stepper


def render(of: MachineExport) -> bytes:
    """The file of a machine: the drives of all its axes."""
    found = {"name": of.name, "axes": [document(one) for _, one in of.exports]}
    return (as_text(found) + "\n").encode("utf-8", "backslashreplace")


def document(of: Export) -> dict[str, Any]:
    """The figures of a drive as plain data."""
    law = torque_law(of) if of.controller else None
    shaft = AtShaft(of.inertia, of.reflected_inertia, of.friction, of.damping, of.weight, law)
    return plain(of) | plain(shaft)


def export_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer export --format json``."""
    defs: Definitions = {}
    drive = properties(Export, defs) | properties(AtShaft, defs)
    return document_schema(
        "drivesizer export", {"name": {"type": "string"}, "axes": array_of("Drive", drive, defs)}, defs
    )
