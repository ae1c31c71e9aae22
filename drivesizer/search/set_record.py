"""One candidate as a record: parts, sums, requirements, checks, figures of a stepper."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from math import pi
from typing import Any

import numpy as np

from drivesizer.catalog import DIRECT, Controller, Gearhead, Motor, Table
from drivesizer.catalog.parts import one_row
from drivesizer.kernel.warming import State, overload_time
from drivesizer.machine.braking import braking_budget
from drivesizer.machine.budgets import MachineBudget
from drivesizer.machine.part_curves import curves_of, torque_of_part
from drivesizer.machine.problem import quickest_winding
from drivesizer.machine.set_cycle import motor_pieces, set_cycle, torque_above, turned, warm_up
from drivesizer.physics.braking import Stop
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.physics.stepper import natural_frequency, start_speed_with
from drivesizer.physics.thermal import two_bodies
from drivesizer.results.check import Check, Figure, Reliability, Status, gravest, verdict
from drivesizer.results.check_kinds import with_origins
from drivesizer.results.drive_set import BrakingBudget, Comparison, DriveParts, DriveSet, MotorPiece, Relaxation
from drivesizer.results.problem import Problem
from drivesizer.search import ranking
from drivesizer.search.columns.brakes import stops
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.controllers import none_suits
from drivesizer.search.columns.evaluation import Evaluation, evaluate, smallest_margin
from drivesizer.search.columns.shaft_limits import life_of_gearheads, shaft_loads
from drivesizer.search.open_checks import estimated, resolved_checks
from drivesizer.search.ranking import CONTROLLING, bought, chosen
from drivesizer.spec.drive import OBJECTIVES, Choice, MotorChoice

# -- Figures of a stepper with its load that have no limit of their own.


STEPPER_ASSUMPTIONS = (
    "gear and belt keep their catalogue efficiency, the maximum, at any torque, and driven backward as well",
    "a stepper's driver gives the current that it is set to, the rated one where control.phase_current gives none, and "
    "that of control.idle_current from the beginning of a rest; it loses 2 R I^2, at high speed less; holding and "
    "pull-out torque go with it, at high speed, where the voltage limits, they fall less",
    "pull-out torque is that of the printed curve of the highest voltage that the lowest supply reaches, compressed "
    "along the speed to a lower one; without a curve that of the ideal two-phase model times an estimated share",
    "a stepper's own friction is in its pull-out torque; losses of its driver are not counted",
    "rotor and load turn as one body: neither lost steps at a resonance nor a soft coupling are in the checks",
)

_STEPPER_TABLE = (
    ("energy", "Energy per cycle, all drives", "energy", "J"),
    ("returned", "Regenerated energy per cycle", "energy", "J"),
    ("power", "Largest supply power, all drives", "power", "W"),
    ("joule_heat", "Heat of both windings, mean", "power", "W"),
    ("peak_current", "Amplitude of the phase current to set", "current", "A"),
    ("winding_temperature", "Winding temperature, peak", "temperature", "degC"),
    ("pull_out_at_rest", "Pull-out torque at low speed", "torque", "N*m"),
    ("pull_out_at_speed", "Pull-out torque at the highest speed", "torque", "N*m"),
    ("step_rate", "Full steps per second at the highest speed", "frequency", "Hz"),
    ("natural_frequency", "Natural frequency with the load, held", "frequency", "Hz"),
    ("start_rate", "Full steps per second without a ramp, no load torque", "frequency", "Hz"),
)


def stepper_figures(problem: Problem, parts: DriveParts, values: dict[str, float]) -> tuple[Figure, ...]:
    """Figures of a drive with a stepper: what it draws, its step rates and how it swings with its load."""
    motor, cycle = parts.motor, problem.cases[0].cycle
    steps, total = 4.0 * motor.pole_pairs, parts.total_ratio
    rotor = motor.rotor_inertia
    inertia = parts.inertia() + float(cycle.inertia) / total**2
    fastest = float(np.abs(cycle.speed).max()) * total
    speeds, volts = np.array([0.0, fastest]), problem.spec.supply.lowest
    at_rest, at_speed = torque_of_part(problem.catalog, motor.part, speeds, volts).tolist()
    starts = start_speed_with(motor.start_speed, rotor, inertia, 0.0, motor.holding_torque)
    own = {
        "pull_out_at_rest": at_rest,
        "pull_out_at_speed": at_speed,
        "step_rate": fastest * steps / (2.0 * pi),
        "natural_frequency": float(natural_frequency(motor.pole_pairs, motor.holding_torque, inertia)),
        "start_rate": float(starts) * steps / (2.0 * pi),
    }
    found = values | own
    return tuple(Figure(name=n, title=t, value=found[n], kind=k, unit=u) for n, t, k, u in _STEPPER_TABLE)


# -- One candidate as a record: parts, sums, requirements and checks.


_NO_BUDGET = MachineBudget()


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
        with_origins(some, parts, evaluation.catalog, guessed)
        for some in (tuple(_why_none(evaluation, index, checks)), beside)
    )
    return DriveSet(
        **_sums(evaluation, index, parts),
        rank=rank,
        status=_status(evaluation, index, checks, budget),
        requirements=tuple(r.at(index) for r in evaluation.shaft.values()),
        checks=checks,
        figures=_figures(evaluation, index, parts) if evaluation.figures else (),
        beside=beside,
        budget=budget.checks,
        machine=budget.figures,
        masses=budget.masses,
        energy=budget.energy,
        braking=budget.braking or (_regenerated(evaluation, index, parts) if rank == 1 else None),
        comparison=compared((*checks, *beside)),
        changes=changes,
        reliability=reliability,
        estimated=guessed,
        pieces=_pieces(evaluation, parts),
        probability=probability,
    )


def drive_in_brief(
    evaluation: Evaluation,
    index: int,
    rank: int,
    *,
    budget: MachineBudget = _NO_BUDGET,
    reliability: Reliability | None = None,
) -> DriveSet:
    """The same with its sums, its tightest check and the figures of one cycle alone."""
    return DriveSet(
        **_sums(evaluation, index, drive_parts(evaluation, index)),
        rank=rank,
        status=gravest((evaluation.status(index), verdict(budget.checks))),
        checks=evaluation.tightest_of(index),
        figures=tuple(_cycle_figures(evaluation, index)) if evaluation.figures else (),
        budget=budget.checks,
        reliability=reliability,
        **_NOT_IN_BRIEF,
    )


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


_NOT_IN_BRIEF: dict[str, Any] = {
    **dict.fromkeys(("requirements", "beside", "machine", "masses", "comparison", "changes"), ()),
    **dict.fromkeys(("energy", "braking")),
}


def _sums(evaluation: Evaluation, index: int, parts: DriveParts) -> dict[str, Any]:
    """Fields of a drive's record: its parts, its mass and its objective."""
    mass, mass_of = _summed(evaluation, index, parts, "mass")
    value, value_of = _objective(evaluation, index, parts)
    return {field.name: getattr(parts, field.name) for field in fields(parts)} | {
        "mass": mass,
        "mass_of": mass_of,
        "objective": value,
        "objective_of": value_of,
    }


