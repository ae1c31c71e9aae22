"""Uncertain figures of a machine: those of its file and of the parts of its drives, and the machine of one sample.

A figure at the top of the file is the same in all axes and in the supply. Drives of all axes deviate alike in the
figures of their parts, as those of one axis do: so a sum of them is on the safe side.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.tolerances.classes import Class
from drivesizer.files.yaml_source import Path_
from drivesizer.load_cases.wheel import WheelLoad
from drivesizer.machine.problem import quickest_winding, with_spec
from drivesizer.multi_axis.common_supply import AxisPower
from drivesizer.multi_axis.file_tolerances import OF_THE_SUPPLY, place_of, toleranced
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.uncertainty.class_of_part import holding
from drivesizer.search.uncertainty.deviating import deviating_drive
from drivesizer.search.uncertainty.uncertain_figures import (
    Assumption,
    applied,
    case_paths,
    of_a_class,
    of_the_file,
)
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.several_axes.machine import MachineSpec

__all__ = ["UncertainMachine", "uncertain_machine"]

Values = NDArray[np.float64]


class _UncertainAxis(NamedTuple):
    """An axis with the numbers of its uncertain figures."""

    power: AxisPower
    paths: dict[int, dict[Path_, int]]  # by load case of the axis
    start: int | None
    classes: dict[tuple[str, str], int]  # by part and figure
    quickest: float  # s, winding

    def at(self, values: Values, given: Sequence[Assumption]) -> AxisPower:
        """The axis with the figures of a sample."""
        problem = self.power.problem
        cases = tuple(self._case(case, values, given) for case in problem.cases)
        factors: dict[str, dict[str, float]] = {"motor": {}, "gearhead": {}, "controller": {}}
        for (part, figure), k in self.classes.items():
            factors[part][figure] = float(values[k])
        start = self.power.start if self.start is None else float(values[self.start])
        one = deviating_drive(self.power.one, cases[0].spec, factors)
        return self.power._replace(problem=replace(problem, cases=cases), one=one, start=start)

    def _case(self, case: LoadCase, values: Values, given: Sequence[Assumption]) -> LoadCase:
        moves = _moves(self.paths[case.number], values, given)
        return with_spec(case, applied(case.spec, moves), self.quickest) if moves else case


class UncertainMachine(NamedTuple):
    """A machine with its uncertain figures."""

    given: tuple[Assumption, ...]
    shared: RobotSpec
    of_shared: dict[Path_, int]
    axes: tuple[_UncertainAxis, ...]

    def at(self, values: Values) -> tuple[RobotSpec, list[AxisPower]]:
        """Shared sections and axes with the figures of a sample."""
        moves = _moves(self.of_shared, values, self.given)

        def moved(spec: RobotSpec) -> RobotSpec:  # a load case with a figure of its own keeps that
            own = {path: x for path, x in moves.items() if _figure(spec, path) == _figure(self.shared, path)}
            return applied(spec, own)

        return self.shared.changed(moved), [axis.at(values, self.given) for axis in self.axes]


def _moves(paths: Mapping[Path_, int], values: Values, given: Sequence[Assumption]) -> dict[Path_, float]:
    """Differences from nominal figures, by place."""
    return {path: float(values[k]) - given[k].nominal for path, k in paths.items()}


def _figure(spec: Any, path: Path_) -> Any:
    """A figure of a spec by its place; None where there is none."""
    for step in path:
        try:
            spec = spec[step] if isinstance(step, int) else getattr(spec, step)
        except (AttributeError, IndexError, TypeError):
            return None
    return spec


def uncertain_machine(machine: MachineSpec, shared: RobotSpec, axes: Sequence[AxisPower]) -> UncertainMachine:
    """The uncertain figures of a machine."""
    figures = toleranced(machine)
    given: dict[Path_ | Class, Assumption] = {}

    def number(key: Path_ | Class, made: Assumption) -> int:
        given.setdefault(key, made)
        return list(given).index(key)

    def of_file(place: Path_) -> int:
        return number(place, of_the_file(figures[place]))

    found = []
    for axis in axes:
        spec = axis.problem.machine
        starts = ("axes", axis.name, "start")
        found.append(_UncertainAxis(
            power=axis,
            paths={n: {path: of_file(place_of(figures, axis.name, spec.toleranced[k].path))
                       for k, path in case_paths(spec, n - 1 if n else None).items() if not _planned(axis, path)}
                   for n in range(len(spec.load_cases))},
            start=of_file(starts) if starts in figures else None,
            classes={(one.part, one.figure): number(one, of_a_class(one)) for one in _classes(axis.problem, axis.one)},
            quickest=quickest_winding(axis.problem.catalog),
        ))  # fmt: skip
    of_shared = {
        path: of_file(path) for path in figures if path[0] in OF_THE_SUPPLY and _figure(shared, path) is not None
    }
    return UncertainMachine(tuple(given.values()), shared, of_shared, tuple(found))


def _planned(axis: AxisPower, path: Path_) -> bool:
    """Whether a figure shapes the path of a platform, which stays as it was planned."""
    return isinstance(axis.problem.spec.load, WheelLoad) and path[0] in ("load", "motion", "platform")


def _classes(problem: Problem, one: DriveParts) -> Iterator[Class]:
    """The tolerance classes of the parts of a drive."""
    catalog: Catalog = problem.catalog
    rows = {
        "motor": catalog.motors.rows.get(one.motor.part, -1),
        "gearhead": catalog.gearheads.rows.get(one.gearhead.part, -1),
        "controller": catalog.controllers.rows.get(one.controller.part, -1) if one.controller else -1,
    }
    for part, row in rows.items():
        yield from (held for held in holding(catalog, problem.machine.tolerances.given, part, row) if held.factor)
