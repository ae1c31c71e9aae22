"""Reader of the tolerances that a maker states in a catalogue file, in the notation of a spec."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import Any

from drivesizer.catalog.field_reader import Reader
from drivesizer.catalog.maker_tolerances import TOLERANCES, MakerTolerance
from drivesizer.catalog.tolerances.classes import CLASSES
from drivesizer.catalog.tolerances.factors import share
from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import Path_

__all__ = ["ENTRY", "FIGURES", "read_maker_tolerances"]

FIGURES = {part: tuple(f for p, f in CLASSES if p == part) for part in dict.fromkeys(part for part, _ in CLASSES)}
ENTRY = ("source", "families", *FIGURES, "text")


def read_maker_tolerances(
    reader: Reader, given: Any, maker: str, families: Mapping[str, Set[str]]
) -> tuple[MakerTolerance, ...]:
    """Tolerances stated in a catalogue file."""
    found: list[MakerTolerance] = []
    for index, entry in enumerate(reader.sequence(given or [], (TOLERANCES,))):
        path: Path_ = (TOLERANCES, index)
        entry = reader.mapping(entry, path, ENTRY, {"source"})
        parts = [part for part in FIGURES if part in entry]
        if not parts:
            raise reader.fail(path, f"expected {' or '.join(FIGURES)}, e.g. motor: {{resistance: +- 10 %}}")
        source = reader.source_number(entry["source"], (*path, "source"))
        text = reader.plain_text(entry.get("text"), (*path, "text"))
        for part in parts:
            named = _families(reader, entry, path, families[part], part)
            for figure, tolerance in _figures(reader, entry[part], (*path, part), FIGURES[part]).items():
                one = MakerTolerance(part, figure, tolerance, maker, named, text, source)
                _once(reader, one, found, (*path, part, figure))
                found.append(one)
    return tuple(found)


def _families(reader: Reader, entry: dict[str, Any], path: Path_, known: Set[str], part: str) -> tuple[str, ...]:
    """The families of an entry; none where it is of all."""
    at: Path_ = (*path, "families")
    if "families" not in entry:
        return ()
    names = tuple(reader.part_number(name, at) for name in reader.sequence(entry["families"], at))
    if not names:
        raise reader.fail(at, "expected families; without the field it is of all of them")
    for name in names:
        if name not in known:
            listed = f"; expected {', '.join(sorted(known))}" if known else ""
            raise reader.fail(at, f"{quoted(name)} is no family with a {part} in this file{listed}")
    return tuple(dict.fromkeys(names))


def _figures(reader: Reader, given: Any, path: Path_, allowed: tuple[str, ...]) -> dict[str, str]:
    """The tolerances of an entry, each readable."""
    found = {}
    for figure, value in reader.mapping(given, path, allowed).items():
        text = reader.plain_text(value, (*path, figure)).strip()
        try:
            share(text)
        except InputError as error:
            raise reader.fail((*path, figure), str(error)) from None
        found[figure] = text
    if not found:
        raise reader.fail(path, f"expected {', '.join(allowed)}, e.g. {allowed[0]}: +- 10 %")
    return found


def _once(reader: Reader, one: MakerTolerance, found: list[MakerTolerance], path: Path_) -> None:
    """Refuse a second tolerance of the same figure and family, or of the same figure for all families."""
    for other in found:
        same = set(one.families) & set(other.families) or (not one.families and not other.families)
        if one[:2] == other[:2] and same:
            of = f" of {min(set(one.families) & set(other.families))}" if one.families else ""
            raise reader.fail(path, f"{one.part} {one.figure}{of} is given twice")
