"""The report of a machine of several axes: what all of them are, then a chapter for each out of the sections of one.

May import: every kind of report, ``sections`` and what these may; none of them imports it.
"""

from __future__ import annotations

__all__: list[str] = []
