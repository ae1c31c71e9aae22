"""Requirements on the machine against what its motion and its equipment come to, whatever drives it."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose
from typing import TYPE_CHECKING

from drivesizer.load_cases.trip import trip
from drivesizer.results.check import Check
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.requirements import Requirements

__all__ = ["requirement_checks"]


def requirement_checks(spec: RobotSpec, required: Requirements) -> tuple[Check, ...]:
    """Time over a distance, speed of the motion, devices; each where it is required."""
    rotary = spec.load.axis == "rotary"
    return tuple(column.at((), "budget", rotary=rotary) for column in _columns(spec, required))


def _columns(spec: RobotSpec, required: Requirements) -> Iterator[CheckColumn]:
    found = trip(spec)
    if required.travel is not None:
        time = required.travel.distance / found.distance * found.time
        yield at_most("travel_time", time, required.travel.within)
    if required.speed is not None:
        reached = required.speed if isclose(required.speed, found.top_speed) else found.top_speed  # but for rounding
        yield at_least("motion_speed", required.speed, reached, by_choice=True)
    if required.devices:
        missing = [name for name in required.devices if name not in _carried(spec)]
        note = f"not among equipment, budget.others or payloads: {', '.join(missing)}" if missing else ""
        there = len(required.devices) - len(missing)
        yield at_least("devices", len(required.devices), there, by_choice=True, note=note)


def _carried(spec: RobotSpec) -> set[str]:
    """Names of all that the spec says the machine carries."""
    others = spec.budget.others if spec.budget else ()
    payloads = spec.platform.payloads if spec.platform else ()
    return {one.name for some in (spec.equipment, others, payloads) for one in some}
