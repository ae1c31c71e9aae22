"""JSON: all figures of the export as one document, each with its unit, and the schema that it obeys.

SI throughout; null is unknown.
"""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite, nan
from typing import Any

from drivesizer.control.validation import Gains
from drivesizer.output.export.common import PROGRAM, Export, Limit, torque_law
from drivesizer.output.export.fmu_motor import FIGURES
from drivesizer.output.export.machine import MachineExport
from drivesizer.output.json.documents import as_text

__all__ = ["SCHEMA_VERSION", "document", "export_schema", "render"]

SCHEMA_VERSION = 1
_GAINS = {  # units of what a controller is made of
    "kp": "V.s/rad", "ki": "V/rad", "kd": "V.s2/rad", "filter_time": "s", "period": "s", "current_kp": "V/A",
    "current_ki": "V/(A.s)", "velocity_kp": "A.s/rad", "velocity_ki": "A/rad", "velocity_kd": "A.s2/rad",
    "position_kp": "1/s", "feedforward_velocity": "A.s/rad", "feedforward_friction": "A",
    "feedforward_acceleration": "A.s2/rad", "current_period": "s", "velocity_period": "s", "position_period": "s",
    "counted_over": "1",
}  # fmt: skip
_LAW = {
    "kp": "N.m/rad", "ki": "N.m/(rad.s)", "kd": "N.m.s/rad", "per_speed": "N.m.s/rad", "per_acceleration": "kg.m2",
    "per_direction": "N.m",
}  # fmt: skip
_AT_SHAFT = {  # attribute of the export: unit and meaning, seen at the driven shaft with gears that drive
    "inertia": ("kg.m2", "load, and rotor with gearhead input reflected"),
    "reflected_inertia": ("kg.m2", "rotor with gearhead input"),
    "friction": ("N.m", "dry friction of load and motor"),
    "damping": ("N.m.s/rad", "viscous friction of the motor"),
    "weight": ("N.m", "of the load, at the start of the motion"),
}
_CYCLE = {"time": "s", "speed": "rad/s", "load_time": "s", "load_torque": "N.m"}
_LIMITS = {
    "peak_torque": "N.m", "continuous_torque": "N.m", "peak_speed": "rad/s", "continuous_speed": "rad/s",
}  # fmt: skip
_ELECTRICAL = {"voltage": "V", "peak_current": "A", "continuous_current": "A"}


def render(of: MachineExport) -> bytes:
    """The file of a machine: of an axis alone its document, else all of them."""
    found: dict[str, Any] = {"schema_version": SCHEMA_VERSION, "program": PROGRAM, "name": of.name}
    found = document(of.alone) if of.alone else found | {"axes": [document(one) for _, one in of.exports]}
    return (as_text(found) + "\n").encode("utf-8", "backslashreplace")


def document(of: Export) -> dict[str, Any]:
    """The figures of a drive as plain data."""
    return {
        "schema_version": SCHEMA_VERSION,
        "program": of.program,
        "name": of.name,
        "set": of.label,
        "parts": of.parts,
        "motor_sets": of.motor_sets,
        "drive": {name: _figure(value, *FIGURES[name]) for name, value in _drive(of).items()},
        "controller_limits": {name: _figure(getattr(of, name), unit) for name, unit in _ELECTRICAL.items()},
        "at_shaft": {name: _figure(getattr(of, name), *what) for name, what in _AT_SHAFT.items()},
        "limits_at_shaft": {n: _limit(x, _LIMITS[n]) for n, x in of.limits._asdict().items()},
        "controller": _controller(of),
        "stepper": _stepper(of),
        "torque_law": {name: _figure(x, _LAW[name]) for name, x in _law(of).items()},
        "cycle": {name: {"unit": unit, "values": list(getattr(of.cycle, name))} for name, unit in _CYCLE.items()},
        "assumptions": list(of.said),
    }


def _drive(of: Export) -> dict[str, float]:
    """The figures of the FMU; NaN where it has a 0 for what is unknown."""
    from drivesizer.output.export.fmu import parameters

    unknown = {"inductance"} if not of.inductance_known or of.stepper else set()
    unknown |= (
        {"winding_to_housing", "housing_to_ambient", "winding_capacity", "housing_capacity"} if not of.heat else set()
    )
    found = {name: float("nan") if name in unknown else x for name, x in parameters(of).items()}
    del found["most_current"]  # stands among the controller's limits
    return found


def _figure(value: float, unit: str, said: str = "") -> dict[str, Any]:
    return {"value": float(f"{value:.12g}") if isfinite(value) else None, "unit": unit} | ({"is": said} if said else {})


