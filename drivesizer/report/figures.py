"""Figures as SVG: the velocity profile, the motor's torque-speed field, the closed loop.

One house style: thin lines that differ in dashes as well as in colour (Okabe-Ito), so that a grey print and a
colour-blind reader lose nothing; a unit on every axis. Nothing here depends on the clock or on installed fonts.
matplotlib is imported when a figure is drawn.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from drivesizer.report.operating import OperatingField
from drivesizer.report.panels import Window, thinned, windows
from drivesizer.results import Validation
from drivesizer.motions import Trapezoid
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["COLOURS", "STYLE", "closed_loop", "torque_speed", "velocity_profile"]

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
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def velocity_profile(motion: Trapezoid) -> bytes:
    """Reference velocity over one cycle, its phases marked; short phases are drawn wider than to scale."""
    phases = [("acceleration", motion.acceleration_time, 1.0), ("cruise", motion.cruise_time, 1.0),
              ("deceleration", motion.acceleration_time, 0.0), ("rest", motion.rest_time, 0.0)]  # fmt: skip
    phases = [phase for phase in phases if phase[1] > 0]

    def draw(figure: Figure) -> None:
        axes = figure.add_subplot()
        edges, times, speeds = [0.0], [0.0], [0.0]
        total = sum(duration for _, duration, _ in phases)
        for name, duration, end in phases:
            edges.append(edges[-1] + max(duration / total, 0.16))
            times.append(times[-1] + duration)
            speeds.append(end * motion.speed)
            middle = (edges[-1] + edges[-2]) / 2
            axes.text(middle, 1.13 * motion.speed, f"{name}\n{duration:g} s", ha="center", va="center", fontsize=7)
        for edge in edges:
            axes.axvline(edge, color=COLOURS["grey"], linewidth=0.5, linestyle=(0, (4, 3)))
        axes.plot(edges, speeds, color=COLOURS["blue"], linewidth=1.6)
        axes.set_xticks(edges, [f"{time:g}" for time in times])
        axes.set(xlim=(0, edges[-1]), ylim=(0, 1.28 * motion.speed))
        axes.set_xlabel("time (s), phases not to scale")
        axes.set_ylabel("velocity (m/s)")

    return _drawn(draw, 1.9)


def torque_speed(field: OperatingField) -> bytes:
    """The motor's field: no-load to stall line, continuous torque, and the operating points of the cycle."""

    def draw(figure: Figure) -> None:
        axes = figure.add_subplot()
        unit = "mN*m" if field.stall_torque < 1.0 else "N*m"
        stall, nominal = (float(from_si(t, unit, "torque")) for t in (field.stall_torque, field.nominal_torque))
        no_load = float(from_si(field.no_load_speed, "rpm", "rotary_speed"))
        points = [(p.name, float(from_si(p.torque, unit, "torque")), float(from_si(p.speed, "rpm", "rotary_speed")))
                  for p in field.points]  # fmt: skip
        axes.plot([0, stall], [no_load, 0], color=COLOURS["blue"], label=f"no load to stall at {field.voltage:g} V")
        if nominal == nominal:
            reach = no_load * (1 - nominal / stall)
            axes.fill([0, nominal, nominal, 0], [0, 0, reach, no_load], color=COLOURS["blue"], alpha=0.10, linewidth=0)
            axes.plot([nominal, nominal], [0, reach], color=COLOURS["vermillion"], linestyle=(0, (5, 2)),
                      label=f"continuous, up to {nominal:.4g} {label(unit)}")  # fmt: skip
        _mark(axes, points, unit)
        left, right = min(0.0, *(t for _, t, _ in points)), max(stall, *(t for _, t, _ in points))
        axes.set(
            xlim=(left - 0.04 * (right - left), right * 1.02), ylim=(0, 1.12 * max(no_load, *(n for *_, n in points)))
        )
        axes.axvline(0, color="black", linewidth=0.6)
        axes.set_xlabel(f"torque at the motor shaft ({label(unit)})")
        axes.set_ylabel("motor speed (rpm)")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), labelspacing=0.9)

    return _drawn(draw, 2.9)


_MARKERS = (("^", "vermillion"), ("o", "green"), ("v", "purple"), ("s", "grey"))


def _mark(axes: Axes, points: list[tuple[str, float, float]], unit: str) -> None:
    """Points with a shape each, told in the legend: labels beside them would overlap where points lie close."""
    for (name, torque, speed), (marker, colour) in zip(points, _MARKERS, strict=True):
        axes.plot(torque, speed, marker=marker, markersize=5.5, markerfacecolor="none", markeredgewidth=1.3,
                  color=COLOURS[colour], linestyle="none", zorder=4,
                  label=f"{name}\n{torque:.4g} {label(unit)}, {speed:.0f} rpm".replace("-", "−"))  # fmt: skip


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
