"""Margins of all checks, a Pareto front, and the effect of each assumption, as figures."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

from drivesizer.output.derivation import clean, margin, minus, short, use
from drivesizer.output.report.figures import picture
from drivesizer.output.report.figures.picture import Curve, Diagram, Plot
from drivesizer.output.report.figures.style import COLOURS, bars, beside, figure, placed, width
from drivesizer.results.check import Check, Driver
from drivesizer.results.sizing import SizingResult, objective_figure
from drivesizer.units import from_si

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# -- The margins of all checks as bars: how much of each limit is used, and how much may be.


FARTHEST = 125.0  # % of a limit where the axis ends; a bar that goes on ends in an arrow
_ROW = 0.172  # in
_LOOKS: dict[str, dict[str, Any]] = {  # distinct in grey as well: plain, hatched, empty and dotted
    "pass": {"facecolor": COLOURS["sky"], "edgecolor": COLOURS["blue"]},
    "fail": {"facecolor": COLOURS["vermillion"], "edgecolor": "black", "hatch": "/////"},
    "unknown": {"facecolor": "white", "edgecolor": COLOURS["grey"], "hatch": "\\\\\\", "linestyle": (0, (2, 2))},
}
_AT_THE_RIGHT: Any = {"xycoords": ("axes fraction", "data"), "va": "center"}


@figure
def margins(figure: Figure, checks: Sequence[Check]) -> None:
    """Every check with the used share of its limit; a line where the required margin begins."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    shown = list(reversed(checks))  # the first one on top
    ((axes,),) = placed(figure, _ROW * len(shown) + 0.72, left=2.35, right=0.62, top=0.24)
    for place, check in enumerate(shown):
        used, allowed = use(check.margin), use(check.needed)
        share = 100.0 * used if used is not None else 0.0 if check.status == "pass" else FARTHEST
        axes.barh(place, min(share, FARTHEST), height=0.62, linewidth=0.6, zorder=3, **_LOOKS[check.status])
        if used is not None and allowed is not None and allowed != 1.0:
            axes.plot([100.0 * allowed] * 2, [place - 0.42, place + 0.42], color="black", linewidth=0.9, zorder=5)
        said = margin(check.margin) if not isnan(check.margin) else check.status
        beside(axes, said, (1.0, place), (4, 0), **_AT_THE_RIGHT)
    axes.axvline(100.0, color="black", linewidth=1.2, zorder=4)
    bars(axes, [short(clean(check.title), 44) for check in shown], upwards=True)
    axes.set(xlim=(0.0, FARTHEST), xlabel="used share of the limit (%)")
    kinds = [kind for kind in _LOOKS if any(check.status == kind for check in shown)]
    names: list[Any] = [Patch(label=kind, linewidth=0.6, **_LOOKS[kind]) for kind in kinds]
    if any(check.needed for check in shown):
        names.append(Line2D([], [], color="black", linewidth=0.9, marker="|", markersize=7, linestyle="none",
                            label="up to here with the required margin"))  # fmt: skip
    figure.legend(handles=names, loc="upper right", ncols=len(names), borderaxespad=0.2)


# -- A Pareto front as a figure: two figures of each drive, and the names where there is room for them.


_SIZE = 6.5  # pt, of a name
_ROOM = (405.0, 173.0)  # pt, of the axes on paper
_LONGEST = 34  # letters of a name
_FEW = 10  # drives with a number beside their point


def trade_off(result: SizingResult) -> Plot | None:
    """Drives of a front by its first two figures, with numbers as in the table; None where fewer than two are known."""
    every = [[objective_figure(one, name) for name in result.pareto] for one in result.front]
    places = [[float(from_si(f.value, f.unit, f.kind)) for f in row[:2]] for row in every]
    known = [n for n, place in enumerate(places) if isfinite(sum(place))]
    if len(known) < 2:
        return None
    drives = [result.front[n] for n in known]
    texts = [f"{one.rank}  {one.label}\n" + "\n".join(f"{f.title} {f.text}" for f in every[n])
             for n, one in zip(known, drives, strict=True)]  # fmt: skip
    names = [(f"{one.rank}  {short(clean(one.label), _LONGEST)}", str(one.rank)) for one in drives]
    return front([places[n] for n in known], names, [(f.title, f.unit) for f in every[0][:2]], texts)


