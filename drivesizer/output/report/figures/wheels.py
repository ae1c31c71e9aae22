"""Two quantities over time for each driven wheel or load case: small diagrams, a row for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from drivesizer.output.report.figures.load_and_loop import Row, Trace, stretches
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, named, placed, torque_unit
from drivesizer.output.report.figures.time_strips import Strip, Window, across, strip, within
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["MOST_WHEELS", "each_over_time", "wheels_over_time"]

MOST_WHEELS = 8  # rows of a figure
_ROW, _NAME = 0.6, 0.19  # in, of a diagram and of the name above it
_LINE = 0.19  # in, of the names of limits
_COLOURS = ("vermillion", "blue")
_DASHES = ((0, (6, 2)), (0, (2, 1.5)), (0, (6, 1.5, 1, 1.5)))  # of limits
_IN_SIGHT = 2.0  # times what is drawn: a limit beyond is not drawn


def wheels_over_time(cycles: Sequence[tuple[str, LoadCycle]], form: Form = "svg") -> bytes:
    """Torque at the left and speed at the right, of each wheel or of several of equal demand."""
    shown = cycles[:MOST_WHEELS]
    unit = torque_unit(max(float(np.abs(cycle.torque).max()) for _, cycle in shown))
    rows = (Row("torque", "torque", unit), Row("speed", "rotary_speed", "rpm"))
    traces = [
        Trace(name, cycle.time.ravel(), {row.column: getattr(cycle, row.column).ravel() for row in rows})
        for name, cycle in shown
    ]
    return each_over_time(traces, rows, stretches(shown), form)


def each_over_time(traces: Sequence[Trace], sides: Sequence[Row], shown: Sequence[Window], form: Form = "svg") -> bytes:
    """Two quantities of each load case, beside each other."""
    traces, beside = traces[:MOST_WHEELS], strip(shown)
    ranges = [_ends(traces, side) for side in sides]
    names = _LINE if any(limits for *_, limits in ranges) else 0.0

    def draw(figure: Figure) -> None:
        grid = placed(figure, len(traces), 2, top=_NAME + 0.04 + names, gaps=(_NAME, 0.62), shared=False)
        for column, (side, ends) in enumerate(zip(sides, ranges, strict=True)):
            for row, trace in enumerate(traces):
                axes = grid[row][column]
                _over_time(axes, trace, beside, side, COLOURS[_COLOURS[column]])
                for look, (name, value) in enumerate(ends.limits):
                    said = f"{name} {value:.4g} {label(side.unit)}"
                    axes.axhline(value, color="black", linewidth=0.7, linestyle=_DASHES[look % 3], label=said)
                axes.set_ylim(ends.low, ends.high)
                axes.tick_params(labelbottom=row == len(traces) - 1)
                axes.set_title(f"{named(trace.name)}: {side.column} ({label(side.unit)})", pad=2.5)
            grid[-1][column].set_xlabel("time (s)")
        if names:
            left, right = (axes.get_legend_handles_labels() for axes in grid[0])
            heading(figure, [*left[0], *right[0]], [*left[1], *right[1]], 4)

    return drawn(draw, (_ROW + _NAME) * len(traces) + 0.46 + names, form)


class _Ends(NamedTuple):
    low: float
    high: float
    limits: tuple[tuple[str, float], ...]  # in sight


def _ends(traces: Sequence[Trace], side: Row) -> _Ends:
    """An axis for all load cases, with 0 in it, and the limits that it shows."""
    values = np.concatenate([from_si(trace.columns[side.column], side.unit, side.kind) for trace in traces])
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    limits = [(name, float(from_si(value, side.unit, side.kind))) for name, value in side.limits]
    near = tuple((name, value) for name, value in limits if value <= _IN_SIGHT * max(high, -low))
    high = max(high, *(value for _, value in near), 0.0)
    room = 0.07 * (high - low) or 1.0
    return _Ends(low - room * (low < 0.0), high + room, near)


def _over_time(axes: Axes, trace: Trace, shown: Strip, side: Row, colour: str) -> None:
    for number, window in enumerate(shown.windows):
        time, values = within(trace.time, trace.columns[side.column], window)
        axes.plot(shown.place(number, time), from_si(values, side.unit, side.kind), color=colour)
    axes.axhline(0.0, color="black", linewidth=0.6)
    across(axes, shown)
