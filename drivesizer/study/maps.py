"""Maps of a study: points or cells of a grid, one colour scale, and the list of drives by number below."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import product
from math import ceil, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.output.derivation import clean, short
from drivesizer.output.report.figures.all_figures import figures_into
from drivesizer.output.report.figures.style import COLOURS, Drawing, figure, placed
from drivesizer.study.plan import Plan
from drivesizer.study.rows import Row, columns_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# -- Look of drives on a map, number, colour and pattern or marker, and their list below it.
#
# Colours are Paul Tol's light scheme, made for cells with black letters and distinguishable by the colour-blind (P.
# Tol, Colour Schemes, SRON/EPS/TN/09-002, figure of the light scheme). After the last colour they repeat with
# another pattern, points with another marker. No numbered drive is grey.


LINE = 0.145  # in, of a line of text


class Look(NamedTuple):
    """Look of a drive's cells and points."""

    face: str
    hatch: str
    marker: str


_FACES = ("#77AADD", "#EE8866", "#EEDD88", "#FFAABB", "#99DDFF", "#44BB99", "#BBCC33", "#AAAA00")
_PATTERNS = (("", "o"), ("....", "s"), ("xxxx", "^"), ("||||", "D"), ("----", "v"), ("oooo", "P"), ("++++", "p"))
OTHERS = Look("#DDDDDD", "**", "h")  # drives without a number
_MOST = len(_FACES) * len(_PATTERNS)  # drives with a number of their own
_SHORT = 10  # lines of one column; more take two
_LETTERS = {1: 96, 2: 50}  # of a name, by columns
_INSET, _APART = 0.75, 2.9  # in, from the left edge to the names, and from column to column


def look_of(number: int) -> Look:
    """Look of the drive with a number; different for every number."""
    n, family = (number - 1) % len(_FACES), (number - 1) // len(_FACES)
    return Look(_FACES[n], *_PATTERNS[family])


def numbered(rows: Sequence[dict[str, Any]]) -> dict[str, int]:
    """The drives that are best most often, numbered from 1."""
    often = Counter(row["set"] for row in rows if row["set"])
    first = sorted(often, key=lambda name: (-often[name], name))[:_MOST]
    return {name: number for number, name in enumerate(first, 1)}


