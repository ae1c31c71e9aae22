"""Power of all axes over time that can be moved: what each draws, stacked, and below zero what each returns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.axes_power import LOOKS, Layer, layers, power_unit
from drivesizer.output.report.html.curves import Plot, figure, line, numbers, rows
from drivesizer.results.machine_power import MachinePower
from drivesizer.units import from_si, label

__all__ = ["power_plot"]

Array = NDArray[np.float64]
_PIECES = 1000  # finer than a screen
_NOTHING = 1e-6  # of the largest power: what rounding leaves
_SHAPES = {"////": "/", "....": ".", "\\\\\\\\": "\\", "xxxx": "x", "----": "-", "++++": "+"}  # of plotly, by hatch


def power_plot(power: MachinePower) -> Plot | None:
    """Layers of the axes over each other; one that is hidden leaves the others where they add up without it."""
    course = power.course(_PIECES)
    found = layers(power, course)
    if not found:
        return None
    largest = max(float(one.drawn.max(initial=0.0)) for one in found)
    unit, least = power_unit(largest), _NOTHING * largest
    data = [trace for layer, look in zip(found, LOOKS, strict=False)
            for trace in _stacked(layer, look, course.time, unit, least)]  # fmt: skip
    if not np.isnan(course.total).any():
        total = _ends(course.total, unit)
        data.append(line(course.time, total, "out of the source", "ink", hovertemplate=_hover("y", unit)))
        data[-1]["line"] |= {"shape": "hv", "width": 1.4}
    layout = rows([f"power ({label(unit)})"], height=320.0)
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": numbers((course.time[0], course.time[-1]))}
    layout["xaxis"]["hoverformat"] = ".4~r"
    return figure(data, layout)


def _stacked(layer: Layer, look: tuple[str, str], time: Array, unit: str, least: float) -> list[Plot]:
    """Traces of a layer: drawn and returned power on a stack of their own, the difference where it is pointed at."""
    colour, hatch = look
    net = layer.drawn - layer.returned
    said = {"customdata": numbers(_ends(np.where(np.abs(net) > least, net, 0.0), unit), 4),
            "hovertemplate": _hover("customdata", unit)}  # fmt: skip
    made = []
    for stack, values, hover in (("drawn", layer.drawn, said), ("returned", -layer.returned, {"hoverinfo": "skip"})):
        trace = line(time, _ends(values, unit), layer.name, colour, stackgroup=stack, fillcolor=colour, **hover)
        trace["line"] |= {"shape": "hv", "width": 0.6}
        if hatch:
            trace["fillpattern"] = {"shape": _SHAPES[hatch], "bgcolor": colour, "fgcolor": "page", "size": 7,
                                    "solidity": 0.15}  # fmt: skip
        made.append(trace)
    return made


def _ends(values: Array, unit: str) -> Array:
    """Means of pieces at the ends of these, the last one held."""
    return np.asarray(from_si(np.append(values, values[-1:]), unit, "power"))


def _hover(value: str, unit: str) -> str:
    return f"%{{{value}:.4~r}} {label(unit)}<extra>%{{fullData.name}}</extra>"
