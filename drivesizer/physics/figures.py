"""Figures of a part by field name: what every law of this room takes, whether of one part or of columns of them."""

from __future__ import annotations

from typing import Any, Protocol

__all__ = ["Figures"]


class Figures(Protocol):
    """Figures of a part by field name, SI: of one part floats and texts, of several columns; NaN or empty unknown.

    Parts of a catalogue and its tables are such figures, and so are plain dictionaries.
    """

    def __getitem__(self, name: str, /) -> Any:
        """A figure."""
