"""Margins of all checks, a Pareto front, and the effect of each assumption, as figures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer.output.derivation import clean, margin, minus, short, use
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, placed, width
from drivesizer.results.check import Driver
from drivesizer.results.sizing import Check

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["margins", "swings", "tornado", "trade_off"]


# -- The margins of all checks as bars: how much of each limit is used, and how much may be.


FARTHEST = 125.0  # % of a limit where the axis ends; a bar that goes on ends in an arrow
_ROW = 0.172  # in
_LOOKS: dict[str, dict[str, Any]] = {  # distinct in grey as well: plain, hatched, empty and dotted
    "pass": {"facecolor": COLOURS["sky"], "edgecolor": COLOURS["blue"]},
    "fail": {"facecolor": COLOURS["vermillion"], "edgecolor": "black", "hatch": "/////"},
    "unknown": {"facecolor": "white", "edgecolor": COLOURS["grey"], "hatch": "\\\\\\", "linestyle": (0, (2, 2))},
}


def margins(checks: Sequence[Check], form: Form = "svg") -> bytes:
    """Every check with the used share of its limit; a line where the required margin begins."""
    shown = list(reversed(checks))  # the first one on top

    def draw(figure: Figure) -> None:
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        axes = placed(figure, left=2.35, right=0.62, top=0.24)[0][0]
        for place, check in enumerate(shown):
            _bar(axes, place, check)
        axes.axvline(100.0, color="black", linewidth=1.2, zorder=4)
        axes.set_yticks(range(len(shown)), [short(clean(check.title), 44) for check in shown])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        axes.set(xlim=(0.0, FARTHEST), ylim=(-0.6, len(shown) - 0.4), xlabel="used share of the limit (%)")
        kinds = [kind for kind in _LOOKS if any(check.status == kind for check in shown)]
        names: list[Any] = [Patch(label=kind, linewidth=0.6, **_LOOKS[kind]) for kind in kinds]
        if any(check.needed for check in shown):
            names.append(Line2D([], [], color="black", linewidth=0.9, marker="|", markersize=7, linestyle="none",
                                label="up to here with the required margin"))  # fmt: skip
        figure.legend(handles=names, loc="upper right", ncols=len(names), borderaxespad=0.2)

    return drawn(draw, _ROW * len(shown) + 0.72, form)


def _bar(axes: Axes, place: int, check: Check) -> None:
    """One check: its bar, the margin that it needs, and its margin in figures."""
    used = use(check.margin)
    share = 100.0 * used if used is not None else 0.0 if check.status == "pass" else FARTHEST
    axes.barh(place, min(share, FARTHEST), height=0.62, linewidth=0.6, zorder=3, **_LOOKS[check.status])
    allowed = use(check.needed)
    if used is not None and allowed is not None and allowed != 1.0:
        axes.plot([100.0 * allowed] * 2, [place - 0.42, place + 0.42], color="black", linewidth=0.9, zorder=5)
    said = margin(check.margin) if not isnan(check.margin) else check.status
    axes.annotate(said, (1.0, place), xycoords=("axes fraction", "data"), xytext=(4, 0), textcoords="offset points",
                  va="center", fontsize=6.5)  # fmt: skip


# -- A Pareto front as a figure: two figures of each drive, and the names where there is room for them.


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


# -- Effect of each assumption on a drive's smallest margin, the largest on top: a tornado.


MOST = 10  # bars
_LEAST = 0.005  # share of the variance, or of the widest bar, that is drawn
_TORNADO_ROW = 0.24  # in
_LETTERS = 44  # of a name
_NAMES, _SHARES = 2.75, 0.5  # in, left and right of the axes
_VALUE_SIZE = 6.2  # pt, of the values at the ends of the bars
_VALUE_GAP = 6.0  # pt, from a bar to its value and from there to the axis

_GROUND = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}  # so that no line runs through a value


def swings(drivers: Sequence[Driver]) -> list[Driver]:
    """The assumptions that are drawn: those that move the margin.

    In the order of the shares that are printed beside them, and of those with the same the widest bar first.
    """
    known = [one for one in drivers if isfinite(one.low_margin + one.high_margin)]
    widest = max((_swing(one) for one in known), default=0.0)
    drawn = [one for one in known if one.share >= _LEAST or _swing(one) > _LEAST * widest]
    return sorted(drawn, key=lambda one: (-round(100.0 * one.share), -_swing(one)))[:MOST]


def _swing(one: Driver) -> float:
    return abs(one.high_margin - one.low_margin)


def tornado(drivers: Sequence[Driver], form: Form = "svg") -> bytes:
    """Smallest margin with one assumption at its 5 % and at its 95 % quantile, all others nominal."""
    shown = list(reversed(swings(drivers)))

    def draw(figure: Figure) -> None:
        axes = placed(figure, left=_NAMES, right=_SHARES, top=0.26)[0][0]
        for place, one in enumerate(shown):
            _tornado_bar(axes, place, one)
        axes.axvline(0.0, color="black", linewidth=1.2, zorder=2)
        axes.set_yticks(range(len(shown)), [short(clean(one.title), _LETTERS) for one in shown])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        across = 72.0 * (figure.get_size_inches()[0] - _NAMES - _SHARES)
        axes.set(xlim=_bars_extent(shown, across), ylim=(-0.6, len(shown) - 0.4))
        axes.set_xlabel("smallest margin of all checks (%)")
        axes.annotate("share of variance", (1.0, len(shown) - 0.4), xycoords=("axes fraction", "data"), xytext=(32, 3),
                      textcoords="offset points", ha="right", fontsize=6.5)  # fmt: skip

    return drawn(draw, _TORNADO_ROW * len(shown) + 0.75, form)


def _bars_extent(shown: Sequence[Driver], across: float) -> tuple[float, float]:
    """Ends of an axis so many points wide [%]: all bars, and beside them their values."""
    ends = [100.0 * end for one in shown for end in (one.low_margin, one.high_margin)] + [0.0]
    sides = [
        _VALUE_GAP + width(longest, _VALUE_SIZE) for longest in map(_longest, zip(*map(_sides, shown), strict=True))
    ]
    scale = (max(ends) - min(ends) or 1.0) / (across - sum(sides))
    return min(ends) - scale * sides[0], max(ends) + scale * sides[1]


def _longest(texts: Sequence[str]) -> str:
    return max(texts, key=len)


def _sides(one: Driver) -> tuple[str, str]:
    """The values at the left and at the right end of a bar."""
    low, high = minus(one.low), minus(one.high)
    return (high, low) if one.low_margin > one.high_margin else (low, high)


def _tornado_bar(axes: Axes, place: int, one: Driver) -> None:
    """From the margin at the low end to that at the high end, each end with the value that makes it."""
    low, high = 100.0 * one.low_margin, 100.0 * one.high_margin
    axes.barh(place, high - low, left=low, height=0.6, facecolor=COLOURS["sky"], edgecolor=COLOURS["blue"],
              linewidth=0.6, zorder=3)  # fmt: skip
    for at, said, right in zip(sorted((low, high)), _sides(one), (False, True), strict=True):
        axes.annotate(said, (at, place), xytext=(3 if right else -3, 0), textcoords="offset points", va="center",
                      ha="left" if right else "right", fontsize=_VALUE_SIZE, bbox=_GROUND, zorder=5)  # fmt: skip
    axes.annotate(f"{100.0 * one.share:.0f} %", (1.0, place), xycoords=("axes fraction", "data"), xytext=(32, 0),
                  textcoords="offset points", va="center", ha="right", fontsize=6.5)  # fmt: skip
