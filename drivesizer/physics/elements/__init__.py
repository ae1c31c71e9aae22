"""Machine elements beside motor and gearhead: formulas of handbooks and makers on plain figures and arrays.

May import: nothing of the rooms beside it.
"""

from __future__ import annotations

__all__: list[str] = []
