"""Queries of catalogues: parts that meet conditions, parts by number and side by side, coverage."""

from __future__ import annotations

import csv
import io
import math
import operator
import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, PARTS, RELATIONS, Catalog, Source, Table, columns_of, load, path_of, shipped
from drivesizer.catalog.parts import Column, printed
from drivesizer.catalog.prices import currencies, is_list
from drivesizer.catalog.tables import CONFIDENCE, OTHER_NAMES, spelling
from drivesizer.catalog.tolerances import MakerTolerance, maker_tolerances_of
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.yaml_source import shipped_data
from drivesizer.units import KINDS, from_si, scale, to_si

if TYPE_CHECKING:
    from drivesizer.catalog.laws import Finding

# -- Conditions on columns as one types them: ``--voltage '24 V'``, ``max_speed>=8000 rpm``.


_SIGNS: dict[str, Callable[[Any, Any], Any]] = {
    "<=": operator.le, ">=": operator.ge, "!=": operator.ne, "==": operator.eq, "<": operator.lt, ">": operator.gt,
    "=": operator.eq,
}  # fmt: skip
_CONDITION = re.compile(r"\s*([A-Za-z][\w -]*?)\s*(<=|>=|!=|==|<|>|=)\s*(.*?)\s*", re.DOTALL)
_OPTION = re.compile(r"\s*(<=|>=|!=|==|<|>|=)?\s*(.*?)\s*", re.DOTALL)

# options of the command line, each with the column that it tests in a section
OPTIONS: dict[str, dict[str, str]] = {"family": dict.fromkeys(PARTS, "family")}
OPTIONS |= shipped_data("drivesizer.catalog", "headers.yaml")["options"]


