"""What a data sheet states twice, as laws that each part of a catalogue is held against.

May import: the catalogue's columns, tables and parts; nothing of the catalogue reads its laws.
"""

from __future__ import annotations

__all__: list[str] = []
