"""Maps of a study: points or cells of a grid, one colour scale, and the list of drives by number below.

A map is over two axes; the others have a panel for each combination of their values. For a Latin hypercube the other
fields keep their sampled values. Cells show their numbers where there is room; one where no drive passes is hatched.
Colours of figures are monotonic in brightness and drives are numbered, so that a grey print is readable.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import product
from math import ceil, inf, isfinite, nan
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.output.derivation import clean, short
from drivesizer.output.report.figures.style import COLOURS, Drawing, figure
from drivesizer.study.plan import Plan
from drivesizer.study.rows import Row, columns_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_POINTS = 40_000
_MOST_PANELS = 12
_WIDE, _TALL = 5.6, 1.75  # in, of all panels side by side, and of a panel
_LETTER, _LINE = 0.055, 0.11  # in, of a letter in a cell
_MOST_TICKS = 20  # numbers of drives along an axis
_MOST_LINES, _MOST_TEXTS = 2500, 700  # cells of a panel that has lines between cells, and numbers in them
_EMPTY, _GREY = "#F4F4F4", "#DDDDDD"  # of what is not known, and of cells that all have one value
_FAILED = "//////"  # hatch where no drive passes


class Map(NamedTuple):
    """A column of the table as a map."""

    name: str
    column: str
    title: str
    scale: float = 1.0  # from the column to what is shown
    lacks: str = ""  # the column of parts that a sum does not cover
    signed: bool = False  # whether the sign matters
    named: bool = False  # names in place of figures: a colour each


# A column of the table as a map; one that the table lacks, or that is unknown everywhere, is left out.
MAPS: tuple[Map, ...] = (
    Map("best_set", "set", "Best drive", named=True),
    Map("motor_family", "motor_family", "Motor family of the best drive", named=True),
    Map("mass", "machine_mass_kg", "Mass of the parts, all drives (kg)", lacks="mass_lacks"),
    Map("price", "machine_price_EUR", "Price of the parts, all drives (EUR)", lacks="price_lacks"),
    Map("peak_power", "peak_W", "Power out of the supply of all axes, largest (W)"),
    Map("smallest_margin", "smallest_margin", "Smallest margin (%)", scale=100.0, signed=True),
    Map("none_fails", "none_fails", "Probability that no check fails (%)", scale=100.0),
)


class Dimension(NamedTuple):
    """An axis of the study, with its values."""

    name: str
    head: str  # of its column
    values: tuple[Any, ...]
    numeric: bool
    stepped: bool = False  # whether its values are even steps, which refinement halves


class MapAxes(NamedTuple):
    """Axes of the maps."""

    across: Dimension
    up: Dimension | None
    panels: tuple[Dimension, ...]  # a panel for each combination
    grid: bool


Points = dict[tuple[Any, ...], list[dict[str, Any]]]  # rows by the values of the other axes
Box = tuple[float, float, float, float]  # left, width, low, height of a cell


def map_axes(plan: Plan, names: Sequence[str]) -> MapAxes | None:
    """Axes of the maps: the two named, or the first two; None where nothing varies."""
    grid = plan.shares is None
    dimensions = [
        Dimension(axis.name, axis.head, tuple(map(axis.table_value, axis.values)), bool(axis.kind), axis.stepped)
        for axis in plan.job.axes
    ]
    dimensions += [
        Dimension("spec", "spec", plan.names, False),
        Dimension("catalogs", "catalogs", plan.catalogs, False),
    ]
    dimensions += [Dimension("objective", "objective", plan.titles, False)]
    sampled = set() if grid else {axis.name for axis in plan.job.axes}
    there = {
        dimension.name: dimension for dimension in dimensions if len(dimension.values) > 1 or dimension.name in sampled
    }
    for name in names:
        if name not in there:
            hint = nearest(name, there) or f"; expected two of {', '.join(there) or 'several'}"
            raise InputError(f"--map: {quoted(name)} does not vary in this study{hint}")
    picked = list(dict.fromkeys(names)) or list(there)[:2]
    if not picked:
        return None
    if names and len(picked) != 2:
        raise InputError(f"--map: expected two fields that vary, e.g. --map {','.join(list(there)[:2])}")
    panel_axes = tuple(dimension for name, dimension in there.items() if name not in picked and name not in sampled)
    return MapAxes(there[picked[0]], there[picked[1]] if len(picked) > 1 else None, panel_axes, grid)


def points(plan: Plan, over: MapAxes, rows: Iterable[Row]) -> Points:
    """The best row of each variant by panel, with the columns that maps need."""
    heads = [column.head for column in columns_of(plan)]
    names = {
        over.across.head,
        *([over.up.head] if over.up else []),
        *(dimension.head for dimension in over.panels),
        "status",
    }
    names |= {name for chart in MAPS for name in (chart.column, chart.lacks) if name in heads}
    places = {name: heads.index(name) for name in names}
    rank, number = heads.index("rank"), heads.index("variant")
    by_panel: Points = {key: [] for key in product(*(dimension.values for dimension in over.panels))}
    for row in rows:
        if row[rank] not in (None, 1):
            continue
        point = {name: row[place] for name, place in places.items()}
        key = tuple(point[dimension.head] for dimension in over.panels)
        if key in by_panel:
            by_panel[key].append(point | {"round": plan.round_of(row[number])})
    return by_panel


def drawn_maps(plan: Plan, rows: Iterable[Row], over: MapAxes) -> tuple[dict[str, Drawing], list[str]]:
    """Maps of a study by name; and why there are none, or not of all panels."""
    if plan.total > MOST_POINTS:
        return {}, [f"no maps: more than {MOST_POINTS} variants; the tables have all"]
    return drawings(over, points(plan, over, rows))


def drawings(over: MapAxes, by_panel: Points) -> tuple[dict[str, Drawing], list[str]]:
    """Maps by name, and notes on panels that are not drawn."""
    panels, notes = dict[str, list[dict[str, Any]]](), []
    for key, rows in by_panel.items():  # fields without their sections, and their values
        title = []
        for dimension, value in zip(over.panels, key, strict=True):
            unit = dimension.head.removeprefix(dimension.name).strip(" ()")
            plain = (
                dimension.name in ("spec", "catalogs") or "," in dimension.name
            )  # which say themselves what they are
            cell = f"{value:g} {unit}".rstrip() if dimension.numeric else str(value)
            named = cell if plain else f"{dimension.name.rpartition('.')[2]} {cell}"
            title.append(f"by {value}" if dimension.name == "objective" else named)
        panels[", ".join(title)] = rows
    if len(panels) > _MOST_PANELS:
        notes.append(
            f"maps show {_MOST_PANELS} of {len(panels)} combinations of the other axes; "
            "--map A,B names the two axes of the maps"
        )
        panels = dict(list(panels.items())[:_MOST_PANELS])
    all_rows = [row for rows in panels.values() for row in rows]
    by_chart = {chart: {row.get(chart.column) for row in all_rows} - {None, ""} for chart in MAPS}
    known = [chart for chart, values in by_chart.items() if len(values) > (chart.name == "motor_family")]
    return {chart.name: draw(chart, panels, over) for chart in known}, notes


# Look of drives: number, colour and pattern or marker, and their list below the map.
#
# Colours are Paul Tol's light scheme, made for cells with black letters and distinguishable by the colour-blind (P.
# Tol, Colour Schemes, SRON/EPS/TN/09-002, figure of the light scheme). After the last colour they repeat with
# another pattern, points with another marker. No numbered drive is grey.


class Look(NamedTuple):
    """Look of a drive's cells and points."""

    face: str
    hatch: str
    marker: str


