"""The margins of all checks as bars: how much of each limit is used, and how much may be."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import TYPE_CHECKING, Any

from drivesizer.output.report.figures.style import COLOURS, Form, drawn, placed
from drivesizer.output.text import clean, margin, short, use
from drivesizer.results.sizing import Check

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FARTHEST", "margins"]

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
