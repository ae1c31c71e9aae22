"""--json: documents for other programs. null where a figure is unknown, never NaN.

A document is what ``schema`` declares of a record: a key is the attribute of its name, but for a unit at its end
(``at_time_s`` is ``at_time``), or what ``_OF`` has for it. So a key that a document gets is one line there.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields
from functools import cache
from math import isfinite, nan
from types import NoneType
from typing import Annotated, Any, NotRequired, cast, get_args, get_origin

from typing_extensions import get_type_hints, is_typeddict

from drivesizer.catalog.tables import ESTIMATED
from drivesizer.control.validation import Validation
from drivesizer.output.json import schema
from drivesizer.output.loop_table import settled
from drivesizer.output.parts import HEADS, machine_parts
from drivesizer.output.thinning import curve_points
from drivesizer.results.check_kinds import missing_figures
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import MachineSizing
from drivesizer.results.sizing import Explanation, SizingResult, verdict, worst
from drivesizer.units import KINDS, from_si
from drivesizer.version import __version__

__all__ = [
    "MOST_SAMPLES", "SCHEMA_VERSION", "as_text", "document", "drive_set", "explanation", "machine_document", "number",
    "plain_data", "sizing", "validation", "written",
]  # fmt: skip

SCHEMA_VERSION = schema.SCHEMA_VERSION
MOST_SAMPLES = 2000  # of the time series: finer than a screen
_MOST_POINTS = 200  # of a curve
_UNIT = re.compile(r"_(s|kg|m|W|J|A|V|Nm|Hz|rad|rad_s|ohm|kgm2)$")  # at the end of a key


def number(value: float) -> float | None:
    """A figure as JSON has it: None where it is unknown or unbounded."""
    return float(value) if isfinite(value) else None


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


def written(kind: Any, value: Any) -> Any:
    """A value as the document has it that the schema declares."""
    origin, inner = get_origin(kind), get_args(kind)
    if value is None:
        return None
    if any(isinstance(mark, schema.PartOf) for mark in inner):  # a part with all its figures in SI
        found = {one.name: getattr(value, one.name) for one in fields(value)}
        return {name: number(x) if isinstance(x, float) else (x or None) for name, x in found.items()}
    if origin in (Annotated, NotRequired):
        return written(inner[0], value)
    if NoneType in inner:
        return None if value == "" else written(inner[0], value)
    if is_typeddict(kind):
        own = _OF.get(kind.__name__, {})
        return {key: written(of, _entry(value, key, own)) for key, of in _keys(kind).items()}
    if origin is list:
        return [written(inner[0], one) for one in value]
    if origin is dict:
        named = value.items() if isinstance(value, Mapping) else ((one.name, one) for one in value)
        return {name: written(inner[1], one) for name, one in named}
    return number(value) if isinstance(value, float) else value


@cache
def _keys(kind: Any) -> dict[str, Any]:
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    optional: Any = NotRequired
    return {key: of for key, of in hints.items() if get_origin(of) is not optional}


def _entry(value: Any, key: str, own: Mapping[str, str | Callable[[Any], Any]]) -> Any:
    """Value of a record for a key."""
    named = own.get(key, key)
    if not isinstance(named, str):
        return named(value)
    if isinstance(value, Mapping):
        return value[named]
    return getattr(value, named if hasattr(value, named) else _UNIT.sub("", named))


def _trade(one: Any, value: float) -> float:
    """A figure in its unit of the trade."""
    return float(from_si(value, one.unit, one.kind)) if isfinite(value) else nan


def _si_unit(one: Any) -> str:
    return KINDS[one.kind].si


def _band(check: Any) -> dict[str, float] | None:
    if check.band is None:
        return None
    low, high, least = check.band
    return {"low": _trade(check, low), "high": _trade(check, high), "least_margin": least}


def _results(one: DriveSet) -> dict[str, Any]:
    """By method: status, tightest check, and names of the checks that do not pass."""
    found = {}
    for checks in (one.checks, one.beside, one.budget):
        if checks:
            tightest = worst(checks)
            failed, open_, unknown = (
                [check.name for check in checks if check.status == status and not check.advice]
                for status in ("fail", "open", "unknown")
            )
            found[checks[0].method] = {
                "status": verdict(checks), "smallest_margin": tightest.margin if tightest else None,
                "tightest_check": tightest.name if tightest else None, "failed": failed, "open": open_,
                "unknown": unknown,
            }  # fmt: skip
    return found


def _belt(one: DriveSet) -> dict[str, Any]:
    """Ratio and efficiency; pulleys and belt, null where they are not from a catalogue."""
    drive = one.belt_drive
    return {
        "ratio": one.belt_ratio, "efficiency": one.belt_efficiency, "pulleys": drive,
        "part": drive.belt if drive else None, "centre_distance_m": drive.centre_distance if drive else None,
        "teeth_in_mesh": drive.teeth_in_mesh if drive else None,
    }  # fmt: skip


def _curves(bode: Any) -> dict[str, Any]:
    """Curves over the frequency; ``thinned_from`` says how many points were computed, peaks are kept."""
    rows = curve_points((bode.open_magnitude, bode.closed_magnitude), _MOST_POINTS)
    curves = {name: getattr(bode, _UNIT.sub("", name)) for name in _keys(schema.Bode) if name != "thinned_from"}
    return {"thinned_from": len(bode.frequency)} | {name: values[rows].tolist() for name, values in curves.items()}


def _step(loop: Any) -> dict[str, Any] | None:
    """Response to a unit step until it has settled, thinned as the curves are; None of an unstable loop."""
    if not len(loop.step):
        return None
    rows = curve_points((loop.step[: settled(loop)],), _MOST_POINTS)
    time = [float(n * loop.period) for n in rows]
    return {"thinned_from": len(loop.step), "time_s": time, "response": loop.step[rows].tolist()}


def _series(proof: Validation) -> dict[str, Any]:
    """Columns over time in SI; ``thinned_from`` says how many samples were recorded."""
    rows = curve_points(tuple(proof.series.values()), MOST_SAMPLES)
    return {
        "thinned_from": len(proof.series["time"]),
        "units": {name: KINDS[kind].si for name, (kind, _) in proof.series_units.items()},
        "columns": {name: values[rows].tolist() for name, values in proof.series.items()},
    }


def _platform(result: SizingResult) -> dict[str, Any] | None:
    """Kinematics and dynamics of the platform in numbers."""
    if result.spec.platform is None:
        return None
    from drivesizer.output.platform import platform_numbers  # with what a spec without one need not load

    found = platform_numbers(result.spec, result.shown)
    return {"remarks": [found.rotors, found.moment], "tables": found.every}


def _course(power: Any) -> dict[str, Any]:
    """Power over time, of each axis and of all."""
    course = power.course()
    each = {
        f"{name}_W": dict(zip(power.axes, getattr(course, name).tolist(), strict=True))
        for name in ("drawn", "returned")
    }
    return {"time_s": course.time.tolist(), "total_W": course.total.tolist(), "left_W": course.left.tolist(), **each}


def _itself(value: Any) -> Any:
    return value


Source = str | Callable[[Any], Any]  # attribute of a key, or what it is made of
_HEAD: dict[str, Source] = {"schema_version": lambda _: SCHEMA_VERSION, "drivesizer": lambda _: __version__}
_FIGURE: dict[str, Source] = {"value": lambda one: _trade(one, one.value), "si": "value"}
_PERCENTILES: dict[str, Source] = {"p5": "low", "p50": "middle", "p95": "high"}
_REST: dict[str, Source] = {
    "none_fails": "probability", "probability": "passing", "error_95": "error", "weakest_check": "weakest",
}  # fmt: skip
_OF: dict[str, dict[str, Source]] = {  # by record
    "Requirement": {"value": "shown", "si": "value"},
    "Figure": _FIGURE,
    "MachineFigure": _FIGURE,
    "Check": {
        "demand": lambda one: _trade(one, one.demand), "limit": lambda one: _trade(one, one.limit),
        "needed_margin": "needed", "band": _band,
    },
    "Relaxation": {"set": "set_label", "si_now": "before", "si_needed": "after", "si_unit": _si_unit},
    "Screw": {"part": "screw"},
    "Consumer": {"share_of_time": "duty"},
    "Estimate": {"si_unit": _si_unit, "confidence": lambda _: ESTIMATED},
    "Margins": _PERCENTILES,
    "Spread": {"margin": _itself},
    "Driver": {
        "share_of_variance": "share", "at_p5": lambda one: {"value": one.low, "smallest_margin": one.low_margin},
        "at_p95": lambda one: {"value": one.high, "smallest_margin": one.high_margin},
    },
    "LoopShare": _REST,
    "SampledFigure": {
        "p5": lambda one: _trade(one, one.low), "p50": lambda one: _trade(one, one.middle),
        "p95": lambda one: _trade(one, one.high),
    },
    "Reliability": {**_REST, "smallest_margin": _itself, "closed_loop": "loop", "closed_loop_refused": "no_loop"},
    "Assumption": {"tolerance": "text"},
    "Uncertainty": {"sets_sampled": "examined", "sets_that_reach_it": "reached"},
    "PlatformTable": {"title": "meaning", "values": lambda one: one.values.tolist()},
    "Set": {
        "belt": _belt, "screw": "chosen_screw", "results": _results, "checks": "every_check",
        "missing": missing_figures,
    },
    "Loop": {
        "poles": lambda loop: [[float(pole.real), float(pole.imag)] for pole in loop.poles], "step": _step,
        "bode": lambda loop: _curves(loop.bode),
    },
    "Beside": {"python_control": "linear"},
    "Linear": {"figures": lambda run: {one.linear.name: one for one in run.figures}},
    "Remedy": {"change": "what"},
    "Proof": {
        **_HEAD, "spec": lambda proof: proof.spec.entered, "set": "drive_set",
        "gains": lambda proof: {one.name: getattr(proof.gains, one.name) for one in fields(proof.gains)},
    },
    "Sizing": {
        **_HEAD, "catalogs": lambda result: dict(result.catalog.digests), "spec": lambda result: result.spec.entered,
        "pareto": lambda result: {"objectives": result.pareto, "sets": result.front}, "platform_numbers": _platform,
    },
    "Explained": _HEAD,
    "Carried": {"axis": "of", "unknown_mass_of": "lacking"},
    "MachineAxis": {"sizing": "result"},
    "Exceeded": {"share_least": "least", "share_most": "most"},
    "MachinePower": {
        "phases_s": lambda power: dict(zip(power.axes, power.phases, strict=False)), "course": _course,
    },
    "Machine": {**_HEAD, "machine": lambda result: result.machine.entered, "best_of_all": "certain"},
}  # fmt: skip
_OF["Validation"] = _OF["Proof"] | {"series": _series}


def drive_set(found: DriveSet) -> schema.Set:
    """One drive."""
    return cast("schema.Set", written(schema.Set, found))


def sizing(result: SizingResult) -> schema.Sizing:
    """The document of ``drivesizer size --json``."""
    return cast("schema.Sizing", written(schema.Sizing, result))


def explanation(found: Explanation) -> dict[str, Any]:
    """The document of ``drivesizer explain --json``."""
    return cast("dict[str, Any]", written(schema.Explained, found))


def validation(proof: Validation) -> schema.Proof:
    """The document of ``drivesizer validate --json``."""
    return cast("schema.Proof", written(schema.Proof, proof))


def document(result: SizingResult, proof: Validation | None) -> schema.Report:
    """Sizing, parts list and closed loop with its series over time as one document."""
    parts = machine_parts(result.sets[0], result.problem) if result.sets else []
    lines = [{HEADS.get(name, name): value for name, value in asdict(line).items()} for line in parts]
    more = {"parts_list": written(list[schema.Line], lines), "validation": written(schema.Validation, proof)}
    return cast("schema.Report", {**sizing(result), **more})


def machine_document(result: MachineSizing, proofs: Mapping[str, Validation] | None = None) -> schema.Machine:
    """The document of ``drivesizer size --json`` of a machine, or of its report with the closed loop of each axis."""
    found = written(schema.Machine, result)
    for name, axis in found["axes"].items() if proofs is not None else ():
        axis["validation"] = written(schema.Validation, (proofs or {}).get(name))
    return cast("schema.Machine", found)
