"""machine.yaml: named axes on one supply, each a spec of its own, and which of them ride on one another."""

from __future__ import annotations

__all__: list[str] = []
