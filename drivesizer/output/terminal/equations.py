"""The paper's equations at the terminal: all of them in lines, or one with its terms, notes and source.

Those of the sizing, (1)-(20), are scalars and those of the platform, (21)-(59), matrices; both are printed alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from rich.console import Console
from rich.text import Text

from drivesizer.output import derivation
from drivesizer.output.derivation import numbers_in
from drivesizer.output.document.records import Cell, Small, Strong, Table, listed
from drivesizer.output.platform import EquationNumbers, Printed, cell, printed
from drivesizer.output.terminal import tables
from drivesizer.output.terminal.render import blocks
from drivesizer.physics.equation import COMPANIONS, EQUATIONS, Equation
from drivesizer.platform import equations as platform_equations
from drivesizer.platform import robot_figures
from drivesizer.platform.equations import PLATFORM, MatrixEquation
from drivesizer.platform.robot_figures import Numbers
from drivesizer.results.drive_set import Requirement
from drivesizer.units import label


def equations() -> None:
    """Print all equations, a line each."""
    console = tables.console()
    rows = []
    for declared in [*EQUATIONS.values(), *COMPANIONS.values()]:
        number = f"({declared.number})" if declared.number else ""
        mark = " *" if derivation.printed_failure(declared) else ""
        computed = f"{declared.symbol} = {derivation.text(declared.computed)}{mark}"
        rows.append((number, declared.title, computed, label(declared.shown)))
    for _, matrix in sorted(PLATFORM.items()):
        mark = " *" if any(robot_figures.finding(matrix)) else ""
        computed = f"{matrix.symbol} = {platform_equations.text(matrix.computed)}{mark}"
        rows.append((f"({matrix.number})", matrix.title, computed, _unit(matrix.result.unit)))
    blocks(console, [listed((("", "right"), ("quantity", "left"), ("computed", "left"), ("unit", "left")), rows)])
    console.print("* the printed form fails the unit check or gives another value; `drivesizer equations 10` says why.")


def _unit(unit: str) -> str:
    """The unit of a vector where it is short."""
    return "" if "," in unit or "per" in unit else label(unit)


def equation(declared: Equation, steps: Sequence[Requirement] = (), of: str = "") -> None:
    """Print one equation: as printed, as computed, why they differ, units, source."""
    console = tables.console()
    tables.heading(console, declared.title, f"equation ({declared.number})" if declared.number else "not in the paper")
    rows = []
    failure = derivation.printed_failure(declared)
    if declared.printed:
        rows.append(("as printed", f"{declared.symbol} = {derivation.text(declared.printed, paper=True)}"))
        rows.append(("unit check", f"fails: {failure}" if failure else "passes"))
    rows.append(("as computed", f"{declared.symbol} = {derivation.text(declared.computed)}"))
    if declared.note:
        rows.append(("note", declared.note))
    rows.append(("result", f"{declared.result.meaning} [{label(declared.shown) or '1'}]"))
    rows += [
        (derivation.symbol_text(term.name), f"{term.meaning} [{label(term.unit) or '1'}]") for term in declared.terms
    ]
    _print_rows(console, [*rows, ("source", robot_figures.SOURCE)])
    if of:
        console.print(Text(of, style="bold"))
    for r in steps:
        if len(steps) > 1:
            console.print(Text(r.title))
        console.print(Text(f"{r.symbol} = {numbers_in(r)} = {r.text}"))


def platform_equation(declared: MatrixEquation, numbers: EquationNumbers | None = None) -> None:
    """Print one equation of the platform: as printed, as computed, where they differ, units, source."""
    console = tables.console()
    tables.heading(console, declared.title, f"equation ({declared.number})")
    _print_rows(console, robot_figures.rows(declared))
    if numbers is not None:
        console.print(Text(numbers.of, style="bold"))
        if numbers.remarks:
            console.print(Text(" ".join(numbers.remarks)))
        blocks(console, _tables(numbers.tables))


def _tables(every: Sequence[Numbers]) -> Iterator[Table]:
    """Matrices one by one; vectors with the same labels beside each other, scalars below each other."""
    columns: dict[tuple[str, ...], list[Numbers]] = {}
    for one in every:
        if one.columns == ("",):
            columns.setdefault(one.rows, []).append(one)
        else:
            yield _matrix(one, printed(one), one.symbol)
    for rows, alike in columns.items():
        if rows == ("",):
            every_one = [(one.symbol, cell(one.values.item(), one.units[0][0])) for one in alike]
            yield listed((("", "left"), ("", "right")), every_one)
        else:
            units = [[u for one in alike for u in one.units[i]] for i in range(len(rows))]
            values = np.hstack([one.values for one in alike])
            together = alike[0]._replace(columns=tuple(one.symbol for one in alike), values=values, units=units)
            yield _matrix(together, printed(together, above=False))


def _matrix(numbers: Numbers, shown: Printed, symbol: str = "") -> Table:
    """Numbers with their labels, symbol and unit in the corner."""
    corner = f"{symbol} ({shown.unit})" if shown.unit else symbol
    heads = ((corner, "left"), *((head, "right") for head in shown.heads))
    return listed(heads, [(name, *cells) for name, cells in zip(numbers.rows, shown.cells, strict=True)])


_NAMES = ("as printed", "unit check", "value check", "as computed", "note", "result", "source")


def _print_rows(console: Console, rows: list[tuple[str, str]]) -> None:
    """Rows of a name, or a symbol, and words."""
    made: list[tuple[Cell, Cell]] = [
        ((Small(name),) if name in _NAMES else name, (Strong(words),) if words.startswith("fails") else words)
        for name, words in rows
    ]
    blocks(console, [listed((("", "left"), ("", "left")), made)])
