"""The best machine as a record, and in words: figures, what holds them, drive, limits, the front."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isinf, isnan
from typing import Any

from drivesizer.codesign.machines import Choice, Machine
from drivesizer.codesign.search import Pair
from drivesizer.codesign.task import Task
from drivesizer.files.arithmetic import Expression
from drivesizer.output.words import number_of
from drivesizer.results.check import sentence_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.study.figures import NAMED, kind_of_figure, row_figures
from drivesizer.study.plan import Axis, Variant
from drivesizer.study.rows import spec_figures
from drivesizer.units import KINDS, show

_SHOWN = ("mass", "price", "energy", "time", "autonomy", "range")
_FRONT = 12  # machines of the front that are listed


@dataclass(frozen=True, slots=True, kw_only=True)
class Flat:
    """A free figure near the optimum, the others as they are: how far it may go for a hundredth of the goal."""

    free: Axis
    low: Any  # values as they go into the spec
    high: Any
    below: str  # what ends it there
    above: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The best machine that was found, and its neighbours."""

    task: Task
    best: Machine | None  # None where none is within the limits
    choice: Choice | None
    nearest: Machine | None  # closest to the limits, where none is within them
    front: tuple[Pair, ...]
    flat: tuple[Flat, ...]
    rounded: Machine | None  # the best with round figures, where these cost no more than a hundredth
    sized: int  # machines
    looked_at: int  # machines, with those that the spec alone puts beyond a limit
    whole: bool  # whether no machine is left that could be better

    @property
    def values(self) -> dict[str, Any]:
        """The free figures of the best machine, as they go into the spec; empty where there is none."""
        names = [one.name for one in self.task.free]
        return dict(zip(names, self.best.values, strict=True)) if self.best else {}

    def filled(self, *, rounded: bool = False) -> str:
        """The spec's text with the figures of the best machine, comments kept."""
        one = self.rounded if rounded and self.rounded else self.best
        assert one is not None
        return self.task.filled(one.values)

    def __str__(self) -> str:
        return "\n".join(_lines(self))


def _lines(answer: Answer) -> Iterator[str]:
    task, best, choice = answer.task, answer.best, answer.choice
    yield _searched(answer)
    yield ""
    if best is None or choice is None:
        yield "  No machine is within all limits."
        if answer.nearest is not None:
            yield f"  Closest: {_values(answer, answer.nearest)}; it fails on {_why(answer.nearest.why)}."
        return
    yield f"  {_title(task.minimise)}: {_figure(answer, task.minimise, choice.goals[0])}"
    yield ""
    yield from _table(_free(answer))
    yield ""
    yield from _drive(answer, choice)
    if answer.rounded:
        yield ""
        one = answer.rounded.choice()
        assert one is not None
        figures = _values(answer, answer.rounded)
        yield f"  Rounded: {figures}: {_figure(answer, task.minimise, one.goals[0])}"
    if answer.front:
        yield ""
        yield from _table(_front(answer))
    for note in task.notes:
        yield f"  Note: {note}."


def _searched(answer: Answer) -> str:
    """Number of machines that were looked at, and whether a better one may be left."""
    task = answer.task
    if answer.whole:
        left = task.combinations - answer.looked_at
        beyond = answer.looked_at - answer.sized
        more = f", {beyond:,} of which the spec alone puts beyond a limit" if beyond else ""
        more += f"; {left:,.0f} more cannot be better" if left > 0 else ""
        return f"All of {number_of(int(task.combinations), 'machine')} looked at{more}."
    of = "any number" if isinf(task.combinations) else f"{task.combinations:.3g}"
    free = number_of(len(task.free), "free figure")
    return (
        f"{number_of(answer.sized, 'machine')} sized of {of} that {free} allow; not all, so a better one may be left."
    )


def _values(answer: Answer, one: Machine) -> str:
    """The free figures of a machine."""
    return ", ".join(f"{free.name} {value}" for free, value in zip(answer.task.free, one.values, strict=True))


