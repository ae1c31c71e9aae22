"""Drives of axes chosen together: so that the sum is least, of few kinds, within the machine's limits.

A carried axis' drive enters the others by its mass alone. So of each axis only drives count that no other equals or
beats in cost and mass, and the axes are gone through from the outermost inward. A bound ends what cannot be the best:
an axis costs no less than with the least masses on it, as long as more mass never makes its drive cheaper.

A kind is a motor with its gearhead. From the best drives on, the two groups of axes whose common kind adds least to the
sum share it, as long as the sum stays within the allowance. What each kind costs is known with the masses that the best
drives put on the axes; with those of the common drives all axes are sized again before they are taken.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.tables import Pairs
from drivesizer.machine.budgets import riding_mass
from drivesizer.results.check import GRAVEST, Status
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.machine import objective_sum
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.passing import sifted
from drivesizer.search.ranking import controlling_unknown, part_rows, single
from drivesizer.search.set_record import drive_parts, other_checks
from drivesizer.search.shortlist import Shortlist, problem_with_drive_mass, shortlist
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.spec.robot import RobotSpec

ORDER = GRAVEST[::-1]
Cost = tuple[int, float]  # figures that are unknown, and the sum of those that are known: less is better in this order
Masses = tuple[float, ...]  # kg, of the carried axes in their order
Kind = tuple[str, str]  # motor and gearhead
Permitted = Mapping[str, Kind]  # kinds by the axis' name; axes that are not in it are free
Array = NDArray[np.float64]
_ROUNDING = 1e-9
_MOST_MERGERS = 12  # common kinds that are tried for one kind less
_OF_A_PAIR = 4  # of them for the same axes
_FIRST = 200  # kinds of an axis that shares none, among which it chooses where other masses are on it
_FREE = 4  # of them that enter the choice for the whole


class Choice(NamedTuple):
    """A drive of an axis, as others see it."""

    name: str
    cost: Cost  # of all drives of the axis
    mass: float  # kg, that rides on the axes that carry this one


class Combination(NamedTuple):
    """A drive for each axis that has one, by its name."""

    choices: dict[str, Choice]
    cost: Cost
    certain: bool  # no other combination costs less, as long as more mass never makes a drive cheaper
    searches: int  # axes that were sized, with the same masses once
    missing: str = ""  # axis without a drive, whatever rides on it


Sized = Callable[[str, Masses], Sequence[Choice]]  # drives of an axis that none beats in cost and mass, by cost


def _total(costs: Iterable[Cost]) -> Cost:
    known = list(costs)
    return sum(missing for missing, _ in known), sum(value for _, value in known)


def within(cost: Cost, limit: Cost) -> bool:
    """Whether a cost is no more than a limit, but for rounding."""
    return cost[0] < limit[0] or (cost[0] == limit[0] and cost[1] <= limit[1] + _ROUNDING * abs(limit[1]))


class _Search:
    """Sizings that were made, how many may follow, and the best combination so far."""

    def __init__(self, order: Sequence[str], carried: Mapping[str, Sequence[str]], sized: Sized, most: int) -> None:
        self.order, self.carried, self.sized, self.most = order, carried, sized, most
        self.offers: dict[tuple[str, Masses], Sequence[Choice]] = {}
        self.least: dict[str, Cost] = {}
        self.best: dict[str, Choice] = {}
        self.cost: Cost | None = None
        self.cut = self.falling = False

    def choices(self, axis: str, masses: Mapping[str, float]) -> Sequence[Choice]:
        """Drives of an axis with drives of some masses on it, each sizing once."""
        on_it = tuple(masses[other] for other in self.carried[axis])
        if (axis, on_it) not in self.offers:
            self.offers[axis, on_it] = self.sized(axis, on_it)
        choices = self.offers[axis, on_it]
        if choices and axis in self.least:
            self.falling |= choices[0].cost < self.least[axis]
        return choices

    def descend(self, depth: int, by_axis: dict[str, Choice], spent: Cost) -> None:
        """Go on with the next axis inward, the cheapest drives first: all of one that others carry."""
        if depth == len(self.order):
            self.best, self.cost = dict(by_axis), spent
            return
        axis, masses = self.order[depth], {name: choice.mass for name, choice in by_axis.items()}
        sized_before = (axis, tuple(masses[other] for other in self.carried[axis])) in self.offers
        if len(self.offers) >= self.most and not sized_before:
            self.cut = True
            return
        rest = _total(self.least[name] for name in self.order[depth + 1 :])
        choices = self.choices(axis, masses)
        for choice in choices if any(axis in names for names in self.carried.values()) else choices[:1]:
            after = _total((spent, choice.cost))
            if self.cost is not None:
                bound, (missing, value) = _total((after, rest)), self.cost
                if bound[0] > missing or (bound[0] == missing and bound[1] >= value - _ROUNDING * abs(value)):
                    return
            self.descend(depth + 1, {**by_axis, axis: choice}, after)

    def one_by_one(self, pick: Callable[[Sequence[Choice]], Choice]) -> Combination:
        """A drive of each axis that has one, those that ride on it chosen before; another choice may cost less."""
        by_axis, missing = dict[str, Choice](), ""
        for axis in self.order:
            choices = self.choices(axis, {name: by_axis[name].mass if name in by_axis else 0.0 for name in self.order})
            if choices:
                by_axis[axis] = pick(choices)
            missing = missing or ("" if choices else axis)
        return Combination(
            by_axis, _total(choice.cost for choice in by_axis.values()), False, len(self.offers), missing
        )


def best_combination(
    order: Sequence[str], carried: Mapping[str, Sequence[str]], sized: Sized, most: int = 100
) -> Combination:
    """The drives of all axes of which the sum of costs is the least."""
    search = _Search(order, carried, sized, most)
    lightest: dict[str, float] = {}
    for axis in order:  # bounds: each axis with the least masses on it
        choices = search.choices(axis, lightest)
        if not choices:
            break
        search.least[axis], lightest[axis] = choices[0].cost, min(choice.mass for choice in choices)
    else:
        search.descend(0, {}, (0, 0.0))
    if search.cost is None:  # an axis has none, or the cheapest were too heavy to carry
        return search.one_by_one(lambda choices: min(choices, key=lambda choice: choice.mass))
    return Combination(search.best, search.cost, not (search.cut or search.falling), len(search.offers))


def axis_by_axis(order: Sequence[str], carried: Mapping[str, Sequence[str]], sized: Sized) -> Combination:
    """The best drive of each axis as it is, those that ride on it chosen before."""
    return _Search(order, carried, sized, 0).one_by_one(lambda choices: choices[0])


# Common drives for several axes, where they cost little more than the best drive of each.


class _Merger(NamedTuple):
    """Two groups of axes with a kind for both."""

    first: tuple[str, ...]
    second: tuple[str, ...]
    kind: Kind
    added: Cost


def fewer_kinds(
    best: Combination,
    kinds: Mapping[str, Kind],
    offered: Mapping[str, Mapping[Kind, Cost]],
    limit: Cost,
    search: Callable[[Permitted], Combination],
) -> tuple[Combination, dict[str, Kind]]:
    """A combination of fewer kinds of drives within a limit; kinds are offered by axis, the best first."""
    by_kind: dict[Kind, tuple[str, ...]] = {}
    for axis, kind in kinds.items():
        by_kind[kind] = (*by_kind.get(kind, ()), axis)
    groups = list(by_kind.values())
    common = {axis: kinds[axis] for group in groups if len(group) > 1 for axis in group}
    first = len(groups)

    def own(group: tuple[str, ...]) -> Cost:
        """Cost of the axes of a group with the kind that they share; of a single axis with its best."""
        if group[0] not in common:
            return min(offered[group[0]].values())
        return _total(offered[axis][common[axis]] for axis in group)

    while len(groups) > 1:
        mergers: list[_Merger] = []  # the least added cost first, as far as the sum may stay within the limit
        for group, other in combinations(groups, 2):
            axes, before, pair_mergers = (*group, *other), _total((own(group), own(other))), []
            for kind in offered[axes[0]]:
                if all(kind in offered[axis] for axis in axes):
                    after = _total(offered[axis][kind] for axis in axes)
                    pair_mergers.append(_Merger(group, other, kind, (after[0] - before[0], after[1] - before[1])))
            mergers += sorted(pair_mergers, key=lambda merger: merger.added)[:_OF_A_PAIR]
        likely = [merger for merger in mergers if within(_total((best.cost, merger.added)), limit)]
        for merger in sorted(likely, key=lambda merger: merger.added)[:_MOST_MERGERS]:
            shared = common | dict.fromkeys((*merger.first, *merger.second), merger.kind)
            result = search(shared)
            if not result.missing and within(result.cost, limit):
                break
        else:
            break
        groups = [group for group in groups if group not in (merger.first, merger.second)]
        groups.append((*merger.first, *merger.second))
        best, common = result, shared
    return best, common if len(groups) < first else {}


class Loaded(NamedTuple):
    """An axis with drives on it, as it is searched."""

    spec: RobotSpec
    catalog: Catalog
    sampling: Sampling | None


class _Row(NamedTuple):
    """A drive of a search."""

    shortlist: Shortlist
    row: int
    choice: Choice


def kind_of(drive: DriveParts) -> Kind:
    """Part numbers of a drive's motor and gearhead."""
    return drive.motor.part, drive.gearhead.part


