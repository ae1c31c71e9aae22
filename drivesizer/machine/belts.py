"""Belts and pulleys out of the catalogues: which ratios there are, and which parts make each of them.

A pair of pulleys gives a ratio, a belt round it a centre distance. Of each ratio the smallest pulleys are taken that
keep enough teeth in mesh, of these the belt that comes nearest to the centre distance.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drivesizer.catalog import Catalog, Table
from drivesizer.catalog.parts import BeltDrive
from drivesizer.errors import InputError, quoted
from drivesizer.physics.belt import LEAST_IN_MESH, centre_distance, shortest_recommended, teeth_in_mesh
from drivesizer.physics.figures import Array, Whole
from drivesizer.results.problem import BeltDrives, Problem
from drivesizer.spec.drive import Pulleys
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

MOST_RATIOS = 60  # that are searched
_SAME = 1e-6  # two pitches or widths that differ by this share are one


def belt_drives(spec: RobotSpec, catalog: Catalog) -> BeltDrives | None:
    """The belt drives that the catalogues have for a spec; None where it names its belt ratios, or has no belt."""
    if spec.belt is None or spec.belt.pulleys is None:
        return None
    stage = spec.transmission.index(spec.belt)
    return drives_for(spec.belt.pulleys, catalog, spec.where(("transmission", stage, "pulleys")))


def drives_for(required: Pulleys, catalog: Catalog, where: str) -> BeltDrives:
    """One drive for each ratio, at most as many as are searched, spread over the range.

    Of each ratio the smallest pulleys with enough teeth in mesh, and the belt nearest to the centre distance, without
    one the shortest that is recommended; of several makers' those whose parts are of one.
    """
    pulleys = _fitting(required, catalog.pulleys, "pulleys", where)
    belts = _fitting(required, catalog.belts, "belts", where)
    teeth = np.unique(catalog.pulleys["teeth"][pulleys]), np.unique(catalog.belts["teeth"][belts])
    driving, driven, belt, distance = _layouts(required, *teeth, where)
    ratio, wish = driven / driving, required.centre_distance  # the same teeth reduced are the same float
    in_mesh = teeth_in_mesh(driving, driven, required.pitch, distance)
    lacking = np.maximum(LEAST_IN_MESH - np.floor(in_mesh), 0.0)
    order = np.lexsort((belt, belt if wish is None else np.abs(distance - wish), driving, lacking, ratio))
    first = order[np.unique(ratio[order], return_index=True)[1]]
    few = first
    if len(first) > MOST_RATIOS:
        enough = in_mesh[first] >= LEAST_IN_MESH
        able = first[enough] if enough.any() else first
        few = able[spread(np.log(ratio[able]), MOST_RATIOS)]

    def parts(row: int) -> BeltDrive:
        """Pulleys of the belt's maker where there are some, the narrowest that take the belt."""
        makers, choices = catalog.pulleys["manufacturer"], []
        for belt_row in belts[catalog.belts["teeth"][belts] == belt[row]].tolist():
            maker, pair = catalog.belts["manufacturer"][belt_row], list[int]()
            for z in (driving[row], driven[row]):
                alike: list[int] = pulleys[catalog.pulleys["teeth"][pulleys] == z].tolist()
                width, name = catalog.pulleys["width"], catalog.pulleys["part"]
                pair.append(min(alike, key=lambda r, m=maker: (makers[r] != m, width[r], name[r], r)))  # type: ignore[misc]
            foreign = sum(bool(makers[r] != maker) for r in pair)
            choices.append((foreign, str(catalog.belts["part"][belt_row]), pair, belt_row))
        _, _, pair, best = min(choices)
        return BeltDrive(
            driving=catalog.pulleys.record(pair[0]),
            driven=catalog.pulleys.record(pair[1]),
            belt=catalog.belts.record(best),
            centre_distance=float(distance[row]),
            teeth_in_mesh=float(in_mesh[row]),
        )

    return BeltDrives(tuple(map(parts, few.tolist())), len(first))


