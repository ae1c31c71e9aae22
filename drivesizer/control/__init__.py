"""Closed loops: the drive train as a linear plant, gains, loop analysis, simulation and its checks.

May import: physics, platform, catalog, loads, spec, results, load_cases; not machine.
"""

from __future__ import annotations

__all__: list[str] = []
