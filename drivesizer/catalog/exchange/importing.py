"""Import of another program's table: CSV with a header and a row of units, to the text of a catalogue file.

Numbers are copied as printed, in the units of the table; nothing is computed or guessed. The resulting text is read as
a catalogue before it is written.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from drivesizer.catalog.catalog_file import RATIO, SCHEMA, parse
from drivesizer.catalog.columns import Column
from drivesizer.catalog.exchange.currencies import foreign_prices
from drivesizer.catalog.exchange.exporting import plain
from drivesizer.catalog.exchange.import_map import Plan
from drivesizer.catalog.parts import columns_of
from drivesizer.errors import CatalogError, InputError, nearest, quoted
from drivesizer.files.yaml_source import YamlSource
from drivesizer.units import number, scale

__all__ = ["Imported", "heads_of", "import_table"]

_BARE = re.compile(r"[A-Za-z][A-Za-z0-9_ ()*/^.%+-]*[A-Za-z0-9_)%]|[A-Za-z]")
_WORDS = {"null", "true", "false"}


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


def import_table(text: str, path: Path, plan: Plan, target: Path) -> Imported:
    """Make the text of a catalogue file from a table."""
    sheet = _sheet(text, path)
    taken = _columns(sheet, plan)
    units, plan, taken = foreign_prices(sheet.units, plan, taken)
    sheet = sheet._replace(units=units)
    heads = {name: _head(sheet, place, columns_of(plan.section)[name]) for name, place in taken.items()}
    rows, skipped = _rows(sheet, taken, plan)
    used = {name for _, row in rows for name in row}
    groups: dict[str, list[dict[str, str]]] = {}
    for line, row in rows:
        groups.setdefault(_family(sheet, line, row, plan), []).append(row)
    imported = Imported(
        text=_written(plan, _maker(sheet, plan, groups), groups, heads),
        parts=len(rows),
        families={_untoken(name): len(some) for name, some in groups.items()},
        columns={sheet.header[place]: name for name, place in taken.items()},
        unknown=tuple(h for h in sheet.header if h and h not in plan.columns and h not in columns_of(plan.section)),
        empty=tuple(name for name in taken if name not in used),
        skipped=skipped,
    )
    _loads(imported.text, target)
    return imported


def heads_of(text: str, path: Path) -> tuple[list[str], list[str]]:
    """Header and units of a table."""
    sheet = _sheet(text, path)
    return sheet.header, sheet.units


def _rows(
    sheet: _Sheet, taken: Mapping[str, int], plan: Plan
) -> tuple[list[tuple[int, dict[str, str]]], tuple[str, ...]]:
    """Rows with a part number, each with its line, and the reasons why others were skipped."""
    found: dict[str, tuple[int, dict[str, str]]] = {}
    skipped: list[str] = []
    for line, cells in sheet.rows:
        row = _row(sheet, line, cells, taken, plan)
        if "part" not in row:
            skipped.append(f"line {line}: no part number" if any(cells) else f"line {line}: empty")
            continue
        first, _ = found.setdefault(row["part"], (line, row))
        if first != line:
            raise InputError(f"{sheet.path}:{line}: part: {quoted(_untoken(row['part']))} is in line {first} too")
    if not found:
        raise InputError(f"{sheet.path}: rows: no part found below the header and the row of units")
    return list(found.values()), tuple(skipped)


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


def _columns(sheet: _Sheet, plan: Plan) -> dict[str, int]:
    """Place of each column in the table."""
    for theirs in (name for name in plan.columns if name not in sheet.header):
        near = nearest(theirs, sheet.header)
        raise InputError(f"{sheet.path}:1: header: the map's column {quoted(theirs)} is not there{near}")
    found: dict[str, int] = {}
    own = columns_of(plan.section)
    for place, theirs in enumerate(sheet.header):
        name = plan.columns.get(theirs, theirs if theirs in own else None)
        if name is None:
            continue
        if name in found:
            raise InputError(f"{sheet.path}:1: header: {quoted(theirs)} and another column are both {name}")
        if name in plan.common:
            raise InputError(f"{sheet.path}:1: header: {quoted(theirs)} is {name}, which the map gives in common too")
        found[name] = place
    if "part" not in found:
        raise InputError(
            f"{sheet.path}:1: header: no column is the part number; name it in the map, e.g. Order no.: part"
        )
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
    """Known cells of a row as YAML, by column."""
    found: dict[str, str] = {}
    schema = columns_of(plan.section)
    for name, place in taken.items() if any(cells) else ():
        cell = plain(cells[place])
        if cell == "" or cell == "~" or cell in plan.unknown:
            continue
        unit = sheet.units[place] if place < len(sheet.units) else ""
        where = f"{sheet.path}:{line}: {sheet.header[place]}"
        found[name] = _token(cell) if schema[name].kind == "text" else _number(cell, unit, schema[name], where)
    return found


def _number(cell: str, unit: str, column: Column, where: str) -> str:
    """A number as printed, checked."""
    if column.kind == "ratio" and RATIO.fullmatch(cell):
        return cell.removesuffix(":1")
    try:
        value, rest = number(cell)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    if rest:
        raise InputError(f"{where}: {quoted(cell)} is not a plain number; the unit belongs in the second row")
    factor, offset = scale(unit or "1", column.kind)
    if value * factor + offset < column.least or (column.kind == "ratio" and value <= 0.0):
        least = "not above 0" if column.kind == "ratio" else f"below {column.least:g}"
        raise InputError(f"{where}: {column.name} {quoted(cell)} is {least}")
    return str(int(cell)) if re.fullmatch(r"[+-]?0[0-9]+", cell) else cell


def _token(text: str) -> str:
    """A text as YAML; unquoted where YAML reads it as the same text.

    >>> _token("RE 25"), _token("118752"), _token("1e5"), _token("27:1")
    ('RE 25', '118752', '"1e5"', '"27:1"')
    """
    if _BARE.fullmatch(text) and text.lower() not in _WORDS:
        return text
    if re.fullmatch(r"[1-9][0-9]{0,17}", text):
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else "\\U" + f"{ord(c):08x}" for c in escaped) + '"'


def _untoken(token: str) -> str:
    """The text of a token, for messages."""
    return token.strip('"')


def _family(sheet: _Sheet, line: int, row: dict[str, str], plan: Plan) -> str:
    """The family of a row as YAML; removed from the row."""
    family = row.pop("family", _token(plan.family) if plan.family else "")
    if not family:
        raise InputError(f"{sheet.path}:{line}: family: unknown; give one with --family or in the map")
    return family


def _maker(sheet: _Sheet, plan: Plan, groups: Mapping[str, list[dict[str, str]]]) -> str:
    """The one maker of all rows as YAML; removed from the rows."""
    found = {row.pop("manufacturer") for rows in groups.values() for row in rows if "manufacturer" in row}
    found |= {_token(plan.manufacturer)} if plan.manufacturer and not found else set()
    if len(found) != 1:
        names = " and ".join(sorted(map(_untoken, found))[:3]) or "none"
        raise InputError(
            f"{sheet.path}: manufacturer: {names} found; a catalogue has one (--manufacturer, or in the map)"
        )
    return found.pop()


def _written(plan: Plan, maker: str, groups: dict[str, list[dict[str, str]]], heads: Mapping[str, str]) -> str:
    """The catalogue file."""
    source = ", ".join(f"{key}: {_token(value)}" for key, value in plan.source.items() if value)
    lines = [f"catalog: {SCHEMA}", f"manufacturer: {maker}", "sources:", f"  {_token(plan.source_name)}: {{{source}}}"]
    lines += ["", f"{plan.section}:"]
    for family, rows in groups.items():
        lines += _block(family, rows, heads, plan)
    return "\n".join(lines).rstrip("\n") + "\n"


def _block(family: str, rows: list[dict[str, str]], heads: Mapping[str, str], plan: Plan) -> Iterator[str]:
    """The table of one family, without columns that have no value."""
    names = [name for name in heads if any(name in row for row in rows)]
    common = ", ".join(f"{name}: {_common(value)}" for name, value in plan.common.items())
    yield f"- family: {family}"
    yield f"  source: {_token(plan.source_name)}"
    if common:
        yield f"  common: {{{common}}}"
    yield f"  columns: [{', '.join(_token(heads[name]) for name in names)}]"
    yield "  rows:"
    for row in rows:
        yield f"  - [{', '.join(row.get(name, '~') for name in names)}]"
    yield ""


def _common(value: Any) -> str:
    return "~" if value is None else str(value) if isinstance(value, int | float) else _token(value)


def _loads(text: str, target: Path) -> None:
    """Check that the text loads as a catalogue."""
    try:
        parse(YamlSource(text, str(target)), target.stem, "")
    except (CatalogError, InputError) as error:
        raise InputError(f"{error} (nothing was written)") from None
