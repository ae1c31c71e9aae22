"""The machine's battery as a report prints it."""

from __future__ import annotations

from math import isnan
from typing import Any

from drivesizer.output.energy_table import consumer_rows
from drivesizer.output.report.lines.sets import figure_row
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.energy import EnergyBudget

__all__ = ["battery_rows", "without"]


def battery_rows(best: DriveSet) -> dict[str, Any] | None:
    """Name, consumers, figures and assumptions of the battery; None where the spec has none."""
    budget = best.energy
    if budget is None:
        return None
    *consumers, together = (row._asdict() for row in consumer_rows(budget))
    lacks = without(budget)
    return {
        "name": budget.battery,
        "consumers": [*consumers, together | {"said": "of what is known" if lacks else ""}],
        "lacks": ", ".join(lacks),
        "timed": any(row["duty"] for row in consumers),
        "figures": [figure_row(figure) for figure in budget.figures],
        "assumptions": list(budget.assumptions),
    }


def without(budget: EnergyBudget) -> tuple[str, ...]:
    """The consumers of which nobody knows what they draw: no sum has them."""
    return tuple(one.name for one in budget.consumers if isnan(one.mean))
