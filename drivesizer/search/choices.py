"""A few hundred drives out of all that pass, among which are those that weights may make the best.

Whatever the weights of several figures are, the best drive by their weighted sum is on the Pareto front, and the best k
are in the first k layers of it: a front, the front of what is left without it, and so on [1]. Energy and margin are
known once the waveform is. Where it would take long to compute that of all drives, those of which it is computed are
picked the same way by a lower bound of the mean power, of moments, and by the margin as far as bounds give it.

References
----------
.. [1] M. Ehrgott, *Multicriteria Optimization*, 2nd edition, Springer 2005, chapter 3: weighted sums and the front.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.view import has_steppers
from drivesizer.physics.extremes import undominated
from drivesizer.physics.figures import Array, Whole
from drivesizer.results.check import Status, verdict
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import CRITERIA, Choice, Choices, used_share, weighted_order
from drivesizer.search import ranking
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation, smallest_margin
from drivesizer.search.machine_filter import InMachine, least_power
from drivesizer.search.search import SearchResult
from drivesizer.search.set_record import drive_parts
from drivesizer.spec.drive import OBJECTIVES, Ranking, weights_of

_CELLS = 200_000  # drives times pieces of the load cycles, of which waveforms are computed: a few tenths of a second
_JUDGED = 16  # drives that are checked in their machine as well, beside those that the search gives
_MOST_LAYERED = 10_000  # drives of which layers are made


def criteria(objective: Ranking, method: str) -> tuple[str, ...]:
    """Objectives that drives can be chosen by: those of the ranking, then mass, price, energy and margin.

    Examples
    --------
    >>> criteria("length", "physics"), criteria("mass", "paper")
    (('length', 'mass', 'price', 'energy', 'margin'), ('mass', 'price', 'margin'))
    """
    names = dict.fromkeys((*weights_of(objective), *CRITERIA))
    return tuple(name for name in names if method == "physics" or name not in ranking.COUNTED)


def choices(problem: Problem, result: SearchResult, most: int, machine: InMachine | None = None) -> Choices | None:
    """Drives to choose from by weights, each with all its figures."""
    best, drives, judge = result.best, result.in_order.drives, machine and machine.judge
    if not len(best):
        return None
    names = criteria(problem.spec.select.objective, problem.spec.method)
    alike_certain = drives.certainty == drives.certainty[best[0]]
    best, alike = best[alike_certain[best]], np.flatnonzero(alike_certain)
    sets, figures = drives.sets.on(alike), {name: column[alike] for name, column in drives.figures.items()}
    best_places = np.searchsorted(alike, best)  # the first of them is the best of all
    affordable = _CELLS // sum(len(case.at_belt.load_cycle.duration) for case in problem.cases)
    rows = picked(_cheap(problem, sets, figures, names), best_places, affordable).rows
    evaluation, best_places = result.in_order.at(alike[rows]), np.searchsorted(rows, best_places)
    few = picked(_objectives(evaluation, names), best_places, _JUDGED if judge else most)
    evaluation, first = evaluation.on(few.rows), int(np.searchsorted(few.rows, best_places[0]))
    passing = judge(evaluation.candidates, evaluation.on, len(few.rows)).best if judge else np.arange(len(few.rows))
    status = {row: _status(evaluation, row, machine if judge else None) for row in passing.tolist()}
    order = _margin_order(evaluation, [row for row, outcome in status.items() if outcome == status[first]])
    return Choices(
        drives=_records(evaluation, order, names), first=order.index(first), weights=problem.spec.select.weights,
        passing=len(alike), judged=judge is not None, whole=few.whole and not judge and len(rows) == len(alike),
    )  # fmt: skip


def _status(evaluation: Evaluation, row: int, machine: InMachine | None) -> Status:
    """Outcome of a drive's checks and of the machine's."""
    budget = machine.budget(evaluation, row).checks if machine else ()
    return verdict((*evaluation.checks_of(row), *budget)) if budget else evaluation.status(row)


def _margin_order(evaluation: Evaluation, rows: list[int]) -> list[int]:
    """Some drives, the larger smallest margin first, then by part number."""
    drives = evaluation.on(np.array(rows, np.int64))
    margin = smallest_margin(drives.checks)  # infinite where it is unknown
    unknown = np.isinf(margin)
    order = ranking.order(
        evaluation.catalog, drives.candidates, np.where(unknown, 0.0, -margin), unknown.astype(np.int64)
    )  # fmt: skip
    return [rows[place] for place in order.tolist()]


def _objectives(evaluation: Evaluation, names: Sequence[str]) -> dict[str, Array]:
    """Objectives of drives, less is better, NaN unknown."""
    known = ranking.counted_figures(evaluation)
    return {name: _lessened(evaluation.catalog, evaluation.candidates, known, name) for name in names}


def _records(evaluation: Evaluation, rows: Sequence[int], names: Sequence[str]) -> tuple[Choice, ...]:
    """Drives with their figures."""
    known = ranking.counted_figures(evaluation)
    columns = {name: _figure(evaluation.catalog, evaluation.candidates, known, name) for name in names}
    return tuple(
        Choice(
            parts=drive_parts(evaluation, row), figures={name: float(column[row]) for name, column in columns.items()}
        )
        for row in rows
    )


def _figure(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], name: str) -> Array:
    """An objective of drives as it is shown, NaN where a part of it is unknown."""
    value, lacking = ranking.single(catalog, sets, figures, name)
    known: Array = np.where(lacking > 0, np.nan, value)
    return -known if OBJECTIVES[name].more_is_better else known


def _lessened(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], name: str) -> Array:
    """The same of which less is better: of a margin the share of the limit that is used."""
    figure: Array = _figure(catalog, sets, figures, name)
    return used_share(figure) if OBJECTIVES[name].more_is_better else figure


# -- picking


def _cheap(problem: Problem, sets: Candidates, figures: Mapping[str, Array], names: Sequence[str]) -> dict[str, Array]:
    """Objectives of drives as far as they are known without a waveform, less is better; a bound of the mean power."""
    columns = dict[str, Array]()
    for name in names:
        if name == "energy" and np.isnan(figures[name]).any() and not has_steppers(problem.catalog):
            wheels = problem.machine_cases[0]  # of the load case that the energy is of
            power = [problem.cases[n].spec.load.alike * least_power(problem, n, sets) for n in wheels]
            columns[name] = np.sum(power, axis=0)
        else:
            columns[name] = _lessened(problem.catalog, sets, figures, name)
    return columns


class Picked(NamedTuple):
    """Some rows out of many."""

    rows: Whole  # rising
    whole: bool  # whether the Pareto front of all is among them


def picked(figures: Mapping[str, Array], always: Whole, most: int) -> Picked:
    """Rows of drives that some weights may make the best, layer by layer of the Pareto front.

    Examples
    --------
    >>> mass, price = np.array([1.0, 2.0, 2.0, 3.0]), np.array([9.0, 5.0, 6.0, 7.0])
    >>> picked({"mass": mass, "price": price}, np.array([3]), 2)
    Picked(rows=array([0, 1, 3]), whole=True)
    """
    count, columns = len(next(iter(figures.values()))), {n: c for n, c in figures.items() if not np.isnan(c).all()}
    if count <= most or not columns:
        return Picked(np.arange(count) if count <= most else always, count <= most)
    place = _best_places(columns)
    left, layers = np.sort(np.argsort(place, kind="stable")[:_MOST_LAYERED]), list[Whole]()
    known_first = (np.where(np.isnan(x), 2.0 * np.nanmax(np.abs(x)) + 1.0, x) for x in columns.values())
    table = np.stack([*known_first], axis=1)
    while len(left) and sum(map(len, layers)) < most:
        layer = left[undominated(-table[left])]
        left = np.setdiff1d(left, layer)
        layers.append(layer[np.argsort(place[layer], kind="stable")])
    whole = count <= _MOST_LAYERED and len(layers[0]) <= most
    return Picked(np.unique(np.concatenate([always, np.concatenate(layers)[:most]])), whole)


def _best_places(columns: Mapping[str, Array]) -> Whole:
    """The best place of each row in several orders: by each figure alone, by each two of them, by all together."""
    names = [*columns]
    several = [*combinations(names, 1), *combinations(names, 2), tuple(names)]
    orders = [weighted_order(columns, dict.fromkeys(group, 1.0)).order for group in several]
    return np.minimum.reduce([np.argsort(order) for order in orders])
