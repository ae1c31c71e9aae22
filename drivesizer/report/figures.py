"""Figures as SVG: the motion, the load over its cycle, the motor's torque-speed field, a front, the closed loop.

One house style: thin lines that differ in dashes as well as in colour (Okabe-Ito), so that a grey print and a
colour-blind reader lose nothing; a unit on every axis. Nothing here depends on the clock or on installed fonts.
matplotlib is imported when a figure is drawn.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.loadcycle import LoadCycle
from drivesizer.loads import load_cycle
from drivesizer.motions import Trapezoid
from drivesizer.operating_field import OperatingField
from drivesizer.profile import profile_of
from drivesizer.report.operating import Panel
from drivesizer.report.panels import Window, thinned, windows
from drivesizer.report.wording import clean, short
from drivesizer.results import Validation
from drivesizer.spec import RobotSpec
from drivesizer.units import from_si, label, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "COLOURS",
    "STYLE",
    "closed_loop",
    "load_over_time",
    "speed_profile",
    "stretches",
    "torque_speed",
    "trade_off",
]

COLOURS = {  # Okabe and Ito
    "blue": "#0072B2", "vermillion": "#D55E00", "green": "#009E73", "purple": "#CC79A7", "grey": "#555555",
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


def _drawn(draw: Any, height: float) -> bytes:
    """A figure in the house style as SVG."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # not what the user's matplotlibrc says
        matplotlib.rcParams.update(STYLE)
        figure = Figure(figsize=(_WIDTH, height), layout="constrained")
        FigureCanvasSVG(figure)
        draw(figure)
        stream = io.BytesIO()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph .* missing")  # a box stands in for a letter of far scripts
            figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def speed_profile(spec: RobotSpec) -> bytes:
    """The speed that the spec asks for over one cycle: a trapezoid by its phases, any other motion to scale."""
    motion = spec.motion
    if isinstance(motion, Trapezoid):
        return _drawn(lambda figure: _phases(figure.add_subplot(), motion, spec.load.axis), 1.9)
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

    return _drawn(draw, 1.9)


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
        axes.text((left + right) / 2, top + 0.13 * span, f"{name}\n{duration:g} s", ha="center", va="center", fontsize=7)
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


def load_over_time(cycles: Sequence[tuple[str, LoadCycle]]) -> bytes:
    """Torque and speed of the driven shaft over the cycle, of one load case or of several.

    Parameters
    ----------
    cycles
        Load cycles with the names of their cases; the first few are drawn.
    """
    cycles = cycles[: len(_CASES)]
    shown = stretches(cycles)
    largest = max(float(np.abs(cycle.torque).max()) for _, cycle in cycles)
    rows = (("torque", "torque", _torque_unit(largest)), ("speed", "rotary_speed", "rpm"))

    def draw(figure: Figure) -> None:
        grid = figure.subplots(2, len(shown), sharex="col", sharey="row", squeeze=False)
        for line, (column, kind, unit) in zip(grid, rows, strict=True):
            line[0].set_ylabel(f"{column} ({label(unit)})")
            for axes, window in zip(line, shown, strict=True):
                axes.axhline(0.0, color="black", linewidth=0.6)
                for (name, cycle), (colour, dashes) in zip(cycles, _CASES, strict=False):
                    time, values = cycle.time.ravel(), from_si(getattr(cycle, column).ravel(), unit, kind)
                    kept = thinned(time, values, window)
                    axes.plot(time[kept], values[kept], color=COLOURS[colour], linestyle=dashes, label=_short(name))
                axes.set_xlim(window.start, window.end)
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
        if len(cycles) > 1:
            figure.legend(*grid[0][0].get_legend_handles_labels(), loc="outside upper center", ncols=len(cycles))
        figure.align_ylabels()

    return _drawn(draw, 2.9)


_CASES: tuple[tuple[str, Any], ...] = (  # colour and dashes of each load case
    ("green", "solid"), ("purple", (0, (5, 2))), ("grey", (0, (1, 1.2))), ("vermillion", (0, (6, 2, 1, 2))),
)  # fmt: skip


def stretches(cycles: Sequence[tuple[str, LoadCycle]]) -> list[Window]:
    """What is drawn: where something changes in a single case, the whole time where several lie over one another."""
    if len(cycles) == 1:
        cycle = cycles[0][1]
        steps = sum(np.abs(np.diff(x)) / (np.abs(x).max() or 1.0) for x in (cycle.speed.ravel(), cycle.torque.ravel()))
        changed = np.append(0.0, np.cumsum(steps))  # by speed and torque: it stands still where both do
        return windows({"time": cycle.time.ravel(), "speed_reference": changed})
    return [Window("", 0.0, max(cycle.total for _, cycle in cycles))]


def _short(name: str) -> str:
    """A name as it stands in a legend; one that begins with an underscore matplotlib would leave out."""
    return f" {short(clean(name), 28)}".removeprefix("" if name.startswith("_") else " ")


def _torque_unit(largest: float) -> str:
    return "mN*m" if largest < 1.0 else "N*m"


