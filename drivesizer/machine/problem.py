"""From a spec to the sizing problem: wheels of a platform as load cases, every load cycle, belts out of catalogues."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.view.mounted import Housing, with_mounting
from drivesizer.catalog.view.own_brake import with_own_brake
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.shift import cycle_of_shift
from drivesizer.machine.pulleys import belt_drives
from drivesizer.machine.supply_unit import with_parts_of_supply
from drivesizer.physics.cycle_at_gearhead import at_gearhead
from drivesizer.physics.thermal import with_plate
from drivesizer.results.problem import SHIFT, LoadCase, Problem
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.mounting import Mounting

__all__ = ["changed", "problem", "quickest_winding", "with_cycle", "with_spec"]


def problem(machine: RobotSpec, catalog: Catalog) -> Problem:
    """The sizing problem of a machine."""
    if machine.brake:
        catalog = with_own_brake(catalog, machine.brake.figures)
    if machine.mounting is not None and machine.mounting.changes_housing:
        catalog = with_mounting(catalog, _housings(machine.mounting))
    machine = with_parts_of_supply(machine, catalog)
    belts, quickest = belt_drives(machine, catalog), quickest_winding(catalog)
    cases = tuple(
        _case(SHIFT if machine.alternating and not number else name, number, spec, quickest)
        for number, name, spec in load_cases(machine)
        if name not in machine.alternating  # all of them are in the first
    )
    return Problem(machine=machine, catalog=catalog, cases=cases, belts=belts)


def _housings(one: Mounting) -> tuple[Housing, Housing, Housing]:
    """Thermal resistance as mounted: nominal, and at the favourable and unfavourable end of its band."""
    if one.plate_resistance is not None:
        beside = partial(with_plate, plate=one.plate_resistance)
        return beside, beside, beside
    value, low, high = (partial(np.multiply, share) for share in one.share)
    return value, low, high


def _case(name: str, number: int, spec: RobotSpec, quickest: float) -> LoadCase:
    """A load case with its cycle; where a brake closes at rest, no torque of the motor holds the load there."""
    cycle = cycle_of_shift(spec)
    if spec.control.at_rest == "brake":
        rests = np.logical_not(cycle.speed.any(axis=1) | cycle.acceleration.any(axis=1))
        cycle = replace(cycle, torque=np.where(rests[:, None], 0.0, cycle.torque))
        spec = spec.with_brake_released(float(cycle.duration[~rests].sum()) / cycle.total)
    at_belt = at_gearhead(cycle, spec.belt_efficiency, quickest)
    return LoadCase(name=name, number=number, spec=spec, at_belt=at_belt)


def quickest_winding(catalog: Catalog) -> float:
    """Shortest time constant of all windings of some catalogues [s]; infinite where none is known.

    Load cycles are divided as finely as that winding needs, so that all drives share one.
    """
    shortest: float = catalog.once(
        "quickest winding", lambda: float(np.nanmin(catalog.motors["winding_time_constant"], initial=np.inf))
    )
    return shortest


def changed(problem: Problem, change: Callable[[RobotSpec], RobotSpec]) -> Problem:
    """The problem with one figure changed in the machine and in all load cases; cycles that depend on it made anew."""
    quickest = quickest_winding(problem.catalog)
    cases = tuple(with_spec(case, case.spec.changed(change), quickest) for case in problem.cases)
    return replace(problem, machine=problem.machine.changed(change), cases=cases)


def with_spec(case: LoadCase, spec: RobotSpec, quickest: float) -> LoadCase:
    """A load case with another spec, its cycle made anew where that depends on it."""
    kept = all(a is b for a, b in zip(_shaping(spec), _shaping(case.spec), strict=True))
    return replace(case, spec=spec) if kept else with_cycle(case, spec, quickest)


def with_cycle(case: LoadCase, spec: RobotSpec, quickest: float) -> LoadCase:
    """A load case with another spec, its cycle made anew."""
    return _case(case.name, case.number, spec, quickest)


def _shaping(spec: RobotSpec) -> tuple[Any, ...]:
    """All that a load cycle is made of; copies of a spec share the sections that they leave as they are."""
    return spec.load, spec.motion, spec.transmission, spec.platform, spec.environment.gravity
