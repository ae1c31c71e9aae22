"""Figures over time: motion, load, current and voltage, heat, energy, closed loop, a set at the bench."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import trajectory_of
from drivesizer.load_cases.profile import profile_of
from drivesizer.loads.motions import SPEED, Track, Trapezoid, Waypoints
from drivesizer.machine.set_cycle import SetCycle, WarmUp
from drivesizer.machine.supply_power import EnergyFlow
from drivesizer.output.report.figures import style
from drivesizer.output.report.figures.field import TOGETHER
from drivesizer.output.report.figures.style import CASES, COLOURS, Window, figure, placed, reads
from drivesizer.physics.load_cycle import LoadCycle, end_times
from drivesizer.results.prediction import Prediction
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


Array = NDArray[np.float64]


# -- The motion of a cycle.


def speed_required(spec: RobotSpec) -> tuple[Array, Array, tuple[str, str]]:
    """Speed over one cycle [s, SI], and its kind and unit of the trade; of a recorded load that of the driven shaft."""
    if spec.motion is None:
        cycle = load_cycle(spec)
        return cycle.time.ravel(), cycle.speed.ravel(), SPEED["rotary"]
    required = profile_of(spec)
    return np.array(required.time) - required.time[0], np.array(required.speed), SPEED[spec.load.axis]


class Moved(NamedTuple):
    """A velocity of a platform over time."""

    name: str
    values: Array  # SI
    kind: str
    unit: str


_STILL = 1e-6  # of the largest speed: what a platform never does


def platform_motion(spec: RobotSpec) -> tuple[Array, list[Moved]]:
    """The motion of a platform on its path, in its own axes: time [s], forwards and to the left, then turning.

    What it never does, such as going sideways, is left out; turning is last and is always there.
    """
    path = trajectory_of(spec)
    assert path is not None
    (forwards, left, turning), _ = path.in_robot()
    found = [Moved("forwards", forwards.ravel(), "speed", "m/s"), Moved("to the left", left.ravel(), "speed", "m/s")]
    largest = max(float(np.abs(one.values).max()) for one in found)
    straight = [one for one in found if np.abs(one.values).max() > _STILL * largest]
    return path.time.ravel(), [*straight, Moved("turning", turning.ravel(), "rotary_speed", "deg/s")]


_HEIGHT = 1.45  # in
_NARROWEST = 0.2  # of a phase that is drawn, as a share of the cycle


@figure
def speed_profile(figure: Figure, spec: RobotSpec) -> None:
    """The speed of the spec over one cycle: a trapezoid by its phases, any other motion to scale.

    Of a platform on a path it is that of the platform: velocities along the floor over that of turning.
    """
    looks: Any = (("blue", "solid"), ("vermillion", (0, (5, 2)))), (("green", "solid"),)
    if isinstance(spec.motion, Track | Waypoints):
        time, (*straight, turning) = platform_motion(spec)
        rows, labels, width = [straight, [turning]], ["speed (m/s)", "turning (°/s)"], 1.1
        grid = [axes for (axes,) in placed(figure, 2.1, 2, top=0.24)]
    else:
        ((axes,),) = placed(figure, _HEIGHT)
        if isinstance(spec.motion, Trapezoid):
            _phases(axes, spec.motion, spec.load.axis)
            return
        time, speed, (kind, unit) = speed_required(spec)
        grid, rows, labels, width = [axes], [[Moved("", speed, kind, unit)]], [reads("speed", unit)], 1.6
    for axes, row, said, of_row in zip(grid, rows, labels, looks, strict=False):
        for one, (colour, dashes) in zip(row, of_row, strict=False):
            some = style.thinned(time, one.values, Window("", float(time[0]), float(time[-1])))
            axes.plot(time[some], from_si(one.values[some], one.unit, one.kind), color=COLOURS[colour],
                      linestyle=dashes, linewidth=width, label=one.name)  # fmt: skip
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.set(xlim=(time[0], time[-1]), ylabel=said)
    grid[-1].set_xlabel("time (s)")
    if len(grid) > 1:
        style.heading(figure, *grid[0].get_legend_handles_labels(), 2)


def _phases(axes: Axes, motion: Trapezoid, axis: str) -> None:
    """A trapezoid with its phases marked; short ones are drawn wider than to scale, so that each has its name."""
    kind, unit = SPEED[axis]
    up, cruise, down, reached = motion.phases
    top = float(from_si(reached, unit, kind))
    phases = [("acceleration", up, top), ("cruise", cruise, top),
              ("deceleration", down, 0.0), ("rest", motion.rest_time, 0.0)]  # fmt: skip
    phases = [phase for phase in phases if phase[1] > 0]
    if motion.there_and_back:
        phases += [(name, duration, -end) for name, duration, end in phases]
    total = sum(duration for _, duration, _ in phases)
    edges = [0.0, *np.cumsum([max(duration / total, _NARROWEST) for _, duration, _ in phases])]
    times = [0.0, *np.cumsum([duration for _, duration, _ in phases])]
    span, low = (2.0 * top, -1.08 * top) if motion.there_and_back else (top, 0.0)
    for (name, duration, _), left, right in zip(phases, edges, edges[1:], strict=False):
        axes.text((left + right) / 2, top + 0.2 * span, f"{name}\n{duration:g} s", ha="center", va="center", fontsize=7)
    for edge in edges:
        axes.axvline(edge, color=COLOURS["grey"], linewidth=0.5, linestyle=(0, (4, 3)))
    axes.plot(edges, [0.0, *(end for *_, end in phases)], color=COLOURS["blue"], linewidth=1.6)
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xticks(edges, [f"{time:g}" for time in times])
    axes.set(xlim=(0, edges[-1]), ylim=(low, top + 0.4 * span))
    axes.set(xlabel="time (s), phases not to scale", ylabel=reads("speed", unit))


# -- Quantities of load cases over time: a row each, or for each driven wheel or case small diagrams beside each other.


class Trace(NamedTuple):
    """A load case over time."""

    name: str
    time: Array  # s
    columns: Mapping[str, Array]  # SI


class Row(NamedTuple):
    """A quantity of a figure over time."""

    column: str
    kind: str
    unit: str
    limits: tuple[tuple[str, float], ...] = ()  # name and figure [SI]

    @property
    def in_unit(self) -> list[tuple[str, float]]:
        """The limits in the unit of the trade."""
        return [(name, float(from_si(value, self.unit, self.kind))) for name, value in self.limits]

    def said(self, name: str, value: float) -> str:
        """A limit in words."""
        return f"{name} {value:.4g} {label(self.unit)}"


MOST_WHEELS = 8  # rows of a figure
_ABREAST = 2  # names of load cases beside each other
_LINE = 0.16  # in, of a legend
_IN_SIGHT = 3.0  # times what is drawn: a limit beyond is named and not drawn
_HEADROOM = 1.15  # for the name above a limit
_HEIGHT_OF_A_NAME = 0.16  # of the axis


@figure
def load_over_time(figure: Figure, cycles: Sequence[tuple[str, LoadCycle]]) -> None:
    """Torque and speed of the driven shaft over the cycle, of one load case or of several."""
    over_time(figure, *_loads(cycles[: len(CASES)]))


@figure
def wheels_over_time(figure: Figure, cycles: Sequence[tuple[str, LoadCycle]]) -> None:
    """Torque at the left and speed at the right, of each wheel or of several of equal demand."""
    each_over_time(figure, *_loads(cycles[:MOST_WHEELS]))


def _loads(cycles: Sequence[tuple[str, LoadCycle]]) -> tuple[list[Trace], tuple[Row, ...], list[Window]]:
    unit = style.torque_unit(max(float(np.abs(cycle.torque).max()) for _, cycle in cycles))
    traces = [
        Trace(name, cycle.time.ravel(), {"torque": cycle.torque.ravel(), "speed": cycle.speed.ravel()})
        for name, cycle in cycles
    ]
    return traces, (Row("torque", "torque", unit), Row("speed", "rotary_speed", "rpm")), stretches(cycles)


def stretches(cycles: Sequence[tuple[str, LoadCycle]]) -> list[Window]:
    """Stretches that are drawn: where something changes, if at the same times in all cases; else the whole time."""
    found = []
    for _, cycle in cycles:
        columns = (cycle.speed.ravel(), cycle.torque.ravel())
        steps = sum(np.abs(np.diff(x)) / (np.abs(x).max() or 1.0) for x in columns)
        changes = np.append(0.0, np.cumsum(steps))
        found.append(style.windows({"time": cycle.time.ravel(), "speed_reference": changes}))
    if all(one == found[0] for one in found):
        return found[0]
    return [Window("", 0.0, max(cycle.total for _, cycle in cycles))]


def over_time(figure: Figure, traces: Sequence[Trace], rows: Sequence[Row], shown: Sequence[Window]) -> None:
    """Quantities over time, a row each, in the stretches in which something changes."""
    legend = _LINE * math.ceil(len(traces) / _ABREAST) if len(traces) > 1 else 0.0
    strip = style.strip(shown)
    grid = [axes for (axes,) in placed(figure, 0.95 * len(rows) + 0.5 + legend, len(rows), top=0.1 + legend)]
    for axes, row in zip(grid, rows, strict=True):
        axes.set_ylabel(reads(row.column, row.unit))
        for trace, (colour, dashes) in zip(traces, CASES, strict=False):
            style.plotted(axes, trace.time, trace.columns[row.column], strip, row.kind, row.unit,
                          style.named(trace.name), color=COLOURS[colour], linestyle=dashes)  # fmt: skip
            axes.axhline(0.0, color="black", linewidth=0.6)
        if row.limits:
            _limits(axes, row)
        style.across(axes, strip)
    grid[-1].set_xlabel("time (s)")
    if legend:
        style.heading(figure, *grid[0].get_legend_handles_labels(), min(len(traces), _ABREAST))


def _limits(axes: Axes, row: Row) -> None:
    """Limits in sight as lines, those beyond it in words."""
    reach = max(abs(end) for end in axes.get_ylim())
    inside = {name: value for name, value in row.in_unit if value <= _IN_SIGHT * reach}
    beyond = [row.said(name, value) for name, value in row.in_unit if name not in inside]
    near = _HEIGHT_OF_A_NAME * max(reach, *inside.values(), 0.0)
    for look, (name, value) in enumerate(inside.items()):
        below = any(value < other < value + near for other in inside.values())
        style.limit(axes, value, row.said(name, value), look, below=below)
    axes.set_ylim(top=_HEADROOM * max(axes.get_ylim()[1], *inside.values(), 0.0))
    if beyond:
        style.beside(axes, "beyond: " + ", ".join(beyond), (0.0, 1.0), (3, -1), xycoords="axes fraction", va="top")


_ROW, _NAME = 0.6, 0.19  # in, of a small diagram and of the name above it
_LIMIT_LINE = 0.19  # in, of the names of limits
_IN_SIGHT_OF_WHEELS = 2.0  # times what is drawn: a limit beyond is not drawn


def each_over_time(figure: Figure, traces: Sequence[Trace], sides: Sequence[Row], shown: Sequence[Window]) -> None:
    """Two quantities of each load case, beside each other; an axis for all of them, with 0 and the limits in sight."""
    traces, strip = traces[:MOST_WHEELS], style.strip(shown)
    ends, limits = [], []
    for side in sides:
        values = np.concatenate([from_si(trace.columns[side.column], side.unit, side.kind) for trace in traces])
        low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
        near = [(name, value) for name, value in side.in_unit if value <= _IN_SIGHT_OF_WHEELS * max(high, -low)]
        high = max(high, *(value for _, value in near), 0.0)
        room = 0.07 * (high - low) or 1.0
        ends.append((low - room * (low < 0.0), high + room))
        limits.append(near)
    names = _LIMIT_LINE if any(limits) else 0.0
    height = (_ROW + _NAME) * len(traces) + 0.46 + names
    grid = placed(figure, height, len(traces), 2, top=_NAME + 0.04 + names, gaps=(_NAME, 0.62), shared=False)
    for column, (side, colour) in enumerate(zip(sides, ("vermillion", "blue"), strict=True)):
        for row, trace in enumerate(traces):
            axes = grid[row][column]
            style.plotted(axes, trace.time, trace.columns[side.column], strip, side.kind, side.unit,
                          color=COLOURS[colour])  # fmt: skip
            axes.axhline(0.0, color="black", linewidth=0.6)
            style.across(axes, strip)
            for (name, value), dashes in zip(limits[column], style.LIMITS, strict=False):
                axes.axhline(value, color="black", linewidth=0.7, linestyle=dashes, label=side.said(name, value))
            axes.set_ylim(*ends[column])
            axes.tick_params(labelbottom=row == len(traces) - 1)
            axes.set_title(f"{style.named(trace.name)}: {reads(side.column, side.unit)}", pad=2.5)
        grid[-1][column].set_xlabel("time (s)")
    if names:
        left, right = (axes.get_legend_handles_labels() for axes in grid[0])
        style.heading(figure, [*left[0], *right[0]], [*left[1], *right[1]], 4)


Limits = Sequence[tuple[str, float]]  # name and figure [SI]


@figure
def current_and_voltage(
    figure: Figure, cases: Sequence[tuple[str, SetCycle]], currents: Limits, voltages: Limits
) -> None:
    """Current and voltage of each moment by the drive model, with the winding as warm as it then is, and limits."""
    cases = cases[:MOST_WHEELS]
    traces = []
    for name, found in cases:
        d, p = found.drive, found.pieces
        current, speed, rise = (np.stack(x, axis=1) for x in ((p.I_0, p.I_1), (p.w_0, p.w_1), (p.rise_0, p.rise_1)))
        voltage = d.emf * speed + (d.R + d.R_rise * rise) * current
        columns = {"current": current.ravel(), "voltage": voltage.ravel()}
        traces.append(Trace(name, end_times(p.duration).ravel(), columns))
    known = [tuple(one for one in limits if math.isfinite(one[1])) for limits in (currents, voltages)]
    rows = (Row("current", "current", "A", known[0]), Row("voltage", "voltage", "V", known[1]))
    draw = each_over_time if len(cases) > TOGETHER else over_time
    draw(figure, traces, rows, stretches([(name, found.cycle.load_cycle) for name, found in cases]))


# -- The closed loop.


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
_LOOKS: dict[str, dict[str, Any]] = {  # in layers: reference and linear model hardly differ from the speed
    "reference": {"color": "black", "linestyle": (0, (1, 2.5)), "linewidth": 1.3, "zorder": 4.0},
    "own": {"color": COLOURS["blue"], "linestyle": "solid", "linewidth": 1.4, "zorder": 2.5},
    LINEAR: {"color": COLOURS["orange"], "linestyle": (0, (5, 2.5)), "linewidth": 0.9, "zorder": 3.5},
}
_WIDEST = 11  # letters of a row's title on a line


def closed_loop_rows(validation: Validation) -> list[tuple[tuple[str, ...], str]]:
    """Rows of the figure of the closed loop: columns of the series that are there and known, and their title.

    A winding whose temperature is not known, or is not to move, is kept at one: there is nothing to show then.
    """
    series = validation.series
    known = {name for name, values in series.items() if np.isfinite(values).any()}
    if np.ptp(series.get("winding_temperature", np.zeros(1))) == 0.0:
        known -= {"winding_temperature"}
    return [row for row in _ROWS if known.issuperset(row[0])]


@figure
def closed_loop(figure: Figure, validation: Validation) -> None:
    """Reference and speed, errors, current, voltage and winding over the moments in which something changes."""
    strip, rows = style.strip(style.windows(validation.series)), closed_loop_rows(validation)
    linear = validation.linear.series if validation.linear else {}
    legend = _LINE if validation.linear and len(strip.windows) > 1 else 0.0  # above the titles of the stretches
    height = 0.62 * len(rows) + 0.6 + legend
    grid = [axes for (axes,) in placed(figure, height, len(rows), left=0.8, top=0.22 + legend)]
    for axes, (names, title) in zip(grid, rows, strict=True):
        kind, unit = validation.series_units[names[-1]]
        axes.set_ylabel("\n".join([*textwrap.wrap(title, _WIDEST), f"({label(unit)})"]))
        traces = [
            (validation.series, name, *(("reference", "reference") if name.endswith("reference") else (name, "own")))
            for name in names
        ]
        traces += [(linear, names[-1], LINEAR, LINEAR)] * (names[-1] in linear)
        for series, name, said, look in traces:
            style.plotted(axes, series["time"], series[name], strip, kind, unit, said, **_LOOKS[look])
        style.across(axes, strip, titled=axes is grid[0])
    grid[-1].set_xlabel("time (s)")
    if len(rows[0][0]) > 1 or validation.linear:
        figure.legend(*grid[0].get_legend_handles_labels(), loc="upper right", ncols=3, borderaxespad=0.2)


# -- Temperatures: of winding and housing from cold, and over the cycle that repeats; of a set at the bench.


def time_unit(longest: float) -> str:
    """The unit in which times up to some length are shown [s]."""
    return "s" if longest < 600.0 else "min" if longest < 36_000.0 else "h"


def _celsius(kelvin: Any) -> Any:
    return from_si(kelvin, "degC", "temperature")


@figure
def temperatures(figure: Figure, found: WarmUp, ambient: float, permitted: float) -> None:
    """Two diagrams: the way from cold, with the winding in each cycle as a band, and one cycle of those that repeat."""
    ((way, cycle),) = placed(figure, 2.05, 1, 2, top=0.42, gaps=(0.0, 0.16))
    unit, repeats = time_unit(found.time[-1]), found.in_cycle
    time = from_si(found.time, unit, "time")
    low, high = (_celsius(np.append(x[0], x)) for x in (found.lowest, found.highest))
    way.fill_between(time, low, high, step="pre", label="winding, in each cycle", linewidth=0.6,
                     facecolor="#F4C9A8", edgecolor=COLOURS["vermillion"])  # fmt: skip
    winding: dict[str, Any] = {"color": COLOURS["vermillion"]}
    housing: dict[str, Any] = {"color": COLOURS["blue"], "linestyle": (0, (5, 2))}
    way.plot(time, _celsius(found.housing), label="housing", **housing)
    way.set(xlim=(0.0, time[-1]), xlabel=reads("time from cold", unit), title="from cold")
    unit = time_unit(repeats[-1])
    time = from_si(repeats, unit, "time")
    for values, look in ((found.winding_in_cycle, winding), (found.housing_in_cycle, housing)):
        rows = style.thinned(repeats, values, Window("", 0.0, float(repeats[-1])))
        cycle.plot(time[rows], _celsius(values[rows]), **look)
    peak = (float(from_si(found.peak_time, unit, "time")), float(_celsius(found.peak)))
    cycle.plot(*peak, "o", markersize=4, color=COLOURS["vermillion"])
    style.beside(cycle, f"{peak[1]:.1f} °C", peak, (4, 4))
    cycle.set(xlim=(0.0, time[-1]), xlabel=reads("time in the cycle", unit), title="over the cycle that repeats")
    limits = [("ambient", ambient, 1), *([("permitted", permitted, 0)] if permitted == permitted else [])]
    for axes in (way, cycle):
        for name, value, dashes in limits:
            said = f"{name} {_celsius(value):.4g} °C" if axes is cycle else ""
            style.limit(axes, _celsius(value), said, dashes)
    rise = np.nanmax([permitted, found.peak]) - ambient
    way.set_ylim(_celsius(ambient) - 0.04 * rise, _celsius(ambient) + 1.12 * rise)
    way.set_ylabel("temperature (°C)")
    style.heading(figure, *way.get_legend_handles_labels(), 3)


@figure
def bench(figure: Figure, found: Prediction) -> None:
    """Three diagrams of a set at the bench: speed over torque; temperatures over time while running at the load.

    Nominal courses are lines, 5 to 95 % are areas.
    """
    ((line, work, hold),) = placed(figure, 2.3, 1, 3, top=0.42, gaps=(0.0, 0.7), shared=False)

    def banded(axes: Axes, along: Any, band: Sequence[Any], colour: str, dashes: Any, name: str) -> None:
        p5, nominal, p95 = band
        axes.fill_between(along, p5, p95, color=COLOURS[colour], alpha=0.18, linewidth=0.0, label=f"5 to 95 %{name}")
        axes.plot(along, nominal, color=COLOURS[colour], linestyle=dashes, label=f"nominal{name}")

    unit, band = style.torque_unit(float(found.torque[-1])), found.speed
    speeds = [from_si(x, "rpm", "rotary_speed") for x in (band.p5, band.nominal, band.p95)]
    banded(line, from_si(found.torque, unit, "torque"), speeds, "green", "solid", "")
    line.set(xlim=(0.0, None), ylim=(0.0, None), xlabel=reads("torque", unit), ylabel="speed (rpm)")
    line.set_title("at full voltage")
    for axes, name, title in ((work, "work", "winding, running at the load"), (hold, "hold", "winding, holding")):
        courses = [one for one in found.courses if one.name.startswith(name)]
        for one in courses:
            start, unit = one.name.rsplit("_", 1)[1], time_unit(float(one.time[-1]) / 6.0)
            colour, dashes = {"cold": ("blue", "solid"), "warm": ("vermillion", (0, (5, 2)))}[start]
            time, warm = from_si(one.time, unit, "time"), one.winding
            banded(
                axes, time, [_celsius(x) for x in (warm.p5, warm.nominal, warm.p95)], colour, dashes, f", from {start}"
            )
            axes.set(xlim=(0.0, float(time[-1])), xlabel=reads("time", unit))
        axes.set_title(title if courses else f"{title}: unknown")
        if courses and found.limit == found.limit:
            style.limit(axes, _celsius(found.limit), f"permitted {_celsius(found.limit):.4g} °C")
    work.set_ylabel("temperature (°C)")
    top = max(work.get_ylim()[1], hold.get_ylim()[1])
    for axes in (work, hold):
        axes.set_ylim(_celsius(found.conditions.ambient) - 2.0, top)
    shown = next((axes for axes in (work, hold) if axes.get_legend_handles_labels()[0]), line)
    style.heading(figure, *shown.get_legend_handles_labels(), 4)


# -- Flow of the energy of a cycle, as bars that follow one another from the energy drawn down to nothing.


_BAR_ROW = 0.17  # in
_SMALLEST = 1e-6  # of what is drawn: less is none, or the rounding of a trajectory
_BARS: dict[str, dict[str, Any]] = {  # distinct in grey as well
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


@figure
def energy_bars(figure: Figure, flow: EnergyFlow) -> None:
    """The energy of a cycle: each bar begins where the one above it ends, the last one ends at nothing."""
    shown = shares(flow)
    largest = max(abs(share.value) for share in shown)
    unit = "J" if largest < 1e3 else "kJ" if largest < 1e6 else "MJ"
    ((axes,),) = placed(figure, _BAR_ROW * len(shown) + 0.52, left=2.0, right=1.25, top=0.06)
    left = [0.0, *accumulate((-share.value for share in shown[1:]), initial=flow.drawn)]
    for place, (share, start) in enumerate(zip(shown, left, strict=False)):
        first, width = (float(from_si(x, unit, "energy")) for x in (start, share.value))
        down = share.look != "drawn"
        axes.barh(place, -width if down else width, left=first, height=0.66, linewidth=0.6, zorder=3,
                  **_BARS[share.look])  # fmt: skip
        part = f", {100.0 * share.value / flow.drawn:.3g} %" if down and flow.drawn > 0.0 else ""
        said = f"{width:.4g} {label(unit)}{part}".replace("-", "−")
        style.beside(axes, said, (1.0, place), (5, 0), xycoords=("axes fraction", "data"), va="center", fontsize=6.8)
    style.bars(axes, [share.name for share in shown])
    axes.axvline(0.0, color="black", linewidth=0.6)
    axes.set_xlabel(reads("energy of a cycle", unit))
