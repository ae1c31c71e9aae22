"""A platform that follows its path: slip, pose control and the simulation of both.

May import: what control may.
"""

from __future__ import annotations
