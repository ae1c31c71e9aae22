"""Bode diagram and step responses of loops as figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.loop_records import Loop
from drivesizer.output.loop_table import cell, loop_figures, loop_name, settled
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, placed
from drivesizer.output.thinning import curve_points
from drivesizer.units import label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["bode", "curve_of", "look_of", "span", "step"]

_LOOKS: dict[str, tuple[str, Any, str]] = {  # colour, dashes and mark of a loop
    "current": ("vermillion", (0, (1, 1.2)), "s"),
    "velocity": ("blue", "solid", "o"),
    "position": ("green", (0, (5, 2)), "^"),
}
_OTHER = ("purple", (0, (6, 2, 1, 2)), "D")
_RANGE = 60.0  # dB: what is drawn up and down
_DOWN = 10.0 * math.log10(2.0)  # dB, 3 for short: half of the power


class Curve(NamedTuple):
    """A loop's frequency response as it is drawn."""

    frequency: NDArray[np.float64]  # Hz
    opened: NDArray[np.float64]  # dB
    phase: NDArray[np.float64]  # deg, at low frequency between -270 and 90
    closed: NDArray[np.float64]  # dB


def curve_of(loop: Loop) -> Curve:
    """The response of a loop in dB and degrees.

    The phase of a record starts where its arctangent does: that of two integrators at 180° or at -180°. Here all start
    in the same turn.
    """
    found, phase = loop.bode, np.degrees(loop.bode.open_phase)
    turns = math.ceil((phase[0] - 90.0) / 360.0)
    return Curve(
        found.frequency, _decibels(found.open_magnitude), phase - 360.0 * turns, _decibels(found.closed_magnitude)
    )


def _decibels(magnitude: NDArray[np.float64]) -> NDArray[np.float64]:
    return 20.0 * np.log10(np.where((magnitude > 0.0) & np.isfinite(magnitude), magnitude, np.nan))


def span(loops: Sequence[Loop]) -> tuple[float, float]:
    """Frequencies of a diagram [Hz]: from well below the slowest loop to the highest Nyquist frequency."""
    ends = [_turning(loop) for loop in loops]
    return min(ends) / 20.0, max(0.5 / loop.period for loop in loops)


def _turning(loop: Loop) -> float:
    """Frequency at which a loop's gain first is 1 [Hz], with crossover or without; else a share of its range."""
    frequency = loop.bode.frequency
    below = np.flatnonzero(loop.bode.open_magnitude < 1.0)
    known = [f for f in (loop.crossover, loop.bandwidth) if f > 0.0]
    if len(below) and below[0]:
        known.append(float(frequency[below[0]]))
    return min(known, default=0.005 / loop.period)


def bode(loops: Sequence[Loop], form: Form = "svg") -> bytes:
    """Open loop in magnitude and phase, closed loop in magnitude, over the frequency."""

    def draw(figure: Figure) -> None:
        above = _ABOVE + 0.16 * len(loops)
        grid = [axes for (axes,) in placed(figure, 3, left=0.8, top=above, heights=(1.25, 1.0, 1.0))]
        for loop in loops:
            _curves(grid, loop)
        _lines(grid)
        _scales(grid, loops)
        heading(figure, *grid[0].get_legend_handles_labels(), 1)

    return drawn(draw, 2.7 + 0.16 * len(loops), form)


_ABOVE = 0.12  # in, over the axes, beside the legend


def _curves(grid: Sequence[Axes], loop: Loop) -> None:
    """A loop in all three diagrams: a mark at crossover and at bandwidth, a line for the phase margin."""
    curve, (colour, dashes, mark) = curve_of(loop), look_of(loop)
    look: dict[str, Any] = {"color": COLOURS[colour], "linestyle": dashes}
    spot: dict[str, Any] = look | {"marker": mark, "markersize": 4, "linestyle": "none", "zorder": 5}
    for axes, values in zip(grid, curve[1:], strict=True):
        axes.plot(curve.frequency, values, **look)
    grid[0].lines[-1].set_label(_labels(loop))
    if loop.crossover > 0.0:
        phase = _value_at(loop.crossover, curve.frequency, curve.phase)
        level = 360.0 * round((phase + 180.0) / 360.0) - 180.0
        grid[1].plot([loop.crossover] * 2, [level, phase], color=COLOURS[colour], linewidth=1.8, zorder=4)
        for axes, height in zip(grid, (0.0, phase), strict=False):
            axes.plot([loop.crossover], [height], **spot)
    if loop.bandwidth > 0.0:  # of the slower direction of power: its curve is there, the other one's may be above
        grid[2].plot([loop.bandwidth], [curve.closed[0] - _DOWN], **spot)


def look_of(loop: Loop) -> tuple[str, Any, str]:
    """Colour, dashes and mark of a loop."""
    return _LOOKS.get(loop.name, _OTHER)


def _value_at(frequency: float, over: NDArray[np.float64], values: NDArray[np.float64]) -> float:
    return float(np.interp(math.log(frequency), np.log(over), values))


