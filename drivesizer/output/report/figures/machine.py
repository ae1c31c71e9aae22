"""The machine as figures: a platform in the plane, the room that it takes, power of axes and of the battery."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from math import ceil, isnan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.path_following import Followed, deviation
from drivesizer.load_cases.platform import trajectory_of
from drivesizer.machine.battery import charge_over_mission
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output.platform import failed_motors_text
from drivesizer.output.report.figures import picture, style
from drivesizer.output.report.figures.picture import Bar, Bars, Curve, Diagram, Plot
from drivesizer.output.report.figures.style import CASES, COLOURS, Window, figure, named
from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.drive_set import EnergyBudget
from drivesizer.results.machine import Course, MachinePower
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# -- The way of a platform in plan view: its path, where it heads and the room that it takes, passages, start and end.


Array = NDArray[np.float64]
_WIDTH = 5.64  # in, of the axes
_HEIGHTS = (1.2, 2.0)  # in, of the axes: at least, at most
_POINTS = 2000  # of a path
_ARROWS_ALONG_WAY = 26  # headings along the way
_ROOM_OF_PLAN = 0.06  # around all that is drawn, as a share of it
_PER_TURN = 0.4  # m of way that turning by a radian counts for, so that what turns on the spot is seen to
_JAMB = 0.5  # of a passage's width that is drawn of the wall at either side


class Way(NamedTuple):
    """A trajectory and the load case, or cases, that it belongs to."""

    name: str
    trajectory: Trajectory


def ways_of(spec: RobotSpec) -> list[Way]:
    """The trajectories of a machine's load cases, each once; none where nothing drives along one."""
    ways: list[Way] = []
    for name, case in spec.load_cases:
        way = trajectory_of(case)
        if way is not None and not any(
            np.array_equal(way.duration, other.trajectory.duration)
            and np.array_equal(way.posture, other.trajectory.posture)
            for other in ways
        ):
            ways.append(Way(name, way))
    return ways


@figure
def plan_view(figure: Figure, spec: RobotSpec) -> None:
    """The way to scale, seen from above; of passages those that have a place in the world."""
    platform, ways = spec.platform, ways_of(spec)[: len(CASES)]
    passages = [p.record for p in platform.passages if p.x is not None] if platform else []
    size = platform.size.record if platform and platform.size else None
    points = [way.trajectory.posture[:2].reshape(2, -1) for way in ways]
    points += [np.array([[p.x], [p.y]]) + p.width * np.array([[-1.0, 1.0]]) for p in passages]
    corners, body = np.concatenate(points, axis=1), size.reach if size else 0.0
    low, high = corners.min(axis=1) - body, corners.max(axis=1) + body
    room = max(_ROOM_OF_PLAN * float((high - low).max()), 0.05)
    low, high = low - room, high + room
    across, up = high - low
    height = float(np.clip(_WIDTH * up / across, *_HEIGHTS))
    scale = max(across / _WIDTH, up / height)  # m to an inch
    (left, below), (right, above) = ((low + high) / 2.0 + sign * scale / 2.0 * np.array([_WIDTH, height])
                                     for sign in (-1.0, 1.0))  # fmt: skip
    legend = 0.18 if len(ways) > 1 else 0.0
    ((axes,),) = style.placed(figure, height + 0.52 + legend, top=0.1 + legend)
    axes.set(xlim=(left, right), ylim=(below, above), xlabel="x (m)", ylabel="y (m)")
    for passage in passages:
        _doorway(axes, passage)
    for number, way in enumerate(ways):
        colour, dashes = ("blue", "solid") if len(ways) == 1 else CASES[number]
        _path(axes, way, COLOURS[colour], dashes, size, scale)
    if len(ways) > 1:
        style.heading(figure, *axes.get_legend_handles_labels(), len(ways))


