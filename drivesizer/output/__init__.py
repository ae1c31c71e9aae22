"""Outputs of results: terminal, JSON, reports, exports to other programs.

May import: every room up to machine and control; not search, sizing or study.
"""

from __future__ import annotations
