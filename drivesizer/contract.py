"""``--json``: the document that other programs rely on. null where a figure is unknown, never NaN."""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from math import isfinite
from typing import Any

from drivesizer import __version__
from drivesizer.catalog import Actuator, Belt, Controller, Encoder, Gearhead, Motor, Pulley
from drivesizer.loop_table import settled
from drivesizer.loops import Bode, Loop
from drivesizer.results import (
    Check,
    DriveSet,
    Figure,
    Relaxation,
    Requirement,
    SizingResult,
    Validation,
    verdict,
    worst,
)
from drivesizer.thinning import on_curves
from drivesizer.units import KINDS, from_si

__all__ = ["SCHEMA_VERSION", "as_text", "drive_set", "sizing", "validation"]

SCHEMA_VERSION = 1


def as_text(document: dict[str, Any]) -> str:
    """A document as JSON text."""
    return json.dumps(document, allow_nan=False, ensure_ascii=False, indent=2)


def _number(value: float) -> float | None:
    return float(value) if isfinite(value) else None


def _requirement(r: Requirement) -> dict[str, Any]:
    return {
        "symbol": r.symbol,
        "equation": r.equation,
        "value": _number(r.shown),
        "unit": r.unit,
        "si": _number(r.value),
        "title": r.title,
        "note": r.note,
    }


def _part(part: Actuator | Motor | Gearhead | Belt | Pulley | Encoder | Controller | None) -> dict[str, Any] | None:
    """A part with all its figures in SI."""
    if part is None:
        return None
    values = {f.name: getattr(part, f.name) for f in fields(part)}
    return {k: _number(v) if isinstance(v, float) else (v or None) for k, v in values.items()}


def _check(check: Check) -> dict[str, Any]:
    def shown(value: float) -> float | None:
        return _number(from_si(value, check.unit, check.kind)) if isfinite(value) else None

    return {
        "name": check.name,
        "method": check.method,
        "case": check.case or None,
        "demand": shown(check.demand),
        "limit": shown(check.limit),
        "unit": check.unit,
        "margin": _number(check.margin),
        "needed_margin": check.needed,
        "status": check.status,
        "at_time_s": check.at_time,
        "note": check.note,
    }


def _relaxation(r: Relaxation) -> dict[str, Any]:
    si = {"si_now": r.before, "si_needed": r.after, "si_unit": KINDS[r.kind].si}
    return {"field": r.field, "now": r.now, "needed": r.needed, "set": r.set_label} | si


def _result(checks: tuple[Check, ...]) -> dict[str, Any]:
    tightest = worst(checks)
    return {
        "status": verdict(checks),
        "smallest_margin": _number(tightest.margin) if tightest else None,
        "tightest_check": tightest.name if tightest else None,
        "failed": [c.name for c in checks if c.status == "fail"],
        "unknown": [c.name for c in checks if c.status == "unknown"],
    }


def _belt(found: DriveSet) -> dict[str, Any]:
    """Ratio and efficiency; pulleys and belt, null where they are not out of the catalogues."""
    drive = found.belt_drive
    return {
        "ratio": found.belt_ratio,
        "efficiency": found.belt_efficiency,
        "pulleys": {"driving": _part(drive.driving), "driven": _part(drive.driven)} if drive else None,
        "part": _part(drive.belt) if drive else None,
        "centre_distance_m": drive.centre_distance if drive else None,
        "teeth_in_mesh": drive.teeth_in_mesh if drive else None,
    }


def drive_set(found: DriveSet) -> dict[str, Any]:
    """One set of the contract."""
    return {
        "rank": found.rank,
        "status": found.status,
        "actuator": _part(found.actuator),
        "motor": _part(found.motor),
        "gearhead": _part(found.gearhead),
        "belt": _belt(found),
        "encoder": _part(found.encoder),
        "controller": _part(found.controller),
        "total_ratio": found.total_ratio,
        "mass_kg": _number(found.mass),
        "mass_of": list(found.mass_of),
        "objective": _number(found.objective),
        "objective_of": list(found.objective_of),
        "requirements": {r.name: _requirement(r) for r in found.requirements},
        "figures": {figure.name: _figure(figure) for figure in found.figures},
        "results": {checks[0].method: _result(checks) for checks in (found.checks, found.beside) if checks},
        "checks": [_check(check) for check in (*found.checks, *found.beside)],
        "changes": [_relaxation(r) for r in found.changes],
    }


