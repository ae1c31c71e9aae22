"""The way of a platform in plan view: its path, where it heads and the room that it takes, passages, start and end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.load_cases.platform_wheels import trajectory_of
from drivesizer.output.report.figures.style import CASES, COLOURS, Form, drawn, heading, named, placed
from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.trajectory import Trajectory
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Way", "passages_of", "plan_view", "ways_of"]

Array = NDArray[np.float64]
_WIDTH = 5.64  # in, of the axes
_HEIGHTS = (1.2, 2.0)  # in, of the axes: at least, at most
_POINTS = 2000  # of a path
_ARROWS = 26  # headings along the way
_ROOM = 0.06  # around all that is drawn, as a share of it
_PER_TURN = 0.4  # m of way that turning by a radian counts for, so that what turns on the spot is seen to
_JAMB = 0.5  # of a passage's width that is drawn of the wall at either side


class Way(NamedTuple):
    """A trajectory and the load case, or cases, that it belongs to."""

    name: str
    trajectory: Trajectory


def ways_of(spec: RobotSpec) -> list[Way]:
    """The trajectories of a machine's load cases, each once; none where nothing drives along one."""
    found: list[Way] = []
    for name, case in spec.load_cases:
        way = trajectory_of(case)
        if way is not None and not any(_close(way, other.trajectory) for other in found):
            found.append(Way(name, way))
    return found


def _close(a: Trajectory, b: Trajectory) -> bool:
    return np.array_equal(a.duration, b.duration) and np.array_equal(a.posture, b.posture)


def passages_of(spec: RobotSpec) -> list[Passage]:
    """The passages that have a place in the world."""
    platform = spec.platform
    return [p.record for p in platform.passages if p.x is not None] if platform else []


def plan_view(spec: RobotSpec, form: Form = "svg") -> bytes:
    """The way to scale, seen from above."""
    ways, passages = ways_of(spec)[: len(CASES)], passages_of(spec)
    platform = spec.platform
    size = platform.size.record if platform and platform.size else None
    low, high = _extent(ways, passages, size)
    across, up = high - low
    height = float(np.clip(_WIDTH * up / across, *_HEIGHTS))
    scale = max(across / _WIDTH, up / height)  # m to an inch
    middle, half = (low + high) / 2.0, scale / 2.0 * np.array([_WIDTH, height])
    legend = 0.18 if len(ways) > 1 else 0.0

    def draw(figure: Figure) -> None:
        axes = placed(figure, top=0.1 + legend)[0][0]
        (left, below), (right, above) = middle - half, middle + half
        axes.set(xlim=(left, right), ylim=(below, above), xlabel="x (m)", ylabel="y (m)")
        for passage in passages:
            _doorway(axes, passage)
        for number, way in enumerate(ways):
            colour, dashes = ("blue", "solid") if len(ways) == 1 else CASES[number]
            _path(axes, way, COLOURS[colour], dashes, size, scale)
        if len(ways) > 1:
            heading(figure, *axes.get_legend_handles_labels(), len(ways))

    return drawn(draw, height + 0.52 + legend, form)


def _extent(ways: Sequence[Way], passages: Sequence[Passage], size: Size | None) -> tuple[Array, Array]:
    """The corners of what is to be seen [m], with room around."""
    body = size.reach if size else 0.0
    points = [way.trajectory.posture[:2].reshape(2, -1) for way in ways]
    points += [np.array([[p.x], [p.y]]) + p.width * np.array([[-1.0, 1.0]]) for p in passages]
    every = np.concatenate(points, axis=1)
    low, high = every.min(axis=1) - body, every.max(axis=1) + body
    room = max(_ROOM * float((high - low).max()), 0.05)
    return low - room, high + room


def _path(axes: Axes, way: Way, colour: str, dashes: Any, size: Size | None, scale: float) -> None:
    """The path, the robot's outline and heading along it, and its ends.

    ``scale`` is metres to an inch.
    """
    times = np.linspace(0.0, way.trajectory.total, _POINTS)
    x, y, theta = way.trajectory.at(times)
    axes.plot(x, y, color=colour, linestyle=dashes, linewidth=1.3, zorder=3, label=named(way.name))
    at = _spread(x, y, theta)
    if size and size.length > 0.05 * scale:  # else it is no more than a dot
        _outlines(axes, size, np.stack([x, y, theta])[:, at], colour)
    length = max(0.16 * scale, 0.75 * size.length if size else 0.0)
    dx, dy = length * np.cos(theta[at]), length * np.sin(theta[at])
    axes.quiver(x[at], y[at], dx, dy, color=colour, angles="xy", scale_units="xy", scale=1.0, width=0.0022,
                headwidth=4.5, headlength=5.0, headaxislength=4.5, zorder=4)  # fmt: skip
    _ends(axes, (x[0], y[0]), (x[-1], y[-1]), 0.1 * scale)


def _spread(x: Array, y: Array, theta: Array) -> NDArray[np.int64]:
    """Places with as much way between each other, turning counted in; the first and the last among them."""
    gone = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)) + _PER_TURN * np.abs(np.diff(theta)))])
    marks = np.linspace(0.0, gone[-1], _ARROWS)
    return np.unique(np.searchsorted(gone, marks).clip(0, len(gone) - 1))


def _outlines(axes: Axes, size: Size, postures: Array, colour: str) -> None:
    from matplotlib.collections import PolyCollection

    px, py = size.corners
    shapes = [
        np.stack([x + px * np.cos(t) - py * np.sin(t), y + px * np.sin(t) + py * np.cos(t)], axis=1)
        for x, y, t in postures.T
    ]
    axes.add_collection(
        PolyCollection(shapes, facecolor="none", edgecolor=colour, linewidth=0.6, alpha=0.8, zorder=2.5)
    )


def _ends(axes: Axes, start: tuple[float, float], end: tuple[float, float], near: float) -> None:
    """Start and end, by shape and word; as one where they are in one place."""
    one = bool(np.hypot(end[0] - start[0], end[1] - start[1]) < near)
    marks = ((start, "o", "start and end" if one else "start"), (end, "s", "end"))
    for place, marker, name in marks[: 1 if one else 2]:
        axes.plot(*place, marker=marker, markersize=5.5, markerfacecolor="white", markeredgewidth=1.2, color="black",
                  linestyle="none", zorder=5)  # fmt: skip
        axes.annotate(name, place, (5, -5), textcoords="offset points", va="top", fontsize=7, zorder=6)


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
    axes.annotate(named(passage.name), tuple(top), (0, 3), textcoords="offset points", ha="center", va="bottom",
                  fontsize=6.8, zorder=6)  # fmt: skip
