"""Estimates of what a data sheet leaves out, each with its band and its law: fitted over the catalogues, or assumed.

``estimates.txt`` declares which figure follows from which others within which class of parts. The laws are fitted over
the shipped catalogues, each measured on families that were left out, and applied; ``estimates.json`` keeps what was
found: ``python -m drivesizer.catalog.estimates > estimates.json`` prints it anew.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator
from fractions import Fraction
from functools import cache
from importlib import resources
from math import exp, inf, log
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.laws import value
from drivesizer.catalog.tables import Catalog, Estimates, Table, as_printed
from drivesizer.files.text import listed
from drivesizer.files.yaml_source import shipped_data
from drivesizer.physics.stepper import PULL_OUT_SHARE, START_BAND
from drivesizer.physics.thermal import continuous_current, rated_ambient, resistance_25, steady_winding_temperature


class Law(NamedTuple):
    """One figure of one class of parts, from terms in logarithms."""

    section: str
    of: str  # class of parts, "" for all
    figure: str
    terms: tuple[str, ...]  # columns, or names of ``_FIGURES``


ROWS = (*listed("drivesizer.catalog", "estimates.txt"),)


def _declared() -> Iterator[Law]:
    for head, (figure, choices, *left) in ROWS:
        section, _, classes = head.partition(": ")
        for terms in choices.split(";") if ": " in head else ():
            names = tuple(term for term in terms.split() if term != "-")
            class_names = (of.strip() for of in classes.split(","))
            yield from (Law(section, of, figure, names) for of in class_names if of not in left)


LAWS: tuple[Law, ...] = tuple(_declared())


class _Figure(NamedTuple):
    """Figure that is no column of its own: known where all that it is made of is."""

    value: str
    column: str = ""  # that it gives
    condition: str = ""  # and how; what no drive is sized by is left out


_FIGURES = {name: _Figure(*rest) for head, (name, *rest) in ROWS if head == "figures"}


def column(table: Table[Any], name: str) -> NDArray[np.float64]:
    """A column of a law, as the catalogue has it or made from it; NaN where that is unknown or not above 0."""
    definition = _FIGURES.get(f"{table.section} {name}")
    values = value(definition.value, table) if definition else table[name]
    return np.where(values > 0.0, values, np.nan)


def given_column(table: Table[Any], figure: str, values: NDArray[np.float64]) -> tuple[str, NDArray[np.float64]]:
    """The column that a law's figure gives, with its values."""
    definition = _FIGURES.get(f"{table.section} {figure}")
    if definition is None or not definition.column:
        return figure, values
    return definition.column, np.asarray(value(definition.condition, table, figure=values))


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
    patterns = shipped_data("drivesizer.catalog", "constructions.yaml")
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
    return [law_fit for law in LAWS if (law_fit := fit(law, printed.table(law.section))) is not None]


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


CONVECTION = 10.0  # W/m^2 K
DENSITY = 2000.0  # kg/m^3, of an actuator whole
_HOTTEST = 453.15  # K, thermal class 180 (H) of IEC 60085
_R_TH = ("thermal_resistance_winding", "thermal_resistance_housing")
_TAU = ("winding_time_constant", "motor_time_constant")
_LEAST = {"brushed": 358.15, "brushless": 373.15}  # K: 85 and 100 degC, of 326 and 356 motors that print one
_STALL = {"nominal_torque": "stall_torque", "nominal_current": "stall_current"}
_LEAST_SHARE = 0.2  # of its stall torque that an actuator is rated for, for a moment: makers of servos advise as much
_ABOVE = 1.14  # of k_t I_N, which printed torques of slotted motors reach, as the law in ``laws.yaml`` has it
_MOST = 10.0  # times its continuous torque, for a moment; of the 201 that print both 192 have 1.3 to 5, 196 up to 10


def _assumed() -> Iterator[Fit]:
    """Laws that are assumed; behind them the rules that are no formula, in the order of ``estimates.txt``."""
    named = {
        "density": DENSITY, "convection": CONVECTION, "pull_out_share": PULL_OUT_SHARE[0],
        "pull_out_band": PULL_OUT_SHARE[1], "start_band": START_BAND,
    }  # fmt: skip
    for name, factor, terms, band, source in (cells for head, cells in ROWS if head == "assumed"):
        section, figure, *of = name.split()
        exponents = dict(term.split() for term in terms.split(",") if term)
        law, wide = Law(section, "".join(of), figure, tuple(exponents)), log(value(band, named))
        coefficients = (log(value(factor, named)), *(float(Fraction(x)) for x in exponents.values()))
        yield Fit(law, coefficients, (-wide, wide), (-wide, wide), ((-inf, inf),) * len(exponents), 0, 0, (), source)
    for _, figure, terms, source in (cells for head, cells in ROWS if head == "rules"):
        named_terms = tuple(term.strip() for term in terms.split(",") if term)
        yield Fit(Law("", "", figure, named_terms), (), (0.0, 0.0), (0.0, 0.0), (), 0, 0, (), source)


