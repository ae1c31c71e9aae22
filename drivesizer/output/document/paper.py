"""A document as plain data for the templates of PDF and page: what they print, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from math import isfinite
from typing import Any

from drivesizer.output.derivation import cleaned, short
from drivesizer.output.document import records as doc
from drivesizer.version import __version__

_MOST_LISTED = 40  # sections of a table of contents on half a page


def paper_data(document: doc.Document, date: str | None = None) -> dict[str, Any]:
    """Everything that a report prints but its figures; texts are printed as strings, never read as markup."""
    title_block = dict(document.block)
    revision = f"revision {title_block['Revision']}" if "Revision" in title_block else ""
    header = ", ".join(filter(None, (document.name, title_block.get("Project", ""), revision)))
    sections = sections_data(document.sections)
    return cleaned({"name": document.name, "header": short(header), "block": document.block,
                                    "machine": document.machine, "version": __version__, "date": short(date or "", 40),
                                    "found": document.has_drive, "subject": document.subject, "sections": sections,
                                    "depth": 2 if len(sections) <= _MOST_LISTED else 1})  # fmt: skip


def sections_data(sections: Iterable[doc.Printed]) -> list[dict[str, Any]]:
    """Sections as plain data; one without a title goes on in the one above."""
    chapters: list[dict[str, Any]] = []
    for section, title, blocks, _, axis in sections:
        data = [as_data(block, axis) for block in blocks if _on_paper(block)]
        if not chapters or title not in ("", chapters[-1]["title"]):
            name = f"{axis}{section.name}" if axis else section.name
            chapters.append({"name": name, "title": title, "level": section.level,
                          "appendix": section.appendix, "blocks": data})  # fmt: skip
        else:
            chapters[-1]["blocks"] += data
    return [section for section in chapters if section["blocks"] or section["level"] == 1]


def _on_paper(block: doc.Block) -> bool:
    return not isinstance(block, doc.Series) and not (
        isinstance(block, doc.Table | doc.Words) and block.media not in doc.PAPER
    )


def as_data(value: Any, axis: str = "") -> Any:
    """Records as lists and dicts, each with its ``kind``; names of figures and tables of an axis begin with its key."""
    of = (
        f", {axis.removesuffix('-').replace('axis', 'axis ')}" if axis else ""
    )  # of equal parts that a page has several
    if isinstance(value, doc.Table):
        columns = [column for column in value.columns if column.media in doc.PAPER]
        if value.look != "checks":  # whose columns line up from group to group
            columns = [c for c in columns if any(row.cells.get(c.key, "") != "" for row in value.rows)]
        return {
            "kind": "table", "name": f"{axis}{value.name}" if value.name else "", "look": value.look,
            "caption": as_data(value.caption, axis), "label": (doc.text_of(value.caption) + of).removeprefix(", "),
            "columns": [{"key": c.key, "head": c.head, "form": c.form, "width": c.width, "merged": c.merged}
                        for c in columns],
            "rows": [_row(row, value, [c.key for c in columns], axis) for row in value.rows],
            "dense": value.dense, "sortable": value.sortable, "halves": value.halves, "grouped": bool(value.group),
        }  # fmt: skip
    if isinstance(value, doc.Quantity):
        number = value.number if isfinite(value.number) else None
        return {"kind": "number", "text": value.text, "value": number, "note": value.note}
    if isinstance(value, doc.Pair):
        sides = {"left": value.left, "right": value.right}
        return {"kind": "pair"} | {side: [as_data(block, axis) for block in blocks if _on_paper(block)]
                                   for side, blocks in sides.items()}  # fmt: skip
    if is_dataclass(value) and not isinstance(value, type):
        record = {"kind": type(value).__name__.lower()} | {
            field.name: as_data(getattr(value, field.name), axis) for field in fields(value)
        }
        record |= {"name": f"{axis}{value.name}"} if isinstance(value, doc.Picture | doc.TableLink) else {}
        return record | {"alt": value.alt + of} if isinstance(value, doc.Picture) else record
    if isinstance(value, dict):
        return {key: as_data(entry, axis) for key, entry in value.items()}
    return [as_data(entry, axis) for entry in value] if isinstance(value, list | tuple) else value


def _row(row: doc.Row, table: doc.Table, keys: list[str], axis: str) -> dict[str, Any]:
    cells = [as_data(row.cells.get(key, ""), axis) for key in keys]
    return {"cells": cells, "status": row.status, "total": row.total, "data": dict(row.data),
            "group": row.cells[table.group] if table.group else ""}  # fmt: skip


def pictures_of(sections: Any) -> Iterator[str]:
    """Names of the figures that sections have a place for."""
    if isinstance(sections, dict):
        if sections.get("kind") == "picture":
            yield sections["name"]
        sections = [*sections.values()]
    if isinstance(sections, list | tuple):
        for entry in sections:
            yield from pictures_of(entry)
