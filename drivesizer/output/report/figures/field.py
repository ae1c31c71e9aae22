"""The motor's torque-speed field as a figure: voltage lines hot and cold, load cases, efficiency."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as data_field
from math import isnan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer import equations as eq
from drivesizer.machine.operating_field import OperatingField, Operation, field, hot_winding, operation
from drivesizer.machine.set_cycle import SetCycle
from drivesizer.output.report.figures import picture, style
from drivesizer.output.report.figures.cycle import TOGETHER
from drivesizer.output.report.figures.picture import Curve, Diagram, Plot
from drivesizer.output.report.figures.style import CASES, COLOURS, Drawing, figure, named, placed, reads, torque_unit
from drivesizer.physics.cycle_at_gearhead import AT_REST, SPEED
from drivesizer.results.drive_set import DriveSet, Requirement
from drivesizer.results.problem import Problem
from drivesizer.units import from_si, label, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# -- Panels of the motor's field: one for load cases that share its lines, and the paper's points.


Array = NDArray[np.float64]
_FAR = 6.0  # times the continuous torque; an intermittent line beyond would leave the rest no room


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingPoint:
    """A moment of the cycle at the motor shaft."""

    name: str
    torque: float  # N*m
    speed: float  # rad/s


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """Load cases with the same usable voltage and ambient: the motor's lines are the same for all of them."""

    cases: tuple[tuple[int, str, OperatingField], ...]  # number and name; without a name where there is but one
    points: tuple[OperatingPoint, ...] = ()
    times: Mapping[int, Array] = data_field(default_factory=dict)  # s, of the segments of each case


def panels(problem: Problem, drive_set: DriveSet, requirements: tuple[Requirement, ...]) -> list[Panel]:
    """The field of a set's motor with the load cases in it; the paper's points too, where its method is used."""
    alike: dict[tuple[float, float], list[tuple[int, str, OperatingField]]] = {}
    for number, case in enumerate(problem.cases):
        operating = field(case.spec, drive_set)
        alike.setdefault((operating.voltage, operating.ambient), []).append((number, case.name, operating))
    points = paper_points(drive_set, requirements) if problem.spec.method == "paper" else ()
    times = {number: case.cycle.time for number, case in enumerate(problem.cases)}
    return [Panel(cases=tuple(cases), points=points, times=times) for cases in alike.values()]


def leading(panels: Sequence[Panel]) -> Panel:
    """The first panel with as many load cases as one diagram shows: all of them, or the first alone."""
    first = panels[0]
    return first if len(first.cases) <= TOGETHER else replace(first, cases=first.cases[:1])


def alone(panels: Sequence[Panel]) -> list[Panel]:
    """A panel for each load case, where they are more than one diagram shows; else none."""
    single = [replace(panel, cases=(case,), points=()) for panel in panels for case in panel.cases]
    return single if len(panels) > 1 or len(single) > TOGETHER else []


def paper_points(drive_set: DriveSet, requirements: tuple[Requirement, ...]) -> tuple[OperatingPoint, ...]:
    """The operating points of the paper's cycle, every torque brought to the motor as in (18)."""
    of = {r.name: float(r.value) for r in requirements}
    wheels = of["maximum_torque"] / of["maximum_torque_per_motor"]
    torques = {
        "end of acceleration": (of["maximum_torque_per_motor"], of["nominal_speed"]),
        "cruise": (of["nominal_torque_per_motor"], of["nominal_speed"]),
        "start of deceleration": (of["deceleration_torque"] / wheels, of["nominal_speed"]),
        "RMS": (of["rms_torque_per_motor"], of["rms_speed"]),
    }
    chain = {"K_g": drive_set.gearhead.ratio, "eta_gear": drive_set.gearhead.efficiency,
             "i_b": drive_set.belt_ratio, "eta_b": drive_set.belt_efficiency}  # fmt: skip
    return tuple(
        OperatingPoint(
            name=name, torque=float(eq.maximum_torque_at_motor(torque, **chain)), speed=speed * drive_set.total_ratio
        )
        for name, (torque, speed) in torques.items()
        if not isnan(torque + speed + sum(chain.values()))  # unknown is nowhere to be marked
    )


