"""Figures that a part's data sheet leaves out, as its peers have them: value, band and the law behind it."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from drivesizer.catalog import columns_of
from drivesizer.catalog.estimates import Estimate, estimates_of
from drivesizer.catalog.query import Hit
from drivesizer.output.terminal.tables import bare
from drivesizer.units import show

__all__ = ["print_estimates"]

# figures that are no column of their own: title, unit, kind
_DERIVED = {
    "friction": ("no load torque", "mN*m", "torque"),
    "loss": ("loss at rated torque", "%", "dimensionless"),
    "loss_per_stage": ("loss per stage", "%", "dimensionless"),
}


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
        title, unit, kind = _named(hit.section, one.figure)
        value, low, high = (show(figure, unit, kind, 2) for figure in (one.value, one.low, one.high))
        table.add_row(title, value, f"{low} to {high}", _law(one))
    out.print(table)
    out.print(Text("Sizing does not use estimates: what a data sheet leaves out is unknown there.", style="dim"))


def _named(section: str, figure: str) -> tuple[str, str, str]:
    """Title, unit and kind of quantity of a figure."""
    column = columns_of(section).get(figure)
    return (figure.replace("_", " "), column.unit, column.kind) if column else _DERIVED[figure]


def _law(one: Estimate) -> str:
    """A law in words.

    >>> from drivesizer.catalog.estimates.fit import Fit
    >>> from drivesizer.catalog.estimates.laws import Law
    >>> law = Law("motors", "brushed", "rotor_inertia", ("mass", "diameter"))
    >>> _law(Estimate("rotor_inertia", 1e-6, 7e-7, 1.3e-6, Fit(law, (0, 1, 1), (-0.3, 0.3), None, (), 309, 32, ("m",))))
    'mass, diameter; 309 brushed motors, 32 families'
    """
    law, terms = one.fit.law, ", ".join(term.replace("_", " ") for term in one.fit.law.terms)
    peers = f"{one.fit.parts} {law.of} {law.section}".replace("  ", " ")
    return f"{terms or 'all alike'}; {peers}, {one.fit.families} families"
