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
from drivesizer.output.document import records as doc
from drivesizer.output.terminal.render import text_of_blocks
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
        return text_of_blocks(self.blocks())

    def blocks(self) -> Iterator[doc.Block]:
        """Tables and sentences that say all of it."""
        yield doc.Words(_searched(self))
        if self.choice is None:
            yield doc.Words("No machine is within all limits.")
            if self.nearest is not None:
                yield doc.Words(f"Closest: {_values(self, self.nearest)}; it fails on {_why(self.nearest.why)}.")
            return
        goal = self.task.minimise
        best = f"{_title(goal)}: {_figure(self, goal, self.choice.goals[0])}"
        yield doc.Table(best, _FREE, [doc.Row(cells) for cells in _free(self)])
        yield doc.listed((("", "left"), ("", "left")), _drive(self, self.choice), "The drive")
        if self.rounded and (one := self.rounded.choice()):
            yield doc.Words(f"Rounded: {_values(self, self.rounded)}: {_figure(self, goal, one.goals[0])}")
        if self.front:
            yield _front(self)
        yield from (doc.Words(f"{note}.", "note") for note in self.task.notes)


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


_FREE = [doc.Column(head, head, "text" if head.endswith("that") else "name")
         for head in ("free figure", "best", "within 1 %", "below that", "above that")]  # fmt: skip


def _free(answer: Answer) -> Iterator[dict[str, doc.Cell]]:
    """The free figures with the ranges in which the optimum is flat."""
    assert answer.best is not None
    for flat, value in zip(answer.flat, answer.best.values, strict=True):
        span = "only this" if flat.low == flat.high else f"{flat.low} .. {flat.high}"
        cells = flat.free.name, str(value), span, _why(flat.below), _why(flat.above)
        yield {column.key: cell for column, cell in zip(_FREE, cells, strict=True)}


def _drive(answer: Answer, choice: Choice) -> Iterator[tuple[str, str]]:
    """The drive with what it costs, and the limits that it is closest to."""
    assert answer.best is not None
    heads, task = answer.task.heads, answer.task
    row = dict(zip(heads, choice.row, strict=True))
    sets = {head.removesuffix("set").rstrip("."): value for head, value in row.items() if head.endswith("set")}
    for name, label in sets.items():
        number = f"{row['drives']} of " if not name and row.get("drives", 1) != 1 else ""
        yield name or "drive", f"{number}{label}" + (f" ({row['status']})" if row["status"] != "pass" else "")
    of_spec = spec_figures(task.job, Variant(0, 0, answer.best.values, 0, 0, []))
    figure = row_figures(heads, choice.row, of_spec)
    shown = [(name, NAMED[name].title, figure(name), NAMED[name]) for name in _SHOWN if NAMED[name].column in row]
    lacks = {name: row.get(f"{name}_lacks") for name in ("mass", "price")}

    def least(names: Iterable[str]) -> str:
        lacking = " + ".join(dict.fromkeys(str(lacks[name]) for name in names if lacks.get(name)))
        return f", at least: {lacking} not known" if lacking else ""

    for name, title, value, named in shown:
        if not isnan(value):
            yield title, f"{show(value, named.unit, named.kind)}{least([name])}"
    yield "tightest", f"{_why(str(row['smallest_margin_check']))}, {100 * choice.margin:+.1f} %"
    for limit in task.limits:
        yield limit.text, f"{_figure(answer, limit.of, limit.of.value(figure))}{least(limit.of.names)}"


def _front(answer: Answer) -> doc.Table:
    """The front, thinned to a dozen machines; free figures that are the same in all are said above it."""
    task = answer.task
    step = max(1, -(-len(answer.front) // _FRONT))
    few = [*answer.front[::step], *([answer.front[-1]] if (len(answer.front) - 1) % step else [])]
    free = [*enumerate(one.name for one in task.free)]
    same = [(n, name) for n, name in free if len({machine.values[n] for machine, _ in few}) == 1]
    columns = [doc.Column(one.text, _title(one), "number") for one in task.goals]
    columns += [doc.Column(name, name, "number", yields=True) for n, name in free if (n, name) not in same]
    rows = []
    for machine, choice in few:
        row = dict(zip(task.heads, choice.row, strict=True))
        goals = (_figure(answer, one, value) for one, value in zip(task.goals, choice.goals, strict=True))
        drives = ", ".join(str(label) for head, label in row.items() if head == "set" or head.endswith(".set"))
        cells = dict(zip((one.text for one in task.goals), goals, strict=True)) | {"drive": drives}
        rows.append(doc.Row(cells | {name: str(machine.values[n]) for n, name in free}))
    alike = ", ".join(f"{name} {few[0][0].values[n]}" for n, name in same)
    caption = "The front" + (f"; in all of it {alike}" if alike else "")
    return doc.Table(caption, [*columns, doc.Column("drive", "drive")], rows)


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
