"""Figures that move: load, loops, torque-speed field, battery and power over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Loop, Validation
from drivesizer.loads.motions import Track, Waypoints
from drivesizer.machine.battery import charge_over_mission
from drivesizer.machine.operating_field import OperatingField, hot_winding
from drivesizer.output.loop_table import cell, loop_figures, loop_name, settled
from drivesizer.output.report.figures.cycle import LINEAR, closed_loop_rows, platform_motion, speed_required, stretches
from drivesizer.output.report.figures.field import TOGETHER, Panel, reach_of, signed
from drivesizer.output.report.figures.loops import curve_of, look_of, span
from drivesizer.output.report.figures.machine import LOOKS, Layer, is_known, layers, power_unit, shown_until
from drivesizer.output.report.figures.style import CASES, torque_unit, windows
from drivesizer.output.report.html.curves import Plot, above, dashes, figure, line, numbers, plain, rows, sampled, whole
from drivesizer.output.thinning import curve_points
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.drive_set import EnergyBudget
from drivesizer.results.machine import MachinePower
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label, show

# -- The motion, and the load over its cycle.


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
    data = [trace for n, (name, cycle) in enumerate(cycles) for trace in _load_over_time(n, name, cycle, unit, views)]
    layout = rows([f"torque ({label(unit)})", "speed (rpm)"])
    longest = max((cycle.time.ravel() for _, cycle in cycles), key=lambda time: float(time[-1]))
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": [0.0, float(longest[-1])]}
    return figure(data, layout, _all_views(views, longest))


def _load_over_time(number: int, name: str, cycle: LoadCycle, unit: str, views: Sequence[Any]) -> list[Plot]:
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


# -- The closed loop over time, the frequency response of its loops, and their answers to a step.


_SYMBOLS = {"s": "square", "o": "circle", "^": "triangle-up", "D": "diamond"}  # of plotly, by matplotlib's marks
_RANGE = 60.0  # dB: what is seen at first, up and down
_MOST_POINTS = 400  # points of a frequency response, samples of an answer


def closed_loop_plot(validation: Validation) -> Plot:
    """Reference and speed, errors, current, voltage and winding over one axis of time; at first the first change."""
    series, found = validation.series, closed_loop_rows(validation)
    time, views = series["time"], windows(series)
    data = [trace for place, (names, _) in enumerate(found, 1) for trace in _loop_over_time(validation, names, place)]
    units = [label(validation.series_units[names[-1]][1]) for names, _ in found]
    layout = rows([f"{title} ({unit})" for (_, title), unit in zip(found, units, strict=True)], height=118.0)
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": [views[0].start, views[0].end]}
    return figure(data, layout, [*views, whole(time)] if len(views) > 1 else [])


def _loop_over_time(validation: Validation, names: tuple[str, ...], place: int) -> list[Plot]:
    looks = (("vermillion", dashes((0, (4, 3)))), ("blue", "solid"))
    time, views = validation.series["time"], windows(validation.series)
    made = []
    for name, look in zip(names, looks[-len(names) :], strict=True):
        kind, unit = validation.series_units[name]
        values = validation.series[name]
        kept = sampled(time, [values], views)
        said = name.replace("_", " ")
        shown = from_si(values[kept], unit, kind)
        hover = f"%{{y:.4~r}} {label(unit)}<extra>%{{fullData.name}}</extra>"
        where: Plot = {"yaxis": "y" if place == 1 else f"y{place}", "showlegend": len(names) > 1}
        made.append(line(time[kept], shown, said, *look, hovertemplate=hover, **where))
    linear, name = validation.linear.series if validation.linear else {}, names[-1]
    if name in linear:
        kind, unit = validation.series_units[name]
        kept = sampled(linear["time"], [linear[name]], views)
        shown = from_si(linear[name][kept], unit, kind)
        said = LINEAR if place == 1 else f"{name}, {LINEAR}"
        hover = f"%{{y:.4~r}} {label(unit)}<extra>{LINEAR}</extra>"
        where = {"yaxis": "y" if place == 1 else f"y{place}", "showlegend": place == 1}
        made.append(
            line(linear["time"][kept], shown, said, "orange", dashes((0, (5, 2.5))), hovertemplate=hover, **where)
        )
    return made


def bode_plot(loops: Sequence[Loop]) -> Plot:
    """Open loop in magnitude and phase, closed loop in magnitude, each loop up to its own Nyquist frequency."""
    left, right = span(loops)
    data = [trace for loop in loops for trace in (*_curves(loop, left), *_marks(loop))]
    layout = rows(["open loop, magnitude (dB)", "open loop, phase (°)", "closed loop, magnitude (dB)"])
    layout["xaxis"] |= {
        "type": "log",
        "title": {"text": "frequency (Hz)"},
        "range": [math.log10(left), math.log10(right)],
    }
    seen = {
        axis: [y for t in data if t["yaxis"] == axis for y in t["y"] if y is not None] for axis in ("y", "y2", "y3")
    }
    layout["yaxis"]["range"] = _within(seen["y"], 20.0)
    layout["yaxis2"] |= {"dtick": 90, "range": _turns(seen["y2"])}
    layout["yaxis3"]["range"] = _within(seen["y3"], 12.0)
    layout["shapes"] = [_level(axis, y) for axis, y in (("y", 0.0), ("y2", -180.0), ("y3", -10.0 * math.log10(2.0)))]
    return figure(data, layout)


def _within(values: Sequence[float], least: float) -> list[float]:
    return [1.05 * max(min(*values, -least), -_RANGE), 1.05 * min(max(*values, least / 2), _RANGE)]


def _turns(values: Sequence[float]) -> list[float]:
    """Limits of the phase: all of it within some turns, and what a margin is measured from."""
    return [max(min(*values, -180.0), -540.0) - 15.0, min(max(*values, -90.0), 180.0) + 15.0]


def _level(axis: str, y: float) -> Plot:
    return {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "yref": axis, "y0": y, "y1": y,
            "line": {"color": "ink", "width": 0.8, "dash": "dash"}}  # fmt: skip


def _curves(loop: Loop, left: float) -> list[Plot]:
    curve, (colour, pattern, _) = curve_of(loop), look_of(loop)
    kept = curve_points((loop.bode.open_magnitude, loop.bode.closed_magnitude), _MOST_POINTS)
    kept = kept[curve.frequency[kept] >= 0.5 * left]
    units = (("y", curve.opened, "dB"), ("y2", curve.phase, "°"), ("y3", curve.closed, "dB"))
    return [
        line(curve.frequency[kept], values[kept], loop_name(loop), colour, dashes(pattern), yaxis=axis,
             hovertemplate=f"%{{y:.4~r}} {unit}<extra>%{{fullData.name}}</extra>")
        for axis, values, unit in units
    ]  # fmt: skip


def _marks(loop: Loop) -> list[Plot]:
    """The crossover on the open loop, and on the closed loop the bandwidth."""
    curve = curve_of(loop)
    colour, _, mark = look_of(loop)
    said = {f.name: cell(f) for f in loop_figures(loop)}
    made = []
    if loop.crossover > 0.0:
        phase = float(np.interp(math.log(loop.crossover), np.log(curve.frequency), curve.phase))
        hover = f"crossover {said['crossover']}, phase margin {said['phase_margin']}"
        made += [(loop.crossover, 0.0, "y", hover), (loop.crossover, phase, "y2", hover)]
    if loop.bandwidth > 0.0:
        made.append((loop.bandwidth, float(curve.closed[0]) - 10.0 * math.log10(2.0), "y3",
                     f"bandwidth {said['bandwidth']}"))  # fmt: skip
    return [
        line(
            [x],
            [y],
            loop_name(loop),
            colour,
            yaxis=axis,
            hovertemplate=f"{plain(hover)}<extra>%{{fullData.name}}</extra>",
        )
        | {"mode": "markers", "marker": {"symbol": _SYMBOLS[mark], "size": 8, "color": colour}}
        for x, y, axis, hover in made
    ]


def step_plots(loops: Sequence[Loop]) -> dict[str, Plot]:
    """The answer of each stable loop to a step of its reference, by the loop's name."""
    return {loop_name(loop): _step(loop) for loop in loops if len(loop.step)}


