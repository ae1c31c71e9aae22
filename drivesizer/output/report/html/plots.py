"""Pictures as plain data that the page moves: what plotly.js draws, with a legend and stretches to look at as buttons.

Colours are names: the page has their values, in light and in dark. Whatever plotly would read as markup is escaped.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from textwrap import wrap
from typing import Any

import numpy as np

from drivesizer.output.report.figures.picture import LOOKS, SIDES, Bars, Curve, Diagram, Plot, limits
from drivesizer.output.report.figures.style import Window, reads, thinned
from drivesizer.units import label

Data = dict[str, Any]
_MARKS = {"s": "square", "o": "circle", "^": "triangle-up", "v": "triangle-down", "D": "diamond", "x": "x-thin"}
_HATCHES = {"////": "/", "....": ".", "\\\\\\\\": "\\", "xxxx": "x", "----": "-", "++++": "+"}
_SPOTS = {side: side if " " in side else f"{side} center" if side in ("top", "bottom") else f"middle {side}"
          for side in SIDES}  # fmt: skip
_ABOVE, _BELOW = 26, 46  # px: the name above a diagram; numbers and name of the lowest axis
_PER_INCH = 160  # px of a diagram's height on paper
_ALONE, _FEW = 340, 60  # px of a diagram alone; points that are marked each
_SHORT = 20  # letters of a line of the name of a bar


def numbers(values: Iterable[float], digits: int = 6) -> list[float | None]:
    """Values as JSON has them: to so many digits, None where unknown.

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


def movable(plot: Plot | Bars) -> Data:
    """A picture as the page draws it."""
    if isinstance(plot, Bars):
        return _bars(plot)
    data = [_trace(plot, diagram, curve, number) | dict(plot.trace)
            for number, diagram in enumerate(plot.diagrams, 1) for curve in diagram.curves]  # fmt: skip
    legend: dict[str, Data] = {}
    for number, trace in enumerate(data):
        if trace["showlegend"]:
            legend.setdefault(trace["legendgroup"], _entry(trace))["traces"].append(number)
    views = []
    if len(plot.windows) > 1 and plot.ends:
        stretches = [*plot.windows, Window("all", *plot.ends)]
        views = [{"title": window.title, "range": numbers((window.start, window.end)), "shown": window is stretches[0]}
                 for window in stretches]  # fmt: skip
    return {"data": data, "layout": _layout(plot), "legend": [*legend.values()] if len(legend) > 1 else [],
            "views": views, "title": plot.title}  # fmt: skip


def _trace(plot: Plot, diagram: Diagram, curve: Curve, number: int) -> Data:
    x, y = np.asarray(curve.x, float), np.asarray(curve.y, float)
    if plot.over_time and not curve.stack:  # peaks and troughs of all of it, and finer in the stretches to look at
        whole = Window("", float(x[0]), float(x[-1]))
        samples = np.unique(np.concatenate([thinned(x, y, window) for window in (whole, *plot.windows)]))
        x, y = x[samples], y[samples]
    few = len(x) <= _FEW and len(x) > 1
    trace: Data = {
        "type": "scatter", "mode": "lines", "x": numbers(x, 8), "y": numbers(y), "name": plain(curve.name),
        "legendgroup": curve.name, "showlegend": curve.listed and bool(curve.name),
        "line": {"color": curve.colour, "dash": dashes(curve.dashes), "width": 1.8},
        "yaxis": "y" if number == 1 else f"y{number}", "hovertemplate": _hover(plot, diagram, curve),
    }  # fmt: skip
    trace |= {} if curve.first else {"visible": "legendonly"}
    if curve.mark and (few or not curve.joined):
        symbol = f"{_MARKS[curve.mark]}-open" if curve.hollow else _MARKS[curve.mark]
        rim = {"width": 1.6 if curve.hollow else 0}
        trace["mode"] = "lines+markers" if curve.joined else "markers"
        trace["marker"] = {"symbol": symbol, "size": 6 if curve.joined else 9, "color": curve.colour, "line": rim}
    if curve.texts:
        keys = curve.keys or [""] * len(curve.texts)
        trace["customdata"] = [[key, plain(text).replace("\n", "<br>")]
                              for key, text in zip(keys, curve.texts, strict=True)]  # fmt: skip
    if any(text for text, _ in curve.spots):
        trace |= {"mode": "markers+text", "text": [text for text, _ in curve.spots], "cliponaxis": False,
                 "textposition": [_SPOTS.get(side, "top center") for _, side in curve.spots]}  # fmt: skip
    if curve.stack:
        trace |= {"stackgroup": curve.stack, "fillcolor": curve.colour, "line": trace["line"] | {"shape": "hv",
                 "width": 0.6}}  # fmt: skip
        if curve.hatch:
            trace["fillpattern"] = {"shape": _HATCHES[curve.hatch], "bgcolor": curve.colour, "fgcolor": "page",
                                   "size": 7, "solidity": 0.15}  # fmt: skip
    if curve.filled:
        trace |= {"fill": "toself", "fillcolor": curve.colour, "opacity": curve.filled, "hoverinfo": "skip",
                 "line": trace["line"] | {"width": 0}}  # fmt: skip
        del trace["hovertemplate"]
    return trace


