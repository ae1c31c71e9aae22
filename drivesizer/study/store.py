"""A study's folder: its inputs, the rows of each point as they come, one process at a time in it, and its tables.

    FOLDER/study.json                the inputs of the results
    FOLDER/rows.jsonl                a line for each point: checksum, then its number and its rows as JSON
    FOLDER/lock, lock.txt            held by a process while it works, and its name
    FOLDER/results.csv, .parquet     the table, units in the heads of CSV and in the metadata of Parquet's columns
    FOLDER/chunks/FIRST-LAST.parquet the rows of some points, where workers write them: in place of all these

After a kill or a failure of power a line is whole, or its point is computed again. The manifest has the digests of all
inputs; rows of different studies are never mixed. The operating system holds the lock for as long as the process lives,
so a killed process leaves none behind. A file system without such locks is refused: a lock file in their place would
outlive the process.
"""

from __future__ import annotations

import csv
import io
import json
import os
import socket
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from itertools import groupby, islice
from pathlib import Path
from typing import Any, BinaryIO
from zlib import crc32

import numpy as np
from filelock import FileLock, Timeout
from numpy.typing import NDArray

from drivesizer.catalog import load
from drivesizer.errors import InputError, reason_of
from drivesizer.files.cache import digest_of
from drivesizer.files.text import read_bytes
from drivesizer.files.writing import ready, remove_files, write_files
from drivesizer.files.yaml_source import YamlSource, texts_in
from drivesizer.output.words import csv_cell
from drivesizer.spec.machine import named_catalogs
from drivesizer.study.plan import Job, Plan, Variant
from drivesizer.study.rows import Column, Part, Row, columns_of, rows_of
from drivesizer.version import __version__

_FORMAT = 2  # of the folder
_MANIFEST = "study.json"
_ANSWERS = ("best.csv", "front.csv", "influence.csv")  # where they are wanted
_OWN = {"lock", "lock.txt", "rows.jsonl", "chunks", "maps", "results.csv", "results.parquet", _MANIFEST, *_ANSWERS}
_HOLDER = "lock.txt"  # names the process that holds the lock: a locked file itself cannot be read on every system
_READ = (".csv", ".txt", ".json", ".urdf", ".xml", ".mjcf")  # ends of names of files that specs name
_GROUP = 50_000  # least number of rows that are written together to Parquet


def usable(folder: Path) -> None:
    """Refuse a folder that cannot be created, is a file, or holds other files."""
    try:
        folder.stat()  # is_dir gives False for a name that is too long, in Python 3.14
        if not folder.is_dir():
            raise InputError(f"{folder}: is a file; expected a folder for the results, -o names another")
        names = {path.name for path in folder.iterdir()}
    except (FileNotFoundError, NotADirectoryError):
        names = set()
    except OSError as error:
        raise InputError(f"{folder}: cannot be read ({reason_of(error)})") from None
    if not folder.parent.is_dir():
        raise InputError(f"{folder}: cannot be made, there is no folder {folder.parent}")
    foreign = sorted(names - _OWN)
    if foreign and _MANIFEST not in names:
        raise InputError(
            f"{folder}: holds other files, such as {foreign[0]}; expected a new or empty folder, -o names one"
        )


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for this process."""
    lock = FileLock(folder / "lock", blocking=False, fallback_to_soft=False)
    try:
        folder.mkdir(exist_ok=True)
        lock.acquire()
    except Timeout:
        try:
            holder = (folder / _HOLDER).read_text("utf-8", errors="replace")[:200]
        except OSError:  # the other process has the lock and has not written its name yet
            holder = "another process"
        text = "is at work on this study; wait until it is done, or choose another folder with -o"
        raise InputError(f"{folder}: {holder} {text}") from None
    except OSError as error:
        raise InputError(f"{folder / 'lock'}: cannot be written or locked ({reason_of(error)})") from None
    try:
        write_files({folder / _HOLDER: f"process {os.getpid()} on {socket.gethostname()}".encode()})
        yield
    finally:
        remove_files([folder / _HOLDER])
        lock.release()


def made_of(plan: Plan) -> dict[str, str]:
    """Digests of the study, its specs, the files that these name, and the catalogues; the program's version.

    Comments and blanks in a YAML file are ignored.
    """

    def canonical(data: Any) -> bytes:
        return json.dumps(data, ensure_ascii=False, separators=(",", ":")).encode()

    def read(data: Any, folder: Path) -> dict[str, str]:
        """Files that a spec names, such as a recording or a robot's description."""
        named = sorted({name for name in texts_in(data) if name.lower().endswith(_READ) and (folder / name).is_file()})
        return {name: digest_of(read_bytes(folder / name)) for name in named}

    shares = b"" if plan.shares is None else plan.shares.tobytes()
    inputs = {"drivesizer": __version__, Path(plan.source.name).name: digest_of(canonical(plan.source.data), shares)}
    for name, (path, text) in zip(plan.names, plan.job.specs, strict=True):
        data, folder = YamlSource(text, path).data, Path(path).parent
        inputs |= {name: digest_of(canonical(data)), **read(data, folder)}
        for names in plan.job.catalogs:
            digests = load(names or named_catalogs(data), beside=folder).digests
            inputs |= {f"catalogue {catalog}": value for catalog, value in digests.items()}
    return inputs | read([list(axis.values) for axis in plan.job.axes], Path(plan.job.specs[0][0]).parent)


