"""Samples made ready: each load case with columns in place of figures, and the load cycles of all samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.loadcycle import LoadCycle
from drivesizer.loads import load_cycle
from drivesizer.platform_cases import on_wheels
from drivesizer.spec import RobotSpec
from drivesizer.tolerances.assumptions import Assumption, applied, case_paths
from drivesizer.tolerances.behind import AtSamples, at_samples
from drivesizer.tolerances.cycles import Cycles, cycles_of
from drivesizer.tolerances.evaluate import Block
from drivesizer.tolerances.lasting import feeding
from drivesizer.tolerances.sampling import REPLICATES
from drivesizer.wheel_load import WheelLoad
from drivesizer.yaml_source import Path_

__all__ = ["Prepared", "blocks", "prepared", "unused"]

Array = NDArray[np.float64]
_CELLS = 400_000  # segments times samples of a block
_ROWS = 16_384  # samples of a block, at most


class _Case(NamedTuple):
    name: str
    spec: RobotSpec  # as it is sized
    paths: dict[int, Path_]  # of the assumptions that count in it, by number
    cycles: Cycles
    rows: NDArray[np.int64]  # the cycle of each sample


class Prepared(NamedTuple):
    """All that the sets have in common."""

    spec: RobotSpec
    given: tuple[Assumption, ...]
    values: Array  # (samples, assumptions)
    cases: tuple[_Case, ...]

    @property
    def fitted(self) -> float:
        """Largest error of the load cycles, of their largest value."""
        return max(case.cycles.fitted for case in self.cases)

    @property
    def cells(self) -> int:
        """Segments times samples, of all load cases."""
        return sum(len(case.cycles.duration) * len(self.values) for case in self.cases)

    @property
    def shared(self) -> int:
        """How many load cycles the samples share; as many as samples where each has its own."""
        several = [case.cycles.size for case in self.cases if case.cycles.size > 1]
        return min(several, default=len(self.values))


def prepared(spec: RobotSpec, given: Sequence[Assumption], values: Array) -> Prepared:
    """Samples of a spec, with their load cycles.

    Parameters
    ----------
    spec
        As it is sized: platforms taken apart into wheels, pulleys known.
    given
        All that is uncertain.
    values
        (samples, assumptions) [SI].
    """
    cases = []
    for number, (name, case) in enumerate(spec.load_cases):
        paths, make = _cycle_of(spec, case, number, name, given)
        own = sorted(paths)
        nominal = np.array([given[k].nominal for k in own])
        cycles = cycles_of(partial(_made, make, own), nominal, values[:, own])
        rows = _rows(len(values), cycles.size)
        cases.append(_Case(name, case, paths, cycles, rows))
        if 1 < cycles.size < len(values):  # what shapes a shared cycle is what that was made with
            each, some = len(values) // REPLICATES, cycles.size // REPLICATES
            mine = [k for k in own if not _has_column(paths[k])]
            values = values.copy()
            values[:, mine] = values[rows // some * each + rows % some][:, mine]
    return Prepared(spec, tuple(given), values, tuple(cases))


def _made(make: Callable[[Mapping[int, float]], LoadCycle], own: Sequence[int], values: Array) -> LoadCycle:
    """A load cycle at values of the assumptions that count in it."""
    return make(dict(zip(own, values.tolist(), strict=True)))


def _rows(samples: int, cycles: int) -> NDArray[np.int64]:
    """The cycle of each sample: its own, the only one, or one of its replicate's in turn."""
    number = np.arange(samples)
    if cycles in (1, samples):
        return number * (cycles > 1)
    each, some = samples // REPLICATES, cycles // REPLICATES
    return number // each * some + number % each % some


def _cycle_of(
    spec: RobotSpec, case: RobotSpec, number: int, name: str, given: Sequence[Assumption]
) -> tuple[dict[int, Path_], Callable[[Mapping[int, float]], LoadCycle]]:
    """Which assumptions count in a load case, and its load cycle at values of them."""
    if not isinstance(case.load, WheelLoad):
        paths = case_paths(spec, number - 1 if number else None)
        return paths, lambda values: load_cycle(applied(case, _moves(paths, values, given)))
    whole = spec.whole
    places = [case_paths(whole, n - 1 if n else None) for n in range(len(whole.load_cases))]
    every = {k: path for one in places for k, path in one.items()}

    def cycle(values: Mapping[int, float]) -> LoadCycle:
        moved = [
            applied(part, _moves(paths, values, given))
            for paths, (_, part) in zip(places, whole.load_cases, strict=True)
        ]
        first = moved[0].model_copy()
        first._cases = tuple((n, part) for (n, _), part in zip(whole.load_cases[1:], moved[1:], strict=True))
        found = dict(on_wheels(first).load_cases)
        return load_cycle(found[name])

    return every, cycle


