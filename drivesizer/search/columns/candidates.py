"""The candidates, motor x gearhead x belt ratio, as rows of the catalogue's tables, and orders of their parts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, Catalog, Table
from drivesizer.physics.braking import released_power
from drivesizer.physics.figures import Alike, Array, Figures, Mask, Whole
from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec

LAST = 1e9  # in place of a figure that is unknown: behind all that are known
FREE = -2  # in place of a part's row: one is chosen


class Candidates(NamedTuple):
    """Rows of motors and gearheads, the belt ratio, and whether a source lists the pair."""

    motor: Whole
    gearhead: Whole
    belt: Array
    listed: Mask
    controller: Whole | None = None  # row of a controller, or FREE; None: one is chosen for each
    brake: Whole | None = None  # the same of a brake,
    encoder: Whole | None = None  # and of an encoder

    def on(self, rows: Whole | Mask | slice) -> Candidates:
        """Some of them."""
        return Candidates._make(None if column is None else column[rows] for column in self)


class Crossed(NamedTuple):
    """Combinations of motor and gearhead, each of them behind each of several belts: numbered belt by belt."""

    pairs: Candidates  # whatever their belt
    belts: list[float]

    def on(self, numbers: Whole) -> Candidates:
        """Some of them."""
        belt, row = np.divmod(numbers, max(len(self.pairs.motor), 1))
        return self.pairs.on(row)._replace(belt=np.array(self.belts, float)[belt])


class Rows:
    """The columns of a table at some rows, taken on first use; at row -1 every figure is unknown."""

    def __init__(self, table: Table[Any], rows: Whole, some_missing: bool | None = None) -> None:
        """``some_missing``: whether a row may be -1, where that is known."""
        self.table, self.rows = table, rows
        self.some_missing = bool((rows < 0).any()) if some_missing is None else some_missing
        self.columns: dict[str, NDArray[Any]] = {}
        self.results: dict[Callable[[Figures], Alike], Alike] = {}

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.columns:
            column: NDArray[Any] = self.table[name]
            if self.some_missing:
                column = np.append(column, np.array([np.nan if column.dtype.kind == "f" else ""], column.dtype))
            self.columns[name] = column.take(self.rows)
        return self.columns[name]

    def per_part(self, compute: Callable[[Figures], Alike]) -> Alike:
        """Results of a function of the figures of one part alone, once for each part where that is less."""
        if compute not in self.results:
            few = len(self.rows) <= len(self.table)
            table: Figures = self.table
            if self.some_missing and not few:  # behind all parts one of which nothing is known
                table = Rows(self.table, np.append(np.arange(len(self.table)), -1))
            self.results[compute] = compute(self) if few else _at(compute(table), self.rows)
        return self.results[compute]

    def on(self, rows: Whole | Mask | slice) -> Rows:
        """Some of the rows; for all of them this one, with the columns that it has taken."""
        if isinstance(rows, slice):
            return self if rows == slice(None) else Rows(self.table, self.rows[rows], self.some_missing)
        if rows.dtype == bool:
            rows = np.flatnonzero(rows)
        return Rows(self.table, self.rows.take(rows), self.some_missing)


def _at(columns: Alike, rows: Whole) -> Alike:
    """Columns, or several of them, at some rows."""
    if not isinstance(columns, tuple):
        return columns.take(rows)
    members = (column.take(rows) for column in columns)
    return type(columns)(*members) if hasattr(columns, "_fields") else tuple(members)


def pairs(problem: Problem, also: tuple[int, int] | None = None) -> Candidates:
    """Every listed combination of motor and gearhead that the spec allows, without a belt."""
    if also is None:  # variants of a spec mostly have the same
        of = (problem.spec.select,)
        several = bool((problem.catalog.motors["order_number"] != "").any())
        key = "pairs", problem.spec.is_direct, problem.spec.supply.nominal if several else None
        return problem.catalog.once(key, lambda: _pairs(problem, None), of)
    return _pairs(problem, also)


def _pairs(problem: Problem, also: tuple[int, int] | None) -> Candidates:
    spec, catalog = problem.spec, problem.catalog
    left, right = _alone(catalog) if spec.is_direct else catalog.motor_gearhead[:2]
    keep = catalog.motors.named(spec.select.motor.named)[left]
    if spec.select.motor.kind:
        keep &= (catalog.motors["kind"] == spec.select.motor.kind)[left]
    keep &= catalog.motors.at_voltage(spec.supply.nominal)[left]
    keep &= catalog.gearheads.named(spec.select.gearhead.named)[right]
    motor, gearhead = left[keep].astype(np.int64), right[keep].astype(np.int64)
    listed = np.ones(len(motor), bool)
    if also is not None and not np.any((motor == also[0]) & (gearhead == also[1])):
        motor, gearhead = np.append(motor, also[0]), np.append(gearhead, also[1])
        listed = np.append(listed, catalog.gearheads["part"][also[1]] == DIRECT)  # nobody need list what is not there
    return Candidates(motor, gearhead, np.ones(len(motor)), listed)


def _alone(catalog: Catalog) -> tuple[Whole, Whole]:
    """Every motor that is not inside an actuator, and no gearhead."""
    motor = np.flatnonzero(catalog.motors["inside"] == "")
    return motor, np.full(len(motor), catalog.gearheads.rows[DIRECT])


def candidates(problem: Problem, also: tuple[int, int] | None = None) -> Candidates:
    """Every combination of :func:`pairs` with every belt ratio of the problem."""
    combinations, belts = pairs(problem, also), np.array(problem.belt_ratios)
    rows = np.repeat(np.arange(len(combinations.motor)), len(belts))
    return combinations.on(rows)._replace(belt=np.tile(belts, len(combinations.motor)))


# -- Orders of parts: by a figure, or by what an objective sums of them.


def figure_order(table: Table[Any], figure: Array) -> Whole:
    """Rows by a figure, then by part number; unknown figures last."""
    return np.lexsort((table["part"], figure))


def summed_share(spec: RobotSpec, table: Table[Any], catalog: Catalog) -> Array:
    """Share of parts in what the objective of a spec sums, less is better."""
    share = np.zeros(len(table))
    for name, weight in spec.select.weights.items():
        share += weight * parts_share(name, table, catalog, alone=len(spec.select.weights) == 1)
    return share


def parts_share(name: str, table: Table[Any], catalog: Catalog, *, alone: bool) -> Array:
    """Figure of parts that an objective sums, in that of a typical motor; unknown ones behind all others.

    Unknown ones go by mass where nothing else counts: beside other figures a mass would be one more of them. Of what
    turns with the motor the inertia, where the objective is a figure of the motor's current.
    """

    def share() -> Array:
        if name == "energy" and table.section == "brakes":
            return np.asarray(np.nan_to_num(released_power(table), nan=LAST), float)
        column = {"mass": "mass", "price": "price", "length": "added_length"}.get(name, "inertia")
        if column not in table.columns or name == "power" or (name == "length" and table.section != "brakes"):
            return np.zeros(len(table))
        figure, of_motors = table[column], catalog.motors["rotor_inertia" if column == "inertia" else name]
        typical = np.median(known) if len(known := of_motors[~np.isnan(of_motors)]) else 1.0
        unknown = LAST + np.nan_to_num(table["mass"]) if alone else LAST
        return np.where(np.isnan(figure), unknown, figure / typical)

    return catalog.once(("share", name, alone), share, (table,))
