"""Import of another program's table: CSV with a header and a row of units, to the text of a catalogue file."""

from __future__ import annotations

import csv
import difflib
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from drivesizer.catalog.catalog_file import RATIO, parse
from drivesizer.catalog.exporting import plain
from drivesizer.catalog.parts import PARTS, Column, columns_of
from drivesizer.catalog.schema import SCHEMA
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.errors import CatalogError, InputError, nearest, quoted
from drivesizer.files.yaml_source import Path_, YamlSource, read
from drivesizer.units import number, scale

# -- Map of a table to import: its columns, and figures that all parts have in common.
#
# manufacturer: Anymaker
# family: M 20                       # where no column gives it
# source: {name: sheet, document: "data sheet, page 3", confidence: quoted, date: "2024-05", url: "https://..."}
# unknown: ["-", n/a]                # further cells that mean unknown, besides an empty one and ~
# common: {kind: brushed, diameter: 20 mm}
# columns:
#   Order no.: part
#   Nominal voltage: nominal_voltage
#   Remark: ~                        # not imported


_KEYS = ("manufacturer", "family", "source", "unknown", "common", "columns")
_SOURCE = ("name", "document", "confidence", "date", "url")


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Map and options combined."""

    section: str
    columns: Mapping[str, str | None]  # header in the table -> column of the catalogue, None: not imported
    manufacturer: str
    family: str
    source_name: str
    source: Mapping[str, str]  # document, confidence, date, url
    unknown: tuple[str, ...]
    common: Mapping[str, Any]


def plan(section: str, path: Path | None, options: Mapping[str, str | None]) -> Plan:
    """Plan of an import from a map file and options; an option takes precedence over the map."""
    if section not in PARTS:
        raise InputError(f"--section: {quoted(section)} is not known; expected {', '.join(PARTS)}")
    file, known = read(path) if path else YamlSource("{}", ""), columns_of(section)
    given = _mapping(file, file.data, (), _KEYS)
    source = _mapping(file, given.get("source"), ("source",), _SOURCE)
    stated = {key: _text(file, source.get(key), ("source", key)) for key in _SOURCE}
    stated |= {key: _text(file, given.get(key), (key,)) for key in ("manufacturer", "family")}
    stated |= {key: value for key, value in options.items() if value}
    if not stated["document"]:
        raise InputError("--document: the source of the figures is missing; expected e.g. 'data sheet, 2024-05'")
    if stated["confidence"] not in CONFIDENCE:
        raise InputError(f"--confidence: {quoted(stated['confidence'])}; expected one of {', '.join(CONFIDENCE)}")
    columns = _mapping(file, given.get("columns"), ("columns",))
    for theirs, ours in columns.items():
        if ours is not None and (not isinstance(ours, str) or ours not in known):
            hint = nearest(str(ours), known) or f"; expected one such as {', '.join(list(known)[:4])}"
            raise InputError(f"{file.where(('columns', theirs))}: {section} have no column {quoted(ours)}{hint}")
    unknown = given.get("unknown")
    if unknown is not None and not isinstance(unknown, list):
        raise InputError(f'{file.where(("unknown",))}: expected a list, e.g. ["-", n/a]')
    common = _mapping(file, given.get("common"), ("common",))
    for name, figure in common.items():
        if name not in known or name in ("part", "family", "manufacturer"):
            raise InputError(f"{file.where(('common', name))}: not a figure that parts have in common")
        if isinstance(figure, dict | list | bool):
            raise InputError(f"{file.where(('common', name))}: expected a figure with its unit, or text")
    return Plan(
        section=section,
        columns=columns,
        manufacturer=stated["manufacturer"],
        family=stated["family"],
        source_name=stated["name"] or "table",
        source={key: stated[key] for key in ("document", "date", "confidence", "url")},
        unknown=tuple(_text(file, cell, ("unknown", place)) for place, cell in enumerate(unknown or [])),
        common=common,
    )


def _mapping(file: YamlSource, value: Any, path: Path_, allowed: tuple[str, ...] = ()) -> dict[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise InputError(f"{file.where(path)}: expected fields such as {', '.join(allowed or ('Order no.: part',))}")
    for key in value if allowed else ():
        if key not in allowed:
            raise InputError(f"{file.where((*path, key))}: unknown key {quoted(key)}; expected {', '.join(allowed)}")
    return value


def _text(file: YamlSource, value: Any, path: Path_) -> str:
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"{file.where(path)}: expected text")
    return str(value)


# -- Prices of a table in their currency: euros, francs, or any other, kept as it is.


_SIGNS = {"$": "USD", "US$": "USD", "£": "GBP", "¥": "JPY", "€": "EUR"}


def currency_of(unit: str) -> str:
    """Code of a currency, of its sign or of the code itself; empty where a unit is none."""
    return _SIGNS.get(unit, unit if re.fullmatch(r"[A-Z]{3}", unit) else "")


def foreign_prices(
    units: Sequence[str], plan: Plan, taken: Mapping[str, int]
) -> tuple[list[str], Plan, dict[str, int]]:
    """Prices in another currency than euros, in the columns for them; nothing is converted."""
    place = taken.get("price", taken.get("foreign_price", len(units)))
    unit = currency_of(units[place]) if place < len(units) else ""
    if not unit or unit == "EUR":
        return list(units), plan, dict(taken)
    francs = unit == "CHF" and "list_price" in columns_of(plan.section)
    own = "list_price" if francs else "foreign_price"
    renamed = {own if at == place else name: at for name, at in taken.items()}
    cleared = [*units[:place], "CHF" if francs else "", *units[place + 1 :]]
    stated = {} if francs or "currency" in taken else {"currency": unit}
    return cleared, replace(plan, common={**stated, **plan.common}), renamed


# -- Columns of another program's table, guessed by their headers and units, and the map that says so.
#
# A guess is by the words of ``headers.yaml``, and only where the unit fits the kind of the column: it is shown and
# written as a map, for a person to look at.


_NEAR = 0.82  # likeness of a header to a name, from which on it counts


def guessed(header: Sequence[str], units: Sequence[str], section: str) -> dict[str, str]:
    """The column that each header of a table means, by its words and its unit."""
    columns, words_of = columns_of(section), read(Path(__file__).with_name("headers.yaml")).data
    own = {name for name in header if name in columns}
    found: list[tuple[float, int, str, str]] = []
    for place, theirs in enumerate(header):
        unit = units[place] if place < len(units) else ""
        for name, column in columns.items() if theirs not in own else ():
            words = [name.replace("_", " "), *words_of.get(name, "").split("; ")]
            ratios = (difflib.SequenceMatcher(None, _plain(theirs), word).ratio() for word in words if word)
            near = max(ratios, default=0.0)
            if near >= _NEAR and name not in own and _fits(unit, column):
                found.append((-near, place, theirs, name))
    chosen: dict[str, str] = {}
    for _, _, theirs, name in sorted(found):
        if theirs not in chosen and name not in chosen.values():
            chosen[theirs] = name
    return {theirs: chosen[theirs] for theirs in header if theirs in chosen}


def _plain(text: str) -> str:
    """A header in small letters, without marks and without what is in brackets.

    >>> _plain("Max. continuous torque [mNm]"), _plain("Order no.")
    ('max continuous torque', 'order no')
    """
    bare = re.sub(r"[\[(][^\])]*[\])]", "", text.lower())
    return " ".join(re.sub(r"[^a-z0-9]+", " ", bare).split())


def _fits(unit: str, column: Column) -> bool:
    """Whether a unit is one of a column's kind; a text has none."""
    if column.name == "price" and currency_of(unit):
        return True
    if column.kind in ("text", "ratio"):
        return unit in ("", "1")
    try:
        scale(unit or "1", column.kind)
    except InputError:
        return False
    return True


