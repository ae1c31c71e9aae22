"""The drives by mass, margin and price, and a front by its objectives."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

from drivesizer.output.report.html.curves import Plot, above, figure, line, plain
from drivesizer.results.objectives import objective_figure
from drivesizer.results.sizing import SizingResult
from drivesizer.units import from_si, label

__all__ = ["apart", "front_plot", "sets_plot"]

_LOOKS = {  # of a drive by its status: colour and mark
    "pass": ("blue", "circle"),
    "open": ("orange", "circle-open"),
    "unknown": ("grey", "circle-open"),
    "fail": ("vermillion", "x-thin-open"),
}
_FEW = 10  # numbers beside more points than these would cover one another


def sets_plot(rows: Sequence[dict[str, Any]], up: str, title: str) -> Plot | None:
    """The drives of the table by their mass and another figure; None where fewer than two can be drawn."""
    known = [row for row in rows if row["exact"]["mass"] is not None and row["exact"][up] is not None]
    if len(known) < 2:
        return None
    names = _names(known, up)
    named = {row["rank"]: (row["exact"]["mass"], row["exact"][up]) for row in known if row["rank"] in names}
    sides = dict(zip(named, apart([*named.values()], [names[rank] for rank in named]), strict=True))
    names = {rank: name for rank, name in names.items() if sides[rank]}
    data = [
        _status_trace(status, [row for row in known if row["status"] == status], up, names, sides) for status in _LOOKS
    ]
    return figure([trace for trace in data if trace["x"]], _layout("mass (g)", title))


def _names(rows: Sequence[dict[str, Any]], up: str) -> dict[str, str]:
    """Label of each point, by rank: drives in one place are named together; none where there are many."""
    places: dict[tuple[float, float], list[str]] = {}
    for row in rows:
        places.setdefault((row["exact"]["mass"], row["exact"][up]), []).append(row["rank"])
    if len(places) > _FEW:
        return {}
    return {ranks[0]: ", ".join(ranks[:3]) + (" …" if len(ranks) > 3 else "") for ranks in places.values()}


def apart(points: Sequence[tuple[float, float]], names: Sequence[str]) -> list[str]:
    """Side of each point at which its label covers neither another label nor a point; empty where there is none.

    Examples
    --------
    >>> apart([(207.0, 2.1), (207.0, 0.9), (192.7, -29.0)], ["1", "2", "3"])
    ['top center', 'bottom center', 'top center']
    """
    spans = [max(axis) - min(axis) or 1.0 for axis in zip(*points, strict=True)]
    places = [(x / spans[0], y / spans[1]) for x, y in points]
    taken: list[tuple[float, float, float]] = [(x, y, _POINT) for x, y in places]  # middle and half width
    chosen = []
    for own, name in zip(places, names, strict=True):
        half = _LETTER * len(name) / 2.0
        free = (
            side for side, step in _SIDES.items() if _is_free(own, (step[0] * (half + _POINT), step[1]), half, taken)
        )
        side = next(free, "")
        chosen.append(side)
        if side:
            across, up = _SIDES[side]
            taken.append((own[0] + across * (half + _POINT), own[1] + up, half))
    return chosen


def _is_free(
    own: tuple[float, float], step: tuple[float, float], half: float, taken: Sequence[tuple[float, float, float]]
) -> bool:
    """Whether a label beside a point covers nothing but that point's surroundings."""
    x, y = own[0] + step[0], own[1] + step[1]
    return not any(
        abs(x - other) < half + wide and abs(y - up) < _HIGH for other, up, wide in taken if (other, up) != own
    )


_LETTER, _POINT, _HIGH = 0.024, 0.018, 0.06  # shares of the axes: width of a letter, half a point, height of a label
_SIDES = {"top center": (0.0, 0.065), "bottom center": (0.0, -0.065), "middle right": (1.0, 0.0),
          "middle left": (-1.0, 0.0)}  # fmt: skip


def _status_trace(
    status: str, rows: Sequence[dict[str, Any]], up: str, names: dict[str, str], sides: dict[str, str]
) -> Plot:
    colour, symbol = _LOOKS[status]
    fields = ("rank", "motor", "gearhead", "ratio", "mass", "price", "margin", "check")
    hover = (
        "<b>%{customdata[0]}  %{customdata[1]}</b><br>%{customdata[2]}<br>ratio %{customdata[3]}"
        "<br>%{customdata[4]}, %{customdata[5]}<br>%{customdata[6]} %{customdata[7]}<extra></extra>"
    )
    points = line([row["exact"]["mass"] for row in rows], [row["exact"][up] for row in rows], status, colour)
    return points | {
        "mode": "markers+text" if names else "markers",
        "marker": {"symbol": symbol, "size": 9, "color": colour, "line": {"width": 2 if "open" in symbol else 0}},
        "text": [names.get(row["rank"], "") for row in rows],
        "textposition": [sides.get(row["rank"]) or "top center" for row in rows],
        "cliponaxis": False,
        "customdata": [[plain(row[name]) for name in fields] for row in rows],
        "hovertemplate": hover,
    }


def _layout(across: str, up: str) -> Plot:
    return {
        "height": 340,
        "hovermode": "closest",
        "xaxis": {"title": {"text": across}},
        "yaxis": {},
        "annotations": [above(up)],
    }


def front_plot(result: SizingResult) -> Plot | None:
    """The sets of a Pareto front by its first two objectives, None where fewer than two can be drawn."""
    found = [[objective_figure(s, name) for name in result.pareto] for s in result.front]
    places = [[float(from_si(f.value, f.unit, f.kind)) for f in row[:2]] for row in found]
    known = [n for n, (x, y) in enumerate(places) if isfinite(x) and isfinite(y)]
    if len(known) < 2:
        return None
    points = line([places[n][0] for n in known], [places[n][1] for n in known], "front", "blue")
    ranks = [str(result.front[n].rank) for n in known]
    sides = apart([(places[n][0], places[n][1]) for n in known], ranks)
    points |= {
        "mode": "markers+text" if len(known) <= _FEW else "markers",
        "marker": {"symbol": "circle", "size": 8, "color": "blue"},
        "text": [rank if side else "" for rank, side in zip(ranks, sides, strict=True)],
        "textposition": [side or "top center" for side in sides],
        "cliponaxis": False,
        "customdata": [[str(result.front[n].rank), plain(result.front[n].label),
                        "<br>".join(f"{f.title} {plain(f.text)}" for f in found[n])] for n in known],
        "hovertemplate": "<b>%{customdata[0]}  %{customdata[1]}</b><br>%{customdata[2]}<extra></extra>",
    }  # fmt: skip
    heads = [f"{f.title} ({label(f.unit)})" for f in found[0][:2]]
    return figure([points], _layout(*heads))
