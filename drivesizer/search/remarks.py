"""Remarks beside the drives of a sizing: assumptions that were made, and warnings."""

from __future__ import annotations

import math
from collections.abc import Iterable
from math import isnan
from statistics import NormalDist

import numpy as np

from drivesizer.catalog.tolerances import lognormal
from drivesizer.load_cases.of_machine import grip_warning, starts_farther_on
from drivesizer.loads import Load
from drivesizer.loads.recorded import ComputedLoad, Recorded
from drivesizer.machine import belts as pulleys
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.physics.drive_train import usual_idle
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check_kinds import unknown_figures
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import unstated_ambient, unstated_supply, unstated_temperature
from drivesizer.results.sizing import objective_figure
from drivesizer.search.machine_filter import shortfall
from drivesizer.search.open_checks import drives_at_points
from drivesizer.search.set_record import TABLES
from drivesizer.search.shortlist import Shortlist
from drivesizer.spec.mounting import altitude_words, mounting_words
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

_FEW = 4  # missing figures at most that are worth a request to the maker


def assumptions(problem: Problem, spec: RobotSpec, sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Assumptions behind the figures of a sizing, as sentences."""
    return (
        *_method_remarks(problem.spec),
        *_waits(problem.machine),
        *altitude_words(problem.spec),
        *mounting_words(problem.spec),
        *_static_remarks(problem),
        *pulleys.assumptions(problem),
        *_data_remarks(spec, sets),
    )


def warnings(picked: Shortlist, sets: tuple[DriveSet, ...]) -> tuple[str, ...]:
    """Warnings: of a part that the method leaves out, of limits of the best drive."""
    result = picked.search
    weighed = (picked.machine.budget(result.evaluation, row) for row in picked.short)
    budgets = shortfall(weighed, result.better, any_passes=bool(result.passing))
    return (
        *_mains(picked.problem.machine),
        *picked.weighed,
        *_best_drive_warnings(picked, sets),
        *nearest_figures(picked.problem.machine, sets[:1]),
        *_held_back_remarks(picked, sets),
        *budgets,
    )


def _data_remarks(spec: RobotSpec, sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Motors whose figures are of a temperature that nobody states, and parts without an ambient range; by physics."""
    if spec.method != "physics":
        return ()
    drives = tuple(sets)
    stated = unstated_temperature(s.motor.part for s in drives if isnan(s.motor.data_temperature))
    return (*stated, *unstated_ambient(drives), *unstated_supply(drives))


def nearest_figures(spec: RobotSpec, sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Parts that have figures at several voltages, none of them that of the supply."""
    volts = spec.supply.nominal
    rows = (s.motor for s in sets if s.motor.order_number and not math.isclose(s.motor.nominal_voltage, volts))
    nearest = {motor.order_number: show(motor.nominal_voltage, "V", "voltage") for motor in rows}
    return tuple(
        f"the figures of {part} are those at {own}, of those of its maker the nearest to {show(volts, 'V', 'voltage')}"
        for part, own in nearest.items()
    )


_MAINS = (100, 110, 115, 120, 200, 208, 220, 230, 240, 380, 400, 415, 440, 460, 480)  # V


def _mains(spec: RobotSpec) -> tuple[str, ...]:
    """A warning of a supply that has a voltage of the mains, which are rectified."""
    volts = spec.supply.nominal
    if spec.battery or spec.supply.kind == "battery" or volts not in _MAINS:
        return ()
    U, rectified = show(volts, "V", "voltage"), show(math.sqrt(2.0) * volts, "V", "voltage", 3)
    return (f"supply.nominal {U} is the direct voltage at the controllers; mains of {U}, rectified, give {rectified}",)


def _waits(spec: RobotSpec) -> tuple[str, ...]:
    """The rest at the end of the motion of an axis of a machine."""
    if spec.waits_until is None:
        return ()
    cycle = show(spec.waits_until, "s", "time")
    return (f"it is at rest after its motion until the machine's cycle of {cycle} is over",)


def _method_remarks(spec: RobotSpec) -> tuple[str, ...]:
    """Assumptions of the method, as sentences."""
    method = "steppers" if spec.steps else spec.method
    sentences = [sentence for head, (sentence, *_) in TABLES if head == method]
    if method == "physics" and spec.paper_applies:
        sentences.append("the paper's factors enter neither requirements nor checks")
    if method != "paper":
        return tuple(sentences)
    factors = spec.paper_factors
    left = [name for name in type(factors).model_fields if getattr(factors, name) == 1.0]
    if left:
        sentences.append(f"paper factors at 1, no allowance: {', '.join(left)}")
    return tuple(sentences)


def _static_remarks(problem: Problem) -> tuple[str, ...]:
    """Assumption of a load case in which nothing moves, as a sentence."""
    if problem.spec.method != "physics" or all(case.at_belt.acts[SPEED] for case in problem.cases):
        return ()
    return (
        "a load that never moves is held on and on: the motor has its torque through the ideal ratio, though gear loss "
        "and friction may carry some, and the RMS torque at rest counts as the gearhead's continuous one",
    )


def _best_drive_warnings(picked: Shortlist, sets: tuple[DriveSet, ...]) -> tuple[str, ...]:
    """Warnings: what the method leaves out, and what limits the best drive."""
    problem, spec = picked.problem, picked.problem.spec
    sentences = list(dict.fromkeys(line for case in problem.cases for line in grip_warning(case.spec)))
    if spec.method == "paper":
        sentences.append(
            "the paper's rule does not look at heat, permissible motor speed or supply sag; the physics beside it does"
        )
    sentences += not_returning(problem)
    sentences += [text for case in problem.cases if (text := _lone_peak(case.spec.load, case.cycle))]
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
    sentences += _idle_gearhead(picked, best)
    figures = {figure.name: figure for figure in best.figures}
    if "current_limit" in figures and figures["current_limit"].value < figures["peak_current"].value:
        currents = figures["current_limit"].text, figures["peak_current"].text
        sentences.append(
            f"the current limit that protects the gearhead at a jam is {currents[0]}, the cycle takes {currents[1]}"
        )
    if spec.method == "paper" and best.motor.nominal_voltage > spec.supply.highest:
        volts = [show(v, "V", "voltage") for v in (best.motor.nominal_voltage, spec.supply.highest)]
        sentences.append(f"the best drive's motor is wound for {volts[0]}, the supply gives {volts[1]} at most")
    return tuple(sentences)


_SHARES = np.linspace(0.05, 0.95, 19)  # of gearheads of a kind, with less friction


def _idle_gearhead(picked: Shortlist, best: DriveSet) -> Iterable[str]:
    """A warning where friction of the gearhead without load, which is not printed, decides of checks."""
    low, usual, high = (float(torque) for torque in usual_idle(best.gearhead))
    if picked.problem.spec.method != "physics" or isnan(usual) or not isnan(best.gearhead.no_load_torque) or best.steps:
        return
    row = next(iter((*picked.best, *picked.unsure)))
    drive, evaluation = picked.search.evaluation.with_parts(np.array([row])), picked.search.evaluation
    idle = lognormal(low, usual, high, np.array([NormalDist().inv_cdf(share) for share in _SHARES]))
    names = {check.name for check in best.own_checks if check.status == "pass"}
    values = {("gearheads", "no_load_torque"): idle}
    samples = drives_at_points(evaluation.problem, drive, [{}], len(idle), names, values)
    decided = [check for check in samples.checks if check.name in names and check.failed[-1] and not check.advice]
    if not decided:
        return
    ends = [show(torque, "mN*m", "torque", 2) for torque in (low, high)]
    passes = f"{np.logical_and.reduce([check.passed for check in decided]).mean():.0%}".replace("%", " %")
    notes, cases = [], tuple(case.name for case in evaluation.problem.cases)
    for check in decided:
        least, most = (check.at(end, "physics", cases=cases) for end in (0, -1))
        figures = [show(x, most.unit, most.kind, 3) for x in (least.demand, most.demand, most.limit)]
        margin = f" with {show(most.needed, '%', 'dimensionless')} of margin" if most.needed else ""
        notes.append("{} {} to {} of {}".format(most.title, *figures) + margin)
    yield (
        "friction of the best drive's gearhead without load is not printed; with what is usual of its kind, "
        f"{ends[0]} to {ends[1]} at its input, the drive passes with {passes}: {'; '.join(notes)}"
    )


_LONE = 0.8  # of the peak, below which the largest torque beside it says that it is one sample's


def _lone_peak(load: Load, cycle: LoadCycle) -> str:
    """A warning of a recording whose largest torque is a single sample; empty of others."""
    if not isinstance(load, Recorded) or isinstance(load, ComputedLoad) or len(cycle.duration) < _SAMPLES:
        return ""
    torque = np.append(np.abs(cycle.torque[:, 0]), abs(cycle.torque[-1, 1]))
    at = int(torque.argmax())
    others = float(np.delete(torque, at).max())
    if others >= _LONE * torque[at]:
        return ""
    peak, without = (show(T * load.motors, "N*m", "torque", 3) for T in (float(torque[at]), others))
    when = show(float(cycle.duration[:at].sum()), "s", "time")
    return f"the largest torque of {load.file}, {peak}, is a single sample at {when}; without it {without}"


_SAMPLES = 50  # of a recording, rather than of a cycle that was written by hand


def _held_back_remarks(picked: Shortlist, sets: tuple[DriveSet, ...]) -> list[str]:
    """Drives better than the best one but for missing figures, and the figures that would decide the first of them."""
    objective = picked.problem.spec.select.objective
    if not sets or not isinstance(objective, str):
        return []
    better = [drive for row in picked.search.held_back if (drive := picked.record(row)).status in ("open", "unknown")]
    needs = [(drive, needed) for drive in better if (needed := _decided_by(drive))]
    if not needs:
        return []
    (first, needed), *others = needs
    value, best = (objective_figure(drive, objective).text for drive in (first, sets[0]))
    also = ", ".join(f"{drive.label} with {objective_figure(drive, objective).text}" for drive, _ in others)
    return [
        f"{first.label}, {value} against {best}, would be the first were its figures known: "
        f"{needed}{f'; so would {also}' if also else ''}"
    ]


def _decided_by(drive: DriveSet) -> str:
    """The figures that decide the open and unknown checks of a drive; empty where they are many."""
    notes = {check.title: check.note for check in drive.own_checks if check.note.startswith("unknown: ")}
    undecided = [check for check in drive.deciding if check.status == "open"]
    hanging = [f"{c.title} {c.note}" if c.note.startswith(("passes", "hangs")) else c.title for c in undecided]
    hanging += [f"{title} is {note}" for title, note in notes.items()]
    unknown = [lacks for title, lacks in unknown_figures(drive) if title not in notes]
    lacking = dict.fromkeys(name for lacks in unknown for name in lacks.split(", "))
    if len(lacking) > _FEW:
        return ""
    return "; ".join([*hanging, *([f"no data sheet gives {', '.join(lacking)}"] if lacking else [])])


def not_returning(problem: Problem) -> list[str]:
    """Load cases that do not return to where they started."""
    return [line for case in problem.cases for line in starts_farther_on(case.name, case.spec)]
