"""Efficiency of a set over torque and speed at the gearhead's output, with the load cycle in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.efficiency import Operation, operation
from drivesizer.machine.set_cycle import SetCycle
from drivesizer.output.report.figures.style import CASES, COLOURS, Form, drawn, named, outside, placed, torque_unit
from drivesizer.physics.cycle_at_gearhead import AT_REST, SPEED
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["LEVELS", "EfficiencyMap", "efficiency_field", "efficiency_map"]

Array = NDArray[np.float64]
LEVELS = (30, 40, 50, 60, 65, 70, 75, 80, 83, 86, 88, 90, 92, 94, 96)  # %, of the lines that may be drawn
_FINE = 48, 56  # points of the field in torque, each way, and in speed
_CROWDED = 1.8  # power by which the torques crowd to 0, where the efficiency changes most
_ROOM = 1.12
_FAR = 4.0  # times the cycle's torque; a gearhead that is rated for more would leave the cycle no room
_SHADES = ("#FFFFFF", "#CFE3F1")
_MOST = 1500  # segments of a trace: finer than print
_MARKED = 200  # ends of segments that are marked each


class EfficiencyMap(NamedTuple):
    """Data of the figure."""

    torque: Array  # N*m, across
    speed: Array  # rad/s, up
    field: Operation  # at all of them: speeds down, torques across
    voltage: float  # V, usable; NaN unknown
    traces: tuple[tuple[str, Array, Array], ...]  # name, torque and speed of each load case over its cycle


def efficiency_field(cases: list[tuple[str, SetCycle]], voltage: float) -> EfficiencyMap:
    """The field around the load cycles of a set."""
    traces = tuple((name, *_trace(found)) for name, found in cases)
    demand = max(float(np.abs(torque).max()) for _, torque, _ in traces) or 1.0
    rated = float(cases[0][1].gearhead["continuous_torque"][0])
    right = _ROOM * max(demand, min(rated, _FAR * demand) if np.isfinite(rated) else 0.0)
    brakes = min(float(torque.min()) for _, torque, _ in traces)
    left = min(0.0, _ROOM * brakes, -0.35 * right if brakes < 0.0 else 0.0)
    top = _ROOM * (max(float(speed.max()) for *_, speed in traces) or 1.0)
    near = np.linspace(0.0, 1.0, _FINE[0]) ** _CROWDED
    torque = np.concatenate([left * near[:0:-1], right * near[1:]]) if left < 0.0 else right * near[1:]
    speed = np.linspace(top / _FINE[1], top, _FINE[1])
    return EfficiencyMap(torque, speed, operation(cases[0][1], torque, speed[:, None]), voltage, traces)


def _trace(found: SetCycle) -> tuple[Array, Array]:
    """Torque and speed at the gearhead's output, one way as the other: what brakes is below 0."""
    functions = found.cycle.functions
    way = np.sign(functions[:, :, SPEED].mean(1))[:, None]
    torque = functions[:, :, : AT_REST + 1].sum(axis=2)
    torque = np.where(way == 0.0, np.abs(torque), way * torque)
    extremes = [column.argmax(axis=0) for column in (torque, -torque, np.abs(functions[:, :, SPEED]))]
    rows = np.unique(np.concatenate([np.arange(0, len(torque), -(-len(torque) // _MOST)), *extremes]))
    return torque[rows].ravel(), np.abs(functions[rows, :, SPEED]).ravel()


def efficiency_map(found: EfficiencyMap, form: Form = "svg") -> bytes:
    """Lines of equal efficiency, as far as the voltage reaches, and the load cycles."""
    unit = torque_unit(float(np.abs(found.torque).max()))

    def draw(figure: Figure) -> None:
        axes = placed(figure, right=2.05, top=0.22)[0][0]
        _lines(axes, found, unit)
        for (name, torque, speed), (colour, dashes) in zip(found.traces, CASES, strict=False):
            said = f"load cycle,\n{named(name)}" if name else "load cycle"
            axes.plot(_shown(torque, unit), _rpm(speed), color=COLOURS[colour], linestyle=dashes, label=said, zorder=5,
                      marker="o" if len(torque) <= _MARKED else "", markersize=2.2)  # fmt: skip
        axes.axvline(0.0, color="black", linewidth=0.6)
        axes.set(xlim=_shown(found.torque[[0, -1]], unit), ylim=(0.0, _rpm(found.speed[-1])))
        axes.set(xlabel=f"torque at the gearhead's output ({label(unit)})", ylabel="speed there (rpm)")
        for said, side, to in (("drives", 3, "left"), ("brakes", -3, "right")):
            if said == "drives" or found.torque[0] < 0.0:
                axes.annotate(said, (0.0, 1.0), (side, 3), xycoords=("data", "axes fraction"), ha=to, fontsize=7,
                              textcoords="offset points")  # fmt: skip
        outside(axes)

    return drawn(draw, 2.3, form)


def _shown(torque: Array, unit: str) -> Array:
    return np.asarray(from_si(torque, unit, "torque"))


def _rpm(speed: Array) -> Array:
    return np.asarray(from_si(speed, "rpm", "rotary_speed"))


def _lines(axes: Axes, found: EfficiencyMap, unit: str) -> None:
    """Iso-lines with their percentage, each direction of power for itself, and the end of the voltage."""
    from matplotlib.colors import LinearSegmentedColormap

    across, up = _shown(found.torque, unit), _rpm(found.speed)
    reached = ~(np.abs(found.field.voltage) > found.voltage)
    share = np.where(reached, 100.0 * found.field.efficiency, np.nan)
    shades = LinearSegmentedColormap.from_list("shades", _SHADES)
    for side in (found.torque > 0.0, found.torque < 0.0):
        values = share[:, side]
        known = values[np.isfinite(values)]
        levels = [level for level in LEVELS if len(known) and known.min() < level < known.max()]
        if side.sum() < 2 or not levels:
            continue
        axes.contourf(across[side], up, values, [0.0, *levels, 100.0], cmap=shades, zorder=0.5)
        drawn_lines = axes.contour(across[side], up, values, levels, colors=COLOURS["grey"], linewidths=0.6)
        axes.clabel(drawn_lines, fmt="%g %%", fontsize=6.2, inline_spacing=2)
    if not reached.all():
        edge = axes.contour(across, up, np.abs(found.field.voltage), [found.voltage], colors=COLOURS["blue"],
                            linewidths=1.1)  # fmt: skip
        edge.set_zorder(4)
        axes.plot([], [], color=COLOURS["blue"], label=f"{found.voltage:.3g} V, winding warm")
