"""Reader of recordings and tables of numbers, to columns in SI.

CSV with a header, a row of units and then numbers is read as it is, fast. A file as loggers and spreadsheets write it
(other separators, a decimal comma, ``torque [N*m]``, further columns) is brought to that form by ``files.sheets``.
"""

from __future__ import annotations

import csv
import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.files.sheets import decimal_sign, figure, plain_head, sheets, split_head, unit_of
from drivesizer.files.text import missing, plain_number, read_text
from drivesizer.units import KINDS, RANGES, noun, possible, scale

Array = NDArray[np.float64]
Form = Mapping[str, str]  # name of each column -> kind of its quantity

_PLAIN = str.maketrans("", "", "0123456789+-.eE, \r\n")  # of numbers that need no closer look
_MOST_ROWS = 1_000_000
_ROW = 64  # bytes of each that a file may have
_ABOVE = 3  # line of the first row of numbers
_MEANINGS = {  # of heads of recordings
    "time": ("time", "t", "timestamp", "zeit", "elapsed time"),
    "speed": ("speed", "velocity", "angular velocity", "omega", "w", "v", "n", "drehzahl", "geschwindigkeit", "vel"),
    "torque": ("torque", "tau", "m", "moment", "drehmoment", "load torque", "effort"),
    "position": ("position", "pos", "x", "s", "weg"),
    "angle": ("angle", "theta", "phi", "winkel", "position", "pos"),
}


class LeftOutWarning(UserWarning):
    """Columns of a recording that nobody takes."""


def path_from_spec(
    spec_file: str, name: str, field: tuple[str | int, ...], what: str = "a CSV file", example: str = "cycle.csv"
) -> Path:
    """Path of a file that a field of a spec names; relative ones count from the spec's folder."""
    path = Path(spec_file).parent / name if spec_file else Path(name)
    if reason := missing(path):
        expected = f"expected {what}, its path from the spec's folder, e.g. {example}"
        raise FieldError(field, f"{quoted(name)} cannot be read ({reason}); {expected}")
    return path


