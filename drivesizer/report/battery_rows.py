"""The machine's battery as a report prints it."""

from __future__ import annotations

from typing import Any

from drivesizer.energy_table import consumer_rows
from drivesizer.report.set_rows import figure_row
from drivesizer.results import DriveSet

__all__ = ["battery_rows"]


def battery_rows(best: DriveSet) -> dict[str, Any] | None:
    """Name, consumers, figures and assumptions of the battery; None where the spec has none."""
    budget = best.energy
    if budget is None:
        return None
    return {
        "name": budget.pack.name,
        "consumers": [row._asdict() for row in consumer_rows(budget)],
        "figures": [figure_row(figure) for figure in budget.figures],
        "assumptions": list(budget.assumptions),
    }
