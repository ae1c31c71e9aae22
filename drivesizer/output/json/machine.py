"""``--json`` of a machine: the documents of its axes, and what concerns all of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivesizer.output.json.documents import SCHEMA_VERSION, sizing
from drivesizer.output.json.loops import number
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["machine_document"]


def machine_document(result: MachineSizing) -> schema.Machine:
    """The document of ``drivesizer size --json`` of a machine.

    Parameters
    ----------
    result
        The sizing.

    Returns
    -------
    dict
        With the document of every axis as of a spec of its own.
    """
    return {
        "schema_version": SCHEMA_VERSION,
        "drivesizer": __version__,
        "machine": result.machine.entered,
        "status": result.status,
        "objective": result.objective,
        "total": number(result.total),
        "best_of_all": result.certain,
        "axes": {axis.name: _axis(axis) for axis in result.axes},
        "notes": list(result.notes),
    }


def _axis(axis: AxisSizing) -> schema.MachineAxis:
    """An axis with the drives that ride on it."""
    return {
        "drives": axis.drives,
        "carried": [
            {"axis": one.of, "mass_kg": one.mass, "distance_m": one.distance, "unknown_mass_of": list(one.lacking)}
            for one in axis.carried
        ],
        "sizing": sizing(axis.result),
    }
