"""The paper's equations at the terminal: all of them in lines, or one with its terms, notes and source."""

from __future__ import annotations

from rich.text import Text

from drivesizer import formula
from drivesizer import terminal_tables as tables
from drivesizer.declare import COMPANIONS, EQUATIONS, Equation
from drivesizer.units import label

__all__ = ["equation", "equations"]


def equations() -> None:
    """Print all equations, a line each."""
    console = tables.console()
    table = tables.bare(("", "right"), ("quantity", "left"), ("computed", "left"), ("unit", "left"))
    for declared in [*EQUATIONS.values(), *COMPANIONS.values()]:
        number = f"({declared.number})" if declared.number else ""
        mark = " *" if formula.printed_failure(declared) else ""
        computed = f"{declared.symbol} = {formula.text(formula.computed(declared))}{mark}"
        table.add_row(number, Text(declared.title), Text(computed), label(declared.shown))
    console.print(table)
    console.print("* the printed form fails the unit check; `drivesizer equations 10` says why.")


def equation(declared: Equation) -> None:
    """Print one equation: as printed, as computed, why they differ, units, source."""
    console = tables.console()
    tables.heading(console, declared.title, f"equation ({declared.number})" if declared.number else "not in the paper")
    rows = []
    failure = formula.printed_failure(declared)
    if declared.printed:
        rows.append(("as printed", f"{declared.symbol} = {formula.text(declared.printed, paper=True)}"))
        rows.append(("unit check", f"fails: {failure}" if failure else "passes"))
    rows.append(("as computed", f"{declared.symbol} = {formula.text(formula.computed(declared))}"))
    if declared.note:
        rows.append(("note", declared.note))
    rows.append(("result", f"{declared.result.meaning} [{label(declared.shown) or '1'}]"))
    table = tables.bare(("", "left"), ("", "left"))
    table.show_header = False
    for name, words in rows:
        table.add_row(Text(name, style="dim"), Text(words, style="red" if words.startswith("fails") else ""))
    for term in declared.terms:
        table.add_row(formula.symbol_text(term.name), Text(f"{term.meaning} [{label(term.unit) or '1'}]"))
    table.add_row(
        Text("source", style="dim"), "Prados Sesmero et al., Appl. Sci. 2021, 11, 6631, doi:10.3390/app11146631"
    )
    console.print(table)