ASSUMED: tuple[Fit, ...] = tuple(_assumed())
UNRATED, RULE, _OF_STALL, _UP_TO_STALL, MOUNTED, _RATED = range(-6, 0)  # numbers of the rules among all laws: the last


def assumed_mass(section: str) -> tuple[float, float, float]:
    """Mass of an encoder or controller of which nothing is known: value, 5th and 95th percentile [kg].

    >>> [round(mass, 3) for mass in assumed_mass("encoders")]
    [0.02, 0.008, 0.05]
    """
    own = next(fit for fit in ASSUMED if (fit.law.section, fit.law.figure) == (section, "mass"))
    value = exp(own.coefficients[0])
    low, high = own.band
    return value, value * exp(low), value * exp(high)


def estimates_by_rated_current(table: Table[Any], estimates: dict[str, Estimates]) -> dict[str, Estimates]:
    """Estimates in accord with the printed nominal current.

    What it gives beside the printed torque no friction takes: k_t (I_N - I_0) is no less. At that current no winding is
    hotter in the long run than is permitted, or than the best thermal class is where no permitted temperature is
    printed: estimated thermal resistances are no larger. What such a winding then reaches the maker permits, by the
    part's own rating and that of no other part. A brushed motor, of which brushes or gears may set the rating, permits
    anything from there to the best class.
    """
    if "max_winding_temperature" not in table.columns:
        return estimates
    unstated, rating = np.isnan(table["max_winding_temperature"]), _rated_current(table)
    if table.section == "motors" and (idle := estimates.get("no_load_current")):
        for_torque = np.minimum(table["nominal_torque"] / table["torque_constant"], rating) / _ABOVE
        most = (rating - np.nan_to_num(for_torque))[idle.rows]
        low, high = np.fmin(idle.low, most), np.fmin(idle.high, most)
        value = np.where(idle.value > high, np.sqrt(low * high), idle.value)
        estimates = estimates | {"no_load_current": idle._replace(value=value, low=low, high=high)}
    winding, housing = (_filled(table, estimates, name) for name in _R_TH)
    printed, R_winding = table["max_winding_temperature"], np.ones(len(table))
    hottest = np.where(unstated, _HOTTEST, printed)
    current = continuous_current(
        np.asarray(resistance_25(table)), R_winding, 0.0 * R_winding, hottest, rated_ambient(table)
    )
    with np.errstate(invalid="ignore", divide="ignore"):  # the resistance with which it brings about what is permitted
        largest = np.asarray(current / rating) ** 2
    share = np.fmin(1.0, largest / (winding + housing))
    limited = {name: _scaled(estimates[name], share) for name in _R_TH if name in estimates}
    times = {name: _scaled(estimates[name], share[:1].repeat(3, 0)) for name in _TAU if name in estimates}
    estimates = estimates | limited | times
    R_winding, R_housing = (_filled(table, estimates, name) for name in _R_TH)
    warm = np.asarray(
        steady_winding_temperature(rated_ambient(table), resistance_25(table), R_winding, R_housing, rating)
    )
    rows = np.flatnonzero(unstated & (warm < _HOTTEST + 0.1).all(axis=0))
    value, low, high = warm[:, rows]
    brushed = table["kind"][rows] == "brushed"
    least = np.fmax(table["ambient_max"][rows], _LEAST["brushed"])  # it runs in that ambient
    low = np.where(brushed, np.fmax(high, least), low)
    high = np.where(brushed, np.fmax(_HOTTEST + 0.1, low), high)
    value = np.where(brushed, (low + high) / 2.0, value)
    rated = Estimates(rows, value, low, high, np.full(len(rows), _RATED))
    rest = np.setdiff1d(np.flatnonzero(unstated & np.isnan(rating)), rows)
    rest = rest[np.isin(table["kind"][rest], tuple(_LEAST))]  # that print neither it nor a rating
    least = np.array([_LEAST[kind] for kind in table["kind"][rest].tolist()], float)
    most = np.full(len(rest), _HOTTEST)
    unrated = Estimates(rest, np.sqrt(least * most), least, most, np.full(len(rest), UNRATED))
    sides: list[NDArray[Any]] = [np.concatenate(columns) for columns in zip(rated, unrated, strict=True)]
    order = np.argsort(sides[0])
    temperatures = Estimates(*(column[order] for column in sides))
    return estimates | {"max_winding_temperature": temperatures} if len(order) else estimates


