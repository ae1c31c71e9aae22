"""A screw out of the catalogues: of each lead the smallest that holds, and of all leads that of the best drive.

The limits of a screw itself do not hang on what drives it. So each lead needs one screw only, and the search runs once
for each lead, as often as for as many belt ratios: another lead is another load cycle, with another inertia and
efficiency, not the same one scaled.
"""

from __future__ import annotations

import fnmatch
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.catalog.more_parts import Screw as Part
from drivesizer.errors import InputError
from drivesizer.load_cases.profile import located, profile_of
from drivesizer.loads.course import Course, course
from drivesizer.loads.screw import Screw, ScrewChoice
from drivesizer.loads.screw_limits import own_limits
from drivesizer.loads.stage_losses import force_along
from drivesizer.machine.problem import problem
from drivesizer.physics.load_cycle import Ends
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.objectives import objective_figure
from drivesizer.results.problem import Problem
from drivesizer.results.screws import ChosenScrew, chosen_of, leaves_open, screw_figures, with_screw
from drivesizer.search.columns.evaluation import smallest_margin
from drivesizer.search.columns.limits import own_limit
from drivesizer.search.machine_filter import best_in_machine
from drivesizer.search.order.ranking import Ranking, names_of, title_of
from drivesizer.search.search import search
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import OBJECTIVES
from drivesizer.units import show

__all__ = ["problem_with_screw"]

_KINDS = {"ball_screw": ("ball",), "lead_screw": ("trapezoidal", "lead")}  # in the catalogues, by kind of load
_SURE = ("pass", "open", "unknown", "fail")
_NO_EFFICIENCY = "efficiency unknown"


class _Case(NamedTuple):
    """A load case of a screw, whatever its lead."""

    spec: RobotSpec
    course: Course
    force: Ends  # N, on the nut of one screw


class _ScrewOfLead(NamedTuple):
    """The screw of a lead, or why there is none."""

    lead: float  # m
    screw: Part | None
    failed: str  # the limit that most of its screws fail


@dataclass(frozen=True, slots=True, kw_only=True)
class _Tried:
    """A lead with its screw and the best drive for it."""

    problem: Problem
    best: DriveSet | None

    @property
    def chosen(self) -> ChosenScrew:
        """Of the machine's length."""
        assert self.problem.screw is not None
        return self.problem.screw


def problem_with_screw(spec: RobotSpec, catalog: Catalog, objective: Ranking) -> tuple[Problem, tuple[str, ...]]:
    """The sizing problem of a machine with the screw out of the catalogues that suits its drive best."""
    held = _smallest_by_lead(spec, catalog)
    screws = [one.screw for one in held if one.screw is not None]
    if not screws:
        raise InputError(f"{spec.where(('load', 'screw'))}: no screw holds: the leads {_reasons(held)}")
    problems = [_with_screw(spec, catalog, screw) for screw in screws]
    tried = [_Tried(problem=one, best=best_in_machine(one, objective)) for one in problems]
    able = [one for one in tried if one.best is not None]
    if able:
        chosen = able[int(np.lexsort(_order(able, objective)[::-1])[0])].problem
    else:
        chosen = max(problems, key=lambda one: _nearness(one, objective))
    return chosen, (_words(held, tried, objective),)


def _with_screw(spec: RobotSpec, catalog: Catalog, screw: Part) -> Problem:
    """The problem with one screw."""
    return replace(problem(with_screw(spec, screw), catalog), screw=chosen_of(spec, screw))


# --- the screw of each lead -------------------------------------------------------------------------------------------


def _smallest_by_lead(spec: RobotSpec, catalog: Catalog) -> list[_ScrewOfLead]:
    """For each lead of the catalogues the smallest screw that holds in all load cases; known limits before unknown."""
    rows, table = _screw_rows(spec, catalog), catalog.screws
    cases = [_case(one) for _, one in spec.load_cases if leaves_open(one)]
    found = []
    for lead in np.unique(table["lead"][rows]).tolist():
        same = rows[table["lead"][rows] == lead]
        order = np.lexsort((table["part"][same], table["dynamic_load"][same], table["diameter"][same]))
        found.append(_smallest(lead, (table.record(int(row)) for row in same[order]), cases))
    return found


def _smallest(lead: float, screws: Iterator[Part], cases: Sequence[_Case]) -> _ScrewOfLead:
    unsure, failed = None, Counter[str]()
    for screw in screws:
        fails, lacks = _screw_verdict(screw, cases)
        if fails:
            failed[fails] += 1
        elif not lacks:
            return _ScrewOfLead(lead, screw, "")
        elif unsure is None:
            unsure = screw
    return _ScrewOfLead(lead, unsure, failed.most_common(1)[0][0] if failed and unsure is None else "")


def _screw_verdict(screw: Part, cases: Sequence[_Case]) -> tuple[str, bool]:
    """The first limit that a screw fails, and whether one is unknown."""
    lacks = False
    for case in cases:
        load: Any = case.spec.load
        load = load.model_copy(update=screw_figures(load, screw))
        if load.efficiency is None and load.thread_friction is None:
            return _NO_EFFICIENCY, False
        with located(case.spec):
            limits = own_limits(load, case.course, case.force)
        for own in limits:
            check = own_limit(case.spec, own)
            if check is not None and check.failed.any():
                return CHECKS["physics"][own.name].title.removeprefix("Screw ").partition(",")[0], False
            lacks |= check is not None and not check.passed.all()
    return "", lacks


