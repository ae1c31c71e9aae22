"""Limits of a machine's common supply over samples of all uncertain figures of its file and of its drives' parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.tolerances import Class
from drivesizer.errors import FieldError
from drivesizer.files.yaml_source import Path_
from drivesizer.load_cases.platform import WheelLoad
from drivesizer.machine.common_bus import AxisPower
from drivesizer.machine.common_supply import OF_THE_SUPPLY, common_supply, place_of, supplied_axes, toleranced
from drivesizer.machine.problem import quickest_winding, with_spec
from drivesizer.results.check import Check, FigureSpread, declared_figure
from drivesizer.results.check_columns import at_least
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.machine import AxisSizing, MachinePower
from drivesizer.results.problem import LoadCase, Problem
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.probabilities import Over, over_samples, quantiles, reduced
from drivesizer.search.uncertainty.sampled_drive import deviating_drive
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.search.uncertainty.uncertain_figures import (
    Assumption,
    applied,
    case_paths,
    holding_of_a_set,
    of_a_class,
    of_the_file,
)
from drivesizer.spec.machine import MachineSpec
from drivesizer.spec.robot import RobotSpec

# -- Uncertain figures of a machine: those of its file and of the parts of its drives, and the machine of one sample.
#
# A figure at the top of the file is the same in all axes and in the supply. Drives of all axes deviate alike in the
# figures of their parts, as those of one axis do: so a sum of them is on the safe side.


Values = NDArray[np.float64]
_PLANNED = ("load", "motion", "platform")  # sections that shape the path of a platform, which stays as it was planned


class _UncertainAxis(NamedTuple):
    """An axis with the numbers of its uncertain figures."""

    power: AxisPower
    paths: dict[int, dict[Path_, int]]  # by load case of the axis
    start: int | None
    classes: dict[Class, int]
    quickest: float  # s, winding

    def at(self, values: Values, assumptions: Sequence[Assumption]) -> AxisPower:
        """The axis with the figures of a sample."""
        problem = self.power.problem
        cases = tuple(self._case(case, values, assumptions) for case in problem.cases)
        factors = {tolerance: float(values[k]) for tolerance, k in self.classes.items()}
        start = self.power.start if self.start is None else float(values[self.start])
        drive = deviating_drive(self.power.drive, cases[0].spec, factors)
        return self.power._replace(problem=replace(problem, cases=cases), drive=drive, start=start)

    def _case(self, case: LoadCase, values: Values, assumptions: Sequence[Assumption]) -> LoadCase:
        moves = _moves(self.paths[case.number], values, assumptions)
        return with_spec(case, applied(case.spec, moves), self.quickest) if moves else case


class UncertainMachine(NamedTuple):
    """A machine with its uncertain figures."""

    assumptions: tuple[Assumption, ...]
    shared: RobotSpec
    of_shared: dict[Path_, int]
    axes: tuple[_UncertainAxis, ...]

    def at(self, values: Values) -> tuple[RobotSpec, list[AxisPower]]:
        """Shared sections and axes with the figures of a sample."""
        moves = _moves(self.of_shared, values, self.assumptions)

        def varied(spec: RobotSpec) -> RobotSpec:  # a load case with a figure of its own keeps that
            own = {path: x for path, x in moves.items() if _figure(spec, path) == _figure(self.shared, path)}
            return applied(spec, own)

        return self.shared.changed(varied), [axis.at(values, self.assumptions) for axis in self.axes]


def _moves(paths: Mapping[Path_, int], values: Values, assumptions: Sequence[Assumption]) -> dict[Path_, float]:
    """Differences from nominal figures, by place."""
    return {path: float(values[k]) - assumptions[k].nominal for path, k in paths.items()}


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
    assumptions: dict[Path_ | Class, Assumption] = {}

    def number(key: Path_ | Class, assumption: Assumption) -> int:
        assumptions.setdefault(key, assumption)
        return list(assumptions).index(key)

    def of_file(place: Path_) -> int:
        return number(place, of_the_file(figures[place]))

    uncertain_axes = []
    for axis in axes:
        spec = axis.problem.machine
        starts = ("axes", axis.name, "start")
        uncertain_axes.append(_UncertainAxis(
            power=axis,
            paths={n: {path: of_file(place_of(figures, axis.name, spec.toleranced[k].path))
                       for k, path in case_paths(spec, n - 1 if n else None).items()
                       if not (isinstance(axis.problem.spec.load, WheelLoad) and path[0] in _PLANNED)}
                   for n in range(len(spec.load_cases))},
            start=of_file(starts) if starts in figures else None,
            classes={own: number(own, of_a_class(own)) for own in _classes(axis.problem, axis.drive)},
            quickest=quickest_winding(axis.problem.catalog),
        ))  # fmt: skip
    of_shared = {
        path: of_file(path) for path in figures if path[0] in OF_THE_SUPPLY and _figure(shared, path) is not None
    }
    return UncertainMachine(tuple(assumptions.values()), shared, of_shared, tuple(uncertain_axes))


def _classes(problem: Problem, drive: DriveParts) -> Iterator[Class]:
    """The tolerance classes of the parts of a drive that have a distribution."""
    parts: dict[str, Any] = {"motors": drive.motor, "gearheads": drive.gearhead, "controllers": drive.controller}
    rows = (problem.catalog.table(name).rows.get(part.part, -1) if part else -1 for name, part in parts.items())
    tolerances = holding_of_a_set(problem.catalog, problem.machine.tolerances.classes, *rows)
    return (own for own in tolerances if own.factor)


# -- Limits of a machine's common supply over samples of all uncertain figures: probability that none is exceeded.
#
# Each sample is the whole machine: load cycles, drives and their courses of power are computed anew and summed up as
# at nominal figures, with the drives and the brake resistor that were chosen there.


_MOST = 256  # samples, each of which takes as long as the nominal machine
_CYCLE = "machine_cycle"
_FIGURES = {"supply_peak": "peak", "supply_mean": "mean", "energy_left": "energy_left"}  # fields of the power
_NOMINAL = (
    "carried masses, brake resistor, power supply, the paths of platforms and the voltage that the current of all axes "
    "takes of a motor are those of nominal figures"
)


def over_tolerances(
    machine: MachineSpec, axes: Sequence[AxisSizing], power: MachinePower, how: Sampling
) -> MachinePower:
    """The power of a machine with the probability that it keeps the limits of its supply, over uncertain figures."""
    supplied = supplied_axes(machine, axes)
    if supplied is None or power.unknown:
        note = "limits of the supply are judged at nominal figures: power over tolerances is unknown"
        return replace(power, assumptions=(*power.assumptions, note))
    shared, catalog, on_it = supplied
    uncertain = uncertain_machine(machine, _as_chosen(shared, power), on_it)
    samples = sample(uncertain.assumptions, min(how.samples, _MOST), how.seed)
    outcomes = [_sample_checks(machine, catalog, *uncertain.at(values)) for values in samples]
    names = dict.fromkeys([check.name for check in power.checks] + [name for checks, _ in outcomes for name in checks])
    over: dict[str, Over] = {name: over_samples([checks.get(name) for checks, _ in outcomes]) for name in names}
    spreads = []
    for name in _FIGURES:
        low, middle, high = quantiles(np.array([figures[name] for _, figures in outcomes]))
        title, kind, unit = declared_figure(name)
        spreads.append(FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high))
    titles = {name: CHECKS["budget"][name].title for name in names}
    reliability = replace(reduced(over, titles).reliability, figures=tuple(spreads))
    note = f"over tolerances: {len(samples)} samples of the machine; drives of all axes deviate alike; {_NOMINAL}"
    checks = power.checks
    if how.confidence is not None:  # required: its margin is none of the load
        required = at_least("supply_confidence", how.confidence, reliability.probability, by_choice=True)
        checks = (*checks, required.at((), "budget"))
    return replace(power, reliability=reliability, checks=checks, assumptions=(*power.assumptions, note))


def _as_chosen(shared: RobotSpec, power: MachinePower) -> RobotSpec:
    """The shared sections with the brake resistor that was chosen; without one where none is needed."""
    section, resistor = shared.brake_resistor, power.braking.resistor if power.braking else None
    if section is None or section.resistance is not None:
        return shared
    if resistor is not None:
        section = section.model_copy(update={"family": None, "part": [resistor.part]})
        section._may_be_none = False
    elif any(check.name == "resistor_available" for check in power.checks):
        return shared
    brake_resistor = section if resistor is not None else None
    return shared.changed(lambda spec: spec.model_copy(update={"brake_resistor": brake_resistor}))


def _sample_checks(
    machine: MachineSpec, catalog: Catalog, shared: RobotSpec, axes: Sequence[AxisPower]
) -> tuple[dict[str, Check], dict[str, float]]:
    """Checks and figures of a sample by name; a motion that is longer than the machine's cycle fails."""
    try:
        power = common_supply(shared, catalog, axes, synchronised=machine.synchronised, cycle_time=machine.cycle_time)
    except FieldError:
        late = at_least(_CYCLE, 1.0, 0.0).at((), "budget")
        return {_CYCLE: late}, dict.fromkeys(_FIGURES, float("nan"))
    checks = {check.name: check for check in power.checks if not check.advice}
    return checks, {name: getattr(power, field) for name, field in _FIGURES.items()}
