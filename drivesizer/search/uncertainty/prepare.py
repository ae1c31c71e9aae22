"""Preparation of samples: each load case with columns in place of figures, and the load cycles of all samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import Path_
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform_wheels import cycles_of as wheels_of
from drivesizer.load_cases.platform_wheels import dynamics_of, trajectory_of
from drivesizer.load_cases.wheel import WheelLoad, wheel_load
from drivesizer.physics.cycle_at_gearhead import at_gearhead
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.problem import Problem
from drivesizer.search.uncertainty.counted_figures import enters_checks
from drivesizer.search.uncertainty.sampled_battery import Feeding, feeding
from drivesizer.search.uncertainty.sampled_cycle import AtSamples
from drivesizer.search.uncertainty.sampled_load_cycles import Cycles, cycles_of
from drivesizer.search.uncertainty.sampled_parts import Block
from drivesizer.search.uncertainty.sampling import first_of_each
from drivesizer.search.uncertainty.uncertain_figures import Assumption, applied, case_paths
from drivesizer.spec.robot import RobotSpec

__all__ = ["Prepared", "blocks", "prepared"]

Array = NDArray[np.float64]
_CELLS = 400_000  # segments times samples of a block
_ROWS = 16_384  # samples of a block, at most


class _Case(NamedTuple):
    """One load case, or one wheel of a platform in it."""

    machine: int  # which of the load cases of the whole machine
    spec: RobotSpec  # as it is sized
    paths: dict[int, Path_]  # of the assumptions that count in it, by number
    cycles: Cycles  # of each sample, or one for all


class Prepared(NamedTuple):
    """The samples, which all drives have in common."""

    problem: Problem
    given: tuple[Assumption, ...]
    values: Array  # (samples, assumptions); fewer than were drawn where load cycles are long
    cases: tuple[_Case, ...]

    @property
    def spec(self) -> RobotSpec:
        """The machine in its first load case."""
        return self.problem.spec

    @property
    def fitted(self) -> float:
        """Largest error of the load cycles, of their largest value."""
        return max(case.cycles.fitted for case in self.cases)

    def on(self, rows: NDArray[np.int64]) -> Prepared:
        """Some of the samples."""
        one_for_all = [case.cycles.size == 1 for case in self.cases]
        cases = [
            case if alike else case._replace(cycles=_some(case.cycles, rows))
            for case, alike in zip(self.cases, one_for_all, strict=True)
        ]
        return self._replace(values=self.values[rows], cases=tuple(cases))

    @property
    def cells(self) -> int:
        """Segments times samples, of all load cases."""
        return sum(len(case.cycles.duration) * len(self.values) for case in self.cases)


def prepared(problem: Problem, given: Sequence[Assumption], values: Array, *, every: bool = False) -> Prepared:
    """Samples of a machine, with their load cycles."""
    cases = []
    for machine, case, paths, make in _cases(problem, given):
        own = sorted(paths)
        nominal = np.array([given[k].nominal for k in own])
        cycles = cycles_of(partial(_made, make, own), nominal, values[:, own], every=every)
        cases.append(_Case(machine, case, paths, cycles))
    fewest = min((case.cycles.size for case in cases if case.cycles.size > 1), default=len(values))
    if fewest == len(values):
        return Prepared(problem, tuple(given), values, tuple(cases))
    rows = first_of_each(fewest, len(values))
    return Prepared(problem, tuple(given), values[rows], tuple(_fewer(case, fewest) for case in cases))


def _fewer(case: _Case, samples: int) -> _Case:
    """A case with as many samples."""
    size = case.cycles.size
    return case if size in (1, samples) else case._replace(cycles=_some(case.cycles, first_of_each(samples, size)))


Make = Callable[[Mapping[int, float]], LoadCycle]  # the load cycle at values of assumptions, by their number
Wheels = Callable[[tuple[float, ...]], tuple[LoadCycle, ...]]  # those of all wheels, at values in the same order


def _made(make: Make, own: Sequence[int], values: Array) -> LoadCycle:
    """A load cycle at values of the assumptions that count in it."""
    return make(dict(zip(own, values.tolist(), strict=True)))


def _cases(problem: Problem, given: Sequence[Assumption]) -> Iterator[tuple[int, RobotSpec, dict[int, Path_], Make]]:
    """Every load case, of a platform on its path every driven wheel, since deviations need not be the same for all.

    Which case of the machine it is, the spec as it is sized, the assumptions that count, and what makes the cycle.
    """
    cases, whole = problem.cases, problem.machine
    for machine, numbers in enumerate(problem.machine_cases):
        paths = case_paths(whole, machine - 1 if machine else None)
        case = cases[numbers[0]].spec
        if isinstance(case.load, WheelLoad):
            every = _every_wheel(whole.load_cases[machine][1], paths, given)
            for number in numbers:
                for one in _one_by_one(cases[number].spec):
                    yield machine, one, paths, partial(_of_wheel, every, one)
        else:
            yield machine, case, paths, partial(_of_case, case, paths, given)


def _of_case(
    case: RobotSpec, paths: dict[int, Path_], given: Sequence[Assumption], at: Mapping[int, float]
) -> LoadCycle:
    return load_cycle(applied(case, _moves(paths, at, given)))


def _one_by_one(case: RobotSpec) -> Iterator[RobotSpec]:
    """The wheels of a load case that are alike at nominal figures."""
    load = case.load
    assert isinstance(load, WheelLoad)
    for number in load.numbers:
        alone = wheel_load(load.cycle, load.motors, [number], load.distance, load.of, load.rolling_torque)
        yield case.model_copy(update={"load": alone})


def _of_wheel(every: Wheels, case: RobotSpec, at: Mapping[int, float]) -> LoadCycle:
    """The load cycle of one wheel, its belt's inertia included."""
    load = case.load
    assert isinstance(load, WheelLoad)
    cycle = every(tuple(at[k] for k in sorted(at)))[load.numbers[0]]
    moved = wheel_load(cycle, load.motors, load.numbers, load.distance, load.of, load.rolling_torque)
    return load_cycle(case.model_copy(update={"load": moved}))