def _entries(numbers: dict[str, int], others: int) -> tuple[list[tuple[str, Look]], int]:
    """Names of the list with their looks, and the height of the list in lines."""
    count = len(numbers) + (others > 0)
    columns = 1 if count <= _SHORT else 2
    found = [(f"{n}  {short(clean(name), _LETTERS[columns])}", look_of(n)) for name, n in numbers.items()]
    return found + ([(f"…  {others} other drives", OTHERS)] if others else []), -(-count // columns)


def listed(figure: Figure, numbers: dict[str, int], others: int, low: float, *, cells: bool) -> None:
    """Draw the list into a figure."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle

    width, height = figure.get_size_inches()
    entries, lines = _entries(numbers, others)
    for n, (text, look) in enumerate(entries):
        left, base = _INSET + _APART * (n // lines), low + LINE * (lines - 1 - n % lines)
        figure.text(left / width, base / height, text, va="bottom", fontsize=6.5)
        x, y, wide, tall = (left - 0.2) / width, base / height, 0.13 / width, 0.09 / height
        at: dict[str, Any] = {"transform": figure.transFigure}
        if cells:
            line: dict[str, Any] = {"edgecolor": "#555555", "linewidth": 0.3, "facecolor": look.face}
            figure.add_artist(Rectangle((x, y), wide, tall, hatch=2 * look.hatch, **line, **at))
        else:
            line = {
                "markeredgecolor": "#555555",
                "markeredgewidth": 0.3,
                "markersize": 4.0,
                "markerfacecolor": look.face,
            }
            sample = Line2D([x + wide / 2], [y + tall / 2], linestyle="none", marker=look.marker, **line, **at)
            figure.add_artist(sample)


# -- One map: cells of a grid, points of a sample, or a figure over one axis.
#
# Cells show their numbers where there is room; a cell where no drive passes is hatched. Colours of figures are
# monotonic in brightness and drives are numbered, so that a grey print is readable.


class Map(NamedTuple):
    """A column of the table as a map."""

    name: str
    column: str
    title: str
    scale: float = 1.0  # from the column to what is shown
    lacks: str = ""  # the column of parts that a sum does not cover
    signed: bool = False  # whether the sign matters


class Dimension(NamedTuple):
    """An axis of the study, with its values."""

    name: str
    head: str  # of its column
    values: tuple[Any, ...]
    numeric: bool
    stepped: bool = False  # whether its values are even steps, which refinement halves


class Panel(NamedTuple):
    """One of several maps of a figure, with its rows."""

    title: str
    rows: list[dict[str, Any]]


class Scene(NamedTuple):
    """Settings that all panels of a figure share."""

    shown: Map
    across: Dimension
    up: Dimension | None
    grid: bool
    colours: Any  # matplotlib's map and norm; None for drives
    numbers: dict[str, int]  # of each drive in the list below; empty for figures


Box = tuple[float, float, float, float]  # left, width, low, height of a cell

_WIDE = 6.5  # in, of a figure
_LETTER, _TALL = 0.055, 0.11  # in, of a letter in a cell
_HATCH = "//////"  # where no drive passes
_MOST_TICKS = 20  # numbers of drives along an axis
_MOST_LINES, _MOST_TEXTS = 2500, 700  # cells of a panel that has lines between cells, and numbers in them


def panel_into(axes: Axes, scene: Scene, panel: Panel) -> None:
    """Draw a map into its axes."""
    axes.set_title(short(clean(panel.title), int(axes.get_position().width * _WIDE / _LETTER)))
    axes.grid(visible=False)
    if scene.up is None:
        _line(axes, scene, panel.rows)
    elif scene.grid:
        _cells(axes, scene, scene.up, panel.rows)
    else:
        _points(axes, scene, scene.up, panel.rows)
    _ticks(axes.xaxis, scene.across, scene.grid)
    if scene.up is not None:
        _ticks(axes.yaxis, scene.up, scene.grid)


def _places(one: Dimension, rows: Sequence[dict[str, Any]]) -> NDArray[np.float64]:
    """Positions of rows along an axis: the number, or the place in its list of values."""
    if one.numeric:
        return np.array([float(row[one.head]) for row in rows])
    place = {value: n for n, value in enumerate(one.values)}
    return np.array([float(place[row[one.head]]) for row in rows])


def _cells(axes: Axes, scene: Scene, up: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    from matplotlib.collections import PolyCollection

    x, y = _edges(scene.across), _edges(up)
    rounds = [row.get("round", 0) for row in rows]
    places = zip(_places(scene.across, rows), _places(up, rows), rounds, strict=True)
    boxes = [(*_within(x, across, scene.across, n), *_within(y, high, up, n)) for across, high, n in places]
    faces = [_face(scene, row) for row in rows]
    corners = [
        [(left, low), (left + width, low), (left + width, low + height), (left, low + height)]
        for left, width, low, height in boxes
    ]
    for finer in sorted(set(rounds)):  # over the coarser ones
        own = [n for n, of in enumerate(rounds) if of == finer]
        lines = {"edgecolors": "white", "linewidths": 0.4} if len(own) <= _MOST_LINES else {"edgecolors": "face"}
        axes.add_collection(PolyCollection([corners[n] for n in own], facecolors=[faces[n][0] for n in own], **lines))
        for pattern in sorted({faces[n][1] for n in own if faces[n][1]}):
            look: dict[str, Any] = {"facecolors": "none", "linewidths": 0.0, "hatch": pattern}
            look["edgecolors"] = "#999999" if pattern == _HATCH else "#777777"
            axes.add_collection(PolyCollection([corners[n] for n in own if faces[n][1] == pattern], **look))
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    if len(rows) <= _MOST_TEXTS:
        _lettered(axes, [_text(scene, row) for row in rows], boxes, faces, rounds)


def _lettered(
    axes: Axes, texts: Sequence[str], boxes: Sequence[Box], faces: Sequence[tuple[Any, str]], rounds: Sequence[int]
) -> None:
    """Texts in all cells or in none; of a refined map in those that have room and no finer ones over them."""
    from matplotlib.colors import to_rgb

    (x0, x1), (y0, y1), position, figure = axes.get_xlim(), axes.get_ylim(), axes.get_position(), axes.get_figure(True)
    assert figure is not None
    wide, tall = figure.get_size_inches()
    across, upward = position.width * wide / (x1 - x0), position.height * tall / (y1 - y0)  # in, of a unit of each axis
    fits = [
        bool(width * across > _LETTER * len(text) + 0.04 and height * upward > _TALL)
        for text, (_, width, _, height) in zip(texts, boxes, strict=True)
    ]
    if not any(rounds):
        fits = [all(fits)] * len(fits)
    for n, (left, width, low, height) in enumerate(boxes):
        finer = (box for box, other in zip(boxes, rounds, strict=True) if other > rounds[n])
        if not fits[n] or any(_overlap(boxes[n], box) for box in finer):
            continue
        face, hatch = faces[n]
        put = axes.text(left + width / 2, low + height / 2, texts[n], ha="center", va="center", fontsize=6)
        red, green, blue = to_rgb(face)
        put.set_color("white" if 0.299 * red + 0.587 * green + 0.114 * blue < 0.5 else "black")
        if hatch and texts[n]:
            put.set_bbox({"boxstyle": "round,pad=0.12", "facecolor": face, "edgecolor": "none"})


def _overlap(one: Box, other: Box) -> bool:
    """Whether two cells share more than an edge."""
    gaps = [max(a, b) - min(a + wide, b + broad) for a, wide, b, broad in (
        (*one[:2], *other[:2]), (*one[2:], *other[2:])
    )]  # fmt: skip
    return all(gap < -1e-9 * max(one[1], one[3]) for gap in gaps)


def _within(edges: NDArray[np.float64], value: float, one: Dimension, halvings: int) -> tuple[float, float]:
    """Lower edge and width of a value's cell after some halvings of the steps."""
    n = int(np.searchsorted(edges, value)) - 1
    if not (halvings and one.stepped):
        return float(edges[n]), float(edges[n + 1] - edges[n])
    half = float(edges[n + 1] - edges[n]) / 2 ** (halvings + 1)
    low = float(edges[0]) if value == one.values[0] else value - half
    return low, (float(edges[-1]) if value == one.values[-1] else value + half) - low


def _edges(one: Dimension) -> NDArray[np.float64]:
    """Edges of cells: midway between values, and as far beyond the first and the last."""
    values = np.sort(np.array(one.values, float)) if one.numeric else np.arange(float(len(one.values)))
    between = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - between[0]], between, [2 * values[-1] - between[-1]]])


