"""A part by its number, a text anywhere in numbers and names, and the sources of one part's figures."""

from __future__ import annotations

from collections import Counter

from drivesizer.catalog import DIRECT, PARTS, RELATIONS, Source
from drivesizer.catalog.conditions import OPTIONS
from drivesizer.catalog.maker_tolerances import MakerTolerance, maker_tolerances_of
from drivesizer.catalog.query import Hit, Shelf, every, select
from drivesizer.catalog.tables import OTHER_NAMES
from drivesizer.errors import InputError, nearest, quoted

__all__ = ["families", "find", "look", "origins", "partners", "tolerances"]


def find(shelf: Shelf, part: str) -> list[Hit]:
    """The parts with a number or another name, in whatever section or catalogue."""
    exact, other = (
        [
            Hit(name, catalog, section, row)
            for name, catalog in shelf.items()
            for section in PARTS
            for row in rows(catalog.table(section))
        ]
        for rows in (lambda table: [table.rows[part]] if part in table.rows else [], lambda table: table.called(part))
    )
    if part != DIRECT and (exact or other):
        return exact or other
    for section, names in families(shelf).items():
        if part in names:
            raise InputError(
                f"{quoted(part)} is a family of {section}; `drivesizer catalog list {section} --family '{part}'` "
                "lists its parts"
            )
    raise InputError(f"{quoted(part)} is in no catalogue{nearest(part, (hit.part for hit in every(shelf)))}")


def look(shelf: Shelf, text: str) -> tuple[dict[str, dict[str, list[Hit]]], list[Hit]]:
    """Families whose name or kind contains a text, by section, and parts whose number does."""

    def hits(section: str, *names: str) -> list[Hit]:
        return select(shelf, section, [], excluded=True, piece=(text, names)).hits

    called = {
        section: {hit["family"] for hit in hits(section, "family", OPTIONS["kind"][section])} for section in PARTS
    }
    groups = {
        section: {name: members for name, members in names.items() if name in called[section]}
        for section, names in families(shelf).items()
    }
    return groups, [hit for section in PARTS for hit in hits(section, "part", *OTHER_NAMES)]


def families(shelf: Shelf) -> dict[str, dict[str, list[Hit]]]:
    """The parts of each family, by section and name."""
    found: dict[str, dict[str, list[Hit]]] = {section: {} for section in PARTS}
    for hit in every(shelf):
        found[hit.section].setdefault(hit["family"], []).append(hit)
    return found


def partners(hit: Hit) -> dict[str, dict[str, int]]:
    """Number of parts of each family that go with a part, by the sections that its catalogue pairs it with."""
    found: dict[str, dict[str, int]] = {}
    for relation, right in RELATIONS.items():
        pairs = getattr(hit.catalog, relation)
        if hit.section not in ("motors", right) or not len(pairs.left):
            continue
        other = right if hit.section == "motors" else "motors"
        own, others = (pairs.left, pairs.right) if hit.section == "motors" else (pairs.right, pairs.left)
        names = hit.catalog.table(other)["family"][others[own == hit.row]]
        found[other] = dict(Counter(sorted(names.tolist())))
    return found


def origins(hit: Hit) -> dict[str, Source]:
    """Source of each known figure of a part: that of its table, or of a note on it."""
    base = hit.catalog.sources[hit.table.source[hit.row]]
    confidence = hit.catalog.confidence(hit.section, hit.row)
    by_document = {source.document: source for source in hit.catalog.sources}
    found = dict.fromkeys(confidence, base)
    for note in hit.catalog.notes_on(hit.section, hit.part):
        if note.source:
            found |= {
                name: by_document.get(note.source, base) for name in (note.fields or confidence) if name in confidence
            }
    return {name: source._replace(confidence=confidence[name]) for name, source in found.items()}


_TOLERANCED = {"motors": ("motor",), "gearheads": ("gearhead",), "actuators": ("motor", "gearhead")}


def tolerances(hit: Hit) -> list[MakerTolerance]:
    """Tolerances that the maker states for a part's figures; for an actuator those of its motor and its gear."""
    stated, owner = hit.catalog.tolerances, (hit["manufacturer"], hit["family"])
    return [
        one for part in _TOLERANCED.get(hit.section, ()) for one in maker_tolerances_of(stated, part, *owner).values()
    ]
