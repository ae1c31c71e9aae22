"""Machines of a task as they are sized: here or by workers, each once, those of an earlier run out of its folder."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby
from math import inf, isnan
from pathlib import Path
from typing import Any

from drivesizer.codesign.task import Task
from drivesizer.errors import InputError
from drivesizer.results.sizing import used_share
from drivesizer.study import store as folders
from drivesizer.study.figures import NAMED, row_figures
from drivesizer.study.plan import Variant
from drivesizer.study.rows import Row, spec_figures
from drivesizer.study.workers import Workers, computed

Values = tuple[Any, ...]  # of the free figures, as they go into the spec
_WORST = 1e30  # before every machine within the limits
_TIE = 1e-7  # share of a figure by which the smallest margin decides between equals
_GOOD = ("pass", "open", "unknown")


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """A machine with a drive in it, within all limits."""

    row: Row  # of the study's table
    goals: tuple[float, ...]  # what is made least, SI
    margin: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine that was sized, with the drives of its front that are within all limits."""

    number: int  # from 1, in the order in which machines were looked at
    values: Values
    choices: tuple[Choice, ...]
    excess: float  # how far it is from being within the limits, as a share; 0 where it is
    why: str  # what it fails on; empty where it is within all limits
    row: Row | None  # of the drive that is closest; None where it was not sized

    def choice(self, goal: int = 0) -> Choice | None:
        """The drive that is best by one of the goals; of equal ones that of the larger margin."""
        return min(self.choices, key=lambda one: (one.goals[goal], -one.margin), default=None)

    def score(self, goal: int = 0) -> float:
        """Score that a minimiser compares: a goal, and behind every machine within the limits the excess over them."""
        one = self.choice(goal)
        if one is None:
            return _WORST * (1.0 + min(self.excess, 1e6))
        return one.goals[goal] + abs(one.goals[goal]) * _TIE * float(used_share(one.margin))


class Machines:
    """All machines of a task that were looked at."""

    def __init__(self, task: Task, on: Workers | None = None, store: folders.Store | None = None) -> None:
        self.task, self.on, self.store = task, on, store
        self.known: dict[Values, Machine] = {}
        self.sized = 0  # by a search for a drive, here or in an earlier run
        self._kept = _by_number(store.every_row() if store else ())

    def at(self, points: Iterable[Values]) -> list[Machine]:
        """Machines of some values, of which those are sized that are not known yet."""
        wanted = list(points)
        new: dict[Values, Variant] = {}
        for values in dict.fromkeys(wanted):
            if values not in self.known:
                number = len(self.known) + len(new) + 1
                new[values] = self._variant(number, values)
        found = dict(self._outside(new))
        rows = {  # of an earlier run of the same search
            one.number: kept for one in new.values()
            if (kept := self._kept.get(one.number)) and kept[0][: len(one.head)] == one.head
        }  # fmt: skip
        rest = [one for values, one in new.items() if values not in found and one.number not in rows]
        each = max(1, len(rest) // (2 * self.on.ahead)) if self.on else 1
        for part in computed(self.task.job, (rest[n : n + each] for n in range(0, len(rest), each)), self.on):
            if self.store:
                self.store.keep(part)
            rows |= _by_number(part.rows)
        self.sized += len(rows)
        if rows and self.sized == len(rows) and all(some[0][-1] for some in rows.values()):  # the first of all
            raise InputError(next(iter(rows.values()))[0][-1])
        for values, one in new.items():
            self.known[values] = found.get(values) or self._machine(one, rows[one.number])
        return [self.known[values] for values in wanted]

    @property
    def good(self) -> list[Machine]:
        """Those within all limits."""
        return [one for one in self.known.values() if one.choices]

    def _variant(self, number: int, values: Values) -> Variant:
        shown = [one.table_value(value) for one, value in zip(self.task.free, values, strict=True)]
        return Variant(number, 0, values, 0, 0, [number, *shown])

    def figures_of_spec(self, values: Values) -> Callable[[str], float]:
        """Figures of a machine's spec by name."""
        return spec_figures(self.task.job, self._variant(0, values))

    def _outside(self, new: dict[Values, Variant]) -> Iterator[tuple[Values, Machine]]:
        """Machines that the spec alone puts beyond a limit, so that no drive need be looked for."""
        of_spec = [one for one in self.task.limits if not {*one.of.names} & {*NAMED, "merit"}]
        for values, one in new.items() if of_spec else ():
            figure = self.figures_of_spec(values)
            excess, text = max((each.excess(figure), each.text) for each in of_spec)
            if excess > 0.0:
                why = Machine(number=one.number, values=values, choices=(), excess=10.0 + excess, why=text, row=None)
                yield values, why

    def _machine(self, one: Variant, rows: list[Row]) -> Machine:
        """A machine by its rows: each drive against the limits of the task."""
        heads, task = self.task.heads, self.task
        status, named = heads.index("status"), heads.index("smallest_margin")
        check, error = heads.index("smallest_margin_check"), heads.index("error")
        of_spec = self.figures_of_spec(one.values)
        choices = list[Choice]()
        nearest: tuple[float, str, Row] = (inf, "", rows[0])
        for row in rows:
            margin = -inf if row[named] is None else float(row[named])
            if row[status] not in _GOOD:
                by = 100.0 if row[status] == "error" else 1.0 + min(max(-margin, 0.0), 50.0)
                nearest = min(nearest, (by, row[error] or row[check] or "no drive", row), key=lambda each: each[0])
                continue
            figure = row_figures(heads, row, of_spec)
            excesses = [(each.excess(figure), each.text) for each in task.limits]
            goals = tuple(each.value(figure) for each in task.goals)
            unknown = [f"{text}: unknown" for by, text in excesses if isnan(by)]
            unknown += [f"{each.text}: unknown" for each, value in zip(task.goals, goals, strict=True) if isnan(value)]
            beyond = [(by, text) for by, text in excesses if by > 1e-9]
            if unknown:
                nearest = min(nearest, (20.0, unknown[0], row), key=lambda each: each[0])
            elif beyond:
                nearest = min(nearest, (sum(by for by, _ in beyond), max(beyond)[1], row), key=lambda each: each[0])
            else:
                choices.append(Choice(row=row, goals=goals, margin=margin))
        if choices:
            return Machine(number=one.number, values=one.values, choices=tuple(choices), excess=0.0, why="", row=None)
        by, why, row = nearest
        return Machine(number=one.number, values=one.values, choices=(), excess=by, why=why, row=row)


def _by_number(rows: Iterable[Row]) -> dict[int, list[Row]]:
    """Rows of each machine by its number."""
    return {number: list(some) for number, some in groupby(rows, key=lambda row: int(row[0]))}


@contextmanager
def machines(task: Task, on: Workers | None, folder: Path | None, *, fresh: bool = False) -> Iterator[Machines]:
    """Machines of a task, kept in a folder where one is given."""
    if folder is None:
        yield Machines(task, on)
        return
    folders.usable(folder)
    origin = folders.made_of(task.plan)
    goals = [*(one.text for one in task.goals), *(one.text for one in task.limits)]
    origin["goals"] = json.dumps([goals, task.evaluations, task.seed])
    with folders.locked(folder):
        yield Machines(task, on, folders.Store(folder, task.plan, origin, fresh=fresh))