class CsvFile:
    """A CSV file, or one brought to its form: its header, and its rows with their lines."""

    def __init__(
        self, path: Path, width: int, most: int | None = None, rows: Iterator[tuple[int, list[str]]] | None = None
    ) -> None:
        self.path, self.most = path, _MOST_ROWS if most is None else most
        self.text = "" if rows else read_text(path, self.most * _ROW)
        self.example = "e.g. " + ",".join(("0.5", "1.2", "0.3", "4.5")[:width])  # of a row
        self.rows = rows or self._rows()
        self.line, self.cells = next(self.rows, (1, []))  # of the header
        self.names = [cell.strip() for cell in self.cells]

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line and cells of each row; blank lines at the end are left out."""
        reader, blank = csv.reader(self._lines(), strict=True), 0
        try:
            for cells in reader:
                if not cells:
                    blank = blank or reader.line_num
                    continue
                if blank:
                    raise self.fault(blank, "row", f"a blank line; expected rows without gaps, {self.example}")
                yield reader.line_num, cells
        except csv.Error as error:
            raise self.fault(reader.line_num, "row", f"{error}; expected {self.example}") from None

    def _lines(self) -> Iterator[str]:
        """Line by line: of ten million rows the first two may be enough."""
        at = 0
        while at < len(self.text):
            end = self.text.find("\n", at) + 1 or len(self.text)
            yield from self.text[at:end].splitlines()
            at = end

    def fault(self, line: int, what: str, said: str) -> InputError:
        """Fault of a line, as a user reads it."""
        return InputError(f"{self.path}:{line}: {what}: {said}")

    def factors(self, names: Sequence[str], form: Form) -> list[float]:
        """Factors that convert the columns to SI, from the row of units."""
        example = ",".join(KINDS[form[name]].si for name in names)
        line, cells = next(self.rows, (2, []))
        if len(cells) != len(names):
            found = quoted(",".join(cells))
            raise self.fault(line, "units", f"{found}; expected a unit per column, e.g. {example}")
        factors = []
        for name, cell in zip(names, cells, strict=True):
            try:
                factors.append(scale(cell.strip(), form[name])[0])
            except InputError as error:
                raise self.fault(line, name, f"{error}; the second row holds the units, e.g. {example}") from None
        return factors

    def values(self, names: Sequence[str], form: Form, factors: Sequence[float], rising: str = "time") -> list[Array]:
        """Columns of numbers in SI, one of them rising."""
        found = self._plain(factors, names.index(rising))
        if found is None:
            found = [column.copy() for column in np.array(self._numbers(names, factors, rising)).T]
        most = [RANGES[form[name]][1] for name in names]  # small ones are steps towards 0
        beyond = [k for k, column in enumerate(found) if np.abs(column).max(initial=0.0) > most[k]]
        if beyond:
            row, k = min((int((np.abs(found[k]) > most[k]).argmax()), k) for k in beyond)
            kind, shown = form[names[k]], found[k][row] / factors[k]
            said = f'"{shown:g}" is no {noun(kind)} of a machine; {possible(kind)}'
            raise self.fault(row + _ABOVE, names[k], said)
        return found

    def _plain(self, factors: Sequence[float], rising: int) -> list[Array] | None:
        """The numbers where all rows are plain ones, with the same bits; None where anything needs a closer look."""
        below = self.text.find("\n", self.text.find("\n") + 1) + 1
        head, body = self.text[:below], self.text[below:]
        lines = body.count("\n") + (not body.endswith("\n"))
        odd = not head.isascii() or '"' in head or len(head.splitlines()) != 2 or not body.isascii()
        if odd or not 2 <= lines <= self.most or not body.strip() or body.translate(_PLAIN):
            return None
        try:
            found = np.loadtxt(StringIO(body), delimiter=",", comments=None, ndmin=2)
        except ValueError:
            return None
        if found.shape != (lines, len(factors)):  # a blank line was left out
            return None
        with np.errstate(over="ignore"):  # beyond all numbers is not finite: looked at more closely
            columns = [column * factor for column, factor in zip(found.T, factors, strict=True)]
        right = all(np.isfinite(column).all() for column in columns) and np.diff(columns[rising]).min() > 0.0
        return columns if right else None

    def _numbers(self, names: Sequence[str], factors: Sequence[float], rising: str) -> list[list[float]]:
        """Rows of numbers in SI, each looked at."""
        time, found, before = names.index(rising), list[list[float]](), -math.inf
        for line, cells in self.rows:
            self.refuse_miscount(line, cells, names, f", {self.example}")
            found.append([self.number(line, *cell) for cell in zip(names, cells, factors, strict=True)])
            if not found[-1][time] > before:
                said = f"{quoted(cells[time])} is not after the row before; expected rising {rising}s"
                raise self.fault(line, rising, said)
            if len(found) > self.most:
                raise self.fault(line, "row", f"more than {self.most} rows; expected a thinned recording")
            before = found[-1][time]
        if len(found) < 2:
            few = f"{len(found)} found; expected at least 2 below the units, {self.example}"
            raise InputError(f"{self.path}: rows: {few}")
        return found

    def number(self, line: int, column: str, cell: str, factor: float) -> float:
        """The finite number in a cell, in SI."""
        value = plain_number(cell) * factor
        if not math.isfinite(value):
            raise self.fault(line, column, f"{quoted(cell)} is not a finite number; expected e.g. 1.25")
        return value

    def refuse_miscount(self, line: int, cells: Sequence[str], names: Sequence[str], example: str = "") -> None:
        """Refuse a row that has more or fewer cells than the header."""
        if len(cells) == len(names):
            return
        found = f"has {len(cells)} of {len(names)} columns"
        if len(cells) > len(names) or (len(cells) == 1 and ";" in cells[0]):
            comma = "a decimal comma or a semicolon does not separate numbers here"
            found = f"has {len(cells)} columns; {comma}"
        raise self.fault(line, "row", f"{quoted(','.join(cells))} {found}; expected {','.join(names)}{example}")


def columns(path: Path, *forms: Form, most: int | None = None) -> dict[str, Array]:
    """Columns of a recording in SI, with rising times, or of a table with a first column that rises."""
    most = _MOST_ROWS if most is None else most
    try:
        sheet = CsvFile(path, len(forms[0]), most)
        names = [name.lower() for name in sheet.names]
        form = next((form for form in forms if sorted(form) == sorted(names)), None)
        if form is None:
            shown = quoted(",".join(sheet.cells)) if sheet.cells else "nothing"
            expected = f"{shown}; expected {' or '.join(','.join(form) for form in forms)}"
            raise sheet.fault(sheet.line, "header", expected)
    except InputError as error:
        logged = _logged(path, forms, most)
        if logged is None:
            raise error from None
        sheet, form, factors = logged
        names = sheet.names
    else:
        factors = sheet.factors(names, form)
    rising = "time" if "time" in form else next(iter(form))
    found = sheet.values(names, form, factors, rising)
    return {name: found[names.index(name)] for name in form}


def _logged(path: Path, forms: Sequence[Form], most: int) -> tuple[CsvFile, Form, list[float]] | None:
    """A recording as loggers and spreadsheets write it, as a sheet of plain numbers; None where it is none."""
    try:
        table = max(sheets(path, most * _ROW), key=lambda one: len(one.rows))
    except InputError:
        return None
    rows = [(line, cells) for line, cells in table.rows if any(cells)]
    head = next((place for place, (_, cells) in enumerate(rows[:20]) if _meant(cells, forms)), None)
    if head is None:
        return None
    line, cells = rows[head]
    form, at = _meant(cells, forms)[0]
    units = [unit for _, unit in map(split_head, cells)]
    below = rows[head + 1][1] if head + 1 < len(rows) else []
    own = [unit_of(cell) for cell in below]
    has_units = any(own) and not any(cell and not unit for cell, unit in zip(below, own, strict=True))
    factors = []
    for name in form:
        unit = units[at[name]] or (own[at[name]] if has_units else "")
        try:
            factors.append(scale(unit, form[name])[0])
        except InputError as error:
            shown = f"{error}" if unit else "has no unit"
            example = f"expected e.g. {name} [{KINDS[form[name]].si}], or a row of units below the header"
            raise InputError(f"{path}:{line}: {cells[at[name]]}: {shown}; {example}") from None
    left_out = [cell for k, cell in enumerate(cells) if cell and k not in {at[name] for name in form}]
    if left_out:
        warnings.warn(f"{path}: columns left out: {', '.join(left_out)}", LeftOutWarning, stacklevel=2)
    numbers = rows[head + 1 + has_units :]
    decimal = decimal_sign([cell for _, some in numbers[:500] for cell in some], table.separator)
    taken = {name: at[name] for name in form}
    plain = ((number, _plain_cells(path, number, some, taken, decimal)) for number, some in numbers)
    return CsvFile(path, len(form), most, chain([(line, list(form))], plain)), form, factors


def _meant(cells: Sequence[str], forms: Sequence[Form]) -> list[tuple[Form, dict[str, int]]]:
    """The form that heads mean, with the place of each column; empty where none or more than one is meant."""
    heads, found = [plain_head(split_head(cell)[0]) for cell in cells], list[tuple[Form, dict[str, int]]]()
    for form in forms:
        at = {name: k for name in form for k, head in enumerate(heads) if head in (name, *_MEANINGS.get(name, ()))}
        if len(at) == len(form) == len(set(at.values())):
            found.append((form, at))
    return found if len({frozenset(at.values()) for _, at in found}) == 1 else []


def _plain_cells(path: Path, line: int, cells: Sequence[str], taken: Mapping[str, int], decimal: str) -> list[str]:
    """The cells of a row that are taken, with decimal points."""
    if len(cells) <= max(taken.values()):
        raise InputError(f"{path}:{line}: row: {len(cells)} cells; the header has more")
    found = []
    for name, place in taken.items():
        try:
            found.append(figure(cells[place], decimal)[0] if decimal == "," else cells[place])
        except InputError as error:
            said = error if cells[place] else "the cell is empty"
            raise InputError(f"{path}:{line}: {name}: {said}; expected a number in each row") from None
    return found