def torque_speed(panels: Sequence[Panel]) -> bytes:
    """The motor's field, winding hot and cold, with the load cases in it: a panel for each usable voltage and ambient."""
    shown = panels[:_MOST_PANELS]

    def draw(figure: Figure) -> None:
        for axes, panel in zip(figure.subplots(len(shown), squeeze=False)[:, 0], shown, strict=True):
            _field(axes, panel)
            if len(shown) > 1:
                lines = panel.cases[0][1]
                given = show(lines.voltage, "V", "voltage"), show(lines.ambient, "degC", "temperature")
                axes.set_title(f"{given[0]} usable, ambient {given[1]}", fontsize=7.5, loc="left")

    return _drawn(draw, 3.2 * len(shown))


_MOST_PANELS = 3
_ROOM = 1.12  # of an axis beyond what must be seen
_FAR = 6.0  # times the continuous torque; an intermittent line beyond would leave the rest no room


def _field(axes: Axes, panel: Panel) -> None:
    first = panel.cases[0][1]
    unit = _torque_unit(_reach(panel))
    _lines(axes, first, unit, _reach(panel))
    for (name, found), (colour, dashes) in zip(panel.cases, _CASES, strict=False):
        _trace(axes, found, unit, colour, dashes, f"load cycle, {_short(name)}" if name else "load cycle")
    _mark(axes, panel, unit)
    right = float(from_si(_ROOM * _reach(panel), unit, "torque"))
    left = min(0.0, *(_signed(f)[1].min(initial=0.0) for _, f in panel.cases), *(p.torque for p in panel.points))
    top = max(first.speed[-1], *(f.speed[-1] for _, f in panel.cases), *(p.speed for p in panel.points))
    axes.set_xlim(_ROOM * float(from_si(left, unit, "torque")) - 0.03 * right, right)
    axes.set_ylim(0, float(from_si(1.06 * top, "rpm", "rotary_speed")))
    axes.axvline(0, color="black", linewidth=0.6)
    axes.set(xlabel=f"torque at the motor's shaft ({label(unit)})", ylabel="motor speed (rpm)")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), labelspacing=0.9)


def _reach(panel: Panel) -> float:
    """The torque to which the axis goes [N*m]: what the drive may do and the cycle asks for, not all the way to stall."""
    first = panel.cases[0][1]
    stall = float(np.nan_to_num(first.voltage_cold[0]))
    lines = (first.continuous.max(), np.fmin(first.intermittent.max(), _FAR * first.continuous.max()))
    known = [min(float(x), stall) for x in lines if x == x]
    asked = [float(np.nan_to_num(_signed(f)[1]).max()) for _, f in panel.cases]
    return max(*known, *asked, *(p.torque for p in panel.points), 1e-6) if known else max(stall, *asked)


