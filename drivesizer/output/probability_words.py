"""A probability as it is printed."""

from __future__ import annotations

from math import ceil, log10

from drivesizer.results.reliability import Reliability

__all__ = ["asked_for", "in_the_loop", "likely"]


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


def in_the_loop(found: Reliability) -> str:
    """What fails in closed loop, or why nothing was driven there; empty where all is well or nothing was asked."""
    if found.no_loop:
        return f"not driven in closed loop: {found.no_loop}"
    return f"in closed loop: {found.loop.weakest}" if found.loop and found.loop.probability < 1.0 else ""


def asked_for(value: float | None) -> str:
    """A probability that somebody asked for, as a text: no digits that nobody wrote.

    >>> asked_for(0.9), asked_for(0.995)
    ('90 %', '99.5 %')
    """
    return f"{100.0 * (value or 0.0):.12g} %"
