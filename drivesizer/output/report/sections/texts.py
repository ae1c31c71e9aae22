"""Texts of a report with marks such as bold letters, and cells with numbers.

A text is a string, or a tuple of strings and of marks; PDF and HTML render a mark by the name of its class.
"""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer.units import KINDS, from_si, show

__all__ = [
    "Code", "Inline", "Mark", "Math", "Number", "Small", "Status", "Strong", "TableLink", "Text", "quantity", "text_of",
]  # fmt: skip


@dataclass(frozen=True)
class _Marked:
    text: str


class Strong(_Marked):
    """Bold letters."""


class Small(_Marked):
    """Small letters on a line of their own, below what is before them."""


class Code(_Marked):
    """Letters of one width, such as a file name."""


class Status(_Marked):
    """``pass``, ``fail`` or ``unknown`` in its colour."""


class Mark(_Marked):
    """The confidence of a figure that is not quoted, such as ``derived``; nothing where it is empty."""


@dataclass(frozen=True, slots=True)
class Math:
    """Typst mathematics, of our own declarations and of numbers only."""

    symbol: str


@dataclass(frozen=True, slots=True)
class TableLink:
    """A reference to the table of that name."""

    name: str


Inline = Strong | Small | Code | Status | Mark | Math | TableLink
Text = str | tuple[str | Inline, ...]


@dataclass(frozen=True, slots=True)
class Number:
    """A cell with a number: as it is printed, and as other programs read it."""

    text: str
    value: float | None  # None: unknown
    unit: str = "1"
    si_value: float | None = None
    si_unit: str = "1"


def quantity(value: float, unit: str, kind: str) -> Number:
    """A cell with a physical quantity.

    Examples
    --------
    >>> quantity(0.25, "mN*m", "torque").text
    '250 mN·m'
    """
    known = value == value
    return Number(
        text=show(value, unit, kind), value=float(from_si(value, unit, kind)) if known else None, unit=unit,
        si_value=value if known else None, si_unit=KINDS[kind].si,
    )  # fmt: skip


def text_of(text: Text | Number) -> str:
    """A text without its marks.

    >>> text_of(("passes on ", Strong("all"), " checks"))
    'passes on all checks'
    """
    if isinstance(text, Number):
        return text.text
    parts = (text,) if isinstance(text, str) else text
    return "".join(part if isinstance(part, str) else getattr(part, "text", "") for part in parts)
