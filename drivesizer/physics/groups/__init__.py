"""Segments of a long load cycle by their kinds, looked through once: imports nothing of the folder above it."""

from __future__ import annotations

__all__: list[str] = []
