"""Sections of a spec that was read before, in place of data that are the very same: nobody reads them once more.

A variant of a spec shares with it all data that it leaves as they are (``study.fields.changed``).
"""

from __future__ import annotations

from typing import Any

from drivesizer.files.fields import Section

__all__ = ["left_out_before", "read_before"]

_NAMING = ("kind", "profile")  # what sort of section it is


def read_before(data: dict[str, Any], known: dict[str, Any], before: Section) -> dict[str, Any]:
    """Groups of a section, and lists of groups, as they were read before where their data are the very same."""
    inside = {name: value for name, value in data.items() if isinstance(value, dict | list) and name in known}
    return {name: _kept(value, known[name], getattr(before, name, None)) for name, value in inside.items()}


def left_out_before(data: dict[str, Any], known: dict[str, Any], before: Section) -> dict[str, Any]:
    """Groups of a section, and lists of groups, that its data leave out as they did before."""
    left_out = type(before).model_fields.keys() - data.keys() - known.keys()
    values = {name: getattr(before, name) for name in left_out}
    return {name: value for name, value in values.items() if _is_read(value)}


def _is_read(value: Any) -> bool:
    """Whether it is a section, or a list of them."""
    if isinstance(value, list):
        return all(isinstance(one, Section) for one in value)
    return isinstance(value, Section)


def _kept(data: Any, known: Any, before: Any) -> Any:
    if isinstance(before, list):
        return before if data is known and _is_read(before) else data
    if not isinstance(before, Section):
        return data
    if data is known:
        return before
    alike = isinstance(data, dict) and isinstance(known, dict)
    if not alike or any(data.get(name) != known.get(name) for name in _NAMING):
        return data
    return data | read_before(data, known, before)
