"""A screw out of the catalogues: of each lead the smallest that holds, and of all leads that of the best drive.

The limits of a screw itself do not hang on what drives it. So each lead needs one screw only, and the search runs
once for each lead, as often as for as many belt ratios: another lead is another load cycle, with another inertia
and efficiency, not the same one scaled.
"""

from __future__ import annotations

import fnmatch
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import Screw as Part
from drivesizer.errors import InputError
from drivesizer.load_cases import located, profile_of, sprung
from drivesizer.loads.course import Course, course
from drivesizer.loads.screw import Screw, own_limits
from drivesizer.loads.stage_losses import force_along
from drivesizer.machine.problem import problem
from drivesizer.physics.figures import Whole
from drivesizer.physics.load_cycle import Ends
from drivesizer.results.check import GRAVEST
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem, TriedScrew, chosen_of, leaves_open, screw_figures, with_screw
from drivesizer.results.sizing import objective_figure
from drivesizer.search.columns.evaluation import smallest_margin
from drivesizer.search.columns.limits import own_limit
from drivesizer.search.machine_filter import best_in_machine
from drivesizer.search.search import search
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.robot import RobotSpec

_KINDS = {"ball_screw": ("ball",), "lead_screw": ("trapezoidal", "lead")}  # in the catalogues, by kind of load
_CERTAIN = GRAVEST[::-1]


class _Case(NamedTuple):
    """A load case of a screw, whatever its lead."""

    spec: RobotSpec
    course: Course
    force: Ends  # N, on the nut of one screw


class _Trial(NamedTuple):
    """A lead with its screw and the best drive for it."""

    problem: Problem
    best: DriveSet | None

    @property
    def row(self) -> TriedScrew:
        """The lead as it is listed; the mass is that of a screw of the machine's length."""
        assert self.problem.screw is not None
        ranked, part = self.problem.spec.select.objective, self.problem.screw.screw
        figure = objective_figure(self.best, ranked) if self.best and isinstance(ranked, str) else None
        drive, mass = self.best.label if self.best else "", self.problem.screw.least_mass
        return TriedScrew(part.lead, f"{part.manufacturer} {part.part}", mass, drive, figure)


def problem_with_screw(spec: RobotSpec, catalog: Catalog) -> tuple[Problem, tuple[str, ...]]:
    """The sizing problem of a machine with the screw out of the catalogues that suits its drive best."""
    screws, failed = _smallest_by_lead(spec, catalog)
    if not screws:
        leads: dict[str, list[str]] = {}
        for lead, reason in failed.items():
            leads.setdefault(reason, []).append(f"{lead * 1e3:.4g}")
        reasons = "; ".join(f"{', '.join(several)} mm ({reason})" for reason, several in leads.items())
        raise InputError(f"{spec.where(('load', 'screw'))}: no screw holds: the leads {reasons}")
    trials = []
    for screw in screws:
        variant = replace(problem(with_screw(spec, screw), catalog), screw=chosen_of(spec, screw))
        trials.append(_Trial(variant, best_in_machine(variant)))
    able = [trial for trial in trials if trial.best is not None]
    best = able[_best_of(able)].problem if able else max((trial.problem for trial in trials), key=_nearness)
    rows = [TriedScrew(lead=lead, failed=reason) for lead, reason in failed.items()] + [trial.row for trial in trials]
    rows.sort(key=lambda row: row.lead)
    assert best.screw is not None
    note = f"a screw of each of {len(rows)} leads was tried with its best drive; --checks and reports list them"
    return replace(best, screw=replace(best.screw, tried=tuple(rows))), (note,) * (len(rows) > 1)


def _smallest_by_lead(spec: RobotSpec, catalog: Catalog) -> tuple[list[Part], dict[float, str]]:
    """For each lead of the catalogues the smallest screw that holds in all load cases; known limits before unknown.

    And of leads without any the limit that most of their screws fail.
    """
    rows, table, cases = _allowed(spec, catalog), catalog.screws, list[_Case]()
    for case in (case for _, case in spec.load_cases if leaves_open(case)):
        load: Any = case.load
        motion = sprung(case, course(profile_of(case)))
        force = force_along(motion, load, case.environment.gravity, load.mass) / load.motors
        cases.append(_Case(case, motion, force))
    screws, failed = list[Part](), dict[float, str]()
    for lead in np.unique(table["lead"][rows]).tolist():
        same = rows[table["lead"][rows] == lead]
        smallest = np.lexsort((table["part"][same], table["dynamic_load"][same], table["diameter"][same]))
        unknown, failing = None, Counter[str]()
        for row in same[smallest].tolist():
            screw: Part = table.record(row)
            fails, lacks = _outcome(screw, cases)
            if fails:
                failing[fails] += 1
            elif not lacks:
                screws.append(screw)
                break
            elif unknown is None:
                unknown = screw
        else:
            if unknown is not None:
                screws.append(unknown)
            else:
                failed[lead] = failing.most_common(1)[0][0]
    return screws, failed


