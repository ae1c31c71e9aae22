"""Reader of CSV files with a header, a row of units and then numbers: strict, to columns in SI."""

from __future__ import annotations

import codecs
import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import decoded, missing, read_bytes
from drivesizer.units import KINDS, noun, possible, scale
from drivesizer.units.kinds import RANGES

Array = NDArray[np.float64]
_PLAIN = b"0123456789+-.eE, \r\n"  # of numbers that need no closer look


def plain_columns(text: bytes, below: int, rising: int, factors: list[float], most: int) -> list[Array] | None:
    """Numbers of a text in SI, where all rows are plain ones; None where anything needs a closer look.

    The same bits as those of ``values_of``, which says what is wrong and where.
    """
    body = text[below:]
    lines = body.count(b"\n") + (not body.endswith(b"\n"))
    if not 2 <= lines <= most or not body.strip() or body.translate(None, _PLAIN):
        return None
    try:
        found = np.loadtxt(StringIO(body.decode("ascii")), delimiter=",", comments=None, ndmin=2)
    except ValueError:
        return None
    if found.shape != (lines, len(factors)):  # a blank line was left out
        return None
    with np.errstate(over="ignore"):  # beyond all numbers is not finite: looked at more closely
        columns = [column * factor for column, factor in zip(found.T, factors, strict=True)]
    right = all(np.isfinite(column).all() for column in columns) and np.diff(columns[rising]).min() > 0.0
    return columns if right else None


Form = Mapping[str, str]  # name of each column -> kind of its quantity

_NUMBERS = ("0.5", "1.2", "0.3", "4.5")  # of a row that is shown as an example
_MOST_ROWS = 1_000_000
_ROW = 64  # bytes of each that a file may have
_ABOVE = 3  # line of the first row of numbers


def path_from_spec(spec_file: str, name: str, where: str) -> Path:
    """Path of a file that a spec names; relative ones count from the spec's folder."""
    path = Path(spec_file).parent / name if spec_file else Path(name)
    if reason := missing(path):
        expected = "expected a CSV file, its path from the spec's folder, e.g. cycle.csv"
        raise InputError(f"{where}: {quoted(name)} cannot be read ({reason}); {expected}")
    return path


def columns(path: Path, *forms: Form, most: int | None = None) -> dict[str, NDArray[np.float64]]:
    """Columns of a recording in SI, with rising times, or of a table with a first column that rises."""
    most = _MOST_ROWS if most is None else most
    raw = read_bytes(path, most * _ROW)
    below = raw.find(b"\n", raw.find(b"\n") + 1) + 1
    head = raw[:below]
    text = head.removeprefix(codecs.BOM_UTF8)  # two lines without quotes, else a closer look says where the rows begin
    plain = below and text.isascii() and b'"' not in text and len(text.decode("ascii").splitlines()) == 2
    rows = rows_of(path, decoded(head if plain else raw, path), len(forms[0]))
    header, form = _header(path, next(rows, None), forms)
    factors = factors_of(path, header, form, next(rows, None))
    rising = "time" if "time" in form else next(iter(form))
    found = plain_columns(raw, below, header.index(rising), factors, most) if plain else None
    if found is None:
        rows = islice(rows_of(path, decoded(raw, path), len(forms[0])), 2, None)
        found = [column.copy() for column in values_of(path, rows, header, factors, rising, most).T]
    refuse_impossible(path, found, header, form, factors)
    return {name: found[header.index(name)] for name in form}


def refuse_impossible(
    path: Path, values: Sequence[NDArray[np.float64]], header: list[str], form: Form, factors: list[float]
) -> None:
    """Refuse figures above the range of their kind; arbitrarily small ones are allowed as steps towards 0."""
    most = [RANGES[form[name]][1] for name in header]
    beyond = [k for k, values_of_one in enumerate(values) if np.abs(values_of_one).max(initial=0.0) > most[k]]
    if beyond:
        row, column = min((int((np.abs(values[k]) > most[k]).argmax()), k) for k in beyond)
        kind, found = form[header[column]], values[column][row] / factors[column]
        reason = f'"{found:g}" is no {noun(kind)} of a machine; {possible(kind)}'
        raise InputError(f"{path}:{row + _ABOVE}: {header[column]}: {reason}")


