"""Cures for numbers that are written in another way: with commas, or as a ratio."""

from __future__ import annotations

import re

__all__ = ["as_quotient", "with_points"]


def with_points(text: str) -> str:
    """A number with commas as it is to be written; where they may part thousands, both ways.

    >>> with_points("45,5 kg"), with_points("1.234,5 kg"), with_points("1,234 kg"), with_points("1,234,567 g")
    ('45.5 kg', '1234.5 kg', '1.234 kg, or 1234 kg', '1234567 g')
    """
    whole, _, last = text.rpartition(",")
    if "," in whole or "." in last:
        return text.replace(",", "")
    written = f"{whole.replace('.', '')}.{last}"
    return f"{written}, or {whole}{last}" if "." not in whole and re.match(r"[0-9]{3}(?![0-9])", last) else written


def as_quotient(value: float, rest: str) -> str:
    """A ratio as the one number that is meant; empty for anything else.

    Parameters
    ----------
    value
        The number that its text starts with.
    rest
        What follows it, as the ``:3`` of 1:3.

    Returns
    -------
    str
        The cure.

    Examples
    --------
    >>> as_quotient(1.0, ":3"), as_quotient(1.0, " kg")
    ('write the quotient, 0.333333', '')
    """
    below = re.fullmatch(r"\s*[:/]\s*([0-9]+(?:\.[0-9]*)?)", rest)
    divisor = float(below.group(1)) if below else 0.0
    return f"write the quotient, {value / divisor:g}" if divisor else ""