def map_text(columns: Mapping[str, str], header: Sequence[str], stated: Mapping[str, str | None]) -> str:
    """The map of a guess as YAML: what is left out stands there too, to be completed."""
    import json

    def quoted(text: str) -> str:
        return json.dumps(text, ensure_ascii=False)

    lines = [f"{key}: {quoted(stated[key] or '')}" for key in ("manufacturer", "family") if stated.get(key)]
    source = {key: stated[key] for key in ("name", "document", "confidence", "date", "url") if stated.get(key)}
    if source:
        lines.append(f"source: {{{', '.join(f'{key}: {quoted(str(value))}' for key, value in source.items())}}}")
    lines.append("columns:  # guessed by name and unit: look at each; ~ is not imported")
    lines += [f"  {quoted(theirs)}: {columns.get(theirs, '~')}" for theirs in header if theirs]
    return "\n".join(lines) + "\n"


# -- Import of another program's table: CSV with a header and a row of units, to the text of a catalogue file.
#
# Numbers are copied as printed, in the units of the table; nothing is computed or guessed. The resulting text is
# read as a catalogue before it is written.


_BARE = re.compile(r"[A-Za-z][A-Za-z0-9_ ()*/^.%+-]*[A-Za-z0-9_)%]|[A-Za-z]")
_YAML_WORDS = {"null", "true", "false"}
_QUOTE = '"'  # of tokens, left out in messages


