"""The catalogues on the page: which there are, and the parts that meet conditions, as ``drivesizer catalog list``."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivesizer.errors import DrivesizerError, InputError
from drivesizer.live.held import EngineMemory, Piece

if TYPE_CHECKING:
    from drivesizer.catalog import Catalog
    from drivesizer.catalog.conditions import Condition
    from drivesizer.catalog.query import Hit

__all__ = ["ALL", "PAGE", "catalogues", "counts", "hit_of", "listed_names", "named_by", "parts", "shelf"]

PAGE = 200  # rows that are sent at once
ALL = "all"  # of the shipped catalogues, as a spec names them


# -- the catalogues


def catalogues(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``catalogues``: all that ship, the spec's and the user's, with their parts; and the sections' columns."""
    from drivesizer.catalog import shipped

    chosen = listed_names(named_by(held, str(request["text"])))
    names = dict.fromkeys([*held.own, *(name for name in chosen if name not in shipped()), *shipped()])
    yield {"kind": "catalogues", "catalogues": [_described(held, name, name in chosen) for name in names],
           "sections": _sections()}  # fmt: skip


def _described(held: EngineMemory, name: str, chosen: bool) -> Piece:
    from drivesizer.catalog import PARTS

    found = {"name": name, "chosen": chosen, "own": name in held.own}
    try:
        catalog = shelf(held, [name])[name]
    except DrivesizerError as error:
        return found | {"wrong": str(error), "parts": {}, "makers": ""}
    makers = {maker: None for section in PARTS for maker in catalog.table(section)["manufacturer"].tolist() if maker}
    return found | {"parts": counts(catalog), "makers": ", ".join(makers)}


def counts(catalog: Catalog) -> dict[str, int]:
    """Number of parts of each section that a catalogue has."""
    from drivesizer.catalog import DIRECT, PARTS

    found = {section: int((catalog.table(section)["part"] != DIRECT).sum()) for section in PARTS}
    return {section: number for section, number in found.items() if number}


def _sections() -> list[Piece]:
    from drivesizer.catalog import PARTS
    from drivesizer.catalog.conditions import OPTIONS
    from drivesizer.catalog.parts import printed
    from drivesizer.units import label

    return [
        {
            "name": section,
            "options": [name for name, columns in OPTIONS.items() if section in columns],
            "columns": [[name, label(column.unit), "" if column.unit == "1" else column.unit, column.kind == "text"]
                        for name, column in printed(section).items()],
        }
        for section in PARTS
    ]  # fmt: skip


def named_by(held: EngineMemory, text: str) -> list[str]:
    """Catalogues that a spec names, those of all axes together; those of a spec without any where it is no YAML."""
    from drivesizer.files.yaml_source import YamlSource
    from drivesizer.spec.drive import Select

    try:
        data = YamlSource(text, held.name).data
    except InputError:
        data = {}
    axes = data.get("axes") if isinstance(data, dict) else None
    found = [_catalogs(one) for one in (data, *(axes.values() if isinstance(axes, dict) else ()))]
    given = [name for names in found for name in names]
    return list(dict.fromkeys(given)) or list(Select.model_fields["catalogs"].default)


def _catalogs(data: Any) -> list[str]:
    select = data.get("select") if isinstance(data, dict) else None
    given = select.get("catalogs") if isinstance(select, dict) else None
    return [str(name) for name in (given if isinstance(given, list) else [given]) if isinstance(name, str | int)]


def listed_names(names: Sequence[str]) -> list[str]:
    """Names of catalogues with ``all`` as those that ship."""
    from drivesizer.catalog import shipped

    return list(dict.fromkeys(each for name in names for each in (shipped() if name == ALL else [name])))


