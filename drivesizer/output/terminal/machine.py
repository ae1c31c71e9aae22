"""The machine with a set in it at the terminal: budgets, what draws from the battery, how long it lasts."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from drivesizer.output.energy_table import consumer_rows
from drivesizer.output.terminal import tables as tables
from drivesizer.results.drive_set import DriveSet
from drivesizer.units import show

__all__ = ["machine"]


def _masses(found: DriveSet) -> Table:
    """What the machine weighs, part by part."""
    table = tables.bare(("", "left"), ("", "right"), ("mass", "right"), title="What it weighs")
    for row in found.masses:
        number = f"{row.number} x {show(row.each, 'g', 'mass')}" if row.number > 1 and row.each == row.each else ""
        table.add_row(row.name, number, show(row.total, "kg", "mass"))
    return table


def machine(console: Console, found: DriveSet) -> None:
    """Print the budgets of the machine with a set in it; nothing where the spec gives none."""
    if found.budget:
        console.print(tables.checks(found.budget, "The machine with this set"))
    if found.masses:
        console.print(_masses(found))
    if found.machine:
        console.print(tables.loose(found.machine, "The machine"))
    if found.energy:
        heads = ("", "right"), ("mean", "right"), ("peak", "right"), ("on", "right"), ("", "left")
        table = tables.bare(("consumer", "left"), *heads, title=f"From the battery: {found.energy.battery}")
        for row in consumer_rows(found.energy):
            table.add_row(*row)
        console.print(table)
        console.print(tables.loose(found.energy.figures, "The battery"))
