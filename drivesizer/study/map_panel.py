"""One map: cells of a grid, points of a sample, or a figure over one axis.

Cells show their numbers where there is room; a cell where no drive passes is hatched. Colours of figures are monotonic
in brightness and drives are numbered, so that a grey print is readable.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.text import clean, short
from drivesizer.study.map_legend import OTHERS, Look, look_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Dimension", "Map", "Panel", "Scene", "panel_into", "words"]


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
    x, y = _edges(scene.across), _edges(up)
    rounds = [row.get("round", 0) for row in rows]
    places = zip(_places(scene.across, rows), _places(up, rows), rounds, strict=True)
    boxes = [(*_within(x, across, scene.across, n), *_within(y, high, up, n)) for across, high, n in places]
    faces = [_face(scene, row) for row in rows]
    for finer in sorted(set(rounds)):  # over the coarser ones
        _laid(axes, [(box, face) for box, face, n in zip(boxes, faces, rounds, strict=True) if n == finer])
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    if len(rows) <= _MOST_TEXTS:
        _lettered(axes, [_text(scene, row) for row in rows], boxes, faces, rounds)


def _laid(axes: Axes, cells: Sequence[tuple[Box, tuple[Any, str]]]) -> None:
    """Cells with their colours and patterns."""
    _filled(axes, [box for box, _ in cells], [face for _, (face, _) in cells])
    for pattern in sorted({hatch for _, (_, hatch) in cells if hatch}):
        _hatched(axes, [box for box, (_, hatch) in cells if hatch == pattern], pattern)


def _lettered(
    axes: Axes, texts: Sequence[str], boxes: Sequence[Box], faces: Sequence[tuple[Any, str]], rounds: Sequence[int]
) -> None:
    """Texts in all cells or in none; of a refined map in those that have room and no finer ones over them."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    fits = [_fits(axes, text, (w / (x1 - x0), h / (y1 - y0))) for text, (_, w, _, h) in zip(texts, boxes, strict=True)]
    if not any(rounds):
        fits = [all(fits)] * len(fits)
    for n, (left, width, low, height) in enumerate(boxes):
        finer = (box for box, other in zip(boxes, rounds, strict=True) if other > rounds[n])
        if not fits[n] or any(_overlap(boxes[n], box) for box in finer):
            continue
        face, hatch = faces[n]
        put = axes.text(left + width / 2, low + height / 2, texts[n], ha="center", va="center", fontsize=6)
        put.set_color(_ink(face))
        if hatch and texts[n]:
            put.set_bbox({"boxstyle": "round,pad=0.12", "facecolor": face, "edgecolor": "none"})


def _overlap(one: Box, other: Box) -> bool:
    """Whether two cells share more than an edge."""
    gaps = [max(a, b) - min(a + wide, b + broad) for a, wide, b, broad in (
        (*one[:2], *other[:2]), (*one[2:], *other[2:])
    )]  # fmt: skip
    return all(gap < -1e-9 * max(one[1], one[3]) for gap in gaps)


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


def _ink(face: Any) -> str:
    from matplotlib.colors import to_rgb

    red, green, blue = to_rgb(face)
    return "white" if 0.299 * red + 0.587 * green + 0.114 * blue < 0.5 else "black"


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


def _fits(axes: Axes, text: str, share: tuple[float, float]) -> bool:
    """Whether a text fits a cell that takes some share of the axes' width and height."""
    box, figure = axes.get_position(), axes.get_figure(root=True)
    assert figure is not None
    width, height = figure.get_size_inches()
    room = share[0] * box.width * width, share[1] * box.height * height
    return bool(room[0] > _LETTER * len(text) + 0.04 and room[1] > _TALL)


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
