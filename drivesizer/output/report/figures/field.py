"""The motor's torque-speed field as a figure: voltage lines hot and cold, what is allowed, and the load cases."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.operating_field import OperatingField, hot_winding
from drivesizer.output.report.figures.field_panels import Panel, reach_of, signed
from drivesizer.output.report.figures.style import (
    CASES,
    COLOURS,
    Form,
    drawn,
    heading,
    named,
    outside,
    placed,
    torque_unit,
)  # fmt: skip
from drivesizer.units import from_si, label, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["MOST_FIELDS", "conditions", "torque_speed", "torque_speed_panels"]


def torque_speed(panels: Sequence[Panel], form: Form = "svg") -> bytes:
    """The motor's field, winding hot and cold, with the load cases in it."""
    heights = [_height(panel) for panel in panels]

    def draw(figure: Figure) -> None:
        grid = placed(figure, len(panels), right=_LEGEND, top=0.2, gaps=(0.6, 0.0), heights=heights, shared=False)
        for (axes,), panel in zip(grid, panels, strict=True):
            _field(axes, panel)
            outside(axes)
            if len(panels) > 1:
                axes.set_title(conditions(panel))

    return drawn(draw, sum(heights) + 0.6 * len(panels), form)


def conditions(panel: Panel) -> str:
    """Usable voltage and ambient of a panel."""
    lines = panel.cases[0][-1]
    return f"{show(lines.voltage, 'V', 'voltage')} usable, ambient {show(lines.ambient, 'degC', 'temperature')}"


def _panel_title(panel: Panel) -> str:
    """Usable voltage and ambient, without words."""
    return conditions(panel).replace(" usable, ambient", ",")


MOST_FIELDS = 8
_NAME = 88.0  # pt, of a name above a small diagram
_ABREAST = 2  # small diagrams
_SMALL = 1.75  # in, of a small diagram


