"""How sure the sets are, as a report prints it."""

from __future__ import annotations

from math import isfinite
from typing import Any

from drivesizer.report.wording import margin
from drivesizer.results import DriveSet, SizingResult
from drivesizer.tolerances.records import Driver, Reliability, Spread
from drivesizer.tolerances.wording import likely

__all__ = ["judged", "sure"]

_SETS = 10
_CHECKS = 12
_DRIVERS = 3


def judged(result: SizingResult) -> DriveSet | None:
    """The set of which drivers and margins are told: the best that is sure enough, else the surest."""
    return next((one for one in (*result.sets, *result.unsure) if one.reliability), None)


def sure(result: SizingResult) -> dict[str, Any] | None:
    """Sets with their probabilities, checks and drivers of one, what is uncertain; None where nothing was sampled."""
    best, told = judged(result), result.uncertainty
    if told is None or best is None or best.reliability is None:
        return None
    sets = [_set(one) for one in (*result.sets, *result.unsure)[:_SETS] if one.reliability]
    return {
        "asked": likely(told.confidence) if told.confidence is not None else "",
        "samples": f"{told.samples:,}",
        "seed": str(told.seed),
        "examined": told.examined,
        "reached": told.reached,
        "label": best.label,
        "sets": sets,
        "checks": [_check(one) for one in _moved(best.reliability)[:_CHECKS]],
        "drivers": [_driver(one) for one in best.reliability.drivers[:_DRIVERS]],
        "assumptions": [[one.title, one.text, one.source] for one in told.assumptions],
        "notes": list(told.notes),
    }


def _set(one: DriveSet) -> list[str]:
    found = one.reliability
    assert found is not None
    loop = f"{likely(found.loop.probability)} ± {100 * found.loop.error:.2g} %" if found.loop else ""
    return [one.label, likely(found.probability), f"± {100 * found.error:.2g} %", found.weakest, _shown(found.low),
            _shown(found.middle), loop]  # fmt: skip


def _shown(value: float) -> str:
    return margin(value) if isfinite(value) else "–"


def _moved(found: Reliability) -> list[Spread]:
    """The checks that samples move, those that fail most first."""
    moved = [one for one in found.checks if one.low != one.high and isfinite(one.low)]
    return sorted(moved, key=lambda one: (one.passes, one.low))


def _check(one: Spread) -> list[str]:
    return [one.title, likely(one.passes), *(_shown(value) for value in (one.low, one.middle, one.high))]


def _driver(one: Driver) -> list[str]:
    ends = [f"{_shown(value)} at {said}" for value, said in ((one.low_margin, one.low), (one.high_margin, one.high))]
    return [one.title, f"{100 * one.share:.0f} %", *ends]
