"""Laws between the figures of one part, of ``laws.yaml``: to check a catalogue, and to derive what a sheet lacks."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import CONSTANT_DRAWS, DISCHARGES, PARTS, PULL_OUTS, RELATIONS, Discharges, columns_of
from drivesizer.catalog.tables import Catalog, Note, Table, as_printed
from drivesizer.files.arithmetic import code, own_value
from drivesizer.files.yaml_source import shipped_data
from drivesizer.physics import thermal
from drivesizer.units import from_si, show

Numbers = NDArray[np.float64]

_TABLE: dict[str, Any] = shipped_data("drivesizer.catalog", "laws.yaml")
_SIZES = _TABLE["sizes"]

# -- Expressions over the figures of a part by name, of one part or of columns.


def _nearest(values: Numbers, series: Sequence[float]) -> Numbers:
    """The nearest by ratio of the sizes that are made; unknown for an unknown value."""
    sizes = np.array(series, float)
    nearest = sizes[np.abs(np.log(values[:, None] / sizes)).argmin(axis=1)]
    return np.where(np.isnan(values), np.nan, nearest)


def _pitch_of_profile(profile: NDArray[np.str_], pitch: Numbers) -> Numbers:
    pitches = np.full(len(pitch), np.nan)
    for name, series in _SIZES["pitches"].items():
        pitches = np.where(profile == name, _nearest(pitch * 1e3, series) / 1e3, pitches)
    return pitches


def _leading_number(texts: NDArray[np.str_]) -> Numbers:
    """The number in front of ``:1``; unknown where a reduction is written otherwise."""
    bare = [text.removesuffix(":1") for text in texts.tolist()]
    return np.array([float(digits) if re.fullmatch(r"[0-9]+(\.[0-9]*)?", digits) else np.nan for digits in bare], float)


def _groups(*columns: NDArray[Any]) -> NDArray[np.intp]:
    """Number of the group in which parts agree; an unknown figure agrees with an unknown one."""
    group: NDArray[np.intp] = np.zeros(len(columns[0]), np.intp)
    for column in columns:
        numbers = np.unique(column, return_inverse=True)[1]
        group = np.unique(group * (len(group) + 1) + numbers, return_inverse=True)[1]
    return group


def _across_offers(values: Numbers, offered: NDArray[np.bool_], how: Callable[[Numbers], Any]) -> float:
    """Median, least or greatest of some offered parts that have the figure."""
    figures = values[offered & ~np.isnan(values)]
    return float(how(figures)) if len(figures) else np.nan


def _median(values: Numbers, excluded: NDArray[np.bool_], *alike: NDArray[Any]) -> Numbers:
    """The median over the parts that agree in some columns; unknown where one of these is."""
    group = _groups(*alike)
    medians = [_across_offers(values, (group == k) & ~excluded, np.median) for k in range(group.max(initial=-1) + 1)]
    known = np.all([~np.isnan(column) for column in alike if column.dtype.kind == "f"], axis=0)
    return np.where(known, np.array(medians, float)[group], np.nan)


def _of_a_stage_less(how: Callable[[Numbers], Any]) -> Callable[..., Numbers]:
    """The least or greatest figure of the same gearhead with the next lower number of stages."""

    def values(figure: Numbers, excluded: NDArray[np.bool_], stages: Numbers, *alike: NDArray[Any]) -> Numbers:
        group, bounds = _groups(*alike), np.full(len(figure), np.nan)
        for k in range(group.max(initial=-1) + 1):
            for less, more in pairwise(np.unique(stages[(group == k) & ~np.isnan(stages)])):
                lesser = _across_offers(figure, (group == k) & (stages == less) & ~excluded, how)
                bounds[(group == k) & (stages == more)] = lesser
        return bounds

    return values


def _known(printed: Any, otherwise: Any) -> Any:
    return np.where(np.isnan(printed), otherwise, printed)


def _parabola(x: Numbers, at_0: Numbers, at_half: Numbers, at_1: Numbers) -> Numbers:
    """Figure at a share of the permissible speed by those at 0, half and all of it; unknown beyond."""
    curve = at_0 * (1 - x) * (1 - 2 * x) + at_half * 4 * x * (1 - x) + at_1 * x * (2 * x - 1)
    return np.where(x <= 1, curve, np.nan)


_FUNCTIONS: dict[str, Any] = {
    "unknown": np.isnan, "known": _known, "nan": np.nan, "infinite": np.inf,
    "smaller": np.minimum, "larger": np.maximum, "abs": np.abs,
    "choose": np.where, "pi": np.pi, "median": _median, "parabola": _parabola, "leading_number": _leading_number,
    "least_of_a_stage_less": _of_a_stage_less(np.min), "greatest_of_a_stage_less": _of_a_stage_less(np.max),
    "pitch_of_profile": _pitch_of_profile, "nearest_full_steps": partial(_nearest, series=_SIZES["full_steps"]),
    "whole": np.round, "nominal_current_by_heat": thermal.nominal_current,
    "continuous_current_by_heat": thermal.continuous_current,
}  # fmt: skip
# figures that no column has, each with the column that stands for it
FURTHER: dict[str, tuple[Callable[[Any], Any], str]] = {
    "k_e": (lambda m: _known(m["back_emf_constant"], m["torque_constant"]), "torque_constant"),
    "motor_k_e": (lambda m: _known(m["motor_back_emf_constant"], m["motor_torque_constant"]), "motor_torque_constant"),
    "resistance_25": (thermal.resistance_25, "resistance"),
    "ambient_of_rating": (thermal.rated_ambient, ""),
}  # fmt: skip


def value(expression: str, figures: Any, **instead: Any) -> Any:
    """The value of an expression over figures by name, some of them replaced."""
    namespace = dict[str, Any](instead)
    for name in code(expression).co_names:
        if name in FURTHER and name not in namespace:
            of = _Replaced(figures, instead) if instead else figures
            namespace[name] = FURTHER[name][0](of)
        elif name == "excluded":
            namespace[name] = figures.excluded
        elif name not in namespace:
            namespace[name] = _FUNCTIONS[name] if name in _FUNCTIONS else figures[name]
    with np.errstate(all="ignore"):
        return own_value(expression, namespace)


class _Replaced:
    """Figures of which some are others."""

    def __init__(self, figures: Any, instead: Mapping[str, Any]) -> None:
        self.figures, self.instead = figures, instead

    def __getitem__(self, name: str) -> Any:
        return self.instead.get(name, self.figures[name])


def solved(equation: str, figures: Any, unknown: str) -> Numbers:
    """The figure that fulfils an equation in which it is linear.

    >>> figures = {"nominal_voltage": 12.0, "stall_current": 85.0, "resistance": float("nan")}
    >>> round(float(solved("stall_current * resistance = nominal_voltage", figures, "resistance")), 4)
    0.1412
    """
    left, right = equation.partition(" where ")[0].split(" = ")
    if left == unknown:
        return np.asarray(value(right, figures))
    at_0, at_1 = (value(f"({left}) - ({right})", figures, **{unknown: at}) for at in (0.0, 1.0))
    with np.errstate(all="ignore"):
        return np.asarray(at_0 / (at_0 - at_1))


# -- Laws.


def _applies(law: str, table: Table[Any]) -> Any:
    """Mask of the parts that a law is of."""
    condition = law.partition(" where ")[2]
    return value(condition, table) if condition else np.ones(len(table), bool)


def _fields(section: str, figure: str, law: str) -> tuple[str, ...]:
    """The other columns in a law, each as often as its exponent, and the texts that say of which parts it is."""
    columns, names = columns_of(section), list[str]()
    expression, _, condition = law.partition(" where ")
    for node in ast.walk(ast.parse(re.sub(r"(?<![<>=!])=(?!=)", "==", expression), mode="eval")):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and isinstance(node.left, ast.Name):
            times = ast.literal_eval(node.right) if isinstance(node.right, ast.Constant) else 1
            names += [node.left.id] * (int(times) - 1)
        elif isinstance(node, ast.Name):
            names.append(node.id)
    if condition:
        names += [name for name in code(condition).co_names if name in columns and columns[name].kind == "text"]
    named = (FURTHER[name][1] if name in FURTHER else name for name in names)
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
            expected: Any = solved(self.law, table, self.figure)
        else:
            expected = value(self.law.partition(" where ")[0].partition(f" {self.relation} ")[2], table)
        return np.where(_applies(self.law, table), self.share * expected, np.nan)


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
        condition = " where abs(ratio - 1) > 0" if "ratio" in columns_of(section) else ""
        for figure in figures:
            yield _law(section, f"{figure.replace('_', ' ')} is a share", figure, f"{figure} < 1{condition}", "below 1",
                       0.0, "none", source="definition", rounds=False)  # fmt: skip
    for section, figures in _TABLE["whole_numbers"].items():
        for figure in figures:
            yield _law(section, f"{figure.replace('_', ' ')} is a whole number", figure, f"{figure} = whole({figure})",
                       "whole", 0.0, "none", source="definition", rounds=False)  # fmt: skip
    for section in PARTS:
        condition = " where stages != 0" if section == "gearheads" else ""  # direct drive
        for column in columns_of(section).values():
            if column.kind not in ("text", "temperature") and column.name not in _TABLE["may_be_zero"]:
                yield _law(section, f"{column.name.replace('_', ' ')} is above zero", column.name,
                           f"{column.name} > 0{condition}", "0 is not unknown (~)", 0.0, "none", source="definition",
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


@cache
def all_laws() -> tuple[Law, ...]:
    """The laws of all sections: only reading and checking a catalogue needs them."""
    return tuple(_laws())


@cache
def identities() -> dict[str, dict[str, str]]:
    """The equations among them, by section and name."""
    return {
        section: {law.name: law.law for law in all_laws() if law.section == section and law.relation == "="} | further
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
    for rule in DERIVED * 2:  # once more with what was found
        table = tables[rule.section]
        if not len(table) or not (lacking := np.isnan(table[rule.figure])).any():
            continue
        equation = identities()[rule.section][rule.identity]
        values = solved(equation, table, rule.figure)
        may = lacking & value(_TABLE["windings"][rule.section], table) & _applies(equation, table)
        if rule.condition:
            may &= value(rule.condition, table)
        rows = np.flatnonzero(may & np.isfinite(values) & (values > 0.0) & (values < rule.most))
        table[rule.figure][rows] = values[rows]
        if len(rows):
            notes.setdefault(rule, []).extend(table["part"][rows].tolist())
    derived_notes = []
    for rule, parts in notes.items():
        follows = f"follows from {identities()[rule.section][rule.identity].partition(' where ')[0]}"
        text = f"{follows}; {rule.assumed}" if rule.assumed else follows
        derived_notes.append(Note(rule.section, tuple(parts), (rule.figure,), text, "derived", derived=True))
    return derived_notes


# -- Check of a catalogue's figures against each other, by laws that data sheets must satisfy.


_SLACK = 1e-9  # relative: of the arithmetic, not of a printed figure
_DIGITS = 3  # to which data sheets round
_PLACES = 8  # decimal places that a printed figure may have
_NOMINAL = {  # whole numbers by definition, not by rounding
    "nominal_voltage", "counts_per_turn", "steps_per_turn", "full_steps", "stages", "teeth", "pitch", "rated_time",
}  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """A contradiction in the figures of one part, or information on it.

    ``found`` and ``expected`` are SI (NaN where there is no number); ``kind`` and ``unit`` are those in which
    datasheets print them. ``deviation`` and ``tolerance`` are relative to ``expected``.
    """

    file: str  # the catalogue's name; for several as one, all their names
    section: str
    part: str
    family: str
    identity: str
    meaning: str
    fields: tuple[str, ...]
    relation: str = ""
    found: float = np.nan
    expected: float = np.nan
    kind: str = ""
    unit: str = ""
    deviation: float = np.nan
    tolerance: float = np.nan
    reason: str = ""  # of the tolerance
    source: str = ""  # of the identity
    grade: str = "finding"  # or information
    accepted: str = ""  # why it may stay, from the catalogue's notes

    @property
    def unexplained(self) -> bool:
        """Whether it is a contradiction that no note of the catalogue accepts."""
        return self.grade != "information" and not self.accepted

    def text(self) -> str:
        """The finding as one line."""
        line = f"{self.file}: {self.section} {self.part} ({self.family}): {self.identity}"
        if self.kind:
            numbers = [show(value, self.unit, self.kind) for value in (self.found, self.expected)]
            line += f": {numbers[0]}, expected {self.relation.removeprefix('=')} {numbers[1]}".replace("  ", " ")
            line += f", off by {self.deviation:+.1%}, tolerance {self.tolerance:.1%}"
        return f"{line}: {self.meaning}" + (f"; accepted: {self.accepted}" if self.accepted else "")


def check(catalog: Catalog, laws: Sequence[Law] | None = None) -> list[Finding]:
    """All findings of a catalogue, the accepted included, in the order of the parts.

    Unknown figures are not checked. Excluded parts are checked but do not count in comparisons with their family, and
    their findings are accepted for the reason of their exclusion. For several catalogues loaded as one a finding names
    all the files: check each by itself.
    """
    catalog, findings = as_printed(catalog), list[Finding]()
    for section in PARTS:
        table, notes = catalog.table(section), dict[str, list[Note]]()
        for note in catalog.notes:
            if note.section == section and (note.accepted or note.exclude):
                for part in note.parts:
                    notes.setdefault(part, []).append(note)
        of_section = (law for law in (all_laws() if laws is None else laws) if law.section == section)
        here = [f for law in of_section for f in _broken(catalog, table, law)]
        here += _twins(catalog, table)
        here += _discharges(catalog) if section == "batteries" else ()
        here += _pull_outs(catalog) if section == "steppers" else ()
        for place, finding in enumerate(here):
            for note in notes.get(finding.part, ()):
                if note.exclude or not note.fields or set(note.fields) & set(finding.fields):
                    here[place] = replace(finding, accepted=note.text)
                    break
        findings += sorted(here, key=lambda finding: table.rows[finding.part])
    return [*findings, *_pairs(catalog)]


def _place(catalog: Catalog, table: Table[Any], row: int) -> dict[str, Any]:
    """File, section, part and family of a finding."""
    part, family = str(table["part"][row]), str(table["family"][row])
    return {"file": ", ".join(catalog.digests), "section": table.section, "part": part, "family": family}


# -- Laws of one part's figures


def _broken(catalog: Catalog, table: Table[Any], law: Law) -> Iterator[Finding]:
    """The parts that break a law, beyond rounding of its figures and the law's allowance."""
    columns, column = columns_of(law.section), columns_of(law.section)[law.figure]
    with np.errstate(all="ignore"):
        values, expected = table[law.figure], np.asarray(law.expected(table), float)
        tolerance = np.full(len(table), law.allowance, float)
        for name in (law.figure, *law.fields) if law.rounds else ():
            if columns[name].kind not in ("text", "ratio"):
                printed = np.abs(from_si(table[name], columns[name].unit, columns[name].kind))
                tolerance += _half_last_digit(printed, table["family"] if name not in _NOMINAL else None)
        tolerance = np.nan_to_num(tolerance)
        span = (tolerance + _SLACK) * np.abs(expected)
        wrong = {
            "=": np.abs(values - expected) > span, "<=": values - expected > span, ">=": expected - values > span,
            "<": values >= expected, ">": values <= expected,
        }[law.relation]  # fmt: skip
        deviation = (values - expected) / np.where(expected == 0.0, 1.0, np.abs(expected))
    for row in np.flatnonzero(wrong & ~np.isnan(values) & ~np.isnan(expected)).tolist():
        yield Finding(
            **_place(catalog, table, row), identity=law.name, meaning=law.meaning,
            fields=tuple(dict.fromkeys((law.figure, *law.fields))), relation=law.relation, found=float(values[row]),
            expected=float(expected[row]), kind=column.kind, unit=column.unit, deviation=float(deviation[row]),
            tolerance=float(tolerance[row]), reason=law.reason, source=law.source,
        )  # fmt: skip


