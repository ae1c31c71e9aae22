"""Drives in order: out of all candidates those that pass or may pass, what orders them, and as many as are wanted."""

from __future__ import annotations

__all__: list[str] = []