def _status(evaluation: Evaluation, index: int, checks: tuple[Check, ...], budget: MachineBudget) -> Status:
    return verdict((*checks, *budget.checks)) if budget.checks else evaluation.status(index)


def _regenerated(evaluation: Evaluation, index: int, parts: DriveParts) -> BrakingBudget | None:
    """Figures of what is regenerated, where anything is known to be and the spec has no limit for it: of the first."""
    problem, returned = evaluation.problem, evaluation.figures.get("returned")
    if problem.machine.limits_the_bus or returned is None or not returned[index] > 0.0:
        return None
    return braking_budget(problem, parts)


_CASES = 4  # whose pieces are listed


def _pieces(evaluation: Evaluation, parts: DriveParts) -> tuple[MotorPiece, ...]:
    """The motor's torque piece by piece in the first load cases."""
    found: list[MotorPiece] = []
    for case in evaluation.problem.cases[:_CASES]:
        cycle, demand = turned(case.spec, parts, case.at_belt)
        noisy = case.spec.load.kind == "recorded"
        found += motor_pieces(cycle, demand, parts.motor.torque_constant, case.name, noisy=noisy)
    return tuple(found)


def _summed(evaluation: Evaluation, index: int, one: DriveParts, objective: str) -> tuple[float, tuple[str, ...]]:
    """The sum of what is known, and of which parts; unknown where it is of neither motor nor gearhead."""
    declared, row = OBJECTIVES[objective], evaluation.on(np.array([index]))
    end = 0 if evaluation.catalog.ends else None
    parts = chosen(row, needs_encoder=not row.spec.steps)
    every = bought(evaluation.catalog, row.candidates, parts, declared.figure, declared.over, end)[:, 0]
    values = dict(zip(declared.over, every.tolist(), strict=True))
    if one.actuator:  # the figures of a motor inside are those of the whole
        values["actuator"] = values.pop("motor")
    known = {role: values[role] for role in one.parts if role in values and not math.isnan(values[role])}
    return (sum(known.values()), tuple(known)) if known.keys() - set(CONTROLLING) else (math.nan, ())