def _half_last_digit(printed: Numbers, group: NDArray[Any] | None) -> Numbers:
    """Half of the last printed digit of each figure, relative to it.

    Figures have at most three digits, and no decimal place that no figure of their group has: 10 beside 14.6 is 10.0,
    0.05 beside 0.85 may be 0.046.
    """
    place = np.zeros(len(printed))
    if group is not None:
        places = np.where(np.isnan(printed), 0, _PLACES)
        for count in reversed(range(_PLACES + 1)):
            places[np.abs(np.round(printed, count) - printed) <= _SLACK * printed] = count
        for name in np.unique(group):
            place[group == name] = 10.0 ** -places[group == name].max()
    last = np.maximum(10.0 ** (np.floor(np.log10(printed)) - (_DIGITS - 1)), place)
    return np.asarray(0.5 * last / printed)


# -- A battery's discharge tables: among each other, with its capacities and with its voltages.
#
# Each figure is compared with a neighbour in its table, so that a misprint is located. Charge is a constant current
# times its time, energy a constant power times its time; the tolerance is half of the last printed digit of both.

_HOURS = {"capacity": np.nan, "capacity_10h": 10.0, "capacity_5h": 5.0, "capacity_1h": 1.0}  # the first: rated_time
_RESTING = {"lead-acid": 1.1}  # full and at rest, per nominal voltage: 2.15 to 2.2 V of 2 V
_MEAN = 0.02  # relative: power over current is the mean voltage of two discharges that are not quite the same


