"""A catalogue in memory: parts as columns for the search, as records for people."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.discharges import NO_DISCHARGES, Discharges
from drivesizer.catalog.maker_tolerances import MakerTolerance
from drivesizer.catalog.more_parts import (
    Actuator,
    Battery,
    Belt,
    Brake,
    BrakeResistor,
    PowerSupply,
    Pulley,
    Screw,
    Stepper,
)
from drivesizer.catalog.parts import PARTS, Controller, Encoder, Gearhead, Motor, columns_of
from drivesizer.catalog.pull_outs import NO_PULL_OUTS, PullOuts

__all__ = [
    "CONFIDENCE",
    "ESTIMATED",
    "OTHER_NAMES",
    "Across",
    "Catalog",
    "Estimates",
    "Note",
    "Pairs",
    "Source",
    "Table",
    "empty",
    "spelling",
    "unique_pairs",
]

_KEPT = 256  # results of a catalogue for specs of late
_BETWEEN = str.maketrans("", "", " \t-_")
OTHER_NAMES = ("order_number", "also_called")  # columns of some sections, beside the part number
_RECORDS = 256  # parts of late, by row

Part = TypeVar("Part")
CONFIDENCE = ("quoted", "secondary", "derived", "recalled")  # from the most to the least reliable; then ESTIMATED
ESTIMATED = "estimated"  # from peers: no catalogue may say so of its own figures


class Source(NamedTuple):
    """Source of figures."""

    document: str
    confidence: str  # quoted, secondary, derived or recalled
    date: str = ""
    url: str = ""


class Note(NamedTuple):
    """A remark on some parts' figures: another confidence, another source, an exclusion, an accepted oddity."""

    section: str
    parts: tuple[str, ...]
    fields: tuple[str, ...]  # empty: the whole row
    text: str
    confidence: str = ""
    source: str = ""  # the document
    exclude: bool = False
    accepted: bool = False
    derived: bool = False  # by the reader, from other figures of the part
    rule: bool = False  # of figures by a rule of thumb, which are no maker's limits


class Pairs(NamedTuple):
    """Rows of two tables that go together, and the source that states it."""

    left: NDArray[np.int32]
    right: NDArray[np.int32]
    source: NDArray[np.int32]  # index into Catalog.sources


class Estimates(NamedTuple):
    """One figure of those parts of a table that lack it and whose peers give it; shape (estimates,), in SI."""

    rows: NDArray[np.int64]
    value: NDArray[np.float64]
    low: NDArray[np.float64]  # 5th percentile
    high: NDArray[np.float64]  # 95th percentile
    fit: NDArray[np.int64]  # which of the fitted laws


class PartEstimate(NamedTuple):
    """One figure of one part, in SI."""

    value: float
    low: float  # 5th percentile
    high: float  # 95th percentile
    fit: int  # which of the fitted laws


class Across(NamedTuple):
    """A list of what goes together that names other catalogues: (catalogue, family or part), empty for its own."""

    relation: str
    motors: tuple[tuple[str, str], ...]
    others: tuple[tuple[str, str], ...]
    source: int  # index into Catalog.sources


