"""The candidates, motor x gearhead x belt ratio, as rows of the catalogue's tables, and which of them are left."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, Catalog, Table
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.columns.controllers import selected

# -- The candidates: motor x gearhead x belt ratio, as rows of the catalogue's tables.


FREE = -2  # in place of a controller's row: one is chosen


class Candidates(NamedTuple):
    """Rows of motors and gearheads, the belt ratio, and whether a source lists the pair."""

    motor: NDArray[np.int64]
    gearhead: NDArray[np.int64]
    belt: NDArray[np.float64]
    listed: NDArray[np.bool_]
    controller: NDArray[np.int64] | None = None  # row of a controller, or FREE; None: one is chosen for each
    brake: NDArray[np.int64] | None = None  # the same of a brake

    def on(self, rows: NDArray[Any] | slice) -> Candidates:
        """Some of them."""
        controller, brake = (None if given is None else given[rows] for given in (self.controller, self.brake))
        return Candidates(self.motor[rows], self.gearhead[rows], self.belt[rows], self.listed[rows], controller, brake)


def joined(several: Sequence[Candidates]) -> Candidates:
    """Several lists of candidates one after the other; at least one."""
    return Candidates(
        np.concatenate([c.motor for c in several]),
        np.concatenate([c.gearhead for c in several]),
        np.concatenate([c.belt for c in several]),
        np.concatenate([c.listed for c in several]),
    )


class Crossed(NamedTuple):
    """Combinations of motor and gearhead, each of them behind each of several belts: numbered belt by belt."""

    pairs: Candidates  # whatever their belt
    belts: list[float]

    def number(self, belt: NDArray[np.int64], row: NDArray[np.int64]) -> NDArray[np.int64]:
        """Numbers of candidates by those of their belts and the rows of their pairs."""
        found: NDArray[np.int64] = belt * len(self.pairs.motor) + row
        return found

    def on(self, numbers: NDArray[np.int64]) -> Candidates:
        """Some of them."""
        belt, row = np.divmod(numbers, max(len(self.pairs.motor), 1))
        return self.pairs.on(row)._replace(belt=np.array(self.belts, float)[belt])


class Rows:
    """The columns of a table at some rows, taken on first use; at row -1 every figure is unknown."""

    def __init__(self, table: Table[Any], rows: NDArray[np.int64], some_missing: bool | None = None) -> None:
        """``some_missing``: whether a row may be -1, where that is known."""
        self.table, self.rows = table, rows
        self.some_missing = bool((rows < 0).any()) if some_missing is None else some_missing
        self.taken: dict[str, NDArray[Any]] = {}
        self.made: dict[Callable[[Any], Any], Any] = {}

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.taken:
            column: NDArray[Any] = self.table[name]
            if self.some_missing:
                column = np.append(column, np.array([np.nan if column.dtype.kind == "f" else ""], column.dtype))
            self.taken[name] = column.take(self.rows)
        return self.taken[name]

    def each(self, compute: Callable[[Any], Any]) -> Any:
        """Results of a function of the figures of one part alone, once for each part where that is less."""
        if compute not in self.made:
            few = len(self.rows) <= len(self.table)
            self.made[compute] = compute(self) if few else _at(compute(self._every), self.rows)
        return self.made[compute]

    @property
    def _every(self) -> Any:
        """All parts of the table; behind them one of which nothing is known, where there is such a row."""
        return Rows(self.table, np.append(np.arange(len(self.table)), -1)) if self.some_missing else self.table

    def on(self, rows: NDArray[Any] | slice) -> Rows:
        """Some of the rows; for all of them this one, with the columns that it has taken."""
        if isinstance(rows, slice):
            return self if rows == slice(None) else Rows(self.table, self.rows[rows], self.some_missing)
        if rows.dtype == bool:
            rows = np.flatnonzero(rows)
        return Rows(self.table, self.rows.take(rows), self.some_missing)


def _at(columns: Any, rows: NDArray[np.int64]) -> Any:
    """Columns, or several of them, at some rows."""
    if not isinstance(columns, tuple):
        return columns.take(rows)
    taken = (column.take(rows) for column in columns)
    return type(columns)(*taken) if hasattr(columns, "_fields") else tuple(taken)


def pairs(problem: Problem, also: tuple[int, int] | None = None) -> Candidates:
    """Every listed combination of motor and gearhead that the spec allows, without a belt."""
    if also is None:  # variants of a spec mostly have the same
        of = (problem.spec.select,)
        several = bool((problem.catalog.motors["order_number"] != "").any())
        key = "pairs", problem.spec.is_direct, problem.spec.supply.nominal if several else None
        found: Candidates = problem.catalog.once(key, lambda: _pairs(problem, None), of)
        return found
    return _pairs(problem, also)


def _pairs(problem: Problem, also: tuple[int, int] | None) -> Candidates:
    spec, catalog = problem.spec, problem.catalog
    left, right = _alone(catalog) if spec.is_direct else catalog.motor_gearhead[:2]
    keep = selected(catalog.motors, spec.select.motor)[left]
    if spec.select.motor.kind:
        keep &= (catalog.motors["kind"] == spec.select.motor.kind)[left]
    keep &= catalog.motors.at_voltage(spec.supply.nominal)[left]
    keep &= selected(catalog.gearheads, spec.select.gearhead)[right]
    motor, gearhead = left[keep].astype(np.int64), right[keep].astype(np.int64)
    listed = np.ones(len(motor), bool)
    if also is not None and not np.any((motor == also[0]) & (gearhead == also[1])):
        motor, gearhead = np.append(motor, also[0]), np.append(gearhead, also[1])
        listed = np.append(listed, catalog.gearheads["part"][also[1]] == DIRECT)  # nobody need list what is not there
    return Candidates(motor, gearhead, np.ones(len(motor)), listed)


def _alone(catalog: Catalog) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Every motor that is not inside an actuator, and no gearhead."""
    motor = np.flatnonzero(catalog.motors["inside"] == "")
    return motor, np.full(len(motor), catalog.gearheads.rows[DIRECT])


