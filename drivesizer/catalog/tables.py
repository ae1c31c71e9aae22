"""A catalogue in memory, as columns for the search and as records for people; compiled; several as one."""

from __future__ import annotations

import fnmatch
import io
import json
import warnings
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import parts
from drivesizer.catalog.parts import DIRECT, PARTS, RELATIONS, columns_of, singular
from drivesizer.catalog.tolerances import MakerTolerance, join_maker_tolerances
from drivesizer.errors import CatalogError, nearest, quoted, reason_of
from drivesizer.files.cache import CacheWarning, cached_bytes, keep

_MOST_RESULTS = 256  # results of a catalogue for specs of late
_BETWEEN = str.maketrans("", "", " \t-_")
OTHER_NAMES = ("order_number", "also_called")  # columns of some sections, beside the part number
_RECORDS = 256  # parts of late, by row

Part = TypeVar("Part")
CONFIDENCE = "measured", "quoted", "secondary", "derived", "recalled"  # the most reliable first; then ESTIMATED
ESTIMATED = "estimated"  # from peers: no catalogue may say so of its own figures


class Source(NamedTuple):
    """Source of figures."""

    document: str
    confidence: str  # measured, quoted, secondary, derived or recalled
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


class Price(NamedTuple):
    """A price of one part, as a price list or the part's own row has it; an empty text is unknown."""

    part: str  # as the list names it; of the catalogue, once it is found there
    amount: float  # of one piece
    currency: str
    pieces: int = 1  # from so many on
    date: str = ""
    seller: str = ""
    order_number: str = ""  # by which it is ordered, where that is not the catalogue's
    delivery: str = ""  # as the list says it
    note: str = ""
    manufacturer: str = ""  # as the list says it
    document: str = ""
    confidence: str = ""
    section: str = ""  # empty, until the part is found in the catalogues
    file: str = ""  # name of the list among the catalogues; empty of one that ships with a catalogue
    column: str = ""  # of the part's row that it stands in; empty in a list


class Pairs(NamedTuple):
    """Rows of two tables that go together, and the source that states it."""

    left: NDArray[np.int32]
    right: NDArray[np.int32]
    source: NDArray[np.int32]  # index into Catalog.sources


def with_pairs(pairs: Pairs, *more: NDArray[Any]) -> Pairs:
    """Pairs with further ones, each once with the first source that states it."""
    return unique_pairs(*(np.concatenate(columns) for columns in zip(pairs, more, strict=True)))


def unique_pairs(left: NDArray[Any], right: NDArray[Any], source: NDArray[Any]) -> Pairs:
    """Pairs of rows, each once with the first source that states it, sorted."""
    _, first = np.unique(left.astype(np.int64) << 32 | right.astype(np.int64), return_index=True)
    return Pairs(*(side[first].astype(np.int32) for side in (left, right, source)))


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

    def changed(self, columns: Mapping[str, NDArray[Any]]) -> Table[Part]:
        """The table with other figures in some columns."""
        return replace(self, columns={**self.columns, **columns})

    def at_rows(self, rows: NDArray[np.int64] | slice) -> Table[Part]:
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
        rows: dict[str, list[int]] = {}
        for column in (name for name in ("part", *OTHER_NAMES) if name in self.columns):
            for row, text in enumerate(self.columns[column].tolist()):
                for name in {spelling(alias) for alias in text.split(";")} - {""} if text else ():
                    rows.setdefault(name, []).append(row)
        return rows

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

    def matching(self, column: str, name: str) -> list[str]:
        """Makers, families or part numbers that a name means: * stands for any text."""
        if column == "part" and (rows := self.called(name)):
            return self["part"][rows].tolist()
        known = set(self[column].tolist())
        if column == "manufacturer":
            return sorted(maker for maker in known if fnmatch.fnmatchcase(maker.casefold(), name.casefold()))
        return [name] if name in known else sorted(fnmatch.filter(known, name)) if set(name) & set("*?") else []

    def named(self, names_by_column: Mapping[str, Sequence[str]]) -> NDArray[np.bool_]:
        """Rows that are not excluded and have in each column one of the names wanted there."""
        keep = ~self.excluded
        for column, names in names_by_column.items():
            keep &= np.isin(self[column], [known for name in names for known in self.matching(column, name)])
        return keep

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


def filled(section: str, figures: Mapping[str, Any], count: int) -> dict[str, NDArray[Any]]:
    """The columns of a section for some parts: figures of all or of each as given, what is not given unknown."""
    columns = columns_of(section).items()
    return {name: np.array(np.broadcast_to(figures.get(name, "" if column.kind == "text" else np.nan), (count,)))
            for name, column in columns}  # fmt: skip


