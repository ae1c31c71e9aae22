"""Import of parts as people have them: a shop's table, a workbook, a data sheet, to the text of a catalogue file.

Numbers are copied as printed; a cell with a unit of its own is brought to that of its column. Which column a head means
is guessed by the words of ``headers.yaml``, and only where its unit fits; a map says it instead. The resulting text is
read as a catalogue before anything is written.
"""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from drivesizer.catalog.catalog_file import RATIO, Reader, parse
from drivesizer.catalog.parts import PARTS, RELATIONS, Column, columns_of
from drivesizer.catalog.query import needed, plain
from drivesizer.catalog.schema import SCHEMA
from drivesizer.catalog.tables import CONFIDENCE, Catalog
from drivesizer.errors import CatalogError, InputError, nearest, quoted
from drivesizer.files.sheets import Sheet, currency_of, decimal_sign, figure, plain_head, split_head, unit_of
from drivesizer.files.yaml_source import YamlSource, read, shipped_data
from drivesizer.units import scale

_KEYS = ("manufacturer", "family", "source", "unknown", "common", "units", "columns")
_SOURCE = ("name", "document", "confidence", "date", "url")
_UNKNOWN = ("", "-", "–", "—", "~")
_NO_FIGURE = ("n/a", "na", "n.a.", "tbd", "k.a.", "none", "null", "nan")  # further ones, where a number is due
_NEAR = 0.86  # likeness of a head to a word, from which on it counts
_GENERAL = frozenset(
    {"part", "family", "manufacturer", "mass", "length", "diameter", "price", "kind", "shaft_diameter"}
)
_TEXTS = ("text", "ratio")
_COLUMNS = {name: column for part in PARTS for name, column in columns_of(part).items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """The words of the user about a table, in a map and in options.

    A map is YAML: ``manufacturer``, ``family``, ``source: {name, document, confidence, date, url}``, ``unknown: [n/a]``
    for further cells that mean unknown, ``common: {kind: brushed}``, ``units: {Weight: g}`` where the table has none,
    ``columns: {Order no.: part, Remark: ~}``.
    """

    section: str = ""  # empty: the one that fits best
    columns: Mapping[str, str | None] | None = None  # head -> column, None: not imported; without a map guessed
    units: Mapping[str, str] = field(default_factory=dict)
    manufacturer: str = ""
    family: str = ""
    source_name: str = ""
    source: Mapping[str, str] = field(default_factory=dict)  # document, confidence, date, url
    unknown: tuple[str, ...] = ()
    common: Mapping[str, Any] = field(default_factory=dict)
    answers: Mapping[str, str] = field(default_factory=dict)  # head -> column, of heads that no guess understood


class Head(NamedTuple):
    """A head of a table, its column and its unit."""

    theirs: str
    unit: str
    line: int
    column: str = ""  # of the catalogue; two, where a cell has a range; empty: not understood
    lacks: str = ""  # why it is not imported


class Imported(NamedTuple):
    """Result of an import: the text of the catalogue file, and what was understood."""

    text: str
    catalog: Catalog
    section: str
    families: dict[str, int]
    heads: list[Head]
    examples: list[str]  # the first known cell below each head
    assumed: tuple[str, ...]  # what the table does not say
    stated: dict[str, Any]  # what stands in a map beside the columns, the assumed included
    cells: tuple[str, ...]  # that are not understood, and are unknown
    skipped: tuple[str, ...]  # rows, each with its reason
    empty: tuple[str, ...]  # columns without any value


# -- What the user says.


def plan(section: str, path: Path | None, options: Mapping[str, str | None], common: Sequence[str] = ()) -> Plan:
    """Plan of an import from a map file and options; an option takes precedence over the map."""
    if section and section not in PARTS:
        raise InputError(f"--section: {quoted(section)} is not known; expected {', '.join(PARTS)}")
    file = read(path) if path else YamlSource("{}", "")
    reader = Reader(file)
    settings = reader.fields({} if file.data is None else file.data, (), {"properties": _KEYS})
    source = reader.fields(settings.get("source") or {}, ("source",), {"properties": _SOURCE})
    stated = {key: reader.plain_text(source.get(key), ("source", key)) for key in _SOURCE}
    stated |= {key: reader.plain_text(settings.get(key), (key,)) for key in ("manufacturer", "family")}
    stated |= {key: value for key, value in options.items() if value}
    if stated["confidence"] and stated["confidence"] not in CONFIDENCE:
        raise InputError(f"--confidence: {quoted(stated['confidence'])}; expected one of {', '.join(CONFIDENCE)}")
    known = columns_of(section) if section else _COLUMNS
    columns = reader.mapping(settings["columns"], ("columns",), "Order no.: part") if "columns" in settings else None
    for theirs, ours in (columns or {}).items():
        if ours is not None and (not isinstance(ours, str) or ours not in known):
            hint = nearest(str(ours), known) or f"; expected one such as {', '.join(list(known)[:4])}"
            what = section or "parts"
            raise InputError(f"{file.where(('columns', theirs))}: {what} have no column {quoted(ours)}{hint}")
    unknown = settings.get("unknown")
    if unknown is not None and not isinstance(unknown, list):
        raise InputError(f'{file.where(("unknown",))}: expected a list, e.g. ["-", n/a]')
    shared = dict(reader.mapping(settings.get("common"), ("common",), "kind: brushed"))
    for entry in common:
        name, sign, text = entry.partition("=")
        if not sign or name.strip() not in known:
            raise InputError(f"--set: {quoted(entry)}; expected a column and its figure, e.g. kind=brushed")
        shared |= {name.strip(): text.strip()}
    for name, value in shared.items():
        if name not in known or name in ("part", "family", "manufacturer"):
            raise InputError(f"{file.where(('common', name))}: not a figure that parts have in common")
        if isinstance(value, dict | list | bool):
            raise InputError(f"{file.where(('common', name))}: expected a figure with its unit, or text")
    units = reader.mapping(settings.get("units"), ("units",), "Weight: g")
    return Plan(
        section=section,
        columns=columns,
        units={theirs: reader.plain_text(unit, ("units", theirs)) for theirs, unit in units.items()},
        manufacturer=stated["manufacturer"],
        family=stated["family"],
        source_name=stated["name"],
        source={key: stated[key] for key in ("document", "date", "confidence", "url")},
        unknown=tuple(reader.plain_text(cell, ("unknown", place)) for place, cell in enumerate(unknown or [])),
        common=shared,
    )


# -- How a table lies: a part in each row below a header, or a part in each column beside its figures' names.


class Layout(NamedTuple):
    """Heads of a table, and the cells of each part with their lines."""

    heads: list[Head]
    parts: list[tuple[int, list[str]]]
    lying: bool = False


def _layouts(sheet: Sheet, units: Mapping[str, str]) -> Iterator[Layout]:
    rows = [(line, cells) for line, cells in sheet.rows if any(cells)]
    for place, (line, cells) in enumerate(rows[:15]):  # upright
        named = [cell for cell in cells if cell and not re.fullmatch(r"[\d.,\s+-]+", cell)]
        if len(named) < 2 or place + 1 == len(rows):
            continue
        below = rows[place + 1][1]
        own = [unit_of(cell) or ("1" if cell == "1" else "") for cell in below]
        has_units = any(own) and not any(cell and not unit for cell, unit in zip(below, own, strict=True))
        heads = [
            _head(cell, own[at] if has_units and at < len(own) else "", line, units) for at, cell in enumerate(cells)
        ]
        start = place + 1 + (has_units or not any(below))
        yield Layout(heads, rows[start:])
    width = max((len(cells) for _, cells in rows), default=0)
    if width < 2 or len(rows) < 2:
        return
    full = [(line, [*cells, *[""] * (width - len(cells))]) for line, cells in rows]
    shares = [sum(bool(unit_of(cells[at])) for _, cells in full) / len(full) for at in range(width)]
    unit_at = max(range(1, width), key=lambda at: shares[at])
    unit_at = unit_at if shares[unit_at] > 0.3 else 0
    values = [at for at in range(1, width) if at != unit_at
              and sum(bool(re.search(r"\d", cells[at])) for _, cells in full) > len(full) // 4]  # fmt: skip
    heads = [_head(cells[0], unit_of(cells[unit_at]) if unit_at else "", line, units) for line, cells in full]
    if values:  # what a line of a data sheet says once it says of all parts
        alone = {place: cells[at] for place, (_, cells) in enumerate(full)
                 if sheet.separator == " " and len(places := [at for at in values if cells[at]]) == 1
                 for at in places}  # fmt: skip
        shared = [[alone.get(place) or cells[at] for place, (_, cells) in enumerate(full)] for at in values]
        yield Layout(heads, [(0, cells) for cells in shared], lying=True)


def _head(cell: str, unit: str, line: int, units: Mapping[str, str]) -> Head:
    theirs, own = (cell, "") if cell in _COLUMNS else split_head(cell)
    return Head(cell, units.get(cell, units.get(theirs, unit or own)), line)


# -- What a head means.


def _words() -> dict[str, Any]:
    return shipped_data("drivesizer.catalog", "headers.yaml")


@cache
def _meanings(section: str) -> dict[str, list[str]]:
    """Columns of a section by the words that mean them."""
    own, meanings = columns_of(section), dict[str, list[str]]()
    lists = {name: text for name, text in _words()["words"].items() if name in own}
    lists |= {name: text for name, text in _words()["ranges"].items() if any(column in own for column in name.split())}
    for name, text in {**dict.fromkeys(own, ""), **lists}.items():
        for word in (*([name.replace("_", " ")] if name in own else []), *text.split("; ")):
            if word and name not in meanings.setdefault(word, []):
                meanings[word].append(name)
    for name, text in _words()["per_turn"].items():
        for word in text.split("; ") if name in own else ():
            meanings.setdefault(word, []).append(name)
    return meanings


def meant_by(section: str, key: str) -> str:
    """The column that a key means, itself or by what shops call it; the key where that is none, or several.

    >>> meant_by("motors", "free_speed"), meant_by("motors", "mass"), meant_by("motors", "colour")
    ('no_load_speed', 'mass', 'colour')
    """
    meant = [] if key in columns_of(section) else _meanings(section).get(plain_head(key.replace("_", " ")), [])
    return meant[0] if len(meant) == 1 and " " not in meant[0] else key


def _spoken(theirs: str) -> list[str]:
    """A head's words, whole and without the symbol behind them."""
    words = plain_head(theirs if theirs in _COLUMNS else split_head(theirs)[0])
    first, _, last = words.rpartition(" ")
    return [words, first] if first and len(last) <= 3 else [words]


def _guessed(layout: Layout, section: str, near: bool = True) -> list[Head]:
    """Heads with the columns that they mean, by their words and units; each column once, the best match first."""
    known, meanings, matches = columns_of(section), _meanings(section), list[tuple[float, int, str]]()
    for place, head in enumerate(layout.heads):
        for step, words in enumerate(_spoken(head.theirs) if head.theirs else ()):
            if head.theirs in known:
                matches.append((-1.1, place, head.theirs))
                break
            names = dict.fromkeys(meanings.get(words, ()), 1.0 - 0.02 * step)
            if near and not names and len(words) > 3:
                like = difflib.get_close_matches(words, meanings, 3, _NEAR)
                names = {name: 0.9 * difflib.SequenceMatcher(None, words, word).ratio()
                         for word in reversed(like) for name in meanings[word]}  # fmt: skip
            matches += [(-likeness, place, name) for name, likeness in names.items()]
            if names:
                break
    columns, misfits = dict[int, str](), dict[int, str]()
    for _, place, name in sorted(matches):
        if place in columns or name in columns.values():
            continue
        lacks = _unfit(layout, place, name, known)
        if lacks:
            misfits.setdefault(place, lacks)
        else:
            columns[place] = name
    heads = []
    for place, head in enumerate(layout.heads):
        name = columns.get(place, "")
        heads.append(
            head._replace(
                column=name, unit=_unit_of(layout, place, name, known), lacks="" if name else misfits.get(place, "")
            )
        )
    for column, instead in (("ratio", "reduction"), ("part", "order_number")):
        if column in known and not any(head.column == column for head in heads):
            heads = [head._replace(column=column) if head.column == instead else head for head in heads]
    return heads


def _unit_of(layout: Layout, place: int, name: str, known: Mapping[str, Column]) -> str:
    """Unit of a column: as its head has it, as its first cell has it, as all of the trade mean it."""
    head = layout.heads[place]
    if head.unit or not name or (name in known and known[name].kind in _TEXTS):
        return head.unit
    for _, cells in layout.parts:
        cell = cells[place] if place < len(cells) else ""
        if (match := re.search(r"\d\s*([^\d\s.,'()+±-][^()\d]*(?:\d[^()\d]*)?)$|^([€$£])", cell)) and (
            unit := unit_of(match.group(1) or match.group(2))
        ):
            return unit
    return str(_words()["implied"].get(plain_head(head.theirs), ""))


def _unfit(layout: Layout, place: int, name: str, known: Mapping[str, Column]) -> str:
    """The reason for which a head cannot mean a column; empty where it can."""
    unit = _unit_of(layout, place, name, known)
    if name in _words()["per_turn"] and name in known and unit in ("deg", "°"):
        return ""
    for column in (known[word] for word in name.split() if word in known):
        if column.name in ("price", "foreign_price") and currency_of(unit):
            continue
        if column.kind in _TEXTS:
            if unit not in ("", "1"):
                return f"{column.name.replace('_', ' ')} has no unit, found {unit}"
            continue
        if not unit and column.kind != "dimensionless":
            return f"{column.name.replace('_', ' ')} without a unit; write e.g. [{column.unit}]"
        try:
            scale(unit or "1", column.kind)
        except InputError as error:
            return str(error)
    return ""


def understood(sheets: Sequence[Sheet], plan: Plan) -> tuple[str, Layout, Sheet]:
    """Kind of part, heads and rows of the table of a file that says most of parts."""
    best: tuple[float, str, Layout, Sheet] | None = None
    for sheet in sheets:
        for layout in _layouts(sheet, plan.units):
            for section in [plan.section] if plan.section else PARTS:
                if plan.columns is not None:
                    names = {head.theirs for head in layout.heads}
                    score = float(sum(theirs in names for theirs in plan.columns))
                    score += 0.5 * len(names & set(columns_of(section)))
                else:
                    heads = _guessed(layout, section, near=False)
                    score = sum((0.4 if head.column in _GENERAL else 1.0) for head in heads if head.column)
                    score += 0.3 * sum(bool(head.lacks) for head in heads)
                if best is None or score > best[0] + 1e-9:
                    best = score, section, layout, sheet
    if best is None or best[0] < (0.3 if plan.section or plan.columns else 1.0):
        raise InputError("expected a header with names such as Order no., Nominal voltage [V], and parts below it, "
                         "or names and units at the left and a part in each column; --map names columns")  # fmt: skip
    _, section, layout, sheet = best
    return section, layout, sheet


def _mapped(layout: Layout, section: str, plan: Plan, where: str) -> list[Head]:
    """Heads with the columns that a map gives them; a head that is a column's own name needs none."""
    columns, known = plan.columns or {}, columns_of(section)
    for theirs in columns:
        if theirs not in {head.theirs for head in layout.heads}:
            near = nearest(theirs, [head.theirs for head in layout.heads])
            raise InputError(f"{where}: header: the map's column {quoted(theirs)} is not there{near}")
    heads, names = [], set[str]()
    for place, head in enumerate(layout.heads):
        name = columns.get(head.theirs, head.theirs if head.theirs in known else None)
        if name is None:
            heads.append(head)
            continue
        if name in names:
            raise InputError(f"{where}: header: {quoted(head.theirs)} and another column are both {name}")
        if name in plan.common:
            raise InputError(f"{where}: header: {quoted(head.theirs)} is {name}, which the map gives in common too")
        if lacks := _unfit(layout, place, name, known):
            raise InputError(f"{where}: {head.theirs}: {lacks}")
        names.add(name)
        heads.append(head._replace(column=name, unit=_unit_of(layout, place, name, known)))
    return heads


# -- Figures of a cell.


def _cell(cell: str, column: Column, unit: str, decimal: str) -> str:
    """A cell as YAML in its column's unit."""
    if column.kind == "text":
        return _token(cell)
    bare = re.sub(r"^i\s*=\s*|\s*(?=:)|(?<=:)\s*", "", cell)
    if column.kind == "ratio" and RATIO.fullmatch(bare):
        return bare.removesuffix(":1")
    text, rest = figure(bare.removesuffix(":1"), decimal)
    own = unit_of(rest) or (unit_of(rest.split()[0]) if rest and not rest.startswith((".", "-", "–", "to ")) else "")
    if rest and not own and not (column.kind == "dimensionless" and rest == "1"):
        raise InputError(f"{quoted(cell)} is not a plain number; the unit belongs in the head, or in the row below it")
    if own and own != unit and not currency_of(own):
        (factor, offset), (to, start) = scale(own, column.kind), scale(unit or "1", column.kind)
        text = f"{(float(text) * factor + offset - start) / to:.12g}"
    if not currency_of(unit):
        factor, offset = scale(unit or "1", column.kind)
        if float(text) * factor + offset < column.least or (column.kind == "ratio" and float(text) <= 0.0):
            least = "not above 0" if column.kind == "ratio" else f"below {column.least:g}"
            raise InputError(f"{column.name} {quoted(cell)} is {least}")
    return str(int(text)) if re.fullmatch(r"[+-]?0[0-9]+", text) else text


def _cells(cell: str, head: Head, known: Mapping[str, Column], decimal: str) -> dict[str, str]:
    """Known figures of a cell as YAML: of two columns where it is a range."""
    names = head.column.split()
    if len(names) == 2:
        ends = re.split(r"\s*(?:\.{2,}|…|–|—|\bto\b|\bbis\b|(?<=[\d°CVA])\s*-\s*(?=[\d+]))\s*", cell)
        if len(ends) != 2:
            raise InputError(f"{quoted(cell)} is no range; expected e.g. 10 ... 30")
        return {
            name: _cell(end, known[name], head.unit, decimal)
            for name, end in zip(names, ends, strict=True)
            if name in known
        }
    if head.column in _words()["per_turn"] and head.unit in ("deg", "°"):
        return {head.column: f"{360.0 / float(figure(cell, decimal)[0]):.12g}"}
    return {head.column: _cell(cell, known[head.column], head.unit, decimal)}


# -- The catalogue file.


_BARE = re.compile(r"[A-Za-z][A-Za-z0-9_ ()*/^.%+-]*[A-Za-z0-9_)%]|[A-Za-z]")
_YAML_WORDS = {"null", "true", "false"}
_QUOTE = '"'  # of tokens, left out in messages


def import_table(
    sheets: Sequence[Sheet], path: Path, plan: Plan, target: Path, partners: Mapping[str, Catalog] | None = None
) -> Imported:
    """Make the text of a catalogue file from the tables of a file."""
    try:
        section, layout, sheet = understood(sheets, plan)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    where = str(path) if layout.lying else f"{path}:{layout.heads[0].line}"
    heads = _guessed(layout, section) if plan.columns is None else _mapped(layout, section, plan, where)
    heads = [head if head.column else head._replace(column=plan.answers.get(head.theirs, "")) for head in heads]
    heads = [
        head._replace(column="", lacks="given in common") if head.column in plan.common else head for head in heads
    ]
    heads, common = _prices(heads, section, plan)
    numbered = any(head.column == "part" for head in heads)
    if not numbered and plan.columns is not None:
        raise InputError(f"{where}: header: no column is the part number; name it in the map, e.g. Order no.: part")
    decimal = decimal_sign([cell for _, cells in layout.parts for cell in cells], sheet.separator)
    rows, odd, skipped = _rows(path, layout, heads, columns_of(section), decimal, plan)
    assumed = [] if numbered else [f"no part numbers: {', '.join(row['part'].strip(_QUOTE) for _, row in rows[:3])}"]
    columns = {name for _, row in rows for name in row} | {"family", "manufacturer"}
    groups, maker = _families(path, rows, plan, assumed)
    source = dict(plan.source)
    for key, value, option in (("document", path.name, "--document"), ("confidence", "secondary", "--confidence")):
        if not source.get(key):
            if plan.columns is not None:
                raise InputError(f"{option}: the source of the figures is missing; expected e.g. 'data sheet, 2024-05'")
            source[key] = value
            assumed.append(f"{key} {value} ({option})")
    if section == "gearheads" and plan.columns is None and "max_motor_shaft" in columns \
            and "mounting" not in {*common, *(head.column for head in heads)}:  # fmt: skip
        common["mounting"] = "clamping hub"
        assumed.append("mounting clamping hub, which takes any motor whose shaft it holds (--set mounting=flange)")
    named = _token(plan.source_name or "table")
    sources = {named: {key: _token(value) for key, value in source.items() if value}}
    pairs = _compatibility(section, list(groups), named, partners or {})
    text = file_text(section, maker, sources, _tables(section, groups, heads, common, named), pairs)
    try:
        catalog = parse(YamlSource(text, str(target)), target.stem, "")
    except (CatalogError, InputError) as error:
        raise InputError(f"{error} (nothing was written)") from None
    return Imported(
        text=text,
        catalog=catalog,
        section=section,
        families={name.strip(_QUOTE): len(members) for name, members in groups.items()},
        heads=heads,
        examples=[next((cells[at] for _, cells in layout.parts if at < len(cells) and cells[at]), "")
                  for at in range(len(heads))],
        assumed=tuple(assumed),
        stated={"manufacturer": maker.strip(_QUOTE), "family": next(iter(groups)).strip(_QUOTE)}
        | {"source": {"name": plan.source_name} | source, "common": common},
        cells=tuple(odd),
        skipped=tuple(skipped),
        empty=tuple(name for head in heads for name in head.column.split() if name not in columns),
    )  # fmt: skip


def _rows(
    path: Path, layout: Layout, heads: Sequence[Head], known: Mapping[str, Column], decimal: str, plan: Plan
) -> tuple[list[tuple[int, dict[str, str]]], list[str], list[str]]:
    """Known cells of each part as YAML, by column; cells that are not understood; rows that are no part."""
    rows, odd, skipped = list[tuple[int, dict[str, str]]](), list[str](), list[str]()
    numbered, lines = any(head.column == "part" for head in heads), dict[str, int]()
    for at, (line, cells) in enumerate(layout.parts, 1):
        if plan.columns is not None and len(cells) != len(heads) and any(cells):
            raise InputError(f"{path}:{line}: row: {len(cells)} cells; the header has {len(heads)}")
        row = dict[str, str]()
        for head, cell in zip(heads, map(plain, cells), strict=False):
            if not head.column or cell in _UNKNOWN or cell in plan.unknown:
                continue
            if cell.casefold() in _NO_FIGURE and not (head.column in known and known[head.column].kind == "text"):
                continue
            place = f"{path}:{line or head.line}: {head.theirs}"
            try:
                row |= _cells(cell, head, known, decimal)
            except InputError as error:
                if plan.columns is not None:
                    raise InputError(f"{place}: {error}") from None
                odd.append(f"line {line or head.line}: {head.theirs}: {error}")
        if not numbered and row:
            voltage = f" {row['nominal_voltage']} V" if "nominal_voltage" in row else f" {at}"
            name = plan.family or path.stem.replace("_", " ")
            row["part"] = _token(f"{name}{voltage if len(layout.parts) > 1 else ''}")
        if "part" not in row:
            skipped.append(f"line {line}: no part number" if any(cells) else f"line {line}: empty")
            continue
        if row["part"] in lines:
            name = quoted(row["part"].strip(_QUOTE))
            raise InputError(f"{path}:{line}: part: {name} is in line {lines[row['part']]} too")
        lines[row["part"]] = line
        rows.append((line, row))
    if not rows:
        raise InputError(f"{path}: rows: no part found below the header")
    return rows, odd, skipped


def _families(
    path: Path, rows: Sequence[tuple[int, dict[str, str]]], plan: Plan, assumed: list[str]
) -> tuple[dict[str, list[dict[str, str]]], str]:
    """Parts by family, and their maker; without a map the file's name stands for what is not said."""
    groups, makers, stem = dict[str, list[dict[str, str]]](), set[str](), path.stem.replace("_", " ")
    for line, row in rows:
        makers |= {row.pop("manufacturer")} if "manufacturer" in row else set()
        family = row.pop("family", "") or (_token(plan.family) if plan.family else "")
        if not family and plan.columns is not None:
            raise InputError(f"{path}:{line}: family: unknown; give one with --family or in the map")
        if not family and f"family {stem} (--family)" not in assumed:
            assumed.append(f"family {stem} (--family)")
        groups.setdefault(family or _token(stem), []).append(row)
    makers = {_token(plan.manufacturer)} if plan.manufacturer else makers
    if not makers and plan.columns is None:
        makers = {_token(stem)}
        assumed.append(f"manufacturer {stem} (--manufacturer)")
    if len(makers) != 1:
        names = " and ".join([maker.strip(_QUOTE) for maker in sorted(makers)][:3]) or "none"
        raise InputError(f"{path}: manufacturer: {names} found; a catalogue has one (--manufacturer, or in the map)")
    return groups, makers.pop()


def _prices(heads: list[Head], section: str, plan: Plan) -> tuple[list[Head], dict[str, Any]]:
    """Prices in another currency than euros go into the columns for them; nothing is converted."""
    common = dict(plan.common)
    for at, head in enumerate(heads):
        code = currency_of(head.unit) if head.column in ("price", "foreign_price") else ""
        if not code or code == "EUR":
            continue
        francs = code == "CHF" and "list_price" in columns_of(section)
        heads[at] = head._replace(column="list_price" if francs else "foreign_price", unit="CHF" if francs else "")
        if not francs and not any(other.column == "currency" for other in heads):
            common.setdefault("currency", code)
    return heads, common


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


def file_text(
    section: str, maker: str, sources: Mapping[str, Mapping[str, str]], tables: Sequence[Mapping[str, Any]],
    pairs: Mapping[str, Sequence[Mapping[str, str]]],
) -> str:  # fmt: skip
    """The text of a catalogue file, of cells that are YAML already: sources, tables of families, what goes together."""

    def flow(group: Mapping[str, str]) -> str:
        return f"{{{', '.join(f'{key}: {value}' for key, value in group.items())}}}"

    lines = [f"catalog: {SCHEMA}", f"manufacturer: {maker}", "sources:"]
    lines += [*(f"  {name}: {flow(source)}" for name, source in sources.items()), "", f"{section}:"]
    for table in tables:
        lines += [f"- family: {table['family']}", f"  source: {table['source']}"]
        lines += [f"  common: {flow(table['common'])}"] if table.get("common") else []
        lines += [f"  columns: [{', '.join(table['columns'])}]", "  rows:"]
        lines += [f"  - [{', '.join(row)}]" for row in table["rows"]]
        lines += ["  notes:", *(f"  - {flow(note)}" for note in table["notes"])] if "notes" in table else []
        lines.append("")
    lines += ["compatibility:"] if pairs else []
    for relation, groups in pairs.items():
        lines += [f"  {relation}:", *(f"  - {flow(group)}" for group in groups)]
    return "\n".join(lines).rstrip("\n") + "\n"


def _tables(
    section: str, groups: Mapping[str, list[dict[str, str]]], heads: Sequence[Head], common: Mapping[str, Any],
    source: str,
) -> list[dict[str, Any]]:  # fmt: skip
    """A table of each family, without columns that have no value."""
    known, titles = columns_of(section), dict[str, str]()
    for head in heads:
        for column in (name for name in head.column.split() if name in known):
            bare = known[column].kind in _TEXTS or head.unit in ("", "1") or column in _words()["per_turn"]
            titles[column] = column if bare else f"{column} ({head.unit})"
    titles.setdefault("part", "part")
    shared = {
        name: "~" if value is None else str(value) if isinstance(value, int | float) else _token(value)
        for name, value in common.items()
    }
    tables = []
    for family, rows in groups.items():
        names = sorted((name for name in titles if any(name in row for row in rows)), key=lambda name: name != "part")
        cells = [[row.get(name, "~") for name in names] for row in rows]
        tables.append({"family": family, "source": source, "common": shared,
                      "columns": [_token(titles[name]) for name in names], "rows": cells})  # fmt: skip
    return tables


def _compatibility(
    section: str, families: Sequence[str], source: str, partners: Mapping[str, Catalog]
) -> dict[str, list[dict[str, str]]]:
    """Lists of what goes together: motors drive without a gearhead; parts of catalogues that are named fit."""
    lists, own = dict[str, list[dict[str, str]]](), f"[{', '.join(families)}]"
    if section == "motors":
        alone = {"name": "direct drive", "source": source, "motors": own, "gearheads": "[direct]"}
        lists["motor_gearhead"] = [alone]
    for relation, other in RELATIONS.items():
        for name, catalog in partners.items() if section in ("motors", other) else ():
            side = other if section == "motors" else "motors"
            names = dict.fromkeys(str(family) for family in catalog.table(side)["family"] if family)
            across = ", ".join(f"{{{_token(name)}: {_token(family)}}}" for family in names)
            sides = {"motors": own, other: own} | {side: f"[{across}]"}
            if names:
                lists.setdefault(relation, []).append({"name": "assumed", "source": source, **sides})
    return lists


def map_text(imported: Imported) -> str:
    """The map of a guess as YAML: what is left out stands there too, to be completed."""

    def quote(value: Any) -> str:
        if not isinstance(value, dict):
            return json.dumps(value, ensure_ascii=False)
        return f"{{{', '.join(f'{key}: {quote(inner)}' for key, inner in value.items() if inner)}}}"

    heads = {head.column for head in imported.heads}
    lines = [f"{key}: {quote(value)}" for key, value in imported.stated.items() if value and key not in heads]
    lines.append("columns:  # guessed by name and unit: look at each; ~ is not imported")
    lines += [f"  {quote(head.theirs)}: {head.column or '~'}" for head in imported.heads if head.theirs]
    return "\n".join(lines) + "\n"


def on_shop_pages(section: str) -> list[str]:
    """Figures by which one begins: those of a shop's page."""
    return _words()["on_shop_pages"].get(section, ["mass"])


def lacking(catalog: Catalog, section: str) -> list[tuple[str, str, int]]:
    """Figures that a sizing needs and parts lack: their names, what each is for, and of how many parts."""
    gaps = ((*head, int(lack.sum())) for head, lack in needed(catalog.table(section)).items())
    return [gap for gap in gaps if gap[2]]