def candidates(problem: Problem, also: tuple[int, int] | None = None) -> Candidates:
    """Every combination of :func:`pairs` with every belt ratio of the problem."""
    found, belts = pairs(problem, also), np.array(problem.belt_ratios)
    every = np.repeat(np.arange(len(found.motor)), len(belts))
    return found.on(every)._replace(belt=np.tile(belts, len(found.motor)))


# -- Candidates through the stages of an examination: which are left, which failed on what, and how closely.
#
# In stages only those that do not fail go on, and of their checks no more is kept than what they amount to;
# otherwise all go through, with every check in full.


Array = NDArray[np.float64]
Rejected = tuple[NDArray[np.int64], Array]  # candidates, and what the smallest margin of each is at most
_ALL = slice(None)
_WORD = 64  # bits of a word of the checks that are unknown
_BITS = {name: (place // _WORD, np.uint64(1 << place % _WORD)) for place, name in enumerate(CHECKS["physics"])}
_WORDS = 1 + max(word for word, _ in _BITS.values())


class Amount(NamedTuple):
    """Amount of checks: columns over parts or candidates."""

    failed: NDArray[np.bool_]  # whether any fails
    unknown: NDArray[np.uint64]  # which are, as bits, shape (rows, words)
    doublings: NDArray[np.int64]  # of known limits up to the demands, over the checks that are undecided
    margin: Array  # the smallest of those that hang on the load; infinite where margins are not computed


def amounting(found: Sequence[CheckColumn], count: int, margins: bool) -> Amount:
    """Amount of some checks."""
    failed, unknown, margin = np.zeros(count, bool), np.zeros((count, _WORDS), np.uint64), np.full(count, np.inf)
    doublings = np.zeros(count, np.int64)
    for check in found:
        failed |= check.failed
        if not check.passed.all():
            word, bit = _BITS[check.name]
            unknown[:, word] |= np.where(check.passed, np.uint64(0), bit)
            doublings += check.doublings
        if margins:
            margin = np.minimum(margin, check.tightness)
    return Amount(failed, unknown, doublings, margin)


def bound_of(found: Sequence[CheckColumn], count: int) -> Array:
    """Upper bound of the smallest margin; -1 where a check fails that has none."""
    least = np.full(count, np.inf)
    for check in found:
        margin = check.margin
        np.minimum(least, np.where(np.isnan(margin), np.where(check.failed, -1.0, np.inf), margin), out=least)
    return least


class Sieve:
    """Candidates through the stages; ``rejected`` and ``failed_by`` are of all that went in."""

    def __init__(
        self,
        rows: NDArray[np.int64],
        unknown: NDArray[np.uint64],
        doublings: NDArray[np.int64],
        margin: Array,
        margins: bool,
    ) -> None:
        """The numbers of candidates in stages, with what the checks of their parts amount to."""
        self.rows, self.unknown, self.doublings, self.margin = rows, unknown, doublings, margin
        self.margins = margins
        self.staged = True
        self.checks: list[CheckColumn] = []
        self.failed_by: Counter[str] = Counter()
        self.rejected: list[Rejected] = []

    @classmethod
    def of_all(cls, rows: NDArray[np.int64], checks: list[CheckColumn]) -> Sieve:
        """Candidates that all go through, with the checks of their parts in full."""
        none = np.zeros((len(rows), _WORDS), np.uint64), np.zeros(len(rows), np.int64)
        sieve = cls(rows, *none, np.full(len(rows), np.inf), False)
        sieve.staged, sieve.checks = False, checks
        return sieve

    def split(self, places: Sequence[slice]) -> list[Sieve]:
        """The candidates that are left in parts; what was counted goes with the first."""
        found = []
        for place in places:
            undecided = self.unknown[place], self.doublings[place]
            part = Sieve(self.rows[place], *undecided, self.margin[place], self.margins)
            part.staged, part.checks = self.staged, [check.on(place) for check in self.checks]
            found.append(part)
        found[0].failed_by, found[0].rejected = self.failed_by, self.rejected
        return found

    def through(self, found: Sequence[CheckColumn]) -> NDArray[np.int64] | slice:
        """Keep what does not fail; which of the rows these are: their places, or a slice of all of them.

        In stages advice is not looked at.
        """
        if not self.staged:
            self.checks += found
            return _ALL
        found = [check for check in found if not check.advice]
        if not found or not len(self.rows):
            return _ALL
        for check in found:
            self.failed_by[check.name] += int(np.count_nonzero(check.failed))
        amount = amounting(found, len(self.rows), self.margins)
        kept: NDArray[np.int64] | slice = _ALL
        if amount.failed.any():
            rejected, kept = np.flatnonzero(amount.failed), np.flatnonzero(~amount.failed)
            self.rejected.append((self.rows[rejected], bound_of([c.on(rejected) for c in found], len(rejected))))
            self.rows, self.margin = self.rows[kept], self.margin[kept]
            self.unknown, self.doublings = self.unknown.take(kept, axis=0), self.doublings[kept]
        self.unknown |= amount.unknown[kept]
        self.doublings += amount.doublings[kept]
        if self.margins:
            self.margin = np.minimum(self.margin, amount.margin[kept])
        return kept