class Imported(NamedTuple):
    """Result of an import: the text of the catalogue file, and a summary."""

    text: str
    parts: int
    families: dict[str, int]
    columns: dict[str, str]  # header in the table -> column
    unknown: tuple[str, ...]  # headers in the table that are no column
    empty: tuple[str, ...]  # columns without any value
    skipped: tuple[str, ...]  # rows, each with its reason


class _Sheet(NamedTuple):
    path: Path
    header: list[str]
    units: list[str]
    rows: list[tuple[int, list[str]]]  # line and cells


def heads_of(text: str, path: Path) -> tuple[list[str], list[str]]:
    """Header and units of a table."""
    sheet = _sheet(text, path)
    return sheet.header, sheet.units


def import_table(text: str, path: Path, plan: Plan, target: Path) -> Imported:
    """Make the text of a catalogue file from a table."""
    sheet = _sheet(text, path)
    taken = _places_of_columns(sheet, plan)
    units, plan, taken = foreign_prices(sheet.units, plan, taken)
    sheet = sheet._replace(units=units)
    schema = columns_of(plan.section)
    heads = {name: _head(sheet, place, schema[name]) for name, place in taken.items()}
    rows: dict[str, tuple[int, dict[str, str]]] = {}
    skipped: list[str] = []
    for line, cells in sheet.rows:
        row = _row(sheet, line, cells, taken, plan)
        if "part" not in row:
            skipped.append(f"line {line}: no part number" if any(cells) else f"line {line}: empty")
            continue
        first, _ = rows.setdefault(row["part"], (line, row))
        if first != line:
            raise InputError(f"{path}:{line}: part: {quoted(row['part'].strip(_QUOTE))} is in line {first} too")
    if not rows:
        raise InputError(f"{path}: rows: no part found below the header and the row of units")
    used = {name for _, row in rows.values() for name in row}
    groups: dict[str, list[dict[str, str]]] = {}
    makers: set[str] = set()
    for line, row in rows.values():
        makers |= {row.pop("manufacturer")} if "manufacturer" in row else set()
        family = row.pop("family", _token(plan.family) if plan.family else "")
        if not family:
            raise InputError(f"{path}:{line}: family: unknown; give one with --family or in the map")
        groups.setdefault(family, []).append(row)
    makers = makers or ({_token(plan.manufacturer)} if plan.manufacturer else set())
    if len(makers) != 1:
        names = " and ".join([maker.strip(_QUOTE) for maker in sorted(makers)][:3]) or "none"
        raise InputError(f"{path}: manufacturer: {names} found; a catalogue has one (--manufacturer, or in the map)")
    made = _written(plan, makers.pop(), groups, heads)
    try:
        parse(YamlSource(made, str(target)), target.stem, "")
    except (CatalogError, InputError) as error:
        raise InputError(f"{error} (nothing was written)") from None
    return Imported(
        text=made,
        parts=len(rows),
        families={name.strip(_QUOTE): len(some) for name, some in groups.items()},
        columns={sheet.header[place]: name for name, place in taken.items()},
        unknown=tuple(h for h in sheet.header if h and h not in plan.columns and h not in schema),
        empty=tuple(name for name in taken if name not in used),
        skipped=tuple(skipped),
    )


def _sheet(text: str, path: Path) -> _Sheet:
    head = text.partition("\n")[0]
    if ";" in head and "," not in head:
        raise InputError(f"{path}:1: header: separated by semicolons; expected commas, and points in numbers")
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        rows = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except csv.Error as error:
        raise InputError(f"{path}:{reader.line_num}: row: {error}; expected comma-separated values") from None
    if len(rows) < 2:
        raise InputError(f"{path}: expected a header, a row of units such as ,V,rpm and then a part in each row")
    (_, header), (_, units), *rest = rows
    for line, cells in [(2, units), *rest]:
        if len(cells) != len(header) and any(cells):
            what = "units" if line == 2 else "row"
            raise InputError(f"{path}:{line}: {what}: {len(cells)} cells; the header has {len(header)}")
    return _Sheet(path, header, units, rest)


