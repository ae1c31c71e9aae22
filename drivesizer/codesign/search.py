"""The search for the best machine: all of few, else SciPy's differential evolution, in ever smaller boxes.

A minimiser compares machines alone: one within the limits is better than any that is not, of two within the lesser
figure counts, of two beyond the smaller excess (Deb 2000). So figures that jump from drive to drive need no gradient.
Populations are Latin hypercubes with a seed, and a generation is sized at once: the same task gives the same machines
in the same order, however many processes there are.

References
----------
.. [1] R. Storn, K. Price, *Differential evolution*, Journal of Global Optimization 11 (1997), pp. 341-359.
.. [2] K. Deb, *An efficient constraint handling method for genetic algorithms*, Computer Methods in Applied Mechanics
   and Engineering 186 (2000), pp. 311-338.
.. [3] R. E. Steuer, E.-U. Choo, *An interactive weighted Tchebycheff procedure for multiple objective programming*,
   Mathematical Programming 26 (1983), pp. 326-344.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby, product
from math import inf, isnan
from operator import methodcaller
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from drivesizer.codesign.task import Task
from drivesizer.errors import InputError
from drivesizer.files.arithmetic import names_in
from drivesizer.physics.extremes import undominated
from drivesizer.results.sizing import used_share
from drivesizer.study import store as folders
from drivesizer.study.figures import NAMED, row_figures
from drivesizer.study.plan import Variant
from drivesizer.study.rows import Row, spec_figures
from drivesizer.study.run import Progress, Workers, computed

Values = tuple[Any, ...]  # of the free figures, as they go into the spec
_WORST = 1e30  # before every machine within the limits
_TIE = 1e-7  # share of a figure by which the smallest margin decides between equals
_GOOD = ("pass", "open", "unknown")


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A machine with a drive in it, within all limits."""

    row: Row  # of the study's table
    goals: tuple[float, ...]  # what is made least, SI
    margin: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine that was sized, with the drives of its front that are within all limits."""

    number: int  # from 1, in the order in which machines were looked at
    values: Values
    choices: tuple[Choice, ...]
    excess: float  # how far it is from being within the limits, as a share; 0 where it is
    why: str  # what it fails on; empty where it is within all limits
    row: Row | None  # of the drive that is closest; None where it was not sized

    def choice(self, goal: int = 0) -> Choice | None:
        """The drive that is best by one of the goals; of equal ones that of the larger margin."""
        return min(self.choices, key=lambda choice: (choice.goals[goal], -choice.margin), default=None)

    def score(self, goal: int = 0) -> float:
        """Score that a minimiser compares: a goal, and behind every machine within the limits the excess over them."""
        choice = self.choice(goal)
        if choice is None:
            return _WORST * (1.0 + min(self.excess, 1e6))
        return choice.goals[goal] + abs(choice.goals[goal]) * _TIE * float(used_share(choice.margin))


class Machines:
    """All machines of a task that were looked at."""

    def __init__(self, task: Task, on: Workers | None = None, store: folders.Store | None = None) -> None:
        self.task, self.on, self.store = task, on, store
        self.known: dict[Values, Machine] = {}
        self.sized = 0  # by a search for a drive, here or in an earlier run
        self.rows_by_number = _by_number(store.every_row() if store else ())

    def at(self, points: Iterable[Values]) -> list[Machine]:
        """Machines of some values, of which those are sized that are not known yet."""
        all_points = list(points)
        new: dict[Values, Variant] = {}
        for values in dict.fromkeys(all_points):
            if values not in self.known:
                number = len(self.known) + len(new) + 1
                new[values] = self._variant(number, values)
        beyond = dict(self._outside(new))
        rows = {  # of an earlier run of the same search
            variant.number: earlier for variant in new.values()
            if (earlier := self.rows_by_number.get(variant.number)) and earlier[0][: len(variant.head)] == variant.head
        }  # fmt: skip
        rest = [variant for values, variant in new.items() if values not in beyond and variant.number not in rows]
        chunk = max(1, len(rest) // (2 * self.on.ahead)) if self.on else 1
        for part in computed(self.task.job, (rest[n : n + chunk] for n in range(0, len(rest), chunk)), self.on):
            if self.store:
                self.store.keep(part)
            rows |= _by_number(part.rows)
        self.sized += len(rows)
        if rows and self.sized == len(rows) and all(of[0][-1] for of in rows.values()):  # the first of all
            raise InputError(next(iter(rows.values()))[0][-1])
        for values, variant in new.items():
            self.known[values] = beyond.get(values) or self._machine(variant, rows[variant.number])
        return [self.known[values] for values in all_points]

    @property
    def good(self) -> list[Machine]:
        """Those within all limits."""
        return [machine for machine in self.known.values() if machine.choices]

    def _variant(self, number: int, values: Values) -> Variant:
        cells = [axis.table_value(value) for axis, value in zip(self.task.free, values, strict=True)]
        return Variant(number, 0, values, 0, 0, [number, *cells])

    def figures_of_spec(self, values: Values) -> Callable[[str], float]:
        """Figures of a machine's spec by name."""
        return spec_figures(self.task.job, self._variant(0, values))

    def _outside(self, new: dict[Values, Variant]) -> Iterator[tuple[Values, Machine]]:
        """Machines that the spec alone puts beyond a limit, so that no drive need be looked for."""
        of_spec = [limit for limit in self.task.limits if not {*limit.of.names} & {*NAMED, "merit"}]
        for values, variant in new.items() if of_spec else ():
            figure = self.figures_of_spec(values)
            excess, text = max((limit.excess(figure), limit.text) for limit in of_spec)
            if excess > 0.0:
                why = Machine(
                    number=variant.number, values=values, choices=(), excess=10.0 + excess, why=text, row=None
                )
                yield values, why

    def _machine(self, variant: Variant, rows: list[Row]) -> Machine:
        """A machine by its rows: each drive against the limits of the task."""
        heads, task = self.task.heads, self.task
        status, named = heads.index("status"), heads.index("smallest_margin")
        check, error = heads.index("smallest_margin_check"), heads.index("error")
        of_spec = self.figures_of_spec(variant.values)
        choices = list[Choice]()
        nearest: tuple[float, str, Row] = (inf, "", rows[0])
        for row in rows:
            margin = -inf if row[named] is None else float(row[named])
            if row[status] not in _GOOD:
                by = 100.0 if row[status] == "error" else 1.0 + min(max(-margin, 0.0), 50.0)
                nearest = min(nearest, (by, row[error] or row[check] or "no drive", row), key=lambda miss: miss[0])
                continue
            figure = row_figures(heads, row, of_spec)
            excesses = [(limit.excess(figure), limit.text) for limit in task.limits]
            goals = tuple(goal.value(figure) for goal in task.goals)
            unknown = [f"{text}: unknown" for by, text in excesses if isnan(by)]
            unknown += [f"{goal.text}: unknown" for goal, value in zip(task.goals, goals, strict=True) if isnan(value)]
            beyond = [(by, text) for by, text in excesses if by > 1e-9]
            if unknown:
                nearest = min(nearest, (9.0, unknown[0], row), key=lambda miss: miss[0])
            elif beyond:
                nearest = min(nearest, (sum(by for by, _ in beyond), max(beyond)[1], row), key=lambda miss: miss[0])
            else:
                choices.append(Choice(row=row, goals=goals, margin=margin))
        if choices:
            return Machine(
                number=variant.number, values=variant.values, choices=tuple(choices), excess=0.0, why="", row=None
            )
        by, why, row = nearest
        return Machine(number=variant.number, values=variant.values, choices=(), excess=by, why=why, row=row)


