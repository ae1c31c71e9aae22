"""A set at the bench: temperatures over time with their bands, and speed over torque with its band."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from drivesizer.output.report.figures.cycle import time_unit
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, limit, placed, torque_unit
from drivesizer.results.prediction import Band, Prediction, WarmingCourse
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["bench"]

_LOOKS = {"cold": ("blue", "solid"), "warm": ("vermillion", (0, (5, 2)))}


def bench(found: Prediction, form: Form = "svg") -> bytes:
    """Three diagrams: speed over torque; temperatures over time while running at the load."""

    def draw(figure: Figure) -> None:
        ((line, work, hold),) = placed(figure, 1, 3, top=0.42, gaps=(0.0, 0.7), shared=False)
        _line(line, found)
        for axes, name, title in ((work, "work", "winding, running at the load"), (hold, "hold", "winding, holding")):
            courses = [one for one in found.courses if one.name.startswith(name)]
            for one in courses:
                _course(axes, one)
            axes.set_title(title if courses else f"{title}: unknown")
            if courses and found.limit == found.limit:
                limit(axes, _celsius(found.limit), f"permitted {_celsius(found.limit):.4g} °C")
        work.set_ylabel("temperature (°C)")
        top = max(work.get_ylim()[1], hold.get_ylim()[1])
        for axes in (work, hold):
            axes.set_ylim(_celsius(found.conditions.ambient) - 2.0, top)
        shown = next((axes for axes in (work, hold) if axes.get_legend_handles_labels()[0]), line)
        heading(figure, *shown.get_legend_handles_labels(), 4)

    return drawn(draw, 2.3, form)


def _celsius(kelvin: Any) -> Any:
    return from_si(kelvin, "degC", "temperature")


def _line(axes: Axes, found: Prediction) -> None:
    unit = torque_unit(float(found.torque[-1]))
    torque = from_si(found.torque, unit, "torque")
    speed = Band(*(from_si(x, "rpm", "rotary_speed") for x in found.speed))
    _banded(axes, torque, speed, COLOURS["green"], "solid", "")
    axes.set(xlim=(0.0, None), ylim=(0.0, None), xlabel=f"torque ({label(unit)})", ylabel="speed (rpm)")
    axes.set_title("at full voltage")


def _course(axes: Axes, one: WarmingCourse) -> None:
    start = one.name.rsplit("_", 1)[1]
    colour, dashes = _LOOKS[start]
    unit = time_unit(float(one.time[-1]) / 6.0)
    time = from_si(one.time, unit, "time")
    _banded(axes, time, Band(*(_celsius(x) for x in one.winding)), COLOURS[colour], dashes, f"from {start}")
    axes.set(xlim=(0.0, float(time[-1])), xlabel=f"time ({label(unit)})")


def _banded(axes: Axes, along: Any, band: Band, colour: str, dashes: Any, name: str) -> None:
    """The nominal course as a line, 5 to 95 % as an area."""
    axes.fill_between(along, band.p5, band.p95, color=colour, alpha=0.18, linewidth=0.0,
                      label=f"5 to 95 %{', ' if name else ''}{name}")  # fmt: skip
    axes.plot(along, band.nominal, color=colour, linestyle=dashes, label=f"nominal{', ' if name else ''}{name}")
