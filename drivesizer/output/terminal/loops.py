"""The loops of a validation at the terminal: a line each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from rich.table import Table
from rich.text import Text

from drivesizer.control.loop_records import Loop
from drivesizer.output.loop_table import cell, loop_figures, loop_name
from drivesizer.output.terminal.tables import STYLE, bare, width_of

if TYPE_CHECKING:
    from drivesizer.control.second_look import Compared

__all__ = ["looked_twice", "loops"]

_FIRST = 6  # figures that 80 columns have room for


def loops(found: Sequence[Loop], width: int) -> Table:
    """Linear analysis of each loop, innermost first.

    Parameters
    ----------
    found
        The loops of a validation.
    width
        Width of the terminal [characters]: the table has as many figures as fit.

    Returns
    -------
    Table
        A row for each loop.
    """
    every = len(loop_figures(found[0]))
    for shown, line in ((every, " "), *((n, "\n") for n in range(every, _FIRST, -1))):
        table = _table(found, shown, line)
        if width_of(table) <= width:
            return table
    return _table(found, _FIRST, "\n")


def looked_twice(rows: Sequence[Compared]) -> Table:
    """Figures of loops by two programs, a line each.

    Parameters
    ----------
    rows
        The figures.

    Returns
    -------
    Table
        With a mark where they differ by more than a part in ten thousand.
    """
    heads = (("loop", "left"), ("figure", "left"), ("drivesizer", "right"), ("python-control", "right"), ("", "left"))
    table = bare(*heads, title="The same loops by python-control")
    for row in rows:
        known = {figure.name: figure for figure in loop_figures(row.loop)}[row.figure]
        both = (cell(replace(known, value=value)) for value in (row.ours, row.theirs))
        mark = Text("agree", style=STYLE["pass"]) if row.agrees else Text("DIFFER", style=STYLE["fail"])
        table.add_row(loop_name(row.loop), known.title, *both, mark)
    return table


def _table(found: Sequence[Loop], shown: int, line: str) -> Table:
    """The first figures of each loop; its name and direction on a line or on two."""
    heads = [figure.title.replace(" ", "\n") for figure in loop_figures(found[0])[:shown]]
    table = bare(("loop", "left"), *((head, "right") for head in heads), title="Linear analysis of the loops")
    for loop in found:
        name = Text(loop_name(loop).replace(" ", line))
        if not loop.stable:
            name += Text("\nUNSTABLE", style=STYLE["fail"])
        table.add_row(name, *(cell(figure) for figure in loop_figures(loop)[:shown]))
    return table
