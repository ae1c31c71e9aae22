"""Candidates with figures that are estimated: which they are, and the problem at both ends of the bands.

The search examines both ends in one go: behind the parts at the favourable end stand those that some candidate needs
at the unfavourable one, as rows of the same tables.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table, columns_of
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import OfferedBrakes, offered_brakes
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.offers import Offers, offers, scattered
from drivesizer.spec.robot import RobotSpec

__all__ = ["BothEnds", "at_ends", "both_ends", "estimated"]

# sizes and masses: whether a drive moves its load does not hang on them
_SIZES = {"mass", "length", "diameter", "backlash"}
_NEEDED = {"length": "length", "mass": "mass", "diameter": "diameter", "backlash": "backlash_at_load"}


def at_ends(problem: Problem) -> tuple[Problem, Problem]:
    """The problem with estimated figures at the favourable and at the unfavourable end of their bands."""
    favourable, unfavourable = (replace(problem, catalog=end) for end in problem.catalog.ends)
    return favourable, unfavourable


def estimated(problem: Problem, candidates: Candidates, method: str = "physics") -> NDArray[np.int64]:
    """Candidates with an estimated figure that a check may hang on."""
    if not problem.catalog.ends:
        return np.zeros(0, np.int64)
    motors, gearheads = (_differ(problem.catalog, name, problem.spec, method) for name in ("motors", "gearheads"))
    found: NDArray[np.bool_] = motors[candidates.motor] | gearheads[candidates.gearhead]
    if method == "physics" and (offered := offered_brakes(problem.spec, problem.catalog)) is not None:
        brakes: NDArray[np.bool_] = np.append(_differ(problem.catalog, "brakes", problem.spec, method), False)
        uncertain: NDArray[np.bool_] = np.any(brakes[offered.row], axis=1)
        found |= uncertain[candidates.motor]
    return np.flatnonzero(found)


def _differ(catalog: Catalog, section: str, spec: RobotSpec, method: str) -> NDArray[np.bool_]:
    """Parts of which a figure that counts is not the same at both ends."""
    left = frozenset(name for name in _SIZES if not getattr(spec.needs, _NEEDED[name]))

    def differ() -> NDArray[np.bool_]:
        low, high = (end.table(section) for end in catalog.ends)
        found = np.zeros(len(low), bool)
        counted = None if method == "physics" else _paper_figures(section)
        for name, column in columns_of(section).items():
            if column.kind != "text" and name not in left and (counted is None or name in counted):
                found |= (low[name] != high[name]) & ~np.isnan(low[name])
        return found

    found: NDArray[np.bool_] = catalog.once(("differ", section, left, method), differ)
    return found


def _paper_figures(section: str) -> set[str]:
    """Figures of a kind of part that checks of the paper's method rest on."""
    prefix = f"{section[:-1]}."
    names = {name for check in CHECKS["paper"].values() for name in check.rests_on}
    return {name.removeprefix(prefix) for name in names if name.startswith(prefix)}


class BothEnds(NamedTuple):
    """Parts at the favourable end of the bands, and behind them those of some candidates at the unfavourable end."""

    problem: Problem  # its catalogue has both; encoders and controllers do not hang on the end
    offered: Offers  # for every motor of it
    motors: NDArray[np.int64]  # rows of those that are there twice, rising
    gearheads: NDArray[np.int64]

    def unfavourable(self, sets: Candidates) -> Candidates:
        """Some of those candidates with their parts at that end."""
        motor, gearhead = (
            len(table) - len(rows) + np.searchsorted(rows, of)
            for table, rows, of in (
                (self.problem.catalog.motors, self.motors, sets.motor),
                (self.problem.catalog.gearheads, self.gearheads, sets.gearhead),
            )
        )
        return sets._replace(motor=motor, gearhead=gearhead)

    def brakes(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Rows of brakes at either end as those of the catalogue."""
        return np.where(rows < 0, rows, rows % max(len(self.problem.catalog.brakes) // 2, 1))


def both_ends(problem: Problem, uncertain: Candidates) -> BothEnds:
    """The problem at both ends of the bands of estimated figures, to be examined in one go."""
    easy, hard = at_ends(problem)
    motors, gearheads = np.unique(uncertain.motor), np.unique(uncertain.gearhead)
    rows = {"motors": motors, "gearheads": gearheads, "brakes": np.arange(len(hard.catalog.brakes))}
    tables = {name: _behind(easy.catalog.table(name), hard.catalog.table(name), some) for name, some in rows.items()}
    together = replace(easy, catalog=easy.catalog.with_tables(tables, {}))
    return BothEnds(together, _offered(offers(easy), offers(hard), motors), motors, gearheads)


def _behind(table: Table[Any], other: Table[Any], rows: NDArray[np.int64]) -> Table[Any]:
    """A table with some rows of another behind its own."""
    source = np.concatenate([table.source, other.source[rows]])
    excluded = np.concatenate([table.excluded, other.excluded[rows]])
    return Table(table.section, _Columns(table.columns, other.columns, rows), source, excluded)


class _Columns(Mapping[str, NDArray[Any]]):
    """Columns of a table with some rows of another behind: put together on first use, as few are used."""

    def __init__(
        self, columns: Mapping[str, NDArray[Any]], others: Mapping[str, NDArray[Any]], rows: NDArray[np.int64]
    ) -> None:
        self.columns, self.others, self.rows = columns, others, rows
        self.made: dict[str, NDArray[Any]] = {}

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.made:
            self.made[name] = np.concatenate([self.columns[name], self.others[name].take(self.rows)])
        return self.made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)


def _offered(easy: Offers, hard: Offers, motors: NDArray[np.int64]) -> Offers:
    """Offers for each motor, and for some of them at the unfavourable end."""
    count = len(easy.encoders.row)
    every = np.append(np.arange(count), motors)
    encoders = easy.encoders._replace(
        **{name: getattr(easy.encoders, name)[every] for name in ("row", "counts", "fastest", "known", "last")}
    )
    first, last = slice(0, count), slice(count, len(every))
    limits = [(first, easy.motor_limits), (last, [check.on(motors) for check in hard.motor_limits])]
    return Offers(
        encoders,
        easy.controllers.of(every),
        scattered(limits, len(every)),
        None if easy.brakes is None or hard.brakes is None else _brakes(easy.brakes, hard.brakes, motors),
    )


def _brakes(easy: OfferedBrakes, hard: OfferedBrakes, motors: NDArray[np.int64]) -> OfferedBrakes:
    """Brakes of each motor; of those at the unfavourable end those at that end, behind the others."""
    count, (several, kinds) = len(motors), easy.listed.shape
    wide = max(easy.row.shape[1], hard.row.shape[1])
    row, listed = np.full((several + count, wide), -1), np.zeros((several + count, 2 * kinds), bool)
    row[:several, : easy.row.shape[1]] = easy.row
    row[several:, : hard.row.shape[1]] = _moved(hard.row[motors], kinds)
    listed[:several, :kinds], listed[several:, kinds:] = easy.listed, hard.listed[motors]
    return OfferedBrakes(row, listed, np.append(easy.last, _moved(hard.last[motors], kinds)))


def _moved(rows: NDArray[np.int64], by: int) -> NDArray[np.int64]:
    """Rows of what comes behind others; of none -1."""
    return np.where(rows < 0, rows, rows + by)
