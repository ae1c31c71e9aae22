"""Recordings: CSV files with a header, a row of units and then numbers, read strictly into SI columns."""

from __future__ import annotations

import csv
import math
from array import array
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import missing, read_text
from drivesizer.units import KINDS, noun, possible, scale
from drivesizer.units.ranges import RANGES

__all__ = [
    "Form", "beside", "columns", "factors_of", "miscount", "number_of", "plain_number", "refuse_impossible", "rows_of",
    "values_of",
]  # fmt: skip

Form = Mapping[str, str]  # name of each column -> kind of its quantity

_NUMBERS = ("0.5", "1.2", "0.3", "4.5")  # of a row that is shown as an example
_MOST_ROWS = 1_000_000
_ABOVE = 3  # line of the first row of numbers


def beside(spec_file: str, name: str, where: str) -> Path:
    """The path to a file that a spec names: relative ones count from the spec's folder.

    Raises
    ------
    InputError
        When there is none: says where the spec names it.
    """
    path = Path(spec_file).parent / name if spec_file else Path(name)
    if reason := missing(path):
        said = "expected a CSV file, its path from the spec's folder, e.g. cycle.csv"
        raise InputError(f"{where}: {quoted(name)} cannot be read ({reason}); {said}")
    return path


def columns(path: Path, *forms: Form) -> dict[str, NDArray[np.float64]]:
    """The columns of a recording, in SI units, times rising.

    Parameters
    ----------
    path
        A CSV file in UTF-8: a header, a row of units such as ``s,m/s``, then the numbers.
    forms
        What columns the file may have, in any order; one of each form is ``time``.

    Returns
    -------
    dict
        By name, in the order of the form that the file has.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
    text = read_text(path)
    rows = rows_of(path, text, len(forms[0]))
    header, form = _header(path, next(rows, None), forms)
    factors = factors_of(path, header, form, next(rows, None))
    values = values_of(path, rows, header, factors, float if text.isascii() and "_" not in text else plain_number)
    refuse_impossible(path, values, header, form, factors)
    return {name: values[:, header.index(name)].copy() for name in form}


def refuse_impossible(
    path: Path, values: NDArray[np.float64], header: list[str], form: Form, factors: list[float]
) -> None:
    """Refuse a figure beyond what machines have; however small ones are steps towards 0.

    Raises
    ------
    InputError
        File, line, column, what was found and what is expected.
    """
    most = np.array([RANGES[form[name]][1] for name in header])
    if not (np.abs(values) <= most).all():
        row, place = (int(k[0]) for k in np.nonzero(np.abs(values) > most))
        kind, found = form[header[place]], values[row, place] / factors[place]
        said = f'"{found:g}" is no {noun(kind)} of a machine; {possible(kind)}'
        raise InputError(f"{path}:{row + _ABOVE}: {header[place]}: {said}")


def _example(width: int) -> str:
    return ",".join(_NUMBERS[:width])


def rows_of(path: Path, text: str, width: int) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row; blank lines at the end are left out.

    Parameters
    ----------
    path, text
        The file's name, for messages, and its content.
    width
        Columns of the example that messages show.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
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
    """The names of the columns as they stand, and the form that has them."""
    line, cells = row or (1, [])
    names = [cell.strip().lower() for cell in cells]
    for form in forms:
        if sorted(names) == sorted(form):
            return names, form
    shown = quoted(",".join(cells)) if cells else "nothing"
    expected = " or ".join(",".join(form) for form in forms)
    raise InputError(f"{path}:{line}: header: {shown}; expected {expected}")


def factors_of(path: Path, header: list[str], form: Form, row: tuple[int, list[str]] | None) -> list[float]:
    """What brings the columns to SI, from the row of units.

    Parameters
    ----------
    path
        The file's name, for messages.
    header, form
        Names of the columns, and the kind of each one's quantity.
    row
        Line number and cells of the row of units; None where the file ends before.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
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


def plain_number(cell: str) -> float:
    """The number in a cell; what else float() takes (underscores, digits of other scripts) is NaN."""
    return float(cell) if cell.isascii() and "_" not in cell else math.nan


def values_of(
    path: Path,
    rows: Iterator[tuple[int, list[str]]],
    header: list[str],
    factors: list[float],
    convert: Callable[[str], float],
) -> NDArray[np.float64]:
    """The numbers in SI, a row each; their times rise.

    Parameters
    ----------
    path
        The file's name, for messages.
    rows
        Line number and cells of each row below the units.
    header, factors
        Names of the columns, and what brings them to SI.
    convert
        What makes a number of a cell: ``float``, or ``plain_number`` of a file that may hold what that should not take.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
    width, at = len(header), header.index("time")
    found, before = array("d"), -math.inf
    for count, (line, cells) in enumerate(rows):
        if len(cells) != width:
            raise InputError(f"{path}:{line}: row: {miscount(cells, header)}, e.g. {_example(width)}")
        try:
            values = [convert(cell) * factor for cell, factor in zip(cells, factors, strict=True)]
        except ValueError:
            values = [math.nan]
        if not math.isfinite(sum(values)):  # a finite sum has finite parts
            values = [number_of(path, line, *given) for given in zip(header, cells, factors, strict=True)]
        if not values[at] > before:
            shown = quoted(cells[at])
            raise InputError(f"{path}:{line}: time: {shown} is not after the row before; expected rising times")
        if count == _MOST_ROWS:
            raise InputError(f"{path}:{line}: row: more than {_MOST_ROWS} rows; expected a thinned recording")
        before = values[at]
        found.extend(values)
    if len(found) < 2 * width:
        few = f"{len(found) // width} found; expected at least 2 below the units, e.g. {_example(width)}"
        raise InputError(f"{path}: rows: {few}")
    return np.frombuffer(found).reshape(-1, width)


def number_of(path: Path, line: int, column: str, cell: str, factor: float) -> float:
    """The finite number in a cell, in SI.

    Raises
    ------
    InputError
        When there is none: says where.
    """
    try:
        value = plain_number(cell) * factor
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path}:{line}: {column}: {quoted(cell)} is not a finite number; expected e.g. 1.25")
    return value


def miscount(cells: list[str], header: list[str]) -> str:
    """What is wrong with a row that has more or fewer cells than the header, in words."""
    text, width = quoted(",".join(cells)), len(header)
    if len(cells) > width or (len(cells) == 1 and ";" in cells[0]):
        return (
            f"{text} has {len(cells)} columns; a decimal comma or a semicolon does not separate numbers here; "
            f"expected {','.join(header)}"
        )
    return f"{text} has {len(cells)} of {width} columns; expected {','.join(header)}"