def _rated_current(table: Table[Any]) -> NDArray[np.float64]:
    """The nominal current; where none is printed that of the nominal torque [A]."""
    k_t = _output_constant(table) if table.section == "actuators" else table["torque_constant"]
    by_torque = table["nominal_torque"] / k_t + np.nan_to_num(table["no_load_current"])
    return np.where(np.isnan(table["nominal_current"]), by_torque, table["nominal_current"])


def _output_constant(table: Table[Any]) -> NDArray[np.float64]:
    """Torque at the output of actuators per ampere, the losses of the gear included."""
    inner = table["ratio"] * table["efficiency"] * table["motor_torque_constant"]
    return np.asarray(np.where(np.isnan(inner), table["torque_constant"], inner))


def peak_torque_estimates(table: Table[Any], estimates: dict[str, Estimates]) -> dict[str, Estimates]:
    """Estimates with ratings that actuators do not print: peaks from the continuous figure to that at stall.

    A peak current is at least that of a printed peak torque; a continuous torque is a tenth to all of the peak.

    Where no stall is printed either nothing bounds it: the middle is that of a band up to ten times the continuous one.
    """
    if table.section != "actuators":
        return estimates
    more = dict[str, Estimates]()

    def between(name: str, low: NDArray[np.float64], usual: NDArray[np.float64], high: NDArray[np.float64]) -> None:
        rows = np.flatnonzero(np.isnan(table[name]) & (low < usual))
        if len(rows):
            middle, law = np.sqrt(low * usual)[rows], np.full(len(rows), _UP_TO_STALL)
            more[name] = Estimates(rows, middle, low[rows], high[rows], law)

    at_peak = table["peak_torque"] / _output_constant(table) + np.nan_to_num(table["no_load_current"])
    least = {"peak_torque": table["nominal_torque"], "peak_current": np.fmax(_rated_current(table), at_peak)}
    for name, lasting in least.items():
        stall = table[name.replace("peak", "stall")]
        low = np.where(np.isnan(lasting), _LEAST_SHARE * stall, lasting)
        unprinted = np.isnan(stall)
        between(name, low, np.where(unprinted, _MOST * lasting, stall), np.where(unprinted, inf, stall))
    short = np.where(np.isnan(table["peak_torque"]), table["stall_torque"], table["peak_torque"])
    between("nominal_torque", short / _MOST, short, short)
    return estimates | more


def rule_of_thumb_bands(catalog: Catalog) -> dict[str, Estimates]:
    """Figures of actuators that are a rule of thumb, with a band from there to the stall."""
    table, estimates = catalog.actuators, dict[str, Estimates]()
    for name, stall in _STALL.items():
        rows = catalog.by_rule(name)
        value = table[name][rows]
        high = np.where(np.isnan(table[stall][rows]), inf, table[stall][rows])
        wide = high > value  # written so that NaN fails too
        if wide.any():
            law = np.full(int(wide.sum()), RULE)
            estimates[name] = Estimates(rows[wide], value[wide], value[wide], high[wide], law)
    for name, (least, usual, most, best) in _OF_PRINTED_STALL.items():
        rows = catalog.by_rule(name)
        value, law = table[name][rows], np.full(len(rows), _OF_STALL)
        if len(rows):
            high = np.maximum(value, np.minimum(most * value, best))
            estimates[name] = Estimates(rows, usual * value, least * value, high, law)
    return estimates


def estimates_by_rule(catalog: Catalog, row: int, figure: str) -> list[Estimate]:
    """A figure of an actuator that is by a rule, where it is one."""
    band = rule_of_thumb_bands(catalog).get(figure)
    return [_of_row(figure, band, k) for k in np.flatnonzero(band.rows == row).tolist()] if band else []


def _of_row(figure: str, estimates: Estimates, k: int) -> Estimate:
    """One of the estimates of a figure."""
    value, low, high = (float(column[k]) for column in (estimates.value, estimates.low, estimates.high))
    return Estimate(figure, value, low, high, shipped_laws()[estimates.fit[k]])


