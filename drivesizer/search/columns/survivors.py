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

__all__ = ["Amount", "Rejected", "Sieve", "amounting", "bound_of"]

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
        counted: NDArray[np.bool_] | None = None,
    ) -> None:
        """The numbers of candidates in stages, with what the checks of their parts amount to.

        ``counted``: whose failures count and which may be the closest rejected; None all.
        """
        self.rows, self.unknown, self.doublings, self.margin = rows, unknown, doublings, margin
        self.margins, self.counted = margins, counted
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
            counted = None if self.counted is None else self.counted[place]
            undecided = self.unknown[place], self.doublings[place]
            part = Sieve(self.rows[place], *undecided, self.margin[place], self.margins, counted)
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
            self.failed_by[check.name] += int(np.count_nonzero(self._counted(check.failed)))
        amount = amounting(found, len(self.rows), self.margins)
        kept: NDArray[np.int64] | slice = _ALL
        if amount.failed.any():
            rejected, kept = np.flatnonzero(self._counted(amount.failed)), np.flatnonzero(~amount.failed)
            self.rejected.append((self.rows[rejected], bound_of([c.on(rejected) for c in found], len(rejected))))
            self.rows, self.margin = self.rows[kept], self.margin[kept]
            self.unknown, self.doublings = self.unknown.take(kept, axis=0), self.doublings[kept]
            self.counted = None if self.counted is None else self.counted[kept]
        self.unknown |= amount.unknown[kept]
        self.doublings += amount.doublings[kept]
        if self.margins:
            self.margin = np.minimum(self.margin, amount.margin[kept])
        return kept

    def _counted(self, failed: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Failures that count."""
        return failed if self.counted is None else failed & self.counted
