"""One house style for all figures: colours, lines, units, and a drawing as SVG or PNG.

Thin lines that differ in dashes as well as in colour (Okabe-Ito), so that a grey print and a colour-blind reader lose
nothing; a unit on every axis. Axes have fixed places, so that those of figures on a page line up and no figure is laid
out by drawing it twice. Nothing here depends on the clock or on installed fonts. matplotlib is imported when a figure
is drawn.
"""

from __future__ import annotations

import io
import unicodedata
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from drivesizer.output.report.figures.layout import laid_out
from drivesizer.output.text import clean, short

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "CASES", "COLOURS", "FILES", "STYLE", "Form", "drawn", "heading", "limit", "named", "outside", "placed",
    "torque_unit", "width",
]  # fmt: skip

Form = Literal["svg", "png", "typeset"]  # typeset: SVG whose letters are letters, for whoever has the font
FILES: tuple[Form, ...] = ("svg", "png")  # those that are files of their own

COLOURS = {  # Okabe and Ito
    "blue": "#0072B2", "vermillion": "#D55E00", "green": "#009E73", "purple": "#CC79A7", "grey": "#555555",
    "orange": "#E69F00", "sky": "#56B4E9",
}  # fmt: skip

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.4,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.1,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "svg.hashsalt": "drivesizer",  # names inside the file come from this and the content, not from chance
    "axes.formatter.useoffset": False,
    "axes.titley": 1.0,  # where it is, and not found by measuring what is below it
    "axes.titlelocation": "left",
    "axes.titlesize": 7.5,
    "axes.titlepad": 4.0,
    "hatch.linewidth": 0.5,
    "text.parse_math": False,  # a name with dollar signs stays a name
    "svg.fonttype": "path",  # letters as outlines: the same on every machine
}

_WIDTH = 6.5  # inches: the text width of the report
_DOTS = 200  # per inch, of a PNG
_UNDATED: dict[str, dict[str, Any]] = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}


def drawn(draw: Any, height: float, form: Form = "svg") -> bytes:
    """A figure in the house style."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    kind = "png" if form == "png" else "svg"
    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # not what the user's matplotlibrc says
        matplotlib.rcParams.update(STYLE | ({"svg.fonttype": "none"} if form == "typeset" else {}))
        dots, canvas = (_DOTS, FigureCanvasAgg) if form == "png" else (72, FigureCanvasSVG)
        stream = io.BytesIO()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph .* missing")  # a box stands in for a letter of far scripts
            figure = laid_out(draw, (_WIDTH, height), dots, canvas)
            # not savefig, which draws all of it twice: once to find the extent of what is drawn, which nothing needs
            getattr(figure.canvas, f"print_{kind}")(stream, metadata=_UNDATED[kind])
    return stream.getvalue()


_EDGE = 0.05  # in, from the figure's edge to the labels of its axes
_BELOW = 0.22  # in, from an axis to its label
_TICKS = 2.2  # per inch, at most


def placed(
    figure: Figure,
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
    """Axes at fixed places: rows over each other, and their labels in line at the edges of the figure."""
    figure.set_layout_engine("none")
    width, height = figure.get_size_inches()
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
    found: list[list[Axes]] = [list(row) for row in grid]
    return found


def outside(axes: Axes) -> None:
    """A legend to the right of axes, which leave room for it."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.03), labelspacing=0.75, borderaxespad=0.4)


def heading(figure: Figure, handles: Any, names: Any, columns: int) -> None:
    """A legend above all axes, at the left."""
    figure.legend(handles, names, loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=columns, borderaxespad=0.2)


def limit(axes: Axes, value: float, name: str, look: int = 0, *, below: bool = False) -> None:
    """A limit as a line across, named at its right end, above it or below."""
    axes.axhline(value, color="black", linewidth=0.7, linestyle=_LIMITS[look % len(_LIMITS)], zorder=2)
    axes.annotate(name, (1.0, value), xycoords=("axes fraction", "data"), xytext=(-2, -1.5 if below else 1.5),
                  textcoords="offset points", ha="right", va="top" if below else "bottom", fontsize=6.5,
                  annotation_clip=False, zorder=6, bbox=_CLEAR)  # fmt: skip


_CLEAR = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}  # of lines below a word
_LIMITS: tuple[Any, ...] = ((0, (6, 2)), (0, (2, 1.5)), (0, (6, 1.5, 1, 1.5)))


CASES: tuple[tuple[str, Any], ...] = (  # colour and dashes of each load case
    ("green", "solid"), ("purple", (0, (5, 2))), ("grey", (0, (1, 1.2))), ("orange", (0, (3, 1, 1, 1, 1, 1))),
)  # fmt: skip


def named(name: str, room: float = 118.0) -> str:
    """A name as it stands in a legend, cut to the room for it [pt].

    One that begins with an underscore matplotlib would leave out.
    """
    shown = short(clean(name).replace("\u200b", ""), 28)
    while len(shown) > 1 and width(shown) > room:
        shown = shown.rstrip("…")[:-1] + "…"
    return f" {shown}".removeprefix("" if name.startswith("_") else " ")


def width(text: str, size: float = 7.0) -> float:
    """About how wide a text of a size is [pt]: letters of East Asia as wide as high, capitals wider than the rest."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    large = sum(letter.isupper() or letter in "mw@%—…" for letter in text)
    return size * (wide + 0.85 * large + 0.6 * (len(text) - wide - large))


def torque_unit(largest: float) -> str:
    """The unit in which torques up to some size are shown [N*m]."""
    return "mN*m" if largest < 1.0 else "N*m"
