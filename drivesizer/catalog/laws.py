"""Laws between the figures of one part, of ``laws.yaml``: to check a catalogue, and to derive what a sheet lacks."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.expressions import FURTHER, solved, value
from drivesizer.catalog.parts import PARTS, columns_of
from drivesizer.catalog.tables import Note, Table
from drivesizer.files.arithmetic import code
from drivesizer.files.yaml_source import shipped_data

Numbers = NDArray[np.float64]


_TABLE: dict[str, Any] = shipped_data("drivesizer.catalog", "laws.yaml")


def _applies(law: str, table: Table[Any]) -> Any:
    """Mask of the parts that a law is of."""
    condition = law.partition(" where ")[2]
    return value(condition, table) if condition else np.ones(len(table), bool)


def _fields(section: str, figure: str, law: str) -> tuple[str, ...]:
    """The other columns in a law, each as often as its exponent, and the texts that say of which parts it is."""
    columns, found = columns_of(section), list[str]()
    expression, _, condition = law.partition(" where ")
    for node in ast.walk(ast.parse(re.sub(r"(?<![<>=!])=(?!=)", "==", expression), mode="eval")):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and isinstance(node.left, ast.Name):
            times = ast.literal_eval(node.right) if isinstance(node.right, ast.Constant) else 1
            found += [node.left.id] * (int(times) - 1)
        elif isinstance(node, ast.Name):
            found.append(node.id)
    if condition:
        found += [name for name in code(condition).co_names if name in columns and columns[name].kind == "text"]
    named = (FURTHER[name][1] if name in FURTHER else name for name in found)
    return tuple(name for name in named if name in columns and name != figure)


# -- The laws


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """One figure compared with a function of other figures."""

    section: str
    name: str
    meaning: str  # as a formula or half a sentence
    figure: str  # the field that is compared; both numbers have its unit
    relation: str  # = <= >= < >, figure on the left
    law: str  # an equation, or ``figure relation expression``
    share: float = 1.0  # of what it says, that the figure is compared with
    fields: tuple[str, ...]  # the other figures in it, each as often as its exponent
    allowance: float = 0.0  # relative, beyond rounding
    rounds: bool = True  # whether the rounding of the figures counts
    reason: str  # of the tolerance
    source: str

    def expected(self, table: Table[Any]) -> Numbers:
        """The number that the figure of each part is compared with; NaN of parts that the law is not of."""
        if self.relation == "=":
            found: Any = solved(self.law, table, self.figure)
        else:
            found = value(self.law.partition(" where ")[0].partition(f" {self.relation} ")[2], table)
        return np.where(_applies(self.law, table), self.share * found, np.nan)


def _law(
    section: str, name: str, figure: str, law: str, meaning: str, allowance: float, reason: str, little: str = "", *,
    source: str, rounds: bool = True, share: float = 1.0,
) -> Law:  # fmt: skip
    law = " ".join(law.split())
    relation = re.split(r" (<=|>=|<|>|=) ", law, maxsplit=1)[1]
    fields = tuple(other for other in _fields(section, figure, law) if other not in little.split())
    return Law(
        section=section, name=name, meaning=meaning, figure=figure, relation=relation, law=law, share=share,
        fields=fields, allowance=allowance, rounds=rounds, reason=reason, source=_TABLE["sources"][source],
    )  # fmt: skip


def _laws() -> Iterator[Law]:
    for group in _TABLE["formulas"]:
        for row in group["rows"]:
            yield _law(group["section"], *row, source=group["source"], rounds=group.get("rounds", True))
    words = {"<": "below", "<=": "not above", ">=": "not below"}
    for section, orders in _TABLE["orders"].items():
        for order in orders:
            figure, relation, other = order.split()
            named = other.replace("_", " ")
            yield _law(section, f"{figure.replace('_', ' ')} and {named}", figure, order, f"{words[relation]} {named}",
                       0.0, "none: rounding keeps the order", source="definition", rounds=False)  # fmt: skip
    ends = ((">=", 0, "least"), ("<=", 1, "most"))
    for section, rows in _TABLE["bands"].items():
        for name, figure, least, most, other, reason, *little in rows:
            source = "body" if re.search(r"\bmass\b", f"{figure} {other}") else "usage"
            shares = [float(Fraction(str(end))) for end in (least, most)]
            usual = f"usually {shares[0]:.3g} to {shares[1]:.6g} {_in_words(other)}; {reason}"
            for relation, side, word in ends:
                yield _law(section, f"{name}, at {word}", figure, f"{figure} {relation} {other}", usual, 0.0, reason,
                           *little, source=source, share=shares[side])  # fmt: skip
    for section, rows in _TABLE["similar"].items():
        for figure, times, alike, reason in rows:
            for relation, side, word in ends:
                share = (1.0 / times, float(times))[side]
                median = f"median({figure}, excluded, {', '.join(alike.split())})"
                yield _law(section, f"{figure.replace('_', ' ')} beside similar parts, at {word}", figure,
                           f"{figure} {relation} {median}",
                           f"usually {1.0 / times:.2g} to {times:g} times the median {reason}", 0.0, reason,
                           source="usage", rounds=False, share=share)  # fmt: skip
    for section, figures in _TABLE["shares"].items():
        some = " where abs(ratio - 1) > 0" if "ratio" in columns_of(section) else ""
        for figure in figures:
            yield _law(section, f"{figure.replace('_', ' ')} is a share", figure, f"{figure} < 1{some}", "below 1", 0.0,
                       "none", source="definition", rounds=False)  # fmt: skip
    for section, figures in _TABLE["whole_numbers"].items():
        for figure in figures:
            yield _law(section, f"{figure.replace('_', ' ')} is a whole number", figure, f"{figure} = whole({figure})",
                       "whole", 0.0, "none", source="definition", rounds=False)  # fmt: skip
    for section in PARTS:
        some = " where stages != 0" if section == "gearheads" else ""  # direct drive
        for column in columns_of(section).values():
            if column.kind not in ("text", "temperature") and column.name not in _TABLE["may_be_zero"]:
                yield _law(section, f"{column.name.replace('_', ' ')} is above zero", column.name,
                           f"{column.name} > 0{some}", "0 is not unknown (~)", 0.0, "none", source="definition",
                           rounds=False)  # fmt: skip


def _in_words(expression: str | float) -> str:
    """An expression of a band as people write it, 1 left out.

    >>> _in_words("pi / 4 * diameter ** 2 * nut_length where kind == 'ball'"), _in_words(1.0)
    ('times π/4 · diameter² · nut length', 'in SI units')
    """
    if not isinstance(expression, str):
        return "in SI units"
    text = "times " + expression.partition(" where ")[0]
    for printed, sign in ((" ** 2", "²"), (" ** 3", "³"), (" * ", " · "), ("pi / 4", "π/4"), ("_", " ")):
        text = text.replace(printed, sign)
    return text


LAWS: tuple[Law, ...] = tuple(_laws())
IDENTITIES: dict[str, dict[str, str]] = {
    section: {law.name: law.law for law in LAWS if law.section == section and law.relation == "="} | further
    for section, further in _TABLE["equations"].items()
}


# -- What follows from other figures


class Derived(NamedTuple):
    """A figure that the reader solves an identity for, with what is assumed thereby."""

    section: str
    figure: str
    identity: str
    assumed: str
    condition: str = ""  # of which parts
    most: float = np.inf  # that it can be


# in the order in which they are tried; a figure that is known by then stays
DERIVED: tuple[Derived, ...] = tuple(Derived(*row) for row in _TABLE["derived"])


def derived(tables: Mapping[str, Table[Any]]) -> list[Note]:
    """Fill in what follows from other figures of a part, and note what it rests on."""
    notes: dict[Derived, list[str]] = {}
    for one in DERIVED * 2:  # once more with what was found
        table = tables[one.section]
        if not len(table) or not (lacking := np.isnan(table[one.figure])).any():
            continue
        equation = IDENTITIES[one.section][one.identity]
        values = solved(equation, table, one.figure)
        may = lacking & value(_TABLE["windings"][one.section], table) & _applies(equation, table)
        if one.condition:
            may &= value(one.condition, table)
        rows = np.flatnonzero(may & np.isfinite(values) & (values > 0.0) & (values < one.most))
        table[one.figure][rows] = values[rows]
        if len(rows):
            notes.setdefault(one, []).extend(table["part"][rows].tolist())
    found = []
    for one, parts in notes.items():
        follows = f"follows from {IDENTITIES[one.section][one.identity].partition(' where ')[0]}"
        said = f"{follows}; {one.assumed}" if one.assumed else follows
        found.append(Note(one.section, tuple(parts), (one.figure,), said, "derived", derived=True))
    return found