def _by_number(rows: Iterable[Row]) -> dict[int, list[Row]]:
    """Rows of each machine by its number."""
    return {number: list(group) for number, group in groupby(rows, key=lambda row: int(row[0]))}


@contextmanager
def machines(task: Task, on: Workers | None, folder: Path | None, *, fresh: bool = False) -> Iterator[Machines]:
    """Machines of a task, kept in a folder where one is given."""
    if folder is None:
        yield Machines(task, on)
        return
    folders.usable(folder)
    origin = folders.made_of(task.plan)
    goals = [*(expression.text for expression in task.goals), *(expression.text for expression in task.limits)]
    origin["goals"] = json.dumps([goals, task.evaluations, task.seed])
    with folders.locked(folder):
        yield Machines(task, on, folders.Store(folder, task.plan, origin, fresh=fresh))


Array = NDArray[np.float64]
Score = Callable[[Machine], float]
Pair = tuple[Machine, Choice]
_CHUNK = 64  # machines of a grid that are sized at once
_COARSE = 0.35  # share of the evaluations for a coarse grid before all else
_BOXES = ((1.0, 0.35), (0.15, 0.2), (0.02, 0.1))  # share of each range round the best, share of the evaluations
_FEWEST, _MOST = 16, 60  # machines of a generation
_WEIGHTS = 5  # directions of a front beside its ends


