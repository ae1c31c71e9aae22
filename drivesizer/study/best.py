"""The best drives of a variant.

The result of ``drivesizer size`` without relaxations, the other method and the catalogue: these take many further
searches where no drive passes, which is frequent in a study.
"""

from __future__ import annotations

from collections.abc import Hashable
from itertools import chain, islice
from typing import Any, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Counts
from drivesizer.search.order.ranking import Ranking, title_of
from drivesizer.search.shortlist import shortlist
from drivesizer.spec.robot import RobotSpec

__all__ = ["Best", "best"]


class Best(NamedTuple):
    """Short result of a search."""

    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    nearest: DriveSet | None  # closest rejected, where none passes
    counts: Counts
    objective: str
    drives: int  # of this kind that the machine has


def best(
    spec: RobotSpec,
    catalog: Catalog,
    *,
    objective: Ranking | None = None,
    top: int = 1,
    made: dict[Hashable, Any] | None = None,
) -> Best:
    """The best drives of a spec."""
    objective = objective or spec.select.objective
    found = shortlist(spec, catalog, objective, top, misses=0, brief=True, checks_alone=True, made=made)
    first = found.best or [*islice(chain(found.unsure, found.short, found.rejected), 1)]
    shown = tuple(found.record(row, rank, reliability=found.reliability.get(row)) for rank, row in enumerate(first, 1))
    sets = shown if found.best else ()
    return Best(
        sets, None if sets else next(iter(shown), None), found.found.counts, title_of(objective), spec.load.motors
    )
