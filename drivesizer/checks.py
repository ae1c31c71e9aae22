"""Demand against limit, for all candidates at once: the one place where margins are made.

An upper limit has margin limit/demand - 1, a required minimum actual/required - 1. A figure that is missing
makes the check *unknown*; a demand of zero passes and has no margin.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivesizer.results import Check, Status

__all__ = ["TITLES", "CheckColumn", "at_least", "at_most", "fits", "in_order"]

_SHARED = {
    "compatibility": "Motor and gearhead fit together",
    "gearhead_continuous_torque": "Gearhead continuous torque",
    "gearhead_intermittent_torque": "Gearhead intermittent torque",
    "backlash_at_load": "Backlash at the load",
    "encoder_counts": "Encoder counts per turn",
    "controller_available": "Controller for bus, voltage and motor",
    "controller_continuous_current": "Controller continuous current",
    "controller_peak_current": "Controller peak current",
}
TITLES = {
    "paper": _SHARED
    | {
        "gearhead_input_speed": "Gearhead input speed",
        "largest_reduction": "Largest reduction allowed",
        "motor_speed": "Motor speed (no-load speed)",
        "motor_continuous_torque": "Motor continuous torque",
        "motor_maximum_torque": "Motor maximum torque (stall)",
        "motor_power": "Motor continuous power",
        "speed_constant": "Speed constant",
    },
    "physics": _SHARED
    | {
        "gearhead_continuous_speed": "Gearhead continuous input speed",
        "gearhead_intermittent_speed": "Gearhead intermittent input speed",
        "gearhead_continuous_power": "Gearhead continuous power",
        "gearhead_intermittent_power": "Gearhead intermittent power",
        "motor_speed": "Motor permissible speed",
        "winding_temperature": "Winding temperature, steady",
        "motor_nominal_current": "Motor nominal current (RMS)",
        "supply_voltage": "Motor voltage, cold and hot",
        "encoder_speed": "Encoder speed",
    },
}


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckColumn:
    """One check over all candidates."""

    name: str
    demand: NDArray[np.float64]
    limit: NDArray[np.float64]
    margin: NDArray[np.float64]
    passed: NDArray[np.bool_]
    failed: NDArray[np.bool_]  # neither passed nor failed: unknown
    kind: str
    unit: str
    by_choice: bool = False
    time: NDArray[np.float64] | None = None  # s, of the worst moment

    def at(
        self, index: int | tuple[()], method: str, *, title: str = "", at_time: float | None = None, note: str = ""
    ) -> Check:
        """The check of one candidate; ``()`` for a column that is a single figure."""
        status: Status = "pass" if self.passed[index] else "fail" if self.failed[index] else "unknown"
        return Check(
            name=self.name,
            title=title or TITLES[method][self.name],
            method=method,
            demand=float(self.demand[index]),
            limit=float(self.limit[index]),
            kind=self.kind,
            unit=self.unit,
            margin=float(self.margin[index]),
            status=status,
            at_time=at_time if self.time is None else float(self.time[index]),
            by_choice=self.by_choice,
            note=note,
        )


def _column(
    name: str, demand: Any, limit: Any, kind: str, unit: str, sense: Literal["most", "least"], by_choice: bool = False
) -> CheckColumn:
    demand, limit = np.broadcast_arrays(np.asarray(demand, float), np.asarray(limit, float))
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = limit / demand - 1.0
    known = ~(np.isnan(demand) | np.isnan(limit))
    idle = known & (demand == 0.0)
    good = idle | (limit >= demand) if sense == "least" else idle | (demand <= limit)
    return CheckColumn(
        name=name,
        demand=demand,
        limit=limit,
        margin=np.where(known & ~idle, margin, np.nan),
        passed=known & good,
        failed=known & ~good,
        kind=kind,
        unit=unit,
        by_choice=by_choice,
    )


def at_most(name: str, demand: Any, limit: Any, kind: str, unit: str) -> CheckColumn:
    """A demand that must not exceed a limit; margin = limit/demand - 1.

    >>> at_most("motor_power", 10.0, 20.0, "power", "W").margin.item()
    1.0
    """
    return _column(name, demand, limit, kind, unit, "most")


def at_least(name: str, required: Any, actual: Any, kind: str, unit: str, *, by_choice: bool = False) -> CheckColumn:
    """A minimum that must be reached; margin = actual/required - 1.

    ``by_choice`` marks what the search keeps as small as it may be, so that its margin says nothing of the load.
    """
    return _column(name, required, actual, kind, unit, "least", by_choice)


def fits(name: str, good: Any, known: Any) -> CheckColumn:
    """A condition that is met or not, without figures."""
    good, known = np.broadcast_arrays(np.asarray(good, bool), np.asarray(known, bool))
    nothing = np.full(good.shape, np.nan)
    return CheckColumn(
        name=name,
        demand=nothing,
        limit=nothing,
        margin=nothing,
        passed=good & known,
        failed=~good & known,
        kind="dimensionless",
        unit="1",
    )


def in_order(found: list[tuple[NDArray[np.int64], list[CheckColumn]]], count: int) -> list[CheckColumn]:
    """Checks that were made for some rows at a time, put together to columns over all of them."""
    together = []
    for same in zip(*(columns for _, columns in found), strict=True):
        arrays = {}
        for name in ("demand", "limit", "margin", "passed", "failed", "time"):
            parts = [getattr(column, name) for column in same]
            if parts[0] is not None:
                arrays[name] = np.empty(count, parts[0].dtype)
                for (rows, _), part in zip(found, parts, strict=True):
                    arrays[name][rows] = part
        together.append(replace(same[0], **arrays))
    return together