def _step(loop: Loop) -> Plot:
    """The samples, the band of 2 % around the end, and the moment from which they stay in it."""
    values = loop.step[: settled(loop)]
    kept = curve_points((values,), _MOST_POINTS)
    unit, per = ("s", 1.0) if len(values) * loop.period >= 1.0 else ("ms", 1e3)
    colour = look_of(loop)[0]
    end, rest = per * loop.period * (len(values) - 1), 100.0 * float(loop.bode.closed_magnitude[0])
    trace = line(per * loop.period * kept, 100.0 * values[kept], loop_name(loop), colour,
                 mode="lines+markers" if len(kept) <= 50 else "lines",
                 hovertemplate=f"%{{y:.4~r}} % at %{{x:.4~r}} {unit}<extra></extra>")  # fmt: skip
    layout = rows(["answer to a step (%)"], height=200.0) | {"hovermode": "closest"}
    layout["xaxis"] |= {"title": {"text": f"time ({unit})"}, "range": numbers((0.0, end))}
    layout["yaxis"]["rangemode"] = "tozero"
    layout["shapes"] = [{"type": "rect", "xref": "paper", "x0": 0, "x1": 1, "yref": "y", "y0": 0.98 * rest,
                         "y1": 1.02 * rest, "fillcolor": "grey", "opacity": 0.2, "line": {"width": 0}}]  # fmt: skip
    if not math.isnan(loop.settling_time):
        layout["shapes"].append({"type": "line", "xref": "x", "x0": per * loop.settling_time,
                                 "x1": per * loop.settling_time, "yref": "y domain", "y0": 0, "y1": 1,
                                 "line": {"color": "grey", "width": 1, "dash": "dash"}})  # fmt: skip
    return figure([trace], layout)


