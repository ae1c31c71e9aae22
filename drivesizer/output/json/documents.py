"""``--json``: documents for other programs. null where a figure is unknown, never NaN."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import fields
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

from drivesizer.catalog import Actuator, Belt, Brake, BrakeResistor, Controller, Encoder, Gearhead, Motor, Pulley
from drivesizer.catalog.more_parts import Screw
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.control.validation import LinearRun, Validation
from drivesizer.output.json.loops import loop_document, number
from drivesizer.output.json.reliability import reliability, uncertainty
from drivesizer.results.braking import BrakingBudget
from drivesizer.results.drive_set import DriveSet, Relaxation
from drivesizer.results.energy import EnergyBudget
from drivesizer.results.estimated import EstimatedFigure
from drivesizer.results.figures_behind_checks import missing_figures
from drivesizer.results.mass import MassRow
from drivesizer.results.pieces import MotorPiece
from drivesizer.results.requirement import Requirement
from drivesizer.results.sizing import Check, Explanation, Figure, SizingResult, verdict, worst
from drivesizer.units import KINDS, from_si
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["SCHEMA_VERSION", "as_text", "drive_set", "explanation", "plain_data", "requirement", "sizing", "validation"]

SCHEMA_VERSION: Final = 1


def as_text(document: Mapping[str, Any]) -> str:
    """A document as JSON text; unknown or unbounded figures are null."""
    return json.dumps(plain_data(document), allow_nan=False, ensure_ascii=False, indent=2)


def plain_data(value: Any) -> Any:
    """Plain data of which every figure that is unknown or unbounded is None."""
    if isinstance(value, float):
        return number(value)
    if isinstance(value, dict):
        return {key: plain_data(inner) for key, inner in value.items()}
    return [plain_data(inner) for inner in value] if isinstance(value, list | tuple) else value


def requirement(r: Requirement) -> schema.Requirement:
    """A requirement."""
    return {
        "symbol": r.symbol,
        "equation": r.equation,
        "value": number(r.shown),
        "unit": r.unit,
        "si": number(r.value),
        "title": r.title,
        "note": r.note,
    }


def _part(
    part: Actuator | Motor | Gearhead | Belt | Pulley | Screw | Brake | BrakeResistor | Encoder | Controller,
) -> dict[str, Any]:
    """A part with all its figures in SI."""
    values = {f.name: getattr(part, f.name) for f in fields(part)}
    return {k: number(v) if isinstance(v, float) else (v or None) for k, v in values.items()}


def check_document(check: Check) -> schema.Check:
    """A check, its demand and limit in the unit of the trade."""

    def shown(value: float) -> float | None:
        return number(from_si(value, check.unit, check.kind)) if isfinite(value) else None

    return {
        "name": check.name,
        "method": check.method,
        "case": check.case or None,
        "demand": shown(check.demand),
        "limit": shown(check.limit),
        "unit": check.unit,
        "margin": number(check.margin),
        "needed_margin": check.needed,
        "status": check.status,
        "advice": check.advice,
        "at_time_s": check.at_time,
        "note": check.note,
        "band": _band(check, shown),
    }


def _band(check: Check, shown: Callable[[float], float | None]) -> schema.Band | None:
    if check.band is None:
        return None
    low, high, least_margin = check.band
    return {"low": shown(low), "high": shown(high), "least_margin": number(least_margin)}


def _relaxation(r: Relaxation) -> schema.Relaxation:
    return {
        "field": r.field,
        "now": r.now,
        "needed": r.needed,
        "set": r.set_label,
        "si_now": r.before,
        "si_needed": r.after,
        "si_unit": KINDS[r.kind].si,
    }


def _result(checks: tuple[Check, ...]) -> schema.Result:
    tightest = worst(checks)
    return {
        "status": verdict(checks),
        "smallest_margin": number(tightest.margin) if tightest else None,
        "tightest_check": tightest.name if tightest else None,
        "failed": [c.name for c in checks if c.status == "fail" and not c.advice],
        "open": [c.name for c in checks if c.status == "open" and not c.advice],
        "unknown": [c.name for c in checks if c.status == "unknown" and not c.advice],
    }


def _belt(found: DriveSet) -> schema.Belt:
    """Ratio and efficiency; pulleys and belt, null where they are not from a catalogue."""
    drive = found.belt_drive
    return {
        "ratio": found.belt_ratio,
        "efficiency": found.belt_efficiency,
        "pulleys": {"driving": _part(drive.driving), "driven": _part(drive.driven)} if drive else None,
        "part": _part(drive.belt) if drive else None,
        "centre_distance_m": drive.centre_distance if drive else None,
        "teeth_in_mesh": drive.teeth_in_mesh if drive else None,
    }


def _screw(found: DriveSet) -> schema.Screw | None:
    """Nut and shaft out of a catalogue, and the length of the shaft."""
    chosen = found.chosen_screw
    if chosen is None:
        return None
    return {"part": _part(chosen.screw), "length_m": chosen.length}


def drive_set(found: DriveSet) -> schema.Set:
    """One drive."""
    return {
        "rank": found.rank,
        "status": found.status,
        "actuator": _part(found.actuator) if found.actuator else None,
        "motor": _part(found.motor),
        "gearhead": _part(found.gearhead),
        "belt": _belt(found),
        "screw": _screw(found),
        "brake": _part(found.brake) if found.brake else None,
        "encoder": _part(found.encoder) if found.encoder else None,
        "controller": _part(found.controller) if found.controller else None,
        "total_ratio": found.total_ratio,
        "mass_kg": number(found.mass),
        "mass_of": list(found.mass_of),
        "objective": number(found.objective),
        "objective_of": list(found.objective_of),
        "requirements": {r.name: requirement(r) for r in found.requirements},
        "figures": {figure.name: figure_document(figure) for figure in found.figures},
        "results": {
            checks[0].method: _result(checks) for checks in (found.checks, found.beside, found.budget) if checks
        },
        "checks": [check_document(check) for check in found.every_check],
        "machine": [{"name": f.name, "title": f.title, **figure_document(f)} for f in found.machine],
        "masses": [_mass(row) for row in found.masses],
        "energy": energy_document(found.energy) if found.energy else None,
        "braking": braking_document(found.braking) if found.braking else None,
        "changes": [_relaxation(r) for r in found.changes],
        "reliability": reliability(found.reliability),
        "pieces": [_piece(one) for one in found.pieces],
        "estimated": [_estimate(one) for one in found.estimated],
        "missing": missing_figures(found),
        "probability": number(found.probability),
    }


def _piece(one: MotorPiece) -> schema.Piece:
    """The motor in one piece of the motion."""
    return {"case": one.case, "name": one.name, "start_s": one.start, "duration_s": one.duration,
            "speed_rad_s": one.speed, "load_torque_Nm": one.load_torque, "motor_torque_Nm": number(one.motor_torque),
            "rms_torque_Nm": number(one.rms_torque), "current_A": number(one.current),
            "rms_current_A": number(one.rms_current)}  # fmt: skip


def _estimate(one: EstimatedFigure) -> schema.Estimate:
    return {"part": one.part, "figure": one.figure, "value": one.value, "low": one.low, "high": one.high,
            "si_unit": KINDS[one.kind].si, "confidence": ESTIMATED, "law": one.law}  # fmt: skip


def _mass(row: MassRow) -> schema.Mass:
    """A line of the masses of the machine."""
    return {"name": row.name, "number": row.number, "each_kg": number(row.each), "total_kg": number(row.total),
            "band_kg": list(row.band) if row.band else None}  # fmt: skip


def energy_document(budget: EnergyBudget) -> schema.Energy:
    """Consumers and figures of the battery; null is unknown, or unbounded where nothing is drawn."""
    return {
        "battery": budget.battery,
        "consumers": [
            {
                "name": one.name,
                "number": one.number,
                "mean_W": number(one.mean),
                "peak_W": number(one.peak),
                "share_of_time": number(one.duty),
                "assumed": one.assumed,
            }
            for one in budget.consumers
        ],
        "figures": {figure.name: figure_document(figure) for figure in budget.figures},
        "assumptions": list(budget.assumptions),
    }


def braking_document(budget: BrakingBudget) -> schema.Braking:
    """Figures of regenerated energy, and the resistor that burns it; null is unknown, or unbounded."""
    return {
        "resistor": _part(budget.resistor) if budget.resistor else None,
        "figures": {figure.name: figure_document(figure) for figure in budget.figures},
        "assumptions": list(budget.assumptions),
    }


def _platform(result: SizingResult) -> schema.PlatformNumbers | None:
    """Kinematics and dynamics of the platform in numbers."""
    if result.spec.platform is None:
        return None
    from drivesizer.output.platform_numbers import platform_numbers  # with what a spec without one need not load

    found = platform_numbers(result.spec, result.shown)
    tables: dict[str, schema.PlatformTable] = {
        one.name: {
            "symbol": one.symbol, "title": one.meaning, "equations": list(one.equations), "rows": list(one.rows),
            "columns": list(one.columns), "values": one.values.tolist(), "units": one.units,
        } for one in found.every
    }  # fmt: skip
    return {"remarks": [found.rotors, found.moment], "tables": tables}


def sizing(result: SizingResult) -> schema.Sizing:
    """The document of ``drivesizer size --json``."""
    method = result.method
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "catalogs": dict(result.catalog.digests),
        "spec": result.spec.entered,
        "method": method,
        "objective": result.objective,
        "requirements": {r.name: requirement(r) for r in result.requirements},
        "sets": [drive_set(s) for s in result.sets],
        "alternatives": [drive_set(s) for s in result.alternatives],
        "misses": [drive_set(s) for s in result.misses],
        "relaxations": [_relaxation(r) for r in result.relaxations],
        "pareto": {"objectives": list(result.pareto), "sets": [drive_set(s) for s in result.front]},
        "unrestricted": drive_set(result.unrestricted) if result.unrestricted else None,
        "unsure": [drive_set(s) for s in result.unsure],
        "uncertainty": uncertainty(result.uncertainty),
        "platform_numbers": _platform(result),
        "counts": {
            "considered": result.counts.considered,
            "feasible": result.counts.feasible,
            "passing": result.counts.passing,
            "left_out": result.counts.left_out,
            "undecided": result.counts.undecided,
            "failed_by": result.counts.failed_by,
            "judged": result.counts.judged,
            "failed_by_budget": result.counts.failed_by_budget,
        },
        "assumptions": list(result.assumptions),
        "warnings": list(result.warnings),
    }


def explanation(found: Explanation) -> dict[str, Any]:
    """The document of ``drivesizer explain --json``."""
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "sets": [drive_set(s) for s in found.sets],
        "uncertainty": uncertainty(found.uncertainty),
        "warnings": list(found.warnings),
    }


def figure_document(figure: Figure) -> schema.Figure:
    """A figure without a limit, in the unit of the trade and in SI."""
    shown = number(from_si(figure.value, figure.unit, figure.kind)) if isfinite(figure.value) else None
    return {"value": shown, "unit": figure.unit, "si": number(figure.value), "at_time_s": figure.at_time}


def validation(proof: Validation) -> schema.Proof:
    """The document of ``drivesizer validate --json``."""
    gains = proof.gains
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "spec": proof.spec.entered,
        "case": proof.case,
        "profile": proof.profile,
        "status": proof.status,
        "set": drive_set(proof.drive_set),
        "gains": {f.name: getattr(gains, f.name) for f in fields(gains)},
        "controller_gains": [
            {"place": gain.place, "name": gain.name, "value": gain.value, "unit": gain.unit}
            for gain in proof.controller_gains
        ],
        "figures": {figure.name: figure_document(figure) for figure in proof.figures},
        "checks": [check_document(check) for check in proof.checks],
        "loops": [loop_document(loop) for loop in proof.loops],
        "assumptions": list(proof.assumptions),
        "warnings": list(proof.warnings),
        "linear": _linear(proof.linear) if proof.linear else None,
        "tried": [
            {
                "change": one.what,
                "entry": one.entry,
                "status": one.status,
                "tightest": check_document(one.tightest) if one.tightest else None,
            }
            for one in proof.tried
        ],
    }


def _linear(run: LinearRun) -> schema.Linear:
    """The simulation by python-control, beside the engine's."""
    figures: dict[str, schema.Beside] = {
        one.linear.name: {
            "python_control": figure_document(one.linear),
            "engine": figure_document(one.engine) if one.engine else None,
        }
        for one in run.figures
    }
    return {"figures": figures, "left_out": list(run.left_out)}
