"""Exceptions that drivesizer raises on purpose; anything else is a bug.

    DrivesizerError
    ├── InputError      the user's text, file or option is wrong (also a ValueError)
    │   ├── FieldError      a field of the spec, before its file and line are added
    │   ├── UnknownCatalogError  no catalogue has that name
    │   └── NoLoopError     this set cannot be driven in closed loop; everything else about it can be reported
    └── CatalogError    a catalogue file is wrong (also a ValueError)

Every message is one line: where, what was found, what is expected.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_LONG = 200  # characters, from which on a text is no misspelt name


class DrivesizerError(Exception):
    """Root of all errors that drivesizer raises on purpose."""


class InputError(DrivesizerError, ValueError):
    """Something that the user gave cannot be used; ``lines`` has a line for each of several faults in one file."""

    def __init__(self, message: str, lines: Iterable[str] = ()) -> None:
        super().__init__(message)
        self.lines = tuple(lines) or (message,)


class FieldError(InputError):
    """A field of the spec that cannot be used, raised where the file is not known; the caller adds file and line."""

    def __init__(self, field: tuple[str | int, ...], message: str) -> None:
        super().__init__(message)
        self.field = field


class UnknownCatalogError(InputError):
    """No catalogue has that name; who knows the file that names it adds file and line."""


class NoLoopError(InputError):
    """A drive that cannot be simulated in closed loop: a figure without which nothing moves is unknown."""


class CatalogError(DrivesizerError, ValueError):
    """A catalogue file cannot be used."""


def quoted(value: object, longest: int = 60) -> str:
    """The user's own text as it goes into a message: on one line, printable, cut when long.

    Parameters
    ----------
    value
        What the user wrote.
    longest
        Characters that are shown.

    Returns
    -------
    str
        The text between quotation marks.

    Examples
    --------
    >>> quoted("3,5 mm")
    '"3,5 mm"'
    """
    text = str(value)
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return f'"{printable(text)}"'


def printable(text: str) -> str:
    r"""A text with what is no printable character written out, so that none reaches a terminal.

    >>> printable("a\x1b[31m\x85b")
    'a\\x1b[31m\\x85b'
    """
    return text if text.isprintable() else "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def reason_of(error: Exception) -> str:
    """Reason of the operating system for a refusal, as in a message: ``no such file or directory``."""
    return (getattr(error, "strerror", "") or str(error)).lower()


def nearest(name: str, known: Iterable[str], most: int = 3) -> str:
    """A hint at what a misspelt name may have meant, to stand at the end of a message; empty where nothing is near.

    Parameters
    ----------
    name
        The misspelt name.
    known
        Names that there are.
    most
        Names that are shown.

    Returns
    -------
    str
        The hint with its leading semicolon, or an empty text.

    Examples
    --------
    >>> nearest("EPOS5", ["EPOS4", "GP 26 A"])
    '; the nearest is EPOS4'
    """
    close = difflib.get_close_matches(name, sorted(known), most, 0.5) if len(name) < _LONG else []
    return f"; the nearest {'is' if len(close) == 1 else 'are'} {', '.join(close)}" if close else ""
