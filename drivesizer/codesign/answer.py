"""The best machine of a task, and what one wants to know of it: how flat the optimum is, what may be rounded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import floor, isinf, log10
from pathlib import Path
from typing import Any

from drivesizer.codesign.machines import Machine, Machines, Values, machines
from drivesizer.codesign.result import Answer, Flat
from drivesizer.codesign.search import best_of, every_machine, evolved, front_of, nearest_of
from drivesizer.codesign.task import Task, read_task
from drivesizer.files.yaml_source import source_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec
from drivesizer.study.plan import Axis
from drivesizer.study.rows import forget_files
from drivesizer.study.workers import Progress, cores, workers

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
    with workers(most, scheduler) as on, machines(task, on, folder, fresh=fresh) as of:
        (every_machine if whole else evolved)(of, advance)
        best = best_of(list(of.known.values()))
        flat, rounded = tuple[Flat, ...](), None
        if best is not None:
            flat = tuple(_flatness(of, best))
            better = best_of(list(of.known.values()))
            if better is not None and better is not best:  # that a neighbour is
                best, flat = better, tuple(_flatness(of, better))
            rounded = _rounded(of, best, flat)
        return Answer(
            task=task, best=best, choice=best.choice() if best else None,
            nearest=None if best else nearest_of(list(of.known.values())), front=tuple(front_of(of)), flat=flat,
            rounded=rounded, sized=of.sized, looked_at=len(of.known), whole=whole,
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
    coordinates = [one.coordinate(value) for one, value in zip(free, best.values, strict=True)]
    sides = [
        _Side(place, coordinates[place], None, end)
        for place, one in enumerate(free)
        for end in one.bounds
    ]  # fmt: skip
    most = of.task.evaluations // 4 // len(sides)  # of many figures each is looked at more coarsely
    for _ in range(min(max(most, 2), _HALVINGS)):
        tried = [(side, x) for side in sides if (x := side.next(free[side.place])) is not None]
        if not tried:
            break
        found = of.at([_with(free, best.values, side.place, x) for side, x in tried])
        for (side, x), machine in zip(tried, found, strict=True):
            if worse := _why_worse(best, machine):
                side.bad, side.why = x, worse
            else:
                side.good, side.bad = x, x if side.bad is None else side.bad
    flats = []
    for place, one in enumerate(free):
        low, high = sides[2 * place], sides[2 * place + 1]
        flats.append(Flat(
            free=one, low=one.value(low.good), high=one.value(high.good), below=low.why or _BOUND,
            above=high.why or _BOUND,
        ))  # fmt: skip
    return flats


def _with(free: tuple[Axis, ...], values: Values, place: int, coordinate: float) -> Values:
    return (*values[:place], free[place].value(coordinate), *values[place + 1 :])


def _why_worse(best: Machine, other: Machine) -> str:
    """Fault of a machine beside the best; empty where it is as good but for a hundredth."""
    one, now = best.choice(), other.choice()
    assert one is not None
    if now is None:
        return other.why
    return "over 1 % worse" if now.goals[0] > one.goals[0] + FLAT * abs(one.goals[0]) else ""


# -- Round figures in that range.


def _rounded(of: Machines, best: Machine, flat: tuple[Flat, ...]) -> Machine | None:
    """The best machine with round figures that cost a hundredth at most, closer to the best ones if need be."""
    for share in (1.0, 0.5, 0.2, 0.05):
        values = tuple(_round_in(one, value, share) for one, value in zip(flat, best.values, strict=True))
        if values == best.values:
            return None
        (found,) = of.at([values])
        if not _why_worse(best, found):
            return found
    return None


def _round_in(flat: Flat, value: Any, share: float) -> Any:
    """The roundest figure within a share of the way to the ends of a flat range."""
    if not flat.free.continuous:
        return value
    best, low, high = (flat.free.coordinate(one) for one in (value, flat.low, flat.high))
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
