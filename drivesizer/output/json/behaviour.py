"""JSON of a platform on its path and of a set at the bench, and the JSON Schema of the latter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field, TypeAdapter
from typing_extensions import TypedDict

from drivesizer.control.path_following.following import Followed, extremes
from drivesizer.load_cases.platform import Driving, Wheel
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output.json.documents import SCHEMA_VERSION, drive_set, number, requirement
from drivesizer.output.json.schema import Assumption, Column, Count, Generator, Number, Version
from drivesizer.results.drive_set import DriveSet, EstimatedFigure
from drivesizer.results.prediction import Band, Predicted, Prediction, WarmingCourse
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import KINDS, from_si
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["driving", "path_document", "prediction", "prediction_schema"]


# -- The JSON document of a platform on its path.


def driving(
    found: Driving, chosen: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None = None
) -> dict[str, Any]:
    """The document of ``drivesizer drive --json``.

    Parameters
    ----------
    found
        The platform on its path.
    chosen
        The drive; None without one.
    runs
        Simulated path following, by name.
    speeds
        That the drive permits; None without one.

    Returns
    -------
    dict
        Plain data.
    """
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "spec": found.spec.entered,
        "trajectory": getattr(found.spec.motion, "trajectory", None),
        "length_m": found.trajectory.length,
        "time_s": found.trajectory.total,
        "wheels": [_wheel(wheel) for wheel in found.wheels],
        "set": drive_set(chosen) if chosen else None,
        **path_document(found.spec, speeds, runs),
    }


def path_document(spec: RobotSpec, speeds: PermittedSpeeds | None, runs: Mapping[str, Followed]) -> schema.OnPath:
    """Speeds that a platform's drives permit, and simulated path following beside measured errors."""
    return {
        "permitted_speeds": _permitted(speeds) if speeds else None,
        "measured": _measured(spec),
        "following": {name: _run(run) for name, run in runs.items()},
    }


def _permitted(speeds: PermittedSpeeds) -> schema.Permitted:
    """Highest steady speeds by failed wheel and direction."""
    every: list[schema.PermittedSpeed] = [
        {"failed_wheel": failed or None, "direction_deg": degrees, "speed_m_per_s": number(speed), "limited_by": limit}
        for failed in speeds.speed
        for degrees in speeds.direction.tolist()
        for speed, limit in [speeds.at(degrees)[failed]]
    ]
    return {"speeds": every, "unknown": [*speeds.unknown], "estimated": [*speeds.estimated]}


def _measured(spec: RobotSpec) -> list[schema.Measured]:
    """Measured errors that the spec states."""
    section = spec.platform
    measured = section.following.measured if section else []
    return [{"name": one.name, "position_m": one.position, "heading_rad": one.heading} for one in measured]


def _run(run: Followed) -> schema.Run:
    """Largest deviations of a run."""
    largest: list[schema.Deviation] = [
        {
            "title": e.title,
            "si": number(e.value),
            "si_unit": KINDS[e.kind].si,
            "at_time_s": e.time,
            "at_way_m": e.travel,
        }
        for e in extremes(run)
    ]
    return {"largest": largest, "time_at_torque_limit": number(float(run.limited.max()))}


def _wheel(wheel: Wheel) -> dict[str, Any]:
    grip = wheel.grip
    return {
        "number": wheel.number,
        "requirements": {r.name: requirement(r) for r in wheel.requirements},
        "force_on_the_floor_N": number(grip.demand) if grip else None,
        "grip_N": number(grip.limit) if grip else None,
        "at_time_s": number(grip.time) if grip else None,
    }


# -- ``drivesizer predict --json``: the document, and the JSON Schema that is generated from its records.


# ruff: noqa: UP013 - several fields to a line, as in a table


Missing = Annotated[list[str], Field(description="figures that no data sheet gives, where the value is unknown")]
Never = Annotated[float | None, Field(description="share of the samples in which it is never reached")]
Sold = Annotated[dict[str, str], Field(description="part number by role: motor or actuator, gearhead, controller")]

