"""Powers drawn from the battery, and its charge over the mission."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

import numpy as np

from drivesizer.machine.energy_budget import charge_over_mission
from drivesizer.output.report.figures.style import COLOURS, Form, drawn, limit, named, placed
from drivesizer.results.energy import EnergyBudget
from drivesizer.units import from_si

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["battery", "is_known", "shown_until"]

_ROW = 0.15  # in
_LEAST = 1.3  # in, of the whole figure
_BEYOND = 1.1  # of the time that the battery lasts, where nothing is required


def is_known(budget: EnergyBudget) -> bool:
    """Whether there is something to draw: powers and a run time."""
    return bool(np.isfinite(budget.autonomy) and np.isfinite(budget.power).all())


def shown_until(budget: EnergyBudget) -> float:
    """End of the charge's course [s]: where both the required and the available time are over."""
    return _BEYOND * budget.autonomy if isnan(budget.required) else max(budget.required, budget.autonomy)


def battery(budget: EnergyBudget, form: Form = "svg") -> bytes:
    """Mean power of each consumer at the left, the charge that is left over time at the right."""
    rows = [(one.name, one.mean) for one in budget.consumers if one.mean]

    def draw(figure: Figure) -> None:
        bars, course = placed(figure, 1, 2, left=1.75, gaps=(0.0, 0.75), shared=False)[0]
        _consumers(bars, rows)
        _charge(course, budget)

    return drawn(draw, max(_LEAST, _ROW * len(rows) + 0.55), form)


def _consumers(axes: Axes, rows: list[tuple[str, float]]) -> None:
    """Mean powers as bars; of what is unknown that is said."""
    powers = [power for _, power in rows]
    colours = ["white" if power < 0.0 else COLOURS["sky"] for power in powers]
    axes.barh(range(len(rows)), powers, height=0.7, color=colours, edgecolor=COLOURS["blue"], linewidth=0.6, zorder=3)
    for place, power in enumerate(powers):
        said = "unknown" if isnan(power) else f"{power:.3g}".replace("-", "−")
        axes.annotate(said, (0.0 if isnan(power) else max(power, 0.0), place), xytext=(3, 0),
                      textcoords="offset points", va="center", fontsize=6.8)  # fmt: skip
    axes.set_yticks(range(len(rows)), [named(name) for name, _ in rows])
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", visible=False)
    axes.axvline(0.0, color="black", linewidth=0.6)
    axes.set(ylim=(len(rows) - 0.4, -0.6), xlabel="mean power (W)")
    axes.set_xlim(right=1.18 * max(0.0, np.nanmax(powers)) or 1.0)


def _charge(axes: Axes, budget: EnergyBudget) -> None:
    """Until the end of what is required or of what there is, whichever is later; the usable share as a limit."""
    lasts = shown_until(budget)
    time, charge = charge_over_mission(budget, lasts)
    axes.plot(from_si(time, "h", "time"), 100.0 * charge, color=COLOURS["blue"], zorder=3)
    if budget.usable < 1.0:
        limit(axes, 100.0 * (1.0 - budget.usable), "may not be used")
    if not isnan(budget.required):
        end = float(from_si(budget.required, "h", "time"))
        axes.axvline(end, color="black", linewidth=0.7, linestyle=(0, (2, 1.5)), zorder=2)
        early = end < 0.5 * float(from_si(lasts, "h", "time"))  # its name on the side that has room for it
        axes.annotate("required", (end, 1.0), xycoords=("data", "axes fraction"), xytext=(2 if early else -2, -2),
                      textcoords="offset points", ha="left" if early else "right", va="top", fontsize=6.5)  # fmt: skip
    axes.set(xlim=(0.0, float(from_si(lasts, "h", "time")) * 1.02), ylim=(0.0, 103.0), xlabel="time (h)")
    axes.set_ylabel("charge (%)")
    axes.yaxis.set_label_coords(-0.2, 0.5)