# -- The motor's torque-speed field: continuous and intermittent, hot and cold, and the cycle in it.


Array = NDArray[np.float64]
_ROOM = 1.12  # of an axis beyond what must be seen
_MOST_SEGMENTS = 1500  # segments of a cycle that are drawn
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
    kept = np.unique(np.concatenate([np.arange(0, len(speed), -(-len(speed) // _MOST_SEGMENTS)), *extremes]))
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


# -- Powers drawn from the battery, and the charge that is left over time.


_ROW = 26  # px


def consumers_plot(budget: EnergyBudget | None) -> Plot | None:
    """Mean power of each consumer as bars; what is unknown has none, and says so where it is pointed at."""
    if budget is None or not is_known(budget):
        return None
    rows = [one for one in budget.consumers if one.mean]
    bars = {
        "type": "bar",
        "orientation": "h",
        "x": numbers(0.0 if isnan(one.mean) else one.mean for one in rows),
        "y": [plain(one.name) for one in rows],
        "customdata": ["unknown" if isnan(one.mean) else f"{one.mean:.4g} W".replace("-", "−") for one in rows],
        "name": "mean power",
        "showlegend": False,
        "marker": {"color": "blue"},
        "text": ["unknown" if isnan(one.mean) else "" for one in rows],
        "textposition": "outside",
        "hovertemplate": "%{y}: %{customdata}<extra></extra>",
    }
    layout = {
        "height": 90 + _ROW * len(rows),
        "hovermode": "closest",
        "xaxis": {"title": {"text": "mean power (W)"}},
        "yaxis": {"autorange": "reversed", "type": "category"},
    }
    return figure([bars], layout)


def charge_plot(budget: EnergyBudget | None) -> Plot | None:
    """The charge from full on, until what is required and what there is have ended; what may not be used is marked."""
    if budget is None or not is_known(budget):
        return None
    time, charge = charge_over_mission(budget, shown_until(budget))
    hours = from_si(time, "h", "time")
    data = [line(hours, 100.0 * charge, "charge", "blue",
                 hovertemplate="%{y:.4~r} % after %{x:.4~r} h<extra></extra>")]  # fmt: skip
    if not isnan(budget.required):
        end = float(from_si(budget.required, "h", "time"))
        data.append(line([end, end], [0.0, 100.0], "required", "grey", "3px,3px", hoverinfo="skip"))
    if budget.usable < 1.0:
        least = 100.0 * (1.0 - budget.usable)
        data.append(line([0.0, float(hours[-1])], [least, least], "may not be used", "vermillion", "8px,3px",
                         hoverinfo="skip"))  # fmt: skip
    layout = {
        "height": 260,
        "hovermode": "closest",
        "xaxis": {"title": {"text": "time (h)"}, "range": [0.0, 1.02 * float(hours[-1])]},
        "yaxis": {"title": {"text": "charge (%)"}, "range": [0.0, 103.0]},
    }
    return figure(data, layout)


# -- Power of all axes over time that can be moved: what each draws, stacked, and below zero what each returns.


_PIECES = 1000  # finer than a screen
_NOTHING = 1e-6  # of the largest power: what rounding leaves
_SHAPES = {"////": "/", "....": ".", "\\\\\\\\": "\\", "xxxx": "x", "----": "-", "++++": "+"}  # of plotly, by hatch


def power_plot(power: MachinePower) -> Plot | None:
    """Layers of the axes over each other; one that is hidden leaves the others where they add up without it."""
    course = power.course(_PIECES)
    found = layers(power, course)
    if not found:
        return None
    largest = max(float(one.drawn.max(initial=0.0)) for one in found)
    unit, least = power_unit(largest), _NOTHING * largest
    data = [trace for layer, look in zip(found, LOOKS, strict=False)
            for trace in _stacked(layer, look, course.time, unit, least)]  # fmt: skip
    if not np.isnan(course.total).any():
        total = _ends(course.total, unit)
        data.append(line(course.time, total, "out of the source", "ink", hovertemplate=_power_hover("y", unit)))
        data[-1]["line"] |= {"shape": "hv", "width": 1.4}
    layout = rows([f"power ({label(unit)})"], height=320.0)
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": numbers((course.time[0], course.time[-1]))}
    layout["xaxis"]["hoverformat"] = ".4~r"
    return figure(data, layout)


def _stacked(layer: Layer, look: tuple[str, str], time: Array, unit: str, least: float) -> list[Plot]:
    """Traces of a layer: drawn and returned power on a stack of their own, the difference where it is pointed at."""
    colour, hatch = look
    net = layer.drawn - layer.returned
    said = {"customdata": numbers(_ends(np.where(np.abs(net) > least, net, 0.0), unit), 4),
            "hovertemplate": _power_hover("customdata", unit)}  # fmt: skip
    made = []
    for stack, values, hover in (("drawn", layer.drawn, said), ("returned", -layer.returned, {"hoverinfo": "skip"})):
        trace = line(time, _ends(values, unit), layer.name, colour, stackgroup=stack, fillcolor=colour, **hover)
        trace["line"] |= {"shape": "hv", "width": 0.6}
        if hatch:
            trace["fillpattern"] = {"shape": _SHAPES[hatch], "bgcolor": colour, "fgcolor": "page", "size": 7,
                                    "solidity": 0.15}  # fmt: skip
        made.append(trace)
    return made


def _ends(values: Array, unit: str) -> Array:
    """Means of pieces at the ends of these, the last one held."""
    return np.asarray(from_si(np.append(values, values[-1:]), unit, "power"))


def _power_hover(value: str, unit: str) -> str:
    return f"%{{{value}:.4~r}} {label(unit)}<extra>%{{fullData.name}}</extra>"
