"""A platform in the plane: its path, desired and driven, with errors along the way; speeds that its drives permit."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.path_following.deviation import deviation
from drivesizer.control.path_following.following import Followed
from drivesizer.errors import InputError
from drivesizer.machine.permitted_speed import PermittedSpeeds
from drivesizer.output.platform_table import failed_motors_text
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, heading, named, placed
from drivesizer.output.report.figures.time_strips import Window, thinned

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["path_and_errors", "speed_by_direction"]

_LOOKS: tuple[tuple[str, Any], ...] = (  # of the runs: the kinematic and the dynamic model, poses fed back
    ("vermillion", (0, (5, 2))), ("green", "solid"), ("purple", (0, (1, 1.2))), ("orange", (0, (3, 1, 1, 1))),
)  # fmt: skip
_ARROWS = 24  # headings along the path
_POINTS = 2000  # of a path
_ACROSS, _MOST = 4, 8  # panels beside each other, and in all
_PANEL = 1.32  # in, wide and high
_LEFT, _RIGHT, _TOP, _BELOW = 0.66, 0.2, 0.4, 0.42  # in, around the panels
_GAP, _TITLE = 0.12, 0.25  # in, between them, and above each


def path_and_errors(runs: Mapping[str, Followed], form: Form = "svg") -> bytes:
    """The desired path and what was driven, to scale; distance and heading error over the way."""
    if not 1 <= len(runs) <= len(_LOOKS):
        raise InputError(f"figure of a path: expected 1 to {len(_LOOKS)} runs, got {len(runs)}")

    def draw(figure: Any) -> None:
        grid = [row[0] for row in placed(figure, 3, top=0.42, gaps=(0.42, 0.1), heights=(3.4, 1.0, 1.0), shared=False)]
        _plane(grid[0], runs)
        _over_way(grid[1], runs, "position", "distance (m)")
        _over_way(grid[2], runs, "heading", "heading (°)")
        grid[1].tick_params(labelbottom=True)
        grid[2].set_xlabel("way along the desired path (m)")
        grid[0].set(xlabel="x (m)", ylabel="y (m)")
        heading(figure, *grid[0].get_legend_handles_labels(), 3)

    return drawn(draw, 6.4, form)


def _plane(axes: Axes, runs: Mapping[str, Followed]) -> None:
    """Desired path with its headings, and what was driven."""
    wanted = next(iter(runs.values())).planned.posture
    x, y = wanted[:2, _every(wanted.shape[1], _POINTS)]
    axes.plot(x, y, color=COLOURS["blue"], linewidth=1.6, label="desired")
    for layer, ((name, run), (colour, dashes)) in enumerate(zip(runs.items(), _LOOKS, strict=False)):
        x, y = run.posture[:2, _every(run.posture.shape[1], _POINTS)]
        look = {"color": COLOURS[colour], "linestyle": dashes, "zorder": _above(layer)}
        axes.plot(x, y, label=named(name), **look)
    at = _every(wanted.shape[1], _ARROWS)
    axes.quiver(*wanted[:2, at], np.cos(wanted[2, at]), np.sin(wanted[2, at]), color=COLOURS["blue"], width=0.0025,
                scale=32.0, zorder=3)  # fmt: skip
    axes.set_aspect("equal", adjustable="datalim")


def _above(layer: int) -> float:
    """Dashes lie on the unbroken line, where two runs are one to the eye."""
    return 3.0 if _LOOKS[layer][1] != "solid" else 2.5


def _every(count: int, most: int) -> NDArray[np.int64]:
    """Some of so many places, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def _over_way(axes: Axes, runs: Mapping[str, Followed], column: str, title: str) -> None:
    """An error over the way."""
    for layer, ((_, run), (colour, dashes)) in enumerate(zip(runs.items(), _LOOKS, strict=False)):
        d = deviation(run)
        values = np.degrees(d.heading) if column == "heading" else d.position
        rows = thinned(d.travel, values, Window("", 0.0, float(d.travel[-1])))
        axes.plot(d.travel[rows], values[rows], color=COLOURS[colour], linestyle=dashes, zorder=_above(layer))
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set(xlim=(0.0, float(d.travel[-1]) or 1.0), ylabel=title)


def speed_by_direction(found: PermittedSpeeds, form: Form = "svg") -> bytes:
    """Highest steady speed in each direction, with all motors and without each of the first few."""
    turn, required = np.radians(np.append(found.direction, 360)), found.required
    failed = [wheel for wheel in found.speed if wheel][:_MOST] or [0]
    rows, columns = ceil(len(failed) / _ACROSS), min(len(failed), _ACROSS)

    fast = [speed[np.isfinite(speed)].max(initial=required or 0.0) for speed in found.speed.values()]
    most = 1.06 * max(fast) or 1.0

    def line(axes: Any, speed: NDArray[np.float64], **look: Any) -> None:
        known = np.where(np.isfinite(speed), speed, np.nan)
        marker = "" if np.isfinite(speed).all() else "."
        axes.plot(known * np.cos(turn), known * np.sin(turn), marker=marker, **look)

    def draw(figure: Figure) -> None:
        right = max(figure.get_size_inches()[0] - _LEFT - (_PANEL + _GAP) * columns + _GAP, _RIGHT)
        grid = placed(figure, rows, columns, top=_TOP, right=right, gaps=(_TITLE, _GAP))
        for axes, wheel in zip((axes for row in grid for axes in row), failed, strict=False):
            line(
                axes, found.speed[0][[*range(len(turn) - 1), 0]], color=COLOURS["blue"], label=failed_motors_text(found)
            )
            if wheel:
                without = found.speed[wheel][[*range(len(turn) - 1), 0]]
                line(
                    axes,
                    without,
                    color=COLOURS["vermillion"],
                    linestyle=(0, (5, 1.5)),
                    label="without one more" if found.failed else "without one",
                )
                axes.set_title(f"without wheel {wheel}")
            if required is not None:
                line(axes, np.full(len(turn), required), color="black", linewidth=0.7, linestyle=(0, (1, 1.5)),
                     label=f"{required:g} m/s, as in the spec")  # fmt: skip
            axes.set(xlim=(-most, most), ylim=(-most, most))
        for axes in grid[-1]:
            axes.set_xlabel("ahead (m/s)")
        for row in grid:
            row[0].set_ylabel("to the left (m/s)")
        heading(figure, *grid[0][0].get_legend_handles_labels(), 3)

    return drawn(draw, _TOP + _BELOW + _PANEL * rows + _TITLE * (rows - 1), form)
