"""Candidates through the stages of an examination: which are left, which failed on what, and how closely.

In stages only those that do not fail go on, and of their checks no more is kept than what they amount to; otherwise
all go through, with every check in full.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import CHECKS
from drivesizer.search.columns.candidates import Candidates

__all__ = ["Alone", "Sieve"]

Array = NDArray[np.float64]
_ALL = slice(None)
_WORD = 64  # bits of a word of the checks that are unknown
_BITS = {name: (place // _WORD, np.uint64(1 << place % _WORD)) for place, name in enumerate(CHECKS["physics"])}
_WORDS = 1 + max(word for word, _ in _BITS.values())
_ENOUGH = 100  # rejected candidates, to find the closest among


class Sieve:
    """Candidates through the stages."""

    def __init__(self, sets: Candidates, staged: bool, margins: bool) -> None:
        self.sets, self.staged, self.margins = sets, staged, margins
        self.rows = np.arange(len(sets.motor))
        self.checks: list[CheckColumn] = []
        self.failed_by: Counter[str] = Counter()
        self.unknown = np.zeros((len(sets.motor), _WORDS), np.uint64)  # checks, as bits
        self.margin = np.full(len(sets.motor), np.inf)
        self.rejected: list[tuple[NDArray[np.int64], Array]] = []

    def parts(self, alone: Alone) -> None:
        """The first stage: each part is judged once, and each pair by its two parts."""
        sets = self.sets
        for check in alone.load:
            self.failed_by[check.name] += len(self.rows) * int(check.failed)
        for found, owner in ((alone.gearhead, sets.gearhead), (alone.motor, sets.motor)):
            used = np.bincount(owner)
            for check in found:
                self.failed_by[check.name] += int(used @ check.failed[: len(used)])
        if self.staged:
            self._drop(alone)
        owners = (
            (alone.load, self.rows),
            (alone.gearhead, sets.gearhead[self.rows]),
            (alone.motor, sets.motor[self.rows]),
        )
        for found, owner in owners:
            self._keep(found, owner)

    def _drop(self, alone: Alone) -> None:
        """Candidates with a part that fails; those of a motor that fails too are hardly among the nearest."""
        load, gearhead, motor = (_judged(found) for found in alone)
        bad_gearhead, bad_motor = gearhead[0][self.sets.gearhead], motor[0][self.sets.motor]
        fails = bad_gearhead | bad_motor | load[0]
        rejected = np.flatnonzero(fails & ~bad_motor)
        if len(rejected) < _ENOUGH:
            rejected = np.flatnonzero(fails)
        bound = np.minimum(gearhead[1][self.sets.gearhead[rejected]], load[1])
        self.rejected.append((rejected, np.minimum(bound, motor[1][self.sets.motor[rejected]])))
        self.rows = np.flatnonzero(~fails)
        self.unknown, self.margin = self.unknown[self.rows], self.margin[self.rows]

    def through(self, found: Sequence[CheckColumn]) -> NDArray[np.bool_] | slice:
        """Keep what does not fail; which of the rows these are: a mask, or a slice of all of them.

        In stages advice is not looked at.
        """
        if self.staged:
            found = [check for check in found if not check.advice]
        for check in found:
            self.failed_by[check.name] += int(np.count_nonzero(check.failed))
        if not self.staged or not found:
            self._keep(found, _ALL)
            return _ALL
        keep: NDArray[np.bool_] = ~np.logical_or.reduce([check.failed for check in found])
        if keep.all():
            self._keep(found, _ALL)
            return _ALL
        rejected, passing = np.flatnonzero(~keep), np.flatnonzero(keep)
        self.rejected.append((self.rows[rejected], _judged([check.on(rejected) for check in found])[1]))
        self.rows, self.unknown, self.margin = self.rows[passing], self.unknown[passing], self.margin[passing]
        self._keep(found, passing)
        return keep

    def _keep(self, found: Sequence[CheckColumn], rows: NDArray[np.int64] | slice) -> None:
        """Remember checks of the rows that are left, by their places in the checks: whole, or what they amount to."""
        if not self.staged:
            self.checks += [_of(check, rows) for check in found]
            return
        for check in found:
            passed = check.passed[rows] if check.passed.ndim else check.passed
            word, bit = _BITS[check.name]
            self.unknown[:, word] |= np.where(passed, np.uint64(0), bit)
            if self.margins:
                self.margin = np.minimum(self.margin, _of(check, rows).tightness)


class Alone(NamedTuple):
    """Checks of the load, of each gearhead and of each motor of the catalogue."""

    load: list[CheckColumn]
    gearhead: list[CheckColumn]
    motor: list[CheckColumn]


def _judged(found: Sequence[CheckColumn]) -> tuple[NDArray[np.bool_], Array]:
    """Whether any check fails, and what the smallest margin is at most; -1 where one fails that has none."""
    if not found:
        return np.zeros(1, bool), np.full(1, np.inf)
    failed = np.logical_or.reduce([np.atleast_1d(check.failed) for check in found])
    return failed, np.minimum.reduce([np.atleast_1d(_at_most(check)) for check in found])


def _at_most(check: CheckColumn) -> Array:
    """Margins; where there is none, -1 of what fails, else infinite."""
    margin = check.margin
    return np.where(np.isnan(margin), np.where(check.failed, -1.0, np.inf), margin)


def _of(check: CheckColumn, rows: NDArray[np.int64] | slice) -> CheckColumn:
    """A check of parts as one of the drives that they belong to; one figure as that of all."""
    if isinstance(rows, slice):
        return check
    return check.on(rows) if check.passed.ndim else check.on_all(rows)
