"""Figures that a part's data sheet leaves out, as its peers have them: value, band and the law behind it."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from drivesizer.catalog import columns_of
from drivesizer.catalog.estimates import estimates_of
from drivesizer.catalog.estimates.estimate import in_words
from drivesizer.catalog.query import Hit
from drivesizer.output.terminal.tables import bare
from drivesizer.units import show

__all__ = ["print_estimates"]


def print_estimates(out: Console, hit: Hit) -> None:
    """Print a table of estimates; nothing where the data sheet leaves nothing out that peers have.

    Parameters
    ----------
    out
        Where to print.
    hit
        The part.
    """
    found = estimates_of(hit.table, hit.row)
    if not found:
        return
    table = bare(("estimated from peers", "left"), ("", "right"), ("5 to 95 %", "right"), ("from", "left"))
    for one in found:
        column = columns_of(hit.section)[one.figure]
        value, low, high = (show(figure, column.unit, column.kind, 2) for figure in (one.value, one.low, one.high))
        table.add_row(one.figure.replace("_", " "), value, f"{low} to {high}", in_words(one.fit))
    out.print(table)
    out.print(Text("Sizing takes these unless the spec has select: {estimates: off}.", style="dim"))