# A servo's printed stall is that of a warm motor or its controller's limit: of the resistance out of it 0.70 to 0.84
# were identified (STS3215 12 V), 0.85 to 0.95 (7.4 V), 0.90 to 0.97 (MX-106); 49 % efficiency where 62 to 77 % were
# measured while it lifts. Least, usual and greatest multiple of the figure out of the printed stall, and the most that
# it may be.
_OF_PRINTED_STALL = {"resistance": (0.68, 0.95, 1.0, inf), "efficiency": (1.0, 1.0, 1.5, 0.85)}


def _filled(table: Table[Any], estimates: dict[str, Estimates], name: str) -> NDArray[np.float64]:
    """Value, low and high of every part, shape (3, parts): printed ones are all three alike."""
    columns = np.tile(table[name], (3, 1))
    if name in estimates:
        columns[:, estimates[name].rows] = estimates[name].value, estimates[name].low, estimates[name].high
    return columns


def _scaled(estimates: Estimates, share: NDArray[np.float64]) -> Estimates:
    value, low, high = np.array([estimates.value, estimates.low, estimates.high]) * share[:, estimates.rows]
    low = np.minimum(low, high)  # what is cut at one end need not be cut alike at the other or in the middle
    return estimates._replace(value=np.clip(value, low, high), low=low, high=high)


# -- Estimates of what a data sheet leaves out, each with its band and its law.
#
# A figure that is printed always wins. What decides a limit (largest speed, torque, temperature) is not estimated
# from peers; the peak torque of an actuator that prints none lies between two figures of its own.


_BEYOND = np.log(2.0)  # a term may lie this far outside the parts that the law was fitted to
_STRANGER = 2.0  # times the band, in logarithms, of a maker or construction not seen: assumed where too few have it
_REFUTABLE = {figure for head, (figure, *_) in ROWS if head == "refutable"}
_LAST = 1e3  # added to widths, in logarithms, of laws without peers of a part's construction


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


class _Parts:
    """Parts of a table: their figures in logarithms, printed or estimated before, and their classes, each made once."""

    def __init__(self, table: Table[Any]) -> None:
        self.table = table
        self.makers = np.unique(table["manufacturer"], return_inverse=True)
        self._built = [np.unique(names, return_inverse=True) for names in constructions_of(table)]
        self._terms: dict[str, _Term] = {}
        self._members: dict[str, NDArray[np.bool_]] = {}

    def term(self, name: str) -> _Term:
        """A figure; exact where it is printed."""
        if name not in self._terms:
            exact = np.zeros(len(self.table))
            self._terms[name] = _Term(np.log(column(self.table, name)), exact, exact)
        return self._terms[name]

    def complete(self, name: str, estimates: Estimates) -> None:
        """A figure with what was estimated of it."""
        columns = [values.copy() for values in self.term(name)]
        for into, values in zip(
            columns, (estimates.value, estimates.low / estimates.value, estimates.high / estimates.value), strict=True
        ):
            into[estimates.rows] = np.log(values)
        self._terms[name] = _Term(*columns)

    def strangers(self, fit: Fit) -> NDArray[np.bool_]:
        """Mask of the parts that are built as no peer of a law is; none where either is not known."""
        mask = np.zeros(len(self.table), bool)
        for names, which in self._built if fit.constructions else ():
            mask |= ~np.isin(names, ("", *fit.constructions))[which]
        return mask

    def members(self, of: str) -> NDArray[np.bool_]:
        """Mask of the parts of a class."""
        if of not in self._members:
            self._members[of] = members_of(self.table, of)
        return self._members[of]


def estimates(table: Table[Any], only: Collection[Fit] = ()) -> dict[str, Estimates]:
    """Every figure that parts of a table lack, by the narrowest law whose terms the part has.

    Laws with parts of its construction among their peers go before all others; of an inertia none counts beside one
    with a printed figure more that gives a value outside its band.
    A term may be an estimate itself, of a figure that is declared before: its band then widens that of the result.
    """
    by_figure: dict[str, Estimates] = {}
    parts = _Parts(table)
    laws = [(number, fit) for number, fit in enumerate(shipped_laws()) if fit.law.section == table.section]
    figures = {fit.law.figure for fit in only}
    laws = [(number, fit) for number, fit in laws if fit in only or fit.law.figure not in figures]
    for figure in dict.fromkeys(fit.law.figure for _, fit in laws):
        estimate = _estimate(parts, figure, [law for law in laws if law[1].law.figure == figure])
        if len(estimate.rows):
            subset = table.at_rows(estimate.rows)
            (name, middle), low, high = (
                given_column(subset, figure, x) for x in (estimate.value, estimate.low, estimate.high)
            )
            keep = np.isnan(subset[name]) & ~np.isnan(middle)
            if keep.any():
                ends = np.sort([low[1][keep], high[1][keep]], axis=0)
                by_figure[name] = Estimates(estimate.rows[keep], middle[keep], ends[0], ends[1], estimate.fit[keep])
            parts.complete(figure, estimate)
    rated = table
    if "resistance" in by_figure:  # what a rated current brings about is judged with the middle of those
        rated = table.changed({"resistance": _filled(table, by_figure, "resistance")[0]})
    return peak_torque_estimates(table, estimates_by_rated_current(rated, by_figure))