class OfferedKinds:
    """Kinds of drives that the axes of a machine may have; searches over few of them, each made once."""

    def __init__(self, axes: Mapping[str, Masses], loaded: Callable[[str, Masses], Loaded]) -> None:
        self.loaded, self.axes = loaded, axes
        self.rows: dict[tuple[str, Masses, frozenset[Kind]], dict[Kind, _Row]] = {}
        self.first: dict[str, frozenset[Kind]] = {}  # by axis

    def costs(self, statuses: Mapping[str, Status], slack: float) -> dict[str, dict[Kind, Cost]]:
        """Cost of the kinds of drives of every axis that pass and cost little more than the cheapest, which is first.

        Budgets of the machine aside.
        """
        offered = {}
        for axis, on_it in self.axes.items():
            loaded = self.loaded(axis, on_it)
            problem, _ = problem_with_drive_mass(loaded.spec, loaded.catalog)
            candidates, _, _ = sifted(problem)
            objective = str(loaded.spec.select.objective)
            value, missing = _known(problem.catalog, candidates.sets, candidates.figures, objective)
            drives = problem.machine.load.motors
            motors, gearheads = problem.catalog.motors["part"], problem.catalog.gearheads["part"]
            rows, costs = np.lexsort((value, missing)), dict[Kind, Cost]()
            for row in rows[candidates.certainty[rows] <= ORDER.index(statuses[axis])].tolist():
                kind = str(motors[candidates.sets.motor[row]]), str(gearheads[candidates.sets.gearhead[row]])
                costs.setdefault(kind, (int(missing[row]), objective_sum(objective, float(value[row]), drives)))
            self.first[axis] = frozenset(list(costs)[:_FIRST])
            least = min(costs.values(), default=(0, 0.0))
            limit = least[0], least[1] + slack
            offered[axis] = {kind: cost for kind, cost in costs.items() if within(cost, limit)}
        return offered

    def choices(self, axis: str, masses: Masses, kind: Kind | None, status: Status) -> list[Choice]:
        """Drives of a kind on an axis with drives of some masses on it; of the first few kinds where it is free."""
        kinds = self.first[axis] if kind is None else frozenset((kind,))
        key = axis, masses, kinds
        if key not in self.rows:
            self.rows[key] = _searched(_restricted(self.loaded(axis, masses), kinds), min(len(kinds), _FREE))
        rows = self.rows[key].values()
        statuses = [row.shortlist.search.evaluation.status(row.row) for row in rows]
        pairs = zip(rows, statuses, strict=True)
        return [row.choice for row, own in pairs if ORDER.index(own) <= ORDER.index(status)][:_FREE]

    def record(self, axis: str, masses: Masses, name: str) -> tuple[Problem, DriveSet]:
        """A drive that ``choices`` gave, in full, and the problem it is of."""
        known = (rows for (other, on_it, _), rows in self.rows.items() if (other, on_it) == (axis, masses))
        row = next(row for rows in known for row in rows.values() if row.choice.name == name)
        short, evaluation = row.shortlist, row.shortlist.search.evaluation
        checks = other_checks(short.problem, drive_parts(evaluation, row.row))
        reliability = short.reliability.get(row.row)
        return short.problem, short.record(row.row, 1, beside=checks, reliability=reliability)


