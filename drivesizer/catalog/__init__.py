"""Catalogues of real parts: loading by name or file, compiled on first use.

>>> catalog = load(["maxon"])
>>> motor = catalog.motors.record(catalog.motors.rows["118752"])
>>> motor.family, motor.resistance
('RE 25', 2.32)

People read and edit YAML tables with units in their heads; the search takes arrays. A compiled file is named by a
digest of program version, schema and YAML and takes its name in one step, so that a changed, damaged or half-written
file is never used. An actuator keeps the figures at its output as its maker prints them; for the search it becomes a
motor and a gearhead that go only with each other. Rows of one order number are one part at several voltages, of which
the one nearest to the supply is searched. A stepper takes a motor's place.

May import: files, physics.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import cache, partial
from importlib import resources
from pathlib import Path
from typing import Any, TypeVar, cast

from drivesizer.catalog.parts import (
    DIRECT,
    EDGES,
    PARTS,
    RELATIONS,
    Actuator,
    Battery,
    Belt,
    Brake,
    BrakeResistor,
    Controller,
    Encoder,
    Gearhead,
    Motor,
    PowerSupply,
    Pulley,
    Stepper,
    columns_of,
    lines,
    singular,
)
from drivesizer.catalog.prices import is_list, matched, price_list
from drivesizer.catalog.tables import Catalog, Note, Pairs, Source, Table, joined, recall, store
from drivesizer.errors import InputError, UnknownCatalogError, nearest, quoted
from drivesizer.files.cache import CacheWarning, digest_of, folder
from drivesizer.files.text import decoded, is_handed, read_bytes, shipped_folder
from drivesizer.units import RANGES
from drivesizer.version import __version__

__all__ = [
    "DIRECT", "EDGES", "PARTS", "RELATIONS", "Actuator", "Battery", "Belt", "Brake", "BrakeResistor", "CacheWarning",
    "Catalog", "Controller", "Encoder", "Gearhead", "Motor", "Note", "Pairs", "PowerSupply", "Pulley", "Source",
    "Stepper", "Table", "catalog_of_text", "columns_of", "lines", "load", "of", "path_of", "shipped", "singular",
]  # fmt: skip


_LARGEST = 16_000_000  # bytes of a catalogue: twenty times the largest that ships


def shipped() -> dict[str, Path]:
    """The catalogues that come with drivesizer, by name."""
    return dict(_found_once())


@cache
def _found_once() -> Mapping[str, Path]:
    """The shipped catalogues, looked for once per process: a hundred are loaded one by one where all are listed."""
    place = shipped_folder("catalogs")
    names = os.listdir(place) if place.is_dir() else []  # noqa: PTH208  ten times as quick
    return {name.removesuffix(".yaml"): place / name for name in sorted(names) if name.endswith(".yaml")}


def load(names: Iterable[str] = ("maxon",), *, beside: Path | None = None) -> Catalog:
    """Catalogues by name or by file, as one.

    Parameters
    ----------
    names
        Names of shipped catalogues, ``all`` for all of them, or paths of catalogue files.
    beside
        Folder from which relative paths count.

    Returns
    -------
    Catalog
        All parts as columns; several catalogues are joined in the order given.

    Raises
    ------
    InputError
        When a catalogue is neither shipped nor a file.
    CatalogError
        When a file does not follow the schema.
    """
    named = [catalog_name for name in names for catalog_name in (shipped() if name == "all" else [name])]
    read, faults = dict[str, tuple[Path, bytes]](), list[str]()
    for name in dict.fromkeys(named):
        try:
            path = path_of(name, beside)
            read[os.path.realpath(path)] = path, read_bytes(path, _LARGEST)  # a file by two names is one
        except InputError as error:
            faults.append(str(error))
    if faults:
        raise UnknownCatalogError(faults[0], faults)
    paths, raws = [path for path, _ in read.values()], [raw for _, raw in read.values()]
    stems = [path.name if is_list(path) else path.stem for path in paths]
    for stem in stems:
        if stems.count(stem) > 1:
            raise InputError(f"two catalogues are called {quoted(stem)}; rename one of the files")
    lists = [_list_beside(path) for path in paths]
    keys = [_key(raw, *map(read_bytes, price_lists)) for raw, price_lists in zip(raws, lists, strict=True)]

    def join() -> Catalog:
        catalogs = []
        for path, stem, raw, key, price_lists in zip(paths, stems, raws, keys, lists, strict=True):
            make = partial(_parsed, path, raw, *price_lists)
            catalogs.append(catalog_of_text(path, raw) if is_handed(path) else _compiled(stem, key, make))
        return matched(joined(catalogs))

    if len(paths) == 1:
        return join()
    name, key = f"{len(paths)} {digest_of(*map(str.encode, stems))}", digest_of(*map(str.encode, keys))
    if any(map(is_handed, paths)):
        return _remembered(f"{name} {key}", join)
    return _compiled(name, key, join)


def path_of(name: str, beside: Path | None = None) -> Path:
    """The file of a catalogue."""
    known = _found_once()
    if name in known:
        return known[name]
    path = (beside or Path()) / name
    if path.suffix in (".yaml", ".yml") or is_list(path):
        return path
    sought = re.compile(rf"^(?:manufacturer|- family): .*\b{re.escape(name)}\b", re.IGNORECASE | re.MULTILINE)
    having = [stem for stem, file in known.items() if sought.search(file.read_text(encoding="utf-8"))]
    hint = f"; it is a maker or a family in {', '.join(having[:3])}" if having else nearest(name, known, 1)
    raise UnknownCatalogError(
        f"no catalogue is called {quoted(name)}{hint}; expected one of `drivesizer catalog stats`, such as maxon, "
        "all, a .yaml file, or a price list, .csv or .xlsx"
    )


def _list_beside(path: Path) -> list[Path]:
    """The price list that ships with a shipped catalogue."""
    prices = path.parent / "prices" / f"{path.stem}.csv"
    return [prices] if _found_once().get(path.stem) == path and prices.is_file() else []


def _key(*raws: bytes) -> str:
    """Digest of what a compiled catalogue is made from: program version, schema and the files' bytes."""
    return digest_of(__version__.encode(), _schema(), *raws)


