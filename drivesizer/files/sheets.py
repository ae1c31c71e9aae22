"""Tables as people have them, as cells of text: CSV of any locale, workbooks, data sheets, JSON, Klipper, MJCF."""

from __future__ import annotations

import codecs
import configparser
import csv
import io
import json
import re
import unicodedata
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import read_bytes
from drivesizer.units import KINDS, kind_of_unit, number

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
    for one in (code,) if code else ("utf-8", "cp1252"):
        try:
            text = raw.decode(one)
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
        width, count = max(widths.items(), key=lambda one: (one[0] > 1, one[1], one[0]), default=(1, 0))
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
    openpyxl, found, cells = _library("openpyxl", path), [], 0
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
            found.append(Sheet(sheet.title, rows))
    except InputError:
        raise
    except Exception as error:  # whatever a damaged archive raises
        raise InputError(f"{path}: cannot be read as a workbook ({type(error).__name__}); save it as CSV") from None
    return found


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
    found = []
    for page, text in enumerate(texts, 1):
        rows = [(at, line_cells(line)) for at, line in enumerate(text.splitlines(), 1) if line.strip()]
        found.append(Sheet(f"page {page}", rows, " "))
    return found


def _records(text: str, path: Path) -> list[Sheet]:
    """A list of objects, or an object of them by name; a figure may be an object of number and unit."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON ({error})") from None
    if isinstance(data, dict) and not any(isinstance(one, dict) for one in data.values()):
        lists = [one for one in data.values() if isinstance(one, list) and one and isinstance(one[0], dict)]
        data = lists[0] if lists else [data]
    objects = [{"name": name} | one for name, one in data.items() if isinstance(one, dict)] \
        if isinstance(data, dict) else data  # fmt: skip
    if not isinstance(objects, list) or not objects or not all(isinstance(one, dict) for one in objects):
        raise InputError(f"{path}: expected a list of objects, one for each part")
    heads = list(dict.fromkeys(str(head) for one in objects for head in one))
    rows = [(at, [_figure(one.get(head)) for head in heads]) for at, one in enumerate(objects, 1)]
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
    found = list(parts)
    heads = list(dict.fromkeys(head for _, one in found for head in one))
    if not found:
        raise InputError(f"{path}: {what} found")
    rows = [(at, [one.get(head, "") for head in heads]) for at, one in found]
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
    parts = ((0, {"part": one.get("name", f"motor {at}"), **{k: v for k, v in one.attrib.items() if k in _MJCF}})
             for at, one in enumerate(root.iter("dcmotor"), 1))  # fmt: skip
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
    for one in (text, _SPELLINGS.get(text, ""), re.sub(r"(?<=[A-Za-z])\.(?=[A-Za-z])", "*", text)):
        if one and (kind_of_unit(one) is not None or currency_of(one)):
            return one
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
