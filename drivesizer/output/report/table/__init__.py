"""Results as tables of figures: CSV files, and what workbooks hold as well.

May import: what output may.
"""

from __future__ import annotations

__all__: list[str] = []
