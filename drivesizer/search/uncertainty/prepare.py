"""Preparation of samples: load cases with columns in place of figures, and the load cycles of all samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from itertools import pairwise, product
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import Path_
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import WheelLoad, dynamics_of, trajectory_of, wheel_load
from drivesizer.load_cases.platform import cycles_of as wheels_of
from drivesizer.physics.cycle_at_gearhead import at_gearhead
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit
from drivesizer.results.problem import Problem
from drivesizer.search.uncertainty.sampled_battery import AtSamples, Feeding, feeding
from drivesizer.search.uncertainty.sampled_parts import Block
from drivesizer.search.uncertainty.sampling import REPLICATES, first_of_each, sobol
from drivesizer.search.uncertainty.uncertain_figures import Assumption, applied, case_paths, enters_checks
from drivesizer.spec.robot import RobotSpec

__all__ = ["Prepared", "blocks", "cycles_of", "prepared"]


# -- Load cycles of many samples at once, fitted to the load cycles of a few.
#
# Few figures shape a load cycle, and they do so smoothly: torque is linear in a mass, a time of acceleration enters
# by its inverse, a slope by its sine. So durations, speeds, accelerations and torques of a cycle's segments are
# fitted by polynomials of the figures: Chebyshev products, of as high a degree in each figure as that figure alone
# needs. The fit is held against cycles that it did not see, corners of the range among them, and counts where it is
# off by no more than 10⁻⁶ of the largest value.
#
# Where it does not, because a cycle's segments are others in another corner, or there are too many of them, the
# cycles of the first samples are computed each by itself: then there are fewer samples. Each by itself, the 10 000
# samples of ``benchmarks/tolerances.py`` take 3.9 s of processor time more, which is six sizings.


Array = NDArray[np.float64]
MakeCycles = Callable[[Array], LoadCycle]  # the cycle at values of the figures that shape it

_ACCURACY = 1e-6  # of the largest value
_HIGHEST = 8  # degree in one figure
_WEIGHTS = (1.0, 1.5, 2.0, 3.0, 5.0, np.inf)  # of a product: sum of its degrees, each as a share of the highest
_TERMS = 300  # of a polynomial at most
_ENOUGH = 10  # power of two of the points that are drawn for it
_CELLS = 400_000  # segments times samples of a fit, at most
_HELD_AGAINST = 24  # cycles that are not fitted
_EACH = 1024  # cycles that are computed each by itself, at most
_FEWEST = 32
_LONGEST = 1_000_000  # segments of all of these, at most
_FEW = 256  # samples, each of which has its cycle computed


class Cycles(NamedTuple):
    """Load cycles side by side: durations (segments, cycles), the others (segments, 2, cycles)."""

    duration: Array  # s; 0 where a cycle has fewer segments
    speed: Array  # rad/s
    acceleration: Array  # rad/s^2
    torque: Array  # N*m
    inertia: Array  # kg*m^2, of each cycle
    radius: Array  # m, way of the load per angle of the shaft
    own: tuple[OwnLimit, ...]  # the load's own limits: columns
    like: LoadCycle  # the nominal one
    fitted: float  # largest error of the fit, of the largest value; 0: each computed
    computed: int  # number of cycles that were computed for it
    held: Any = nan  # N*m, largest torque that holds each at rest on its path

    @property
    def size(self) -> int:
        """Number of cycles."""
        return int(self.duration.shape[1])

    @property
    def total(self) -> Array:
        """Length of each cycle [s]."""
        found: Array = self.duration.sum(axis=0)
        return found

    @property
    def travel(self) -> Array:
        """Travel of the load over each cycle, there and back [m]."""
        found: Array = self.radius * (np.abs(self.speed).mean(axis=1) * self.duration).sum(axis=0)
        return found


def cycles_of(make: MakeCycles, nominal: Array, values: Array, *, every: bool = False) -> Cycles:
    """The load cycles of samples."""
    like = make(nominal)
    if every or len(values) <= _FEW:
        return _side_by_side([make(row) for row in values], like)
    low, high = values.min(axis=0, initial=np.inf), values.max(axis=0, initial=-np.inf)
    shaping = [k for k in range(len(nominal)) if _shapes(make, like, nominal, k, (low[k], high[k]))]
    if not shaping:
        return _side_by_side([like], like)
    small = len(like.duration) * len(values) <= _CELLS
    found = _fitted(make, like, nominal, values, shaping) if small else None
    return found or _each(make, like, values)


def _shapes(make: MakeCycles, like: LoadCycle, nominal: Array, k: int, ends: tuple[float, float]) -> bool:
    """Whether a figure changes the cycle."""
    for end in ends:
        moved = nominal.copy()
        moved[k] = end
        found = make(moved)
        if len(found.duration) != len(like.duration) or not np.array_equal(_flat(found), _flat(like), equal_nan=True):
            return True
    return False


def _flat(cycle: LoadCycle) -> Array:
    """All figures of a cycle in a row."""
    columns = (cycle.duration, cycle.speed, cycle.acceleration, cycle.torque)
    own = [_of_own(one) for one in cycle.own]
    single = [cycle.inertia, cycle.radius, *(figure for two in own for figure in two), *_held(cycle)]
    return np.concatenate([*(c.reshape(-1) for c in columns), np.array(single)])


def _held(cycle: LoadCycle) -> list[float]:
    """The torque that holds it, where that is looked at."""
    return [] if isnan(cycle.held) else [cycle.held]


def _of_own(one: OwnLimit) -> tuple[float, float]:
    """Of a load's own limit what is smooth in its figures: of a largest force that is the inertia in it."""
    return (one.demand if np.isnan(one.turning) else one.turning), one.limit


