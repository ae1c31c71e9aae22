"""From a spec to the sizing problem: wheels of a platform as load cases, every load cycle, belts out of catalogues."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table
from drivesizer.catalog.parts import BeltDrive
from drivesizer.catalog.view.mounted import Housing, with_mounting, with_own_brake
from drivesizer.errors import InputError, quoted
from drivesizer.load_cases.of_machine import cycle_of_shift, load_cases
from drivesizer.machine.braking import with_parts_of_supply
from drivesizer.physics.belt import LEAST_IN_MESH, centre_distance, shortest_recommended, teeth_in_mesh
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.thermal import with_plate
from drivesizer.results.problem import SHIFT, BeltDrives, LoadCase, Problem
from drivesizer.spec.drive import Pulleys
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.spec.mounting import Mounting

__all__ = [
    "MOST_RATIOS", "assumptions", "belt_drives", "changed", "problem", "quickest_winding", "spread", "with_cycle",
    "with_spec",
]  # fmt: skip


# -- Belts and pulleys out of the catalogues: which ratios there are, and which parts make each of them.
#
# A pair of pulleys gives a ratio, a belt round it a centre distance. Of each ratio the smallest pulleys are taken
# that keep enough teeth in mesh, of these the belt that comes nearest to the centre distance.


Array = NDArray[np.float64]
MOST_RATIOS = 60  # that are searched
_SAME = 1e-6  # two pitches or widths that differ by this share are one


class _Layouts(NamedTuple):
    """Layouts of a belt round two pulleys, as columns."""

    driving: Array  # teeth
    driven: Array
    belt: Array
    centre_distance: Array  # m; NaN where the belt is too short

    @property
    def ratio(self) -> Array:
        """Turns of the driving pulley per turn of the driven one; the same teeth reduced are the same float."""
        return self.driven / self.driving

    def on(self, rows: NDArray[Any]) -> _Layouts:
        """Some of them."""
        return _Layouts(*(column[rows] for column in self))


def belt_drives(spec: RobotSpec, catalog: Catalog) -> BeltDrives | None:
    """The belt drives that the catalogues have for a spec; None where it names its belt ratios, or has no belt."""
    if spec.belt is None or spec.belt.pulleys is None:
        return None
    stage = spec.transmission.index(spec.belt)
    try:
        return _drives(spec.belt.pulleys, catalog)
    except _NothingFitsError as error:
        raise InputError(f"{spec.where(('transmission', stage, 'pulleys'))}: {error}") from None


class _NothingFitsError(Exception):
    """There is no such part, or none that fits."""


def _drives(required: Pulleys, catalog: Catalog) -> BeltDrives:
    """One drive for each ratio, at most as many as are searched, spread over the range.

    Of each ratio the smallest pulleys with enough teeth in mesh, and the belt nearest to the centre distance, without
    one the shortest; where none keeps enough, the one that lacks the fewest. Where ratios are too many, those that keep
    enough go first.
    """
    pulleys = _taking(required, catalog.pulleys, "pulleys")
    belts = _taking(required, catalog.belts, "belts")
    every = _layouts(required, np.unique(catalog.pulleys["teeth"][pulleys]), np.unique(catalog.belts["teeth"][belts]))
    wish, a = required.centre_distance, every.centre_distance
    held = teeth_in_mesh(every.driving, every.driven, required.pitch, a)
    lacking = np.maximum(LEAST_IN_MESH - np.floor(held), 0.0)
    off = every.belt if wish is None else np.abs(a - wish)
    order = np.lexsort((every.belt, off, every.driving, lacking, every.ratio))
    first = order[np.unique(every.ratio[order], return_index=True)[1]]
    few = first
    if len(first) > MOST_RATIOS:
        able = first[held[first] >= LEAST_IN_MESH] if (held[first] >= LEAST_IN_MESH).any() else first
        few = able[spread(np.log(every.ratio[able]), MOST_RATIOS)]
    drives = (_drive(catalog, pulleys, belts, every, row, required.pitch) for row in few.tolist())
    return BeltDrives(tuple(drives), len(first))


def _taking(required: Pulleys, table: Table[Any], section: str) -> NDArray[np.int64]:
    """Rows of the belts of the required kind, or of the pulleys that take them."""
    fits = np.char.lower(table["profile"]) == required.profile.lower()
    fits &= np.isclose(table["pitch"], required.pitch, rtol=_SAME, atol=0.0) & ~table.excluded & (table["teeth"] > 0)
    wide_enough = table["width"] >= required.width * (1.0 - _SAME)
    not_wider = table["width"] <= required.width * (1.0 + _SAME)
    rows = np.flatnonzero(fits & wide_enough & (not_wider if section == "belts" else True))
    if not len(rows):
        takes = "of" if section == "belts" else "for a belt of"
        wanted = f"{quoted(required.profile)} {_mm(required.pitch)} {takes} {_mm(required.width)} width"
        raise _NothingFitsError(
            f"no {section} {wanted} in the catalogues that the spec names; {_stock(table, section)}"
        )
    return rows


def _stock(table: Table[Any], section: str) -> str:
    """Belts or pulleys of a table, in words."""
    kinds: dict[tuple[str, float], set[float]] = {}
    known = ~table.excluded & (table["profile"] != "") & ~np.isnan(table["pitch"] + table["width"])
    for row in np.flatnonzero(known):
        kind = str(table["profile"][row]), float(table["pitch"][row])
        kinds.setdefault(kind, set()).add(float(table["width"][row]))
    if not kinds:
        return f"they list no {section}: select.catalogs needs some that do, e.g. wcp, or all"
    sentences = (
        f"{profile} {_mm(pitch)} of {', '.join(map(_mm, sorted(w)))}" for (profile, pitch), w in sorted(kinds.items())
    )
    return f"there are {'; '.join(sentences)} width"


def _layouts(required: Pulleys, pulleys: Array, belts: Array) -> _Layouts:
    """Every layout of a belt round two pulleys of a ratio in the range, at the required centre distance.

    Without one, at the recommended one or more.
    """
    driving, driven = (side.ravel() for side in np.meshgrid(pulleys, pulleys, indexing="ij"))
    ratio, wish = driven / driving, required.centre_distance
    pairs = np.flatnonzero((ratio >= required.ratio_min) & (ratio <= required.ratio_max))
    if not len(pairs):
        below, above = ratio[ratio < required.ratio_min], ratio[ratio > required.ratio_max]
        ends = [*([below.max()] if len(below) else []), *([above.min()] if len(above) else [])]
        nearest = f"the nearest {'are' if len(ends) > 1 else 'is'} {' and '.join(f'{one:.4g}' for one in ends)}"
        wanted = f"from {required.ratio_min:.4g} to {required.ratio_max:.4g}"
        raise _NothingFitsError(f"no two pulleys have a ratio {wanted}; {nearest}")
    driving, driven = (np.repeat(side[pairs], len(belts)) for side in (driving, driven))
    belt = np.tile(belts, len(pairs))
    a = centre_distance(driving, driven, required.pitch, belt)
    least = shortest_recommended(driving, driven, required.pitch)
    fits = np.flatnonzero(a >= least if wish is None else np.abs(a - wish) <= required.adjustable)
    if len(fits):
        return _Layouts(driving, driven, belt, a).on(fits)
    there_are = f"{len(belts)} belts of {belts[0]:.0f} to {belts[-1]:.0f} teeth"
    if wish is None or np.isnan(a).all():
        raise _NothingFitsError(f"no belt is long enough for two pulleys of such a ratio; there are {there_are}")
    row = int(np.nanargmin(np.abs(a - wish)))
    nearest = f"{driven[row]:.0f}:{driving[row]:.0f} with {belt[row]:.0f} teeth at {show(a[row], 'mm', 'length', 6)}"
    raise _NothingFitsError(
        f"no belt gives a centre distance of {_mm(wish)} within {_mm(required.adjustable)}; of {there_are} the nearest "
        f"is {nearest}"
    )


def spread(values: Array, most: int) -> NDArray[np.int64]:
    """Rows of at most so many values that cover their range best: each further one is farthest from those before."""
    if len(values) <= most:
        return np.arange(len(values))
    rows = [int(values.argmin()), int(values.argmax())]
    away = np.minimum(*(np.abs(values - values[row]) for row in rows))
    while len(rows) < most:
        rows.append(int(away.argmax()))
        away = np.minimum(away, np.abs(values - values[rows[-1]]))
    return np.sort(np.array(rows))


def _drive(
    catalog: Catalog, pulleys: NDArray[Any], belts: NDArray[Any], layouts: _Layouts, row: int, pitch: float
) -> BeltDrive:
    """The parts of one layout: pulleys of the belt's maker where there are some, the narrowest that take the belt."""
    driving, driven, teeth, distance = (float(column[row]) for column in layouts)
    table = catalog.pulleys

    def chosen(belt: int) -> tuple[tuple[int, str], tuple[int, ...]]:
        maker, both = catalog.belts["manufacturer"][belt], list[int]()
        for z in (driving, driven):
            alike: Iterable[int] = pulleys[table["teeth"][pulleys] == z].tolist()
            both.append(min((bool(table["manufacturer"][r] != maker), table["width"][r], table["part"][r], r)
                            for r in alike)[-1])  # fmt: skip
        foreign = sum(bool(table["manufacturer"][one] != maker) for one in both)
        return (foreign, str(catalog.belts["part"][belt])), (*both, belt)

    alike = belts[catalog.belts["teeth"][belts] == teeth]
    _, (first, second, belt) = min(chosen(int(one)) for one in alike)
    return BeltDrive(
        driving=table.record(first),
        driven=table.record(second),
        belt=catalog.belts.record(belt),
        centre_distance=distance,
        teeth_in_mesh=float(teeth_in_mesh(driving, driven, pitch, distance)),
    )


def assumptions(problem: Problem) -> tuple[str, ...]:
    """Assumptions on a belt out of the catalogues, as sentences."""
    belt = problem.machine.belt
    if belt is None or belt.pulleys is None or problem.belts is None:
        return ()
    sentences = [
        "the torque that a belt withstands is in no catalogue: "
        + ("only max_tension is checked" if belt.max_tension else "it is not checked; max_tension gives a limit"),
        "of each belt ratio the smallest pulleys that keep 6 teeth in mesh; their bores are not compared with the "
        "shafts, their inertia is what the spec gives for the belt",
    ]
    if belt.pulleys.centre_distance is None:
        sentences.append("no centre distance is given: the shortest belt from 0.2 p (z1 + z2) on is taken")
    drives, ratios = problem.belts
    if len(drives) < ratios:
        sentences.append(
            f"the pulleys give {ratios} ratios: {len(drives)} that cover the range best are searched, of those with "
            "6 teeth in mesh where there are such"
        )
    return tuple(sentences)


def _mm(length: float) -> str:
    return show(length, "mm", "length")


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
    at_belt = CycleAtBelt(cycle, spec.belt_efficiency, quickest)
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
