"""A law between the figures of one part, its sides, and functions that make laws out of rows of a table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.identities import IDENTITIES, solved
from drivesizer.catalog.parts import PARTS, columns_of
from drivesizer.catalog.tables import Table

__all__ = [
    "DEFINITION", "ENERGY", "HANDBOOK", "ROUNDED", "SLACK", "USAGE", "Band", "Beside", "Formula", "Law", "Numbers",
    "Side", "above_zero", "across_offers", "against_similar", "bands", "cylinder", "decimal_places", "formulas",
    "groups", "half_last_digit", "only", "orders", "per_stage", "reductions", "shares", "usual", "whole_numbers",
    "words",
]  # fmt: skip


Numbers = NDArray[np.float64]
Side = Callable[[Table[Any]], Any]
# name, meaning, figure, relation, expected (None: by the identity of that name), other figures, allowance, reason
Formula = tuple[str, str, str, str, Side | None, tuple[str, ...], float, str]
# section, name, figure, expected, least and most share of it, other figures, reason
Band = tuple[str, str, str, Side, float, float, tuple[str, ...], str]
# section, figure, side, largest multiple of the median of similar parts, reason
Beside = tuple[str, str, Callable[[str], Side], float, str]

HANDBOOK = "maxon academy, Formulae Handbook, 2nd ed., 2012"
DEFINITION = "what the words mean"
SLACK = 1e-9  # relative: of the arithmetic, not of a printed figure
_DIGITS = 3  # to which data sheets round
_PLACES = range(1, 9)  # decimal places that a printed figure may have
ENERGY = "no machine gives more than it takes"
BODY = "a body's mass and volume"
USAGE = "usual in the trade"
ROUNDED = "only what rounding explains"


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """One figure compared with a function of other figures."""

    section: str
    name: str
    meaning: str  # as a formula or half a sentence
    figure: str  # the field that is compared; both numbers have its unit
    relation: str  # = <= >= < >, figure on the left
    expected: Side
    fields: tuple[str, ...]  # the other figures in it, each as often as its exponent
    allowance: float = 0.0  # relative, beyond rounding
    rounds: bool = True  # whether the rounding of the figures counts
    reason: str = ROUNDED  # of the tolerance
    source: str = DEFINITION
    grade: str = "finding"  # or information


def decimal_places(printed: Numbers) -> NDArray[np.int_]:
    """Decimal places that each figure needs; 0 for an unknown one."""
    found = np.where(np.isnan(printed), 0, _PLACES[-1])
    for places in reversed((0, *_PLACES)):
        found[np.abs(np.round(printed, places) - printed) <= SLACK * printed] = places
    return found


def half_last_digit(printed: Numbers, place: Numbers) -> Numbers:
    """Half of the last printed digit of figures with three digits, relative to them."""
    last = np.maximum(10.0 ** (np.floor(np.log10(printed)) - (_DIGITS - 1)), place)
    return np.asarray(0.5 * last / printed)


# --- sides -----------------------------------------------------------------------------------------------------------


def only(table: Table[Any], kind: str, values: Any) -> Numbers:
    """Values of the parts of one kind, unknown for the others."""
    return np.where(table["kind"] == kind, values, np.nan)


def cylinder(table: Table[Any]) -> Numbers:
    """The volume of a part, from its diameter and length."""
    return np.asarray(np.pi / 4 * table["diameter"] ** 2 * table["length"])


def groups(table: Table[Any], *names: str) -> NDArray[np.intp]:
    """Number of the group in which parts agree in some fields; an unknown figure agrees with an unknown one."""
    found: NDArray[np.intp] = np.zeros(len(table), np.intp)
    for name in names:
        numbers = np.unique(table[name], return_inverse=True)[1]
        found = np.unique(found * (len(table) + 1) + numbers, return_inverse=True)[1]
    return found


def across_offers(table: Table[Any], figure: str, rows: NDArray[np.bool_], how: Callable[[Numbers], Any]) -> float:
    """Median, least or greatest figure of some offered parts."""
    values = table[figure][rows & ~table.excluded & ~np.isnan(table[figure])]
    return float(how(values)) if len(values) else np.nan


def usual(*names: str) -> Callable[[str], Side]:
    """The median of a figure over the parts that agree in some fields."""

    def side(figure: str) -> Side:
        def values(table: Table[Any]) -> Numbers:
            group = groups(table, *names)
            medians = [
                across_offers(table, figure, group == k, np.median) for k in range(int(group.max(initial=-1)) + 1)
            ]
            alike = np.all([~np.isnan(table[n]) for n in names if columns_of(table.section)[n].kind != "text"], axis=0)
            return np.where(alike, np.array(medians, float)[group], np.nan)

        return values

    return side


def per_stage(table: Table[Any], gearing: str, base: float) -> Numbers:
    """A number to the power of the stages, for planetary and spur gears."""
    return np.where(np.isin(table[gearing], ("planetary", "spur")), base ** table["stages"], np.nan)


def _printed_reduction(table: Table[Any]) -> Numbers:
    """The number in front of ``:1``; unknown where the reduction is written otherwise."""

    def number(text: str) -> float:
        try:
            return float(text.removesuffix(":1"))
        except ValueError:
            return np.nan

    return np.array([number(text) for text in table["reduction"].tolist()], float)


def _number(value: float) -> Side:
    """The same number for every part but direct drive, the gearhead without stages."""

    def values(table: Table[Any]) -> Numbers:
        found = np.full(len(table), value)
        return np.where(table["stages"] == 0, np.nan, found) if table.section == "gearheads" else found

    return values


def _one(table: Table[Any]) -> Numbers:
    """One; unknown for parts of ratio 1, which may be lossless."""
    if "ratio" not in table.columns:
        return np.ones(len(table))
    return np.where(np.abs(table["ratio"] - 1) > 0, 1.0, np.nan)


def _column(name: str) -> Side:
    return lambda table: table[name]


def _whole(name: str) -> Side:
    return lambda table: np.round(table[name])


def _times(share: float, side: Side) -> Side:
    return lambda table: share * side(table)


# --- laws out of rows ------------------------------------------------------------------------------------------------


def words(name: str) -> str:
    """A field's name in words."""
    return name.replace("_", " ")