def _free(answer: Answer) -> list[tuple[str, ...]]:
    """The free figures with the ranges in which the optimum is flat."""
    assert answer.best is not None
    rows: list[tuple[str, ...]] = [("free figure", "best", "within 1 %", "below that", "above that")]
    for flat, value in zip(answer.flat, answer.best.values, strict=True):
        same = flat.low == flat.high
        span = "only this" if same else f"{flat.low} .. {flat.high}"
        rows.append((flat.free.name, str(value), span, _why(flat.below), _why(flat.above)))
    return rows


def _drive(answer: Answer, choice: Choice) -> Iterator[str]:
    """The drive with what it costs, and the limits that it is closest to."""
    assert answer.best is not None
    heads, task = answer.task.heads, answer.task
    row = dict(zip(heads, choice.row, strict=True))
    sets = {head.removesuffix("set").rstrip("."): value for head, value in row.items() if head.endswith("set")}
    for name, label in sets.items():
        number = f"{row['drives']} of " if not name and row.get("drives", 1) != 1 else ""
        yield f"  {name or 'drive'}: {number}{label}" + (f" ({row['status']})" if row["status"] != "pass" else "")
    of_spec = spec_figures(task.job, Variant(0, 0, answer.best.values, 0, 0, []))
    figure = row_figures(heads, choice.row, of_spec)
    shown = [(name, NAMED[name].title, figure(name), NAMED[name]) for name in _SHOWN if NAMED[name].column in row]
    lacks = {name: row.get(f"{name}_lacks") for name in ("mass", "price")}

    def least(names: Iterable[str]) -> str:
        lacking = " + ".join(dict.fromkeys(str(lacks[name]) for name in names if lacks.get(name)))
        return f", at least: {lacking} not known" if lacking else ""

    for name, title, value, named in shown:
        if not isnan(value):
            yield f"  {title}: {show(value, named.unit, named.kind)}{least([name])}"
    yield f"  tightest: {_why(str(row['smallest_margin_check']))}, {100 * choice.margin:+.1f} %"
    for limit in task.limits:
        yield f"  {limit.text}: {_figure(answer, limit.of, limit.of.value(figure))}{least(limit.of.names)}"


def _front(answer: Answer) -> list[tuple[str, ...]]:
    """The front, thinned to a dozen machines."""
    task = answer.task
    heads = (*(_title(one) for one in task.goals), *(one.name for one in task.free), "drive")
    step = max(1, -(-len(answer.front) // _FRONT))
    few = [*answer.front[::step], *([answer.front[-1]] if (len(answer.front) - 1) % step else [])]
    rows = [heads]
    for machine, choice in few:
        row = dict(zip(task.heads, choice.row, strict=True))
        goals = (_figure(answer, one, value) for one, value in zip(task.goals, choice.goals, strict=True))
        drives = ", ".join(str(label) for head, label in row.items() if head == "set" or head.endswith(".set"))
        rows.append((*goals, *map(str, machine.values), drives))
    return rows


def _title(one: Expression) -> str:
    return NAMED[one.text].title if one.text in NAMED else one.text


def _figure(answer: Answer, one: Expression, value: float) -> str:
    """A value of an expression: in the unit of the trade where it is of one figure alone, else in SI."""
    name = one.text.removeprefix("-")
    value = -value if name != one.text else value
    if name in NAMED:
        return show(value, NAMED[name].unit, NAMED[name].kind)
    if one.names == (name,) and name != "merit":
        kind = kind_of_figure(name, answer.task.figures) or "dimensionless"
        return show(value, KINDS[kind].si, kind)
    return f"{value:.5g}"


def _why(name: str) -> str:
    """A check by its title; anything else as it is."""
    for checks in CHECKS.values():
        if name in checks:
            return sentence_case(checks[name].title)
    return name


def _table(rows: list[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(len(row[n]) for row in rows) for n in range(len(rows[0]))]
    for row in rows:
        yield ("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))).rstrip()
