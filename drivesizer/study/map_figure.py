"""A map as a figure: cells of a grid or points of a sample, coloured by a figure or by the set that is best there.

The numbers stand in the cells where there is room for them; where no set stands a cell is hatched. Colours are of one
brightness scale, and sets are numbered, so that a grey print tells the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import ceil, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.report.style import COLOURS, Form, drawn, placed
from drivesizer.report.wording import clean, short

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Dimension", "Map", "Panel", "draw"]


class Map(NamedTuple):
    """A column of the table as a map."""

    name: str
    column: str
    title: str
    scale: float = 1.0  # from the column to what is shown
    lacks: str = ""  # the column that says which parts a sum does not cover
    signed: bool = False  # below zero is another thing than above


class Dimension(NamedTuple):
    """Something that varies."""

    name: str
    head: str  # of its column
    values: tuple[Any, ...]
    numeric: bool


class Panel(NamedTuple):
    """A map among others: what they differ by, and its rows."""

    title: str
    rows: list[dict[str, Any]]


class _Scene(NamedTuple):
    """What all panels of a figure share."""

    shown: Map
    across: Dimension
    up: Dimension | None
    grid: bool
    colours: Any  # matplotlib's map and norm; None for sets
    numbers: dict[str, int]  # of each set that has a line below; empty for figures


_HEIGHT, _SINGLE = 1.75, 2.7  # in, of a panel among several, and alone
_LINE = 0.145  # in, of a line of text
_SETS = 14  # with a line of their own
_ROOM = 0.155, 0.12  # in, that a number in a cell takes for each letter's half, and up
_HATCH = "//////"
_FACES = [COLOURS[name] for name in ("sky", "orange", "green", "purple", "vermillion", "blue")] + ["#F0E442", "#BBBBBB"]


def draw(
    shown: Map, panels: Sequence[Panel], across: Dimension, up: Dimension | None, grid: bool, form: Form = "svg"
) -> bytes:
    """Draw a map.

    Parameters
    ----------
    shown
        Which figure of the best sets, or the sets.
    panels
        The maps that stand beside each other.
    across, up
        What they are over; without the second the figure is drawn over the first.
    grid
        Whether the rows fill a grid; else they are points.
    form
        Of the drawing.
    """
    rows = [row for panel in panels for row in panel.rows]
    numbers = _numbered(rows) if shown.name == "best_set" else {}
    below = _below(shown, rows, numbers, grid and up is not None)
    count = min(len(panels), 3)
    lines = ceil(len(panels) / count)
    height = 0.3 + (_SINGLE if len(panels) == 1 else lines * _HEIGHT) + 0.45 + _LINE * (len(below) + 0.5)

    def put(figure: Figure) -> None:
        scene = _Scene(shown, across, up, grid, None if numbers else _coloured(shown, rows), numbers)
        bottom = 0.45 + _LINE * (len(below) + 0.5)
        places = placed(
            figure, lines, count, left=0.75, right=0.95 if scene.colours and up else 0.2, top=0.3, bottom=bottom,
            gaps=(0.28, 0.12),
        )  # fmt: skip
        flat = [axes for line in places for axes in line]
        for axes, panel in zip(flat, panels, strict=False):
            _panel(axes, scene, panel)
        for axes in flat[len(panels) :]:
            axes.set_visible(False)
        _labelled(figure, places, scene, len(panels))
        _told_below(figure, below, numbers)

    return drawn(put, height, form)


def _numbered(rows: Sequence[dict[str, Any]]) -> dict[str, int]:
    """The sets that are best most often, numbered from 1."""
    often = Counter(row["set"] for row in rows if row["set"])
    first = sorted(often, key=lambda name: (-often[name], name))[:_SETS]
    return {name: number for number, name in enumerate(first, 1)}


def _coloured(shown: Map, rows: Sequence[dict[str, Any]]) -> Any:
    import matplotlib
    from matplotlib.colors import Normalize, TwoSlopeNorm

    known = [row[shown.column] * shown.scale for row in rows if row[shown.column] is not None]
    known = [value for value in known if np.isfinite(value)] or [0.0]
    low, high = min(known), max(known)
    if low == high:
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    if shown.signed and low < 0.0 < high:
        return matplotlib.colormaps["PuOr"], TwoSlopeNorm(0.0, low, high)
    return matplotlib.colormaps["cividis"], Normalize(low, high)


# --- a panel


def _panel(axes: Axes, scene: _Scene, panel: Panel) -> None:
    axes.set_title(short(clean(panel.title), 44))
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
    """Where rows lie along something that varies: at the number, or at the place in the list."""
    if one.numeric:
        return np.array([float(row[one.head]) for row in rows])
    place = {value: n for n, value in enumerate(one.values)}
    return np.array([float(place[row[one.head]]) for row in rows])


def _cells(axes: Axes, scene: _Scene, up: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    from matplotlib.patches import Rectangle

    x, y = _edges(scene.across), _edges(up)
    for row, across, high in zip(rows, _places(scene.across, rows), _places(up, rows), strict=True):
        left, low = (int(np.searchsorted(e, v)) - 1 for e, v in ((x, across), (y, high)))
        corner, size = (x[left], y[low]), (x[left + 1] - x[left], y[low + 1] - y[low])
        face, hatch = _face(scene, row)
        axes.add_patch(Rectangle(corner, *size, facecolor=face, edgecolor="white", linewidth=0.4))
        if hatch:
            axes.add_patch(Rectangle(corner, *size, fill=False, edgecolor="#999999", linewidth=0.0, hatch=hatch))
        text = _text(scene, row)
        if text and _fits(axes, text, size, (x[-1] - x[0], y[-1] - y[0])):
            axes.annotate(text, (corner[0] + size[0] / 2, corner[1] + size[1] / 2), ha="center", va="center",
                          fontsize=6, color=_ink(face))  # fmt: skip
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))


def _edges(one: Dimension) -> NDArray[np.float64]:
    """Between the values, half of the way to the next, and as far beyond the first and the last."""
    at = np.sort(np.array(one.values, float)) if one.numeric else np.arange(float(len(one.values)))
    between = (at[1:] + at[:-1]) / 2
    return np.concatenate([[2 * at[0] - between[0]], between, [2 * at[-1] - between[-1]]])


def _face(scene: _Scene, row: dict[str, Any]) -> tuple[Any, str]:
    """Colour of a cell, and what is hatched over it."""
    value = row[scene.shown.column]
    if row["status"] == "error":
        return "white", ""
    if scene.numbers:
        number = scene.numbers.get(value)
        if row["status"] == "fail":
            return "#F4F4F4", _HATCH
        return (_tinted(_FACES[(number - 1) % len(_FACES)]) if number else "#E2E2E2"), ""
    hatch = _HATCH if row["status"] == "fail" else ""
    if value is None:
        return "#F4F4F4", hatch
    colours, norm = scene.colours
    return colours(norm(value * scene.shown.scale)), hatch


def _tinted(colour: str) -> Any:
    from matplotlib.colors import to_rgb

    return tuple(1.0 - 0.55 * (1.0 - part) for part in to_rgb(colour))


def _ink(face: Any) -> str:
    from matplotlib.colors import to_rgb

    red, green, blue = to_rgb(face)
    return "white" if 0.299 * red + 0.587 * green + 0.114 * blue < 0.5 else "black"


def _text(scene: _Scene, row: dict[str, Any]) -> str:
    """What stands in a cell: ``≥`` before a sum that does not cover all, ``?`` behind a set with an unknown check."""
    value = row[scene.shown.column]
    if row["status"] == "error":
        return "×"
    if scene.numbers:
        number = scene.numbers.get(value)
        return f"{number or '…'}{'?' * (row['status'] == 'unknown')}" if value else ""
    if value is None or row["status"] == "fail":
        return ""
    return f"{'≥' * bool(scene.shown.lacks and row[scene.shown.lacks])}{value * scene.shown.scale:.3g}"


def _fits(axes: Axes, text: str, size: tuple[float, float], whole: tuple[float, float]) -> bool:
    """Whether a text has room in a cell."""
    box, figure = axes.get_position(), axes.figure
    width, height = figure.get_size_inches()  # type: ignore[union-attr]
    room = size[0] / whole[0] * box.width * width, size[1] / whole[1] * box.height * height
    return room[0] > 0.06 * len(text) + 0.04 and room[1] > _ROOM[1]


def _points(axes: Axes, scene: _Scene, up: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    x, y = _places(scene.across, rows), _places(up, rows)
    fell = np.array([row["status"] in ("fail", "error") for row in rows])
    axes.scatter(x[fell], y[fell], marker="x", s=9, linewidths=0.6, color="#999999")
    faces = [_face(scene, row)[0] for row in rows]
    kept = [n for n in range(len(rows)) if not fell[n]]
    axes.scatter(x[kept], y[kept], c=[faces[n] for n in kept], s=16, linewidths=0.3, edgecolors="#555555")
    if scene.numbers and len(kept) <= 150:
        for n in kept:
            axes.annotate(_text(scene, rows[n]).rstrip("?"), (x[n], y[n]), xytext=(2.4, 1.6),
                          textcoords="offset points", fontsize=5)  # fmt: skip


def _line(axes: Axes, scene: _Scene, rows: Sequence[dict[str, Any]]) -> None:
    """Over one thing that varies: the figure itself, or the number of the set."""
    x = _places(scene.across, rows)
    if scene.numbers:
        y = np.array([float(scene.numbers.get(row["set"]) or nan) for row in rows])
        axes.set(ylim=(0.0, len(scene.numbers) + 1.0), yticks=range(1, len(scene.numbers) + 1))
    else:
        values = [row[scene.shown.column] for row in rows]
        y = np.array([nan if value is None else value * scene.shown.scale for value in values])
    order = np.argsort(x, kind="stable")
    style = "o" if scene.numbers or not scene.across.numeric else "o-"
    axes.plot(x[order], y[order], style, color=COLOURS["blue"], markersize=3)
    fell = [row["status"] in ("fail", "error") for row in rows]
    axes.plot(x[fell], np.zeros(sum(fell)), "x", color="#999999", markersize=4, clip_on=False,
              transform=axes.get_xaxis_transform())  # fmt: skip
    axes.grid(visible=True)


def _ticks(axis: Any, one: Dimension, grid: bool) -> None:
    if one.numeric and not (grid and len(one.values) <= 6):
        return
    places = sorted(map(float, one.values)) if one.numeric else range(len(one.values))
    texts = [f"{place:g}" for place in places] if one.numeric else [short(clean(str(v)), 16) for v in one.values]
    axis.set_ticks(list(places), texts)


# --- around the panels


def _labelled(figure: Figure, places: list[list[Axes]], scene: _Scene, count: int) -> None:
    """Names of the axes at the edges, the title, the scale of colours."""
    columns = len(places[0])
    for n in range(count):
        axes = places[n // columns][n % columns]
        if n + columns >= count:
            axes.set_xlabel(short(clean(scene.across.head), 40))
            axes.tick_params(labelbottom=True)
        if n % columns == 0:
            own = scene.shown.title if scene.up is None and not scene.numbers else "Set" if scene.up is None else ""
            axes.set_ylabel(short(clean(scene.up.head if scene.up else own), 40))
    width, height = figure.get_size_inches()
    figure.text(0.05 / width, 1.0 - 0.04 / height, scene.shown.title, va="top", fontsize=8, fontweight="bold")
    if scene.colours and scene.up is not None:
        from matplotlib.cm import ScalarMappable

        first, last = places[-1][0].get_position(), places[0][0].get_position()
        box = figure.add_axes((1.0 - 0.8 / width, first.y0, 0.13 / width, last.y1 - first.y0))
        figure.colorbar(ScalarMappable(scene.colours[1], scene.colours[0]), cax=box).outline.set_linewidth(0.5)


def _below(shown: Map, rows: Sequence[dict[str, Any]], numbers: dict[str, int], cells: bool) -> list[str]:
    """The lines below: the sets by number, and what the signs mean."""
    lines = [f"{number}  {short(clean(name), 96)}" for name, number in numbers.items()]
    others = {row["set"] for row in rows if row["set"]} - set(numbers) if numbers else set()
    if others:
        lines.append(f"…  {len(others)} other sets")
    statuses = {row["status"] for row in rows}
    signs = []
    if "fail" in statuses:
        signs.append("hatched: no set stands" if cells else "×: no set stands, or no machine")
    if "error" in statuses and cells:
        signs.append("×: not a machine")
    if numbers and "unknown" in statuses:
        signs.append("?: a check is unknown")
    if shown.lacks and any(row[shown.lacks] for row in rows):
        signs.append("≥: not known of all parts, so at least" if cells else "some are not known of all parts: at least")
    return lines + ([";  ".join(signs)] if signs else [])


def _told_below(figure: Figure, lines: Sequence[str], numbers: dict[str, int]) -> None:
    width, height = figure.get_size_inches()
    for n, line in enumerate(reversed(lines)):
        at = (0.06 + _LINE * n) / height
        figure.text(0.75 / width, at, line, va="bottom", fontsize=6.5)
        known = [number for number in numbers.values() if line.startswith(f"{number} ")]
        if known:
            from matplotlib.patches import Rectangle

            face = _tinted(_FACES[(known[0] - 1) % len(_FACES)])
            figure.add_artist(
                Rectangle((0.55 / width, at), 0.13 / width, 0.09 / height, facecolor=face, edgecolor="#777777",
                          linewidth=0.3, transform=figure.transFigure)
            )  # fmt: skip
