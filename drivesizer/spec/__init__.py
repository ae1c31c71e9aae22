"""robot.yaml as typed data in SI units, each field with the line that it stands in.

May import: files, physics, platform, catalog, loads.
"""

from __future__ import annotations