def front(
    places: Sequence[Sequence[float]], names: Sequence[tuple[str, ...]], heads: Sequence[tuple[str, str]],
    texts: Sequence[str],
) -> Plot:  # fmt: skip
    """Points with the longest of their names that has room."""
    x, y = zip(*places, strict=True)
    spots = picture.spots([*zip(x, y, strict=True)], names, _ROOM, _SIZE)
    points = Curve(name="front", x=x, y=y, mark="o", joined=False, listed=False, texts=texts, spots=spots,
                   keys=[one[-1] for one in names])  # fmt: skip
    (across, unit), (up, of) = heads
    return Plot(diagrams=[Diagram(name=up, unit=of, curves=[points])], across=across, unit=unit)


# -- Effect of each assumption on a drive's smallest margin, the largest on top: a tornado.


MOST = 10  # bars
_LEAST = 0.005  # share of the variance, or of the widest bar, that is drawn
_TORNADO_ROW = 0.24  # in
_LETTERS = 44  # of a name
_NAMES, _SHARES = 2.75, 0.5  # in, left and right of the axes
_VALUE_SIZE = 6.2  # pt, of the values at the ends of the bars
_VALUE_GAP = 6.0  # pt, from a bar to its value and from there to the axis


def swings(drivers: Sequence[Driver]) -> list[Driver]:
    """The assumptions that are drawn: those that move the margin.

    In the order of the shares that are printed beside them, and of those with the same the widest bar first.
    """
    wide = {one: abs(one.high_margin - one.low_margin) for one in drivers}
    known = [one for one in drivers if isfinite(one.low_margin + one.high_margin)]
    widest = max((wide[one] for one in known), default=0.0)
    drawn = [one for one in known if one.share >= _LEAST or wide[one] > _LEAST * widest]
    return sorted(drawn, key=lambda one: (-round(100.0 * one.share), -wide[one]))[:MOST]


@figure
def tornado(figure: Figure, drivers: Sequence[Driver]) -> None:
    """Smallest margin with one assumption at its 5 % and at its 95 % quantile, all others nominal.

    Each end of a bar has the value that makes it, and the axis room for them.
    """
    shown = list(reversed(swings(drivers)))
    ((axes,),) = placed(figure, _TORNADO_ROW * len(shown) + 0.75, left=_NAMES, right=_SHARES, top=0.26)
    ends, sides = [0.0], []
    for place, one in enumerate(shown):
        (left, at_left), (right, at_right) = sorted(
            ((100.0 * one.low_margin, minus(one.low)), (100.0 * one.high_margin, minus(one.high))),
            key=lambda end: end[0],
        )
        ends += [left, right]
        sides.append((at_left, at_right))
        axes.barh(place, right - left, left=left, height=0.6, facecolor=COLOURS["sky"], edgecolor=COLOURS["blue"],
                  linewidth=0.6, zorder=3)  # fmt: skip
        for at, said, off, to in ((left, at_left, -3, "right"), (right, at_right, 3, "left")):
            beside(axes, said, (at, place), (off, 0), va="center", ha=to, fontsize=_VALUE_SIZE, zorder=5,
                   bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6})  # fmt: skip
        beside(axes, f"{100.0 * one.share:.0f} %", (1.0, place), (32, 0), ha="right", **_AT_THE_RIGHT)
    axes.axvline(0.0, color="black", linewidth=1.2, zorder=2)
    bars(axes, [short(clean(one.title), _LETTERS) for one in shown], upwards=True)
    rooms = [_VALUE_GAP + width(max(texts, key=len), _VALUE_SIZE) for texts in zip(*sides, strict=True)]
    across = 72.0 * (figure.get_figwidth() - _NAMES - _SHARES)
    scale = (max(ends) - min(ends) or 1.0) / (across - sum(rooms))
    axes.set_xlim(min(ends) - scale * rooms[0], max(ends) + scale * rooms[1])
    axes.set_xlabel("smallest margin of all checks (%)")
    beside(axes, "share of variance", (1.0, len(shown) - 0.4), (32, 3), xycoords=("axes fraction", "data"), ha="right")
