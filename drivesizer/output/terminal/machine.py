"""The machine with a drive at the terminal: budgets, masses, consumers and the battery."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.output.energy_table import consumer_rows
from drivesizer.output.terminal import tables as tables
from drivesizer.results.drive_set import DriveSet

__all__ = ["machine"]


def _masses(found: DriveSet) -> Table:
    """Masses of the machine, part by part."""
    table = tables.bare(("", "left"), ("", "right"), ("mass", "right"), title="Masses")
    for row in found.masses:
        number = f"{row.number} x {row.text(row.each, 'g')}" if row.number > 1 and row.each == row.each else ""
        table.add_row(row.name, number, row.text(row.total, "kg"))
    return table


def machine(console: Console, found: DriveSet) -> None:
    """Print the budgets of the machine with a drive, and what it regenerates; nothing where there is neither."""
    if found.budget:
        console.print(tables.checks(found.budget, "The machine with this drive"))
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
        if found.energy.assumptions:
            assumed = "; ".join(found.energy.assumptions)
            console.print(Text(f"Assumptions of the energy budget: {assumed}.\n", style="dim"))
    if found.braking:
        resistor = f"; brake resistor {found.braking.name}" if found.braking.name else ""
        console.print(tables.loose(found.braking.figures, f"Regenerated energy{resistor}"))
