"""One drive in its machine: its load cycle, losses and temperatures, battery, mass and the platform's budgets.

May import: physics, platform, catalog, loads, spec, results, load_cases.
"""

from __future__ import annotations

__all__: list[str] = []