def _lines(axes: Axes, found: OperatingField, unit: str, reach: float) -> None:
    """What the motor can do: the field that is allowed continuously, voltage lines hot and cold, intermittent, speed."""
    rpm = from_si(found.speed, "rpm", "rotary_speed")

    def torque(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(from_si(np.where(values < 0.0, np.nan, values), unit, "torque"))

    allowed = np.fmin(found.continuous, found.voltage_hot)
    allowed = np.where((allowed < 0.0) | (found.speed > np.nan_to_num(found.permissible_speed, nan=np.inf)), 0.0, allowed)
    if not np.isnan(allowed).any():
        axes.fill_betweenx(rpm, 0.0, torque(allowed), color=COLOURS["blue"], alpha=0.12, linewidth=0,
                           label="continuous" if found.thermal else "continuous, nominal torque")  # fmt: skip
    for values, temperature, dashes in (
        (found.voltage_hot, found.hot, "solid"), (found.voltage_cold, found.ambient, (0, (5, 2))),
    ):  # fmt: skip
        if not np.isnan(values).any():
            said = f"{found.voltage:.3g} V, winding {show(temperature, 'degC', 'temperature', 3)}"
            axes.plot(torque(values), rpm, color=COLOURS["blue"], linestyle=dashes, label=said)
    within = np.where(found.intermittent <= np.fmin(found.voltage_cold, _ROOM * reach), found.intermittent, np.nan)
    if not np.isnan(within).all():
        axes.plot(torque(within), rpm, color=COLOURS["vermillion"], linestyle=(0, (6, 2, 1, 2)),
                  label="intermittent")  # fmt: skip
    if found.permissible_speed <= 1.06 * found.speed[-1]:
        axes.axhline(float(from_si(found.permissible_speed, "rpm", "rotary_speed")), color=COLOURS["grey"],
                     linestyle=(0, (1, 1.5)), label="permissible speed")  # fmt: skip


_MOST_SEGMENTS = 1500  # of a trace: finer than print


def _signed(found: OperatingField) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Speed and torque of the cycle with motion one way as with the other: what brakes is below 0, what holds is not."""
    way = np.sign(found.cycle_speed.mean(1))[:, None]
    return np.abs(found.cycle_speed), np.where(way == 0.0, np.abs(found.cycle_torque), way * found.cycle_torque)


def _trace(axes: Axes, found: OperatingField, unit: str, colour: str, dashes: Any, name: str) -> None:
    speed, torque = _signed(found)
    if np.isnan(torque).any():
        return
    extremes = [column.argmax(axis=0) for column in (speed, torque, -torque)]
    rows = np.unique(np.concatenate([np.arange(0, len(speed), -(-len(speed) // _MOST_SEGMENTS)), *extremes]))
    axes.plot(from_si(torque[rows].ravel(), unit, "torque"), from_si(speed[rows].ravel(), "rpm", "rotary_speed"),
              color=COLOURS[colour], linestyle=dashes, zorder=4, label=name)  # fmt: skip
    axes.plot(*_at(found.rms_torque, found.rms_speed, unit), marker="o", markersize=5.5, color=COLOURS[colour],
              linestyle="none", zorder=5, label=_told("RMS current and speed", found.rms_torque, found.rms_speed, unit))  # fmt: skip


def _at(torque: float, speed: float, unit: str) -> tuple[float, float]:
    return float(from_si(torque, unit, "torque")), float(from_si(speed, "rpm", "rotary_speed"))


def _told(name: str, torque: float, speed: float, unit: str) -> str:
    x, y = _at(torque, speed, unit)
    return f"{name}\n{x:.4g} {label(unit)}, {y:.0f} rpm".replace("-", "−")


_MARKERS = (("^", "vermillion"), ("s", "grey"), ("v", "purple"), ("D", "blue"))


def _mark(axes: Axes, panel: Panel, unit: str) -> None:
    """Points with a shape each, told in the legend: labels beside them would overlap where points lie close."""
    for point, (marker, colour) in zip(panel.points, _MARKERS, strict=False):
        axes.plot(*_at(point.torque, point.speed, unit), marker=marker, markersize=5.5, markerfacecolor="none",
                  markeredgewidth=1.2, color=COLOURS[colour], linestyle="none", zorder=6,
                  label=_told(f"paper: {point.name}", point.torque, point.speed, unit))  # fmt: skip


def trade_off(sets: Sequence[tuple[str, float, float]], heads: tuple[str, str]) -> bytes:
    """Sets of a Pareto front by two of their objectives, numbered as in the table.

    Parameters
    ----------
    sets
        Number and the two figures of each set, as they are shown.
    heads
        What the axes are called, units included.
    """

    def draw(figure: Figure) -> None:
        axes = figure.add_subplot()
        known = [(number, x, y) for number, x, y in sets if np.isfinite(x + y)]
        axes.plot([x for _, x, _ in known], [y for *_, y in known], "o", color=COLOURS["blue"], markersize=4)
        for number, x, y in known if len(known) <= _NAMED else ():
            axes.annotate(number, (x, y), xytext=(4, 3), textcoords="offset points", fontsize=7)
        axes.margins(0.08)
        axes.set(xlabel=heads[0], ylabel=heads[1])

    return _drawn(draw, 2.4)


_NAMED = 25  # numbers beside more points than these would cover one another


_ROWS = (  # columns of the series, and how the axis is called
    (("speed_reference", "speed"), "speed"),
    (("error",), "error"),
    (("current",), "current"),
    (("voltage",), "voltage"),
)


def closed_loop(validation: Validation) -> bytes:
    """Reference and speed, error, current and voltage over the moments in which something changes."""
    series, shown = validation.series, windows(validation.series)
    rows = [(names, title) for names, title in _ROWS if all(name in series for name in names)]

    def draw(figure: Figure) -> None:
        grid = figure.subplots(len(rows), len(shown), sharex="col", sharey="row", squeeze=False)
        for line, (names, title) in zip(grid, rows, strict=True):
            _, unit = validation.series_units[names[-1]]
            line[0].set_ylabel(f"{title} ({label(unit)})")
            for axes, window in zip(line, shown, strict=True):
                _traces(axes, validation, names, window)
        for axes, window in zip(grid[0], shown, strict=True):
            axes.set_title(window.title, fontsize=7.5, loc="left")
        for axes in grid[-1]:
            axes.set_xlabel("time (s)")
        if len(rows[0][0]) > 1:
            grid[0][0].legend(loc="best")
        figure.align_ylabels()

    return _drawn(draw, 1.25 * len(rows) + 0.3)


def _traces(axes: Axes, validation: Validation, names: tuple[str, ...], window: Window) -> None:
    looks = ((COLOURS["vermillion"], (0, (4, 3)), 1.0), (COLOURS["blue"], "solid", 1.4))
    for layer, (name, (colour, dashes, width)) in enumerate(zip(names, looks[-len(names) :], strict=True)):
        kind, unit = validation.series_units[name]
        rows = thinned(validation.series["time"], validation.series[name], window)
        time, values = validation.series["time"][rows], from_si(validation.series[name][rows], unit, kind)
        said = "reference" if name.endswith("reference") else name
        axes.plot(time, values, color=colour, linestyle=dashes, linewidth=width, label=said, zorder=4 - layer)
    axes.set_xlim(window.start, window.end)
