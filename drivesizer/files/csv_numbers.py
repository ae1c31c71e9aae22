"""Rows of numbers of a CSV file, read in one go where all of them are plain: to columns, without a text of each."""

from __future__ import annotations

from io import StringIO

import numpy as np
from numpy.typing import NDArray

__all__ = ["plain_columns"]

Array = NDArray[np.float64]
_PLAIN = b"0123456789+-.eE, \r\n"  # of numbers that need no closer look
_PIECE = 1 << 21  # bytes that are read at a time


def plain_columns(text: bytes, below: int, rising: int, factors: list[float], most: int) -> list[Array] | None:
    """Numbers of a text in SI; None where anything needs a closer look.

    The same bits as those of ``csv_columns.values_of``, which says what is wrong and where: all round as the
    processor's doubles.
    """
    lines = text.count(b"\n", below) + (not text.endswith(b"\n"))
    if not 2 <= lines <= most:
        return None
    columns = [np.empty(lines) for _ in factors]
    start, read = below, 0
    while start < len(text):
        end = text.find(b"\n", start + _PIECE) + 1 or len(text)
        found = _values(text[start:end], len(factors))
        if found is None:
            return None
        for column, values in zip(columns, found, strict=True):
            column[read : read + len(values)] = values
        start, read = end, read + found.shape[1]
    return columns if read == lines and _in_si(columns, rising, factors) else None  # else a blank line was left out


def _values(piece: bytes, width: int) -> Array | None:
    """Values of some rows: (columns, rows)."""
    if not piece.strip() or piece.translate(None, _PLAIN):
        return None
    try:
        found = np.loadtxt(StringIO(piece.decode("ascii")), delimiter=",", comments=None, ndmin=2)
    except ValueError:
        return None
    return found.T if found.shape[1] == width else None


def _in_si(columns: list[Array], rising: int, factors: list[float]) -> bool:
    """Convert to SI; whether all are finite, and the one column rises."""
    with np.errstate(over="ignore"):  # beyond all numbers is not finite: looked at more closely
        for column, factor in zip(columns, factors, strict=True):
            column *= factor
    finite = all(np.isfinite(column).all() for column in columns)
    return finite and bool((columns[rising][1:] > columns[rising][:-1]).all())
