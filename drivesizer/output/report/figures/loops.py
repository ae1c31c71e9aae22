"""The loop of a drive as a block diagram, Bode diagrams and step responses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.validation import Cascade, Gains, LinearRun, Loop, Validation
from drivesizer.output.loop_table import cell, loop_figures, loop_name, settled
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, placed
from drivesizer.output.thinning import curve_points
from drivesizer.units import label, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["block_diagram", "bode", "curve_of", "look_of", "span", "step"]


# -- The loop of a drive as a block diagram, after figure 3 of the paper: controllers, DC motor, gears, encoder.


_WIDTH, _HEIGHT = 6.5, 1.83  # in
_AXIS, _BACK, _INNER, _AHEAD = 1.0, 0.14, 0.4, 1.69  # in, heights of the main path, of feedback and of feedforward
_LEFT, _RIGHT = 0.55, 0.68  # in, of the reference's and of the load's name
_TALL, _SUM, _GAP = 0.78, 0.075, 0.145  # in: a block's height, a sum's radius, an arrow's length


class _Block(NamedTuple):
    """A block with its title and figures; without any a sum."""

    name: str
    title: str = ""
    lines: tuple[str, ...] = ()


def block_diagram(validation: Validation, run: LinearRun, form: Form = "svg") -> bytes:
    """The chosen drive's loop with its gains, motor, gears and encoder."""
    blocks = _blocks(validation, run.train)

    def draw(figure: Figure) -> None:
        figure.set_layout_engine("none")
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set(xlim=(0.0, _WIDTH), ylim=(0.0, _HEIGHT))
        axes.axis("off")
        places = _path(axes, blocks)
        _feedback(axes, places, _encoder(validation))
        if isinstance(validation.gains, Cascade):
            _ahead(axes, places, validation.gains)
        left, right = places["motor"]
        middle = 0.5 * (left + right)
        _arrow(axes, (middle, _AHEAD - 0.1), (middle, _AXIS + 0.5 * _TALL))
        _word(axes, middle, _AHEAD, "load torque")

    return drawn(draw, _HEIGHT, form)


def _blocks(v: Validation, train: DriveTrain) -> list[_Block]:
    """The main path from the reference to the load."""
    c = v.gains
    unit = "rad/m" if v.series_units["speed"][0] == "speed" else "1"
    found = [_Block("to the motor", "K / r", (f"{train.motor_per_speed:.4g} {label(unit)}",))]
    if isinstance(c, Gains):
        found += [_Block("speed"), _Block("velocity", _named("PID", c.kd), (
            *_gains((c.kp, "V*s/rad"), (c.ki, "V/rad"), (c.kd, "V*s^2/rad")), _every(c.period)))]  # fmt: skip
    elif isinstance(c, Cascade):
        if c.position_kp and c.position_period:
            found += [_Block("angle"), _Block("position", "position P", (
                f"{c.position_kp:.4g} 1/s", _every(c.position_period)))]  # fmt: skip
        found += [
            _Block("speed"),
            _Block("velocity", f"velocity {_named('PID', c.velocity_kd)}", (
                *_gains((c.velocity_kp, "A*s/rad"), (c.velocity_ki, "A/rad"), (c.velocity_kd, "A*s^2/rad")),
                _every(c.velocity_period))),
            _Block("current"),
            _Block("voltage", "current PI", (
                *_gains((c.current_kp, "V/A"), (c.current_ki, "V/(A*s)")), _every(c.current_period))),
        ]  # fmt: skip
    inertia = train.motor_inertia + train.load_inertia / (train.efficiency * train.ratio**2)
    motor = (
        f"R {show(train.resistance, 'ohm', 'resistance', 3)}",
        f"L {show(train.inductance, 'mH', 'inductance', 3)}",
        f"k {show(train.torque_constant, 'mN*m/A', 'torque_constant', 3)}",
        f"J {show(inertia, 'kg*cm^2', 'inertia', 3)}",
    )
    shaft = ", shaft" if train.flexible else ""
    gears = (f"K {train.ratio:.4g}", f"η {train.efficiency:.3g}")
    radius = (f"r {1e3 * train.radius:.4g} mm",) if unit == "rad/m" else ()
    return [*found, _Block("motor", f"DC motor{shaft}", motor), _Block("gears", "r / K" if radius else "1 / K",
            (*gears, *radius))]  # fmt: skip


def _named(whole: str, kd: float) -> str:
    return whole if kd else "PI"


def _gains(*gains: tuple[float, str]) -> tuple[str, ...]:
    named = zip("PID", gains, strict=False)
    return tuple(f"{name} {value:.4g} {label(unit)}" for name, (value, unit) in named if value)


def _every(period: float) -> str:
    return f"every {show(period, 'ms', 'time', 3)}"


def _encoder(v: Validation) -> str:
    encoder, over = v.drive_set.encoder, getattr(v.gains, "counted_over", 0)
    if not over or encoder is None:
        return "speed measured exactly"
    return f"encoder, {encoder.lines:.0f} lines; counts of {over} period{'s' * (over > 1)}"


# --- drawing


