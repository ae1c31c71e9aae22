"""Tables as people have them: cells of text out of CSV, workbooks, data sheets, JSON, Klipper, MJCF; columns in SI."""

from __future__ import annotations

import codecs
import configparser
import csv
import io
import json
import math
import re
import unicodedata
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.files.text import missing, plain_number, read_bytes, read_text
from drivesizer.units import KINDS, RANGES, kind_of_unit, noun, number, possible, scale

_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"),
          (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))  # fmt: skip
_SEPARATORS = ",;\t|"
_DASHES = frozenset({"-", "–", "—", "−", "~", "n/a", "N/A"})  # cells of a data sheet without a figure
_MOST_CELLS = 5_000_000
_KLIPPER = {"resistance": "ohm", "inductance": "H", "holding_torque": "N*m", "max_current": "A"}
_MJCF = {"resistance": "ohm", "inductance": "H", "motorconst": "N*m/A", "armature": "kg*m^2"}


_SPELLINGS = {  # of units, beside those of their reader
    "VDC": "V", "V DC": "V", "Vdc": "V", "VAC": "V", "Volt": "V", "Volts": "V", "volts": "V", "Amp": "A", "Amps": "A",
    "amps": "A", "Arms": "A", "A rms": "A", "A(rms)": "A", "ADC": "A", "Apk": "A", "Ohms": "ohm", "Watt": "W",
    "Watts": "W", "watts": "W", "Newton meters": "N*m", "kg.cm": "kgf*cm", "grams": "g",
}  # fmt: skip


class Sheet(NamedTuple):
    """One table of a file: its name where the file has several, and its rows, each with its line."""

    name: str
    rows: list[tuple[int, list[str]]]
    separator: str = ""  # of a text file; a space, where it is the lines of a data sheet


def sheets(path: Path, largest: int = 64_000_000) -> list[Sheet]:
    """All tables of a file, cells as printed; the content decides what the file is, then its suffix."""
    return tables_of(read_bytes(path, largest), path)


def tables_of(raw: bytes, path: Path) -> list[Sheet]:
    """All tables of a content, as of :func:`sheets` of the file."""
    if raw.startswith(b"PK\x03\x04"):
        return _workbook(raw, path)
    if raw.startswith(b"%PDF"):
        return _pages(raw, path)
    if raw.startswith(b"\xd0\xcf\x11\xe0"):
        raise InputError(f"{path}: is a workbook of the old form; save it as .xlsx or CSV")
    text = as_text(raw, path)
    if path.suffix == ".json":
        return _records(text, path)
    if path.suffix == ".cfg":
        return _klipper(text, path)
    if path.suffix in (".xml", ".mjcf"):
        return _mjcf(text, path)
    return [_separated(text, path)]


def as_text(raw: bytes, path: Path) -> str:
    r"""A file's text by its mark, as UTF-8 or UTF-16, else as what spreadsheets of the West write.

    >>> as_text("Länge".encode("cp1252"), Path("a.csv")), as_text("a;b".encode("utf-16-le"), Path("a.csv"))
    ('Länge', 'a;b')
    """
    code = next((code for mark, code in _MARKS if raw.startswith(mark)), "")
    if not code and b"\0" in raw[:400]:
        code = "utf-16-le" if raw[1:400:2].count(0) > raw[0:400:2].count(0) else "utf-16-be"
    for encoding in (code,) if code else ("utf-8", "cp1252"):
        try:
            text = raw.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise InputError(f"{path}: is no text; expected CSV in UTF-8, UTF-16 or cp1252, XLSX, PDF or JSON")


def _separated(text: str, path: Path) -> Sheet:
    """Rows by the separator by which most lines have equally many cells; without one the lines of a data sheet."""
    lines, best = text.splitlines(), ("", 0.0)
    if lines and (stated := re.fullmatch(r"sep=(.)", lines[0])):  # as spreadsheets write it above the header
        return Sheet("", _csv("\n" + "\n".join(lines[1:]), stated.group(1), path), stated.group(1))
    for separator in _SEPARATORS:
        widths = Counter(len(cells) for cells in csv.reader(lines[:500], delimiter=separator) if any(cells))
        width, count = max(widths.items(), key=lambda pair: (pair[0] > 1, pair[1], pair[0]), default=(1, 0))
        if width > 1 and count / widths.total() > best[1]:
            best = separator, count / widths.total()
    if best[1] >= 0.5:
        return Sheet("", _csv(text, best[0], path), best[0])
    return Sheet("", [(at + 1, line_cells(line)) for at, line in enumerate(lines) if line.strip()], " ")