def _face(scene: Scene, row: dict[str, Any]) -> tuple[Any, str]:
    """Colour and hatching of a cell."""
    value = row[scene.shown.column]
    if row["status"] == "error":
        return "white", ""
    if scene.numbers:
        if row["status"] == "fail" or not value:
            return "#F4F4F4", _HATCH if row["status"] == "fail" else ""
        look = _look(scene, value)
        return look.face, look.hatch
    hatch = _HATCH if row["status"] == "fail" else ""
    if value is None:
        return "#F4F4F4", hatch
    colours, norm = scene.colours
    return colours(norm(value * scene.shown.scale)), hatch


def _look(scene: Scene, name: str) -> Look:
    number = scene.numbers.get(name)
    return look_of(number) if number else OTHERS


def _text(scene: Scene, row: dict[str, Any]) -> str:
    """Text of a cell: ``≥`` before a sum that does not cover all parts, ``?`` after a drive with an unknown check."""
    value = row[scene.shown.column]
    if row["status"] == "error":
        return "×"
    if scene.numbers:
        number = scene.numbers.get(value)
        return f"{number or '…'}{'?' * (row['status'] == 'unknown')}" if value else ""
    if value is None or row["status"] == "fail":
        return ""
    return f"{'≥' * bool(scene.shown.lacks and row[scene.shown.lacks])}{value * scene.shown.scale:.3g}"


