"""JSON: the document of ``drivesizer size --json`` with parts list and closed loop in it, for other programs.

null where a figure is unknown, never NaN; figures are SI where the key names no other unit. The schema is in
``schema``.
"""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any, cast

from drivesizer.control.validation import Validation
from drivesizer.output.json.documents import sizing, validation
from drivesizer.output.part_line import HEADS, PartLine
from drivesizer.output.parts import machine_parts
from drivesizer.output.thinning import curve_points
from drivesizer.results.sizing import SizingResult
from drivesizer.units import KINDS

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["MOST_SAMPLES", "document", "simulated"]

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
