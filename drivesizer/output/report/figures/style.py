"""One house style for all figures: colours, lines, units, layout, stretches of long records, drawings as SVG or PNG.

A figure is a function from a record to axes, ``@figure``: called with its record it is a ``Drawing``, laid out when it
is first printed. Thin lines differ in dashes as well as in colour (Okabe-Ito), so that a grey print and a colour-blind
reader lose nothing; a unit on every axis. Axes have fixed places, so that those of figures on a page line up and no
figure is laid out by drawing it twice. Nothing here depends on the clock or on installed fonts. matplotlib is imported
when a figure is drawn.
"""

from __future__ import annotations

import io
import unicodedata
import warnings
from collections.abc import Callable, Sequence
from functools import cache, cached_property, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Concatenate, Literal, NamedTuple, ParamSpec

import numpy as np
from numpy.typing import NDArray

from drivesizer import units
from drivesizer.output.derivation import clean, short
from drivesizer.output.thinning import extremes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


Array = NDArray[np.float64]
Form = Literal["svg", "png", "typeset"]  # typeset: SVG whose letters are letters, for whoever has the font
FILES: tuple[Form, ...] = ("svg", "png")  # those that are files of their own

COLOURS = {  # Okabe and Ito
    "blue": "#0072B2", "vermillion": "#D55E00", "green": "#009E73", "purple": "#CC79A7", "grey": "#555555",
    "orange": "#E69F00", "sky": "#56B4E9",
}  # fmt: skip

_WIDTH = 6.5  # inches: the text width of the report
_DOTS = 200  # per inch, of a PNG
_UNDATED: dict[str, dict[str, Any]] = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}


# -- A figure: laid out once for several forms of the same drawing.


@cache
def house_style() -> dict[Any, Any]:
    """matplotlib's parameters of the one style, which is in ``house.mplstyle``."""
    from matplotlib import rc_params_from_file

    return dict(rc_params_from_file(Path(__file__).with_name("house.mplstyle"), use_default_template=False))


class Drawing:
    """A figure of a record, drawn when it is printed: with its letters once, for all documents that have it."""

    def __init__(self, draw: Callable[[Figure], object]) -> None:
        self.draw = draw

    def __call__(self, form: Form = "svg") -> bytes:
        """The figure as SVG, or as PNG of 200 dots per inch."""
        return self._typeset if form == "typeset" else self._printed(form)

    @cached_property
    def _typeset(self) -> bytes:
        return self._printed("typeset")

    def _printed(self, form: Form) -> bytes:
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.backends.backend_svg import FigureCanvasSVG
        from matplotlib.figure import Figure

        kind, dots, canvas = ("png", _DOTS, FigureCanvasAgg) if form == "png" else ("svg", 72, FigureCanvasSVG)
        stream = io.BytesIO()
        with matplotlib.rc_context(), warnings.catch_warnings():
            matplotlib.rcdefaults()  # not what the user's matplotlibrc says
            matplotlib.rcParams.update(house_style() | ({"svg.fonttype": "none"} if form == "typeset" else {}))
            warnings.filterwarnings("ignore", message="Glyph .* missing")  # a box stands in for a letter of far scripts
            target = Figure(figsize=(_WIDTH, _WIDTH), dpi=dots)
            canvas(target)
            self.draw(target)
            # not savefig, which draws all of it twice: once to find the extent of what is drawn, which nothing needs
            getattr(target.canvas, f"print_{kind}")(stream, metadata=_UNDATED[kind])
        return stream.getvalue()


class Ready(Drawing):
    """A drawing that is SVG already, and of which there is no other form."""

    def __init__(self, svg: bytes) -> None:
        self.svg = svg

    def __call__(self, form: Form = "svg") -> bytes:
        """The figure as SVG."""
        return self.svg


_Record = ParamSpec("_Record")


def figure(draw: Callable[Concatenate[Figure, _Record], None]) -> Callable[_Record, Drawing]:
    """A function that draws a record on a figure, as one from the record to its drawing."""

    @wraps(draw)
    def drawing(*record: _Record.args, **options: _Record.kwargs) -> Drawing:
        return Drawing(lambda figure: draw(figure, *record, **options))

    return drawing


_EDGE = 0.05  # in, from the figure's edge to the labels of its axes
_BELOW = 0.22  # in, from an axis to its label
_TICKS = 2.2  # per inch, at most


