"""The best machine of a task, and what one wants to know of it: how flat the optimum is, what may be rounded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import floor, isinf, isnan, log10
from pathlib import Path
from typing import Any

from drivesizer.codesign import search
from drivesizer.codesign.search import Choice, Machine, Machines, Pair, Values
from drivesizer.codesign.task import Task, read_task
from drivesizer.files.arithmetic import Expression
from drivesizer.files.yaml_source import source_of
from drivesizer.output.document import records as doc
from drivesizer.output.terminal.render import text_of_blocks
from drivesizer.output.words import number_of
from drivesizer.results.check import sentence_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import frame_of
from drivesizer.spec.robot import RobotSpec
from drivesizer.study.figures import NAMED, kind_of_figure, row_figures
from drivesizer.study.plan import Axis, Variant
from drivesizer.study.rows import forget_files, spec_figures
from drivesizer.study.run import Progress, cores, workers
from drivesizer.units import KINDS, show

_FIGURES = ("mass", "price", "energy", "time", "autonomy", "range")
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
        names = [axis.name for axis in self.task.free]
        return dict(zip(names, self.best.values, strict=True)) if self.best else {}

    def filled(self, *, rounded: bool = False) -> str:
        """The spec's text with the figures of the best machine, comments kept."""
        machine = self.rounded if rounded and self.rounded else self.best
        assert machine is not None
        return self.task.filled(machine.values)

    def __str__(self) -> str:
        return text_of_blocks(self.blocks())

    def rows(self) -> list[dict[str, Any]]:
        """The machines of the front with their drives, or the best alone: free figures and the columns of a study."""
        choices = [choice for _, choice in self.front] or ([self.choice] if self.choice else [])
        return [dict(zip(self.task.heads, choice.row, strict=True)) for choice in choices]

    def to_frame(self) -> Any:
        """The same as a data frame of pandas."""
        return frame_of(self.rows())

    def blocks(self) -> Iterator[doc.Block]:
        """Tables and sentences that say all of it."""
        yield doc.Words(_searched(self))
        if self.choice is None:
            yield doc.Words("No machine is within all limits.")
            if self.nearest is not None:
                yield doc.Words(f"Closest: {_values(self, self.nearest)}; it fails on {_why(self.nearest.why)}.")
                if "price" in self.nearest.why and self.nearest.why.endswith("unknown"):
                    yield doc.Words("Prices count in euros, others by rates: select: {rates: {USD: 0.92 EUR}}.", "note")
            return
        goal = self.task.minimise
        best = f"Best {_title(goal)}: {_figure(self, goal, self.choice.goals[0])}"
        yield doc.Table(best, _FREE, [doc.Row(cells) for cells in _free(self)])
        yield doc.table("words", "The drive", _drive(self, self.choice))
        if self.rounded and (choice := self.rounded.choice()):
            yield doc.Words(f"Rounded: {_values(self, self.rounded)}: {_figure(self, goal, choice.goals[0])}")
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
    of = (
        "any number"
        if isinf(task.combinations)
        else f"{task.combinations:{',.0f' if task.combinations < 1e9 else '.3g'}}"
    )
    free = number_of(len(task.free), "free figure")
    return (
        f"{number_of(answer.sized, 'machine')} sized of {of} that {free} allow; not all, so a better one may be left."
    )


def _values(answer: Answer, machine: Machine) -> str:
    """The free figures of a machine."""
    return ", ".join(f"{free.name} {value}" for free, value in zip(answer.task.free, machine.values, strict=True))


