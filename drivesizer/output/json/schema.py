"""Records of the JSON documents, and the JSON Schema that is generated from them; that of a part from its columns.

null where a figure is unknown; SI where neither the key nor a ``unit`` beside it names another unit. The document of
``drivesizer size --json`` is a report without ``parts_list`` and ``validation``, that of ``drivesizer validate --json``
is ``validation`` without ``series``.
"""

# ruff: noqa: UP013 - several fields to a line, as in a table
from __future__ import annotations

from typing import Annotated, Any, Final, Literal, NamedTuple, NotRequired

from pydantic import Field, TypeAdapter
from pydantic.json_schema import GenerateJsonSchema
from typing_extensions import TypedDict

from drivesizer.catalog import columns_of
from drivesizer.catalog.tables import CONFIDENCE, ESTIMATED
from drivesizer.units import KINDS

__all__ = ["SCHEMA_VERSION", "Generator", "PartOf", "document_schema", "machine_report_schema", "report_schema"]


class PartOf(NamedTuple):
    """A part of a section: every column, in SI."""

    section: str

    def __get_pydantic_json_schema__(self, _: Any, __: Any) -> dict[str, Any]:
        fields = {
            name: {"type": ["string", "null"]}
            if column.kind == "text"
            else {"type": ["number", "null"], "description": f"{KINDS[column.kind].si}; null: unknown"}
            for name, column in columns_of(self.section).items()
        }
        return {"type": "object", "properties": fields, "required": [*fields], "additionalProperties": False}


Number = Annotated[float | None, Field(description="null: unknown")]
Count = Annotated[int, Field(ge=0)]
Text = str | None
Status = Literal["pass", "fail", "open", "unknown"]
Confidence = Annotated[str | None, Field(json_schema_extra={"enum": [*CONFIDENCE, ESTIMATED, None]})]
Version = Literal[1]
SCHEMA_VERSION: Final = 1
Method = Annotated[str, Field(json_schema_extra={"enum": ["paper", "physics"]})]