def every_machine(of: Machines, progress: Progress) -> None:
    """Size a grid; where the spec alone says how good a machine is, only until none that is left could win."""
    task = of.task
    order: list[Values] = [*product(*(axis.values for axis in task.free))]
    known = not {*names_in(task.goals)} & {*NAMED, "merit"}
    if known and len(task.goals) == 1:
        value = {values: task.minimise.value(of.figures_of_spec(values)) for values in order}
        order.sort(key=value.__getitem__)
    for start in range(0, len(order), _CHUNK):
        machines = of.at(order[start : start + _CHUNK])
        progress(min(start + _CHUNK, len(order)), len(order))
        if known and len(task.goals) == 1 and any(machine.choices for machine in machines):
            return


def evolved(of: Machines, progress: Progress) -> None:
    """Look for the best machine among more than can be sized, and for the front where one is wanted."""
    task = of.task
    ends = len(task.goals)
    searches = 1 if ends == 1 else ends + _WEIGHTS
    evaluations = task.evaluations // searches
    _coarse(of, int(_COARSE * task.evaluations), progress)
    for goal in range(ends):
        _in_boxes(of, methodcaller("score", goal), evaluations, task.seed + goal, progress)
    for n, weights in enumerate(_directions(ends) if ends > 1 else ()):
        _in_boxes(of, _along(of, weights), evaluations, task.seed + ends + n, progress)


def _directions(goals: int) -> Iterator[Array]:
    """Weights of the goals, spread over those between the ends."""
    if goals == 2:
        for share in np.linspace(0.0, 1.0, _WEIGHTS + 2)[1:-1].tolist():
            yield np.array([share, 1.0 - share])
        return
    for point in qmc.Halton(goals, scramble=False).random(_WEIGHTS + 1)[1:]:
        weight = -np.log(np.maximum(point, 1e-9))
        yield weight / weight.sum()


def _along(of: Machines, weights: Array) -> Score:
    """The greatest weighted distance of a machine's best drive from the ideal, in parts of the front's extent [3]."""
    goals = np.array([choice.goals for machine in of.good for choice in machine.choices])
    if not len(goals):
        return Machine.score
    ideal = goals.min(axis=0)
    extent = goals[undominated(-goals)].max(axis=0) - ideal
    extent = np.where(extent > 0.0, extent, 1.0)

    def score(machine: Machine) -> float:
        if not machine.choices:
            return machine.score()
        shares = (np.array([choice.goals for choice in machine.choices]) - ideal) / extent * weights
        return float((shares.max(axis=1) + 1e-3 * shares.sum(axis=1)).min())

    return score


