"""Stored results of a study: manifest, chunks of variants, digests of inputs, one process at a time in its folder."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from drivesizer.catalog import load
from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import digest_of
from drivesizer.files.text import read_bytes
from drivesizer.files.writing import remove_files, write_files
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.drive import Select
from drivesizer.study.columns import Row, columns_of
from drivesizer.study.plan import Plan
from drivesizer.study.variant import Part, rows_of
from drivesizer.version import __version__

__all__ = ["Store", "locked", "made_of", "opened", "refuse_if_all_invalid"]


# -- One process at a time in a study's folder.
#
# The operating system holds the lock for as long as the process lives, so a killed process leaves none behind. A
# file system without such locks is refused: a lock file in their place would outlive the process.


_LOCK = "lock"
_HOLDER = "lock.txt"  # names the process that holds the lock: a locked file itself cannot be read on every system


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for this process."""
    lock = FileLock(folder / _LOCK, blocking=False, fallback_to_soft=False)
    try:
        lock.acquire()
    except Timeout:
        raise InputError(_refusal(folder)) from None
    except OSError as error:
        raise InputError(f"{folder / _LOCK}: cannot be written or locked ({reason_of(error)})") from None
    try:
        write_files({folder / _HOLDER: f"process {os.getpid()} on {socket.gethostname()}".encode()})
        yield
    finally:
        remove_files([folder / _HOLDER])
        lock.release()


def _refusal(folder: Path) -> str:
    try:
        holder = (folder / _HOLDER).read_text("utf-8", errors="replace")[:200]
    except OSError:  # the other process has the lock and has not written its name yet
        holder = "another process"
    return f"{folder}: {holder} is at work on this study; wait until it is done, or choose another folder with -o"


# -- Inputs of a study's results by name with their digests: runs with the same inputs are the same study.


_READ = (".csv", ".txt", ".json", ".urdf", ".xml", ".mjcf")  # ends of names of files that specs name
_TRIED = 200  # variants, to find a valid one


def made_of(plan: Plan) -> dict[str, str]:
    """Digests of the study, its specs, the files that these name, and the catalogues; the program's version.

    Comments and blanks in a YAML file are ignored.
    """
    shares = b"" if plan.shares is None else plan.shares.tobytes()
    found = {"drivesizer": __version__, Path(plan.source.name).name: digest_of(_canonical(plan.source.data), shares)}
    for name, (path, text) in zip(plan.names, plan.job.specs, strict=True):
        data = YamlSource(text, path).data
        found[name] = digest_of(_canonical(data))
        folder = Path(path).parent
        found |= {given: digest_of(read_bytes(folder / given)) for given in sorted(_files(data, folder))}
        for names in plan.job.catalogs:
            digests = load(names or _named(data), beside=folder).digests
            found |= {f"catalogue {catalog}": value for catalog, value in digests.items()}
    varied = {given for axis in plan.job.axes for given in _files(list(axis.values), Path(plan.job.specs[0][0]).parent)}
    return found | {given: digest_of(read_bytes(Path(plan.job.specs[0][0]).parent / given)) for given in sorted(varied)}


def _canonical(data: Any) -> bytes:
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()


def _named(data: Any) -> list[str]:
    """Catalogues that a spec or the axes of a machine name; default ones where it has none or a field is malformed."""
    axes = data.get("axes")
    found = [_named_in(data), *(_named_in(axis) for axis in (axes.values() if isinstance(axes, dict) else ()))]
    names = [name for some in found for name in some]
    return list(dict.fromkeys(names if found[0] else [*Select().catalogs, *names]))


def _named_in(data: Any) -> list[str]:
    """Catalogues of a section ``select``."""
    select = data.get("select") if isinstance(data, dict) else None
    given = select.get("catalogs") if isinstance(select, dict) else None
    names = [given] if isinstance(given, str) else given
    return [str(name) for name in names] if isinstance(names, list) else []


def _files(data: Any, folder: Path) -> Iterator[str]:
    """Texts in a spec that name a file, such as a recording or a robot's description."""
    if isinstance(data, dict | list):
        for value in data.values() if isinstance(data, dict) else data:
            yield from _files(value, folder)
    elif isinstance(data, str) and data.lower().endswith(_READ) and (folder / data).is_file():
        yield data


def refuse_if_all_invalid(plan: Plan) -> str:
    """Size variants until one is valid."""
    heads = [column.head for column in columns_of(plan)]
    status, error = heads.index("status"), heads.index("error")
    few = range(1, plan.total + 1, -(-plan.total // _TRIED))
    first = ""
    for number in few:
        variant = plan.variant(number)
        (row, *_) = rows_of(plan.job, [variant], [plan.head(variant)]).rows
        if row[status] != "error":
            return ""
        first = first or row[error]
    if len(few) == plan.total:
        raise InputError(f"{plan.source.name}: all of its variants are invalid ({plan.total}); the first: {first}")
    return f"each of {len(few)} variants tried is invalid, the first: {first}"


# -- Stored results of a study: a manifest, and a file for each completed chunk of variants.
#
# A chunk is written in one step and carries the digest of its rows, so after a kill or a power failure it is
# complete or is computed again. The manifest has the digests of all inputs; rows of different studies are never
# mixed.
#
#     FOLDER/study.json                the inputs of the results
#     FOLDER/chunks/000/000012.jsonl   a head with the digest, then a row in each line
#     FOLDER/lock, lock.txt            held by a process while it works, and its name


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
