"""A probability as it is printed."""

from __future__ import annotations

from math import ceil, log10

__all__ = ["asked_for", "likely"]


def likely(value: float) -> str:
    """A probability as a text: never 100 % where a sample fails.

    >>> likely(0.95432), likely(0.99996), likely(0.999999), likely(1.0)
    ('95.4 %', '99.996 %', '99.9999 %', '100 %')
    """
    if value in (0.0, 1.0):
        return f"{100 * value:.0f} %"
    digits = 1 if 0.001 <= value <= 0.999 else max(3, ceil(-log10(min(value, 1.0 - value))) - 2)
    return f"{100 * value:.{digits}f} %"


def asked_for(value: float | None) -> str:
    """A probability that somebody asked for, as a text: no digits that nobody wrote.

    >>> asked_for(0.9), asked_for(0.995)
    ('90 %', '99.5 %')
    """
    return f"{100.0 * (value or 0.0):.12g} %"
