"""A catalogue to CSV and JSON, and other people's tables to a catalogue.

May import: the catalogue and its laws.
"""

from __future__ import annotations

__all__: list[str] = []
