"""One drive in closed loop: put together, simulated by the engine, judged, its figures.

May import: control and control/engine.
"""

from __future__ import annotations

__all__: list[str] = []