@dataclass(frozen=True)
class Table(Generic[Part]):
    """All parts of one kind: one array per field, NaN or an empty text where the figure is unknown."""

    section: str
    columns: Mapping[str, NDArray[Any]]
    source: NDArray[np.int32]  # per row, index into Catalog.sources
    excluded: NDArray[np.bool_]  # per row: in the file with its reason, but not offered

    def __len__(self) -> int:
        return len(self.source)

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    def taken(self, rows: NDArray[np.int64] | slice) -> Table[Part]:
        """Some of the parts, as a table."""
        columns = {name: values[rows] for name, values in self.columns.items()}
        return Table(self.section, columns, self.source[rows], self.excluded[rows])

    def record(self, row: int) -> Part:
        """One part, as its record."""
        if row not in self._records:
            if len(self._records) == _RECORDS:
                self._records.clear()
            kind: type[Part] = PARTS[self.section]
            self._records[row] = kind(**{name: self.columns[name][row].item() for name in columns_of(self.section)})
        return self._records[row]

    @cached_property
    def _records(self) -> dict[int, Part]:
        return {}

    @cached_property
    def rows(self) -> dict[str, int]:
        """Row by part number."""
        return {part: row for row, part in enumerate(self.columns["part"].tolist())}

    @cached_property
    def spellings(self) -> dict[str, list[int]]:
        """Rows by all names of parts: number, order number and others, whatever case, blanks and hyphens."""
        found: dict[str, list[int]] = {}
        for column in (name for name in ("part", *OTHER_NAMES) if name in self.columns):
            for row, text in enumerate(self.columns[column].tolist()):
                for name in {spelling(one) for one in text.split(";")} - {""} if text else ():
                    found.setdefault(name, []).append(row)
        return found

    def called(self, name: str) -> list[int]:
        """Rows of a part by any of its names; of one that has figures at several voltages all of them.

        >>> table = empty("actuators")
        >>> parts = {"part": ["X 12 V", "X 9 V", "Y-1"], "order_number": ["X", "X", ""], "also_called": ["", "", "Z"]}
        >>> table = replace(table, columns={name: np.array(texts) for name, texts in parts.items()})
        >>> table.called("x12v"), table.called("X"), table.called("z"), table.called("W")
        ([0, 1], [0, 1], [2], [])
        """
        rows = [self.rows[name]] if name in self.rows else self.spellings.get(spelling(name), [])
        if "order_number" not in self.columns:
            return rows
        orders = {order for row in rows if (order := str(self["order_number"][row]))}
        return sorted({*rows, *(row for order in orders for row in self.spellings[spelling(order)])})

    def at_voltage(self, volts: float) -> NDArray[np.bool_]:
        """Rows that count at a supply voltage: of parts with figures at several that with the nearest one."""
        keep = np.ones(len(self), bool)
        several = np.flatnonzero((self["order_number"] != "") & ~self.excluded)
        own, order = self["nominal_voltage"][several], self["order_number"][several]
        ranked = several[np.lexsort((own, np.abs(own - volts), order))]
        keep[ranked] = False
        keep[ranked[np.unique(self["order_number"][ranked], return_index=True)[1]]] = True
        return keep

    @cached_property
    def alphabetical(self) -> NDArray[np.int64]:
        """Place of each row by part number, by which ties are resolved: a catalogue may list its parts in any order."""
        place = np.empty(len(self), np.int64)
        place[np.argsort(self["part"], kind="stable")] = np.arange(len(self))
        return place

    @cached_property
    def members(self) -> dict[str, NDArray[np.int64]]:
        """Rows by part number and by family name."""
        order = np.argsort(self["family"], kind="stable")
        names, first = np.unique(self["family"][order], return_index=True)
        families = dict(zip(names.tolist(), np.split(order, first[1:]), strict=True)) if len(self) else {}
        return {part: np.array([row]) for part, row in self.rows.items()} | families


def spelling(name: str) -> str:
    """A name of a part without case, blanks and hyphens.

    >>> spelling("ST-3215-C001") == spelling("st3215 c001")
    True
    """
    return name.translate(_BETWEEN).casefold()


def empty(section: str) -> Table[Any]:
    """A table without rows."""
    columns: dict[str, NDArray[Any]] = {
        name: np.array([], str if column.kind == "text" else float) for name, column in columns_of(section).items()
    }
    return Table(section, columns, np.zeros(0, np.int32), np.zeros(0, bool))


