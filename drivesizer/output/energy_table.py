"""Consumers of a battery, as rows that terminal and reports print."""

from __future__ import annotations

from math import isnan
from typing import NamedTuple

from drivesizer.results.energy import EnergyBudget
from drivesizer.units import show

__all__ = ["ConsumerRow", "consumer_rows"]


class ConsumerRow(NamedTuple):
    """A line of the table of consumers."""

    name: str
    number: str
    mean: str
    peak: str
    duty: str
    said: str  # "assumed" where its figures are a guess of the spec


def consumer_rows(budget: EnergyBudget) -> list[ConsumerRow]:
    """Drive, equipment and their total, with the power of each at the battery."""
    rows = [
        ConsumerRow(
            name=one.name,
            number=str(one.number) if one.number > 1 else "",
            mean=show(one.mean, "W", "power"),
            peak=show(one.peak, "W", "power") if one.peak or isnan(one.peak) else "",
            duty="" if isnan(one.duty) or one.duty == 1.0 else show(one.duty, "%", "dimensionless"),
            said="assumed" if one.assumed else "",
        )
        for one in budget.consumers
        if one.mean or isnan(one.mean)
    ]
    total = show(budget.mean_power, "W", "power"), show(budget.peak_power, "W", "power")
    return [*rows, ConsumerRow("total", "", *total, "", "")]