Percentiles = TypedDict("Percentiles", {"value": Column, "p5": Column, "p50": Column, "p95": Column})
BenchFigure = TypedDict("BenchFigure", {
    "group": str, "title": str, "value": Number, "p5": Number, "p50": Number, "p95": Number, "unit": str,
    "never": Never, "missing": Missing,
})  # fmt: skip
BenchConditions = TypedDict("BenchConditions", {
    "voltage_V": Number, "ambient_degC": Number, "load_Nm": Number, "hold_Nm": Number, "inertia_kgm2": Number,
    "duration_s": Number, "warm_degC": Number, "resistance_ohm": Number,
})  # fmt: skip
SpeedLine = TypedDict("SpeedLine", {"torque_Nm": Column, "speed_rad_per_s": Percentiles})
TemperatureCourse = TypedDict("TemperatureCourse", {
    "title": str, "time_s": Column, "winding_degC": Percentiles, "housing_degC": Percentiles,
})  # fmt: skip
EstimatedOf = TypedDict("EstimatedOf", {
    "part": str, "figure": str, "value": float, "p5": float, "p95": float, "unit": str, "law": str,
})  # fmt: skip
BenchPrediction = TypedDict("BenchPrediction", {
    "schema_version": Version, "drivesizer": str, "catalogs": dict[str, str], "parts": Sold, "set": str,
    "conditions": BenchConditions, "figures": dict[str, BenchFigure], "line": SpeedLine,
    "courses": dict[str, TemperatureCourse], "winding_limit_degC": Number, "estimates": list[EstimatedOf],
    "tolerances": list[Assumption], "samples": Count, "assumptions": list[str], "warnings": list[str],
})  # fmt: skip


def prediction(found: Prediction) -> BenchPrediction:
    """The document of ``drivesizer predict --json``."""
    given = found.conditions
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "catalogs": found.digests,
        "parts": found.parts,
        "set": found.label,
        "conditions": {
            "voltage_V": number(given.voltage),
            "ambient_degC": _celsius(given.ambient),
            "load_Nm": number(given.load),
            "hold_Nm": number(given.hold),
            "inertia_kgm2": number(given.inertia),
            "duration_s": number(given.duration),
            "warm_degC": _celsius(given.warm),
            "resistance_ohm": number(given.resistance),
        },
        "figures": {one.name: _figure(one) for one in found.figures},
        "line": {"torque_Nm": found.torque.tolist(), "speed_rad_per_s": _columns(found.speed)},
        "courses": {one.name: _course(one) for one in found.courses},
        "winding_limit_degC": _celsius(found.limit),
        "estimates": [_estimate(one) for one in found.estimates],
        "tolerances": [{"name": name, "tolerance": text, "source": why} for name, text, why in found.tolerances],
        "samples": found.samples,
        "assumptions": list(found.assumptions),
        "warnings": list(found.warnings),
    }


def _celsius(kelvin: float) -> float | None:
    return number(float(from_si(kelvin, "degC", "temperature")))


def _figure(one: Predicted) -> BenchFigure:
    value, low, middle, high = (number(float(from_si(x, one.unit, one.kind))) for x in one.band)
    return {
        "group": one.group,
        "title": one.title,
        "value": value,
        "p5": low,
        "p50": middle,
        "p95": high,
        "unit": one.unit,
        "never": number(one.never),
        "missing": list(one.missing),
    }


def _columns(band: Band, kind: str = "rotary_speed", unit: str = "rad/s") -> Percentiles:
    nominal, low, middle, high = ([number(x) for x in np.asarray(from_si(y, unit, kind)).tolist()] for y in band)
    return {"value": nominal, "p5": low, "p50": middle, "p95": high}


def _course(one: WarmingCourse) -> TemperatureCourse:
    winding, housing = (_columns(band, "temperature", "degC") for band in (one.winding, one.housing))
    return {"title": one.title, "time_s": one.time.tolist(), "winding_degC": winding, "housing_degC": housing}


def _estimate(one: EstimatedFigure) -> EstimatedOf:
    value, low, high = (float(from_si(x, one.unit, one.kind)) for x in (one.value, one.low, one.high))
    return {"part": one.part, "figure": one.figure, "value": value, "p5": low, "p95": high, "unit": one.unit,
            "law": one.law}  # fmt: skip


def prediction_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer predict --json``."""
    made = TypeAdapter(list[BenchPrediction]).json_schema(schema_generator=Generator)
    document: dict[str, Any] = made["$defs"].pop("BenchPrediction")
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "drivesizer prediction"}
    return document | dialect | {"$defs": made["$defs"]}