def _every_wheel(part: RobotSpec, paths: dict[int, Path_], given: Sequence[Assumption]) -> Wheels:
    """The load cycles of all wheels at values of the assumptions that count, in their order; each computed once."""
    moving = any(path[0] == "motion" or path[:2] == ("platform", "limits") for path in paths.values())
    nominal = trajectory_of(part)

    @cache
    def every(values: tuple[float, ...]) -> tuple[LoadCycle, ...]:
        moved = applied(part, _moves(paths, dict(zip(sorted(paths), values, strict=True)), given))
        trajectory = trajectory_of(moved) if moving else nominal
        assert trajectory is not None
        return wheels_of(moved, dynamics_of(moved), trajectory)

    return every


def _moves(paths: Mapping[int, Path_], values: Mapping[int, float], given: Sequence[Assumption]) -> dict[Path_, float]:
    """Differences from nominal figures, by their place."""
    moved = {paths[k]: value - given[k].nominal for k, value in values.items() if k in paths}
    return {path: difference for path, difference in moved.items() if difference}


# --- blocks


def blocks(one: Prepared, catalog: Catalog, belts: Sequence[float]) -> Iterator[Block]:
    """The samples in blocks, ready for drives with any of some belt ratios."""
    longest = max(len(case.cycles.duration) for case in one.cases)
    size = int(np.clip(_CELLS // longest, 64, _ROWS))
    for first in range(0, len(one.values), size):
        rows = np.arange(first, min(first + size, len(one.values)))
        yield _block(one, catalog, rows, belts)


def _block(one: Prepared, catalog: Catalog, rows: NDArray[np.int64], belts: Sequence[float]) -> Block:
    factors = {
        given.catalogue: np.ascontiguousarray(one.values[rows, k])
        for k, given in enumerate(one.given)
        if given.catalogue
    }
    specs, ats = [], []
    for case in one.cases:
        spec = _with_columns(case, one, rows)
        cycles = case.cycles if case.cycles.size == 1 else _some(case.cycles, rows)
        base = at_gearhead(cycles, spec.belt_efficiency)
        specs.append(spec)
        ats.append({belt: AtSamples(base, belt) for belt in belts})
    return Block(
        len(rows),
        tuple(specs),
        tuple(ats),
        tuple(_feeds(one, catalog, specs)),
        factors,
        one.spec.tolerances.given,
        {belt: one.problem.belt_drive(belt) for belt in belts},
        {},
    )


def _feeds(one: Prepared, catalog: Catalog, specs: Sequence[Any]) -> Iterator[tuple[Feeding, tuple[int, ...]]]:
    """The battery of each load case of the machine, and the numbers of the cases that draw from it together."""
    for machine in sorted({case.machine for case in one.cases}):
        numbers = tuple(n for n, case in enumerate(one.cases) if case.machine == machine)
        rated = one.cases[numbers[0]].spec.battery
        if rated:
            yield feeding(specs[numbers[0]], rated, catalog), numbers


def _some(cycles: Cycles, rows: NDArray[np.int64]) -> Cycles:
    """Some of the cycles."""
    own = tuple(one._replace(demand=one.demand[rows], limit=one.limit[rows]) for one in cycles.own)
    return cycles._replace(
        duration=cycles.duration[..., rows], speed=cycles.speed[..., rows],
        acceleration=cycles.acceleration[..., rows], torque=cycles.torque[..., rows], inertia=cycles.inertia[rows],
        radius=cycles.radius[rows], own=own, held=cycles.held if np.ndim(cycles.held) == 0 else cycles.held[rows],
    )  # fmt: skip


def _with_columns(case: _Case, one: Prepared, rows: NDArray[np.int64]) -> RobotSpec:
    """A load case with columns in place of the figures that enter checks."""
    columns = {k: path for k, path in case.paths.items() if enters_checks(path)}
    return applied(case.spec, {path: one.values[rows, k] - one.given[k].nominal for k, path in columns.items()})
