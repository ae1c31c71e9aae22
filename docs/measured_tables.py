"""What each part of the page finds, and the table of all errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Findings", "Row", "percent", "rms", "span", "table"]

Array = NDArray[np.float64]
_HEAD = ("quantity", "data sheet says", "measured", "error", "refined", "by what")


class Row(NamedTuple):
    """One line of the table, as text."""

    quantity: str
    predicted: str
    measured: str
    error: str
    refined: str = ""  # the error then
    by: str = ""


class Findings(NamedTuple):
    """Lines of the table, figures by file name, numbers of the text by name."""

    rows: Sequence[Row]
    figures: Mapping[str, bytes]
    values: Mapping[str, str]


def percent(share: float) -> str:
    """A relative error with its sign."""
    return f"{round(100 * share, 1) + 0.0:+.1f} %".replace("-", "−").replace("+0.0", "0.0")


def span(shares: Array) -> str:
    """Least and greatest of relative errors."""
    return f"{percent(float(np.min(shares)))} to {percent(float(np.max(shares)))}"


def rms(values: Array) -> float:
    """Root of the mean square."""
    return sqrt(float(np.mean(values**2)))


def table(rows: Sequence[Row]) -> str:
    """A Markdown table."""
    lines = [_HEAD, ("---",) * len(_HEAD), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