def _discharges(catalog: Catalog) -> Iterator[Finding]:
    """Contradictions of batteries' discharge tables, among each other and with the batteries' figures."""
    discharges, batteries = catalog.discharges, catalog.batteries
    for row in np.unique(discharges.battery).tolist():
        own = discharges.on(discharges.battery == row)
        odd = [*_along_columns(own), *_capacities_by_table(own, batteries, row), *_mean_voltage(own, batteries, row)]
        for identity, meaning, relation, figure, expected, kind, unit, tolerance, *fields in odd:
            yield Finding(
                **_place(catalog, batteries, row), identity=identity, meaning=meaning, relation=relation,
                found=float(figure), expected=float(expected), kind=kind, unit=unit,
                deviation=float(figure / expected - 1.0), tolerance=float(tolerance),
                reason="half of the last printed digits", source="what the words mean", fields=(DISCHARGES, *fields),
            )  # fmt: skip


# identity, meaning, relation, figure, what it is compared with, kind and unit of both, tolerance, further fields
Odd = tuple[Any, ...]


def _along_columns(own: Discharges) -> Iterator[Odd]:
    """A longer discharge draws less, and gives no less in total; one to a lower end voltage gives no less."""
    for quantity, unit in CONSTANT_DRAWS.items():
        table = own.on(~np.isnan(getattr(own, quantity)))
        total = {"current": ("charge", "A*h"), "power": ("energy", "W*h")}[quantity]
        draw = getattr(table, quantity)
        digit, amount = _half_last_digit(draw, table.time), draw * table.time
        for quick, slow in _neighbours(table.cutoff_voltage, table.time):
            where, span = f"{_at(table, slow)}, beside {_hours(table.time[quick])}", digit[slow] + digit[quick]
            if not draw[slow] < draw[quick]:
                yield (f"{quantity} falls with time", f"less than for a shorter time: {where}", "<", draw[slow],
                       draw[quick], quantity, unit, 0.0)  # fmt: skip
            if amount[slow] < amount[quick] * (1.0 - span - _SLACK):
                yield (f"{total[0]} and rate", f"not below that of a faster discharge: {where}", ">=", amount[slow],
                       amount[quick], *total, span)  # fmt: skip
        for deep, shallow in _neighbours(table.time, table.cutoff_voltage):
            span = digit[deep] + digit[shallow]
            if draw[deep] < draw[shallow] * (1.0 - span - _SLACK):
                text = f"{_at(table, deep)}, beside {show(table.cutoff_voltage[shallow], 'V', 'voltage')}"
                yield (f"{quantity} and end voltage", f"not below that down to more volts: {text}", ">=", draw[deep],
                       draw[shallow], quantity, unit, span)  # fmt: skip