def _objective(evaluation: Evaluation, index: int, parts: DriveParts) -> tuple[float, tuple[str, ...]]:
    """The objective, as it is shown: the margin itself, not what makes less of it better."""
    objective = evaluation.spec.select.objective
    if objective == "margin":
        least = float(smallest_margin(evaluation.checks)[index])
        return (math.nan if math.isinf(least) else least), (OBJECTIVES[objective].note,)
    if not isinstance(objective, str):
        figures = dict(evaluation.figures) | {"margin": smallest_margin(evaluation.checks)}
        figures |= chosen(evaluation, needs_encoder=not evaluation.spec.steps)
        value, missing = ranking.values(evaluation.catalog, evaluation.candidates, figures, objective)
        lacking = f", {missing[index]} figures unknown" if missing[index] else ""
        return math.nan if missing[index] else float(value[index]), (
            f"shares of the best shown: {ranking.title_of(objective)}{lacking}",
        )
    declared = OBJECTIVES[objective]
    if declared.over:
        return _summed(evaluation, index, parts, objective)
    return float(evaluation.figures[objective][index]), (declared.note,)


_TABLE = (
    ("energy", "Energy per cycle, all drives", "energy", "J"),
    ("returned", "Regenerated energy per cycle", "energy", "J"),
    ("power", "Largest supply power, all drives", "power", "W"),
    ("joule_heat", "Heat of the winding, mean", "power", "W"),
    ("peak_current", "Largest motor current", "current", "A"),
    ("winding_temperature", "Winding temperature, peak", "temperature", "degC"),
)


def _cycle_figures(evaluation: Evaluation, index: int) -> list[Figure]:
    """Figures of a drive over one cycle that are computed of every candidate."""
    values = evaluation.figures
    return [Figure(name=n, title=t, value=float(values[n][index]), kind=k, unit=u) for n, t, k, u in _TABLE]


