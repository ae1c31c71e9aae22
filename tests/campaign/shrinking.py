"""The smallest input that still ends in the same way."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

from case import Case

__all__ = ["shrunk"]


def shrunk(case: Case, still: Callable[[Case], bool], seconds: float = 20.0) -> Case:
    """An input without what it does not need: files, lines, pieces of lines.

    Parameters
    ----------
    case
        The input.
    still
        Whether another ends in the same way.
    seconds
        Time that is spent on it.

    Returns
    -------
    Case
        No larger than the input.
    """
    end, found = time.monotonic() + seconds, case
    for name in case.files:
        without = Case({key: raw for key, raw in found.files.items() if key != name}, found.commands)
        found = without if still(without) else found
    for parting in (b"\n", b" ", b""):
        for name in found.files:
            found = _without(found, name, parting, still, end)
    return found


def _without(case: Case, name: str, parting: bytes, still: Callable[[Case], bool], end: float) -> Case:
    """Pieces of a file taken away, half of them first, then ever fewer at once."""
    pieces = case.files[name].split(parting) if parting else [bytes([b]) for b in case.files[name][:400]]
    if not parting and len(case.files[name]) > len(pieces):
        return case
    size = max(len(pieces) // 2, 1)
    while size and time.monotonic() < end:
        for at in _backward(len(pieces), size):
            fewer = pieces[:at] + pieces[at + size :]
            other = Case({**case.files, name: parting.join(fewer)}, case.commands)
            if time.monotonic() < end and still(other):
                pieces, case = fewer, other
        size //= 2
    return case


def _backward(count: int, size: int) -> Iterator[int]:
    yield from range(((count - 1) // size) * size if count else -1, -1, -size)