Requirement = TypedDict("Requirement", {
    "symbol": str, "equation": int | None, "value": Number, "unit": str, "si": Number, "title": str, "note": str,
})  # fmt: skip
Band = TypedDict("Band", {"low": Number, "high": Number, "least_margin": Number})
Check = TypedDict("Check", {
    "name": str, "method": str, "case": Text, "demand": Number, "limit": Number, "unit": str, "margin": Number,
    "needed_margin": float, "status": Status, "advice": bool, "at_time_s": Number, "note": str,
    "band": Annotated[Band | None, Field(description="demand at the ends of the band of estimated figures")],
})  # fmt: skip
Relaxation = TypedDict("Relaxation", {
    "field": str, "now": str, "needed": str, "set": str, "si_now": float, "si_needed": float, "si_unit": str,
})  # fmt: skip
Result = TypedDict("Result", {
    "status": Status, "smallest_margin": Number, "tightest_check": Text, "failed": list[str], "open": list[str],
    "unknown": list[str],
})  # fmt: skip
Figure = TypedDict("Figure", {"value": Number, "unit": str, "si": Number, "at_time_s": Number})
MachineFigure = TypedDict("MachineFigure", {
    "name": str, "title": str, "value": Number, "unit": str, "si": Number, "at_time_s": Number,
})  # fmt: skip
Line = TypedDict("Line", {
    "role": str, "maker": Text, "family": Text, "part": Text,
    "order_number": Annotated[Text, Field(description="null: the catalogue knows none, `part` is its own name")],
    "is": Text, "quantity": Annotated[Count, Field(description="of the whole machine")], "mass_kg": Number,
    "mass_low_kg": Annotated[Number, Field(description="5th percentile where the mass is estimated, else null")],
    "mass_high_kg": Annotated[Number, Field(description="95th percentile")],
    "price": Annotated[float | None, Field(description="of one, in the currency; null: unknown")], "currency": Text,
    "price_from_pieces": int | None, "price_date": Text, "price_source": Text, "price_confidence": Confidence,
    "part_source": Text, "part_source_date": Text, "part_confidence": Confidence, "url": Text, "note": Text,
})  # fmt: skip
Pulley = Annotated[dict[str, Any], PartOf("pulleys")]
Pulleys = TypedDict("Pulleys", {"driving": Pulley, "driven": Pulley})
Belt = TypedDict("Belt", {
    "ratio": float, "efficiency": float, "pulleys": Pulleys | None,
    "part": Annotated[dict[str, Any], PartOf("belts")] | None, "centre_distance_m": Number, "teeth_in_mesh": Number,
})  # fmt: skip
TriedScrew = TypedDict("TriedScrew", {
    "lead_m": float, "screw": Text, "mass_kg": Number, "drive": Text, "objective": Figure | None, "failed": Text,
})  # fmt: skip
Screw = TypedDict("Screw", {
    "part": Annotated[dict[str, Any], PartOf("screws")], "length_m": float, "tried": list[TriedScrew],
})  # fmt: skip
Mass = TypedDict("Mass", {
    "name": str, "number": Count, "each_kg": Number, "total_kg": Number, "band_kg": list[float] | None,
})  # fmt: skip
Consumer = TypedDict("Consumer", {
    "name": str, "number": Count, "mean_W": Number, "peak_W": Number, "share_of_time": Number, "assumed": bool,
})  # fmt: skip
Energy = TypedDict("Energy", {
    "battery": str, "consumers": list[Consumer], "figures": dict[str, Figure], "assumptions": list[str],
})  # fmt: skip
Braking = TypedDict("Braking", {
    "resistor": Annotated[dict[str, Any], PartOf("brake_resistors")] | None, "figures": dict[str, Figure],
    "assumptions": list[str],
})  # fmt: skip
Margins = TypedDict("Margins", {"p5": Number, "p50": Number, "p95": Number})
End = TypedDict("End", {"value": str, "smallest_margin": Number})
Spread = TypedDict("Spread", {"name": str, "passes": float, "fails": float, "weakest": float, "margin": Margins})
Driver = TypedDict("Driver", {
    "name": str, "share_of_variance": float, "rank_correlation": float, "at_p5": End, "at_p95": End,
})  # fmt: skip
LoopShare = TypedDict("LoopShare", {
    "samples": Count, "probability": Number, "none_fails": float, "error_95": float, "weakest_check": str,
    "unknown": list[str],
})  # fmt: skip
SampledFigure = TypedDict("SampledFigure", {"p5": Number, "p50": Number, "p95": Number, "unit": str})
Reliability = TypedDict("Reliability", {
    "probability": Number, "none_fails": float, "error_95": float, "weakest_check": str, "unknown": list[str],
    "smallest_margin": Margins, "checks": list[Spread], "figures": dict[str, SampledFigure], "drivers": list[Driver],
    "closed_loop": LoopShare | None, "closed_loop_refused": Text,
})  # fmt: skip
Estimate = TypedDict("Estimate", {
    "part": str, "figure": str, "value": float, "low": float, "high": float, "si_unit": str, "confidence": Confidence,
    "law": str,
})  # fmt: skip
Piece = TypedDict("Piece", {
    "case": str, "name": str, "start_s": float, "duration_s": float, "speed_rad_s": float, "load_torque_Nm": float,
    "motor_torque_Nm": Number, "rms_torque_Nm": Number, "current_A": Number, "rms_current_A": Number,
})  # fmt: skip
PlatformTable = TypedDict("PlatformTable", {
    "symbol": str, "title": str, "equations": list[int], "rows": list[str], "columns": list[str],
    "values": list[list[float]], "units": list[list[str]],
})  # fmt: skip
PlatformNumbers = TypedDict("PlatformNumbers", {"remarks": list[str], "tables": dict[str, PlatformTable]})
Set = TypedDict("Set", {
    "rank": Count, "status": Status, "actuator": Annotated[dict[str, Any], PartOf("actuators")] | None,
    "motor": Annotated[dict[str, Any], PartOf("motors")],
    "gearhead": Annotated[dict[str, Any], PartOf("gearheads")], "belt": Belt,
    "screw": Annotated[Screw | None, Field(description="null where it is not from a catalogue")],
    "brake": Annotated[dict[str, Any], PartOf("brakes")] | None,
    "encoder": Annotated[dict[str, Any], PartOf("encoders")] | None,
    "controller": Annotated[dict[str, Any], PartOf("controllers")] | None, "total_ratio": float, "mass_kg": Number,
    "mass_of": list[str], "objective": Number, "objective_of": list[str], "requirements": dict[str, Requirement],
    "figures": dict[str, Figure], "results": dict[str, Result], "checks": list[Check],
    "machine": list[MachineFigure], "masses": list[Mass], "energy": Energy | None,
    "braking": Annotated[
        Braking | None,
        Field(description="null: nothing is regenerated, a battery takes it, or behind the first without limits"),
    ],
    "changes": list[Relaxation],
    "reliability": Reliability | None, "pieces": list[Piece],
    "estimated": Annotated[list[Estimate], Field(description="that no data sheet gives; 5th to 95th percentile")],
    "missing": Annotated[list[str], Field(description="figures and parts that unknown checks lack")],
    "probability": Annotated[Number, Field(description="that no check fails; null where estimates leave none open")],
})  # fmt: skip
Assumption = TypedDict("Assumption", {"name": str, "tolerance": str, "source": str})
Uncertainty = TypedDict("Uncertainty", {
    "samples": Count, "seed": Count, "confidence": Number, "sets_sampled": Count, "sets_that_reach_it": Count,
    "assumptions": list[Assumption], "notes": list[str],
})  # fmt: skip
Column = list[Number]
Bode = TypedDict("Bode", {
    "thinned_from": Count, "frequency_Hz": Column, "open_magnitude": Column, "open_phase_rad": Column,
    "closed_magnitude": Column, "closed_phase_rad": Column,
})  # fmt: skip
Step = TypedDict("Step", {"thinned_from": Count, "time_s": Column, "response": Column})
Loop = TypedDict("Loop", {
    "name": str, "direction": Text, "stable": bool, "period_s": Number, "pole_radius": Number, "gain_margin": Number,
    "gain_reduction": Number, "phase_margin_rad": Number, "crossover_Hz": Number, "sensitivity": Number,
    "bandwidth_Hz": Number, "rise_time_s": Number, "overshoot": Number, "settling_time_s": Number,
    "poles": list[Annotated[Column, Field(min_length=2, max_length=2)]], "bode": Bode, "step": Step | None,
})  # fmt: skip
ControllerGain = TypedDict("ControllerGain", {"place": str, "name": str, "value": int, "unit": str})
Series = TypedDict("Series", {"thinned_from": Count, "units": dict[str, str], "columns": dict[str, Column]})
Beside = TypedDict("Beside", {"python_control": Figure, "engine": Figure | None})
Linear = TypedDict("Linear", {
    "figures": Annotated[dict[str, Beside], Field(description="by python-control and by the engine")],
    "left_out": list[str],
})  # fmt: skip
Remedy = TypedDict("Remedy", {
    "change": str, "entry": Annotated[str, Field(description="as one writes it in the spec, or the option")],
    "status": Status, "tightest": Annotated[Check | None, Field(description="the check of the smallest margin")],
})  # fmt: skip
Proof = TypedDict("Proof", {
    "schema_version": Version, "drivesizer": str, "spec": dict[str, Any], "case": str, "profile": str,
    "status": Status, "set": Set, "gains": dict[str, Any], "controller_gains": list[ControllerGain],
    "figures": dict[str, Figure], "checks": list[Check], "loops": list[Loop], "assumptions": list[str],
    "warnings": list[str],
    "linear": Annotated[Linear | None, Field(description="PID and DC motor in python-control; null: a stepper")],
    "tried": Annotated[list[Remedy], Field(description="of a drive that fails: changes simulated one at a time")],
})  # fmt: skip
Pareto = TypedDict("Pareto", {"objectives": list[str], "sets": list[Set]})
Counts = TypedDict("Counts", {
    "considered": Count, "feasible": Count, "passing": Count, "left_out": Count, "undecided": Count,
    "failed_by": dict[str, Count], "judged": Count, "failed_by_budget": dict[str, Count],
})  # fmt: skip
Sizing = TypedDict("Sizing", {
    "schema_version": Version, "drivesizer": str, "catalogs": dict[str, str], "spec": dict[str, Any],
    "method": Method, "objective": str, "requirements": dict[str, Requirement],
    "sets": list[Set],
    "alternatives": Annotated[list[Set], Field(description="the best of other motor families, in order")],
    "misses": list[Set], "relaxations": list[Relaxation], "pareto": Pareto,
    "unrestricted": Set | None, "unsure": list[Set], "uncertainty": Uncertainty | None,
    "platform_numbers": PlatformNumbers | None, "counts": Counts,
    "assumptions": list[str], "warnings": list[str],
})  # fmt: skip