def _csv(text: str, separator: str, path: Path) -> list[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    try:
        return [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader]
    except csv.Error as error:
        raise InputError(
            f"{path}:{reader.line_num}: row: {error}; expected cells between {quoted(separator)}"
        ) from None


def line_cells(line: str) -> list[str]:
    """The cells of a line of a data sheet: what is printed, its unit, the values; else what wide gaps part.

    >>> line_cells("2 No load speed          rpm   4790  5500")
    ['2 No load speed', 'rpm', '4790', '5500']
    >>> line_cells("Rated voltage: 24 V"), line_cells("RE 25   Graphite brushes")
    (['Rated voltage', 'V', '24'], ['RE 25', '', 'Graphite brushes'])
    """
    wide = [cell for cell in re.split(r"\s{2,}|\t", line.strip()) if cell]
    words = [word for word in re.split(r"\s+|:\s", line.strip()) if word]
    last = len(words) - 1 if len(words) > 2 and _is_unit(words[-1]) and re.search(r"[0-9]", words[-2]) else len(words)
    first = last
    while first > 1 and (words[first - 1] in _DASHES or re.match(r"[<>≤≥±~]?[+-]?[0-9]", words[first - 1])):
        first -= 1
    if first == last:
        return [wide[0], "", *wide[1:]]
    values, unit = words[first:last], words[last] if last < len(words) else ""
    if not unit and first > 1 and _is_unit(words[first - 1]):
        first, unit = first - 1, words[first - 1]
    printed = " ".join(values)  # 9 560 is one figure where gaps between figures are wide
    ends = [wide[at:-1] if wide[-1] == unit else wide[at:] for at in range(1, len(wide))]
    values = next((end for end in ends if end and " ".join(end) == printed and len(end) < len(values)), values)
    return [" ".join(words[:first]).rstrip(":"), unit, *values]


def _is_unit(word: str) -> bool:
    return kind_of_unit(word.strip("[]()")) is not None


def _library(name: str, path: Path) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(f"{path}: needs {name}: pip install 'drivesizer[parts]'; or save it as CSV") from None


def _workbook(raw: bytes, path: Path) -> list[Sheet]:
    openpyxl, tables, cells = _library("openpyxl", path), [], 0
    try:
        book = openpyxl.load_workbook(io.BytesIO(raw), read_only=True, data_only=True)
        for sheet in book.worksheets:
            rows = []
            for at, row in enumerate(sheet.iter_rows(values_only=True), 1):
                cells += len(row)
                if cells > _MOST_CELLS:
                    raise InputError(f"{path}: more than {_MOST_CELLS} cells; keep the table of parts alone")
                if any(cell is not None for cell in row):
                    rows.append((at, ["" if cell is None else _printed(cell) for cell in row]))
            tables.append(Sheet(sheet.title, rows))
    except InputError:
        raise
    except Exception as error:  # whatever a damaged archive raises
        raise InputError(f"{path}: cannot be read as a workbook ({type(error).__name__}); save it as CSV") from None
    return tables


def _printed(value: Any) -> str:
    """A cell as text; a whole number without its point."""
    if isinstance(value, float):
        return f"{value:.15g}"
    return " ".join(str(value).split())


def _pages(raw: bytes, path: Path) -> list[Sheet]:
    pypdf = _library("pypdf", path)
    try:
        pages = pypdf.PdfReader(io.BytesIO(raw)).pages
        texts = [page.extract_text(extraction_mode="layout") for page in pages]
    except Exception as error:  # whatever a damaged document raises
        raise InputError(f"{path}: cannot be read as PDF ({type(error).__name__})") from None
    if not any(text.strip() for text in texts):
        raise InputError(f"{path}: the PDF has pictures and no text; type the figures into a table")
    tables = []
    for page, text in enumerate(texts, 1):
        rows = [(at, line_cells(line)) for at, line in enumerate(text.splitlines(), 1) if line.strip()]
        tables.append(Sheet(f"page {page}", rows, " "))
    return tables


def _records(text: str, path: Path) -> list[Sheet]:
    """A list of objects, or an object of them by name; a figure may be an object of number and unit."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON ({error})") from None
    if isinstance(data, dict) and not any(isinstance(value, dict) for value in data.values()):
        lists = [value for value in data.values() if isinstance(value, list) and value and isinstance(value[0], dict)]
        data = lists[0] if lists else [data]
    objects = [{"name": name} | record for name, record in data.items() if isinstance(record, dict)] \
        if isinstance(data, dict) else data  # fmt: skip
    if not isinstance(objects, list) or not objects or not all(isinstance(record, dict) for record in objects):
        raise InputError(f"{path}: expected a list of objects, one for each part")
    heads = list(dict.fromkeys(str(head) for record in objects for head in record))
    rows = [(at, [_figure(record.get(head)) for head in heads]) for at, record in enumerate(objects, 1)]
    return [
        Sheet(
            "",
            [(0, [re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", head) if head.isalnum() else head for head in heads]), *rows],
        )
    ]


def _figure(value: Any) -> str:
    if isinstance(value, dict):
        number = next((value[key] for key in ("magnitude", "value", "n", "number") if key in value), None)
        unit = next((value[key] for key in ("unit", "units", "s") if key in value), "")
        return "" if number is None else f"{_printed(number)} {unit}".strip()
    return "" if value is None or isinstance(value, list) else _printed(value)


def _table(parts: Iterator[tuple[int, dict[str, str]]], units: dict[str, str], path: Path, what: str) -> list[Sheet]:
    records = list(parts)
    heads = list(dict.fromkeys(head for _, record in records for head in record))
    if not records:
        raise InputError(f"{path}: {what} found")
    rows = [(at, [record.get(head, "") for head in heads]) for at, record in records]
    return [Sheet("", [(0, heads), (0, [units.get(head, "") for head in heads]), *rows])]


def _klipper(text: str, path: Path) -> list[Sheet]:
    """Sections ``[motor_constants NAME]``: ohm, H, N·m, A of amplitude; of a stepper."""
    reader = configparser.ConfigParser(strict=False, interpolation=None, inline_comment_prefixes=("#",))
    try:
        reader.read_string(text)
    except configparser.Error as error:
        raise InputError(f"{path}: {' '.join(str(error).split())}") from None
    named = (name for name in reader.sections() if name.startswith("motor_constants "))
    parts = ((0, {"part": name.partition(" ")[2], **reader[name]}) for name in named)
    return _table(parts, _KLIPPER, path, "no section [motor_constants NAME]")


def _mjcf(text: str, path: Path) -> list[Sheet]:
    """Elements ``dcmotor`` of an MJCF, in SI."""
    try:
        root = ElementTree.fromstring(text)  # noqa: S314  expat bounds what entities may grow to
    except ElementTree.ParseError as error:
        raise InputError(f"{path}: is not XML ({error})") from None
    parts = ((0, {"part": motor.get("name", f"motor {at}"), **{k: v for k, v in motor.attrib.items() if k in _MJCF}})
             for at, motor in enumerate(root.iter("dcmotor"), 1))  # fmt: skip
    return _table(parts, _MJCF, path, "no <dcmotor>")


# -- Heads and figures of such tables.


def split_head(head: str) -> tuple[str, str]:
    """A head without its unit, and the unit.

    >>> split_head("Nominal voltage [V]"), split_head("free_speed_rpm"), split_head("Kt (N.m/A)")
    (('Nominal voltage', 'V'), ('free speed', 'rpm'), ('Kt', 'N*m/A'))
    """
    text = " ".join(head.split())
    for pattern in (r"(.+?)\s*\[([^\]]+)\]\W*", r"(.+?)\s*\(([^()]+(?:\([^()]*\))?)\)\W*", r"(.+?),\s*(\S+)",
                    r"(.+?)\s+/\s+(\S+)", r"(.+?)\s+in\s+(\S+)", r"(.+)[_ ]([^_\s]+)"):  # fmt: skip
        match = re.fullmatch(pattern, text)
        if match and (unit := unit_of(match.group(2), small="_" in text)):
            return match.group(1).replace("_", " ") if "_" in match.group(1) else match.group(1), unit
    return text, ""


def unit_of(text: str, small: bool = False) -> str:
    """A unit in the reader's spelling, empty where it is none; letters of a name such as ``torque_nm`` are small."""
    text = text.strip()
    for spelling in (text, _SPELLINGS.get(text, ""), re.sub(r"(?<=[A-Za-z])\.(?=[A-Za-z])", "*", text)):
        if spelling and (kind_of_unit(spelling) is not None or currency_of(spelling)):
            return spelling
    return {"nm": "N*m", "v": "V", "a": "A", "w": "W", "ma": "mA"}.get(text, "") if small else ""


def currency_of(unit: str) -> str:
    """Code of a currency, of its sign or of the code itself; empty where a unit is none."""
    signs = KINDS["price"].units.items()
    return next((code for code, others in signs if unit in (code, *others.split())), "")


def plain_head(text: str) -> str:
    """A head in small letters, without accents and marks, without what stands in brackets and the row's number.

    >>> plain_head("Max. continuous torque [mNm]"), plain_head("3 Trägheitsmoment"), plain_head("No load speed @ 12V")
    ('max continuous torque', 'tragheitsmoment', 'no load speed')
    """
    bare = re.sub(r"[\[(][^\])]*[\])]|\s(@|at|bei)\s.*|^\s*\d{1,2}\s+(?=\D)", "", text.casefold())
    ascii_only = unicodedata.normalize("NFKD", bare).encode("ascii", "ignore").decode()
    return (
        " ".join(re.sub(r"[^a-z0-9]+", " ", ascii_only).split())
        .replace("maximum ", "max ")
        .replace("maximale ", "max ")
    )


def decimal_sign(cells: Sequence[str], separator: str) -> str:
    """The sign before decimals in a table: what no other reading allows decides, then the separator.

    >>> decimal_sign(["24,5", "1.200"], ";"), decimal_sign(["24.5", "1,200"], ";"), decimal_sign(["1,200"], ",")
    (',', '.', '.')
    """
    text = " ; ".join(cells)
    commas = len(re.findall(r"(?<![\d.,])\d+,(?:\d{1,2}|\d{4,})(?![\d.,])|(?<![\d.,])0,\d+|\d\.\d{3},\d", text))
    points = len(re.findall(r"(?<![\d.,])\d+\.(?:\d{1,2}|\d{4,})(?![\d.,])|(?<![\d.,])0\.\d+|\d,\d{3}\.\d", text))
    if commas != points:
        return "," if commas > points else "."
    return "," if separator in (";", "\t") and re.search(r"\d,\d", text) else "."


_FIGURE = re.compile(
    r"(?:[<>≤≥≈~=±]|ca\.?|max\.?|min\.?|up to|bis|approx\.?)*\s*([€$£]|US\$)?\s*"
    r"([+-]?[0-9](?:[0-9.,']|\s(?=[0-9]{3}(?![0-9])))*(?:[eE][+-]?[0-9]+)?)"
    r"(?:\s*[x×·*]\s*10\^?([+-]?[0-9]+))?\s*(.*)"
)
_SMALL = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_SIGNS_OF_PRINT = str.maketrans("−\u00a0\u202f\u2009’", "-   '")


def figure(cell: str, decimal: str) -> tuple[str, str]:
    """The number of a cell, with a decimal point, and what follows it.

    >>> figure("1.234,5 min-1", ","), figure("1'200", "."), figure("≤ 0.5°", "."), figure("€ 12,50", ",")
    (('1234.5', 'min-1'), ('1200', ''), ('0.5', '°'), ('12.50', '€'))
    """
    powers = re.sub(r"(?<=10)[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+", lambda power: power.group().translate(_SMALL), cell)
    match = _FIGURE.fullmatch(powers.translate(_SIGNS_OF_PRINT).strip())
    if match is None:
        raise InputError(f"{quoted(cell)} does not start with a number")
    sign, digits, power, rest = match.groups()
    digits = re.sub(r"[\s']", "", digits).rstrip(".,")
    other = "." if decimal == "," else ","
    if other in digits:
        if not re.fullmatch(rf"[+-]?\d{{1,3}}(?:\{other}\d{{3}})+(?:\{decimal}\d*)?", digits):
            raise InputError(
                f"{quoted(cell)}: {quoted(other)} does not part thousands; decimals have {quoted(decimal)} here"
            )
        digits = digits.replace(other, "")
    digits = digits.replace(decimal, ".")
    number(digits)  # in the range of floats, written in one way
    return digits + (f"e{power}" if power else ""), (sign or rest).strip()


# -- Reader of recordings and tables of numbers, to columns in SI.
#
# CSV with a header, a row of units and then numbers is read as it is, fast. A file as loggers and spreadsheets write it
# (other separators, a decimal comma, ``torque [N*m]``, further columns) is brought to that form first.


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

    def fault(self, line: int, what: str, text: str) -> InputError:
        """Fault of a line, as a user reads it."""
        return InputError(f"{self.path}:{line}: {what}: {text}")

    def factors(self, names: Sequence[str], form: Form) -> list[float]:
        """Factors that convert the columns to SI, from the row of units."""
        example = ",".join(KINDS[form[name]].si for name in names)
        line, cells = next(self.rows, (2, []))
        if len(cells) != len(names):
            row = quoted(",".join(cells))
            raise self.fault(line, "units", f"{row}; expected a unit per column, e.g. {example}")
        factors = []
        for name, cell in zip(names, cells, strict=True):
            try:
                factors.append(scale(cell.strip(), form[name])[0])
            except InputError as error:
                raise self.fault(line, name, f"{error}; the second row holds the units, e.g. {example}") from None
        return factors

    def values(self, names: Sequence[str], form: Form, factors: Sequence[float], rising: str = "time") -> list[Array]:
        """Columns of numbers in SI, one of them rising."""
        columns = self._plain(factors, names.index(rising))
        if columns is None:
            columns = [column.copy() for column in np.array(self._numbers(names, factors, rising)).T]
        most = [RANGES[form[name]][1] for name in names]  # small ones are steps towards 0
        beyond = [k for k, column in enumerate(columns) if np.abs(column).max(initial=0.0) > most[k]]
        if beyond:
            row, k = min((int((np.abs(columns[k]) > most[k]).argmax()), k) for k in beyond)
            kind, value = form[names[k]], columns[k][row] / factors[k]
            text = f'"{value:g}" is no {noun(kind)} of a machine; {possible(kind)}'
            raise self.fault(row + _ABOVE, names[k], text)
        return columns

    def _plain(self, factors: Sequence[float], rising: int) -> list[Array] | None:
        """The numbers where all rows are plain ones, with the same bits; None where anything needs a closer look."""
        below = self.text.find("\n", self.text.find("\n") + 1) + 1
        head, body = self.text[:below], self.text[below:]
        lines = body.count("\n") + (not body.endswith("\n"))
        odd = not head.isascii() or '"' in head or len(head.splitlines()) != 2 or not body.isascii()
        if odd or not 2 <= lines <= self.most or not body.strip() or body.translate(_PLAIN):
            return None
        try:
            numbers = np.loadtxt(StringIO(body), delimiter=",", comments=None, ndmin=2)
        except ValueError:
            return None
        if numbers.shape != (lines, len(factors)):  # a blank line was left out
            return None
        with np.errstate(over="ignore"):  # beyond all numbers is not finite: looked at more closely
            columns = [column * factor for column, factor in zip(numbers.T, factors, strict=True)]
        right = all(np.isfinite(column).all() for column in columns) and np.diff(columns[rising]).min() > 0.0
        return columns if right else None

    def _numbers(self, names: Sequence[str], factors: Sequence[float], rising: str) -> list[list[float]]:
        """Rows of numbers in SI, each looked at."""
        time, rows, before = names.index(rising), list[list[float]](), -math.inf
        for line, cells in self.rows:
            self.refuse_miscount(line, cells, names, f", {self.example}")
            rows.append([self.number(line, *cell) for cell in zip(names, cells, factors, strict=True)])
            if not rows[-1][time] > before:
                text = f"{quoted(cells[time])} is not after the row before; expected rising {rising}s"
                raise self.fault(line, rising, text)
            if len(rows) > self.most:
                raise self.fault(line, "row", f"more than {self.most} rows; expected a thinned recording")
            before = rows[-1][time]
        if len(rows) < 2:
            few = f"{len(rows)} found; expected at least 2 below the units, {self.example}"
            raise InputError(f"{self.path}: rows: {few}")
        return rows

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
        text = f"has {len(cells)} of {len(names)} columns"
        if len(cells) > len(names) or (len(cells) == 1 and ";" in cells[0]):
            comma = "a decimal comma or a semicolon does not separate numbers here"
            text = f"has {len(cells)} columns; {comma}"
        raise self.fault(line, "row", f"{quoted(','.join(cells))} {text}; expected {','.join(names)}{example}")


def columns(path: Path, *forms: Form, most: int | None = None) -> dict[str, Array]:
    """Columns of a recording in SI, with rising times, or of a table with a first column that rises."""
    most = _MOST_ROWS if most is None else most
    try:
        sheet = CsvFile(path, len(forms[0]), most)
        names = [name.lower() for name in sheet.names]
        form = next((form for form in forms if sorted(form) == sorted(names)), None)
        if form is None:
            header = quoted(",".join(sheet.cells)) if sheet.cells else "nothing"
            expected = f"{header}; expected {' or '.join(','.join(form) for form in forms)}"
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
    values = sheet.values(names, form, factors, rising)
    return {name: values[names.index(name)] for name in form}


def _logged(path: Path, forms: Sequence[Form], most: int) -> tuple[CsvFile, Form, list[float]] | None:
    """A recording as loggers and spreadsheets write it, as a sheet of plain numbers; None where it is none."""
    try:
        table = max(sheets(path, most * _ROW), key=lambda sheet: len(sheet.rows))
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
            fault = f"{error}" if unit else "has no unit"
            example = f"expected e.g. {name} [{KINDS[form[name]].si}], or a row of units below the header"
            raise InputError(f"{path}:{line}: {cells[at[name]]}: {fault}; {example}") from None
    left_out = [cell for k, cell in enumerate(cells) if cell and k not in {at[name] for name in form}]
    if left_out:
        warnings.warn(f"{path}: columns left out: {', '.join(left_out)}", LeftOutWarning, stacklevel=2)
    numbers = rows[head + 1 + has_units :]
    decimal = decimal_sign([cell for _, cells in numbers[:500] for cell in cells], table.separator)
    places = {name: at[name] for name in form}
    plain = ((number, _plain_cells(path, number, cells, places, decimal)) for number, cells in numbers)
    return CsvFile(path, len(form), most, chain([(line, list(form))], plain)), form, factors


def _meant(cells: Sequence[str], forms: Sequence[Form]) -> list[tuple[Form, dict[str, int]]]:
    """The form that heads mean, with the place of each column; empty where none or more than one is meant."""
    heads, matches = [plain_head(split_head(cell)[0]) for cell in cells], list[tuple[Form, dict[str, int]]]()
    for form in forms:
        at = {name: k for name in form for k, head in enumerate(heads) if head in (name, *_MEANINGS.get(name, ()))}
        if len(at) == len(form) == len(set(at.values())):
            matches.append((form, at))
    return matches if len({frozenset(at.values()) for _, at in matches}) == 1 else []


def _plain_cells(path: Path, line: int, cells: Sequence[str], places: Mapping[str, int], decimal: str) -> list[str]:
    """The cells of a row that are taken, with decimal points."""
    if len(cells) <= max(places.values()):
        raise InputError(f"{path}:{line}: row: {len(cells)} cells; the header has more")
    numbers = []
    for name, place in places.items():
        try:
            numbers.append(figure(cells[place], decimal)[0] if decimal == "," else cells[place])
        except InputError as error:
            fault = error if cells[place] else "the cell is empty"
            raise InputError(f"{path}:{line}: {name}: {fault}; expected a number in each row") from None
    return numbers
