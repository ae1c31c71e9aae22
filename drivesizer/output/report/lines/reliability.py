"""The probability that a drive passes, in words and as cells of a table."""

from __future__ import annotations

from math import isfinite

from drivesizer.output.probability import confidence, likely, loop_text
from drivesizer.output.text import margin, minus
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Driver, LoopShare, Reliability, Spread
from drivesizer.results.sizing import SizingResult

__all__ = [
    "check_cells", "drive_cells", "driver_cells", "error_and_weakest", "none_reaches", "outcome", "reported",
]  # fmt: skip


def outcome(result: SizingResult) -> str:
    """``found``, ``unsure`` where no drive reaches the required confidence, or ``missed`` where all are rejected."""
    return "found" if result.sets else "unsure" if result.unsure else "missed"


def none_reaches(result: SizingResult) -> str:
    """Statement that no drive reaches the required confidence; empty where one does, or none meets all limits."""
    if outcome(result) != "unsure" or result.uncertainty is None:
        return ""
    return f"no drive reaches the confidence of {confidence(result.uncertainty.confidence)}"


def error_and_weakest(found: Reliability) -> str:
    """The error of a probability, the weakest check and the unknown ones."""
    number = "1 check is" if len(found.unknown) == 1 else f"{len(found.unknown)} checks are"
    unknown = f"; {number} unknown: {'; '.join(found.unknown)}" if found.unknown else ""
    return f"{_error(found.error)}; weakest check: {found.weakest}{unknown}"


def reported(result: SizingResult) -> DriveSet | None:
    """The drive whose margins and drivers are reported: the best that is probable enough, else the most probable."""
    return next((one for one in (*result.sets, *result.unsure) if one.reliability), None)


def drive_cells(one: DriveSet) -> dict[str, str]:
    """A drive over its samples; it must have been sampled."""
    found = one.reliability
    assert found is not None
    more = [loop_text(found)] if loop_text(found) else []
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
        "loop": _driven(found.loop) if found.loop else "",
    }


def _driven(loop: LoopShare) -> str:
    none_fails = f"{likely(loop.probability)} {_error(loop.error)}"
    return f"unknown; none fails: {none_fails}" if loop.unknown else none_fails


def _error(value: float) -> str:
    return f"± {100 * value:.2g} %"


def _shown(value: float) -> str:
    return margin(value) if isfinite(value) else "–"


def check_cells(one: Spread) -> list[str]:
    """Title, share of samples that pass, quantiles of the margin."""
    return [one.title, likely(one.passes), *(_shown(value) for value in (one.low, one.middle, one.high))]


def driver_cells(one: Driver) -> list[str]:
    """Title, share of the variance, and the smallest margin at both quantiles of the assumption."""
    ends = ((one.low_margin, one.low), (one.high_margin, one.high))
    return [one.title, f"{100 * one.share:.0f} %", *(f"{_shown(value)} at {minus(end)}" for value, end in ends)]
