"""Parts written out: CSV with a row of units, JSON in SI, a catalogue file.

Numbers are written as the data sheet prints them where that is the same figure, so that what is exported and
imported again is the same. An unknown figure is an empty cell, null in JSON. A text that a spreadsheet would take
for a formula gets an apostrophe in front, which :func:`plain` removes.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from drivesizer.catalog import PARTS, Catalog, columns_of
from drivesizer.catalog.law_check import Finding
from drivesizer.catalog.parts import Column, printed
from drivesizer.catalog.query import Hit, origins, tolerances
from drivesizer.catalog.schema import SCHEMA
from drivesizer.units import KINDS, from_si, scale

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
    shown = float(from_si(value, column.unit, column.kind))
    for count in range(6, 17):
        text = f"{shown:.{count}g}"
        if float(text) * factor + offset == value:
            return repr(float(text)).removesuffix(".0") if "e" in text else text
    return repr(shown)


def as_csv(section: str, hits: Sequence[Hit]) -> bytes:
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


def as_document(shelf: Mapping[str, Catalog], hits: Sequence[Hit], *, sources: bool = False) -> dict[str, Any]:
    """Parts as one JSON document with their catalogues and units, figures in SI, null where one is unknown."""
    parts = []
    for hit in hits:
        part: dict[str, Any] = {"section": hit.section, "catalog": hit.catalogue}
        part |= {name: _known(hit[name]) for name in printed(hit.section)}
        part |= {"excluded": bool(hit.table.excluded[hit.row])}
        if sources:  # of its figures, and the tolerances that its maker states
            part["sources"] = {name: one._asdict() for name, one in origins(hit).items()}
            part["tolerances"] = [
                {"part": one.part, "figure": one.figure, "tolerance": one.tolerance, "text": one.text or None,
                 "source": hit.catalog.sources[one.source]._asdict()}
                for one in tolerances(hit)
            ]  # fmt: skip
        parts.append(part)
    sections = [section for section in PARTS if any(hit.section == section for hit in hits)]
    units = {section: {name: KINDS[c.kind].si for name, c in columns_of(section).items() if c.kind != "text"}
             for section in sections}  # fmt: skip
    digests = {name: digest for c in shelf.values() for name, digest in c.digests.items()}
    return {"catalogs": digests, "units": units, "parts": parts}


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
