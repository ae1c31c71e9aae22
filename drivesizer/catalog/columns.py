"""Declaration of a part's figures in a record: each field with its kind of quantity and its datasheet unit."""

from __future__ import annotations

from dataclasses import field, fields
from math import nan
from typing import Any, NamedTuple

__all__ = ["DATA", "Column", "PartRecord", "columns", "figure", "text"]

DATA = "data_temperature"  # stands at the head of a file, for all motors and actuators that have none of their own


class PartRecord:
    """A record of a part, whose figures laws read by name (``physics.figures``)."""

    __slots__ = ()
    part: str
    family: str
    manufacturer: str
    price: float

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


class Column(NamedTuple):
    """One field of a part: name, kind of quantity (or ``text``), datasheet unit, smallest allowed value."""

    name: str
    kind: str
    unit: str
    least: float


def figure(kind: str, unit: str, *, least: float = 0.0) -> Any:
    """A field of a part that holds a figure in SI."""
    return field(default=nan, metadata={"kind": kind, "unit": unit, "least": least})


def text() -> Any:
    """A field of a part that holds text; empty unless given."""
    return field(default="", metadata={"kind": "text", "unit": ""})


def columns(record: Any) -> dict[str, Column]:
    """The columns of a record, in the order of its fields."""
    return {
        f.name: Column(f.name, f.metadata["kind"], f.metadata["unit"], f.metadata.get("least", 0.0))
        for f in fields(record)
    }