def _coarse(of: Machines, most: int, progress: Progress) -> None:
    """A coarse grid with the ends of all ranges: a best machine often lies there; of many figures a Latin hypercube."""
    free = of.task.free
    low, high = (np.array(ends) for ends in zip(*(axis.bounds for axis in free), strict=True))
    steps = int(most ** (1.0 / len(free)) + 1e-9)
    if steps < 3:
        shares = qmc.LatinHypercube(len(free), rng=np.random.default_rng(of.task.seed)).random(most)
        points = low + shares * (high - low)
    else:
        points = np.array(list(product(*(np.linspace(*ends, steps) for ends in zip(low, high, strict=True)))))
    values = [tuple(f.value(x) for f, x in zip(free, point, strict=True)) for point in points.tolist()]
    for start in range(0, len(values), _CHUNK):
        of.at(values[start : start + _CHUNK])
        progress(len(of.known), of.task.evaluations)


def _in_boxes(of: Machines, score: Score, most: int, seed: int, progress: Progress) -> None:
    free = of.task.free
    low, high = (np.array(ends) for ends in zip(*(axis.bounds for axis in free), strict=True))
    for share, part in _BOXES:
        first = min(of.known.values(), key=lambda machine: (score(machine), machine.number))
        best = np.array([axis.coordinate(value) for axis, value in zip(free, first.values, strict=True)])
        reach = share * (high - low) / (1.0 if share == 1.0 else 2.0)
        whole = np.array([not axis.continuous for axis in free])
        reach = np.where(whole, np.maximum(np.floor(reach), 1.0), reach)
        box = np.maximum(low, best - reach), np.minimum(high, best + reach)
        _minimise(of, score, box, int(most * part), seed, best, progress)


def _minimise(
    of: Machines, score: Score, box: tuple[Array, Array], most: int, seed: int, start: Array, progress: Progress
) -> None:
    """Look for the best machine in a box from a point in it, by differential evolution."""
    low, high = box
    free, open_ = of.task.free, np.flatnonzero(high > low)
    count = min(max(_FEWEST, 8 * len(open_)), _MOST)
    if not len(open_):
        return

    def points(columns: Array) -> list[Values]:
        coordinates = np.repeat(start[:, None], columns.shape[1], axis=1)
        coordinates[open_] = columns
        return [tuple(f.value(x) for f, x in zip(free, column, strict=True)) for column in coordinates.T.tolist()]

    def scores(columns: Array) -> Array:
        matrix = columns if columns.ndim == 2 else columns[:, None]
        values = np.array([score(machine) for machine in of.at(points(matrix))])
        progress(min(len(of.known), of.task.evaluations), of.task.evaluations)
        return values if columns.ndim == 2 else values[0]

    hypercube = qmc.LatinHypercube(len(open_), rng=np.random.default_rng(seed)).random(count)
    population = low[open_] + hypercube * (high - low)[open_]
    population[0] = start[open_]
    whole = np.array([not free[n].continuous for n in open_.tolist()])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it stopped where it was to
        differential_evolution(
            scores, list(zip(low[open_].tolist(), high[open_].tolist(), strict=True)),
            init=population, integrality=whole,
            maxiter=max(1, most // count - 1), rng=seed, polish=False, updating="deferred", vectorized=True,
            tol=0.0, atol=0.0, mutation=(0.4, 0.9), recombination=0.8,
        )  # fmt: skip


def front_of(of: Machines) -> list[Pair]:
    """Machines with drives that no other beats in all goals, in the order of the first."""
    if len(of.task.goals) < 2:
        return []
    pairs = [(machine, choice) for machine in of.good for choice in machine.choices]
    pairs.sort(key=lambda pair: (-pair[1].margin, pair[0].number))  # of equal ones the first remains
    goals = np.array([[float(f"{value:.9g}") for value in choice.goals] for _, choice in pairs])
    front = [pairs[n] for n in undominated(-goals).tolist()] if pairs else []
    return sorted(front, key=lambda pair: pair[1].goals)


def best_of(machines: Sequence[Machine]) -> Machine | None:
    """The best machine: by the first goal, then by its smallest margin, then the one that was looked at first."""
    good = [(machine, choice) for machine in machines if (choice := machine.choice())]
    if not good:
        return None
    return min(good, key=lambda pair: (float(f"{pair[1].goals[0]:.9g}"), -pair[1].margin, pair[0].number))[0]
