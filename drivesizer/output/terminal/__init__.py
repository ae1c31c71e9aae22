"""Results as tables at the terminal.

May import: what output may.
"""

from __future__ import annotations