def _path(axes: Axes, way: Way, colour: str, dashes: Any, size: Size | None, scale: float) -> None:
    """The path, the robot's outline and heading along it, and its ends.

    ``scale`` is metres to an inch. Outlines have as much way between each other, turning counted in; the first and the
    last place are among them.
    """
    from matplotlib.collections import PolyCollection

    x, y, theta = way.trajectory.at(np.linspace(0.0, way.trajectory.total, _POINTS))
    axes.plot(x, y, color=colour, linestyle=dashes, linewidth=1.3, zorder=3, label=named(way.name))
    gone = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)) + _PER_TURN * np.abs(np.diff(theta)))])
    marks = np.linspace(0.0, gone[-1], _ARROWS_ALONG_WAY)
    at = np.unique(np.searchsorted(gone, marks).clip(0, len(gone) - 1))
    if size and size.length > 0.05 * scale:  # else it is no more than a dot
        px, py = size.corners
        shapes = [
            np.stack([a + px * np.cos(t) - py * np.sin(t), b + px * np.sin(t) + py * np.cos(t)], axis=1)
            for a, b, t in zip(x[at], y[at], theta[at], strict=True)
        ]
        outlines = PolyCollection(shapes, facecolor="none", edgecolor=colour, linewidth=0.6, alpha=0.8, zorder=2.5)
        axes.add_collection(outlines)
    length = max(0.16 * scale, 0.75 * size.length if size else 0.0)
    dx, dy = length * np.cos(theta[at]), length * np.sin(theta[at])
    axes.quiver(x[at], y[at], dx, dy, color=colour, angles="xy", scale_units="xy", scale=1.0, width=0.0022,
                headwidth=4.5, headlength=5.0, headaxislength=4.5, zorder=4)  # fmt: skip
    closed = bool(np.hypot(x[-1] - x[0], y[-1] - y[0]) < 0.1 * scale)
    ends = [(x[0], y[0], "o", "start and end" if closed else "start"), (x[-1], y[-1], "s", "end")]
    for a, b, marker, name in ends[: 1 if closed else 2]:
        axes.plot(a, b, marker=marker, markersize=5.5, markerfacecolor="white", markeredgewidth=1.2, color="black",
                  linestyle="none", zorder=5)  # fmt: skip
        style.text_off(axes, name, (a, b), (5, -5), va="top", fontsize=7, zorder=6)


def _doorway(axes: Axes, passage: Passage) -> None:
    """The wall at both sides of a passage, as deep as it is, and its name."""
    from matplotlib.patches import Polygon

    along = np.array([np.cos(passage.direction), np.sin(passage.direction)])
    aside = np.array([-along[1], along[0]])
    place, half = np.array([passage.x, passage.y]), 0.5 * passage.depth
    for side in (1.0, -1.0):
        inner, outer = (side * passage.width * share * aside for share in (0.5, 0.5 + _JAMB))
        corners = [place + inner - half * along, place + inner + half * along,
                   place + outer + half * along, place + outer - half * along]  # fmt: skip
        axes.add_patch(Polygon(corners, facecolor=COLOURS["grey"], edgecolor=COLOURS["grey"], linewidth=1.2, zorder=2))
    top = place + passage.width * (0.5 + _JAMB) * (aside if aside[1] >= 0.0 else -aside)
    style.text_off(axes, named(passage.name), tuple(top), (0, 3), ha="center", va="bottom", fontsize=6.8, zorder=6)


# -- A platform in the plane: its path, desired and driven, with errors along the way; speeds that its drives permit.


_LOOKS: tuple[tuple[str, Any], ...] = (  # of the runs: the kinematic and the dynamic model, poses fed back
    ("vermillion", (0, (5, 2))), ("green", "solid"), ("purple", (0, (1, 1.2))), ("orange", (0, (3, 1, 1, 1))),
)  # fmt: skip
_ARROWS = 24  # headings along the path
_ACROSS, _MOST_PLACES = 4, 8  # panels beside each other, and in all
_PANEL = 1.32  # in, wide and high
_LEFT, _RIGHT, _TOP, _BELOW = 0.66, 0.2, 0.4, 0.42  # in, around the panels
_GAP, _TITLE = 0.12, 0.25  # in, between them, and above each


@figure
def path_and_errors(figure: Figure, runs: Mapping[str, Followed]) -> None:
    """The desired path and what was driven, to scale; distance and heading error over the way."""

    def spread_places(count: int, most: int) -> NDArray[np.int64]:  # places, the first and the last among them
        return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))

    (plane,), (distance,), (turned,) = style.placed(
        figure, 6.4, 3, top=0.42, gaps=(0.42, 0.1), heights=(3.4, 1.0, 1.0), shared=False
    )
    posture = next(iter(runs.values())).planned.posture
    plane.plot(
        *posture[:2, spread_places(posture.shape[1], _POINTS)], color=COLOURS["blue"], linewidth=1.6, label="desired"
    )
    for (name, run), (colour, dashes) in zip(runs.items(), cycle(_LOOKS), strict=False):
        # dashes lie on the unbroken line, where two runs are one to the eye
        look: Any = {"color": COLOURS[colour], "linestyle": dashes, "zorder": 2.5 if dashes == "solid" else 3.0}
        plane.plot(*run.posture[:2, spread_places(run.posture.shape[1], _POINTS)], label=named(name), **look)
        off = deviation(run)
        whole = Window("", 0.0, float(off.travel[-1]))
        for axes, values in ((distance, off.position), (turned, np.degrees(off.heading))):
            rows = style.thinned(off.travel, values, whole)
            axes.plot(off.travel[rows], values[rows], **look)
            axes.set_xlim(0.0, whole.end or 1.0)
    at = spread_places(posture.shape[1], _ARROWS)
    plane.quiver(*posture[:2, at], np.cos(posture[2, at]), np.sin(posture[2, at]), color=COLOURS["blue"], width=0.0025,
                 scale=32.0, zorder=3)  # fmt: skip
    plane.set_aspect("equal", adjustable="datalim")
    plane.set(xlabel="x (m)", ylabel="y (m)")
    for axes, title in ((distance, "distance (m)"), (turned, "heading (°)")):
        axes.axhline(0.0, color="black", linewidth=0.6)
        axes.set_ylabel(title)
    turned.set_xlabel("way along the desired path (m)")
    style.heading(figure, *plane.get_legend_handles_labels(), 3)


