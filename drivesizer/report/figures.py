"""Figures: the motion, the load over its cycle, a front, the closed loop."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.loadcycle import LoadCycle
from drivesizer.loads import load_cycle
from drivesizer.motions import Trapezoid
from drivesizer.profile import profile_of
from drivesizer.report.panels import Window, thinned, windows
from drivesizer.report.style import CASES, COLOURS, Form, drawn, named, torque_unit
from drivesizer.results import Validation
from drivesizer.spec import RobotSpec
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["closed_loop", "closed_loop_rows", "load_over_time", "speed_profile", "stretches", "trade_off"]


def speed_profile(spec: RobotSpec, form: Form = "svg") -> bytes:
    """The speed that the spec asks for over one cycle: a trapezoid by its phases, any other motion to scale."""
    motion = spec.motion
    if isinstance(motion, Trapezoid):
        return drawn(lambda figure: _phases(figure.add_subplot(), motion, spec.load.axis), 1.9, form)
    if motion is None:
        cycle = load_cycle(spec)
        time, speed, axis = cycle.time.ravel(), cycle.speed.ravel(), "rotary"
    else:
        asked, axis = profile_of(spec), spec.load.axis
        time, speed = np.array(asked.time) - asked.time[0], np.array(asked.speed)

    def draw(figure: Figure) -> None:
        kind, unit = _SPEED[axis]
        axes = figure.add_subplot()
        rows = thinned(time, speed, Window("", float(time[0]), float(time[-1])))
        axes.plot(time[rows], from_si(speed[rows], unit, kind), color=COLOURS["blue"], linewidth=1.6)
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.set(xlim=(time[0], time[-1]), xlabel="time (s)", ylabel=f"speed ({label(unit)})")

    return drawn(draw, 1.9, form)


_SPEED = {"linear": ("speed", "m/s"), "rotary": ("rotary_speed", "rpm")}  # of a load along a line or about an axis
_NARROWEST = 0.2  # of a phase that is drawn, as a share of the cycle


def _phases(axes: Axes, motion: Trapezoid, axis: str) -> None:
    """A trapezoid with its phases marked; short ones are drawn wider than to scale, so that each has its name."""
    kind, unit = _SPEED[axis]
    top = float(from_si(motion.speed, unit, kind))
    legs = _legs(motion, top)
    total = sum(duration for _, duration, _ in legs)
    edges = [0.0, *np.cumsum([max(duration / total, _NARROWEST) for _, duration, _ in legs])]
    times = [0.0, *np.cumsum([duration for _, duration, _ in legs])]
    span, low = (2.0 * top, -1.08 * top) if motion.there_and_back else (top, 0.0)
    for (name, duration, _), left, right in zip(legs, edges, edges[1:], strict=False):
        axes.text(
            (left + right) / 2, top + 0.13 * span, f"{name}\n{duration:g} s", ha="center", va="center", fontsize=7
        )
    for edge in edges:
        axes.axvline(edge, color=COLOURS["grey"], linewidth=0.5, linestyle=(0, (4, 3)))
    axes.plot(edges, [0.0, *(end for *_, end in legs)], color=COLOURS["blue"], linewidth=1.6)
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xticks(edges, [f"{time:g}" for time in times])
    axes.set(xlim=(0, edges[-1]), ylim=(low, top + 0.28 * span))
    axes.set(xlabel="time (s), phases not to scale", ylabel=f"speed ({label(unit)})")


def _legs(motion: Trapezoid, top: float) -> list[tuple[str, float, float]]:
    """Name, length [s] and speed at the end of each phase."""
    down = motion.acceleration_time if motion.deceleration_time is None else motion.deceleration_time
    there = [("acceleration", motion.acceleration_time, top), ("cruise", motion.cruise_time, top),
             ("deceleration", down, 0.0), ("rest", motion.rest_time, 0.0)]  # fmt: skip
    there = [leg for leg in there if leg[1] > 0]
    return there + [(name, duration, -end) for name, duration, end in there] if motion.there_and_back else there


def load_over_time(cycles: Sequence[tuple[str, LoadCycle]], form: Form = "svg") -> bytes:
    """Torque and speed of the driven shaft over the cycle, of one load case or of several.

    Parameters
    ----------
    cycles
        Load cycles with the names of their cases; the first few are drawn.
    """
    cycles = cycles[: len(CASES)]
    shown = stretches(cycles)
    largest = max(float(np.abs(cycle.torque).max()) for _, cycle in cycles)
    rows = (("torque", "torque", torque_unit(largest)), ("speed", "rotary_speed", "rpm"))

    def draw(figure: Figure) -> None:
        grid = figure.subplots(2, len(shown), sharex="col", sharey="row", squeeze=False)
        for line, (column, kind, unit) in zip(grid, rows, strict=True):
            line[0].set_ylabel(f"{column} ({label(unit)})")
            for axes, window in zip(line, shown, strict=True):
                for (name, cycle), look in zip(cycles, CASES, strict=False):
                    _over_time(axes, cycle, getattr(cycle, column).ravel(), (unit, kind), window, look, name)
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
        if len(cycles) > 1:
            figure.legend(*grid[0][0].get_legend_handles_labels(), loc="outside upper center", ncols=len(cycles))
        figure.align_ylabels()

    return drawn(draw, 2.9, form)


def _over_time(
    axes: Axes,
    cycle: LoadCycle,
    values: NDArray[np.float64],
    shown: tuple[str, str],
    window: Window,
    look: tuple[str, Any],
    name: str,
) -> None:
    time = cycle.time.ravel()
    kept = thinned(time, values, window)
    axes.plot(time[kept], from_si(values[kept], *shown), color=COLOURS[look[0]], linestyle=look[1], label=named(name))
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xlim(window.start, window.end)


def stretches(cycles: Sequence[tuple[str, LoadCycle]]) -> list[Window]:
    """What is drawn: where something changes, if that is at the same times in all load cases; else the whole time."""
    found = [_changes(cycle) for _, cycle in cycles]
    if all(one == found[0] for one in found):
        return found[0]
    return [Window("", 0.0, max(cycle.total for _, cycle in cycles))]


def _changes(cycle: LoadCycle) -> list[Window]:
    """Where speed or torque changes."""
    columns = (cycle.speed.ravel(), cycle.torque.ravel())
    steps = sum(np.abs(np.diff(x)) / (np.abs(x).max() or 1.0) for x in columns)
    return windows({"time": cycle.time.ravel(), "speed_reference": np.append(0.0, np.cumsum(steps))})


def trade_off(
    names: Sequence[str], across: Sequence[float], up: Sequence[float], heads: Sequence[str], form: Form = "svg"
) -> bytes:
    """Sets of a Pareto front by two of their objectives, numbered as in the table.

    Parameters
    ----------
    names
        What stands beside each set.
    across, up
        Two figures of each set as they are shown; NaN is not drawn.
    heads
        What the two axes are called, units included.
    """

    def draw(figure: Figure) -> None:
        axes = figure.add_subplot()
        axes.plot(across, up, "o", color=COLOURS["blue"], markersize=4)
        for name, x, y in zip(names, across, up, strict=True) if len(names) <= _NAMED else ():
            if np.isfinite(x + y):
                axes.annotate(name, (x, y), xytext=(4, 3), textcoords="offset points", fontsize=7)
        axes.margins(0.08)
        axes.set(xlabel=heads[0], ylabel=heads[1])

    return drawn(draw, 2.4, form)


_NAMED = 25  # numbers beside more points than these would cover one another


_ROWS = (  # columns of the series, and how the axis is called
    (("speed_reference", "speed"), "speed"),
    (("error",), "speed error"),
    (("position_error",), "position error"),
    (("current",), "current"),
    (("voltage",), "voltage"),
    (("winding_temperature",), "winding temperature"),
)


def closed_loop_rows(validation: Validation) -> list[tuple[tuple[str, ...], str]]:
    """What the figure of the closed loop shows: columns of the series that are there and known, and their title.

    A winding whose temperature is not known, or is not to move, is kept at one: there is nothing to show then.
    """
    series = validation.series
    known = {name for name, values in series.items() if np.isfinite(values).any()}
    if np.ptp(series.get("winding_temperature", np.zeros(1))) == 0.0:
        known -= {"winding_temperature"}
    return [row for row in _ROWS if known.issuperset(row[0])]


def closed_loop(validation: Validation, form: Form = "svg") -> bytes:
    """Reference and speed, errors, current, voltage and winding over the moments in which something changes."""
    shown, rows = windows(validation.series), closed_loop_rows(validation)

    def draw(figure: Figure) -> None:
        grid = figure.subplots(len(rows), len(shown), sharex="col", sharey="row", squeeze=False)
        for line, (names, title) in zip(grid, rows, strict=True):
            _, unit = validation.series_units[names[-1]]
            line[0].set_ylabel("\n".join([*title.split(), f"({label(unit)})"]))
            for axes, window in zip(line, shown, strict=True):
                _traces(axes, validation, names, window)
        for axes, window in zip(grid[0], shown, strict=True):
            axes.set_title(window.title, fontsize=7.5, loc="left")
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
        if len(rows[0][0]) > 1:
            grid[0][0].legend(loc="best")
        figure.align_ylabels()

    return drawn(draw, (1.25 if len(rows) <= _FEW else 1.1) * len(rows) + 0.3, form)


_FEW = 4  # rows: more are drawn lower, so that the figure and its caption fit a page


def _traces(axes: Axes, validation: Validation, names: tuple[str, ...], window: Window) -> None:
    looks = ((COLOURS["vermillion"], (0, (4, 3)), 1.0), (COLOURS["blue"], "solid", 1.4))
    for layer, (name, (colour, dashes, width)) in enumerate(zip(names, looks[-len(names) :], strict=True)):
        kind, unit = validation.series_units[name]
        rows = thinned(validation.series["time"], validation.series[name], window)
        time, values = validation.series["time"][rows], from_si(validation.series[name][rows], unit, kind)
        said = "reference" if name.endswith("reference") else name
        axes.plot(time, values, color=colour, linestyle=dashes, linewidth=width, label=said, zorder=4 - layer)
    axes.set_xlim(window.start, window.end)