def _outcome(screw: Part, cases: Sequence[_Case]) -> tuple[str, bool]:
    """The first limit that a screw fails, and whether one is unknown."""
    lacks = False
    for spec, motion, force in cases:
        load: Any = spec.load
        load = load.model_copy(update=screw_figures(load, screw))
        if load.efficiency is None and load.thread_friction is None:
            return "efficiency unknown", False
        with located(spec):
            limits = own_limits(load, motion, force)
        for own in limits:
            check = own_limit(spec, own)
            if check is not None and check.failed.any():
                return CHECKS["physics"][own.name].title.removeprefix("Screw ").partition(",")[0], False
            lacks |= check is not None and not check.passed.all()
    return "", lacks


def _allowed(spec: RobotSpec, catalog: Catalog) -> Whole:
    """Rows of the screws of the required kind, maker and size."""
    load, table = spec.load, catalog.screws
    assert isinstance(load, Screw) and load.screw is not None
    choice = load.screw
    of_kind = np.isin(table["kind"], _KINDS[load.kind]) & ~table.excluded
    good = of_kind & (table["lead"] > 0.0)
    for name, column in (("maker", "manufacturer"), ("family", "family"), ("part", "part")):
        patterns = getattr(choice, name)
        if patterns is not None:
            texts = np.char.lower(table[column])
            good &= np.array([any(fnmatch.fnmatchcase(str(t), w.lower()) for w in patterns) for t in texts], bool)
    for name in ("diameter", "lead"):
        most = getattr(choice, f"{name}_max")
        good &= table[name] >= (getattr(choice, f"{name}_min") or 0.0) * (1.0 - 1e-9)
        good &= table[name] <= (inf if most is None else most) * (1.0 + 1e-9)
    if choice.play_max is not None:
        good &= table["axial_play"] <= choice.play_max
    if not good.any():
        listed = np.count_nonzero(of_kind)
        there = f"{listed} of that kind" if listed else "none: select.catalogs needs some that do, e.g. thk, or all"
        raise InputError(
            f"{spec.where(('load', 'screw'))}: no such screw in the catalogues that the spec names; they list {there}"
        )
    return np.flatnonzero(good)


def _best_of(able: Sequence[_Trial]) -> int:
    """The best lead: by the status of its drive, objectives of which the screw's share is unknown, the objective, size.

    Mass and price count with the screw's as far as that is known, as shares of the least.
    """
    best: list[Any] = [trial.best for trial in able]
    screws: list[Any] = [trial.problem.screw for trial in able]
    value, unknown = np.zeros(len(able)), np.zeros(len(able))
    for name, weight in able[0].problem.spec.select.weights.items():
        own = np.array([{"mass": s.least_mass, "price": s.screw.price}.get(name, 0.0) for s in screws])
        figures = np.array([objective_figure(drive, name).value for drive in best]) + np.nan_to_num(own)
        if OBJECTIVES[name].more_is_better:
            figures = 1.0 / np.maximum(1.0 + figures, 1e-9)
        least = np.nanmin(figures, initial=inf)
        value += weight * np.nan_to_num(figures / least if 0.0 < least < inf else figures, nan=1e9)
        unknown += np.isnan(own)
    certain, size = [_CERTAIN.index(drive.status) for drive in best], np.array([screw.least_mass for screw in screws])
    return int(np.lexsort(np.array([size, value, unknown, certain]))[0])


def _nearness(variant: Problem) -> float:
    """The smallest margin of the closest rejected drive."""
    evaluation = search(variant, top=1, misses=1).evaluation
    return float(smallest_margin(evaluation.checks)[0]) if len(evaluation.candidates.motor) else -inf
