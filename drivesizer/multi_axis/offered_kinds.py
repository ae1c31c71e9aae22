"""Kinds of drives that the axes of a machine may have, and the drives of some kinds with masses on an axis."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.tables import Pairs
from drivesizer.machine.budgets import riding_mass
from drivesizer.multi_axis.combinations import Choice, Cost
from drivesizer.multi_axis.few_kinds import Kind, within
from drivesizer.results.check import Status
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.problem import Problem
from drivesizer.search.both_methods import other_checks
from drivesizer.search.columns.bought import chosen
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.order.ranking import controlling_unknown, single
from drivesizer.search.order.sifting import sifted
from drivesizer.search.own_mass import problem_with_drive_mass
from drivesizer.search.set_record import drive_parts
from drivesizer.search.shortlist import Shortlist, shortlist
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.spec.robot import RobotSpec

__all__ = ["ORDER", "Loaded", "OfferedKinds", "kind_of"]

ORDER: tuple[Status, ...] = ("pass", "open", "unknown", "fail")
_FIRST = 200  # kinds of an axis that shares none, among which it chooses where other masses are on it
_FREE = 4  # of them that enter the choice for the whole
Masses = tuple[float, ...]
Array = NDArray[np.float64]


class Loaded(NamedTuple):
    """An axis with drives on it, as it is searched."""

    spec: RobotSpec
    catalog: Catalog
    objective: str
    sampling: Sampling | None


class _Row(NamedTuple):
    """A drive of a search."""

    shortlist: Shortlist
    row: int
    kind: Kind
    choice: Choice


def kind_of(one: DriveParts) -> Kind:
    """Part numbers of a drive's motor and gearhead."""
    return one.motor.part, one.gearhead.part


class OfferedKinds:
    """Searches over few kinds, each made once."""

    def __init__(self, axes: Mapping[str, Masses], loaded: Callable[[str, Masses], Loaded]) -> None:
        self.loaded = loaded
        self.made: dict[tuple[str, Masses, frozenset[Kind]], dict[Kind, _Row]] = {}
        self.first: dict[str, frozenset[Kind]] = {}  # by axis
        self.axes = axes

    def costs(self, statuses: Mapping[str, Status], slack: float) -> dict[str, dict[Kind, Cost]]:
        """Cost of the kinds of drives of every axis that pass, the cheapest first."""
        found = {axis: _costs(self.loaded(axis, on_it), statuses[axis]) for axis, on_it in self.axes.items()}
        self.first = {axis: frozenset(list(costs)[:_FIRST]) for axis, costs in found.items()}
        return {axis: _within(costs, slack) for axis, costs in found.items()}

    def choices(self, axis: str, masses: Masses, kind: Kind | None, status: Status) -> list[Choice]:
        """Drives of a kind on an axis with drives of some masses on it; of the first few kinds where it is free."""
        found = self._found(axis, masses, self.first[axis] if kind is None else frozenset((kind,)))
        return [row.choice for row in found.values() if _no_worse(row, status)][:_FREE]

    def record(self, axis: str, masses: Masses, name: str) -> tuple[Problem, DriveSet]:
        """A drive that ``choices`` gave, in full, and the problem it is of."""
        known = (rows for (one, on_it, _), rows in self.made.items() if (one, on_it) == (axis, masses))
        found = next(row for rows in known for row in rows.values() if row.choice.name == name)
        short, evaluation = found.shortlist, found.shortlist.found.evaluation
        beside = other_checks(short.problem, drive_parts(evaluation, found.row))
        reliability = short.reliability.get(found.row)
        return short.problem, short.record(found.row, 1, beside=beside, reliability=reliability)

    def _found(self, axis: str, masses: Masses, kinds: frozenset[Kind]) -> dict[Kind, _Row]:
        """The best drive of each of some kinds, in the order of the search."""
        key = axis, masses, kinds
        if key not in self.made:
            loaded = _restricted(self.loaded(axis, masses), kinds)
            belts = max(1, len(loaded.spec.belt_ratios))
            self.made[key] = _searched(loaded, min(len(kinds), _FREE) * belts)
        return self.made[key]