def one_way(speed: Array, torque: Array) -> tuple[Array, Array]:
    """Speed and torque of segments, one way as the other: what brakes is below 0, what holds is not."""
    way = np.sign(speed.mean(1))[:, None]
    return np.abs(speed), np.where(way == 0.0, np.abs(torque), way * torque)


def signed(field: OperatingField) -> tuple[Array, Array]:
    """Speed and torque of the cycle at the motor, one way as the other."""
    return one_way(field.cycle_speed, field.cycle_torque)


def _thinned(speed: Array, torque: Array) -> Array:
    """Segments of a trace that are drawn: so many, and the extremes."""
    extremes = [column.argmax(axis=0) for column in (speed, torque, -torque)]
    return np.unique(np.concatenate([np.arange(0, len(speed), -(-len(speed) // _MOST_SEGMENTS)), *extremes]))


def reach_of(panel: Panel) -> float:
    """The torque to which the axis goes [N*m]: what the drive may do and the cycle requires, seldom as far as stall."""
    first = panel.cases[0][-1]
    required = [float(np.nan_to_num(signed(f)[1]).max()) for *_, f in panel.cases]
    if first.pull_out is not None:
        return max(float(np.nan_to_num(first.pull_out).max()), *required)
    stall = float(np.nan_to_num(first.voltage_cold[0]))
    lines = (first.continuous.max(), np.fmin(first.intermittent.max(), _FAR * first.continuous.max()))
    known = [min(float(x), stall) for x in lines if x == x]
    return max(*known, *required, *(p.torque for p in panel.points), 1e-6) if known else max(stall, *required)


# -- The motor's torque-speed field: voltage lines hot and cold, what is allowed, and the load cases.


MOST_FIELDS = 8
_NAME = 88.0  # pt, of a name above a small diagram
_ABREAST, _SMALL = 2, 1.75  # small diagrams beside each other, and the height of one [in]
_LOWEST = 2.3  # in, of a field
_ROOM = 1.12  # of an axis beyond what must be seen
_HEADROOM = 1.06  # above the highest speed
_SLOWEST = 0.1  # rad/s, highest speed of a diagram at least: a stepper that holds its load has none
_MOST_SEGMENTS = 1500  # of a trace: finer than print
_MARKERS = (("^", "vermillion"), ("s", "grey"), ("v", "purple"), ("D", "blue"))


def conditions(panel: Panel) -> str:
    """Usable voltage and ambient of a panel."""
    lines = panel.cases[0][-1]
    return f"{show(lines.voltage, 'V', 'voltage')} usable, ambient {show(lines.ambient, 'degC', 'temperature')}"


def torque_speed(panel: Panel, *, plain: bool = False) -> Plot:
    """The motor's field, winding hot and cold, with the load cases in it; plain: without figures in the names."""
    first, reach = panel.cases[0][-1], reach_of(panel)
    unit = torque_unit(reach)
    curves = _lines(first, unit, reach, plain=plain)
    for place, (number, name, operating) in enumerate(panel.cases):
        first_shown = place == 0 or len(panel.cases) <= TOGETHER
        colour, dashes = CASES[0 if plain else number % len(CASES)]
        curves += [replace(curve, colour=colour, dashes=curve.dashes and dashes, first=first_shown)
                   for curve in _cycle(operating, "" if plain else name, unit, panel.times.get(number))]  # fmt: skip
    # points with a shape each, named in the legend: labels beside them would overlap where points lie close
    curves += [replace(_dot(f"paper: {point.name}", point.torque, point.speed, unit), mark=mark, hollow=True,
                       colour=colour)
               for point, (mark, colour) in zip(panel.points, _MARKERS, strict=False)]  # fmt: skip
    right = float(from_si(_ROOM * reach, unit, "torque"))
    left = min(0.0, *(np.nan_to_num(signed(f)[1]).min() for *_, f in panel.cases), *(p.torque for p in panel.points))
    top = max(_SLOWEST, first.speed[-1], *(f.speed[-1] for *_, f in panel.cases), *(p.speed for p in panel.points))
    names = len({curve.name for curve in curves}) + sum(bool(curve.detail) for curve in curves)
    field = Diagram(name="motor speed", unit="rpm", curves=curves, ends=(0.0, float(_rpm(_HEADROOM * top))),
                    height=max(_LOWEST, 0.175 * names))  # fmt: skip
    low = _ROOM * float(from_si(left, unit, "torque")) - 0.03 * right
    return Plot(diagrams=[field], across="torque at the motor's shaft", unit=unit, ends=(low, right), legend="right")


def torque_speed_panels(panels: Sequence[Panel]) -> Drawing:
    """The motor's field once for each load case, as small diagrams with one legend."""
    fields = panels[:MOST_FIELDS]
    several, plots = len({conditions(panel) for panel in fields}) > 1, []
    for panel in fields:
        name = named(panel.cases[0][1], _NAME).strip()
        title = f"{name}: {conditions(panel).replace(' usable, ambient', ',')}" if several else name
        plots.append(torque_speed(panel, plain=True).titled(title))
    return picture.abreast(plots, _SMALL, columns=_ABREAST, names=5)


def _rpm(speed: Any) -> Any:
    return from_si(speed, "rpm", "rotary_speed")


def _dot(name: str, torque: float, speed: float, unit: str) -> Curve:
    x, y = float(from_si(torque, unit, "torque")), float(_rpm(speed))
    detail = f"{x:.4g} {label(unit)}, {y:.0f} rpm".replace("-", "−")
    return Curve(name=name, x=[x], y=[y], mark="o", joined=False, dashes="", detail=detail)


def _cycle(field: OperatingField, name: str, unit: str, time: Array | None) -> Iterator[Curve]:
    """The way of a load cycle through the field, and the point of its RMS current and speed."""
    speed, torque = signed(field)
    if np.isnan(torque).any():
        return
    rows, texts = _thinned(speed, torque), list[str]()
    if time is not None:
        power = (speed * torque)[rows].ravel()
        texts = [f"at {at:.6g} s of the cycle, {watts:.4g} W at the shaft".replace("-", "−")
                 for at, watts in zip(time[rows].ravel(), power, strict=True)]  # fmt: skip
    of = f", {name}" if name else ""
    yield Curve(name=f"load cycle{of}", x=from_si(torque[rows].ravel(), unit, "torque"),
                y=_rpm(speed[rows].ravel()), texts=texts, mark="o" if len(rows) <= _EACH_MARKED else "")  # fmt: skip
    if not np.isnan(field.rms_torque):  # of a motor of unknown friction the RMS current is unknown
        yield _dot(f"RMS current and speed{of}", field.rms_torque, field.rms_speed, unit)


_EACH_MARKED = 30  # segments of a cycle


def _lines(field: OperatingField, unit: str, reach: float, *, plain: bool) -> list[Curve]:
    """Limits of the motor: continuous by heat, voltage and speed, by voltage hot and cold, short-time, and by speed."""
    rpm, curves = _rpm(field.speed), list[Curve]()

    def line(name: str, values: Array, colour: str, dashes: Any) -> None:
        if not np.isnan(values).all():
            curves.append(Curve(name=name, x=from_si(values, unit, "torque"), y=rpm, colour=colour, dashes=dashes))

    def region(name: str, low: Array, high: Array, colour: str, opacity: float) -> None:
        outline = from_si(np.concatenate([low, high[::-1]]), unit, "torque")
        curves.append(Curve(name=name, x=outline, y=np.concatenate([rpm, rpm[::-1]]), colour=colour, filled=opacity))

    if field.pull_out is not None:
        line("pull-out torque" if plain else "pull-out torque, lowest supply", field.pull_out, "blue", "solid")
        line(f"1/{field.factor:g} of it", field.pull_out / field.factor, "blue", picture.DASHED)
        return curves
    hot = np.maximum(field.voltage_hot, 0.0)
    if not np.isnan(field.permissible_speed):
        hot = np.where(field.speed > field.permissible_speed, 0.0, hot)
    allowed = np.fmin(np.nan_to_num(field.continuous), hot)
    if not np.isnan(field.continuous).any():
        region("continuous" if field.thermal else "continuous, nominal torque", np.zeros_like(hot), allowed, "blue",
               0.2)  # fmt: skip
    if not np.isnan(for_a_while := np.fmin(field.intermittent, hot)).any():
        region("intermittent", allowed, np.maximum(allowed, for_a_while), "vermillion", 0.11)
    ambient = show(field.ambient, "degC", "temperature", 3)
    for values, word, winding, dashes in ((field.voltage_hot, "hot", hot_winding(field), "solid"),
                                          (field.voltage_cold, "cold", ambient, picture.DASHED)):  # fmt: skip
        text = f"winding {word}" if plain else f"{field.voltage:.3g} V, winding {winding}"
        line(text.replace("-", "−"), np.where(values < 0.0, np.nan, values), "blue", dashes)
    within = np.fmin(field.voltage_cold, _ROOM * reach)  # beyond that it limits nothing, or is not in sight
    line("intermittent", np.where(field.intermittent <= within, field.intermittent, np.nan), "vermillion",
         picture.MIXED)  # fmt: skip
    if field.permissible_speed <= _HEADROOM * field.speed[-1]:
        ends = [0.0, float(from_si(_ROOM * reach, unit, "torque"))]
        curves.append(Curve(name="permissible speed", x=ends, y=[float(_rpm(field.permissible_speed))] * 2,
                          colour="grey", dashes=picture.DOTTED))  # fmt: skip
    return curves


# -- Efficiency of a set over torque and speed at the gearhead's output, with the load cycle in it.


LEVELS = (30, 40, 50, 60, 65, 70, 75, 80, 83, 86, 88, 90, 92, 94, 96)  # %, of the lines that may be drawn
_LEAST, _FEW = 3, 6  # of them: with less, as many even ones as there is room for
_FINE = 48, 56  # points of the field in torque, each way, and in speed
_CROWDED = 1.8  # power by which torques and speeds crowd to 0, where the efficiency changes most
_FAR_BEYOND_CYCLE = 4.0  # times the cycle's torque; a gearhead that is rated for more would leave the cycle no room
_APART = 0.06  # of the field, between the names of lines
_SHADES = ("#FFFFFF", "#CFE3F1")
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
    traces = []
    for name, case in cases:  # at the gearhead's output, one way as the other: what brakes is below 0
        functions = case.cycle.functions
        speed, torque = one_way(functions[:, :, SPEED], functions[:, :, : AT_REST + 1].sum(axis=2))
        rows = _thinned(speed, torque)
        traces.append((name, torque[rows].ravel(), speed[rows].ravel()))
    demand = max(float(np.abs(torque).max()) for _, torque, _ in traces) or 1.0
    rated = float(cases[0][1].gearhead["continuous_torque"][0])
    right = _ROOM * max(demand, min(rated, _FAR_BEYOND_CYCLE * demand) if np.isfinite(rated) else 0.0)
    brakes = min(float(torque.min()) for _, torque, _ in traces)
    left = min(0.0, _ROOM * brakes, -0.35 * right if brakes < 0.0 else 0.0)
    top = _ROOM * (max(float(speed.max()) for *_, speed in traces) or 1.0)
    near = np.linspace(0.0, 1.0, _FINE[0]) ** _CROWDED
    torque = np.concatenate([left * near[:0:-1], right * near[1:]]) if left < 0.0 else right * near[1:]
    speed = top * np.linspace(1.0 / _FINE[1], 1.0, _FINE[1]) ** _CROWDED
    return EfficiencyMap(torque, speed, operation(cases[0][1], torque, speed[:, None]), voltage, tuple(traces))


@figure
def efficiency_map(figure: Figure, cases: list[tuple[str, SetCycle]], voltage: float) -> None:
    """Lines of equal efficiency, as far as the voltage reaches, and the load cycles."""
    efficiency = efficiency_field(cases, voltage)
    unit = torque_unit(float(np.abs(efficiency.torque).max()))
    ((axes,),) = placed(figure, 2.3, right=2.05, top=0.22)
    _efficiency_lines(axes, efficiency, unit)
    for (name, torque, speed), (colour, dashes) in zip(efficiency.traces, CASES, strict=False):
        text = f"load cycle,\n{named(name)}" if name else "load cycle"
        axes.plot(from_si(torque, unit, "torque"), _rpm(speed), color=COLOURS[colour], linestyle=dashes, label=text,
                  zorder=5, marker="o" if len(torque) <= _MARKED else "", markersize=2.2)  # fmt: skip
    axes.axvline(0.0, color="black", linewidth=0.6)
    axes.set(xlim=from_si(efficiency.torque[[0, -1]], unit, "torque"), ylim=(0.0, _rpm(efficiency.speed[-1])))
    axes.set(xlabel=reads("torque at the gearhead's output", unit), ylabel="speed there (rpm)")
    for text, side, to in (("drives", 3, "left"), ("brakes", -3, "right")):
        if text == "drives" or efficiency.torque[0] < 0.0:
            style.text_off(axes, text, (0.0, 1.0), (side, 3), xycoords=("data", "axes fraction"), ha=to, fontsize=7)
    style.outside(axes)


def _places(levels: Sequence[Sequence[Array]], field: Array) -> list[Array]:
    """Places of the names of lines, apart from one another: half up the outer branch of each line.

    The inner branches crowd where there is no torque.
    """
    places = list[Array]()
    for line in (line / field for lines in reversed(levels) for line in lines):
        lowest = int(line[:, 1].argmin())
        outer = max(line[: lowest + 1], line[lowest:], key=lambda branch: float(np.ptp(branch[:, 0])))
        reach = np.abs(outer - line[lowest]).sum(axis=1)
        place = outer[int(np.abs(reach - 0.5 * reach.max()).argmin())]
        if np.ptp(outer[:, 0]) > _APART and all(np.abs(place - other).max() > _APART for other in places):
            places.append(place)
    return [place * field for place in places]


def _efficiency_lines(axes: Axes, efficiency: EfficiencyMap, unit: str) -> None:
    """Iso-lines with their percentage, each direction of power for itself, and the end of the voltage."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.ticker import MaxNLocator

    across, up = from_si(efficiency.torque, unit, "torque"), _rpm(efficiency.speed)
    reached = ~(np.abs(efficiency.field.voltage) > efficiency.voltage)
    share = np.where(reached, 100.0 * efficiency.field.efficiency, np.nan)
    shades = LinearSegmentedColormap.from_list("shades", _SHADES)
    for side in (efficiency.torque > 0.0, efficiency.torque < 0.0):
        values = share[:, side]
        known = values[np.isfinite(values)]
        if side.sum() < 2 or not len(known):
            continue
        levels: list[float] = [level for level in LEVELS if known.min() < level < known.max()]
        if len(levels) < _LEAST:  # of a drive that friction keeps far below those
            ticks = MaxNLocator(_FEW, steps=[1, 2, 5, 10]).tick_values(max(float(known.min()), 0.0), float(known.max()))
            levels = [float(level) for level in ticks if known.min() < level < known.max()]
        if not levels:
            continue
        axes.contourf(across[side], up, values, [0.0, *levels, 100.0], cmap=shades, zorder=0.5)
        lines = axes.contour(across[side], up, values, levels, colors=COLOURS["grey"], linewidths=0.6)
        axes.clabel(lines, fmt="%g %%", fontsize=6.2, inline_spacing=2,
                    manual=_places(lines.allsegs, np.array([np.ptp(across), up[-1]])))  # fmt: skip
    if not reached.all():
        edge = axes.contour(across, up, np.abs(efficiency.field.voltage), [efficiency.voltage], colors=COLOURS["blue"],
                            linewidths=1.1)  # fmt: skip
        edge.set_zorder(4)
        axes.plot([], [], color=COLOURS["blue"], label=f"{efficiency.voltage:.3g} V, winding warm")
