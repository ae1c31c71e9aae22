"""Tolerances of catalogue figures: classes of figures and their distributions.

May import: files and what is below the catalogue.
"""

from __future__ import annotations

__all__: list[str] = []