def _case(spec: RobotSpec) -> _Case:
    load: Any = spec.load
    moved = course(profile_of(spec))
    return _Case(spec, moved, force_along(moved, load, spec.environment.gravity, load.mass) / load.motors)


def _screw_rows(spec: RobotSpec, catalog: Catalog) -> NDArray[np.int64]:
    """Rows of the screws of the required kind, maker and size."""
    load, table = spec.load, catalog.screws
    assert isinstance(load, Screw)
    assert load.screw is not None
    good = np.isin(table["kind"], _KINDS[load.kind]) & ~table.excluded & (table["lead"] > 0.0)
    for rows in _conditions(load.screw, table):
        good &= rows
    found = np.flatnonzero(good)
    if not len(found):
        listed = len(np.flatnonzero(np.isin(table["kind"], _KINDS[load.kind]) & ~table.excluded))
        there = f"{listed} of that kind" if listed else "none: select.catalogs needs some that do, e.g. thk, or all"
        raise InputError(
            f"{spec.where(('load', 'screw'))}: no such screw in the catalogues that the spec names; they list {there}"
        )
    return found


def _conditions(choice: ScrewChoice, table: Table[Any]) -> Iterator[NDArray[np.bool_]]:
    """Masks of the screws that meet each part of a choice."""
    for name, column in (("maker", "manufacturer"), ("family", "family"), ("part", "part")):
        wanted = getattr(choice, name)
        if wanted is not None:
            texts = np.char.lower(table[column])
            yield np.array([any(fnmatch.fnmatchcase(str(t), w.lower()) for w in wanted) for t in texts], bool)
    for name in ("diameter", "lead"):
        yield table[name] >= (getattr(choice, f"{name}_min") or 0.0) * (1.0 - 1e-9)
        most = getattr(choice, f"{name}_max")
        yield table[name] <= (inf if most is None else most) * (1.0 + 1e-9)
    if choice.play_max is not None:
        yield table["axial_play"] <= choice.play_max


# --- the best of them -------------------------------------------------------------------------------------------------


def _order(able: Sequence[_Tried], objective: Ranking) -> tuple[NDArray[np.float64], ...]:
    """Columns that order leads, the first one first.

    Status of their best drives, objectives of which the screw's share is unknown, the objective, the screw's size.
    """
    best: list[Any] = [one.best for one in able]
    sure = np.array([float(_SURE.index(one.status)) for one in best])
    value = np.zeros(len(able))
    weights = (
        {part.objective: part.weight for part in objective} if not isinstance(objective, str) else {objective: 1.0}
    )
    for name in names_of(objective):
        value += weights[name] * _shares(np.array([_figure(one, name) for one in able]), name)
    size = np.array([one.chosen.least_mass for one in able])
    unknown = np.array([float(sum(isnan(_screw_share(one, name)) for name in weights)) for one in able])
    return sure, unknown, value, size


def _figure(one: _Tried, name: str) -> float:
    """An objective of the best drive, of mass and price with the screw's as far as that is known."""
    assert one.best is not None
    own = _screw_share(one, name)
    return objective_figure(one.best, name).value + (0.0 if isnan(own) else own)


def _screw_share(one: _Tried, name: str) -> float:
    """Share of the screw in an objective; NaN unknown."""
    return {"mass": one.chosen.least_mass, "price": one.chosen.screw.price}.get(name, 0.0)


def _shares(values: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Figures as shares of the best of them, less is better; unknown ones behind all others."""
    if OBJECTIVES[name].more_is_better:
        values = 1.0 / np.maximum(1.0 + values, 1e-9)
    least = np.nanmin(values, initial=inf)
    return np.nan_to_num(values / least if 0.0 < least < inf else values, nan=1e9)


def _nearness(one: Problem, objective: Ranking) -> float:
    """The smallest margin of the closest rejected drive."""
    found = search(one, top=1, objective=objective, misses=1)
    return float(smallest_margin(found.evaluation.checks)[0]) if len(found.evaluation.candidates.motor) else -inf


# --- words ------------------------------------------------------------------------------------------------------------


def _words(held: Sequence[_ScrewOfLead], tried: Sequence[_Tried], objective: Ranking) -> str:
    """The leads and the best drive of each, in a sentence."""
    drives = "; ".join(_drive_of(one, objective) for one in tried)
    left = _reasons(held)
    without = f"; no screw holds of {left}" if left else ""
    return f"the best drive for the smallest screw of each lead, by {title_of(objective)}: {drives}{without}"


def _drive_of(one: _Tried, objective: Ranking) -> str:
    part = one.chosen.screw
    screw = f"{show(part.lead, 'mm', 'length')} {part.manufacturer} {part.part}"
    if one.best is None:
        return f"{screw}: none"
    figure = objective_figure(one.best, objective).text if isinstance(objective, str) else ""
    beside = f" and a screw of {show(one.chosen.least_mass, 'g', 'mass', 3)}" if objective == "mass" else ""
    return f"{screw}: {one.best.motor_name} {figure}{beside}".rstrip()


def _reasons(held: Sequence[_ScrewOfLead]) -> str:
    """Leads without a screw that holds, by the limit that most of its screws fail."""
    leads: dict[str, list[str]] = {}
    for one in held:
        if one.screw is None:
            leads.setdefault(one.failed, []).append(f"{one.lead * 1e3:.4g}")
    return "; ".join(f"{', '.join(several)} mm ({reason})" for reason, several in leads.items())