_FACES = ("#77AADD", "#EE8866", "#EEDD88", "#FFAABB", "#99DDFF", "#44BB99", "#BBCC33", "#AAAA00")
_PATTERNS = (("", "o"), ("....", "s"), ("xxxx", "^"), ("||||", "D"), ("----", "v"), ("oooo", "P"), ("++++", "p"))
OTHERS = Look(_GREY, "**", "h")  # drives without a number
_SHORT = 10  # lines of one column; more take two
_LETTERS = {1: 96, 2: 46}  # of a name, by columns


def look_of(number: int | None) -> Look:
    """Look of the drive with a number; different for every number."""
    if number is None:
        return OTHERS
    pattern, face = divmod(number - 1, len(_FACES))
    return Look(_FACES[face], *_PATTERNS[pattern])


@figure
def draw(figure: Figure, chart: Map, panels: dict[str, list[dict[str, Any]]], over: MapAxes) -> None:
    """Draw a map: panels side by side with one colour scale, and what colours and signs mean."""
    from matplotlib.cm import ScalarMappable

    rows = [row for panel in panels.values() for row in panel]
    numbers, others, same = dict[str, int](), 0, None
    if chart.named:  # those that are best most often
        often = Counter(row[chart.column] for row in rows if row[chart.column])
        first = sorted(often, key=lambda name: (-often[name], name))[: len(_FACES) * len(_PATTERNS)]
        numbers = {name: number for number, name in enumerate(first, 1)}
        others = len(often) - len(numbers)
    known = [row[chart.column] * chart.scale for row in rows if row[chart.column] is not None] if not numbers else []
    known = [value for value in known if isfinite(value)]
    if len(set(known)) == 1:  # no colour scale is needed
        same = known[0]
    scale = _scale(chart, known or [0.0])
    count = 2 if len(panels) == 4 else min(len(panels), 3)
    lines, listed = ceil(len(panels) / count), len(numbers) + (others > 0)
    width = int(_WIDE / count / _LETTER)
    titles = [wrap(clean(title), width, max_lines=2, placeholder=" …") for title in panels]
    tall = (_TALL if len(panels) > 1 else 2.7) + 0.13 * max(len(title) - 1 for title in titles)
    columns = 1 if listed <= _SHORT else 2
    figure.set_layout_engine("constrained")
    below = 0.15 * ceil(listed / columns)
    figure.set_figheight(0.9 + lines * tall + below)
    figure.suptitle(chart.title, x=0.01, ha="left", fontsize=8, fontweight="bold")
    grid = figure.subplots(lines, count, squeeze=False, sharex=True, sharey=True)
    for n, axes in enumerate(grid.flat):
        axes.set_visible(n < len(panels))
        if n + count >= len(panels):  # nothing is below it
            axes.set_xlabel(short(clean(over.across.head), 40))
            axes.tick_params(labelbottom=True)
    for axes, title, panel_rows in zip(grid.flat, titles, panels.values(), strict=False):
        axes.set_title("\n".join(title))
        axes.grid(visible=False)
        colours = [_colour(chart, numbers, scale, row) for row in panel_rows]
        if over.up is None:
            _line(axes, chart, numbers, over.across, panel_rows)
        elif over.grid:
            _cells(
                axes,
                over.across,
                over.up,
                panel_rows,
                colours,
                [_text(chart, numbers, row) for row in panel_rows],
                count,
            )
        else:
            _points(axes, chart, numbers, over, panel_rows, colours)
        _ticks(axes.xaxis, over.across, over.grid, _WIDE / count)
        if over.up is not None:
            _ticks(axes.yaxis, over.up, over.grid, inf)
    upright = over.up.head if over.up else chart.title
    middle = 0.5 + 0.5 * below / figure.get_figheight()  # the panels, not the list below them
    figure.supylabel(short(clean(upright), 40), fontsize=7.5, y=middle)
    if known and same is None and over.up is not None:
        bar: Any = figure.colorbar(ScalarMappable(scale[1], scale[0]), ax=list(grid.flat), pad=0.02)
        bar.outline.set_linewidth(0.5)
    cells = over.grid and over.up is not None
    _legend(figure, numbers, others, _signs(chart, rows, numbers, same, cells), columns, cells=cells)