_FREE = [doc.Column(head, head, "name" if head == "free figure" else "text")
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
    if row["unknown_checks"]:
        names = row["unknown_checks"].split(" + ")
        more = f", {len(names) - 3} more" if len(names) > 3 else ""
        yield "unknown", "; ".join(_why(name) for name in names[:3]) + more
    of_spec = spec_figures(task.job, Variant(0, 0, answer.best.values, 0, 0, []))
    figure = row_figures(heads, choice.row, of_spec)
    figures = [(name, NAMED[name].title, figure(name), NAMED[name]) for name in _FIGURES if NAMED[name].column in row]
    lacks = {name: row.get(f"{name}_lacks") for name in ("mass", "price")}

    def least(names: Iterable[str]) -> str:
        lacking = " + ".join(dict.fromkeys(str(lacks[name]) for name in names if lacks.get(name)))
        return f", at least: {lacking} not known" if lacking else ""

    for name, title, value, named in figures:
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
    free = [*enumerate(axis.name for axis in task.free)]
    same = [(n, name) for n, name in free if len({machine.values[n] for machine, _ in few}) == 1]
    columns = [doc.Column(goal.text, _title(goal), "number") for goal in task.goals]
    columns += [doc.Column(name, name, "number", yields=True) for n, name in free if (n, name) not in same]
    rows = []
    for machine, choice in few:
        row = dict(zip(task.heads, choice.row, strict=True))
        goals = (_figure(answer, goal, value) for goal, value in zip(task.goals, choice.goals, strict=True))
        drives = ", ".join(str(label) for head, label in row.items() if head == "set" or head.endswith(".set"))
        cells = dict(zip((goal.text for goal in task.goals), goals, strict=True)) | {"drive": drives}
        rows.append(doc.Row(cells | {name: str(machine.values[n]) for n, name in free}))
    alike = ", ".join(f"{name} {few[0][0].values[n]}" for n, name in same)
    caption = "The front" + (f"; in all of it {alike}" if alike else "")
    return doc.Table(caption, [*columns, doc.Column("drive", "drive")], rows)


def _title(expression: Expression) -> str:
    """The figure's title, also where it is made large; an expression as it is written."""
    name = expression.text.removeprefix("-")
    return NAMED[name].title if name in NAMED else name if expression.names == (name,) else expression.text


def _figure(answer: Answer, expression: Expression, value: float) -> str:
    """A value of an expression: in the unit of the trade where it is of one figure alone, else in SI."""
    name = expression.text.removeprefix("-")
    value = -value if name != expression.text else value
    if name in NAMED:
        return show(value, NAMED[name].unit, NAMED[name].kind)
    if expression.names == (name,) and name != "merit":
        kind = kind_of_figure(name, answer.task.figures) or "dimensionless"
        return show(value, KINDS[kind].si, kind)
    return f"{value:.5g}"


def _why(name: str) -> str:
    """A check by its title; anything else as it is."""
    for checks in CHECKS.values():
        if name in checks:
            return sentence_case(checks[name].title)
    return name


FLAT = 0.01  # share by which a figure may be worse where an optimum is called flat
_HALVINGS = 12  # of the range on either side
_BOUND = "end of its range"


def answer(
    task: Task,
    *,
    processes: int = 0,
    folder: Path | None = None,
    fresh: bool = False,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Answer:
    """The best machine of a task."""
    most = 1 if task.job.merit else processes or cores()
    advance: Progress = progress or (lambda done, total: None)
    forget_files()
    whole = task.combinations <= task.evaluations
    with workers(most, scheduler) as on, search.machines(task, on, folder, fresh=fresh) as of:
        (search.every_machine if whole else search.evolved)(of, advance)
        best = search.best_of(list(of.known.values()))
        flat, rounded = tuple[Flat, ...](), None
        if best is not None:
            flat = tuple(_flatness(of, best))
            better = search.best_of(list(of.known.values()))
            if better is not None and better is not best:  # that a neighbour is
                best, flat = better, tuple(_flatness(of, better))
            rounded = _rounded(of, best, flat)
        closest = min(of.known.values(), key=lambda machine: (machine.excess, machine.number), default=None)
        return Answer(
            task=task, best=best, choice=best.choice() if best else None, nearest=None if best else closest, flat=flat,
            front=tuple(search.front_of(of)), rounded=rounded, sized=of.sized, looked_at=len(of.known), whole=whole,
        )  # fmt: skip


def design(
    spec: str | Path | Mapping[str, Any] | RobotSpec,
    *,
    free: Mapping[str, Any] | None = None,
    minimise: str | Callable[[DriveSet], float] | None = None,
    subject_to: Sequence[str] | None = None,
    pareto: Sequence[str] | None = None,
    evaluations: int | None = None,
    seed: int | None = None,
    processes: int = 1,
    folder: str | Path | None = None,
    progress: Progress | None = None,
) -> Answer:
    """The best machine with its drive.

    Parameters
    ----------
    spec
        A file, the same fields as a dict, or a spec that was read.
    free
        Free figures beside those that the spec has, by field: ``{"load.wheel_diameter": "120 mm .. 250 mm"}``, a list,
        or ``{"free": ..., "step": ...}``.
    minimise
        An expression, such as ``"mass + 0.1 * price"``, or a function of a drive.
    subject_to, pareto, evaluations, seed
        As in section ``design`` of a spec, and in its place where given.
    processes
        That share the work; 0 is one for each core. With a function it is done in this one.
    folder
        Where every machine is kept; the same call goes on from there.
    progress
        Called with the machines that are done and all there are to be.

    Returns
    -------
    Answer
        Figures of the best machine, its drive, the front, how flat the optimum is; printed, it says all of that.

    Raises
    ------
    InputError
        When the spec, a free figure or an expression is wrong: one line.

    Examples
    --------
    >>> cart = {
    ...     "name": "cart", "supply": {"nominal": "24 V", "accepts": "all"},
    ...     "load": {"kind": "wheeled_vehicle", "mass": "60 kg", "driven_wheels": 2, "wheel_diameter": "200 mm",
    ...              "rolling_resistance": 0.02, "inertia": "40 kg*cm^2"},
    ...     "motion": {"speed": "1 m/s", "acceleration_time": "1 s", "cruise_time": "9 s"},
    ...     "select": {"motor": {"family": "RE 40"}, "gearhead": {"family": "GP 42 C"}},
    ... }
    >>> found = design(cart, free={"load.wheel_diameter": ["150 mm", "250 mm"]}, minimise="load.wheel_diameter")
    >>> found.values
    {'load.wheel_diameter': '150 mm'}
    """
    source = spec.source if isinstance(spec, RobotSpec) else source_of(spec)
    judged = None if minimise is None or isinstance(minimise, str) else minimise
    task = read_task(
        source, free=free, merit=judged, minimise=None if judged else minimise, evaluations=evaluations, seed=seed,
        subject_to=None if subject_to is None else list(subject_to), pareto=None if pareto is None else list(pareto),
    )  # fmt: skip
    return answer(task, processes=processes, folder=None if folder is None else Path(folder), progress=progress)


# -- How flat the optimum is: each figure alone goes as far to either side as the goal allows, by halving.


@dataclass
class _Side:
    """One figure and how far it may go to one side: in places of its list, or figures."""

    place: int  # of the free figure
    good: float
    bad: float | None  # None: not looked at yet
    end: float
    why: str = ""

    def next(self, free: Axis) -> float | None:
        """The next coordinate to try; None where the end is known well enough."""
        if self.bad is None:
            return None if self.end == self.good else self.end
        middle = (self.good + self.bad) / 2
        if not free.continuous:
            middle = float(floor(middle) if self.bad > self.good else -floor(-middle))
        return None if middle == self.good else middle


def _flatness(of: Machines, best: Machine) -> list[Flat]:
    """Ranges of the figures, each alone, within a hundredth of the goal."""
    free = of.task.free
    coordinates = [axis.coordinate(value) for axis, value in zip(free, best.values, strict=True)]
    sides = [
        _Side(place, coordinates[place], None, end)
        for place, axis in enumerate(free)
        for end in axis.bounds
    ]  # fmt: skip
    most = of.task.evaluations // 4 // len(sides)  # of many figures each is looked at more coarsely
    for _ in range(min(max(most, 2), _HALVINGS)):
        steps = [(side, x) for side in sides if (x := side.next(free[side.place])) is not None]
        if not steps:
            break
        machines = of.at([_with(free, best.values, side.place, x) for side, x in steps])
        for (side, x), machine in zip(steps, machines, strict=True):
            if worse := _why_worse(best, machine):
                side.bad, side.why = x, worse
            else:
                side.good, side.bad = x, x if side.bad is None else side.bad
    flats = []
    for place, axis in enumerate(free):
        low, high = sides[2 * place], sides[2 * place + 1]
        flats.append(Flat(
            free=axis, low=axis.value(low.good), high=axis.value(high.good), below=low.why or _BOUND,
            above=high.why or _BOUND,
        ))  # fmt: skip
    return flats


def _with(free: tuple[Axis, ...], values: Values, place: int, coordinate: float) -> Values:
    return (*values[:place], free[place].value(coordinate), *values[place + 1 :])


def _why_worse(best: Machine, other: Machine) -> str:
    """Fault of a machine beside the best; empty where it is as good but for a hundredth."""
    best_choice, now = best.choice(), other.choice()
    assert best_choice is not None
    if now is None:
        return other.why
    return "over 1 % worse" if now.goals[0] > best_choice.goals[0] + FLAT * abs(best_choice.goals[0]) else ""


# -- Round figures in that range.


def _rounded(of: Machines, best: Machine, flat: tuple[Flat, ...]) -> Machine | None:
    """The best machine with round figures that cost a hundredth at most, closer to the best ones if need be."""
    for share in (1.0, 0.5, 0.2, 0.05):
        values = tuple(_round_in(figure, value, share) for figure, value in zip(flat, best.values, strict=True))
        if values == best.values:
            return None
        (machine,) = of.at([values])
        if not _why_worse(best, machine):
            return machine
    return None


def _round_in(flat: Flat, value: Any, share: float) -> Any:
    """The roundest figure within a share of the way to the ends of a flat range."""
    if not flat.free.continuous:
        return value
    best, low, high = (flat.free.coordinate(figure) for figure in (value, flat.low, flat.high))
    return flat.free.value(roundest(best - share * (best - low), best + share * (high - best), best))


def roundest(low: float, high: float, near: float) -> float:
    """The roundest figure between two, near a third: a multiple of 5, 2 or 1 times the largest power of ten.

    >>> roundest(171.3, 188.9, 176.2), roundest(0.97, 1.08, 1.01), roundest(2.0, 2.0, 2.0)
    (180.0, 1.0, 2.0)
    """
    largest = max(abs(low), abs(high))
    if not low < high or isinf(largest):
        return near
    for power in range(floor(log10(largest)) + 1, floor(log10(high - low)) - 2, -1):
        for step in (5.0, 2.0, 1.0):
            unit = float(f"{step}e{power}")
            nearest = round(near / unit)
            for multiple in (nearest, nearest + 1, nearest - 1):
                if low <= multiple * unit <= high and multiple:
                    return float(f"{multiple * unit:.12g}")
    return near
