"""Changes of one figure of a spec at which a drive passes: which figures may move, and how far."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from math import atan, tan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.machine.problem import changed
from drivesizer.results.check import Status
from drivesizer.results.drive_set import DriveParts, Relaxation
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates, candidates
from drivesizer.search.columns.evaluation import Evaluation, evaluate
from drivesizer.search.machine_filter import any_in_machine, best_in_machine, passes_budgets
from drivesizer.search.set_record import TABLES, drive_parts
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show, to_si


class MovableFigure(NamedTuple):
    """A figure of a spec that may move alone so that a drive passes."""

    path: tuple[str, ...]
    direction: int  # +1 when more helps
    linear: tuple[str, ...]  # kind and unit
    rotary: tuple[str, ...]  # the same where the load turns


HOLDING = ("needs", "holding_factor")
FIGURES = tuple(
    MovableFigure((*path.split("."),), 1 if way == "more" else -1, (kind, unit), (*turning,) or (kind, unit))
    for path, way, kind, unit, *turning in (cells for head, cells in TABLES if head == "movable")
)


def movable(problem: Problem) -> Iterator[tuple[MovableFigure, float]]:
    """The figures of a spec that may move, each with what it is now [SI]: in the first load case that has it.

    A friction coefficient of a vehicle is its grip, of which less does not help; a force that helps stays as it is.
    """
    spec = problem.spec
    for figure in FIGURES:
        now = next(
            filter(None, (_positive_figure(case, figure) for case in (spec, *(case.spec for case in problem.cases)))),
            None,
        )
        if now is None or (figure.path == HOLDING and not (spec.needs.hold_unpowered and now > 1.0)):
            continue  # it must hold without power, and with a factor of 1 at least
        if figure.path == ("load", "friction_coefficient") and spec.load.kind == "wheeled_vehicle":
            continue
        yield figure, now


def _positive_figure(spec: RobotSpec, figure: MovableFigure) -> float | None:
    """The figure where a spec has it, and of the sense that its direction means."""
    value: Any = spec
    for name in figure.path:
        value = getattr(value, name, None)
    return value if isinstance(value, float) and value > 0.0 else None


# -- Changes of one figure of a spec at which a drive passes: found by search, to one per cent.
#
# For a drive that fails, and for a search in which nothing passes. Each figure moves alone, in all load cases alike.
# With estimated figures at the middle of their bands: near their favourable end a change would help hardly any drive.


_STEPS = (1.1, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0)  # times
_NEAR_ENOUGH = 1.01
_STEP, _ROUNDINGS = 2e-3, 8  # of a factor, until what is printed of a figure is on the side that passes
_ROOM, _ICE = 298.15, 273.15  # K: 25 degC, the ambient of data sheets, and 0 degC


class _Passing(NamedTuple):
    """Drives that meet all limits of a problem."""

    any: Callable[[Problem], bool]  # whether one does, or fails no check
    best: Callable[[Problem], tuple[str, Status] | None]  # label of the best one, and its status; None: it lacks more


_AMBIENT = ("environment", "ambient")
_COILS = ("supply", "brakes")


def relaxations(problem: Problem, going_on: Callable[[], None] = lambda: None) -> tuple[Relaxation, ...]:
    """The changes that would let some drive pass where none does."""
    battery, reject = problem.spec.battery, problem.spec.select.unknown == "reject"
    if reject and battery and battery.part is None and None in (battery.continuous_current, battery.peak_current):
        return ()  # each drive is unknown by its battery, whatever else changes
    if not len(candidates(problem).motor):
        return ()

    def best(variant: Problem) -> tuple[str, Status] | None:
        drive = best_in_machine(variant)
        if drive is None:
            raise AssertionError("a drive that passes ranks nowhere")
        if drive.status == "unknown":
            only = _only(problem, drive)
            if _undecided(evaluate(variant, only)) - _undecided(evaluate(problem, only), or_failed=True):
                return None
        return drive.label, drive.status

    middle = replace(problem.catalog, ends=())

    def passes(variant: Problem) -> bool:
        going_on()
        return any_in_machine(replace(variant, catalog=middle))

    return tuple(_helping_changes(problem, _Passing(passes, best)))


def changes_for(problem: Problem, drive: DriveParts) -> tuple[Relaxation, ...]:
    """The changes that would let a drive pass that fails, the least first."""
    only = _only(problem, drive)
    now, middle = _undecided(evaluate(problem, only), or_failed=True), replace(problem.catalog, ends=())

    def passes(variant: Problem) -> bool:
        evaluation = evaluate(replace(variant, catalog=middle), only)
        return (
            not evaluation.failed[0]
            and _undecided(evaluation) <= now
            and passes_budgets(variant, drive_parts(evaluation, 0))
        )

    def own(variant: Problem) -> tuple[str, Status]:
        return drive.label, evaluate(variant, only).status(0)

    if problem.spec.method == "paper":  # its rule looks at the other reductions of the family: those come along
        return tuple(_other_reductions(problem, drive))
    return (*_other_reductions(problem, drive), *_helping_changes(problem, _Passing(passes, own)))


def _only(problem: Problem, drive: DriveParts) -> Candidates:
    """One motor with its gearhead and belt."""
    motors, gearheads = problem.catalog.motors.rows, problem.catalog.gearheads.rows
    rows = np.array([motors[drive.motor.part]]), np.array([gearheads[drive.gearhead.part]])
    return Candidates(*rows, np.array([drive.belt_ratio]), np.array([True]))


def _undecided(evaluation: Evaluation, *, or_failed: bool = False) -> set[str]:
    """Checks of one drive that figures leave unknown: no change may add to them, as a voltage beyond its parts does."""
    checks = [check for check in evaluation.checks if not check.advice and not check.passed[0]]
    checks = [check for check in checks if not np.any(check.opened)]
    return {check.name for check in checks if or_failed or not check.failed[0]}


def movable_names(problem: Problem) -> tuple[str, ...]:
    """Names of the figures of a spec that are moved, each alone, to look for a drive that passes."""
    ambient = [".".join(_AMBIENT)] if problem.spec.environment.ambient > _ROOM else []
    coils = [".".join(_COILS)] if problem.spec.supply.brakes is not None else []
    return (*(".".join(figure.path) for figure, _ in movable(problem)), *ambient, *coils)


def _other_reductions(problem: Problem, drive: DriveParts) -> Iterator[Relaxation]:
    """The nearest reduction of the same family that passes with the same motor and belt; not of an actuator."""
    if drive.actuator:
        return
    select, catalog = problem.spec.select.pair_with(drive.motor.part, drive.gearhead.family), problem.catalog
    narrowed = problem.with_sections(select=select)
    sets = candidates(narrowed)
    if not len(sets.motor):
        return
    evaluation = evaluate(narrowed, sets)
    failed = evaluation.failed
    ratio = catalog.gearheads["ratio"][sets.gearhead]
    rows = np.flatnonzero(~failed & (sets.belt == drive.belt_ratio))
    if len(rows):
        row = rows[np.abs(np.log(ratio[rows] / drive.gearhead.ratio)).argmin()]
        other = catalog.gearheads.record(int(sets.gearhead[row]))
        label = drive.label.replace(
            f"{drive.gearhead.reduction} {drive.gearhead.part}", f"{other.reduction} {other.part}"
        )
        share = abs(other.ratio / drive.gearhead.ratio - 1.0)
        yield Relaxation(
            field="gearhead",
            now=drive.gearhead.reduction,
            needed=f"{other.reduction} {other.part}".strip(),
            set_label=label,
            share=share,
            kind="dimensionless",
            unit="1",
            before=drive.gearhead.ratio,
            after=other.ratio,
            status=evaluation.status(int(row)),
        )


def _helping_changes(problem: Problem, passing: _Passing) -> list[Relaxation]:
    """Each figure that helps when it moves alone."""
    changes = [*_scaled(problem, passing), *_cooler(problem, passing), *_for_coils(problem, passing)]
    return sorted(changes, key=lambda r: (r.share, r.field))


def _scaled(problem: Problem, passing: _Passing) -> Iterator[Relaxation]:
    turns = problem.spec.load.axis == "rotary"
    for figure, now in movable(problem):
        passes = partial(_passes_at, problem, passing, figure.path, now)
        factor = _least_change(passes, figure.direction)
        if factor is not None:
            kind, unit = figure.rotary if turns else figure.linear
            unit = problem.catalog.currency if kind == "price" else unit
            grade = kind == "angle" and _entered(problem.spec, figure.path).endswith("%")
            steps = (factor * (1.0 + _STEP * figure.direction * n) for n in range(_ROUNDINGS))
            printed = (_printed(now * step, unit, kind, 3, grade) for step in steps)
            needed = next(
                (text for text in printed if passes(_read(text, kind, grade) / now)),
                _printed(now * factor, unit, kind, 9, grade),
            )
            after = _read(needed, kind, grade)
            if not (best := _best(passing, _changed(problem, figure.path, after / now))):
                continue
            yield Relaxation(
                field=".".join(figure.path), now=_printed(now, unit, kind, 4, grade),
                needed=needed + _together(problem, figure.path), share=abs(after / now - 1.0),
                kind=kind, unit=unit, before=now, after=after, **best,
            )  # fmt: skip


def _entered(spec: RobotSpec, path: tuple[str, ...]) -> str:
    """A field as the user wrote it, in the spec or in its first load case that has it; empty where it is no text."""
    for value in (spec.entered, *(spec.entered.get("cases") or ())):
        for name in path:
            value = value.get(name) if isinstance(value, dict) else None
        if isinstance(value, str):
            return value.strip()
    return ""


def _printed(value: float, unit: str, kind: str, digits: int, grade: bool) -> str:
    """A figure as text; a slope that was entered as a grade as one."""
    return show(tan(value), "%", "dimensionless", digits) if grade else show(value, unit, kind, digits)


def _read(text: str, kind: str, grade: bool) -> float:
    return atan(to_si(text, "dimensionless")) if grade else to_si(text, kind)


def _best(passing: _Passing, variant: Problem) -> dict[str, Any]:
    """The best drive of a changed problem, as fields of a change; a status that is no pass stands behind its name."""
    if (best := passing.best(variant)) is None:
        return {}
    label, status = best
    return {"set_label": label if status == "pass" else f"{label}, {status}", "status": status}


def _together(problem: Problem, path: tuple[str, ...]) -> str:
    """Words on the limits of a supply's voltage that move with it, where they are given."""
    supply = problem.spec.supply
    limits = [name for name in ("min", "max") if path == ("supply", "nominal") and getattr(supply, name) is not None]
    return f" ({' and '.join(limits)} in proportion)" if limits else ""


