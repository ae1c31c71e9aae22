"""Drives in order through the budgets of their machine, as many as are wanted."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.sizing import Counts
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.order.found import BudgetFilter, Evaluated, Judge

__all__ = ["but_for", "failing_before", "ordered_in_machine", "without_rejected"]

_FIRST = 1 << 12  # drives that are judged at first
_MOST = 1 << 16  # at a time


def ordered_in_machine(
    judge: Judge | None, sets: Candidates, evaluated: Evaluated, order: NDArray[np.int64], wanted: int
) -> BudgetFilter:
    """The drives in order that pass the machine's budgets, until so many are found or none is left."""
    if judge is None:
        return BudgetFilter(order, order[:0], 0, Counter())
    best, rejected, by, start, size = [order[:0]], [order[:0]], Counter[str](), 0, _FIRST
    while start < len(order) and sum(map(len, best)) < wanted:
        rows = order[start : start + size]
        found = judge(sets.on(rows), _among(evaluated, rows), wanted - sum(map(len, best)))
        best.append(rows[found.best])
        rejected.append(rows[found.rejected])
        by.update(found.by)
        start, size = start + found.judged, min(16 * size, _MOST)
    return BudgetFilter(np.concatenate(best), np.concatenate(rejected), start, by)


def _among(evaluated: Evaluated, rows: NDArray[np.int64]) -> Evaluated:
    """The same function for some of the drives, by their places among these."""
    return lambda few: evaluated(rows[few])


def without_rejected(counts: Counts, kept: BudgetFilter, passes: NDArray[np.bool_]) -> Counts:
    """The counts without the drives that fail on a budget of the machine."""
    by = {name: count for name, count in kept.by.items() if count}
    left, passing = counts.feasible - len(kept.rejected), counts.passing - int(passes[kept.rejected].sum())
    return replace(counts, feasible=left, passing=passing, judged=kept.judged, failed_by_budget=by)


def failing_before(kept: BudgetFilter, order: NDArray[np.int64]) -> int:
    """Number of drives that fail on a budget before the first that passes."""
    if not len(kept.best):
        return len(kept.rejected)
    return int(np.argmax(order == kept.best[0]))  # all before it were judged


def but_for(rows: NDArray[np.int64], others: NDArray[np.int64]) -> NDArray[np.int64]:
    """Some rows without others."""
    return rows[~np.isin(rows, others)] if len(rows) else rows
