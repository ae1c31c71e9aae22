"""The loop of a drive as a block diagram, Bode diagrams and step responses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Cascade, Gains, LinearRun, Loop, Validation
from drivesizer.output.loop_table import cell, loop_figures, loop_name, settled
from drivesizer.output.report.figures.picture import Curve, Diagram, Plot
from drivesizer.output.report.figures.style import COLOURS, figure
from drivesizer.output.thinning import curve_points
from drivesizer.units import label, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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


def _blocks(v: Validation, run: LinearRun) -> list[_Block]:
    """The main path from the reference to the load."""

    def controller(name: str, title: str, gains: Sequence[tuple[float, str]], period: float) -> _Block:
        lines = [
            f"{letter} {gain:.4g} {label(unit)}" for letter, (gain, unit) in zip("PID", gains, strict=False) if gain
        ]
        return _Block(name, title, (*lines, f"every {show(period, 'ms', 'time', 3)}"))

    c, train = v.gains, run.train
    linear = v.series_units["speed"][0] == "speed"
    blocks = [_Block("to the motor", "K / r", (f"{train.motor_per_speed:.4g} {label('rad/m' if linear else '1')}",))]
    if isinstance(c, Gains):
        gains = (c.kp, "V*s/rad"), (c.ki, "V/rad"), (c.kd, "V*s^2/rad")
        blocks += [_Block("speed"), controller("velocity", "PID" if c.kd else "PI", gains, c.period)]
    elif isinstance(c, Cascade):
        if c.position_kp and c.position_period:
            period = f"every {show(c.position_period, 'ms', 'time', 3)}"
            blocks += [_Block("angle"), _Block("position", "position P", (f"{c.position_kp:.4g} 1/s", period))]
        gains = (c.velocity_kp, "A*s/rad"), (c.velocity_ki, "A/rad"), (c.velocity_kd, "A*s^2/rad")
        inner = (c.current_kp, "V/A"), (c.current_ki, "V/(A*s)")
        title = f"velocity {'PID' if c.velocity_kd else 'PI'}"
        blocks += [_Block("speed"), controller("velocity", title, gains, c.velocity_period),
                  _Block("current"), controller("voltage", "current PI", inner, c.current_period)]  # fmt: skip
    inertia = train.motor_inertia + train.load_inertia / (train.efficiency * train.ratio**2)
    motor = (
        f"R {show(train.resistance, 'ohm', 'resistance', 3)}",
        f"L {show(train.inductance, 'mH', 'inductance', 3)}",
        f"k {show(train.torque_constant, 'mN*m/A', 'torque_constant', 3)}",
        f"J {show(inertia, 'kg*cm^2', 'inertia', 3)}",
    )
    gears = (
        f"K {train.ratio:.4g}",
        f"η {train.efficiency:.3g}",
        *((f"r {1e3 * train.radius:.4g} mm",) if linear else ()),
    )
    return [*blocks, _Block("motor", f"DC motor{', shaft' if train.flexible else ''}", motor),
            _Block("gears", "r / K" if linear else "1 / K", gears)]  # fmt: skip


@figure
def block_diagram(figure: Figure, validation: Validation, run: LinearRun) -> None:
    """The chosen drive's loop with its gains, motor, gears and encoder."""
    figure.set_figheight(_HEIGHT)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, _WIDTH), ylim=(0.0, _HEIGHT))
    axes.axis("off")
    places = _path(axes, _blocks(validation, run))
    encoder, over = validation.drive_set.encoder, getattr(validation.gains, "counted_over", 0)
    measured = "speed measured exactly"
    if over and encoder is not None:
        measured = f"encoder, {encoder.lines:.0f} lines; counts of {over} period{'s' * (over > 1)}"
    _feedback(axes, places, measured)
    if isinstance(validation.gains, Cascade):
        _ahead(axes, places, validation.gains)
    middle = sum(places["motor"]) / 2.0
    _arrow(axes, (middle, _AHEAD - 0.1), (middle, _AXIS + 0.5 * _TALL))
    _word(axes, middle, _AHEAD, "load torque")


