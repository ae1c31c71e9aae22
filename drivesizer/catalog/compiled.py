"""Compiled catalogues: the columns of a catalogue file as plain bytes in the user's cache folder.

A compiled file is named by the digest of what it was made from (this package's version, the schema, the YAML's
bytes), so an old compilation is never used for a changed catalogue. It starts with the digest of its own
contents and is discarded when that differs. Numbers are npy arrays read without pickle, texts are
JSON. Writing goes to a private file that then takes the name at once, so two processes cannot disturb each
other; when the folder cannot be written, the program works without it.
"""

from __future__ import annotations

import io
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.discharges import NO_DISCHARGES, Discharges
from drivesizer.catalog.maker_tolerances import MakerTolerance
from drivesizer.catalog.parts import PARTS, RELATIONS, columns_of
from drivesizer.catalog.pull_outs import NO_PULL_OUTS, PullOuts
from drivesizer.catalog.tables import Across, Catalog, Note, Pairs, Source, Table, empty
from drivesizer.errors import reason_of
from drivesizer.files.cache import CacheWarning, arrays_kept, keep

__all__ = ["recall", "store"]

_NONE = np.zeros((3, 0), np.int32)


def recall(path: Path) -> Catalog | None:
    """The compiled catalogue at a path, or None when there is none or it is damaged."""
    arrays = arrays_kept(path)
    try:
        return None if arrays is None else _unpacked(arrays)
    except (ValueError, KeyError, TypeError, IndexError):
        return None  # an intact file of another layout: compiled again


def store(path: Path, catalog: Catalog) -> None:
    """Keep a compiled catalogue; older compilations of the same file are removed."""
    buffer = io.BytesIO()
    np.savez(buffer, **_packed(catalog))  # type: ignore[arg-type]  # its allow_pickle is no array
    try:
        keep(path, buffer.getvalue())
    except OSError as error:
        reason = reason_of(error)
        warnings.warn(f"the compiled catalogue is not kept in {path.parent} ({reason})", CacheWarning, stacklevel=2)


def _packed(catalog: Catalog) -> dict[str, NDArray[Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    texts: dict[str, Any] = {"sources": catalog.sources, "notes": catalog.notes, "digests": dict(catalog.digests)}
    texts |= {"overrides": catalog.overrides, "across": catalog.across, "replaced": catalog.replaced}
    texts |= {"tolerances": catalog.tolerances}
    for section in PARTS:
        table, schema = catalog.table(section), columns_of(section)
        if not len(table):
            continue
        figures = [name for name, column in schema.items() if column.kind != "text"]
        arrays[f"{section}.figures"] = np.array([table[name] for name in figures])
        arrays[f"{section}.source"] = table.source
        arrays[f"{section}.excluded"] = table.excluded
        texts[section] = {name: table[name].tolist() for name in schema if name not in figures}
    for relation in RELATIONS:
        if len(getattr(catalog, relation).left):
            arrays[relation] = np.array(getattr(catalog, relation))
    if len(catalog.discharges.time):
        arrays |= {f"discharges.{name}": column for name, column in catalog.discharges._asdict().items()}
    if len(catalog.pull_outs.speed):
        arrays |= {f"pull_outs.{name}": column for name, column in catalog.pull_outs._asdict().items()}
    arrays["texts"] = np.frombuffer(json.dumps(texts).encode(), np.uint8)
    return arrays


def _unpacked(arrays: dict[str, NDArray[Any]]) -> Catalog:
    texts = json.loads(arrays["texts"].tobytes())
    tables: dict[str, Any] = {}
    for section in PARTS:
        if section not in texts:
            tables[section] = empty(section)
            continue
        schema = columns_of(section)
        figures = [name for name, column in schema.items() if column.kind != "text"]
        columns: dict[str, NDArray[Any]] = dict(zip(figures, arrays[f"{section}.figures"], strict=True))
        columns |= {name: np.array(values, str) for name, values in texts[section].items()}
        tables[section] = Table(section, columns, arrays[f"{section}.source"], arrays[f"{section}.excluded"])
    pairs: dict[str, Any] = {relation: Pairs(*arrays.get(relation, _NONE)) for relation in RELATIONS}
    printed = NO_DISCHARGES._asdict().items()
    discharges: Any = (arrays.get(f"discharges.{name}", none) for name, none in printed)
    curves: Any = (arrays.get(f"pull_outs.{name}", none) for name, none in NO_PULL_OUTS._asdict().items())
    return Catalog(
        **tables,
        **pairs,
        discharges=Discharges(*discharges),
        pull_outs=PullOuts(*curves),
        sources=tuple(Source(*s) for s in texts["sources"]),
        notes=tuple(Note(n[0], tuple(n[1]), tuple(n[2]), *n[3:]) for n in texts["notes"]),
        digests=texts["digests"],
        overrides=texts["overrides"],
        replaced=tuple(texts["replaced"]),
        tolerances=tuple(MakerTolerance(s[0], s[1], s[2], s[3], tuple(s[4]), s[5], s[6]) for s in texts["tolerances"]),
        across=tuple(Across(a[0], _names(a[1]), _names(a[2]), a[3]) for a in texts["across"]),
    )


def _names(given: list[list[str]]) -> tuple[tuple[str, str], ...]:
    return tuple((catalogue, name) for catalogue, name in given)