def _structure(cycle: LoadCycle) -> tuple[int, bytes]:
    """Structure that a fit takes to be the same everywhere: number of segments, standstills and directions."""
    return len(cycle.duration), np.sign(cycle.speed.mean(axis=1)).tobytes()


def _each(make: MakeCycles, like: LoadCycle, values: Array) -> Cycles:
    """The cycles of the first samples of each replicate, each computed by itself."""
    most = int(np.clip(_LONGEST // len(like.duration), _FEWEST, _EACH)) // REPLICATES
    rows = first_of_each(min(len(values), REPLICATES * 2 ** int(np.log2(most))), len(values))
    return _side_by_side([make(values[row]) for row in rows], like)


def _side_by_side(several: Sequence[LoadCycle], like: LoadCycle) -> Cycles:
    """Cycles as columns, the shorter ones filled up with segments that take no time."""
    longest = max(len(cycle.duration) for cycle in several)

    def column(name: str) -> Array:
        parts = []
        for cycle in several:
            values = getattr(cycle, name)
            last = np.zeros_like(values[-1:]) if name == "duration" else np.repeat(values[-1:, 1:], 2, axis=1)
            parts.append(np.concatenate([values, np.repeat(last, longest - len(values), axis=0)]))
        return np.ascontiguousarray(np.moveaxis(np.array(parts), 0, -1))

    own = tuple(
        one._replace(
            demand=np.array([c.own[n].demand for c in several]), limit=np.array([c.own[n].limit for c in several])
        )
        for n, one in enumerate(like.own)
    )
    inertia, radius = (np.array([getattr(cycle, name) for cycle in several]) for name in ("inertia", "radius"))
    return Cycles(
        column("duration"), column("speed"), column("acceleration"), column("torque"), inertia, radius, own, like, 0.0,
        len(several), np.array([cycle.held for cycle in several]),
    )  # fmt: skip


# --- the fit


def _fitted(make: MakeCycles, like: LoadCycle, nominal: Array, values: Array, shaping: list[int]) -> Cycles | None:
    """Polynomials of the figures, where they are good enough."""
    low, high = values[:, shaping].min(axis=0), values[:, shaping].max(axis=0)

    def at(points: Array) -> list[LoadCycle]:
        """The cycles at points of the cube from -1 to 1."""
        rows = np.tile(nominal, (len(points), 1))
        rows[:, shaping] = low + (points + 1.0) / 2.0 * (high - low)
        return [make(row) for row in rows]

    against = _points(len(shaping), _HELD_AGAINST, 1)
    held = at(against)
    if any(_structure(cycle) != _structure(like) for cycle in held):
        return None
    wanted = np.array([_flat(cycle) for cycle in held])
    size = _sizes(like, wanted)
    spread = 2.0 * (values[:, shaping] - low) / (high - low) - 1.0
    degrees = _degrees(at, len(shaping), size, like)
    if degrees is None:
        return None
    nodes, cycles = np.zeros((0, len(shaping))), np.zeros((0, wanted.shape[1]))
    for weight in _WEIGHTS:
        powers = _powers(degrees, weight)
        if len(powers) > _TERMS:
            return None
        fresh = _points(len(shaping), 2 * len(powers) + 4, 2)[len(nodes) :]
        found = at(fresh)
        if any(_structure(cycle) != _structure(like) for cycle in found):
            return None
        nodes = np.concatenate([nodes, fresh])
        cycles = np.concatenate([cycles, np.array([*map(_flat, found)]).reshape(-1, wanted.shape[1])])
        factors = np.linalg.lstsq(_terms(nodes, powers), cycles, rcond=None)[0]
        error = float((np.abs(_terms(against, powers) @ factors - wanted).max(axis=0) / size).max())
        if error <= _ACCURACY:
            return _unfolded(factors.T @ _terms(spread, powers).T, like, error, len(nodes) + len(against))
    return None


def _degrees(make: Callable[[Array], list[LoadCycle]], figures: int, size: Array, like: LoadCycle) -> list[int] | None:
    """The degree in which each figure alone enters; None where one is not smooth enough."""
    points = np.cos(np.pi * (np.arange(_HIGHEST + 2) + 0.5) / (_HIGHEST + 2))
    found = []
    for k in range(figures):
        rows = np.zeros((len(points), figures))
        rows[:, k] = points
        cycles = make(rows)
        if any(_structure(cycle) != _structure(like) for cycle in cycles):
            return None
        terms = np.polynomial.chebyshev.chebfit(points, np.array([*map(_flat, cycles)]), _HIGHEST + 1)
        heavy = (np.abs(terms) > _ACCURACY / 10 * size).any(axis=1)
        found.append(int(np.flatnonzero(heavy).max(initial=0)))
        if found[-1] > _HIGHEST:
            return None
    return found


def _sizes(like: LoadCycle, wanted: Array) -> Array:
    """For each figure of a cycle the largest value that its like has: of durations, speeds and so on."""
    n = len(like.duration)
    parts = [n, 2 * n, 2 * n, 2 * n, *[1] * (2 + 2 * len(like.own) + len(_held(like)))]
    edges = np.concatenate([[0], np.cumsum(parts)])
    largest = [np.abs(wanted[:, a:b]).max() for a, b in pairwise(edges)]
    return np.repeat(np.where(np.array(largest) > 0.0, largest, 1.0), parts)


def _points(figures: int, count: int, seed: int) -> Array:
    """Points of the cube from -1 to 1, denser at its sides; the first of those that are held against are corners."""
    found: Array = -np.cos(np.pi * sobol(figures, _ENOUGH, [(seed,)])[:count])
    if seed == 1:
        corners = list(product((-1.0, 1.0), repeat=figures)) if figures <= 3 else []
        corners += [(sign,) * figures for sign in (-1.0, 1.0)]
        found[: len(corners)] = corners
    return found


def _powers(degrees: Sequence[int], weight: float) -> NDArray[np.int64]:
    """The degrees of all products up to a weight."""
    every: list[tuple[int, ...]] = [()]
    for k, most in enumerate(degrees):
        every = [
            one
            for before in every
            for one in ((*before, n) for n in range(most + 1))
            if sum(n / max(highest, 1) for n, highest in zip(one, degrees[: k + 1], strict=True)) <= weight + 1e-9
        ]
    return np.array(every, dtype=np.int64)


def _terms(points: Array, powers: NDArray[np.int64]) -> Array:
    """The Chebyshev products at points: (points, terms)."""
    most = int(powers.max())
    single = [np.ones_like(points), points]
    for _ in range(max(most - 1, 0)):
        single.append(2.0 * points * single[-1] - single[-2])
    table = np.array(single)  # (degree, points, figures)
    found = np.ones((len(points), len(powers)))
    for k in range(points.shape[1]):
        found *= table[powers[:, k], :, k].T
    return found


def _unfolded(flat: Array, like: LoadCycle, error: float, computed: int) -> Cycles:
    """Columns of cycles out of all their figures: (figures, samples)."""
    n = len(like.duration)
    resting = (like.speed == 0.0).all(axis=1)
    duration, rest = flat[:n], flat[n:]
    speed, acceleration, torque = (rest[k * 2 * n : (k + 1) * 2 * n].reshape(n, 2, -1) for k in range(3))
    speed[like.speed == 0.0] = 0.0  # not what rounding makes of it
    level = like.speed[:, 0] == like.speed[:, 1]
    speed[level, 1] = speed[level, 0]
    acceleration[resting] = 0.0
    tail = rest[6 * n :]
    own = []
    for k, one in enumerate(like.own):
        demand, limit = tail[2 + 2 * k], tail[3 + 2 * k]
        if not np.isnan(one.turning):
            demand = np.abs(torque - demand * acceleration).max(axis=(0, 1)) / tail[1]
        own.append(one._replace(demand=demand, limit=limit))
    holding = tail[-1] if _held(like) else nan
    return Cycles(duration, speed, acceleration, torque, tail[0], tail[1], tuple(own), like, error, computed, holding)


# -- Preparation of samples: each load case with columns in place of figures, and the load cycles of all samples.


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
