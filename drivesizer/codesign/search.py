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

import warnings
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from operator import methodcaller

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution
from scipy.stats import qmc

from drivesizer.codesign.machines import Choice, Machine, Machines, Values
from drivesizer.files.arithmetic import names_in
from drivesizer.physics.extremes import undominated
from drivesizer.study.figures import NAMED
from drivesizer.study.workers import Progress

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
    order: list[Values] = [*product(*(one.values for one in task.free))]
    known = not {*names_in(task.goals)} & {*NAMED, "merit"}
    if known and len(task.goals) == 1:
        value = {values: task.minimise.value(of.figures_of_spec(values)) for values in order}
        order.sort(key=value.__getitem__)
    for start in range(0, len(order), _CHUNK):
        found = of.at(order[start : start + _CHUNK])
        progress(min(start + _CHUNK, len(order)), len(order))
        if known and len(task.goals) == 1 and any(one.choices for one in found):
            return


def evolved(of: Machines, progress: Progress) -> None:
    """Look for the best machine among more than can be sized, and for the front where one is wanted."""
    task = of.task
    ends = len(task.goals)
    searches = 1 if ends == 1 else ends + _WEIGHTS
    each = task.evaluations // searches
    _coarse(of, int(_COARSE * task.evaluations), progress)
    for goal in range(ends):
        _in_boxes(of, methodcaller("score", goal), each, task.seed + goal, progress)
    for n, weights in enumerate(_directions(ends) if ends > 1 else ()):
        _in_boxes(of, _along(of, weights), each, task.seed + ends + n, progress)


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
    every = np.array([one.goals for machine in of.good for one in machine.choices])
    if not len(every):
        return Machine.score
    ideal = every.min(axis=0)
    extent = every[undominated(-every)].max(axis=0) - ideal
    extent = np.where(extent > 0.0, extent, 1.0)

    def score(one: Machine) -> float:
        if not one.choices:
            return one.score()
        shares = (np.array([choice.goals for choice in one.choices]) - ideal) / extent * weights
        return float((shares.max(axis=1) + 1e-3 * shares.sum(axis=1)).min())

    return score


def _coarse(of: Machines, most: int, progress: Progress) -> None:
    """A coarse grid with the ends of all ranges: a best machine often lies there; of many figures a Latin hypercube."""
    free = of.task.free
    low, high = (np.array(ends) for ends in zip(*(one.bounds for one in free), strict=True))
    steps = int(most ** (1.0 / len(free)) + 1e-9)
    if steps < 3:
        shares = qmc.LatinHypercube(len(free), rng=np.random.default_rng(of.task.seed)).random(most)
        points = low + shares * (high - low)
    else:
        points = np.array(list(product(*(np.linspace(*ends, steps) for ends in zip(low, high, strict=True)))))
    every = [tuple(f.value(x) for f, x in zip(free, point, strict=True)) for point in points.tolist()]
    for start in range(0, len(every), _CHUNK):
        of.at(every[start : start + _CHUNK])
        progress(len(of.known), of.task.evaluations)


def _in_boxes(of: Machines, score: Score, most: int, seed: int, progress: Progress) -> None:
    free = of.task.free
    low, high = (np.array(ends) for ends in zip(*(one.bounds for one in free), strict=True))
    for share, part in _BOXES:
        first = min(of.known.values(), key=lambda one: (score(one), one.number))
        best = np.array([one.coordinate(value) for one, value in zip(free, first.values, strict=True)])
        reach = share * (high - low) / (1.0 if share == 1.0 else 2.0)
        whole = np.array([not one.continuous for one in free])
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
        every = np.repeat(start[:, None], columns.shape[1], axis=1)
        every[open_] = columns
        return [tuple(f.value(x) for f, x in zip(free, column, strict=True)) for column in every.T.tolist()]

    def scores(columns: Array) -> Array:
        some = columns if columns.ndim == 2 else columns[:, None]
        found = np.array([score(one) for one in of.at(points(some))])
        progress(min(len(of.known), of.task.evaluations), of.task.evaluations)
        return found if columns.ndim == 2 else found[0]

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
    every = [(machine, choice) for machine in of.good for choice in machine.choices]
    every.sort(key=lambda pair: (-pair[1].margin, pair[0].number))  # of equal ones the first remains
    goals = np.array([[float(f"{value:.9g}") for value in choice.goals] for _, choice in every])
    found = [every[n] for n in undominated(-goals).tolist()] if every else []
    return sorted(found, key=lambda pair: pair[1].goals)


def best_of(some: Sequence[Machine]) -> Machine | None:
    """The best machine: by the first goal, then by its smallest margin, then the one that was looked at first."""
    good = [(one, choice) for one in some if (choice := one.choice())]
    if not good:
        return None
    return min(good, key=lambda pair: (float(f"{pair[1].goals[0]:.9g}"), -pair[1].margin, pair[0].number))[0]


def nearest_of(some: Sequence[Machine]) -> Machine | None:
    """The machine that is closest to being within the limits."""
    return min(some, key=lambda one: (one.excess, one.number), default=None)
