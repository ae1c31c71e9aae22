"""Laws fitted over the catalogues, and how far each is off for a family that it has not seen.

Least squares in logarithms. The residual of a part is that of a fit without its whole family, for parts of one family
are hardly independent; the band is the 5th and 95th percentile of these residuals. Where three makers or more have
the figure, a second band leaves the whole maker out: it serves parts of makers that are not among them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.laws import LAWS, Law, column, families_of, members_of
from drivesizer.catalog.tables import Catalog, Table

__all__ = ["Fit", "fit", "fits", "left_out"]

_PARTS, _FAMILIES, _MAKERS = 30, 4, 3  # fewer are no law: the ends of the band would be single parts
_LEVELS = (0.05, 0.95)


class Fit(NamedTuple):
    """A law with its coefficients and bands, all as natural logarithms but the counts."""

    law: Law
    coefficients: tuple[float, ...]  # the constant first
    band: tuple[float, float]  # 5th and 95th percentile of what is left, families left out
    other_makers: tuple[float, float] | None  # the same, makers left out; None where too few have the figure
    ranges: tuple[tuple[float, float], ...]  # of each term, over the parts fitted
    parts: int
    families: int
    makers: tuple[str, ...]
    source: str = ""  # of a law that is assumed, not fitted


def fits(catalog: Catalog) -> list[Fit]:
    """Every law that the parts of a catalogue suffice for.

    Parameters
    ----------
    catalog
        All shipped catalogues joined.

    Returns
    -------
    list
        In the order in which the laws are declared.
    """
    return [found for law in LAWS if (found := fit(law, catalog.table(law.section))) is not None]


def fit(law: Law, table: Table[Any]) -> Fit | None:
    """One law over the parts that have its figure and its terms; None where too few have.

    Parameters
    ----------
    law
        Figure, class and terms.
    table
        Parts of the law's kind.

    Returns
    -------
    Fit or None
        Coefficients, bands, counts.
    """
    x, y, rows = _logarithms(law, table)
    maker = table["manufacturer"][rows].astype(str)
    family = families_of(table)[rows]
    families, makers = np.unique(family), np.unique(maker)
    if len(y) < _PARTS or len(families) < _FAMILIES:
        return None
    beyond = _band(left_out(x, y, maker)) if len(makers) >= _MAKERS else None
    return Fit(
        law,
        tuple(_solved(x, y).tolist()),
        _band(left_out(x, y, family)),
        beyond,
        tuple((float(low), float(high)) for low, high in zip(x[:, 1:].min(0), x[:, 1:].max(0), strict=True)),
        len(y),
        len(families),
        tuple(makers.tolist()),
    )


def left_out(x: NDArray[np.float64], y: NDArray[np.float64], group: NDArray[np.str_]) -> NDArray[np.float64]:
    """Residual of each part by a fit without its group.

    Parameters
    ----------
    x
        Terms, a column of ones first, shape (parts, terms + 1).
    y
        Logarithms of the figure, shape (parts,).
    group
        Name of each part's group, shape (parts,).

    Returns
    -------
    NDArray
        Logarithm of printed figure over estimate, shape (parts,).
    """
    left = np.empty(len(y))
    for name in np.unique(group):
        own = group == name
        left[own] = y[own] - x[own] @ _solved(x[~own], y[~own])
    return left


def _logarithms(law: Law, table: Table[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Terms and figure in logarithms, and the rows that have both; variants of one family that are alike count once."""
    y = np.log(column(table, law.figure))
    terms = [np.log(column(table, term)) for term in law.terms]
    known = members_of(table, law.of) & np.isfinite(y) & ~table.excluded
    for term in terms:
        known &= np.isfinite(term)
    listed = np.flatnonzero(known)
    x = np.column_stack([np.ones(len(listed)), *(term[listed] for term in terms)])
    family = np.unique(table["family"][listed], return_inverse=True)[1]
    one_each = np.sort(np.unique(np.column_stack([x, y[listed], family]), axis=0, return_index=True)[1])
    return x[one_each], y[listed[one_each]], listed[one_each]


def _solved(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.linalg.lstsq(x, y, rcond=None)[0], np.float64)


def _band(left: NDArray[np.float64]) -> tuple[float, float]:
    low, high = np.quantile(left, _LEVELS)
    return float(low), float(high)