def _fitting(required: Pulleys, table: Table[Any], section: str, where: str) -> Whole:
    """Whole of the belts of the required kind, or of the pulleys that take them."""
    fits = np.char.lower(table["profile"]) == required.profile.lower()
    fits &= np.isclose(table["pitch"], required.pitch, rtol=_SAME, atol=0.0) & ~table.excluded & (table["teeth"] > 0)
    fits &= table["width"] >= required.width * (1.0 - _SAME)
    if section == "belts":
        fits &= table["width"] <= required.width * (1.0 + _SAME)
    if fits.any():
        return np.flatnonzero(fits)
    kinds: dict[tuple[str, float], set[float]] = {}  # what there is
    for row in np.flatnonzero(~table.excluded & (table["profile"] != "") & ~np.isnan(table["pitch"] + table["width"])):
        kind = str(table["profile"][row]), float(table["pitch"][row])
        kinds.setdefault(kind, set()).add(float(table["width"][row]))
    stock = f"they list no {section}: select.catalogs needs some that do, e.g. wcp, or all"
    if kinds:
        widths = [
            f"{name} {_mm(pitch)} of {', '.join(map(_mm, sorted(w)))}" for (name, pitch), w in sorted(kinds.items())
        ]
        stock = f"there are {'; '.join(widths)} width"
    takes = "of" if section == "belts" else "for a belt of"
    requirement = f"{quoted(required.profile)} {_mm(required.pitch)} {takes} {_mm(required.width)} width"
    raise InputError(f"{where}: no {section} {requirement} in the catalogues that the spec names; {stock}")


def _layouts(required: Pulleys, pulleys: Array, belts: Array, where: str) -> tuple[Array, Array, Array, Array]:
    """Every belt round two pulleys of a ratio in the range: teeth of both and of the belt, centre distance [m]."""
    driving, driven = (side.ravel() for side in np.meshgrid(pulleys, pulleys, indexing="ij"))
    ratio, wish = driven / driving, required.centre_distance
    pairs = np.flatnonzero((ratio >= required.ratio_min) & (ratio <= required.ratio_max))
    if not len(pairs):
        below, above = ratio[ratio < required.ratio_min], ratio[ratio > required.ratio_max]
        ends = [*([below.max()] if len(below) else []), *([above.min()] if len(above) else [])]
        nearest = f"the nearest {'are' if len(ends) > 1 else 'is'} {' and '.join(f'{ratio:.4g}' for ratio in ends)}"
        requirement = f"from {required.ratio_min:.4g} to {required.ratio_max:.4g}"
        raise InputError(f"{where}: no two pulleys have a ratio {requirement}; {nearest}")
    driving, driven = (np.repeat(side[pairs], len(belts)) for side in (driving, driven))
    belt = np.tile(belts, len(pairs))
    a = centre_distance(driving, driven, required.pitch, belt)
    least = shortest_recommended(driving, driven, required.pitch)
    fits = np.flatnonzero(a >= least if wish is None else np.abs(a - wish) <= required.adjustable)
    if len(fits):
        return driving[fits], driven[fits], belt[fits], a[fits]
    there_are = f"{len(belts)} belts of {belts[0]:.0f} to {belts[-1]:.0f} teeth"
    if wish is None or np.isnan(a).all():
        raise InputError(f"{where}: no belt is long enough for two pulleys of such a ratio; there are {there_are}")
    row = int(np.nanargmin(np.abs(a - wish)))
    nearest = f"{driven[row]:.0f}:{driving[row]:.0f} with {belt[row]:.0f} teeth at {show(a[row], 'mm', 'length', 6)}"
    raise InputError(
        f"{where}: no belt gives a centre distance of {_mm(wish)} within {_mm(required.adjustable)}; of {there_are} "
        f"the nearest is {nearest}"
    )


def spread(values: Array, most: int) -> Whole:
    """Whole of at most so many values that cover their range best: each further one is farthest from those before."""
    if len(values) <= most:
        return np.arange(len(values))
    rows = [int(values.argmin()), int(values.argmax())]
    away = np.minimum(*(np.abs(values - values[row]) for row in rows))
    while len(rows) < most:
        rows.append(int(away.argmax()))
        away = np.minimum(away, np.abs(values - values[rows[-1]]))
    return np.sort(np.array(rows))


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