def empty(section: str) -> Table[Any]:
    """A table without rows."""
    return Table(section, filled(section, {}, 0), np.zeros(0, np.int32), np.zeros(0, bool))


def with_rows(
    table: Table[Any], columns: Mapping[str, NDArray[Any]], source: NDArray[Any], excluded: NDArray[Any]
) -> Table[Any]:
    """A table with further rows below its own."""
    return stacked([table, Table(table.section, columns, source.astype(np.int32), excluded)])


def stacked(tables: Sequence[Table[Any]]) -> Table[Any]:
    """Tables of one section as one, the rows of each below those of the one before."""
    columns = {name: np.concatenate([table[name] for table in tables]) for name in tables[0].columns}
    source, excluded = (np.concatenate([getattr(table, name) for table in tables]) for name in ("source", "excluded"))
    return Table(tables[0].section, columns, source, excluded)


@dataclass(frozen=True)
class Catalog:
    """Loaded catalogues: parts, pairs that go together, and the source of each figure."""

    motors: Table[parts.Motor]
    gearheads: Table[parts.Gearhead]
    encoders: Table[parts.Encoder]
    controllers: Table[parts.Controller]
    actuators: Table[parts.Actuator]
    brakes: Table[parts.Brake]
    steppers: Table[parts.Stepper]
    belts: Table[parts.Belt]
    pulleys: Table[parts.Pulley]
    screws: Table[parts.Screw]
    batteries: Table[parts.Battery]
    power_supplies: Table[parts.PowerSupply]
    brake_resistors: Table[parts.BrakeResistor]
    motor_gearhead: Pairs
    motor_encoder: Pairs
    motor_brake: Pairs
    sources: tuple[Source, ...]
    notes: tuple[Note, ...]
    digests: Mapping[str, str]  # catalogue name -> digest of its file, so that a result can be traced
    overrides: bool = False  # its parts count before those of the catalogues named before it
    across: tuple[Across, ...] = ()  # pairs with parts of other catalogues, until those are loaded with it
    discharges: parts.Discharges = parts.NO_DISCHARGES  # of the batteries
    pull_outs: parts.PullOuts = parts.NO_PULL_OUTS  # of the steppers
    tolerances: tuple[MakerTolerance, ...] = ()  # that makers state for their figures
    replaced: tuple[str, ...] = ()  # parts that an overriding catalogue gives in place of another, in words
    estimates: Mapping[str, Mapping[str, Estimates]] = field(default_factory=dict)  # by section and figure
    prices: tuple[Price, ...] = ()  # of price lists
    currency: str = "EUR"  # of the column price: the one in which prices are compared
    rates: Mapping[str, float] = field(default_factory=lambda: {"EUR": 1.0})  # what one of another currency is in it
    unpriced: Catalog | None = None  # with the prices of the rows as printed, where that column has others
    mounted: bool = False  # whether thermal figures of motors are those of the spec's mounting
    ends: tuple[Catalog, ...] = ()  # as ``search_view`` makes it: with estimates at either end of their bands

    def table(self, section: str) -> Table[Any]:
        """The table of a section, such as ``motors``."""
        return getattr(self, section)

    @cached_property
    def _results(self) -> dict[Hashable, Any]:
        return {}

    def once(self, key: Hashable, make: Callable[[], Any], of: tuple[Any, ...] = ()) -> Any:
        """Result that hangs on these parts and a key alone: made once for the keys of late, not to be changed.

        It may hang on further objects ``of`` that do not change and have no hash, such as sections of a spec: on the
        very same ones.
        """
        key = (key, *map(id, of))  # what is kept holds the objects, so that no other one gets their places
        if key not in self._results:
            if len(self._results) == _MOST_RESULTS:  # of a study that varies the supply
                self._results.clear()
            self._results[key] = make(), of
        return self._results[key][0]

    def __repr__(self) -> str:
        """Its catalogues, and how many parts of each family they have."""
        counts = (f"{len(self.table(section))} {section}" for section in PARTS if len(self.table(section)))
        return f"Catalog({', '.join(self.digests)}: {', '.join(counts)})"

    def __add__(self, other: Catalog) -> Catalog:
        """The parts of both; where both have one of a number, the other's must mean to replace it."""
        return joined([self, other])

    def with_tables(self, tables: Mapping[str, Any], pairs: Mapping[str, Any]) -> Catalog:
        """The catalogue with other tables and pairs, by their names."""
        return replace(self, **tables, **pairs)

    def notes_on(self, section: str, part: str) -> list[Note]:
        """The catalogue's notes on a part."""
        return [note for note in self.notes if note.section == section and part in note.parts]

    def by_rule(self, name: str) -> NDArray[np.int64]:
        """Rows of the actuators of which a figure is a rule of thumb."""
        notes = (note for note in self.notes if note.rule and note.section == "actuators" and name in note.fields)
        rows = self.actuators.rows
        return np.array(sorted({rows[part] for note in notes for part in note.parts if part in rows}), np.int64)

    def confidence(self, section: str, row: int) -> dict[str, str]:
        """Confidence of each known figure of a part: that of its row, changed by the notes on it; or estimated."""
        table = self.table(section)
        base = self.sources[table.source[row]].confidence
        figures = {name: table[name][row] for name in columns_of(section)}
        levels = {name: base for name, figure in figures.items() if figure == figure and figure != ""}
        for note in self.notes_on(section, str(table["part"][row])):
            if note.confidence:
                levels |= {name: note.confidence for name in (note.fields or tuple(levels)) if name in levels}
        if self.mounted and section == "motors":
            levels |= dict.fromkeys(levels.keys() & {"thermal_resistance_housing", "motor_time_constant"}, "derived")
        return {name: ESTIMATED if self.estimate_of(section, row, name) else level for name, level in levels.items()}

    def estimate_of(self, section: str, row: int, name: str) -> PartEstimate | None:
        """Estimate of a figure of a part, or of the actuator that it is inside of; None where peers give none."""
        if not self.estimates:
            return None
        table = self.table(section)
        inside = str(table["inside"][row]) if "inside" in table.columns else ""
        whole = self.actuators.rows.get(inside)  # a controller may be inside a motor too
        estimates = self.estimates.get(section if whole is None else "actuators", {}).get(name)
        if estimates is None:
            return None
        place = np.flatnonzero(estimates.rows == (row if whole is None else whole))
        if not len(place):
            return None
        value, low, high, fit = (column[place[0]] for column in estimates[1:])
        return PartEstimate(float(value), float(low), float(high), int(fit))


