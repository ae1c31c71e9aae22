"""Stored results of a study: a manifest, and a file for each completed chunk of variants.

A chunk is written in one step and carries the digest of its rows, so after a kill or a power failure it is complete or
is computed again. The manifest has the digests of all inputs; rows of different studies are never mixed.

    FOLDER/study.json                the inputs of the results
    FOLDER/chunks/000/000012.jsonl   a head with the digest, then a row in each line
    FOLDER/lock, lock.txt            held by a process while it works, and its name
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import digest_of
from drivesizer.files.writing import remove_files, write_files
from drivesizer.study.column import Row
from drivesizer.study.plan import Plan
from drivesizer.study.variant import Part

__all__ = ["FORMAT", "Store", "opened"]

FORMAT = 1  # of the folder
_MANIFEST = "study.json"
_CHUNKS = "chunks"
_RESULTS = ("results.csv", "results.parquet")
_MAPS = "maps"
_FRESH = "--fresh begins anew, -o FOLDER keeps both"


@dataclass(frozen=True, slots=True)
class Store:
    """A study's folder."""

    folder: Path
    made_of: Mapping[str, str]
    chunks: int

    @property
    def results(self) -> tuple[Path, Path]:
        """Paths of the tables: CSV and Parquet."""
        return self.folder / _RESULTS[0], self.folder / _RESULTS[1]

    @property
    def maps(self) -> Path:
        """Folder of the maps."""
        return self.folder / _MAPS

    def path(self, chunk: int) -> Path:
        """The file of a chunk."""
        return self.folder / _CHUNKS / f"{chunk // 1000:03}" / f"{chunk:06}.jsonl"

    def keep(self, chunk: int, part: Part) -> None:
        """Store the rows of a chunk."""
        for name, found in part.made_of.items():
            if self.made_of.get(name, found) != found:
                raise InputError(
                    f"{name}: a process that computes variants has another version ({found[:12]}) than this one "
                    f"({self.made_of[name][:12]}); expected the same everywhere"
                )
        lines = "".join(f"{json.dumps(row, ensure_ascii=False)}\n" for row in part.rows).encode()
        head = json.dumps({"chunk": chunk, "digest": digest_of(lines)}).encode()
        path = self.path(chunk)
        path.parent.mkdir(exist_ok=True)
        write_files({path: head + b"\n" + lines})

    def _lines(self, chunk: int) -> bytes | None:
        """The rows of a chunk as written; None where they are missing or damaged."""
        try:
            head, _, lines = self.path(chunk).read_bytes().partition(b"\n")
            return lines if json.loads(head) == {"chunk": chunk, "digest": digest_of(lines)} else None
        except (OSError, ValueError):
            return None

    def missing(self) -> list[int]:
        """Chunks to be computed."""
        return [chunk for chunk in range(self.chunks) if self._lines(chunk) is None]

    def every_row(self) -> Iterator[list[Row]]:
        """The rows of all chunks in the order of their variants, a chunk at a time."""
        for chunk in range(self.chunks):
            lines = self._lines(chunk)
            if lines is None:
                raise InputError(f"{self.path(chunk)}: is damaged; the same command computes it again")
            yield [json.loads(line) for line in lines.decode().split("\n")[:-1]]


def opened(folder: Path, plan: Plan, made_of: Mapping[str, str], *, fresh: bool = False) -> Store:
    """Prepare a study's folder; the caller holds its lock."""
    store = Store(folder, made_of, plan.chunks)
    manifest = {"format": FORMAT, "variants": plan.total, "chunk": plan.chunk, "made_of": dict(made_of)}
    before = _manifest(folder / _MANIFEST)
    if fresh:
        _cleared(store)
    elif before is not None and before != manifest:
        raise InputError(f"{folder}: holds results of another study ({_difference(before, manifest)}); {_FRESH}")
    try:
        (folder / _CHUNKS).mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written ({reason_of(error)})") from None
    killed = (folder / _CHUNKS).glob("*/.drivesizer-*.part"), folder.glob("results.*.part")
    remove_files(chain(*killed))  # of a process that was killed while writing
    if fresh or before is None:
        write_files({folder / _MANIFEST: (json.dumps(manifest, indent=2) + "\n").encode()})
    return store


def _manifest(path: Path) -> dict[str, Any] | None:
    try:
        found = json.loads(path.read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValueError):
        found = None
    return found if isinstance(found, dict) else {}


def _difference(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Inputs that have changed since the results were computed."""
    made = before.get("made_of")
    if before.get("format") != now["format"] or not isinstance(made, dict):
        return f"its {_MANIFEST} is none of this version"
    names = [name for name in {**made, **now["made_of"]} if made.get(name) != now["made_of"].get(name)]
    return f"{_listed(names)} changed since" if names else "of another size"


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def _cleared(store: Store) -> None:
    """Remove the files of a study, and no others."""
    own = [*store.results, store.folder / _MANIFEST]
    own += [*(store.folder / _CHUNKS).glob("*/*.jsonl"), *store.maps.glob("*.svg"), *store.maps.glob("*.png")]
    remove_files(own)
