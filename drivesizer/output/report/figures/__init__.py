"""Figures by matplotlib, for reports and as files.

May import: ``lines`` and what output may.
"""

from __future__ import annotations
