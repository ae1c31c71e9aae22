"""Maps of a study and their points.

A map is over two axes; the others have a panel for each combination of their values. For a Latin hypercube the other
fields keep their sampled values.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from itertools import product
from typing import Any, NamedTuple

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.output.report.figures.all_figures import Drawing
from drivesizer.study.column import Row
from drivesizer.study.columns import columns_of
from drivesizer.study.map_figure import draw
from drivesizer.study.map_panel import Dimension, Map, Panel
from drivesizer.study.plan import Plan

__all__ = ["MAPS", "MOST_POINTS", "MapAxes", "Points", "drawings", "map_axes", "points"]

MOST_POINTS = 40_000
_MOST_PANELS = 12

# A column of the table as a map; one that the table lacks, or that is unknown everywhere, is left out.
MAPS: tuple[Map, ...] = (
    Map("best_set", "set", "Best drive"),
    Map("mass", "machine_mass_kg", "Mass of motors and gearheads, all drives (kg)", lacks="mass_lacks"),
    Map("price", "machine_price_EUR", "Price of the parts, all drives (EUR)", lacks="price_lacks"),
    Map("peak_power", "peak_W", "Power out of the supply of all axes, largest (W)"),
    Map("smallest_margin", "smallest_margin", "Smallest margin (%)", scale=100.0, signed=True),
    Map("none_fails", "none_fails", "Probability that no check fails (%)", scale=100.0),
)


class MapAxes(NamedTuple):
    """Axes of the maps."""

    across: Dimension
    up: Dimension | None
    beside: tuple[Dimension, ...]  # a panel for each combination
    grid: bool


Points = dict[tuple[Any, ...], list[dict[str, Any]]]  # rows by the values of the other axes


def map_axes(plan: Plan, names: Sequence[str]) -> MapAxes | None:
    """Axes of the maps: the two named, or the first two; None where nothing varies."""
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
    return MapAxes(there[picked[0]], there[picked[1]] if len(picked) > 1 else None, beside, grid)


def _dimensions(plan: Plan) -> list[Dimension]:
    """Axes of the study in the order of the table's columns."""
    found = [
        Dimension(axis.name, axis.head, tuple(map(axis.table_value, axis.values)), bool(axis.kind), axis.stepped)
        for axis in plan.job.axes
    ]
    found += [Dimension("spec", "spec", plan.names, False), Dimension("catalogs", "catalogs", plan.catalogs, False)]
    found += [Dimension("objective", "objective", plan.titles, False)]
    sampled = plan.shares is not None
    return [one for n, one in enumerate(found) if len(one.values) > 1 or (sampled and n < len(plan.job.axes))]


def points(plan: Plan, over: MapAxes, chunks: Iterable[list[Row]]) -> Points:
    """The best row of each variant by panel, with the columns that maps need."""
    heads = [column.head for column in columns_of(plan)]
    wanted = {over.across.head, *([over.up.head] if over.up else []), *(one.head for one in over.beside), "status"}
    wanted |= {name for one in MAPS for name in (one.column, one.lacks) if name in heads}
    places = {name: heads.index(name) for name in wanted}
    rank, number = heads.index("rank"), heads.index("variant")
    found: Points = {key: [] for key in product(*(one.values for one in over.beside))}
    for rows in chunks:
        for row in rows:
            if row[rank] not in (None, 1):
                continue
            point = {name: row[place] for name, place in places.items()}
            key = tuple(point[one.head] for one in over.beside)
            if key in found:
                found[key].append(point | {"round": plan.round_of(row[number])})
    return found


def drawings(over: MapAxes, found: Points) -> tuple[dict[str, Drawing], list[str]]:
    """Maps by name, and notes on panels that are not drawn."""
    panels = [Panel(_title(over.beside, key), rows) for key, rows in found.items()]
    notes = []
    if len(panels) > _MOST_PANELS:
        notes.append(
            f"maps show {_MOST_PANELS} of {len(panels)} combinations of the other axes; "
            "--map A,B names the two axes of the maps"
        )
    shown = panels[:_MOST_PANELS]
    made: dict[str, Drawing] = {}
    for one in MAPS:
        if any(row.get(one.column) not in (None, "") for panel in shown for row in panel.rows):
            made[one.name] = partial(draw, one, shown, over.across, over.up, over.grid)
    return made, notes


def _title(beside: Sequence[Dimension], key: Sequence[Any]) -> str:
    return ", ".join(_panel_label(one, value) for one, value in zip(beside, key, strict=True))


def _panel_label(one: Dimension, value: Any) -> str:
    """Short label of a panel: the field without its section, and the value."""
    if one.name in ("spec", "catalogs", "objective"):
        return f"by {value}" if one.name == "objective" else str(value)
    unit = one.head.removeprefix(one.name).strip(" ()")
    return f"{one.name.rpartition('.')[2]} {value:g} {unit}".rstrip() if one.numeric else str(value)
