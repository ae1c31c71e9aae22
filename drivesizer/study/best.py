"""The best sets of a variant and nothing more.

What ``drivesizer size`` finds, without what it tells beside: what would have to give, the other method, the whole
catalogue. That costs many searches more where nothing stands, which in a study is often.
"""

from __future__ import annotations

from itertools import chain
from typing import NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Counts
from drivesizer.search.machine_filter import ranked
from drivesizer.search.ranking import Ranking, title_of
from drivesizer.search.set_record import drive_set
from drivesizer.search.shortlist import shortlist
from drivesizer.spec.robot import RobotSpec

__all__ = ["Best", "best"]


class Best(NamedTuple):
    """What a search found, in short."""

    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    nearest: DriveSet | None  # that falls, where nothing stands
    counts: Counts
    objective: str


def best(spec: RobotSpec, catalog: Catalog, *, objective: Ranking | None = None, top: int = 1) -> Best:
    """The best sets of a spec.

    Parameters
    ----------
    spec
        The machine.
    catalog
        Parts to choose from, actuators taken apart and gearheads on every shaft, as ``sizing.load_parts`` gives them.
    objective
        In place of the spec's.
    top
        How many sets to give.

    Raises
    ------
    InputError
        As :func:`drivesizer.sizing.size` does.
    """
    objective = objective or spec.select.objective
    found = shortlist(spec, catalog, objective, top, misses=0, brief=True)
    evaluation = found.found.evaluation
    fallen = (drive_set(evaluation, row, 0, objective) for row in found.fallen)
    close = next(chain(found.unsure.values(), found.short.values(), fallen), None)
    sets = ranked(found.best.values())
    return Best(sets, None if sets else close, found.found.counts, title_of(objective))