def _searched(loaded: Loaded, kinds: int) -> dict[Kind, _Row]:
    """The best drive of each kind, in the order of the search."""
    if not len(loaded.catalog.motor_gearhead.left):
        return {}
    top, objective = kinds * max(1, len(loaded.spec.belt_ratios)), str(loaded.spec.select.objective)
    short = shortlist(loaded.spec, loaded.catalog, top, misses=0, sampling=loaded.sampling, detail="drives")
    rows: dict[Kind, _Row] = {}
    for row in short.best:
        drive = drive_parts(short.search.evaluation, row)
        if kind_of(drive) in rows:
            continue
        evaluation = short.search.evaluation.on(np.array([row]))
        bought = part_rows(evaluation, needs_encoder=not evaluation.spec.steps)
        value, missing = _known(evaluation.catalog, evaluation.candidates, {**evaluation.figures, **bought}, objective)
        cost = int(missing[0]), objective_sum(objective, float(value[0]), short.problem.machine.load.motors)
        rows[kind_of(drive)] = _Row(short, row, Choice(drive.label, cost, riding_mass(short.problem, drive)))
    return rows


def _known(
    catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], objective: str
) -> tuple[Array, NDArray[np.int64]]:
    """Known part of an objective, and number of parts of which it is unknown."""
    value, missing = single(catalog, sets, figures, objective)
    return value, missing + controlling_unknown(catalog, sets, figures, objective)


