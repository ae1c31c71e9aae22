"""Values as cells of a table for other programs: no text that a spreadsheet would compute or cannot hold."""

from __future__ import annotations

import math
import re
import unicodedata
from typing import Any

__all__ = ["LONGEST", "csv_cell", "visible"]

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
    shown = ended if ended.isprintable() else "".join(repr(c)[1:-1] if _hides(c) else c for c in ended)
    return shown if len(shown) <= longest else shown[: longest - 1] + "…"


def _hides(letter: str) -> bool:
    return letter not in "\n\t" and (unicodedata.category(letter) in _HIDDEN or letter in _TURNING)


def csv_cell(value: Any) -> Any:
    """A value as a cell of a CSV: numbers unchanged, unknown empty, text never computed.

    >>> csv_cell(-2.5), csv_cell(math.nan), csv_cell("=1+1"), csv_cell("-1;=1+1")
    (-2.5, '', "'=1+1", "'-1;'=1+1")
    """
    if isinstance(value, float):
        return "" if math.isnan(value) else float(value)  # numpy's floats print as their constructor
    return _FORMULA.sub("'", visible(value)) if isinstance(value, str) else value
