"""The closed loop over time, the frequency response of its loops, and their answers to a step."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from drivesizer.control.loop_records import Loop
from drivesizer.control.validation import Validation
from drivesizer.output.loop_table import cell, loop_figures, loop_name, settled
from drivesizer.output.report.figures.bode_and_step import curve_of, look_of, span
from drivesizer.output.report.figures.load_and_loop import LINEAR, closed_loop_rows
from drivesizer.output.report.figures.time_strips import windows
from drivesizer.output.report.html.curves import Plot, dashes, figure, line, numbers, plain, rows, sampled, whole
from drivesizer.output.thinning import curve_points
from drivesizer.units import from_si, label

__all__ = ["bode_plot", "closed_loop_plot", "step_plots"]

_SYMBOLS = {"s": "square", "o": "circle", "^": "triangle-up", "D": "diamond"}  # of plotly, by matplotlib's marks
_RANGE = 60.0  # dB: what is seen at first, up and down
_MOST = 400  # points of a frequency response, samples of an answer


def closed_loop_plot(validation: Validation) -> Plot:
    """Reference and speed, errors, current, voltage and winding over one axis of time; at first the first change."""
    series, found = validation.series, closed_loop_rows(validation)
    time, views = series["time"], windows(series)
    data = [trace for place, (names, _) in enumerate(found, 1) for trace in _over_time(validation, names, place)]
    units = [label(validation.series_units[names[-1]][1]) for names, _ in found]
    layout = rows([f"{title} ({unit})" for (_, title), unit in zip(found, units, strict=True)], height=118.0)
    layout["xaxis"] |= {"title": {"text": "time (s)"}, "range": [views[0].start, views[0].end]}
    return figure(data, layout, [*views, whole(time)] if len(views) > 1 else [])


def _over_time(validation: Validation, names: tuple[str, ...], place: int) -> list[Plot]:
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
    kept = curve_points((loop.bode.open_magnitude, loop.bode.closed_magnitude), _MOST)
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
    kept = curve_points((values,), _MOST)
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
