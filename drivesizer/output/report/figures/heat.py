"""Temperatures of winding and housing: from cold until nothing changes any more, and over the cycle that repeats."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.warm_up import WarmUp
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, limit, placed
from drivesizer.output.report.figures.time_strips import Window, thinned
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["temperatures", "time_unit"]

_WINDING: dict[str, Any] = {"color": COLOURS["vermillion"]}
_HOUSING: dict[str, Any] = {"color": COLOURS["blue"], "linestyle": (0, (5, 2))}


class _Scale(NamedTuple):
    unit: str

    def __call__(self, seconds: Any) -> Any:
        return from_si(seconds, self.unit, "time")


def time_unit(longest: float) -> str:
    """The unit in which times up to some length are shown [s]."""
    return "s" if longest < 600.0 else "min" if longest < 36_000.0 else "h"


def temperatures(found: WarmUp, ambient: float, permitted: float, form: Form = "svg") -> bytes:
    """Two diagrams: the way from cold, and one cycle of those that repeat."""

    def draw(figure: Figure) -> None:
        ((way, cycle),) = placed(figure, 1, 2, top=0.42, gaps=(0.0, 0.16))
        _way(way, found)
        _cycle(cycle, found)
        for axes in (way, cycle):
            limit(axes, _celsius(ambient), f"ambient {_celsius(ambient):.4g} °C" if axes is cycle else "", 1)
            if permitted == permitted:
                limit(axes, _celsius(permitted), f"permitted {_celsius(permitted):.4g} °C" if axes is cycle else "")
        top = np.nanmax([permitted, found.periodic.winding_peak])
        way.set_ylim(_celsius(ambient) - 0.04 * (top - ambient), _celsius(ambient) + 1.12 * (top - ambient))
        way.set_ylabel("temperature (°C)")
        heading(figure, *way.get_legend_handles_labels(), 3)

    return drawn(draw, 2.05, form)


def _celsius(kelvin: Any) -> Any:
    return from_si(kelvin, "degC", "temperature")


def _way(axes: Axes, found: WarmUp) -> None:
    """Lowest and highest of the winding in each cycle, as a band; the housing at the end of each."""
    scale = _Scale(time_unit(found.time[-1]))
    time = scale(found.time)
    low, high = (_celsius(np.append(x[0], x)) for x in (found.lowest, found.highest))
    axes.fill_between(time, low, high, step="pre", label="winding, in each cycle", linewidth=0.6,
                      facecolor="#F4C9A8", edgecolor=COLOURS["vermillion"])  # fmt: skip
    axes.plot(time, _celsius(found.housing), label="housing", **_HOUSING)
    axes.set(xlim=(0.0, time[-1]), xlabel=f"time from cold ({label(scale.unit)})")
    axes.set_title("from cold")


def _cycle(axes: Axes, found: WarmUp) -> None:
    """The cycle that repeats, with its peak."""
    cycle, scale = found.periodic, _Scale(time_unit(found.periodic.time[-1]))
    for values, look in ((cycle.winding, _WINDING), (cycle.housing, _HOUSING)):
        rows: NDArray[np.int64] = thinned(cycle.time, values, Window("", 0.0, float(cycle.time[-1])))
        axes.plot(scale(cycle.time[rows]), _celsius(values[rows]), **look)
    peak = _celsius(cycle.winding_peak)
    axes.plot([scale(cycle.winding_peak_time)], [peak], "o", markersize=4, color=COLOURS["vermillion"])
    axes.annotate(f"{peak:.1f} °C", (scale(cycle.winding_peak_time), peak), xytext=(4, 4), textcoords="offset points",
                  fontsize=6.5)  # fmt: skip
    axes.set(xlim=(0.0, scale(cycle.time[-1])), xlabel=f"time in the cycle ({label(scale.unit)})")
    axes.set_title("over the cycle that repeats")
