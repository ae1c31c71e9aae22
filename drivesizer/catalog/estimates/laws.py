"""Log-linear laws by which figures follow from others, declared once, and fitted over the catalogues."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.expressions import value
from drivesizer.catalog.tables import Catalog, Table, as_printed
from drivesizer.files.text import listed
from drivesizer.files.yaml_source import shipped_data


class Law(NamedTuple):
    """One figure of one class of parts, from terms in logarithms."""

    section: str
    of: str  # class of parts, "" for all
    figure: str
    terms: tuple[str, ...]  # columns, or names of ``_FIGURES``


ROWS = (*listed("drivesizer.catalog.estimates", "laws.txt"),)


def _declared() -> Iterator[Law]:
    for head, (figure, choices, *left) in ROWS:
        section, _, classes = head.partition(": ")
        for terms in choices.split(";") if ": " in head else ():
            names = tuple(term for term in terms.split() if term != "-")
            each = (of.strip() for of in classes.split(","))
            yield from (Law(section, of, figure, names) for of in each if of not in left)


LAWS: tuple[Law, ...] = tuple(_declared())


class _Figure(NamedTuple):
    """Figure that is no column of its own: known where all that it is made of is."""

    value: str
    column: str = ""  # that it gives
    given: str = ""  # and how; what no drive is sized by is left out


_FIGURES = {name: _Figure(*rest) for head, (name, *rest) in ROWS if head == "figures"}


def column(table: Table[Any], name: str) -> NDArray[np.float64]:
    """A column of a law, as the catalogue has it or made from it; NaN where that is unknown or not above 0."""
    one = _FIGURES.get(f"{table.section} {name}")
    values = value(one.value, table) if one else table[name]
    return np.where(values > 0.0, values, np.nan)


def given_column(table: Table[Any], figure: str, values: NDArray[np.float64]) -> tuple[str, NDArray[np.float64]]:
    """The column that a law's figure gives, with its values."""
    one = _FIGURES.get(f"{table.section} {figure}")
    if one is None or not one.column:
        return figure, values
    return one.column, np.asarray(value(one.given, table, figure=values))


def members_of(table: Table[Any], of: str) -> NDArray[np.bool_]:
    """Mask of the parts of a class."""
    if not of:
        return np.ones(len(table), bool)
    if table.section == "motors" and of not in ("brushed", "brushless"):
        return np.asarray(_motor_constructions(table) == of, np.bool_)
    by_gearing = table.section == "actuators" and of not in ("brushed", "brushless")
    rows: NDArray[np.bool_] = table["gearing" if by_gearing else "kind"] == of
    if table.section == "gearheads":
        rows &= table["ratio"] > 1.0  # none is a gearhead of its own in the table
    return rows


def families_of(table: Table[Any]) -> NDArray[np.str_]:
    """Maker and family of each part, with a line's end between: families of two makers may have one name."""
    return np.char.add(np.char.add(table["manufacturer"].astype(str), "\n"), table["family"].astype(str))


def constructions_of(table: Table[Any]) -> NDArray[np.str_]:
    """Construction of each part, finer than most classes of laws."""
    names = {"gearheads": ("kind",), "actuators": ("kind", "gearing")}.get(table.section, ())
    columns = [table[name].astype(str) for name in names]
    if table.section == "motors":
        columns = [_motor_constructions(table)]
    return np.array(columns, np.str_).reshape(len(columns), len(table))


def _motor_constructions(table: Table[Any]) -> NDArray[np.str_]:
    kind = table["kind"].astype(str)
    names, back = np.unique(families_of(table), return_inverse=True)
    return np.where(kind == "brushless", np.array([_construction(n) for n in names.tolist()])[back], kind)


@cache
def _construction(name: str) -> str:
    """Construction of the brushless motors of a maker's family."""
    maker, family = name.split("\n", 1)
    patterns = shipped_data("drivesizer.catalog.estimates", "constructions.yaml")
    return next((p["construction"] for p in patterns if p["maker"] == maker and re.match(p["family"], family)), "")


# -- Laws fitted over the catalogues, and how far each is off for a family that it has not seen.
#
# Least squares in logarithms. The residual of a part is that of a fit without its whole family, for parts of one
# family are hardly independent. Away from the centre of its peers a law knows less, as an interval of prediction
# says:
#
# .. math:: w = \sqrt{1 + h}, \quad h = 1/n + (x - c)^T S^{-1} (x - c)
#
# with n families, each of weight 1 however many parts it has, their centre c and scatter S. The band is the 5th and
# 95th percentile of the residuals over w, each with the peers that its fit has seen, and a part's band is w times
# that. Where three makers or more have the figure, a second band leaves the whole maker out: it serves parts of
# makers that are not among the peers.
#
# References ---------- .. [1] N. Draper, H. Smith, *Applied Regression Analysis*, 3rd ed., Wiley 1998, section 3.1:
# interval of prediction.


_PARTS, _FAMILIES, _MAKERS = 30, 4, 3  # fewer are no law: the ends of the band would be single parts
_SAME = 7  # digits of logarithms that make two figures one: 27/7 is 3.857142857 too, and last digits go by processor
_OF_ONE = 2  # families that make a construction one of the peers: with one left out the law has still seen it
_LEVELS = (0.05, 0.95)
Array = NDArray[np.float64]