def _passes_at(problem: Problem, passing: _Passing, path: tuple[str, ...], now: float, factor: float) -> bool:
    """Whether a drive passes with one figure times a factor; a safety factor stays at least 1."""
    return not (path == HOLDING and now * factor < 1.0) and passing.any(_changed(problem, path, factor))


def _cooler(problem: Problem, passing: _Passing) -> Iterator[Relaxation]:
    """The ambient, which moves by kelvins; below that of a room it is no remedy."""
    now = problem.spec.environment.ambient

    def cooled(fall: float) -> Problem:
        return _changed(problem, _AMBIENT, 1.0 - fall / now)

    low, high = 0.0, now - _ROOM
    if high <= 0.0 or not passing.any(cooled(high)):
        return
    while high - low > 1.0:
        middle = (low + high) / 2
        if passing.any(cooled(middle)):
            high = middle
        else:
            low = middle
    needed = show(np.floor(10.0 * (now - high - _ICE)) / 10.0 + _ICE, "degC", "temperature", 4)
    after = to_si(needed, "temperature")
    if passing.any(cooled(now - after)) and (best := _best(passing, cooled(now - after))):
        yield Relaxation(
            field=".".join(_AMBIENT), now=show(now, "degC", "temperature"), needed=needed,
            share=1.0 - after / now, kind="temperature", unit="degC", before=now, after=after, **best,
        )  # fmt: skip


