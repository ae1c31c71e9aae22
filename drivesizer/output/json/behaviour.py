"""JSON of a platform on its path and of a set at the bench, and the JSON Schema of the latter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, cast

import numpy as np
from pydantic import Field
from typing_extensions import TypedDict

from drivesizer.control.path_following.following import Followed, extremes
from drivesizer.load_cases.platform import Driving
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output.json import schema
from drivesizer.output.json.documents import SCHEMA_VERSION, written
from drivesizer.output.json.schema import Assumption, Column, Count, Number, Version
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.prediction import Prediction
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import KINDS, from_si
from drivesizer.version import __version__

__all__ = ["driving", "path_document", "prediction", "prediction_schema"]


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
    wheels = [
        {
            "number": wheel.number,
            "requirements": written(dict[str, schema.Requirement], wheel.requirements),
            "force_on_the_floor_N": written(Number, wheel.grip and wheel.grip.demand),
            "grip_N": written(Number, wheel.grip and wheel.grip.limit),
            "at_time_s": written(Number, wheel.grip and wheel.grip.time),
        }
        for wheel in found.wheels
    ]
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "spec": found.spec.entered,
        "trajectory": getattr(found.spec.motion, "trajectory", None),
        "length_m": found.trajectory.length,
        "time_s": found.trajectory.total,
        "wheels": wheels,
        "set": written(schema.Set, chosen),
        **path_document(found.spec, speeds, runs),
    }


def path_document(spec: RobotSpec, speeds: PermittedSpeeds | None, runs: Mapping[str, Followed]) -> schema.OnPath:
    """Highest steady speeds by failed wheel and direction, and simulated path following beside measured errors."""
    permitted = speeds and {
        "speeds": [
            {"failed_wheel": failed or None, "direction_deg": degrees, "speed_m_per_s": speed, "limited_by": limit}
            for failed in speeds.speed
            for degrees in speeds.direction.tolist()
            for speed, limit in [speeds.at(degrees)[failed]]
        ],
        "unknown": speeds.unknown,
        "estimated": speeds.estimated,
    }
    following = {}
    for name, run in runs.items():
        largest = [
            {"title": e.title, "si": e.value, "si_unit": KINDS[e.kind].si, "at_time_s": e.time, "at_way_m": e.travel}
            for e in extremes(run)
        ]
        following[name] = {"largest": largest, "time_at_torque_limit": float(run.limited.max())}
    measured = [
        {"name": one.name, "position_m": one.position, "heading_rad": one.heading}
        for one in (spec.platform.following.measured if spec.platform else [])
    ]
    found = {"permitted_speeds": permitted, "measured": measured, "following": following}
    return cast("schema.OnPath", written(schema.OnPath, found))


# ``drivesizer predict --json``.


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

    def celsius(kelvin: float) -> float:
        return float(from_si(kelvin, "degC", "temperature"))

    def percentiles(band: Any, kind: str, unit: str) -> dict[str, Any]:
        columns = (np.asarray(from_si(values, unit, kind)).tolist() for values in band)
        return dict(zip(("value", "p5", "p50", "p95"), columns, strict=True))

    given = found.conditions
    figures, courses = {}, {}
    for one in found.figures:
        value, low, middle, high = (float(from_si(x, one.unit, one.kind)) for x in one.band)
        figures[one.name] = {
            "group": one.group, "title": one.title, "value": value, "p5": low, "p50": middle, "p95": high,
            "unit": one.unit, "never": one.never, "missing": one.missing,
        }  # fmt: skip
    for course in found.courses:
        bodies = {"winding_degC": course.winding, "housing_degC": course.housing}
        bands = {name: percentiles(band, "temperature", "degC") for name, band in bodies.items()}
        courses[course.name] = {"title": course.title, "time_s": course.time.tolist()} | bands
    estimates = []
    for part in found.estimates:
        value, low, high = (float(from_si(x, part.unit, part.kind)) for x in (part.value, part.low, part.high))
        named = {"part": part.part, "figure": part.figure, "value": value, "p5": low, "p95": high}
        estimates.append(named | {"unit": part.unit, "law": part.law})
    document = {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "catalogs": found.digests,
        "parts": found.parts,
        "set": found.label,
        "conditions": {
            "voltage_V": given.voltage, "ambient_degC": celsius(given.ambient), "load_Nm": given.load,
            "hold_Nm": given.hold, "inertia_kgm2": given.inertia, "duration_s": given.duration,
            "warm_degC": celsius(given.warm), "resistance_ohm": given.resistance,
        },
        "figures": figures,
        "line": {
            "torque_Nm": found.torque.tolist(), "speed_rad_per_s": percentiles(found.speed, "rotary_speed", "rad/s"),
        },
        "courses": courses,
        "winding_limit_degC": celsius(found.limit),
        "estimates": estimates,
        "tolerances": [{"name": name, "text": text, "source": why} for name, text, why in found.tolerances],
        "samples": found.samples,
        "assumptions": found.assumptions,
        "warnings": found.warnings,
    }  # fmt: skip
    return cast("BenchPrediction", written(BenchPrediction, document))


def prediction_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer predict --json``."""
    return schema.document_schema(BenchPrediction, "drivesizer prediction")