def sizing(result: SizingResult) -> dict[str, Any]:
    """The document of ``drivesizer size --json``."""
    method = result.method
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "catalogs": dict(result.catalog.digests),
        "spec": result.spec.entered,
        "method": method,
        "objective": result.objective,
        "requirements": {r.name: _requirement(r) for r in result.requirements},
        "sets": [drive_set(s) for s in result.sets],
        "misses": [drive_set(s) for s in result.misses],
        "relaxations": [_relaxation(r) for r in result.relaxations],
        "pareto": {"objectives": list(result.pareto), "sets": [drive_set(s) for s in result.front]},
        "unrestricted": drive_set(result.unrestricted) if result.unrestricted else None,
        "counts": {
            "considered": result.counts.considered,
            "feasible": result.counts.feasible,
            "failed_by": result.counts.failed_by,
        },
        "assumptions": list(result.assumptions),
        "warnings": list(result.warnings),
    }


def _figure(figure: Figure) -> dict[str, Any]:
    shown = _number(from_si(figure.value, figure.unit, figure.kind)) if isfinite(figure.value) else None
    return {"value": shown, "unit": figure.unit, "si": _number(figure.value), "at_time_s": figure.at_time}


def validation(proof: Validation) -> dict[str, Any]:
    """The document of ``drivesizer validate --json``."""
    gains = proof.gains
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "spec": proof.spec.entered,
        "profile": proof.profile,
        "status": proof.status,
        "set": drive_set(proof.drive_set),
        "gains": {f.name: getattr(gains, f.name) for f in fields(gains)},
        "controller_gains": [asdict(gain) for gain in proof.controller_gains],
        "figures": {figure.name: _figure(figure) for figure in proof.figures},
        "checks": [_check(check) for check in proof.checks],
        "loops": [_loop(loop) for loop in proof.loops],
        "assumptions": list(proof.assumptions),
        "warnings": list(proof.warnings),
    }


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


def _loop(loop: Loop) -> dict[str, Any]:
    """A loop with its poles in the z plane as [re, im]; null where a figure does not exist."""
    return {
        "name": loop.name,
        "direction": loop.direction or None,
        "stable": loop.stable,
        **{key: _number(getattr(loop, name)) for key, name in _LOOP},
        "poles": [[_number(pole.real), _number(pole.imag)] for pole in loop.poles],
        "bode": _bode(loop.bode),
        "step": _step(loop),
    }


def _bode(bode: Bode) -> dict[str, Any]:
    """Curves over the frequency; ``thinned_from`` says how many points were computed, peaks are kept."""
    rows = on_curves((bode.open_magnitude, bode.closed_magnitude), _MOST_POINTS)
    columns = {
        "frequency_Hz": bode.frequency,
        "open_magnitude": bode.open_magnitude,
        "open_phase_rad": bode.open_phase,
        "closed_magnitude": bode.closed_magnitude,
        "closed_phase_rad": bode.closed_phase,
    }
    return {"thinned_from": len(bode.frequency)} | {k: [_number(x) for x in v[rows]] for k, v in columns.items()}


def _step(loop: Loop) -> dict[str, Any] | None:
    """The answer to a unit step until it has long settled, thinned as the curves are; null of an unstable loop."""
    if not len(loop.step):
        return None
    rows = on_curves((loop.step[: settled(loop)],), _MOST_POINTS)
    return {
        "thinned_from": len(loop.step),
        "time_s": [_number(n * loop.period) for n in rows],
        "response": [_number(x) for x in loop.step[rows]],
    }
