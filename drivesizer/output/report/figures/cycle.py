"""Figures over time: motion, load, current and voltage, heat, energy, closed loop."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from itertools import accumulate
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import trajectory_of
from drivesizer.load_cases.profile import SPEED, profile_of
from drivesizer.machine.set_cycle import SetCycle, WarmUp, waveform
from drivesizer.machine.supply_power import EnergyFlow
from drivesizer.output.report.figures.field import TOGETHER
from drivesizer.output.report.figures.style import (
    CASES,
    COLOURS,
    Form,
    Strip,
    Window,
    across,
    drawn,
    heading,
    limit,
    named,
    placed,
    strip,
    thinned,
    torque_unit,
    windows,
    within,
)
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.motions import Track, Trapezoid, Waypoints
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "LINEAR", "MOST_WHEELS", "Row", "Trace", "closed_loop", "closed_loop_rows", "current_and_voltage", "each_over_time",
    "energy_bars", "energy_unit", "load_over_time", "platform_motion", "shares", "speed_profile", "speed_required",
    "stretches", "temperatures", "time_unit", "wheels_over_time",
]  # fmt: skip


# -- The motion of a cycle as a figure.


def speed_profile(spec: RobotSpec, form: Form = "svg") -> bytes:
    """The speed of the spec over one cycle: a trapezoid by its phases, any other motion to scale.

    Of a platform on a path it is that of the platform.
    """
    motion = spec.motion
    if isinstance(spec.motion, Track | Waypoints):
        return _platform(platform_motion(spec), form)
    if isinstance(motion, Trapezoid):
        return drawn(lambda figure: _phases(placed(figure)[0][0], motion, spec.load.axis), _HEIGHT, form)
    time, speed, (kind, unit) = speed_required(spec)

    def draw(figure: Figure) -> None:
        axes = placed(figure)[0][0]
        rows = thinned(time, speed, Window("", float(time[0]), float(time[-1])))
        axes.plot(time[rows], from_si(speed[rows], unit, kind), color=COLOURS["blue"], linewidth=1.6)
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.set(xlim=(time[0], time[-1]), xlabel="time (s)", ylabel=f"speed ({label(unit)})")

    return drawn(draw, _HEIGHT, form)


def speed_required(spec: RobotSpec) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[str, str]]:
    """Speed over one cycle [s, SI], and its kind and unit of the trade; of a recorded load that of the driven shaft."""
    if spec.motion is None:
        cycle = load_cycle(spec)
        return cycle.time.ravel(), cycle.speed.ravel(), SPEED["rotary"]
    required = profile_of(spec)
    return np.array(required.time) - required.time[0], np.array(required.speed), SPEED[spec.load.axis]


class Moved(NamedTuple):
    """A velocity of a platform over time."""

    name: str
    values: NDArray[np.float64]  # SI
    kind: str
    unit: str


def platform_motion(spec: RobotSpec) -> tuple[NDArray[np.float64], list[Moved]]:
    """The motion of a platform on its path, in its own axes: time [s], forwards and to the left, then turning.

    What it never does, such as going sideways, is left out; turning is last and is always there.
    """
    path = trajectory_of(spec)
    assert path is not None
    (forwards, left, turning), _ = path.in_robot()
    found = [Moved("forwards", forwards.ravel(), "speed", "m/s"), Moved("to the left", left.ravel(), "speed", "m/s")]
    largest = max(float(np.abs(one.values).max()) for one in found)
    straight = [one for one in found if np.abs(one.values).max() > _NONE * largest]
    return path.time.ravel(), [*straight, Moved("turning", turning.ravel(), "rotary_speed", "deg/s")]


_NONE = 1e-6  # of the largest speed


def _platform(moved: tuple[NDArray[np.float64], list[Moved]], form: Form) -> bytes:
    """Velocities along the floor over that of turning."""
    time, (*straight, turning) = moved
    window = Window("", float(time[0]), float(time[-1]))

    def line(axes: Axes, one: Moved, colour: str, dashes: Any) -> None:
        rows = thinned(time, one.values, window)
        axes.plot(time[rows], from_si(one.values[rows], one.unit, one.kind), color=COLOURS[colour], linestyle=dashes,
                  label=one.name)  # fmt: skip

    def draw(figure: Figure) -> None:
        grid = [axes for (axes,) in placed(figure, 2, top=0.24)]
        for one, look in zip(straight, (("blue", "solid"), ("vermillion", (0, (5, 2)))), strict=False):
            line(grid[0], one, *look)
        line(grid[1], turning, "green", "solid")
        for axes, said in zip(grid, ("speed (m/s)", "turning (°/s)"), strict=True):
            axes.axhline(0.0, color="black", linewidth=0.6)
            axes.set(xlim=(time[0], time[-1]), ylabel=said)
        grid[-1].set_xlabel("time (s)")
        heading(figure, *grid[0].get_legend_handles_labels(), 2)

    return drawn(draw, 2.1, form)


_HEIGHT = 1.45  # in
_NARROWEST = 0.2  # of a phase that is drawn, as a share of the cycle


def _phases(axes: Axes, motion: Trapezoid, axis: str) -> None:
    """A trapezoid with its phases marked; short ones are drawn wider than to scale, so that each has its name."""
    kind, unit = SPEED[axis]
    top = float(from_si(motion.speed, unit, kind))
    legs = _legs(motion, top)
    total = sum(duration for _, duration, _ in legs)
    edges = [0.0, *np.cumsum([max(duration / total, _NARROWEST) for _, duration, _ in legs])]
    times = [0.0, *np.cumsum([duration for _, duration, _ in legs])]
    span, low = (2.0 * top, -1.08 * top) if motion.there_and_back else (top, 0.0)
    for (name, duration, _), left, right in zip(legs, edges, edges[1:], strict=False):
        axes.text((left + right) / 2, top + 0.2 * span, f"{name}\n{duration:g} s", ha="center", va="center", fontsize=7)
    for edge in edges:
        axes.axvline(edge, color=COLOURS["grey"], linewidth=0.5, linestyle=(0, (4, 3)))
    axes.plot(edges, [0.0, *(end for *_, end in legs)], color=COLOURS["blue"], linewidth=1.6)
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xticks(edges, [f"{time:g}" for time in times])
    axes.set(xlim=(0, edges[-1]), ylim=(low, top + 0.4 * span))
    axes.set(xlabel="time (s), phases not to scale", ylabel=f"speed ({label(unit)})")


def _legs(motion: Trapezoid, top: float) -> list[tuple[str, float, float]]:
    """Name, length [s] and speed at the end of each phase."""
    down = motion.acceleration_time if motion.deceleration_time is None else motion.deceleration_time
    there = [("acceleration", motion.acceleration_time, top), ("cruise", motion.cruise_time, top),
             ("deceleration", down, 0.0), ("rest", motion.rest_time, 0.0)]  # fmt: skip
    there = [leg for leg in there if leg[1] > 0]
    return there + [(name, duration, -end) for name, duration, end in there] if motion.there_and_back else there


# -- Figures over time: the load over its cycle, and the closed loop.


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


# -- Two quantities over time for each driven wheel or load case: small diagrams, a row for each.


MOST_WHEELS = 8  # rows of a figure
_ROW, _NAME = 0.6, 0.19  # in, of a diagram and of the name above it
_LIMIT_LINE = 0.19  # in, of the names of limits
_COLOURS = ("vermillion", "blue")
_DASHES = ((0, (6, 2)), (0, (2, 1.5)), (0, (6, 1.5, 1, 1.5)))  # of limits
_IN_SIGHT_OF_WHEELS = 2.0  # times what is drawn: a limit beyond is not drawn


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
    names = _LIMIT_LINE if any(limits for *_, limits in ranges) else 0.0

    def draw(figure: Figure) -> None:
        grid = placed(figure, len(traces), 2, top=_NAME + 0.04 + names, gaps=(_NAME, 0.62), shared=False)
        for column, (side, ends) in enumerate(zip(sides, ranges, strict=True)):
            for row, trace in enumerate(traces):
                axes = grid[row][column]
                _trace_over_time(axes, trace, beside, side, COLOURS[_COLOURS[column]])
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
    near = tuple((name, value) for name, value in limits if value <= _IN_SIGHT_OF_WHEELS * max(high, -low))
    high = max(high, *(value for _, value in near), 0.0)
    room = 0.07 * (high - low) or 1.0
    return _Ends(low - room * (low < 0.0), high + room, near)


def _trace_over_time(axes: Axes, trace: Trace, shown: Strip, side: Row, colour: str) -> None:
    for number, window in enumerate(shown.windows):
        time, values = within(trace.time, trace.columns[side.column], window)
        axes.plot(shown.place(number, time), from_si(values, side.unit, side.kind), color=colour)
    axes.axhline(0.0, color="black", linewidth=0.6)
    across(axes, shown)


# -- Current and voltage of the motor over the cycle, with the limits that they must not pass.


Limits = Sequence[tuple[str, float]]  # name and figure [SI]


def current_and_voltage(
    cases: Sequence[tuple[str, SetCycle]], currents: Limits, voltages: Limits, form: Form = "svg"
) -> bytes:
    """Current and voltage of each moment by the drive model, with the winding as warm as it then is."""
    cases = cases[:MOST_WHEELS]
    traces, cycles = [], []
    for name, found in cases:
        ends, cycle = waveform(found), found.cycle.load_cycle
        columns = {"current": ends.current[0].ravel(), "voltage": ends.voltage[0].ravel()}
        time = np.cumsum(ends.duration)
        traces.append(Trace(name, np.stack([time - ends.duration, time], axis=1).ravel(), columns))
        cycles.append((name, cycle))
    rows = (Row("current", "current", "A", _known(currents)), Row("voltage", "voltage", "V", _known(voltages)))
    draw = each_over_time if len(cases) > TOGETHER else over_time
    return draw(traces, rows, stretches(cycles), form)


def _known(limits: Limits) -> tuple[tuple[str, float], ...]:
    return tuple((name, value) for name, value in limits if isfinite(value))


# -- Temperatures of winding and housing: from cold until nothing changes any more, and over the cycle that repeats.


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


# -- Flow of the energy of a cycle, as bars that follow one another from the energy drawn down to nothing.


_BAR_ROW = 0.17  # in
_SMALLEST = 1e-6  # of what is drawn: less is none, or the rounding of a trajectory
_LOOKS: dict[str, dict[str, Any]] = {  # distinct in grey as well
    "drawn": {"facecolor": "#BBBBBB", "edgecolor": "black"},
    "loss": {"facecolor": "#F4C9A8", "edgecolor": COLOURS["vermillion"], "hatch": "/////"},
    "load": {"facecolor": COLOURS["sky"], "edgecolor": COLOURS["blue"]},
    "back": {"facecolor": "white", "edgecolor": COLOURS["green"], "hatch": "\\\\\\"},
}


class Share(NamedTuple):
    """A part of the energy."""

    name: str
    value: float  # J
    look: str


def shares(flow: EnergyFlow) -> list[Share]:
    """Energy drawn, and then all that it goes into; shares of zero are left out."""
    into = [
        Share("resistance of the supply", flow.supply, "loss"),
        Share("controllers", flow.controller, "loss"),
        Share("brake, released", flow.brake, "loss"),
        Share("copper of the winding", flow.copper, "loss"),
        Share("friction and iron of the motor", flow.friction, "loss"),
        Share("gearhead", flow.gearhead, "loss"),
        Share("belt", flow.belt, "loss"),
        Share("work on the load", flow.load, "load"),
        Share("more in rotor and gear at the end", flow.rotor, "load"),
        Share("regenerated, kept by the supply", flow.stored, "back"),
        Share("regenerated, not kept", flow.burnt, "loss"),
    ]
    size = max(flow.drawn, abs(flow.load))
    return [Share("drawn from the supply", flow.drawn, "drawn"), *(x for x in into if abs(x.value) > _SMALLEST * size)]


def energy_unit(largest: float) -> str:
    """The unit in which energies up to some size are shown [J]."""
    return "J" if largest < 1e4 else "kJ" if largest < 1e7 else "MJ"


def energy_bars(flow: EnergyFlow, form: Form = "svg") -> bytes:
    """The energy of a cycle: each bar begins where the one above it ends, the last one ends at nothing."""
    shown = shares(flow)
    unit = energy_unit(max(abs(share.value) for share in shown))

    def draw(figure: Figure) -> None:
        axes = placed(figure, left=2.0, right=1.25, top=0.06)[0][0]
        left = [0.0, *accumulate((-share.value for share in shown[1:]), initial=flow.drawn)]
        for place, (share, start) in enumerate(zip(shown, left, strict=False)):
            _bar(axes, place, share, start, (unit, flow.drawn))
        axes.set_yticks(range(len(shown)), [share.name for share in shown])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="y", visible=False)
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.set(ylim=(len(shown) - 0.4, -0.6), xlabel=f"energy of a cycle ({label(unit)})")

    return drawn(draw, _BAR_ROW * len(shown) + 0.52, form)


def _bar(axes: Axes, place: int, share: Share, start: float, scale: tuple[str, float]) -> None:
    unit, whole = scale
    first, width = (float(from_si(x, unit, "energy")) for x in (start, share.value))
    down = share.look != "drawn"
    axes.barh(place, -width if down else width, left=first, height=0.66, linewidth=0.6, zorder=3, **_LOOKS[share.look])
    part = f", {100.0 * share.value / whole:.3g} %" if down and whole > 0.0 else ""
    said = f"{width:.4g} {label(unit)}{part}".replace("-", "−")
    axes.annotate(said, (1.0, place), xycoords=("axes fraction", "data"), xytext=(5, 0), textcoords="offset points",
                  va="center", fontsize=6.8)  # fmt: skip
