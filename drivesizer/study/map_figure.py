"""A map as a figure: panels side by side with one colour scale, and the list of drives by number below."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from drivesizer.output.report.figures.style import Form, drawn, placed
from drivesizer.output.text import clean, short
from drivesizer.study.map_legend import LINE, listed, numbered, rows_of_list
from drivesizer.study.map_panel import Dimension, Map, Panel, Scene, panel_into, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw"]

_HEIGHT, _SINGLE = 1.75, 2.7  # in, of one of several panels, and of a single one
_WIDTH = 6.5  # in, of the figure
_NO_SCALE = "#DDDDDD"  # colour of cells that all have one value
_WORD = 0.058  # in, of a letter along an axis


def draw(
    shown: Map, panels: Sequence[Panel], across: Dimension, up: Dimension | None, grid: bool, form: Form = "svg"
) -> bytes:
    """Draw a map."""
    rows = [row for panel in panels for row in panel.rows]
    numbers = numbered(rows) if shown.name == "best_set" else {}
    others = len({row["set"] for row in rows if row["set"]} - set(numbers)) if numbers else 0
    same = None if numbers else _one_value(shown, rows)
    signs = _signs(shown, rows, numbers, same, grid and up is not None)
    count = 2 if len(panels) == 4 else min(len(panels), 3)
    lines = ceil(len(panels) / count)
    left, right = _left(up), 0.95 if not numbers and up and same is None else 0.2
    upright = _upright(across, (_WIDTH - left - right) / count)
    bottom = 0.45 + upright + LINE * (rows_of_list(numbers, others) + len(signs) + 0.5)
    height = 0.3 + (_SINGLE if len(panels) == 1 else lines * _HEIGHT) + bottom

    def put(figure: Figure) -> None:
        scene = Scene(shown, across, up, grid, None if numbers else _coloured(shown, rows), numbers)
        places = placed(
            figure, lines, count, left=left, right=right, top=0.3, bottom=bottom, gaps=(0.28, 0.12)
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

    return drawn(put, height, form)


def _left(up: Dimension | None) -> float:
    """Width of the labels and title of the vertical axis [in]."""
    longest = max(map(len, words(up))) if up and not up.numeric else 0
    return max(0.75, 0.4 + _WORD * longest)


def _upright(across: Dimension, room: float) -> float:
    """Extra height of the labels of the horizontal axis where they are turned for want of room [in]."""
    if across.numeric:
        return 0.0
    labels = words(across)
    longest = max(map(len, labels))
    return _WORD * (longest - 1) if _WORD * (longest + 1) > room / len(labels) else 0.0


def _known(shown: Map, rows: Sequence[dict[str, Any]]) -> list[float]:
    known = [row[shown.column] * shown.scale for row in rows if row[shown.column] is not None]
    return [value for value in known if np.isfinite(value)]


def _one_value(shown: Map, rows: Sequence[dict[str, Any]]) -> float | None:
    """The figure where all are equal, so that no colour scale is needed."""
    known = set(_known(shown, rows))
    return known.pop() if len(known) == 1 else None


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