def _labels(loop: Loop) -> str:
    """Labels of the legend."""
    if not loop.stable:
        return f"{loop_name(loop)}: unstable, largest pole {loop.pole_radius:.4g}"
    said = {figure.name: cell(figure) for figure in loop_figures(loop)}
    return (
        f"{loop_name(loop)}: crossover {said['crossover']}, phase margin {said['phase_margin']}, "
        f"bandwidth {said['bandwidth']}"
    )


def _lines(grid: Sequence[Axes]) -> None:
    """Lines of reference for the marks: gain 1, -180°, and 3 dB below rest."""
    for axes, level in zip(grid, (0.0, -180.0, -_DOWN), strict=True):
        axes.axhline(level, color="black", linewidth=0.6, linestyle=(0, (4, 3)))


def _scales(grid: Sequence[Axes], loops: Sequence[Loop]) -> None:
    """Axes: what lies in the span of the loops, within 60 dB and some turns."""
    from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator, NullFormatter

    left, right = span(loops)
    curves = [Curve(*(column[c.frequency >= left] for column in c)) for c in map(curve_of, loops)]
    opened, phase, closed = (np.concatenate([c[n] for c in curves]) for n in (1, 2, 3))
    grid[0].set_ylim(_within(1.05 * opened, (-20.0, 20.0), (-_RANGE, _RANGE)))
    grid[1].set_ylim(_within(phase, (-180.0, -90.0), (-540.0, 180.0), room=15.0))
    grid[2].set_ylim(_within(1.05 * closed, (-12.0, 6.0), (-_RANGE, _RANGE)))
    for axes, name in zip(grid, _NAMES, strict=True):
        axes.set_ylabel(name)
    for axes, step in zip(grid, (20.0, 90.0, 20.0), strict=True):
        axes.yaxis.set_major_locator(MultipleLocator(step))
    grid[2].set(xscale="log", xlim=(left, right), xlabel="frequency (Hz)")
    plain = FuncFormatter(lambda x, _: f"{x:g}")
    grid[2].xaxis.set_major_formatter(plain)
    grid[2].xaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    grid[2].tick_params(axis="x", which="minor", pad=5.0)  # on the line of the longer ticks
    grid[2].xaxis.set_minor_formatter(plain if right < 100.0 * left else NullFormatter())


_NAMES = "open loop\nmagnitude\n(dB)", "open loop\nphase\n(°)", "closed loop\nmagnitude\n(dB)"


def _within(
    values: NDArray[np.float64], least: tuple[float, float], most: tuple[float, float], room: float = 0.0
) -> tuple[float, float]:
    """Limits of an axis: all values, some range at least, and never more than another."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return max(min(low, least[0]), most[0]) - room, min(max(high, least[1]), most[1]) + room


def step(loops: Sequence[Loop], form: Form = "svg") -> bytes:
    """The answer of each loop to a step of its reference, over its own time."""

    def draw(figure: Figure) -> None:
        (grid,) = placed(figure, 1, len(loops), top=0.22, gaps=(0.0, 0.4), shared=False)
        for axes, loop in zip(grid, loops, strict=True):
            axes.set_title(loop_name(loop))
            if len(loop.step):
                _answer(axes, loop)
            else:
                _empty_axes(axes, loop)
        grid[0].set_ylabel("answer to a step (%)")

    return drawn(draw, 1.4, form)


def _answer(axes: Axes, loop: Loop) -> None:
    """The samples, the band of 2 % around the end, and the moment from which they stay in it."""
    values = loop.step[: settled(loop)]
    rows = curve_points((values,), _MOST)
    unit, per = ("s", 1.0) if len(values) * loop.period >= 1.0 else ("ms", 1e3)
    few: dict[str, Any] = {"marker": "o", "markersize": 2.5} if len(rows) <= _FEW else {}
    axes.plot(per * loop.period * rows, 100.0 * values[rows], color=COLOURS[look_of(loop)[0]], **few)
    rest = 100.0 * float(loop.bode.closed_magnitude[0])
    axes.axhspan(0.98 * rest, 1.02 * rest, color=COLOURS["grey"], alpha=0.18, linewidth=0)
    if not math.isnan(loop.settling_time):
        axes.axvline(per * loop.settling_time, color=COLOURS["grey"], linewidth=0.6, linestyle=(0, (4, 3)))
    axes.set(xlim=(0.0, per * loop.period * (len(values) - 1)), xlabel=f"time ({label(unit)})")
    axes.set_ylim(bottom=min(0.0, 100.0 * float(values.min())))


_MOST = 1200  # samples of an answer that are drawn: finer than print
_FEW = 50  # samples that are marked each


def _empty_axes(axes: Axes, loop: Loop) -> None:
    axes.set(xticks=[], yticks=[])
    said = f"unstable:\nlargest pole {loop.pole_radius:.4g},\nits answer has no end"
    axes.text(0.5, 0.5, said, transform=axes.transAxes, ha="center", va="center")
