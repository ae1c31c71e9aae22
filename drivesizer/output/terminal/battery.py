"""Discharge tables of a battery at the terminal: current or power over time and cut-off voltage."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich.table import Table

from drivesizer.catalog.discharges import HELD, Discharges
from drivesizer.catalog.query import Hit
from drivesizer.output.terminal.tables import bare
from drivesizer.units import show

__all__ = ["discharge_tables"]


def discharge_tables(hit: Hit) -> Iterator[Table]:
    """The printed discharges of a battery, constant currents and constant powers apart; times down, voltages across."""
    own = hit.catalog.discharges.on(hit.catalog.discharges.battery == hit.row)
    for held, unit in HELD.items():
        some = own.on(~np.isnan(getattr(own, held)))
        if len(some.time):
            yield _table(some, held, unit)


def _table(own: Discharges, held: str, unit: str) -> Table:
    ends = np.unique(own.cutoff_voltage)
    heads = [(show(float(end), "V", "voltage"), "right") for end in ends]
    table = bare(("lasts", "right"), *heads, title=f"Constant {held} ({unit}), down to")
    draw = getattr(own, held)
    for time in np.unique(own.time):
        cells = [draw[(own.time == time) & (own.cutoff_voltage == end)] for end in ends]
        minutes = float(time) < 3600.0
        table.add_row(
            show(float(time), "min" if minutes else "h", "time"), *(f"{c[0]:g}" if len(c) else "–" for c in cells)
        )
    return table
