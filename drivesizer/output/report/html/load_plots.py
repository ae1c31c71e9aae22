"""The motion, and the load over its cycle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drivesizer.output.report.figures.load_and_loop import stretches
from drivesizer.output.report.figures.motion import platform_motion, speed_required
from drivesizer.output.report.figures.style import CASES, torque_unit
from drivesizer.output.report.figures.time_strips import windows
from drivesizer.output.report.html.curves import Plot, dashes, figure, line, rows, sampled, whole
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.spec.motions import Track, Waypoints
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label

__all__ = ["case_look", "cycle_plot", "motion_plot"]


def motion_plot(spec: RobotSpec) -> Plot:
    """The speed of the spec over one cycle, to scale; of a platform on a path that of the platform."""
    if isinstance(spec.motion, Track | Waypoints):
        return _platform_plot(spec)
    time, speed, (kind, unit) = speed_required(spec)
    views = windows({"time": time, "speed_reference": speed})
    kept = sampled(time, [speed], views)
    trace = line(time[kept], from_si(speed[kept], unit, kind), "speed", "blue",
                 hovertemplate=f"%{{y:.4~r}} {label(unit)}<extra></extra>")  # fmt: skip
    layout = rows([f"speed ({label(unit)})"])
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": [float(time[0]), float(time[-1])]}
    return figure([trace], layout, _all_views(views, time))


def _platform_plot(spec: RobotSpec) -> Plot:
    """Velocities of a platform in its own axes, turning below."""
    time, moved = platform_motion(spec)
    kept = sampled(time, [one.values for one in moved], ())
    looks = {"forwards": ("blue", "solid"), "to the left": ("vermillion", "8px,3px"), "turning": ("green", "solid")}
    data = [
        line(time[kept], from_si(one.values[kept], one.unit, one.kind), one.name, *looks[one.name],
             yaxis="y2" if one.name == "turning" else "y",
             hovertemplate=f"%{{y:.4~r}} {_turned(one.unit)}<extra>%{{fullData.name}}</extra>")
        for one in moved
    ]  # fmt: skip
    layout = rows(["speed (m/s)", "turning (°/s)"])
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": [float(time[0]), float(time[-1])]}
    return figure(data, layout)


def _turned(unit: str) -> str:
    return label(unit).replace("deg", "°")


def cycle_plot(cycles: Sequence[tuple[str, LoadCycle]]) -> Plot:
    """Torque and speed of the driven shaft, of one drive, in every load case."""
    views = stretches(cycles)
    unit = torque_unit(max(float(np.abs(cycle.torque).max()) for _, cycle in cycles))
    data = [trace for n, (name, cycle) in enumerate(cycles) for trace in _over_time(n, name, cycle, unit, views)]
    layout = rows([f"torque ({label(unit)})", "speed (rpm)"])
    longest = max((cycle.time.ravel() for _, cycle in cycles), key=lambda time: float(time[-1]))
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": [0.0, float(longest[-1])]}
    return figure(data, layout, _all_views(views, longest))


def _over_time(number: int, name: str, cycle: LoadCycle, unit: str, views: Sequence[Any]) -> list[Plot]:
    time, shown = cycle.time.ravel(), case_look(number)
    said = name or "load cycle"
    kept = sampled(time, [cycle.torque.ravel(), cycle.speed.ravel()], views)
    columns = ((cycle.torque, unit, "torque", "y"), (cycle.speed, "rpm", "rotary_speed", "y2"))
    return [
        line(time[kept], from_si(values.ravel()[kept], trade, kind), said, yaxis=axis,
             hovertemplate=f"%{{y:.4~r}} {label(trade)}<extra>%{{fullData.name}}</extra>", **shown)
        for values, trade, kind, axis in columns
    ]  # fmt: skip


def case_look(number: int) -> dict[str, Any]:
    """Colour and dashes of a load case; those beyond the first few are shown when they are selected."""
    colour, pattern = CASES[number % len(CASES)]
    return {"colour": colour, "dash": dashes(pattern)} | ({} if number < len(CASES) else {"visible": "legendonly"})


def _all_views(views: Sequence[Any], time: Any) -> list[Any]:
    return [whole(time), *views] if len(views) > 1 else []
