"""Whether a document reads as another one with one field changed: what an edit of its text is held against."""

from __future__ import annotations

import copy
from typing import Any

from drivesizer.files.yaml_source import Path_

__all__ = ["reads_as"]


def reads_as(after: Any, before: Any, path: Path_, value: Any, *, text: bool) -> bool:
    """Whether only one field differs."""
    if value is None:
        return bool(_same_data(after, _without_value(before, path)))
    try:
        found = after
        for step in path:
            found = found[step]
        expected = _with_value(before, path, found)
    except (KeyError, IndexError, TypeError):
        return False
    return bool(_same_data(after, expected)) and (not text or not isinstance(value, str) or found == value)


def _same_data(one: Any, other: Any) -> bool:
    return bool((one or None) == (other or None))  # without a field, a document is none, or an empty group


def _with_value(data: Any, path: Path_, value: Any) -> Any:
    """Data with a field, and the groups that it is in."""
    if not path:
        return value
    step, *rest = path
    if isinstance(step, int):
        entries = list(data or ())
        entries[step : step + 1] = [_with_value(entries[step] if step < len(entries) else None, tuple(rest), value)]
        return entries
    return {**(data or {}), step: _with_value((data or {}).get(step), tuple(rest), value)}


def _without_value(data: Any, path: Path_) -> Any:
    """Data without a field, and without groups that are empty then."""
    left = copy.deepcopy(data)
    places = [left]
    for step in path[:-1]:
        places.append(_below(places[-1], step))
    for place, step in zip(reversed(places), reversed(path), strict=True):
        if _below(place, step) is _NOTHING:
            return data
        if len(place) > 1 or place is left:
            del place[step]
            return left
    return left


_NOTHING = object()


def _below(place: Any, step: str | int) -> Any:
    known = isinstance(place, list) and isinstance(step, int) and 0 <= step < len(place)
    known = known or (isinstance(place, dict) and step in place)
    return place[step] if known else _NOTHING
