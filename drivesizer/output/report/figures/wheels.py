"""Torque and speed of each driven wheel of a platform over time on its path, a row for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from drivesizer.output.report.figures.load_and_loop import stretches
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, named, placed, torque_unit
from drivesizer.output.report.figures.time_strips import Strip, across, strip, within
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.units import from_si, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["MOST_WHEELS", "wheels_over_time"]

MOST_WHEELS = 8  # rows of a figure
_ROW, _NAME = 0.6, 0.19  # in, of a diagram and of the name above it
_LOOKS = (("torque", "torque", "vermillion"), ("speed", "rotary_speed", "blue"))


def wheels_over_time(cycles: Sequence[tuple[str, LoadCycle]], form: Form = "svg") -> bytes:
    """Torque at the left and speed at the right, of each wheel or of several of equal demand.

    Parameters
    ----------
    cycles
        Load cycles with the names of their wheels; the first few are drawn. All have one scale.
    form
        Drawing, picture, or drawing for a typesetter.

    Returns
    -------
    bytes
        The file in that form.
    """
    shown = cycles[:MOST_WHEELS]
    unit = torque_unit(max(float(np.abs(cycle.torque).max()) for _, cycle in shown))
    beside = strip(stretches(shown))

    def draw(figure: Figure) -> None:
        grid = placed(figure, len(shown), 2, top=_NAME + 0.04, gaps=(_NAME, 0.62), shared=False)
        for column, ((name, kind, colour), trade) in enumerate(zip(_LOOKS, (unit, "rpm"), strict=True)):
            ends = _ends(shown, name, trade, kind)
            for row, (wheel, cycle) in enumerate(shown):
                axes = grid[row][column]
                _over_time(axes, cycle, beside, (name, kind, trade, COLOURS[colour]))
                axes.set_ylim(*ends)
                axes.tick_params(labelbottom=row == len(shown) - 1)
                axes.set_title(f"{named(wheel)}: {name} ({label(trade)})", pad=2.5)
            grid[-1][column].set_xlabel("time (s)")

    return drawn(draw, (_ROW + _NAME) * len(shown) + 0.46, form)


def _ends(cycles: Sequence[tuple[str, LoadCycle]], name: str, unit: str, kind: str) -> tuple[float, float]:
    """An axis for all wheels, with 0 in it."""
    values = np.concatenate([from_si(getattr(cycle, name).ravel(), unit, kind) for _, cycle in cycles])
    low, high = min(float(values.min()), 0.0), max(float(values.max()), 0.0)
    room = 0.07 * (high - low) or 1.0
    return low - room * (low < 0.0), high + room


def _over_time(axes: Axes, cycle: LoadCycle, shown: Strip, look: tuple[str, str, str, str]) -> None:
    name, kind, unit, colour = look
    for number, window in enumerate(shown.windows):
        time, values = within(cycle.time.ravel(), getattr(cycle, name).ravel(), window)
        axes.plot(shown.place(number, time), from_si(values, unit, kind), color=colour)
    axes.axhline(0.0, color="black", linewidth=0.6)
    across(axes, shown)
