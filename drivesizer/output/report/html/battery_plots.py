"""Powers drawn from the battery, and the charge that is left over time."""

from __future__ import annotations

from math import isnan

from drivesizer.machine.energy_budget import charge_over_mission
from drivesizer.output.report.figures.battery import is_known, shown_until
from drivesizer.output.report.html.curves import Plot, figure, line, numbers, plain
from drivesizer.results.energy import EnergyBudget
from drivesizer.units import from_si

__all__ = ["charge_plot", "consumers_plot"]

_ROW = 26  # px


def consumers_plot(budget: EnergyBudget | None) -> Plot | None:
    """Mean power of each consumer as bars; what is unknown has none, and says so where it is pointed at."""
    if budget is None or not is_known(budget):
        return None
    rows = [one for one in budget.consumers if one.mean]
    bars = {
        "type": "bar",
        "orientation": "h",
        "x": numbers(0.0 if isnan(one.mean) else one.mean for one in rows),
        "y": [plain(one.name) for one in rows],
        "customdata": ["unknown" if isnan(one.mean) else f"{one.mean:.4g} W".replace("-", "−") for one in rows],
        "name": "mean power",
        "showlegend": False,
        "marker": {"color": "blue"},
        "text": ["unknown" if isnan(one.mean) else "" for one in rows],
        "textposition": "outside",
        "hovertemplate": "%{y}: %{customdata}<extra></extra>",
    }
    layout = {
        "height": 90 + _ROW * len(rows),
        "hovermode": "closest",
        "xaxis": {"title": {"text": "mean power (W)"}},
        "yaxis": {"autorange": "reversed", "type": "category"},
    }
    return figure([bars], layout)


def charge_plot(budget: EnergyBudget | None) -> Plot | None:
    """The charge from full on, until what is required and what there is have ended; what may not be used is marked."""
    if budget is None or not is_known(budget):
        return None
    time, charge = charge_over_mission(budget, shown_until(budget))
    hours = from_si(time, "h", "time")
    data = [line(hours, 100.0 * charge, "charge", "blue",
                 hovertemplate="%{y:.4~r} % after %{x:.4~r} h<extra></extra>")]  # fmt: skip
    if not isnan(budget.required):
        end = float(from_si(budget.required, "h", "time"))
        data.append(line([end, end], [0.0, 100.0], "required", "grey", "3px,3px", hoverinfo="skip"))
    if budget.usable < 1.0:
        least = 100.0 * (1.0 - budget.usable)
        data.append(line([0.0, float(hours[-1])], [least, least], "may not be used", "vermillion", "8px,3px",
                         hoverinfo="skip"))  # fmt: skip
    layout = {
        "height": 260,
        "hovermode": "closest",
        "xaxis": {"title": {"text": "time (h)"}, "range": [0.0, 1.02 * float(hours[-1])]},
        "yaxis": {"title": {"text": "charge (%)"}, "range": [0.0, 103.0]},
    }
    return figure(data, layout)
