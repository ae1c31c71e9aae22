"""From a spec to the sizing problem: wheels of a platform as load cases, every load cycle, parts of the supply."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.view import with_current_limit, with_mounting, with_own_brake
from drivesizer.load_cases.of_machine import cycle_of_shift, load_cases
from drivesizer.machine.belts import belt_drives
from drivesizer.machine.braking import with_parts_of_supply
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.thermal import with_plate
from drivesizer.results.problem import SHIFT, LoadCase, Problem
from drivesizer.spec.robot import RobotSpec


def problem(machine: RobotSpec, catalog: Catalog) -> Problem:
    """The sizing problem of a machine."""
    mounting = machine.mounting
    if machine.brake:
        catalog = with_own_brake(catalog, machine.brake.figures)
    if mounting is not None and mounting.changes_housing:  # nominal, and at both ends of the band
        if mounting.plate_resistance is not None:
            nominal = favourable = unfavourable = partial(with_plate, plate=mounting.plate_resistance)
        else:
            nominal, favourable, unfavourable = (partial(np.multiply, share) for share in mounting.share)
        catalog = with_mounting(catalog, (nominal, favourable, unfavourable))
    if machine.power_stage.motor_current is not None:
        catalog = with_current_limit(catalog, machine.power_stage.motor_current)
    machine = with_parts_of_supply(machine, catalog)
    belts, quickest = belt_drives(machine, catalog), quickest_winding(catalog)
    cases = tuple(
        load_case(SHIFT if machine.alternating and not number else name, number, spec, quickest)
        for number, name, spec in load_cases(machine)
        if name not in machine.alternating  # all of them are in the first
    )
    return Problem(machine=machine, catalog=catalog, cases=cases, belts=belts)


def load_case(name: str, number: int, spec: RobotSpec, quickest: float) -> LoadCase:
    """A load case with its cycle; where a brake closes at rest, no torque of the motor holds the load there."""
    cycle = cycle_of_shift(spec)
    if spec.control.at_rest == "brake":
        rests = np.logical_not(cycle.speed.any(axis=1) | cycle.acceleration.any(axis=1))
        cycle = replace(cycle, torque=np.where(rests[:, None], 0.0, cycle.torque))
        spec = spec.with_brake_released(float(cycle.duration[~rests].sum()) / cycle.total)
    at_belt = CycleAtBelt(cycle, spec.belt_efficiency, quickest)
    return LoadCase(name=name, number=number, spec=spec, at_belt=at_belt)


def quickest_winding(catalog: Catalog) -> float:
    """Shortest time constant of all windings of some catalogues [s]; infinite where none is known.

    Load cycles are divided as finely as that winding needs, so that all drives share one.
    """
    return catalog.once(
        "quickest winding", lambda: float(np.nanmin(catalog.motors["winding_time_constant"], initial=np.inf))
    )


def changed(problem: Problem, change: Callable[[RobotSpec], RobotSpec]) -> Problem:
    """The problem with one figure changed in the machine and in all load cases; cycles that depend on it made anew."""
    quickest = quickest_winding(problem.catalog)
    cases = tuple(with_spec(case, case.spec.changed(change), quickest) for case in problem.cases)
    return replace(problem, machine=problem.machine.changed(change), cases=cases)


def with_spec(case: LoadCase, spec: RobotSpec, quickest: float) -> LoadCase:
    """A load case with another spec, its cycle made anew where that depends on it."""
    # copies of a spec share the sections that they leave as they are
    same = all(
        getattr(spec, name) is getattr(case.spec, name) for name in ("load", "motion", "transmission", "platform")
    )
    if same and spec.environment.gravity is case.spec.environment.gravity:
        return replace(case, spec=spec)
    return load_case(case.name, case.number, spec, quickest)
