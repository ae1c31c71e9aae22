"""Figures over time: the load over its cycle, and the closed loop."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.output.report.figures.style import (
    CASES,
    COLOURS,
    Form,
    drawn,
    heading,
    limit,
    named,
    placed,
    torque_unit,
)
from drivesizer.output.report.figures.time_strips import Strip, Window, across, strip, windows, within
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["LINEAR", "Row", "Trace", "closed_loop", "closed_loop_rows", "load_over_time", "over_time", "stretches"]


class Trace(NamedTuple):
    """A load case over time."""

    name: str
    time: NDArray[np.float64]  # s
    columns: Mapping[str, NDArray[np.float64]]  # SI


class Row(NamedTuple):
    """Content of a row of a figure over time."""

    column: str
    kind: str
    unit: str
    limits: tuple[tuple[str, float], ...] = ()  # name and figure [SI]


def load_over_time(cycles: Sequence[tuple[str, LoadCycle]], form: Form = "svg") -> bytes:
    """Torque and speed of the driven shaft over the cycle, of one load case or of several."""
    cycles = cycles[: len(CASES)]
    largest = max(float(np.abs(cycle.torque).max()) for _, cycle in cycles)
    rows = (Row("torque", "torque", torque_unit(largest)), Row("speed", "rotary_speed", "rpm"))
    traces = [
        Trace(name, cycle.time.ravel(), {row.column: getattr(cycle, row.column).ravel() for row in rows})
        for name, cycle in cycles
    ]
    return over_time(traces, rows, stretches(cycles), form)


def over_time(traces: Sequence[Trace], rows: Sequence[Row], shown: Sequence[Window], form: Form = "svg") -> bytes:
    """Quantities over time, a row each, in the stretches in which something changes."""
    lines = math.ceil(len(traces) / _ABREAST) if len(traces) > 1 else 0

    beside = strip(shown)

    def draw(figure: Figure) -> None:
        grid = [axes for (axes,) in placed(figure, len(rows), top=0.1 + _LINE * lines)]
        for axes, row in zip(grid, rows, strict=True):
            axes.set_ylabel(f"{row.column} ({label(row.unit)})")
            for trace, look in zip(traces, CASES, strict=False):
                _over_time(axes, trace, row, beside, look)
            if row.limits:
                _limits(axes, row)
            across(axes, beside)
        grid[-1].set_xlabel("time (s)")
        if lines:
            heading(figure, *grid[0].get_legend_handles_labels(), min(len(traces), _ABREAST))

    return drawn(draw, 0.95 * len(rows) + 0.5 + _LINE * lines, form)


_ABREAST = 2  # names of load cases beside each other
_LINE = 0.16  # in, of a legend


_IN_SIGHT = 3.0  # times what is drawn: a limit beyond is named and not drawn
_HEADROOM = 1.15  # for the name above a limit
_HEIGHT_OF_A_NAME = 0.16  # of the axis


def _limits(axes: Axes, row: Row) -> None:
    """Limits in sight as lines, those beyond it in words."""
    reach = max(abs(end) for end in axes.get_ylim())
    limits = [(name, float(from_si(value, row.unit, row.kind))) for name, value in row.limits]
    inside = {name: value for name, value in limits if value <= _IN_SIGHT * reach}
    beyond = [_label(name, value, row.unit) for name, value in limits if name not in inside]
    near = _HEIGHT_OF_A_NAME * max(reach, *inside.values(), 0.0)
    for look, (name, value) in enumerate(inside.items()):
        below = any(value < other < value + near for other in inside.values())
        limit(axes, value, _label(name, value, row.unit), look, below=below)
    axes.set_ylim(top=_HEADROOM * max(axes.get_ylim()[1], *inside.values(), 0.0))
    if beyond:
        axes.annotate("beyond: " + ", ".join(beyond), (0.0, 1.0), (3, -1), xycoords="axes fraction",
                      textcoords="offset points", ha="left", va="top", fontsize=6.5)  # fmt: skip


def _label(name: str, value: float, unit: str) -> str:
    return f"{name} {value:.4g} {label(unit)}"


def _over_time(axes: Axes, trace: Trace, row: Row, shown: Strip, look: tuple[str, Any]) -> None:
    for number, window in enumerate(shown.windows):
        time, values = within(trace.time, trace.columns[row.column], window)
        axes.plot(shown.place(number, time), from_si(values, row.unit, row.kind), color=COLOURS[look[0]],
                  linestyle=look[1], label="" if number else named(trace.name))  # fmt: skip
    axes.axhline(0.0, color="black", linewidth=0.6)


def stretches(cycles: Sequence[tuple[str, LoadCycle]]) -> list[Window]:
    """Stretches that are drawn: where something changes, if at the same times in all cases; else the whole time."""
    found = [_changes(cycle) for _, cycle in cycles]
    if all(one == found[0] for one in found):
        return found[0]
    return [Window("", 0.0, max(cycle.total for _, cycle in cycles))]


def _changes(cycle: LoadCycle) -> list[Window]:
    """Times at which speed or torque changes."""
    columns = (cycle.speed.ravel(), cycle.torque.ravel())
    steps = sum(np.abs(np.diff(x)) / (np.abs(x).max() or 1.0) for x in columns)
    return windows({"time": cycle.time.ravel(), "speed_reference": np.append(0.0, np.cumsum(steps))})


LINEAR = "python-control"  # the linear model's trace

_ROWS = (  # columns of the series, and how the axis is called
    (("speed_reference", "speed"), "speed"),
    (("error",), "speed error"),
    (("position_error",), "position error"),
    (("load_angle",), "load angle"),
    (("current",), "current"),
    (("voltage",), "voltage"),
    (("winding_temperature",), "winding temperature"),
)


def closed_loop_rows(validation: Validation) -> list[tuple[tuple[str, ...], str]]:
    """Rows of the figure of the closed loop: columns of the series that are there and known, and their title.

    A winding whose temperature is not known, or is not to move, is kept at one: there is nothing to show then.
    """
    series = validation.series
    known = {name for name, values in series.items() if np.isfinite(values).any()}
    if np.ptp(series.get("winding_temperature", np.zeros(1))) == 0.0:
        known -= {"winding_temperature"}
    return [row for row in _ROWS if known.issuperset(row[0])]


def closed_loop(validation: Validation, form: Form = "svg") -> bytes:
    """Reference and speed, errors, current, voltage and winding over the moments in which something changes."""
    shown, rows = strip(windows(validation.series)), closed_loop_rows(validation)
    legend = _LINE if validation.linear and len(shown.windows) > 1 else 0.0  # above the titles of the stretches

    def draw(figure: Figure) -> None:
        grid = [axes for (axes,) in placed(figure, len(rows), left=0.8, top=0.22 + legend)]
        for axes, (names, title) in zip(grid, rows, strict=True):
            _, unit = validation.series_units[names[-1]]
            axes.set_ylabel("\n".join([*textwrap.wrap(title, _WIDEST), f"({label(unit)})"]))
            _traces(axes, validation, names, shown)
            across(axes, shown, titled=axes is grid[0])
        grid[-1].set_xlabel("time (s)")
        if len(rows[0][0]) > 1 or validation.linear:
            figure.legend(*grid[0].get_legend_handles_labels(), loc="upper right", ncols=3, borderaxespad=0.2)

    return drawn(draw, 0.62 * len(rows) + 0.6 + legend, form)


_ABOVE = {"reference": 4.0, LINEAR: 3.5}  # layers: they hardly differ from the speed
_WIDEST = 11  # letters of a row's title on a line


def _traces(axes: Axes, validation: Validation, names: tuple[str, ...], shown: Strip) -> None:
    looks = (("black", (0, (1, 2.5)), 1.3), (COLOURS["blue"], "solid", 1.4))
    traces = [
        (validation.series, name, "reference" if name.endswith("reference") else name, *look)
        for name, look in zip(names, looks[-len(names) :], strict=True)
    ]
    linear = validation.linear.series if validation.linear else {}
    if names[-1] in linear:
        traces.append((linear, names[-1], LINEAR, COLOURS["orange"], (0, (5, 2.5)), 0.9))
    for series, name, said, colour, dashes, width in traces:
        kind, unit = validation.series_units[name]
        above = _ABOVE.get(said, 2.5)
        for number, window in enumerate(shown.windows):
            if window.start >= series["time"][-1] or window.end <= series["time"][0]:  # of python-control's part
                continue
            seen = window._replace(start=max(window.start, series["time"][0]), end=min(window.end, series["time"][-1]))
            time, values = within(series["time"], series[name], seen)
            axes.plot(shown.place(number, time), from_si(values, unit, kind), color=colour, linestyle=dashes,
                      linewidth=width, label="" if number else said, zorder=above)  # fmt: skip
