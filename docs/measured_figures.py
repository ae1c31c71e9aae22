"""Figures of the page on measured drives, in the style of the report: bands, and points inside and outside."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from textwrap import fill
from typing import Any

import numpy as np
from measured_compared import Comparison

from drivesizer.output.report.figures.style import COLOURS, Drawing

__all__ = ["drawing"]

_ACROSS = 3
_LETTERS = 40  # of a line of a title
_HEIGHT = 2.0  # in, of a row of panels
_POINT: dict[str, Any] = {"linestyle": "none", "markersize": 3.0, "zorder": 3}
_INSIDE = _POINT | {"marker": "o", "color": COLOURS["grey"], "label": "measured, inside"}
_OUTSIDE = _POINT | {"marker": "x", "color": COLOURS["vermillion"], "label": "measured, outside", "markersize": 4.0}
_CLOSE = 1e-3  # of the axis: points so near each other differ in more than what the axis shows
_MOST = 80  # points that a panel shows


def drawing(comparisons: Sequence[Comparison], titles: Sequence[str]) -> bytes:
    """One panel for each quantity, as SVG."""
    rows = ceil(len(comparisons) / _ACROSS)

    def draw(figure: Any) -> None:
        figure.set_figheight(0.3 + _HEIGHT * rows)
        figure.set_layout_engine("constrained")
        panels = np.atleast_1d(figure.subplots(rows, _ACROSS)).ravel()
        for axes, one, title in zip(panels, comparisons, titles, strict=False):
            _panel(axes, one, title)
        for axes in panels[len(comparisons) :]:
            axes.set_axis_off()
        handles = {
            label: handle for axes in panels for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=4)

    return Drawing(draw)()


def _panel(axes: Any, one: Comparison, title: str) -> None:
    shown = np.unique(np.linspace(0, len(one.x) - 1, min(len(one.x), _MOST)).round().astype(int))
    x = one.x[shown] * one.along.factor
    y, low, nominal, high = (column[shown] * one.shown.factor for column in (one.y, one.low, one.nominal, one.high))
    if len(x) > 1 and np.diff(x).min() > _CLOSE * np.ptp(x):
        axes.fill_between(x, low, high, color=COLOURS["sky"], alpha=0.35, linewidth=0.0, label="5 to 95 %")
        axes.plot(x, nominal, color=COLOURS["blue"], label="nominal")
    else:  # single machines, or points that are no curve
        axes.vlines(x, low, high, color=COLOURS["sky"], alpha=0.6, linewidth=2.5, label="5 to 95 %")
        axes.plot(x, nominal, linestyle="none", marker="_", color=COLOURS["blue"], label="nominal")
    inside = one.inside[shown]
    for mask, look in ((inside, _INSIDE), (~inside, _OUTSIDE)):
        if mask.any():
            axes.plot(x[mask], y[mask], **look)
    axes.set(xlabel=_label(one.along.name, one.along.unit), ylabel=_label(one.shown.name, one.shown.unit))
    axes.set_title(fill(title, _LETTERS), fontsize=6.5)
    if not one.along.name:
        axes.set_xticks([])


def _label(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name