def torque_speed_panels(panels: Sequence[Panel], form: Form = "svg") -> bytes:
    """The motor's field once for each load case, as small diagrams with one legend."""
    shown = panels[:MOST_FIELDS]
    rows = -(-len(shown) // _ABREAST)
    several = len({conditions(panel) for panel in shown}) > 1

    def draw(figure: Figure) -> None:
        grid = placed(figure, rows, _ABREAST, top=0.52, gaps=(0.62, 0.62), shared=False)
        places = [axes for row in grid for axes in row]
        for axes, panel in zip(places, shown, strict=False):
            _field(axes, panel, plain=True)
            name = named(panel.cases[0][1], _NAME).strip()
            axes.set_title(f"{name}: {_panel_title(panel)}" if several else name)
        for axes in places[len(shown) :]:
            axes.set_visible(False)
        heading(figure, *_names(places[: len(shown)]), 5)

    return drawn(draw, (_SMALL + 0.62) * rows + 0.32, form)


def _names(places: Sequence[Axes]) -> tuple[list[Any], list[str]]:
    """Lines of all diagrams, those of a name once: a stepper has others than a motor."""
    found: dict[str, Any] = {}
    for axes in places:
        for line, name in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(name, line)
    return [*found.values()], [*found]


_LEGEND = 2.05  # in, of room beside the field
_LOWEST = 2.3  # in, of a field


def _height(panel: Panel) -> float:
    """Of a field [in]: its legend has a name and a dot of two lines each for a load case, and for a point."""
    cases = sum(number < len(CASES) for number, *_ in panel.cases)
    named_ones = 0.2 * _LINES + (0.66 if cases > 1 else 0.53) * cases + 0.33 * len(panel.points)
    return max(_LOWEST, named_ones - _BESIDE)


_LINES = 5  # of a motor that have a name
_BESIDE = 0.45  # in, of a legend that may stand beside the axis below a field
_ROOM = 1.12  # of an axis beyond what must be seen
_HEADROOM = 1.06  # above the highest speed
_SLOWEST = 0.1  # rad/s, highest speed of a diagram at least: a stepper that holds its load has none


def _field(axes: Axes, panel: Panel, *, plain: bool = False) -> None:
    """Limits of the motor and load cycles; plain: names without figures, for a legend that several diagrams share."""
    first = panel.cases[0][-1]
    reach = reach_of(panel)
    unit = torque_unit(reach)
    _lines(axes, first, unit, reach, plain=plain)
    for number, name, found in panel.cases:
        if plain or number < len(CASES):
            said = "load cycle" if plain or not name else f"load cycle,\n{named(name)}"
            _trace(axes, found, unit, *CASES[0 if plain else number], said, plain=plain)
    _mark(axes, panel, unit)
    right = float(from_si(_ROOM * reach, unit, "torque"))
    left = min(0.0, *(np.nan_to_num(signed(f)[1]).min() for *_, f in panel.cases), *(p.torque for p in panel.points))
    top = max(_SLOWEST, first.speed[-1], *(f.speed[-1] for *_, f in panel.cases), *(p.speed for p in panel.points))
    axes.set_xlim(_ROOM * float(from_si(left, unit, "torque")) - 0.03 * right, right)
    axes.set_ylim(0, float(from_si(_HEADROOM * top, "rpm", "rotary_speed")))
    axes.axvline(0, color="black", linewidth=0.6)
    axes.set(xlabel=f"torque at the motor's shaft ({label(unit)})", ylabel="motor speed (rpm)")


def _lines(axes: Axes, found: OperatingField, unit: str, reach: float, *, plain: bool) -> None:
    """Limits of the motor: continuous, by voltage hot and cold, short-time, and by speed."""

    def line(values: NDArray[np.float64], colour: str, dashes: Any, name: str) -> None:
        if not np.isnan(values).all():
            torque, rpm = from_si(values, unit, "torque"), from_si(found.speed, "rpm", "rotary_speed")
            axes.plot(torque, rpm, color=COLOURS[colour], linestyle=dashes, label=name)

    if found.pull_out is not None:
        line(found.pull_out, "blue", "solid", "pull-out torque" if plain else "pull-out torque, lowest supply")
        line(found.pull_out / found.factor, "blue", (0, (5, 2)), f"1/{found.factor:g} of it")
        return
    _continuous(axes, found, unit)
    hot, cold = (np.where(values < 0.0, np.nan, values) for values in (found.voltage_hot, found.voltage_cold))
    ambient = show(found.ambient, "degC", "temperature", 3)
    for values, winding, dashes in ((hot, hot_winding(found), "solid"), (cold, ambient, (0, (5, 2)))):
        said = (
            f"winding {'hot' if dashes == 'solid' else 'cold'}"
            if plain
            else f"{found.voltage:.3g} V, winding {winding}"
        )
        line(values, "blue", dashes, said.replace("-", "−"))
    within = np.fmin(found.voltage_cold, _ROOM * reach)  # beyond that it limits nothing, or is not in sight
    intermittent = np.where(found.intermittent <= within, found.intermittent, np.nan)
    line(intermittent, "vermillion", (0, (6, 2, 1, 2)), "intermittent")
    if found.permissible_speed <= _HEADROOM * found.speed[-1]:
        axes.axhline(float(from_si(found.permissible_speed, "rpm", "rotary_speed")), color=COLOURS["grey"],
                     linestyle=(0, (1, 1.5)), label="permissible speed")  # fmt: skip


def _continuous(axes: Axes, found: OperatingField, unit: str) -> None:
    """The field that is allowed continuously, by heat, by the voltage of a hot winding, and by speed."""
    if np.isnan(found.continuous).any():
        return
    allowed = np.fmin(found.continuous, np.maximum(found.voltage_hot, 0.0))
    if not np.isnan(found.permissible_speed):
        allowed = np.where(found.speed > found.permissible_speed, 0.0, allowed)
    name = "continuous" if found.thermal else "continuous, nominal torque"
    axes.fill_betweenx(from_si(found.speed, "rpm", "rotary_speed"), 0.0, from_si(allowed, unit, "torque"),
                       color=COLOURS["blue"], alpha=0.12, linewidth=0, label=name)  # fmt: skip


_MOST_SEGMENTS = 1500  # of a trace: finer than print


def _trace(axes: Axes, found: OperatingField, unit: str, colour: str, dashes: Any, name: str, *, plain: bool) -> None:
    speed, torque = signed(found)
    if np.isnan(torque).any():
        return
    extremes = [column.argmax(axis=0) for column in (speed, torque, -torque)]
    rows = np.unique(np.concatenate([np.arange(0, len(speed), -(-len(speed) // _MOST_SEGMENTS)), *extremes]))
    axes.plot(from_si(torque[rows].ravel(), unit, "torque"), from_si(speed[rows].ravel(), "rpm", "rotary_speed"),
              color=COLOURS[colour], linestyle=dashes, zorder=4, label=name)  # fmt: skip
    if np.isnan(found.rms_torque):  # a motor whose friction is unknown: the line is drawn, its RMS current is not known
        return
    rms = found.rms_torque, found.rms_speed, unit
    axes.plot(*_point(*rms), marker="o", markersize=5.5, color=COLOURS[colour], linestyle="none", zorder=5,
              label="RMS current and speed" if plain else _marked("RMS current and speed", *rms))  # fmt: skip


def _point(torque: float, speed: float, unit: str) -> tuple[float, float]:
    return float(from_si(torque, unit, "torque")), float(from_si(speed, "rpm", "rotary_speed"))


def _marked(name: str, torque: float, speed: float, unit: str) -> str:
    x, y = _point(torque, speed, unit)
    return f"{name}\n{x:.4g} {label(unit)}, {y:.0f} rpm".replace("-", "−")


_MARKERS = (("^", "vermillion"), ("s", "grey"), ("v", "purple"), ("D", "blue"))


def _mark(axes: Axes, panel: Panel, unit: str) -> None:
    """Points with a shape each, named in the legend: labels beside them would overlap where points lie close."""
    for point, (marker, colour) in zip(panel.points, _MARKERS, strict=False):
        axes.plot(*_point(point.torque, point.speed, unit), marker=marker, markersize=5.5, markerfacecolor="none",
                  markeredgewidth=1.2, color=COLOURS[colour], linestyle="none", zorder=6,
                  label=_marked(f"paper: {point.name}", point.torque, point.speed, unit))  # fmt: skip
