"""Effect of each assumption on a drive's smallest margin, the largest on top: a tornado."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

from drivesizer.output.report.figures.style import COLOURS, Form, drawn, placed, width
from drivesizer.output.text import clean, minus, short
from drivesizer.results.reliability import Driver

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["MOST", "swings", "tornado"]

MOST = 10  # bars
_LEAST = 0.005  # share of the variance, or of the widest bar, that is drawn
_ROW = 0.24  # in
_LETTERS = 44  # of a name
_NAMES, _SHARES = 2.75, 0.5  # in, left and right of the axes
_SIZE = 6.2  # pt, of the values at the ends of the bars
_GAP = 6.0  # pt, from a bar to its value and from there to the axis

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
            _bar(axes, place, one)
        axes.axvline(0.0, color="black", linewidth=1.2, zorder=2)
        axes.set_yticks(range(len(shown)), [short(clean(one.title), _LETTERS) for one in shown])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        across = 72.0 * (figure.get_size_inches()[0] - _NAMES - _SHARES)
        axes.set(xlim=_extent(shown, across), ylim=(-0.6, len(shown) - 0.4))
        axes.set_xlabel("smallest margin of all checks (%)")
        axes.annotate("share of variance", (1.0, len(shown) - 0.4), xycoords=("axes fraction", "data"), xytext=(32, 3),
                      textcoords="offset points", ha="right", fontsize=6.5)  # fmt: skip

    return drawn(draw, _ROW * len(shown) + 0.75, form)


def _extent(shown: Sequence[Driver], across: float) -> tuple[float, float]:
    """Ends of an axis so many points wide [%]: all bars, and beside them their values."""
    ends = [100.0 * end for one in shown for end in (one.low_margin, one.high_margin)] + [0.0]
    sides = [_GAP + width(longest, _SIZE) for longest in map(_longest, zip(*map(_sides, shown), strict=True))]
    scale = (max(ends) - min(ends) or 1.0) / (across - sum(sides))
    return min(ends) - scale * sides[0], max(ends) + scale * sides[1]


def _longest(texts: Sequence[str]) -> str:
    return max(texts, key=len)


def _sides(one: Driver) -> tuple[str, str]:
    """The values at the left and at the right end of a bar."""
    low, high = minus(one.low), minus(one.high)
    return (high, low) if one.low_margin > one.high_margin else (low, high)


def _bar(axes: Axes, place: int, one: Driver) -> None:
    """From the margin at the low end to that at the high end, each end with the value that makes it."""
    low, high = 100.0 * one.low_margin, 100.0 * one.high_margin
    axes.barh(place, high - low, left=low, height=0.6, facecolor=COLOURS["sky"], edgecolor=COLOURS["blue"],
              linewidth=0.6, zorder=3)  # fmt: skip
    for at, said, right in zip(sorted((low, high)), _sides(one), (False, True), strict=True):
        axes.annotate(said, (at, place), xytext=(3 if right else -3, 0), textcoords="offset points", va="center",
                      ha="left" if right else "right", fontsize=_SIZE, bbox=_GROUND, zorder=5)  # fmt: skip
    axes.annotate(f"{100.0 * one.share:.0f} %", (1.0, place), xycoords=("axes fraction", "data"), xytext=(32, 0),
                  textcoords="offset points", va="center", ha="right", fontsize=6.5)  # fmt: skip
