"""A study's table as CSV and as Parquet, written a chunk at a time and whole or not at all.

CSV has units in its heads, as every table of this program. Parquet has the same heads, and each column's unit in its
metadata; it needs pyarrow.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, BinaryIO

from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready
from drivesizer.output.cells import csv_cell
from drivesizer.study.column import Column, Row

__all__ = ["has_parquet", "write_csv", "write_parquet"]

_GROUP = 50_000  # least number of rows that are written together to Parquet


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
        for rows in _grouped(chunks):
            arrays = [pyarrow.array([row[n] for row in rows], field.type) for n, field in enumerate(schema)]
            writer.write_table(pyarrow.table(arrays, schema=schema))


def _grouped(chunks: Iterable[list[Row]]) -> Iterator[list[Row]]:
    """Rows of several chunks together, so that a file has few row groups."""
    group: list[Row] = []
    for rows in chunks:
        group += rows
        if len(group) >= _GROUP:
            yield group
            group = []
    if group:
        yield group


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
