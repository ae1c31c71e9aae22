"""The loop of a drive as a block diagram, after figure 3 of the paper: controllers, DC motor, gears, encoder."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from drivesizer.control.cascade import Cascade
from drivesizer.control.drive_train import DriveTrain
from drivesizer.control.validation import Gains, LinearRun, Validation
from drivesizer.output.report.figures.style import COLOURS, Form, drawn
from drivesizer.units import label, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["block_diagram"]

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