def _neighbours(first: Numbers, then: Numbers) -> Iterator[tuple[int, int]]:
    """Neighbours along the second column where the first is the same."""
    order = np.lexsort((then, first))
    for a, b in zip(order[:-1].tolist(), order[1:].tolist(), strict=True):
        if first[a] == first[b]:
            yield a, b


def _capacities_by_table(own: Discharges, batteries: Table[Any], row: int) -> Iterator[Odd]:
    """A printed capacity is current times time of the table, down to the end voltage where they are nearest."""
    charge, digit = own.current * own.time, _half_last_digit(own.current, own.time)
    for name, hours in _HOURS.items():
        capacity, time = batteries[name][row], 3600.0 * hours if hours == hours else batteries["rated_time"][row]
        there = np.flatnonzero((np.abs(own.time / time - 1.0) < _SLACK) & ~np.isnan(charge))
        if not len(there) or np.isnan(capacity):
            continue
        near = there[np.abs(charge[there] - capacity).argmin()]
        span = digit[near] + 0.005  # a capacity has two digits or more
        if abs(charge[near] - capacity) > capacity * (span + _SLACK):
            yield (f"{name.replace('_', ' ')} in the table", f"current x time: {_at(own, near)}", "=", charge[near],
                   capacity, "charge", "A*h", span, name)  # fmt: skip


