"""The paper's equations as documents: all of them in lines, or one with its terms, notes, source and numbers.

Those of the sizing, (1)-(20), are scalars and those of the platform, (21)-(59), matrices; both are printed alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from drivesizer.output import derivation
from drivesizer.output.document import records as doc
from drivesizer.output.platform import EquationNumbers, Printed, cell, printed
from drivesizer.physics.equation import COMPANIONS, EQUATIONS, Equation
from drivesizer.platform import equations as platform_equations
from drivesizer.platform import robot_figures
from drivesizer.platform.equations import PLATFORM, MatrixEquation
from drivesizer.platform.robot_figures import Numbers
from drivesizer.results.drive_set import Requirement
from drivesizer.units import label


def equations() -> doc.Document:
    """All equations, a line each."""
    rows = []
    for declared in [*EQUATIONS.values(), *COMPANIONS.values()]:
        number = f"({declared.number})" if declared.number else ""
        mark = " *" if derivation.printed_failure(declared) else ""
        computed = f"{declared.symbol} = {derivation.text(declared.computed)}{mark}"
        rows.append((number, declared.title, computed, label(declared.display_unit)))
    for _, matrix in sorted(PLATFORM.items()):
        mark = " *" if any(robot_figures.finding(matrix)) else ""
        computed = f"{matrix.symbol} = {platform_equations.text(matrix.computed)}{mark}"
        unit = matrix.result.unit
        short = "" if "," in unit or "per" in unit else label(unit)  # the unit of a vector where it is short
        rows.append((f"({matrix.number})", matrix.title, computed, short))
    note = "* the printed form fails the unit check or gives another value; `drivesizer equations 10` says why."
    return _document("Equations of the paper", "", [doc.table("equations", "", rows), doc.Words(note)])


def _document(name: str, words: str, blocks: Sequence[doc.Block]) -> doc.Document:
    sections = [doc.section("equations", "Equations", blocks)]
    return doc.Document(name=name, machine=words, subject="equations", headed=bool(words), sections=sections)


def equation(declared: Equation, steps: Sequence[Requirement] = (), of: str = "") -> doc.Document:
    """One equation: as printed, as computed, why they differ, units, source; and its numbers of a spec."""
    rows = []
    failure = derivation.printed_failure(declared)
    if declared.printed:
        rows.append(("as printed", f"{declared.symbol} = {derivation.text(declared.printed, paper=True)}"))
        rows.append(("unit check", f"fails: {failure}" if failure else "passes"))
    rows.append(("as computed", f"{declared.symbol} = {derivation.text(declared.computed)}"))
    if declared.note:
        rows.append(("note", declared.note))
    rows.append(("result", f"{declared.result.meaning} [{label(declared.display_unit) or '1'}]"))
    rows += [
        (derivation.symbol_text(term.name), f"{term.meaning} [{label(term.unit) or '1'}]") for term in declared.terms
    ]
    blocks: list[doc.Block] = [_rows([*rows, ("source", robot_figures.SOURCE)])]
    blocks += [doc.Words((doc.Strong(of),))] if of else []
    for r in steps:
        blocks += [doc.Words(r.title)] if len(steps) > 1 else []
        blocks.append(doc.Words(f"{r.symbol} = {derivation.numbers_in(r)} = {r.text}"))
    return _document(declared.title, f"equation ({declared.number})" if declared.number else "not in the paper", blocks)


def platform_equation(declared: MatrixEquation, numbers: EquationNumbers | None = None) -> doc.Document:
    """One equation of the platform: as printed, as computed, where they differ, units, source."""
    blocks: list[doc.Block] = [_rows(robot_figures.rows(declared))]
    if numbers is not None:
        blocks.append(doc.Words((doc.Strong(numbers.of),)))
        blocks += [doc.Words(" ".join(numbers.remarks))] if numbers.remarks else []
        blocks += _tables(numbers.tables)
    return _document(declared.title, f"equation ({declared.number})", blocks)


def _tables(tables: Sequence[Numbers]) -> Iterator[doc.Table]:
    """Matrices one by one; vectors with the same labels beside each other, scalars below each other."""
    columns: dict[tuple[str, ...], list[Numbers]] = {}
    for table in tables:
        if table.columns == ("",):
            columns.setdefault(table.rows, []).append(table)
        else:
            yield _matrix(table, printed(table), table.symbol)
    for rows, alike in columns.items():
        if rows == ("",):
            scalars = [(table.symbol, cell(table.values.item(), table.units[0][0])) for table in alike]
            yield doc.table("across", "", scalars, more=[doc.Column("value", "", "number")])
        else:
            units = [[u for table in alike for u in table.units[i]] for i in range(len(rows))]
            values = np.hstack([table.values for table in alike])
            together = alike[0]._replace(columns=tuple(table.symbol for table in alike), values=values, units=units)
            yield _matrix(together, printed(together, above=False))


def _matrix(numbers: Numbers, texts: Printed, symbol: str = "") -> doc.Table:
    """Numbers with their labels, symbol and unit in the corner."""
    corner = f"{symbol} ({texts.unit})" if texts.unit else symbol
    rows = [(name, *cells) for name, cells in zip(numbers.rows, texts.cells, strict=True)]
    columns = [doc.Column(f"n{n}", head, "number") for n, head in enumerate(texts.heads)]
    return doc.table("across", "", rows, heads={"title": corner}, more=columns)


_NAMES = ("as printed", "unit check", "value check", "as computed", "note", "result", "source")


def _rows(rows: Sequence[tuple[str, str]]) -> doc.Table:
    """Rows of a name, or a symbol, and words."""
    return doc.table("words", "", [
        ((doc.Small(name),) if name in _NAMES else name, (doc.Strong(words),) if words.startswith("fails") else words)
        for name, words in rows
    ])  # fmt: skip
