"""What each part of the page finds, and the table of all errors."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from math import sqrt
from typing import NamedTuple

import numpy as np
from measured_bands import source_of
from numpy.typing import NDArray

__all__ = ["Findings", "Row", "misses", "percent", "rms", "span", "table"]

Array = NDArray[np.float64]
_HEAD = ("quantity", "predicted", "measured", "error", "band", "predicted by", "refined", "by what")


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


def _ends(error: str) -> tuple[float, float] | None:
    """The numbers that ``percent`` or ``span`` wrote [1]; None where an error is no share."""
    found = re.fullmatch(r"(\S+) %(?: to (\S+) %)?", error.replace("−", "-"))
    if found is None:
        return None
    low, high = (float(text) / 100.0 for text in (found[1], found[2] or found[1]))
    return low, high


def _outside(row: Row) -> bool:
    """Whether an error leaves the band of its line."""
    _, band = source_of(row.quantity)
    ends = _ends(row.error)
    return band is not None and ends is not None and (ends[0] < band[0] or ends[1] > band[1])


def _cells(row: Row) -> tuple[str, ...]:
    whose, band = source_of(row.quantity)
    bounds = "" if band is None else span(np.array(band)) + (", **missed**" if _outside(row) else "")
    return row.quantity, row.predicted, row.measured, row.error, bounds, whose, row.refined, row.by


def misses(rows: Sequence[Row]) -> str:
    """The lines whose error leaves its band, as a list, the farthest off first."""
    found = [row for row in rows if _outside(row)]

    def far(row: Row) -> float:
        return -max(map(abs, _ends(row.error) or (0.0,)))

    def said(row: Row) -> str:
        whose, band = source_of(row.quantity)
        return f"- {row.quantity}: {row.error}, band {span(np.array(band))}; {whose}."

    return "\n".join(map(said, sorted(found, key=far)))


def table(rows: Sequence[Row]) -> str:
    """A Markdown table."""
    lines = [_HEAD, ("---",) * len(_HEAD), *map(_cells, rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