def _estimate(parts: _Parts, figure: str, laws: list[tuple[int, Fit]]) -> Estimates:
    count = len(parts.table)
    band, by = np.full((3, count), np.nan), np.full(count, -1)
    missing, width = np.isnan(parts.term(figure).middle), np.full(count, np.inf)
    strangers = {number: parts.strangers(law) for number, law in laws if missing.any()}
    values = [(number, law, _law_value(law, parts, strangers[number])) for number, law in laws if number in strangers]
    for number, law, term in values:
        spread = term.above - term.below + np.where(strangers[number], _LAST, 0.0)
        better = missing & (spread < width) & ((by < 0) | (law.source == ""))
        better &= ~_refuted(parts, law, term, values)
        for place, side in enumerate((np.zeros(count), term.below, term.above)):
            band[place][better] = np.exp(term.middle + side)[better]
        by[better], width[better] = number, spread[better]
    rows = np.flatnonzero(by >= 0)
    value, low, high = band[:, rows]
    return Estimates(rows, value, low, high, by[rows])


def _refuted(parts: _Parts, law: Fit, term: _Term, others: list[tuple[int, Fit, _Term]]) -> NDArray[np.bool_]:
    """Parts whose figure by a law with a printed term more is outside a law's band: its peers are other parts."""
    refuted = np.zeros(len(parts.table), bool)
    if f"{law.law.section} {law.law.figure}" not in _REFUTABLE:
        return refuted
    for _, fit, other in others:
        if set(fit.law.terms) > set(law.law.terms):
            more = [parts.term(name).above == 0.0 for name in fit.law.terms if name not in law.law.terms]
            off = other.middle - term.middle
            refuted |= np.logical_and.reduce(more) & ((off < term.below) | (off > term.above))
    return refuted


def _law_value(fit: Fit, parts: _Parts, stranger: NDArray[np.bool_]) -> _Term:
    """The figure by one law; NaN where the law does not reach. Errors of terms add to it as independent ones."""
    terms = [parts.term(name) for name in fit.law.terms]
    x = np.column_stack([np.zeros((len(parts.table), 0)), *(term.middle for term in terms)])
    wider = widening(fit.peers, x) if fit.peers else np.ones(len(parts.table))
    middle: Array = np.where(parts.members(fit.law.of), fit.coefficients[0], np.nan)
    below, above = ((wider * end) ** 2 for end in _ends(fit, parts, stranger))
    for factor, term, (low, high) in zip(fit.coefficients[1:], terms, fit.ranges, strict=True):
        inside = (term.middle > low - _BEYOND) & (term.middle < high + _BEYOND)
        middle += factor * np.where(inside, term.middle, np.nan)
        ends = (term.below, term.above) if factor > 0.0 else (term.above, term.below)
        below, above = below + (factor * ends[0]) ** 2, above + (factor * ends[1]) ** 2
    return _Term(middle, -np.sqrt(below) + 0.0 * middle, np.sqrt(above) + 0.0 * middle)


def _ends(fit: Fit, parts: _Parts, stranger: NDArray[np.bool_]) -> Array:
    """Ends of the band at the peers' centre: the widest band that maker and construction of a part call for."""
    twice = (_STRANGER * fit.band[0], _STRANGER * fit.band[1])
    names, which = parts.makers
    maker = ~np.isin(names, fit.makers)[which]
    band = np.tile(np.array(fit.band)[:, None], len(maker))
    for other, ends in ((maker, fit.other_makers or twice), (stranger, twice)):
        wider = other & (ends[1] - ends[0] > band[1] - band[0])
        band[:, wider] = np.array(ends)[:, None]
    return band


