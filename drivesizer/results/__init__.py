"""Records that every output prints, and the columns of checks that they are made from.

May import: physics, catalog, spec.
"""

from __future__ import annotations
