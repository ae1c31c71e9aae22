"""CSV of a machine: a row for each axis; beside it parts list, power over time and closed loops of all axes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from drivesizer.output.report.csv import columns_csv, encoded, set_columns, shared_parts_csv
from drivesizer.output.report.machine import AxisContent, MachineContent, loop_files, power_columns

__all__ = ["render_machine"]


def render_machine(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """The files of a CSV report."""
    files = {path: axes_csv(content)}
    files[path.with_name(f"{path.stem}-parts{path.suffix}")] = shared_parts_csv(content.bought)
    power = content.sizing.power
    if power is not None:
        files[path.with_name(f"{path.stem}-power{path.suffix}")] = columns_csv(power_columns(power))
    return files | loop_files(content, path)


def axes_csv(content: MachineContent) -> bytes:
    """A row for each axis with its drive; of one without a drive its name and what it carries."""
    best = [one.best for one in content.sizing.axes if one.best]
    heads, found = set_columns(best, content.sizing.objective)
    rows = iter(found)
    made = [[*_axis(one), *(next(rows) if one.sizing.best else [""] * len(heads))] for one in content.axes]
    return encoded([*_AXIS, *heads], made)


_AXIS = ("axis", "axis_status", "drives", "carried_axes", "carried_mass_kg")


def _axis(one: AxisContent) -> list[Any]:
    names = "; ".join(found.of for found in one.sizing.carried)
    return [one.name, one.status, one.sizing.drives, names, one.sizing.carried_mass]
