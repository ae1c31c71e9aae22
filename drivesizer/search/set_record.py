"""One candidate as a record: parts, sums, checks, figures; beside them the checks by the other method."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from drivesizer.catalog import DIRECT, Table
from drivesizer.catalog.parts import one_row
from drivesizer.files.text import listed
from drivesizer.kernel.warming import State, overload_time
from drivesizer.machine.budgets import MachineBudget, drive_rows, on_its_supply
from drivesizer.machine.part_curves import curves_of, torque_of_drive
from drivesizer.machine.problem import quickest_winding
from drivesizer.machine.set_cycle import motor_pieces, set_cycle, torque_above, turned, warm_up
from drivesizer.physics.braking import Stop
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.physics.figures import Alike, on
from drivesizer.physics.stepper import natural_frequency, start_speed_with
from drivesizer.physics.thermal import two_bodies
from drivesizer.results.check import Check, Figure, Reliability, figures_of, gravest, verdict
from drivesizer.results.check_kinds import with_origins
from drivesizer.results.drive_set import Comparison, DriveParts, DriveSet, MotorPiece, Relaxation
from drivesizer.results.problem import Problem
from drivesizer.search import ranking
from drivesizer.search.columns.brakes import stops
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.controllers import none_suits
from drivesizer.search.columns.evaluation import Evaluation, evaluate, smallest_margin
from drivesizer.search.columns.shaft_limits import life_of_gearheads, shaft_loads
from drivesizer.search.open_checks import estimated, resolved_checks
from drivesizer.search.ranking import CONTROLLING, bought, part_rows
from drivesizer.spec.drive import OBJECTIVES

TABLES = (*listed("drivesizer.search", "tables.txt"),)
_NO_BUDGET = MachineBudget()
_CASES = 4  # whose pieces are listed


def drive_parts(evaluation: Evaluation, index: int) -> DriveParts:
    """The parts of one row of an evaluation."""
    problem, catalog, candidates = evaluation.problem, evaluation.catalog, evaluation.candidates
    motor = catalog.motors.record(int(candidates.motor[index]))
    gearhead = catalog.gearheads.record(int(candidates.gearhead[index]))
    encoder, controller = int(evaluation.encoder[index]), int(evaluation.controller[index])
    brake = int(evaluation.brake[index])
    return DriveParts(
        motor=motor,
        gearhead=gearhead,
        encoder=catalog.encoders.record(encoder) if encoder >= 0 else None,
        controller=catalog.controllers.record(controller) if controller >= 0 else None,
        brake=catalog.brakes.record(brake) if brake >= 0 else None,
        belt_ratio=float(candidates.belt[index]),
        belt_efficiency=evaluation.spec.belt_efficiency,
        belt_drive=problem.belt_drive(float(candidates.belt[index])),
        chosen_screw=problem.screw,
        total_ratio=float(gearhead.ratio * candidates.belt[index]),
        actuator=catalog.actuators.record(catalog.actuators.rows[motor.inside]) if motor.inside else None,
        quickest=quickest_winding(catalog),
        pull_outs=curves_of(catalog, int(candidates.motor[index])),
        currency=catalog.currency,
    )


def drive_set(
    evaluation: Evaluation,
    index: int,
    rank: int,
    *,
    budget: MachineBudget = _NO_BUDGET,
    beside: tuple[Check, ...] = (),
    reliability: Reliability | None = None,
    changes: tuple[Relaxation, ...] = (),
) -> DriveSet:
    """One row of an evaluation as a record, with what else is known of the drive."""
    parts = drive_parts(evaluation, index)
    checks, probability = resolved_checks(evaluation, index)
    guessed = estimated(evaluation, index)
    checks, beside = (
        with_origins(group, parts, evaluation.catalog, guessed)
        for group in (tuple(_why_none(evaluation, index, checks)), beside)
    )
    checks = tuple(replace(check, unit=parts.currency) if check.kind == "price" else check for check in checks)
    problem, returned = evaluation.problem, evaluation.figures.get("returned")
    braking, pieces = budget.braking, list[MotorPiece]()
    limited = problem.machine.limits_the_bus or returned is None or not returned[index] > 0.0
    if not braking and rank == 1 and not limited and problem.machine.battery is None:
        braking = on_its_supply(problem, parts).braking  # of what is regenerated, for which the spec has no limit
    for case in problem.cases[:_CASES]:
        cycle, demand = turned(case.spec, parts, case.at_belt)
        noisy = case.spec.load.kind == "recorded"
        pieces += motor_pieces(cycle, demand, parts.motor.torque_constant, case.name, noisy=noisy)
    return DriveSet(
        **_sums(evaluation, index, parts),
        rank=rank,
        status=verdict((*checks, *budget.checks)) if budget.checks else evaluation.status(index),
        requirements=tuple(evaluation.requirements(index)[1]),
        checks=checks,
        figures=_figures(evaluation, index, parts),
        beside=beside,
        budget=budget.checks,
        machine=budget.figures,
        masses=budget.masses,
        energy=budget.energy,
        braking=braking,
        comparison=compared((*checks, *beside)),
        changes=changes,
        reliability=reliability,
        estimated=guessed,
        pieces=tuple(pieces),
        probability=probability,
    )


def drive_in_brief(
    evaluation: Evaluation,
    index: int,
    rank: int,
    *,
    every_check: bool = False,
    budget: MachineBudget = _NO_BUDGET,
    reliability: Reliability | None = None,
) -> DriveSet:
    """The same with its sums, its tightest check or all of them, and the figures of one cycle alone."""
    return DriveSet(
        **_sums(evaluation, index, drive_parts(evaluation, index)),
        rank=rank,
        status=gravest((evaluation.status(index), verdict(budget.checks))),
        checks=evaluation.checks_of(index) if every_check else evaluation.tightest_of(index),
        figures=figures_of("cycle", {name: column[index] for name, column in evaluation.figures.items()}),
        budget=budget.checks,
        reliability=reliability,
        requirements=(), beside=(), machine=(), masses=(), comparison=(), changes=(), energy=None, braking=None,
    )  # fmt: skip


def _why_none(evaluation: Evaluation, index: int, checks: tuple[Check, ...]) -> Iterator[Check]:
    """The checks; that of a controller says why there is none."""
    problem, motor = evaluation.problem, int(evaluation.candidates.motor[index])
    needed = {check.name: check.demand * (1.0 + check.needed) for check in checks}
    rms, peak = (needed.get(f"controller_{name}_current", math.nan) for name in ("continuous", "peak"))
    for check in checks:
        if check.name == "controller_available" and evaluation.controller[index] < 0:
            yield replace(check, note=none_suits(problem.spec, problem.supply, problem.catalog, motor, (rms, peak)))
        else:
            yield check


def _sums(evaluation: Evaluation, index: int, parts: DriveParts) -> dict[str, Any]:
    """Fields of a drive's record: its parts, its mass and its objective."""
    mass, mass_of = _summed(evaluation, index, parts, "mass")
    by_mass = evaluation.spec.select.objective == "mass"
    value, value_of = (mass, mass_of) if by_mass else _objective(evaluation, index, parts)
    of_parts = {field.name: getattr(parts, field.name) for field in fields(parts)}
    bands = {row.name for row in drive_rows(parts, 1, evaluation.catalog) if row.band}
    masses = {"mass": mass, "mass_of": mass_of, "mass_estimated": tuple(role for role in mass_of if role in bands)}
    return of_parts | masses | {"objective": value, "objective_of": value_of}


