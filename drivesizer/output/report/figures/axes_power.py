"""Power of several axes on one supply over time: what each draws, stacked, and below zero what each returns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, named, placed
from drivesizer.results.machine_power import Course, MachinePower
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["LOOKS", "Layer", "axes_power", "layers", "power_unit"]

Array = NDArray[np.float64]
_MOST = 6  # axes that have a layer of their own
_PIECES = 1500  # finer than print
LOOKS: tuple[tuple[str, str], ...] = (  # colour and hatch, so that a grey print distinguishes them too
    ("blue", ""), ("orange", "////"), ("green", "...."), ("purple", "\\\\\\\\"), ("sky", "xxxx"),
    ("vermillion", "----"), ("grey", "++++"),
)  # fmt: skip


class Layer(NamedTuple):
    """Power of an axis, or of several small ones, over the pieces of a course."""

    name: str
    drawn: Array  # W
    returned: Array  # W


def layers(power: MachinePower, course: Course) -> list[Layer]:
    """Power of the axes as layers: of many axes those of the largest peaks, and the sum of the others."""
    known = [n for n in range(len(power.axes)) if not np.isnan(course.drawn[n]).any()]
    largest = sorted(known, key=lambda n: -float(course.drawn[n].max(initial=0.0)))[:_MOST]
    kept = known if len(known) <= _MOST + 1 else sorted(largest)
    made = [Layer(power.axes[n], course.drawn[n], course.returned[n]) for n in kept]
    rest = [n for n in known if n not in kept]
    if rest:
        made.append(Layer(f"{len(rest)} others", course.drawn[rest].sum(axis=0), course.returned[rest].sum(axis=0)))
    return made


def power_unit(largest: float) -> str:
    """The unit in which powers up to some size are shown [W]."""
    return "W" if largest < 10e3 else "kW"


def axes_power(power: MachinePower, form: Form = "svg") -> bytes:
    """Power of all axes over time."""
    course = power.course(_PIECES)
    found = layers(power, course)
    unit = power_unit(max((float(one.drawn.max(initial=0.0)) for one in found), default=0.0))

    def draw(figure: Figure) -> None:
        axes = placed(figure, top=0.22 * -(-(len(found) + 1) // _ABREAST) + 0.06)[0][0]
        _stack(axes, course, found, unit)
        if not np.isnan(course.total).any():
            axes.stairs(from_si(course.total, unit, "power"), course.time, baseline=None, color="black", linewidth=1.0,
                        label="out of the source")  # fmt: skip
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.set(xlabel="time (s)", ylabel=f"power ({label(unit)})", xlim=(course.time[0], course.time[-1]))
        heading(figure, *axes.get_legend_handles_labels(), _ABREAST)

    return drawn(draw, 3.0, form)


_ABREAST = 5  # names of the legend


def _stack(axes: Axes, course: Course, found: list[Layer], unit: str) -> None:
    """The layers over each other: drawn upward, returned downward."""
    above, below = np.zeros(len(course.total)), np.zeros(len(course.total))
    for layer, (colour, hatch) in zip(found, LOOKS, strict=False):
        look: dict[str, Any] = {"fill": True, "facecolor": _light(colour), "hatch": hatch,
                                "edgecolor": COLOURS[colour], "linewidth": 0.4}  # fmt: skip
        up, down = above + layer.drawn, below - layer.returned
        for low, high, name in ((above, up, named(layer.name, _ROOM)), (below, down, None)):
            ends = (from_si(values, unit, "power") for values in (high, low))
            axes.stairs(next(ends), course.time, baseline=next(ends), label=name, **look)
        above, below = up, down


_ROOM = 62.0  # pt, of a name in the legend


def _light(colour: str) -> tuple[float, ...]:
    """A colour that lines and letters can be read on."""
    from matplotlib.colors import to_rgb

    return tuple(1.0 - 0.45 * (1.0 - part) for part in to_rgb(COLOURS[colour]))
