"""The motion of a cycle as a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform_wheels import trajectory_of
from drivesizer.load_cases.profile import SPEED, profile_of
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, placed
from drivesizer.output.report.figures.time_strips import Window, thinned
from drivesizer.spec.motions import Track, Trapezoid, Waypoints
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Moved", "platform_motion", "speed_profile", "speed_required"]


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
