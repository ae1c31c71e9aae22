"""Laws between the figures of one part, of ``laws.yaml``: to check a catalogue, and to derive what a data sheet lacks.

>>> figures = {"nominal_voltage": 12.0, "stall_current": 85.0, "resistance": float("nan")}
>>> round(float(solved("stall_current * resistance = nominal_voltage", figures, "resistance")), 4)
0.1412
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib import resources
from itertools import pairwise
from types import CodeType
from typing import Any, NamedTuple

import numpy as np
import yaml
from numpy.typing import NDArray

from drivesizer.catalog.parts import PARTS, columns_of
from drivesizer.catalog.tables import Note, Table
from drivesizer.files.yaml_source import LOADER
from drivesizer.physics import thermal

__all__ = ["DERIVED", "IDENTITIES", "LAWS", "Derived", "Law", "derived", "solved", "text"]

Numbers = NDArray[np.float64]


def text() -> str:
    """The table of laws as it is written."""
    return (resources.files(__package__) / "laws.yaml").read_text(encoding="utf-8")


_TABLE: dict[str, Any] = yaml.load(text(), Loader=LOADER)  # noqa: S506  the safe loader


# -- Functions in laws

# profile and the pitches that it is made in, mm
_PITCHES = {
    "HTD": (3.0, 5.0, 8.0, 14.0, 20.0), "GT2": (2.0, 3.0, 5.0, 8.0, 14.0), "RT25": (6.35,), "MXL": (2.032,),
    "XL": (5.08,), "L": (9.525,), "H": (12.7,), "XH": (22.225,), "T2.5": (2.5,), "T5": (5.0,), "T10": (10.0,),
    "T20": (20.0,), "AT3": (3.0,), "AT5": (5.0,), "AT10": (10.0,), "AT20": (20.0,),
}  # fmt: skip
_FULL_STEPS = (12.0, 20.0, 24.0, 36.0, 48.0, 60.0, 72.0, 96.0, 100.0, 120.0, 144.0, 180.0, 200.0, 300.0, 400.0, 500.0,
               1000.0)  # fmt: skip


def _nearest(values: Numbers, made: tuple[float, ...]) -> Numbers:
    """The nearest by ratio of the sizes that are made; unknown for an unknown value."""
    sizes = np.array(made)
    nearest = sizes[np.abs(np.log(values[:, None] / sizes)).argmin(axis=1)]
    return np.where(np.isnan(values), np.nan, nearest)


def _pitch_of_profile(profile: NDArray[np.str_], pitch: Numbers) -> Numbers:
    found = np.full(len(pitch), np.nan)
    for name, made in _PITCHES.items():
        found = np.where(profile == name, _nearest(pitch * 1e3, made) / 1e3, found)
    return found


def _leading_number(texts: NDArray[np.str_]) -> Numbers:
    """The number in front of ``:1``; unknown where a reduction is written otherwise."""
    bare = [text.removesuffix(":1") for text in texts.tolist()]
    return np.array([float(one) if re.fullmatch(r"[0-9]+(\.[0-9]*)?", one) else np.nan for one in bare], float)


def _groups(*columns: NDArray[Any]) -> NDArray[np.intp]:
    """Number of the group in which parts agree; an unknown figure agrees with an unknown one."""
    found: NDArray[np.intp] = np.zeros(len(columns[0]), np.intp)
    for column in columns:
        numbers = np.unique(column, return_inverse=True)[1]
        found = np.unique(found * (len(found) + 1) + numbers, return_inverse=True)[1]
    return found


def _across_offers(values: Numbers, offered: NDArray[np.bool_], how: Callable[[Numbers], Any]) -> float:
    """Median, least or greatest of some offered parts that have the figure."""
    some = values[offered & ~np.isnan(values)]
    return float(how(some)) if len(some) else np.nan


def _median(values: Numbers, excluded: NDArray[np.bool_], *alike: NDArray[Any]) -> Numbers:
    """The median over the parts that agree in some columns; unknown where one of these is."""
    group = _groups(*alike)
    medians = [_across_offers(values, (group == k) & ~excluded, np.median) for k in range(group.max(initial=-1) + 1)]
    known = np.all([~np.isnan(column) for column in alike if column.dtype.kind == "f"], axis=0)
    return np.where(known, np.array(medians, float)[group], np.nan)


def _of_a_stage_less(how: Callable[[Numbers], Any]) -> Callable[..., Numbers]:
    """The least or greatest figure of the same gearhead with the next lower number of stages."""

    def values(figure: Numbers, excluded: NDArray[np.bool_], stages: Numbers, *alike: NDArray[Any]) -> Numbers:
        group, found = _groups(*alike), np.full(len(figure), np.nan)
        for k in range(group.max(initial=-1) + 1):
            for less, more in pairwise(np.unique(stages[(group == k) & ~np.isnan(stages)])):
                lesser = _across_offers(figure, (group == k) & (stages == less) & ~excluded, how)
                found[(group == k) & (stages == more)] = lesser
        return found

    return values


def _known(printed: Any, otherwise: Any) -> Any:
    return np.where(np.isnan(printed), otherwise, printed)


def _parabola(x: Numbers, at_0: Numbers, at_half: Numbers, at_1: Numbers) -> Numbers:
    """Figure at a share of the permissible speed by those at 0, half and all of it; unknown beyond."""
    curve = at_0 * (1 - x) * (1 - 2 * x) + at_half * 4 * x * (1 - x) + at_1 * x * (2 * x - 1)
    return np.where(x <= 1, curve, np.nan)


_FUNCTIONS: dict[str, Any] = {
    "unknown": np.isnan, "abs": np.abs, "choose": np.where, "pi": np.pi, "median": _median, "parabola": _parabola,
    "leading_number": _leading_number,
    "least_of_a_stage_less": _of_a_stage_less(np.min), "greatest_of_a_stage_less": _of_a_stage_less(np.max),
    "pitch_of_profile": _pitch_of_profile, "nearest_full_steps": lambda steps: _nearest(steps, _FULL_STEPS),
    "whole": np.round, "nominal_current_by_heat": thermal.nominal_current,
    "continuous_current_by_heat": thermal.continuous_current,
}  # fmt: skip
# figures that no column has, each with the column that stands for it
_FURTHER: dict[str, tuple[Callable[[Any], Any], str]] = {
    "k_e": (lambda m: _known(m["back_emf_constant"], m["torque_constant"]), "torque_constant"),
    "motor_k_e": (lambda m: _known(m["motor_back_emf_constant"], m["motor_torque_constant"]), "motor_torque_constant"),
    "resistance_25": (thermal.resistance_25, "resistance"),
    "ambient_of_rating": (thermal.rated_ambient, ""),
}  # fmt: skip


# -- Expressions over the columns of a table


@cache
def _code(expression: str) -> CodeType:
    return compile(f"({expression})", expression, "eval")


def _value(expression: str, figures: Any, **instead: float) -> Any:
    """The value of an expression over figures by name, some of them replaced."""
    code, found = _code(expression), dict[str, Any](instead)
    for name in code.co_names:
        if name in _FURTHER and name not in found:
            of = _Replaced(figures, instead) if instead else figures
            found[name] = _FURTHER[name][0](of)
        elif name == "excluded":
            found[name] = figures.excluded
        elif name not in found:
            found[name] = _FUNCTIONS[name] if name in _FUNCTIONS else figures[name]
    with np.errstate(all="ignore"):
        return eval(code, {"__builtins__": {}}, found)  # noqa: S307  of this table


class _Replaced:
    """Figures of which some are others."""

    def __init__(self, figures: Any, instead: Mapping[str, float]) -> None:
        self.figures, self.instead = figures, instead

    def __getitem__(self, name: str) -> Any:
        return self.instead.get(name, self.figures[name])


def solved(equation: str, figures: Any, unknown: str) -> Numbers:
    """The figure that fulfils an equation in which it is linear."""
    left, right = equation.partition(" where ")[0].split(" = ")
    if left == unknown:
        return np.asarray(_value(right, figures))
    at_0, at_1 = (_value(f"({left}) - ({right})", figures, **{unknown: value}) for value in (0.0, 1.0))
    with np.errstate(all="ignore"):
        return np.asarray(at_0 / (at_0 - at_1))


def _applies(law: str, table: Table[Any]) -> Any:
    """Mask of the parts that a law is of."""
    condition = law.partition(" where ")[2]
    return _value(condition, table) if condition else np.ones(len(table), bool)


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
        found += [name for name in _code(condition).co_names if name in columns and columns[name].kind == "text"]
    named = (_FURTHER[name][1] if name in _FURTHER else name for name in found)
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
            value: Any = solved(self.law, table, self.figure)
        else:
            value = _value(self.law.partition(" where ")[0].partition(f" {self.relation} ")[2], table)
        return np.where(_applies(self.law, table), self.share * value, np.nan)


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
            for relation, side, word in ends:
                share = float(Fraction(str((least, most)[side])))
                yield _law(section, f"{name}, at {word}", figure, f"{figure} {relation} {other}",
                           f"{share:g} of it at {word}", 0.0, reason, *little, source=source, share=share)  # fmt: skip
    for section, rows in _TABLE["similar"].items():
        for figure, times, alike, reason in rows:
            for relation, side, word in ends:
                share = (1.0 / times, float(times))[side]
                median = f"median({figure}, excluded, {', '.join(alike.split())})"
                yield _law(section, f"{figure.replace('_', ' ')} beside similar parts, at {word}", figure,
                           f"{figure} {relation} {median}", f"{share:.3g} of the median at {word}", 0.0, reason,
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
        may = lacking & _value(_TABLE["windings"][one.section], table) & _applies(equation, table)
        if one.condition:
            may &= _value(one.condition, table)
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