def placed(
    figure: Figure,
    height: float,
    rows: int = 1,
    columns: int = 1,
    *,
    left: float = 0.66,
    right: float = 0.2,
    top: float = 0.08,
    bottom: float = 0.42,
    gaps: tuple[float, float] = (0.1, 0.12),
    heights: Sequence[float] | None = None,
    shared: bool = True,
) -> list[list[Axes]]:
    """Axes at fixed places in a figure of some height: rows over each other, their labels in line at its edges [in]."""
    figure.set_figheight(height)
    width = figure.get_figwidth()
    across = (width - left - right - gaps[1] * (columns - 1)) / columns
    up = (height - top - bottom - gaps[0] * (rows - 1)) / rows
    edges = {"left": left / width, "right": 1.0 - right / width, "bottom": bottom / height, "top": 1.0 - top / height}
    share: dict[str, Any] = {"sharex": "col", "sharey": "row"} if shared else {}
    grid = figure.subplots(
        rows, columns, squeeze=False, **share,
        gridspec_kw={"wspace": gaps[1] / across, "hspace": gaps[0] / up, "height_ratios": heights, **edges},
    )  # fmt: skip
    for axes in grid.flat:
        box = axes.get_position()
        axes.yaxis.set_label_coords((_EDGE - left) / (box.width * width), 0.5)
        axes.yaxis.label.set_verticalalignment("top")
        axes.xaxis.set_label_coords(0.5, -_BELOW / (box.height * height))
        for axis, room in ((axes.xaxis, box.width * width), (axes.yaxis, box.height * height)):
            axis.get_major_locator().set_params(nbins=max(3, min(round(_TICKS * room), 9)))
    return [list(row) for row in grid]


def outside(axes: Axes) -> None:
    """A legend to the right of axes, which leave room for it."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.03), labelspacing=0.75, borderaxespad=0.4)


def heading(figure: Figure, handles: Any, names: Any, columns: int) -> None:
    """A legend above all axes, at the left."""
    figure.legend(handles, names, loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.2)


def text_off(axes: Axes, text: str, place: tuple[float, float], off: tuple[float, float], **look: Any) -> None:
    """A word, if there is one, some points off a place, which is in data unless ``xycoords`` says otherwise."""
    if text:
        axes.annotate(text, place, xytext=off, textcoords="offset points", **{"fontsize": 6.5, **look})


def bars(axes: Axes, names: Sequence[str], *, upwards: bool = False) -> None:
    """Axes for horizontal bars, each with its name: the first one on top unless they go upwards."""
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", visible=False)
    ends = (-0.6, len(names) - 0.4)
    axes.set_ylim(*(ends if upwards else ends[::-1]))


def reads(name: str, unit: str) -> str:
    """The label of an axis."""
    return f"{name} ({units.label(unit)})" if unit else name


def limit(axes: Axes, value: float, name: str, look: int = 0, *, below: bool = False) -> None:
    """A limit as a line across, named at its right end, above it or below."""
    axes.axhline(value, color="black", linewidth=0.7, linestyle=LIMITS[look % len(LIMITS)], zorder=2)
    text_off(axes, name, (1.0, value), (-2, -1.5 if below else 1.5), xycoords=("axes fraction", "data"), ha="right",
           va="top" if below else "bottom", annotation_clip=False, zorder=6,
           bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6})  # fmt: skip


LIMITS: tuple[Any, ...] = ((0, (6, 2)), (0, (2, 1.5)), (0, (6, 1.5, 1, 1.5)))  # dashes
CASES: tuple[tuple[str, Any], ...] = (  # colour and dashes of each load case
    ("green", "solid"), ("purple", (0, (5, 2))), ("grey", (0, (1, 1.2))), ("orange", (0, (3, 1, 1, 1, 1, 1))),
)  # fmt: skip


def named(name: str, room: float = 118.0) -> str:
    """A name as it stands in a legend, cut to the room for it [pt].

    One that begins with an underscore matplotlib would leave out.
    """
    text = short(clean(name).replace("\u200b", ""), 28)
    while len(text) > 1 and width(text) > room:
        text = text.rstrip("…")[:-1] + "…"
    return f" {text}".removeprefix("" if name.startswith("_") else " ")


def width(text: str, size: float = 7.0) -> float:
    """About how wide a text of a size is [pt]: letters of East Asia as wide as high, capitals wider than the rest."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    large = sum(letter.isupper() or letter in "mw@%—…" for letter in text)
    return size * (wide + 0.85 * large + 0.6 * (len(text) - wide - large))


def torque_unit(largest: float) -> str:
    """The unit in which torques up to some size are shown [N*m]."""
    return "mN*m" if largest < 1.0 else "N*m"


# -- Stretches of a long record that a figure shows, beside each other on one axis, with gaps for what is left out.


_MOST = 700  # samples that a trace keeps: finer than print
_SEEN = 1.0 / 300.0  # of a window: a longer step in time is more than a line's width

_GAP = 0.035  # of all that is drawn, between two stretches
_TICKS_OF_STRIP = 5  # of a stretch, at most
_BREAK = [(-1.0, -1.8), (1.0, 1.8)]  # the mark where an axis is broken


class Window(NamedTuple):
    """A stretch of time with its title."""

    title: str
    start: float
    end: float


