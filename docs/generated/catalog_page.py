"""The columns of a catalogue as tables: unit of data sheets, and the remark beside the declaration."""

from __future__ import annotations

import inspect
import re
from typing import Any

from drivesizer.catalog.parts import PARTS, columns_of, printed

__all__ = ["columns"]

_FIELD = re.compile(r"^    (\w+): \w+ = (?:figure|text)\([^#\n]*\)(?:  # (.*))?$", re.MULTILINE)
_UNITS = {"text": "text", "1": "number"}


def columns() -> str:
    """A table for each section: column, unit, meaning where the name does not say it."""
    return "\n\n".join(_section(section, record) for section, record in PARTS.items())


def _section(section: str, record: Any) -> str:
    remarks = dict(_FIELD.findall(inspect.getsource(record)))
    rows = [f"| `{name}` | {_unit(section, name)} | {remarks.get(name, '')} |" for name in printed(section)]
    return "\n".join([f"### {section}", "", "| column | unit | |", "|---|---|---|", *rows])


def _unit(section: str, name: str) -> str:
    column = columns_of(section)[name]
    return _UNITS.get(column.kind, _UNITS.get(column.unit, column.unit))