def shelf(held: EngineMemory, names: Sequence[str]) -> dict[str, Catalog]:
    """Catalogues by name, each by itself; a file is read as it is now."""
    from drivesizer.catalog import load, shipped

    if not held.shelf and set(names) & set(shipped()):  # all at once: a list mostly names many
        held.shelf = {name: load([name]) for name in shipped()}
    others = {name: load([name], beside=Path(held.name).parent) for name in names if name not in held.shelf}
    return {name: held.shelf.get(name) or others[name] for name in names}


def hit_of(held: EngineMemory, name: str, section: str, part: str) -> Hit:
    """A part by its catalogue, section and number."""
    from drivesizer.catalog import DIRECT, PARTS
    from drivesizer.catalog.query import Hit
    from drivesizer.errors import quoted

    catalog = shelf(held, [name])[name]
    rows = catalog.table(section).rows if section in PARTS else {}
    if part not in rows or part == DIRECT:
        raise InputError(f"{quoted(part)} is no longer in {quoted(name)}; list the parts again")
    return Hit(name, catalog, section, rows[part])


# -- lists of parts


def parts(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``parts`` with at most ``PAGE`` rows, or ``unmet`` with the conditions that cannot be read."""
    from drivesizer.catalog.conditions import OPTIONS
    from drivesizer.catalog.query import select

    section = str(request["section"])
    wanted, faults = _conditions(section, request["options"], request["where"])
    if faults:
        yield {"kind": "unmet", "faults": faults}
        return
    text = request["piece"], ("part", "family", "manufacturer", OPTIONS["kind"][section])
    found = select(shelf(held, listed_names(request["catalogues"])), section, wanted, sort=request["sort"],
                   excluded=request["excluded"], piece=text)  # fmt: skip
    start = request["start"] if request["start"] < len(found.hits) else 0
    yield {"kind": "parts", "section": section, "found": len(found.hits), "start": start,
           "undecided": found.undecided, "excluded": found.excluded, "sort": request["sort"],
           **_table(section, found.hits[start : start + PAGE], [one.column.name for one in wanted])}  # fmt: skip


def _conditions(section: str, options: Mapping[str, str], where: Sequence[str]) -> tuple[list[Condition], list[Piece]]:
    """Conditions as read, and those that cannot be, each with its field."""
    from drivesizer.catalog.conditions import option
    from drivesizer.catalog.conditions import where as condition

    reading: dict[str, Callable[[], list[Condition] | None]]
    reading = {name: partial(option, section, name, text) for name, text in options.items() if text.strip()}
    reading |= {f"where.{n}": partial(_one, condition, section, text) for n, text in enumerate(where)}
    found: list[Condition] = []
    faults = []
    for field, read in reading.items():
        try:
            found += read() or []
        except InputError as error:
            faults.append({"field": field, "text": str(error).removeprefix(f"--{field.partition('.')[0]}: ")})
    return found, faults


def _one(read: Callable[[str, str], Condition], section: str, text: str) -> list[Condition]:
    return [read(section, text)]


def _table(section: str, hits: Sequence[Hit], named: Sequence[str]) -> Piece:
    """Heads and rows of a list: the columns that one looks for first, and those that conditions name."""
    from drivesizer.catalog import columns_of
    from drivesizer.output.words import FIRST_NOTES, figure, first_columns
    from drivesizer.units import label

    shown = first_columns(section)
    there = {"part", "family", "manufacturer", *(column.name for _, column in shown)}
    schema = columns_of(section)
    shown += [(name.replace("_", " "), schema[name]) for name in dict.fromkeys(named) if name not in there]
    heads = [{"name": c.name, "head": head, "unit": label(c.unit), "text": c.kind == "text"} for head, c in shown]
    rows = [
        {"catalogue": hit.catalogue, "part": hit.part, "family": hit["family"], "maker": hit["manufacturer"],
         "excluded": bool(hit.table.excluded[hit.row]),
         "cells": ["" if (text := figure(hit[c.name], c, unit=False)) == "unknown" else text for _, c in shown]}
        for hit in hits
    ]  # fmt: skip
    return {"columns": heads, "rows": rows, "note": FIRST_NOTES[section]}
