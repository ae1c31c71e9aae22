"""A number of things in words: one of them is no several."""

from __future__ import annotations

__all__ = ["number_of"]


def number_of(count: int, thing: str, several: str = "") -> str:
    """A number with what it counts.

    Parameters
    ----------
    count
        The number.
    thing
        What one of them is called.
    several
        What others are called; with an s where not given.

    Returns
    -------
    str
        The text, thousands apart.

    Examples
    --------
    >>> number_of(1, "part"), number_of(2345, "part"), number_of(0, "axis", "axes")
    ('1 part', '2,345 parts', '0 axes')
    """
    return f"{count:,} {thing if count == 1 else several or thing + 's'}"
