"""Figures over time: motion, load, current and voltage, heat, energy, closed loop, a set at the bench."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.load_cases import load_cycle, profile_of
from drivesizer.load_cases.platform import trajectory_of
from drivesizer.loads.motions import SPEED, Track, Trapezoid, Waypoints
from drivesizer.machine.set_cycle import SetCycle, WarmUp
from drivesizer.machine.supply_power import EnergyFlow
from drivesizer.output.report.figures import picture, style
from drivesizer.output.report.figures.picture import Bar, Bars, Curve, Diagram, Plot
from drivesizer.output.report.figures.style import CASES, COLOURS, Drawing, Window, figure, placed, reads
from drivesizer.physics.load_cycle import LoadCycle, end_times
from drivesizer.results.identification import Trace
from drivesizer.results.prediction import Band, Movement, Prediction
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.figure import Figure


Array = NDArray[np.float64]


# -- The motion of a cycle: speed over time, of a platform on a path its velocities along the floor and its turning.


_STILL = 1e-6  # of the largest speed: what a platform never does
_NARROWEST = 0.2  # of a phase that is drawn, as a share of the cycle


def motion(spec: RobotSpec) -> Plot:
    """The speed of the spec over one cycle, to scale; of a recorded load that of the driven shaft."""
    if isinstance(spec.motion, Track | Waypoints):
        return _platform_motion(spec)
    if spec.motion is None:
        cycle = load_cycle(spec)
        time, speed, (kind, unit) = cycle.time.ravel(), cycle.speed.ravel(), SPEED["rotary"]
    else:
        required, (kind, unit) = profile_of(spec), SPEED[spec.load.axis]
        time, speed = np.array(required.time) - required.time[0], np.array(required.speed)
    curve = Curve(name="speed", x=time, y=from_si(speed, unit, kind), width=1.6, listed=False)
    return picture.over_time(Diagram(name="speed", unit=unit, curves=[curve], zero=True),
                             windows=style.windows(time, speed))  # fmt: skip


def _platform_motion(spec: RobotSpec) -> Plot:
    """Without what the platform never does, such as going sideways."""
    path = trajectory_of(spec)
    assert path is not None
    (forwards, left, turning), _ = path.in_robot()
    time, largest = path.time.ravel(), max(float(np.abs(component).max()) for component in (forwards, left))
    along = [
        Curve(name=name, x=time, y=values.ravel(), colour=colour, dashes=dashes)
        for name, values, colour, dashes in (("forwards", forwards, "blue", "solid"),
                                             ("to the left", left, "vermillion", picture.DASHED))
        if np.abs(values).max() > _STILL * largest
    ]  # fmt: skip
    around = Curve(name="turning", x=time, y=from_si(turning.ravel(), "deg/s", "rotary_speed"), colour="green",
                   listed=False)  # fmt: skip
    return picture.over_time(
        Diagram(name="speed", unit="m/s", curves=along, zero=True),
        Diagram(name="turning", unit="deg/s", curves=[around], zero=True), windows=(),
    )  # fmt: skip


def speed_profile(spec: RobotSpec) -> Drawing:
    """The motion as paper has it: a trapezoid by its phases, any other to scale."""
    if isinstance(spec.motion, Trapezoid):
        return _phases(spec.motion, spec.load.axis)
    return picture.on_paper(motion(spec))


@figure
def _phases(figure: Figure, motion: Trapezoid, axis: str) -> None:
    """A trapezoid with its phases marked; short ones are drawn wider than to scale, so that each has its name."""
    ((axes,),) = placed(figure, 1.45)
    kind, unit = SPEED[axis]
    up, cruise, down, reached = motion.phases
    top = float(from_si(reached, unit, kind))
    phases = [("acceleration", up, top), ("cruise", cruise, top),
              ("deceleration", down, 0.0), ("rest", motion.rest_time, 0.0)]  # fmt: skip
    phases = [phase for phase in phases if phase[1] > 0]
    if motion.there_and_back:
        phases += [(name, duration, -end) for name, duration, end in phases]
    total = sum(duration for _, duration, _ in phases)
    edges = [0.0, *np.cumsum([max(duration / total, _NARROWEST) for _, duration, _ in phases])]
    times = [0.0, *np.cumsum([duration for _, duration, _ in phases])]
    span, low = (2.0 * top, -1.08 * top) if motion.there_and_back else (top, 0.0)
    for (name, duration, _), left, right in zip(phases, edges, edges[1:], strict=False):
        axes.text((left + right) / 2, top + 0.2 * span, f"{name}\n{duration:g} s", ha="center", va="center", fontsize=7)
    for edge in edges:
        axes.axvline(edge, color=COLOURS["grey"], linewidth=0.5, linestyle=(0, (4, 3)))
    axes.plot(edges, [0.0, *(end for *_, end in phases)], color=COLOURS["blue"], linewidth=1.6)
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xticks(edges, [f"{time:g}" for time in times])
    axes.set(xlim=(0, edges[-1]), ylim=(low, top + 0.4 * span))
    axes.set(xlabel="time (s), phases not to scale", ylabel=reads("speed", unit))


# -- Quantities of load cases over time: a row each, or for each driven wheel or case small diagrams beside each other.


MOST_WHEELS = 8  # rows of a figure
TOGETHER = 2  # load cases that one diagram shows apart; more are drawn one by one
_IN_SIGHT = 3.0  # times what is drawn: a limit beyond is named and not drawn


def load(cycles: Sequence[tuple[str, LoadCycle]]) -> Plot:
    """Torque and speed of the driven shaft over the cycle, of one load case or of several."""
    unit = style.torque_unit(max(float(np.abs(cycle.torque).max()) for _, cycle in cycles))
    diagrams = []
    for name, kind, of in (("torque", "torque", unit), ("speed", "rotary_speed", "rpm")):
        curves = [_of_case(n, case, cycle.time.ravel(), from_si(getattr(cycle, name).ravel(), of, kind))
                  for n, (case, cycle) in enumerate(cycles)]  # fmt: skip
        diagrams.append(Diagram(name=name, unit=of, curves=curves, zero=True))
    return picture.over_time(*diagrams, windows=stretches(cycles))


def _of_case(number: int, name: str, time: Array, values: Array) -> Curve:
    """A load case in its colour and dashes; those beyond the first few the page shows when they are selected."""
    colour, dashes = CASES[number % len(CASES)]
    return Curve(name=name or "load cycle", x=time, y=values, colour=colour, dashes=dashes, first=number < len(CASES))


def stretches(cycles: Sequence[tuple[str, LoadCycle]]) -> list[Window]:
    """Stretches that are drawn: where something changes, if at the same times in all cases; else the whole time."""
    windows = []
    for _, cycle in cycles:
        columns = (cycle.speed.ravel(), cycle.torque.ravel())
        steps = sum(np.abs(np.diff(x)) / (np.abs(x).max() or 1.0) for x in columns)
        changes = np.append(0.0, np.cumsum(steps))
        windows.append(style.windows(cycle.time.ravel(), changes))
    if all(window == windows[0] for window in windows):
        return windows[0]
    return [Window("", 0.0, max(cycle.total for _, cycle in cycles))]


Limits = Sequence[tuple[str, float]]  # name and figure [SI]


def demand(cases: Sequence[tuple[str, SetCycle]], currents: Limits, voltages: Limits) -> Plot:
    """Current and voltage of each moment by the drive model, with the winding as warm as it then is, and limits."""
    rows: list[list[Curve]] = [[], []]
    for n, (name, case) in enumerate(cases[:MOST_WHEELS]):
        d, p = case.drive, case.pieces
        current, speed, rise = (np.stack(x, axis=1) for x in ((p.I_0, p.I_1), (p.w_0, p.w_1), (p.rise_0, p.rise_1)))
        voltage = d.emf * speed + (d.R + d.R_rise * rise) * current
        for curves, values in zip(rows, (current, voltage), strict=True):
            curves.append(_of_case(n, name, end_times(p.duration).ravel(), values.ravel()))
    diagrams = [_limited(name, unit, curves, limits) for name, unit, curves, limits in
             (("current", "A", rows[0], currents), ("voltage", "V", rows[1], voltages))]  # fmt: skip
    return picture.over_time(*diagrams, windows=stretches([(name, case.cycle.load_cycle) for name, case in cases]))


def _limited(name: str, unit: str, curves: Sequence[Curve], limits: Limits) -> Diagram:
    """A diagram with its known limits, those in sight on its axis."""
    values = np.concatenate([curve.y for curve in curves])
    low, high = min(float(np.nanmin(values)), 0.0), max(float(np.nanmax(values)), 0.0)
    known = [limit for limit in limits if np.isfinite(limit[1])]
    top = max([high, *(value for _, value in known if value <= _IN_SIGHT * max(high, -low))])
    beyond = any(value > top for _, value in known)  # room for the names of limits
    ends = low - 0.07 * (top - low) * (low < 0.0), top + (0.28 if beyond else 0.15) * (top - low or 1.0)
    return Diagram(name=name, unit=unit, curves=curves, zero=True, levels=known, ends=ends)


_ROW, _NAME = 0.6, 0.19  # in, of a small diagram and of the name above it


@figure
def each_over_time(figure: Figure, plot: Plot) -> None:
    """Two quantities of each load case beside each other as small diagrams; an axis for all of each."""
    strip, count = style.strip(plot.windows), min(len(plot.diagrams[0].curves), MOST_WHEELS)
    names = _NAME if any(diagram.levels for diagram in plot.diagrams) else 0.0
    height = (_ROW + _NAME) * count + 0.46 + names
    grid = placed(figure, height, count, 2, top=_NAME + 0.04 + names, gaps=(_NAME, 0.62), shared=False)
    for column, (diagram, colour) in enumerate(zip(plot.diagrams, ("vermillion", "blue"), strict=True)):
        values = np.concatenate([curve.y for curve in diagram.curves[:count]])
        low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
        room = 0.07 * (high - low) or 1.0
        ends = diagram.ends or (low - room * (low < 0.0), high + room)
        for row, curve in enumerate(diagram.curves[:count]):
            axes = grid[row][column]
            alone = replace(curve, colour=colour, dashes="solid", listed=False)
            picture.draw(axes, replace(diagram, curves=[alone], levels=(), ends=ends), strip)
            style.across(axes, strip)
            for (name, value), dashes in zip(diagram.levels, style.LIMITS, strict=False):
                if value <= ends[1]:
                    axes.axhline(value, color="black", linewidth=0.7, linestyle=dashes,
                                 label=f"{name} {value:.4g} {label(diagram.unit)}")  # fmt: skip
            axes.tick_params(labelbottom=row == count - 1)
            axes.set_title(f"{style.named(curve.name)}: {reads(diagram.name, diagram.unit)}", pad=2.5)
            axes.set_ylabel("")
        grid[-1][column].set_xlabel("time (s)")
    if names:
        left, right = (axes.get_legend_handles_labels() for axes in grid[0])
        style.heading(figure, [*left[0], *right[0]], [*left[1], *right[1]], 4)


# -- The closed loop.


LINEAR = "python-control"  # the linear model's trace
_ROWS = (  # columns of the series, and how the axis is called
    (("speed_reference", "speed"), "speed"),
    (("error",), "speed error"),
    (("position_error",), "position error"),
    (("load_angle",), "load angle"),
    (("current",), "current"),
    (("voltage",), "voltage"),
    (("winding_temperature",), "winding temperature"),
)


def closed_loop_rows(validation: Validation) -> list[tuple[tuple[str, ...], str]]:
    """Rows of the figure of the closed loop: columns of the series that are there and known, and their title.

    A winding whose temperature is not known, or is not to move, is kept at one: there is nothing to show then.
    """
    series = validation.series
    known = {name for name, values in series.items() if np.isfinite(values).any()}
    if np.ptp(series.get("winding_temperature", np.zeros(1))) == 0.0:
        known -= {"winding_temperature"}
    return [row for row in _ROWS if known.issuperset(row[0])]


def closed_loop(validation: Validation) -> Plot:
    """Reference and speed, errors, current, voltage and winding over the moments in which something changes.

    In layers: reference and linear model hardly differ from the speed.
    """
    series, linear, rows = validation.series, validation.linear.series if validation.linear else {}, []
    for names, title in closed_loop_rows(validation):
        kind, unit = validation.series_units[names[-1]]
        curves = [Curve(name=names[-1].replace("_", " "), x=series["time"], y=from_si(series[names[-1]], unit, kind),
                        width=1.4, listed=len(names) > 1)]  # fmt: skip
        if names[-1] in linear:
            curves.append(Curve(name=LINEAR, x=linear["time"], y=from_si(linear[names[-1]], unit, kind),
                                colour="orange", dashes=(0, (5, 2.5)), width=0.9))  # fmt: skip
        if len(names) > 1:
            curves.append(Curve(name="reference", x=series["time"], y=from_si(series[names[0]], unit, kind),
                                colour="ink", dashes=(0, (1, 2.5)), width=1.3))  # fmt: skip
        rows.append(Diagram(name=title, unit=unit, curves=curves, height=0.62))
    return picture.over_time(*rows, windows=style.windows(series["time"], series["speed_reference"]),
                             columns=3)  # fmt: skip


# -- Temperatures of winding and housing from cold, and over the cycle that repeats.


def time_unit(longest: float) -> str:
    """The unit in which times up to some length are shown [s]."""
    return "s" if longest < 600.0 else "min" if longest < 36_000.0 else "h"


def _celsius(kelvin: Any) -> Any:
    return from_si(kelvin, "degC", "temperature")


def temperatures(warming: WarmUp, ambient: float, permitted: float) -> list[Plot]:
    """The way from cold, with the winding in each cycle as a band, and one cycle of those that repeat."""
    limits = [(name, _celsius(x)) for name, x in (("ambient", ambient), ("permitted", permitted)) if x == x]
    rise = np.nanmax([permitted, warming.peak]) - ambient
    ends = _celsius(ambient) - 0.04 * rise, _celsius(ambient) + 1.16 * rise

    def plot(title: str, across: str, time: Array, unit: str, curves: Sequence[Curve]) -> Plot:
        diagram = Diagram(name="temperature", unit="degC", curves=curves, levels=limits, ends=ends)
        return Plot(diagrams=[diagram], across=across, unit=unit, ends=(0.0, float(time[-1])), title=title)

    unit, repeats = time_unit(warming.time[-1]), warming.in_cycle
    time = from_si(warming.time, unit, "time")
    steps, band = np.repeat(time, 2)[1:-1], [np.repeat(_celsius(x), 2) for x in (warming.lowest, warming.highest)]
    way = [Curve(name="winding, in each cycle", x=np.concatenate([steps, steps[::-1]]), filled=0.4,
                 y=np.concatenate([band[0], band[1][::-1]]), colour="vermillion"),
           Curve(name="housing", x=time, y=_celsius(warming.housing), dashes=picture.DASHED)]  # fmt: skip
    of, cycle = time_unit(repeats[-1]), list[Curve]()
    for name, values, colour, dashes in (("winding", warming.winding_in_cycle, "vermillion", "solid"),
                                         ("housing", warming.housing_in_cycle, "blue", picture.DASHED)):  # fmt: skip
        rows = style.thinned(repeats, values, Window("", 0.0, float(repeats[-1])))
        cycle.append(Curve(name=name, x=from_si(repeats[rows], of, "time"), y=_celsius(values[rows]), colour=colour,
                           dashes=dashes))  # fmt: skip
    cycle.append(Curve(name=f"peak {_celsius(warming.peak):.1f} °C", x=[from_si(warming.peak_time, of, "time")],
                       y=[_celsius(warming.peak)], colour="vermillion", mark="o", joined=False))  # fmt: skip
    time_in_cycle = from_si(repeats, of, "time")
    return [plot("from cold", "time from cold", time, unit, way),
            plot("over the cycle that repeats", "time in the cycle", time_in_cycle, of, cycle)]  # fmt: skip


# -- Measured against model over time: figures of a log.


_POINTS = 3000  # of a curve


def measured_and_model(time: Array, traces: Sequence[Trace]) -> Plot:
    """Each quantity of a log as it was measured and as the model has it."""
    apart = np.diff(time)
    usual = float(np.median(apart)) if len(apart) else 1.0
    along = np.concatenate([[0.0], np.cumsum(np.where((apart > 0.0) & (apart < 20.0 * usual), apart, usual))])
    thinned = slice(None, None, max(1, len(along) // _POINTS))

    def curves(trace: Trace) -> list[Curve]:
        lines = [
            ("measured", trace.measured, "grey", "solid", 1.4),
            ("model", trace.modelled, "vermillion", picture.DASHED, 1.0),
        ]
        return [Curve(name=name, x=along[thinned], y=from_si(y, trace.unit, trace.kind)[thinned], colour=colour,
                      dashes=dashes, width=width) for name, y, colour, dashes, width in lines]  # fmt: skip

    diagrams = [Diagram(name=trace.name, unit=trace.unit, curves=curves(trace), height=1.3) for trace in traces]
    return Plot(diagrams=diagrams, across="time", unit="s", ends=(0.0, float(along[-1])))


# -- A set at the bench.


def bench(prediction: Prediction) -> list[Plot]:
    """Speed over torque; temperatures over time at the load and while holding; a machine at full voltage, its swing.

    Nominal courses are lines, 5 to 95 % are areas.
    """
    unit = style.torque_unit(float(prediction.torque[-1]))
    across = from_si(prediction.torque, unit, "torque")
    speed = Diagram(name="speed", unit="rpm", whole=True,
                    curves=[*_banded(across, prediction.speed, "rpm", "rotary_speed", colour="green")])  # fmt: skip
    plots = [Plot(diagrams=[speed], across="torque", unit=unit, ends=(0.0, float(across[-1])), title="at full voltage")]
    hottest = [float(np.nanmax(course.winding.p95)) for course in prediction.courses] + [prediction.limit]
    ends = _celsius(prediction.conditions.ambient) - 2.0, _celsius(np.nanmax(hottest)) + 8.0
    limits = [("permitted", _celsius(prediction.limit))] if prediction.limit == prediction.limit else []
    for name, title in (("work", "winding, running at the load"), ("hold", "winding, holding")):
        courses, curves = [course for course in prediction.courses if course.name.startswith(name)], list[Curve]()
        longest = max((float(course.time[-1]) for course in courses), default=1.0)
        of = time_unit(longest / 6.0)
        for course in courses:
            start = course.name.rsplit("_", 1)[1]
            colour, dashes = {"cold": ("blue", "solid"), "warm": ("vermillion", picture.DASHED)}[start]
            curves += _banded(from_si(course.time, of, "time"), course.winding, "degC", "temperature",
                              f", from {start}", colour=colour, dashes=dashes)  # fmt: skip
        diagram = Diagram(name="temperature", unit="degC", curves=curves, levels=limits if courses else (),
                          ends=ends if courses else None)  # fmt: skip
        plots.append(Plot(diagrams=[diagram], across="time", unit=of, ends=(0.0, float(from_si(longest, of, "time"))),
                         title=title if courses else f"{title}: unknown"))  # fmt: skip
    return [*plots, *(plot for movement in prediction.movements for plot in _moving(movement))]


def _moving(movement: Movement) -> Iterator[Plot]:
    """A machine from rest: position, speed and current over time; of a swing the position."""
    of = time_unit(float(movement.time[-1]) / 6.0)
    along, travel = (
        from_si(movement.time, of, "time"),
        ("length", "m") if movement.axis == "linear" else ("angle", "deg"),
    )
    courses, title = {"position": (movement.position, *travel)}, "let go, terminals open"
    if movement.name == "start":
        courses |= {"speed": (movement.speed, *SPEED[movement.axis]), "current": (movement.current, "current", "A")}
        title = "from rest at full voltage"
    for name, (band, kind, unit) in courses.items():
        curves = [*_banded(along, band, unit, kind, colour="green")]
        diagram = Diagram(name=name, unit=unit, curves=curves, whole=name != "position")
        yield Plot(diagrams=[diagram], across="time", unit=of, ends=(0.0, float(along[-1])), title=title)


def _banded(along: Array, band: Band, unit: str, kind: str, name: str = "", **look: Any) -> Iterator[Curve]:
    """A nominal course as a line, and the area of 5 to 95 % around it."""
    low, nominal, high = (from_si(np.asarray(x), unit, kind) for x in (band.p5, band.nominal, band.p95))
    known = np.isfinite(low + high)
    yield Curve(name=f"5 to 95 %{name}", x=np.concatenate([along[known], along[known][::-1]]), filled=0.18,
                y=np.concatenate([low[known], high[known][::-1]]), colour=look["colour"])  # fmt: skip
    yield Curve(name=f"nominal{name}", x=along, y=nominal, **look)


# -- Flow of the energy of a cycle, as bars that follow one another from the energy drawn down to nothing.


_SMALLEST = 1e-6  # of what is drawn: less is none, or the rounding of a trajectory
_INTO = (  # parts that the energy goes into, and their looks
    ("resistance of the supply", "supply", "loss"), ("controllers", "controller", "loss"),
    ("brake, released", "brake", "loss"), ("copper of the winding", "copper", "loss"),
    ("friction and iron of the motor", "friction", "loss"), ("gearhead", "gearhead", "loss"), ("belt", "belt", "loss"),
    ("work on the load", "load", "pass"), ("more in rotor and gear at the end", "rotor", "pass"),
    ("regenerated, kept by the supply", "stored", "back"), ("regenerated, not kept", "burnt", "loss"),
)  # fmt: skip


def energy_bars(flow: EnergyFlow) -> Bars:
    """The energy of a cycle: each bar begins where the one above it ends, the last one ends at nothing."""
    size, left = max(flow.drawn, abs(flow.load)), flow.drawn
    parts = [(name, getattr(flow, of), look) for name, of, look in _INTO]
    parts = [part for part in parts if abs(part[1]) > _SMALLEST * size]
    largest = max(flow.drawn, *(abs(value) for _, value, _ in parts))
    unit = "J" if largest < 1e3 else "kJ" if largest < 1e6 else "MJ"

    def in_unit(value: float) -> float:
        return float(from_si(value, unit, "energy"))

    rows = [
        Bar(
            "drawn from the supply", in_unit(flow.drawn), look="drawn", label=f"{in_unit(flow.drawn):.4g} {label(unit)}"
        )
    ]
    for name, value, look in parts:
        low, high = sorted((in_unit(left - value), in_unit(left)))
        share = f", {100.0 * value / flow.drawn:.3g} %" if flow.drawn > 0.0 else ""
        text = f"{in_unit(value):.4g} {label(unit)}{share}".replace("-", "−")
        rows.append(Bar(name, high, low, look, text))
        left -= value
    return Bars(rows=rows, across="energy of a cycle", unit=unit, sides=(2.0, 1.25))