def _path(axes: Axes, blocks: list[_Block]) -> dict[str, tuple[float, float]]:
    """Draw the main path; left and right ends of each block and sum."""
    from matplotlib.patches import Circle, Rectangle

    look: Any = {"facecolor": "white", "edgecolor": "black", "linewidth": 0.8}
    boxes = [block for block in blocks if block.title]
    free = _WIDTH - _LEFT - _RIGHT - 2.0 * _SUM * (len(blocks) - len(boxes)) - _GAP * (len(blocks) - 1)
    lengths = [1.5 + max(map(len, (block.title, *block.lines))) for block in boxes]
    per = min(free / sum(lengths), 0.085)
    wide = {block.name: per * length for block, length in zip(boxes, lengths, strict=True)}
    gap = _GAP + max(free - sum(wide.values()), 0.0) / (len(blocks) + 1)
    x, places = _LEFT + gap - _GAP, {}
    _word(axes, 0.05, _AXIS + 0.12, "reference", "left")
    _arrow(axes, (0.05, _AXIS), (x, _AXIS))
    for block in blocks:
        end = x + wide.get(block.name, 2.0 * _SUM)
        places[block.name], middle = (x, end), 0.5 * (x + end)
        if block.title:
            axes.add_patch(Rectangle((x, _AXIS - 0.5 * _TALL), end - x, _TALL, **look))
            top = _AXIS + 0.0625 * len(block.lines)
            axes.text(middle, top, block.title, ha="center", va="center", fontsize=6.8, color=COLOURS["blue"])
            for n, line in enumerate(block.lines, 1):
                axes.text(middle, top - 0.125 * n, line, ha="center", va="center", fontsize=5.8)
        else:
            axes.add_patch(Circle((middle, _AXIS), _SUM, **look))
            axes.text(middle + 0.07, _AXIS - _SUM - 0.07, "−", ha="left", va="center", fontsize=7)
        x = end + gap
        _arrow(axes, (end, _AXIS), (_WIDTH - 0.05 if block is blocks[-1] else x, _AXIS))
    _word(axes, _WIDTH - 0.05, _AXIS + 0.12, "load's speed", "right")
    return places


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


# -- Bode diagram and step responses of loops.


_LOOKS: dict[str, tuple[str, Any, str]] = {  # colour, dashes and mark of a loop
    "current": ("vermillion", (0, (1, 1.2)), "s"),
    "velocity": ("blue", "solid", "o"),
    "position": ("green", (0, (5, 2)), "^"),
}
_RANGE = 60.0  # dB: what is drawn up and down
_DOWN = 10.0 * math.log10(2.0)  # dB, 3 for short: half of the power
_MOST = 400  # samples of an answer or a curve: finer than print
_FEW = 50  # samples that are marked each


def look_of(loop: Loop) -> tuple[str, Any, str]:
    """Colour, dashes and mark of a loop."""
    return _LOOKS.get(loop.name, ("purple", (0, (6, 2, 1, 2)), "D"))


class Response(NamedTuple):
    """A loop's frequency response as it is drawn."""

    frequency: NDArray[np.float64]  # Hz
    opened: NDArray[np.float64]  # dB
    phase: NDArray[np.float64]  # deg, at low frequency between -270 and 90
    closed: NDArray[np.float64]  # dB


def response_of(loop: Loop) -> Response:
    """The response of a loop in dB and degrees.

    The phase of a record starts where its arctangent does: that of two integrators at 180° or at -180°. Here all start
    in the same turn.
    """
    bode, phase = loop.bode, np.degrees(loop.bode.open_phase)
    turns = math.ceil((phase[0] - 90.0) / 360.0)
    opened, closed = (
        20.0 * np.log10(np.where((size > 0.0) & np.isfinite(size), size, np.nan))
        for size in (bode.open_magnitude, bode.closed_magnitude)
    )
    return Response(bode.frequency, opened, phase - 360.0 * turns, closed)


def span(loops: Sequence[Loop]) -> tuple[float, float]:
    """Frequencies of a diagram [Hz]: from well below the slowest loop to the highest Nyquist frequency.

    A loop is as slow as its crossover, its bandwidth or where its gain first is 1; else a share of its range.
    """
    turning = []
    for loop in loops:
        below = np.flatnonzero(loop.bode.open_magnitude < 1.0)
        known = [f for f in (loop.crossover, loop.bandwidth) if f > 0.0]
        if len(below) and below[0]:
            known.append(float(loop.bode.frequency[below[0]]))
        turning.append(min(known, default=0.005 / loop.period))
    return min(turning) / 20.0, max(0.5 / loop.period for loop in loops)


