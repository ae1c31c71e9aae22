"""Sizing: from a spec and catalogues to the result that everything else prints."""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan
from pathlib import Path

import numpy as np

from drivesizer.catalog import DIRECT, Catalog, load, one_of
from drivesizer.catalog.view.stepper_view import STEPPER, view_for
from drivesizer.errors import InputError, UnknownCatalogError, nearest, quoted
from drivesizer.load_cases.requirements import requirements
from drivesizer.load_cases.screw_requirements import screw_requirements
from drivesizer.load_cases.warnings import grip_warning, starts_farther_on
from drivesizer.machine import pulleys
from drivesizer.machine.budgets import check_battery, of_the_platform
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.figures_behind_checks import unknown_figures
from drivesizer.results.objectives import objective_figure
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import unstated_temperature
from drivesizer.results.reliability import Reliability
from drivesizer.results.requirement import Requirement
from drivesizer.results.sizing import Explanation, SizingResult, verdict
from drivesizer.search.both_methods import other_checks
from drivesizer.search.columns.candidates import Candidates, candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.found import Found
from drivesizer.search.machine_filter import best_in_machine, shortfall, weighing
from drivesizer.search.own_mass import problem_with_drive_mass
from drivesizer.search.paper.derivation import vehicle
from drivesizer.search.ranking import Ranking, title_of
from drivesizer.search.relaxations import changes_for, relaxations, tried
from drivesizer.search.set_record import drive_parts, drive_set
from drivesizer.search.shortlist import Shortlist, shortlist
from drivesizer.search.sifting import Progress
from drivesizer.search.stepper_figures import STEPPER_ASSUMPTIONS
from drivesizer.search.uncertainty.options import Sampling, sampling_of
from drivesizer.spec.altitude import altitude_words
from drivesizer.spec.mounting import mounting_words
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import Choice, ControllerChoice, EncoderChoice, MotorChoice
from drivesizer.units import show

__all__ = ["explain", "explained", "load_parts", "size"]

_MISSES = 3  # closest rejected, where a drive passes
_ALTERNATIVES = 3  # drives of other motor families beside the best
_FEW = 4  # missing figures at most that are worth a request to the maker


def load_parts(spec: RobotSpec, catalog: Catalog | None = None) -> Catalog:
    """The catalogues that a spec names, or one that was loaded, for the search.

    Parameters
    ----------
    spec
        Paths of catalogues count from its folder; it says whether figures are estimated.
    catalog
        In place of those that it names.

    Returns
    -------
    Catalog
        Actuators split, gearheads on every shaft, with estimates.
    """
    if catalog is None:
        try:
            catalog = load(spec.select.catalogs, beside=Path(spec.file).parent if spec.file else None)
        except UnknownCatalogError as error:
            raise InputError(f"{spec.where(('select', 'catalogs'))}: {error}") from None
    _offers_motors(spec, catalog)
    return view_for(catalog, spec.select.motor.kind, estimates=spec.select.estimates == "on")


