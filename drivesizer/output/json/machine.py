"""``--json`` of a machine: the documents of its axes, and what concerns all of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from drivesizer.control.validation import Validation
from drivesizer.output.json.documents import (
    SCHEMA_VERSION,
    braking_document,
    check_document,
    energy_document,
    figure_document,
    sizing,
)
from drivesizer.output.json.file import simulated
from drivesizer.output.json.loops import number
from drivesizer.output.json.reliability import reliability
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.results.machine_power import MachinePower
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["machine_document"]


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