def _costs(loaded: Loaded, status: Status) -> dict[Kind, Cost]:
    """Cost of all kinds of drives of an axis that pass, budgets of the machine aside; the cheapest first."""
    problem, _ = problem_with_drive_mass(loaded.spec, loaded.catalog, loaded.objective)
    kept, _, _ = sifted(problem, {loaded.objective}, None)
    value, missing = _known(problem.catalog, kept.sets, kept.figures, loaded.objective)
    drives = _drives_summed(loaded.objective, problem.machine)
    motors, gearheads = problem.catalog.motors["part"], problem.catalog.gearheads["part"]
    rows = np.lexsort((value, missing))
    rows = rows[kept.certainty[rows] <= ORDER.index(status)]
    found: dict[Kind, Cost] = {}
    for row in rows.tolist():
        kind = str(motors[kept.sets.motor[row]]), str(gearheads[kept.sets.gearhead[row]])
        found.setdefault(kind, (int(missing[row]), float(value[row]) * drives))
    return found


def _within(costs: Mapping[Kind, Cost], slack: float) -> dict[Kind, Cost]:
    """Those that cost little more than the cheapest."""
    least = min(costs.values(), default=(0, 0.0))
    return {kind: cost for kind, cost in costs.items() if within(cost, (least[0], least[1] + slack))}


def _searched(loaded: Loaded, top: int) -> dict[Kind, _Row]:
    """The best drive of each kind."""
    if not len(loaded.catalog.motor_gearhead.left):
        return {}
    found = shortlist(
        loaded.spec, loaded.catalog, loaded.objective, top, misses=0, sampling=loaded.sampling, brief=True
    )
    rows: dict[Kind, _Row] = {}
    for row in found.best:
        one = drive_parts(found.found.evaluation, row)
        if kind_of(one) not in rows:
            choice = Choice(one.label, _cost(found, row), riding_mass(found.problem, one))
            rows[kind_of(one)] = _Row(found, row, kind_of(one), choice)
    return rows


def _cost(found: Shortlist, row: int) -> Cost:
    """The objective of all drives of an axis."""
    objective = str(found.objective)
    some = found.found.evaluation.on(np.array([row]))
    figures = {**some.figures, **chosen(some.encoder, some.controller, some.brake, needs_encoder=not some.spec.steps)}
    value, missing = _known(some.catalog, some.candidates, figures, objective)
    return int(missing[0]), float(value[0]) * _drives_summed(objective, found.problem.machine)


def _known(
    catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], objective: str
) -> tuple[Array, NDArray[np.int64]]:
    """Known part of an objective, and number of parts of which it is unknown."""
    value, missing = single(catalog, sets, figures, objective)
    return value, missing + controlling_unknown(catalog, sets, figures, objective)


def _drives_summed(objective: str, spec: RobotSpec) -> int:
    """Drives of an axis over which an objective is summed: the energy of a cycle is that of all already."""
    return 1 if objective == "energy" else spec.load.motors


def _no_worse(row: _Row, status: Status) -> bool:
    found = row.shortlist.found.evaluation.status(row.row)
    return ORDER.index(found) <= ORDER.index(status)


def _restricted(loaded: Loaded, kinds: Collection[Kind]) -> Loaded:
    """The same with the motors and gearheads of some kinds alone."""
    spec, catalog = loaded.spec, loaded.catalog
    if spec.is_direct:
        motor = spec.select.motor.model_copy(update={"part": sorted({motor for motor, _ in kinds})})
        select = spec.select.model_copy(update={"motor": motor})
        return loaded._replace(spec=spec.changed(lambda one: one.model_copy(update={"select": select})))
    listed = [(catalog.motors.rows.get(motor, -1), catalog.gearheads.rows.get(gear, -1)) for motor, gear in kinds]
    every = len(catalog.gearheads)
    wanted = np.array([motor * every + gear for motor, gear in listed if min(motor, gear) >= 0], np.int64)

    def kept(one: Catalog) -> Catalog:
        pairs = one.motor_gearhead
        keep = np.isin(pairs.left.astype(np.int64) * every + pairs.right, wanted)
        left = Pairs(*(column[keep] for column in pairs))
        return replace(one, motor_gearhead=left, ends=tuple(kept(end) for end in one.ends))

    return loaded._replace(catalog=kept(catalog))
