"""Pictures of curves, described once for paper and page: diagrams below one another over one axis.

A picture is data in the units of its axes. ``on_paper`` draws it with matplotlib, ``html/plotly`` makes it plain data
that the page moves. Of a long record paper has the stretches in which something changes, beside each other with gaps;
the page has all of it, and a button for each stretch.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, isfinite, nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.derivation import clean, short
from drivesizer.output.report.figures import style
from drivesizer.output.report.figures.style import COLOURS, Drawing, Window
from drivesizer.units import label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
DASHED, DOTTED, MIXED = (0, (5, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2))


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """Points that a line joins, or marks, or the outline of an area."""

    name: str  # in the legend; curves of one name are one entry
    x: Any
    y: Any
    colour: str = "blue"
    dashes: Any = "solid"
    width: float = 1.1  # pt
    mark: str = ""  # at each point, by matplotlib's letters
    hollow: bool = False
    joined: bool = True
    filled: float = 0.0  # opacity of the area that it is the outline of
    stack: str = ""  # layers of one name stand on one another; their values hold from each time to the next
    hatch: str = ""
    listed: bool = True  # in the legend
    first: bool = True  # whether the page shows it before it is selected
    detail: str = ""  # below its name in the legend on paper
    texts: Sequence[str] = ()  # what the page says of each point
    keys: Sequence[str] = ()  # of the rows of a table that the points are
    spots: Sequence[tuple[str, str]] = ()  # a short text beside each point, and on which side


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagram:
    """Curves over one upright axis."""

    name: str
    unit: str
    curves: Sequence[Curve]
    ends: tuple[float, float] | None = None  # of the axis; else what is drawn, and 0 where it is ``whole``
    whole: bool = False
    levels: Sequence[tuple[str, float]] = ()  # limits with their names
    dashed: Sequence[float] = ()  # lines across that the curves are read against
    upright: Sequence[float] = ()  # and such lines upright
    band: tuple[float, float] | None = None  # across
    zero: bool = False  # a line at 0
    tick: float = 0.0  # between two ticks; 0: as suits
    log: bool = False
    height: float = 0.95  # in, on paper


@dataclass(frozen=True, slots=True, kw_only=True)
class Plot:
    """A picture of curves."""

    diagrams: Sequence[Diagram]
    across: str  # name of the level axis
    unit: str
    ends: tuple[float, float] | None = None
    windows: Sequence[Window] = ()  # stretches of a record over time
    log: bool = False
    over_time: bool = False  # the page shows all curves at a time
    legend: str = "above"  # or at the right, on paper
    columns: int = 2  # of the legend above
    fewest: int = 2  # names that a legend is for
    title: str = ""
    trace: Mapping[str, Any] = field(default_factory=dict)  # of the page alone, for all its curves

    def titled(self, title: str) -> Plot:
        """The same with a title, which the page has above it."""
        return replace(self, title=title)


class Bar(NamedTuple):
    """A bar with its name, from its lower to its higher end, and the texts at it."""

    name: str
    end: float
    start: float = 0.0
    look: str = "pass"  # of ``LOOKS``
    label: str = ""  # at the right of all bars
    left: str = ""  # at its ends
    right: str = ""
    mark: float = nan  # a line across it


LOOKS = {  # colour, that of the rim, and hatch: distinct in grey as well
    "pass": ("sky", "blue", ""), "fail": ("vermillion", "ink", "/"), "open": ("page", "orange", "/"),
    "unknown": ("page", "grey", "\\"), "drawn": ("grey", "ink", ""), "loss": ("orange", "vermillion", "/"),
    "back": ("page", "green", "\\"),
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars:
    """Bars, the first on top."""

    rows: Sequence[Bar]
    across: str
    unit: str
    ends: tuple[float, float] | None = None  # of the axis; else what is drawn and 0, with room for the texts
    line: float = 0.0  # an upright line
    head: str = ""  # above the texts at the right
    marks: str = ""  # in the legend, with the looks
    sides: tuple[float, float] = (2.35, 0.2)  # in, for the names, and for the texts at the right


class Pictured(NamedTuple):
    """A figure on paper, and on the page: one or several that can be moved; without them as on paper."""

    paper: Drawing | None
    page: Sequence[Plot | Bars] = ()


def over_time(*diagrams: Diagram, windows: Sequence[Window], **more: Any) -> Plot:
    """A picture over time [s]."""
    end = max(float(curve.x[-1]) for diagram in diagrams for curve in diagram.curves)
    start = min(float(curve.x[0]) for diagram in diagrams for curve in diagram.curves)
    return Plot(diagrams=diagrams, across="time", unit="s", ends=(start, end), windows=windows, over_time=True, **more)


_LINE = 0.16  # in, of a legend
_LETTERS = 30  # of a line of a legend at the right
_LEGEND_WIDTH = 2.05  # in, of such a legend
_WIDE = 13  # letters of the name of a low diagram's axis on a line
_HEIGHT_OF_A_NAME = 0.16  # of the axis
_FEW = 60  # points that are marked each


@style.figure
def on_paper(figure: Figure, plot: Plot) -> None:
    """A picture as paper has it."""
    names = {curve.name for diagram in plot.diagrams for curve in diagram.curves if curve.listed and curve.name}
    right = plot.legend == "right"
    lines = 0 if right or len(names) < plot.fewest else ceil(len(names) / plot.columns)
    strip = style.strip(plot.windows) if plot.windows else None
    titled = strip is not None and len(strip.windows) > 1
    top = 0.1 + _LINE * lines + 0.12 * titled
    heights = [diagram.height for diagram in plot.diagrams]
    low = max(heights) < 0.9  # names of axes on several lines
    name_of = _on_lines if right else _on_a_line if plot.columns > 1 else lambda curve: clean(curve.name)
    grid = style.placed(figure, sum(heights) + 0.5 + top - 0.1, len(heights), top=top, left=0.8 if low else 0.66,
                        heights=heights, right=_LEGEND_WIDTH if right else 0.2)  # fmt: skip
    for (axes,), diagram in zip(grid, plot.diagrams, strict=True):
        draw(axes, diagram, strip, name_of)
        if low:
            axes.set_ylabel("\n".join([*textwrap.wrap(diagram.name, _WIDE), f"({label(diagram.unit)})"]))
        if strip:
            style.across(axes, strip, titled=titled and axes is grid[0][0])
    axes = grid[-1][0]
    if plot.log:
        _decades(axes, plot.ends)
    elif plot.ends and not strip:
        axes.set_xlim(plot.ends)
    axes.set_xlabel(style.reads(plot.across, plot.unit))
    handles = {name: line for (ax,) in reversed(grid)
               for line, name in reversed([*zip(*ax.get_legend_handles_labels(), strict=True)])}  # fmt: skip
    if right:
        style.outside(axes)
    elif lines:
        listed = [*dict.fromkeys(name for (ax,) in grid for name in ax.get_legend_handles_labels()[1])]
        style.heading(figure, [handles[name] for name in listed], listed, plot.columns)


@style.figure
def abreast(figure: Figure, plots: Sequence[Plot], height: float, *, columns: int = 0, names: int = 3) -> None:
    """Pictures of a diagram each beside one another as paper has them: each under its title, one legend above all."""
    columns = columns or len(plots)
    rows = ceil(len(plots) / columns)
    listed = {curve.name for plot in plots for curve in plot.diagrams[0].curves if curve.listed}
    top = 0.22 + (0.04 + _LINE * ceil(len(listed) / names) if len(listed) > 1 else 0.0)
    grid = style.placed(figure, (height + _APART) * rows - _APART + top + 0.42, rows, columns, top=top,
                        gaps=(_APART, _APART), shared=False)  # fmt: skip
    seen: dict[str, Any] = {}  # lines of a name once: a picture may have others than the first
    for n, axes in enumerate(axes for row in grid for axes in row):
        axes.set_visible(n < len(plots))
        if n >= len(plots):
            continue
        (diagram,), before = plots[n].diagrams, plots[n - 1].diagrams[0]
        draw(axes, diagram)
        if plots[n].ends:
            axes.set_xlim(plots[n].ends)
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.set_xlabel(style.reads(plots[n].across, plots[n].unit))
        axes.set_title(short(clean(plots[n].title), int(_LETTERS * 3 / columns)))
        if n % columns and (diagram.name, diagram.unit) == (before.name, before.unit):
            axes.set_ylabel("")
        for line, name in zip(*axes.get_legend_handles_labels(), strict=True):
            seen.setdefault(name, line)
    if len(seen) > 1:
        style.heading(figure, [*seen.values()], [*seen], names)


_APART = 0.62  # in, between small diagrams


def _on_a_line(curve: Curve) -> str:
    return style.named(curve.name)


def draw(
    axes: Axes, diagram: Diagram, strip: style.Strip | None = None, said_of: Callable[[Curve], str] = _on_a_line
) -> None:
    """A diagram on its axes."""
    seen = {""}
    stacks: dict[str, Array] = {}
    for curve in diagram.curves:
        name = said_of(curve) if curve.listed and curve.name not in seen else ""
        seen.add(curve.name)
        colour = COLOURS.get(curve.colour, "black")
        look: dict[str, Any] = {"color": colour, "linestyle": curve.dashes, "linewidth": curve.width,
                                "label": name or None}  # fmt: skip
        if curve.mark:
            small = curve.joined and len(curve.x) > 1
            look |= {"marker": curve.mark if not small or len(curve.x) <= _FEW else "",
                     "markersize": 2.5 if small else 5.5, "zorder": 6,
                     **({"markerfacecolor": "none", "markeredgewidth": 1.2} if curve.hollow else {}),
                     **({} if curve.joined else {"linestyle": "none"})}  # fmt: skip
        if curve.stack:
            _layer(axes, curve, stacks, name)
        elif curve.filled:
            axes.fill(curve.x, curve.y, color=colour, alpha=curve.filled, linewidth=0, label=name or None)
        elif strip:
            style.plotted(axes, curve.x, curve.y, strip, **look)
        else:
            axes.plot(curve.x, curve.y, **look)
    if diagram.zero:
        axes.axhline(0.0, color="black", linewidth=0.6)
    for level in diagram.dashed:
        axes.axhline(level, color="black", linewidth=0.6, linestyle=(0, (4, 3)))
    for place in diagram.upright:
        axes.axvline(place, color=COLOURS["grey"], linewidth=0.6, linestyle=(0, (4, 3)))
    if diagram.band:
        axes.axhspan(*diagram.band, color=COLOURS["grey"], alpha=0.18, linewidth=0)
    if diagram.levels:
        _limits(axes, diagram)
    if diagram.ends:
        axes.set_ylim(diagram.ends)
    elif diagram.whole:
        axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]) if axes.dataLim.y0 < 0.0 else 0.0)
    if diagram.log:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter("{x:g}")
    if diagram.tick:
        from matplotlib.ticker import MultipleLocator

        axes.yaxis.set_major_locator(MultipleLocator(diagram.tick))
    axes.set_ylabel(style.reads(diagram.name, diagram.unit))


def _on_lines(curve: Curve) -> str:
    """The name of a curve in a legend at the right, on lines of its own where it is long."""
    lines = textwrap.wrap(clean(curve.name).replace("\u200b", ""), _LETTERS)[:2]
    return "\n".join(style.named(line) for line in [*lines, *([curve.detail] if curve.detail else [])])


def _layer(axes: Axes, curve: Curve, stacks: dict[str, Array], name: str) -> None:
    from matplotlib.colors import to_rgb

    below = stacks.get(curve.stack, np.zeros(len(curve.y)))
    above = stacks[curve.stack] = below + curve.y
    colour = COLOURS[curve.colour]
    light = tuple(1.0 - 0.45 * (1.0 - part) for part in to_rgb(colour))  # lines can be read on it
    axes.stairs(above[:-1], curve.x, baseline=below[:-1], fill=True, facecolor=light, hatch=curve.hatch,
                edgecolor=colour, linewidth=0.4, label=name or None)  # fmt: skip


class Limit(NamedTuple):
    """A limit with its name in words, below its line where another one is close above it."""

    label: str
    value: float
    below: bool


def limits(diagram: Diagram, top: float) -> tuple[list[Limit], list[str]]:
    """Limits of a diagram up to the end of its axis; and those beyond, in words."""
    levels = [(f"{name} {value:.4g} {label(diagram.unit)}", value) for name, value in diagram.levels]
    inside = [value for _, value in levels if value <= top]
    near = _HEIGHT_OF_A_NAME * top
    sight = [Limit(text, value, any(value < other < value + near for other in inside))
             for text, value in levels if value <= top]  # fmt: skip
    return sight, [text for text, value in levels if not value <= top]


def _limits(axes: Axes, diagram: Diagram) -> None:
    """Limits in sight as lines, those beyond the end of the axis in words."""
    inside, beyond = limits(diagram, (diagram.ends or axes.get_ylim())[1])
    for look, (text, value, below) in enumerate(inside):
        style.limit(axes, value, text, look, below=below)
    if beyond:
        style.text_off(axes, "beyond: " + ", ".join(beyond), (0.0, 1.0), (3, -1), xycoords="axes fraction", va="top",
                       zorder=6)  # fmt: skip


def _decades(axes: Axes, ends: tuple[float, float] | None) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    plain = FuncFormatter(lambda x, _: f"{x:g}")
    axes.set(xscale="log")
    ends = ends or axes.get_xlim()
    axes.set_xlim(ends)
    axes.xaxis.set_major_formatter(plain)
    axes.xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    axes.tick_params(axis="x", which="minor", pad=5.0)  # on the line of the longer ticks
    axes.xaxis.set_minor_formatter(plain if ends[1] < 100.0 * ends[0] else NullFormatter())


@style.figure
def barred(figure: Figure, bars: Bars) -> None:
    """Bars as paper has them; where they have marks, with a legend of these and of the looks."""
    from matplotlib.lines import Line2D

    left, right = bars.sides
    ((axes,),) = style.placed(figure, 0.175 * len(bars.rows) + 0.72, left=left, right=right, top=0.24)
    draw_bars(axes, bars)
    style.text_off(axes, bars.head, (1.0, 1.0), (5, 3), xycoords="axes fraction")
    if bars.marks:
        mark: Any = {"color": "black", "linewidth": 0.9, "marker": "|", "markersize": 7, "linestyle": "none"}
        looks = {name: line for line, name in zip(*axes.get_legend_handles_labels(), strict=True)}
        names: dict[str, Any] = looks | {bars.marks: Line2D([], [], **mark)}
        figure.legend(names.values(), names, loc="upper right", ncols=len(names), borderaxespad=0.2)


def pictured(plot: Plot | Bars) -> Pictured:
    """A figure that has the same on paper and on the page."""
    return Pictured(barred(plot) if isinstance(plot, Bars) else on_paper(plot), [plot])


def draw_bars(axes: Axes, bars: Bars) -> None:
    """Bars on their axes, with their texts, for which the axis has room."""
    colours, rooms = {"ink": "black", "page": "white", **COLOURS}, []
    for place, bar in enumerate(bars.rows):
        face, edge, hatch = LOOKS[bar.look]
        axes.barh(place, bar.end - bar.start, left=bar.start, height=0.65, facecolor=colours[face], zorder=3,
                  edgecolor=colours[edge], hatch=hatch * 4 or None, linewidth=0.6, label=bar.look)  # fmt: skip
        if isfinite(bar.mark):
            axes.plot([bar.mark] * 2, [place - 0.42, place + 0.42], color="black", linewidth=0.9, zorder=5)
        for at, text, off, to in ((bar.start, bar.left, -3, "right"), (bar.end, bar.right, 3, "left")):
            style.text_off(axes, text, (at, place), (off, 0), va="center", ha=to, fontsize=6.2, zorder=5,
                         bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6})  # fmt: skip
        style.text_off(axes, bar.label, (1.0, place), (5, 0), xycoords=("axes fraction", "data"), va="center")
        rooms.append([style.width(text, 6.2) + 6.0 if text else 0.0 for text in (bar.left, bar.right)])
    style.bars(axes, [short(clean(bar.name), _LONGEST) for bar in bars.rows])
    axes.axvline(bars.line, color="black", linewidth=1.2, zorder=4)
    axes.set_xlabel(style.reads(bars.across, bars.unit))
    low, high = min(0.0, *(bar.start for bar in bars.rows)), max(0.0, *(bar.end for bar in bars.rows))
    before, behind = np.max(rooms, axis=0)
    wide = axes.get_window_extent().width * 72.0 / axes.figure.dpi
    scale = (high - low or 1.0) / (wide - before - behind)
    axes.set_xlim(bars.ends or (low - scale * before, high + scale * max(behind, 4.0)))


_LONGEST = 44  # letters of the name of a bar


# -- Texts beside the points of a diagram, where they cover neither one another, a point nor the edge.


_GAP, _DOT, _LETTER, _HIGH = 3.5, 2.5, 0.68, 1.25  # pt; half of a mark, pt; width and height of a letter by its size
SIDES = {"right": (1.0, 0.0), "left": (-1.0, 0.0), "top": (0.0, 1.0), "bottom": (0.0, -1.0), "top right": (1.0, 1.0),
         "bottom right": (1.0, -1.0), "top left": (-1.0, 1.0), "bottom left": (-1.0, -1.0)}  # fmt: skip


def spots(
    points: Sequence[tuple[float, float]], texts: Sequence[Sequence[str]], room: tuple[float, float], size: float
) -> list[tuple[str, str]]:
    """Of each point the first of its texts that has room, and its side; empty without.

    ``room`` is what the axes take [pt], with their ends as far beyond the points as ``AROUND`` says.

    >>> spots([(207.0, 2.1), (207.0, 0.9), (192.7, -29.0)], [["1"], ["2"], ["3"]], (300.0, 200.0), 6.5)
    [('1', 'right'), ('2', 'left'), ('3', 'right')]
    """
    at = np.array(points, float).reshape(-1, 2)
    low, spread = at.min(axis=0), np.where(np.ptp(at, axis=0) == 0.0, 1.0, np.ptp(at, axis=0))
    places = ((at - low) / spread + AROUND) / (1.0 + 2.0 * np.array(AROUND)) * room
    boxes = [(x - _DOT, y - _DOT, x + _DOT, y + _DOT) for x, y in places]
    labels = list[tuple[str, str]]()
    for x, y in places:
        spot = ("", "")
        for text in texts[len(labels)]:
            wide, high = _LETTER * size * len(text), _HIGH * size
            for side, (across, up) in SIDES.items():
                left = x + across * (_GAP + wide / 2.0) - wide / 2.0
                base = y + up * (_GAP + high / 2.0) - high / 2.0
                box = left, base, left + wide, base + high
                inside = min(left, base) >= 0.0 and box[2] <= room[0] and box[3] <= room[1]
                free = all(box[0] >= b[2] or b[0] >= box[2] or box[1] >= b[3] or b[1] >= box[3] for b in boxes)
                if inside and free:
                    boxes.append(box)
                    spot = short(text), side
                    break
            if spot[0]:
                break
        labels.append(spot)
    return labels


AROUND = (0.08, 0.12)  # of the spread of the points, beyond them at each end


@style.figure
def scatter(figure: Figure, plot: Plot) -> None:
    """Points with their texts as paper has them."""
    ((axes,),) = style.placed(figure, 2.9)
    (diagram,) = plot.diagrams
    draw(axes, diagram)
    axes.margins(*AROUND)
    axes.set_xlabel(style.reads(plot.across, plot.unit))
    for curve in diagram.curves:
        for x, y, (text, side) in zip(curve.x, curve.y, curve.spots, strict=True):
            across, up = SIDES.get(side, (0.0, 0.0))
            if text:
                style.text_off(axes, text, (x, y), (_GAP * across, _GAP * up), ha=_ALIGNED[-across], va=_UPRIGHT[-up])


_ALIGNED = {-1.0: "left", 0.0: "center", 1.0: "right"}
_UPRIGHT = {-1.0: "bottom", 0.0: "center", 1.0: "top"}
