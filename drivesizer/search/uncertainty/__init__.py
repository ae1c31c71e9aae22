"""How sure a drive is: figures with tolerances, and how probable it is that every check passes all the same."""

from __future__ import annotations

__all__: list[str] = []