def _offers_motors(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse catalogues without a motor of the kind that the spec selects: steppers, or anything else."""
    steppers = spec.select.motor.kind == STEPPER
    if steppers and not len(catalog.steppers):
        where = spec.where(("select", "catalogs"))
        named = ", ".join(spec.select.catalogs)
        raise InputError(f"{where}: {named} without steppers; expected e.g. stepperonline")
    if not steppers and len(catalog.steppers) and not len(catalog.motors) and not len(catalog.actuators):
        where = spec.where(("select", "catalogs"))
        raise InputError(f"{where}: only steppers are in them; expected select: {{motor: {{kind: {STEPPER}}}}}")


def size(
    spec: RobotSpec,
    *,
    catalog: Catalog | None = None,
    top: int = 5,
    objective: Ranking | None = None,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    sampling: Sampling | None = None,
    brief: bool = False,
    choices: int = 0,
) -> SizingResult:
    """Size a drive.

    Parameters
    ----------
    spec
        The machine.
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
    brief
        The drives alone: no alternatives, no checks by the other method, no changes that would let one pass.
    choices
        How many drives that pass to give as well, about, to choose from by weights of several objectives.

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
    catalog = load_parts(spec, catalog)
    objective = objective or spec.select.objective
    picked = shortlist(
        spec, catalog, objective, top, pareto=pareto, progress=progress, sampling=sampling, choices=choices,
        misses=0 if brief else _MISSES, others=0 if brief else _ALTERNATIVES, brief=brief,
    )  # fmt: skip
    problem, found, short = picked.problem, picked.found, picked.short

    def going_on() -> None:
        if progress:
            progress(found.counts.considered, found.counts.considered)

    def passing(rows: list[int], before: int = 0) -> tuple[DriveSet, ...]:
        return tuple(
            picked.record(
                row, rank,
                beside=() if brief else other_checks(problem, drive_parts(found.evaluation, row)),
                reliability=picked.reliability.get(row),
            )
            for rank, row in enumerate(rows, before + 1)
        )  # fmt: skip

    sets = passing(picked.best)
    unsure = passing(picked.unsure, len(sets))
    rejected = [*short, *picked.rejected][: None if sets else top]
    weighed = (picked.weigh(found.evaluation, row) for row in short)
    budgets = shortfall(weighed, found.better, any_passes=bool(found.passing))
    return SizingResult(
        problem=problem,
        method=spec.method,
        objective=title_of(objective),
        requirements=_requirements(found, next(iter((*picked.best, *picked.unsure, *short)), 0)),
        sets=sets,
        misses=tuple(picked.record(row, rank) for rank, row in enumerate(rejected, len(sets) + len(unsure) + 1)),
        relaxations=() if brief or found.passing else relaxations(problem, objective, going_on),
        tried=() if brief or found.passing else tried(problem),
        counts=found.counts,
        assumptions=(
            *_assumptions(problem.spec),
            *_waits(problem.machine),
            *altitude_words(problem.spec),
            *mounting_words(problem.spec),
            *_held(problem),
            *pulleys.assumptions(problem),
            *_of_data(spec, (*sets, *unsure)),
        ),
        warnings=(*picked.weighed, *_warnings(problem, sets), *_held_back(picked, sets), *budgets, *catalog.replaced),
        unrestricted=None if brief else _unrestricted(problem, objective),
        front=tuple(picked.record(row, rank) for rank, row in enumerate(found.front, 1)),
        pareto=pareto,
        unsure=unsure,
        uncertainty=picked.uncertainty,
        alternatives=tuple(picked.record(row, rank) for rank, row in enumerate(picked.others, 2)),
        choices=picked.choices,
    )


def _requirements(found: Found, row: int) -> tuple[Requirement, ...]:
    """The load's requirements: by physics figures of the load cycle, by the paper (1)-(16).

    The latter are with the rotor inertia of the candidate that is shown; without candidates, with none.
    """
    problem = found.evaluation.problem
    if problem.spec.method == "physics":
        of_screw = screw_requirements([case.spec for case in problem.cases])
        return (*requirements([case.cycle for case in problem.cases]), *of_screw)
    if len(found.evaluation.candidates.motor):
        return tuple(r.at(row) for r in found.evaluation.wheel.values())
    return tuple(vehicle(problem.spec, 0.0).steps.values())


def _of_data(spec: RobotSpec, sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Motors whose resistance is of a temperature that nobody states; the paper's method does not use it."""
    if spec.method != "physics":
        return ()
    return unstated_temperature(s.motor.part for s in sets if isnan(s.motor.data_temperature))


def _waits(spec: RobotSpec) -> tuple[str, ...]:
    """The rest at the end of the motion of an axis of a machine."""
    if spec.waits_until is None:
        return ()
    cycle = show(spec.waits_until, "s", "time")
    return (f"it is at rest after its motion until the machine's cycle of {cycle} is over",)


def _assumptions(spec: RobotSpec) -> tuple[str, ...]:
    """Assumptions of the method, as sentences."""
    if spec.steps:
        return STEPPER_ASSUMPTIONS
    if spec.method == "physics":
        sentences = [
            "gear and belt keep their catalogue efficiency, the maximum, at any torque, and driven backward as well; "
            "where a gearhead's no-load torque is printed, that is lost at any torque and the rest in proportion",
            "brushed motors lose k_t I_0 at any speed; of brushless ones the no-load loss rises with speed",
            "the winding's peak is that of the cycle in periodic steady state; friction and iron losses warm the "
            "housing, copper the winding; where time constants are unknown it is the mean",
            "voltage is with the winding at the ambient and at its mean temperature, the larger counts",
            "at rest the motor holds the full torque of the load, without help of friction",
            "an unknown inertia of the gearhead or friction of the motor is left out where it could only raise the "
            "demand: a check that fails without it fails, one that passes is unknown",
            "an encoder's unknown inertia is left out",
            "a gearhead's continuous input speed may be exceeded for 1 s uninterrupted and 10 % of the time, but not "
            "by the mean while running; Apex Dynamics, Harmonic Drive and Wittenstein limit that mean alone",
        ]
        if spec.paper_applies:
            sentences.append("the paper's factors enter neither requirements nor checks")
        return tuple(sentences)
    sentences = [
        "J_m of (10) is each candidate's own rotor inertia at the motor shaft, without K², as the paper has it",
        "the motor's speed is its no-load speed at nominal voltage, its maximum torque the stall torque",
        "a gearhead's efficiency is the catalogue's maximum, at rated torque",
        "motor current is torque / k_t plus the no-load current",
    ]
    factors = spec.paper_factors
    left = [name for name in type(factors).model_fields if getattr(factors, name) == 1.0]
    if left:
        sentences.append(f"paper factors at 1, no allowance: {', '.join(left)}")
    return tuple(sentences)


def _held(problem: Problem) -> tuple[str, ...]:
    """Assumption of a load case in which nothing moves, as a sentence."""
    if problem.spec.method != "physics" or all(case.at_belt.acts[SPEED] for case in problem.cases):
        return ()
    return (
        "a load that never moves is held on and on: the motor has its torque through the ideal ratio, though gear loss "
        "and friction may carry some, and the RMS torque at rest counts as the gearhead's continuous one",
    )


def _warnings(problem: Problem, sets: tuple[DriveSet, ...]) -> tuple[str, ...]:
    """Warnings: what the method leaves out, and what limits the best drive."""
    spec = problem.spec
    sentences = list(dict.fromkeys(line for case in problem.cases for line in grip_warning(case.spec)))
    if spec.method == "paper":
        sentences.append(
            "the paper's rule does not look at heat, permissible motor speed or supply sag; the physics beside it does"
        )
    sentences += _not_returning(problem)
    if not sets:
        return tuple(sentences)
    best = sets[0]
    sentences += [
        "at rest the hottest phase of the best drive's motor, at the rotor's worst angle, may reach "
        f"{show(check.demand, 'degC', 'temperature', 4)}: the winding's limit is "
        f"{show(check.limit, 'degC', 'temperature', 4)}"
        for check in best.own_checks
        if check.name == "hottest_phase" and check.status == "fail"
    ]
    figures = {figure.name: figure for figure in best.figures}
    if "current_limit" in figures and figures["current_limit"].value < figures["peak_current"].value:
        both = figures["current_limit"].text, figures["peak_current"].text
        sentences.append(
            f"the current limit that protects the gearhead at a jam is {both[0]}, the cycle takes {both[1]}"
        )
    if spec.method == "paper" and best.motor.nominal_voltage > spec.supply.highest:
        volts = [show(v, "V", "voltage") for v in (best.motor.nominal_voltage, spec.supply.highest)]
        sentences.append(f"the best drive's motor is wound for {volts[0]}, the supply gives {volts[1]} at most")
    return tuple(sentences)


def _held_back(picked: Shortlist, sets: tuple[DriveSet, ...]) -> list[str]:
    """Drives better than the best one but for a missing figure, and the figure that would decide it."""
    row = picked.found.held_back
    if row is None or not sets or not isinstance(picked.objective, str):
        return []
    better = picked.record(row)
    if better.status not in ("open", "unknown"):
        return []
    figures = [objective_figure(one, picked.objective) for one in (better, sets[0])]
    hanging = [f"{check.title} {check.note}" for check in better.deciding if check.status == "open"]
    lacking = dict.fromkeys(name for _, lacks in unknown_figures(better) for name in lacks.split(", "))
    if len(lacking) > _FEW:
        return []
    needed = [*hanging, *([f"no data sheet gives {', '.join(lacking)}"] if lacking else [])]
    return [
        f"{better.label}, {figures[0].text} against {figures[1].text}, would be the first were its figures known: "
        f"{'; '.join(needed)}"
    ]


def _not_returning(problem: Problem) -> list[str]:
    """Load cases that do not return to where they started."""
    return [line for case in problem.cases for line in starts_farther_on(case.name, case.spec)]


def _unrestricted(problem: Problem, objective: Ranking) -> DriveSet | None:
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
    return best_in_machine(problem.with_sections(select=select.model_copy(update=free)), objective)


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

    Parameters
    ----------
    spec
        The robot; its choice of motors and gearheads is left aside.
    motor, gearhead
        Part numbers; an actuator is named as the motor and brings its own gearhead. Any other motor may drive the load
        directly, whatever the spec's transmission says.
    catalog
        Parts to choose from; those that the spec names when not given.
    sampling
        How the combination is sampled for its tolerances; as the spec says when not given.

    Returns
    -------
    Explanation
        A drive for every belt ratio of the spec, whether it passes or not.

    Raises
    ------
    InputError
        When a part number is in no catalogue, the gearhead is missing or inside something else, or no pulleys fit.
    """
    catalog = load_parts(spec, catalog)
    check_battery(spec, catalog)
    objective = spec.select.objective
    problem, _ = problem_with_drive_mass(spec, catalog, objective)
    rows = _pair(catalog, motor, gearhead)
    family = str(catalog.gearheads["family"][rows[1]])
    select = spec.select.model_copy(update={"motor": MotorChoice(part=[motor]), "gearhead": Choice(family=[family])})
    narrowed = problem.with_sections(select=select, transmission=spec.behind(gearhead).transmission)
    combinations: Candidates = candidates(narrowed, also=rows)
    evaluation = evaluate(narrowed, combinations)
    found = np.flatnonzero((combinations.motor == rows[0]) & (combinations.gearhead == rows[1]))
    weigh = weighing(problem, of_the_platform(problem.machine))
    parts = {row: drive_parts(evaluation, row) for row in found.tolist()}
    beside = {row: other_checks(problem, one) for row, one in parts.items()}
    sampling = sampling or sampling_of(spec)
    reliability: dict[int, Reliability] = {}
    if sampling:
        from drivesizer.search.uncertainty.run import reliabilities, sample_drives, subject, uncertainty

        sampled = sample_drives(problem, {row: subject(evaluation, row, beside[row]) for row in parts}, sampling)
        passing = {
            row: one
            for row, one in parts.items()
            if not evaluation.failed[row] and verdict(weigh(evaluation, row).checks) != "fail"
        }
        reliability = reliabilities(sampled, parts, passing)
    sets = [
        drive_set(
            evaluation, row, rank, objective,
            budget=weigh(evaluation, row),
            beside=beside[row],
            reliability=reliability.get(row),
            changes=changes_for(problem, one) if evaluation.failed[row] else (),
        )
        for rank, (row, one) in enumerate(parts.items(), 1)
    ]  # fmt: skip
    return Explanation(sets, uncertainty(sampled) if sampling else None, tuple(_not_returning(problem)))


def _pair(catalog: Catalog, motor: str, gearhead: str) -> tuple[int, int]:
    """Rows of a motor and a gearhead."""
    row = _row(catalog, "motors", motor)
    box = str(catalog.motors["inside"][row])
    if box and gearhead in ("", box):
        return row, catalog.gearheads.rows[box]
    if not gearhead:
        raise InputError(f"--gearhead: motor {quoted(motor)} needs one; expected a part number, or {DIRECT} for none")
    other = _row(catalog, "gearheads", gearhead)
    whole = box or str(catalog.gearheads["inside"][other])
    if whole:
        raise InputError(f"--gearhead: {quoted(whole)} is an actuator, which has motor and gearhead inside")
    return row, other


def _row(catalog: Catalog, section: str, part: str) -> int:
    table = catalog.table(section)
    if part not in table.rows:
        raise InputError(f"{one_of(section)} {quoted(part)} is in no catalogue{nearest(part, table.rows)}")
    return table.rows[part]
