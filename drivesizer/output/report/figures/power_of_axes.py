"""Power of all axes of a machine over its cycle, stacked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drivesizer.output.report.figures.style import COLOURS, Form, drawn, limit, named, outside, placed
from drivesizer.results.machine_power import MachinePower

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["power_of_axes"]

_HEIGHT = 2.3  # in
_PIECES = 600
_SHADES = tuple(COLOURS[name] for name in ("sky", "orange", "green", "purple", "blue", "vermillion", "grey"))
_HATCHES = ("", "////", "....", "\\\\\\\\")
_ROOM = 2.0  # of the largest power: a limit beyond is not drawn


def power_of_axes(power: MachinePower, form: Form = "svg") -> bytes:
    """Drawn power of each axis above the line, regenerated power below, one axis on the other, and their sum.

    Parameters
    ----------
    power
        Of all axes, known.

    Returns
    -------
    bytes
        The file in that form.
    """

    def draw(figure: Figure) -> None:
        axes = placed(figure, right=1.35)[0][0]
        _stacked(axes, power)
        for place, (name, value) in enumerate(_limits(power)):
            limit(axes, value, name, place)
        outside(axes)

    return drawn(draw, _HEIGHT, form)


def _stacked(axes: Axes, power: MachinePower) -> None:
    course = power.course(_PIECES)
    for rows, sign, names in ((course.drawn, 1.0, power.axes), (course.returned, -1.0, ())):
        ends = sign * np.concatenate([np.zeros((1, rows.shape[1])), np.cumsum(rows, axis=0)])
        for k in range(len(rows)):
            axes.stairs(
                ends[k + 1], course.time, baseline=ends[k], fill=True, facecolor=_SHADES[k % len(_SHADES)],
                hatch=_HATCHES[k // len(_SHADES) % len(_HATCHES)], edgecolor="white", linewidth=0.0, zorder=2,
                label=named(names[k], 80.0) if names else None,
            )  # fmt: skip
    net = course.drawn.sum(axis=0) - course.returned.sum(axis=0)
    axes.stairs(net, course.time, baseline=None, color="black", linewidth=0.9, zorder=4, label="all axes")
    axes.axhline(0.0, color="black", linewidth=0.5, zorder=3)
    axes.set(xlim=(0.0, float(course.time[-1])), xlabel="time (s)", ylabel="power (W)")


def _limits(power: MachinePower) -> list[tuple[str, float]]:
    """Limits of the supply that are not far above the largest power [W]."""
    found = []
    names = {"supply_current": "supply, largest current", "supply_power": "supply, largest power"}
    for check in power.checks:
        if check.name in names and check.case == power.case and check.demand > 0.0:
            most = check.limit * power.peak / check.demand
            if most <= _ROOM * power.peak:
                found.append((names[check.name], most))
    return found
