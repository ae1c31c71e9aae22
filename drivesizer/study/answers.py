"""Answers out of a study's rows: the best variant of each case, the front, and the field that decides a figure."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import isnan, nan

import numpy as np
from numpy.typing import NDArray

from drivesizer.files.arithmetic import Expression
from drivesizer.physics.extremes import undominated
from drivesizer.study.figures import row_figures
from drivesizer.study.plan import Plan
from drivesizer.study.rows import Column, Row, columns_of, spec_figures

_GOOD = ("pass", "open", "unknown")
_PARTS = 10  # of a sampled range, for its influence
INFLUENCE = (
    Column("figure", "text"), Column("field", "text"), Column("share"),
    Column("least_mean"), Column("least_at", "text"), Column("most_mean"), Column("most_at", "text"),
)  # fmt: skip


Table = tuple[str, Sequence[Column], list[Row]]  # name of the file, columns, rows


def answers(plan: Plan, rows: Callable[[], Iterable[Row]]) -> list[Table]:
    """Tables that a study wants."""
    wanted, columns, found = plan.answers, columns_of(plan), list[Table]()
    if wanted.by is not None:
        found.append(("best.csv", columns, _best(plan, rows(), wanted.over, wanted.by)))
    if wanted.front:
        found.append(("front.csv", columns, _front(plan, rows, wanted.front)))
    if wanted.influence:
        found.append(("influence.csv", INFLUENCE, _influence(plan, rows, wanted.influence)))
    return found


def _value(plan: Plan, row: Row, one: Expression) -> float:
    """An expression over the figures of a row and of its variant's spec; NaN where the row has no drive."""
    heads = [column.head for column in columns_of(plan)]
    if row[heads.index("status")] not in _GOOD:
        return nan
    return one.value(row_figures(heads, row, spec_figures(plan.job, plan.variant(row[0]))))


def _best(plan: Plan, rows: Iterable[Row], over: Sequence[str], by: Expression) -> list[Row]:
    """The best row of each combination of all fields but some; the first of equal ones."""
    heads = [column.head for column in columns_of(plan)]
    kept = [axis.head for axis in plan.job.axes if axis.name not in over] + ["spec", "catalogs", "objective"]
    places = [heads.index(head) for head in kept if head in heads]
    best: dict[tuple[object, ...], tuple[float, Row]] = {}
    for row in rows:
        key, value = tuple(row[place] for place in places), _value(plan, row, by)
        if not isnan(value) and (key not in best or value < best[key][0]):
            best[key] = value, row
    return [row for _, row in best.values()]


def _front(plan: Plan, rows: Callable[[], Iterable[Row]], goals: Sequence[Expression]) -> list[Row]:
    """Rows that no other beats in all goals, in the order of the first."""
    values = np.array([[_value(plan, row, one) for one in goals] for row in rows()])
    known = np.flatnonzero(~np.isnan(values).any(axis=1)) if len(values) else np.zeros(0, int)
    front = known[undominated(-values[known])] if len(known) else known
    wanted = {int(n) for n in front}
    found = [(tuple(values[n]), row) for n, row in enumerate(rows()) if n in wanted]
    return [row for _, row in sorted(found, key=lambda pair: pair[0])]


def _influence(plan: Plan, rows: Callable[[], Iterable[Row]], figures: Sequence[Expression]) -> list[Row]:
    """Share of the variance of a figure that each field alone explains, and its means at both extremes.

    The correlation ratio, which of a full grid is the first-order index of Sobol (Saltelli et al., *Global Sensitivity
    Analysis*, Wiley 2008, section 4.5); a sampled range is taken in ten parts.
    """
    heads, found = [column.head for column in columns_of(plan)], list[Row]()
    every = list(rows())
    for one in figures:
        values = np.array([_value(plan, row, one) for row in every])
        known = np.flatnonzero(~np.isnan(values))
        table = list[Row]()
        for axis in plan.job.axes if len(known) else ():
            cells = [every[n][heads.index(axis.head)] for n in known.tolist()]
            table.append([one.text, axis.name, *_explained(cells, values[known], sampled=plan.shares is not None)])
        found += sorted(table, key=lambda row: (-row[2], row[1]))
    return found


def _explained(cells: Sequence[object], values: NDArray[np.float64], *, sampled: bool) -> Row:
    """Share of the variance between the groups of some cells, and the least and greatest mean of a group."""
    numeric = all(isinstance(cell, int | float) for cell in cells)
    if sampled and numeric:
        order = np.argsort(np.argsort(np.array(cells, float), kind="stable"), kind="stable")
        group = order * _PARTS // len(cells)
        names = [f"{np.array(cells, float)[group == n].mean():.4g}" for n in range(int(group.max()) + 1)]
    else:
        every = sorted(set(cells)) if numeric else list(dict.fromkeys(cells))  # type: ignore[type-var]
        group = np.array([every.index(cell) for cell in cells])
        names = [f"{cell:g}" if isinstance(cell, int | float) else str(cell) for cell in every]
    count = np.bincount(group)
    means = np.bincount(group, values) / count
    whole = float(((values - values.mean()) ** 2).sum())
    between = float((count * (means - values.mean()) ** 2).sum())
    least, most = int(means.argmin()), int(means.argmax())
    share = between / whole if whole > 0.0 else 0.0
    return [
        float(f"{share:.6g}"),
        float(f"{means[least]:.12g}"),
        names[least],
        float(f"{means[most]:.12g}"),
        names[most],
    ]