def _legend(figure: Figure, numbers: dict[str, int], others: int, signs: str, columns: int, *, cells: bool) -> None:
    """The drives by number, and what signs mean."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    names = [(f"{n}  {short(clean(name), _LETTERS[columns])}", look_of(n)) for name, n in numbers.items()]
    names += [(f"…  {others} others", OTHERS)] if others else []
    edge: dict[str, Any] = {"markeredgecolor": "#555555", "markeredgewidth": 0.3, "markersize": 4.0}
    handles: list[Any] = [
        Patch(facecolor=look.face, edgecolor="#555555", linewidth=0.3, hatch=2 * look.hatch) if cells
        else Line2D([], [], linestyle="none", marker=look.marker, markerfacecolor=look.face, **edge)
        for _, look in names
    ]  # fmt: skip
    if names or signs:
        figure.legend(
            handles, [name for name, _ in names], loc="outside lower left", ncols=columns, fontsize=6.5, title=signs,
            title_fontsize=6.5, alignment="left", handlelength=1.3, handleheight=0.9, labelspacing=0.35,
        )  # fmt: skip


def _signs(chart: Map, rows: Sequence[dict[str, Any]], numbers: dict[str, int], same: float | None, cells: bool) -> str:
    """A single value, and the meaning of signs."""
    statuses, signs = {row["status"] for row in rows}, list[str]()
    if "fail" in statuses:
        signs.append("hatched: no drive passes" if cells else "×: no drive passes, or an invalid variant")
    if "error" in statuses and cells:
        signs.append("×: an invalid variant")
    if numbers and "unknown" in statuses:
        signs.append("?: a check is unknown")
    if chart.lacks and any(row[chart.lacks] for row in rows):
        signs.append("≥: not known of all parts, at least" if cells else "some are not known of all parts: at least")
    notes = [f"{same:.4g} wherever it is known: one value, so no colour scale"] if same is not None else []
    return "\n".join([*notes, *([";  ".join(signs)] if signs else [])])


def _scale(chart: Map, known: Sequence[float]) -> tuple[Any, Any]:
    """Colours of figures, and their norm."""
    import matplotlib
    from matplotlib.colors import ListedColormap, Normalize, TwoSlopeNorm

    low, high = min(known), max(known)
    if low == high:
        return ListedColormap([_GREY]), Normalize(low - 1.0, high + 1.0)
    if chart.signed and low < 0.0 < high:
        return matplotlib.colormaps["PuOr"], TwoSlopeNorm(0.0, low, high)
    return matplotlib.colormaps["cividis"], Normalize(low, high)


def _colour(chart: Map, numbers: dict[str, int], scale: tuple[Any, Any], row: dict[str, Any]) -> tuple[Any, str]:
    """Colour and pattern of a cell."""
    value, hatch = row[chart.column], _FAILED * (row["status"] == "fail")
    if numbers and value and not hatch:
        look = look_of(numbers.get(value))
        return look.face, look.hatch
    return (_EMPTY if numbers or value is None else scale[0](scale[1](value * chart.scale))), hatch


def _text(chart: Map, numbers: dict[str, int], row: dict[str, Any]) -> str:
    """Text of a cell: ``≥`` before a sum that does not cover all parts, ``?`` after a drive with an unknown check."""
    value = row[chart.column]
    if row["status"] == "error":
        return "×"
    if numbers:
        return f"{numbers.get(value) or '…'}{'?' * (row['status'] == 'unknown')}" if value else ""
    if value is None or row["status"] == "fail":
        return ""
    return f"{'≥' * bool(chart.lacks and row[chart.lacks])}{value * chart.scale:.3g}"


def _places(dimension: Dimension, rows: Sequence[dict[str, Any]]) -> NDArray[np.float64]:
    """Positions of rows along an axis: the number, or the place in its list of values."""
    place = {value: value if dimension.numeric else n for n, value in enumerate(dimension.values)}
    return np.array([float(place.get(row[dimension.head], row[dimension.head])) for row in rows])


def _cells(
    axes: Axes, across: Dimension, up: Dimension, rows: Sequence[dict[str, Any]], colours: Sequence[tuple[Any, str]],
    texts: Sequence[str], panels: int,
) -> None:  # fmt: skip
    """Cells with their texts: in all of them or in none; of a refined map where there is room and no finer one over."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    x, y = _edges(across), _edges(up)
    rounds = [row.get("round", 0) for row in rows]
    places = zip(_places(across, rows), _places(up, rows), rounds, strict=True)
    boxes = [(*_within(x, left, across, n), *_within(y, low, up, n)) for left, low, n in places]
    corners = [[(a, b), (a + wide, b), (a + wide, b + tall), (a, b + tall)] for a, wide, b, tall in boxes]
    for finer in sorted(set(rounds)):  # over the coarser ones
        own = [n for n, of in enumerate(rounds) if of == finer]
        lines = {"edgecolors": "white", "linewidths": 0.4} if len(own) <= _MOST_LINES else {"edgecolors": "face"}
        axes.add_collection(PolyCollection([corners[n] for n in own], facecolors=[colours[n][0] for n in own], **lines))
        for pattern in sorted({colours[n][1] for n in own if colours[n][1]}):
            look: dict[str, Any] = {"facecolors": "none", "linewidths": 0.0, "hatch": pattern}
            look["edgecolors"] = "#999999" if pattern == _FAILED else "#777777"
            axes.add_collection(PolyCollection([corners[n] for n in own if colours[n][1] == pattern], **look))
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    if len(rows) > _MOST_TEXTS:
        return
    across_in, up_in = _WIDE / panels / (x[-1] - x[0]), _TALL / (y[-1] - y[0])  # in, of a unit of each axis
    fits = [wide * across_in > _LETTER * len(text) + 0.04 and tall * up_in > _LINE
            for text, (_, wide, _, tall) in zip(texts, boxes, strict=True)]  # fmt: skip
    if not any(rounds):
        fits = [all(fits)] * len(fits)
    for n, (left, wide, low, tall) in enumerate(boxes):
        over = [box for box, other in zip(boxes, rounds, strict=True) if other > rounds[n] and _overlap(boxes[n], box)]
        if not fits[n] or over or not texts[n]:
            continue
        face, hatch = colours[n]
        put = axes.text(left + wide / 2, low + tall / 2, texts[n], ha="center", va="center", fontsize=6)
        red, green, blue = to_rgb(face)
        put.set_color("white" if 0.299 * red + 0.587 * green + 0.114 * blue < 0.5 else "black")
        if hatch:
            put.set_bbox({"boxstyle": "round,pad=0.12", "facecolor": face, "edgecolor": "none"})


