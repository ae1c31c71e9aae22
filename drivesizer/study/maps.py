"""Which maps a study has, and the points that are on them.

A map is over two of the things that vary; what varies beside them has a panel for each of its values. Of a Latin
hypercube the other fields are left as they fall.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from itertools import product
from typing import Any, NamedTuple

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.output.report.all_figures import Drawing
from drivesizer.study.columns import Row, columns_of
from drivesizer.study.map_figure import draw
from drivesizer.study.map_panel import Dimension, Map, Panel
from drivesizer.study.plan import Plan

__all__ = ["MAPS", "MOST_POINTS", "Chosen", "Points", "chosen", "drawings", "points"]

MOST_POINTS = 40_000
_MOST_PANELS = 12

# A column of the table as a map; one that the table lacks, or that is unknown everywhere, is left out.
MAPS: tuple[Map, ...] = (
    Map("best_set", "set", "Best set"),
    Map("mass", "mass_kg", "Mass of motor and gearhead (kg)", lacks="mass_lacks"),
    Map("price", "price_EUR", "Price of the parts (EUR)", lacks="price_lacks"),
    Map("smallest_margin", "smallest_margin", "Smallest margin (%)", scale=100.0, signed=True),
    Map("none_fails", "none_fails", "Probability that no check fails (%)", scale=100.0),
)


class Chosen(NamedTuple):
    """What the maps are over."""

    across: Dimension
    up: Dimension | None
    beside: tuple[Dimension, ...]  # a panel for each combination
    grid: bool


Points = dict[tuple[Any, ...], list[dict[str, Any]]]  # rows by the values of what varies beside


def chosen(plan: Plan, names: Sequence[str]) -> Chosen | None:
    """What maps are over: two that are named, or the first two that vary; None where nothing varies.

    Raises
    ------
    InputError
        When a name is nothing that the study varies.
    """
    grid = plan.shares is None
    there = {dimension.name: dimension for dimension in _dimensions(plan)}
    for name in names:
        if name not in there:
            hint = nearest(name, there) or f"; expected two of {', '.join(there) or 'several'}"
            raise InputError(f"--map: {quoted(name)} does not vary in this study{hint}")
    picked = list(dict.fromkeys(names)) or list(there)[:2]
    if not picked:
        return None
    if names and len(picked) != 2:
        raise InputError(f"--map: expected two fields that vary, e.g. --map {','.join(list(there)[:2])}")
    sampled = {axis.name for axis in plan.job.axes} if not grid else set()
    beside = tuple(one for name, one in there.items() if name not in picked and name not in sampled)
    return Chosen(there[picked[0]], there[picked[1]] if len(picked) > 1 else None, beside, grid)


def _dimensions(plan: Plan) -> list[Dimension]:
    """What varies, in the order of the table's columns."""
    found = [
        Dimension(axis.name, axis.head, tuple(axis.told(value) for value in axis.values), bool(axis.kind))
        for axis in plan.job.axes
    ]
    found += [Dimension("spec", "spec", plan.names, False), Dimension("catalogs", "catalogs", plan.catalogs, False)]
    found += [Dimension("objective", "objective", plan.titles, False)]
    sampled = plan.shares is not None
    return [one for n, one in enumerate(found) if len(one.values) > 1 or (sampled and n < len(plan.job.axes))]


def points(plan: Plan, over: Chosen, chunks: Iterable[list[Row]]) -> Points:
    """The best row of each variant by its panel, with what the maps need."""
    heads = [column.head for column in columns_of(plan)]
    wanted = {over.across.head, *([over.up.head] if over.up else []), *(one.head for one in over.beside), "status"}
    wanted |= {name for one in MAPS for name in (one.column, one.lacks) if name in heads}
    places = {name: heads.index(name) for name in wanted}
    rank = heads.index("rank")
    found: Points = {key: [] for key in product(*(one.values for one in over.beside))}
    for rows in chunks:
        for row in rows:
            if row[rank] not in (None, 1):
                continue
            point = {name: row[place] for name, place in places.items()}
            found[tuple(point[one.head] for one in over.beside)].append(point)
    return found


def drawings(over: Chosen, found: Points) -> tuple[dict[str, Drawing], list[str]]:
    """The maps by name, and what is to be said of what is not on them."""
    panels = [Panel(_title(over.beside, key), rows) for key, rows in found.items()]
    said = []
    if len(panels) > _MOST_PANELS:
        said.append(
            f"maps show {_MOST_PANELS} of {len(panels)} combinations of what varies beside {over.across.name}; "
            "--map A,B names the two that they are over"
        )
    shown = panels[:_MOST_PANELS]
    made: dict[str, Drawing] = {}
    for one in MAPS:
        if any(row.get(one.column) not in (None, "") for panel in shown for row in panel.rows):
            made[one.name] = partial(draw, one, shown, over.across, over.up, over.grid)
    return made, said


def _title(beside: Sequence[Dimension], key: Sequence[Any]) -> str:
    return ", ".join(_told(one, value) for one, value in zip(beside, key, strict=True))


def _told(one: Dimension, value: Any) -> str:
    """What a panel is for, in a few letters: without the section that a field stands in."""
    if one.name in ("spec", "catalogs", "objective"):
        return f"by {value}" if one.name == "objective" else str(value)
    unit = one.head.removeprefix(one.name).strip(" ()")
    return f"{one.name.rpartition('.')[2]} {value:g} {unit}".rstrip() if one.numeric else str(value)
