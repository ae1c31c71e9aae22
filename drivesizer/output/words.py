"""Words and cells that all outputs print: numbers of things, probabilities, confidence, figures of parts."""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import replace
from math import ceil, inf, isfinite, isnan, log10
from typing import Any

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.parts import DATA, Column
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.files.text import listed
from drivesizer.load_cases.platform import WheelLoad
from drivesizer.results.check import Reliability, Spread, Status
from drivesizer.results.drive_set import DriveSet, section_of
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Counts, SizingResult
from drivesizer.units import digits_of, from_si, show

# -- A number of things in words: one of them is no several.


def number_of(count: int, thing: str, several: str = "") -> str:
    """A number with what it counts.

    Examples
    --------
    >>> number_of(1, "part"), number_of(2345, "part"), number_of(0, "axis", "axes")
    ('1 part', '2,345 parts', '0 axes')
    """
    return f"{count:,} {thing if count == 1 else several or thing + 's'}"


def meeting(counts: Counts, best: Status | None, of: str = "") -> str:
    """Number of drives that meet all limits, and that fail none as far as figures are known, in words.

    Examples
    --------
    >>> counts = [Counts(considered=99, feasible=n, passing=k, failed_by={}) for n, k in ((1, 1), (7, 0), (113, 87))]
    >>> [meeting(count, "pass") for count in counts]
    ['1 meets all limits', '7 fail no check', '87 meet all limits, 26 more fail none, figures missing']
    >>> meeting(Counts(considered=99, feasible=7, passing=5, failed_by={}, left_out=8), "pass")
    '5 meet all limits, 10 more fail none, figures missing, 8 of them left out by select: {unknown: reject}'
    >>> meeting(Counts(considered=99, feasible=7, passing=7, failed_by={}, undecided=1646), "pass")
    'at least 7 meet all limits, 1,646 behind them not computed'
    """
    if counts.undecided:
        known = meeting(replace(counts, undecided=0), best, of)
        return f"at least {known}, {counts.undecided:,} behind them not computed"
    passing = counts.passing if best in ("pass", None) else 0
    more = counts.feasible - passing + counts.left_out
    those = "" if counts.left_out == more else f"{counts.left_out:,} of them "
    left = f", {those}left out by select: {{unknown: reject}}" if counts.left_out else ""
    if not passing and more:
        return f"{more:,} fail{'s' * (more == 1)} no check{of}{left}"
    meet = f"{passing:,} meet{'s' * (passing == 1)} all limits{of}"
    return f"{meet}, {more:,} more fail{'s' * (more == 1)} none, figures missing{left}" if more else meet


# -- Probabilities as text, and the checks of a sampled drive in the order of printing.


def likely(value: float) -> str:
    """A probability as a text: never 100 % where a sample fails; NaN is unknown.

    >>> likely(0.95432), likely(0.99996), likely(0.999999), likely(1.0)
    ('95.4 %', '99.996 %', '99.9999 %', '100 %')
    """
    if value != value:
        return "unknown"
    if value in (0.0, 1.0):
        return f"{100 * value:.0f} %"
    digits = 1 if 0.001 <= value <= 0.999 else max(3, ceil(-log10(min(value, 1.0 - value))) - 2)
    return f"{100 * value:.{digits}f} %"


def about(value: float) -> str:
    """A probability out of a hundred samples or so, in whole per cent; empty where there is none.

    >>> about(0.648), about(1.0), about(float("nan"))
    ('about 65 %', 'about 99 %', '')
    """
    return "" if value != value else f"about {min(max(round(100 * value), 1), 99)} %"


def loop_text(reliability: Reliability) -> str:
    """The failing check in closed loop, or why none was simulated; empty where all pass or none was required."""
    if reliability.no_loop:
        return f"not simulated in closed loop: {reliability.no_loop}"
    return (
        f"in closed loop: {reliability.loop.weakest}" if reliability.loop and reliability.loop.probability < 1.0 else ""
    )


def confidence(value: float | None) -> str:
    """A required probability as text, with the digits of the spec.

    >>> confidence(0.9), confidence(0.995)
    ('90 %', '99.5 %')
    """
    return f"{100.0 * (value or 0.0):.12g} %"


def varying_checks(reliability: Reliability) -> list[Spread]:
    """The checks that vary over the samples or fail in some, lowest probability first."""
    varying = [
        check for check in reliability.checks if check.fails > 0.0 or (isfinite(check.low) and check.low != check.high)
    ]
    return sorted(varying, key=lambda check: (check.passes, check.low if isfinite(check.low) else -inf))


# -- The drive that is reported.


def outcome(result: SizingResult) -> str:
    """``found``, ``unsure`` where no drive reaches the required confidence, or ``missed`` where all are rejected."""
    return "found" if result.sets else "unsure" if result.unsure else "missed"


