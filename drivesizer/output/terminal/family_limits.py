"""Permitted limits that a part's data sheet leaves out, as all others of its family have them."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from drivesizer.catalog import columns_of
from drivesizer.catalog.estimates.family_limits import SAME_FAMILY, family_limits
from drivesizer.catalog.query import Hit
from drivesizer.output.terminal.tables import bare
from drivesizer.units import show

__all__ = ["print_family_limits"]


def print_family_limits(out: Console, hit: Hit) -> None:
    """Print a table of such limits; nothing where there is none.

    Parameters
    ----------
    out
        Where to print.
    hit
        The part.
    """
    found = family_limits(hit.table, hit.row)
    if not found:
        return
    table = bare(("limits of the family", "left"), ("", "right"), ("from", "left"))
    for one in found:
        column = columns_of(hit.section)[one.figure]
        value = show(one.value, column.unit, column.kind, 3)
        table.add_row(one.figure.replace("_", " "), value, f"{SAME_FAMILY}; {one.members} parts print it, all alike")
    out.print(table)
    out.print(Text("Sizing does not use them.", style="dim"))
