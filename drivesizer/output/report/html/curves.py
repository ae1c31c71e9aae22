"""Pieces of interactive figures as plain data: numbers, traces, legends, rows of axes.

A figure is what plotly.js draws (``data`` and ``layout``) with a legend and stretches to look at, which the page
shows as buttons. Colours are names: the page has their values, in light and in dark. Whatever plotly would read as
markup is escaped here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.time_strips import Window, thinned

__all__ = ["Plot", "above", "dashes", "figure", "line", "numbers", "plain", "rows", "sampled", "whole"]

Plot = dict[str, Any]


def numbers(values: Iterable[float], digits: int = 6) -> list[float | None]:
    """Values as JSON has them: to so many digits, None where unknown.

    Examples
    --------
    >>> numbers([1.23456789, float("nan")])
    [1.23457, None]
    """
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values]


def plain(text: str) -> str:
    """A text that plotly shows letter by letter, in names, titles and hovers.

    >>> plain("<b>R & D</b>")
    '&lt;b&gt;R &amp; D&lt;/b&gt;'
    """
    return escape(text, quote=False)


def dashes(pattern: Any) -> str:
    """Dashes of a print figure as plotly and SVG write them.

    >>> dashes((0, (5, 2))), dashes("solid")
    ('8px,3px', 'solid')
    """
    return pattern if isinstance(pattern, str) else ",".join(f"{max(1.6 * x, 1.5):.0f}px" for x in pattern[1])


def whole(time: NDArray[np.float64]) -> Window:
    """All of a record."""
    return Window("all", float(time[0]), float(time[-1]))


def sampled(
    time: NDArray[np.float64], columns: Sequence[NDArray[np.float64]], stretches: Sequence[Window]
) -> NDArray[np.int64]:
    """Rows of a record to draw: peaks and troughs of all of it, and finer in the stretches to be looked at."""
    kept = [thinned(time, column, window) for column in columns for window in (whole(time), *stretches)]
    found: NDArray[np.int64] = np.unique(np.concatenate(kept))
    return found


def line(x: Iterable[float], y: Iterable[float], label: str, colour: str, dash: str = "solid", **more: Any) -> Plot:
    """A trace."""
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(x, 8),
        "y": numbers(y),
        "name": plain(label),
        "legendgroup": label,
        "line": {"color": colour, "dash": dash, "width": 1.8},
    } | more


def rows(titles: Sequence[str], height: float = 150.0) -> Plot:
    """A layout of diagrams below one another over one axis, each with its title above it."""
    count, room = len(titles), 26.0
    total = count * (height + room)
    layout: Plot = {
        "height": round(total + _BELOW),
        "annotations": [],
        "hoversubplots": "axis",
        "hovermode": "x unified",
    }
    for number, title in enumerate(titles):
        top = 1.0 - (number * (height + room) + room) / total
        axis = "yaxis" if number == 0 else f"yaxis{number + 1}"
        layout[axis] = {"domain": [max(top - height / total, 0.0), top], "anchor": "x"}
        layout["annotations"].append(above(plain(title), top))
    layout["xaxis"] = {"anchor": "y" if count == 1 else f"y{count}", "showspikes": True}
    return layout


_BELOW = 46  # px: numbers and title of the lowest axis


def above(text: str, height: float = 1) -> Plot:
    """The title of an upright axis, above its upper end."""
    return {"text": text, "x": 0, "y": height, "xref": "paper", "yref": "paper", "xanchor": "left", "yanchor": "bottom",
            "showarrow": False}  # fmt: skip


def figure(data: Sequence[Plot], layout: Plot, views: Sequence[Window] = ()) -> Plot:
    """A figure with its legend and, where there are several, the stretches that it can be looked at in."""
    entries: dict[str, Plot] = {}
    for number, trace in enumerate(data):
        if trace.get("showlegend") is False:
            continue
        entry = entries.setdefault(trace["legendgroup"], _entry(trace))
        entry["traces"].append(number)
    return {
        "data": list(data),
        "layout": layout,
        "legend": list(entries.values()) if len(entries) > 1 else [],
        "views": [_view(v, layout["xaxis"]["range"]) for v in views] if len(views) > 1 else [],
    }


def _view(stretch: Window, seen: Sequence[float]) -> Plot:
    ends = numbers((stretch.start, stretch.end))
    return {"title": stretch.title, "range": ends, "shown": ends == numbers(seen)}


def _entry(trace: Plot) -> Plot:
    marker = trace.get("marker", {})
    drawn = "lines" in trace["mode"]
    return {
        "label": trace["legendgroup"],
        "colour": trace["line"]["color"] if drawn else marker["color"],
        "dash": trace["line"]["dash"] if drawn else "",
        "filled": trace.get("fill") == "toself",
        "stacked": "stackgroup" in trace,
        "hatch": trace.get("fillpattern", {}).get("shape", ""),
        "mark": marker.get("symbol", "") if not drawn else "",
        "shown": trace.get("visible", True) is True,
        "traces": [],
    }