def _points(axes: Axes, scene: Scene, up: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    x, y = _places(scene.across, rows), _places(up, rows)
    failed = np.array([row["status"] in ("fail", "error") for row in rows])
    axes.scatter(x[failed], y[failed], marker="x", s=9, linewidths=0.6, color="#999999")
    faces = [_face(scene, row)[0] for row in rows]
    kept = [n for n in range(len(rows)) if not failed[n]]
    looks = [_look(scene, rows[n]["set"]).marker if scene.numbers else "o" for n in kept]
    for marker in sorted(set(looks)):
        some = [n for n, look in zip(kept, looks, strict=True) if look == marker]
        axes.scatter(x[some], y[some], c=[faces[n] for n in some], s=16, linewidths=0.3, edgecolors="#555555",
                     marker=marker)  # fmt: skip
    if scene.numbers and len(kept) <= 150:
        for n in kept:
            axes.annotate(_text(scene, rows[n]).rstrip("?"), (x[n], y[n]), xytext=(2.4, 1.6),
                          textcoords="offset points", fontsize=5)  # fmt: skip


def _line(axes: Axes, scene: Scene, rows: Sequence[dict[str, Any]]) -> None:
    """The figure, or the number of the drive, over one axis."""
    x = _places(scene.across, rows)
    if scene.numbers:
        y = np.array([float(scene.numbers.get(row["set"]) or nan) for row in rows])
        every = ceil(len(scene.numbers) / _MOST_TICKS)
        axes.set(ylim=(0.0, len(scene.numbers) + 1.0), yticks=range(1, len(scene.numbers) + 1, every))
    else:
        values = [row[scene.shown.column] for row in rows]
        y = np.array([nan if value is None else value * scene.shown.scale for value in values])
    order = np.argsort(x, kind="stable")
    style = "o" if scene.numbers or not scene.across.numeric else "o-"
    axes.plot(x[order], y[order], style, color=COLOURS["blue"], markersize=3)
    failed = [row["status"] in ("fail", "error") for row in rows]
    axes.plot(x[failed], np.zeros(sum(failed)), "x", color="#999999", markersize=4, clip_on=False,
              transform=axes.get_xaxis_transform())  # fmt: skip
    axes.grid(visible=True)


def _ticks(axis: Any, one: Dimension, grid: bool) -> None:
    if one.numeric and not (grid and len(one.values) <= 6):
        return
    places = sorted(map(float, one.values)) if one.numeric else range(len(one.values))
    axis.set_ticks(list(places), [f"{place:.4g}" for place in places] if one.numeric else words(one))


def words(one: Dimension) -> list[str]:
    """Labels of an axis without numbers."""
    return [short(clean(str(value)), 16) for value in one.values]


# -- A map as a figure: panels side by side with one colour scale, and the list of drives by number below.


_HEIGHT, _SINGLE = 1.75, 2.7  # in, of one of several panels, and of a single one
_WIDTH = 6.5  # in, of the figure
_NO_SCALE = "#DDDDDD"  # colour of cells that all have one value
_WORD = 0.058  # in, of a letter along an axis


@figure
def draw(
    figure: Figure, shown: Map, panels: Sequence[Panel], across: Dimension, up: Dimension | None, grid: bool
) -> None:
    """Draw a map."""
    rows = [row for panel in panels for row in panel.rows]
    numbers = numbered(rows) if shown.name == "best_set" else {}
    others = len({row["set"] for row in rows if row["set"]} - set(numbers)) if numbers else 0
    values = set() if numbers else set(_known(shown, rows))
    same = values.pop() if len(values) == 1 else None  # no colour scale is needed
    signs = _signs(shown, rows, numbers, same, grid and up is not None)
    count = 2 if len(panels) == 4 else min(len(panels), 3)
    lines = ceil(len(panels) / count)
    longest = max(map(len, words(up))) if up and not up.numeric else 0  # label of the vertical axis
    left, right = max(0.75, 0.4 + _WORD * longest), 0.95 if not numbers and up and same is None else 0.2
    upright = 0.0  # in, of labels of the horizontal axis that are turned for want of room
    if not across.numeric:
        letters = max(map(len, words(across)))
        if _WORD * (letters + 1) > (_WIDTH - left - right) / count / len(across.values):
            upright = _WORD * (letters - 1)
    bottom = 0.45 + upright + LINE * (_entries(numbers, others)[1] + len(signs) + 0.5)
    height = 0.3 + (_SINGLE if len(panels) == 1 else lines * _HEIGHT) + bottom

    scene = Scene(shown, across, up, grid, None if numbers else _coloured(shown, rows), numbers)
    places = placed(
        figure, height, lines, count, left=left, right=right, top=0.3, bottom=bottom, gaps=(0.28, 0.12)
    )  # fmt: skip
    flat = [axes for line in places for axes in line]
    for axes, panel in zip(flat, panels, strict=False):
        panel_into(axes, scene, panel)
        if upright:
            axes.tick_params(axis="x", labelrotation=90.0)
            down = axes.xaxis.label.get_position()[1] - upright / (axes.get_position().height * height)
            axes.xaxis.set_label_coords(0.5, down)
    for axes in flat[len(panels) :]:
        axes.set_visible(False)
    _labelled(figure, places, scene, len(panels))
    if same is None and not numbers and up is not None:
        _scaled(figure, places, scene)
    listed(figure, numbers, others, 0.06 + LINE * len(signs), cells=grid and up is not None)
    for n, line in enumerate(reversed(signs)):
        figure.text(0.75 / _WIDTH, (0.06 + LINE * n) / height, line, va="bottom", fontsize=6.5)


def _known(shown: Map, rows: Sequence[dict[str, Any]]) -> list[float]:
    known = [row[shown.column] * shown.scale for row in rows if row[shown.column] is not None]
    return [value for value in known if np.isfinite(value)]


def _coloured(shown: Map, rows: Sequence[dict[str, Any]]) -> Any:
    import matplotlib
    from matplotlib.colors import ListedColormap, Normalize, TwoSlopeNorm

    known = _known(shown, rows) or [0.0]
    low, high = min(known), max(known)
    if low == high:
        return ListedColormap([_NO_SCALE]), Normalize(low - 1.0, high + 1.0)
    if shown.signed and low < 0.0 < high:
        return matplotlib.colormaps["PuOr"], TwoSlopeNorm(0.0, low, high)
    return matplotlib.colormaps["cividis"], Normalize(low, high)


def _labelled(figure: Figure, places: list[list[Axes]], scene: Scene, count: int) -> None:
    """Axis labels at the edges, and the title."""
    columns = len(places[0])
    for n in range(count):
        axes = places[n // columns][n % columns]
        if n + columns >= count:
            axes.set_xlabel(short(clean(scene.across.head), 40))
            axes.tick_params(labelbottom=True)
        if n % columns == 0:
            own = scene.shown.title if scene.up is None and not scene.numbers else "Drive" if scene.up is None else ""
            axes.set_ylabel(short(clean(scene.up.head if scene.up else own), 40))
    width, height = figure.get_size_inches()
    figure.text(0.05 / width, 1.0 - 0.04 / height, scene.shown.title, va="top", fontsize=8, fontweight="bold")


def _scaled(figure: Figure, places: list[list[Axes]], scene: Scene) -> None:
    """The colour scale beside the panels."""
    from matplotlib.cm import ScalarMappable

    width = figure.get_size_inches()[0]
    first, last = places[-1][0].get_position(), places[0][0].get_position()
    box = figure.add_axes((1.0 - 0.8 / width, first.y0, 0.13 / width, last.y1 - first.y0))
    bar: Any = figure.colorbar(ScalarMappable(scene.colours[1], scene.colours[0]), cax=box)
    bar.outline.set_linewidth(0.5)
    box.grid(visible=False)


def _signs(
    shown: Map, rows: Sequence[dict[str, Any]], numbers: dict[str, int], same: float | None, cells: bool
) -> list[str]:
    """Lines below the panels: a single value, and the meaning of signs."""
    lines = [f"{same:.4g} wherever it is known: one value, so no colour scale"] if same is not None else []
    statuses = {row["status"] for row in rows}
    signs = []
    if "fail" in statuses:
        signs.append("hatched: no drive passes" if cells else "×: no drive passes, or an invalid variant")
    if "error" in statuses and cells:
        signs.append("×: an invalid variant")
    if numbers and "unknown" in statuses:
        signs.append("?: a check is unknown")
    if shown.lacks and any(row[shown.lacks] for row in rows):
        signs.append("≥: not known of all parts, at least" if cells else "some are not known of all parts: at least")
    return lines + ([";  ".join(signs)] if signs else [])


# -- Maps of a study and their points.
#
# A map is over two axes; the others have a panel for each combination of their values. For a Latin hypercube the
# other fields keep their sampled values.


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


def points(plan: Plan, over: MapAxes, rows: Iterable[Row]) -> Points:
    """The best row of each variant by panel, with the columns that maps need."""
    heads = [column.head for column in columns_of(plan)]
    wanted = {over.across.head, *([over.up.head] if over.up else []), *(one.head for one in over.beside), "status"}
    wanted |= {name for one in MAPS for name in (one.column, one.lacks) if name in heads}
    places = {name: heads.index(name) for name in wanted}
    rank, number = heads.index("rank"), heads.index("variant")
    found: Points = {key: [] for key in product(*(one.values for one in over.beside))}
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
            made[one.name] = draw(one, shown, over.across, over.up, over.grid)
    return made, notes


def _title(beside: Sequence[Dimension], key: Sequence[Any]) -> str:
    """Short label of a panel: fields without their sections, and their values."""
    found = []
    for one, value in zip(beside, key, strict=True):
        unit = one.head.removeprefix(one.name).strip(" ()")
        named = f"{one.name.rpartition('.')[2]} {value:g} {unit}".rstrip() if one.numeric else str(value)
        found.append(f"by {value}" if one.name == "objective" else named)
    return ", ".join(found)


def draw_maps(plan: Plan, rows: Iterable[Row], over: MapAxes, folder: Path) -> tuple[list[Path], list[str]]:
    """Write the maps of a study into a folder; files and notes."""
    if plan.total > MOST_POINTS:
        return [], [f"no maps: more than {MOST_POINTS} variants; the tables have all"]
    found, left_out = drawings(over, points(plan, over, rows))
    return figures_into(found, folder) if found else [], left_out
