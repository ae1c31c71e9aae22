"""What reports print, read back, and a name that a report must escape."""

from __future__ import annotations

import csv
import io

HOSTILE = '#import "x" $y$ *b* \\ <a> "q"'


def rows_of(content: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(content.decode(), newline="")))
