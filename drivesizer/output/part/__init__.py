"""One part of a catalogue as every output prints it: its data sheet, tables, curves and remarks, without a format."""

from __future__ import annotations

__all__: list[str] = []