def _summed(evaluation: Evaluation, index: int, drive: DriveParts, objective: str) -> tuple[float, tuple[str, ...]]:
    """The sum of what is known, and of which parts; unknown where it is of neither motor nor gearhead."""
    declared, end = OBJECTIVES[objective], 0 if evaluation.catalog.ends else None
    parts = part_rows(evaluation, needs_encoder=not evaluation.spec.steps)
    sets, parts = on((evaluation.candidates, parts), np.array([index]))
    figures = bought(evaluation.catalog, sets, parts, declared.figure, declared.over, end)[:, 0]
    values = dict(zip(declared.over, figures.tolist(), strict=True))
    if drive.actuator:  # the figures of a motor inside are those of the whole
        values["actuator"] = values.pop("motor")
    known = {role: values[role] for role in drive.parts if role in values and not math.isnan(values[role])}
    return (sum(known.values()), tuple(known)) if known.keys() - set(CONTROLLING) else (math.nan, ())


def _objective(evaluation: Evaluation, index: int, parts: DriveParts) -> tuple[float, tuple[str, ...]]:
    """The objective, as it is shown: the margin itself, not what makes less of it better."""
    objective = evaluation.spec.select.objective
    if objective == "margin":
        least = float(smallest_margin(evaluation.checks)[index])
        return (math.nan if math.isinf(least) else least), (OBJECTIVES[objective].note,)
    if not isinstance(objective, str):
        figures = ranking.counted_figures(evaluation)
        value, missing = ranking.values(evaluation.catalog, evaluation.candidates, figures, objective)
        lacking = f", {missing[index]} figures unknown" if missing[index] else ""
        return math.nan if missing[index] else float(value[index]), (
            f"shares of the best shown: {ranking.title_of(objective)}{lacking}",
        )
    declared = OBJECTIVES[objective]
    if declared.over:
        return _summed(evaluation, index, parts, objective)
    return float(evaluation.figures[objective][index]), (declared.note,)


