"""Results of a search, and how budgets of the machine take part in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.sizing import Counts
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation

__all__ = ["BudgetFilter", "Evaluated", "Judge", "Passing", "SearchResult"]

Array = NDArray[np.float64]
Evaluated = Callable[[NDArray[np.int64]], Evaluation]  # some rows of the drives in full


class SearchResult(NamedTuple):
    """The result of a search: drives in full, those that pass first and in order."""

    evaluation: Evaluation
    passing: int  # how many of the evaluation's rows pass
    counts: Counts
    front: tuple[int, ...]  # rows on the Pareto front, where one was required
    short: tuple[int, ...] = ()  # rows of the best that a budget of the machine rejects
    better: int = 0  # drives that fail on a budget before the first that passes
    held_back: int | None = None  # row of the best that would be better than the first, did its checks not lack figures
    others: tuple[int, ...] = ()  # rows of the best of other motor families than the first one's, where required
    every: Passing | None = None  # all that pass their own checks


class Passing(NamedTuple):
    """All drives that pass their own checks, as rows of a few numbers."""

    sets: Candidates
    certainty: NDArray[np.int64]
    figures: dict[str, Array]  # that objectives count, as far as they were computed
    best: NDArray[np.int64]  # rows of those that are given
    evaluated: Evaluated


class BudgetFilter(NamedTuple):
    """Of the drives that pass their own checks those that pass the machine's budgets, as far as they were examined."""

    best: NDArray[np.int64]  # which of them, in order
    rejected: NDArray[np.int64]  # which of them fail on a budget, in order
    judged: int
    by: Counter[str]  # how many by each budget


Judge = Callable[[Candidates, Evaluated, int], BudgetFilter]  # drives in order, and how many that pass are wanted