def _limit(limit: Limit, unit: str) -> dict[str, Any]:
    return _figure(limit.value, unit) | {"by": limit.by or None, "unknown": list(limit.unknown)}


def _law(of: Export) -> dict[str, float]:
    """The controller as one law; unknown without one."""
    return dict.fromkeys(_LAW, nan) if of.controller is None else torque_law(of)._asdict()


def _controller(of: Export) -> dict[str, Any] | None:
    """Structure, rule and gains, at the motor shaft; null where none is designed."""
    if of.controller is None:
        return None
    figures = asdict(of.controller)
    rule, source = figures.pop("rule"), figures.pop("source")
    structure = "voltage_pid" if isinstance(of.controller, Gains) else "cascade"
    gains = {name: _figure(x, _GAINS[name]) for name, x in figures.items()}
    return {"structure": structure, "rule": rule, "source": source, "gains": gains}


def _stepper(of: Export) -> dict[str, Any] | None:
    """The model of a stepper in open loop; null of other motors."""
    if of.stepper is None:
        return None
    one = of.stepper.model
    figures = {
        "teeth": (one.teeth, "1"), "microsteps": (one.microsteps, "1"), "microstep": (one.microstep, "rad"),
        "damping_ratio": (one.damping_ratio, "1"), "natural_frequency": (one.natural_frequency, "Hz"),
    }  # fmt: skip
    curve = {"speed": {"unit": "rad/s", "values": of.stepper.speed.tolist()},
             "pull_out_torque": {"unit": "N.m", "values": one.torque.tolist()}}  # fmt: skip
    return {name: _figure(*figure) for name, figure in figures.items()} | curve


_STEPPER = ("teeth", "microsteps", "microstep", "damping_ratio", "natural_frequency")


# --- the schema


def export_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer export --format json``."""
    figure = {"$ref": "#/$defs/figure"}
    texts = {"type": "array", "items": {"type": "string"}}
    column = _all_of(unit={"type": "string"}, values={"type": "array", "items": {"type": "number"}})
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drivesizer export",
        **_all_of(
            schema_version={"const": SCHEMA_VERSION}, program={"type": "string"}, name={"type": "string"},
            set={"type": "string"}, parts={"type": "object", "additionalProperties": {"type": "string"}},
            motor_sets={"type": "integer", "minimum": 1}, drive=_alike(set(FIGURES) - {"most_current"}, figure),
            controller_limits=_alike(_ELECTRICAL, figure), at_shaft=_alike(_AT_SHAFT, figure),
            limits_at_shaft=_alike(_LIMITS, {"$ref": "#/$defs/limit"}),
            controller={"description": _NO_CONTROLLER, "anyOf": [
                _all_of(structure={"enum": ["voltage_pid", "cascade"]}, rule={"type": "string"},
                        source={"type": "string"}, gains={"type": "object", "additionalProperties": figure}),
                {"type": "null"},
            ]},
            stepper={"description": "at the motor; null: it is none", "anyOf": [
                _all_of(**dict.fromkeys(_STEPPER, figure), speed=column, pull_out_torque=column), {"type": "null"},
            ]},
            torque_law=_alike(_LAW, figure), cycle=_alike(_CYCLE, column), assumptions=texts,
        ),
        "$defs": {"figure": _FIGURE, "limit": _LIMIT},
    }  # fmt: skip


_NO_CONTROLLER = "null: none is designed, for the rotor's inertia is unknown, or the motor a stepper"
_VALUE = {"type": ["number", "null"], "description": "null: unknown"}
_UNIT = {"type": "string", "description": "SI"}
_FIGURE: dict[str, Any] = {
    "type": "object", "properties": {"value": _VALUE, "unit": _UNIT, "is": {"type": "string"}},
    "required": ["value", "unit"], "additionalProperties": False,
}  # fmt: skip
_LIMIT: dict[str, Any] = {
    "type": "object",
    "properties": {
        "value": _VALUE, "unit": _UNIT, "by": {"type": ["string", "null"]},
        "unknown": {"type": "array", "items": {"type": "string"}},
    },
    "required": ["value", "unit", "by", "unknown"], "additionalProperties": False,
}  # fmt: skip


def _alike(names: Any, schema: dict[str, Any]) -> dict[str, Any]:
    return _all_of(**dict.fromkeys(sorted(names), schema))


def _all_of(**properties: Any) -> dict[str, Any]:
    """An object that has all of these and nothing else."""
    return {"type": "object", "properties": properties, "required": list(properties), "additionalProperties": False}
