"""Consistency of data sheets: laws between figures of a part, and the check of catalogues against them.

May import: the catalogue's columns, tables and parts; nothing of the catalogue reads its laws.
"""

from __future__ import annotations

__all__: list[str] = []