# -- Figures of a drive without a limit of their own, and the settings of its controller.


_LIVES = {"gearhead_life": "rated_life", "gearhead_median_life": "median_life"}


def _figures(evaluation: Evaluation, index: int, parts: DriveParts) -> tuple[Figure, ...]:
    """Figures of a drive, those that its parts have."""
    values: dict[str, Alike] = {name: float(column[index]) for name, column in evaluation.figures.items()}
    if not values:
        return ()
    problem, gearhead, controller = evaluation.problem, parts.gearhead, parts.controller
    if parts.steps:
        return figures_of(("cycle", "stepper"), values | _of_stepper(problem, parts))
    still = next((case for case in problem.cases if not case.at_belt.acts[SPEED]), None)
    if still is not None:  # the first load case in which nothing moves
        warming = warm_up(set_cycle(still.spec, parts, still.at_belt))
        ends = (warming.highest[0], warming.housing[1], warming.housing_in_cycle.max()) if warming else (math.nan,) * 3
        values |= zip(("hold_winding_cold", "hold_housing_cold", "hold_housing"), ends, strict=True)
    stop, linear = _of_brake(problem, parts)
    emergency_stops = problem.spec.needs.emergency_stops
    values |= {name: value for name, value in stop.items() if emergency_stops or not math.isnan(value)}
    cycles = [case.at_belt.behind(parts.belt_ratio) for case in problem.cases]
    for name, rated in _LIVES.items():  # in the load case that wears it most
        life = min(float(life_of_gearheads(cycle, one_row(gearhead), rated)[0]) for cycle in cycles)
        values |= {name: life} if math.isfinite(life) else {}
    loads = shaft_loads(problem.cases[0].spec, cycles[0], parts.belt_drive)
    if loads is not None and problem.cases[0].spec.shaft is not None and not loads.least:
        means = zip(("radial", "axial"), map(float, loads.means[:2]), strict=True)
        values |= {f"shaft_mean_{name}_load": mean for name, mean in means if mean > 0.0}
    if controller is not None:
        at_gear = gearhead.intermittent_torque / (gearhead.ratio * gearhead.efficiency * parts.motor.torque_constant)
        values["current_limit"] = min(controller.peak_current, math.inf if math.isnan(at_gear) else at_gear)
        above = (torque_above(cycle, gearhead.continuous_torque) for cycle in cycles)
        if over := next((pair for pair in above if pair[0] > 0.0), None):
            values |= zip(("gearhead_overload", "gearhead_overload_share"), over, strict=True)
        bodies, ambient = two_bodies(parts.motor), problem.spec.environment.ambient
        for name, start in (("cold", ambient), ("warm", values["winding_temperature"])):
            state, highest = State(start, start), parts.motor.max_winding_temperature
            time = overload_time(bodies, ambient, state, highest, controller.peak_current)
            values[f"overload_time_{name}"] = time
    changed: dict[str, dict[str, Any]] = {}
    if gearhead.kind != DIRECT:
        changed["current_limit"] = {"title": "Current limit to set: no jam overloads the gearhead"}
    if linear:
        changed["stop_travel"] = {"kind": "length", "unit": "mm"}
    return tuple(replace(figure, **changed.get(figure.name, {})) for figure in figures_of(("cycle", "servo"), values))


