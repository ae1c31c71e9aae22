"""A column of a study's table, and its cells."""

from __future__ import annotations

from math import isnan
from typing import Any, Literal, NamedTuple

__all__ = ["Column", "Form", "Row", "cell"]

Form = Literal["whole", "number", "text"]
Row = list[Any]  # a figure that is not known is None
_DIGITS = 12  # of a figure, to hide rounding errors


class Column(NamedTuple):
    """A column: its head, its type, and its unit for programs that read units separately."""

    head: str
    form: Form
    unit: str = ""


def cell(column: Column, value: Any) -> Any:
    """A value as a table has it."""
    if column.form != "number":
        return value
    return None if isnan(value) else float(f"{value:.{_DIGITS}g}")
