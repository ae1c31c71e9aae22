"""Estimates of what a data sheet leaves out, each with its band and its law.

A figure that is printed always wins. What decides a limit (largest speed, torque, temperature) is not estimated.
"""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.fit import Fit
from drivesizer.catalog.estimates.laws import Law, column, members_of
from drivesizer.catalog.tables import Table

__all__ = ["Estimate", "Estimates", "as_records", "estimate", "estimates_of", "kept", "written"]

_BEYOND = np.log(2.0)  # a term may lie this far outside the parts that the law was fitted to
_STRANGER = (
    2.0  # times the band, in logarithms, of a maker that no fit has seen: *assumed* where too few makers have it
)


class Estimates(NamedTuple):
    """One figure of all parts of a table; NaN and -1 where nothing is estimated. Arrays of shape (parts,), in SI."""

    value: NDArray[np.float64]
    low: NDArray[np.float64]  # 5th percentile
    high: NDArray[np.float64]  # 95th percentile
    fit: NDArray[np.int64]  # index into :func:`kept`


class Estimate(NamedTuple):
    """One figure of one part."""

    figure: str
    value: float
    low: float
    high: float
    fit: Fit


def estimate(table: Table[Any], figure: str) -> Estimates:
    """A figure of every part that lacks it, by the narrowest law whose terms the part has.

    Parameters
    ----------
    table
        Parts of one kind.
    figure
        Of a law: a column, or what is made of columns.

    Returns
    -------
    Estimates
        Value and band [SI], and by which law.
    """
    count = len(table)
    value, low, high = (np.full(count, np.nan) for _ in range(3))
    by = np.full(count, -1)
    missing, width = np.isnan(column(table, figure)), np.full(count, np.inf)
    for number, law in enumerate(kept()):
        if (law.law.section, law.law.figure) != (table.section, figure):
            continue
        middle, below, above = _by(law, table)
        better = missing & (above - below < width)
        for into, values in ((value, middle), (low, middle + below), (high, middle + above)):
            into[better] = np.exp(values[better])
        by[better], width[better] = number, (above - below)[better]
    return Estimates(value, low, high, by)


def _by(fit: Fit, table: Table[Any]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Logarithms of the figure by one law, and of the ends of its band over it; NaN where the law does not reach."""
    rows = members_of(table, fit.law.of)
    middle = np.where(rows, fit.coefficients[0], np.nan)
    for factor, name, (low, high) in zip(fit.coefficients[1:], fit.law.terms, fit.ranges, strict=True):
        term = np.log(column(table, name))
        middle += factor * np.where((term > low - _BEYOND) & (term < high + _BEYOND), term, np.nan)
    known = np.isin(table["manufacturer"], fit.makers)
    other = fit.other_makers or (_STRANGER * fit.band[0], _STRANGER * fit.band[1])
    below, above = (np.where(known, fit.band[i], other[i]) + 0.0 * middle for i in range(2))
    return middle, below, above


def estimates_of(table: Table[Any], row: int) -> list[Estimate]:
    """All that a part's data sheet leaves out and its peers give.

    Parameters
    ----------
    table
        Parts of one kind.
    row
        Of the part.

    Returns
    -------
    list
        In the order in which the laws are declared.
    """
    one = table.taken(slice(row, row + 1))
    figures = dict.fromkeys(fit.law.figure for fit in kept() if fit.law.section == table.section)
    found = ((figure, estimate(one, figure)) for figure in figures)
    return [
        Estimate(figure, float(e.value[0]), float(e.low[0]), float(e.high[0]), kept()[e.fit[0]])
        for figure, e in found
        if e.fit[0] >= 0
    ]


def as_records(table: Table[Any], row: int) -> list[dict[str, Any]]:
    """The estimates of a part for JSON: figures in SI, the band from the 5th to the 95th percentile.

    Parameters
    ----------
    table
        Parts of one kind.
    row
        Of the part.

    Returns
    -------
    list
        A record per figure: ``figure``, ``value``, ``low``, ``high``, ``terms``, ``peers``, ``parts``, ``families``.
    """
    return [
        {"figure": one.figure, "value": one.value, "low": one.low, "high": one.high, "terms": list(one.fit.law.terms),
         "peers": one.fit.law.of or one.fit.law.section, "parts": one.fit.parts, "families": one.fit.families}
        for one in estimates_of(table, row)
    ]  # fmt: skip


@cache
def kept() -> tuple[Fit, ...]:
    """The fitted laws that ship."""
    text = (resources.files("drivesizer.catalog.estimates") / "fitted.json").read_text(encoding="utf-8")
    return tuple(_read(record) for record in json.loads(text))


def _read(record: dict[str, Any]) -> Fit:
    law = Law(record["section"], record["of"], record["figure"], tuple(record["terms"]))
    beyond = tuple(record["other_makers"]) if record["other_makers"] else None
    ranges = tuple((low, high) for low, high in record["ranges"])
    return Fit(law, tuple(record["coefficients"]), tuple(record["band"]), beyond, ranges, record["parts"],
               record["families"], tuple(record["makers"]))  # fmt: skip


def written(fits: list[Fit]) -> str:
    """Fitted laws as ``fitted.json`` keeps them: a law a line, figures rounded to six digits.

    Parameters
    ----------
    fits
        Of all laws.
    """
    lines = (json.dumps(_rounded(fit.law._asdict() | fit._asdict() | {"law": None})) for fit in fits)
    return "[\n" + ",\n".join(lines) + "\n]\n"


def _rounded(record: dict[str, Any]) -> dict[str, Any]:
    return {name: _six(value) for name, value in record.items() if name != "law"}


def _six(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.6g}")
    return [_six(one) for one in value] if isinstance(value, tuple) else value
