"""Sizing: from a spec and catalogues to the result that everything else prints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.prices import uncompared
from drivesizer.load_cases import requirements, screw_requirements
from drivesizer.loads.recorded import ComputedLoad
from drivesizer.machine.budgets import check_battery
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check import Reliability, verdict
from drivesizer.results.drive_set import Detail, DriveSet, Requirement
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Explanation, SizingResult
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.columns.paper import vehicle
from drivesizer.search.machine_filter import InMachine, best_in_machine
from drivesizer.search.passing import Progress
from drivesizer.search.ranking import title_of
from drivesizer.search.relaxations import changes_for, movable_names, relaxations
from drivesizer.search.remarks import assumptions, nearest_figures, not_returning, warnings
from drivesizer.search.search import SearchResult
from drivesizer.search.set_record import drive_parts, drive_set, other_checks
from drivesizer.search.shortlist import load_parts, pair_of, problem_with_drive_mass, shortlist
from drivesizer.search.uncertainty.options import Sampling, sampling_of
from drivesizer.spec.drive import Choice, ControllerChoice, EncoderChoice, MotorChoice, Ranking
from drivesizer.spec.robot import RobotSpec, load_spec

_MISSES = 3  # closest rejected, where a drive passes
_ALTERNATIVES = 3  # drives of other motor families beside the best


def size(
    spec: RobotSpec | str | Path | Mapping[str, Any],
    *,
    catalog: Catalog | None = None,
    top: int = 5,
    objective: Ranking | None = None,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    sampling: Sampling | None = None,
    detail: Detail = "full",
    choices: int = 0,
    load: LoadCycle | None = None,
) -> SizingResult:
    """Size a drive.

    Parameters
    ----------
    spec
        The machine, or what ``load_spec`` makes it of: a file, or the same fields as a dict.
    catalog
        Parts to choose from; those that the spec names when not given.
    top
        How many drives to give.
    objective
        In place of the spec's.
    pareto
        Objectives of which the front is wanted too: drives that no other beats in all of them.
    progress
        Called with the drives that are examined and all there are, a chunk at a time.
    sampling
        How drives are sampled for their tolerances; as the spec says when not given.
    detail
        ``"drives"``: these alone, without alternatives, checks by the other method and changes that would let one pass;
        ``"headline"``: of all but the first of these their sums and checks alone, and no warnings.
    choices
        How many drives that pass to give as well, about, to choose from by weights of several objectives.
    load
        Load cycle of the driven shaft of one drive in place of the spec's load and motion, such as
        ``LoadCycle.from_arrays(time, speed, torque)``.

    Returns
    -------
    SizingResult
        The best drives, or the closest rejected and the changes that would let one pass.

    Raises
    ------
    InputError
        When a family or part that the spec selects is in no catalogue, no pulleys fit, or the objective needs
        another method.
    """
    spec = spec if isinstance(spec, RobotSpec) else load_spec(spec)
    spec = spec if load is None else spec.alone(load=ComputedLoad.with_cycle(load, spec.load.motors), motion=None)
    in_full, catalog = detail == "full", load_parts(spec, catalog)
    spec = spec.with_select(spec.select.ranked_by(objective))
    picked = shortlist(
        spec, catalog, top, pareto=pareto, progress=progress, sampling=sampling, choices=choices,
        misses=_MISSES if in_full else 0, others=_ALTERNATIVES if in_full else 0, detail=detail,
    )  # fmt: skip
    problem, search, evaluation = picked.problem, picked.search, picked.search.evaluation

    def records(rows: Iterable[int], first: int) -> tuple[DriveSet, ...]:
        return tuple(picked.record(row, rank) for rank, row in enumerate(rows, first))

    def passing(rows: Iterable[int], first: int) -> tuple[DriveSet, ...]:
        return tuple(
            picked.record(
                row, rank,
                reliability=picked.reliability.get(row),
                **({"beside": other_checks(problem, drive_parts(evaluation, row))} if in_full else {}),
            )
            for rank, row in enumerate(rows, first)
        )  # fmt: skip

    sets = passing(picked.best, 1)
    unsure = passing(picked.unsure, len(sets) + 1)
    rejected, in_vain = [*picked.short, *picked.rejected][: None if sets else top], in_full and not search.passing
    row = next(iter((*picked.best, *picked.unsure, *picked.short)), 0)

    def going_on() -> None:
        if progress:
            progress(search.counts.considered, search.counts.considered)

    prices_left = [uncompared(problem.catalog)] if problem.machine.counts_price or "price" in pareto else []
    return SizingResult(
        problem=problem,
        method=spec.method,
        objective=title_of(spec.select.objective),
        requirements=_requirements(search, row),
        sets=sets,
        unsure=unsure,
        misses=records(rejected, len(sets) + len(unsure) + 1),
        front=records(search.front, 1),
        alternatives=records(picked.others, 2),
        relaxations=relaxations(problem, going_on) if in_vain else (),
        tried=movable_names(problem) if in_vain else (),
        unrestricted=_unrestricted(problem) if in_full else None,
        counts=search.counts,
        assumptions=assumptions(problem, spec, (*sets, *unsure)),
        warnings=()
        if detail == "headline"
        else (*warnings(picked, sets), *catalog.replaced, *filter(None, prices_left)),
        pareto=pareto,
        uncertainty=picked.uncertainty,
        choices=picked.choices,
    )


def _requirements(search: SearchResult, row: int) -> tuple[Requirement, ...]:
    """The load's requirements: by physics figures of the load cycle, by the paper (1)-(16).

    The latter are with the rotor inertia of the candidate that is shown; without candidates, with none.
    """
    problem = search.evaluation.problem
    if problem.spec.method == "physics":
        of_screw = screw_requirements([case.spec for case in problem.cases])
        return (*requirements([case.cycle for case in problem.cases]), *of_screw)
    if len(search.evaluation.candidates.motor):
        return tuple(search.evaluation.requirements(row)[0])
    return tuple(vehicle(problem.spec, 0.0).steps.values())


def _unrestricted(problem: Problem) -> DriveSet | None:
    """The best drive of the whole catalogue, where the spec names families or parts."""
    select = problem.spec.select
    if not select.is_restricted:
        return None
    free = {
        "motor": MotorChoice(kind=select.motor.kind),
        "gearhead": Choice(),
        "encoder": EncoderChoice(min_counts=select.encoder.min_counts),
        "controller": ControllerChoice(bus=select.controller.bus),
        "brake": Choice(),
    }
    return best_in_machine(problem.with_sections(select=select.model_copy(update=free)))


def explain(spec: RobotSpec, motor: str, gearhead: str = "", *, catalog: Catalog | None = None) -> list[DriveSet]:
    """One combination of motor and gearhead with every belt ratio of the spec: the drives of :func:`explained`.

    Parameters
    ----------
    spec
        The machine.
    motor, gearhead
        As for :func:`explained`.
    catalog
        Parts to choose from; those that the spec names when not given.

    Returns
    -------
    list[DriveSet]
        One for each belt ratio.
    """
    return explained(spec, motor, gearhead, catalog=catalog).sets


def explained(
    spec: RobotSpec,
    motor: str,
    gearhead: str = "",
    *,
    catalog: Catalog | None = None,
    sampling: Sampling | None = None,
) -> Explanation:
    """One combination of motor and gearhead, check by check, and its probability where the spec has tolerances.

    Where the drive's own mass counts the machine is as heavy as ``size`` makes it, for any combination.
    """
    catalog = load_parts(spec, catalog)
    check_battery(spec, catalog)
    problem, _ = problem_with_drive_mass(spec, catalog)
    rows = pair_of(catalog, motor, gearhead, spec)
    family, box = (str(problem.catalog.gearheads[name][rows[1]]) for name in ("family", "part"))
    behind = spec.behind(box)
    part = str(problem.catalog.motors["part"][rows[0]])
    narrowed = problem.with_sections(
        select=behind.select.pair_with(part, family), transmission=behind.transmission
    )  # the motor with all gearheads of the family, of which the one is examined
    combinations = candidates(narrowed, also=rows)
    pair_rows = np.flatnonzero((combinations.motor == rows[0]) & (combinations.gearhead == rows[1])).tolist()
    evaluation = evaluate(narrowed, combinations)
    machine = InMachine(problem)
    parts = {row: drive_parts(evaluation, row) for row in pair_rows}
    others = {row: other_checks(problem, drive) for row, drive in parts.items()}
    reliability, uncertain = dict[int, Reliability](), None
    if sampling or (sampling := sampling_of(spec)):
        from drivesizer.search.uncertainty.probabilities import reliabilities, sample_drives, subject, uncertainty

        sampled = sample_drives(problem, {row: subject(evaluation, row, others[row]) for row in pair_rows}, sampling)
        passing = {  # which alone go through the closed loop
            row: drive
            for row, drive in parts.items()
            if not evaluation.failed[row] and verdict(machine.budget(evaluation, row).checks) != "fail"
        }
        reliability, uncertain = reliabilities(sampled, pair_rows, passing), uncertainty(sampled)
    sets = [
        drive_set(
            evaluation, row, rank,
            budget=machine.budget(evaluation, row),
            beside=others[row],
            reliability=reliability.get(row),
            changes=changes_for(problem, drive) if evaluation.failed[row] else (),
        )
        for rank, (row, drive) in enumerate(parts.items(), 1)
    ]  # fmt: skip
    return Explanation(sets, uncertain, (*not_returning(problem), *nearest_figures(spec, sets)))
