"""Files in and out: text, CSV and YAML read strictly, types of their fields, outputs written whole or not at all, caches.

May import: errors, ranges, units.
"""

from __future__ import annotations

__all__: list[str] = []