def _figures(evaluation: Evaluation, index: int, parts: DriveParts) -> tuple[Figure, ...]:
    """Figures of a drive without a limit, and the settings of its controller."""
    values = {name: float(column[index]) for name, column in evaluation.figures.items()}
    if parts.steps:
        return stepper_figures(evaluation.problem, parts, values)
    found = _cycle_figures(evaluation, index)
    found += [*_static_temperatures(evaluation, parts), *_braking(evaluation, index, parts)]
    found += _gearhead_life(evaluation, index, parts.gearhead)
    found += _shaft_loads(evaluation, parts)
    motor, gearhead, controller = parts.motor, parts.gearhead, parts.controller
    if controller is None:
        return tuple(found)
    at_gear = gearhead.intermittent_torque / (gearhead.ratio * gearhead.efficiency * motor.torque_constant)
    limit = min(controller.peak_current, at_gear) if at_gear == at_gear else controller.peak_current
    title = "Current limit to set" + (": no jam overloads the gearhead" if gearhead.kind != DIRECT else "")
    found.append(Figure(name="current_limit", title=title, value=limit, kind="current", unit="A"))
    return (
        *found,
        *_gearhead_overload(evaluation, index, gearhead),
        *_overloads(evaluation, values, motor, controller),
    )


_HELD = {
    "hold_winding_cold": "Winding at the end of the hold, from cold",
    "hold_housing_cold": "Housing at the end of the hold, from cold",
    "hold_housing": "Housing, hold repeated",
}


def _static_temperatures(evaluation: Evaluation, parts: DriveParts) -> list[Figure]:
    """Temperatures of the first load case in which nothing moves; none where there is no such case."""
    case = next((one for one in evaluation.problem.cases if not one.at_belt.acts[SPEED]), None)
    if case is None:
        return []
    found = warm_up(set_cycle(case.spec, parts, case.at_belt))
    ends = (found.highest[0], found.housing[1], found.housing_in_cycle.max()) if found else (math.nan,) * 3
    return [
        Figure(name=name, title=title, value=float(value), kind="temperature", unit="degC")
        for (name, title), value in zip(_HELD.items(), ends, strict=True)
    ]


def _shaft_loads(evaluation: Evaluation, parts: DriveParts) -> list[Figure]:
    """Equivalent mean loads of the output shaft in the first load case; none where the spec has none."""
    case = evaluation.problem.cases[0]
    loads = shaft_loads(case.spec, case.at_belt.behind(parts.belt_ratio), parts.belt_drive)
    if loads is None or case.spec.shaft is None or loads.least:
        return []
    radial, axial, _ = (float(mean) for mean in loads.means)
    return [
        Figure(name=f"shaft_mean_{name}_load", title=f"Output shaft, equivalent mean {name} load", value=value,
               kind="force", unit="N")
        for name, value in (("radial", radial), ("axial", axial)) if value > 0.0
    ]  # fmt: skip


_LIVES = {
    "rated_life": ("gearhead_life", "Gearhead nominal life, rests included"),
    "median_life": ("gearhead_median_life", "Gearhead median life L_50, rests included"),
}


def _gearhead_life(evaluation: Evaluation, index: int, gearhead: Gearhead) -> list[Figure]:
    """Lives of the gearhead in the load case that wears it most; none without a rated life, or where it never turns."""
    found = []
    for rated, (name, title) in _LIVES.items():
        cycles = [case.at_belt.behind(float(evaluation.candidates.belt[index])) for case in evaluation.problem.cases]
        life = min(float(life_of_gearheads(cycle, one_row(gearhead), rated)[0]) for cycle in cycles)
        if math.isfinite(life):
            found.append(Figure(name=name, title=title, value=life, kind="time", unit="h"))
    return found


