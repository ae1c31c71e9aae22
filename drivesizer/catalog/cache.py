"""Compiled catalogues: the columns of a catalogue file as plain bytes in the user's cache folder.

A compiled file is named by the digest of what it was made from (this package's version, the schema, the YAML's
bytes), so a changed catalogue is never met by an old compilation. It starts with the digest of its own
contents and is thrown away when that does not hold. Numbers are npy arrays read without pickle, texts are
JSON. Writing goes to a private file that then takes the name at once, so two processes cannot disturb each
other; when the folder cannot be written, the program goes on without.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import tempfile
import time
import warnings
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.discharges import NO_DISCHARGES, Discharges
from drivesizer.catalog.parts import PARTS, RELATIONS, columns_of
from drivesizer.catalog.stated import Stated
from drivesizer.catalog.tables import Across, Catalog, Note, Pairs, Source, Table, empty
from drivesizer.errors import reason_of

__all__ = ["CacheWarning", "digest_of", "folder", "keep", "kept", "recall", "store"]

_NONE = np.zeros((3, 0), np.int32)
_HALF = ".compiling-"  # begins the name of a file that is being written
_LONG_AGO = 600.0  # s, after which nobody writes it any more
_DIGEST = 32  # bytes of blake2b at the head of a compiled file


class CacheWarning(UserWarning):
    """The compiled catalogue could not be kept; the next start is slower."""


def folder() -> Path:
    """Where compiled catalogues are kept: ``$DRIVESIZER_CACHE``, or the user's cache folder."""
    given = os.environ.get("DRIVESIZER_CACHE")
    if given:
        return Path(given)
    from platformdirs import user_cache_path

    return user_cache_path("drivesizer", appauthor=False)


def digest_of(*parts: bytes) -> str:
    """Digest of some bytes, as text for a file name."""
    mixed = hashlib.blake2b(digest_size=16)
    for part in parts:
        mixed.update(len(part).to_bytes(8, "big") + part)
    return mixed.hexdigest()


def recall(path: Path) -> Catalog | None:
    """The compiled catalogue at a path, or None when there is none or it is damaged."""
    body = kept(path)
    if body is None:
        return None
    try:
        with np.load(io.BytesIO(body), allow_pickle=False) as arrays:
            return _unpacked({name: arrays[name] for name in arrays.files})
    except (zipfile.BadZipFile, ValueError, KeyError, TypeError, EOFError):
        return None  # an intact file of another layout: compiled again


def store(path: Path, catalog: Catalog) -> None:
    """Keep a compiled catalogue; older compilations of the same file are removed.

    Warns
    -----
    CacheWarning
        When the folder cannot be written.
    """
    buffer = io.BytesIO()
    np.savez(buffer, **_packed(catalog))  # type: ignore[arg-type]  # its allow_pickle is no array
    try:
        keep(path, buffer.getvalue())
    except OSError as error:
        reason = reason_of(error)
        warnings.warn(f"the compiled catalogue is not kept in {path.parent} ({reason})", CacheWarning, stacklevel=2)


def kept(path: Path) -> bytes | None:
    """What was kept under a path, or None when there is nothing or it is damaged."""
    try:
        raw = path.read_bytes()
    except OSError:
        return None
    body = raw[_DIGEST:]
    return body if hashlib.blake2b(body, digest_size=_DIGEST).digest() == raw[:_DIGEST] else None


def keep(path: Path, body: bytes) -> None:
    """Keep bytes under a path, whole or not at all; older ones of the same name before its digest are removed.

    Raises
    ------
    OSError
        When the folder cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=_HALF)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.blake2b(body, digest_size=_DIGEST).digest() + body)
        Path(name).replace(path)
    except OSError:
        Path(name).unlink()
        raise
    _tidy(path)


def _tidy(path: Path) -> None:
    """Remove older compilations of the same catalogue, and what a killed process left half done."""
    for old in path.parent.iterdir():
        with contextlib.suppress(FileNotFoundError):  # of another process, which is done with it
            left_over = old.name.startswith(_HALF) and time.time() - old.stat().st_mtime > _LONG_AGO
            if left_over or (_catalogue(old) == _catalogue(path) and old != path):
                old.unlink()


def _catalogue(path: Path) -> tuple[str, str]:
    """The name of the catalogue that a compiled file holds (before the digest), and the file's ending."""
    return path.stem.rpartition("-")[0], path.suffix


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
    return Catalog(
        **tables,
        **pairs,
        discharges=Discharges(*discharges),
        sources=tuple(Source(*s) for s in texts["sources"]),
        notes=tuple(Note(n[0], tuple(n[1]), tuple(n[2]), *n[3:]) for n in texts["notes"]),
        digests=texts["digests"],
        overrides=texts["overrides"],
        replaced=tuple(texts["replaced"]),
        tolerances=tuple(Stated(s[0], s[1], s[2], s[3], tuple(s[4]), s[5], s[6]) for s in texts["tolerances"]),
        across=tuple(Across(a[0], _names(a[1]), _names(a[2]), a[3]) for a in texts["across"]),
    )


def _names(given: list[list[str]]) -> tuple[tuple[str, str], ...]:
    return tuple((catalogue, name) for catalogue, name in given)