def _path(axes: Axes, blocks: list[_Block]) -> dict[str, tuple[float, float]]:
    """Draw the main path; left and right ends of each block and sum."""
    boxes = [block for block in blocks if block.title]
    sums = len(blocks) - len(boxes)
    free = _WIDTH - _LEFT - _RIGHT - 2.0 * _SUM * sums - _GAP * (len(blocks) - 1)
    lengths = [1.5 + max(map(len, (block.title, *block.lines))) for block in boxes]
    per = min(free / sum(lengths), 0.085)
    wide = {block.name: per * length for block, length in zip(boxes, lengths, strict=True)}
    gap = _GAP + max(free - sum(wide.values()), 0.0) / (len(blocks) + 1)
    x, places = _LEFT + gap - _GAP, {}
    _word(axes, 0.05, _AXIS + 0.12, "reference", "left")
    _arrow(axes, (0.05, _AXIS), (x, _AXIS))
    for n, block in enumerate(blocks):
        end = x + (wide[block.name] if block.title else 2.0 * _SUM)
        places[block.name] = (x, end)
        if block.title:
            _box(axes, x, end, block)
        else:
            _sum(axes, 0.5 * (x + end))
        if n < len(blocks) - 1:
            _arrow(axes, (end, _AXIS), (end + gap, _AXIS))
            x = end + gap
    end = places[blocks[-1].name][1]
    _arrow(axes, (end, _AXIS), (_WIDTH - 0.05, _AXIS))
    _word(axes, _WIDTH - 0.05, _AXIS + 0.12, "load's speed", "right")
    return places


def _box(axes: Axes, left: float, right: float, block: _Block) -> None:
    from matplotlib.patches import Rectangle

    face = Rectangle(
        (left, _AXIS - 0.5 * _TALL), right - left, _TALL, facecolor="white", edgecolor="black", linewidth=0.8
    )
    axes.add_patch(face)
    middle, step = 0.5 * (left + right), 0.125
    top = _AXIS + 0.5 * step * len(block.lines)
    axes.text(middle, top, block.title, ha="center", va="center", fontsize=6.8, color=COLOURS["blue"])
    for n, line in enumerate(block.lines, 1):
        axes.text(middle, top - step * n, line, ha="center", va="center", fontsize=5.8)


def _sum(axes: Axes, middle: float) -> None:
    from matplotlib.patches import Circle

    axes.add_patch(Circle((middle, _AXIS), _SUM, facecolor="white", edgecolor="black", linewidth=0.8))
    axes.text(middle + 0.07, _AXIS - _SUM - 0.07, "−", ha="left", va="center", fontsize=7)


def _feedback(axes: Axes, places: dict[str, tuple[float, float]], encoder: str) -> None:
    """The motor's speed and angle by the encoder, and the current of a cascade."""
    tap = 0.5 * (places["motor"][1] + places["gears"][0])
    back = [sum(places[name]) / 2.0 for name in ("speed", "angle") if name in places]
    left = min(back)
    _line(axes, (tap, tap, left), (_AXIS, _BACK, _BACK))
    axes.plot([tap], [_AXIS], "o", color="black", markersize=2.2)
    for name in ("speed", "angle"):
        if name in places:
            x = sum(places[name]) / 2.0
            _arrow(axes, (x, _BACK), (x, _AXIS - _SUM))
            _word(axes, x - 0.04, 0.5 * (_BACK + _AXIS - 0.5 * _TALL) + 0.06, name, "right")
    axes.text(0.5 * (max(back) + tap), _BACK, encoder, ha="center", va="center", fontsize=6.4,
              bbox={"facecolor": "white", "edgecolor": "black", "linewidth": 0.8, "pad": 2.5})  # fmt: skip
    if "current" in places:
        x, start = sum(places["current"]) / 2.0, places["motor"][0] + 0.12
        _line(axes, (start, start, x), (_AXIS - 0.5 * _TALL, _INNER, _INNER))
        _arrow(axes, (x, _INNER), (x, _AXIS - _SUM))
        _word(axes, 0.5 * (x + start), _INNER + 0.08, "current")


def _ahead(axes: Axes, places: dict[str, tuple[float, float]], c: Cascade) -> None:
    """Reference of a cascade past a loop: its speed past the position loop, its feedforward."""
    tap = places["to the motor"][1] + 0.06
    ends = [("speed", "path's speed")] if "angle" in places else []
    if c.feedforward_velocity or c.feedforward_friction or c.feedforward_acceleration:
        ends.append(("current", "feedforward"))
    if not ends:
        return
    axes.plot([tap], [_AXIS], "o", color="black", markersize=2.2)
    for name, word in ends:
        x, high = sum(places[name]) / 2.0, _AHEAD - (0.14 if name == "speed" else 0.0)
        _line(axes, (tap, tap, x), (_AXIS, high, high))
        _arrow(axes, (x, high), (x, _AXIS + _SUM))
        _word(axes, x - 0.05, high + 0.08, word, "right")


def _line(axes: Axes, x: tuple[float, ...], y: tuple[float, ...]) -> None:
    axes.plot(x, y, color="black", linewidth=0.8, solid_joinstyle="miter", zorder=0)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "linewidth": 0.8, "color": "black",
                  "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6})  # fmt: skip


def _word(axes: Axes, x: float, y: float, word: str, side: str = "center") -> None:
    axes.text(x, y, word, ha=side, va="center", fontsize=6.4, color=COLOURS["grey"])


# -- Bode diagram and step responses of loops as figures.


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