@cache
def _schema() -> bytes:
    schema, laws = [columns_of(section) for section in PARTS], resources.files(__package__) / "laws.yaml"
    return repr((schema, RANGES)).encode() + laws.read_bytes()


def catalog_of_text(path: Path, raw: bytes) -> Catalog:
    """A catalogue out of its text: nothing of it is kept on the disk, and the last few are remembered."""
    return _remembered(f"{path.stem} {_key(raw)}", lambda: _parsed(path, raw))


def of(
    given: Mapping[str, Any] | Any, section: str = "motors", *, name: str = "own", manufacturer: str = "own",
    pairs: Mapping[str, Any] | None = None,
) -> Catalog:  # fmt: skip
    """A catalogue out of a dict with the fields of a catalogue's file, or out of a table.

    Parameters
    ----------
    given
        The fields; or a data frame, or a dict of columns, whose heads are those of a catalogue's table:
        ``part``, ``family``, ``mass (g)``.
    section
        Of a table: what its rows are.
    name
        In messages, and where catalogues are added to one another.
    manufacturer
        Of the parts of a table.
    pairs
        Of a table: ``compatibility`` as in a file, of motors with gearheads that go with them;
        else motors drive their loads directly.

    Returns
    -------
    Catalog
        Added to others by ``+``.

    Raises
    ------
    CatalogError
        When it does not follow the schema.

    Examples
    --------
    >>> table = {"part": ["A1"], "nominal_voltage (V)": [24], "resistance (ohm)": [0.5], "mass (g)": [300]}
    >>> of(table).motors.record(0).mass
    0.3
    """
    from drivesizer.files.yaml_source import written

    if not (isinstance(given, Mapping) and "sources" in given):
        columns = {str(head): [_plain(cell) for cell in given[head]] for head in given}
        family = columns.pop("family", None) or [section] * len(next(iter(columns.values()), ()))
        rows = list(zip(*columns.values(), strict=True))
        tables = [
            {
                "family": group, "source": "table", "columns": list(columns),
                "rows": [list(row) for row, of_row in zip(rows, family, strict=True) if of_row == group],
            }
            for group in dict.fromkeys(family)
        ]  # fmt: skip
        direct = {"motor_gearhead": [{"source": "table", "motors": list(dict.fromkeys(family)), "gearheads": [DIRECT]}]}
        given = {
            "catalog": 1, "manufacturer": manufacturer,
            "sources": {"table": {"document": "a table of a program", "confidence": "secondary"}},
            section: tables, "compatibility": pairs or (direct if section == "motors" else {}),
        }  # fmt: skip
    return catalog_of_text(Path(f"{name}.yaml"), written(given, name).text.encode())


def _plain(cell: Any) -> Any:
    """A cell of a table as a file has it: a number, text, or nothing."""
    cell = cell.item() if hasattr(cell, "item") else cell
    return None if cell is None or cell != cell else cell  # NaN of a data frame


def _parsed(path: Path, raw: bytes, *lists: Path) -> Catalog:
    from drivesizer.catalog.catalog_file import parse
    from drivesizer.files.yaml_source import YamlSource

    if is_list(path):
        return price_list(path, digest_of(raw))
    digest = digest_of(raw, *map(read_bytes, lists))
    catalog = parse(YamlSource(decoded(raw, path), str(path)), path.stem, digest)
    prices = (price for file in lists for price in price_list(file, "", shipped=True).prices)
    return matched(replace(catalog, prices=(*catalog.prices, *prices))) if lists else catalog


_REMEMBERED = 8
_memory: dict[str, Catalog] = {}  # of late, the newest last; of some of them the disk is not to keep anything
_Value = TypeVar("_Value", Catalog, Catalog | None)


def _remembered(key: str, make: Callable[[], _Value]) -> _Value:
    value = cast("_Value", _memory.pop(key, None) or make())
    while len(_memory) >= _REMEMBERED:
        del _memory[next(iter(_memory))]
    if value is not None:
        _memory[key] = value
    return value


def _compiled(name: str, key: str, make: Callable[[], Catalog]) -> Catalog:
    """The compiled catalogue of a name and key; made and stored where there is none."""
    place = folder() / f"{name}-{key}.catalog"
    try:
        seen = place.stat()
        catalog = _remembered(f"{place} {seen.st_mtime_ns} {seen.st_size}", lambda: recall(place))
    except OSError:
        catalog = None
    if catalog is None:
        catalog = make()
        store(place, catalog)
    return catalog