def windows(time: Array, reference: Array) -> list[Window]:
    """The first and the last stretch in which the reference changes; all of it where it changes most of the time."""
    whole = Window("whole cycle", float(time[0]), float(time[-1]))
    changing = np.flatnonzero(np.abs(np.diff(reference)) > 1e-6 * np.abs(reference).max(initial=0.0))
    if not len(changing):
        return [whole]
    still = time[changing[1:]] - time[changing[:-1] + 1]  # s, from the end of one change to the start of the next
    gap = int(np.argmax(still)) if len(still) else 0
    if not len(still) or still[gap] < 0.5 * (whole.end - whole.start):
        return [whole]
    first = whole.start, float(time[changing[gap] + 1])
    last = float(time[changing[gap + 1]]), float(time[changing[-1] + 1])
    room = 0.35 * max(first[1] - first[0], last[1] - last[0])
    return [
        Window("acceleration", first[0], first[1] + room),
        Window("deceleration", last[0] - room, min(last[1] + room, whole.end)),
    ]


def thinned(time: Array, values: Array, window: Window) -> NDArray[np.int64]:
    """Rows of a window to draw: all when they are few, else the extremes of equal bins, so that no peak is lost.

    The neighbours outside the window are among them, and both ends of every step in time that can be seen: where
    nothing changes a record may have few samples.
    """
    first, last = np.searchsorted(time, [window.start, window.end])
    start, end = max(first - 1, 0), min(last + 1, len(time))
    steps = np.flatnonzero(np.diff(time[start:end]) > _SEEN * (window.end - window.start))
    rows = [extremes(values[start:end], _MOST), steps, steps + 1]
    return start + np.unique(np.concatenate(rows))


class Strip(NamedTuple):
    """Stretches and where they are on the axis [s]."""

    windows: tuple[Window, ...]
    starts: tuple[float, ...]
    end: float

    def place(self, number: int, time: Array) -> Array:
        """Places of the times of a stretch."""
        return time - self.windows[number].start + self.starts[number]


def strip(windows: Sequence[Window]) -> Strip:
    """Stretches in a row.

    >>> strip([Window("", 0.0, 6.0), Window("", 100.0, 104.0)]).starts
    (0.0, 6.35)
    """
    lengths = [window.end - window.start for window in windows]
    gap, starts = _GAP * sum(lengths), [0.0]
    for length in lengths[:-1]:
        starts.append(round(starts[-1] + length + gap, 12))
    return Strip(tuple(windows), tuple(starts), starts[-1] + lengths[-1])


def within(time: Array, values: Array, window: Window) -> tuple[Array, Array]:
    """A record in a stretch, thinned, from its very start to its very end."""
    rows = thinned(time, values, window)
    t, v = time[rows], values[rows]
    inside = (t >= window.start) & (t <= window.end)
    edges = np.array([window.start, window.end])
    ends = np.interp(edges, t, v)
    missing = [not inside.any() or bool(edge != t[inside][n]) for n, edge in ((0, edges[0]), (-1, edges[1]))]
    pieces = [(edges[:1], ends[:1])] * missing[0] + [(t[inside], v[inside])] + [(edges[1:], ends[1:])] * missing[1]
    return np.concatenate([x for x, _ in pieces]), np.concatenate([y for _, y in pieces])


def across(axes: Axes, strip: Strip, *, titled: bool = False) -> None:
    """Ticks of each stretch by its own times, a gap with marks between them, and their titles."""
    from matplotlib.ticker import MaxNLocator

    locator = MaxNLocator(_TICKS_OF_STRIP, steps=[1, 2, 5, 10])
    places, names = list[float](), list[str]()
    for number, (window, start) in enumerate(zip(strip.windows, strip.starts, strict=True)):
        ticks, room = np.asarray(locator.tick_values(window.start, window.end)), 1e-9 * (window.end - window.start)
        ticks = ticks[(ticks >= window.start - room) & (ticks <= window.end + room)]
        places += strip.place(number, ticks).tolist()
        names += [f"{tick:.6g}" for tick in ticks]
        if titled:
            text_off(axes, window.title, (start, 1.0), (0, 4), xycoords=("data", "axes fraction"), fontsize=7.5)
        if number:
            before = strip.windows[number - 1]
            end = strip.starts[number - 1] + before.end - before.start
            axes.axvspan(end, start, facecolor="white", linewidth=0, zorder=3.5)
            axes.plot([end, start], [0.0, 0.0], transform=axes.get_xaxis_transform(), linestyle="none", marker=_BREAK,
                      markersize=5, color="black", clip_on=False, zorder=6)  # fmt: skip
    axes.set_xticks(places, names)
    axes.set_xlim(0.0, strip.end)


def plotted(axes: Axes, time: Array, values: Array, strip: Strip, *, label: str | None = None, **look: Any) -> None:
    """A record over time in all stretches."""
    for number, window in enumerate(strip.windows):
        start, end = max(window.start, float(time[0])), min(window.end, float(time[-1]))
        if start < end:  # a record may be of a part only
            t, v = within(time, values, window._replace(start=start, end=end))
            axes.plot(strip.place(number, t), v, label=None if number else label, **look)
