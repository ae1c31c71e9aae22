"""Check of a catalogue's figures against each other, by laws that data sheets must satisfy.

>>> findings = check_file("maxon")
>>> [f for f in findings if f.unexplained]
[]
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.identities import as_printed
from drivesizer.catalog.law import SLACK, Law, Numbers, decimal_places, half_last_digit
from drivesizer.catalog.laws_of_parts import LAWS, odd_discharges, odd_pull_outs
from drivesizer.catalog.more_parts import Column
from drivesizer.catalog.parts import PARTS, RELATIONS, columns_of
from drivesizer.catalog.tables import Catalog, Note, Table
from drivesizer.units import from_si, show

__all__ = ["Finding", "check", "check_file"]


INFORMATION = "information"
_NOMINAL = {  # whole numbers by definition, not by rounding
    "nominal_voltage", "counts_per_turn", "steps_per_turn", "full_steps", "stages", "teeth", "pitch", "rated_time",
}  # fmt: skip
_WRONG: dict[str, Callable[[Any, Any, Any], Any]] = {
    "=": lambda found, expected, span: np.abs(found - expected) > span,
    "<=": lambda found, expected, span: found - expected > span,
    ">=": lambda found, expected, span: expected - found > span,
    "<": lambda found, expected, span: found >= expected,
    ">": lambda found, expected, span: found <= expected,
}


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
        return self.grade != INFORMATION and not self.accepted

    def text(self) -> str:
        """The finding as one line."""
        line = f"{self.file}: {self.section} {self.part} ({self.family}): {self.identity}"
        if self.kind:
            numbers = [show(value, self.unit, self.kind) for value in (self.found, self.expected)]
            line += f": {numbers[0]}, expected {self.relation.removeprefix('=')} {numbers[1]}".replace("  ", " ")
            line += f", off by {self.deviation:+.1%}, tolerance {self.tolerance:.1%}"
        return f"{line}: {self.meaning}" + (f"; accepted: {self.accepted}" if self.accepted else "")


def check_file(name: str, *, beside: Path | None = None) -> list[Finding]:
    """Findings of one catalogue, by name or by file; see :func:`check`."""
    from drivesizer.catalog import load

    return check(load([name], beside=beside))


def check(catalog: Catalog) -> list[Finding]:
    """All findings of a catalogue, the accepted included, in the order of the parts.

    Unknown figures are not checked. Excluded parts are checked but do not count in comparisons with their family, and
    their findings are accepted for the reason of their exclusion. For several catalogues loaded as one a finding names
    all the files: check each by itself (:func:`check_file`).
    """
    catalog, found = as_printed(catalog), list[Finding]()
    for section in PARTS:
        table, notes = catalog.table(section), _notes_by_part(catalog, section)
        here = [f for law in LAWS if law.section == section for f in _broken(catalog, table, law)]
        here += _twins(catalog, table)
        if section == "batteries":
            here += _discharges(catalog)
        if section == "steppers":
            here += _pull_outs(catalog)
        found += sorted((_accepted_by_note(f, notes.get(f.part, [])) for f in here), key=lambda f: table.rows[f.part])
    return [*found, *_dangling(catalog), *_alone(catalog)]


# --- laws ------------------------------------------------------------------------------------------------------------


def _broken(catalog: Catalog, table: Table[Any], law: Law) -> Iterator[Finding]:
    """The parts that break a law."""
    column = columns_of(law.section)[law.figure]
    with np.errstate(all="ignore"):
        found, expected = table[law.figure], np.asarray(law.expected(table), float)
        tolerance = _tolerance(table, law)
        wrong = _WRONG[law.relation](found, expected, (tolerance + SLACK) * np.abs(expected))
        deviation = (found - expected) / np.where(expected == 0.0, 1.0, np.abs(expected))
    for row in np.flatnonzero(wrong & ~np.isnan(found) & ~np.isnan(expected)).tolist():
        yield Finding(
            **_place(catalog, table, row), identity=law.name, meaning=law.meaning,
            fields=tuple(dict.fromkeys((law.figure, *law.fields))), relation=law.relation, found=float(found[row]),
            expected=float(expected[row]), kind=column.kind, unit=column.unit, deviation=float(deviation[row]),
            tolerance=float(tolerance[row]), reason=law.reason, source=law.source, grade=law.grade,
        )  # fmt: skip


def _place(catalog: Catalog, table: Table[Any], row: int) -> dict[str, Any]:
    name = ", ".join(catalog.digests)
    return {
        "file": name,
        "section": table.section,
        "part": str(table["part"][row]),
        "family": str(table["family"][row]),
    }


def _tolerance(table: Table[Any], law: Law) -> Numbers:
    """Tolerance of a law per part: rounding of its figures and the law's allowance."""
    total = np.full(len(table), law.allowance)
    columns = columns_of(law.section)
    for name in (law.figure, *law.fields) if law.rounds else ():
        if columns[name].kind not in ("text", "ratio"):
            total += _rounding(table, columns[name])
    return np.asarray(np.nan_to_num(total))


