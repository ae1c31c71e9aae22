"""``drivesizer predict --json``: the document, and the JSON Schema that is generated from its records."""

# ruff: noqa: UP013 - several fields to a line, as in a table
from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from pydantic import Field, TypeAdapter
from typing_extensions import TypedDict

from drivesizer.output.json.documents import SCHEMA_VERSION
from drivesizer.output.json.loops import number
from drivesizer.output.json.schema import Assumption, Column, Count, Generator, Number, Version
from drivesizer.results.estimated import EstimatedFigure
from drivesizer.results.prediction import Band, Predicted, Prediction, WarmingCourse
from drivesizer.units import from_si
from drivesizer.version import __version__

__all__ = ["prediction", "prediction_schema"]

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