def _places_of_columns(sheet: _Sheet, plan: Plan) -> dict[str, int]:
    """Place of each column in the table."""
    where = f"{sheet.path}:1: header"
    for theirs in (name for name in plan.columns if name not in sheet.header):
        near = nearest(theirs, sheet.header)
        raise InputError(f"{where}: the map's column {quoted(theirs)} is not there{near}")
    found: dict[str, int] = {}
    own = columns_of(plan.section)
    for place, theirs in enumerate(sheet.header):
        name = plan.columns.get(theirs, theirs if theirs in own else None)
        if name is None:
            continue
        if name in found:
            raise InputError(f"{where}: {quoted(theirs)} and another column are both {name}")
        if name in plan.common:
            raise InputError(f"{where}: {quoted(theirs)} is {name}, which the map gives in common too")
        found[name] = place
    if "part" not in found:
        raise InputError(f"{where}: no column is the part number; name it in the map, e.g. Order no.: part")
    return found


def _head(sheet: _Sheet, place: int, column: Column) -> str:
    """A column's head in the catalogue, its unit checked."""
    unit = sheet.units[place] if place < len(sheet.units) else ""
    where = f"{sheet.path}:2: {sheet.header[place]}"
    if column.kind in ("text", "ratio") or (column.kind == "dimensionless" and unit in ("", "1")):
        if unit not in ("", "1"):
            raise InputError(
                f"{where}: {column.name} has no unit, found {quoted(unit)}; the second row holds the units"
            )
        return column.name
    if not unit:
        raise InputError(f"{where}: {column.name} needs a unit in the second row, e.g. {column.unit}")
    try:
        scale(unit, column.kind)
    except InputError as error:
        raise InputError(f"{where}: {error}; the second row holds the units, e.g. {column.unit}") from None
    return f"{column.name} ({unit})"


def _row(sheet: _Sheet, line: int, cells: list[str], taken: Mapping[str, int], plan: Plan) -> dict[str, str]:
    """Known cells of a row as YAML, by column; numbers as printed, checked."""
    found: dict[str, str] = {}
    for name, place in taken.items() if any(cells) else ():
        column, cell = columns_of(plan.section)[name], plain(cells[place])
        if cell in ("", "~", *plan.unknown):
            continue
        if column.kind == "text" or (column.kind == "ratio" and RATIO.fullmatch(cell)):
            found[name] = _token(cell) if column.kind == "text" else cell.removesuffix(":1")
            continue
        where = f"{sheet.path}:{line}: {sheet.header[place]}"
        try:
            value, rest = number(cell)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        if rest:
            raise InputError(f"{where}: {quoted(cell)} is not a plain number; the unit belongs in the second row")
        unit = sheet.units[place] if place < len(sheet.units) else ""
        factor, offset = scale(unit or "1", column.kind)
        if value * factor + offset < column.least or (column.kind == "ratio" and value <= 0.0):
            least = "not above 0" if column.kind == "ratio" else f"below {column.least:g}"
            raise InputError(f"{where}: {column.name} {quoted(cell)} is {least}")
        found[name] = str(int(cell)) if re.fullmatch(r"[+-]?0[0-9]+", cell) else cell
    return found


def _token(text: str) -> str:
    """A text as YAML; unquoted where YAML reads it as the same text.

    >>> _token("RE 25"), _token("118752"), _token("1e5"), _token("27:1")
    ('RE 25', '118752', '"1e5"', '"27:1"')
    """
    if _BARE.fullmatch(text) and text.lower() not in _YAML_WORDS:
        return text
    if re.fullmatch(r"[1-9][0-9]{0,17}", text):
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else "\\U" + f"{ord(c):08x}" for c in escaped) + '"'


def _written(plan: Plan, maker: str, groups: dict[str, list[dict[str, str]]], heads: Mapping[str, str]) -> str:
    """The catalogue file: a table of each family, without columns that have no value."""
    source, name = ", ".join(f"{key}: {_token(value)}" for key, value in plan.source.items() if value), plan.source_name
    lines = [f"catalog: {SCHEMA}", f"manufacturer: {maker}", "sources:", f"  {_token(name)}: {{{source}}}", ""]
    lines.append(f"{plan.section}:")
    common = ", ".join(
        f"{figure}: {'~' if value is None else value if isinstance(value, int | float) else _token(value)}"
        for figure, value in plan.common.items()
    )
    for family, rows in groups.items():
        names = [head for head in heads if any(head in row for row in rows)]
        lines += [f"- family: {family}", f"  source: {_token(name)}"]
        lines += [f"  common: {{{common}}}"] if common else []
        lines += [f"  columns: [{', '.join(_token(heads[head]) for head in names)}]", "  rows:"]
        lines += [f"  - [{', '.join(row.get(head, '~') for head in names)}]" for row in rows]
        lines.append("")
    return "\n".join(lines).rstrip("\n") + "\n"