def estimates_of(table: Table[Any], row: int) -> list[Estimate]:
    """All that a part's data sheet leaves out and its peers give."""
    return [_of_row(figure, values, 0) for figure, values in estimates(table.at_rows(slice(row, row + 1))).items()]


def as_records(table: Table[Any], row: int) -> list[dict[str, Any]]:
    """The estimates of a part for JSON, and limits of its family: figures in SI, the 5th to the 95th percentile."""
    names = ("figure", "value", "low", "high", "terms", "peers", "parts", "families")
    rows = [(*figures, list(fit.law.terms), fit.source or fit.law.of or fit.law.section, fit.parts, fit.families)
            for *figures, fit in estimates_of(table, row)]  # fmt: skip
    rows += [(name, x, x, x, [], SAME_FAMILY, members, 1) for name, x, members in family_limits(table, row)]
    return [dict(zip(names, cells, strict=True)) for cells in rows]


def law_text(fit: Fit) -> str:
    """A law in words: its terms, and the parts it was fitted to.

    >>> law = Law("motors", "brushed", "rotor_inertia", ("mass", "diameter"))
    >>> law_text(Fit(law, (0, 1, 1), (-0.3, 0.3), None, (), 309, 32, ("m",)))
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
    text = (resources.files("drivesizer.catalog") / "estimates.json").read_text(encoding="utf-8")
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
    """Fitted laws as ``estimates.json`` keeps them: a law a line, figures rounded to six digits.

    ``width`` is the upper end of the band over the lower one, median over the parts of the law.
    """

    def six(value: Any) -> Any:
        if isinstance(value, float):
            return float(f"{value:.6g}")
        return [six(entry) for entry in value] if isinstance(value, tuple) else value

    lines = []
    for fit in fits:
        width = float(np.exp(fit.width * (fit.band[1] - fit.band[0])))
        record = fit.law._asdict() | fit._asdict() | (fit.peers._asdict() if fit.peers else {}) | {"width": width}
        fields = {name: six(value) for name, value in record.items() if name not in ("law", "source", "peers")}
        lines.append(json.dumps(fields))
    return "[\n" + ",\n".join(lines) + "\n]\n"


# -- Permitted limits of parts whose maker prints one and the same limit for all others of the family.
#
# A limit is a decision of the maker, so that no law over other makers' parts gives it; where the family speaks with
# one voice, the part that lacks it has it too. Two members at least must print it.


SAME_FAMILY = "same family"  # the law's name, wherever such a limit is shown
LIMITS = {
    "motors": ("max_speed", "max_winding_temperature", "peak_torque"),
    "gearheads": ("continuous_input_speed", "intermittent_input_speed", "continuous_torque", "intermittent_torque"),
    "actuators": ("max_speed", "max_winding_temperature", "peak_torque"),
    "encoders": ("max_speed", "max_mechanical_speed"),
}
_LEAST_OF_FAMILY = 2  # members that print it
_ROUNDING = 1e-9  # relative, of units


class FamilyLimit(NamedTuple):
    """A limit of one part, as its family has it; its band has no width."""

    figure: str
    value: float  # SI
    members: int  # that print it


def family_limits(table: Table[Any], row: int) -> list[FamilyLimit]:
    """Limits that a part lacks and all others of its family that print them have alike."""
    families = families_of(table)
    family = families == families[row] if table["family"][row] else np.zeros(len(table), np.bool_)
    limits = []
    for figure in LIMITS.get(table.section, ()):
        printed = table[figure][family & ~np.isnan(table[figure])]
        if not np.isnan(table[figure][row]) or len(printed) < _LEAST_OF_FAMILY:
            continue
        if np.ptp(printed) <= _ROUNDING * np.abs(printed).max():
            limits.append(FamilyLimit(figure, float(printed[0]), len(printed)))
    return limits


# -- Estimates of all parts of a catalogue.


_SECTIONS = tuple(dict.fromkeys((*(law.section for law in LAWS), "controllers", "brakes")))


def estimates_of_catalog(catalog: Catalog) -> dict[str, dict[str, Estimates]]:
    """Estimates of figures that data sheets leave out, and figures that are a rule of thumb."""
    by_section = {section: estimates(catalog.table(section)) for section in _SECTIONS}
    by_section["actuators"] |= rule_of_thumb_bands(catalog)
    return {section: figures for section, figures in by_section.items() if figures}


if __name__ == "__main__":
    from drivesizer.catalog import load

    print(written(fits(load(["all"]))), end="")
