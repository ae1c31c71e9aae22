"""A drive over a long cycle in one pass, segment by segment: peaks, heat and energy as machine code."""

from __future__ import annotations

__all__: list[str] = []
