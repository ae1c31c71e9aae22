"""Preparation of samples: load cycles of all of them, load cases with columns in place of figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import Path_
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import WheelLoad, cycles_of, dynamics_of, trajectory_of, wheel_load
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.problem import Problem
from drivesizer.search.uncertainty.sampled_battery import AtSamples, feeding
from drivesizer.search.uncertainty.sampled_drive import Block
from drivesizer.search.uncertainty.sampling import REPLICATES, first_of_each
from drivesizer.search.uncertainty.uncertain_figures import Assumption, applied, case_paths, enters_checks
from drivesizer.spec.motions import Cam
from drivesizer.spec.robot import RobotSpec

# -- Load cycles of all samples: figures of load, motion and stages go through their laws as columns.
#
# What no column of numbers goes through is computed sample by sample: a platform on its path, a curve that is smoothed.


Array = NDArray[np.float64]
_ROWS = 16_384  # samples of a block, at most
_CELLS = 400_000  # segments times samples of a block
_LONGEST = 2_000_000  # segments times samples, at most: of longer cycles there are fewer samples
_EACH, _LONGEST_EACH = 1024, 1_000_000  # cycles one by one, and their segments
_FEWEST = 32


class _Case(NamedTuple):
    """One load case, or one wheel of a platform in it."""

    machine: int  # which of the load cases of the whole machine
    spec: RobotSpec  # as it is sized
    paths: dict[int, Path_]  # of the assumptions that count in it, by number
    cycle: LoadCycle  # of each sample, or one for all


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
    def cells(self) -> int:
        """Segments times samples, of all load cases."""
        return sum(len(case.cycle.duration) * len(self.values) for case in self.cases)


def prepared(problem: Problem, given: Sequence[Assumption], values: Array, *, every: bool = False) -> Prepared:
    """Samples of a machine, with their load cycles."""
    whole, counting = problem.machine, []
    for machine in range(len(problem.machine_cases)):
        paths = case_paths(whole, machine - 1 if machine else None)
        counting.append({k: path for k, path in paths.items() if k < len(given)})
    most = len(values)
    for paths, numbers in zip(counting, problem.machine_cases, strict=True):
        case, shaping = problem.cases[numbers[0]], [path for path in paths.values() if _shapes(path)]
        if shaping and not every:
            longest = _LONGEST_EACH if _one_by_one(case.spec, shaping) else _LONGEST
            few = _EACH if longest == _LONGEST_EACH else most
            most = min(most, few, longest // len(case.cycle.duration))
    if most < len(values) > _FEWEST:
        each = 2 ** int(np.log2(max(most, _FEWEST) // REPLICATES))
        values = values[first_of_each(REPLICATES * each, len(values))]
    cases = [
        case
        for machine, (paths, numbers) in enumerate(zip(counting, problem.machine_cases, strict=True))
        for case in _cases(problem, machine, numbers, paths, given, values)
    ]
    return Prepared(problem, tuple(given), values, tuple(cases))


def _shapes(path: Path_) -> bool:
    """Whether a figure makes the load cycle another."""
    return path[0] in ("load", "motion", "transmission", "platform") or path == ("environment", "gravity")


def _one_by_one(case: RobotSpec, paths: Sequence[Path_]) -> bool:
    """Whether some of the figures are such that no column goes through their law."""
    of_a_curve = isinstance(case.motion, Cam) and any(path[0] == "motion" for path in paths)
    return isinstance(case.load, WheelLoad) or of_a_curve or ("load", "smoothing") in paths


def _cases(
    problem: Problem, machine: int, numbers: Sequence[int], paths: dict[int, Path_], given: Sequence[Assumption],
    values: Array,
) -> Iterator[_Case]:  # fmt: skip
    """A load case; of a platform on its path every driven wheel, since deviations need not be the same for all."""
    columns = {path: values[:, k] - given[k].nominal for k, path in paths.items() if _shapes(path)}
    case = problem.cases[numbers[0]].spec
    if isinstance(case.load, WheelLoad):
        cycles = _of_wheels(problem.machine.load_cases[machine][1], columns, len(values))
        stages = {path: column for path, column in columns.items() if path[0] == "transmission"}
        for one in (problem.cases[number].spec for number in numbers):
            for wheel, nominal in _wheels(one):
                load = nominal.load.model_copy(update={"cycle": cycles[wheel]})
                moved = applied(nominal.model_copy(update={"load": load}), stages)
                yield _Case(machine, nominal, paths, load_cycle(moved, sampled=True))
    elif _one_by_one(case, [*columns]):
        each = [load_cycle(applied(case, moved)) for moved in _each(columns, len(values))]
        yield _Case(machine, case, paths, side_by_side(each))
    else:
        yield _Case(machine, case, paths, load_cycle(applied(case, columns), sampled=True))


def _each(columns: Mapping[Path_, Array], samples: int) -> Iterator[dict[Path_, float]]:
    """Differences from nominal figures, by their place, sample by sample."""
    for row in range(samples):
        yield {path: float(column[row]) for path, column in columns.items() if column[row]}


def _wheels(case: RobotSpec) -> Iterator[tuple[int, Any]]:
    """The wheels of a load case that are alike at nominal figures."""
    load = case.load
    assert isinstance(load, WheelLoad)
    for number in load.numbers:
        alone = wheel_load(load.cycle, load.motors, [number], load.distance, load.of, load.rolling_torque)
        yield number, case.model_copy(update={"load": alone})


def _of_wheels(part: RobotSpec, columns: Mapping[Path_, Array], samples: int) -> list[LoadCycle]:
    """The load cycle of each driven wheel of a platform over the samples."""
    nominal = trajectory_of(part)
    planned = any(path[0] == "motion" or path[:2] == ("platform", "limits") for path in columns)
    every = []
    for moved in _each(columns, samples) if columns else [{}]:
        one = applied(part, moved)
        trajectory = trajectory_of(one) if planned else nominal
        assert trajectory is not None
        every.append(cycles_of(one, dynamics_of(one), trajectory))
    return [side_by_side(several) for several in zip(*every, strict=True)]


def side_by_side(several: Sequence[LoadCycle]) -> LoadCycle:
    """Cycles as columns of one, the shorter ones filled up with segments that take no time."""
    longest, like = max(len(cycle.duration) for cycle in several), several[0]

    def column(name: str) -> Array:
        parts = []
        for cycle in several:
            values = getattr(cycle, name)
            last = np.zeros_like(values[-1:]) if name == "duration" else np.repeat(values[-1:, 1:], 2, axis=1)
            parts.append(np.concatenate([values, np.repeat(last, longest - len(values), axis=0)]))
        return np.ascontiguousarray(np.moveaxis(np.array(parts), 0, -1))

    own = []
    for n, one in enumerate(like.own):
        demand, limit = (np.array([getattr(cycle.own[n], name) for cycle in several]) for name in ("demand", "limit"))
        own.append(one._replace(demand=demand, limit=limit))
    inertia, radius, held = (np.array([getattr(c, name) for c in several]) for name in ("inertia", "radius", "held"))
    duration, speed, acceleration, torque = map(column, ("duration", "speed", "acceleration", "torque"))
    return LoadCycle(like.name, duration, speed, acceleration, torque, inertia, tuple(own), radius, held)


# --- blocks


def blocks(one: Prepared, catalog: Catalog, belts: Sequence[float]) -> Iterator[Block]:
    """The samples in blocks, ready for drives with any of some belt ratios."""
    longest = max(len(case.cycle.duration) for case in one.cases)
    size = int(np.clip(_CELLS // longest, 64, _ROWS))
    for first in range(0, len(one.values), size):
        rows = np.arange(first, min(first + size, len(one.values)))
        specs, ats = [], []
        for case in one.cases:  # with columns in place of the figures that enter checks
            columns = {k: path for k, path in case.paths.items() if enters_checks(path)}
            moved = {path: one.values[rows, k] - one.given[k].nominal for k, path in columns.items()}
            spec = applied(case.spec, moved)
            base = CycleAtBelt(case.cycle.on(rows), spec.belt_efficiency)
            specs.append(spec)
            ats.append({belt: AtSamples(base, belt) for belt in belts})
        feeds = []
        for machine in sorted({case.machine for case in one.cases}):  # all cases that draw from one battery together
            numbers = tuple(n for n, case in enumerate(one.cases) if case.machine == machine)
            if (rated := one.cases[numbers[0]].spec.battery) is not None:
                feeds.append((feeding(specs[numbers[0]], rated, catalog), numbers))
        factors = {
            given.catalogue: np.ascontiguousarray(one.values[rows, k])
            for k, given in enumerate(one.given) if given.catalogue
        }  # fmt: skip
        known = {belt: one.problem.belt_drive(belt) for belt in belts}
        yield Block(len(rows), tuple(specs), tuple(ats), tuple(feeds), factors, one.spec.tolerances.given, known, {})
