"""How sure the sets are, as a report prints it."""

from __future__ import annotations

from math import isfinite
from typing import Any

from drivesizer.output.probability import confidence, in_the_loop, likely, moved
from drivesizer.output.text import margin, minus
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Driver, LoopShare, Reliability, Spread
from drivesizer.results.sizing import SizingResult

__all__ = ["error_and_weakest", "judged", "none_as_sure", "standing", "sure"]

_SETS = 10
_CHECKS = 12
_DRIVERS = 3


def standing(result: SizingResult) -> str:
    """Whether a set was ``found``, all that stand are ``unsure``, or all were ``missed``."""
    return "found" if result.sets else "unsure" if result.unsure else "missed"


def none_as_sure(result: SizingResult) -> str:
    """That no set reaches the confidence that was asked for; empty where one does, or none stands at all."""
    if standing(result) != "unsure" or result.uncertainty is None:
        return ""
    return f"no set is as sure as {confidence(result.uncertainty.confidence)}"


def error_and_weakest(found: Reliability) -> str:
    """What is to be known beside a probability."""
    number = "1 check is" if len(found.unknown) == 1 else f"{len(found.unknown)} checks are"
    unknown = f"; {number} unknown: {'; '.join(found.unknown)}" if found.unknown else ""
    return f"{_error(found.error)}; weakest check: {found.weakest}{unknown}"


def judged(result: SizingResult) -> DriveSet | None:
    """The set of which drivers and margins are told: the best that is sure enough, else the surest."""
    return next((one for one in (*result.sets, *result.unsure) if one.reliability), None)


def sure(result: SizingResult) -> dict[str, Any] | None:
    """Sets with their probabilities, checks and drivers of one, what is uncertain; None where nothing was sampled."""
    best, told = judged(result), result.uncertainty
    if told is None or best is None or best.reliability is None:
        return None
    return {
        "asked": confidence(told.confidence) if told.confidence is not None else "",
        "samples": f"{told.samples:,}",
        "seed": str(told.seed),
        "examined": told.examined,
        "reached": told.reached,
        "none": none_as_sure(result),
        "claim": "no check fails" if best.reliability.unknown else "all checks pass",
        "chance": likely(best.reliability.probability),
        "beside": error_and_weakest(best.reliability),
        "label": best.label,
        "sets": [_set(one) for one in result.sets[:_SETS] if one.reliability],
        "unsure": [_set(one) for one in result.unsure[:_SETS] if one.reliability],
        "looped": any(one.reliability and one.reliability.loop for one in result.sets),
        "checks": [_check(one) for one in moved(best.reliability)[:_CHECKS]],
        "drivers": [_driver(one) for one in best.reliability.drivers[:_DRIVERS]],
        "assumptions": [[one.title, one.text, one.source] for one in told.assumptions],
        "notes": list(told.notes),
    }


def _set(one: DriveSet) -> dict[str, str]:
    found = one.reliability
    assert found is not None
    loop = found.loop
    more = [in_the_loop(found)] if in_the_loop(found) else []
    more += [f"unknown: {'; '.join(found.unknown)}"] if found.unknown else []
    return {
        "rank": str(one.rank),
        "label": one.label,
        "chance": likely(found.passing),
        "error": _error(found.error),
        "weakest": found.weakest,
        "more": "; ".join(more),
        "low": _shown(found.low),
        "middle": _shown(found.middle),
        "loop": _driven(loop) if loop else "",
    }


def _driven(loop: LoopShare) -> str:
    none_fails = f"{likely(loop.probability)} {_error(loop.error)}"
    return f"unknown; none fails: {none_fails}" if loop.unknown else none_fails


def _error(value: float) -> str:
    return f"± {100 * value:.2g} %"


def _shown(value: float) -> str:
    return margin(value) if isfinite(value) else "–"


def _check(one: Spread) -> list[str]:
    return [one.title, likely(one.passes), *(_shown(value) for value in (one.low, one.middle, one.high))]


def _driver(one: Driver) -> list[str]:
    ends = [
        f"{_shown(value)} at {minus(said)}" for value, said in ((one.low_margin, one.low), (one.high_margin, one.high))
    ]
    return [one.title, f"{100 * one.share:.0f} %", *ends]
