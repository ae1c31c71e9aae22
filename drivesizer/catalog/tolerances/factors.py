"""Tolerances of catalogue figures, as shares of what is printed."""

from __future__ import annotations

import re

from drivesizer.catalog.tolerances.distributions import CUT, Distribution
from drivesizer.errors import InputError, quoted
from drivesizer.units import number

__all__ = ["share"]


def share(text: str) -> Distribution | None:
    """A tolerance of a catalogue figure, as a factor: ``+- 7 %``, ``-10 %..30 %``, ``normal(5 %)``; None for ``none``.

    Examples
    --------
    >>> share("+- 7 %").high
    1.07
    """
    bare = text.strip()
    if bare == "none":
        return None
    hint = "expected +- 7 %, -10 %..30 %, normal(5 %) or none"
    width = re.fullmatch(r"(?:\+\s?/?\s?[-−]|±)\s*(.+?)", bare)
    ends, normal = re.fullmatch(r"(.+?)\s*\.\.\s*(.+)", bare), re.fullmatch(r"normal\(\s*(.+?)\s*\)", bare)
    try:
        if width or normal:
            half = _per_cent((width or normal)[1])  # type: ignore[index]
            found = (
                Distribution("normal", 1.0 - CUT * half, 1.0 + CUT * half, 1.0) if normal
                else Distribution("uniform", 1.0 - half, 1.0 + half, 1.0)
            )  # fmt: skip
        elif ends:
            low, high = 1.0 + _per_cent(ends[1]), 1.0 + _per_cent(ends[2])
            found = Distribution("uniform", low, high, (low + high) / 2.0)
        else:
            raise InputError(f"{quoted(text)} is no tolerance of a catalogue figure")
    except InputError as error:
        raise InputError(f"{error}; {hint}") from None
    if not found.low < found.high:
        raise InputError(f"{quoted(text)}: a width must be above 0; {hint}")
    if not found.low > 0.0:
        raise InputError(f"{quoted(text)} reaches 0 and below, which no such figure is; {hint}")
    return found


def _per_cent(text: str) -> float:
    value, unit = number(text)
    if unit not in ("%", ""):
        raise InputError(f"{quoted(unit)} is not per cent")
    return value / 100.0 if unit == "%" else value