def _moves(paths: Mapping[int, Path_], values: Mapping[int, float], given: Sequence[Assumption]) -> dict[Path_, float]:
    """By how much figures move, by their place."""
    moved = {paths[k]: value - given[k].nominal for k, value in values.items() if k in paths}
    return {path: difference for path, difference in moved.items() if difference}


def unused(one: Prepared) -> list[Assumption]:
    """Figures of the spec whose tolerance counts in no check that is sampled."""
    idle = []
    for k, given in enumerate(one.given):
        if given.given is None:
            continue
        used = any(k in case.paths and (_has_column(case.paths[k]) or _shapes(case, k, one)) for case in one.cases)
        if not used:
            idle.append(given)
    return idle


_COLUMNS = {
    "supply": {"nominal", "min", "max", "current", "power", "regeneration", "capacitance"},
    "environment": {"ambient"},
    "needs": {"radial_load"},
    "battery": {"capacity", "health"},
    "equipment": {"power", "peak_power", "efficiency"},
}


def _has_column(path: Path_) -> bool:
    """Whether a figure is one that checks ask for beside the load cycle."""
    return str(path[-1]) in _COLUMNS.get(str(path[0]), set()) or (path[0] == "transmission" and path[-1] in _BELT)


_BELT = {"efficiency", "stiffness", "max_tension", "max_speed"}


def _shapes(case: _Case, k: int, one: Prepared) -> bool:
    """Whether a figure is one of the load, its motion, or what else shapes a cycle."""
    return case.cycles.size > 1 and case.paths[k][0] in ("load", "motion", "environment", "transmission", "platform")


# --- blocks


def blocks(one: Prepared, catalog: Catalog, belts: Sequence[float]) -> Iterator[Block]:
    """The samples, some at a time, ready for sets with any of some belt ratios."""
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
    specs, ats, feeds = [], [], []
    for case in one.cases:
        spec, efficiency = _with_columns(case, one, rows)
        cycles = case.cycles if case.cycles.size == 1 else _some(case.cycles, case.rows[rows])
        sampled = at_samples(cycles, efficiency)
        specs.append(spec)
        ats.append({belt: AtSamples(sampled, belt) for belt in belts})
        feeds.append(feeding(case.spec, catalog, _ratios(case, one, rows)))
    return Block(len(rows), tuple(specs), tuple(ats), tuple(feeds), factors, one.spec.tolerances.given)


def _ratios(case: _Case, one: Prepared, rows: NDArray[np.int64]) -> dict[Path_, Array]:
    """Sampled figures of battery and equipment over their nominal ones."""
    fed = {k: path for k, path in case.paths.items() if path[0] in ("battery", "equipment")}
    return {path: one.values[rows, k] / one.given[k].nominal for k, path in fed.items()}


def _some(cycles: Cycles, rows: NDArray[np.int64]) -> Cycles:
    """Some of the cycles."""
    own = {name: (demand[rows], limit[rows]) for name, (demand, limit) in cycles.own.items()}
    return cycles._replace(
        duration=cycles.duration[..., rows], speed=cycles.speed[..., rows],
        acceleration=cycles.acceleration[..., rows], torque=cycles.torque[..., rows], inertia=cycles.inertia[rows],
        radius=cycles.radius[rows], own=own,
    )  # fmt: skip


class _Seen:
    """A section of a spec with columns in place of some figures."""

    def __init__(self, section: Any, columns: Mapping[str, Any]) -> None:
        self._section, self._columns = section, columns

    def __getattr__(self, name: str) -> Any:
        return self._columns[name] if name in self._columns else getattr(self._section, name)


def _with_columns(case: _Case, one: Prepared, rows: NDArray[np.int64]) -> tuple[Any, Any]:
    """A load case as limits see it, and the efficiency of its belt."""
    found: dict[str, dict[str, Any]] = {"supply": {}, "environment": {}, "needs": {}, "transmission": {}}
    for k, path in case.paths.items():
        if path[0] in found and _has_column(path):
            moved = one.values[rows, k] - one.given[k].nominal
            found[str(path[0])][str(path[-1])] = _at(case.spec, path) + moved
    spec, supply = case.spec, found["supply"]
    nominal = supply.get("nominal", spec.supply.nominal)
    supply["lowest"] = supply.get("min", spec.supply.min or nominal)
    supply["highest"] = supply.get("max", spec.supply.max or nominal)
    columns: dict[str, Any] = {
        name: _Seen(getattr(spec, name), found[name]) for name in ("supply", "environment", "needs")
    }
    columns["belt"] = _Seen(spec.belt, found["transmission"]) if spec.belt else None
    return _Seen(spec, columns), found["transmission"].get("efficiency", spec.belt_efficiency)


def _at(spec: Any, path: Path_) -> float:
    """A figure of a spec by its place."""
    for step in path:
        spec = spec[step] if isinstance(step, int) else getattr(spec, step)
    return float(spec)
