"""Results as CSV files.

May import: ``sections``, ``lines`` and what output may.
"""

from __future__ import annotations

__all__: list[str] = []
