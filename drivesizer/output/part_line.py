"""A line of a parts list: one part of a catalogue, as it is ordered, with its mass and price.

What no catalogue gives is left open: an order number, a price, a cable.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import Any

from drivesizer.catalog import BrakeResistor, Catalog, Note, Source, columns_of
from drivesizer.catalog.lookup import origins
from drivesizer.catalog.query import Hit
from drivesizer.output.part_words import SAID
from drivesizer.results.drive_set import section_of

__all__ = ["HEADS", "NO_NUMBER", "PartLine", "line_of", "ordered_as", "price_for", "resistor_line"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PartLine:
    """One line of a parts list; an empty text or NaN is unknown."""

    role: str  # motor, gearhead, driving pulley ...
    maker: str = ""
    family: str = ""
    part: str = ""  # its name in the catalogue
    order_number: str = ""  # as its maker sells it; mostly the same
    said: str = ""  # what it is, in words
    quantity: int  # of the whole machine
    mass: float = nan  # kg, of one
    mass_low: float = nan  # kg, 5th percentile where the mass is estimated; else NaN
    mass_high: float = nan  # kg, 95th percentile
    price: float = nan  # of one, in the currency
    currency: str = ""
    pieces: int | None = None  # from so many on that price holds
    price_date: str = ""
    price_source: str = ""  # the document
    price_confidence: str = ""
    document: str = ""  # where the part comes from
    date: str = ""
    confidence: str = ""  # of its number
    url: str = ""
    note: str = ""  # what the catalogue remarks on number, price, mass or the part as a whole


HEADS = {"said": "is", "mass": "mass_kg", "mass_low": "mass_low_kg", "mass_high": "mass_high_kg",
         "pieces": "price_from_pieces", "confidence": "part_confidence",
         "document": "part_source", "date": "part_source_date"}  # fmt: skip
"""Names of a line's figures in CSV and JSON, where they differ."""
NO_NUMBER = "no order number known"  # so a catalogue marks a part whose name is not the maker's
_OF_BUYING = {"part", "mass", "price", "price_5", "price_20", "list_price", "foreign_price"}
_PRICES = (  # field, and from how many pieces
    ("price_20", 20), ("price_5", 5), ("price", 1), ("list_price", 1), ("foreign_price", 1),
)  # fmt: skip


def line_of(role: str, part: Any, catalog: Catalog, quantity: int, mass: dict[str, Any]) -> PartLine:
    """A part as a line."""
    if part is None:
        return PartLine(role=role, quantity=quantity, **mass)
    section = section_of(part)
    known = origins(Hit("", catalog, section, catalog.table(section).rows[part.part]))
    notes, source = _remarks(catalog, part), known["part"]
    return PartLine(
        role=role, maker=part.manufacturer, family=part.family, part=part.part,
        order_number=_number(catalog, part),
        said=SAID[role](part), quantity=quantity, **mass, **price_for(part, quantity, known),
        document=source.document, date=source.date, confidence=source.confidence, url=source.url,
        note="; ".join(dict.fromkeys(map(_note_text, notes))),
    )  # fmt: skip


def resistor_line(resistor: BrakeResistor, catalog: Catalog) -> PartLine:
    """A brake resistor as a line."""
    if resistor.part:
        return line_of("brake resistor", resistor, catalog, 1, {"mass": resistor.mass})
    return PartLine(role="brake resistor", said=SAID["brake resistor"](resistor), quantity=1)


def price_for(part: Any, quantity: int, known: dict[str, Source]) -> dict[str, Any]:
    """The price of a part for a quantity."""
    for name, pieces in _PRICES:
        if quantity >= pieces and name in known:
            source, unit = known[name], columns_of(section_of(part))[name].unit
            unit = (part.currency or "of unknown currency") if name == "foreign_price" else unit
            return {"price": getattr(part, name), "currency": unit, "pieces": pieces, "price_date": source.date,
                    "price_source": source.document, "price_confidence": source.confidence}  # fmt: skip
    return {}


def ordered_as(part: str, order_number: str) -> str:
    """A part for ordering: its order number, or its name and that no order number is known."""
    return order_number or (f"{part}, {NO_NUMBER}" if part else "")


def _number(catalog: Catalog, part: Any) -> str:
    """The order number of a part; empty where the name in the catalogue is the catalogue's own."""
    known = not any(NO_NUMBER in note.text for note in _remarks(catalog, part))
    return (getattr(part, "order_number", "") or str(part.part)) if known else ""


def _remarks(catalog: Catalog, part: Any) -> list[Note]:
    """Notes on the part as a whole, or on figures for ordering."""
    notes = catalog.notes_on(section_of(part), part.part)
    return [note for note in notes if not note.fields or _OF_BUYING & set(note.fields)]


def _note_text(note: Note) -> str:
    """A note with the figures that it concerns, as far as they are for ordering."""
    on = ", ".join(name.replace("_", " ") for name in note.fields if name in _OF_BUYING)
    return f"{on}: {note.text}" if on else note.text