def _example(width: int) -> str:
    return ",".join(_NUMBERS[:width])


def rows_of(path: Path, text: str, width: int) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row; blank lines at the end are left out."""
    reader = csv.reader(text.splitlines(), strict=True)
    blank, example = 0, f"e.g. {_example(width)}"
    try:
        for cells in reader:
            if not cells:
                blank = blank or reader.line_num
                continue
            if blank:
                raise InputError(f"{path}:{blank}: row: a blank line; expected rows without gaps, {example}")
            yield reader.line_num, cells
    except csv.Error as error:
        raise InputError(f"{path}:{reader.line_num}: row: {error}; expected {example}") from None


def _header(path: Path, row: tuple[int, list[str]] | None, forms: tuple[Form, ...]) -> tuple[list[str], Form]:
    """Names of the columns in the file's order, and the form that has them."""
    line, cells = row or (1, [])
    names = [cell.strip().lower() for cell in cells]
    for form in forms:
        if sorted(names) == sorted(form):
            return names, form
    shown = quoted(",".join(cells)) if cells else "nothing"
    expected = " or ".join(",".join(form) for form in forms)
    raise InputError(f"{path}:{line}: header: {shown}; expected {expected}")


def factors_of(path: Path, header: list[str], form: Form, row: tuple[int, list[str]] | None) -> list[float]:
    """Factors that convert the columns to SI, from the row of units."""
    example = ",".join(KINDS[form[name]].si for name in header)
    line, cells = row or (2, [])
    if len(cells) != len(header):
        raise InputError(f"{path}:{line}: units: {quoted(','.join(cells))}; expected a unit per column, e.g. {example}")
    factors = []
    for name, cell in zip(header, cells, strict=True):
        try:
            factors.append(scale(cell.strip(), form[name])[0])
        except InputError as error:
            raise InputError(
                f"{path}:{line}: {name}: {error}; the second row holds the units, e.g. {example}"
            ) from None
    return factors


def values_of(
    path: Path,
    rows: Iterator[tuple[int, list[str]]],
    header: list[str],
    factors: list[float],
    rising: str = "time",
    most: int = _MOST_ROWS,
) -> NDArray[np.float64]:
    """Numbers in SI, those of one column rising."""
    width, time = len(header), header.index(rising)
    found, before = list[list[float]](), -math.inf
    for line, cells in rows:
        if len(cells) != width:
            raise InputError(f"{path}:{line}: row: {miscount(cells, header)}, e.g. {_example(width)}")
        found.append([number_of(path, line, *cell) for cell in zip(header, cells, factors, strict=True)])
        if not found[-1][time] > before:
            shown = quoted(cells[time])
            raise InputError(f"{path}:{line}: {rising}: {shown} is not after the row before; expected rising {rising}s")
        if len(found) > most:
            raise InputError(f"{path}:{line}: row: more than {most} rows; expected a thinned recording")
        before = found[-1][time]
    if len(found) < 2:
        few = f"{len(found)} found; expected at least 2 below the units, e.g. {_example(width)}"
        raise InputError(f"{path}: rows: {few}")
    return np.array(found)


def number_of(path: Path, line: int, column: str, cell: str, factor: float) -> float:
    """The finite number in a cell, in SI; float() would take underscores and digits of other scripts too."""
    try:
        value = float(cell) * factor if cell.isascii() and "_" not in cell else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path}:{line}: {column}: {quoted(cell)} is not a finite number; expected e.g. 1.25")
    return value


def miscount(cells: list[str], header: list[str]) -> str:
    """Message for a row that has more or fewer cells than the header."""
    text, width = quoted(",".join(cells)), len(header)
    if len(cells) > width or (len(cells) == 1 and ";" in cells[0]):
        return (
            f"{text} has {len(cells)} columns; a decimal comma or a semicolon does not separate numbers here; "
            f"expected {','.join(header)}"
        )
    return f"{text} has {len(cells)} of {width} columns; expected {','.join(header)}"