def _rounding(table: Table[Any], column: Column) -> Numbers:
    """Half of the last printed digit of each figure, relative to it.

    Figures have at most three digits, and no decimal place that no figure of their family has: 10 beside 14.6 is 10.0,
    0.05 beside 0.85 may be 0.046.
    """
    printed = np.abs(from_si(table[column.name], column.unit, column.kind))
    place = np.zeros(len(table))
    places = decimal_places(printed)
    for family in np.unique(table["family"]) if column.name not in _NOMINAL else ():
        here = table["family"] == family
        place[here] = 10.0 ** -places[here].max()
    return half_last_digit(printed, place)


# --- notes of the catalogue ------------------------------------------------------------------------------------------


def _notes_by_part(catalog: Catalog, section: str) -> dict[str, list[Note]]:
    notes: dict[str, list[Note]] = {}
    for note in catalog.notes:
        if note.section == section and (note.accepted or note.exclude):
            for part in note.parts:
                notes.setdefault(part, []).append(note)
    return notes


def _accepted_by_note(finding: Finding, notes: list[Note]) -> Finding:
    """The finding, with the text of a note that accepts one of its fields, or that excludes its part."""
    for note in notes:
        if note.exclude or not note.fields or set(note.fields) & set(finding.fields):
            return replace(finding, accepted=note.text)
    return finding


def _discharges(catalog: Catalog) -> Iterator[Finding]:
    """Contradictions of batteries' discharge tables, among each other and with the batteries' figures."""
    for odd in odd_discharges(catalog.discharges, catalog.batteries):
        yield Finding(**_place(catalog, catalog.batteries, odd.row), **odd.finding)


def _pull_outs(catalog: Catalog) -> Iterator[Finding]:
    """Contradictions of steppers' pull-out curves with their holding torque and with themselves."""
    for odd in odd_pull_outs(catalog.pull_outs, catalog.steppers):
        yield Finding(**_place(catalog, catalog.steppers, odd.row), **odd.finding)


# --- parts among each other ------------------------------------------------------------------------------------------


def _twins(catalog: Catalog, table: Table[Any]) -> Iterator[Finding]:
    """Parts that agree in every field but the number."""
    first: dict[tuple[str, ...], str] = {}
    for row in np.flatnonzero(~table.excluded).tolist():
        figures = tuple(str(table[name][row]) for name in table.columns if name != "part")
        part = str(table["part"][row])
        other = first.setdefault(figures, part)
        if other != part:
            meaning = f"every figure is that of {other}"
            yield Finding(**_place(catalog, table, row), identity="two numbers for one part", meaning=meaning,
                          fields=("part",), grade=INFORMATION)  # fmt: skip


def _dangling(catalog: Catalog) -> Iterator[Finding]:
    """Pairs of rows that do not exist: impossible in a file, possible in a damaged compilation."""
    for relation, section in RELATIONS.items():
        pairs = getattr(catalog, relation)
        sides = ((pairs.left, len(catalog.motors)), (pairs.right, len(catalog.table(section))))
        out = sum(int(((rows < 0) | (rows >= count)).sum()) for rows, count in sides)
        if out:
            yield Finding(file=", ".join(catalog.digests), section=section, part="", family="", fields=(),
                          identity="dangling compatibility", meaning=f"{out} of {relation} name no part")  # fmt: skip


def _alone(catalog: Catalog) -> Iterator[Finding]:
    """Offered parts that go with no offered part: no contradiction, but never found by a search."""
    for relation, section in RELATIONS.items():
        pairs, motors, others = getattr(catalog, relation), catalog.motors, catalog.table(section)
        inside = (pairs.left < len(motors)) & (pairs.right < len(others))
        left, right = pairs.left[inside], pairs.right[inside]
        both = ~motors.excluded[left] & ~others.excluded[right]
        yield from _unmet(catalog, others, right[both], "no motor is listed for it")
        if section == "gearheads" and len(others):
            yield from _unmet(catalog, motors, left[both], "no gearhead is listed for it: direct drive only")


def _unmet(catalog: Catalog, table: Table[Any], met: NDArray[np.int32], meaning: str) -> Iterator[Finding]:
    alone = ~table.excluded & ~np.isin(np.arange(len(table)), met)
    for row in np.flatnonzero(alone).tolist():
        yield Finding(**_place(catalog, table, row), identity="goes with nothing", meaning=meaning, fields=("part",),
                      grade=INFORMATION)  # fmt: skip
