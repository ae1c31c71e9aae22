"""One map: cells of a grid, points of a sample, or a figure over one thing that varies.

The numbers stand in the cells where there is room for them; where no set stands a cell is hatched. Colours of figures
are of one scale of brightness, and sets are numbered, so that a grey print tells the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.text import clean, short
from drivesizer.study.map_sets import OTHERS, Look, look_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Dimension", "Map", "Panel", "Scene", "panel_into", "words"]


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


class Scene(NamedTuple):
    """What all panels of a figure share."""

    shown: Map
    across: Dimension
    up: Dimension | None
    grid: bool
    colours: Any  # matplotlib's map and norm; None for sets
    numbers: dict[str, int]  # of each set that has a line below; empty for figures


Box = tuple[float, float, float, float]  # left, width, low, height of a cell

_WIDE = 6.5  # in, of a figure
_LETTER, _TALL = 0.055, 0.11  # in, of a letter in a cell
_HATCH = "//////"  # no set's
_MOST_TICKS = 20  # numbers of sets along an axis
_MOST_LINES, _MOST_TEXTS = 2500, 700  # cells of a panel with lines between them, and with numbers in them


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
    """Where rows lie along something that varies: at the number, or at the place in the list."""
    if one.numeric:
        return np.array([float(row[one.head]) for row in rows])
    place = {value: n for n, value in enumerate(one.values)}
    return np.array([float(place[row[one.head]]) for row in rows])


def _cells(axes: Axes, scene: Scene, up: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    x, y = _edges(scene.across), _edges(up)
    places = zip(_places(scene.across, rows), _places(up, rows), strict=True)
    boxes = [(*_within(x, across), *_within(y, high)) for across, high in places]
    faces = [_face(scene, row) for row in rows]
    _filled(axes, boxes, [face for face, _ in faces])
    for pattern in sorted({hatch for _, hatch in faces if hatch}):
        _hatched(axes, [box for box, (_, hatch) in zip(boxes, faces, strict=True) if hatch == pattern], pattern)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    told = [_text(scene, row) for row in rows] if len(rows) <= _MOST_TEXTS else []
    whole = x[-1] - x[0], y[-1] - y[0]
    if all(_fits(axes, text, (w / whole[0], h / whole[1])) for text, (_, w, _, h) in zip(told, boxes, strict=False)):
        for text, (left, width, low, height), (face, hatch) in zip(told, boxes, faces, strict=False):
            put = axes.text(left + width / 2, low + height / 2, text, ha="center", va="center", fontsize=6)
            put.set_color(_ink(face))
            if hatch and text:
                put.set_bbox({"boxstyle": "round,pad=0.12", "facecolor": face, "edgecolor": "none"})


def _corners(boxes: Sequence[Box]) -> list[list[tuple[float, float]]]:
    return [
        [(left, low), (left + width, low), (left + width, low + height), (left, low + height)]
        for left, width, low, height in boxes
    ]


def _filled(axes: Axes, boxes: Sequence[Box], faces: Sequence[Any]) -> None:
    from matplotlib.collections import PolyCollection

    lines = {"edgecolors": "white", "linewidths": 0.4} if len(boxes) <= _MOST_LINES else {"edgecolors": "face"}
    axes.add_collection(PolyCollection(_corners(boxes), facecolors=faces, **lines))


def _hatched(axes: Axes, boxes: Sequence[Box], pattern: str) -> None:
    from matplotlib.collections import PolyCollection

    colour = "#999999" if pattern == _HATCH else "#777777"
    look: dict[str, Any] = {"facecolors": "none", "edgecolors": colour, "linewidths": 0.0, "hatch": pattern}
    axes.add_collection(PolyCollection(_corners(boxes), **look))


def _within(edges: NDArray[np.float64], value: float) -> tuple[float, float]:
    """Where the cell of a value begins, and how wide it is."""
    n = int(np.searchsorted(edges, value)) - 1
    return float(edges[n]), float(edges[n + 1] - edges[n])


def _edges(one: Dimension) -> NDArray[np.float64]:
    """Between the values, half of the way to the next, and as far beyond the first and the last."""
    at = np.sort(np.array(one.values, float)) if one.numeric else np.arange(float(len(one.values)))
    between = (at[1:] + at[:-1]) / 2
    return np.concatenate([[2 * at[0] - between[0]], between, [2 * at[-1] - between[-1]]])


def _face(scene: Scene, row: dict[str, Any]) -> tuple[Any, str]:
    """Colour of a cell, and what is hatched over it."""
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


def _ink(face: Any) -> str:
    from matplotlib.colors import to_rgb

    red, green, blue = to_rgb(face)
    return "white" if 0.299 * red + 0.587 * green + 0.114 * blue < 0.5 else "black"


def _text(scene: Scene, row: dict[str, Any]) -> str:
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


def _fits(axes: Axes, text: str, share: tuple[float, float]) -> bool:
    """Whether a text has room in a cell that takes some share of the axes across and up."""
    box, figure = axes.get_position(), axes.get_figure(root=True)
    assert figure is not None
    width, height = figure.get_size_inches()
    room = share[0] * box.width * width, share[1] * box.height * height
    return bool(room[0] > _LETTER * len(text) + 0.04 and room[1] > _TALL)


def _points(axes: Axes, scene: Scene, up: Dimension, rows: Sequence[dict[str, Any]]) -> None:
    x, y = _places(scene.across, rows), _places(up, rows)
    fell = np.array([row["status"] in ("fail", "error") for row in rows])
    axes.scatter(x[fell], y[fell], marker="x", s=9, linewidths=0.6, color="#999999")
    faces = [_face(scene, row)[0] for row in rows]
    kept = [n for n in range(len(rows)) if not fell[n]]
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
    """Over one thing that varies: the figure itself, or the number of the set."""
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
    fell = [row["status"] in ("fail", "error") for row in rows]
    axes.plot(x[fell], np.zeros(sum(fell)), "x", color="#999999", markersize=4, clip_on=False,
              transform=axes.get_xaxis_transform())  # fmt: skip
    axes.grid(visible=True)


def _ticks(axis: Any, one: Dimension, grid: bool) -> None:
    if one.numeric and not (grid and len(one.values) <= 6):
        return
    places = sorted(map(float, one.values)) if one.numeric else range(len(one.values))
    axis.set_ticks(list(places), [f"{place:.4g}" for place in places] if one.numeric else words(one))


def words(one: Dimension) -> list[str]:
    """What is no number, as it stands along an axis."""
    return [short(clean(str(value)), 16) for value in one.values]
