"""Figures of parts by field name, as every law takes them; columns over many candidates, and products of such.

Products go a part at a time, each too small to be worth threads, which would wait for one another. Figures of a part
are computed once for each part, not for each candidate that has it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
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
    def rows(self) -> NDArray[np.int64]:
        """Numbers of these parts in their catalogue; -1 none."""

    def on(self, rows: Any, /) -> Columns:
        """Some of them."""


class Range(NamedTuple):
    """Ends between which a figure lies, floats or columns; NaN where nobody knows one."""

    low: Figure
    high: Figure


def no_less(figure: Figure, known: NDArray[np.bool_] | np.bool_ | bool = False) -> Range:
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
    found = np.empty((len(rows), columns.shape[1]))
    wide = min(columns.shape[1], _WIDEST)
    high = max(_MULTIPLIED // (columns.shape[0] * wide), 1)
    for top in range(0, len(rows), high):
        for left in range(0, columns.shape[1], wide):
            part = slice(top, top + high), slice(left, left + wide)
            np.matmul(rows[part[0]], columns[:, part[1]], out=found[part])
    return found


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
        each: Callable[[Callable[[Figures], Result]], Result] | None = getattr(part, "each", None)
        return compute(part) if each is None else each(compute)

    return computed