def _hover(plot: Plot, diagram: Diagram, curve: Curve) -> str:
    """Words at a point: its figure, of all curves at a time, or with the place and what else it is."""
    up, across = label(diagram.unit), label(plot.unit)
    height = "%{customdata[1]}" if curve.stack and curve.texts else f"%{{y:.4~r}} {up}"
    if plot.over_time:
        return f"{height}<extra>%{{fullData.name}}</extra>"
    if curve.keys:
        return "%{customdata[1]}<extra></extra>"
    more = "<br>%{customdata[1]}" if curve.texts else ""
    return f"<b>%{{fullData.name}}</b><br>{height}, %{{x:.4~r}} {across}{more}<extra></extra>"


def _layout(plot: Plot) -> Data:
    """Diagrams below one another, each with its name above it."""
    alone = len(plot.diagrams) == 1 and not plot.over_time
    heights = [max(_ALONE if alone else 0, round(_PER_INCH * diagram.height)) for diagram in plot.diagrams]
    total = sum(heights) + _ABOVE * len(heights)
    hover = {"hoversubplots": "axis", "hovermode": "x unified"} if plot.over_time else {"hovermode": "closest"}
    layout: Data = {"height": total + _BELOW, "annotations": [], "shapes": [], **hover}
    top = 1.0
    for number, (diagram, high) in enumerate(zip(plot.diagrams, heights, strict=True), 1):
        top -= _ABOVE / total
        name = "yaxis" if number == 1 else f"yaxis{number}"
        axis: Data = {"domain": [max(top - high / total, 0.0), top], "anchor": "x"}
        axis |= {"range": [*diagram.ends]} if diagram.ends else {"rangemode": "tozero"} if diagram.whole else {}
        axis |= {"dtick": diagram.tick} if diagram.tick else {"type": "log"} if diagram.log else {}
        layout[name] = axis
        layout["annotations"].append({
            "text": plain(reads(diagram.name, diagram.unit)), "x": 0, "y": top, "xref": "paper", "yref": "paper",
            "xanchor": "left", "yanchor": "bottom", "showarrow": False,
        })  # fmt: skip
        highest = diagram.ends[1] if diagram.ends else max((level for _, level in diagram.levels), default=0.0)
        inside, _ = limits(diagram, highest)
        layout["shapes"] += _shapes(diagram, [limit.value for limit in inside], name.replace("axis", ""))
        layout["annotations"] += [
            {"text": plain(text), "x": 1, "y": value, "xref": "paper", "yref": name.replace("axis", ""),
             "xanchor": "right", "yanchor": "top" if below else "bottom", "showarrow": False}
            for text, value, below in inside
        ]  # fmt: skip
        top = axis["domain"][0]
    lowest = "y" if len(heights) == 1 else f"y{len(heights)}"
    title = {"text": plain(reads(plot.across, plot.unit))}
    layout["xaxis"] = {"anchor": lowest, "title": title, "showspikes": plot.over_time}
    seen = (plot.windows[0].start, plot.windows[0].end) if plot.windows else plot.ends
    if seen:
        layout["xaxis"]["range"] = [math.log10(end) for end in seen] if plot.log else numbers(seen)
    layout["xaxis"] |= {"type": "log"} if plot.log else {}
    return layout


