"""A study's folder: manifest, chunks of variants, digests of inputs, one process at a time in it, and its tables.

A chunk is written in one step and carries the digest of its rows, so after a kill or a power failure it is complete or
is computed again. The manifest has the digests of all inputs; rows of different studies are never mixed.

    FOLDER/study.json                the inputs of the results
    FOLDER/chunks/000/000012.jsonl   a head with the digest, then a row in each line
    FOLDER/lock, lock.txt            held by a process while it works, and its name
    FOLDER/results.csv, .parquet     the table, units in the heads of CSV and in the metadata of Parquet's columns

The operating system holds the lock for as long as the process lives, so a killed process leaves none behind. A file
system without such locks is refused: a lock file in their place would outlive the process.
"""

from __future__ import annotations

import csv
import io
import json
import os
import socket
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

from filelock import FileLock, Timeout

from drivesizer.catalog import load
from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import digest_of
from drivesizer.files.text import read_bytes
from drivesizer.files.writing import ready, remove_files, write_files
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.words import csv_cell
from drivesizer.spec.drive import Select
from drivesizer.study.plan import Plan
from drivesizer.study.rows import Column, Part, Row, columns_of, rows_of
from drivesizer.version import __version__

_LOCK = "lock"
_HOLDER = "lock.txt"  # names the process that holds the lock: a locked file itself cannot be read on every system


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for this process."""
    lock = FileLock(folder / _LOCK, blocking=False, fallback_to_soft=False)
    try:
        lock.acquire()
    except Timeout:
        try:
            holder = (folder / _HOLDER).read_text("utf-8", errors="replace")[:200]
        except OSError:  # the other process has the lock and has not written its name yet
            holder = "another process"
        text = "is at work on this study; wait until it is done, or choose another folder with -o"
        raise InputError(f"{folder}: {holder} {text}") from None
    except OSError as error:
        raise InputError(f"{folder / _LOCK}: cannot be written or locked ({reason_of(error)})") from None
    try:
        write_files({folder / _HOLDER: f"process {os.getpid()} on {socket.gethostname()}".encode()})
        yield
    finally:
        remove_files([folder / _HOLDER])
        lock.release()


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
    axes, found = data.get("axes"), list[list[str]]()
    for section in (data, *(axes.values() if isinstance(axes, dict) else ())):
        select = section.get("select") if isinstance(section, dict) else None
        given = select.get("catalogs") if isinstance(select, dict) else None
        names = [given] if isinstance(given, str) else given
        found.append([str(name) for name in names] if isinstance(names, list) else [])
    every = [name for names in found for name in names]
    return list(dict.fromkeys(every if found[0] else [*Select().catalogs, *every]))


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


FORMAT = 1  # of the folder
_MANIFEST = "study.json"
_CHUNKS = "chunks"
_RESULTS = ("results.csv", "results.parquet")
_MAPS = "maps"
_GROUP = 50_000  # least number of rows that are written together to Parquet
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
    try:
        read: Any = json.loads((folder / _MANIFEST).read_bytes())
    except FileNotFoundError:
        read = None
    except (OSError, ValueError):
        read = {}
    before = read if isinstance(read, dict | None) else {}
    if fresh:  # the files of a study, and no others
        own = [*store.results, store.folder / _MANIFEST, *(store.folder / _CHUNKS).glob("*/*.jsonl")]
        remove_files([*own, *store.maps.glob("*.svg"), *store.maps.glob("*.png")])
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


def _difference(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Inputs that have changed since the results were computed."""
    made = before.get("made_of")
    if before.get("format") != now["format"] or not isinstance(made, dict):
        return f"its {_MANIFEST} is none of this version"
    names = [name for name in {**made, **now["made_of"]} if made.get(name) != now["made_of"].get(name)]
    listed = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    return f"{listed} changed since" if names else "of another size"


# Its tables, written a chunk at a time and whole or not at all.


def write_csv(path: Path, columns: Sequence[Column], chunks: Iterable[list[Row]]) -> None:
    """Write a table as CSV."""
    with _whole(path) as stream:
        text = io.TextIOWrapper(stream, "utf-8", newline="", write_through=True)
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([csv_cell(column.head) for column in columns])
        for rows in chunks:
            writer.writerows([["" if cell is None else csv_cell(cell) for cell in row] for row in rows])
        text.detach()


def has_parquet() -> bool:
    """Whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def write_parquet(path: Path, columns: Sequence[Column], chunks: Iterable[list[Row]]) -> None:
    """Write a table as Parquet, with units in the metadata of its columns."""
    pyarrow: Any = import_module("pyarrow")
    parquet: Any = import_module("pyarrow.parquet")
    types = {"whole": pyarrow.int64(), "number": pyarrow.float64(), "text": pyarrow.string()}
    schema = pyarrow.schema([
        pyarrow.field(column.head, types[column.form], metadata={"unit": column.unit} if column.unit else None)
        for column in columns
    ])  # fmt: skip
    with _whole(path) as stream, parquet.ParquetWriter(stream, schema, compression="zstd") as writer:
        group: list[Row] = []  # rows of several chunks together, so that a file has few row groups
        for rows in chain(chunks, [None]):
            group += rows or []
            if group and (rows is None or len(group) >= _GROUP):
                arrays = [pyarrow.array([row[n] for row in group], field.type) for n, field in enumerate(schema)]
                writer.write_table(pyarrow.table(arrays, schema=schema))
                group = []


@contextmanager
def _whole(path: Path) -> Iterator[BinaryIO]:
    """Stream to a temporary file that replaces the target when complete, for content larger than memory."""
    ready(path)
    if path.exists() and not path.is_file():  # a device or a pipe, which a file would take the place of
        raise InputError(f"{path}: cannot be written, it is no file; remove it, or choose another folder with -o")
    target = path.resolve()
    temporary = target.with_name(f"{target.name}.part")
    try:
        temporary.unlink(missing_ok=True)
        with temporary.open("xb") as stream:
            yield stream
        temporary.replace(target)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({reason_of(error)})") from None
    finally:
        temporary.unlink(missing_ok=True)