def _mean_voltage(own: Discharges, batteries: Table[Any], row: int) -> Iterator[Odd]:
    """Power over current for the same time and end voltage is a voltage between that end and that of a full battery."""
    nominal, chemistry = batteries["nominal_voltage"][row], str(batteries["chemistry"][row])
    full = _RESTING[chemistry] * nominal if chemistry in _RESTING else batteries["charge_voltage"][row]
    current, power = ({(v, t): n for n, (v, t, x) in enumerate(zip(own.cutoff_voltage, own.time, column, strict=True))
                       if x == x} for column in (own.current, own.power))  # fmt: skip
    digits = _half_last_digit(own.current, own.time), _half_last_digit(own.power, own.time)
    for key in (key for key in current if key in power):
        n, m = current[key], power[key]
        mean, span = own.power[m] / own.current[n], digits[0][n] + digits[1][m] + _MEAN
        for relation, bound, off in ((">=", key[0], key[0] - mean), ("<=", full, mean - full)):
            if off > span * bound:
                yield ("mean voltage", f"power by current, between the end's and a full one's: {_at(own, n)}",
                       relation, mean, bound, "voltage", "V", span)  # fmt: skip


def _at(own: Discharges, place: int) -> str:
    return f"{_hours(own.time[place])} to {show(own.cutoff_voltage[place], 'V', 'voltage')}"


