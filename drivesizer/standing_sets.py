"""Which of the sets that a search found stand in the machine that they drive."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from drivesizer.budgets import with_budget
from drivesizer.mechanical_budget import MechanicalBudget
from drivesizer.ranking import Objective
from drivesizer.records import drive_set
from drivesizer.results import DriveSet, verdict
from drivesizer.search import Found
from drivesizer.spec import RobotSpec

__all__ = ["FURTHER", "divided", "on_the_front", "ranked", "shortfall"]

FURTHER = 4  # times as many sets are looked at where some may fall by the machine's budgets


def divided(
    found: Found, spec: RobotSpec, machine: MechanicalBudget | None, objective: Objective, top: int, rows: Iterable[int]
) -> tuple[dict[int, DriveSet], dict[int, DriveSet]]:
    """Of some rows the best sets that stand with the machine's budgets, and the better ones that fall by those.

    Parameters
    ----------
    found
        Of the search.
    spec
        The machine.
    machine
        What is the same for every set, of ``budgets.of_the_platform``.
    objective
        That they were ranked by.
    top
        How many of each.
    rows
        Of sets that no check makes fall, in order.
    """
    catalog = found.evaluation.catalog
    best: dict[int, DriveSet] = {}
    short: dict[int, DriveSet] = {}
    for row in rows:
        one = with_budget(spec, catalog, drive_set(found.evaluation, row, 0, objective), machine)
        falls = one.status == "fail" or (verdict(one.budget) == "unknown" and spec.select.unknown != "allow")
        (short if falls else best)[row] = one
        if len(best) == top:
            break
    return best, dict(list(short.items())[:top])


def on_the_front(
    found: Found, spec: RobotSpec, machine: MechanicalBudget | None, objective: Objective
) -> tuple[DriveSet, ...]:
    """The sets of a Pareto front that stand with the machine's budgets, in its order; see ``divided``."""
    catalog = found.evaluation.catalog
    sets = (with_budget(spec, catalog, drive_set(found.evaluation, row, 0, objective), machine) for row in found.front)
    return ranked(one for one in sets if one.status != "fail")


def ranked(sets: Iterable[DriveSet], before: int = 0) -> tuple[DriveSet, ...]:
    """Sets by the rank in which they are shown."""
    return tuple(replace(one, rank=rank) for rank, one in enumerate(sets, before + 1))


def shortfall(best: dict[int, DriveSet], short: dict[int, DriveSet]) -> list[str]:
    """That better sets fell by a budget."""
    names = sorted({check.title.lower() for one in short.values() for check in one.budget if check.status == "fail"})
    better = [row for row in short if not best or row < min(best)]
    if not better or not names:
        return []
    sets = "1 set that stands" if len(better) == 1 else f"{len(better)} sets that stand"
    return [f"{sets} by method and objective before these: not enough for the machine ({', '.join(names)})"]
