"""--json: documents for other programs, of a sizing, its loops and probabilities, and of a machine."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from math import isfinite
from typing import TYPE_CHECKING, Any, Final, cast

from drivesizer.catalog import Actuator, Belt, Brake, BrakeResistor, Controller, Encoder, Gearhead, Motor, Pulley
from drivesizer.catalog.parts import Screw, columns
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.control.validation import Bode, LinearRun, Loop, Validation
from drivesizer.output.loop_table import settled
from drivesizer.output.parts import HEADS, PartLine, machine_parts
from drivesizer.output.thinning import curve_points
from drivesizer.results.check import Driver, FigureSpread, LoopShare, Reliability, Spread, Uncertainty
from drivesizer.results.check_kinds import missing_figures
from drivesizer.results.drive_set import (
    BrakingBudget,
    DriveSet,
    EnergyBudget,
    EstimatedFigure,
    MassRow,
    MotorPiece,
    Relaxation,
    Requirement,
)
from drivesizer.results.machine import AxisSizing, MachinePower, MachineSizing
from drivesizer.results.sizing import Check, Explanation, Figure, SizingResult, verdict, worst
from drivesizer.units import KINDS, from_si
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = [
    "MOST_SAMPLES", "SCHEMA_VERSION", "as_text", "document", "drive_set", "explanation", "machine_document", "number",
    "plain_data", "reliability", "requirement", "sizing", "uncertainty", "validation",
]  # fmt: skip


# -- A loop in the JSON document: linear analysis with its curves.


def number(value: float) -> float | None:
    """A figure as JSON has it: None where it is unknown or unbounded."""
    return float(value) if isfinite(value) else None


_LOOP = (  # key of the document, attribute of a loop; SI, the unit in the key
    ("period_s", "period"),
    ("pole_radius", "pole_radius"),
    ("gain_margin", "gain_margin"),
    ("gain_reduction", "gain_reduction"),
    ("phase_margin_rad", "phase_margin"),
    ("crossover_Hz", "crossover"),
    ("sensitivity", "sensitivity"),
    ("bandwidth_Hz", "bandwidth"),
    ("rise_time_s", "rise_time"),
    ("overshoot", "overshoot"),
    ("settling_time_s", "settling_time"),
)
_MOST_POINTS = 200  # of a curve


def loop_document(loop: Loop) -> schema.Loop:
    """A loop with its poles in the z plane as [re, im]; null where a figure does not exist."""
    found = {
        "name": loop.name,
        "direction": loop.direction or None,
        "stable": loop.stable,
        **{key: number(getattr(loop, name)) for key, name in _LOOP},
        "poles": [[number(pole.real), number(pole.imag)] for pole in loop.poles],
        "bode": _bode(loop.bode),
        "step": _step(loop),
    }
    return cast("schema.Loop", found)


def _bode(bode: Bode) -> schema.Bode:
    """Curves over the frequency; ``thinned_from`` says how many points were computed, peaks are kept."""
    rows = curve_points((bode.open_magnitude, bode.closed_magnitude), _MOST_POINTS)
    columns = {
        "frequency_Hz": bode.frequency,
        "open_magnitude": bode.open_magnitude,
        "open_phase_rad": bode.open_phase,
        "closed_magnitude": bode.closed_magnitude,
        "closed_phase_rad": bode.closed_phase,
    }
    thinned = {k: [number(x) for x in v[rows]] for k, v in columns.items()}
    return cast("schema.Bode", {"thinned_from": len(bode.frequency), **thinned})


def _step(loop: Loop) -> schema.Step | None:
    """Response to a unit step until it has settled, thinned as the curves are; None of an unstable loop."""
    if not len(loop.step):
        return None
    rows = curve_points((loop.step[: settled(loop)],), _MOST_POINTS)
    return {
        "thinned_from": len(loop.step),
        "time_s": [number(n * loop.period) for n in rows],
        "response": [number(x) for x in loop.step[rows]],
    }


# -- Probabilities in the JSON document; null where a figure is unknown or there is none.


def reliability(found: Reliability | None) -> schema.Reliability | None:
    """Probabilities and quantiles of a sampled drive."""
    if found is None:
        return None
    return {
        "probability": number(found.passing),
        "none_fails": found.probability,
        "error_95": found.error,
        "weakest_check": found.weakest,
        "unknown": list(found.unknown),
        "smallest_margin": _margins(found.low, found.middle, found.high),
        "checks": [_spread(one) for one in found.checks],
        "figures": {one.name: _figure(one) for one in found.figures},
        "drivers": [_driver(one) for one in found.drivers],
        "closed_loop": _loop(found.loop),
        "closed_loop_refused": found.no_loop or None,
    }


def _margins(low: float, middle: float, high: float) -> schema.Margins:
    return {"p5": number(low), "p50": number(middle), "p95": number(high)}


def _spread(one: Spread) -> schema.Spread:
    return {
        "name": one.name,
        "passes": one.passes,
        "fails": one.fails,
        "weakest": one.weakest,
        "margin": _margins(one.low, one.middle, one.high),
    }


def _figure(one: FigureSpread) -> schema.SampledFigure:
    p5, p50, p95 = (
        number(float(from_si(x, one.unit, one.kind))) if x == x else None for x in (one.low, one.middle, one.high)
    )
    return {"p5": p5, "p50": p50, "p95": p95, "unit": one.unit}


def _driver(one: Driver) -> schema.Driver:
    return {
        "name": one.name,
        "share_of_variance": one.share,
        "rank_correlation": one.rank_correlation,
        "at_p5": {"value": one.low, "smallest_margin": number(one.low_margin)},
        "at_p95": {"value": one.high, "smallest_margin": number(one.high_margin)},
    }


def _loop(found: LoopShare | None) -> schema.LoopShare | None:
    if found is None:
        return None
    return {
        "samples": found.samples,
        "probability": number(found.passing),
        "none_fails": found.probability,
        "error_95": found.error,
        "weakest_check": found.weakest,
        "unknown": list(found.unknown),
    }


def uncertainty(found: Uncertainty | None) -> schema.Uncertainty | None:
    """Uncertain figures, and the sampling."""
    if found is None:
        return None
    return {
        "samples": found.samples,
        "seed": found.seed,
        "confidence": found.confidence,
        "sets_sampled": found.examined,
        "sets_that_reach_it": found.reached,
        "assumptions": [{"name": one.name, "tolerance": one.text, "source": one.source} for one in found.assumptions],
        "notes": list(found.notes),
    }


# -- ``--json``: documents for other programs. null where a figure is unknown, never NaN.


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
    values = {name: getattr(part, name) for name in columns(type(part))}
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
    from drivesizer.output.platform import platform_numbers  # with what a spec without one need not load

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


# -- JSON: the document of ``drivesizer size --json`` with parts list and closed loop in it, for other programs.
#
# null where a figure is unknown, never NaN; figures are SI where the key names no other unit. The schema is in
# ``schema``.


MOST_SAMPLES = 2000  # of the time series: finer than a screen


def document(result: SizingResult, proof: Validation | None) -> schema.Report:
    """Sizing, parts list and closed loop as one document."""
    parts = machine_parts(result.sets[0], result.problem) if result.sets else []
    found = simulated(proof) if proof else None
    more = {"parts_list": [_line(line) for line in parts], "validation": found}
    return cast("schema.Report", {**sizing(result), **more})


def simulated(proof: Validation) -> schema.Validation:
    """The closed loop of a report: the document of ``drivesizer validate --json`` with the series over time."""
    return {**validation(proof), "series": _series(proof)}


def _line(line: PartLine) -> schema.Line:
    found = {HEADS.get(name, name): _known(value) for name, value in asdict(line).items()}
    return cast("schema.Line", found)


def _known(value: Any) -> Any:
    if isinstance(value, float):
        return value if isfinite(value) else None
    return None if value == "" else value


def _series(proof: Validation) -> schema.Series:
    """Columns over time in SI; ``thinned_from`` says how many samples were recorded."""
    rows = curve_points(tuple(proof.series.values()), MOST_SAMPLES)
    return {
        "thinned_from": len(proof.series["time"]),
        "units": {name: KINDS[kind].si for name, (kind, _) in proof.series_units.items()},
        "columns": {name: [_known(x) for x in values[rows].tolist()] for name, values in proof.series.items()},
    }


# -- ``--json`` of a machine: the documents of its axes, and what concerns all of them.


def machine_document(result: MachineSizing, proofs: Mapping[str, Validation] | None = None) -> schema.Machine:
    """The document of ``drivesizer size --json`` of a machine, or of its report."""
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "machine": result.machine.entered,
        "status": result.status,
        "objective": result.objective,
        "total": number(result.total),
        "best_of_all": result.certain,
        "power": _power(result.power) if result.power else None,
        "axes": {axis.name: _axis(axis, proofs) for axis in result.axes},
        "notes": list(result.notes),
    }


def _axis(axis: AxisSizing, proofs: Mapping[str, Validation] | None) -> schema.MachineAxis:
    """An axis with the drives that ride on it; in a report its closed loop, as in that of it alone."""
    found: schema.MachineAxis = {
        "drives": axis.drives,
        "carried": [
            {"axis": one.of, "mass_kg": one.mass, "distance_m": one.distance, "unknown_mass_of": list(one.lacking)}
            for one in axis.carried
        ],
        "sizing": sizing(axis.result),
    }
    if proofs is not None:
        proof = proofs.get(axis.name)
        found["validation"] = simulated(proof) if proof else None
    return found


def _power(power: MachinePower) -> schema.MachinePower:
    """All axes on their supply; null is unknown."""
    course = power.course()
    return {
        "case": power.case or None,
        "synchronised": power.synchronised,
        "peak_W": number(power.peak),
        "peak_time_s": number(power.peak_time),
        "peak_axis": power.peak_axis or None,
        "mean_W": number(power.mean),
        "energy_left_J": number(power.energy_left),
        "exchanged_J": number(power.exchanged),
        "phases_s": dict(zip(power.axes, power.phases, strict=False)),
        "exceeded": [
            {"check": one.check, "limit_W": one.limit, "share_least": number(one.least), "share_most": number(one.most)}
            for one in power.exceeded
        ],
        "unknown": list(power.unknown),
        "checks": [check_document(one) for one in power.checks],
        "figures": {one.name: figure_document(one) for one in power.figures},
        "reliability": reliability(power.reliability),
        "braking": braking_document(power.braking) if power.braking else None,
        "energy": energy_document(power.energy) if power.energy else None,
        "course": {
            "time_s": course.time.tolist(),
            "drawn_W": {name: _column(row) for name, row in zip(power.axes, course.drawn, strict=True)},
            "returned_W": {name: _column(row) for name, row in zip(power.axes, course.returned, strict=True)},
            "total_W": _column(course.total),
            "left_W": _column(course.left),
        },
        "assumptions": list(power.assumptions),
    }


def _column(values: Any) -> list[float | None]:
    """Figures of a row."""
    return [number(float(value)) for value in values]