def reported(result: SizingResult) -> DriveSet | None:
    """The drive whose margins and drivers are reported: the best that is probable enough, else the most probable."""
    return next((drive for drive in (*result.sets, *result.unsure) if drive.reliability), None)


def first_wheel(problem: Problem) -> str:
    """The first load case where it is that of a wheel on a trajectory, such as ``wheel 1``; else empty."""
    return problem.cases[0].name if isinstance(problem.spec.load, WheelLoad) else ""


# -- Figures of a drive's parts that are not out of the makers' own documents.


def confidences(part: Any, role: str, drive: DriveSet, catalog: Catalog) -> dict[str, str]:
    """Confidence of each known figure of a part; of estimated ones those that the drive's checks rest on."""
    section = section_of(part)
    row = catalog.table(section).rows.get(part.part)
    if row is None:  # a brake that the spec describes
        return {}
    known = catalog.confidence(section, row)
    estimated = {estimate.figure for estimate in drive.estimated if estimate.part == role}
    return {
        name: known[name]
        for name, column in columns_of(section).items()
        if name in known
        and column.kind != "text"
        and name != DATA  # a condition of the others
        and (known[name] != ESTIMATED or name in estimated)
    }


def not_quoted(part: Any, role: str, drive: DriveSet, catalog: Catalog) -> dict[str, str]:
    """Figures of less confidence than quoted, those of the highest confidence first."""
    figures = confidences(part, role, drive, catalog)
    return {name: level for grade in LESS for name, level in figures.items() if level == grade}


LESS = ("secondary", "derived", "recalled", ESTIMATED)
"""Levels of confidence below quoted, the highest first."""


# -- Values as cells of a table for other programs: no text that a spreadsheet would compute or cannot hold.


LONGEST = 32767  # letters that a cell of a spreadsheet holds

# A spreadsheet computes a cell that begins so; some read the wide letters of East Asia alike. One that separates by
# semicolon or tab, or does not know the quotes of a field, finds the start of a cell inside a text as well.
_FORMULA = re.compile(r"^(?=[\t\n]| *[=+\-@＝＋－＠])|(?<=[;\t\n])(?= *[=+\-@＝＋－＠])")
_HIDDEN = {"Cc", "Cs", "Cn"}  # control characters, surrogates, unassigned
_TURNING = {*"\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"}  # change the displayed order of a text


def visible(text: str, longest: int = LONGEST) -> str:
    """A text with invisible characters spelled out, cut to the length of a cell.

    Examples
    --------
    >>> visible("a\\x00b\\r\\nc"), visible("abcdef", 4)
    ('a\\\\x00b\\nc', 'abc…')
    """
    ended = text.replace("\r\n", "\n").replace("\r", "\n")  # a lone carriage return ends the row for most readers
    printable = (
        ended
        if ended.isprintable()
        else "".join(
            repr(c)[1:-1] if c not in "\n\t" and (unicodedata.category(c) in _HIDDEN or c in _TURNING) else c
            for c in ended
        )
    )
    return printable if len(printable) <= longest else printable[: longest - 1] + "…"


def csv_cell(value: Any) -> Any:
    """A value as a cell of a CSV: numbers unchanged, unknown empty, text never computed.

    >>> csv_cell(-2.5), csv_cell(math.nan), csv_cell("=1+1"), csv_cell("-1;=1+1")
    (-2.5, '', "'=1+1", "'-1;'=1+1")
    """
    if isinstance(value, float):
        return "" if math.isnan(value) else float(value)  # numpy's floats print as their constructor
    return _FORMULA.sub("'", visible(value)) if isinstance(value, str) else value


# -- Figures of parts as texts, and which of them an engineer looks for first.


_LISTED = {name: cells for head, (name, *cells) in listed("drivesizer.output", "parts.txt") if head == "listed"}


def first_columns(section: str) -> tuple[str, list[tuple[str, Column]]]:
    """Figures that heads of a list of parts leave out, and its columns, each with its head, the most wanted first."""
    schema, (note, *columns) = columns_of(section), _LISTED[section]
    return note, [(head, schema[name]) for head, _, name in (column.rpartition(" ") for column in columns)]


def whole_name(part: Any) -> str:
    """Maker, family and number of a part, each word once."""
    return " ".join(dict.fromkeys(filter(None, (part.manufacturer, part.family, part.part))))


def figure(value: Any, column: Column, *, unit: bool = True, digits: int = 5) -> str:
    """A figure as a data sheet prints it; "unknown" where it is."""
    if isinstance(value, str):
        return value or "unknown"
    if isnan(value):
        return "unknown"
    if column.kind.startswith("price"):  # to the cent, as money is
        return f"{value:.2f} {column.unit}" if unit else f"{value:.2f}"
    if not unit:
        return digits_of(float(from_si(value, column.unit, column.kind)), digits)
    return show(value, column.unit, column.kind, digits)