class Condition(NamedTuple):
    """Condition on a column: a figure in SI, or a text in which ``*`` matches anything."""

    column: Column
    sign: str
    value: float | str

    def met(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Mask of a column's values that meet the condition; an unknown one does not."""
        if isinstance(self.value, str):
            pattern = re.compile(re.escape(self.value).replace(r"\*", ".*"), re.IGNORECASE | re.DOTALL)
            either = "both" if self.column.name == "drives" else None
            same = np.array([bool(pattern.fullmatch(v)) or v == either for v in values.tolist()], bool)
            return same if self.sign in ("=", "==") else np.asarray(~same & (values != ""), bool)
        near: NDArray[np.bool_] = np.isclose(values, self.value, rtol=1e-9, atol=0.0)
        if self.sign in ("=", "=="):
            return near
        mask: NDArray[np.bool_] = _SIGNS[self.sign](values, self.value) & ~np.isnan(values)
        return mask | near if self.sign in ("<=", ">=") else mask & ~near

    def unknown(self, values: NDArray[Any]) -> NDArray[np.bool_]:
        """Mask of a column's values that are not known."""
        return np.asarray(values == "" if isinstance(self.value, str) else np.isnan(values), bool)


def where(section: str, text: str) -> Condition:
    """A condition such as ``max_speed>=8000 rpm`` on a section's column."""
    match = _CONDITION.fullmatch(text)
    if match is None:
        raise InputError(f"--where: {quoted(text)} is not a condition; expected e.g. 'max_speed>=8000 rpm'")
    return _condition(section, column_name(match[1]), match[2], match[3], "--where")


def name_of(text: str) -> str:
    """The column that a condition names; empty when it is none."""
    match = _CONDITION.fullmatch(text)
    return column_name(match[1]) if match else ""


def column_name(text: str) -> str:
    """Name of a column that a user wrote with blanks or hyphens."""
    return re.sub(r"[ -]+", "_", text.strip())


def has(section: str, texts: Iterable[str], sort: str = "") -> bool:
    """Whether a section has all columns that conditions and sorting name."""
    names = {column_name(sort.removeprefix("-")), *map(name_of, texts)} - {""}
    return names <= set(columns_of(section))


def option(section: str, name: str, text: str) -> list[Condition] | None:
    """The conditions of an option such as ``--diameter '<=26 mm'``; None where the section has no such figure."""
    if section not in OPTIONS[name]:
        return None
    match = _OPTION.fullmatch(text)
    sign, value = (match[1] or "=", match[2]) if match else ("=", text)
    columns = OPTIONS[name][section].split()
    if len(columns) == 1:
        return [_condition(section, columns[0], sign, value, f"--{name}")]
    signs = {"=": ("<=", ">="), "==": ("<=", ">=")}.get(sign, (sign, ""))
    if sign.startswith(">"):
        signs = ("", sign)
    return [_condition(section, c, s, value, f"--{name}") for c, s in zip(columns, signs, strict=True) if s]


def _condition(section: str, name: str, sign: str, text: str, condition: str) -> Condition:
    columns = columns_of(section)
    if name not in columns:
        raise InputError(
            f"{condition}: {section} have no column {quoted(name)}; expected e.g. mass{nearest(name, columns)}"
        )
    column = columns[name]
    if column.kind == "text":
        if sign not in ("=", "==", "!=") or not text:
            raise InputError(f"{condition}: {name} is text; expected = or != and a text, in which * matches anything")
        return Condition(column, sign, text)
    try:
        return Condition(column, sign, to_si(text, column.kind))
    except InputError as error:
        raise InputError(f"{condition}: {name}: {error}") from None


def conditions(section: str, options: Mapping[str, str | None], texts: Sequence[str]) -> list[Condition] | None:
    """All conditions on a section; None when it lacks a figure that an option names."""
    criteria: list[Condition] = []
    for name, text in options.items():
        more = [] if text is None else option(section, name, text)
        if more is None:
            return None
        criteria += more
    return criteria + [where(section, text) for text in texts]


# -- Queries of catalogues: parts that meet conditions.
#
# Catalogues are searched one by one and not joined, so that every part keeps the name of its catalogue. An unknown
# figure neither meets a condition nor fails it; such parts are counted separately.


Shelf = Mapping[str, Catalog]  # catalogues by name


@dataclass(frozen=True, slots=True)
class PartRow:
    """A part with its catalogue, section and row."""

    catalogue: str
    catalog: Catalog
    section: str
    row: int

    @property
    def table(self) -> Table[Any]:
        """The part's table."""
        return self.catalog.table(self.section)

    @property
    def part(self) -> str:
        """The part number."""
        return str(self["part"])

    def __getitem__(self, name: str) -> Any:
        """A figure in SI or a text, by its column."""
        return self.table[name][self.row].item()


class Selection(NamedTuple):
    """The parts that meet all conditions, and the number of those that may, some figures being unknown."""

    hits: list[PartRow]
    undecided: int
    excluded: int  # meet all conditions, but the catalogue excludes them from sizing


def open_catalogs(names: Iterable[str] = ()) -> dict[str, Catalog]:
    """Catalogues by name, those that ship when none is given."""
    catalogs: dict[str, Catalog] = {}
    listed = list(names)
    lists = [name for name in listed if is_list(name)]  # over the prices of each
    others = [name for name in listed if name not in lists] or shipped()
    files = {name if name == "all" else os.path.realpath(path_of(name)): name for name in others}
    for file in files.values():
        catalog = load([file, *lists])
        name = ", ".join(name for name in catalog.digests if not is_list(name))
        if name in catalogs:
            raise InputError(f"two catalogues are called {quoted(name)}; rename one of the files")
        catalogs[name] = catalog
    return catalogs


def all_parts(shelf: Shelf, sections: Iterable[str] = PARTS) -> Iterator[PartRow]:
    """All parts of some sections, without direct drive."""
    for section in sections:
        for name, catalog in shelf.items():
            parts = catalog.table(section)["part"].tolist()
            yield from (PartRow(name, catalog, section, row) for row, part in enumerate(parts) if part != DIRECT)


def select(
    shelf: Shelf,
    section: str,
    conditions: Sequence[Condition],
    *,
    sort: str = "",
    excluded: bool = False,
    piece: tuple[str, Sequence[str]] = ("", ()),
) -> Selection:
    """The parts of a section that meet all conditions, sorted by a column; unknown figures come last."""
    hits: list[PartRow] = []
    undecided = left_out = 0
    for name, catalog in shelf.items():
        table = catalog.table(section)
        met = contains(table, *piece) & (table["part"] != DIRECT)
        possible = met.copy()
        for condition in conditions:
            met &= condition.met(table[condition.column.name])
            possible &= condition.met(table[condition.column.name]) | condition.unknown(table[condition.column.name])
        offered = np.ones(len(table), bool) if excluded else ~table.excluded
        left_out += int((met & ~offered).sum())
        undecided += int((possible & ~met & offered).sum())
        hits += [PartRow(name, catalog, section, int(row)) for row in np.flatnonzero(met & offered)]
    return Selection(_sorted(hits, section, sort), undecided, left_out)


def contains(table: Table[Any], text: str, names: Sequence[str]) -> NDArray[np.bool_]:
    """Rows of a table that have a text in one of some columns; case, blanks and hyphens do not matter."""
    piece = spelling(text) or text.strip()
    rows = np.full(len(table), not piece)
    for name in (name for name in names if piece and name in table.columns):
        rows |= np.array([piece in spelling(value) for value in table[name].tolist()], bool)
    return rows


def _sorted(hits: list[PartRow], section: str, name: str) -> list[PartRow]:
    if not name:
        return hits
    column = columns_of(section).get(column_name(name.removeprefix("-")))
    if column is None:
        hint = nearest(name, columns_of(section))
        raise InputError(f"--sort: {section} have no column {quoted(name)}; expected e.g. mass{hint}")
    known = [hit for hit in hits if is_known(hit[column.name])]
    unknown = [hit for hit in hits if not is_known(hit[column.name])]
    return sorted(known, key=lambda hit: hit[column.name], reverse=name.startswith("-")) + unknown


def is_known(value: Any) -> bool:
    """Whether a figure or a text is known."""
    return value != "" if isinstance(value, str) else not math.isnan(value)


# -- A part by its number, a text anywhere in numbers and names, and the sources of one part's figures.


def find(shelf: Shelf, part: str) -> list[PartRow]:
    """The parts with a number or another name, in whatever section or catalogue."""
    exact, other = list[PartRow](), list[PartRow]()
    for name, catalog in shelf.items():
        for section in PARTS:
            table = catalog.table(section)
            exact += [PartRow(name, catalog, section, table.rows[part])] if part in table.rows else []
            other += [PartRow(name, catalog, section, row) for row in table.called(part)]
    if part != DIRECT and (exact or other):
        return exact or other
    for section, names in families(shelf).items():
        if part in names:
            raise InputError(
                f"{quoted(part)} is a family of {section}; `drivesizer catalog list {section} --family '{part}'` "
                "lists its parts"
            )
    raise InputError(f"{quoted(part)} is in no catalogue{nearest(part, (hit.part for hit in all_parts(shelf)))}")


def look(shelf: Shelf, text: str) -> tuple[dict[str, dict[str, list[PartRow]]], list[PartRow]]:
    """Families whose name or kind contains a text, by section, and parts whose number does."""

    def hits(section: str, *names: str) -> list[PartRow]:
        return select(shelf, section, [], excluded=True, piece=(text, names)).hits

    called = {
        section: {hit["family"] for hit in hits(section, "family", OPTIONS["kind"][section])} for section in PARTS
    }
    groups = {
        section: {name: members for name, members in names.items() if name in called[section]}
        for section, names in families(shelf).items()
    }
    return groups, [hit for section in PARTS for hit in hits(section, "part", *OTHER_NAMES)]


def families(shelf: Shelf) -> dict[str, dict[str, list[PartRow]]]:
    """The parts of each family, by section and name."""
    groups: dict[str, dict[str, list[PartRow]]] = {section: {} for section in PARTS}
    for hit in all_parts(shelf):
        groups[hit.section].setdefault(hit["family"], []).append(hit)
    return groups


def partners(hit: PartRow) -> dict[str, dict[str, int]]:
    """Number of parts of each family that go with a part, by the sections that its catalogue pairs it with."""
    counts: dict[str, dict[str, int]] = {}
    for relation, right in RELATIONS.items():
        pairs = getattr(hit.catalog, relation)
        if hit.section not in ("motors", right) or not len(pairs.left):
            continue
        other = right if hit.section == "motors" else "motors"
        own, others = (pairs.left, pairs.right) if hit.section == "motors" else (pairs.right, pairs.left)
        names = hit.catalog.table(other)["family"][others[own == hit.row]]
        counts[other] = dict(Counter(sorted(names.tolist())))
    return counts


def origins(hit: PartRow) -> dict[str, Source]:
    """Source of each known figure of a part: that of its table, or of a note on it."""
    base = hit.catalog.sources[hit.table.source[hit.row]]
    confidence = hit.catalog.confidence(hit.section, hit.row)
    by_document = {source.document: source for source in hit.catalog.sources}
    sources = dict.fromkeys(confidence, base)
    for note in hit.catalog.notes_on(hit.section, hit.part):
        if note.source:
            sources |= {
                name: by_document.get(note.source, base) for name in (note.fields or confidence) if name in confidence
            }
    return {name: source._replace(confidence=confidence[name]) for name, source in sources.items()}


_TOLERANCED = {"motors": ("motor",), "gearheads": ("gearhead",), "actuators": ("motor", "gearhead")}


def tolerances(hit: PartRow) -> list[MakerTolerance]:
    """Tolerances that the maker states for a part's figures; for an actuator those of its motor and its gear."""
    stated, owner = hit.catalog.tolerances, (hit["manufacturer"], hit["family"])
    return [
        tolerance
        for part in _TOLERANCED.get(hit.section, ())
        for tolerance in maker_tolerances_of(stated, part, *owner).values()
    ]


# -- Parts side by side: every figure that one of them has, and whether they differ in it.


class Row(NamedTuple):
    """A column of the catalogue with the value of each part; NaN or an empty text where it is unknown."""

    column: Column
    values: tuple[Any, ...]
    differs: bool | None  # None: those that are known are the same, and some are not known


def side_by_side(hits: Sequence[PartRow]) -> list[Row]:
    """The columns in which at least one part has something."""
    sections = list(dict.fromkeys(hit.section for hit in hits))
    if len(sections) > 1:
        kinds = ", ".join(f"{hit.part} of {hit.section}" for hit in hits)
        raise InputError(f"parts of one kind can be compared; found {kinds}")
    rows = []
    for name, column in columns_of(sections[0]).items():
        values = tuple(hit[name] for hit in hits)
        known = [value for value in values if is_known(value)]
        if not known or name == "part":
            continue
        text = column.kind == "text"
        differs = any(value != known[0] if text else not math.isclose(value, known[0], rel_tol=1e-9) for value in known)
        rows.append(Row(column, values, True if differs else None if len(known) < len(values) else False))
    return rows


# -- Coverage of catalogues: parts, pairs, number of known figures of each column, and their confidence.


class Coverage(NamedTuple):
    """Coverage of one kind of part in a catalogue."""

    parts: int
    families: int
    excluded: int
    known: dict[str, int]  # parts of which the figure is known, by column
    sure: dict[str, int]  # known figures (texts are not counted) by confidence
    priced: int  # parts that have a price
    prices: dict[str, int]  # the same by currency
    silent: dict[str, list[str]]  # figures that decide in a sizing, with the families that give none of their parts'


def coverage(catalog: Catalog, section: str) -> Coverage:
    """Coverage of a section of a catalogue."""
    table = catalog.table(section)
    real = table["part"] != DIRECT
    known = {name: (table[name] != "" if c.kind == "text" else ~np.isnan(table[name])) & real
             for name, c in printed(section).items()}  # fmt: skip
    figures = [name for name, column in printed(section).items() if column.kind != "text"]
    # the confidence of each figure as its place in CONFIDENCE: as Catalog.confidence, for all rows at once
    of_source = np.array([CONFIDENCE.index(source.confidence) for source in catalog.sources])
    level = np.tile(of_source[table.source], (len(figures), 1))
    for note in (note for note in catalog.notes if note.section == section and note.confidence):
        rows = [table.rows[part] for part in note.parts if part in table.rows]
        columns = [place for place, name in enumerate(figures) if not note.fields or name in note.fields]
        level[np.ix_(columns, rows)] = CONFIDENCE.index(note.confidence)
    there = np.array([known[name] for name in figures])
    priced = currencies(catalog, section)
    groups = np.unique(table["family"][real])
    unknown = {names: lack | ~real for (names, _), lack in needed(table).items()}
    silent = {names: [str(family) for family in groups if lack[table["family"] == family].all()]
              for names, lack in unknown.items()}  # fmt: skip
    return Coverage(
        parts=int(real.sum()),
        families=len(groups),
        excluded=int((table.excluded & real).sum()),
        known={name: int(mask.sum()) for name, mask in known.items()},
        sure={name: int((there & (level == place)).sum()) for place, name in enumerate(CONFIDENCE)},
        priced=len(set().union(*priced.values())),
        prices={code: len(parts) for code, parts in priced.items()},
        silent={names: families for names, families in silent.items() if families},
    )


def needed(table: Table[Any]) -> dict[tuple[str, str], NDArray[np.bool_]]:
    """The figures of a kind of part that decide in a sizing, what each is for, and which rows of a table lack them."""
    masks = {}
    decisive = shipped_data("drivesizer.catalog", "headers.yaml")["needed"]
    for names, purpose in decisive.get(table.section, {}).items():
        columns = [table[name] for name in names.split(" or ")]
        unknown = [values == "" if values.dtype.kind == "U" else np.isnan(values) for values in columns]
        masks[names.replace("_", " "), purpose] = np.all(unknown, axis=0)
    return masks


def pairs_of(catalog: Catalog) -> dict[str, int]:
    """Number of pairs that a catalogue states."""
    direct = catalog.gearheads["part"][catalog.motor_gearhead.right] == DIRECT
    return {
        "motor and gearhead": int((~direct).sum()),
        "motor without gearhead": int(direct.sum()),
        "motor and encoder": len(catalog.motor_encoder.left),
    }


# -- Parts written out: CSV with a row of units, JSON in SI, a catalogue file.
#
# Numbers are written as the data sheet prints them where that is the same figure, so that what is exported and
# imported again is the same. An unknown figure is an empty cell, null in JSON. A text that a spreadsheet would take
# for a formula gets an apostrophe in front, which :func:`plain` removes.


ORIGIN = ("catalog", "document", "confidence", "excluded")  # columns of a CSV that are no figures of a part
_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # a spreadsheet takes a cell that begins so for a formula


def safe(text: str) -> str:
    """A text as a cell that no spreadsheet takes for a formula.

    >>> safe("=1+1"), safe("RE 25")
    ("'=1+1", 'RE 25')
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n")  # a lone carriage return ends the row for most readers
    return f"'{text}" if text.lstrip("'").startswith(_FORMULA) else text


def plain(cell: str) -> str:
    """The text of a cell that drivesizer or another program wrote.

    >>> plain("'=1+1"), plain("'n Sync")
    ('=1+1', "'n Sync")
    """
    return cell[1:] if cell.startswith("'") and cell.lstrip("'").startswith(_FORMULA) else cell


def digits(value: float, column: Column) -> str:
    """A figure in its column's unit, with the digits that give the same figure when read again."""
    if math.isnan(value):
        return ""
    factor, offset = scale(column.unit, column.kind)
    figure = float(from_si(value, column.unit, column.kind))
    for count in range(6, 17):
        text = f"{figure:.{count}g}"
        if float(text) * factor + offset == value:
            return repr(float(text)).removesuffix(".0") if "e" in text else text
    return repr(figure)


def as_csv(section: str, hits: Sequence[PartRow]) -> bytes:
    """Parts of one section as CSV: a header, a row of units, then a part with its source in each row."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    columns = printed(section)
    writer.writerow([*columns, *ORIGIN])
    writer.writerow(["" if c.unit == "1" else c.unit for c in columns.values()] + [""] * len(ORIGIN))
    for hit in hits:
        source, excluded = hit.catalog.sources[hit.table.source[hit.row]], bool(hit.table.excluded[hit.row])
        cells = [safe(hit[name]) if c.kind == "text" else digits(hit[name], c) for name, c in columns.items()]
        writer.writerow([*cells, safe(hit.catalogue), safe(source.document), source.confidence, str(excluded).lower()])
    return text.getvalue().encode()


def _known(value: Any) -> Any:
    """A figure or a text; None where it is unknown."""
    if isinstance(value, str):
        return value or None
    return value if not isinstance(value, float) or math.isfinite(value) else None


def as_finding(finding: Finding) -> dict[str, Any]:
    """A finding with its numbers in SI, null where there is none."""
    values = {f.name: _known(getattr(finding, f.name)) for f in fields(finding)}
    return values | {"unexplained": finding.unexplained}


def as_document(shelf: Mapping[str, Catalog], hits: Sequence[PartRow], *, sources: bool = False) -> dict[str, Any]:
    """Parts as one JSON document with their catalogues and units, figures in SI, null where one is unknown."""
    parts = []
    for hit in hits:
        part: dict[str, Any] = {"section": hit.section, "catalog": hit.catalogue}
        part |= {name: _known(hit[name]) for name in printed(hit.section)}
        part |= {"excluded": bool(hit.table.excluded[hit.row])}
        if sources:  # of its figures, and the tolerances that its maker states
            part["sources"] = {name: source._asdict() for name, source in origins(hit).items()}
            part["tolerances"] = [
                {"part": tolerance.part, "figure": tolerance.figure, "tolerance": tolerance.tolerance,
                 "text": tolerance.text or None, "source": hit.catalog.sources[tolerance.source]._asdict()}
                for tolerance in tolerances(hit)
            ]  # fmt: skip
        parts.append(part)
    sections = [section for section in PARTS if any(hit.section == section for hit in hits)]
    units = {section: {name: KINDS[c.kind].si for name, c in columns_of(section).items() if c.kind != "text"}
             for section in sections}  # fmt: skip
    digests = {name: digest for c in shelf.values() for name, digest in c.digests.items()}
    return {"catalogs": digests, "units": units, "parts": parts}
