"""Estimates of what a data sheet leaves out, each with its band and its law.

A figure that is printed always wins. What decides a limit (largest speed, torque, temperature) is not estimated from
peers; the peak torque of an actuator that prints none lies between two figures of its own.
"""

from __future__ import annotations

import json
from collections.abc import Collection
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.assumed import ASSUMED, estimates_by_rated_current, peak_torque_estimates
from drivesizer.catalog.estimates.fit import Fit, Peers, widening
from drivesizer.catalog.estimates.laws import Law, column, constructions_of, given_column, members_of
from drivesizer.catalog.tables import Estimates, Table

__all__ = [
    "Estimate",
    "as_records",
    "estimates",
    "estimates_of",
    "law_text",
    "shipped_laws",
    "written",
]

_BEYOND = np.log(2.0)  # a term may lie this far outside the parts that the law was fitted to
_STRANGER = 2.0  # times the band, in logarithms, of a maker or construction not seen: assumed where too few have it
_LAST = 1e3  # added to widths, in logarithms, of laws without peers of a part's construction
Array = NDArray[np.float64]


class Estimate(NamedTuple):
    """One figure of one part."""

    figure: str
    value: float
    low: float
    high: float
    fit: Fit


class _Term(NamedTuple):
    """A term of a law: its logarithm, and how far the ends of its own band are where it is estimated itself."""

    middle: Array
    below: Array
    above: Array


def estimates(table: Table[Any], only: Collection[Fit] = ()) -> dict[str, Estimates]:
    """Every figure that parts of a table lack, by the narrowest law whose terms the part has.

    Laws with parts of its construction among their peers go before all others.
    A term may be an estimate itself, of a figure that is declared before: its band then widens that of the result.
    """
    found: dict[str, Estimates] = {}
    terms: dict[str, _Term] = {}
    laws = [(number, fit) for number, fit in enumerate(shipped_laws()) if fit.law.section == table.section]
    given = {fit.law.figure for fit in only}
    laws = [(number, fit) for number, fit in laws if fit in only or fit.law.figure not in given]
    for figure in dict.fromkeys(fit.law.figure for _, fit in laws):
        one = _estimate(table, figure, [law for law in laws if law[1].law.figure == figure], terms)
        if len(one.rows):
            name, found_of = _column_estimates(table, figure, one)
            found |= {name: found_of} if len(found_of.rows) else {}
            terms[figure] = _completed(_printed(table, figure), one)
    return peak_torque_estimates(table, estimates_by_rated_current(table, found))


def _column_estimates(table: Table[Any], figure: str, one: Estimates) -> tuple[str, Estimates]:
    """Estimates of a column from one figure, of those parts that lack it."""
    some = table.taken(one.rows)
    values = [given_column(some, figure, values) for values in (one.value, one.low, one.high)]
    name, middle = values[0]
    keep = np.isnan(some[name]) & ~np.isnan(middle)
    ends = np.sort([end[keep] for _, end in values[1:]], axis=0)
    return name, Estimates(one.rows[keep], middle[keep], ends[0], ends[1], one.fit[keep])


def _estimate(table: Table[Any], figure: str, laws: list[tuple[int, Fit]], terms: dict[str, _Term]) -> Estimates:
    count, constructions = len(table), constructions_of(table)
    band, by = np.full((3, count), np.nan), np.full(count, -1)
    missing, width = np.isnan(column(table, figure)), np.full(count, np.inf)
    for number, law in laws if missing.any() else ():
        stranger = ~_same_construction(law, constructions)
        found = _law_value(law, table, terms, stranger)
        spread = found.above - found.below + np.where(stranger, _LAST, 0.0)
        better = missing & (spread < width) & ((by < 0) | (law.source == ""))
        for place, side in enumerate((np.zeros(count), found.below, found.above)):
            band[place][better] = np.exp(found.middle + side)[better]
        by[better], width[better] = number, spread[better]
    rows = np.flatnonzero(by >= 0)
    value, low, high = band[:, rows]
    return Estimates(rows, value, low, high, by[rows])


def _same_construction(fit: Fit, constructions: NDArray[np.str_]) -> NDArray[np.bool_]:
    """Mask of the parts that are built as some peers of a law are; all where either is not known."""
    known = constructions if fit.constructions else np.full_like(constructions, "")
    return np.asarray(np.isin(known, ("", *fit.constructions)).all(axis=0))


def _law_value(fit: Fit, table: Table[Any], terms: dict[str, _Term], stranger: NDArray[np.bool_]) -> _Term:
    """The figure by one law; NaN where the law does not reach. Errors of terms add to it as independent ones."""
    taken = [terms[name] if name in terms else _printed(table, name) for name in fit.law.terms]
    x = np.column_stack([np.zeros((len(table), 0)), *(term.middle for term in taken)])
    wider = widening(fit.peers, x) if fit.peers else np.ones(len(table))
    middle: Array = np.where(members_of(table, fit.law.of), fit.coefficients[0], np.nan)
    below, above = ((wider * end) ** 2 for end in _ends(fit, table, stranger))
    for factor, term, (low, high) in zip(fit.coefficients[1:], taken, fit.ranges, strict=True):
        inside = (term.middle > low - _BEYOND) & (term.middle < high + _BEYOND)
        middle += factor * np.where(inside, term.middle, np.nan)
        ends = (term.below, term.above) if factor > 0.0 else (term.above, term.below)
        below, above = below + (factor * ends[0]) ** 2, above + (factor * ends[1]) ** 2
    return _Term(middle, -np.sqrt(below) + 0.0 * middle, np.sqrt(above) + 0.0 * middle)