def _overlap(box: Box, other: Box) -> bool:
    """Whether two cells share more than an edge."""
    gaps = [max(a, b) - min(a + wide, b + broad) for a, wide, b, broad in (
        (*box[:2], *other[:2]), (*box[2:], *other[2:])
    )]  # fmt: skip
    return all(gap < -1e-9 * max(box[1], box[3]) for gap in gaps)


def _within(edges: NDArray[np.float64], value: float, dimension: Dimension, halvings: int) -> tuple[float, float]:
    """Lower edge and width of a value's cell after some halvings of the steps."""
    n = int(np.searchsorted(edges, value)) - 1
    if not (halvings and dimension.stepped):
        return float(edges[n]), float(edges[n + 1] - edges[n])
    half = float(edges[n + 1] - edges[n]) / 2 ** (halvings + 1)
    low = float(edges[0]) if value == dimension.values[0] else value - half
    return low, (float(edges[-1]) if value == dimension.values[-1] else value + half) - low


def _edges(dimension: Dimension) -> NDArray[np.float64]:
    """Edges of cells: midway between values, and as far beyond the first and the last."""
    values = (
        np.sort(np.array(dimension.values, float)) if dimension.numeric else np.arange(float(len(dimension.values)))
    )
    between = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - between[0]], between, [2 * values[-1] - between[-1]]])