def bode(loops: Sequence[Loop]) -> Plot:
    """Open loop in magnitude and phase, closed loop in magnitude, each loop up to its own Nyquist frequency.

    A mark at crossover and at bandwidth, a line for the phase margin; what lies in the span of the loops, within 60 dB
    and some turns.
    """
    left, right = span(loops)
    rows: list[list[Curve]] = [[], [], []]
    seen: list[list[NDArray[np.float64]]] = [[], [], []]
    for loop in loops:
        response, (colour, dashes, mark) = response_of(loop), look_of(loop)
        legend = _legend(loop)
        thin = curve_points((loop.bode.open_magnitude, loop.bode.closed_magnitude), _MOST)
        thin = thin[response.frequency[thin] >= 0.5 * left]
        for row, of, values in zip(rows, seen, response[1:], strict=True):
            row.append(Curve(name=legend, x=response.frequency[thin], y=values[thin], colour=colour, dashes=dashes))
            of.append(values[response.frequency >= left])
        marked = []  # row, frequency, height, what is there
        if loop.crossover > 0.0:
            phase = float(np.interp(math.log(loop.crossover), np.log(response.frequency), response.phase))
            level = 360.0 * round((phase + 180.0) / 360.0) - 180.0
            rows[1].append(Curve(name=legend, x=[loop.crossover] * 2, y=[level, phase], colour=colour, width=1.8,
                                 listed=False))  # fmt: skip
            marked += [(0, loop.crossover, 0.0, "crossover"), (1, loop.crossover, phase, "phase margin")]
        if loop.bandwidth > 0.0:  # of the slower direction of power: its curve is there, the other one's may be above
            marked.append((2, loop.bandwidth, float(response.closed[0]) - _DOWN, "bandwidth"))
        for place, x, y, text in marked:
            rows[place].append(Curve(name=legend, x=[x], y=[y], colour=colour, mark=mark, joined=False, texts=[text],
                                     listed=False))  # fmt: skip
    about = (  # name, unit; line of reference, ticks, what is seen at least and at most, stretch and room, height
        ("open loop, magnitude", "dB", 0.0, 20.0, (-20.0, 20.0), (-_RANGE, _RANGE), 1.05, 0.0, 0.88),
        ("open loop, phase", "deg", -180.0, 90.0, (-180.0, -90.0), (-540.0, 180.0), 1.0, 15.0, 0.72),
        ("closed loop, magnitude", "dB", -_DOWN, 20.0, (-12.0, 6.0), (-_RANGE, _RANGE), 1.05, 0.0, 0.72),
    )
    diagrams = []
    for curves, of, scale in zip(rows, seen, about, strict=True):
        name, unit, level, tick, least, most, stretch, room, height = scale
        values = stretch * np.concatenate(of)
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        ends = max(min(low, least[0]), most[0]) - room, min(max(high, least[1]), most[1]) + room
        diagrams.append(
            Diagram(name=name, unit=unit, curves=curves, dashed=[level], tick=tick, ends=ends, height=height)
        )
    return Plot(diagrams=diagrams, across="frequency", unit="Hz", ends=(left, right), log=True, columns=1, fewest=1)


def _legend(loop: Loop) -> str:
    """Figures of a loop for the legend."""
    if not loop.stable:
        return f"{loop_name(loop)}: unstable, largest pole {loop.pole_radius:.4g}"
    texts = {figure.name: cell(figure) for figure in loop_figures(loop)}
    margin, bandwidth = texts["phase_margin"], texts["bandwidth"]
    return f"{loop_name(loop)}: crossover {texts['crossover']}, phase margin {margin}, bandwidth {bandwidth}"


def steps(loops: Sequence[Loop]) -> list[Plot]:
    """The answer of each loop to a step of its reference, over its own time; of an unstable one that it has none.

    With the band of 2 % around the end, and the moment from which the samples stay in it.
    """
    plots = []
    for loop in loops:
        if not len(loop.step):
            none = Diagram(name="answer to a step", unit="%", curves=[])
            title = f"{loop_name(loop)}: unstable, largest pole {loop.pole_radius:.4g}"
            plots.append(Plot(diagrams=[none], across="time", unit="ms", title=title))
            continue
        values = loop.step[: settled(loop)]
        samples = curve_points((values,), _MOST)
        unit, per = ("s", 1.0) if len(values) * loop.period >= 1.0 else ("ms", 1e3)
        rest = 100.0 * float(loop.bode.closed_magnitude[0])
        curve = Curve(name=loop_name(loop), x=per * loop.period * samples, y=100.0 * values[samples], listed=False,
                      colour=look_of(loop)[0], mark="o" if len(samples) <= _FEW else "")  # fmt: skip
        settling = [] if math.isnan(loop.settling_time) else [per * loop.settling_time]
        diagram = Diagram(name="answer to a step", unit="%", curves=[curve], whole=True, upright=settling,
                          band=(0.98 * rest, 1.02 * rest))  # fmt: skip
        plots.append(Plot(diagrams=[diagram], across="time", unit=unit, title=loop_name(loop),
                         ends=(0.0, per * loop.period * (len(values) - 1))))  # fmt: skip
    return plots
