"""Figures that move as plain data: numbers, traces, legends, axes; and the curves of one part."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from math import isnan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import HELD, Discharges
from drivesizer.catalog.query import Hit
from drivesizer.machine.battery import Pack, pack_of, run_time
from drivesizer.machine.part_curves import gear_efficiency, nominal_voltage_curves
from drivesizer.output.part import pull_out_conditions, reach_of, speed_torque
from drivesizer.output.report.figures.style import Window, thinned, torque_unit
from drivesizer.physics.stepper import PULL_OUT_SHARE, pull_out_torque, rotor_teeth
from drivesizer.spec.battery import Battery
from drivesizer.units import from_si, label, show

# -- Pieces of interactive figures as plain data: numbers, traces, legends, rows of axes.
#
# A figure is what plotly.js draws (``data`` and ``layout``) with a legend and stretches to look at, which the page
# shows as buttons. Colours are names: the page has their values, in light and in dark. Whatever plotly would read as
# markup is escaped here.


Plot = dict[str, Any]


def numbers(values: Iterable[float], digits: int = 6) -> list[float | None]:
    """Values as JSON has them: to so many digits, None where unknown.

    Examples
    --------
    >>> numbers([1.23456789, float("nan")])
    [1.23457, None]
    """
    return [float(f"{value:.{digits}g}") if math.isfinite(value) else None for value in values]


def plain(text: str) -> str:
    """A text that plotly shows letter by letter, in names, titles and hovers.

    >>> plain("<b>R & D</b>")
    '&lt;b&gt;R &amp; D&lt;/b&gt;'
    """
    return escape(text, quote=False)


def dashes(pattern: Any) -> str:
    """Dashes of a print figure as plotly and SVG write them.

    >>> dashes((0, (5, 2))), dashes("solid")
    ('8px,3px', 'solid')
    """
    return pattern if isinstance(pattern, str) else ",".join(f"{max(1.6 * x, 1.5):.0f}px" for x in pattern[1])


def whole(time: NDArray[np.float64]) -> Window:
    """All of a record."""
    return Window("all", float(time[0]), float(time[-1]))


def sampled(
    time: NDArray[np.float64], columns: Sequence[NDArray[np.float64]], stretches: Sequence[Window]
) -> NDArray[np.int64]:
    """Rows of a record to draw: peaks and troughs of all of it, and finer in the stretches to be looked at."""
    kept = [thinned(time, column, window) for column in columns for window in (whole(time), *stretches)]
    found: NDArray[np.int64] = np.unique(np.concatenate(kept))
    return found


def line(x: Iterable[float], y: Iterable[float], label: str, colour: str, dash: str = "solid", **more: Any) -> Plot:
    """A trace."""
    return {
        "type": "scatter",
        "mode": "lines",
        "x": numbers(x, 8),
        "y": numbers(y),
        "name": plain(label),
        "legendgroup": label,
        "line": {"color": colour, "dash": dash, "width": 1.8},
    } | more


def rows(titles: Sequence[str], height: float = 150.0) -> Plot:
    """A layout of diagrams below one another over one axis, each with its title above it."""
    count, room = len(titles), 26.0
    total = count * (height + room)
    layout: Plot = {
        "height": round(total + _BELOW),
        "annotations": [],
        "hoversubplots": "axis",
        "hovermode": "x unified",
    }
    for number, title in enumerate(titles):
        top = 1.0 - (number * (height + room) + room) / total
        axis = "yaxis" if number == 0 else f"yaxis{number + 1}"
        layout[axis] = {"domain": [max(top - height / total, 0.0), top], "anchor": "x"}
        layout["annotations"].append(above(plain(title), top))
    layout["xaxis"] = {"anchor": "y" if count == 1 else f"y{count}", "showspikes": True}
    return layout


_BELOW = 46  # px: numbers and title of the lowest axis


def above(text: str, height: float = 1) -> Plot:
    """The title of an upright axis, above its upper end."""
    return {"text": text, "x": 0, "y": height, "xref": "paper", "yref": "paper", "xanchor": "left", "yanchor": "bottom",
            "showarrow": False}  # fmt: skip


def figure(data: Sequence[Plot], layout: Plot, views: Sequence[Window] = ()) -> Plot:
    """A figure with its legend and, where there are several, the stretches that it can be looked at in."""
    entries: dict[str, Plot] = {}
    for number, trace in enumerate(data):
        if trace.get("showlegend") is False:
            continue
        entry = entries.setdefault(trace["legendgroup"], _entry(trace))
        entry["traces"].append(number)
    return {
        "data": list(data),
        "layout": layout,
        "legend": list(entries.values()) if len(entries) > 1 else [],
        "views": [_view(v, layout["xaxis"]["range"]) for v in views] if len(views) > 1 else [],
    }


def _view(stretch: Window, seen: Sequence[float]) -> Plot:
    ends = numbers((stretch.start, stretch.end))
    return {"title": stretch.title, "range": ends, "shown": ends == numbers(seen)}


def _entry(trace: Plot) -> Plot:
    marker = trace.get("marker", {})
    drawn = "lines" in trace["mode"]
    return {
        "label": trace["legendgroup"],
        "colour": trace["line"]["color"] if drawn else marker["color"],
        "dash": trace["line"]["dash"] if drawn else "",
        "filled": trace.get("fill") == "toself",
        "stacked": "stackgroup" in trace,
        "hatch": trace.get("fillpattern", {}).get("shape", ""),
        "mark": marker.get("symbol", "") if not drawn else "",
        "shown": trace.get("visible", True) is True,
        "traces": [],
    }


# -- Curves of one part out of the catalogue: what a motor, gearhead, stepper or battery does, as figures that move.


Array = NDArray[np.float64]
_POINTS = 121
_SUPPLIES = (24.0, 48.0)  # V, of a stepper without a printed curve
_USEFUL = 0.15  # of its torque at rest
_LOOKS: dict[str, Any] = {  # of a curve of speed over torque: colour, dashes, mark
    "line": ("blue", "solid", ""), "continuous": ("green", dashes((0, (5, 2))), ""),
    "peak": ("vermillion", dashes((0, (1, 1.5))), ""), "nominal": ("green", "solid", "circle"),
}  # fmt: skip
_COLOURS = ("blue", "vermillion", "green", "purple", "orange", "grey")
_DASHES = ("solid", dashes((0, (5, 2))), dashes((0, (1, 1.5))), dashes((0, (6, 2, 1, 2))))


def part_plots(hit: Hit) -> dict[str, Plot]:
    """Curves of a part that its figures give, by a name, each with the ``title`` that it has."""
    made = _OF.get(hit.section, lambda _: iter(()))(hit)
    return {name: plot | {"title": title} for name, title, plot in made}


Made = Iterator[tuple[str, str, Plot]]  # name, title, figure


def _single_name(data: Sequence[Plot]) -> str:
    """Name of a line that has no legend, for it is alone."""
    return f": {data[0]['legendgroup']}" if len(data) == 1 else ""


def _marks(x: Sequence[float], y: Sequence[float], label: str, colour: str, symbol: str, **more: Any) -> Plot:
    mark = {"symbol": symbol, "size": 8, "color": colour, "line": {"width": 1.6 if "open" in symbol else 0}}
    return line(x, y, label, colour, mode="markers", marker=mark, **more)


def _axes(across: str, up: str, **more: Any) -> Plot:
    """A layout of one diagram."""
    bound = {"title": {"text": plain(across)}, "rangemode": "tozero"}
    return {"height": 340, "hovermode": "closest", "xaxis": bound | more.get("x", {}),
            "yaxis": {"rangemode": "tozero"} | more.get("y", {}), "annotations": [above(plain(up))]}  # fmt: skip


# -- motors and actuators


def _motor(hit: Hit) -> Made:
    """Speed, current and efficiency over one axis of torque."""
    curves, reach = speed_torque(hit), reach_of(hit)
    if not curves or isnan(reach):
        return
    unit, torque = torque_unit(reach), reach * np.linspace(0.0, 1.0, _POINTS) ** 2  # dense where the efficiency rises
    _, current, efficiency = nominal_voltage_curves(hit, torque)
    below = [("current", "A", "vermillion", current)]
    if np.nanmax(efficiency, initial=0.0) <= 1.0:  # else its figures contradict one another
        below.append(("efficiency", "%", "purple", 100.0 * efficiency))
    below = [one for one in below if not np.isnan(one[-1]).all()]
    data = [_speed(kind, name, from_si(np.asarray(torques), unit, "torque"), speeds, unit)
            for kind, name, torques, speeds in curves]  # fmt: skip
    across = from_si(torque, unit, "torque")
    data += [_below(across, *one, number, unit) for number, one in enumerate(below, 2)]
    layout = rows(["speed (rpm)", *(f"{name} ({sign})" for name, sign, *_ in below)], 160.0 if below else 240.0)
    for name in [name for name in layout if name.startswith("yaxis")]:
        layout[name] |= {"rangemode": "tozero"}
    layout["xaxis"] |= {"title": {"text": f"torque ({label(unit)})"}, "range": [0.0, 1.04 * float(across[-1])]}
    names = ", ".join(("Speed", *(name for name, *_ in below)))
    yield "speed-torque", f"{names} over torque at nominal voltage", figure(data, layout | {"hovermode": "closest"})


def _speed(kind: str, name: str, torque: Any, speed: Sequence[float], unit: str) -> Plot:
    colour, dash, symbol = _LOOKS[kind]
    over = f"<b>%{{fullData.name}}</b><br>%{{y:.0f}} rpm, %{{x:.4~r}} {label(unit)}<extra></extra>"
    rpm = from_si(np.asarray(speed), "rpm", "rotary_speed")
    if symbol:
        return _marks(torque, rpm, name, colour, symbol, hovertemplate=over)
    return line(torque, rpm, name, colour, dash, hovertemplate=over)


def _below(torque: Any, name: str, sign: str, colour: str, values: Array, number: int, unit: str) -> Plot:
    over = f"<b>{name}</b><br>%{{y:.3~r}} {sign} at %{{x:.4~r}} {label(unit)}<extra></extra>"
    return line(torque, values, name, colour, hovertemplate=over, yaxis=f"y{number}", showlegend=False)


# -- gearheads


def _gearhead(hit: Hit) -> Made:
    """Efficiency over load where the torque without load is known, and permissible torques of its family over ratio."""
    reach = hit["intermittent_torque"] if hit["intermittent_torque"] > 0.0 else hit["continuous_torque"]
    if reach > 0.0 and not isnan(hit["no_load_torque"] + hit["efficiency"]):
        unit, torque = torque_unit(reach), np.linspace(0.0, reach, _POINTS)[1:]
        trace = line(from_si(torque, unit, "torque"), 100.0 * gear_efficiency(hit, torque), "efficiency", "blue",
                     hovertemplate=f"%{{y:.3~r}} % at %{{x:.4~r}} {label(unit)}<extra></extra>")  # fmt: skip
        across = f"torque at the output ({label(unit)})"
        yield (
            "efficiency",
            "Efficiency over load, as sizing computes it",
            figure([trace], _axes(across, "efficiency (%)")),
        )
    table = hit.table
    family = np.flatnonzero((table["family"] == hit["family"]) & ~table.excluded)
    data = [one for name, words, colour, symbol in _PERMITTED
            for one in _permitted(hit, family, name, words, colour, symbol)]  # fmt: skip
    if data:
        layout = _axes("ratio", "torque at the output (N·m)", x=_LOG)
        yield "torque-ratio", f"Permissible torque in {hit['family']} over ratio", figure(data, layout)


_PERMITTED = (
    ("continuous_torque", "continuous", "blue", "circle"),
    ("intermittent_torque", "intermittent", "vermillion", "square"),
)


def _permitted(hit: Hit, family: NDArray[np.int64], name: str, words: str, colour: str, symbol: str) -> Iterator[Plot]:
    table = hit.table
    known = family[~np.isnan(table[name][family] + table["ratio"][family]) & np.isfinite(table[name][family])]
    if len(np.unique(table["ratio"][known])) < 2:
        return
    over = f"%{{customdata}}<br>%{{y:.4~r}} N·m {words}, ratio %{{x:.4~r}}<extra></extra>"
    yield _marks(table["ratio"][known], table[name][known], words, colour, f"{symbol}-open",
                 customdata=[plain(str(part)) for part in table["part"][known]], hovertemplate=over)  # fmt: skip
    if hit.row in known:
        yield _marks([hit["ratio"]], [hit[name]], f"{hit.part}, {words}", colour, symbol, customdata=[plain(hit.part)],
                     hovertemplate=over)  # fmt: skip


# -- steppers


def _stepper(hit: Hit) -> Made:
    """Pull-out torque over speed: as printed, else of the model with its band."""
    own = hit.catalog.pull_outs.on(hit.catalog.pull_outs.stepper == hit.row)
    unit = torque_unit(hit["holding_torque"]) if hit["holding_torque"] > 0.0 else "N*m"
    over = f"<b>%{{fullData.name}}</b><br>%{{y:.4~r}} {label(unit)} at %{{x:.0f}} rpm<extra></extra>"
    data = []
    for number, curve in enumerate(np.unique(own.curve).tolist()):
        one = own.on(own.curve == curve)
        look = _COLOURS[number % len(_COLOURS)], _DASHES[number % len(_DASHES)]
        data.append(line(from_si(one.speed, "rpm", "rotary_speed"), from_si(one.torque, unit, "torque"),
                         pull_out_conditions(one), *look, mode="lines+markers", hovertemplate=over,
                         marker={"size": 6, "color": look[0]}))  # fmt: skip
    title = f"Pull-out torque as printed{_single_name(data)}"
    if not data:
        data, title = list(_modelled(hit, unit, over)), "Pull-out torque, estimated: no curve is printed"
    if data:
        layout = _axes("speed (rpm)", f"pull-out torque ({label(unit)})")
        yield "pull-out", title, figure(data, layout)


def _modelled(hit: Hit, unit: str, over: str) -> Iterator[Plot]:
    """Share of the ideal model at two supply voltages, and the band of the share."""
    known = {name: hit[name] for name in ("holding_torque", "phase_current", "resistance", "inductance")}
    teeth, (share, band) = rotor_teeth(hit["full_steps"]), PULL_OUT_SHARE
    if isnan(sum(known.values()) + teeth):
        return
    for number, voltage in enumerate(_SUPPLIES):
        end = _last_speed(voltage, known, teeth)
        speed = np.linspace(0.0, end, _POINTS)
        torque = from_si(share * pull_out_torque(speed, voltage, teeth=teeth, **known), unit, "torque")
        rpm, colour = from_si(speed, "rpm", "rotary_speed"), _COLOURS[number]
        name = f"{show(voltage, 'V', 'voltage')} supply, {share:g} of the ideal model"
        most = np.minimum(torque * band, torque / share)  # no more than the model itself
        around = line(np.concatenate([rpm, rpm[::-1]]), np.concatenate([torque / band, most[::-1]]),
                      f"5 to 95 % at {show(voltage, 'V', 'voltage')}", colour, fill="toself", fillcolor=colour,
                      opacity=0.15, hoverinfo="skip")  # fmt: skip
        yield around | {"line": {"color": colour, "dash": "solid", "width": 0}}
        yield line(rpm, torque, name, colour, _DASHES[number], hovertemplate=over)


def _last_speed(voltage: float, known: dict[str, float], teeth: float) -> float:
    """Speed up to which enough of the torque at rest is left to be of use [rad/s]."""
    speed = np.geomspace(1.0, 1e4, 400)
    torque = pull_out_torque(speed, voltage, teeth=teeth, **known)
    left = np.flatnonzero(torque > _USEFUL * torque[0])
    return float(speed[left[-1]]) if len(left) else float(speed[-1])


# -- batteries


def _battery(hit: Hit) -> Made:
    """Run time over current or power: as printed, else by the rule that sizing uses."""
    own = hit.catalog.discharges.on(hit.catalog.discharges.battery == hit.row)
    for held, unit in HELD.items():
        known = own.on(~np.isnan(getattr(own, held)))
        data = [_until(known.on(known.cutoff_voltage == end), held, unit, number)
                for number, end in enumerate(np.unique(known.cutoff_voltage))]  # fmt: skip
        if data:
            layout = _axes(f"constant {held} ({unit})", "run time (h)", x=_LOG, y=_LOG)
            yield (
                f"discharge-{held}",
                f"Run time at constant {held} as printed{_single_name(data)}",
                figure(data, layout),
            )
    if not len(own.time):
        yield from _run_time_rule(hit)


_LOG = {"type": "log", "rangemode": "normal"}


def _until(own: Discharges, held: str, unit: str, number: int) -> Plot:
    """Printed run times down to one voltage."""
    draw = getattr(own, held)
    order, end = np.argsort(draw), show(float(own.cutoff_voltage[0]), "V", "voltage")
    return _lasts(draw[order], own.time[order], f"down to {end}", number, unit)


def _lasts(draw: Array, time: Array, name: str, number: int, unit: str) -> Plot:
    colour = _COLOURS[number % len(_COLOURS)]
    over = f"<b>%{{fullData.name}}</b><br>%{{y:.3~r}} h at %{{x:.4~r}} {unit}<extra></extra>"
    return line(draw, time / 3600.0, name, colour, _DASHES[number % len(_DASHES)], mode="lines+markers",
                marker={"size": 5, "color": colour}, hovertemplate=over)  # fmt: skip


def _run_time_rule(hit: Hit) -> Made:
    """Run time of one cell or block at constant current, where no table is printed."""
    pack = pack_of(Battery(part=hit.part), hit.catalog)
    if pack.law is None:
        return
    most = hit["continuous_current"] if hit["continuous_current"] > 0.0 else 2.0 * pack.capacity / 3600.0
    current = np.geomspace(pack.capacity / (20.0 * 3600.0), most, 41)
    trace = _lasts(current, _run_times(pack, current), pack.rule, 0, "A") | {"mode": "lines"}
    layout = _axes("constant current (A)", "run time (h)", x=_LOG, y=_LOG)
    yield "discharge", f"Run time at constant current, computed: {pack.rule}", figure([trace], layout)


def _run_times(pack: Pack, current: Array) -> Array:
    return np.asarray(run_time(pack, current * pack.mean_voltage))


_OF: dict[str, Any] = {"motors": _motor, "actuators": _motor, "gearheads": _gearhead, "steppers": _stepper,
                       "batteries": _battery}  # fmt: skip