@figure
def speed_by_direction(figure: Figure, speeds: PermittedSpeeds) -> None:
    """Highest steady speed in each direction, with all motors and without each of the first few."""
    turn, required = np.radians(np.append(speeds.direction, 360)), speeds.required
    failed = [wheel for wheel in speeds.speed if wheel][:_MOST_PLACES] or [0]
    rows, columns = ceil(len(failed) / _ACROSS), min(len(failed), _ACROSS)
    fast = [speed[np.isfinite(speed)].max(initial=required or 0.0) for speed in speeds.speed.values()]
    most = 1.06 * max(fast) or 1.0

    def line(axes: Axes, speed: Array, **look: Any) -> None:
        known = np.where(np.isfinite(speed), speed, np.nan)
        marker = "" if np.isfinite(speed).all() else "."
        axes.plot(known * np.cos(turn), known * np.sin(turn), marker=marker, **look)

    right = max(figure.get_figwidth() - _LEFT - (_PANEL + _GAP) * columns + _GAP, _RIGHT)
    height = _TOP + _BELOW + _PANEL * rows + _TITLE * (rows - 1)
    grid = style.placed(figure, height, rows, columns, top=_TOP, right=right, gaps=(_TITLE, _GAP))
    for axes, wheel in zip((axes for row in grid for axes in row), failed, strict=False):
        line(
            axes,
            np.append(speeds.speed[0], speeds.speed[0][0]),
            color=COLOURS["blue"],
            label=failed_motors_text(speeds),
        )
        if wheel:
            line(axes, np.append(speeds.speed[wheel], speeds.speed[wheel][0]), color=COLOURS["vermillion"],
                 linestyle=(0, (5, 1.5)), label="without one more" if speeds.failed else "without one")  # fmt: skip
            axes.set_title(f"without wheel {wheel}")
        if required is not None:
            line(axes, np.full(len(turn), required), color="black", linewidth=0.7, linestyle=(0, (1, 1.5)),
                 label=f"{required:g} m/s, as in the spec")  # fmt: skip
        axes.set(xlim=(-most, most), ylim=(-most, most))
    for axes in grid[-1]:
        axes.set_xlabel("ahead (m/s)")
    for row in grid:
        row[0].set_ylabel("to the left (m/s)")
    style.heading(figure, *grid[0][0].get_legend_handles_labels(), 3)


# -- Power of several axes on one supply over time: what each draws, stacked, and below zero what each returns.


_MOST_AXES = 6  # axes that have a layer of their own
_PIECES = 1500  # finer than print
_ABREAST = 5  # names of the legend
_NOTHING = 1e-6  # of the largest power: what rounding leaves
LOOKS: tuple[tuple[str, str], ...] = (  # colour and hatch, so that a grey print distinguishes them too
    ("blue", ""), ("orange", "////"), ("green", "...."), ("purple", "\\\\\\\\"), ("sky", "xxxx"),
    ("vermillion", "----"), ("grey", "++++"),
)  # fmt: skip


class Layer(NamedTuple):
    """Power of an axis, or of several small ones, over the pieces of a course."""

    name: str
    drawn: Array  # W
    returned: Array  # W


def layers(power: MachinePower, course: Course) -> list[Layer]:
    """Power of the axes as layers: of many axes those of the largest peaks, and the sum of the others."""
    known = [n for n in range(len(power.axes)) if not np.isnan(course.drawn[n]).any()]
    largest = sorted(known, key=lambda n: -float(course.drawn[n].max(initial=0.0)))[:_MOST_AXES]
    axes = known if len(known) <= _MOST_AXES + 1 else sorted(largest)
    layers = [Layer(power.axes[n], course.drawn[n], course.returned[n]) for n in axes]
    rest = [n for n in known if n not in axes]
    if rest:
        layers.append(Layer(f"{len(rest)} others", course.drawn[rest].sum(axis=0), course.returned[rest].sum(axis=0)))
    return layers


