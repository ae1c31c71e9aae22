"""The best sets of a spec and nothing more.

What ``drivesizer size`` finds, without what it tells beside: what would have to give, the other method, the whole
catalogue. That costs many searches more where nothing stands, which in a study is often.
"""

from __future__ import annotations

from typing import NamedTuple

from drivesizer import belt_choice
from drivesizer.budgets import check_battery
from drivesizer.catalog import Catalog
from drivesizer.platform_cases import on_wheels
from drivesizer.ranking import Objective, names_of, title_of
from drivesizer.records import drive_set
from drivesizer.results import Counts, DriveSet
from drivesizer.search import search
from drivesizer.sizing import _FURTHER, _at_its_own_mass, _divided, _known_choices, _known_to, _ranked
from drivesizer.spec import RobotSpec

__all__ = ["Best", "best"]


class Best(NamedTuple):
    """What a search found, in short."""

    sets: tuple[DriveSet, ...]  # that pass or are unknown, best first
    nearest: DriveSet | None  # that falls, where nothing stands
    counts: Counts
    objective: str


def best(spec: RobotSpec, catalog: Catalog, *, objective: Objective | None = None, top: int = 1) -> Best:
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
    spec, _ = _at_its_own_mass(spec, catalog, objective)
    spec = belt_choice.with_pulleys(on_wheels(spec), catalog)
    _known_choices(spec, catalog)
    check_battery(spec, catalog)
    _known_to(spec, set(names_of(objective)))
    most = top * _FURTHER if spec.battery or spec.budget else top
    found = search(spec, catalog, top=most, objective=objective, misses=0)
    stand, short = _divided(found, spec, objective, top)
    nearest = None
    if not stand:
        failed = found.evaluation.failed
        first = next((i for i in range(found.standing, len(failed)) if failed[i]), None)
        fell = [*short.values(), *([] if first is None else [drive_set(found.evaluation, first, 0, objective)])]
        nearest = next(iter(fell), None)
    return Best(_ranked(stand.values()), nearest, found.counts, title_of(objective))
