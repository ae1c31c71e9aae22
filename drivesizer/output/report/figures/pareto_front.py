"""A Pareto front as a figure: two figures of each drive, and the names where there is room for them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer.output.report.figures.style import COLOURS, Form, drawn, placed
from drivesizer.output.text import clean, short

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Box", "overlap", "trade_off"]

_SIZE = 6.5  # pt, of a name
_GAP = 3.5  # pt, between a mark and its name
_DOT = 2.5  # pt, half of a mark
_LONGEST = 34  # letters of a name


class Box(NamedTuple):
    """A rectangle on paper [pt]."""

    left: float
    low: float
    right: float
    high: float


def overlap(a: Box, b: Box) -> bool:
    """Whether two rectangles share more than an edge."""
    return a.left < b.right and b.left < a.right and a.low < b.high and b.low < a.high


def trade_off(
    numbers: Sequence[str],
    names: Sequence[str],
    across: Sequence[float],
    up: Sequence[float],
    heads: Sequence[str],
    form: Form = "svg",
) -> bytes:
    """Sets of a Pareto front by two of their objectives, with numbers as in the table, and names."""
    known = [n for n, (x, y) in enumerate(zip(across, up, strict=True)) if isfinite(x + y)]

    def draw(figure: Figure) -> None:
        axes = placed(figure)[0][0]
        axes.plot([across[n] for n in known], [up[n] for n in known], "o", color=COLOURS["blue"], markersize=2 * _DOT)
        axes.margins(0.08, 0.12)
        axes.set(xlabel=heads[0], ylabel=heads[1])
        texts = [(numbers[n], f"{numbers[n]}  {short(clean(names[n]), _LONGEST)}") for n in known]
        _name(axes, [(across[n], up[n]) for n in known], texts)

    return drawn(draw, 2.9, form)


def _name(axes: Axes, points: Sequence[tuple[float, float]], texts: Sequence[tuple[str, str]]) -> None:
    """Names beside their marks, one after the other, where none covers another, a mark or the edge."""
    axes.autoscale_view()  # now, and not when it is drawn: places on paper follow from it
    figure: Any = axes.figure
    corners = np.array([*axes.get_window_extent().get_points(), *axes.transData.transform(points)])
    corners *= 72.0 / figure.dpi  # pt
    frame, marks = Box(*corners[:2].ravel().tolist()), corners[2:].tolist()
    taken = [Box(x - _DOT, y - _DOT, x + _DOT, y + _DOT) for x, y in marks]
    for (number, name), (x, y), at in zip(texts, marks, points, strict=True):
        for text in (name, number):
            spot = next(_free(x, y, text, taken, frame), None)
            if spot is not None:
                box, offset = spot
                axes.annotate(text, at, xytext=offset, textcoords="offset points", fontsize=_SIZE, va="bottom")
                taken.append(box)
                break


def _free(x: float, y: float, text: str, taken: Sequence[Box], frame: Box) -> Iterator[tuple[Box, tuple[float, float]]]:
    """Places beside a mark that are free: the rectangle, and how far its lower left corner is from the mark."""
    width, height = _extent(text)
    for left in (_GAP, -_GAP - width, -width / 2):
        for low in (-height / 2, _GAP, -_GAP - height):
            if left == -width / 2 and low == -height / 2:
                continue
            box = Box(x + left, y + low, x + left + width, y + low + height)
            inside = frame.left <= box.left and box.right <= frame.right and frame.low <= box.low <= frame.high - height
            if inside and not any(overlap(box, other) for other in taken):
                yield box, (left, low)


def _extent(text: str) -> tuple[float, float]:
    """Width and height of a text [pt]."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    width, _, _ = text_to_path.get_text_width_height_descent(text, FontProperties(size=_SIZE), False)
    return float(width), 1.25 * _SIZE