def _of_stepper(problem: Problem, parts: DriveParts) -> dict[str, float]:
    """Figures of a stepper with its load: its pull-out torque, its step rates and how it swings with its load."""
    motor, cycle = parts.motor, problem.cases[0].cycle
    steps, total = 4.0 * motor.pole_pairs, parts.total_ratio
    inertia = parts.inertia() + float(cycle.inertia) / total**2
    fastest = float(np.abs(cycle.speed).max()) * total
    speeds, volts = np.array([0.0, fastest]), problem.spec.supply.lowest
    at_rest, at_speed = torque_of_drive(parts, speeds, volts).tolist()
    starts = start_speed_with(motor.start_speed, motor.rotor_inertia, inertia, 0.0, motor.holding_torque)
    return {
        "pull_out_at_rest": at_rest,
        "pull_out_at_speed": at_speed,
        "step_rate": fastest * steps / (2.0 * math.pi),
        "natural_frequency": float(natural_frequency(motor.pole_pairs, motor.holding_torque, inertia)),
        "start_rate": float(starts) * steps / (2.0 * math.pi),
    }


def _of_brake(problem: Problem, parts: DriveParts) -> tuple[dict[str, float], bool]:
    """Power of the released brake, and an emergency stop from the highest speed in the load case with most energy.

    And whether the load travels in a line.
    """
    brake, gearhead, own = parts.brake, parts.gearhead, parts.inertia()
    if brake is None:
        return {}, False
    worst, radius, axis = Stop(0.0, 0.0, 0.0), 1.0, "rotary"
    for case in problem.cases:
        _, weak_stop = stops(case.spec, case.at_belt.behind(parts.belt_ratio), gearhead, brake, own)
        if not weak_stop.energy <= worst.energy:  # NaN too
            worst, radius, axis = weak_stop, case.cycle.radius, case.spec.load.shaft_axis
    travel = worst.angle / (1.0 if brake.shaft == "load" else parts.total_ratio) * radius
    figures = parts.released_power, worst.energy, worst.time, travel
    values = dict(zip(("brake_power", "stop_energy", "stop_time", "stop_travel"), map(float, figures), strict=True))
    return values, axis == "linear"


# -- The paper's method and the physics side by side, for drives that were found by one of them.


# what the paper checks, what physics checks in its place, and why the two figures differ
_PAIRS = (
    ("gearhead_continuous_torque", "gearhead_continuous_torque",
     "no bearing, efficiency and oversize factors; RMS while running"),
    ("gearhead_intermittent_torque", "gearhead_intermittent_torque",
     "no oversize and efficiency factors; the rotor is not behind the gearhead"),
    ("gearhead_input_speed", "gearhead_continuous_speed",
     "the wheel turns at speed over radius, no reserve of (1)"),
    ("controller_continuous_current", "controller_continuous_current",
     "rotor inertia through the ratio squared, braking by its direction of power, no factors"),
    ("controller_peak_current", "controller_peak_current",
     "rotor inertia through the ratio squared, no oversize factor"),
)  # fmt: skip


def compared(checks: Sequence[Check]) -> tuple[Comparison, ...]:
    """The limits that both methods look at, among the checks of both."""
    paper, physics = ({c.name: c for c in checks if c.method == method} for method in ("paper", "physics"))
    pairs = [(a, b, why) for a, b, why in _PAIRS if a in paper and b in physics]
    return tuple(Comparison(paper=paper[a], physics=physics[b], why=why) for a, b, why in pairs)


def other_checks(problem: Problem, drive: DriveParts) -> tuple[Check, ...]:
    """The checks of a drive by the other method; none where the paper does not treat the load.

    The gearhead's whole family comes along, as the paper's rule looks at the other reductions too.
    """
    if not problem.spec.paper_applies:
        return ()
    method = "physics" if problem.spec.method == "paper" else "paper"
    catalog = problem.catalog
    tables: dict[str, Table[Any]] = {  # in which these parts alone may be chosen
        name: replace(table, excluded=table["part"] != part.part)
        for name, table, part in (
            ("encoders", catalog.encoders, drive.encoder), ("controllers", catalog.controllers, drive.controller),
        )
        if part is not None
    }  # fmt: skip
    narrowed = replace(problem, catalog=catalog.with_tables(tables, {})).with_sections(
        select=problem.spec.select.pair_with(drive.motor.part, drive.gearhead.family), method=method
    )
    rows = catalog.motors.rows[drive.motor.part], catalog.gearheads.rows[drive.gearhead.part]
    offered = candidates(narrowed, also=rows)
    evaluation = evaluate(narrowed, offered)
    mask = (offered.motor == rows[0]) & (offered.gearhead == rows[1]) & (offered.belt == drive.belt_ratio)
    return evaluation.checks_of(int(np.flatnonzero(mask)[0]))
