"""Samples in closed loop without a cycle that begins warm: figures that such a cycle does not exceed, without a run.

A current that loops keep needs more voltage in a warmer winding, by the resistance that it gains. Twice the product of
that and of the largest current is taken, and some per cent for what loops do otherwise around another resistance:
``tests/search/test_tolerances_loop.py`` holds simulations against it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drivesizer.control.engine import MotorHeat, Simulation
from drivesizer.physics.thermal import COPPER
from drivesizer.results.sizing import Check

__all__ = ["Judged", "alike", "warm_at_most", "weakest"]

_TIMES = 2.0  # of the voltage that the gained resistance takes of the largest current
_VOLTAGE, _CURRENT = 1.02, 1.1  # by which voltage and current may differ besides


def warm_at_most(heat: MotorHeat, cold: Simulation, free: Simulation, start: Sequence[float]) -> Simulation:
    """A simulation from cold with figures that a cycle does not exceed which begins warm."""
    figures = free.figures
    hottest = max(start) + figures["winding_highest"] - heat.ambient  # as if nothing of the start were dissipated
    volts = figures["stage_voltage"]
    more = _TIMES * COPPER * heat.bodies.R_25 * (hottest - heat.ambient) * figures["current"]
    with_more = _VOLTAGE * volts + more
    drawn = _CURRENT * cold.figures["bus_current"] * (1.0 + more / np.where(volts > 0.0, volts, 1.0))
    changed = {"stage_voltage": with_more, "current_demand": _CURRENT * figures["current_demand"], "bus_current": drawn}
    return replace(free, figures={**figures, **changed})


class Judged(NamedTuple):
    """One machine against its limits in closed loop; each check passes or fails as with all simulations."""

    checks: tuple[Check, ...]  # with margins that are no smaller
    least: tuple[Check, ...]  # with margins that are no larger


def alike(checks: tuple[Check, ...]) -> Judged:
    """Checks with the margins of all simulations."""
    return Judged(checks, checks)


def weakest(found: Sequence[Judged]) -> str | None:
    """The check that fails most often, else that with the smallest margin in the mean."""
    failed = Counter(check.title for one in found for check in one.checks if check.status == "fail")
    if failed:
        return failed.most_common(1)[0][0]
    means, least = _mean_margins(one.checks for one in found), _mean_margins(one.least for one in found)
    title = min(means, key=lambda name: means[name], default="")
    sure = all(one.least is one.checks for one in found)
    return title if sure or all(means[title] < mean for name, mean in least.items() if name != title) else None


def _mean_margins(found: Iterable[tuple[Check, ...]]) -> dict[str, float]:
    """Mean of the margins of each check, by its title."""
    margins: dict[str, list[float]] = {}
    for several in found:
        for check in several:
            if check.margin == check.margin:
                margins.setdefault(check.title, []).append(check.margin)
    return {title: float(np.mean(some)) for title, some in margins.items()}