def _hours(time: float) -> str:
    return show(time, "h" if time >= 3600.0 else "min", "time")


# -- Pull-out curves of steppers

_RISE = 0.08  # of the torque at a lower speed: charts are read to about 5 %, and have dips where rotors resonate
_READ = 0.05


def _pull_outs(catalog: Catalog) -> Iterator[Finding]:
    """The first point of each curve that is above the holding torque, or above the torque at a lower speed."""
    curves, steppers = catalog.pull_outs, catalog.steppers
    for curve in np.unique(curves.curve).tolist():
        own = curves.on(curves.curve == curve)
        row = int(own.stepper[0])
        holding, least = np.full(len(own.torque), steppers["holding_torque"][row]), np.minimum.accumulate(own.torque)
        for identity, meaning, limit, span, fields in (
            ("pull-out and holding torque", "not above the holding torque", holding, _READ, ("holding_torque",)),
            ("pull-out torque and speed", "not above that at a lower speed", least, _RISE, ()),
        ):
            for n in np.flatnonzero(own.torque > limit * (1.0 + span))[:1].tolist():
                speed = show(float(own.speed[n]), "rpm", "rotary_speed")
                yield Finding(
                    **_place(catalog, steppers, row), identity=identity,
                    meaning=f"{meaning}: {show(float(own.voltage[n]), 'V', 'voltage')}, {speed}",
                    fields=(PULL_OUTS, *fields), relation="<=", found=float(own.torque[n]), expected=float(limit[n]),
                    kind="torque", unit="N*m", deviation=float(own.torque[n] / limit[n]) - 1.0, tolerance=span,
                )  # fmt: skip


# -- Parts among each other


def _twins(catalog: Catalog, table: Table[Any]) -> Iterator[Finding]:
    """Parts that agree in every field but the number."""
    first: dict[tuple[str, ...], str] = {}
    for row in np.flatnonzero(~table.excluded).tolist():
        figures = tuple(str(table[name][row]) for name in table.columns if name != "part")
        part = str(table["part"][row])
        other = first.setdefault(figures, part)
        if other != part:
            yield Finding(**_place(catalog, table, row), identity="two numbers for one part", fields=("part",),
                          meaning=f"every figure is that of {other}", grade="information")  # fmt: skip


def _pairs(catalog: Catalog) -> Iterator[Finding]:
    """Pairs of rows that do not exist (in a damaged compilation); then offered parts that go with no offered part."""
    alone: list[Finding] = []
    for relation, section in RELATIONS.items():
        pairs, motors, others = getattr(catalog, relation), catalog.motors, catalog.table(section)
        there = (pairs.left >= 0) & (pairs.left < len(motors)) & (pairs.right >= 0) & (pairs.right < len(others))
        if not there.all():
            yield Finding(file=", ".join(catalog.digests), section=section, part="", family="", fields=(),
                          identity="dangling compatibility",
                          meaning=f"{int((~there).sum())} of {relation} name no part")  # fmt: skip
        left, right = pairs.left[there], pairs.right[there]
        offered = ~motors.excluded[left] & ~others.excluded[right]
        sides = [(others, right[offered], "no motor is listed for it")]
        if section == "gearheads" and len(others):
            sides.append((motors, left[offered], "no gearhead is listed for it: direct drive only"))
        for table, met, meaning in sides:
            for row in np.flatnonzero(~table.excluded & ~np.isin(np.arange(len(table)), met)).tolist():
                alone.append(Finding(**_place(catalog, table, row), identity="goes with nothing", meaning=meaning,
                                     fields=("part",), grade="information"))  # fmt: skip
    yield from alone
