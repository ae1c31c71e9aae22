"""What a report says, line by line, for every kind of report.

May import: what output may; no kind of report.
"""

from __future__ import annotations

__all__: list[str] = []
