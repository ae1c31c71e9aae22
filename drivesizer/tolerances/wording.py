"""A probability as it is printed."""

from __future__ import annotations

__all__ = ["likely"]


def likely(value: float) -> str:
    """A probability as a text: never 100 % where a sample fails.

    >>> likely(0.95432), likely(0.99996), likely(1.0)
    ('95.4 %', '99.996 %', '100 %')
    """
    if value in (0.0, 1.0):
        return f"{100 * value:.0f} %"
    digits = 1 if 0.001 <= value <= 0.999 else 3
    return f"{100 * value:.{digits}f} %"
