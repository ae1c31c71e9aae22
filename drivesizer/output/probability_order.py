"""Which checks of a sampled set are worth telling, and in which order."""

from __future__ import annotations

from math import inf, isfinite

from drivesizer.results.reliability import Reliability, Spread

__all__ = ["moved"]


def moved(found: Reliability) -> list[Spread]:
    """The checks that samples move or that fail in some, those that pass least often first."""
    told = [one for one in found.checks if one.fails > 0.0 or _spreads(one)]
    return sorted(told, key=lambda one: (one.passes, one.low if isfinite(one.low) else -inf))


def _spreads(one: Spread) -> bool:
    return isfinite(one.low) and one.low != one.high
