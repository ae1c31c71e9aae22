"""Figures that a part's data sheet leaves out: as its peers have them, and limits that its whole family has."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.text import Text

from drivesizer.catalog import columns_of
from drivesizer.catalog.estimates import estimates_of
from drivesizer.catalog.estimates.estimate import in_words
from drivesizer.catalog.estimates.family_limits import SAME_FAMILY, family_limits
from drivesizer.catalog.query import Hit
from drivesizer.output.terminal.tables import bare
from drivesizer.units import show

__all__ = ["print_estimates", "print_family_limits"]


def print_estimates(out: Console, hit: Hit) -> None:
    """Print a table of estimates; nothing where the data sheet leaves nothing out that peers have.

    Parameters
    ----------
    out
        Where to print.
    hit
        The part.
    """
    rows = []
    for one in estimates_of(hit.table, hit.row):
        value, low, high = (_shown(hit, one.figure, figure, 2) for figure in (one.value, one.low, one.high))
        rows.append((one.figure.replace("_", " "), value, f"{low} to {high}", in_words(one.fit)))
    heads = ("estimated from peers", "left"), ("", "right"), ("5 to 95 %", "right"), ("from", "left")
    _print(out, heads, rows, "Sizing takes these unless the spec has select: {estimates: off}.")


def print_family_limits(out: Console, hit: Hit) -> None:
    """Print a table of permitted limits that all others of a part's family have; nothing where there is none.

    Parameters
    ----------
    out
        Where to print.
    hit
        The part.
    """
    rows = [
        (one.figure.replace("_", " "), _shown(hit, one.figure, one.value, 3),
         f"{SAME_FAMILY}; {one.members} parts print it, all alike")
        for one in family_limits(hit.table, hit.row)
    ]  # fmt: skip
    heads = ("limits of the family", "left"), ("", "right"), ("from", "left")
    _print(out, heads, rows, "Sizing does not use them.")


def _shown(hit: Hit, figure: str, value: float, digits: int) -> str:
    column = columns_of(hit.section)[figure]
    return show(value, column.unit, column.kind, digits)


def _print(out: Console, heads: Iterable[tuple[str, str]], rows: Sequence[tuple[str, ...]], closing: str) -> None:
    if not rows:
        return
    table = bare(*heads)
    for row in rows:
        table.add_row(*row)
    out.print(table)
    out.print(Text(closing, style="dim"))
