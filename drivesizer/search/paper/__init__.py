"""The paper's method: its equations for a spec, and its rule as checks on columns."""

from __future__ import annotations

__all__: list[str] = []
