"""The motor's torque-speed field: continuous and intermittent, hot and cold, and the cycle in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.machine.operating_field import OperatingField, hot_winding
from drivesizer.output.report.figures.field_panels import TOGETHER, Panel, reach_of, signed
from drivesizer.output.report.figures.style import torque_unit
from drivesizer.output.report.html.curves import Plot, above, dashes, figure, line
from drivesizer.output.report.html.load_plots import case_look
from drivesizer.units import from_si, label, show

__all__ = ["field_plot"]

Array = NDArray[np.float64]
_ROOM = 1.12  # of an axis beyond what must be seen
_MOST = 1500  # segments of a cycle that are drawn
_MARKED = 60  # segments whose ends are marked each
_PAPER = (("triangle-up-open", "vermillion"), ("square-open", "grey"), ("triangle-down-open", "purple"),
          ("diamond-open", "blue"))  # fmt: skip


def field_plot(panel: Panel, times: Sequence[Array]) -> Plot:
    """The field of a motor and the load cases of one usable voltage and ambient."""
    first, reach = panel.cases[0][-1], reach_of(panel)
    unit = torque_unit(reach)
    data = [*_regions(first, unit), *_voltage_lines(first, unit, reach)]
    first_alone = len(panel.cases) > TOGETHER
    for place, (number, name, found) in enumerate(panel.cases):
        hidden = {"visible": "legendonly"} if first_alone and place else {}
        data += [trace | hidden for trace in _cycle(number, name, found, times[number], unit)]
    data += [_spot(f"paper: {point.name}", point.torque, point.speed, unit, *look)
             for point, look in zip(panel.points, _PAPER, strict=False)]  # fmt: skip
    return figure(data, _layout(panel, unit, reach))


def _layout(panel: Panel, unit: str, reach: float) -> Plot:
    first = panel.cases[0][-1]
    left = min(0.0, *(np.nan_to_num(signed(f)[1]).min() for *_, f in panel.cases), *(p.torque for p in panel.points))
    top = max(first.speed[-1], *(f.speed[-1] for *_, f in panel.cases), *(p.speed for p in panel.points))
    right = float(from_si(_ROOM * reach, unit, "torque"))
    low = _ROOM * float(from_si(left, unit, "torque")) - 0.03 * right
    return {
        "height": 460,
        "hovermode": "closest",
        "xaxis": {"title": {"text": f"torque at the motor's shaft ({label(unit)})"}, "range": [low, right]},
        "yaxis": {"range": [0.0, 1.06 * _rpm(top)]},
        "annotations": [above("motor speed (rpm)")],
    }


def _rpm(speed: Any) -> float:
    return float(from_si(speed, "rpm", "rotary_speed"))


def _regions(found: OperatingField, unit: str) -> list[Plot]:
    """The intermittent and the continuous field, both with a hot winding."""
    hot = np.maximum(found.voltage_hot, 0.0)
    if not np.isnan(found.permissible_speed):
        hot = np.where(found.speed > found.permissible_speed, 0.0, hot)
    continuous = np.fmin(np.nan_to_num(found.continuous), hot)
    for_a_while = np.fmin(found.intermittent, hot)
    made = []
    if not np.isnan(for_a_while).any():
        made.append(
            _region(_INTERMITTENT, continuous, np.maximum(continuous, for_a_while), found, unit, "vermillion", 0.11)
        )
    if not np.isnan(found.continuous).any():
        by_heat = "continuous" if found.thermal else "continuous, nominal torque"
        made.append(_region(by_heat, np.zeros_like(hot), continuous, found, unit, "blue", 0.2))
    return made


_INTERMITTENT = "intermittent"


def _region(name: str, low: Array, high: Array, found: OperatingField, unit: str, colour: str, share: float) -> Plot:
    """All between two torques at every speed."""
    torque, speed = np.concatenate([low, high[::-1]]), np.concatenate([found.speed, found.speed[::-1]])
    region = line(from_si(torque, unit, "torque"), from_si(speed, "rpm", "rotary_speed"), name, colour, fill="toself",
                  fillcolor=colour, opacity=share, hoverinfo="skip")  # fmt: skip
    return region | {"line": {"color": colour, "dash": "solid", "width": 0}}


def _voltage_lines(found: OperatingField, unit: str, reach: float) -> list[Plot]:
    """Lines of the voltage, hot and cold, of short-time operation as far as it goes, and of the permissible speed."""
    hot, cold = (np.where(values < 0.0, np.nan, values) for values in (found.voltage_hot, found.voltage_cold))
    given = f"{found.voltage:.3g} V, winding "
    within = np.where(found.intermittent <= found.voltage_cold, found.intermittent, np.nan)
    wanted = (
        (f"{given}{hot_winding(found)}", hot, "blue", "solid"),
        (f"{given}{show(found.ambient, 'degC', 'temperature', 3)}", cold, "blue", dashes((0, (5, 2)))),
        (_INTERMITTENT, within, "vermillion", dashes((0, (6, 2, 1, 2)))),
    )
    rpm = from_si(found.speed, "rpm", "rotary_speed")
    made = [
        line(from_si(values, unit, "torque"), rpm, name, colour, dash, hovertemplate=_hover(unit))
        for name, values, colour, dash in wanted
        if not np.isnan(values).all()
    ]
    if found.permissible_speed <= _ROOM * found.speed[-1]:
        ends = (0.0, float(from_si(_ROOM * reach, unit, "torque"))), [_rpm(found.permissible_speed)] * 2
        dotted = dashes((0, (1, 1.5)))
        made.append(line(*ends, "permissible speed", "grey", dotted, hovertemplate=_hover(unit)))
    return made


def _hover(unit: str, more: str = "") -> str:
    return f"<b>%{{fullData.name}}</b><br>%{{y:.0f}} rpm, %{{x:.4~r}} {label(unit)}{more}<extra></extra>"


def _cycle(number: int, name: str, found: OperatingField, time: Array, unit: str) -> list[Plot]:
    """The way of a load cycle through the field, and the point of its RMS current and speed."""
    speed, torque = signed(found)
    if np.isnan(torque).any():
        return []
    extremes = [column.argmax(axis=0) for column in (speed, torque, -torque)]
    kept = np.unique(np.concatenate([np.arange(0, len(speed), -(-len(speed) // _MOST)), *extremes]))
    look, said = case_look(number), f"load cycle, {name}" if name else "load cycle"
    way = line(
        from_si(torque[kept].ravel(), unit, "torque"),
        from_si(speed[kept].ravel(), "rpm", "rotary_speed"),
        said,
        mode="lines+markers" if len(kept) <= _MARKED else "lines",
        marker={"size": 6, "color": look["colour"]},
        customdata=_moments(time[kept].ravel(), (speed * torque)[kept].ravel()),
        hovertemplate=_hover(unit, "<br>at %{customdata[0]:.6~r} s of the cycle, %{customdata[1]}"),
        **look,
    )
    if np.isnan(found.rms_torque):
        return [way]
    title = "RMS current and speed" + (f", {name}" if name else "")
    rms = _spot(title, found.rms_torque, found.rms_speed, unit, "circle", look["colour"])
    return [way, rms | {key: look[key] for key in ("visible",) if key in look}]


def _moments(time: Array, power: Array) -> list[list[Any]]:
    """Time of each point of a cycle [s], and the power of the shaft then."""
    shown = (f"{watts:.4g} W at the shaft".replace("-", "−") for watts in power)
    return [[float(f"{at:.8g}"), said] for at, said in zip(time, shown, strict=True)]


def _spot(name: str, torque: float, speed: float, unit: str, symbol: str, colour: str) -> Plot:
    at = [float(from_si(torque, unit, "torque"))], [_rpm(speed)]
    mark = {"symbol": symbol, "size": 10, "color": colour, "line": {"width": 1.6 if "open" in symbol else 0}}
    return line(*at, name, colour, hovertemplate=_hover(unit), mode="markers", marker=mark)