def _for_coils(problem: Problem, passing: _Passing) -> Iterator[Relaxation]:
    """The voltage that feeds the brakes as that of a coil that there is, the nearest with which a drive passes."""
    now, coils = problem.spec.supply.brakes, np.unique(problem.catalog.brakes["supply"])
    if now is None:
        return
    for coil in sorted(coils[coils > 0.0].tolist(), key=lambda volts: max(volts / now, now / volts)):
        variant = _changed(problem, _COILS, coil / now)
        if passing.any(variant) and (best := _best(passing, variant)):
            yield Relaxation(
                field=".".join(_COILS), now=show(now, "V", "voltage"), needed=show(coil, "V", "voltage"),
                share=abs(coil / now - 1.0), kind="voltage", unit="V", before=now, after=coil, **best,
            )  # fmt: skip
            return


def _changed(problem: Problem, path: tuple[str, ...], factor: float) -> Problem:
    """The problem with one figure times a factor in every load case; of the supply all voltages move together."""
    names = ("nominal", "min", "max") if path == ("supply", "nominal") else path[1:]

    def scaled(spec: RobotSpec) -> RobotSpec:
        section = getattr(spec, path[0])
        if section is None:  # as the motion of a wheel on a trajectory
            return spec.model_copy()
        update = {name: getattr(section, name) * factor for name in names if getattr(section, name, None) is not None}
        return spec.model_copy(update={path[0]: section.model_copy(update=update)})

    return changed(problem, scaled)


def _least_change(passes: Callable[[float], bool], direction: int) -> float | None:
    """The factor nearest to 1 at which something passes, between 1 and 1/20 or 20; None where nothing does.

    Looked for in steps first: more is not always better, as when a voltage outgrows the controllers.
    """
    near = 1.0
    for step in _STEPS:
        far = step**direction
        if passes(far):
            break
        near = far
    else:
        return None
    while max(far / near, near / far) > _NEAR_ENOUGH:
        middle = float(np.sqrt(near * far))
        if passes(middle):
            far = middle
        else:
            near = middle
    return far