# -- Direct drive as a row of the gearheads: no mass, no loss and no limits.


NO_GEARHEAD_SOURCE = Source("no gearhead: the motor drives the load itself", "quoted")


def with_no_gearhead(gearheads: Table[parts.Gearhead], source: int) -> Table[parts.Gearhead]:
    """A table of gearheads with the row of direct drive, which weighs nothing and has no limits, as its last."""
    row = {name: np.array([getattr(parts.NO_GEARHEAD, name)]) for name in gearheads.columns}
    return with_rows(gearheads, row, np.array([source]), np.array([False]))


def as_printed(catalog: Catalog) -> Catalog:
    """A catalogue without what the reader derived: the same where that is nothing."""
    tables: dict[str, Any] = {}
    for note in (note for note in catalog.notes if note.derived):
        table = tables.get(note.section) or catalog.table(note.section)
        out = np.isin(table["part"], note.parts)
        unknown = {name: np.where(out, np.nan, table[name]) for name in note.fields}
        tables[note.section] = table.changed(unknown)
    if not tables:
        return catalog
    return replace(catalog, **tables, notes=tuple(note for note in catalog.notes if not note.derived))


# -- Compiled catalogues: the columns of a catalogue file as plain bytes in the user's cache folder.
#
# A compiled file is named by the digest of what it was made from (this package's version, the schema, the YAML's
# bytes), so an old compilation is never used for a changed catalogue. It starts with the digest of its own
# contents and is discarded when that differs. Numbers are npy arrays read without pickle, texts are
# JSON. Writing goes to a private file that then takes the name at once, so two processes cannot disturb each
# other; when the folder cannot be written, the program works without it.


_PRINTED: dict[str, tuple[str, Any]] = {  # entries of tables of parts: their section, and those of a catalogue without
    "discharges": ("batteries", parts.NO_DISCHARGES), "pull_outs": ("steppers", parts.NO_PULL_OUTS),
}  # fmt: skip


def recall(path: Path) -> Catalog | None:
    """The compiled catalogue at a path, or None when there is none or it is damaged."""
    body = cached_bytes(path)
    try:
        return None if body is None else _unpacked(body)
    except Exception:  # an intact file of another layout: compiled again
        return None