def axes_power(power: MachinePower) -> Plot:
    """Power of all axes over time: layers over each other, drawn upward, returned downward."""
    course = power.course(_PIECES)
    power_layers = layers(power, course)
    largest = max((float(layer.drawn.max(initial=0.0)) for layer in power_layers), default=0.0)
    unit, curves = "W" if largest < 10e3 else "kW", list[Curve]()

    def steps(values: Array) -> Any:  # means of pieces at the ends of these, the last one held
        return from_si(np.append(values, values[-1:]), unit, "power")

    for layer, (colour, hatch) in zip(power_layers, LOOKS, strict=False):
        net = layer.drawn - layer.returned
        texts = [f"{value:.4g} {label(unit)}".replace("-", "−")
                for value in steps(np.where(np.abs(net) > _NOTHING * largest, net, 0.0))]  # fmt: skip
        for stack, values in (("drawn", layer.drawn), ("returned", -layer.returned)):
            curves.append(Curve(name=layer.name, x=course.time, y=steps(values), colour=colour, hatch=hatch,
                                stack=stack, texts=texts if stack == "drawn" else ()))  # fmt: skip
    if not np.isnan(course.total).any():
        curves.append(Curve(name="out of the source", x=np.repeat(course.time, 2)[1:-1],
                            y=from_si(np.repeat(course.total, 2), unit, "power"), colour="ink", width=1.0))  # fmt: skip
    diagram = Diagram(name="power", unit=unit, curves=curves, zero=True, height=2.3)
    return picture.over_time(diagram, windows=(), columns=_ABREAST)


# -- Powers drawn from the battery, and its charge over the mission.


_ROW = 0.15  # in
_LEAST = 1.3  # in, of the whole figure
_BEYOND = 1.1  # of the time that the battery lasts, where nothing is required


def is_known(budget: EnergyBudget) -> bool:
    """Whether there is something to draw: powers and a run time."""
    return bool(np.isfinite(budget.autonomy) and np.isfinite(budget.power).all())


def consumers(budget: EnergyBudget) -> Bars:
    """Mean power of each consumer."""
    rows = []
    for name, mean in [(consumer.name, consumer.mean) for consumer in budget.consumers if consumer.mean]:
        low, high = (0.0, 0.0) if isnan(mean) else (min(mean, 0.0), max(mean, 0.0))
        text = "unknown" if isnan(mean) else f"{mean:.3g}".replace("-", "−")
        rows.append(Bar(style.named(name).strip(), high, low, "back" if mean < 0.0 else "pass", right=text))
    return Bars(rows=rows, across="mean power", unit="W")


def charge(budget: EnergyBudget) -> Plot:
    """The charge from full on, until what is required and what there is have ended; what may not be used is marked."""
    lasts = _BEYOND * budget.autonomy if isnan(budget.required) else max(budget.required, budget.autonomy)
    time, left = charge_over_mission(budget, lasts)
    end = 1.02 * float(from_si(lasts, "h", "time"))
    curves = [Curve(name="charge", x=from_si(time, "h", "time"), y=100.0 * left)]
    if not isnan(budget.required):
        required = [float(from_si(budget.required, "h", "time"))] * 2
        curves.append(Curve(name="required", x=required, y=[0.0, 100.0], colour="grey", dashes=picture.DOTTED))
    if budget.usable < 1.0:
        least = [100.0 * (1.0 - budget.usable)] * 2
        curves.append(Curve(name="may not be used", x=[0.0, end], y=least, colour="vermillion", dashes=picture.DASHED))
    diagram = Diagram(name="charge", unit="%", curves=curves, ends=(0.0, 103.0))
    return Plot(diagrams=[diagram], across="time", unit="h", ends=(0.0, end))


@figure
def battery(figure: Figure, budget: EnergyBudget) -> None:
    """Mean power of each consumer at the left, the charge that is left over time at the right."""
    bars, plot = consumers(budget), charge(budget)
    height = max(_LEAST, _ROW * len(bars.rows) + 0.55)
    ((mean, course),) = style.placed(figure, height + 0.12, 1, 2, left=1.75, top=0.2, gaps=(0.0, 0.75), shared=False)
    picture.draw_bars(mean, bars)
    picture.draw(course, plot.diagrams[0])
    course.set(xlim=plot.ends, xlabel="time (h)")
    course.yaxis.set_label_coords(-0.2, 0.5)
    course.legend(loc="lower right", bbox_to_anchor=(1.02, 0.98), ncols=3, borderaxespad=0.0, columnspacing=1.0)