Explained = TypedDict("Explained", {
    "schema_version": Version, "drivesizer": str, "sets": list[Set], "uncertainty": Uncertainty | None,
    "warnings": list[str],
})  # fmt: skip
PermittedSpeed = TypedDict("PermittedSpeed", {
    "failed_wheel": Count | None, "direction_deg": Count, "speed_m_per_s": Number, "limited_by": str,
})  # fmt: skip
Permitted = TypedDict("Permitted", {"speeds": list[PermittedSpeed], "unknown": list[str], "estimated": list[str]})
Deviation = TypedDict("Deviation", {"title": str, "si": Number, "si_unit": str, "at_time_s": float, "at_way_m": float})
Run = TypedDict("Run", {"largest": list[Deviation], "time_at_torque_limit": Number})
Measured = TypedDict("Measured", {"name": str, "position_m": float, "heading_rad": float})
OnPath = TypedDict("OnPath", {
    "permitted_speeds": Permitted | None, "measured": list[Measured], "following": dict[str, Run],
})  # fmt: skip


class Validation(Proof):
    """The closed loop of a report."""

    series: Series


class Report(Sizing):
    """``drivesizer report -o report.json``."""

    parts_list: list[Line]
    validation: Validation | None
    platform: NotRequired[OnPath]


Carried = TypedDict("Carried", {
    "axis": str, "mass_kg": float,
    "distance_m": Annotated[float | None, Field(description="null: along a line")], "unknown_mass_of": list[str],
})  # fmt: skip
MachineAxis = TypedDict("MachineAxis", {
    "drives": Count, "carried": list[Carried], "sizing": Sizing,
    "validation": NotRequired[Annotated[
        Validation | None, Field(description="of a report; null: no drive passes, or it cannot be simulated"),
    ]],
})  # fmt: skip
Exceeded = TypedDict("Exceeded", {"check": str, "limit_W": float, "share_least": Number, "share_most": Number})
Course = TypedDict("Course", {
    "time_s": Annotated[list[float], Field(description="ends of the pieces, one more than there are means")],
    "drawn_W": dict[str, list[Number]], "returned_W": dict[str, list[Number]], "total_W": list[Number],
    "left_W": Annotated[list[Number], Field(description="regenerated, that no axis draws at the same moment")],
})  # fmt: skip
MachinePower = TypedDict("MachinePower", {
    "case": Text, "synchronised": bool, "peak_W": Number, "peak_time_s": Number, "peak_axis": Text, "mean_W": Number,
    "energy_left_J": Number, "exchanged_J": Number,
    "phases_s": Annotated[dict[str, float], Field(description="at which all peaks fall together; of random ones")],
    "exceeded": list[Exceeded], "unknown": list[str], "checks": list[Check], "figures": dict[str, Figure],
    "reliability": Annotated[Reliability | None, Field(description="of the supply's limits; null: no tolerances")],
    "braking": Braking | None, "energy": Energy | None, "course": Course, "assumptions": list[str],
})  # fmt: skip
Machine = TypedDict("Machine", {
    "schema_version": Version, "drivesizer": str, "machine": dict[str, Any], "status": Status, "objective": str,
    "total": Annotated[float | None, Field(description="SI; null: unknown, or no sum")],
    "best_of_all": Annotated[bool, Field(description="no other choice of carried drives is better by the objective")],
    "power": Annotated[MachinePower | None, Field(description="null: of one axis, or an axis has no drive")],
    "axes": dict[str, MachineAxis], "notes": list[str],
})  # fmt: skip


class Generator(GenerateJsonSchema):
    """Schemas of records with their keys and no other, without the titles that only repeat their keys."""

    def typed_dict_schema(self, schema: Any) -> dict[str, Any]:
        """A record; pydantic before 2.11 does not hand a configuration to the records inside of one."""
        return {**super().typed_dict_schema(schema), "additionalProperties": False}

    def field_title_should_be_set(self, schema: Any) -> bool:
        """None of them."""
        return False


def report_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer report -o report.json``."""
    return document_schema(Report, "drivesizer report")


def machine_report_schema() -> dict[str, Any]:
    """The JSON Schema of ``drivesizer size --json`` and ``drivesizer report -o report.json`` of a machine."""
    return document_schema(Machine, "drivesizer report of a machine")


def document_schema(of: Any, title: str) -> dict[str, Any]:
    """The JSON Schema of a document."""
    every = TypeAdapter(list[of]).json_schema(schema_generator=Generator)
    document: dict[str, Any] = every["$defs"].pop(of.__name__)
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title}
    return document | dialect | {"$defs": every["$defs"]}
