"""Drives that pass the budgets of their machine."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.budgets import MachineBudget, machine_budget, machine_requirements
from drivesizer.results.check import sentence_case
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Check, verdict
from drivesizer.search.budget_columns import certain_failures
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.least_drawn import battery_failures
from drivesizer.search.order.found import BudgetFilter, Evaluated, Judge, SearchResult
from drivesizer.search.order.ranking import Ranking
from drivesizer.search.search import any_drive, search
from drivesizer.search.set_record import drive_parts, drive_set

if TYPE_CHECKING:
    from drivesizer.machine.platform_budget import MechanicalBudget

__all__ = [
    "Weigh",
    "any_in_machine",
    "best_in_machine",
    "divided",
    "machine_filter",
    "passes_budgets",
    "shortfall",
    "weighing",
]


_FIRST = 4  # times as many drives as are wanted are computed in full at first
_FEWEST, _MORE, _MOST = 8, 8, 1 << 16  # at first at least, times as many each time, at most
_FEW = 4  # whose records cost less than columns of what the paper's method does not compute
_CELLS = 400_000  # drives times pieces of the load cycle at a time: over a long one each row costs
Weigh = Callable[[Evaluation, int], MachineBudget]  # of the drive in a row of an evaluation


def weighing(problem: Problem, machine: MechanicalBudget | None, *, brief: bool = False) -> Weigh:
    """A function that gives the budgets of the machine with a drive in it, of each drive once."""
    made: dict[tuple[int, int, float], MachineBudget] = {}

    def weigh(sets: Evaluation, row: int) -> MachineBudget:
        candidates = sets.candidates
        key = int(candidates.motor[row]), int(candidates.gearhead[row]), float(candidates.belt[row])
        if key not in made:
            made[key] = machine_budget(problem, drive_parts(sets, row), machine, brief=brief)
        return made[key]

    return weigh


def machine_filter(
    problem: Problem,
    machine: MechanicalBudget | None,
    weigh: Weigh,
    aside: frozenset[str] = frozenset(),
    *,
    counted: bool = True,
) -> Judge | None:
    """A function that separates drives that pass the machine's budgets from those that fail; None without budgets."""
    spec = problem.spec
    if not (spec.battery or spec.budget or machine or spec.limits_the_bus):
        return None

    def judge(sets: Candidates, evaluated: Evaluated, wanted: int) -> BudgetFilter:
        count = len(sets.motor)
        if machine and _fails(problem, machine.checks):
            return BudgetFilter(
                np.arange(0), np.arange(count), count, Counter(dict.fromkeys(_failed(machine.checks), count))
            )
        early = _looked_at(battery_failures(problem, sets) if spec.method == "physics" else {}, aside)
        rejected, best, by = _any_of(early, count), list[int](), Counter[str]()
        most = max(_FEWEST, _CELLS // max(case.at_belt.pieces for case in problem.cases))
        alone = 0 if counted else wanted  # these first: they are at hand, and mostly pass
        for rows in _pieces(np.flatnonzero(~rejected), alone, _FIRST * wanted, min(most, _MOST)):
            found = _of_evaluated(weigh, aside, evaluated(rows), wanted - len(best), counted)
            rejected[rows[found.rejected]] = True
            best += rows[found.best].tolist()
            by.update(found.by)
            if len(best) == wanted:
                break
        judged = best[-1] + 1 if len(best) == wanted else count
        by.update({name: int(np.count_nonzero(rows[:judged])) for name, rows in early.items()})
        return BudgetFilter(np.array(best, np.int64), np.flatnonzero(rejected[:judged]), judged, by)

    return judge


def _of_evaluated(weigh: Weigh, aside: frozenset[str], sets: Evaluation, wanted: int, counted: bool) -> BudgetFilter:
    """Of evaluated drives those that pass: by columns where these decide, else one by one."""

    def budget(row: int) -> tuple[Check, ...]:
        return tuple(check for check in weigh(sets, row).checks if check.name not in aside)

    count = len(sets.candidates.motor)
    if wanted <= count and not any(_fails(sets.problem, budget(row)) for row in range(wanted)):
        return BudgetFilter(
            np.arange(wanted), np.arange(0), wanted, Counter()
        )  # in most machines: no need of the columns
    few = not counted and not sets.figures and count <= _FEW  # columns are to be computed, and cost more than so many
    certain = _looked_at({} if few else certain_failures(sets), aside)
    rejected, best, by = _any_of(certain, count), list[int](), Counter[str]()
    for row in np.flatnonzero(~rejected).tolist():
        checks = budget(row)
        if _fails(sets.problem, checks):
            rejected[row] = True
            by.update(_failed(checks))
        else:
            best.append(row)
        if len(best) == wanted:
            break
    judged = best[-1] + 1 if len(best) == wanted else count
    by.update({name: int(np.count_nonzero(rows[:judged])) for name, rows in certain.items()})
    return BudgetFilter(np.array(best, np.int64), np.flatnonzero(rejected[:judged]), judged, by)


def _looked_at(found: dict[str, NDArray[np.bool_]], aside: frozenset[str]) -> dict[str, NDArray[np.bool_]]:
    return {name: rows for name, rows in found.items() if name not in aside}


def _any_of(found: dict[str, NDArray[np.bool_]], count: int) -> NDArray[np.bool_]:
    rows: NDArray[np.bool_] = np.logical_or.reduce([np.zeros(count, bool), *found.values()])
    return rows


def _pieces(rows: NDArray[np.int64], alone: int, first: int, most: int) -> Iterator[NDArray[np.int64]]:
    """Some rows alone, then a piece at a time, each larger than the one before: a piece costs much more than a row."""
    if alone and len(rows):
        yield rows[:alone]
        rows = rows[alone:]
    size = min(max(first, _FEWEST), most)
    while len(rows):
        yield rows[:size]
        rows, size = rows[size:], min(_MORE * size, most)


def any_in_machine(problem: Problem) -> bool:
    """Whether any drive passes by itself and in its machine."""
    machine = machine_requirements(problem.machine)
    return any_drive(problem, machine_filter(problem, machine, weighing(problem, machine)))


def best_in_machine(problem: Problem, objective: Ranking, aside: frozenset[str] = frozenset()) -> DriveSet | None:
    """The best drive that passes the machine's budgets too; None where none does."""
    machine = machine_requirements(problem.machine)
    judge = machine_filter(problem, machine, weighing(problem, machine), aside)
    found = search(problem, top=1, objective=objective, misses=None, judge=judge)
    return drive_set(found.evaluation, 0, 1, objective) if found.passing else None


def passes_budgets(problem: Problem, one: DriveParts) -> bool:
    """Whether a drive passes the budgets of its machine, which need not have been computed."""
    machine = machine_requirements(problem.machine)
    if machine and _fails(problem, machine.checks):
        return False
    return not _fails(problem, machine_budget(problem, one, machine).checks)


def _fails(problem: Problem, checks: tuple[Check, ...]) -> bool:
    """Whether a machine's checks reject its drive: one fails, or is unknown where the spec rejects that."""
    status = verdict(checks)
    return status == "fail" or (status == "unknown" and problem.spec.select.unknown != "allow")


def _failed(checks: tuple[Check, ...]) -> set[str]:
    return {check.name for check in checks if check.status == "fail"}


def divided(found: SearchResult, weigh: Weigh, top: int, rows: Iterable[int], *, short: bool = False) -> list[int]:
    """Of some rows the best drives that pass the machine's budgets, or the first ones that fail on those."""
    evaluation = found.evaluation

    def fails(row: int) -> bool:
        return evaluation.fails(row) or _fails(evaluation.problem, weigh(evaluation, row).checks)

    return list(islice((row for row in rows if fails(row) == short), top))


def shortfall(short: Iterable[MachineBudget], better: int, *, any_passes: bool) -> list[str]:
    """A warning that better drives fail on a budget: how many, and which budgets."""
    names = sorted({sentence_case(check.title) for one in short for check in one.checks if check.status == "fail"})
    if not better or not names:
        return []
    if any_passes:
        drives = "1 better drive is" if better == 1 else f"{better} better drives are"
    else:
        drives = (
            "1 drive meets its own limits and is" if better == 1 else f"{better} drives meet their own limits and are"
        )
    return [f"{drives} not enough for the machine ({', '.join(names)})"]