def _braking(evaluation: Evaluation, index: int, parts: DriveParts) -> list[Figure]:
    """Power of the released brake, and an emergency stop from the highest speed in the load case with most energy."""
    brake = parts.brake
    if brake is None:
        return []
    gearhead, own = parts.gearhead, parts.inertia()
    worst, radius, axis = Stop(0.0, 0.0, 0.0), 1.0, "rotary"
    for case in evaluation.problem.cases:
        cycle = case.at_belt.behind(parts.belt_ratio)
        _, found = stops(case.spec, cycle, gearhead, brake, own)
        if not found.energy <= worst.energy:  # NaN too
            worst, radius, axis = found, case.cycle.radius, case.spec.load.axis
    travel = worst.angle / (1.0 if brake.shaft == "load" else parts.total_ratio) * radius
    path = ("length", "mm") if axis == "linear" else ("angle", "deg")
    rows = (
        ("brake_power", "Brake, released", parts.released_power, "power", "W"),
        ("stop_energy", "Emergency stop from the highest speed, energy in the brake", worst.energy, "energy", "J"),
        ("stop_time", "Emergency stop, time", worst.time, "time", "s"),
        ("stop_travel", "Emergency stop, travel of the load", travel, *path),
    )
    every = [Figure(name=n, title=t, value=float(value), kind=k, unit=u) for n, t, value, k, u in rows]
    return [one for one in every if evaluation.spec.needs.emergency_stops or not math.isnan(one.value)]


def _gearhead_overload(evaluation: Evaluation, index: int, gearhead: Gearhead) -> list[Figure]:
    """Times of the gearhead above its continuous torque, in the first load case that has any."""
    limit = gearhead.continuous_torque
    for case in evaluation.problem.cases:
        longest, share = torque_above(case.at_belt.behind(float(evaluation.candidates.belt[index])), limit)
        if longest > 0.0:
            title = "Gearhead above its continuous torque"
            return [
                Figure(name="gearhead_overload", title=f"{title}, uninterrupted", value=longest, kind="time", unit="s"),
                Figure(name="gearhead_overload_share", title=f"{title}, share of the cycle", value=share,
                       kind="dimensionless", unit="%"),
            ]  # fmt: skip
    return []


def _overloads(evaluation: Evaluation, values: dict[str, float], motor: Motor, controller: Controller) -> list[Figure]:
    """Overload time of the motor at the controller's peak current, cold and at its highest temperature."""
    bodies = two_bodies(motor)
    ambient, current = evaluation.spec.environment.ambient, controller.peak_current
    hot = values["winding_temperature"]
    starts = {"cold": State(ambient, ambient), "warm": State(hot, hot)}
    return [
        Figure(
            name=f"overload_time_{name}", title=f"Time at the controller's peak current, {name}",
            value=overload_time(bodies, ambient, start, motor.max_winding_temperature, current), kind="time", unit="s",
        )
        for name, start in starts.items()
    ]  # fmt: skip


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
    both = [(a, b, why) for a, b, why in _PAIRS if a in paper and b in physics]
    return tuple(Comparison(paper=paper[a], physics=physics[b], why=why) for a, b, why in both)


def other_checks(problem: Problem, one: DriveParts) -> tuple[Check, ...]:
    """The checks of a drive by the other method; none where the paper does not treat the load.

    The gearhead's whole family comes along, as the paper's rule looks at the other reductions too.
    """
    if not problem.spec.paper_applies:
        return ()
    fixed = {
        "motor": MotorChoice(part=[one.motor.part]),
        "gearhead": Choice(family=[one.gearhead.family]),
    }
    method = "physics" if problem.spec.method == "paper" else "paper"
    catalog = problem.catalog
    tables: dict[str, Table[Any]] = {  # in which these parts alone may be chosen
        name: replace(table, excluded=table["part"] != part.part)
        for name, table, part in (
            ("encoders", catalog.encoders, one.encoder), ("controllers", catalog.controllers, one.controller),
        )
        if part is not None
    }  # fmt: skip
    narrowed = replace(problem, catalog=catalog.with_tables(tables, {})).with_sections(
        select=problem.spec.select.model_copy(update=fixed), method=method
    )
    rows = catalog.motors.rows[one.motor.part], catalog.gearheads.rows[one.gearhead.part]
    offered = candidates(narrowed, also=rows)
    evaluation = evaluate(narrowed, offered)
    found = (offered.motor == rows[0]) & (offered.gearhead == rows[1]) & (offered.belt == one.belt_ratio)
    return evaluation.checks_of(int(np.flatnonzero(found)[0]))