class Store:
    """The rows of a study; the caller holds its folder's lock."""

    kind: Mapping[str, str] = {}  # in the manifest
    most_of_task = 100  # variants: so many are lost by each killed process

    def __init__(self, folder: Path, plan: Plan, made_of: Mapping[str, str], *, fresh: bool = False) -> None:
        self.folder, self.path, self.made_of = folder, folder / "rows.jsonl", made_of
        self.of_each = plan.of_each
        self.results = folder / "results.csv", folder / "results.parquet"
        manifest = {"format": _FORMAT, "variants": plan.total, "made_of": dict(made_of), **self.kind}
        try:
            read: Any = json.loads((folder / _MANIFEST).read_bytes())
        except FileNotFoundError:
            read = None
        except (OSError, ValueError):
            read = {}
        before = read if isinstance(read, dict | None) else {}
        if fresh:  # the files of a study, and no others
            maps = folder / "maps"
            answers = (folder / name for name in _ANSWERS)
            files = [*(folder / "chunks").glob("*.parquet"), *maps.glob("*.svg"), *maps.glob("*.png")]
            remove_files([*self.results, *answers, folder / "rows.jsonl", folder / _MANIFEST, *files])
        elif before is not None and before != manifest:
            reason = _difference(before, manifest)
            raise InputError(
                f"{folder}: holds results of another study ({reason}); --fresh begins anew, another folder keeps both"
            )
        remove_files(folder.glob("results.*.part"))  # of a process that was killed while writing
        if fresh or before is None:
            write_files({folder / _MANIFEST: (json.dumps(manifest, indent=2) + "\n").encode()})
        self.places = np.full(plan.points, -1, np.int64)  # of each point's line in the file
        try:
            self._find()
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written ({reason_of(error)})") from None

    def _find(self) -> None:
        """Find the points that are stored."""
        with self.path.open("a+b") as file:
            place, line = file.seek(0), b"\n"
            for line in file:
                body = line[9:-1]
                if line == _line(body):  # else of a process that was killed while writing
                    point = int(body[1 : body.index(b",")])
                    self._grow(point + 1)
                    self.places[point] = place
                place += len(line)
            if not line.endswith(b"\n"):
                file.write(b"\n")

    def _grow(self, points: int) -> None:
        if points > len(self.places):
            self.places = np.concatenate([self.places, np.full(points - len(self.places), -1, np.int64)])

    def keep(self, part: Part) -> None:
        """Store the rows of some points."""
        refuse_others(self.made_of, part)
        try:
            with self.path.open("ab") as file:
                for point, rows in groupby(part.rows, lambda row: (row[0] - 1) // self.of_each):
                    self._grow(point + 1)
                    self.places[point] = file.tell()
                    file.write(_line(json.dumps([point, *rows], ensure_ascii=False).encode()))
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written ({reason_of(error)})") from None

    def missing(self, points: int) -> list[NDArray[np.int64]]:
        """Points to be computed, of the first so many: stretches out of which a task may have some."""
        self._grow(points)
        return [np.flatnonzero(self.places[:points] < 0)]

    def computation(self, plan: Plan) -> Callable[[Job, Sequence[Variant]], Part]:
        """The function that computes a task: here its rows are given back."""
        return rows_of

    def every_row(self, points: int | None = None) -> Iterator[Row]:
        """The rows of the first so many points in the order of their variants, as far as they are known."""
        with self.path.open("rb") as file:
            for place in self.places[:points][self.places[:points] >= 0].tolist():
                file.seek(place)
                yield from json.loads(file.readline()[9:])[1:]

    def write(
        self, columns: Sequence[Column], counted: Iterable[Row], rows: Callable[[], Iterable[Row]]
    ) -> tuple[list[Path], list[str]]:
        """Write the table of some rows: its files, and what there is to say of them."""
        as_csv, as_parquet = self.results
        write_csv(as_csv, columns, counted)
        if not has_parquet():
            remove_files([as_parquet])
            return [as_csv], ["no results.parquet, which needs pyarrow: install drivesizer[study]"]
        write_parquet(as_parquet, columns, rows())
        return [as_csv, as_parquet], []


def refuse_others(made_of: Mapping[str, str], part: Part) -> None:
    """Refuse rows of a process with another program or catalogue."""
    for name, version in part.made_of.items():
        if made_of.get(name, version) != version:
            raise InputError(
                f"{name}: a process that computes variants has another version ({version[:12]}) than this one "
                f"({made_of[name][:12]}); expected the same everywhere"
            )


def _line(body: bytes) -> bytes:
    return b"%08x %s\n" % (crc32(body), body)


def _difference(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Inputs that have changed since the results were computed."""
    inputs = before.get("made_of")
    if before.get("format") != now["format"] or not isinstance(inputs, dict):
        return f"its {_MANIFEST} is none of this version"
    if before.get("rows") != now.get("rows"):
        return "its rows are kept in another form: with --chunks or without"
    names = [name for name in {**inputs, **now["made_of"]} if inputs.get(name) != now["made_of"].get(name)]
    listed = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    return f"{listed} changed since" if names else "of another size"


# Its tables, written a row at a time and whole or not at all.


def write_csv(path: Path, columns: Sequence[Column], rows: Iterable[Row]) -> None:
    """Write a table as CSV."""
    with _whole(path) as stream:
        text = io.TextIOWrapper(stream, "utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([csv_cell(column.head) for column in columns])
        writer.writerows(["" if cell is None else csv_cell(cell) for cell in row] for row in rows)
        text.flush()
        text.detach()


def has_parquet() -> bool:
    """Whether pyarrow is installed."""
    return find_spec("pyarrow") is not None


def write_parquet(path: Path, columns: Sequence[Column], rows: Iterable[Row]) -> None:
    """Write a table as Parquet, with units in the metadata of its columns."""
    pyarrow: Any = import_module("pyarrow")
    parquet: Any = import_module("pyarrow.parquet")
    types = {"whole": pyarrow.int64(), "number": pyarrow.float64(), "text": pyarrow.string()}
    schema = pyarrow.schema([
        pyarrow.field(column.head, types[column.form], metadata={"unit": column.unit} if column.unit else None)
        for column in columns
    ])  # fmt: skip
    with _whole(path) as stream, parquet.ParquetWriter(stream, schema, compression="zstd") as writer:
        rest = iter(rows)
        while group := list(islice(rest, _GROUP)):
            arrays = [pyarrow.array([row[n] for row in group], field.type) for n, field in enumerate(schema)]
            writer.write_table(pyarrow.table(arrays, schema=schema))


# Rows that those who compute them write themselves.


class Chunks(Store):
    """The rows of a study in files of Parquet, each with the points that its name says: together they are one table."""

    kind: Mapping[str, str] = {"rows": "chunks"}
    most_of_task = 1000

    def missing(self, points: int) -> list[NDArray[np.int64]]:
        """The same; a chunk has points one after the other."""
        (points_left,) = super().missing(points)
        return np.split(points_left, np.flatnonzero(np.diff(points_left) > 1) + 1)

    def computation(self, plan: Plan) -> Callable[[Job, Sequence[Variant]], Part]:
        """The function that computes a task and writes its rows."""
        return partial(into_chunk, folder=str(self.path.absolute()), columns=columns_of(plan), made_of=self.made_of)

    def _find(self) -> None:
        self.path = self.folder / "chunks"
        self.path.mkdir(exist_ok=True)
        remove_files(self.path.glob("*.part"))  # of a process that was killed while writing
        for file in self._files():
            first, last = map(int, file.stem.split("-"))
            self._grow(last + 1)
            self.places[first : last + 1] = first

    def _files(self) -> list[Path]:
        return sorted(self.path.glob("*-*.parquet"))

    def keep(self, part: Part) -> None:
        """Rows that a worker stored."""

    def write(
        self, columns: Sequence[Column], counted: Iterable[Row], rows: Callable[[], Iterable[Row]]
    ) -> tuple[list[Path], list[str]]:
        """The table is there; its rows are counted."""
        deque(counted, maxlen=0)
        return [self.path], []

    def every_row(self, points: int | None = None) -> Iterator[Row]:
        """The rows of the first so many points in the order of their variants, as far as they are known."""
        parquet: Any = import_module("pyarrow.parquet")
        for file in self._files():
            if points is None or int(file.stem.split("-")[0]) < points:
                yield from map(list, zip(*parquet.read_table(file).to_pydict().values(), strict=True))


def into_chunk(
    job: Job, variants: Sequence[Variant], *, folder: str, columns: Sequence[Column], made_of: Mapping[str, str]
) -> Part:
    """Rows of some variants, of points one after the other, as a file of their own; none are given back."""
    part, of_each = rows_of(job, variants), len(job.catalogs) * len(job.objectives)
    refuse_others(made_of, part)
    first, last = ((variants[n].number - 1) // of_each for n in (0, -1))
    write_parquet(Path(folder) / f"{first:08d}-{last:08d}.parquet", columns, part.rows)
    return part._replace(rows=[])


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