def _shapes(diagram: Diagram, inside: Sequence[float], axis: str) -> list[Data]:
    def line(ends: Data, colour: str) -> Data:
        return {"type": "line", "line": {"color": colour, "width": 0.8, "dash": "dash"}, **ends}

    across = {"xref": "paper", "x0": 0, "x1": 1, "yref": axis}
    shapes = [line({**across, "y0": y, "y1": y}, "ink") for y in (*diagram.dashed, *inside)]
    shapes += [line({"xref": "x", "x0": x, "x1": x, "yref": f"{axis} domain", "y0": 0, "y1": 1}, "grey")
              for x in diagram.upright]  # fmt: skip
    if diagram.band:
        shapes.append({"type": "rect", **across, "y0": diagram.band[0], "y1": diagram.band[1], "fillcolor": "grey",
                      "opacity": 0.2, "line": {"width": 0}})  # fmt: skip
    return shapes


def _entry(trace: Data) -> Data:
    marker, lined = trace.get("marker", {}), "lines" in trace["mode"]
    return {
        "label": trace["legendgroup"], "colour": trace["line"]["color"], "dash": trace["line"]["dash"] if lined else "",
        "filled": "fill" in trace, "stacked": "stackgroup" in trace,
        "hatch": trace.get("fillpattern", {}).get("shape", ""), "mark": "" if lined else marker.get("symbol", ""),
        "shown": trace.get("visible", True) is True, "traces": [],
    }  # fmt: skip


def _bars(bars: Bars) -> Data:
    """Bars of a look as a trace each."""
    data = list[Data]()
    names = {bar.name: "<br>".join(wrap(plain(bar.name), _SHORT, break_long_words=False)) for bar in bars.rows}
    for look in dict.fromkeys(bar.look for bar in bars.rows):
        rows, (face, edge, hatch) = [bar for bar in bars.rows if bar.look == look], LOOKS[look]
        marker: Data = {"color": face, "line": {"color": edge, "width": 0.8}}
        if hatch:
            marker["pattern"] = {"shape": hatch, "bgcolor": face, "fgcolor": edge, "size": 6, "solidity": 0.2}
        ends = [(f"{bar.start:.4g} {label(bars.unit)} at {bar.left}, " if bar.left else "")
                + (f"{bar.end:.4g} {label(bars.unit)} at {bar.right}" if bar.left else bar.label or bar.right)
                for bar in rows]  # fmt: skip
        data.append({
            "type": "bar", "orientation": "h", "base": numbers(bar.start for bar in rows),
            "x": numbers(bar.end - bar.start for bar in rows), "y": [names[bar.name] for bar in rows], "name": look,
            "showlegend": False, "marker": marker, "customdata": [plain(text.replace("-", "−")) for text in ends],
            "text": [plain(bar.label or bar.right).replace(", ", "<br>") for bar in rows], "textposition": "outside",
            "cliponaxis": False, "hovertemplate": "%{y}: %{customdata}<extra></extra>",
        })  # fmt: skip
    low, high = min(0.0, *(bar.start for bar in bars.rows)), max(0.0, *(bar.end for bar in bars.rows))
    layout = {"height": 90 + 34 * len(names), "hovermode": "closest", "barmode": "overlay",
              "xaxis": {"title": {"text": reads(bars.across, bars.unit)},
                        "range": numbers((1.05 * low, high + 0.3 * (high - low)))},
              "yaxis": {"autorange": "reversed", "type": "category", "categoryarray": [*names.values()]},
              "annotations": [], "shapes": []}  # fmt: skip
    return {"data": data, "layout": layout, "legend": [], "views": [], "title": ""}