def _points(
    axes: Axes, chart: Map, numbers: dict[str, int], over: MapAxes, rows: Sequence[dict[str, Any]],
    colours: Sequence[tuple[Any, str]],
) -> None:  # fmt: skip
    """Points of a sample, each with its drive's number where they are few."""
    assert over.up is not None
    x, y = _places(over.across, rows), _places(over.up, rows)
    failed = np.array([row["status"] in ("fail", "error") for row in rows])
    axes.scatter(x[failed], y[failed], marker="x", s=9, linewidths=0.6, color="#999999")
    looks = [look_of(numbers.get(row["set"])).marker if numbers else "o" for row in rows]
    for marker in sorted(set(looks)):
        indices = [n for n, look in enumerate(looks) if look == marker and not failed[n]]
        faces = [colours[n][0] for n in indices]
        axes.scatter(x[indices], y[indices], c=faces, s=16, linewidths=0.3, edgecolors="#555555", marker=marker)
    if numbers and np.count_nonzero(~failed) <= 150:
        for n in np.flatnonzero(~failed).tolist():
            axes.annotate(_text(chart, numbers, rows[n]).rstrip("?"), (x[n], y[n]), xytext=(2.4, 1.6),
                          textcoords="offset points", fontsize=5)  # fmt: skip


def _line(axes: Axes, chart: Map, numbers: dict[str, int], across: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    """The figure, or the number of the drive, over one axis."""
    x = _places(across, rows)
    if numbers:
        y = np.array([float(numbers.get(row["set"]) or nan) for row in rows])
        step = ceil(len(numbers) / _MOST_TICKS)
        axes.set(ylim=(0.0, len(numbers) + 1.0), yticks=range(1, len(numbers) + 1, step))
    else:
        values = [row[chart.column] for row in rows]
        y = np.array([nan if value is None else value * chart.scale for value in values])
    order = np.argsort(x, kind="stable")
    style = "o" if numbers or not across.numeric else "o-"
    axes.plot(x[order], y[order], style, color=COLOURS["blue"], markersize=3)
    failed = [row["status"] in ("fail", "error") for row in rows]
    axes.plot(x[failed], np.zeros(sum(failed)), "x", color="#999999", markersize=4, clip_on=False,
              transform=axes.get_xaxis_transform())  # fmt: skip
    axes.grid(visible=True)


def _ticks(axis: Any, dimension: Dimension, grid: bool, room: float) -> None:
    """Ticks at the values that are words, upright where they have no room [in], and at few numbers of a grid."""
    if dimension.numeric:
        if grid and len(dimension.values) <= 6:
            axis.set_ticks(
                sorted(map(float, dimension.values)), [f"{value:.4g}" for value in sorted(map(float, dimension.values))]
            )
        return
    words = [short(clean(str(value)), 16) for value in dimension.values]
    upright = 90.0 * (0.058 * (max(map(len, words)) + 1) > room / len(words))
    axis.set_ticks(range(len(words)), words, rotation=upright)
