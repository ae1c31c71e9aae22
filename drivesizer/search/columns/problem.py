"""A spec with the load cycles of its cases, and what is judged in each: the worst case of every check."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.wheel import machine_cases
from drivesizer.physics.motor_demand import at_gearhead
from drivesizer.results.check_columns import CheckColumn, worst_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.search.columns.controllers import Usable, usable_controllers
from drivesizer.search.columns.encoders import Offered, offered_encoders
from drivesizer.spec.robot import RobotSpec

__all__ = ["Problem", "doubted", "each", "problem", "quickest_winding"]


class Problem(NamedTuple):
    """A spec with its load cycles at hand."""

    spec: RobotSpec
    catalog: Catalog
    names: tuple[str, ...]  # of the load cases
    specs: tuple[RobotSpec, ...]
    bases: tuple[Any, ...]  # their cycles, behind a belt of no ratio
    offered: Offered  # encoders of every motor
    usable: Usable  # controllers of every motor

    @property
    def machines(self) -> list[list[int]]:
        """Numbers of the load cases that act on one machine at the same time, such as those of its wheels."""
        loads = (case.load for case in self.specs)
        return [numbers for _, numbers in machine_cases(zip(self.names, loads, strict=True))]


def problem(spec: RobotSpec, catalog: Catalog) -> Problem:
    """The load cycle of every case, and the encoders and controllers of every motor."""
    names, specs = zip(*spec.load_cases, strict=True)
    quickest = quickest_winding(catalog)
    bases = tuple(at_gearhead(load_cycle(case), case.belt_efficiency, quickest) for case in specs)
    supply = min(s.supply.lowest for s in specs), max(s.supply.highest for s in specs)
    usable = usable_controllers(spec, catalog, supply)
    return Problem(spec, catalog, names, specs, bases, offered_encoders(spec, catalog), usable)


def quickest_winding(catalog: Catalog) -> float:
    """Shortest time constant of all windings of some catalogues [s]: as fine the cycles of all their sets are cut."""
    return float(np.nanmin(catalog.motors["winding_time_constant"], initial=np.inf))


def doubted(checks: list[CheckColumn], sure: NDArray[np.bool_]) -> list[CheckColumn]:
    """The checks, of which those that hang on an unknown inertia may fail but not pass."""
    if sure.all():
        return checks
    return [replace(c, passed=c.passed & sure) if CHECKS["physics"][c.name].on_inertia else c for c in checks]


def each(given: Problem, checks: Callable[[int], list[CheckColumn]]) -> list[CheckColumn]:
    """The worst case of each check, of the load cases that have it."""
    found: dict[str, list[tuple[int, CheckColumn]]] = {}
    for number in range(len(given.specs)):
        for check in checks(number):
            found.setdefault(check.name, []).append((number, check))
    return [worst_case(same) for same in found.values()]
