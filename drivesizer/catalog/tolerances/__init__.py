"""How far catalogue figures may be off: by the maker's statement, else by a class of figures; distributions.

May import: files and what is below the catalogue.
"""

from __future__ import annotations

__all__: list[str] = []
