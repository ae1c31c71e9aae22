"""Texts of the PDF report: cleaned, cut, and made breakable.

Text of a spec or a catalogue is printed letter for letter; only invisible characters, and words too long for a column,
are changed.
"""

from __future__ import annotations

import math
import re
from typing import Any

from drivesizer.output.derivation import MATHEMATICS

__all__ = ["clean", "cleaned", "margin", "minus", "short", "use"]

_BREAK = "\u200b"  # zero width space: a line may end here
_LONG = 40  # characters of a word that fit a line of text; the template handles narrower columns


def clean(text: str) -> str:
    """A text with control characters spelled out, and places to break in very long words.

    >>> clean("a\\x00b")
    'a\\\\x00b'
    """
    visible = "".join(c if c.isprintable() or c == "\n" else repr(c)[1:-1] for c in text.expandtabs(4))
    return re.sub(rf"\S{{{_LONG + 1},}}", lambda match: _broken(match.group()), visible)


def _broken(word: str) -> str:
    return _BREAK.join(word[start : start + _LONG] for start in range(0, len(word), _LONG))


def cleaned(value: Any) -> Any:
    """Every text inside nested lists and dicts, cleaned; mathematics and pictures are left alone."""
    if isinstance(value, dict):
        return {key: entry if key in _RAW else cleaned(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [cleaned(entry) for entry in value]
    return clean(value) if isinstance(value, str) else value


_RAW = {*MATHEMATICS, "svg"}  # made by us


def short(text: str, longest: int = 60) -> str:
    """A text for a line that must not wrap.

    Examples
    --------
    >>> short("a long name", 8)
    'a long …'
    """
    return text if len(text) <= longest else text[: longest - 1] + "…"


def margin(value: float) -> str:
    """A margin as it is printed, empty where there is none.

    >>> margin(0.2095), margin(-0.05), margin(10.1)
    ('+21 %', '−5.0 %', '+1010 %')
    """
    if math.isnan(value):
        return ""
    percent = 100.0 * value
    digits = f"{abs(percent):.1f}" if abs(percent) < 9.95 else f"{abs(percent):.0f}"
    sign = "" if float(digits) == 0.0 else "−" if percent < 0 else "+"
    return f"{sign}{digits} %"


def minus(figure: str) -> str:
    """A printed figure with the minus sign that margins have.

    >>> minus("-4.93 %"), minus("0.02 in 0.015..0.03")
    ('−4.93 %', '0.02 in 0.015..0.03')
    """
    return f"−{figure[1:]}" if figure.startswith("-") else figure


def use(value: float) -> float | None:
    """The used share of a limit that belongs to a margin, None where it is unknown.

    >>> use(0.25)
    0.8
    """
    if math.isnan(value):
        return None
    return 1.0 / (1.0 + value) if value > -1.0 else 99.0
