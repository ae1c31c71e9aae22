"""The loops of a validation at the terminal: a line each."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from drivesizer.control.loop_records import Loop
from drivesizer.control.validation import LinearRun
from drivesizer.output.loop_table import BESIDE, cell, linear_rows, loop_figures, loop_name
from drivesizer.output.terminal.tables import STYLE, bare, width_of

__all__ = ["linear", "loops"]

_FIRST = 6  # figures that 80 columns have room for


def loops(found: Sequence[Loop], width: int) -> Table:
    """Linear analysis of each loop, innermost first."""
    every = len(loop_figures(found[0]))
    for shown, line in ((every, " "), *((n, "\n") for n in range(every, _FIRST, -1))):
        table = _table(found, shown, line)
        if width_of(table) <= width:
            return table
    return _table(found, _FIRST, "\n")


def linear(run: LinearRun) -> Table:
    """The simulation by python-control beside the engine's, a line for each figure."""
    heads = (("", "left"), ("python-control", "right"), ("at", "right"), ("engine", "right"), ("at", "right"))
    table = bare(*heads, title=BESIDE)
    for row in linear_rows(run):
        table.add_row(*row)
    return table


def _table(found: Sequence[Loop], shown: int, line: str) -> Table:
    """The first figures of each loop; its name and direction on a line or on two."""
    heads = [figure.title.replace(" ", "\n") for figure in loop_figures(found[0])[:shown]]
    table = bare(
        ("loop", "left"), *((head, "right") for head in heads), title="Linear analysis of the loops, by python-control"
    )
    for loop in found:
        name = Text(loop_name(loop).replace(" ", line))
        if not loop.stable:
            name += Text("\nUNSTABLE", style=STYLE["fail"])
        table.add_row(name, *(cell(figure) for figure in loop_figures(loop)[:shown]))
    return table