def _restricted(loaded: Loaded, kinds: frozenset[Kind]) -> Loaded:
    """The same with the motors and gearheads of some kinds alone."""
    spec, catalog = loaded.spec, loaded.catalog
    if spec.is_direct:
        motor = spec.select.motor.model_copy(update={"part": sorted({motor for motor, _ in kinds})})
        select = spec.select.model_copy(update={"motor": motor})
        return loaded._replace(spec=spec.changed(lambda spec: spec.model_copy(update={"select": select})))
    listed = [(catalog.motors.rows.get(motor, -1), catalog.gearheads.rows.get(gear, -1)) for motor, gear in kinds]
    gears = len(catalog.gearheads)
    numbers = np.array([motor * gears + gear for motor, gear in listed if min(motor, gear) >= 0], np.int64)

    def restricted(catalog: Catalog) -> Catalog:
        pairs = catalog.motor_gearhead
        keep = np.isin(pairs.left.astype(np.int64) * gears + pairs.right, numbers)
        left = Pairs(*(column[keep] for column in pairs))
        return replace(catalog, motor_gearhead=left, ends=tuple(restricted(end) for end in catalog.ends))

    return loaded._replace(catalog=restricted(catalog))


# Other drives for the axes where the best of each together break a limit of the machine.


def cheapest_first(offers: Mapping[str, Sequence[Choice]], most: int) -> Iterator[dict[str, Choice]]:
    """Choices of one drive for each axis in the order of their cost, the cheapest of all left out."""
    names = list(offers)
    start = (0,) * len(names)

    def cost(places: tuple[int, ...]) -> tuple[int, float, int]:
        costs = [offers[name][place].cost for name, place in zip(names, places, strict=True)]
        return sum(missing for missing, _ in costs), sum(value for _, value in costs), sum(places)

    waiting, seen = [(cost(start), start)], {start}
    while waiting and most > 0:
        _, places = heapq.heappop(waiting)
        if any(places):
            most -= 1
            yield {name: offers[name][place] for name, place in zip(names, places, strict=True)}
        for n, name in enumerate(names):
            further = (*places[:n], places[n] + 1, *places[n + 1 :])
            if further[n] < len(offers[name]) and further not in seen:
                seen.add(further)
                heapq.heappush(waiting, (cost(further), further))
