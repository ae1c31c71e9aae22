"""One drive in closed loop: its set-up, simulation by the engine, checks and figures.

May import: control and control/engine.
"""

from __future__ import annotations
