"""Numbers read back from the outputs."""

from __future__ import annotations

import re
from math import inf, nan
from typing import Any


def number(cell: Any) -> float:
    return nan if cell in ("", None) else inf if cell == "unbounded" else float(cell)


def sheet(book: Any, name: str) -> list[dict[str, Any]]:
    heads, *rows = book[name].iter_rows(values_only=True)
    return [dict(zip(heads, row, strict=True)) for row in rows]


NUMBER = r"[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+|⋅10[−-]?\d+)?"


def words(name: str) -> str:
    """A name as a pattern: a line may end behind its hyphens and slashes."""
    return re.sub(r"(\\-|/)", r"\1 ?", re.escape(name))


def value_of(digits: str) -> float:
    return float(digits.replace("⋅10", "e").replace("−", "-"))
