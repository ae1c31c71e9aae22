"""Figures of parts by field name, as every law takes them; columns over many candidates, and products of such.

Products go a part at a time, each too small to be worth threads, which would wait for one another. Figures of a part
are computed once for each part, not for each candidate that has it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Whole = NDArray[np.int64]  # numbers, of rows or places
Figure = float | Array  # of one part or sample, or a column over many; NaN unknown
Alike = Any  # what comes of figures: a float of floats, a column where one of them is
Result = TypeVar("Result")
_MULTIPLIED = 1 << 17  # products of figures at a time
_WIDEST = 2048  # columns at a time, where these are too many


class Figures(Protocol):
    """Figures of a part by field name, SI: of one part floats and texts, of several columns; NaN or empty unknown.

    Parts of a catalogue and its tables are such figures, and so are plain dictionaries.
    """

    def __getitem__(self, name: str, /) -> Any:
        """A figure."""


class Columns(Figures, Protocol):
    """Figures of the parts of many candidates, a row each."""

    @property
    def rows(self) -> Whole:
        """Numbers of these parts in their catalogue; -1 none."""

    def on(self, rows: Any, /) -> Columns:
        """Some of them."""


class Range(NamedTuple):
    """Ends between which a figure lies, floats or columns; NaN where nobody knows one."""

    low: Figure
    high: Figure


def no_less(figure: Figure, known: Mask | np.bool_ | bool = False) -> Range:
    """A figure that may be more, but where it is known.

    Parameters
    ----------
    figure
        The least that it is.
    known
        Whether it is that: a mask, or of all.

    Returns
    -------
    Range
        Without a high end where it is not known.

    Examples
    --------
    >>> no_less(np.array([2.0, 3.0]), np.array([True, False])).high.tolist()
    [2.0, nan]
    """
    return Range(figure, np.where(known, figure, np.nan))


Record = TypeVar("Record")


def on(record: Record, rows: Any) -> Record:
    """Columns, and records of columns, at some of the candidates.

    Parameters
    ----------
    record
        A column, or records, lists and dictionaries of columns and of what has a method ``on`` itself.
    rows
        A mask, numbers or a slice.

    Returns
    -------
    record
        Of the same type; columns that are one and the same stay so.

    Examples
    --------
    >>> on({"mass": np.array([1.0, 2.0, 3.0])}, np.array([2, 0]))["mass"].tolist()
    [3.0, 1.0]
    """
    rows = np.flatnonzero(rows) if isinstance(rows, np.ndarray) and rows.dtype == bool else rows  # numbers are quicker
    known: dict[int, Any] = {}

    def at_rows(x: Any) -> Any:
        if id(x) not in known:
            if isinstance(x, np.ndarray):
                known[id(x)] = x[rows] if isinstance(rows, slice) else x.take(rows, axis=0)
            else:
                known[id(x)] = x.on(rows) if hasattr(x, "on") else _elementwise(at_rows, x)
        return known[id(x)]

    return at_rows(record)


def joined(several: Sequence[Record]) -> Record:
    """Columns over several lists of candidates as those over all of them, one list after the other.

    Parameters
    ----------
    several
        Records of one type: at least one.

    Returns
    -------
    record
        Of the same type.

    Examples
    --------
    >>> joined([Range(np.array([1.0]), np.array([2.0])), Range(np.array([5.0]), np.array([7.0]))]).high.tolist()
    [2.0, 7.0]
    """
    records: Any = several
    if len(several) == 1:
        return several[0]
    whole: Any = (
        np.concatenate(records) if isinstance(records[0], np.ndarray) else _elementwise(lambda *x: joined(x), *records)
    )
    return whole


def put(record: Record, rows: Any, replacement: Record) -> Record:
    """Columns, and records of columns, with those of some of the candidates replaced.

    Parameters
    ----------
    record, replacement
        Of all candidates and of these.
    rows
        Which these are: a mask or numbers.

    Returns
    -------
    record
        Of the same type.

    Examples
    --------
    >>> put(np.array([1, 2, 3]), np.array([True, False, True]), np.array([7, 8])).tolist()
    [7, 2, 8]
    """
    x: Any = record
    if isinstance(x, np.ndarray):
        x = x.copy()
        x[rows] = replacement
    elif hasattr(x, "with_rows"):
        x = x.with_rows(rows, replacement)
    else:
        x = _elementwise(lambda a, b: put(a, rows, b), x, replacement)
    return x


def _elementwise(make: Callable[..., Any], *records: Any) -> Any:
    """Records of one type made part by part; None stays."""
    first = records[0]
    if first is None:
        return None
    if isinstance(first, dict):
        return {name: make(*(record[name] for record in records)) for name in first}
    parts = [make(*same) for same in zip(*records, strict=True)]
    return first._make(parts) if hasattr(first, "_make") else type(first)(parts)


def bisected(low: Array, high: Array, beyond: Callable[[Array], Any], times: int) -> tuple[Array, Array]:
    """Ends of columns around the values from which on something holds, after so many halvings.

    Parameters
    ----------
    low, high
        Ends between which it begins to hold.
    beyond
        Whether it holds at values.
    times
        How often the ends are halved.

    Returns
    -------
    low, high
        At the high end it holds.

    Examples
    --------
    >>> bisected(np.array([0.0, 4.0]), np.array([8.0, 8.0]), lambda x: x * x >= 25.0, 3)
    (array([4. , 4.5]), array([5., 5.]))
    """
    for _ in range(times):
        middle = (low + high) / 2.0
        over = beyond(middle)
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    return low, high


def product(rows: Array, columns: Array) -> Array:
    """A matrix product of few figures each, ``rows @ columns``.

    Parameters
    ----------
    rows
        Shape (n, k).
    columns
        Shape (k, m).

    Returns
    -------
    array
        Shape (n, m).

    Examples
    --------
    >>> product(np.array([[1.0, 2.0]]), np.array([[3.0], [4.0]])).tolist()
    [[11.0]]
    """
    if rows.size * columns.shape[1] <= _MULTIPLIED:
        return rows @ columns
    result = np.empty((len(rows), columns.shape[1]))
    wide = min(columns.shape[1], _WIDEST)
    high = max(_MULTIPLIED // (columns.shape[0] * wide), 1)
    for top in range(0, len(rows), high):
        for left in range(0, columns.shape[1], wide):
            part = slice(top, top + high), slice(left, left + wide)
            np.matmul(rows[part[0]], columns[:, part[1]], out=result[part])
    return result


def once_per_part(compute: Callable[[Figures], Result]) -> Callable[[Figures], Result]:
    """Make a function of a part's figures use what columns of many candidates know: which part is whose.

    Parameters
    ----------
    compute
        Function of figures by field name, one part's or columns, that mixes no rows. Its result is a column or a tuple
        of columns.

    Returns
    -------
    callable
        The same function. Of figures with a method ``each`` it is what that gives.

    Examples
    --------
    >>> doubled = once_per_part(lambda part: 2.0 * part["mass"])
    >>> doubled({"mass": 0.5})
    1.0
    """

    @wraps(compute)
    def computed(part: Figures) -> Result:
        per_part: Callable[[Callable[[Figures], Result]], Result] | None = getattr(part, "per_part", None)
        return compute(part) if per_part is None else per_part(compute)

    return computed