def formulas(section: str, rows: Iterable[Formula], source: str) -> Iterator[Law]:
    """Formulas of a section's parts."""
    for name, meaning, figure, relation, expected, fields, allowance, reason in rows:
        side = expected or _by_identity(section, name, figure)
        yield Law(section=section, name=name, meaning=meaning, figure=figure, relation=relation, expected=side,
                  fields=fields, allowance=allowance, reason=reason, source=source)  # fmt: skip


def _by_identity(section: str, name: str, figure: str) -> Side:
    equation = IDENTITIES[section][name]
    return lambda table: solved(equation, table.columns, figure)


def orders(rows: dict[str, tuple[str, ...]]) -> Iterator[Law]:
    """Figures of one part in their order such as ``price_5 <= price``, by section; rounding does not change it."""
    meaning = {"<": "below", "<=": "not above", ">=": "not below"}
    for section, (figure, relation, other) in ((name, row.split()) for name, some in rows.items() for row in some):
        yield Law(section=section, name=f"{words(figure)} and {words(other)}", figure=figure, relation=relation,
                  meaning=f"{meaning[relation]} {words(other)}", expected=_column(other), fields=(other,), rounds=False,
                  reason="none: rounding keeps the order")  # fmt: skip


def bands(rows: Iterable[Band]) -> Iterator[Law]:
    """A figure between two multiples of the expected one."""
    for section, name, figure, side, least, most, fields, reason in rows:
        for relation, share, word in ((">=", least, "least"), ("<=", most, "most")):
            yield Law(section=section, name=f"{name}, at {word}", meaning=f"{share:g} of it at {word}", figure=figure,
                      relation=relation, expected=_times(share, side), fields=fields, reason=reason,
                      source=BODY if "mass" in (figure, *fields) else USAGE)  # fmt: skip


def against_similar(rows: Iterable[Beside]) -> Iterator[Law]:
    """A figure compared with the median of similar parts."""
    for section, figure, side, times, reason in rows:
        for relation, share, word in ((">=", 1 / times, "least"), ("<=", times, "most")):
            yield Law(section=section, name=f"{words(figure)} beside similar parts, at {word}", figure=figure,
                      meaning=f"{share:.3g} of the median at {word}", relation=relation, fields=("family",),
                      expected=_times(share, side(figure)), rounds=False, reason=reason, source=USAGE)  # fmt: skip


def reductions(section: str, gearing: str) -> Iterator[Law]:
    """Laws of gear ratios."""
    yield Law(section=section, name="printed reduction", meaning="the reduction is the ratio, rounded",
              figure="ratio", relation="=", expected=_printed_reduction, fields=("reduction",),
              reason="half of the last digit of the reductions from 17:1 on; 4.8:1 and the like come nearer",
              allowance=0.03)  # fmt: skip
    yield Law(section=section, name="ratio per stage, at least", meaning="1.5 to the power of the stages at least",
              figure="ratio", relation=">=", expected=lambda g: np.where(g["stages"] > 0, 1.5 ** g["stages"], np.nan),
              fields=("stages",), reason="2.1 to 6.75 of 2215 maxon gearheads, Faulhaber from 1.76",
              source=USAGE)  # fmt: skip
    yield Law(section=section, name="ratio per stage, at most", meaning="10 to the power of the stages at most",
              figure="ratio", relation="<=", expected=lambda g: per_stage(g, gearing, 10.0),
              fields=("stages", gearing), source=USAGE,
              reason="beyond, planets would touch; other kinds have no such bound")  # fmt: skip


def shares(rows: Iterable[tuple[str, str]]) -> Iterator[Law]:
    """Figures below 1."""
    for section, figure in rows:
        yield Law(section=section, name=f"{words(figure)} is a share", meaning="below 1", figure=figure, relation="<",
                  expected=_one, fields=(), rounds=False, reason="none")  # fmt: skip


def whole_numbers(rows: Iterable[tuple[str, str]]) -> Iterator[Law]:
    """Figures that count something."""
    for section, figure in rows:
        yield Law(section=section, name=f"{words(figure)} is a whole number", meaning="whole", figure=figure,
                  relation="=", expected=_whole(figure), fields=(), rounds=False, reason="none")  # fmt: skip


def above_zero(but: set[str]) -> Iterator[Law]:
    """Every figure of every section but those that may be zero."""
    for section in PARTS:
        for column in columns_of(section).values():
            if column.kind not in ("text", "temperature") and column.name not in but:
                yield Law(section=section, name=f"{words(column.name)} is above zero", meaning="0 is not unknown (~)",
                          figure=column.name, relation=">", expected=_number(0.0), fields=(), rounds=False,
                          reason="none")  # fmt: skip
