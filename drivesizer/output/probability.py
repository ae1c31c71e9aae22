"""Probabilities as text, and the checks of a sampled drive in the order of printing."""

from __future__ import annotations

from math import ceil, inf, isfinite, log10

from drivesizer.results.reliability import Reliability, Spread

__all__ = ["about", "confidence", "likely", "loop_text", "moved"]


def likely(value: float) -> str:
    """A probability as a text: never 100 % where a sample fails; NaN is unknown.

    >>> likely(0.95432), likely(0.99996), likely(0.999999), likely(1.0)
    ('95.4 %', '99.996 %', '99.9999 %', '100 %')
    """
    if value != value:
        return "unknown"
    if value in (0.0, 1.0):
        return f"{100 * value:.0f} %"
    digits = 1 if 0.001 <= value <= 0.999 else max(3, ceil(-log10(min(value, 1.0 - value))) - 2)
    return f"{100 * value:.{digits}f} %"


def about(value: float) -> str:
    """A probability out of a hundred samples or so, in whole per cent; empty where there is none.

    >>> about(0.648), about(1.0), about(float("nan"))
    ('about 65 %', 'about 99 %', '')
    """
    return "" if value != value else f"about {min(max(round(100 * value), 1), 99)} %"


def loop_text(found: Reliability) -> str:
    """The failing check in closed loop, or why none was simulated; empty where all pass or none was required."""
    if found.no_loop:
        return f"not simulated in closed loop: {found.no_loop}"
    return f"in closed loop: {found.loop.weakest}" if found.loop and found.loop.probability < 1.0 else ""


def confidence(value: float | None) -> str:
    """A required probability as text, with the digits of the spec.

    >>> confidence(0.9), confidence(0.995)
    ('90 %', '99.5 %')
    """
    return f"{100.0 * (value or 0.0):.12g} %"


def moved(found: Reliability) -> list[Spread]:
    """The checks that vary over the samples or fail in some, lowest probability first."""
    varying = [one for one in found.checks if one.fails > 0.0 or (isfinite(one.low) and one.low != one.high)]
    return sorted(varying, key=lambda one: (one.passes, one.low if isfinite(one.low) else -inf))
