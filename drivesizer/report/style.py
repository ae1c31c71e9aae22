"""One house style for all figures: colours, lines, units, and a drawing as SVG or PNG.

Thin lines that differ in dashes as well as in colour (Okabe-Ito), so that a grey print and a colour-blind reader lose
nothing; a unit on every axis. Nothing here depends on the clock or on installed fonts. matplotlib is imported when a
figure is drawn.
"""

from __future__ import annotations

import io
import warnings
from typing import Any, Literal

from drivesizer.report.wording import clean, short

__all__ = ["CASES", "COLOURS", "STYLE", "Form", "drawn", "named", "torque_unit"]

Form = Literal["svg", "png"]

COLOURS = {  # Okabe and Ito
    "blue": "#0072B2", "vermillion": "#D55E00", "green": "#009E73", "purple": "#CC79A7", "grey": "#555555",
    "orange": "#E69F00",
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
    "text.parse_math": False,  # a name with dollar signs stays a name
    "svg.fonttype": "path",  # letters as outlines: the same on every machine
}

_WIDTH = 6.5  # inches: the text width of the report
_DOTS = 200  # per inch, of a PNG
_UNDATED: dict[Form, dict[str, Any]] = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}


def drawn(draw: Any, height: float, form: Form = "svg") -> bytes:
    """A figure in the house style.

    Parameters
    ----------
    draw
        What draws into a matplotlib figure.
    height
        Of the figure [in].
    form
        Drawing for print, or picture of 200 dots per inch.
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # not what the user's matplotlibrc says
        matplotlib.rcParams.update(STYLE)
        figure = Figure(figsize=(_WIDTH, height), layout="constrained")
        (FigureCanvasSVG if form == "svg" else FigureCanvasAgg)(figure)
        draw(figure)
        stream = io.BytesIO()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph .* missing")  # a box stands in for a letter of far scripts
            _lay_out(figure)
            dots = "figure" if form == "svg" else _DOTS
            figure.savefig(stream, format=form, metadata=_UNDATED[form], dpi=dots)
    return stream.getvalue()


def _lay_out(figure: Any) -> None:
    """Place the axes once: left to itself, matplotlib draws the whole figure for that before it draws it."""
    figure.get_layout_engine().execute(figure)
    figure.set_layout_engine(None)


CASES: tuple[tuple[str, Any], ...] = (  # colour and dashes of each load case
    ("green", "solid"), ("purple", (0, (5, 2))), ("grey", (0, (1, 1.2))), ("orange", (0, (3, 1, 1, 1, 1, 1))),
)  # fmt: skip


def named(name: str) -> str:
    """A name as it stands in a legend; one that begins with an underscore matplotlib would leave out."""
    return f" {short(clean(name), 28)}".removeprefix("" if name.startswith("_") else " ")


def torque_unit(largest: float) -> str:
    """The unit in which torques up to some size are shown [N*m]."""
    return "mN*m" if largest < 1.0 else "N*m"
