"""The figures of the page on measured drives, in the style of the report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.style import COLOURS, drawn

__all__ = ["Curve", "panels"]

Array = NDArray[np.float64]

MEASURED = {"color": COLOURS["grey"], "linestyle": "none", "marker": "o", "markersize": 2.6, "zorder": 3}
RECORDED = {"color": COLOURS["grey"], "linewidth": 2.4, "alpha": 0.5}  # a dense record
LINES: dict[str, dict[str, Any]] = {
    "sheet": {"color": COLOURS["blue"], "linestyle": "solid"},
    "second": {"color": COLOURS["vermillion"], "linestyle": (0, (5, 2))},
    "third": {"color": COLOURS["green"], "linestyle": (0, (1, 1.2))},
    "measured": MEASURED,
    "other": MEASURED | {"marker": "s", "markerfacecolor": "white"},
    "record": RECORDED,
}


class Curve(NamedTuple):
    """One line of a figure."""

    x: Array
    y: Array
    label: str
    kind: str  # of LINES


class Panel(NamedTuple):
    """One pair of axes."""

    title: str
    x: str
    y: str
    curves: Sequence[Curve]


def panels(*found: Panel, height: float = 2.4) -> bytes:
    """Panels side by side as SVG."""
    return drawn(_drawing(found), height)


def _drawing(found: Sequence[Panel]) -> Callable[[Any], None]:
    def draw(figure: Any) -> None:
        for axes, panel in zip(np.atleast_1d(figure.subplots(1, len(found))), found, strict=True):
            for curve in panel.curves:
                axes.plot(curve.x, curve.y, label=curve.label, **LINES[curve.kind])
            axes.set(xlabel=panel.x, ylabel=panel.y)
            axes.set_title(panel.title, fontsize=7.5, loc="left")
            axes.legend()
            axes.set_xlim(left=0.0)

    return draw
