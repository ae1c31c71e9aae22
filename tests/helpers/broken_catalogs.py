"""Catalogues with one figure changed, and what the laws say of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import PARTS, RELATIONS, Catalog, Pairs, Table, columns_of
from drivesizer.catalog.laws import Finding, Law, all_laws, check

EMPTY = Pairs(*(np.zeros(0, np.int32) for _ in range(3)))

UNPAIRED: dict[str, Any] = dict.fromkeys(RELATIONS, EMPTY)


def with_cells(catalog: Catalog, section: str, row: int, **cells: Any) -> Catalog:
    """The catalogue with other figures in one row."""
    table = catalog.table(section)
    columns = dict(table.columns)
    for name, value in cells.items():
        columns[name] = columns[name].copy()
        columns[name][row] = value
    return replace(catalog, **{section: replace(table, columns=columns)})  # type: ignore[arg-type]


def rows_of(catalog: Catalog, kept: dict[str, NDArray[np.intp]]) -> Catalog:
    """Some rows of every table, and no pairs."""
    tables = {}
    for section, rows in kept.items():
        table = catalog.table(section)
        columns = {name: column[rows] for name, column in table.columns.items()}
        tables[section] = Table(section, columns, table.source[rows], table.excluded[rows])
    return replace(catalog, **tables, **UNPAIRED)  # type: ignore[arg-type]


def alone(catalog: Catalog, section: str) -> Catalog:
    """One table, the others empty: laws are of one section, so the others are only time."""
    none = np.zeros(0, np.intp)
    return rows_of(catalog, {s: np.arange(len(catalog.table(s))) if s == section else none for s in PARTS})


def held_to(catalog: Catalog, laws: Sequence[Law]) -> list[Finding]:
    """What some of the laws find: of one broken figure the others need not be checked, there are hundreds."""
    return check(catalog, laws)


def laws_of(section: str) -> list[Law]:
    return [law for law in all_laws() if law.section == section]


def about(findings: list[Finding], part: str) -> set[str]:
    return {f.identity for f in findings if f.part == part and f.grade == "finding"}


def broken(law: Law, table: Table[Any], row: int) -> dict[str, float]:
    """Cells that break a law in one row: unknown figures made up, the compared one far on the wrong side."""
    made_up = {n: 0.5 for n in law.fields if columns_of(law.section)[n].kind != "text" and np.isnan(table[n][row])}
    columns = {n: c.copy() for n, c in table.columns.items()}
    for name, value in ({law.figure: 4.0} | made_up).items():
        columns[name][row] = value if name in made_up or np.isnan(columns[name][row]) else columns[name][row]
    with np.errstate(all="ignore"):
        expected = float(np.asarray(law.expected(replace(table, columns=columns)))[row])
    if law.name.endswith("whole number"):
        return made_up | {law.figure: expected + 0.3}
    if law.relation == ">":
        return made_up | {law.figure: expected}
    return made_up | {law.figure: expected / 3 if law.relation == ">=" else expected * 3}