def _ends(fit: Fit, table: Table[Any], stranger: NDArray[np.bool_]) -> Array:
    """Ends of the band at the peers' centre: the widest band that maker and construction of a part call for."""
    twice = (_STRANGER * fit.band[0], _STRANGER * fit.band[1])
    maker = ~np.isin(table["manufacturer"], fit.makers)
    found = np.tile(np.array(fit.band)[:, None], len(table))
    for other, ends in ((maker, fit.other_makers or twice), (stranger, twice)):
        wider = other & (ends[1] - ends[0] > found[1] - found[0])
        found[:, wider] = np.array(ends)[:, None]
    return found


def _printed(table: Table[Any], name: str) -> _Term:
    exact = np.zeros(len(table))
    return _Term(np.log(column(table, name)), exact, exact)


def _completed(term: _Term, found: Estimates) -> _Term:
    """A term with what was estimated of it."""
    columns = [values.copy() for values in term]
    estimated = (found.value, found.low / found.value, found.high / found.value)
    for into, values in zip(columns, estimated, strict=True):
        into[found.rows] = np.log(values)
    return _Term(*columns)


def estimates_of(table: Table[Any], row: int) -> list[Estimate]:
    """All that a part's data sheet leaves out and its peers give."""
    found = estimates(table.taken(slice(row, row + 1)))
    return [
        Estimate(figure, float(e.value[0]), float(e.low[0]), float(e.high[0]), shipped_laws()[e.fit[0]])
        for figure, e in found.items()
    ]


def as_records(table: Table[Any], row: int) -> list[dict[str, Any]]:
    """The estimates of a part for JSON: figures in SI, the band from the 5th to the 95th percentile."""
    return [
        {"figure": one.figure, "value": one.value, "low": one.low, "high": one.high, "terms": list(one.fit.law.terms),
         "peers": one.fit.source or one.fit.law.of or one.fit.law.section, "parts": one.fit.parts,
         "families": one.fit.families}
        for one in estimates_of(table, row)
    ]  # fmt: skip


def law_text(fit: Fit) -> str:
    """A law in words: its terms, and the parts it was fitted to.

    >>> law = Law("motors", "brushed", "rotor_inertia", ("mass", "diameter"))
    >>> in_words(Fit(law, (0, 1, 1), (-0.3, 0.3), None, (), 309, 32, ("m",)))
    'mass, diameter; 309 brushed motors, 32 families'
    """
    terms = ", ".join(term.replace("_", " ") for term in fit.law.terms)
    if fit.source:
        return f"{terms}; assumed: {fit.source}".removeprefix("; ")
    peers = f"{fit.parts} {fit.law.of} {fit.law.section}".replace("  ", " ")
    return f"{terms or 'all alike'}; {peers}, {fit.families} {'family' if fit.families == 1 else 'families'}"


@cache
def shipped_laws() -> tuple[Fit, ...]:
    """The fitted laws that ship, and behind them those that are assumed."""
    text = (resources.files("drivesizer.catalog.estimates") / "fitted.json").read_text(encoding="utf-8")
    return (*(_read(record) for record in json.loads(text)), *ASSUMED)


def _read(record: dict[str, Any]) -> Fit:
    law = Law(record["section"], record["of"], record["figure"], tuple(record["terms"]))
    beyond = tuple(record["other_makers"]) if record["other_makers"] else None
    ranges = tuple((low, high) for low, high in record["ranges"])
    peers = Peers(record["families"], tuple(record["centre"]), tuple(map(tuple, record["precision"])))
    return Fit(law, tuple(record["coefficients"]), tuple(record["band"]), beyond, ranges, record["parts"],
               record["families"], tuple(record["makers"]), constructions=tuple(record["constructions"]),
               peers=peers)  # fmt: skip


def written(fits: list[Fit]) -> str:
    """Fitted laws as ``fitted.json`` keeps them: a law a line, figures rounded to six digits.

    ``width`` is the upper end of the band over the lower one, median over the parts of the law.
    """
    lines = (json.dumps(_rounded(_record(fit))) for fit in fits)
    return "[\n" + ",\n".join(lines) + "\n]\n"


def _record(fit: Fit) -> dict[str, Any]:
    centre = fit.peers._asdict() if fit.peers else {}
    width = float(np.exp(fit.width * (fit.band[1] - fit.band[0])))
    return fit.law._asdict() | fit._asdict() | centre | {"width": width}


def _rounded(record: dict[str, Any]) -> dict[str, Any]:
    return {name: _six(value) for name, value in record.items() if name not in ("law", "source", "peers")}


def _six(value: Any) -> Any:
    if isinstance(value, float):
        return float(f"{value:.6g}")
    return [_six(one) for one in value] if isinstance(value, tuple) else value