def store(path: Path, catalog: Catalog) -> None:
    """Keep a compiled catalogue; older compilations of the same file are removed."""
    arrays: dict[str, NDArray[Any]] = {}
    names = ("sources", "notes", "digests", "overrides", "across", "replaced", "tolerances", "prices")
    texts: dict[str, Any] = {name: getattr(catalog, name) for name in names}
    for section in PARTS:
        table, schema = catalog.table(section), columns_of(section)
        if len(table):
            figures = [name for name, column in schema.items() if column.kind != "text"]
            arrays[f"{section}.figures"] = np.array([table[name] for name in figures])
            arrays |= {f"{section}.source": table.source, f"{section}.excluded": table.excluded}
            texts[section] = {name: table[name].tolist() for name in schema if name not in figures}
    arrays |= {relation: np.array(getattr(catalog, relation)) for relation in RELATIONS}
    for name in (name for name in _PRINTED if len(getattr(catalog, name).source)):
        arrays |= {f"{name}.{column}": values for column, values in getattr(catalog, name)._asdict().items()}
    arrays["texts"] = np.frombuffer(json.dumps(texts).encode(), np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # its allow_pickle is no array
    try:
        keep(path, buffer.getvalue())
    except OSError as error:
        reason = reason_of(error)
        warnings.warn(f"the compiled catalogue is not kept in {path.parent} ({reason})", CacheWarning, stacklevel=2)


def _unpacked(body: bytes) -> Catalog:
    with np.load(io.BytesIO(body), allow_pickle=False) as archive:
        arrays = {name: archive[name] for name in archive.files}
    texts = json.loads(arrays["texts"].tobytes())
    contents: dict[str, Any] = {section: empty(section) for section in PARTS if section not in texts}
    for section in (section for section in PARTS if section in texts):
        figures = [name for name, column in columns_of(section).items() if column.kind != "text"]
        columns: dict[str, NDArray[Any]] = dict(zip(figures, arrays[f"{section}.figures"], strict=True))
        columns |= {name: np.array(values, str) for name, values in texts[section].items()}
        contents[section] = Table(section, columns, arrays[f"{section}.source"], arrays[f"{section}.excluded"])
    contents |= {relation: Pairs(*arrays[relation]) for relation in RELATIONS}
    for name, (_, none) in _PRINTED.items():
        contents[name] = type(none)(*(arrays.get(f"{name}.{column}", getattr(none, column)) for column in none._fields))
    for name, kind in (("sources", Source), ("notes", Note), ("tolerances", MakerTolerance), ("across", Across),
                       ("prices", Price)):  # fmt: skip
        contents[name] = tuple(kind(*map(_frozen, fields)) for fields in texts[name])
    plain: dict[str, Any] = {name: texts[name] for name in ("digests", "overrides")}
    return Catalog(**contents, **plain, replaced=tuple(texts["replaced"]))


def _frozen(value: Any) -> Any:
    """Lists as the tuples that they were."""
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


# -- Several catalogues as one: rows concatenated, pairs renumbered, overridden parts left out.


def joined(catalogs: Sequence[Catalog]) -> Catalog:
    """Several catalogues as one."""
    if len(catalogs) == 1 and not catalogs[0].across:
        return catalogs[0]
    replaced = (*(message for c in catalogs for message in c.replaced), *_replaced(catalogs), *_not_loaded(catalogs))
    first_source = [int(n) for n in np.cumsum([0, *(len(c.sources) for c in catalogs)])[:-1]]
    stacks = {section: _Stack([c.table(section) for c in catalogs], first_source) for section in PARTS}
    contents: dict[str, Any] = {section: stack.table for section, stack in stacks.items()}
    for relation, right in RELATIONS.items():
        motors, others = stacks["motors"], stacks[right]
        sides: list[tuple[NDArray[Any], ...]] = []
        for n, catalog in enumerate(catalogs):
            own: Pairs = getattr(catalog, relation)
            listed: list[tuple[NDArray[Any], ...]] = [
                (own.left + motors.starts[n], own.right + others.starts[n], own.source)
            ]
            for pairing in (pairing for pairing in catalog.across if pairing.relation == relation):
                left, also = _named(catalogs, n, motors, pairing.motors), _named(catalogs, n, others, pairing.others)
                pairs = np.repeat(left, len(also)), np.tile(also, len(left))
                listed.append((*pairs, np.full(len(pairs[0]), pairing.source)))
            sides += [(motors.place[a], others.place[b], source + first_source[n]) for a, b, source in listed]
        contents[relation] = unique_pairs(*(np.concatenate(side) for side in zip(*sides, strict=True)))
    for name, (section, _) in _PRINTED.items():
        contents[name] = _printed([getattr(c, name) for c in catalogs], stacks[section], first_source)
    tolerances, instead = join_maker_tolerances(
        [(", ".join(c.digests), c.tolerances, c.overrides) for c in catalogs], first_source
    )
    return Catalog(
        **contents,
        sources=tuple(source for c in catalogs for source in c.sources),
        notes=tuple(note for c in catalogs for note in c.notes),
        digests={name: digest for c in catalogs for name, digest in c.digests.items()},
        replaced=(*replaced, *instead),
        tolerances=tolerances,
        prices=tuple(price for c in catalogs for price in c.prices),
    )


def _replaced(catalogs: Sequence[Catalog]) -> tuple[str, ...]:
    """Parts that are in two catalogues; refused where the later one does not mean to replace them."""
    owner: dict[tuple[str, str], str] = {}
    messages = []
    for catalog in catalogs:
        name = ", ".join(catalog.digests)
        for section in PARTS:
            for part in catalog.table(section).rows:
                first = owner.setdefault((section, part), name)
                if first == name or part == DIRECT:
                    continue
                if not catalog.overrides:
                    raise CatalogError(
                        f"part {quoted(part)} is in two catalogues: {first} and {name}; "
                        "`overrides: true` in the second makes its row count"
                    )
                messages.append(f"{singular(section)} {part}: {name} in place of {first}")
    return tuple(messages)


def _not_loaded(catalogs: Sequence[Catalog]) -> tuple[str, ...]:
    """Catalogues that others name for parts that go together, and that are not among them."""
    loaded = {name for c in catalogs for name in c.digests}
    messages: dict[str, None] = {}
    for catalog in catalogs:
        for pairing in catalog.across:
            for other, part in (*pairing.motors, *pairing.others):
                if other and other not in loaded:
                    own = ", ".join(catalog.digests)
                    messages[f"{own} lists {part} of {other}, which is not among the catalogues: left out"] = None
    return tuple(messages)


class _Stack:
    """One section of all catalogues under each other, of rows with one part number the last left."""

    def __init__(self, tables: Sequence[Table[Any]], first_source: Sequence[int]) -> None:
        self.starts = [int(n) for n in np.cumsum([0, *map(len, tables)])]  # first row of each catalogue
        whole = stacked([replace(t, source=t.source + n) for t, n in zip(tables, first_source, strict=True)])
        columns = whole.columns
        last = {part: row for row, part in enumerate(columns["part"].tolist())}
        self.rows = np.array(sorted(last.values()), np.int64)  # that are left
        place = {part: n for n, part in enumerate(columns["part"][self.rows].tolist())}
        self.place = np.array([place[part] for part in columns["part"].tolist()], np.int32)  # of each row, among these
        self.table = whole if len(self.rows) == len(whole) else whole.at_rows(self.rows)


def _printed(by_catalog: Sequence[Any], stack: _Stack, first_source: Sequence[int]) -> Any:
    """Printed entries of a section's parts, each with its row first; of a replaced part only those of the last file."""
    entries, number = [], 0
    for own, start, first in zip(by_catalog, stack.starts, first_source, strict=False):
        rows = own[0] + start
        entry = own._replace(**{own._fields[0]: stack.place[rows], "source": (own.source + first).astype(np.int32)})
        if "curve" in own._fields:  # numbered through all files
            entry = entry._replace(curve=own.curve + number)
            number += int(own.curve.max(initial=-1)) + 1
        entries.append(entry.on(np.isin(rows, stack.rows)))
    return type(entries[0])(*(np.concatenate(columns) for columns in zip(*entries, strict=True)))


def _named(catalogs: Sequence[Catalog], own: int, stack: _Stack, names: Sequence[tuple[str, str]]) -> NDArray[np.int64]:
    """Rows, in the table of all, of families and parts by name; of a catalogue that is not loaded there are none."""
    places = {name: place for place, c in enumerate(catalogs) for name in c.digests}
    rows = [np.zeros(0, np.int64)]
    for other, name in names:
        place = places.get(other) if other else own
        if place is None:
            continue
        members = catalogs[place].table(stack.table.section).members
        if name not in members:
            text = f"{', '.join(catalogs[own].digests)}, compatibility: {quoted(name)} is no family or part of {other}"
            raise CatalogError(f"{text}{nearest(name, members, 1)}")
        rows.append(members[name] + stack.starts[place])
    return np.concatenate(rows)