@dataclass(frozen=True)
class Catalog:
    """Loaded catalogues: parts, pairs that go together, and the source of each figure."""

    motors: Table[Motor]
    gearheads: Table[Gearhead]
    encoders: Table[Encoder]
    controllers: Table[Controller]
    actuators: Table[Actuator]
    brakes: Table[Brake]
    steppers: Table[Stepper]
    belts: Table[Belt]
    pulleys: Table[Pulley]
    screws: Table[Screw]
    batteries: Table[Battery]
    power_supplies: Table[PowerSupply]
    brake_resistors: Table[BrakeResistor]
    motor_gearhead: Pairs
    motor_encoder: Pairs
    motor_brake: Pairs
    sources: tuple[Source, ...]
    notes: tuple[Note, ...]
    digests: Mapping[str, str]  # catalogue name -> digest of its file, so that a result can be traced
    overrides: bool = False  # its parts count before those of the catalogues named before it
    across: tuple[Across, ...] = ()  # pairs with parts of other catalogues, until those are loaded with it
    discharges: Discharges = NO_DISCHARGES  # of the batteries
    pull_outs: PullOuts = NO_PULL_OUTS  # of the steppers
    tolerances: tuple[MakerTolerance, ...] = ()  # that makers state for their figures
    replaced: tuple[str, ...] = ()  # parts that an overriding catalogue gives in place of another, in words
    estimates: Mapping[str, Mapping[str, Estimates]] = field(default_factory=dict)  # by section and figure
    mounted: bool = False  # whether thermal figures of motors are those of the spec's mounting
    ends: tuple[Catalog, ...] = ()  # as ``search_view`` makes it: with estimates at either end of their bands

    def table(self, section: str) -> Table[Any]:
        """The table of a section, such as ``motors``."""
        found: Table[Any] = getattr(self, section)
        return found

    @cached_property
    def _kept(self) -> dict[Hashable, Any]:
        return {}

    def once(self, key: Hashable, make: Callable[[], Any], of: tuple[Any, ...] = ()) -> Any:
        """Result that hangs on these parts and a key alone: made once for the keys of late, not to be changed.

        It may hang on further objects ``of`` that do not change and have no hash, such as sections of a spec: on the
        very same ones.
        """
        key = (key, *map(id, of))  # what is kept holds the objects, so that no other one gets their places
        if key not in self._kept:
            if len(self._kept) == _KEPT:  # of a study that varies the supply
                self._kept.clear()
            self._kept[key] = make(), of
        return self._kept[key][0]

    def with_tables(self, tables: Mapping[str, Any], pairs: Mapping[str, Any]) -> Catalog:
        """The catalogue with other tables and pairs, by their names."""
        return replace(self, **tables, **pairs)

    def notes_on(self, section: str, part: str) -> list[Note]:
        """The catalogue's notes on a part."""
        return [note for note in self.notes if note.section == section and part in note.parts]

    def by_rule(self, section: str, name: str) -> NDArray[np.int64]:
        """Rows of the parts of which a figure is a rule of thumb."""
        notes = (note for note in self.notes if note.rule and note.section == section and name in note.fields)
        rows = self.table(section).rows
        return np.array(sorted({rows[part] for note in notes for part in note.parts if part in rows}), np.int64)

    def confidence(self, section: str, row: int) -> dict[str, str]:
        """Confidence of each known figure of a part: that of its row, changed by the notes on it; or estimated."""
        table = self.table(section)
        base = self.sources[table.source[row]].confidence
        known = {name for name, column in columns_of(section).items() if _is_known(table[name][row], column.kind)}
        found = dict.fromkeys((n for n in columns_of(section) if n in known), base)
        for note in self.notes_on(section, str(table["part"][row])):
            if note.confidence:
                found |= {name: note.confidence for name in (note.fields or known) if name in known}
        if self.mounted and section == "motors":
            found |= dict.fromkeys(known & {"thermal_resistance_housing", "motor_time_constant"}, "derived")
        estimated = (name for name in known if self.estimate_of(section, row, name))
        return found | dict.fromkeys(estimated, ESTIMATED)

    def estimate_of(self, section: str, row: int, name: str) -> PartEstimate | None:
        """Estimate of a figure of a part, or of the actuator that it is inside of; None where peers give none."""
        if not self.estimates:
            return None
        table = self.table(section)
        inside = str(table["inside"][row]) if "inside" in table.columns else ""
        found = self.estimates.get("actuators" if inside else section, {}).get(name)
        if found is None:
            return None
        place = np.flatnonzero(found.rows == (self.actuators.rows[inside] if inside else row))
        if not len(place):
            return None
        value, low, high, fit = (column[place[0]] for column in found[1:])
        return PartEstimate(float(value), float(low), float(high), int(fit))


def _is_known(value: Any, kind: str) -> bool:
    return bool(value != "") if kind == "text" else bool(value == value)


def unique_pairs(left: NDArray[Any], right: NDArray[Any], source: NDArray[Any]) -> Pairs:
    """Pairs of rows, each once with the first source that states it, sorted."""
    _, first = np.unique(left.astype(np.int64) << 32 | right.astype(np.int64), return_index=True)
    return Pairs(*(side[first].astype(np.int32) for side in (left, right, source)))
