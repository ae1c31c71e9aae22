"""What drivesizer raises on purpose; anything else is a bug.

    DrivesizerError
    ├── InputError      the user's text, file or option is wrong (also a ValueError)
    └── CatalogError    a catalogue file is wrong (also a ValueError)

Every message is one line: where, what was found, what is expected.
"""

from __future__ import annotations

__all__ = ["CatalogError", "DrivesizerError", "InputError", "quoted"]


class DrivesizerError(Exception):
    """Root of all errors that drivesizer raises on purpose."""


class InputError(DrivesizerError, ValueError):
    """Something that the user gave cannot be used."""


class CatalogError(DrivesizerError, ValueError):
    """A catalogue file cannot be used."""


def quoted(found: object, longest: int = 60) -> str:
    """The user's own text as it goes into a message: on one line, printable, cut when long.

    >>> quoted("3,5 mm")
    '"3,5 mm"'
    """
    text = str(found)
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return '"' + "".join(c if c.isprintable() else repr(c)[1:-1] for c in text) + '"'
