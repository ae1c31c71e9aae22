"""Texts and rows of plain data, for the sections and for figures.

May import: what output may.
"""

from __future__ import annotations

__all__: list[str] = []