class Peers(NamedTuple):
    """Centre and scatter of the parts of a law, each family of weight 1."""

    families: int
    centre: tuple[float, ...]  # mean logarithm of each term
    precision: tuple[tuple[float, ...], ...]  # inverse of their scatter, the sum of products of deviations


class Fit(NamedTuple):
    """A law with its coefficients and bands, all as natural logarithms but the counts."""

    law: Law
    coefficients: tuple[float, ...]  # the constant first
    band: tuple[float, float]  # 5th and 95th percentile of what is left at the peers' centre, families left out
    other_makers: tuple[float, float] | None  # the same, makers left out; None where too few have the figure
    ranges: tuple[tuple[float, float], ...]  # of each term, over the parts fitted
    parts: int
    families: int
    makers: tuple[str, ...]
    source: str = ""  # of a law that is assumed, not fitted
    constructions: tuple[str, ...] = ()  # of its peers, as ``constructions_of`` names them
    peers: Peers | None = None  # None of a law that is assumed: its band is the same everywhere
    width: float = 1.0  # median widening over the parts fitted


def fits(catalog: Catalog) -> list[Fit]:
    """Every law that the parts of a catalogue suffice for."""
    printed = as_printed(catalog)
    return [found for law in LAWS if (found := fit(law, printed.table(law.section))) is not None]


def fit(law: Law, table: Table[Any]) -> Fit | None:
    """One law over the parts that have its figure and its terms; None where too few have."""
    x, y, rows = _logarithms(law, table)
    maker = table["manufacturer"][rows].astype(str)
    family, built = families_of(table)[rows], constructions_of(table)[:, rows]
    families, makers = np.unique(family), np.unique(maker)
    if len(y) < _PARTS or len(families) < _FAMILIES:
        return None
    _, back, count = np.unique(family, return_inverse=True, return_counts=True)
    weight = np.asarray(1.0 / count[back])  # one over the members of each part's family
    peers = _peers(x[:, 1:], weight)
    wide = widening(peers, x[:, 1:])  # what a whole maker is off by is not for the others' scatter to explain
    return Fit(
        law,
        tuple(_solved(x, y).tolist()),
        _band(left_out(x, y, family, weight)),
        _band(left_out(x, y, maker) / wide) if len(makers) >= _MAKERS else None,
        tuple((float(low), float(high)) for low, high in zip(x[:, 1:].min(0), x[:, 1:].max(0), strict=True)),
        len(y),
        len(families),
        tuple(makers.tolist()),
        constructions=_seen(built, family),
        peers=peers,
        width=float(np.median(wide)),
    )


def left_out(x: Array, y: Array, group: NDArray[np.str_], weight: Array | None = None) -> Array:
    """Residual of each part by a fit without its group; with weights over the widening by the peers outside of it."""
    left = np.empty(len(y))
    for name in np.unique(group):
        own = group == name
        left[own] = y[own] - x[own] @ _solved(x[~own], y[~own])
        if weight is not None:
            left[own] /= widening(_peers(x[~own, 1:], weight[~own]), x[own, 1:])
    return left


def widening(peers: Peers, x: Array) -> Array:
    """Factor of the band for distance from the peers, at least 1."""
    away = x - np.array(peers.centre)
    precision = np.array(peers.precision).reshape(2 * x.shape[1:])
    return np.asarray(np.sqrt(1.0 + 1.0 / peers.families + np.einsum("pi,ij,pj->p", away, precision, away)))


def _peers(x: Array, weight: Array) -> Peers:
    centre = weight @ x / weight.sum()
    away = x - centre
    precision = np.linalg.pinv((weight[:, None] * away).T @ away, hermitian=True)
    return Peers(round(weight.sum()), tuple(centre.tolist()), tuple(map(tuple, precision.tolist())))


def _seen(built: NDArray[np.str_], family: NDArray[np.str_]) -> tuple[str, ...]:
    """Constructions with families enough among the peers."""
    names = (name for name in np.unique(built).tolist() if name)
    having = {name: np.unique(family[(built == name).any(axis=0)]) for name in names}
    return tuple(name for name, families in having.items() if len(families) >= _OF_ONE)


def _logarithms(law: Law, table: Table[Any]) -> tuple[Array, Array, NDArray[np.int64]]:
    """Terms and figure in logarithms, and the rows that have both; variants of one family that are alike count once."""
    y = np.log(column(table, law.figure))
    terms = [np.log(column(table, term)) for term in law.terms]
    known = members_of(table, law.of) & np.isfinite(y) & ~table.excluded
    for term in terms:
        known &= np.isfinite(term)
    listed = np.flatnonzero(known)
    x = np.column_stack([np.ones(len(listed)), *(term[listed] for term in terms)])
    family = np.unique(table["family"][listed], return_inverse=True)[1]
    alike = np.round(np.column_stack([x, y[listed], family]), _SAME)
    one_each = np.sort(np.unique(alike, axis=0, return_index=True)[1])
    return x[one_each], y[listed[one_each]], listed[one_each]


def _solved(x: Array, y: Array) -> Array:
    return np.asarray(np.linalg.lstsq(x, y, rcond=None)[0], np.float64)


def _band(left: Array) -> tuple[float, float]:
    low, high = np.quantile(left, _LEVELS)
    return float(low), float(high)
