"""Candidates as columns, and their checks in stages: cheap ones first, the waveform last.

May import: what search may; nothing else of it.
"""

from __future__ import annotations
