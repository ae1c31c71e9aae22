"""Estimates of all parts of a catalogue, kept in the cache folder once they are found."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from contextlib import suppress
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.assumed import rule_of_thumb_bands
from drivesizer.catalog.estimates.estimate import estimates
from drivesizer.catalog.estimates.laws import LAWS
from drivesizer.catalog.tables import Catalog, Estimates
from drivesizer.files.cache import arrays_kept, digest_of, folder, keep
from drivesizer.version import __version__

__all__ = ["estimates_kept"]

_SUFFIXES = {".json", ".py", ".yaml"}
_SECTIONS = tuple(dict.fromkeys((*(law.section for law in LAWS), "controllers", "brakes")))
_CLASSES = ("manufacturer", "family", "kind", "gearing")  # texts that the laws read
Found = dict[str, dict[str, Estimates]]


def estimates_kept(catalog: Catalog) -> Found:
    """Estimates of figures that data sheets leave out, from peers of the parts."""
    path = folder() / f"estimates {digest_of(*map(str.encode, catalog.digests))[:8]}-{_key(catalog)}.npz"
    arrays = arrays_kept(path)
    if arrays is not None and (known := _unpacked(arrays)) is not None:
        return _with_rules(catalog, known)
    every = {section: estimates(catalog.table(section)) for section in _SECTIONS}
    found = {section: figures for section, figures in every.items() if figures}
    with suppress(OSError):  # a folder without write access was reported when the catalogue was not kept
        keep(path, _written(found))
    return _with_rules(catalog, found)


def _with_rules(catalog: Catalog, found: Found) -> Found:
    """The estimates, and the figures of actuators that are a rule of thumb."""
    rules = rule_of_thumb_bands(catalog)
    return found | {"actuators": found.get("actuators", {}) | rules} if rules else found


def _key(catalog: Catalog) -> str:
    """Digest of the laws and of all that they read: tables may be others than those of the catalogue's files."""
    parts = [__version__.encode(), *_sources()]
    for section in _SECTIONS:
        columns = catalog.table(section).columns
        parts += [np.array([column for column in columns.values() if column.dtype.kind == "f"]).tobytes()]
        parts += [columns[name].tobytes() for name in _CLASSES if name in columns]
    return digest_of(*parts)


def _sources() -> list[bytes]:
    """Content of the files that estimates are made with: the laws, their figures, and the physics that they use."""
    laws = [file for file in resources.files(__package__).iterdir() if Path(file.name).suffix in _SUFFIXES]
    physics = resources.files("drivesizer.physics") / "thermal.py"
    return [file.read_bytes() for file in (*sorted(laws, key=lambda file: file.name), physics)]


def _written(found: Found) -> bytes:
    listed = [(section, column, one) for section, columns in found.items() for column, one in columns.items()]
    buffer = io.BytesIO()
    names = json.dumps([(section, column, len(one.rows)) for section, column, one in listed])
    figures = np.concatenate([np.zeros((5, 0)), *(np.array(one) for *_, one in listed)], axis=1)
    np.savez(buffer, names=np.frombuffer(names.encode(), np.uint8), figures=figures)
    return buffer.getvalue()


def _unpacked(arrays: Mapping[str, NDArray[Any]]) -> Found | None:
    """The estimates that were kept; None of a file of another layout."""
    found: Found = {}
    start = 0
    try:
        for section, column, count in json.loads(arrays["names"].tobytes()):
            rows, value, low, high, fit = arrays["figures"][:, start : start + count]
            one = Estimates(rows.astype(np.int64), value, low, high, fit.astype(np.int64))
            found.setdefault(section, {})[column] = one
            start += count
    except (KeyError, ValueError, TypeError, IndexError):
        return None
    return found
