"""Panels of the motor's field: one for load cases that share its lines, and the paper's points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isnan

import numpy as np
from numpy.typing import NDArray

from drivesizer import equations as eq
from drivesizer.machine.operating_field import OperatingField, field, with_pull_out
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.requirement import Requirement

__all__ = ["TOGETHER", "OperatingPoint", "Panel", "alone", "leading", "panels", "paper_points", "reach_of", "signed"]

TOGETHER = 2  # load cases that one diagram shows apart; more are drawn one by one
_FAR = 6.0  # times the continuous torque; an intermittent line beyond would leave the rest no room


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """A moment of the cycle at the motor shaft."""

    name: str
    torque: float  # N*m
    speed: float  # rad/s


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """Load cases with the same usable voltage and ambient: the motor's lines are the same for all of them."""

    cases: tuple[tuple[int, str, OperatingField], ...]  # number and name; without a name where there is but one
    points: tuple[OperatingPoint, ...] = ()


def panels(problem: Problem, drive_set: DriveSet, requirements: tuple[Requirement, ...]) -> list[Panel]:
    """The field of a set's motor with the load cases in it; the paper's points too, where its method is used."""
    alike: dict[tuple[float, float], list[tuple[int, str, OperatingField]]] = {}
    for number, case in enumerate(problem.cases):
        found = field(case.spec, drive_set)
        if drive_set.steps:
            found = with_pull_out(found, case.spec, problem.catalog, drive_set.motor.part)
        alike.setdefault((found.voltage, found.ambient), []).append((number, case.name, found))
    points = paper_points(drive_set, requirements) if problem.spec.method == "paper" else ()
    return [Panel(cases=tuple(cases), points=points) for cases in alike.values()]


def leading(found: Sequence[Panel]) -> Panel:
    """The first panel with as many load cases as one diagram shows: all of them, or the first alone."""
    first = found[0]
    return first if len(first.cases) <= TOGETHER else replace(first, cases=first.cases[:1])


def alone(found: Sequence[Panel]) -> list[Panel]:
    """A panel for each load case, where they are more than one diagram shows; else none."""
    single = [replace(panel, cases=(case,), points=()) for panel in found for case in panel.cases]
    return single if len(found) > 1 or len(single) > TOGETHER else []


def paper_points(drive_set: DriveSet, requirements: tuple[Requirement, ...]) -> tuple[OperatingPoint, ...]:
    """The operating points of the paper's cycle, every torque brought to the motor as in (18)."""
    of = {r.name: float(r.value) for r in requirements}
    wheels = of["maximum_torque"] / of["maximum_torque_per_motor"]
    torques = {
        "end of acceleration": (of["maximum_torque_per_motor"], of["nominal_speed"]),
        "cruise": (of["nominal_torque_per_motor"], of["nominal_speed"]),
        "start of deceleration": (of["deceleration_torque"] / wheels, of["nominal_speed"]),
        "RMS": (of["rms_torque_per_motor"], of["rms_speed"]),
    }
    chain = {"K_g": drive_set.gearhead.ratio, "eta_gear": drive_set.gearhead.efficiency,
             "i_b": drive_set.belt_ratio, "eta_b": drive_set.belt_efficiency}  # fmt: skip
    return tuple(
        OperatingPoint(
            name=name, torque=float(eq.maximum_torque_at_motor(torque, **chain)), speed=speed * drive_set.total_ratio
        )
        for name, (torque, speed) in torques.items()
        if not isnan(torque + speed + sum(chain.values()))  # unknown is nowhere to be marked
    )


def signed(found: OperatingField) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Speed and torque of the cycle, one way as the other: what brakes is below 0, what holds is not."""
    way = np.sign(found.cycle_speed.mean(1))[:, None]
    return np.abs(found.cycle_speed), np.where(way == 0.0, np.abs(found.cycle_torque), way * found.cycle_torque)


def reach_of(panel: Panel) -> float:
    """The torque to which the axis goes [N*m]: what the drive may do and the cycle requires, seldom as far as stall."""
    first = panel.cases[0][-1]
    required = [float(np.nan_to_num(signed(f)[1]).max()) for *_, f in panel.cases]
    if first.pull_out is not None:
        return max(float(np.nan_to_num(first.pull_out).max()), *required)
    stall = float(np.nan_to_num(first.voltage_cold[0]))
    lines = (first.continuous.max(), np.fmin(first.intermittent.max(), _FAR * first.continuous.max()))
    known = [min(float(x), stall) for x in lines if x == x]
    return max(*known, *required, *(p.torque for p in panel.points), 1e-6) if known else max(stall, *required)
